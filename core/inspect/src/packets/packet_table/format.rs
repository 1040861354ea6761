//! Words and numbers of the packet table: outcomes, marks, hex, times.

use alloc::{
    borrow::ToOwned,
    format,
    string::{String, ToString},
};
use core::fmt::Write;
use stepscope_peripheral::{
    protocol::{FrameOutcome, Reply},
    signal::PacketOutcome,
    trace::RowOutcome,
    units::Cycles,
};

/// What became of a row, at a glance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Done.
    Good,
    /// Not for this controller, or from another.
    OtherAddress,
    /// Acknowledged, and not done again.
    Repeated,
    /// Dropped, refused, or spoiled.
    Bad,
}

impl Mark {
    /// Of a row.
    #[must_use]
    pub const fn of(outcome: RowOutcome) -> Self {
        match outcome {
            RowOutcome::Packet(PacketOutcome::Queued)
            | RowOutcome::Frame(FrameOutcome::Queued(_) | FrameOutcome::Taken(_))
            | RowOutcome::Reply(Reply { answer: Ok(_), .. }) => Self::Good,
            RowOutcome::Packet(PacketOutcome::OtherAddress)
            | RowOutcome::Frame(FrameOutcome::OtherAddress) => Self::OtherAddress,
            RowOutcome::Frame(FrameOutcome::Repeated) => Self::Repeated,
            _ => Self::Bad,
        }
    }

    /// `good`, `foreign`, `repeated` or `bad`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::OtherAddress => "foreign",
            Self::Repeated => "repeated",
            Self::Bad => "bad",
        }
    }
}

/// What became of a row, in full; what a reply says beside that stands in its summary.
pub(super) fn outcome(outcome: RowOutcome) -> String {
    match outcome {
        RowOutcome::Reply(Reply { answer: Ok(_), .. }) => "acknowledged".to_owned(),
        RowOutcome::Reply(Reply { answer: Err(reason), .. }) => format!("refused: {}", reason.name()),
        outcome => outcome.to_string(),
    }
}

/// What became of a row, for a narrow column: a cross for what was not done, and the name of the reason.
pub(super) fn short(row: RowOutcome) -> String {
    match row {
        RowOutcome::Frame(FrameOutcome::Repeated) => "\u{21bb} repeated".to_owned(),
        RowOutcome::Frame(FrameOutcome::BadCrc { .. }) => "\u{2715} CRC".to_owned(),
        RowOutcome::Packet(PacketOutcome::Booting) => "\u{2715} self-test".to_owned(),
        RowOutcome::Ignored => "\u{2715} ignored".to_owned(),
        RowOutcome::Collision => "\u{2715} collision".to_owned(),
        RowOutcome::Open => "\u{2715} not complete".to_owned(),
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

/// Adds bytes in hex, two digits each.
pub(super) fn write_hex(bytes: &[u8], between: &str, text: &mut impl Write) {
    for (index, byte) in bytes.iter().enumerate() {
        let _ = write!(text, "{}{byte:02x}", if index == 0 { "" } else { between });
    }
}

/// Times of one column: one unit and one number of digits, so that they can be compared at a glance.
#[derive(Clone, Copy, Debug)]
pub struct TimeScale {
    /// The unit.
    pub unit: &'static str,
    /// Smallest step that is printed: so many of them are a second.
    per_s: u64,
    digits: usize,
    clock_hz: u64,
}

impl TimeScale {
    /// For a run of so many cycles.
    #[must_use]
    pub(super) fn of(Cycles(cycles): Cycles, clock_hz: u32) -> Self {
        let clock_hz = u64::from(clock_hz.max(1));
        let (unit, per_s, digits) = match cycles / clock_hz {
            10.. => ("s", 100_000, 5),
            _ if cycles.saturating_mul(100) >= clock_hz => ("ms", 1_000_000, 3),
            _ => ("\u{b5}s", 100_000_000, 2),
        };
        Self { unit, per_s, digits, clock_hz }
    }

    /// Adds a time.
    pub(super) fn write(self, cycles: u64, text: &mut String) {
        let steps = u128::from(cycles) * u128::from(self.per_s) + u128::from(self.clock_hz / 2);
        let steps = steps / u128::from(self.clock_hz);
        let whole = 10_u128.pow(self.digits as u32);
        let _ = write!(text, "{}.{:0width$}", steps / whole, steps % whole, width = self.digits);
    }
}
