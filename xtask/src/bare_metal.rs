//! Runs the golden cases (`tests/cortex-m3`) in QEMU.

use anyhow::Result;
use tokio::process::Command;

use crate::toolchain::{self, BARE_METAL};
use crate::{apt, run};

pub(crate) const PACKAGE: &str = "stepscope-cortex-m3";

/// The emulator that `.cargo/config.toml` names.
const QEMU: &str = "qemu-system-arm";
const DEBIAN_PACKAGE: &str = QEMU;

pub(crate) async fn test() -> Result<()> {
    toolchain::target(BARE_METAL).await?;
    apt::require("the microcontroller's test", &[QEMU], &[DEBIAN_PACKAGE]).await?;
    run::compile(cargo("build")).await?;
    run::to_end(cargo("run")).await
}

fn cargo(what: &str) -> Command {
    let mut command = toolchain::cargo();
    command.args([what, "--release", "--locked", "--package", PACKAGE, "--target", BARE_METAL]);
    command
}
