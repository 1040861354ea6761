//! Ports: a serial port, a pseudo-terminal, a socket. Each reads with a time-out and writes without blocking.

use super::closed_peer;
use super::line_errors::{self, LineErrors};
use crate::{failure::Failure, interrupt};
use serial2::{CharSize, FlowControl, Parity, SerialPort, Settings, StopBits};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// The system's shortest wait.
const MIN_WAIT: Duration = Duration::from_millis(1);
/// How long a write waits for space.
const WRITE_WAIT: Duration = Duration::from_millis(1);
/// Interval of checks for Ctrl-C while connecting.
const CONNECT_WAIT: Duration = Duration::from_millis(20);
/// Interval of checks whether a client whose bytes are unread has closed.
const CHECK_TIME: Duration = Duration::from_millis(20);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Received {
    Nothing,
    Bytes(usize),
    Connected,
    /// No more bytes come; the other end may still read.
    Ended,
    /// The other end has disconnected; its unread bytes are lost.
    Gone,
}

pub(crate) trait Port {
    /// Reads what is available or comes within `wait`.
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Received>;

    fn wait(&mut self, wait: Duration) -> io::Result<Received> {
        thread::sleep(wait);
        Ok(Received::Nothing)
    }

    fn hang_up(&mut self) {}

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize>;

    /// Waits until everything is sent, if the system can tell.
    fn drain(&mut self) -> io::Result<()> {
        Ok(())
    }

    fn set_rts(&mut self, _on: bool) -> io::Result<()> {
        Err(ErrorKind::Unsupported.into())
    }

    /// Called several times per second for other events; returns a message for the user.
    fn poll_events(&mut self) -> Option<String> {
        None
    }

    fn line_errors(&self) -> Option<LineErrors> {
        None
    }

    fn is_connected(&self) -> bool {
        true
    }
}

pub(crate) fn write_all(port: &mut dyn Port, mut bytes: &[u8], within: Duration) -> io::Result<()> {
    let begin = Instant::now();
    while !bytes.is_empty() {
        let written = port.write(bytes)?;
        bytes = bytes.get(written..).unwrap_or_default();
        if written == 0 {
            if begin.elapsed() > within {
                return Err(io::Error::new(ErrorKind::TimedOut, "the port accepts no bytes"));
            }
            thread::sleep(MIN_WAIT);
        }
    }
    Ok(())
}

/// Whether a read or a write has to be repeated later.
fn is_retry(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

fn read_result(result: io::Result<usize>) -> io::Result<Received> {
    match result {
        Ok(0) => Ok(Received::Gone),
        Ok(count) => Ok(Received::Bytes(count)),
        Err(error) if is_retry(&error) => Ok(Received::Nothing),
        Err(error) => Err(error),
    }
}

fn write_result(result: io::Result<usize>) -> io::Result<usize> {
    result.or_else(|error| if is_retry(&error) { Ok(0) } else { Err(error) })
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Rs485 {
    /// The adapter switches it
    #[default]
    Auto,
    /// The kernel switches it (TIOCSRS485)
    Kernel,
    /// This command switches it with RTS, up to 9600 baud
    Rts,
}

pub(crate) struct Serial {
    port: SerialPort,
    errors_before: Option<LineErrors>,
}

impl Serial {
    /// Opens the port exclusively at 8N1 without flow control and reads the settings back.
    pub(crate) fn open(path: &Path, baud: u32, rs485: Rs485) -> Result<Self, Failure> {
        let name = || path.display().to_string();
        let failed = |error: io::Error| Failure::Unusable(name(), error.to_string());
        let set = |mut settings: Settings| -> io::Result<Settings> {
            settings.set_raw();
            settings.set_char_size(CharSize::Bits8);
            settings.set_stop_bits(StopBits::One);
            settings.set_parity(Parity::None);
            settings.set_flow_control(FlowControl::None);
            settings.set_baud_rate(baud)?;
            Ok(settings)
        };
        let mut port = SerialPort::open(path, |settings: Settings| Ok(settings)).map_err(failed)?;
        #[cfg(unix)]
        rustix::termios::ioctl_tiocexcl(&port).map_err(|error| failed(error.into()))?;
        let wanted = port.get_configuration().and_then(set).map_err(failed)?;
        let refused = |why: &str| {
            Failure::Unusable(name(), format!("the port does not support {baud} baud, 8N1, raw: {why}"))
        };
        port.set_configuration(&wanted).map_err(|error| refused(&error.to_string()))?;
        let actual = port.get_configuration().map_err(failed)?;
        let actual_baud = actual.get_baud_rate().unwrap_or(0);
        // Dividers are coarse, and receivers tolerate a few percent.
        if u64::from(actual_baud.abs_diff(baud)) * 50 > u64::from(baud) {
            return Err(refused(&format!("it reports {actual_baud} baud")));
        }
        let frame = (actual.get_char_size().ok(), actual.get_stop_bits().ok(), actual.get_parity().ok());
        if frame != (Some(CharSize::Bits8), Some(StopBits::One), Some(Parity::None)) {
            return Err(refused(&format!("it reports {frame:?}")));
        }
        port.set_write_timeout(WRITE_WAIT).map_err(failed)?;
        if rs485 == Rs485::Kernel {
            enable_kernel_rs485(&port).map_err(|error| {
                Failure::Unusable(
                    name(),
                    format!("the port cannot switch an RS-485 transceiver: {error}; use --rs485 auto or rts"),
                )
            })?;
        }
        if rs485 == Rs485::Rts {
            port.set_rts(false).map_err(failed)?;
        }
        // Bytes from before this session are not replies.
        port.discard_buffers().map_err(failed)?;
        let errors_before = line_errors::counted(&port);
        Ok(Self { port, errors_before })
    }
}

#[cfg(target_os = "linux")]
fn enable_kernel_rs485(port: &SerialPort) -> io::Result<()> {
    port.set_rs4xx_mode(serial2::rs4xx::Rs485Config::new())
}

#[cfg(not(target_os = "linux"))]
fn enable_kernel_rs485(_port: &SerialPort) -> io::Result<()> {
    Err(ErrorKind::Unsupported.into())
}

#[cfg(unix)]
fn has_bytes(port: &impl std::os::fd::AsFd, wait: Duration) -> io::Result<bool> {
    Ok(!poll_for(port, rustix::event::PollFlags::IN, wait)?.is_empty())
}

/// Waits for events. Uses nanoseconds: timeouts of ports and sockets have the resolution of the system's tick.
#[cfg(unix)]
fn poll_for(
    port: &impl std::os::fd::AsFd,
    flags: rustix::event::PollFlags,
    wait: Duration,
) -> io::Result<rustix::event::PollFlags> {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let mut fds = [PollFd::new(port, flags)];
    let timeout = Timespec { tv_sec: wait.as_secs().cast_signed(), tv_nsec: wait.subsec_nanos().into() };
    match poll(&mut fds, Some(&timeout)) {
        Ok(_) => Ok(fds[0].revents()),
        Err(rustix::io::Errno::INTR) => Ok(PollFlags::empty()),
        Err(error) => Err(error.into()),
    }
}

/// The read's own time-out follows.
#[cfg(not(unix))]
fn has_bytes<T>(_port: &T, _wait: Duration) -> io::Result<bool> {
    Ok(true)
}

impl Port for Serial {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Received> {
        if !has_bytes(&self.port, wait)? {
            return Ok(Received::Nothing);
        }
        let wait = if wait.is_zero() { wait } else { wait.max(MIN_WAIT) };
        self.port.set_read_timeout(wait)?;
        read_result(self.port.read(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        write_result(self.port.write(bytes))
    }

    fn drain(&mut self) -> io::Result<()> {
        self.port.flush()
    }

    fn set_rts(&mut self, on: bool) -> io::Result<()> {
        self.port.set_rts(on)
    }

    fn line_errors(&self) -> Option<LineErrors> {
        Some(line_errors::counted(&self.port)?.since(self.errors_before?))
    }
}

pub(crate) struct Socket(TcpStream);

impl Socket {
    pub(crate) fn new(stream: TcpStream) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        // Reads wait with `poll`, so neither reads nor writes need to block.
        stream.set_nonblocking(cfg!(unix))?;
        stream.set_write_timeout(Some(WRITE_WAIT))?;
        Ok(Self(stream))
    }

    /// Ctrl-C ends the wait for the name and the connection.
    pub(crate) fn connect(address: &str) -> Result<Self, Failure> {
        let failed = |error: io::Error| Failure::Unusable(format!("tcp:{address}"), error.to_string());
        let (sender, connected) = sync_channel(1);
        let to = address.to_owned();
        // Name lookup and connecting cannot be interrupted, so a thread does them; it ends with the command.
        let connect = move || drop(sender.send(TcpStream::connect(to)));
        thread::Builder::new().name("connect".to_owned()).spawn(connect).map_err(Failure::threads)?;
        loop {
            match connected.recv_timeout(CONNECT_WAIT) {
                Ok(stream) => return stream.and_then(Self::new).map_err(failed),
                Err(RecvTimeoutError::Timeout) if interrupt::count() > 0 => return Err(Failure::Interrupted),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Err(failed(ErrorKind::Other.into())),
            }
        }
    }
}

impl Port for Socket {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Received> {
        if !has_bytes(&self.0, wait)? {
            return Ok(Received::Nothing);
        }
        if !cfg!(unix) {
            self.0.set_read_timeout(Some(wait.max(MIN_WAIT)))?;
        }
        read_result(self.0.read(buffer))
    }

    fn wait(&mut self, wait: Duration) -> io::Result<Received> {
        Ok(if is_broken(&self.0, wait)? { Received::Gone } else { Received::Nothing })
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        write_result(self.0.write(bytes))
    }
}

#[cfg(unix)]
fn is_broken(stream: &TcpStream, wait: Duration) -> io::Result<bool> {
    Ok(!poll_for(stream, rustix::event::PollFlags::empty(), wait)?.is_empty())
}

/// The next read shows it.
#[cfg(not(unix))]
fn is_broken(_stream: &TcpStream, wait: Duration) -> io::Result<bool> {
    thread::sleep(wait);
    Ok(false)
}

struct Client {
    socket: Socket,
    from: SocketAddr,
    ended: bool,
}

impl Client {
    /// Whether no process has the other end open, although unread bytes may remain.
    fn is_closed(&self) -> bool {
        // A reset connection has no row in the system's tables.
        is_broken(&self.socket.0, Duration::ZERO).unwrap_or(false)
            || self.socket.0.local_addr().is_ok_and(|here| closed_peer::is_closed(here, self.from))
    }
}

pub(crate) struct Listener {
    listener: TcpListener,
    client: Option<Client>,
    is_new: bool,
    checked: Instant,
}

impl Listener {
    /// Accepts connections from other machines only with `open`.
    pub(crate) fn open(address: SocketAddr, open: bool) -> Result<(Self, SocketAddr), Failure> {
        if !address.ip().is_loopback() && !open {
            return Err(Failure::Option(format!(
                "--tcp: other machines can reach {address}; use 127.0.0.1, or --allow-remote to allow them"
            )));
        }
        let failed = |error: io::Error| Failure::Unusable(format!("tcp:{address}"), error.to_string());
        let listener = TcpListener::bind(address).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        Ok((Self { listener, client: None, is_new: false, checked: Instant::now() }, address))
    }

    /// Accepts a waiting client; an additional one gets a message and is disconnected.
    fn accept(&mut self) -> Option<String> {
        let (stream, from) = self.listener.accept().ok()?;
        if self.client.as_ref().is_some_and(|client| !client.ended && !client.is_closed()) {
            // The client may use another protocol, but can show this text.
            let _ = (&stream).write_all(b"stepscope serve: another client is connected; one at a time\n");
            let _ = stream.shutdown(Shutdown::Both);
            return Some(format!("{from} was refused: another client is connected"));
        }
        let socket = Socket::new(stream).ok()?;
        self.client = Some(Client { socket, from, ended: false });
        self.is_new = true;
        Some(format!("{from} is connected"))
    }
}

impl Port for Listener {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Received> {
        if std::mem::take(&mut self.is_new) {
            return Ok(Received::Connected);
        }
        let Some(client) = self.client.as_mut().filter(|client| !client.ended) else {
            return self.wait(wait.min(MIN_WAIT));
        };
        match client.socket.read(buffer, wait) {
            Ok(Received::Gone) => {
                client.ended = true;
                Ok(Received::Ended)
            }
            Err(_) => {
                self.client = None;
                Ok(Received::Gone)
            }
            received => received,
        }
    }

    fn wait(&mut self, wait: Duration) -> io::Result<Received> {
        if std::mem::take(&mut self.is_new) {
            return Ok(Received::Connected);
        }
        let Some(client) = &mut self.client else {
            thread::sleep(wait);
            return Ok(Received::Nothing);
        };
        let is_broken = client.socket.wait(wait)? == Received::Gone;
        let checks = !client.ended && self.checked.elapsed() > CHECK_TIME;
        if checks {
            self.checked = Instant::now();
        }
        if is_broken || checks && client.is_closed() {
            let ended = client.ended;
            self.client = None;
            // A client that has stopped sending has been read completely.
            return Ok(if ended { Received::Nothing } else { Received::Gone });
        }
        Ok(Received::Nothing)
    }

    fn hang_up(&mut self) {
        self.client = None;
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Until the new client is reported, replies belong to the previous one.
        if self.is_new {
            return Ok(bytes.len());
        }
        // An unread reply is lost, as on a wire. The next read shows a broken connection.
        self.client.as_mut().map_or(Ok(bytes.len()), |client| client.socket.write(bytes).or(Ok(bytes.len())))
    }

    fn poll_events(&mut self) -> Option<String> {
        self.accept()
    }

    fn is_connected(&self) -> bool {
        self.client.is_some()
    }
}

#[cfg(unix)]
pub(crate) use pty::Pty;

#[cfg(unix)]
mod pty {
    use super::*;
    use rustix::event::PollFlags;
    use rustix::fs::{OFlags, fcntl_setfl};
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};
    use std::{fs, os::fd::OwnedFd, os::unix::ffi::OsStringExt};

    /// Maximum bytes that the system holds for a client that has closed.
    const MAX_DISCARDED: usize = 1 << 20;

    /// Claims a link for this session by an abstract socket, which disappears with the process and leaves no file.
    /// The link's target does not show whether it is in use, since systems reuse the numbers of pseudo-terminals.
    #[cfg(target_os = "linux")]
    fn claim(link: &Path) -> Result<std::os::unix::net::UnixListener, Failure> {
        use std::{
            hash::{DefaultHasher, Hash as _, Hasher as _},
            os::{linux::net::SocketAddrExt as _, unix::net::UnixListener},
        };
        let folder = link.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let failed = |error: io::Error| Failure::File(link.to_owned(), error);
        let path = fs::canonicalize(folder).map_err(failed)?.join(link.file_name().unwrap_or_default());
        // Socket names are short, so the path is hashed.
        let mut hasher = DefaultHasher::new();
        path.hash(&mut hasher);
        let name = format!("stepscope-serve-pty-{:016x}", hasher.finish());
        let address = std::os::unix::net::SocketAddr::from_abstract_name(name).map_err(failed)?;
        UnixListener::bind_addr(&address).map_err(|error| match error.kind() {
            ErrorKind::AddrInUse => Failure::Unusable(
                link.display().to_string(),
                "a running session of stepscope serve uses this link; end that session, or use another link"
                    .to_owned(),
            ),
            _ => failed(error),
        })
    }

    /// A pseudo-terminal; the other end is a port for another program.
    pub(crate) struct Pty {
        master: OwnedFd,
        pub(crate) path: PathBuf,
        link: Option<PathBuf>,
        /// Held while this session owns the link.
        #[cfg(target_os = "linux")]
        _claim: Option<std::os::unix::net::UnixListener>,
        baud: u32,
        connected: bool,
        /// The last rate of the host that was reported, or the line's.
        warned: u32,
    }

    impl Pty {
        pub(crate) fn open(link: Option<&Path>, baud: u32) -> Result<Self, Failure> {
            let failed = |error: io::Error| Failure::Unusable("pty".to_owned(), error.to_string());
            let opened = || -> io::Result<(OwnedFd, PathBuf)> {
                let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
                grantpt(&master)?;
                unlockpt(&master)?;
                fcntl_setfl(&master, OFlags::NONBLOCK)?;
                // Settings of the master apply to the other end.
                let mut settings = tcgetattr(&master)?;
                settings.make_raw();
                // A rate unknown to the system cannot be compared, so there is no warning.
                let _ = settings.set_speed(baud);
                tcsetattr(&master, OptionalActions::Now, &settings)?;
                let path = ptsname(&master, Vec::new())?;
                Ok((master, PathBuf::from(std::ffi::OsString::from_vec(path.into_bytes()))))
            };
            #[cfg(target_os = "linux")]
            let claim = link.map(claim).transpose()?;
            let (master, path) = opened().map_err(failed)?;
            let mut pty = Self {
                master,
                path,
                link: None,
                #[cfg(target_os = "linux")]
                _claim: claim,
                baud,
                connected: false,
                warned: baud,
            };
            if let Some(link) = link {
                pty.link_to(link).map_err(|error| match error.kind() {
                    ErrorKind::AlreadyExists => {
                        let why = "exists and is not a link to a terminal; remove it, or use another link";
                        Failure::Unusable(link.display().to_string(), why.to_owned())
                    }
                    _ => Failure::File(link.to_owned(), error),
                })?;
            }
            Ok(pty)
        }

        /// Whether there are bytes, and whether the other end is closed.
        fn poll(&self, flags: PollFlags, wait: Duration) -> io::Result<(bool, bool)> {
            let events = poll_for(&self.master, flags, wait)?;
            Ok((events.contains(PollFlags::IN), events.contains(PollFlags::HUP)))
        }

        /// Drops bytes that will get no reply: at most the system's buffer.
        fn discard(&self) {
            let mut buffer = [0; 4096];
            for _ in 0..MAX_DISCARDED / buffer.len() {
                if !matches!(rustix::io::read(&self.master, &mut buffer), Ok(1..)) {
                    break;
                }
            }
        }

        /// Replaces only a link that a session left behind and that is no longer in use.
        fn link_to(&mut self, link: &Path) -> io::Result<()> {
            if fs::read_link(link).is_ok_and(|target| target.starts_with("/dev/pts")) {
                fs::remove_file(link)?;
            }
            std::os::unix::fs::symlink(&self.path, link)?;
            self.link = Some(link.to_owned());
            Ok(())
        }
    }

    impl Drop for Pty {
        fn drop(&mut self) {
            if let Some(link) = &self.link
                && fs::read_link(link).is_ok_and(|target| target == self.path)
            {
                let _ = fs::remove_file(link);
            }
        }
    }

    impl Port for Pty {
        fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Received> {
            let (has_bytes, is_closed) = self.poll(PollFlags::IN, wait)?;
            let was_connected = std::mem::replace(&mut self.connected, has_bytes || !is_closed);
            if self.connected && !was_connected {
                return Ok(Received::Connected);
            }
            if has_bytes {
                return match rustix::io::read(&self.master, buffer) {
                    Ok(count) => read_result(Ok(count)),
                    // The other end was closed meanwhile.
                    Err(rustix::io::Errno::IO) => Ok(Received::Nothing),
                    Err(error) => read_result(Err(error.into())),
                };
            }
            if is_closed {
                if was_connected {
                    return Ok(Received::Ended);
                }
                // The system reports this without waiting.
                thread::sleep(wait.min(MIN_WAIT));
            }
            Ok(Received::Nothing)
        }

        fn wait(&mut self, wait: Duration) -> io::Result<Received> {
            let (_, is_closed) = self.poll(PollFlags::empty(), wait)?;
            if is_closed && std::mem::replace(&mut self.connected, false) {
                self.discard();
                return Ok(Received::Gone);
            }
            if is_closed {
                thread::sleep(wait.min(MIN_WAIT));
            }
            Ok(Received::Nothing)
        }

        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if !self.connected {
                return Ok(bytes.len());
            }
            write_result(rustix::io::write(&self.master, bytes).map_err(Into::into))
        }

        fn poll_events(&mut self) -> Option<String> {
            if !self.connected {
                return None;
            }
            let actual = tcgetattr(&self.master).ok()?.output_speed();
            if actual == self.warned {
                return None;
            }
            self.warned = actual;
            let line = self.baud;
            (actual != line).then(|| {
                format!("warning: the host set the port to {actual} baud, but the line has {line}; a real controller would receive framing errors")
            })
        }

        fn is_connected(&self) -> bool {
            self.connected
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replies_to_the_last_client_do_not_reach_the_next() {
        let any = SocketAddr::from(([127, 0, 0, 1], 0));
        let (mut listener, address) = Listener::open(any, false).expect("a port");
        let mut buffer = [0; 8];
        let connect = |listener: &mut Listener| {
            let client = TcpStream::connect(address).expect("it listens");
            while listener.poll_events().is_none() {}
            client
        };
        let first = connect(&mut listener);
        assert_eq!(listener.read(&mut buffer, MIN_WAIT).expect("it reads"), Received::Connected);
        drop(first);
        while listener.read(&mut buffer, MIN_WAIT).expect("it reads") != Received::Ended {}
        let mut second = connect(&mut listener);
        assert_eq!(listener.write(b"old").expect("it takes all"), 3);
        assert_eq!(listener.read(&mut buffer, MIN_WAIT).expect("it reads"), Received::Connected);
        assert_eq!(listener.write(b"new").expect("it takes all"), 3);
        second.read_exact(&mut buffer[..3]).expect("a reply");
        assert_eq!(&buffer[..3], b"new");
    }
}
