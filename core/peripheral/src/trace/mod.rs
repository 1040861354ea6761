//! Traces: digest, text form, and steps (DESIGN A3).
//!
//! ```
//! use stepscope_peripheral::{signal::{Levels, Record}, trace::{Digest, parse_line, steps, write_record},
//!     units::Instant};
//!
//! let (right, step) = (1 << Levels::DIR_SHIFT, 1);
//! let trace = [(0, 0), (40, right), (80, right | step), (120, right)]
//!     .map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) });
//! assert_eq!(steps(&trace, 0)[0].position, 1);
//!
//! let mut text = String::new();
//! trace.iter().for_each(|&record| write_record(&mut text, record).expect("strings do not fail"));
//! let read: Vec<Record> = text.lines().map(|line| parse_line(line).expect("a record")).collect();
//! assert_eq!(Digest::of(&read), Digest::of(&trace));
//! ```

mod digest;
mod steps;
mod text;

pub use digest::Digest;
pub use steps::{Step, steps, steps_in};
pub use text::{ParseError, parse_line, write_record};

use crate::signal::{Levels, Record};
use crate::units::Instant;

/// Levels in cycle `at`; the levels of reset before the first record.
pub fn levels_at(trace: &[Record], at: Instant) -> Levels {
    let after = trace.partition_point(|record| record.cycle <= at);
    after.checked_sub(1).and_then(|index| trace.get(index)).map_or(Levels::RESET, |record| record.levels)
}

/// The level of signal `bit` in the first record, then each change, with its cycle.
pub fn level_changes(trace: &[Record], bit: u32) -> impl Iterator<Item = (Instant, bool)> {
    let mask = 1_u64.checked_shl(bit).unwrap_or(0);
    let mut before = None;
    trace.iter().filter_map(move |record| {
        let level = record.levels.0 & mask != 0;
        (before.replace(level) != Some(level)).then_some((record.cycle, level))
    })
}

/// Bits of the signals in exports: STEP and DIR of each channel, then EN, RX, TX, DE.
pub fn shown_signals(channels: u8) -> impl Iterator<Item = u32> {
    let channels = 0..u32::from(channels);
    let others = [Levels::EN, Levels::RX, Levels::TX, Levels::DE].map(u64::trailing_zeros);
    channels.flat_map(|channel| [channel, Levels::DIR_SHIFT + channel]).chain(others)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn a_signal_has_its_first_level_and_its_changes() {
        let trace = [(0, 0b01), (5, 0b11), (9, 0b01), (12, 0b00)];
        let trace = trace.map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) });
        let changes = |bit| level_changes(&trace, bit).map(|(at, level)| (at.0, level)).collect::<Vec<_>>();
        assert_eq!(changes(0), [(0, true), (12, false)]);
        assert_eq!(changes(1), [(0, false), (5, true), (9, false)]);
        assert_eq!(changes(64), [(0, false)]);
        assert_eq!(level_changes(&[], 0).next(), None);
    }
}
