//! Server, driver and sessions of one test. All of it ends with the test, also where the test fails.

use std::{
    env,
    ffi::OsString,
    fs,
    future::Future,
    path::{Path, PathBuf},
    process::Stdio,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU32, Ordering},
    },
    time::Duration,
};

use anyhow::{Context, Result, anyhow, bail};
use fantoccini::{Client, ClientBuilder};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};
use tokio::{
    io::{AsyncBufReadExt, BufReader},
    process::{Child, Command},
    task::{LocalSet, spawn_local},
    time::timeout,
};

use crate::session::Session;

/// Longest time of one test's own work.
const TEST_LIMIT: Duration = Duration::from_secs(120);
/// Longest time until a program that was started says where it listens.
const START_LIMIT: Duration = Duration::from_secs(30);
/// Longest time for a goodbye, after which a program is killed.
const END_LIMIT: Duration = Duration::from_secs(10);

/// Flags of every browser: no window, and no word to any other host.
const FLAGS: &[&str] = &[
    "--headless",
    // The browser ends when the driver does.
    "--remote-debugging-pipe",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--force-device-scale-factor=1",
    "--window-size=1440,900",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1, EXCLUDE localhost",
];

/// What one test uses.
pub(crate) struct Bench {
    /// Address of the page, such as `http://127.0.0.1:40000/`.
    pub(crate) page: String,
    driver: String,
    profiles: Folder,
    sessions: Mutex<Vec<Session>>,
    server: Mutex<Option<Child>>,
}

/// Runs `test` in a browser of its own. An error in the browser's console fails the test too.
pub(crate) fn in_browser<T, F>(test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    in_browser_on(Path::new(&web()?), test)
}

/// The built page that the environment names.
pub(crate) fn web() -> Result<OsString> {
    named("STEPSCOPE_WEB")
}

/// As [`in_browser`], with the page in a folder of the test's own.
pub(crate) fn in_browser_on<T, F>(web: &Path, test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    LocalSet::new().block_on(&runtime, async {
        let mut serve = Command::new(named("STEPSCOPE_XTASK")?);
        serve.args(["serve", "--port", "0", "--web"]).arg(web);
        let mut drive = Command::new(named("STEPSCOPE_CHROMEDRIVER")?);
        let profiles = Folder::temporary()?;
        // Chromium leaves files behind in the folder for temporary ones.
        drive.arg("--port=0").env("TMPDIR", &profiles.0);
        let (server, page) = start(serve, |line| line.strip_prefix("serving ").map(str::to_owned))
            .await
            .context("the server")?;
        let (mut driver, port) = start(drive, |line| {
            let (_, port) = line.split_once("started successfully on port ")?;
            Some(port.trim_end_matches('.').to_owned())
        })
        .await
        .context("chromedriver")?;
        let bench = Arc::new(Bench {
            page,
            driver: format!("http://127.0.0.1:{port}"),
            profiles,
            sessions: Mutex::default(),
            server: Mutex::new(Some(server)),
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
    pub(crate) async fn browser(&self) -> Result<Client> {
        static PROFILE: AtomicU32 = AtomicU32::new(0);
        let profile = self.profiles.0.join(PROFILE.fetch_add(1, Ordering::Relaxed).to_string());
        let mut args: Vec<String> = FLAGS.iter().map(|&flag| flag.to_owned()).collect();
        args.push(format!("--user-data-dir={}", profile.display()));
        let wanted = json!({
            "browserName": "chrome",
            "goog:loggingPrefs": { "browser": "ALL" },
            "goog:chromeOptions": { "binary": Path::new(&named("STEPSCOPE_CHROMIUM")?), "args": args },
        });
        let Value::Object(wanted) = wanted else { bail!("the capabilities are an object") };
        let mut builder = ClientBuilder::new(HttpConnector::new());
        let connecting = builder.capabilities(wanted).connect(&self.driver);
        timeout(START_LIMIT, connecting).await.context("Chromium did not start")?.context("Chromium")
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
    async fn end_sessions(&self, mut outcome: Result<()>) -> Result<()> {
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

fn named(variable: &str) -> Result<OsString> {
    env::var_os(variable).with_context(|| {
        format!("{variable} is not set; `cargo xtask test --only page` sets what these tests need")
    })
}

/// Starts a program and waits for the line in which it says where it listens.
async fn start(mut command: Command, says: impl Fn(&str) -> Option<String>) -> Result<(Child, String)> {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).kill_on_drop(true);
    let mut child = command.spawn().context("does not start")?;
    let mut lines = BufReader::new(child.stdout.take().context("has no output")?).lines();
    let waiting = async {
        while let Some(line) = lines.next_line().await? {
            if let Some(place) = says(&line) {
                return Ok(place);
            }
        }
        bail!("ended without a word on where it listens")
    };
    let place = timeout(START_LIMIT, waiting).await.context("says nothing on where it listens")??;
    // A full pipe would stop the program.
    tokio::spawn(async move { while let Ok(Some(_)) = lines.next_line().await {} });
    Ok((child, place))
}

async fn end(child: &mut Child) {
    // It may have ended by itself, and nothing is left to be done then.
    let _ = child.start_kill();
    let _ = timeout(END_LIMIT, child.wait()).await;
}
