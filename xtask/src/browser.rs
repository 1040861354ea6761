//! Chromium and its driver, for the tests that need a real browser.

use std::env;
use std::path::PathBuf;

use anyhow::{Context, Result};

use crate::apt;

/// A browser and the driver that goes with it.
pub(crate) struct Browser {
    pub(crate) chromium: PathBuf,
    pub(crate) chromedriver: PathBuf,
}

/// Environment variables that name the two where PATH does not, and by which tests are told of them.
pub(crate) const CHROMIUM: &str = "STEPSCOPE_CHROMIUM";
/// See [`CHROMIUM`].
pub(crate) const CHROMEDRIVER: &str = "STEPSCOPE_CHROMEDRIVER";

impl Browser {
    /// Finds the two; installs them where that is one command and nobody needs to be asked.
    pub(crate) async fn ready() -> Result<Self> {
        if let Some(found) = Self::find() {
            return Ok(found);
        }
        apt::install(&["chromium", "chromium-driver"]).await.with_context(remedy)?;
        Self::find().with_context(remedy)
    }

    fn find() -> Option<Self> {
        let named = |variable| env::var_os(variable).map(PathBuf::from);
        let on_path = |names: &[&str]| names.iter().find_map(|name| which::which(name).ok());
        Some(Self {
            chromium: named(CHROMIUM).or_else(|| {
                on_path(&["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"])
            })?,
            chromedriver: named(CHROMEDRIVER).or_else(|| on_path(&["chromedriver"]))?,
        })
    }
}

fn remedy() -> String {
    format!(
        "the browser tests need Chromium (or Chrome) and the chromedriver of the same version: install both \
         (Debian: `apt-get install chromium chromium-driver` as root) so that they are on PATH, or name them in \
         {CHROMIUM} and {CHROMEDRIVER}"
    )
}
