//! Levels forced on the line: glitches on and next to the receiver's samples, and breaks with critical
//! ends.

use proptest::prelude::*;
use proptest::sample::Index;

use super::LONGEST_RUN;
use crate::oracle::{Config, bit_time};

/// A fault on the line.
#[derive(Debug, Clone)]
pub(super) enum LineFault {
    /// One forced level.
    Level { place: Place, length: Length, level: bool },
    /// Low until a stop bit is missing, high for a few cycles, low again. The time of the next stop bit shows whether
    /// the receiver was armed in time for the second low.
    Break { place: Place, low_bits: u64, high_cycles: u64, low_again: Length },
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Place {
    /// Cycles after the start of a byte.
    InByte(Index, u64),
    /// Sample `0..=9` of a byte (0 is the start bit, 9 the stop bit), plus or minus one cycle.
    AtSample(Index, u64, i64),
    /// Cycles from the end of the previous forced level, or from cycle 1.
    AfterLast(i64),
    Anywhere(u64),
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Length {
    Cycles(u64),
    /// Half a bit time, plus or minus one cycle: the maximum length of a glitch.
    HalfBit(i64),
    Bits(u64),
}

fn place() -> impl Strategy<Value = Place> {
    prop_oneof![
        2 => (any::<Index>(), 0..440_u64).prop_map(|(byte, cycles)| Place::InByte(byte, cycles)),
        3 => (any::<Index>(), 0..=9_u64, -1..=1_i64)
            .prop_map(|(byte, sample, offset)| Place::AtSample(byte, sample, offset)),
        3 => (-8..=8_i64).prop_map(Place::AfterLast),
        2 => (1..LONGEST_RUN).prop_map(Place::Anywhere),
    ]
}

fn length() -> impl Strategy<Value = Length> {
    prop_oneof![
        4 => (1..=2_u64).prop_map(Length::Cycles),
        2 => (1..=60_u64).prop_map(Length::Cycles),
        2 => (-2..=2_i64).prop_map(Length::HalfBit),
        1 => (8..=60_u64).prop_map(Length::Bits),
    ]
}

pub(super) fn line_fault() -> impl Strategy<Value = LineFault> {
    let level = prop_oneof![3 => Just(false), 2 => Just(true)];
    prop_oneof![
        6 => (place(), length(), level)
            .prop_map(|(place, length, level)| LineFault::Level { place, length, level }),
        1 => (place(), 9..=24_u64, 1..=3_u64, length()).prop_map(|(place, low_bits, high_cycles, low_again)| {
            LineFault::Break { place, low_bits, high_cycles, low_again }
        }),
    ]
}

/// The faults as entries of A4: cycle, length, level.
pub(super) fn force(config: &Config, faults: &[LineFault], byte_starts: &[u64]) -> Vec<(u64, u64, bool)> {
    let bit_time = bit_time(config);
    let byte = |which: Index| if byte_starts.is_empty() { 1 } else { *which.get(byte_starts) };
    let start = |place: Place, forced: &[(u64, u64, bool)]| {
        let cycle = match place {
            Place::InByte(which, cycles) => byte(which) + cycles,
            Place::AtSample(which, sample, offset) => {
                (byte(which) + bit_time / 2 + sample * bit_time).saturating_add_signed(offset)
            }
            Place::AfterLast(offset) => {
                let end = forced.last().map_or(1, |(cycle, length, _)| cycle + length);
                end.saturating_add_signed(offset)
            }
            Place::Anywhere(cycle) => cycle,
        };
        cycle.max(1)
    };
    let cycles = |length: Length| {
        let cycles = match length {
            Length::Cycles(cycles) => cycles,
            Length::HalfBit(offset) => (bit_time / 2).saturating_add_signed(offset),
            Length::Bits(bits) => bits * bit_time,
        };
        cycles.max(1)
    };
    let mut forced: Vec<(u64, u64, bool)> = Vec::new();
    for strike in faults {
        match *strike {
            LineFault::Level { place, length, level } => {
                forced.push((start(place, &forced), cycles(length), level));
            }
            LineFault::Break { place, low_bits, high_cycles, low_again } => {
                let (first, low) = (start(place, &forced), low_bits * bit_time);
                forced.push((first, low, false));
                forced.push((first + low, high_cycles, true));
                forced.push((first + low + high_cycles, cycles(low_again), false));
            }
        }
    }
    forced
}
