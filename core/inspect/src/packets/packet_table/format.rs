//! Texts and numbers of the packet table: outcomes, marks, hex, times.

use crate::packets::log::RowOutcome;
use alloc::string::{String, ToString};
use alloc::{borrow::ToOwned, format};
use core::fmt::Write;
use stepscope_peripheral::protocol::{FrameOutcome, Reply};
use stepscope_peripheral::{signal::PacketOutcome, units::Cycles};

/// The color of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    Good,
    OtherAddress,
    Repeated,
    Bad,
}

impl Mark {
    pub const fn of(outcome: RowOutcome) -> Self {
        match outcome {
            RowOutcome::Packet(PacketOutcome::Queued)
            | RowOutcome::Frame(FrameOutcome::Queued(_) | FrameOutcome::Executed(_))
            | RowOutcome::Reply(Reply { result: Ok(_), .. }) => Self::Good,
            RowOutcome::Packet(PacketOutcome::OtherAddress)
            | RowOutcome::Frame(FrameOutcome::OtherAddress) => Self::OtherAddress,
            RowOutcome::Frame(FrameOutcome::Repeated) => Self::Repeated,
            _ => Self::Bad,
        }
    }

    pub const fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::OtherAddress => "foreign",
            Self::Repeated => "repeated",
            Self::Bad => "bad",
        }
    }
}

pub(super) fn outcome(outcome: RowOutcome) -> String {
    match outcome {
        RowOutcome::Reply(Reply { result: Ok(_), .. }) => "acknowledged".to_owned(),
        RowOutcome::Reply(Reply { result: Err(reason), .. }) => format!("refused: {}", reason.name()),
        outcome => outcome.to_string(),
    }
}

/// The outcome for a narrow column: a cross and the reason.
pub(super) fn short(row: RowOutcome) -> String {
    match row {
        RowOutcome::Frame(FrameOutcome::Repeated) => "\u{21bb} repeated".to_owned(),
        RowOutcome::Frame(FrameOutcome::BadCrc { .. }) => "\u{2715} CRC".to_owned(),
        RowOutcome::Packet(PacketOutcome::Booting) => "\u{2715} self-test".to_owned(),
        RowOutcome::Ignored => "\u{2715} ignored".to_owned(),
        RowOutcome::Collision => "\u{2715} collision".to_owned(),
        RowOutcome::Incomplete => "\u{2715} incomplete".to_owned(),
        RowOutcome::Recorded => "\u{2715} unknown".to_owned(),
        row => {
            let full = outcome(row);
            match full.strip_prefix("dropped: ").or_else(|| full.strip_prefix("refused: ")) {
                Some(reason) => format!("\u{2715} {reason}"),
                None => full,
            }
        }
    }
}

pub(super) fn write_hex(bytes: &[u8], separator: &str, text: &mut impl Write) {
    for (index, byte) in bytes.iter().enumerate() {
        let _ = write!(text, "{}{byte:02x}", if index == 0 { "" } else { separator });
    }
}

/// The unit and number of digits of a column, so that its times are easy to compare.
#[derive(Clone, Copy, Debug)]
pub struct TimeScale {
    pub unit: &'static str,
    /// Smallest printed step, as steps per second.
    per_s: u64,
    digits: usize,
    clock_hz: u64,
}

impl TimeScale {
    pub(super) fn of(Cycles(cycles): Cycles, clock_hz: u32) -> Self {
        let clock_hz = u64::from(clock_hz.max(1));
        let (unit, per_s, digits) = match cycles / clock_hz {
            10.. => ("s", 100_000, 5),
            _ if cycles.saturating_mul(100) >= clock_hz => ("ms", 1_000_000, 3),
            _ => ("\u{b5}s", 100_000_000, 2),
        };
        Self { unit, per_s, digits, clock_hz }
    }

    pub(super) fn write(self, cycles: u64, text: &mut String) {
        let steps = u128::from(cycles) * u128::from(self.per_s) + u128::from(self.clock_hz / 2);
        let steps = steps / u128::from(self.clock_hz);
        let scale = 10_u128.pow(self.digits as u32);
        let _ = write!(text, "{}.{:0width$}", steps / scale, steps % scale, width = self.digits);
    }
}
