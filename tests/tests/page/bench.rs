//! Setup of one test: the page at an address, and its users. All of it is released at the end of the test, even after
//! a failure. An error in a browser's console fails the test, too.

use std::{
    future::Future,
    path::PathBuf,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use anyhow::{Context, Result, anyhow, bail};
use tokio::{
    task::{LocalSet, spawn_local},
    time::timeout,
};

use crate::{
    browser::{Browser, named},
    pool::{self, Lent},
    programs::Program,
    session::Session,
};

/// Maximum duration of a test, on a busy machine, too.
const TEST_LIMIT: Duration = Duration::from_secs(1800);
/// Maximum time for ending a visit.
const END_LIMIT: Duration = Duration::from_secs(60);

/// Removes the service worker interface from later documents, before their own scripts run. Otherwise all files of the page
/// would be fetched and stored for each user.
const NOT_KEPT: &str = "delete Navigator.prototype.serviceWorker;";

/// Whether the service worker stores the page on the device.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Keeping {
    Kept,
    NotKept,
}

/// Setup of one test.
pub(crate) struct Bench {
    pub(crate) browser: Browser,
    keeping: Keeping,
    /// Address of the page, such as `http://127.0.0.1:40000/`; each user has a separate host name.
    page: String,
    /// A browser of another engine, or a Chromium for this test only.
    driver: Option<Program>,
    /// For additional visitors of such a browser.
    servers: Mutex<Vec<Program>>,
    visitors: Mutex<Vec<(Session, Option<Lent>)>>,
}

/// Runs `test` with the shipped page in a Chromium that other tests share, as a new user without a stored
/// page.
pub(crate) fn in_browser<T, F>(test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    at_work(pool::served(&dist()?)?, Browser::Chromium, None, Keeping::NotKept, test)
}

/// Like [`in_browser`], but the page is stored on the device, as for real users.
pub(crate) fn in_browser_that_keeps<T, F>(test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    in_browser_at(&pool::served(&dist()?)?, test)
}

/// The folder of the shipped page.
pub(crate) fn dist() -> Result<PathBuf> {
    named("STEPSCOPE_DIST").map(PathBuf::from)
}

/// The folder of the page's sources.
fn web() -> Result<PathBuf> {
    named("STEPSCOPE_WEB").map(PathBuf::from)
}

/// Like [`in_browser`], with the page's sources, whose single modules can be tested. They are many files, so they load
/// more slowly.
pub(crate) fn in_sources<T, F>(test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    in_engine(Browser::Chromium, test)
}

/// Like [`in_browser_that_keeps`], with the page at the address of the test's own server.
pub(crate) fn in_browser_at<T, F>(address: &str, test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    in_engine_at(address.to_owned(), Browser::Chromium, test)
}

/// Like [`in_sources`], in this engine; browsers other than Chromium are started for the test.
pub(crate) fn in_engine<T, F>(browser: Browser, test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    in_engine_at(pool::served(&web()?)?, browser, test)
}

/// Like [`in_browser_at`], in this driver's Chromium, which only this test uses.
pub(crate) fn in_chromium_of<T, F>(driver: Program, address: String, test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    at_work(address, Browser::Chromium, Some(driver), Keeping::Kept, test)
}

fn in_engine_at<T, F>(page: String, browser: Browser, test: T) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    let driver = match browser {
        Browser::Chromium => None,
        Browser::Firefox | Browser::WebKit => Some(Program::driver(browser)?),
    };
    at_work(page, browser, driver, Keeping::Kept, test)
}

fn at_work<T, F>(
    page: String,
    browser: Browser,
    driver: Option<Program>,
    keeping: Keeping,
    test: T,
) -> Result<()>
where
    T: FnOnce(Session) -> F,
    F: Future<Output = Result<()>> + 'static,
{
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    LocalSet::new().block_on(&runtime, async {
        let (servers, visitors) = (Mutex::default(), Mutex::default());
        let bench = Arc::new(Bench { browser, keeping, page, driver, servers, visitors });
        let outcome = match bench.visitor(None).await {
            Ok(session) => guarded(test(session)).await,
            Err(error) => Err(error),
        };
        bench.end_visits(outcome).await
    })
}

/// Runs the test as a separate task, so that a panic or an endless wait becomes an error.
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
    /// A new user, at this address or at a new one.
    pub(crate) async fn visitor(self: &Arc<Self>, address: Option<String>) -> Result<Session> {
        let (client, address, lent) = match &self.driver {
            Some(driver) => (pool::start(self.browser, &driver.address).await?, self.page.clone(), None),
            None => {
                let lent = Lent::take().await?;
                lent.open().await?;
                (lent.client.clone(), address.unwrap_or_else(|| pool::fresh(&self.page)), Some(lent))
            }
        };
        let session = Session::new(client, self, address);
        self.visitors().push((session.clone(), lent));
        self.prepare(&session).await?;
        Ok(session)
    }

    /// Settings of each user: the size of the screen, and whether the device stores the page.
    async fn prepare(&self, session: &Session) -> Result<()> {
        session.screen(1440, 900).await?;
        match self.keeping {
            Keeping::Kept => Ok(()),
            Keeping::NotKept => session.before_scripts(NOT_KEPT).await,
        }
    }

    /// Replaces the test's only user by another one, at another address; also returns the console of the first
    /// user.
    pub(crate) async fn next_in_browser(self: &Arc<Self>) -> Result<(Vec<String>, Session)> {
        let last = self.visitors().pop();
        let (Some((session, lent)), true) = (last, self.visitors().is_empty()) else {
            bail!("there is not one visitor alone")
        };
        let said = session.complaints().await?;
        let address = match &lent {
            Some(lent) => {
                lent.clear().await?;
                lent.open().await?;
                pool::fresh(&self.page)
            }
            // Another port is another origin, and these browsers do not resolve names of visitors.
            None => {
                let server = Program::server(&web()?)?;
                let address = server.address.clone();
                self.servers.lock().unwrap_or_else(PoisonError::into_inner).push(server);
                address
            }
        };
        let session = Session::new(session.client, self, address);
        self.visitors().push((session.clone(), lent));
        self.prepare(&session).await?;
        Ok((said, session))
    }

    /// The output of the driver and its browsers so far.
    pub(crate) fn heard(&self) -> Vec<String> {
        self.driver.as_ref().map(Program::heard).unwrap_or_default()
    }

    fn visitors(&self) -> MutexGuard<'_, Vec<(Session, Option<Lent>)>> {
        self.visitors.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads every user's console and releases the browsers; returns `outcome` with the errors of the consoles.
    pub(crate) async fn end_visits(&self, mut outcome: Result<()>) -> Result<()> {
        let visitors = std::mem::take(&mut *self.visitors());
        for (session, lent) in visitors {
            if outcome.is_err() {
                session.failed().await;
            }
            let complaints = timeout(END_LIMIT, session.complaints()).await;
            let complaints = complaints.context("the console was not read in time").flatten();
            let silent = complaints.as_ref().is_ok_and(Vec::is_empty);
            // The browser must end in any case; after a failure no other test may get it.
            let ended = match lent {
                Some(lent) if outcome.is_ok() && silent => timeout(END_LIMIT, lent.give_back()).await,
                Some(lent) => timeout(END_LIMIT, lent.end()).await,
                None => timeout(END_LIMIT, session.end()).await,
            };
            outcome = match (outcome, complaints) {
                (Ok(()), Ok(lines)) if lines.is_empty() => ended.context("the visit did not end").flatten(),
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
