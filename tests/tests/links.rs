//! Published links open forever. `tests/links/v<version>.txt` has one line per link: a link of each format that was
//! ever written, and its scenario in canonical JSON. If a link has its sender's digests, the run is still the same,
//! except for those of [`OTHER_RUNS`].
//!
//! Lines are only added. A new version gets a new file; the old files then test its upgrades.

use std::{collections::BTreeSet, fmt::Write as _, fs, path::PathBuf};
use stepscope_core::{
    inspect::trace::{
        fingerprint::{FingerprintCheck, FingerprintMatch, Fingerprinter},
        run_fingerprint::RunFingerprint,
    },
    scenario::{
        Compact, Scenario, VERSION,
        link::{decode, encode, part, with_part},
        presets::PRESETS,
    },
    sim::Experiment,
};

/// Published links whose run has changed, because the framed host's policy changed, identified by the CRC of their
/// digests: each still opens as its scenario, and `--verify` reports where the runs differ. Only a decision in
/// docs/decisions.md may add a line.
const OTHER_RUNS: &[(&str, &str)] = &[
    ("82bd8736", "a framed link: the host requests positions at the start and the end"),
    ("02482e43", "a framed link on a noisy line: as above"),
    ("72a08697", "four controllers on one framed line: as above"),
];

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("links")
}

#[test]
fn every_published_link_opens_as_its_scenario() {
    let mut links = 0;
    for entry in fs::read_dir(folder()).expect("the folder of links") {
        let path = entry.expect("an entry").path();
        for line in fs::read_to_string(&path).expect("a text file").lines() {
            let (link, json) = line.split_once(' ').expect("a link, a space, its scenario");
            let meant = Scenario::from_json(json).unwrap_or_else(|p| panic!("{}: {p:?}", path.display()));
            assert_eq!(decode(link).as_ref(), Ok(&meant), "{}: {link}", path.display());
            links += 1;
        }
    }
    assert!(links >= PRESETS.len(), "only {links} links");
}

/// The text of a scenario's link is part of the published format: two people who share the same experiment
/// get the same text.
#[test]
fn links_of_the_current_version_are_written_unchanged() {
    let file = folder().join(format!("v{VERSION}.txt"));
    for line in fs::read_to_string(file).expect("this version's links").lines() {
        let (link, json) = line.split_once(' ').expect("a link, a space, its scenario");
        let scenario = Scenario::from_json(json).expect("reads");
        let (link, _) = link.split_once('&').unwrap_or((link, ""));
        assert_eq!(encode(&scenario).as_deref(), Ok(link));
        assert_eq!(scenario.compact().to_string(), json, "canonical");
    }
}

#[test]
fn published_fingerprints_match_and_other_runs_are_reported() {
    let (mut proofs, mut others) = (0, BTreeSet::new());
    let versions = (1..=VERSION).map(|version| folder().join(format!("v{version}.txt")));
    let texts: String = versions.map(|path| fs::read_to_string(path).expect("a version's links")).collect();
    for line in texts.lines() {
        let link = line.split(' ').next().unwrap_or_default();
        let Some(text) = part(link, "d") else { continue };
        let mut proof = RunFingerprint::parse(&text).unwrap_or_else(|error| panic!("{link}: {error}"));
        let experiment = Experiment::new(&decode(link).expect("opens")).expect("a good scenario");
        let same = |proof: &RunFingerprint| {
            assert_eq!(proof.controllers.len(), experiment.controllers());
            let mut comparisons: Vec<_> = proof.controllers.iter().map(FingerprintCheck::with).collect();
            experiment.run_each(&mut comparisons);
            comparisons.into_iter().all(|each| matches!(each.finish(), FingerprintMatch::Same(_)))
        };
        let check = text.rsplit('.').next().unwrap_or_default();
        let changed = OTHER_RUNS.iter().find(|(known, _)| *known == check);
        others.extend(changed.map(|_| check.to_owned()));
        assert_eq!(same(&proof), changed.is_none(), "{check} {changed:?}: {link}");
        if let Some(last) = proof.controllers.last_mut() {
            last.digest ^= 1;
        }
        assert!(!same(&proof), "{link}");
        proofs += 1;
    }
    assert!(proofs >= 4, "only {proofs} links with digests");
    assert_eq!(others.len(), OTHER_RUNS.len(), "one is no published link's: {others:?}");
}

/// Prints the lines of the current presets, to add them to the file of their version:
/// `STEPSCOPE_BLESS=1 cargo test -p stepscope-tests links:: -- --nocapture`.
#[test]
fn prints_links_of_the_presets_on_request() {
    let mut lines = String::new();
    for scenario in PRESETS.iter().map(|preset| preset.scenario()).chain([Scenario::default()]) {
        let link = encode(&scenario).expect("a preset fits in a link");
        let _ = writeln!(lines, "{link} {}", scenario.compact());
        let experiment = Experiment::new(&scenario).expect("a good scenario");
        let mut fingerprints = vec![Fingerprinter::default(); experiment.controllers()];
        experiment.run_each(&mut fingerprints);
        let proof = RunFingerprint::of(fingerprints.into_iter().map(Fingerprinter::finish).collect());
        let _ = writeln!(lines, "{} {}", with_part(link, "d", &proof.emit()), scenario.compact());
    }
    assert_eq!(lines.lines().count(), 2 * (PRESETS.len() + 1));
    if std::env::var_os("STEPSCOPE_BLESS").is_some() {
        print!("{lines}");
    }
}
