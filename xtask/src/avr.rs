//! Builds `firmware/avr` and runs it in simavr for tests in `cli`: recordings, and replies to `stepscope send`.

use std::path::Path;

use anyhow::{Result, bail};

use crate::{apt, judges, run, toolchain};

const PROGRAMS: [&str; 5] = ["avr-gcc", "simavr", "sigrok-cli", "cppcheck", "cc"];
const PACKAGES: [&str; 7] =
    ["gcc-avr", "avr-libc", "simavr", "libsimavr-dev", "sigrok-cli", "cppcheck", "gcc"];
const HEADERS: [&str; 2] = ["simavr/avr/avr_mcu_section.h", "simavr/sim_avr.h"];
const INCLUDES: [&str; 2] = ["/usr/include", "/usr/local/include"];

pub(crate) async fn test() -> Result<()> {
    apt::require("the tests of firmware", &PROGRAMS, &PACKAGES).await?;
    if missing_header().is_some() {
        apt::install(&PACKAGES).await?;
    }
    if let Some(header) = missing_header() {
        bail!("the tests of firmware need {header} in {}: install simavr's headers", INCLUDES.join(" or "));
    }
    let mut command = toolchain::ignored_tests(&["avr_recordings", "avr_live"]);
    command.env("STEPSCOPE_PYTHON", judges::python().await?);
    run::cargo_test(command).await
}

fn missing_header() -> Option<&'static str> {
    let is_there = |header: &str| INCLUDES.iter().any(|folder| Path::new(folder).join(header).exists());
    HEADERS.into_iter().find(|header| !is_there(header))
}
