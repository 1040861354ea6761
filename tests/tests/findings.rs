//! Regression tests of fuzzing: every input of `tests/findings/` passes the check that it once violated. So do the seeds and
//! some random inputs, so that a broken check is detected without fuzzing.

use proptest::prelude::*;
use std::{fs, panic::catch_unwind, path::Path};
use stepscope_tests::effort;
use stepscope_tests::fuzzing::{TARGETS, Target};

/// All inputs that fail the target's check: name and description.
fn broken(target: &Target, inputs: impl IntoIterator<Item = (String, Vec<u8>)>) -> Vec<String> {
    let breaks = |(name, bytes): (String, Vec<u8>)| {
        let broken = catch_unwind(|| (target.check)(&bytes)).is_err();
        broken.then(|| format!("{name}: {}", (target.told)(&bytes)))
    };
    inputs.into_iter().filter_map(breaks).collect()
}

#[test]
fn earlier_findings_pass_their_checks() {
    for target in TARGETS {
        let findings = target.findings().expect("the findings can be read");
        assert_eq!(broken(target, findings), [""; 0], "in tests/findings/{}", target.name);
    }
}

#[test]
fn every_target_has_seeds_and_they_pass() {
    for target in TARGETS {
        let seeds = (target.seeds)();
        assert!(seeds.len() > 5, "{} has {} seeds", target.name, seeds.len());
        let named = seeds.into_iter().enumerate().map(|(index, bytes)| (index.to_string(), bytes));
        assert_eq!(broken(target, named), [""; 0], "seeds of {}", target.name);
        let words = (target.words)();
        assert_eq!(
            ["scenario", "link"].contains(&target.name),
            words.contains("\"channels\""),
            "{}",
            target.name
        );
        assert_eq!(target.name == "capture", words.contains("$timescale"), "{}", target.name);
        // libFuzzer accepts words of up to 64 bytes.
        assert!(words.iter().all(|word| (1..=64).contains(&word.len())), "{words:?}");
    }
}

/// libFuzzer runs exactly the targets of the table above.
#[test]
fn each_target_has_its_own_binary() {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz");
    let manifest = fs::read_to_string(fuzz.join("Cargo.toml")).expect("fuzz/Cargo.toml");
    let names = manifest
        .lines()
        .skip_while(|line| *line != "[[bin]]")
        .filter_map(|line| line.strip_prefix("name = ").map(|name| name.trim_matches('"').to_owned()));
    let names: Vec<String> = names.collect();
    assert_eq!(names, TARGETS.iter().map(|target| target.name).collect::<Vec<_>>());
    for name in names {
        let source = fs::read_to_string(fuzz.join(format!("fuzz_targets/{name}.rs"))).expect("its source");
        assert!(source.contains(&format!("fuzzing::{name}::check(data)")), "{name}: {source}");
    }
}

/// The seed with some changed bytes, as in libFuzzer's first steps.
fn inputs() -> impl Strategy<Value = (usize, Vec<u8>)> {
    let all: Vec<(usize, Vec<u8>)> = (0..TARGETS.len())
        .flat_map(|target| (TARGETS[target].seeds)().into_iter().map(move |seed| (target, seed)))
        .collect();
    let changes = prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8);
    let near = (prop::sample::select(all), changes).prop_map(|((target, mut bytes), changes)| {
        for (index, byte) in changes {
            let at = index.index(bytes.len());
            bytes[at] = byte;
        }
        (target, bytes)
    });
    prop_oneof![3 => near, 1 => (0..TARGETS.len(), prop::collection::vec(any::<u8>(), 0..600))]
}

proptest! {
    #![proptest_config(effort::cases(1_000))]

    #[test]
    fn random_inputs_pass_every_check((target, bytes) in inputs()) {
        (TARGETS[target].check)(&bytes);
    }
}
