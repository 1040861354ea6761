//! The vocabulary of the framed protocol (DESIGN A6): commands, outcomes, replies. [`crate::wire::frame`] encodes and
//! decodes frames.
//!
//! ```
//! use stepscope_peripheral::protocol::{FrameOutcome, Kind, Reason};
//!
//! assert_eq!(Kind::parse(5), Some(Kind::Stop));
//! assert_eq!(Reason::QueueFull.name(), "QUEUE_FULL");
//! assert_eq!(FrameOutcome::Queued(3).to_string(), "3 ticks queued");
//! assert_eq!(FrameOutcome::Short.reply_result(), None); // invalid frames get no reply
//! ```

use core::fmt;

/// Maximum ticks in one TICKS frame.
pub const MAX_TICKS: u8 = 32;

/// Declares enums of byte values with their protocol names.
macro_rules! byte_enums {
    ($($(#[$meta:meta])* pub enum $name:ident {
        $($(#[$variant_meta:meta])* $variant:ident = $byte:literal $word:literal,)*
    })*) => {$(
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum $name {
            $($(#[$variant_meta])* $variant = $byte,)*
        }

        impl $name {
            /// All variants in the order of their bytes.
            pub const ALL: &[Self] = &[$(Self::$variant),*];

            /// The variant of a byte; `None` if it has none.
            pub const fn parse(byte: u8) -> Option<Self> {
                match byte {
                    $($byte => Some(Self::$variant),)*
                    _ => None,
                }
            }

            /// Its name in the protocol, such as `QUEUE_FULL`.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)*
                }
            }
        }
    )*};
}

byte_enums! {
    /// The kind of a frame.
    pub enum Kind {
        Ticks = 1 "TICKS",
        /// Drivers on; leaves STOPPED.
        Enable = 2 "ENABLE",
        /// Drivers off, if nothing moves.
        Disable = 3 "DISABLE",
        Status = 4 "STATUS",
        Stop = 5 "STOP",
        /// Set the expected sequence number to 0 and clear the fault flags.
        Resync = 6 "RESYNC",
        /// Request a reply with the position counters.
        Positions = 7 "POSITIONS",
    }

    /// Why a frame was refused.
    pub enum Reason {
        /// Neither the expected sequence number nor a repetition of the one before it.
        BadSeq = 1 "BAD_SEQ",
        /// Too few free places in the queue.
        QueueFull = 2 "QUEUE_FULL",
        /// A byte requests more steps than a tick has slots.
        TooManySteps = 3 "TOO_MANY_STEPS",
        /// In the self-test; or, for DISABLE, a tick runs or waits.
        Busy = 4 "BUSY",
        /// Stopped: ENABLE is needed first.
        Stopped = 5 "STOPPED",
        /// The body does not fit the kind or the number of channels.
        BadBody = 6 "BAD_BODY",
        UnknownKind = 7 "UNKNOWN_KIND",
    }

    /// State of the controller.
    pub enum State {
        /// In the self-test after reset.
        Busy = 0 "BUSY",
        Ready = 1 "READY",
        /// A tick runs or waits.
        Moving = 2 "MOVING",
        /// Stopped; ENABLE leaves this state.
        Stopped = 3 "STOPPED",
    }
}

/// The status in every reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status {
    pub state: State,
    pub free: u8,
    /// Sequence number expected in the next TICKS.
    pub expected_seq: u8,
    /// Bits of [`Faults`](crate::device::Faults).
    pub faults: u16,
    /// Ticks done since reset, wrapping.
    pub ticks_done: u32,
}

/// A reply; the counters of POSITIONS are [`Positions`](crate::signal::Positions).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reply {
    pub address: u8,
    /// The executed kind, or the reason of the refusal.
    pub result: Result<Kind, Reason>,
    pub status: Status,
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameOutcome {
    Queued(u8),
    /// Acknowledged again, but not queued again.
    Repeated,
    Executed(Kind),
    /// Refused; only fault flags changed.
    Refused(Reason),
    OtherAddress,
    /// Invalid COBS, or too short.
    Short,
    BadCrc {
        found: u32,
        expected: u32,
    },
    /// Too long; bytes are dropped up to the next delimiter.
    Overlong,
}

impl FrameOutcome {
    /// The result in the reply; `None` for frames without a reply.
    pub const fn reply_result(self) -> Option<Result<Kind, Reason>> {
        match self {
            Self::Queued(_) | Self::Repeated => Some(Ok(Kind::Ticks)),
            Self::Executed(kind) => Some(Ok(kind)),
            Self::Refused(reason) => Some(Err(reason)),
            Self::OtherAddress | Self::Short | Self::BadCrc { .. } | Self::Overlong => None,
        }
    }
}

impl fmt::Display for FrameOutcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Queued(1) => f.write_str("1 tick queued"),
            Self::Queued(ticks) => write!(f, "{ticks} ticks queued"),
            Self::Repeated => f.write_str("repeated: acknowledged, not queued again"),
            Self::Executed(kind) => write!(f, "{} done", kind.name()),
            Self::Refused(reason) => write!(f, "refused: {}", reason.name()),
            Self::OtherAddress => f.write_str("another address"),
            Self::Short => f.write_str("dropped: SHORT_PACKET"),
            Self::BadCrc { found, expected } => {
                write!(f, "dropped: CRC {found:08x} found, {expected:08x} expected")
            }
            Self::Overlong => f.write_str("dropped: OVERLONG"),
        }
    }
}

impl fmt::Display for Reply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.result {
            Ok(kind) => write!(f, "ACK {}", kind.name())?,
            Err(reason) => write!(f, "NAK {}", reason.name())?,
        }
        let Status { state, free, expected_seq, faults, ticks_done } = self.status;
        let state = state.name();
        write!(f, ": {state}, {free} free, seq {expected_seq}, faults {faults:#04x}, {ticks_done} ticks done")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{string::ToString, vec::Vec};

    #[test]
    fn bytes_have_the_names_of_the_contract() {
        let kinds = ["TICKS", "ENABLE", "DISABLE", "STATUS", "STOP", "RESYNC", "POSITIONS"];
        let reasons =
            ["BAD_SEQ", "QUEUE_FULL", "TOO_MANY_STEPS", "BUSY", "STOPPED", "BAD_BODY", "UNKNOWN_KIND"];
        let states = ["BUSY", "READY", "MOVING", "STOPPED"];
        for byte in 0..=u8::MAX {
            let name = |names: &[&'static str], first: u8| {
                byte.checked_sub(first).and_then(|index| names.get(usize::from(index))).copied()
            };
            assert_eq!(Kind::parse(byte).map(Kind::name), name(&kinds, 1), "kind {byte}");
            assert_eq!(Reason::parse(byte).map(Reason::name), name(&reasons, 1), "reason {byte}");
            assert_eq!(State::parse(byte).map(State::name), name(&states, 0), "state {byte}");
        }
        assert_eq!(Kind::ALL.iter().map(|&kind| kind as u8).collect::<Vec<_>>(), [1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(Reason::ALL.len(), 7);
    }

    #[test]
    fn each_outcome_has_its_text_and_reply() {
        let ticks = Some(Ok(Kind::Ticks));
        let rows = [
            (FrameOutcome::Queued(1), "1 tick queued", ticks),
            (FrameOutcome::Queued(32), "32 ticks queued", ticks),
            (FrameOutcome::Repeated, "repeated: acknowledged, not queued again", ticks),
            (FrameOutcome::Executed(Kind::Stop), "STOP done", Some(Ok(Kind::Stop))),
            (FrameOutcome::Refused(Reason::BadSeq), "refused: BAD_SEQ", Some(Err(Reason::BadSeq))),
            (FrameOutcome::OtherAddress, "another address", None),
            (FrameOutcome::Short, "dropped: SHORT_PACKET", None),
            (
                FrameOutcome::BadCrc { found: 0xab, expected: 0x1234_5678 },
                "dropped: CRC 000000ab found, 12345678 expected",
                None,
            ),
            (FrameOutcome::Overlong, "dropped: OVERLONG", None),
        ];
        for (outcome, text, result) in rows {
            assert_eq!((outcome.to_string().as_str(), outcome.reply_result()), (text, result));
        }
    }

    #[test]
    fn a_reply_prints_its_result_and_status() {
        let status = Status { state: State::Moving, free: 3, expected_seq: 7, faults: 0x82, ticks_done: 12 };
        let text = |result| Reply { address: 1, result, status }.to_string();
        let expected = "MOVING, 3 free, seq 7, faults 0x82, 12 ticks done";
        assert_eq!(text(Ok(Kind::Ticks)), alloc::format!("ACK TICKS: {expected}"));
        assert_eq!(text(Err(Reason::Busy)), alloc::format!("NAK BUSY: {expected}"));
    }
}
