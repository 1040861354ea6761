//! What all tests share: a server for each folder, Chromium's driver, and browsers that are lent from test to test.
//!
//! Starting a browser takes longer than most of what a test does in it. So a browser is lent, and each visitor meets it
//! as if it were new: with a tab of its own, which begins with no emulation, no script of a test's and no history, and
//! under a name of its own, such as `visitor-7.page.localhost`. By that name it has an origin that no page was ever at,
//! and what a page leaves behind (storage, databases, caches, cookies without a domain, service workers, permissions)
//! stays with its origin. All these names are this machine, and to a browser they are as safe as 127.0.0.1; and they are
//! one site, which may keep its process from visitor to visitor. What has no origin is looked after by hand: between two
//! visitors keys and buttons that are held are lifted and the console is read out, and the clipboard is emptied for
//! whoever may use it.
//!
//! A browser in which something went wrong is not lent again.

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

/// Not dropped at the end, as no static is; what it holds ends by itself then: see [`Program`].
static POOL: LazyLock<Pool> = LazyLock::new(Pool::default);

#[derive(Default)]
struct Pool {
    /// By the folder that is served.
    servers: Mutex<BTreeMap<PathBuf, Program>>,
    driver: Mutex<Option<Program>>,
    /// Browsers that nobody uses.
    free: Mutex<Vec<Lent>>,
}

/// A Chromium, open at a tab for one user.
pub(crate) struct Lent {
    pub(crate) client: Client,
    /// The tab that keeps the browser open between two visitors.
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

/// The same page at an origin that no page was ever at.
pub(crate) fn fresh(address: &str) -> String {
    static VISITOR: AtomicU32 = AtomicU32::new(0);
    let number = VISITOR.fetch_add(1, Ordering::Relaxed);
    address.replace("127.0.0.1", &format!("visitor-{number}.page.localhost"))
}

/// A new browser of the driver at this address.
pub(crate) async fn start(browser: Browser, driver: &str) -> Result<Client> {
    // What keeps the connection lives as long as the process, and not as the test that happens to be the first.
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
    /// A browser that nobody uses, or a new one. One that is not given back ends.
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

    /// Opens a tab that is in front and has the focus; one that WebDriver opens has not.
    pub(crate) async fn open(&self) -> Result<()> {
        let about = json!({ "url": "about:blank" });
        let tab = devtools::command(&self.client, "Target.createTarget", about).await?;
        let tab = tab["targetId"].as_str().context("no tab was opened")?.to_owned();
        Ok(self.client.switch_to_window(tab.try_into()?).await?)
    }

    /// Closes all that the user opened, lifts what was held down and forgets what the console said.
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

    /// Gives the browser back, as if nobody had been there.
    pub(crate) async fn give_back(self) -> Result<()> {
        self.clear().await?;
        locked(&POOL.free).push(self);
        Ok(())
    }

    /// Ends the browser: nobody shall have it after this.
    pub(crate) async fn end(self) -> Result<()> {
        Ok(self.client.close().await?)
    }
}
