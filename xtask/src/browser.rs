//! Chromium and its driver, for the tests that need a real browser.

use std::env;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::apt;
use crate::aside::say;
use crate::tools::version_answer;

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

    /// The same engine without windows, menus and what they cost, of the driver's version: a load of the page takes a third
    /// less. It is installed beside Debian's own Chromium. Chromium itself where it cannot be had, or another was asked for.
    pub(crate) async fn headless(&self) -> PathBuf {
        if env::var_os(CHROMIUM).is_some() {
            return self.chromium.clone();
        }
        let find = || on_path(&["chromium-headless-shell", "chrome-headless-shell"]);
        if find().is_none()
            && self.chromium.ends_with("chromium")
            && let Err(why) = apt::install(&["chromium-headless-shell"]).await
        {
            say(format_args!("without Chromium's headless shell the tests take longer: {why:#}"));
        }
        match find() {
            Some(shell) if fits(&shell, &self.chromedriver).await => shell,
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

/// Whether two programs say the same number before the first dot of their versions: `Chromium 156.0.8078.79`.
async fn fits(shell: &Path, driver: &Path) -> bool {
    let major = async |program: &Path| {
        let answer = version_answer(program).await?;
        let mut numbers = answer.split_whitespace().filter_map(|word| word.split_once('.'));
        numbers.find_map(|(major, _)| major.parse::<u32>().ok())
    };
    match (major(shell).await, major(driver).await) {
        (Some(shell), Some(driver)) => shell == driver,
        _ => false,
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
