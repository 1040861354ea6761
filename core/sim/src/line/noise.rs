//! Random faults of the line and of the host; a seed always gives the same faults.
//!
//! Bits are flipped, bytes lost or duplicated, levels forced, replies missed, and the host crashes within a frame. Faults
//! are drawn frame by frame in the order of sending.

use alloc::vec::Vec;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::ForcedLevel;
use stepscope_peripheral::wire::Schedule;
use stepscope_peripheral::wire::{BitTimes, schedule::line_time};
use stepscope_scenario::Noise as Rates;

/// Seeded numbers, the same on every target.
#[derive(Clone, Debug)]
pub(crate) struct Random(Xoshiro256PlusPlus);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// A number below `end`.
    pub(crate) fn below(&mut self, end: u64) -> u64 {
        ((u128::from(self.0.next_u64()) * u128::from(end)) >> 64) as u64
    }
}

/// The random faults of a line.
#[derive(Clone, Debug)]
pub struct Noise {
    rates: Rates,
    random: Random,
    clock_hz: u32,
    baud: u32,
}

/// A send with noise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CorruptedSend {
    /// The bytes that reach the line.
    pub bytes: Vec<u8>,
    /// A level that is forced during the send.
    pub forced: Option<ForcedLevel>,
    /// Whether the host crashed after sending `bytes`.
    pub crashes: bool,
}

impl Noise {
    /// The noise of a line; `None` if every rate is 0.
    pub fn new(rates: &Rates, clock_hz: u32, baud: u32) -> Option<Self> {
        let quiet = Rates { seed: rates.seed, ..Rates::default() };
        let random = Random::new(rates.seed.into());
        (*rates != quiet).then(|| Self { rates: rates.clone(), random, clock_hz, baud })
    }

    fn happens(&mut self, ppm: u32) -> bool {
        ppm > 0 && self.random.below(1_000_000) < u64::from(ppm)
    }

    fn byte(&mut self, byte: u8, out: &mut Vec<u8>) {
        if self.happens(self.rates.lost_bytes_ppm) {
            return;
        }
        let mut flips = 0;
        for bit in 0..8 {
            flips |= u8::from(self.happens(self.rates.flipped_bits_ppm)) << bit;
        }
        out.push(byte ^ flips);
        if self.happens(self.rates.duplicated_bytes_ppm) {
            out.push(byte ^ flips);
        }
    }

    /// What the host receives of a byte.
    pub fn receive(&mut self, byte: u8) -> Vec<u8> {
        let mut received = Vec::new();
        self.byte(byte, &mut received);
        received
    }

    /// Whether the host misses a reply.
    pub fn misses_reply(&mut self) -> bool {
        self.happens(self.rates.lost_replies_ppm)
    }

    /// What reaches the line of a send that begins in cycle `start`.
    pub fn send(&mut self, start: Instant, bytes: &[u8]) -> CorruptedSend {
        let mut corrupted = Vec::with_capacity(bytes.len());
        for &byte in bytes {
            self.byte(byte, &mut corrupted);
        }
        let crashes = self.happens(self.rates.host_crashes_ppm);
        if crashes {
            corrupted.truncate(self.random.below(corrupted.len() as u64 + 1) as usize);
        }
        let glitch = (0..bytes.len()).any(|_| self.happens(self.rates.glitches_ppm));
        let forced = glitch.then(|| self.glitch(start, corrupted.len() as u64));
        CorruptedSend { bytes: corrupted, forced, crashes }
    }

    /// A forced level of one cycle to two bit times within `bytes` bytes.
    fn glitch(&mut self, start: Instant, bytes: u64) -> ForcedLevel {
        let room = line_time(bytes.max(1), self.clock_hz, self.baud);
        let Cycles(longest) = BitTimes::new(self.clock_hz, self.baud).bit(2);
        let start = start + Cycles(self.random.below(room));
        let end = start + Cycles(1 + self.random.below(longest.max(1)));
        debug_assert!(start < end);
        ForcedLevel { start, end, level: self.random.below(2) == 1 }
    }

    /// A schedule with noise. Each send still ends before the next one.
    pub fn schedule(mut self, schedule: &Schedule) -> (Schedule, Vec<ForcedLevel>) {
        let (mut noisy, mut all_forced) = (Schedule::default(), Vec::new());
        for (index, send) in schedule.iter().enumerate() {
            let CorruptedSend { mut bytes, forced, .. } = self.send(send.start, send.bytes);
            if let Some(next) = schedule.get(index + 1) {
                let room = next.start - send.start;
                while line_time(bytes.len() as u64, self.clock_hz, self.baud) > room.0 {
                    bytes.pop();
                }
            }
            noisy.push(send.start, &bytes);
            all_forced.extend(forced);
        }
        (noisy, all_forced)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(rates: Rates) -> Noise {
        Noise::new(&rates, 16_000_000, 115_200).expect("is noisy")
    }

    #[test]
    fn the_seed_determines_the_noise() {
        assert!(Noise::new(&Rates { seed: 7, ..Rates::default() }, 16_000_000, 115_200).is_none());
        let rates = |seed| Rates { seed, flipped_bits_ppm: 100_000, ..Rates::default() };
        let spoil = |seed| noise(rates(seed)).send(Instant(1), &[0; 64]).bytes;
        assert_eq!(spoil(1), spoil(1));
        assert_ne!(spoil(1), spoil(2));
    }

    #[test]
    fn faults_at_a_rate_of_one_always_happen_and_at_zero_never() {
        const SURE: u32 = 1_000_000;
        let bytes = [1, 2, 3];
        let spoil = |rates| noise(rates).send(Instant(100), &bytes);
        let lost = spoil(Rates { lost_bytes_ppm: SURE, ..Rates::default() });
        assert_eq!(lost, CorruptedSend { bytes: Vec::new(), forced: None, crashes: false });
        let duplicated = spoil(Rates { duplicated_bytes_ppm: SURE, ..Rates::default() });
        assert_eq!(duplicated.bytes, [1, 1, 2, 2, 3, 3]);
        assert_eq!(spoil(Rates { flipped_bits_ppm: SURE, ..Rates::default() }).bytes, [254, 253, 252]);
        let crashed = spoil(Rates { host_crashes_ppm: SURE, ..Rates::default() });
        assert!(crashed.crashes && bytes.starts_with(&crashed.bytes));
        let forced = spoil(Rates { glitches_ppm: SURE, ..Rates::default() }).forced.expect("forced");
        assert!(Instant(100) <= forced.start && forced.start < forced.end);
        assert!(forced.end.0 < 100 + line_time(3, 16_000_000, 115_200) + 280);
        assert!(noise(Rates { lost_replies_ppm: SURE, ..Rates::default() }).misses_reply());
    }

    #[test]
    fn sends_of_a_noisy_schedule_do_not_overlap() {
        let mut schedule = Schedule::default();
        schedule.push(Instant(1), &[1, 2]);
        schedule.push(Instant(1) + Cycles(line_time(2, 16_000_000, 115_200)), &[3, 4]);
        let rates = Rates { duplicated_bytes_ppm: 1_000_000, ..Rates::default() };
        let (noisy, forced) = noise(rates).schedule(&schedule);
        let sent: Vec<&[u8]> = noisy.iter().map(|send| send.bytes).collect();
        assert_eq!(sent, [&[1, 1][..], &[3, 3, 4, 4]]);
        assert_eq!(forced, []);
    }

    #[test]
    fn a_seed_gives_the_same_faults() {
        use crate::noise::Noise;
        use stepscope_peripheral::units::Instant;
        use stepscope_scenario::Noise as Rates;

        let rates = Rates { seed: 7, flipped_bits_ppm: 100_000, ..Rates::default() };
        let corrupted = |rates: &Rates| {
            let mut noise = Noise::new(rates, 16_000_000, 115_200).expect("there are faults");
            noise.send(Instant(1), &[0; 32]).bytes
        };
        assert_ne!(corrupted(&rates), [0; 32]);
        assert_eq!(corrupted(&rates), corrupted(&rates)); // from the same seed the same faults
        assert!(Noise::new(&Rates::default(), 16_000_000, 115_200).is_none());
    }
}
