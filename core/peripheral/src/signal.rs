//! The 36 signals of the peripheral, trace records, and sinks for them (DESIGN A3).
//!
//! ```
//! use stepscope_peripheral::{signal::{Levels, Record, Sink}, units::Instant};
//!
//! /// A sink that counts falling edges of EN.
//! #[derive(Default)]
//! struct PowerCuts {
//!     count: u32,
//!     is_powered: bool,
//! }
//!
//! impl Sink for PowerCuts {
//!     fn record(&mut self, record: Record) {
//!         let was_powered = std::mem::replace(&mut self.is_powered, record.levels.has(Levels::EN));
//!         self.count += u32::from(was_powered && !self.is_powered);
//!     }
//! }
//!
//! let mut cuts = PowerCuts::default();
//! cuts.record(Record { cycle: Instant(0), levels: Levels::RESET });
//! cuts.record(Record { cycle: Instant(9), levels: Levels(Levels::RX | Levels::TX) });
//! assert_eq!(cuts.count, 1);
//! ```

use crate::protocol::{FrameOutcome, Reply};
use crate::units::Instant;
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
#[repr(transparent)]
pub struct Levels(pub u64);

impl Levels {
    /// Bit of channel 0's DIR.
    pub const DIR_SHIFT: u32 = 16;
    pub const EN: u64 = 1 << 32;
    pub const RX: u64 = 1 << 33;
    pub const TX: u64 = 1 << 34;
    pub const DE: u64 = 1 << 35;
    /// Levels at reset: windings powered, line idle.
    pub const RESET: Self = Self(Self::EN | Self::RX | Self::TX);
    const SIGNALS: u32 = 2 * MAX_CHANNELS as u32 + 4;

    /// STEP levels, channel 0 in bit 0.
    pub const fn step(self) -> u16 {
        self.0 as u16
    }

    /// DIR levels, channel 0 in bit 0.
    pub const fn dir(self) -> u16 {
        (self.0 >> Self::DIR_SHIFT) as u16
    }

    /// Whether all signals of `mask` are high.
    pub const fn has(self, mask: u64) -> bool {
        self.0 & mask == mask
    }
}

const _: () = assert!(MAX_CHANNELS == u16::BITS as usize && Levels::DIR_SHIFT == u16::BITS);
const _: () = assert!(Levels::EN | Levels::RX | Levels::TX | Levels::DE == 0xf << (2 * MAX_CHANNELS));
const _: () = assert!(Levels::DE == 1 << (Levels::SIGNALS - 1));

/// Name of a signal such as `STEP0`; `None` above bit 35.
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

/// Bit of a signal by its [`name`]; `None` if there is no such signal.
pub fn bit(signal: &str) -> Option<u32> {
    (0..Levels::SIGNALS).find(|&bit| name(bit).is_some_and(|own| own == signal))
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
    /// The counters of channels 0, 1, …; `None` unless there are 1 to 16.
    pub fn new(counters: &[i32]) -> Option<Self> {
        let mut all = [0; MAX_CHANNELS];
        let used = all.get_mut(..counters.len()).filter(|used| !used.is_empty())?;
        used.copy_from_slice(counters);
        Some(Self { counters: all, channels: counters.len() as u8 })
    }

    /// One counter per channel, in steps.
    pub fn as_slice(&self) -> &[i32] {
        self.counters.get(..usize::from(self.channels)).unwrap_or_default()
    }
}

/// An event that is not a change of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Event {
    /// A byte whose start bit was detected in cycle `start`.
    Byte { start: Instant, byte: u8 },
    /// The stop bit of a byte was low. On a raw line bytes are dropped up to the next gap.
    FramingError { start: Instant, is_dropping: bool },
    /// A gap in the bytes of a raw line cut a packet short; else it ended the dropping of bytes.
    Gap { cuts_packet: bool },
    /// The byte completed a raw packet.
    Packet(PacketOutcome),
    /// The byte completed a frame, or exceeded its maximum length.
    Frame(FrameOutcome),
    /// A reply from its first start bit to the end of its last stop bit, where DE falls.
    Reply { start: Instant, end: Instant, reply: Reply, positions: Option<Positions> },
    /// This controller and another node drive the line at the same time.
    Collision,
    /// A tick with steps ended and none followed (framed protocol only).
    Underrun,
    /// Firmware queued a tick.
    Pushed,
    /// Firmware or an overload stopped the controller and cleared the queue.
    Stopped,
    /// The tick at the head of the queue started.
    TickStart { commands: [u8; MAX_CHANNELS] },
    /// The tick ended.
    TickEnd,
    /// The panel of a stand-alone controller changed: lamps, digits and state as bits, the position of the axis in steps, and
    /// the displayed value in units of its last digit.
    Panel { controller: u8, word: u64, position: i64, display: i64 },
    /// The raw level of a stand-alone controller's input changed.
    Input { controller: u8, input: u8, level: bool },
}

/// What became of a raw packet; all but `Queued` drop it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketOutcome {
    Queued,
    OtherAddress,
    /// It ended during the self-test.
    Booting,
    Stopped,
    TooManySteps,
    QueueFull,
}

/// Receives the records of a run in order, and the events between them.
pub trait Sink {
    /// Receives the levels from a cycle on.
    fn record(&mut self, record: Record);

    /// Receives an event in cycle `_at`.
    fn event(&mut self, _at: Instant, _event: Event) {}

    /// Whether the run should return before its end; checked between cycles.
    fn is_paused(&self) -> bool {
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

    fn is_paused(&self) -> bool {
        self.0.is_paused() || self.1.is_paused()
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

    fn is_paused(&self) -> bool {
        self.as_ref().is_some_and(Sink::is_paused)
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

    fn is_paused(&self) -> bool {
        (**self).is_paused()
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
    fn each_bit_has_its_signal_name() {
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
        assert_eq!(super::bit("STEP16"), None);
        for (bit, expected) in rows {
            assert_eq!(name(bit).as_deref(), expected, "bit {bit}");
            assert_eq!(expected.and_then(super::bit), expected.map(|_| bit), "bit {bit}");
        }
    }

    #[test]
    fn levels_select_signals_by_bit() {
        let levels = Levels(Levels::EN | Levels::DE | 0xa55a_1234);
        assert_eq!((levels.step(), levels.dir()), (0x1234, 0xa55a));
        assert!(levels.has(Levels::EN) && levels.has(Levels::EN | Levels::DE));
        assert!(!levels.has(Levels::EN | Levels::TX) && !levels.has(Levels::RX));
        assert_eq!(Levels::RESET, Levels(0x7_0000_0000), "powered, line idle");
    }

    /// Stores records and events; paused if `is_full`.
    #[derive(Default)]
    struct Stored {
        records: Vec<Record>,
        events: Vec<(Instant, Event)>,
        is_full: bool,
    }

    impl Sink for Stored {
        fn record(&mut self, record: Record) {
            self.records.push(record);
        }

        fn event(&mut self, at: Instant, event: Event) {
            self.events.push((at, event));
        }

        fn is_paused(&self) -> bool {
            self.is_full
        }
    }

    const RECORDS: [Record; 3] = [
        Record { cycle: Instant(3), levels: Levels::RESET },
        Record { cycle: Instant(4), levels: Levels(Levels::EN) },
        Record { cycle: Instant(9), levels: Levels::RESET },
    ];

    /// Returns whether the sink is paused afterwards.
    fn send_all(sink: &mut impl Sink) -> bool {
        RECORDS.into_iter().for_each(|record| sink.record(record));
        sink.event(Instant(4), Event::TickEnd);
        sink.is_paused()
    }

    #[test]
    fn composed_sinks_forward_records_events_and_pauses() {
        let full = || Stored { is_full: true, ..Stored::default() };
        for (first, second, expected) in [
            (Stored::default(), Stored::default(), false),
            (full(), Stored::default(), true),
            (Stored::default(), full(), true),
        ] {
            let mut both = (first, Some(second));
            assert_eq!(send_all(&mut &mut both), expected);
            let (first, second) = (both.0, both.1.expect("the second sink"));
            for stored in [first, second] {
                assert_eq!(stored.records, RECORDS);
                assert_eq!(stored.events, [(Instant(4), Event::TickEnd)]);
            }
        }
        assert!(!send_all(&mut None::<Stored>), "no sink, no pause");
        let mut trace = vec![];
        assert!(!send_all(&mut trace));
        assert_eq!(trace, RECORDS);
    }
}
