//! Provides a serial port for tests of the page: a pseudo-terminal mounted over `/dev/ttyS0` in a mount namespace of
//! Chromium. On machines where this is impossible, it reports what is missing.

use std::path::{Path, PathBuf};
use std::{env, fs};

use anyhow::{Context, Result, ensure};
use tokio::process::Command;

use crate::{apt, run, toolchain};

pub(crate) const COMMAND: &str = "STEPSCOPE_COMMAND";
/// A port with a driver that Chromium accepts.
const PORT: &str = "/dev/ttyS0";
const DRIVERS: &str = "/proc/tty/drivers";
/// Chromium's folder of policies, replaced in the namespace.
const POLICIES: &str = "/etc/chromium";
const TRIAL: &str = "mount --bind /dev/null /dev/ttyS0 && mount -t tmpfs none /etc/chromium";

/// An error that states what is missing, if the tests are impossible here.
pub(crate) async fn possible() -> Result<()> {
    let drivers = fs::read_to_string(DRIVERS).with_context(|| format!("{DRIVERS} can't be read"))?;
    ensure!(has_serial_ports(&drivers), "{DRIVERS} has no driver of serial ports /dev/ttyS");
    ensure!(Path::new(PORT).exists(), "{PORT} does not exist");
    ensure!(Path::new(POLICIES).is_dir(), "{POLICIES}, the folder of Chromium's policies, does not exist");
    ensure!(apt::is_root(), "only root can mount");
    which::which("unshare").context("unshare (of util-linux) is not on PATH")?;
    let mut trial = Command::new("unshare");
    trial.args(["--mount", "--propagation", "private", "sh", "-c", TRIAL]);
    run::output(trial).await.context("mounting in a namespace failed")?;
    Ok(())
}

fn has_serial_ports(drivers: &str) -> bool {
    drivers.lines().any(|line| {
        let words: Vec<_> = line.split_whitespace().collect();
        words.get(1) == Some(&"/dev/ttyS") && words.last() == Some(&"serial")
    })
}

pub(crate) async fn command() -> Result<PathBuf> {
    let mut build = toolchain::cargo();
    build.args(["build", "--workspace", "--bin", "stepscope", "--locked"]);
    run::compile(build).await?;
    let this = crate::THIS_PROGRAM.as_ref().context("this program's own path is unknown")?;
    let command = this.with_file_name(format!("stepscope{}", env::consts::EXE_SUFFIX));
    ensure!(command.exists(), "cargo did not build {}", command.display());
    Ok(command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn serial_ports_are_found_in_the_kernel_list_of_drivers() {
        for (drivers, expected) in [
            ("serial               /dev/ttyS       4      64 serial\n", true),
            ("/dev/tty /dev/tty 5 0 system:/dev/tty\nserial /dev/ttyS 4 64-67 serial\n", true),
            ("pty_slave            /dev/pts      136 0-1048575 pty:slave\n", false),
            ("usbserial            /dev/ttyUSB   188 0-511 serial\n", false),
            ("", false),
        ] {
            assert_eq!(has_serial_ports(drivers), expected, "{drivers}");
        }
    }
}
