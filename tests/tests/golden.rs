//! The golden cases, natively: at both speeds of DESIGN A2. `STEPSCOPE_BLESS=1` writes what the core
//! gives into the cases' files; look at the difference before you commit it.
#![cfg(not(target_arch = "wasm32"))]

use std::{env, fs, io, path::Path};
use stepscope_core::scenario::presets::PRESETS;
use stepscope_tests::golden::{CASES, Case, Outcome};

/// Runs up to which a case is also run clock by clock, in cycles.
const MOST_CYCLES_CLOCK_BY_CLOCK: u64 = 2_000_000;

/// A case's outcome at the fast speed and, where it is short, clock by clock.
fn run(case: &Case) -> Result<(Outcome, Option<Outcome>), String> {
    let experiment = case.experiment()?;
    let channels = experiment.config().channels();
    let mut cycles = 0;
    let fast = Outcome::of(
        |sink| {
            let run = experiment.run(sink);
            cycles = run.cycles().0;
            run
        },
        channels,
    );
    let slow = (cycles < MOST_CYCLES_CLOCK_BY_CLOCK)
        .then(|| Outcome::of(|sink| experiment.run_clock_by_clock(sink), channels));
    Ok((fast, slow))
}

fn bless(case: &Case, outcome: &Outcome) -> io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(case.name);
    fs::write(folder.join("digest"), format!("{}\n", outcome.digest))?;
    fs::write(folder.join("status"), &outcome.status)?;
    match outcome.trace_text() {
        Some(text) => fs::write(folder.join("expect.trace"), text),
        None if case.file("expect.trace").is_some() => fs::remove_file(folder.join("expect.trace")),
        None => Ok(()),
    }
}

#[test]
fn every_case_gives_its_trace_at_both_speeds() {
    let blessing = env::var_os("STEPSCOPE_BLESS").is_some();
    let mut failures = Vec::new();
    for case in CASES {
        match run(case) {
            Ok((fast, _)) if blessing => {
                failures.extend(bless(case, &fast).err().map(|error| format!("{}: {error}", case.name)));
            }
            Ok((fast, slow)) => {
                failures.extend(case.compare(&fast).err());
                failures.extend(
                    slow.and_then(|slow| case.compare(&slow).err())
                        .map(|text| format!("clock by clock, {text}")),
                );
            }
            Err(message) => failures.push(message),
        }
    }
    assert!(failures.is_empty(), "{} failed\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn every_case_says_why_and_every_preset_is_one() {
    for case in CASES {
        let known = ["digest", "expect.trace", "preset", "scenario.json", "status", "why"];
        for (name, text) in case.files {
            assert!(known.contains(name) && !text.is_empty(), "{}/{name} is no file of a case", case.name);
        }
        assert!(case.file("why").is_some(), "{}/why is missing", case.name);
    }
    for preset in PRESETS {
        let is_a_case = |case: &&Case| case.file("preset").map(str::trim) == Some(preset.id);
        assert_eq!(
            CASES.iter().filter(is_a_case).count(),
            1,
            "give golden/preset-{}/preset and why, then bless",
            preset.id
        );
    }
}
