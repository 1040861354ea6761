//! Tests the live commands with Python's packages for serial ports, COBS and CRC-32C, and with socat, in `cli`.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use tokio::process::Command;

use crate::output_buffer::print_line;
use crate::tools::cache;
use crate::{apt, run, toolchain};

const PACKAGES: [&str; 3] = ["pyserial==3.5", "cobs==1.2.2", "google-crc32c==1.9.0"];
/// Change the number when these versions change.
const HOME: &str = "live-judges-1";
const PROBE: &str = "import serial, cobs.cobs, google_crc32c";

pub(crate) async fn test() -> Result<()> {
    let python = python().await?;
    socat().await?;
    let mut command = toolchain::ignored_tests(&["live_judges"]);
    command.env("STEPSCOPE_PYTHON", python);
    run::cargo_test(command).await
}

pub(crate) async fn socat() -> Result<()> {
    apt::require("the test of live commands", &["socat"], &["socat"]).await
}

pub(crate) async fn python() -> Result<PathBuf> {
    let home = cache()?.join("tools").join(HOME);
    let python = home.join("bin").join("python");
    if python.exists() && has_packages(&python).await {
        return Ok(python);
    }
    print_line(format_args!("installing {} (once)", PACKAGES.join(" and ")));
    let remedy = "the live commands' tests need Python 3.9 or newer with venv and pip (Debian: `apt-get install python3-venv` as root)";
    let mut command = Command::new(which::which("python3").context(remedy)?);
    command.args(["-m", "venv", "--clear"]).arg(&home);
    run::to_end(command).await.context(remedy)?;
    let mut command = Command::new(&python);
    command.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(PACKAGES);
    run::to_end(command).await.context(remedy)?;
    Ok(python)
}

async fn has_packages(python: &Path) -> bool {
    let mut command = Command::new(python);
    command.args(["-c", PROBE]);
    run::output(command).await.is_some()
}
