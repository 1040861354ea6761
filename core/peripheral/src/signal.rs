//! The 36 signals of the peripheral, trace records, and sinks for them (DESIGN A3).
//!
//! ```
//! use stepscope_peripheral::{signal::{Levels, Record, Sink}, units::Instant};
//!
//! /// Counts falling edges of EN.
//! #[derive(Default)]
//! struct PowerCuts(u32, bool);
//!
//! impl Sink for PowerCuts {
//!     fn record(&mut self, record: Record) {
//!         let powered = record.levels.has(Levels::EN);
//!         self.0 += u32::from(self.1 && !powered);
//!         self.1 = powered;
//!     }
//! }
//!
//! let mut cuts = PowerCuts::default();
//! cuts.record(Record { cycle: Instant(0), levels: Levels::RESET });
//! cuts.record(Record { cycle: Instant(9), levels: Levels(Levels::RX | Levels::TX) });
//! assert_eq!(cuts.0, 1);
//! ```

use crate::{
    protocol::{FrameOutcome, Reply},
    units::Instant,
};
use alloc::vec::Vec;

pub const MAX_CHANNELS: usize = 16;

/// Levels of all signals in one cycle.
///
/// | bits | signal |
/// | --- | --- |
/// | 0..=15 | STEP of channel 0..=15 |
/// | 16..=31 | DIR of channel 0..=15 |
/// | 32 | EN, high = windings powered |
/// | 33 | RX, the line as the receiver samples it |
/// | 34 | TX, the controller's reply |
/// | 35 | DE, the transceiver's transmit enable |
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Levels(pub u64);

impl Levels {
    pub const DIR_SHIFT: u32 = 16;
    pub const EN: u64 = 1 << 32;
    pub const RX: u64 = 1 << 33;
    pub const TX: u64 = 1 << 34;
    /// DE, high while the controller drives the line.
    pub const DE: u64 = 1 << 35;
    pub const RESET: Self = Self(Self::EN | Self::RX | Self::TX);
    const SIGNALS: u32 = 2 * MAX_CHANNELS as u32 + 4;

    /// STEP levels, channel 0 in bit 0.
    #[must_use]
    pub const fn step(self) -> u16 {
        self.0 as u16
    }

    /// DIR levels, channel 0 in bit 0.
    #[must_use]
    pub const fn dir(self) -> u16 {
        (self.0 >> Self::DIR_SHIFT) as u16
    }

    #[must_use]
    pub const fn has(self, mask: u64) -> bool {
        self.0 & mask == mask
    }
}

const _: () = assert!(MAX_CHANNELS == u16::BITS as usize && Levels::DIR_SHIFT == u16::BITS);
const _: () = assert!(Levels::EN | Levels::RX | Levels::TX | Levels::DE == 0xf << (2 * MAX_CHANNELS));
const _: () = assert!(Levels::DE == 1 << (Levels::SIGNALS - 1));

#[must_use]
pub fn name(bit: u32) -> Option<alloc::string::String> {
    match bit {
        0..=15 => Some(alloc::format!("STEP{bit}")),
        16..=31 => Some(alloc::format!("DIR{}", bit - 16)),
        32 => Some("EN".into()),
        33 => Some("RX".into()),
        34 => Some("TX".into()),
        35 => Some("DE".into()),
        _ => None,
    }
}

/// The levels from a cycle on, until the next record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Record {
    pub cycle: Instant,
    pub levels: Levels,
}

/// Position counters of a controller's channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Positions {
    /// Invariant: unused channels have 0.
    counters: [i32; MAX_CHANNELS],
    /// Invariant: 1..=16.
    channels: u8,
}

impl Positions {
    /// `None` unless there are 1 to 16.
    #[must_use]
    pub fn new(counters: &[i32]) -> Option<Self> {
        let mut all = [0; MAX_CHANNELS];
        let used = all.get_mut(..counters.len()).filter(|used| !used.is_empty())?;
        used.copy_from_slice(counters);
        Some(Self { counters: all, channels: counters.len() as u8 })
    }

    #[must_use]
    pub fn as_slice(&self) -> &[i32] {
        self.counters.get(..usize::from(self.channels)).unwrap_or_default()
    }
}

/// An event besides changes of signals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Event {
    Byte {
        /// Cycle of its start bit.
        seen: Instant,
        byte: u8,
    },
    /// The stop bit of a byte was low.
    FramingError {
        seen: Instant,
        /// Whether bytes are dropped up to the next gap, as on a raw line.
        drops: bool,
    },
    /// A gap cut a packet short, or ended the dropping of bytes.
    Gap {
        short: bool,
    },
    Packet(PacketOutcome),
    /// The byte completed a frame, or exceeded its maximum length.
    Frame(FrameOutcome),
    Reply {
        start: Instant,
        end: Instant,
        reply: Reply,
        positions: Option<Positions>,
    },
    /// This controller and another node drive the line at the same time.
    Collision,
    Underrun,
    Pushed,
    /// Firmware or an overload stopped the controller and cleared the queue.
    Stopped,
    TickStart {
        /// One byte per channel.
        commands: [u8; MAX_CHANNELS],
    },
    TickEnd,
    /// The panel of a stand-alone controller changed.
    Panel {
        controller: u8,
        word: u64,
        /// In steps.
        position: i64,
        /// In display digits.
        display: i64,
    },
    /// The raw level of a stand-alone controller's input changed.
    Input {
        controller: u8,
        /// Its number in the controller crate.
        input: u8,
        level: bool,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketOutcome {
    Queued,
    OtherAddress,
    Booting,
    Stopped,
    TooManySteps,
    QueueFull,
}

/// Receives the records of a run in order, and the events between them.
pub trait Sink {
    fn record(&mut self, record: Record);

    fn event(&mut self, _at: Instant, _event: Event) {}

    fn paused(&self) -> bool {
        false
    }
}

impl Sink for Vec<Record> {
    fn record(&mut self, record: Record) {
        debug_assert!(
            self.last().is_none_or(|last| last.cycle < record.cycle && last.levels != record.levels),
            "{record:?} after {:?}",
            self.last()
        );
        self.push(record);
    }
}

impl<A: Sink, B: Sink> Sink for (A, B) {
    fn record(&mut self, record: Record) {
        self.0.record(record);
        self.1.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.0.event(at, event);
        self.1.event(at, event);
    }

    fn paused(&self) -> bool {
        self.0.paused() || self.1.paused()
    }
}

impl<S: Sink> Sink for Option<S> {
    fn record(&mut self, record: Record) {
        if let Some(sink) = self {
            sink.record(record);
        }
    }

    fn event(&mut self, at: Instant, event: Event) {
        if let Some(sink) = self {
            sink.event(at, event);
        }
    }

    fn paused(&self) -> bool {
        self.as_ref().is_some_and(Sink::paused)
    }
}

impl Sink for () {
    fn record(&mut self, _: Record) {}
}

impl<S: Sink> Sink for &mut S {
    fn record(&mut self, record: Record) {
        (**self).record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        (**self).event(at, event);
    }

    fn paused(&self) -> bool {
        (**self).paused()
    }
}

/// A sink that never pauses.
pub struct Unpaused<'a, S>(pub &'a mut S);

impl<S: Sink> Sink for Unpaused<'_, S> {
    fn record(&mut self, record: Record) {
        self.0.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.0.event(at, event);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn every_bit_has_the_contracts_name() {
        let rows = [
            (0, Some("STEP0")),
            (15, Some("STEP15")),
            (16, Some("DIR0")),
            (31, Some("DIR15")),
            (32, Some("EN")),
            (33, Some("RX")),
            (34, Some("TX")),
            (35, Some("DE")),
            (36, None),
        ];
        for (bit, expected) in rows {
            assert_eq!(name(bit).as_deref(), expected, "bit {bit}");
        }
    }

    #[test]
    fn levels_are_read_by_their_bits() {
        let levels = Levels(Levels::EN | Levels::DE | 0xa55a_1234);
        assert_eq!((levels.step(), levels.dir()), (0x1234, 0xa55a));
        assert!(levels.has(Levels::EN) && levels.has(Levels::EN | Levels::DE));
        assert!(!levels.has(Levels::EN | Levels::TX) && !levels.has(Levels::RX));
        assert_eq!(Levels::RESET, Levels(0x7_0000_0000), "powered, and the line idle");
    }

    /// Takes everything, and may want to pause.
    #[derive(Default)]
    struct Taken {
        records: Vec<Record>,
        events: Vec<(Instant, Event)>,
        is_full: bool,
    }

    impl Sink for Taken {
        fn record(&mut self, record: Record) {
            self.records.push(record);
        }

        fn event(&mut self, at: Instant, event: Event) {
            self.events.push((at, event));
        }

        fn paused(&self) -> bool {
            self.is_full
        }
    }

    const MORE: [Record; 2] = [
        Record { cycle: Instant(4), levels: Levels(Levels::EN) },
        Record { cycle: Instant(9), levels: Levels::RESET },
    ];

    fn give(sink: &mut impl Sink) -> bool {
        sink.record(Record { cycle: Instant(3), levels: Levels::RESET });
        MORE.into_iter().for_each(|record| sink.record(record));
        sink.event(Instant(4), Event::TickEnd);
        sink.paused()
    }

    #[test]
    fn sinks_that_stand_for_others_hand_everything_on() {
        let full = || Taken { is_full: true, ..Taken::default() };
        for (first, second, expected) in [
            (Taken::default(), Taken::default(), false),
            (full(), Taken::default(), true),
            (Taken::default(), full(), true),
        ] {
            let mut both = (first, Some(second));
            assert_eq!(give(&mut &mut both), expected);
            let (first, second) = (both.0, both.1.expect("it is there"));
            for taken in [first, second] {
                assert_eq!(
                    taken.records,
                    [Record { cycle: Instant(3), levels: Levels::RESET }, MORE[0], MORE[1]]
                );
                assert_eq!(taken.events, [(Instant(4), Event::TickEnd)]);
            }
        }
        assert!(!give(&mut None::<Taken>), "nobody asks for a pause");
        let mut trace = vec![];
        assert!(!give(&mut trace));
        assert_eq!(trace, [Record { cycle: Instant(3), levels: Levels::RESET }, MORE[0], MORE[1]]);
    }
}
