//! A run in memory, as the views need it: records, digest and packets.
//!
//! ```
//! use stepscope_inspect::trace::stored_run::StoredRun;
//! use stepscope_sim::Experiment;
//!
//! let mut recording = StoredRun::default();
//! Experiment::from_json("{}").expect("the default motion").run(&mut recording);
//! assert_eq!(recording.digest.records(), recording.trace.len() as u64);
//! ```

use crate::packets::log::PacketLog;
use alloc::vec::Vec;
use core::fmt;
use stepscope_peripheral::signal::{Event, Record, Sink};
use stepscope_peripheral::{trace::Digest, units::Instant};
use stepscope_sim::{Experiment, Run};

pub use stepscope_sim::MAX_RECORDS;

/// Records between two calls of [`check_records`].
pub const RECORDS_PER_CHECK: u64 = 1 << 16;

/// Trace, digest and packets of a controller's run.
#[derive(Clone, Default)]
pub struct StoredRun {
    pub trace: Vec<Record>,
    pub digest: Digest,
    pub packets: PacketLog,
}

impl Sink for StoredRun {
    fn record(&mut self, record: Record) {
        self.trace.push(record);
        self.digest.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.packets.event(at, event);
    }
}

impl StoredRun {
    /// Start of the first tick: time 0 of a motion.
    pub fn first_tick(&self) -> Option<Instant> {
        self.packets.ticks().first().map(|tick| tick.start)
    }
}

/// The run exceeds [`MAX_RECORDS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TooLong {
    Steps(u64),
    Edges,
}

impl fmt::Display for TooLong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Steps(steps) => {
                write!(f, "{steps} steps are too many; the maximum is {}", MAX_RECORDS / 2)?
            }
            Self::Edges => write!(f, "the run has more than {MAX_RECORDS} edges, the maximum")?,
        }
        f.write_str("; use a shorter motion, or end the run earlier with run_cycles")
    }
}

impl core::error::Error for TooLong {}

/// Runs an experiment and stores the traces of its first `controllers` controllers.
pub fn record_run(experiment: &Experiment, controllers: usize) -> Result<(Run, Vec<StoredRun>), TooLong> {
    record_within(experiment, controllers, MAX_RECORDS)
}

fn record_within(
    experiment: &Experiment,
    controllers: usize,
    max_records: u64,
) -> Result<(Run, Vec<StoredRun>), TooLong> {
    // The steps of segments are known in advance; other edges are counted during the run.
    let segments = experiment.segments();
    if let Some(steps) = segments.map(|segments| segments.steps()).filter(|steps| *steps > max_records / 2) {
        return Err(TooLong::Steps(steps));
    }
    let mut recordings: Vec<StoredRun> = (0..controllers).map(|_| StoredRun::default()).collect();
    let mut run = experiment.start();
    while !run.advance_each(RECORDS_PER_CHECK, &mut recordings) {
        if segments.is_none() {
            check_within(&recordings, max_records)?;
        }
    }
    Ok((run, recordings))
}

/// Fails if the recordings exceed [`MAX_RECORDS`].
pub fn check_records(recordings: &[StoredRun]) -> Result<(), TooLong> {
    check_within(recordings, MAX_RECORDS)
}

fn check_within(recordings: &[StoredRun], max_records: u64) -> Result<(), TooLong> {
    let records: u64 = recordings.iter().map(|recording| recording.trace.len() as u64).sum();
    if records > max_records { Err(TooLong::Edges) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{format, string::ToString};

    #[test]
    fn stored_records_equal_those_of_a_run() {
        let experiment = Experiment::from_json("{}").expect("it runs");
        let mut expected = StoredRun::default();
        let run = experiment.run(&mut expected);
        let (stored, recordings) = record_run(&experiment, 1).expect("it is short");
        assert_eq!(recordings.first().map(|found| &found.trace), Some(&expected.trace));
        assert_eq!(stored.cycles(), run.cycles());
    }

    #[test]
    fn too_many_steps_are_rejected_before_the_run() {
        let json = |count: u32| {
            let list = format!(r#"{{"segments":[{{"steps":{{"count":{count}}}}}]}}"#);
            format!(r#"{{"source":{{"segments":{{"channels":[{list}]}}}}}}"#)
        };
        let experiment = Experiment::from_json(&json(u32::MAX)).expect("it runs");
        let refused = record_run(&experiment, 1).err().expect("it is too long");
        assert_eq!(refused, TooLong::Steps(u32::MAX.into()));
        assert_eq!(
            refused.to_string(),
            "4294967295 steps are too many; the maximum is 24000000; use a shorter motion, or end the run earlier with run_cycles"
        );
        let experiment = Experiment::from_json(&json(1000)).expect("it runs");
        assert!(record_within(&experiment, 1, 2000).is_ok());
        assert_eq!(record_within(&experiment, 1, 1999).err(), Some(TooLong::Steps(1000)));
    }

    #[test]
    fn too_many_edges_end_the_run() {
        let json = r#"{"source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":200000},"speed":{"steps_s":20000}}}]}]}}}"#;
        let experiment = Experiment::from_json(json).expect("it runs");
        assert!(record_run(&experiment, 1).is_ok());
        assert_eq!(record_within(&experiment, 1, 100_000).err(), Some(TooLong::Edges));
    }
}
