//! Exchanges files with GTKWave's and sigrok's programs: a test of `cli` makes them read its value change dumps, a
//! test of `core/capture` reads theirs.

use anyhow::{Context, Result};

use crate::{apt, run, toolchain};

const PACKAGES: [&str; 2] = ["gtkwave", "sigrok-cli"];
const PROGRAMS: [&str; 3] = ["vcd2fst", "fst2vcd", "sigrok-cli"];

pub(crate) async fn test() -> Result<()> {
    let found = || PROGRAMS.iter().try_for_each(|program| which::which(program).map(drop));
    if found().is_err() {
        apt::install(&PACKAGES).await.with_context(remedy)?;
        found().with_context(remedy)?;
    }
    run::cargo_test(toolchain::ignored_tests(&["second_reader", "others_files"])).await
}

fn remedy() -> String {
    format!(
        "the dumps' tests need {} on PATH: install them (Debian: `apt-get install {}` as root)",
        PROGRAMS.join(", "),
        PACKAGES.join(" ")
    )
}
