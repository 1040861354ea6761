//! A value change dump read by other people's programs: GTKWave's and sigrok's, which a test of `cli` calls.

use anyhow::{Context, Result};

use crate::{apt, run, toolchain};

/// The packages in Debian, and the programs of them that the test calls.
const PACKAGES: [&str; 2] = ["gtkwave", "sigrok-cli"];
const PROGRAMS: [&str; 3] = ["vcd2fst", "fst2vcd", "sigrok-cli"];

/// Installs the programs if one is missing and runs the test.
pub(crate) async fn test() -> Result<()> {
    let found = || PROGRAMS.iter().try_for_each(|program| which::which(program).map(drop));
    if found().is_err() {
        apt::install(&PACKAGES).await.with_context(remedy)?;
        found().with_context(remedy)?;
    }
    let mut command = toolchain::cargo();
    // The whole workspace, so that its packages keep the features, and with them the builds, of the native step.
    let line = [
        "test",
        "--workspace",
        "--features",
        "stepscope-cli/dump-readers",
        "--test",
        "second_reader",
        "--locked",
    ];
    command.args(line);
    run::to_end(command, run::LIMIT).await
}

fn remedy() -> String {
    format!(
        "the dump's test needs {} on PATH: install them (Debian: `apt-get install {}` as root)",
        PROGRAMS.join(", "),
        PACKAGES.join(" ")
    )
}
