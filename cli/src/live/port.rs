//! Ports: a real one, a pseudo-terminal's side for others, a socket. Each reads for a while and writes what it can.

use super::{
    closed_peer,
    line_errors::{self, LineErrors},
};
use crate::{failure::Failure, interrupt};
use serial2::{CharSize, FlowControl, Parity, SerialPort, Settings, StopBits};
use std::{
    io::{self, ErrorKind, Read, Write},
    net::{Shutdown, SocketAddr, TcpListener, TcpStream},
    path::{Path, PathBuf},
    sync::mpsc::{RecvTimeoutError, sync_channel},
    thread,
    time::{Duration, Instant},
};

/// A system does not wait for less.
const MIN_WAIT: Duration = Duration::from_millis(1);
/// How long a write waits for room before it is tried again later.
const WRITE_WAIT: Duration = Duration::from_millis(1);
/// How often it is looked whether Ctrl-C ends the wait for a connection.
const CONNECT_WAIT: Duration = Duration::from_millis(20);
/// How often the system is asked whether a client is closed whose bytes are not read.
const ASK_TIME: Duration = Duration::from_millis(20);

/// What came of reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Heard {
    /// Nothing in that time.
    Nothing,
    /// So many bytes.
    Bytes(usize),
    /// Another client is connected than before.
    Connected,
    /// No more bytes come. The other end may still read.
    Ended,
    /// The other end has disconnected, and what it sent and was not read is lost.
    Gone,
}

/// One end of a line.
pub(crate) trait Port {
    /// Reads what is there, or comes within `wait`.
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Heard>;

    /// Waits without reading: what is there stays in the system. Still sees that the other end disconnects.
    fn wait(&mut self, wait: Duration) -> io::Result<Heard> {
        thread::sleep(wait);
        Ok(Heard::Nothing)
    }

    /// Disconnects a client whose bytes have ended.
    fn hang_up(&mut self) {}

    /// Writes as much as there is room for, now.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize>;

    /// Waits until all that was written has left, where the system tells.
    fn drain(&mut self) -> io::Result<()> {
        Ok(())
    }

    /// Raises or drops RTS.
    fn set_rts(&mut self, _on: bool) -> io::Result<()> {
        Err(ErrorKind::Unsupported.into())
    }

    /// Looks after what is no data, a few times a second; what is to be told.
    fn look(&mut self) -> Option<String> {
        None
    }

    /// Errors that the line had since it was opened, where the system counts them.
    fn line_errors(&self) -> Option<LineErrors> {
        None
    }

    /// Whether somebody is at the other end.
    fn is_connected(&self) -> bool {
        true
    }
}

/// Writes all, at the latest by `within`.
pub(crate) fn write_all(port: &mut dyn Port, mut bytes: &[u8], within: Duration) -> io::Result<()> {
    let begin = Instant::now();
    while !bytes.is_empty() {
        let written = port.write(bytes)?;
        bytes = bytes.get(written..).unwrap_or_default();
        if written == 0 {
            if begin.elapsed() > within {
                return Err(io::Error::new(ErrorKind::TimedOut, "it takes no bytes"));
            }
            thread::sleep(MIN_WAIT);
        }
    }
    Ok(())
}

/// What a read of the system comes to.
fn heard(result: io::Result<usize>) -> io::Result<Heard> {
    match result {
        Ok(0) => Ok(Heard::Gone),
        Ok(count) => Ok(Heard::Bytes(count)),
        Err(error) => match error.kind() {
            ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => Ok(Heard::Nothing),
            _ => Err(error),
        },
    }
}

/// What a write of the system comes to.
fn written(result: io::Result<usize>) -> io::Result<usize> {
    match result {
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
            ) =>
        {
            Ok(0)
        }
        other => other,
    }
}

/// How an RS-485 transceiver is turned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Rs485 {
    /// The adapter turns by itself.
    #[default]
    Auto,
    /// The kernel does (TIOCSRS485).
    Kernel,
    /// This command does: RTS up, write, drain, RTS down. Up to 9600 baud.
    Rts,
}

/// A real port, or somebody's pseudo-terminal.
pub(crate) struct Serial {
    port: SerialPort,
    /// Errors that were counted before.
    errors_before: Option<LineErrors>,
}

impl Serial {
    /// Opens a port at 8N1 without flow control, for nobody else, and reads back whether it is.
    pub(crate) fn open(path: &Path, baud: u32, rs485: Rs485) -> Result<Self, Failure> {
        let name = || path.display().to_string();
        let failed = |error: io::Error| Failure::Port(name(), error.to_string());
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
        let refused =
            |why: &str| Failure::Port(name(), format!("it does not take {baud} baud, 8N1, raw: {why}"));
        port.set_configuration(&wanted).map_err(|error| refused(&error.to_string()))?;
        let told = port.get_configuration().map_err(failed)?;
        let has = told.get_baud_rate().unwrap_or(0);
        // A divider has its steps; A4's receivers bear some per cent.
        if u64::from(has.abs_diff(baud)) * 50 > u64::from(baud) {
            return Err(refused(&format!("it says {has} baud")));
        }
        let frame = (told.get_char_size().ok(), told.get_stop_bits().ok(), told.get_parity().ok());
        if frame != (Some(CharSize::Bits8), Some(StopBits::One), Some(Parity::None)) {
            return Err(refused(&format!("it says {frame:?}")));
        }
        port.set_write_timeout(WRITE_WAIT).map_err(failed)?;
        if rs485 == Rs485::Kernel {
            kernel_turns(&port).map_err(|error| {
                Failure::Port(
                    name(),
                    format!("this port cannot turn an RS-485 transceiver: {error}; give --rs485 auto or rts"),
                )
            })?;
        }
        if rs485 == Rs485::Rts {
            port.set_rts(false).map_err(failed)?;
        }
        // What was sent before this port was opened is no answer.
        port.discard_buffers().map_err(failed)?;
        let errors_before = line_errors::counted(&port);
        Ok(Self { port, errors_before })
    }
}

#[cfg(target_os = "linux")]
fn kernel_turns(port: &SerialPort) -> io::Result<()> {
    port.set_rs4xx_mode(serial2::rs4xx::Rs485Config::new())
}

#[cfg(not(target_os = "linux"))]
fn kernel_turns(_port: &SerialPort) -> io::Result<()> {
    Err(ErrorKind::Unsupported.into())
}

/// Waits for bytes, or for the end of them.
#[cfg(unix)]
fn has_bytes(port: &impl std::os::fd::AsFd, wait: Duration) -> io::Result<bool> {
    poll_for(port, rustix::event::PollFlags::IN, wait)
}

/// Waits for what is asked for, and for errors, to the nanosecond: timeouts of ports and sockets are those of the system's tick.
#[cfg(unix)]
fn poll_for(
    port: &impl std::os::fd::AsFd,
    flags: rustix::event::PollFlags,
    wait: Duration,
) -> io::Result<bool> {
    use rustix::event::{PollFd, Timespec, poll};
    let mut fds = [PollFd::new(port, flags)];
    let timeout = Timespec { tv_sec: wait.as_secs().cast_signed(), tv_nsec: wait.subsec_nanos().into() };
    match poll(&mut fds, Some(&timeout)) {
        Ok(found) => Ok(found > 0),
        Err(rustix::io::Errno::INTR) => Ok(false),
        Err(error) => Err(error.into()),
    }
}

/// The timeout that follows is that of the system.
#[cfg(not(unix))]
fn has_bytes<T>(_port: &T, _wait: Duration) -> io::Result<bool> {
    Ok(true)
}

impl Port for Serial {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Heard> {
        if !has_bytes(&self.port, wait)? {
            return Ok(Heard::Nothing);
        }
        let wait = if wait.is_zero() { wait } else { wait.max(MIN_WAIT) };
        self.port.set_read_timeout(wait)?;
        heard(self.port.read(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        written(self.port.write(bytes))
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

/// A socket to a program that speaks the bytes as they are.
pub(crate) struct Socket(TcpStream);

impl Socket {
    pub(crate) fn new(stream: TcpStream) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        // Where reads are preceded by a wait for bytes neither a read nor a write has to wait itself.
        stream.set_nonblocking(cfg!(unix))?;
        stream.set_write_timeout(Some(WRITE_WAIT))?;
        Ok(Self(stream))
    }

    /// Connects to an address of another program. Ctrl-C ends the wait for the name and for the connection.
    pub(crate) fn connect(address: &str) -> Result<Self, Failure> {
        let failed = |error: io::Error| Failure::Port(format!("tcp:{address}"), error.to_string());
        let (sender, connected) = sync_channel(1);
        let to = address.to_owned();
        // The system looks up names and connects without a way to be interrupted: in a thread, which ends with the command.
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
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Heard> {
        if !has_bytes(&self.0, wait)? {
            return Ok(Heard::Nothing);
        }
        if !cfg!(unix) {
            self.0.set_read_timeout(Some(wait.max(MIN_WAIT)))?;
        }
        heard(self.0.read(buffer))
    }

    fn wait(&mut self, wait: Duration) -> io::Result<Heard> {
        Ok(if is_broken(&self.0, wait)? { Heard::Gone } else { Heard::Nothing })
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        written(self.0.write(bytes))
    }
}

/// Waits, and gives early whether the connection is broken.
#[cfg(unix)]
fn is_broken(stream: &TcpStream, wait: Duration) -> io::Result<bool> {
    poll_for(stream, rustix::event::PollFlags::empty(), wait)
}

/// Shows when it is read.
#[cfg(not(unix))]
fn is_broken(_stream: &TcpStream, wait: Duration) -> io::Result<bool> {
    thread::sleep(wait);
    Ok(false)
}

/// A client of a [`Listener`].
struct Client {
    socket: Socket,
    from: SocketAddr,
    /// It sends no more, and may still read.
    ended: bool,
}

impl Client {
    /// Whether no process has the other end open any more, though bytes from it may still wait in the system.
    fn is_closed(&self) -> bool {
        // A connection that was reset has no row in the system's tables.
        is_broken(&self.socket.0, Duration::ZERO).unwrap_or(false)
            || self.socket.0.local_addr().is_ok_and(|here| closed_peer::is_closed(here, self.from))
    }
}

/// A socket that waits for one client at a time.
pub(crate) struct Listener {
    listener: TcpListener,
    client: Option<Client>,
    /// Whether the client is one that was not told of.
    is_new: bool,
    /// When it was last asked whether the client is closed.
    asked: Instant,
}

impl Listener {
    /// Listens on an address; on one that others than this machine reach only where that is asked for.
    pub(crate) fn open(address: SocketAddr, open: bool) -> Result<(Self, SocketAddr), Failure> {
        if !address.ip().is_loopback() && !open {
            return Err(Failure::Option(format!(
                "--tcp {address}: whoever reaches this address could move the model; give 127.0.0.1, or --open to let them"
            )));
        }
        let failed = |error: io::Error| Failure::Port(format!("tcp:{address}"), error.to_string());
        let listener = TcpListener::bind(address).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        Ok((Self { listener, client: None, is_new: false, asked: Instant::now() }, address))
    }

    /// Takes a client that waits; one more than there may be is told and sent away.
    fn accept(&mut self) -> Option<String> {
        let (stream, from) = self.listener.accept().ok()?;
        if self.client.as_ref().is_some_and(|client| !client.ended && !client.is_closed()) {
            // It may speak another protocol: what it reads here it can show.
            let _ = (&stream).write_all(b"stepscope serve: another client is connected; one at a time\n");
            let _ = stream.shutdown(Shutdown::Both);
            return Some(format!("{from} was sent away: another client is connected"));
        }
        let socket = Socket::new(stream).ok()?;
        self.client = Some(Client { socket, from, ended: false });
        self.is_new = true;
        Some(format!("{from} is connected"))
    }
}

impl Port for Listener {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Heard> {
        if std::mem::take(&mut self.is_new) {
            return Ok(Heard::Connected);
        }
        let Some(client) = self.client.as_mut().filter(|client| !client.ended) else {
            return self.wait(wait.min(MIN_WAIT));
        };
        match client.socket.read(buffer, wait) {
            Ok(Heard::Gone) => {
                client.ended = true;
                Ok(Heard::Ended)
            }
            Err(_) => {
                self.client = None;
                Ok(Heard::Gone)
            }
            heard => heard,
        }
    }

    fn wait(&mut self, wait: Duration) -> io::Result<Heard> {
        if std::mem::take(&mut self.is_new) {
            return Ok(Heard::Connected);
        }
        let Some(client) = &mut self.client else {
            thread::sleep(wait);
            return Ok(Heard::Nothing);
        };
        let is_broken = client.socket.wait(wait)? == Heard::Gone;
        let asks = !client.ended && self.asked.elapsed() > ASK_TIME;
        if asks {
            self.asked = Instant::now();
        }
        if is_broken || asks && client.is_closed() {
            let ended = client.ended;
            self.client = None;
            // All that one sent whose bytes have ended was read.
            return Ok(if ended { Heard::Nothing } else { Heard::Gone });
        }
        Ok(Heard::Nothing)
    }

    fn hang_up(&mut self) {
        self.client = None;
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Until the new client is reported, replies are those to the client before.
        if self.is_new {
            return Ok(bytes.len());
        }
        // A reply that nobody reads is lost, as on a wire. A broken connection shows when it is read.
        self.client.as_mut().map_or(Ok(bytes.len()), |client| client.socket.write(bytes).or(Ok(bytes.len())))
    }

    fn look(&mut self) -> Option<String> {
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
    use rustix::{
        event::{PollFd, PollFlags, Timespec, poll},
        fs::{OFlags, fcntl_setfl},
        pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
        termios::{OptionalActions, tcgetattr, tcsetattr},
    };
    use std::{fs, os::fd::OwnedFd, os::unix::ffi::OsStringExt};

    /// Maximum number of bytes that a system may hold of a client that closed its port.
    const MAX_DISCARDED: usize = 1 << 20;

    /// Claims a link for this session, until it ends, however it ends: a name among the system's abstract sockets, which leaves no
    /// file behind. Whether the pseudo-terminal that the link leads to is there says nothing, as systems use its number again.
    #[cfg(target_os = "linux")]
    fn claim(link: &Path) -> Result<std::os::unix::net::UnixListener, Failure> {
        use std::{
            hash::{DefaultHasher, Hash as _, Hasher as _},
            os::{linux::net::SocketAddrExt as _, unix::net::UnixListener},
        };
        let folder = link.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let failed = |error: io::Error| Failure::File(link.to_owned(), error);
        let place = fs::canonicalize(folder).map_err(failed)?.join(link.file_name().unwrap_or_default());
        // Names of sockets are short.
        let mut hasher = DefaultHasher::new();
        place.hash(&mut hasher);
        let name = format!("stepscope-serve-pty-{:016x}", hasher.finish());
        let address = std::os::unix::net::SocketAddr::from_abstract_name(name).map_err(failed)?;
        UnixListener::bind_addr(&address).map_err(|error| match error.kind() {
            ErrorKind::AddrInUse => Failure::Port(
                link.display().to_string(),
                "a running session of stepscope serve uses this link; end that session, or give --pty another link".to_owned(),
            ),
            _ => failed(error),
        })
    }

    /// A pseudo-terminal whose other end is a port to somebody.
    pub(crate) struct Pty {
        master: OwnedFd,
        /// Of the other end.
        pub(crate) path: PathBuf,
        link: Option<PathBuf>,
        /// Held while the link is this session's.
        #[cfg(target_os = "linux")]
        _claim: Option<std::os::unix::net::UnixListener>,
        baud: u32,
        connected: bool,
        /// The rate that was warned of last.
        warned: u32,
    }

    impl Pty {
        /// Makes one, raw and at `baud`, with a symbolic link to it.
        pub(crate) fn open(link: Option<&Path>, baud: u32) -> Result<Self, Failure> {
            let failed = |error: io::Error| Failure::Port("pty".to_owned(), error.to_string());
            let made = || -> io::Result<(OwnedFd, PathBuf)> {
                let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
                grantpt(&master)?;
                unlockpt(&master)?;
                fcntl_setfl(&master, OFlags::NONBLOCK)?;
                // A master's settings are those of the other end.
                let mut settings = tcgetattr(&master)?;
                settings.make_raw();
                // A rate that the system has no word for shows as another one: then nobody is warned.
                let _ = settings.set_speed(baud);
                tcsetattr(&master, OptionalActions::Now, &settings)?;
                let path = ptsname(&master, Vec::new())?;
                Ok((master, PathBuf::from(std::ffi::OsString::from_vec(path.into_bytes()))))
            };
            let (master, path) = made().map_err(failed)?;
            #[cfg(target_os = "linux")]
            let claim = link.map(claim).transpose()?;
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
                pty.link_to(link).map_err(|error| Failure::File(link.to_owned(), error))?;
            }
            Ok(pty)
        }

        /// Waits for the other end; whether bytes are there, and whether nobody has the other end open.
        fn poll(&self, flags: PollFlags, wait: Duration) -> io::Result<(bool, bool)> {
            let mut fds = [PollFd::new(&self.master, flags)];
            let timeout =
                Timespec { tv_sec: wait.as_secs().cast_signed(), tv_nsec: wait.subsec_nanos().into() };
            match poll(&mut fds, Some(&timeout)) {
                Ok(_) => {}
                Err(rustix::io::Errno::INTR) => return Ok((false, false)),
                Err(error) => return Err(error.into()),
            }
            let [fd] = &fds;
            Ok((fd.revents().contains(PollFlags::IN), fd.revents().contains(PollFlags::HUP)))
        }

        /// Drops what nobody will be answered for: at most what the system holds.
        fn discard(&self) {
            let mut buffer = [0; 4096];
            for _ in 0..MAX_DISCARDED / buffer.len() {
                if !matches!(rustix::io::read(&self.master, &mut buffer), Ok(1..)) {
                    break;
                }
            }
        }

        /// Makes the link. One that a session left behind, and leads to no pseudo-terminal any more or to another one, is
        /// replaced; nothing else is.
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
        fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<Heard> {
            let (has_bytes, is_closed) = self.poll(PollFlags::IN, wait)?;
            let was_connected = std::mem::replace(&mut self.connected, has_bytes || !is_closed);
            if self.connected && !was_connected {
                return Ok(Heard::Connected);
            }
            if has_bytes {
                return match rustix::io::read(&self.master, buffer) {
                    Ok(count) => heard(Ok(count)),
                    // The other end was closed meanwhile.
                    Err(rustix::io::Errno::IO) => Ok(Heard::Nothing),
                    Err(error) => heard(Err(error.into())),
                };
            }
            if is_closed {
                if was_connected {
                    return Ok(Heard::Ended);
                }
                // The system reports it at once, again and again.
                thread::sleep(wait.min(MIN_WAIT));
            }
            Ok(Heard::Nothing)
        }

        fn wait(&mut self, wait: Duration) -> io::Result<Heard> {
            let (_, is_closed) = self.poll(PollFlags::empty(), wait)?;
            if is_closed && std::mem::replace(&mut self.connected, false) {
                self.discard();
                return Ok(Heard::Gone);
            }
            if is_closed {
                thread::sleep(wait.min(MIN_WAIT));
            }
            Ok(Heard::Nothing)
        }

        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if !self.connected {
                return Ok(bytes.len());
            }
            written(rustix::io::write(&self.master, bytes).map_err(Into::into))
        }

        fn look(&mut self) -> Option<String> {
            if !self.connected {
                return None;
            }
            let has = tcgetattr(&self.master).ok()?.output_speed();
            if has == self.warned {
                return None;
            }
            self.warned = has;
            let line = self.baud;
            (has != line).then(|| {
                format!("warning: the host set the port to {has} baud, and the line has {line}: a real one would not understand it")
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
    fn a_reply_to_the_client_before_does_not_reach_the_next_one() {
        let any = SocketAddr::from(([127, 0, 0, 1], 0));
        let (mut listener, address) = Listener::open(any, false).expect("a port");
        let mut buffer = [0; 8];
        let connect = |listener: &mut Listener| {
            let client = TcpStream::connect(address).expect("it listens");
            while listener.look().is_none() {}
            client
        };
        let first = connect(&mut listener);
        assert_eq!(listener.read(&mut buffer, MIN_WAIT).expect("it reads"), Heard::Connected);
        drop(first);
        while listener.read(&mut buffer, MIN_WAIT).expect("it reads") != Heard::Ended {}
        let mut second = connect(&mut listener);
        assert_eq!(listener.write(b"old").expect("it takes all"), 3);
        assert_eq!(listener.read(&mut buffer, MIN_WAIT).expect("it reads"), Heard::Connected);
        assert_eq!(listener.write(b"new").expect("it takes all"), 3);
        second.read_exact(&mut buffer[..3]).expect("a reply");
        assert_eq!(&buffer[..3], b"new");
    }
}
