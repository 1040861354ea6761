//! Files between Stepscope and other people's programs, GTKWave's and sigrok's: a test of `cli` has them read its value
//! change dumps, a test of `core/capture` reads what they write.

use anyhow::{Context, Result};

use crate::{apt, run, toolchain};

/// The packages in Debian, and the programs of them that the tests call.
const PACKAGES: [&str; 2] = ["gtkwave", "sigrok-cli"];
const PROGRAMS: [&str; 3] = ["vcd2fst", "fst2vcd", "sigrok-cli"];

/// Installs the programs if one is missing and runs the tests.
pub(crate) async fn test() -> Result<()> {
    let found = || PROGRAMS.iter().try_for_each(|program| which::which(program).map(drop));
    if found().is_err() {
        apt::install(&PACKAGES).await.with_context(remedy)?;
        found().with_context(remedy)?;
    }
    run::to_end(toolchain::ignored_tests(&["second_reader", "others_files"])).await
}

fn remedy() -> String {
    format!(
        "the dumps' tests need {} on PATH: install them (Debian: `apt-get install {}` as root)",
        PROGRAMS.join(", "),
        PACKAGES.join(" ")
    )
}
