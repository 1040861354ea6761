//! Shared by all tests: one server per folder, Chromium's driver, and a pool of browsers.
//!
//! Starting a browser takes longer than most tests, so tests share browsers. Each user gets a browser as if it were
//! new. The tab is new, without emulation, scripts of other tests or history. The host name is new,
//! such as `visitor-7.page.localhost`, so it is a new origin,
//! and everything that a page stores (storage, databases, caches, cookies without a domain, service workers, permissions)
//! belongs to that origin. All these names are this machine, and browsers treat them like 127.0.0.1. They are
//! one site, so that users can share a process. Things without an origin are reset explicitly: between two
//! users, held keys and buttons are released, the console is read, and the clipboard is emptied for a user
//! who may read it.
//!
//! After a failure a browser is not used again.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{
        LazyLock, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU32, Ordering},
    },
};

use anyhow::{Context, Result, anyhow};
use fantoccini::{Client, ClientBuilder, wd::WindowHandle};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::json;
use tokio::{runtime::Runtime, time::timeout};

use crate::{
    browser::Browser,
    devtools,
    programs::{Program, START_LIMIT},
};

/// A static is never dropped; its contents end with this process: see [`Program`].
static POOL: LazyLock<Pool> = LazyLock::new(Pool::default);

#[derive(Default)]
struct Pool {
    /// By the served folder.
    servers: Mutex<BTreeMap<PathBuf, Program>>,
    driver: Mutex<Option<Program>>,
    /// Idle browsers.
    free: Mutex<Vec<Lent>>,
}

/// A Chromium with an open tab for one user.
pub(crate) struct Lent {
    pub(crate) client: Client,
    /// The tab that keeps the browser open between two users.
    home: WindowHandle,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The address of the page in this folder.
pub(crate) fn served(web: &Path) -> Result<String> {
    let mut servers = locked(&POOL.servers);
    if let Some(server) = servers.get(web) {
        return Ok(server.address.clone());
    }
    let server = Program::server(web)?;
    let address = server.address.clone();
    servers.insert(web.to_owned(), server);
    Ok(address)
}

/// The same page at a new origin.
pub(crate) fn fresh(address: &str) -> String {
    static VISITOR: AtomicU32 = AtomicU32::new(0);
    let number = VISITOR.fetch_add(1, Ordering::Relaxed);
    address.replace("127.0.0.1", &format!("visitor-{number}.page.localhost"))
}

/// A new browser of the driver at this address.
pub(crate) async fn start(browser: Browser, driver: &str) -> Result<Client> {
    // The connection must live as long as the process, not only as the first test.
    static CONNECTIONS: LazyLock<std::io::Result<Runtime>> =
        LazyLock::new(|| tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build());
    let connections = CONNECTIONS.as_ref().map_err(|error| anyhow!("no runtime: {error}"))?;
    let (capabilities, driver) = (browser.capabilities()?, driver.to_owned());
    let connecting = connections.spawn(async move {
        let mut builder = ClientBuilder::new(HttpConnector::new());
        timeout(START_LIMIT, builder.capabilities(capabilities).connect(&driver)).await
    });
    let started = connecting.await?.with_context(|| format!("{browser:?} did not start"))?;
    started.with_context(|| format!("{browser:?}"))
}

/// The address of Chromium's driver.
fn driver() -> Result<String> {
    let mut driver = locked(&POOL.driver);
    let running = match driver.take() {
        Some(running) => running,
        None => Program::driver(Browser::Chromium)?,
    };
    Ok(driver.insert(running).address.clone())
}

impl Lent {
    /// An idle browser, or a new one. A browser that is not returned ends.
    pub(crate) async fn take() -> Result<Self> {
        let free = locked(&POOL.free).pop();
        match free {
            Some(free) => Ok(free),
            None => {
                let client = start(Browser::Chromium, &driver()?).await?;
                let home = client.window().await?;
                Ok(Self { client, home })
            }
        }
    }

    /// Opens a tab in front with the focus; tabs of WebDriver have no focus.
    pub(crate) async fn open(&self) -> Result<()> {
        let about = json!({ "url": "about:blank" });
        let tab = devtools::command(&self.client, "Target.createTarget", about).await?;
        let tab = tab["targetId"].as_str().context("no tab was opened")?.to_owned();
        Ok(self.client.switch_to_window(tab.try_into()?).await?)
    }

    /// Closes everything that the user opened, releases held keys, and clears the console.
    pub(crate) async fn clear(&self) -> Result<()> {
        for tab in self.client.windows().await? {
            if tab != self.home {
                self.client.switch_to_window(tab).await?;
                self.client.close_window().await?;
            }
        }
        self.client.switch_to_window(self.home.clone()).await?;
        self.client.release_actions().await?;
        devtools::console(&self.client).await.map(drop)
    }

    /// Returns the browser to the pool, as if it were new.
    pub(crate) async fn give_back(self) -> Result<()> {
        self.clear().await?;
        locked(&POOL.free).push(self);
        Ok(())
    }

    /// Ends the browser, so that no other test gets it.
    pub(crate) async fn end(self) -> Result<()> {
        Ok(self.client.close().await?)
    }
}
