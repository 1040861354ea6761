//! Links that were published open for ever: `tests/links/v<version>.txt` holds, one a line, a link
//! of each format that was ever written and the scenario that it means, in canonical JSON.
//!
//! Lines are only ever added. A new version gets a new file; the old ones then test its upgraders.

use std::{fmt::Write as _, fs, path::PathBuf};
use stepscope_core::scenario::{
    Compact, Scenario,
    link::{decode, encode},
    presets::PRESETS,
};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("links")
}

#[test]
fn every_link_that_was_ever_published_opens_as_the_scenario_that_it_meant() {
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

/// The link of a scenario is part of what was published: two people who share the same experiment
/// get the same text.
#[test]
fn the_current_versions_links_are_still_written_as_they_were() {
    let file = folder().join("v1.txt");
    for line in fs::read_to_string(file).expect("version 1's links").lines() {
        let (link, json) = line.split_once(' ').expect("a link, a space, its scenario");
        let scenario = Scenario::from_json(json).expect("reads");
        assert_eq!(encode(&scenario).as_deref(), Ok(link));
        assert_eq!(scenario.compact().to_string(), json, "canonical");
    }
}

/// Prints the lines of today's presets, to add them to the file of their version:
/// `STEPSCOPE_BLESS=1 cargo test -p stepscope-tests --test links -- --nocapture`.
#[test]
fn lines_for_the_presets_can_be_printed() {
    let mut lines = String::new();
    for scenario in PRESETS.iter().map(|preset| preset.scenario()).chain([Scenario::default()]) {
        let link = encode(&scenario).expect("a preset fits in a link");
        let _ = writeln!(lines, "{link} {}", scenario.compact());
    }
    assert_eq!(lines.lines().count(), PRESETS.len() + 1);
    if std::env::var_os("STEPSCOPE_BLESS").is_some() {
        print!("{lines}");
    }
}
