//! Finds Chromium and its driver, for the tests that need a browser.

use std::env;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::apt;
use crate::output_buffer::print_line;
use crate::tools::version_output;

pub(crate) struct Browser {
    pub(crate) chromium: PathBuf,
    pub(crate) chromedriver: PathBuf,
}

/// Environment variables with paths of the programs, if they are not on PATH; the tests read them, too.
pub(crate) const CHROMIUM: &str = "STEPSCOPE_CHROMIUM";
pub(crate) const CHROMEDRIVER: &str = "STEPSCOPE_CHROMEDRIVER";

impl Browser {
    /// Finds both, or installs them.
    pub(crate) async fn ready() -> Result<Self> {
        if let Some(found) = Self::find() {
            return Ok(found);
        }
        apt::install(&["chromium", "chromium-driver"]).await.with_context(remedy)?;
        Self::find().with_context(remedy)
    }

    /// Chrome's headless shell in the driver's version: it loads the page in two thirds of the time. Falls back to
    /// Chromium itself if the shell is not available or another browser was requested.
    pub(crate) async fn headless(&self) -> PathBuf {
        if env::var_os(CHROMIUM).is_some() {
            return self.chromium.clone();
        }
        let find = || on_path(&["chromium-headless-shell", "chrome-headless-shell"]);
        if find().is_none()
            && self.chromium.ends_with("chromium")
            && let Err(why) = apt::install(&["chromium-headless-shell"]).await
        {
            print_line(format_args!("without Chromium's headless shell the tests take longer: {why:#}"));
        }
        match find() {
            Some(shell) if have_same_version(&shell, &self.chromedriver).await => shell,
            _ => self.chromium.clone(),
        }
    }

    fn find() -> Option<Self> {
        let named = |variable| env::var_os(variable).map(PathBuf::from);
        let chromium = named(CHROMIUM).or_else(|| {
            on_path(&["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"])
        })?;
        let chromedriver = named(CHROMEDRIVER).or_else(|| on_path(&["chromedriver"]))?;
        Some(Self { chromium, chromedriver })
    }
}

/// Compares major versions, as in `Chromium 156.0.8078.79`.
async fn have_same_version(shell: &Path, driver: &Path) -> bool {
    let major = async |program: &Path| {
        let output = version_output(program).await?;
        let mut numbers = output.split_whitespace().filter_map(|word| word.split_once('.'));
        numbers.find_map(|(major, _)| major.parse::<u32>().ok())
    };
    match (major(shell).await, major(driver).await) {
        (Some(shell), Some(driver)) => shell == driver,
        _ => false,
    }
}

fn on_path(names: &[&str]) -> Option<PathBuf> {
    names.iter().find_map(|name| which::which(name).ok())
}

fn remedy() -> String {
    format!(
        "the browser tests need Chromium (or Chrome) and the chromedriver of the same version: install both \
         (Debian: `apt-get install chromium chromium-driver` as root) so that they are on PATH, or set \
         {CHROMIUM} and {CHROMEDRIVER}"
    )
}
