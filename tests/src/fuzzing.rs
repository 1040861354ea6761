//! The checks of the fuzz targets, as functions of bytes that panic if a property is violated. `cargo xtask fuzz`
//! runs them with libFuzzer's inputs; `tests/findings.rs` with all earlier findings, the seeds and random inputs.
//!
//! A new target is a module here, a line in `TARGETS` and a file in `fuzz/fuzz_targets/`. Its findings are
//! files in `findings/<target>/`: see the README there.

pub mod capture;
pub mod frames;
pub mod line;
pub mod link;
pub mod scenario;

use crate::golden::CASES;
use std::{collections::BTreeSet, fs, io, path::PathBuf};
use stepscope_core::scenario::{
    Scenario,
    presets::{CONTROLLER_PRESETS, PLANT_PRESETS, PRESETS},
};

/// A fuzz target.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Name of its binary in `fuzz/`, and of its folder in `findings/`.
    pub name: &'static str,
    /// Panics if a property is violated.
    pub check: fn(&[u8]),
    /// A readable description of an input.
    pub told: fn(&[u8]) -> String,
    /// The initial inputs, made from files of the repository; never empty.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// The words of its inputs, such as `"channels"` with its quotation marks, for libFuzzer's dictionary; empty
    /// if it has none.
    pub words: fn() -> BTreeSet<String>,
}

/// All fuzz targets.
pub const TARGETS: &[Target] = &[
    Target { name: "line", check: line::check, told: line::told, seeds: line::seeds, words: BTreeSet::new },
    Target { name: "frames", check: frames::check, told: bytes, seeds: frames::seeds, words: BTreeSet::new },
    Target { name: "scenario", check: scenario::check, told: text, seeds: scenario::seeds, words },
    Target { name: "link", check: link::check, told: text, seeds: link::seeds, words },
    Target {
        name: "capture",
        check: capture::check,
        told: capture::told,
        seeds: capture::seeds,
        words: capture::words,
    },
];

impl Target {
    /// Inputs that once violated a property: name and bytes, sorted by name.
    ///
    /// # Errors
    /// If a file or the folder cannot be read; a target without a folder has no findings.
    pub fn findings(&self) -> io::Result<Vec<(String, Vec<u8>)>> {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("findings").join(self.name);
        if !folder.exists() {
            return Ok(Vec::new());
        }
        let files = fs::read_dir(folder)?.map(|entry| {
            let path = entry?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            Ok((name, fs::read(path)?))
        });
        let mut files = files.collect::<io::Result<Vec<_>>>()?;
        files.sort();
        Ok(files)
    }
}

/// The words of a scenario.
fn words() -> BTreeSet<String> {
    // Quoted words, without long texts.
    let words = |text: &str| -> Vec<String> {
        let quoted = text.split('"').skip(1).step_by(2);
        quoted.filter(|word| word.len() < 24).map(|word| format!("\"{word}\"")).collect()
    };
    scenarios().flat_map(words).chain(words(&Scenario::default().to_json())).collect()
}

/// An input that is a stream of bytes.
fn bytes(data: &[u8]) -> String {
    format!("{data:02x?}")
}

/// An input that is a text.
fn text(data: &[u8]) -> String {
    String::from_utf8_lossy(data).into_owned()
}

/// The JSON of the presets and the golden cases.
fn scenarios() -> impl Iterator<Item = &'static str> {
    let golden = CASES.iter().filter_map(|case| case.file("scenario.json"));
    PRESETS.iter().chain(PLANT_PRESETS).chain(CONTROLLER_PRESETS).map(|preset| preset.json).chain(golden)
}

/// The published links.
fn links() -> impl Iterator<Item = &'static str> {
    include_str!("../links/v1.txt").lines().filter_map(|line| line.split(' ').next())
}
