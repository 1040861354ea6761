//! Chromium and its driver, for the tests that need a real browser.

use std::env;
use std::path::PathBuf;

use anyhow::{Context, Result};

use crate::apt;

/// A browser and the driver that goes with it.
pub(crate) struct Browser {
    pub(crate) chromium: PathBuf,
    pub(crate) chromedriver: PathBuf,
    /// The same engine without windows, menus and what they cost: a load of the page takes a third less. Chromium itself
    /// where there is none.
    pub(crate) headless: PathBuf,
}

/// Environment variables that name the two where PATH does not, and by which tests are told of them.
pub(crate) const CHROMIUM: &str = "STEPSCOPE_CHROMIUM";
/// See [`CHROMIUM`].
pub(crate) const CHROMEDRIVER: &str = "STEPSCOPE_CHROMEDRIVER";

impl Browser {
    /// Finds the two; installs them where that is one command and nobody needs to be asked.
    pub(crate) async fn ready() -> Result<Self> {
        let found = match Self::find() {
            Some(found) => found,
            None => {
                apt::install(&["chromium", "chromium-driver"]).await.with_context(remedy)?;
                Self::find().with_context(remedy)?
            }
        };
        Ok(found.with_headless().await)
    }

    /// Looks for the engine without windows; installs it beside Debian's own Chromium, whose version it has.
    async fn with_headless(self) -> Self {
        if env::var_os(CHROMIUM).is_some() {
            return self;
        }
        let find = || on_path(&["chromium-headless-shell", "chrome-headless-shell"]);
        let mut headless = find();
        if headless.is_none() && self.chromium.ends_with("chromium") {
            // Nothing needs it: without it the tests take longer.
            if let Err(why) = apt::install(&["chromium-headless-shell"]).await {
                println!("{} will do without its headless shell: {why:#}", self.chromium.display());
            }
            headless = find();
        }
        Self { headless: headless.unwrap_or_else(|| self.chromium.clone()), ..self }
    }

    fn find() -> Option<Self> {
        let named = |variable| env::var_os(variable).map(PathBuf::from);
        let chromium = named(CHROMIUM).or_else(|| {
            on_path(&["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"])
        })?;
        let chromedriver = named(CHROMEDRIVER).or_else(|| on_path(&["chromedriver"]))?;
        Some(Self { headless: chromium.clone(), chromium, chromedriver })
    }
}

/// The first of these programs that is on PATH.
fn on_path(names: &[&str]) -> Option<PathBuf> {
    names.iter().find_map(|name| which::which(name).ok())
}

fn remedy() -> String {
    format!(
        "the browser tests need Chromium (or Chrome) and the chromedriver of the same version: install both \
         (Debian: `apt-get install chromium chromium-driver` as root) so that they are on PATH, or name them in \
         {CHROMIUM} and {CHROMEDRIVER}"
    )
}
