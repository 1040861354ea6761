//! Finds Firefox and WebKit with their drivers, and a display for WebKit, which has no headless mode.

use std::env;
use std::path::PathBuf;
use std::process::Stdio;

use anyhow::{Context, Result};
use tokio::process::Command;

use crate::{apt, run, tools};

/// Environment variables with paths of the programs, if they are not on PATH; the tests read them, too.
pub(crate) const FIREFOX: &str = "STEPSCOPE_FIREFOX";
pub(crate) const GECKODRIVER: &str = "STEPSCOPE_GECKODRIVER";
pub(crate) const WEBKITDRIVER: &str = "STEPSCOPE_WEBKITDRIVER";

pub(crate) struct Firefox {
    pub(crate) firefox: PathBuf,
    pub(crate) geckodriver: PathBuf,
}

impl Firefox {
    pub(crate) async fn ready() -> Result<Self> {
        let firefox = program(FIREFOX, &["firefox", "firefox-esr"], "firefox-esr").await.with_context(|| {
            format!(
                "tests in Firefox need it on PATH: install it (Debian: `apt-get install firefox-esr` as root), or set \
                 {FIREFOX}"
            )
        })?;
        let geckodriver = match env::var_os(GECKODRIVER) {
            Some(named) => named.into(),
            None => tools::geckodriver().await.with_context(|| {
                format!("tests in Firefox need geckodriver on PATH: install it, or set {GECKODRIVER}")
            })?,
        };
        Ok(Self { firefox, geckodriver })
    }
}

/// WebKit's driver starts the browser itself. The display lives as long as this value.
pub(crate) struct WebKit {
    pub(crate) driver: PathBuf,
    pub(crate) display: String,
    _server: run::Group,
}

impl WebKit {
    pub(crate) async fn ready() -> Result<Self> {
        let driver = program(WEBKITDRIVER, &["WebKitWebDriver"], "webkit2gtk-driver").await.with_context(|| {
            format!(
                "tests in WebKit need WebKitGTK's MiniBrowser, and WebKitWebDriver on PATH: install both (Debian: `apt-get \
                 install webkit2gtk-driver` as root), or set {WEBKITDRIVER}"
            )
        })?;
        let server = program("STEPSCOPE_XVFB", &["Xvfb"], "xvfb").await.context(
            "tests in WebKit need a virtual display: install Xvfb (Debian: `apt-get install xvfb` as root) so that it \
             is on PATH",
        )?;
        let mut command = Command::new(server);
        // Xvfb selects a free display number and prints it.
        command.args(["-displayfd", "1", "-screen", "0", "1600x1200x24", "-nolisten", "tcp"]);
        command.stdout(Stdio::piped()).stderr(Stdio::null());
        let mut server = run::start(command)?;
        let number = server.first_line().await.context("Xvfb did not report its display")?;
        Ok(Self { driver, display: format!(":{number}"), _server: server })
    }
}

async fn program(variable: &str, names: &[&str], package: &str) -> Result<PathBuf> {
    let on_path = || names.iter().find_map(|name| which::which(name).ok());
    if let Some(found) = env::var_os(variable).map(PathBuf::from).or_else(on_path) {
        return Ok(found);
    }
    apt::install(&[package]).await?;
    on_path().with_context(|| format!("{package} was installed, but has no {}", names.join(" and no ")))
}
