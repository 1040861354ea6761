//! XXH64 digest of a plant, seed 0, over every twentieth grid point (PLANT F8).

use core::hash::Hasher;
use twox_hash::XxHash64;

const PERIOD: u32 = 20;

#[derive(Clone)]
pub(crate) struct Digest {
    hasher: XxHash64,
    /// Grid points until the next one counts.
    wait: u32,
}

impl Default for Digest {
    fn default() -> Self {
        Self { hasher: XxHash64::with_seed(0), wait: PERIOD }
    }
}

impl core::fmt::Debug for Digest {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "Digest({:016x})", self.value())
    }
}

impl Digest {
    /// Counts a grid point; returns whether it belongs to the digest.
    pub(crate) fn count_point(&mut self) -> bool {
        self.wait -= 1;
        let is_due = self.wait == 0;
        if is_due {
            self.wait = PERIOD;
        }
        is_due
    }

    pub(crate) fn cycle(&mut self, cycle: u64) {
        self.hasher.write(&cycle.to_le_bytes());
    }

    pub(crate) fn numbers(&mut self, numbers: &[f64]) {
        for number in numbers {
            self.hasher.write(&number.to_bits().to_le_bytes());
        }
    }

    pub(crate) fn value(&self) -> u64 {
        self.hasher.clone().finish()
    }
}
