//! Tests of `cli` and `core/capture` exchange value change dumps with GTKWave's and sigrok's programs.

use anyhow::Result;

use crate::{apt, run, toolchain};

pub(crate) async fn test() -> Result<()> {
    let programs = ["vcd2fst", "fst2vcd", "sigrok-cli"];
    apt::require("the test of value change dumps", &programs, &["gtkwave", "sigrok-cli"]).await?;
    run::cargo_test(toolchain::ignored_tests(&["second_reader", "others_files"])).await
}
