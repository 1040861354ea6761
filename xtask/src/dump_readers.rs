//! Exchanges files with GTKWave's and sigrok's programs: a test of `cli` makes them read its value change dumps, a test of
//! `core/capture` reads theirs.

use anyhow::Result;

use crate::{apt, run, toolchain};

pub(crate) async fn test() -> Result<()> {
    let programs = ["vcd2fst", "fst2vcd", "sigrok-cli"];
    apt::require("the test of value change dumps", &programs, &["gtkwave", "sigrok-cli"]).await?;
    run::cargo_test(toolchain::ignored_tests(&["second_reader", "others_files"])).await
}
