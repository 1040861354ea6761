//! The recordings in `core/capture/recordings`, made again: a test of `cli` builds the programs in `firmware/avr` and runs
//! them in simavr.

use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::{apt, run, toolchain};

/// The packages in Debian, the programs of them that the test calls, and headers that these read.
const PACKAGES: [&str; 5] = ["gcc-avr", "avr-libc", "simavr", "libsimavr-dev", "sigrok-cli"];
const PROGRAMS: [&str; 3] = ["avr-gcc", "simavr", "sigrok-cli"];
const HEADER: &str = "simavr/avr/avr_mcu_section.h";
const INCLUDES: [&str; 2] = ["/usr/include", "/usr/local/include"];

/// Installs what is missing and runs the test.
pub(crate) async fn test() -> Result<()> {
    if found().is_err() {
        apt::install(&PACKAGES).await.with_context(remedy)?;
        found().with_context(remedy)?;
    }
    let mut command = toolchain::cargo();
    // The whole workspace, so that its packages keep the features, and with them the builds, of the native step.
    let line =
        ["test", "--workspace", "--features", "stepscope-cli/avr", "--test", "avr_recordings", "--locked"];
    command.args(line);
    run::to_end(command, run::LIMIT).await
}

fn found() -> Result<()> {
    for program in PROGRAMS {
        which::which(program).with_context(|| program)?;
    }
    if !INCLUDES.iter().any(|folder| Path::new(folder).join(HEADER).exists()) {
        bail!("no {HEADER} in {}", INCLUDES.join(", "));
    }
    Ok(())
}

fn remedy() -> String {
    format!(
        "the recordings' test needs {} on PATH, avr-libc, and simavr's headers: install them (Debian: `apt-get install {}` as root)",
        PROGRAMS.join(", "),
        PACKAGES.join(" ")
    )
}
