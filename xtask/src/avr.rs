//! Builds the programs in `firmware/avr` and runs them in simavr: they make the recordings in
//! `core/capture/recordings` again and answer `stepscope send`. The tests are in `cli`.

use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::{apt, judges, run, toolchain};

const PACKAGES: [&str; 6] = ["gcc-avr", "avr-libc", "simavr", "libsimavr-dev", "sigrok-cli", "gcc"];
const PROGRAMS: [&str; 4] = ["avr-gcc", "simavr", "sigrok-cli", "cc"];
const HEADERS: [&str; 2] = ["simavr/avr/avr_mcu_section.h", "simavr/sim_avr.h"];
const INCLUDES: [&str; 2] = ["/usr/include", "/usr/local/include"];

pub(crate) async fn test() -> Result<()> {
    if found().is_err() {
        apt::install(&PACKAGES).await.with_context(remedy)?;
        found().with_context(remedy)?;
    }
    let mut command = toolchain::ignored_tests(&["avr_recordings", "avr_live"]);
    command.env("STEPSCOPE_PYTHON", judges::python().await?);
    run::cargo_test(command).await
}

fn found() -> Result<()> {
    for program in PROGRAMS {
        which::which(program).with_context(|| program)?;
    }
    for header in HEADERS {
        if !INCLUDES.iter().any(|folder| Path::new(folder).join(header).exists()) {
            bail!("no {header} in {}", INCLUDES.join(", "));
        }
    }
    Ok(())
}

fn remedy() -> String {
    format!(
        "the tests of firmware need {} on PATH, avr-libc, and simavr's headers: install them (Debian: `apt-get install {}` as root)",
        PROGRAMS.join(", "),
        PACKAGES.join(" ")
    )
}
