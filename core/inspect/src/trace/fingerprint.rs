//! Compares two runs without their traces: by the digest, and by intermediate digests at up to sixteen checkpoints
//! (DESIGN A3).
//!
//! The spacing of checkpoints is the smallest power of two that makes at most sixteen of them:
//!
//! ```text
//! records    1 … 16    17 … 33    34 … 67    …    n
//! spacing         1          2          4         the smallest power of two s with n/s < 17
//! ```

use alloc::vec::Vec;
use stepscope_peripheral::signal::{Levels, Record, Sink};
use stepscope_peripheral::{trace::Digest, units::Instant};

pub(crate) const MAX_CHECKPOINTS: usize = 16;

/// The digest and checkpoints of a trace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fingerprint {
    pub digest: u64,
    pub records: u64,
    /// High halves of the digests after 1, 2, 3, … times [`Self::spacing`] records.
    pub checkpoints: Vec<u32>,
}

impl Fingerprint {
    pub fn of(trace: &[Record]) -> Self {
        let mut fingerprinter = Fingerprinter::default();
        for record in trace {
            fingerprinter.record(*record);
        }
        fingerprinter.finish()
    }

    /// Records between checkpoints.
    pub const fn spacing(&self) -> u64 {
        spacing(self.records)
    }
}

pub(crate) const fn spacing(records: u64) -> u64 {
    (records / (MAX_CHECKPOINTS as u64 + 1) + 1).next_power_of_two()
}

/// Computes a fingerprint record by record.
#[derive(Clone)]
pub struct Fingerprinter {
    digest: Digest,
    checkpoints: Vec<u32>,
    spacing: u64,
    next: u64,
}

impl Default for Fingerprinter {
    fn default() -> Self {
        Self { digest: Digest::default(), checkpoints: Vec::new(), spacing: 1, next: 1 }
    }
}

impl Fingerprinter {
    /// The fingerprint of all records so far.
    pub fn finish(self) -> Fingerprint {
        Fingerprint {
            digest: self.digest.value(),
            records: self.digest.records(),
            checkpoints: self.checkpoints,
        }
    }
}

impl Sink for Fingerprinter {
    fn record(&mut self, record: Record) {
        self.digest.record(record);
        if self.digest.records() == self.next {
            self.checkpoints.push(high_half(&self.digest));
            if self.checkpoints.len() > MAX_CHECKPOINTS {
                // Keeps every second one.
                let mut index = 0;
                self.checkpoints.retain(|_| {
                    index += 1;
                    index % 2 == 0
                });
                self.spacing *= 2;
            }
            self.next = (self.checkpoints.len() as u64 + 1) * self.spacing;
        }
    }
}

fn high_half(digest: &Digest) -> u32 {
    (digest.value() >> 32) as u32
}

/// A position in a trace: the records and edges before it, and its cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    pub records: u64,
    pub edges: u64,
    pub cycle: Instant,
}

/// Result of comparing a trace with a fingerprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FingerprintMatch {
    Same(Mark),
    /// The first difference comes after `after` and no later than `until`.
    Differs {
        after: Mark,
        until: Mark,
        /// The trace that ends first, if it is equal up to its end.
        shorter: Option<Shorter>,
    },
}

/// Which of two traces ends first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shorter {
    This,
    Other,
}

/// Compares a trace with a fingerprint, record by record.
pub struct FingerprintCheck<'a> {
    other: &'a Fingerprint,
    spacing: u64,
    digest: Digest,
    levels: Option<Levels>,
    last: Mark,
    same: Mark,
    differs: Option<Mark>,
}

impl<'a> FingerprintCheck<'a> {
    pub fn with(other: &'a Fingerprint) -> Self {
        let none = Mark { records: 0, edges: 0, cycle: Instant::RESET };
        Self {
            other,
            spacing: other.spacing(),
            digest: Digest::default(),
            levels: None,
            last: none,
            same: none,
            differs: None,
        }
    }

    /// The result for all records so far.
    pub fn finish(self) -> FingerprintMatch {
        let Self { other, last, same, differs, .. } = self;
        if let Some(until) = differs {
            let shorter = (same.records == other.records).then_some(Shorter::Other);
            return FingerprintMatch::Differs { after: same, until, shorter };
        }
        if last.records == other.records {
            return FingerprintMatch::Same(last);
        }
        FingerprintMatch::Differs { after: same, until: last, shorter: Some(Shorter::This) }
    }
}

impl Sink for FingerprintCheck<'_> {
    fn record(&mut self, record: Record) {
        let before = self.levels.replace(record.levels).unwrap_or(record.levels);
        self.last.records += 1;
        self.last.edges += u64::from((before.0 ^ record.levels.0).count_ones());
        self.last.cycle = record.cycle;
        if self.differs.is_some() {
            return;
        }
        self.digest.record(record);
        let records = self.last.records;
        let same = if records == self.other.records {
            self.digest.value() == self.other.digest
        } else if records > self.other.records {
            false
        } else if records.is_multiple_of(self.spacing) {
            let index = (records / self.spacing - 1) as usize;
            self.other.checkpoints.get(index).is_none_or(|known| *known == high_half(&self.digest))
        } else {
            return;
        };
        if same {
            self.same = self.last;
        } else {
            self.differs = Some(self.last);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One record every ten cycles; each toggles one signal.
    fn trace(records: u64) -> Vec<Record> {
        (0..records).map(|i| Record { cycle: Instant(10 * i), levels: Levels(i & 1) }).collect()
    }

    fn compare(trace: &[Record], other: &Fingerprint) -> FingerprintMatch {
        let mut comparison = FingerprintCheck::with(other);
        trace.iter().for_each(|record| comparison.record(*record));
        comparison.finish()
    }

    #[test]
    fn checkpoints_are_up_to_sixteen_running_digests() {
        for records in (1..=80).chain([127, 128, 543, 544, 545, 1000]) {
            let trace = trace(records);
            let Fingerprint { digest, records: counted, checkpoints } = Fingerprint::of(&trace);
            assert_eq!((digest, counted), (Digest::of(&trace), records));
            let spacing = spacing(records);
            assert!(spacing.is_power_of_two() && records / spacing <= 16, "{records}");
            assert!(spacing == 1 || records / (spacing / 2) > 16, "{records}: not the smallest spacing");
            let expected: Vec<u32> = (1..=records / spacing)
                .map(|k| (Digest::of(&trace[..(k * spacing) as usize]) >> 32) as u32)
                .collect();
            assert_eq!(checkpoints, expected, "{records}");
        }
    }

    #[test]
    fn the_first_difference_lies_in_the_reported_range() {
        for records in [1, 2, 16, 17, 100, 545] {
            let sent = trace(records);
            let other = Fingerprint::of(&sent);
            let FingerprintMatch::Same(mark) = compare(&sent, &other) else {
                panic!("{records}: they are equal")
            };
            assert_eq!((mark.records, mark.edges), (records, records - 1));
            for changed in 0..records as usize {
                let mut own = sent.clone();
                own[changed].levels.0 ^= 1 << 35;
                let FingerprintMatch::Differs { after, until, shorter: None } = compare(&own, &other) else {
                    panic!("{records} {changed}: they differ")
                };
                let number = changed as u64 + 1;
                assert!(after.records < number && number <= until.records, "{records} {changed}");
                assert!(until.records - after.records <= spacing(records), "{records} {changed}");
                assert_eq!(until.cycle, own[until.records as usize - 1].cycle);
            }
        }
    }

    #[test]
    fn a_shorter_trace_is_distinguished_from_a_different_one() {
        let sent = trace(100);
        let other = Fingerprint::of(&sent);
        let FingerprintMatch::Differs { after, until, shorter } = compare(&trace(77), &other) else {
            panic!("they differ")
        };
        assert_eq!((after.records, until.records, shorter), (72, 77, Some(Shorter::This)));
        let FingerprintMatch::Differs { after, until, shorter } = compare(&trace(130), &other) else {
            panic!("they differ")
        };
        assert_eq!((after.records, until.records, shorter), (100, 101, Some(Shorter::Other)));
    }

    #[test]
    fn equal_traces_have_equal_fingerprints() {
        use crate::trace::stored_run::StoredRun;
        use stepscope_sim::Experiment;

        let experiment = Experiment::from_json("{}").expect("the default motion");
        let mut recording = StoredRun::default();
        experiment.run(&mut recording);
        let sent = Fingerprint::of(&recording.trace);
        let mut check = FingerprintCheck::with(&sent);
        recording.trace.iter().for_each(|&record| check.record(record));
        assert!(matches!(check.finish(), FingerprintMatch::Same(_)));
    }
}
