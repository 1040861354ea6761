//! Runs the kernels in a browser: their page posts its reports to a local server, whose reply is the number of rounds.

use std::ffi::OsString;
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
use crate::{files, root, serve};

/// Maximum time between two messages of the page: the browser starts, or it measures the rounds of a block.
const TIMEOUT: Duration = Duration::from_secs(120);

enum Message {
    /// The report of the last rounds, empty at first; the page then waits for the next number of rounds.
    Report(String),
    Failed(String),
}

pub(super) struct Page {
    messages: mpsc::Receiver<Message>,
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
        let (sender, mut messages) = mpsc::channel(1);
        let (rounds, requested) = mpsc::channel(1);
        let router = router(page, package, sender, requested);
        let server = tokio::spawn(async move {
            let _ = axum::serve(listener, router).await;
        });
        let log = home.join("browser.log");
        let browser = run::start(command(browser, &address, home, &log)?)?;
        receive(&mut messages, &log).await?;
        Ok(Self { messages, rounds, server, _browser: browser, log })
    }

    pub(super) async fn rounds(&mut self, rounds: u32) -> Result<Vec<Report>> {
        self.rounds.send(rounds).await.context("the server stopped")?;
        let text = receive(&mut self.messages, &self.log).await?;
        Report::all_from_json(&text)
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        self.server.abort();
    }
}

async fn receive(messages: &mut mpsc::Receiver<Message>, log: &Path) -> Result<String> {
    match tokio::time::timeout(TIMEOUT, messages.recv()).await {
        Ok(Some(Message::Report(text))) => Ok(text),
        Ok(Some(Message::Failed(why))) => bail!("the page of the kernels failed: {why}"),
        Ok(None) => bail!("the server of the kernels' page stopped"),
        Err(_) => bail!(
            "no message from the page of the kernels within {} s; the output of the browser is in {}",
            TIMEOUT.as_secs(),
            log.display()
        ),
    }
}

fn router(
    page: &Path,
    package: &Path,
    messages: mpsc::Sender<Message>,
    rounds: mpsc::Receiver<u32>,
) -> Router {
    let failures = messages.clone();
    let rounds = Arc::new(Mutex::new(rounds));
    let report = move |text: String| async move {
        let _ = messages.send(Message::Report(text)).await;
        rounds.lock().await.recv().await.unwrap_or(0).to_string()
    };
    let fail = move |why: String| async move {
        let _ = failures.send(Message::Failed(why)).await;
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
    let text = files::read(&flags)?;
    let flags: WebDriver =
        serde_json::from_str(&text).with_context(|| format!("{} is invalid", flags.display()))?;
    let file = files::create(log)?;
    let mut profile = OsString::from("--user-data-dir=");
    profile.push(home.join("profile"));
    let mut command = Command::new(&browser.chromium);
    command.args(flags.chromium.args).arg(profile).arg(address);
    command.stdout(file.try_clone()?).stderr(file);
    Ok(command)
}
