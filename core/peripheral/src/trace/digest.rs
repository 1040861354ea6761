//! The digest of a trace: XXH64, seed 0, over two little-endian words a record (DESIGN A3).

use crate::signal::{Record, Sink};
use core::hash::Hasher;
use twox_hash::XxHash64;

/// Records that are gathered before they are hashed: the hash is faster on long runs.
const BLOCK: usize = 256;
/// Bytes of a record: two words.
const RECORD: usize = 16;
const _: () = assert!(size_of::<Record>() == RECORD);

/// The digest of the records so far.
#[derive(Clone)]
pub struct Digest {
    hasher: XxHash64,
    block: [[u8; RECORD]; BLOCK],
    /// Records in the block.
    ///
    /// Invariant: fewer than it holds.
    filled: usize,
    /// Blocks that have been hashed.
    hashed: u64,
}

impl Default for Digest {
    fn default() -> Self {
        Self { hasher: XxHash64::with_seed(0), block: [[0; RECORD]; BLOCK], filled: 0, hashed: 0 }
    }
}

impl Digest {
    /// The digest; 16 hexadecimal digits when printed with `{:016x}`.
    #[must_use]
    pub fn value(&self) -> u64 {
        let mut hasher = self.hasher.clone();
        hasher.write(self.block.get(..self.filled).unwrap_or_default().as_flattened());
        hasher.finish()
    }

    /// How many records it has seen.
    #[must_use]
    pub const fn records(&self) -> u64 {
        self.hashed * BLOCK as u64 + self.filled as u64
    }

    /// The digest of a stored trace.
    #[must_use]
    pub fn of(records: &[Record]) -> u64 {
        let mut digest = Self::default();
        for record in records {
            digest.record(*record);
        }
        digest.value()
    }

    /// Empties the full block. By itself, so that the registers of who makes records are not the hash's.
    #[inline(never)]
    fn hash(&mut self) {
        self.hasher.write(self.block.as_flattened());
        (self.filled, self.hashed) = (0, self.hashed + 1);
    }
}

impl Sink for Digest {
    #[inline(always)]
    fn record(&mut self, record: Record) {
        let filled = self.filled;
        if let Some(place) = self.block.get_mut(filled) {
            place[..8].copy_from_slice(&record.cycle.0.to_le_bytes());
            place[8..].copy_from_slice(&record.levels.0.to_le_bytes());
            self.filled = filled + 1;
        }
        if filled + 1 == BLOCK {
            self.hash();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{signal::Levels, units::Instant};
    use alloc::vec::Vec;

    #[test]
    fn the_digest_is_xxh64_of_the_records_bytes() {
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
