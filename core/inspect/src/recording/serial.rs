//! Bytes on a recorded line: bit rate, framing, and protocol (DESIGN A5, A6).

use alloc::{collections::BTreeSet, vec, vec::Vec};
use stepscope_capture::uart::{Edge, Estimate, Fault, Format, decode, estimate};
use stepscope_peripheral::signal::{Levels, MAX_CHANNELS};
use stepscope_peripheral::wire::frame::{Deframed, Deframer, Ticks};
use stepscope_peripheral::{protocol::Kind, signal::Record, units::Instant};

pub(super) const MEASURED_EDGES: usize = 4000;
/// Gap in bit times that ends a raw packet.
pub(super) const GAP_BITS: u64 = 45;

/// A measured bit rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    pub baud: f64,
    /// The nearest usual rate within 2 %.
    pub usual: Option<u32>,
}

impl Measured {
    pub(super) fn of(found: Estimate, clock_hz: u32) -> Self {
        Self { baud: f64::from(clock_hz) / found.measured, usual: found.usual }
    }

    /// The usual rate, or the measured one as a whole number.
    pub fn rounded(self) -> u32 {
        self.usual.unwrap_or_else(|| libm::round(self.baud) as u32)
    }
}

/// How to decode a line; without `baud` its rate is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineOptions {
    pub baud: Option<u32>,
    pub format: Format,
}

/// The bit rate of an 8N1 line (RX or TX); `None` if none or several fit.
pub fn measured_baud(records: &[Record], mask: u64, clock_hz: u32) -> Option<Measured> {
    let edges: Vec<Edge> = edges(records.iter().copied(), mask).take(MEASURED_EDGES).collect();
    let found = estimate(&edges, Format::default(), Some(clock_hz.into())).ok()?;
    Some(Measured::of(found, clock_hz))
}

pub(super) fn edges(records: impl Iterator<Item = Record>, mask: u64) -> impl Iterator<Item = Edge> {
    let mut before = None;
    records.filter_map(move |record| {
        let high = record.levels.has(mask);
        let changes = before.replace(high).is_some_and(|before| before != high);
        changes.then_some(Edge { at: record.cycle.0, high })
    })
}

/// Minimum words to detect a format; fewer may have the same parity by chance.
const FORMAT_WORDS: usize = 8;
const PARITY_WORDS: u32 = 6;

/// The parity of 7 data bits: `E` or `O`; `None` without one, or with too few different bytes.
pub(super) fn seven_bit_parity(bytes: &[DecodedByte]) -> Option<char> {
    let mut seen = [0_u64; 4];
    let (mut even, mut odd) = (true, true);
    for decoded in bytes {
        let is_even = decoded.byte.count_ones().is_multiple_of(2);
        (even, odd) = (even && is_even, odd && !is_even);
        if let Some(word) = seen.get_mut(usize::from(decoded.byte >> 6)) {
            *word |= 1 << (decoded.byte & 63);
        }
    }
    if bytes.len() < FORMAT_WORDS || seen.iter().map(|word| word.count_ones()).sum::<u32>() < PARITY_WORDS {
        return None;
    }
    if even { Some('E') } else { odd.then_some('O') }
}

/// Whether all bytes look like 7-bit text with a stop bit or pause as the eighth bit.
pub(super) fn looks_like_seven_bit_text(bytes: &[DecodedByte]) -> bool {
    let is_text = |decoded: &&DecodedByte| matches!(decoded.byte & 0x7f, b' '..=b'~' | b'\r' | b'\n' | b'\t');
    bytes.len() >= FORMAT_WORDS
        && bytes.iter().all(|decoded| decoded.byte & 0x80 != 0)
        && bytes.iter().map(|decoded| decoded.byte).collect::<BTreeSet<u8>>().len() >= 4
        && bytes.iter().filter(is_text).count() * 10 >= bytes.len() * 9
}

/// A byte with the time of its start bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DecodedByte {
    pub start: Instant,
    pub byte: u8,
}

/// The bytes and errors of a serial line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DecodedLine {
    pub bytes: Vec<DecodedByte>,
    pub framing_errors: Vec<Instant>,
    pub parity_errors: Vec<Instant>,
}

/// The bytes of an 8N1 line at a rate.
pub fn decode_line(records: &[Record], mask: u64, clock_hz: u32, baud: u32) -> DecodedLine {
    let bit = f64::from(clock_hz) / f64::from(baud.max(1));
    decode_records(records.iter().copied(), mask, bit, Format::default())
}

pub(super) fn decode_records(
    records: impl Iterator<Item = Record>,
    mask: u64,
    bit: f64,
    format: Format,
) -> DecodedLine {
    let mut decoded = DecodedLine::default();
    decode(edges(records, mask), bit, format, |word| {
        let start = Instant(word.start);
        match word.fault {
            None => decoded.bytes.push(DecodedByte { start, byte: word.byte }),
            Some(Fault::Framing) => decoded.framing_errors.push(start),
            Some(Fault::Parity) => decoded.parity_errors.push(start),
        }
    });
    decoded
}

/// The detected protocol of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Guess {
    /// Frames with a valid CRC and without.
    Framed {
        /// The most frequent address except 255.
        address: u8,
        channels: Option<u8>,
        good: u32,
        bad: u32,
    },
    /// Raw packets: the most frequent length, with address, and the packets with that and other lengths.
    Raw { length: u8, good: u32, bad: u32 },
    #[default]
    Other,
}

/// Detects the protocol; a bit lasts `bit_cycles`.
pub fn guess(bytes: &[DecodedByte], bit_cycles: u64) -> Guess {
    let framed = framed(bytes);
    if let Guess::Framed { good, bad, .. } = framed
        && good > bad
    {
        return framed;
    }
    raw(bytes, bit_cycles)
}

fn framed(bytes: &[DecodedByte]) -> Guess {
    let mut deframer = Deframer::default();
    let (mut good, mut bad, mut channels) = (0, 0, None);
    let mut addresses = vec![0_u32; 256];
    for decoded in bytes {
        match deframer.byte(decoded.byte) {
            Some(Deframed::Frame(frame)) => {
                good += 1;
                if let Some(count) = addresses.get_mut(usize::from(frame.address)) {
                    *count += 1;
                }
                if frame.kind == Kind::Ticks as u8 {
                    let fits = |channels: &u8| Ticks::parse(frame.body, *channels).is_some();
                    channels = channels.or_else(|| (1..=MAX_CHANNELS as u8).find(fits));
                }
            }
            Some(_) => bad += 1,
            None => {}
        }
    }
    let frequent =
        (0..255).max_by_key(|address| (addresses.get(usize::from(*address)).copied(), 255 - *address));
    Guess::Framed { address: frequent.unwrap_or(0), channels, good, bad }
}

fn raw(bytes: &[DecodedByte], bit_cycles: u64) -> Guess {
    let mut lengths = [0_u32; MAX_CHANNELS + 2];
    let mut note = |length: usize| {
        if length > 0 {
            lengths[length.min(MAX_CHANNELS + 1)] += 1;
        }
    };
    let mut length = 0;
    for (index, decoded) in bytes.iter().enumerate() {
        let before = index.checked_sub(1).and_then(|before| bytes.get(before));
        let gap =
            before.is_some_and(|before| decoded.start.0 - before.start.0 > (GAP_BITS + 10) * bit_cycles);
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
    // Without gaps in most positions there are no packets.
    if good * 2 > all && (1..=MAX_CHANNELS + 1).contains(&length) {
        return Guess::Raw { length: length as u8, good, bad: all - good };
    }
    Guess::Other
}

pub const fn line_name(mask: u64) -> &'static str {
    if mask == Levels::TX { "TX" } else { "RX" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_peripheral::wire::BitTimes;

    /// The levels of RX for bytes sent at `baud`, each with the idle cycles before it.
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
    fn bytes_are_decoded_at_any_rate_and_pause() {
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
            assert_eq!(found.usual, (baud != 187_500).then_some(baud));
            let decoded = decode_line(&records, Levels::RX, clock_hz, found.rounded());
            assert_eq!(decoded.framing_errors, []);
            assert_eq!(
                decoded.bytes.iter().map(|decoded| decoded.byte).collect::<Vec<_>>(),
                sent.iter().map(|sent| sent.0).collect::<Vec<_>>(),
                "{clock_hz} {baud} {pause}"
            );
        }
        assert_eq!(measured_baud(&line(1_000_000, 9600, &[]), Levels::RX, 1_000_000), None);
    }

    #[test]
    fn seven_bits_are_detected_by_text() {
        let decoded = |bytes: &[u8]| -> Vec<DecodedByte> {
            bytes.iter().map(|byte| DecodedByte { start: Instant(0), byte: *byte }).collect()
        };
        let top = |text: &[u8]| decoded(&text.iter().map(|byte| byte | 0x80).collect::<Vec<_>>());
        assert!(looks_like_seven_bit_text(&top(b"G1 X10\r\n")));
        assert!(!looks_like_seven_bit_text(&top(b"G1 X10\n")));
        assert!(!looks_like_seven_bit_text(&top(b"AAAAAAAAAA")));
        assert!(!looks_like_seven_bit_text(&decoded(b"G1 X10\r\n")));
        assert!(!looks_like_seven_bit_text(&top(&[1, 5, 1, 5, 1, 5, 1, 5, 1])));
        let even = |text: &[u8]| -> Vec<DecodedByte> {
            let parity = |byte: &u8| if byte.count_ones() % 2 == 1 { byte | 0x80 } else { *byte };
            decoded(&text.iter().map(parity).collect::<Vec<_>>())
        };
        assert_eq!(seven_bit_parity(&even(b"G1 X10\r\n")), Some('E'));
        assert_eq!(seven_bit_parity(&even(b"ABABABABAB")), None);
    }

    #[test]
    fn raw_packets_are_detected_by_gaps() {
        let bit = 139;
        let packets = |length: usize, count: usize| -> Vec<(u8, u64)> {
            (0..length * count).map(|i| (0x85, if i % length == 0 { 60 * bit } else { 0 })).collect()
        };
        for length in [1, 2, 8, 17] {
            let decoded =
                decode_line(&line(16_000_000, 115_200, &packets(length, 9)), Levels::RX, 16_000_000, 115_200);
            assert_eq!(guess(&decoded.bytes, bit), Guess::Raw { length: length as u8, good: 9, bad: 0 });
        }
        let decoded =
            decode_line(&line(16_000_000, 115_200, &packets(300, 1)), Levels::RX, 16_000_000, 115_200);
        assert_eq!(guess(&decoded.bytes, bit), Guess::Raw { length: 17, good: 1, bad: 0 });
        assert_eq!(guess(&[], bit), Guess::Other);
    }
}
