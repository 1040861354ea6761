//! `cargo xtask bench`: the benchmarks, native code first.

use anyhow::Result;

use crate::{run, toolchain};

/// Runs every benchmark there is. One of the wasm build belongs after the native one.
pub(crate) async fn run() -> Result<()> {
    native().await
}

/// The criterion benchmarks of the core, as native code.
async fn native() -> Result<()> {
    let mut command = toolchain::cargo();
    command.args(["bench", "--package", "stepscope-tests", "--locked"]);
    run::to_end(command, run::LIMIT).await
}
