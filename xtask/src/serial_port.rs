//! A port of the system for the page's tests: a pseudo-terminal in the place of `/dev/ttyS0`, in a mount namespace of Chromium's
//! own (LIVE H6). Not every machine can have that; what it lacks is printed.

use std::path::{Path, PathBuf};
use std::{env, fs};

use anyhow::{Context, Result, ensure};
use tokio::process::Command;

use crate::{apt, run, toolchain};

/// Names the command `stepscope` for the tests.
pub(crate) const COMMAND: &str = "STEPSCOPE_COMMAND";
/// The port, of which Chromium takes none whose driver is of another type.
const PORT: &str = "/dev/ttyS0";
const DRIVERS: &str = "/proc/tty/drivers";
/// Where Chromium looks for policies; in its namespace an own one lies there.
const POLICIES: &str = "/etc/chromium";
/// What the test mounts, with nothing behind it.
const TRIAL: &str = "mount --bind /dev/null /dev/ttyS0 && mount -t tmpfs none /etc/chromium";

/// Tries, where Chromium is installed, what its namespace needs; the error is why this machine cannot have the port.
pub(crate) async fn possible() -> Result<()> {
    let drivers = fs::read_to_string(DRIVERS).with_context(|| format!("{DRIVERS} can't be read"))?;
    ensure!(has_serial_ports(&drivers), "{DRIVERS} has no driver of serial ports /dev/ttyS");
    ensure!(Path::new(PORT).exists(), "there is no {PORT}");
    ensure!(Path::new(POLICIES).is_dir(), "there is no {POLICIES}, where Chromium would find a policy");
    ensure!(apt::is_root(), "only root mounts");
    which::which("unshare").context("unshare (of util-linux) is not on PATH")?;
    let mut trial = Command::new("unshare");
    trial.args(["--mount", "--propagation", "private", "sh", "-c", TRIAL]);
    run::output(trial).await.context("nothing can be mounted in a namespace of its own")?;
    Ok(())
}

/// Whether the kernel's list of drivers has the serial ones of `/dev/ttyS0`: `serial /dev/ttyS 4 64 serial`.
fn has_serial_ports(drivers: &str) -> bool {
    drivers.lines().any(|line| {
        let words: Vec<_> = line.split_whitespace().collect();
        words.get(1) == Some(&"/dev/ttyS") && words.last() == Some(&"serial")
    })
}

/// Builds the command, and says where it lies: beside this program.
pub(crate) async fn command() -> Result<PathBuf> {
    let mut build = toolchain::cargo();
    build.args(["build", "--workspace", "--bin", "stepscope", "--locked"]);
    run::to_end(build).await?;
    let this = crate::THIS_PROGRAM.as_ref().context("this program's own path is unknown")?;
    let command = this.with_file_name(format!("stepscope{}", env::consts::EXE_SUFFIX));
    ensure!(command.exists(), "cargo built no {}", command.display());
    Ok(command)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_has_serial_ports_where_the_kernel_lists_their_driver() {
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
