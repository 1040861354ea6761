//! Installs Debian packages that no Rust registry has: browsers, an emulator and a waveform viewer.

use anyhow::{Context, Result, bail};
use tokio::process::Command;
use tokio::sync::Mutex;

use crate::aside::say;
use crate::run;

/// apt allows one installation at a time, and two steps may need one at once.
static ONE_AT_A_TIME: Mutex<()> = Mutex::const_new(());

/// Installs `packages` if that needs no password and no question.
pub(crate) async fn install(packages: &[&str]) -> Result<()> {
    let names = packages.join(" and ");
    let apt = match which::which("apt-get") {
        Ok(apt) if is_root() => apt,
        _ => bail!("{names} can be installed from here only by root and with apt-get"),
    };
    let _turn = ONE_AT_A_TIME.lock().await;
    say(format_args!("installing {names}"));
    let apt = |arguments: &[&str]| {
        let mut command = Command::new(&apt);
        command.args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
        run::to_end(command)
    };
    apt(&["update"]).await?;
    apt(&[&["install", "-y", "--no-install-recommends"], packages].concat()).await
}

/// Makes sure that `what` finds its programs on PATH; installs the packages if one is missing.
pub(crate) async fn require(what: &str, programs: &[&str], packages: &[&str]) -> Result<()> {
    let remedy = || {
        let (programs, packages) = (programs.join(", "), packages.join(" "));
        format!("{what} needs {programs} on PATH: install it (Debian: `apt-get install {packages}` as root)")
    };
    let found = || programs.iter().try_for_each(|program| which::which(program).map(drop));
    if found().is_err() {
        install(packages).await.with_context(remedy)?;
    }
    found().with_context(remedy)
}

#[cfg(unix)]
pub(crate) fn is_root() -> bool {
    rustix::process::geteuid().is_root()
}

#[cfg(not(unix))]
pub(crate) fn is_root() -> bool {
    false
}
