//! The digest of a plant: XXH64, seed 0, at each twentieth point (F8).

use core::hash::Hasher;
use twox_hash::XxHash64;

const EVERY: u32 = 20;

#[derive(Clone)]
pub(crate) struct Digest {
    hasher: XxHash64,
    wait: u32,
}

impl Default for Digest {
    fn default() -> Self {
        Self { hasher: XxHash64::with_seed(0), wait: EVERY }
    }
}

impl core::fmt::Debug for Digest {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "Digest({:016x})", self.value())
    }
}

impl Digest {
    #[inline(always)]
    pub(crate) fn is_due(&mut self) -> bool {
        self.wait -= 1;
        let is_due = self.wait == 0;
        if is_due {
            self.wait = EVERY;
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
