//! Servers and drivers: programs that listen, and that always end with this process.

use std::{
    env, fs,
    io::{BufRead, BufReader, Read},
    net::TcpStream,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU32, Ordering},
        mpsc,
    },
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail, ensure};

use crate::browser::{Browser, Says, named};

/// Maximum time until a program reports its address.
pub(crate) const START_LIMIT: Duration = Duration::from_secs(300);
/// Pause between two attempts to reach a program.
const LOOK_AGAIN: Duration = Duration::from_millis(20);

/// The output of a program and its children so far.
type RxEvent = Arc<Mutex<Vec<String>>>;

/// A program that listens. It ends, with all its children, when this is dropped, and when this process ends.
pub(crate) struct Program {
    /// The address of its service, with a trailing slash; or the path.
    pub(crate) address: String,
    child: Child,
    heard: RxEvent,
}

impl Program {
    /// Serves the page in a folder.
    pub(crate) fn server(web: &Path) -> Result<Self> {
        let mut serve = Command::new(named("STEPSCOPE_XTASK")?);
        serve.args(["serve", "--port", "0", "--web"]).arg(web);
        Self::start(&serve, Says::Line("serving ")).context("the server")
    }

    /// A browser's driver. If another program takes the chosen free port first, a second port is
    /// chosen.
    pub(crate) fn driver(browser: Browser) -> Result<Self> {
        let mut tried = 0;
        loop {
            let (drive, says) = browser.driver()?;
            tried += 1;
            match Self::start(&drive, says) {
                Err(_) if tried < 3 => {}
                done => return done.with_context(|| format!("{browser:?}'s driver")),
            }
        }
    }

    /// Starts an attended program, and waits until it listens.
    pub(crate) fn start(program: &Command, says: Says) -> Result<Self> {
        let mut attended = Command::new(named("STEPSCOPE_XTASK")?);
        attended.args(["attend", "--"]).arg(program.get_program()).args(program.get_args());
        attended.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // It outlives this process by a moment, even if a signal ends the whole process group.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut attended, 0);
        let mut child = attended.spawn().context("does not start")?;
        let (said, lines) = mpsc::channel();
        let output = child.stdout.take().context("has no output")?;
        let errors = child.stderr.take().context("has no output")?;
        let mut program = Self { address: String::new(), child, heard: RxEvent::default() };
        program.hear(output, said.clone());
        program.hear(errors, said);
        program.address = program.place(says, &lines)?;
        Ok(program)
    }

    /// Reads lines while the program runs, because a full pipe would stop it; `said` stores them while they are needed.
    fn hear<R: Read + Send + 'static>(&self, output: R, said: mpsc::Sender<String>) {
        let heard = Arc::clone(&self.heard);
        thread::spawn(move || {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                // Once it listens, its output is not needed.
                let _ = said.send(line.clone());
                heard.lock().unwrap_or_else(PoisonError::into_inner).push(line);
            }
        });
    }

    fn place(&mut self, says: Says, lines: &mpsc::Receiver<String>) -> Result<String> {
        let end = Instant::now() + START_LIMIT;
        match says {
            Says::Line(before) => {
                let line = self.line(before, lines, end)?;
                let place = line.trim_end_matches(['.', '/']);
                let port = place.rsplit_once(':').map_or(place, |(_, port)| port);
                Ok(format!("http://127.0.0.1:{port}/"))
            }
            Says::Path(before) => self.line(before, lines, end),
            Says::Nothing(port) => {
                while TcpStream::connect(("127.0.0.1", port)).is_err() {
                    ensure!(self.child.try_wait()?.is_none(), "ended before it listened");
                    ensure!(Instant::now() < end, "does not listen after {START_LIMIT:?}");
                    thread::sleep(LOOK_AGAIN);
                }
                Ok(format!("http://127.0.0.1:{port}/"))
            }
        }
    }

    /// The rest of the first line with this text, after the text.
    fn line(&self, before: &str, lines: &mpsc::Receiver<String>, end: Instant) -> Result<String> {
        loop {
            match lines.recv_timeout(end.saturating_duration_since(Instant::now())) {
                Ok(line) => {
                    if let Some((_, place)) = line.split_once(before) {
                        return Ok(place.to_owned());
                    }
                }
                Err(mpsc::RecvTimeoutError::Disconnected) => {
                    bail!("ended without a word on where it listens: {}", self.heard().join("\n"))
                }
                Err(mpsc::RecvTimeoutError::Timeout) => bail!("does not report its address"),
            }
        }
    }

    /// The output of the program and its children so far.
    pub(crate) fn heard(&self) -> Vec<String> {
        self.heard.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // The end of its input makes it end its children, and then itself.
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}

/// A folder that is removed when it is dropped.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn temporary() -> Result<Self> {
        static FOLDER: AtomicU32 = AtomicU32::new(0);
        let number = FOLDER.fetch_add(1, Ordering::Relaxed);
        let folder = env::temp_dir().join(format!("stepscope-page-{}-{number}", std::process::id()));
        fs::create_dir_all(&folder).with_context(|| format!("{} can't be made", folder.display()))?;
        Ok(Self(folder))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // The system removes what an ending server still uses.
        let _ = fs::remove_dir_all(&self.0);
    }
}
