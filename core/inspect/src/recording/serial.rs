//! Bytes on a recorded line: its bit rate from its pulses, its bytes as A4's receiver hears them, and which protocol they
//! speak.
//!
//! ```
//! use stepscope_inspect::recording::serial::{Guess, guess, hear, measured_baud};
//! use stepscope_peripheral::{signal::Levels, trace::Recording};
//! use stepscope_sim::Experiment;
//!
//! // The line of a run, as a logic analyser would have seen it.
//! let experiment = Experiment::from_json(r#"{"line":{"protocol":"framed"}}"#).expect("the default motion, framed");
//! let mut recording = Recording::default();
//! experiment.run(&mut recording);
//! let baud = measured_baud(&recording.trace, Levels::RX, 16_000_000).expect("a line");
//! assert_eq!(baud.usual, Some(115_200));
//! let heard = hear(&recording.trace, Levels::RX, 16_000_000, 115_200);
//! assert!(heard.framing_errors.is_empty());
//! assert!(matches!(guess(&heard.bytes, 139), Guess::Framed { address: 0, channels: Some(1), bad: 0, .. }));
//! ```

use alloc::{vec, vec::Vec};
use stepscope_peripheral::{
    protocol::Kind,
    signal::{Levels, MAX_CHANNELS, Record},
    units::{Cycles, Instant},
    wire::{
        frame::{Deframed, Deframer, Ticks},
        uart::{Receiver, RxEvent},
    },
};

/// Rates that lines have.
const USUAL: [u32; 26] = [
    300, 1200, 2400, 4800, 9600, 14_400, 19_200, 28_800, 31_250, 38_400, 57_600, 74_880, 76_800, 115_200,
    128_000, 230_400, 250_000, 256_000, 460_800, 500_000, 576_000, 921_600, 1_000_000, 1_500_000, 2_000_000,
    3_000_000,
];
/// How far a measured rate may be from a usual one, in parts of a hundred.
const NEAR_PERCENT: u64 = 2;
/// Pulses that are looked at for the rate.
const MAX_PULSES: usize = 100_000;
/// Lengths that are tried as that of a bit.
const MAX_CANDIDATES: usize = 200;
/// Longest run of equal bits within a byte: start bit and eight zeros.
const MAX_BITS: u64 = 9;
/// How far a pulse may be from whole bits, in bits.
const MAX_OFF: f64 = 0.3;
/// Pulses that have to fit, where there are so many.
const MIN_PULSES: usize = 4;
/// Bit times after which a gap ends a raw packet (DESIGN A5).
pub(super) const GAP_BITS: u64 = 45;

/// The bit rate that pulses have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// As measured, in bits a second.
    pub baud: f64,
    /// The usual rate that is nearest, within 2 %.
    pub usual: Option<u32>,
}

impl Measured {
    /// The usual rate, or the measured one.
    #[must_use]
    pub fn rounded(self) -> u32 {
        self.usual.unwrap_or_else(|| libm::round(self.baud) as u32)
    }
}

/// The rate of the line of `mask` (RX or TX): its shortest pulse is a bit, of which all others within a byte are whole
/// multiples; single shorter ones are glitches. `None` where no rate fits nineteen of twenty pulses.
#[must_use]
pub fn measured_baud(records: &[Record], mask: u64, clock_hz: u32) -> Option<Measured> {
    measured_baud_among(records.iter().copied(), mask, clock_hz)
}

/// The same of records that are nowhere together.
pub(super) fn measured_baud_among(
    records: impl Iterator<Item = Record>,
    mask: u64,
    clock_hz: u32,
) -> Option<Measured> {
    let mut lengths = Vec::new();
    let (mut since, mut before) = (None, None);
    for now in records {
        let high = now.levels.has(mask);
        if before.replace(high).is_none_or(|before| before == high) {
            continue;
        }
        if let Some(since) = since.replace(now.cycle.0) {
            lengths.push(now.cycle.0 - since);
        }
        if lengths.len() == MAX_PULSES {
            break;
        }
    }
    lengths.sort_unstable();
    // Up to a twentieth of the pulses may be glitches.
    let candidates = lengths.get(..lengths.len() / 20 + 1).unwrap_or_default();
    let mut tried = 0;
    // Of very many some are enough, with the last, which no glitch is.
    let some = candidates.iter().step_by(candidates.len() / MAX_CANDIDATES + 1);
    for &bit in some.chain(candidates.last()) {
        if bit == tried || bit == 0 {
            continue;
        }
        tried = bit;
        // By short runs first, whose number of bits is sure; what they give counts the bits of longer ones.
        let mut period = bit as f64;
        for most in [1, 2, 4, MAX_BITS] {
            period = refined(&lengths, period, most);
        }
        let within = lengths.iter().take_while(|length| **length as f64 <= period * (MAX_BITS as f64 + 0.5));
        let (mut all, mut fitting) = (0, 0);
        for length in within {
            let bits = libm::round(*length as f64 / period);
            all += 1;
            fitting +=
                usize::from(bits > 0.0 && libm::fabs(*length as f64 - bits * period) <= MAX_OFF * period);
        }
        if fitting * 20 < all * 19 || fitting < MIN_PULSES.min(lengths.len()) {
            continue;
        }
        let baud = f64::from(clock_hz) / period;
        let near = |rate: &u32| {
            libm::fabs(baud - f64::from(*rate)) * 100.0 <= f64::from(*rate) * NEAR_PERCENT as f64
        };
        let off = |rate: &u32| libm::fabs(baud - f64::from(*rate));
        let usual = USUAL.into_iter().filter(near).min_by(|a, b| off(a).total_cmp(&off(b)));
        return Some(Measured { baud, usual });
    }
    None
}

/// The time of a bit, from the pulses of up to `most` bits by what is known of it.
fn refined(lengths: &[u64], period: f64, most: u64) -> f64 {
    let (mut cycles, mut counted) = (0.0, 0.0);
    for length in lengths.iter().map(|length| *length as f64) {
        let bits = libm::round(length / period);
        if bits > most as f64 {
            break;
        }
        if bits > 0.0 && libm::fabs(length - bits * period) <= MAX_OFF * period {
            (cycles, counted) = (cycles + length, counted + bits);
        }
    }
    if counted > 0.0 { cycles / counted } else { period }
}

/// A byte, and where its start bit was seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeardByte {
    /// Where the line went low.
    pub start: Instant,
    /// The byte.
    pub byte: u8,
}

/// What a line says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Heard {
    /// Its bytes.
    pub bytes: Vec<HeardByte>,
    /// Where bytes begin whose stop bit was low.
    pub framing_errors: Vec<Instant>,
}

/// The bytes of the line of `mask` at a rate, as DESIGN A4's receiver hears them.
#[must_use]
pub fn hear(records: &[Record], mask: u64, clock_hz: u32, baud: u32) -> Heard {
    hear_among(records.iter().copied(), mask, clock_hz, baud)
}

/// The same of records that are nowhere together.
pub(super) fn hear_among(
    records: impl Iterator<Item = Record>,
    mask: u64,
    clock_hz: u32,
    baud: u32,
) -> Heard {
    let bit = ((2 * u64::from(clock_hz) + u64::from(baud)) / (2 * u64::from(baud.max(1)))).max(2);
    let mut receiver = Receiver::new(Cycles(bit));
    let mut heard = Heard::default();
    let mut take = |receiver: &Receiver, event: Option<RxEvent>| match event {
        Some(RxEvent::Byte(byte)) => heard.bytes.push(HeardByte { start: receiver.seen(), byte }),
        Some(RxEvent::FramingError) => heard.framing_errors.push(receiver.seen()),
        None => {}
    };
    let (mut now, mut high) = (Instant(0), true);
    let ends = [(Instant::NEVER, true)];
    for (at, level) in records.map(|record| (record.cycle, record.levels.has(mask))).chain(ends) {
        // What the receiver does by itself until the next change.
        loop {
            let due = receiver.deadline(now, high);
            if due >= at || due == Instant::NEVER {
                break;
            }
            let event = receiver.clock(due, high, high);
            take(&receiver, event);
            now = due;
        }
        if at == Instant::NEVER {
            break;
        }
        if level != high || at == receiver.deadline(now, high) {
            let event = receiver.clock(at, high, level);
            take(&receiver, event);
            (now, high) = (at, level);
        }
    }
    heard
}

/// What bytes seem to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guess {
    /// Frames (DESIGN A6).
    Framed {
        /// The address that most of them have, 255 left out.
        address: u8,
        /// Channels, where a frame orders ticks.
        channels: Option<u8>,
        /// Frames with a right check.
        good: u32,
        /// Others.
        bad: u32,
    },
    /// Raw packets of so many bytes (DESIGN A5); the address, if there is one, is the first of them.
    Raw {
        /// Bytes of a packet: those between two gaps.
        length: u8,
        /// Packets of this length.
        good: u32,
        /// Others.
        bad: u32,
    },
    /// Neither.
    Other,
}

/// What bytes seem to be; a bit lasts `bit_cycles`.
#[must_use]
pub fn guess(bytes: &[HeardByte], bit_cycles: u64) -> Guess {
    let framed = framed(bytes);
    if let Guess::Framed { good, bad, .. } = framed
        && good > bad
    {
        return framed;
    }
    raw(bytes, bit_cycles)
}

fn framed(bytes: &[HeardByte]) -> Guess {
    let mut deframer = Deframer::default();
    let (mut good, mut bad, mut channels) = (0, 0, None);
    let mut addresses = vec![0_u32; 256];
    for heard in bytes {
        match deframer.byte(heard.byte) {
            Some(Deframed::Frame(frame)) => {
                good += 1;
                if let Some(count) = addresses.get_mut(usize::from(frame.address)) {
                    *count += 1;
                }
                if frame.kind == Kind::Ticks as u8 {
                    // So many that the ticks of the body come out even.
                    let fits = |channels: &u8| Ticks::parse(frame.body, *channels).is_some();
                    channels = channels.or_else(|| (1..=MAX_CHANNELS as u8).find(fits));
                }
            }
            Some(_) => bad += 1,
            None => {}
        }
    }
    let most = (0..255).max_by_key(|address| (addresses.get(usize::from(*address)).copied(), 255 - *address));
    Guess::Framed { address: most.unwrap_or(0), channels, good, bad }
}

fn raw(bytes: &[HeardByte], bit_cycles: u64) -> Guess {
    let mut lengths = [0_u32; MAX_CHANNELS + 2];
    let mut note = |length: usize| {
        if length > 0 {
            lengths[length.min(MAX_CHANNELS + 1)] += 1;
        }
    };
    let mut length = 0;
    for (index, heard) in bytes.iter().enumerate() {
        let before = index.checked_sub(1).and_then(|before| bytes.get(before));
        let gap = before.is_some_and(|before| heard.start.0 - before.start.0 > (GAP_BITS + 10) * bit_cycles);
        if gap {
            note(length);
            length = 0;
        }
        length += 1;
    }
    note(length);
    let all: u32 = lengths.iter().sum();
    let (length, good) = lengths
        .iter()
        .enumerate()
        .max_by_key(|(length, count)| (**count, MAX_CHANNELS + 2 - length))
        .map_or((0, 0), |(length, count)| (length, *count));
    // Without gaps in most places there are no packets.
    if good * 2 > all && (1..=MAX_CHANNELS + 1).contains(&length) {
        return Guess::Raw { length: length as u8, good, bad: all - good };
    }
    Guess::Other
}

/// Bit of a line in words.
#[must_use]
pub const fn line_name(mask: u64) -> &'static str {
    if mask == Levels::TX { "TX" } else { "RX" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_peripheral::wire::BitTimes;

    /// The levels of bytes sent at `baud`, each so many cycles after the last one's end, on RX.
    fn line(clock_hz: u32, baud: u32, bytes: &[(u8, u64)]) -> Vec<Record> {
        let times = BitTimes::new(clock_hz, baud);
        let record = |cycle, high| Record {
            cycle: Instant(cycle),
            levels: Levels(if high { Levels::RESET.0 } else { Levels::RESET.0 & !Levels::RX }),
        };
        let mut records = vec![record(0, true)];
        let mut at = 0;
        for &(byte, pause) in bytes {
            at += pause;
            let bits = u16::from(byte) << 1 | 1 << 9;
            for bit in 0..10 {
                let high = bits >> bit & 1 == 1;
                if records.last().is_some_and(|last| last.levels.has(Levels::RX) != high) {
                    records.push(record(at + times.bit(bit).0, high));
                }
            }
            at += times.bit(10).0;
        }
        records
    }

    #[test]
    fn a_rate_is_measured_and_the_bytes_are_heard_at_any_rate_and_pause() {
        for (clock_hz, baud, pause) in [
            (16_000_000, 9600, 0),
            (1_000_000, 9600, 7),
            (24_000_000, 1_000_000, 100),
            (2_000_000, 187_500, 3),
        ] {
            let sent: Vec<(u8, u64)> = (0..60_u8)
                .map(|i| (i.wrapping_mul(73) ^ 0x55, if i % 7 == 0 { 50 + pause } else { pause }))
                .collect();
            let records = line(clock_hz, baud, &sent);
            let found = measured_baud(&records, Levels::RX, clock_hz).expect("a line");
            assert!((found.baud / f64::from(baud) - 1.0).abs() < 0.02, "{found:?} of {baud}");
            assert_eq!(found.usual, USUAL.contains(&baud).then_some(baud));
            let heard = hear(&records, Levels::RX, clock_hz, found.rounded());
            assert_eq!(heard.framing_errors, []);
            assert_eq!(
                heard.bytes.iter().map(|heard| heard.byte).collect::<Vec<_>>(),
                sent.iter().map(|sent| sent.0).collect::<Vec<_>>(),
                "{clock_hz} {baud} {pause}"
            );
        }
        assert_eq!(measured_baud(&line(1_000_000, 9600, &[]), Levels::RX, 1_000_000), None);
    }

    #[test]
    fn raw_packets_are_known_by_their_gaps() {
        let bit = 139;
        let packets = |length: usize, count: usize| -> Vec<(u8, u64)> {
            (0..length * count).map(|i| (0x85, if i % length == 0 { 60 * bit } else { 0 })).collect()
        };
        for length in [1, 2, 8, 17] {
            let heard =
                hear(&line(16_000_000, 115_200, &packets(length, 9)), Levels::RX, 16_000_000, 115_200);
            assert_eq!(guess(&heard.bytes, bit), Guess::Raw { length: length as u8, good: 9, bad: 0 });
        }
        let heard = hear(&line(16_000_000, 115_200, &packets(300, 1)), Levels::RX, 16_000_000, 115_200);
        assert_eq!(guess(&heard.bytes, bit), Guess::Raw { length: 17, good: 1, bad: 0 });
        assert_eq!(guess(&[], bit), Guess::Other);
    }
}
