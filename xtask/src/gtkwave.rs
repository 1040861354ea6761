//! A value change dump read by a second program: GTKWave's, which the test of `cli` calls.

use anyhow::{Context, Result};

use crate::{apt, run, toolchain};

/// The package in Debian, and the programs of it that the test calls.
const PACKAGE: &str = "gtkwave";
const PROGRAMS: [&str; 2] = ["vcd2fst", "fst2vcd"];

/// Installs GTKWave if it is missing and runs the test.
pub(crate) async fn test() -> Result<()> {
    let found = || PROGRAMS.iter().try_for_each(|program| which::which(program).map(drop));
    if found().is_err() {
        apt::install(&[PACKAGE]).await.with_context(remedy)?;
        found().with_context(remedy)?;
    }
    let mut command = toolchain::cargo();
    // The whole workspace, so that its packages keep the features, and with them the builds, of the native step.
    let line =
        ["test", "--workspace", "--features", "stepscope-cli/gtkwave", "--test", "second_reader", "--locked"];
    command.args(line);
    run::to_end(command, run::LIMIT).await
}

fn remedy() -> String {
    let programs = PROGRAMS.join(" and ");
    format!(
        "the dump's test needs GTKWave's {programs} on PATH: install it (Debian: `apt-get install {PACKAGE}` as root)"
    )
}
