//! The kernels in a browser. Their page requests the number of rounds itself, so only the local server is between it
//! and this process.

use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use axum::Router;
use axum::routing::post;
use serde::Deserialize;
use tokio::process::Command;
use tokio::sync::{Mutex, mpsc};
use tokio::task::JoinHandle;
use tower_http::services::ServeDir;

use super::table::Report;
use crate::browser::Browser;
use crate::run::{self, Group};
use crate::{root, serve};

/// Maximum time between two messages of the page: the browser starts, or it measures the rounds of a block.
const PATIENCE: Duration = Duration::from_secs(120);

enum Word {
    /// The report of the last rounds, empty at first; the page then waits for the next number of rounds.
    Report(String),
    Failed(String),
}

pub(super) struct Page {
    words: mpsc::Receiver<Word>,
    rounds: mpsc::Sender<u32>,
    server: JoinHandle<()>,
    _browser: Group,
    log: PathBuf,
}

impl Page {
    pub(super) async fn open(browser: &Browser, page: &Path, package: &Path, home: &Path) -> Result<Self> {
        let listener = serve::bind(0)?;
        let address = format!("http://{}/", listener.local_addr()?);
        listener.set_nonblocking(true)?;
        let listener = tokio::net::TcpListener::from_std(listener)?;
        let (said, mut words) = mpsc::channel(1);
        let (rounds, asked) = mpsc::channel(1);
        let router = router(page, package, said, asked);
        let server = tokio::spawn(async move {
            let _ = axum::serve(listener, router).await;
        });
        let log = home.join("browser.log");
        let browser = run::start(command(browser, &address, home, &log)?)?;
        hear(&mut words, &log).await?;
        Ok(Self { words, rounds, server, _browser: browser, log })
    }

    pub(super) async fn rounds(&mut self, rounds: u32) -> Result<Vec<Report>> {
        self.rounds.send(rounds).await.context("the server stopped")?;
        let text = hear(&mut self.words, &self.log).await?;
        Report::all_from_json(&text)
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.server.abort();
    }
}

async fn hear(words: &mut mpsc::Receiver<Word>, log: &Path) -> Result<String> {
    match tokio::time::timeout(PATIENCE, words.recv()).await {
        Ok(Some(Word::Report(text))) => Ok(text),
        Ok(Some(Word::Failed(why))) => bail!("the page of the kernels failed: {why}"),
        Ok(None) => bail!("the server of the kernels' page stopped"),
        Err(_) => bail!(
            "the page of the kernels was silent for {} s; what the browser printed is in {}",
            PATIENCE.as_secs(),
            log.display()
        ),
    }
}

fn router(page: &Path, package: &Path, words: mpsc::Sender<Word>, rounds: mpsc::Receiver<u32>) -> Router {
    let failed = words.clone();
    let rounds = Arc::new(Mutex::new(rounds));
    let report = move |text: String| async move {
        let _ = words.send(Word::Report(text)).await;
        rounds.lock().await.recv().await.unwrap_or(0).to_string()
    };
    let fail = move |why: String| async move {
        let _ = failed.send(Word::Failed(why)).await;
    };
    Router::new()
        .route("/rounds", post(report))
        .route("/failed", post(fail))
        .nest_service("/pkg", ServeDir::new(package))
        .fallback_service(ServeDir::new(page))
}

/// Uses the same flags as the wasm crate's tests.
fn command(browser: &Browser, address: &str, home: &Path, log: &Path) -> Result<Command> {
    #[derive(Deserialize)]
    struct WebDriver {
        #[serde(rename = "goog:chromeOptions")]
        chromium: Chromium,
    }
    #[derive(Deserialize)]
    struct Chromium {
        args: Vec<String>,
    }
    let flags = root().join("wasm").join("webdriver.json");
    let text =
        std::fs::read_to_string(&flags).with_context(|| format!("{} can't be read", flags.display()))?;
    let flags: WebDriver = serde_json::from_str(&text)
        .with_context(|| format!("{} is not what it should be", flags.display()))?;
    let file = File::create(log).with_context(|| format!("{} can't be written", log.display()))?;
    let mut profile = OsString::from("--user-data-dir=");
    profile.push(home.join("profile"));
    let mut command = Command::new(&browser.chromium);
    command.args(flags.chromium.args).arg(profile).arg(address);
    command.stdout(file.try_clone()?).stderr(file);
    Ok(command)
}
