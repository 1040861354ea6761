//! Golden cases: folders of `tests/golden/`, run on every target (native, a browser, a microcontroller) from the same
//! files.
//!
//! | file | contents |
//! | --- | --- |
//! | `scenario.json` or `preset` | the experiment, or the id of its preset |
//! | `why` | the sentence of the contract that the case checks, and whether its trace was checked by hand |
//! | `digest` | XXH64 of each controller's trace, 16 hexadecimal digits |
//! | `status` | the output of `stepscope run --status` below the digests |
//! | `expect.trace` | the first controller's trace, if it is short: one record per line, cycle and levels in hexadecimal |
//!
//! Only `STEPSCOPE_BLESS=1 cargo test -p stepscope-tests golden::` writes the last three.

use alloc::{
    format,
    string::{String, ToString as _},
    vec::Vec,
};
use core::fmt::Write as _;
use stepscope_core::{
    peripheral::{
        signal::{self, Record, Sink},
        trace::{Digest, parse_line, write_record},
    },
    scenario::presets::{CONTROLLER_PRESETS, PRESETS},
    sim::{Experiment, Run, Summary},
};

/// Maximum records of a trace that is stored as text.
pub const MAX_RECORDS: u64 = 400;

/// Maximum length of a run that is also made clock by clock, in cycles.
const MAX_CYCLES_CLOCK_BY_CLOCK: u64 = 2_000_000;

/// All cases, sorted by name.
pub const CASES: &[Case] = include!(concat!(env!("OUT_DIR"), "/golden.rs"));

/// One case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Name of its folder.
    pub name: &'static str,
    /// Name and text of each file.
    pub files: &'static [(&'static str, &'static str)],
}

/// Results of a run, as in the files of a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// 16 hexadecimal digits, one line per controller.
    pub digest: String,
    /// One `name value` per line.
    pub status: String,
    /// The first records, up to one more than a case stores.
    pub trace: Vec<Record>,
}

impl Case {
    /// Text of a file, if the case has it.
    #[must_use]
    pub fn file(&self, name: &str) -> Option<&'static str> {
        self.files.iter().find(|(each, _)| *each == name).map(|(_, text)| *text)
    }

    /// The scenario's JSON.
    ///
    /// # Errors
    /// A sentence, if the case has no scenario, has two, or names an unknown preset.
    pub fn json(&self) -> Result<&'static str, String> {
        match (self.file("scenario.json"), self.file("preset").map(str::trim)) {
            (Some(json), None) => Ok(json),
            (None, Some(id)) => {
                let preset = PRESETS.iter().chain(CONTROLLER_PRESETS).find(|preset| preset.id == id);
                preset
                    .map(|preset| preset.json)
                    .ok_or_else(|| format!("{}: no preset is called {id}", self.name))
            }
            _ => Err(format!("{}: give either scenario.json or preset", self.name)),
        }
    }

    /// The experiment.
    ///
    /// # Errors
    /// A sentence with all problems of the scenario.
    pub fn experiment(&self) -> Result<Experiment, String> {
        Experiment::from_json(self.json()?).map_err(|problems| {
            problems.iter().fold(format!("{}:", self.name), |text, problem| format!("{text}\n  {problem}"))
        })
    }

    /// Runs the experiment from event to event and, if it is short, clock by clock, too (DESIGN A2).
    ///
    /// # Errors
    /// A sentence with all problems of the scenario.
    pub fn run(&self) -> Result<(Outcome, Option<Outcome>), String> {
        let experiment = self.experiment()?;
        let mut cycles = 0;
        let go = |sinks: &mut [Keep]| {
            let run = experiment.run_each(sinks);
            cycles = run.cycles().0;
            run
        };
        let fast = Outcome::of(go, &experiment);
        let slow = (cycles < MAX_CYCLES_CLOCK_BY_CLOCK)
            .then(|| Outcome::of(|sinks| experiment.run_each_clock_by_clock(sinks), &experiment));
        Ok((fast, slow))
    }

    /// Runs the experiment like [`Case::run`] and compares it with the case's files: the complete test of a target.
    ///
    /// # Errors
    /// The problems of the scenario, or the differences.
    pub fn check(&self) -> Result<(), String> {
        let (fast, slow) = self.run()?;
        let fast = self.compare(&fast).err();
        let slow =
            slow.and_then(|slow| self.compare(&slow).err()).map(|text| format!("clock by clock, {text}"));
        match [fast, slow].into_iter().flatten().reduce(|fast, slow| fast + &slow) {
            Some(differences) => Err(differences),
            None => Ok(()),
        }
    }

    /// Compares a run with the case's files.
    ///
    /// # Errors
    /// All differences; of the trace only the first, with the names of the signals.
    pub fn compare(&self, found: &Outcome) -> Result<(), String> {
        let mut differences = String::new();
        let file = |name| self.file(name).unwrap_or_default();
        if let Some(trace) = self.file("expect.trace") {
            differences += &first_difference(trace, &found.trace).unwrap_or_default();
        }
        for (name, found) in [("digest", &found.digest), ("status", &found.status)] {
            let mut expected = file(name).lines();
            for line in found.lines() {
                let expected = expected.next().unwrap_or("nothing");
                if line != expected {
                    let _ = writeln!(differences, "  {name}: expected `{expected}`, found `{line}`");
                }
            }
            for expected in expected {
                let _ = writeln!(differences, "  {name}: expected `{expected}`, found nothing");
            }
        }
        if differences.is_empty() { Ok(()) } else { Err(format!("{}:\n{differences}", self.name)) }
    }
}

impl Outcome {
    /// Makes a run by `go`, which gets the sinks of the controllers. Stores digest and status of all controllers,
    /// and the records of the first one.
    pub fn of(go: impl FnOnce(&mut [Keep]) -> Run, experiment: &Experiment) -> Self {
        let mut keeps: Vec<Keep> = (0..experiment.controllers()).map(|_| Keep::default()).collect();
        let run = go(&mut keeps);
        let summary = Summary::new(experiment, &run, keeps.iter().map(|keep| &keep.digest));
        let mut digest = String::new();
        for controller in &summary.controllers {
            let _ = writeln!(digest, "{:016x}", controller.digest);
        }
        let status = summary.to_string();
        Self { digest, status, trace: keeps.into_iter().next().map(|keep| keep.first).unwrap_or_default() }
    }

    /// The trace as text, if it is short enough to be stored.
    #[must_use]
    pub fn trace_text(&self) -> Option<String> {
        let mut text = String::new();
        for record in &self.trace {
            write_record(&mut text, *record).ok()?;
        }
        (self.trace.len() as u64 <= MAX_RECORDS).then_some(text)
    }
}

/// Receives the records of a run: the digest of all, and the first ones.
#[derive(Default)]
pub struct Keep {
    digest: Digest,
    first: Vec<Record>,
}

impl Sink for Keep {
    fn record(&mut self, record: Record) {
        if self.digest.records() <= MAX_RECORDS {
            self.first.push(record);
        }
        self.digest.record(record);
    }
}

/// The first record that differs from the text's, with the previous one and the signals' names.
fn first_difference(expected: &str, found: &[Record]) -> Option<String> {
    let lines: Vec<&str> = expected.lines().collect();
    let records: Vec<_> = lines.iter().map(|line| parse_line(line).ok()).collect();
    let index = (0..lines.len().max(found.len())).find(|&index| {
        let expected = records.get(index).copied().flatten();
        expected.is_none() || expected != found.get(index).copied()
    })?;
    let before = index.checked_sub(1).and_then(|before| found.get(before));
    let expected = match (lines.get(index), records.get(index).copied().flatten()) {
        (Some(line), None) => format!("`{line}`, which is no record"),
        (_, record) => describe(record, before),
    };
    Some(format!(
        "  expect.trace line {}, after {}\n    expected {expected}\n    found    {}\n",
        index + 1,
        describe(before.copied(), None),
        describe(found.get(index).copied(), before)
    ))
}

/// Describes a record: the cycle, the changes since the previous record, and the high signals.
fn describe(record: Option<Record>, before: Option<&Record>) -> String {
    let Some(Record { cycle, levels }) = record else { return "no record".into() };
    let names = |mask: u64, mark: &str| {
        let bits = (0..64).filter(|bit| mask >> bit & 1 != 0);
        bits.map(|bit| format!(" {mark}{}", signal::name(bit).unwrap_or_else(|| format!("bit{bit}"))))
            .collect::<String>()
    };
    let mut text = format!("cycle {:#x} ({})", cycle.0, cycle.0);
    if let Some(before) = before {
        let (rise, fall) = (levels.0 & !before.levels.0, !levels.0 & before.levels.0);
        text += &format!(":{}{}", names(rise, "+"), names(fall, "-"));
    }
    format!("{text} [{:x} ={}]", levels.0, names(levels.0, ""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_core::peripheral::{signal::Levels, units::Instant};

    fn record(cycle: u64, levels: u64) -> Record {
        Record { cycle: Instant(cycle), levels: Levels(levels) }
    }

    #[test]
    fn the_first_difference_is_reported_with_its_signals() {
        let found = [record(0, 0x7_0000_0000), record(0x10, 0x7_0001_0000), record(0x18, 0x7_0001_0001)];
        let rows = [
            ("0 700000000\n10 700010000\n18 700010001\n", None),
            (
                "0 700000000\r\n10 700010000\r\n19 700010001\r\n",
                Some(
                    "  expect.trace line 3, after cycle 0x10 (16) [700010000 = DIR0 EN RX TX]\n    \
                     expected cycle 0x19 (25): +STEP0 [700010001 = STEP0 DIR0 EN RX TX]\n    \
                     found    cycle 0x18 (24): +STEP0 [700010001 = STEP0 DIR0 EN RX TX]\n",
                ),
            ),
            (
                "0 700000000\n10 700010000\n",
                Some(
                    "  expect.trace line 3, after cycle 0x10 (16) [700010000 = DIR0 EN RX TX]\n    \
                     expected no record\n    \
                     found    cycle 0x18 (24): +STEP0 [700010001 = STEP0 DIR0 EN RX TX]\n",
                ),
            ),
            (
                "0 700000000\nten\n",
                Some(
                    "  expect.trace line 2, after cycle 0x0 (0) [700000000 = EN RX TX]\n    \
                     expected `ten`, which is no record\n    \
                     found    cycle 0x10 (16): +DIR0 [700010000 = DIR0 EN RX TX]\n",
                ),
            ),
        ];
        for (expected, difference) in rows {
            assert_eq!(first_difference(expected, &found).as_deref(), difference, "{expected}");
        }
    }
}
