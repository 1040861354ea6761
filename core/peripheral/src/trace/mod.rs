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

/// Bits of the signals in exports: STEP and DIR of each channel, then EN, RX, TX, DE.
pub fn shown_signals(channels: u8) -> impl Iterator<Item = u32> {
    let channels = 0..u32::from(channels);
    let others = [Levels::EN, Levels::RX, Levels::TX, Levels::DE].map(u64::trailing_zeros);
    channels.flat_map(|channel| [channel, Levels::DIR_SHIFT + channel]).chain(others)
}
