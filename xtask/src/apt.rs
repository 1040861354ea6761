//! Installs Debian packages that no Rust registry has: browsers, an emulator and a waveform viewer.

use anyhow::{Context, Result, bail};
use tokio::process::Command;
use tokio::sync::Mutex;

use crate::output_buffer::print_line;
use crate::run;

/// apt allows one installation at a time, but two steps may run in parallel.
static ONE_AT_A_TIME: Mutex<()> = Mutex::const_new(());

/// Installs `packages`. Errors: the process is not root, or there is no apt-get.
pub(crate) async fn install(packages: &[&str]) -> Result<()> {
    let names = packages.join(" and ");
    let apt = match which::which("apt-get") {
        Ok(apt) if is_root() => apt,
        _ => bail!("installing {names} needs apt-get and root"),
    };
    let _turn = ONE_AT_A_TIME.lock().await;
    print_line(format_args!("installing {names}"));
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
        format!(
            "{what} needs {programs} on PATH: install them (Debian: `apt-get install {packages}` as root)"
        )
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
