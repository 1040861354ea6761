//! Server, driver and sessions of one test. All of it ends with the test, also where the test fails.

use std::{
    env, fs,
    future::Future,
    path::{Path, PathBuf},
    process::Stdio,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU32, Ordering},
    },
    time::Duration,
};

use anyhow::{Context, Result, anyhow, bail, ensure};
use fantoccini::{Client, ClientBuilder};
use hyper_util::client::legacy::connect::HttpConnector;
use tokio::{
    io::{AsyncBufReadExt, AsyncRead, BufReader, Lines},
    net::TcpStream,
    process::{Child, Command},
    task::{LocalSet, spawn_local},
    time::{sleep, timeout},
};

use crate::{
    browser::{Browser, Says, named},
    session::Session,
};

/// Longest time of one test's own work.
const TEST_LIMIT: Duration = Duration::from_secs(300);
/// Longest time until a program that was started says where it listens.
const START_LIMIT: Duration = Duration::from_secs(120);
/// Rest between two attempts to reach a program.
const LOOK_AGAIN: Duration = Duration::from_millis(20);
/// Longest time for a goodbye, after which a program is killed.
const END_LIMIT: Duration = Duration::from_secs(10);

/// What one test uses.
pub(crate) struct Bench {
    /// Address of the page, such as `http://127.0.0.1:40000/`.
    pub(crate) page: String,
    pub(crate) browser: Browser,
    driver: String,
    profiles: Folder,
    sessions: Mutex<Vec<Session>>,
    server: Mutex<Option<Child>>,
    heard: Heard,
}

/// What a driver and its browsers have said so far.
type Heard = Arc<Mutex<Vec<String>>>;

/// Runs `test` in a Chromium of its own. An error in the browser's console fails the test too.
pub(crate) fn in_browser<T, F>(test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    in_engine(Browser::Chromium, test)
}

/// The folder of the page as it is shipped.
pub(crate) fn dist() -> Result<PathBuf> {
    named("STEPSCOPE_DIST").map(PathBuf::from)
}

/// As [`in_browser`], with the page as it is shipped.
pub(crate) fn in_browser_shipped<T, F>(test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    in_browser_on(&dist()?, test)
}

/// As [`in_browser`], with the page in a folder of the test's own.
pub(crate) fn in_browser_on<T, F>(web: &Path, test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    in_engine_on(web, Browser::Chromium, test)
}

/// As [`in_browser`], in this engine.
pub(crate) fn in_engine<T, F>(browser: Browser, test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    in_engine_on(Path::new(&named("STEPSCOPE_WEB")?), browser, test)
}

fn in_engine_on<T, F>(web: &Path, browser: Browser, test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    LocalSet::new().block_on(&runtime, async {
        let mut serve = Command::new(named("STEPSCOPE_XTASK")?);
        serve.args(["serve", "--port", "0", "--web"]).arg(web);
        let (heard, silent) = (Heard::default(), Heard::default());
        let (server, page) = start(serve, Says::Port("serving "), &silent).await.context("the server")?;
        let profiles = Folder::temporary()?;
        let (mut driver, port) = driven(browser, &profiles.0, &heard).await?;
        let driver_address = format!("http://127.0.0.1:{}", port.trim_end_matches('.'));
        let bench = Arc::new(Bench {
            page,
            browser,
            driver: driver_address,
            profiles,
            sessions: Mutex::default(),
            server: Mutex::new(Some(server)),
            heard,
        });
        let outcome = match Session::start(&bench).await {
            Ok(session) => guarded(test(session)).await,
            Err(error) => Err(error),
        };
        let outcome = bench.end_sessions(outcome).await;
        end(&mut driver).await;
        bench.stop_server().await;
        outcome
    })
}

/// A driver that listens, with its port. Another program may take the free port that it chose before it does: then
/// it chooses once more.
async fn driven(browser: Browser, temporary: &Path, heard: &Heard) -> Result<(Child, String)> {
    let mut tried = 0;
    loop {
        let (drive, says) = browser.driver(temporary)?;
        tried += 1;
        match start(drive, says, heard).await {
            Err(_) if tried < 3 => {}
            done => return done.with_context(|| format!("{browser:?}'s driver")),
        }
    }
}

/// A test's work as a task of its own, so that a panic and an endless wait come back as errors.
async fn guarded(work: impl Future<Output = Result<()>> + 'static) -> Result<()> {
    let task = spawn_local(work);
    let stop = task.abort_handle();
    match timeout(TEST_LIMIT, task).await {
        Ok(Ok(outcome)) => outcome,
        Ok(Err(panic)) => Err(anyhow!(panic)),
        Err(_) => {
            stop.abort();
            Err(anyhow!("the test was not done after {TEST_LIMIT:?}"))
        }
    }
}

impl Bench {
    /// A browser with a fresh profile.
    pub(crate) async fn client(&self) -> Result<Client> {
        static PROFILE: AtomicU32 = AtomicU32::new(0);
        let profile = self.profiles.0.join(PROFILE.fetch_add(1, Ordering::Relaxed).to_string());
        let mut builder = ClientBuilder::new(HttpConnector::new());
        let connecting = builder.capabilities(self.browser.capabilities(&profile)?).connect(&self.driver);
        let name = format!("{:?}", self.browser);
        timeout(START_LIMIT, connecting).await.with_context(|| format!("{name} did not start"))?.context(name)
    }

    /// Errors of the page among what the driver and its browsers have said.
    pub(crate) fn heard(&self) -> Vec<String> {
        let heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        heard.iter().filter(|line| self.browser.complains(line, &self.page)).cloned().collect()
    }

    /// Ends the server: from now on there is no network.
    pub(crate) async fn stop_server(&self) {
        let server = self.server.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(mut server) = server {
            end(&mut server).await;
        }
    }

    pub(crate) fn keep(&self, session: Session) {
        self.sessions.lock().unwrap_or_else(PoisonError::into_inner).push(session);
    }

    /// Reads every session's console and ends the session; `outcome` with what the consoles add.
    pub(crate) async fn end_sessions(&self, mut outcome: Result<()>) -> Result<()> {
        let sessions = std::mem::take(&mut *self.sessions.lock().unwrap_or_else(PoisonError::into_inner));
        for session in sessions {
            if outcome.is_err() {
                session.failed().await;
            }
            let complaints = timeout(END_LIMIT, session.complaints()).await;
            // Whatever else is wrong, the browser must not stay.
            let ended = timeout(END_LIMIT, session.end()).await;
            let complaints = complaints.context("the console was not read in time").flatten();
            outcome = match (outcome, complaints) {
                (Ok(()), Ok(lines)) if lines.is_empty() => ended.context("the session did not end").flatten(),
                (Ok(()), Ok(lines)) => Err(anyhow!("the console is not silent:\n{}", lines.join("\n"))),
                (Ok(()), Err(error)) => Err(error),
                (Err(error), Ok(lines)) if !lines.is_empty() => {
                    Err(error.context(format!("the console:\n{}", lines.join("\n"))))
                }
                (Err(error), _) => Err(error),
            };
        }
        outcome
    }
}

/// A folder that goes with its owner.
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
        // What a dying browser still holds is left to the system's own clearing.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Starts a program, waits until it listens and gives where; what it says goes to `heard`.
async fn start(mut command: Command, says: Says, heard: &Heard) -> Result<(Child, String)> {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).kill_on_drop(true);
    let mut child = command.spawn().context("does not start")?;
    let mut lines = BufReader::new(child.stdout.take().context("has no output")?).lines();
    keep(BufReader::new(child.stderr.take().context("has no output")?).lines(), heard);
    let waiting = async {
        match says {
            Says::Port(before) => {
                while let Some(line) = lines.next_line().await? {
                    if let Some((_, place)) = line.split_once(before) {
                        return Ok(place.to_owned());
                    }
                }
                bail!("ended without a word on where it listens")
            }
            Says::Nothing(port) => {
                while TcpStream::connect(("127.0.0.1", port)).await.is_err() {
                    ensure!(child.try_wait()?.is_none(), "ended before it listened");
                    sleep(LOOK_AGAIN).await;
                }
                Ok(port.to_string())
            }
        }
    };
    let place = timeout(START_LIMIT, waiting).await.context("says nothing on where it listens")??;
    keep(lines, heard);
    Ok((child, place))
}

/// Reads a program's lines as long as it runs: a full pipe would stop it.
fn keep<R: AsyncRead + Unpin + Send + 'static>(mut lines: Lines<BufReader<R>>, heard: &Heard) {
    let heard = Arc::clone(heard);
    tokio::spawn(async move {
        while let Ok(Some(line)) = lines.next_line().await {
            heard.lock().unwrap_or_else(PoisonError::into_inner).push(line);
        }
    });
}

async fn end(child: &mut Child) {
    // It may have ended by itself, and nothing is left to be done then.
    let _ = child.start_kill();
    let _ = timeout(END_LIMIT, child.wait()).await;
}
