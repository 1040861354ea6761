//! The golden cases, natively, at both speeds of DESIGN A2. `STEPSCOPE_BLESS=1` writes the results of the core
//! to the cases' files; check the difference before you commit it.

use std::{env, fs, io, path::Path};
use stepscope_core::scenario::presets::{CONTROLLER_PRESETS, PRESETS};
use stepscope_tests::golden::{CASES, Case, Outcome};

fn bless(case: &Case, outcome: &Outcome) -> io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(case.name);
    fs::write(folder.join("digest"), &outcome.digest)?;
    fs::write(folder.join("status"), &outcome.status)?;
    match outcome.trace_text() {
        Some(text) => fs::write(folder.join("expect.trace"), text),
        None if case.file("expect.trace").is_some() => fs::remove_file(folder.join("expect.trace")),
        None => Ok(()),
    }
}

#[test]
fn every_case_has_its_trace_at_both_speeds() {
    let blessing = env::var_os("STEPSCOPE_BLESS").is_some();
    let mut failures = Vec::new();
    for case in CASES {
        let done = if blessing {
            case.run().and_then(|(outcome, _)| {
                bless(case, &outcome).map_err(|error| format!("{}: {error}", case.name))
            })
        } else {
            case.check()
        };
        failures.extend(done.err());
    }
    assert!(failures.is_empty(), "{} failed\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn every_case_states_its_reason_and_every_preset_is_a_case() {
    for case in CASES {
        let known = ["digest", "expect.trace", "preset", "scenario.json", "status", "why"];
        for (name, text) in case.files {
            assert!(known.contains(name) && !text.is_empty(), "{}/{name} is no file of a case", case.name);
        }
        assert!(case.file("why").is_some(), "{}/why is missing", case.name);
    }
    for preset in PRESETS.iter().chain(CONTROLLER_PRESETS) {
        let is_a_case = |case: &&Case| case.file("preset").map(str::trim) == Some(preset.id);
        assert_eq!(
            CASES.iter().filter(is_a_case).count(),
            1,
            "give golden/preset-{}/preset and why, then bless",
            preset.id
        );
    }
}
