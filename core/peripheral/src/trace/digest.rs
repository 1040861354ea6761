//! The digest of a trace: XXH64, seed 0, over two little-endian words per record (DESIGN A3).

use crate::signal::{Record, Sink};
use core::hash::Hasher;
use twox_hash::XxHash64;

/// Computes the digest of the records that it receives.
#[derive(Clone)]
pub struct Digest {
    hasher: XxHash64,
    records: u64,
}

impl Default for Digest {
    fn default() -> Self {
        Self { hasher: XxHash64::with_seed(0), records: 0 }
    }
}

impl Digest {
    /// The digest; print it with `{:016x}`.
    pub fn value(&self) -> u64 {
        self.hasher.finish()
    }

    /// Number of records so far.
    pub const fn records(&self) -> u64 {
        self.records
    }

    /// The digest of a whole trace.
    pub fn of(records: &[Record]) -> u64 {
        let mut digest = Self::default();
        records.iter().for_each(|record| digest.record(*record));
        digest.value()
    }
}

impl Sink for Digest {
    fn record(&mut self, Record { cycle, levels }: Record) {
        self.hasher.write(&cycle.0.to_le_bytes());
        self.hasher.write(&levels.0.to_le_bytes());
        self.records += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{signal::Levels, units::Instant};
    use alloc::vec::Vec;

    #[test]
    fn the_digest_is_xxh64_of_the_bytes_of_the_records() {
        let records: Vec<Record> =
            (0..1000).map(|i| Record { cycle: Instant(i * 7), levels: Levels(i << 30 | 5) }).collect();
        for count in [0, 1, 255, 256, 257, 1000] {
            let bytes: Vec<u8> = records[..count]
                .iter()
                .flat_map(|r| [r.cycle.0.to_le_bytes(), r.levels.0.to_le_bytes()].concat())
                .collect();
            assert_eq!(Digest::of(&records[..count]), XxHash64::oneshot(0, &bytes), "{count} records");
        }
        assert_eq!(Digest::of(&[]), 0xef46_db37_51d8_e999, "the published value of the empty input");
    }
}
