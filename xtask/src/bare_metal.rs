//! The golden cases on a microcontroller: `tests/cortex-m3`, built, and run in QEMU.

use anyhow::{Context, Result};

use crate::toolchain::{self, BARE_METAL};
use crate::{apt, run};

/// The crate of the program.
pub(crate) const PACKAGE: &str = "stepscope-cortex-m3";

/// The emulator, as `.cargo/config.toml` calls it, and its package's name in Debian.
const QEMU: &str = "qemu-system-arm";

/// Builds the program and runs it; an error unless every case gives what it gives everywhere.
pub(crate) async fn test() -> Result<()> {
    toolchain::target(BARE_METAL).await?;
    if which::which(QEMU).is_err() {
        apt::install(&[QEMU]).await.with_context(remedy)?;
        which::which(QEMU).with_context(remedy)?;
    }
    cargo("build").await?;
    cargo("run").await
}

async fn cargo(what: &str) -> Result<()> {
    let mut command = toolchain::cargo();
    command.args([what, "--release", "--locked", "--package", PACKAGE, "--target", BARE_METAL]);
    run::to_end(command).await
}

fn remedy() -> String {
    format!(
        "the microcontroller's test needs QEMU's {QEMU} on PATH: install it (Debian: `apt-get install {QEMU}` as root)"
    )
}
