//! The contents of a recorded file.
//!
//! ```
//! use stepscope_capture::read::{Limits, read};
//!
//! let dump = "$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 1! #12 0!";
//! let capture = read(std::io::Cursor::new(dump), &Limits::default(), &mut |_| true).capture;
//! assert_eq!((capture.channels[0].name.as_str(), capture.bytes.len()), ("STEP", 0));
//! ```

pub use crate::changes::Change;

use crate::{changes::Changes, timebase::Timebase};
use core::fmt;
use stepscope_peripheral::trace::Step;

/// Maximum number of channels that are read: a [`Change`] has one bit per channel.
pub const MAX_CHANNELS: usize = 64;

/// The file formats that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Value change dump (IEEE 1364).
    Vcd,
    /// Session of sigrok or PulseView (`.sr`).
    SigrokSession,
    /// Table of sigrok or PulseView, one row per sample.
    SigrokCsv,
    /// Table of levels with times, one row per change: DSView, WaveForms and others.
    LevelsCsv,
    /// Saleae Logic 2, digital channels, one row per change.
    SaleaeCsv,
    /// Saleae Logic 2, decoded bytes.
    SaleaeBytes,
    /// Stepscope's table of edges: cycle, time and levels.
    EdgesCsv,
    /// Stepscope's trace: cycle and levels in hexadecimal.
    Trace,
    /// Bytes in hexadecimal, with or without times.
    HexBytes,
    /// Hexadecimal dump with offsets: hexdump, xxd, od or a terminal.
    HexDump,
    /// Log of bytes in hexadecimal, with times of day.
    SerialLog,
    /// Output of sigrok's UART decoder.
    Annotations,
    /// Klipper's step commands.
    Klipper,
    /// Table of times and positions.
    PositionsCsv,
    /// No known format: the capture is empty, and the error names the nearest formats.
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
            Self::Unknown => "unknown format",
        })
    }
}

/// A channel of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// The name in the file, with its scopes: `top.motor.STEP`.
    pub name: String,
}

/// A byte that another program decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimedByte {
    /// Start of the start bit, in ticks of the file; without times the index of the byte.
    pub tick: u64,
    /// Index into [`Capture::channels`].
    pub channel: u8,
    pub byte: u8,
    /// Whether the file reports a low stop bit.
    pub framing_error: bool,
}

/// A position that the firmware printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimedPosition {
    /// Time in ticks of the file.
    pub tick: u64,
    /// Position in steps.
    pub position: i64,
}

/// The contents of a file: levels, bytes or positions; the other two are empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Capture {
    pub format: Format,
    /// Length of a tick; `None` if the file does not give it.
    pub timebase: Option<Timebase>,
    /// Channels in the order of their bits, at most [`MAX_CHANNELS`].
    pub channels: Vec<Channel>,
    /// Levels in order of time, each different from the previous one. The first also applies before its time.
    pub changes: Changes,
    /// Decoded bytes in order of time.
    pub bytes: Vec<TimedByte>,
    /// Positions in order of time.
    pub positions: Vec<TimedPosition>,
    /// The last tick in the file.
    pub end: u64,
    /// Number of channels beyond [`MAX_CHANNELS`], which are not read.
    pub omitted_channels: u64,
    /// What was omitted or assumed, one sentence each.
    pub notes: Vec<String>,
}

impl Capture {
    pub const fn new(format: Format) -> Self {
        Self {
            format,
            timebase: None,
            channels: Vec::new(),
            changes: Changes::new(),
            bytes: Vec::new(),
            positions: Vec::new(),
            end: 0,
            omitted_channels: 0,
            notes: Vec::new(),
        }
    }

    /// Number of changes, bytes or positions.
    pub const fn len(&self) -> usize {
        self.changes.len() + self.bytes.len() + self.positions.len()
    }

    /// Converts positions to steps, evenly spaced between two rows and relative to the first position. `cycle` converts a
    /// tick to a clock cycle. `None` if there are more than `max_steps`, or a position does not fit into 32 bits.
    pub fn steps(&self, cycle: impl Fn(u64) -> u64, max_steps: u64) -> Option<Vec<Step>> {
        let rows = self.positions.iter().zip(self.positions.iter().skip(1));
        let counts = rows.clone().map(|(row, next)| next.position.abs_diff(row.position));
        if counts.fold(0, u64::saturating_add) > max_steps {
            return None;
        }
        let origin = i128::from(self.positions.first().map_or(0, |row| row.position));
        let mut steps = Vec::new();
        for (row, next) in rows {
            let count = next.position.abs_diff(row.position);
            let direction = if next.position > row.position { 1 } else { -1 };
            let (from, to) = (cycle(row.tick), cycle(next.tick));
            for k in 1..=count {
                let elapsed = u128::from(to.saturating_sub(from)) * u128::from(k) / u128::from(count);
                let position = i128::from(row.position) - origin + direction * i128::from(k);
                steps.push(Step { cycle: from + elapsed as u64, position: i32::try_from(position).ok()? });
            }
        }
        Some(steps)
    }

    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_become_evenly_spaced_steps() {
        let rows = |rows: &[(u64, i64)]| Capture {
            positions: rows.iter().map(|&(tick, position)| TimedPosition { tick, position }).collect(),
            ..Capture::new(Format::PositionsCsv)
        };
        let steps = |positions: &[(u64, i64)], max_steps| {
            let steps = rows(positions).steps(|tick| 10 * tick, max_steps)?;
            Some(steps.iter().map(|step| (step.cycle, step.position)).collect::<Vec<_>>())
        };
        let found = steps(&[(0, 5), (10, 7), (20, 7), (30, 6)], 3);
        assert_eq!(found, Some(vec![(50, 1), (100, 2), (300, 1)]));
        assert_eq!(steps(&[(0, 5), (10, 7), (20, 7), (30, 6)], 2), None);
        assert_eq!(steps(&[(0, i64::MIN), (1, i64::MAX)], u64::MAX - 1), None);
        assert_eq!(steps(&[], 0), Some(vec![]));
    }

    #[test]
    fn two_steps_in_a_row_are_half_a_row_apart() {
        use crate::capture::{Capture, Format, TimedPosition};

        // Two steps in 10 ticks: the second at the row's time, the first half way to it.
        let rows = [(0, 5), (10, 7)].map(|(tick, position)| TimedPosition { tick, position });
        let capture = Capture { positions: rows.to_vec(), ..Capture::new(Format::PositionsCsv) };
        let steps = capture.steps(|tick| 100 * tick, 1000).expect("two are not too many");
        assert_eq!(
            steps.iter().map(|step| (step.cycle, step.position)).collect::<Vec<_>>(),
            [(500, 1), (1000, 2)]
        );
    }
}
