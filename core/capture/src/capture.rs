//! What a file has recorded.
//!
//! ```
//! use stepscope_capture::capture::{Capture, Format, TimedPosition};
//!
//! // Two steps in 10 ticks: the second at the row's time, the first half way to it.
//! let rows = [(0, 5), (10, 7)].map(|(tick, position)| TimedPosition { tick, position });
//! let capture = Capture { positions: rows.to_vec(), ..Capture::new(Format::PositionsCsv) };
//! let steps = capture.steps(|tick| 100 * tick, 1000).expect("two are not too many");
//! assert_eq!(steps.iter().map(|step| (step.cycle, step.position)).collect::<Vec<_>>(), [(500, 1), (1000, 2)]);
//! ```

pub use crate::changes::Change;

use crate::{changes::Changes, timebase::Timebase};
use core::fmt;
use stepscope_peripheral::trace::Step;

/// Most channels that are read: a bit each of a [`Change`].
pub const MAX_CHANNELS: usize = 64;

/// Which kind of file it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// A value change dump (IEEE 1364), ours or another program's.
    Vcd,
    /// A session of sigrok or PulseView (`.sr`).
    SigrokSession,
    /// sigrok's or PulseView's table: a row a sample.
    SigrokCsv,
    /// A table of levels, one row per change, with its time: of DSView, WaveForms, or a program of one's own.
    LevelsCsv,
    /// Saleae Logic 2's table of digital channels: one row per change, with its time.
    SaleaeCsv,
    /// Saleae Logic 2's table of decoded bytes.
    SaleaeBytes,
    /// Stepscope's own table of edges.
    EdgesCsv,
    /// Stepscope's own trace: cycle and levels in hexadecimal.
    Trace,
    /// Bytes in hexadecimal, with times or without.
    HexBytes,
    /// A dump of bytes in hexadecimal, with offsets: of hexdump, xxd, od or a terminal.
    HexDump,
    /// A log of bytes in hexadecimal, with the times of a clock.
    SerialLog,
    /// Annotations of sigrok's decoder of serial lines.
    Annotations,
    /// Step commands of Klipper.
    Klipper,
    /// A table of times and positions.
    PositionsCsv,
    /// No kind that can be read: the capture is empty, and the error says what can.
    Unknown,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Vcd => "value change dump",
            Self::SigrokSession => "sigrok session",
            Self::SigrokCsv => "sigrok table of samples",
            Self::LevelsCsv => "table of levels",
            Self::SaleaeCsv => "Saleae table of levels",
            Self::SaleaeBytes => "Saleae table of decoded bytes",
            Self::EdgesCsv => "Stepscope table of edges",
            Self::Trace => "Stepscope trace",
            Self::HexBytes => "bytes in hexadecimal",
            Self::HexDump => "hex dump",
            Self::SerialLog => "serial log",
            Self::Annotations => "annotations of sigrok's UART decoder",
            Self::Klipper => "Klipper step commands",
            Self::PositionsCsv => "table of times and positions",
            Self::Unknown => "file of no known kind",
        })
    }
}

/// A channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// As the file has it; what it stands in comes before it, with points between (`top.motor.STEP`).
    pub name: String,
}

/// A byte of a line that was decoded already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimedByte {
    /// When its start bit begins, in ticks of the file; in a file without times its place among the bytes.
    pub tick: u64,
    /// Its channel, an index into [`Capture::channels`].
    pub channel: u8,
    /// The byte.
    pub byte: u8,
    /// Whether the file says that its stop bit was not high.
    pub framing_error: bool,
}

/// A position at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimedPosition {
    /// When, in ticks of the file.
    pub tick: u64,
    /// In steps.
    pub position: i64,
}

/// What a file has recorded: levels, or bytes, or positions; the other two are empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Capture {
    /// Which kind of file it is.
    pub format: Format,
    /// How long a tick is; `None` where the file does not tell, and whoever opens it has to say it.
    pub timebase: Option<Timebase>,
    /// The channels, at most [`MAX_CHANNELS`].
    pub channels: Vec<Channel>,
    /// What the levels were, in the order of time: ticks rise, and each row differs from the one before. The first stands
    /// for all the time before the second.
    pub changes: Changes,
    /// Bytes, in the order of time.
    pub bytes: Vec<TimedByte>,
    /// Positions, in the order of time.
    pub positions: Vec<TimedPosition>,
    /// The last tick that the file tells something of.
    pub end: u64,
    /// Channels of the file beyond [`MAX_CHANNELS`], which are not read.
    pub channels_left_out: u64,
    /// What the file holds and was not read, a sentence each: analogue channels, levels that are neither high nor low.
    pub left_out: Vec<String>,
}

impl Capture {
    /// Before anything of a file is read.
    #[must_use]
    pub const fn new(format: Format) -> Self {
        Self {
            format,
            timebase: None,
            channels: Vec::new(),
            changes: Changes::new(),
            bytes: Vec::new(),
            positions: Vec::new(),
            end: 0,
            channels_left_out: 0,
            left_out: Vec::new(),
        }
    }

    /// How much it holds: changes, bytes or positions.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.changes.len() + self.bytes.len() + self.positions.len()
    }

    /// The steps that the positions stand for, in the cycles of their times: those of a row come evenly from the row before
    /// to its own time, the last of them at it. Positions count from the first row's on. `None` if they are more than
    /// `most`, or lead further than 2^31 steps away.
    #[must_use]
    pub fn steps(&self, cycle: impl Fn(u64) -> u64, most: u64) -> Option<Vec<Step>> {
        let pairs = || self.positions.iter().zip(self.positions.iter().skip(1));
        let all = pairs()
            .fold(0, |sum: u64, (before, row)| sum.saturating_add(row.position.abs_diff(before.position)));
        if all > most {
            return None;
        }
        let start = i128::from(self.positions.first().map_or(0, |row| row.position));
        let mut steps = Vec::new();
        for (before, row) in pairs() {
            let (count, right) = (row.position.abs_diff(before.position), (row.position > before.position));
            let (from, to) = (cycle(before.tick), cycle(row.tick));
            for k in 1..=count {
                let at =
                    from + (u128::from(to.saturating_sub(from)) * u128::from(k) / u128::from(count)) as u64;
                let position = i128::from(before.position) - start
                    + (if right { i128::from(k) } else { -i128::from(k) });
                steps.push(Step { cycle: at, position: i32::try_from(position).ok()? });
            }
        }
        Some(steps)
    }

    /// Whether it holds nothing.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_stand_for_steps_that_come_evenly() {
        let rows = |rows: &[(u64, i64)]| Capture {
            positions: rows.iter().map(|&(tick, position)| TimedPosition { tick, position }).collect(),
            ..Capture::new(Format::PositionsCsv)
        };
        let steps = |positions: &[(u64, i64)], most| {
            let steps = rows(positions).steps(|tick| 10 * tick, most)?;
            Some(steps.iter().map(|step| (step.cycle, step.position)).collect::<Vec<_>>())
        };
        let found = steps(&[(0, 5), (10, 7), (20, 7), (30, 6)], 3);
        assert_eq!(found, Some(vec![(50, 1), (100, 2), (300, 1)]));
        assert_eq!(steps(&[(0, 5), (10, 7), (20, 7), (30, 6)], 2), None);
        assert_eq!(steps(&[(0, i64::MIN), (1, i64::MAX)], u64::MAX - 1), None);
        assert_eq!(steps(&[], 0), Some(vec![]));
    }
}
