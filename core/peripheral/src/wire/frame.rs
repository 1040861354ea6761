//! Frames of the framed protocol, with CRC and delimiter (DESIGN A6).
//!
//! ```text
//! wire     COBS( address kind body crc ) 00
//! crc      CRC-32/ISCSI (Castagnoli) over address, kind and body, little-endian
//! ```
//!
//! The controller decodes frames and encodes replies; the host does the opposite.
//!
//! ```
//! use stepscope_peripheral::{protocol::Kind, wire::frame::{Deframed, Deframer, Ticks, emit}};
//!
//! // Two ticks of one channel of controller 7: 5 steps right, 3 left.
//! let wire = emit(7, Kind::Ticks as u8, &Ticks::emit(0, 1, &[0x85, 0x03]));
//! let mut deframer = Deframer::default();
//! let (last, bytes) = wire.split_last().expect("a delimiter");
//! assert!(bytes.iter().all(|&byte| deframer.byte(byte).is_none()));
//! let Some(Deframed::Frame(frame)) = deframer.byte(*last) else { panic!("a frame") };
//! let ticks = Ticks::parse(frame.body, 1).expect("a body of TICKS");
//! assert_eq!((frame.address, ticks.seq, ticks.commands()), (7, 0, &[0x85, 0x03][..]));
//! ```

pub use crate::protocol::{Kind, MAX_TICKS, Reason, Reply, State, Status};
use crate::signal::{MAX_CHANNELS, Positions};
use crate::wire::cobs::{CobsByte, CobsDecoder};
use crate::wire::packet::Tick;
use alloc::vec::Vec;
use crc::{CRC_32_ISCSI, Crc};

pub const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);
pub const DELIMITER: u8 = 0;

/// Encodes `content` (address, kind, body) with CRC, COBS and delimiter.
pub fn encode_frame(content: &[u8]) -> Vec<u8> {
    let mut content = content.to_vec();
    content.extend(CRC.checksum(&content).to_le_bytes());
    let mut wire = cobs::encode_vec(&content);
    wire.push(DELIMITER);
    wire
}

pub const CRC_LEN: usize = 4;
/// Minimum decoded bytes of a frame: address, kind and CRC.
pub const MIN_DECODED: usize = 2 + CRC_LEN;
pub const MAX_DECODED: usize = 600;
/// Maximum bytes of a body.
pub const MAX_BODY: usize = MAX_DECODED - MIN_DECODED;
pub const STATUS_LEN: usize = 9;
pub const POSITION_LEN: usize = 4;
/// Bytes of an ACK on the wire, with COBS and delimiter; POSITIONS adds its counters.
pub const ACK_LEN: usize = MIN_DECODED + STATUS_LEN + 2;
/// Bytes of a NAK on the wire: an ACK and the reason.
pub const NAK_LEN: usize = ACK_LEN + 1;
/// Maximum bytes of a reply on the wire: POSITIONS with all channels.
pub const REPLY_LEN: usize = reply_len(Kind::Positions, MAX_CHANNELS as u8);
/// Maximum bytes of content that COBS encodes with one additional byte.
const COBS_RUN: usize = 254;
/// Bit in the kind of a positive reply.
pub const ACK: u8 = 0x80;
/// Kind of a negative reply.
pub const NAK: u8 = 0xff;

const _: () = assert!(MIN_DECODED + 2 + MAX_TICKS as usize * MAX_CHANNELS <= MAX_DECODED);
const _: () = assert!(ACK_LEN == 17 && NAK_LEN == 18 && REPLY_LEN == 81);
// Without the COBS byte and the delimiter, a reply is a single COBS run.
const _: () = assert!(REPLY_LEN - 2 <= COBS_RUN);
// Kinds, their acknowledgements and NAK are distinct.
const _: () = {
    let mut index = 0;
    while index < Kind::ALL.len() {
        assert!((Kind::ALL[index] as u8) & ACK == 0 && Kind::ALL[index] as u8 | ACK != NAK);
        index += 1;
    }
};

/// Maximum bytes on the wire of a reply to a frame of this kind.
pub const fn reply_len(kind: Kind, channels: u8) -> usize {
    let positions = if matches!(kind, Kind::Positions) { POSITION_LEN * channels as usize } else { 0 };
    if ACK_LEN + positions > NAK_LEN { ACK_LEN + positions } else { NAK_LEN }
}

fn emit_status(status: &Status) -> [u8; STATUS_LEN] {
    let [f0, f1] = status.faults.to_le_bytes();
    let [t0, t1, t2, t3] = status.ticks_done.to_le_bytes();
    [status.state as u8, status.free, status.expected_seq, f0, f1, t0, t1, t2, t3]
}

fn parse_status(bytes: &[u8]) -> Option<Status> {
    let &[state, free, expected_seq, f0, f1, t0, t1, t2, t3] = bytes else { return None };
    Some(Status {
        state: State::parse(state)?,
        free,
        expected_seq,
        faults: u16::from_le_bytes([f0, f1]),
        ticks_done: u32::from_le_bytes([t0, t1, t2, t3]),
    })
}

impl Reply {
    /// Encodes the reply; `positions` for the ACK of POSITIONS only.
    pub fn emit(&self, positions: Option<&Positions>) -> Vec<u8> {
        debug_assert_eq!(positions.is_some(), self.result == Ok(Kind::Positions), "{self:?}");
        let (kind, reason) = match self.result {
            Ok(kind) => (kind as u8 | ACK, None),
            Err(reason) => (NAK, Some(reason as u8)),
        };
        let mut body: Vec<u8> = reason.into_iter().collect();
        body.extend(emit_status(&self.status));
        let counters = positions.into_iter().flat_map(Positions::as_slice);
        body.extend(counters.flat_map(|counter| counter.to_le_bytes()));
        emit(self.address, kind, &body)
    }

    /// Decodes a reply; [`Frame::positions`] has its position counters.
    pub fn parse(frame: Frame<'_>) -> Option<Self> {
        parse_reply(frame).map(|(reply, _)| reply)
    }
}

fn parse_reply(frame: Frame<'_>) -> Option<(Reply, Option<Positions>)> {
    let (result, content) = if frame.kind == NAK {
        let (&reason, content) = frame.body.split_first()?;
        (Err(Reason::parse(reason)?), content)
    } else {
        (Ok(Kind::parse(frame.kind & !ACK).filter(|_| frame.kind & ACK != 0)?), frame.body)
    };
    let (status, rest) = content.split_at_checked(STATUS_LEN)?;
    let positions = match (result, rest) {
        (Ok(Kind::Positions), counters) => Some(parse_positions(counters)?),
        (_, []) => None,
        _ => return None,
    };
    Some((Reply { address: frame.address, result, status: parse_status(status)? }, positions))
}

fn parse_positions(bytes: &[u8]) -> Option<Positions> {
    let (counters, []) = bytes.as_chunks::<POSITION_LEN>() else { return None };
    let mut all = [0; MAX_CHANNELS];
    let used = all.get_mut(..counters.len())?;
    used.iter_mut().zip(counters).for_each(|(counter, bytes)| *counter = i32::from_le_bytes(*bytes));
    Positions::new(used)
}

/// A frame with a valid CRC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Address of the controller, or the broadcast address.
    pub address: u8,
    /// Byte of the kind, known or not.
    pub kind: u8,
    /// What follows the kind, without the CRC.
    pub body: &'a [u8],
}

impl Frame<'_> {
    /// The position counters in an ACK of POSITIONS.
    pub fn positions(&self) -> Option<Positions> {
        parse_reply(*self)?.1
    }
}

/// Encodes a frame ([`encode_frame`]).
pub fn emit(address: u8, kind: u8, body: &[u8]) -> Vec<u8> {
    let mut content = alloc::vec![address, kind];
    content.extend_from_slice(body);
    encode_frame(&content)
}

/// Decodes the bytes of one frame, as from [`emit`]; the delimiter may be missing. Returns address, kind and body; `None` if
/// COBS or CRC are wrong, or if there is more than one frame.
pub fn decode_frame(wire: &[u8]) -> Option<(u8, u8, Vec<u8>)> {
    let bytes = wire.strip_suffix(&[DELIMITER]).unwrap_or(wire);
    let mut deframer = Deframer::default();
    if bytes.iter().any(|byte| deframer.byte(*byte).is_some()) {
        return None;
    }
    match deframer.byte(DELIMITER) {
        Some(Deframed::Frame(Frame { address, kind, body })) => Some((address, kind, body.to_vec())),
        _ => None,
    }
}

/// The body of a TICKS frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ticks<'a> {
    pub seq: u8,
    channels: usize,
    commands: &'a [u8],
}

impl<'a> Ticks<'a> {
    /// Decodes the body for a controller with `channels` channels; `None` is BAD_BODY.
    pub fn parse(body: &'a [u8], channels: u8) -> Option<Self> {
        let (&[seq, count], commands) = body.split_first_chunk()?;
        let channels = usize::from(channels.max(1));
        let fits = (1..=MAX_TICKS).contains(&count) && commands.len() == usize::from(count) * channels;
        fits.then_some(Self { seq, channels, commands })
    }

    /// The body for ticks of `channels` bytes each.
    pub fn emit(seq: u8, channels: u8, commands: &[u8]) -> Vec<u8> {
        let count = commands.len() / usize::from(channels.max(1));
        debug_assert!(count <= MAX_TICKS.into(), "{count} ticks in a frame");
        let mut body = alloc::vec![seq, count as u8];
        body.extend_from_slice(commands);
        body
    }

    /// Number of ticks, 1..=32.
    pub fn count(&self) -> usize {
        self.commands.len() / self.channels
    }

    /// The commands of all ticks, one byte per channel and tick.
    pub const fn commands(&self) -> &'a [u8] {
        self.commands
    }

    pub fn iter(&self) -> impl Iterator<Item = Tick> + use<'a> {
        self.commands.chunks(self.channels).map(|commands| {
            let mut tick = [0; MAX_CHANNELS];
            tick.iter_mut().zip(commands).for_each(|(command, &byte)| *command = byte);
            tick
        })
    }
}

/// What a byte completed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deframed<'a> {
    Frame(Frame<'a>),
    /// Invalid COBS, or fewer than [`MIN_DECODED`] bytes.
    Short,
    BadCrc {
        found: u32,
        expected: u32,
    },
    /// Too long; bytes are dropped up to the next delimiter.
    Overlong,
}

/// Assembles frames from bytes.
#[derive(Clone, Debug)]
pub struct Deframer {
    cobs: CobsDecoder,
    /// Invariant: at most [`MAX_DECODED`].
    content: Vec<u8>,
    /// Bytes are dropped up to the next delimiter.
    dropping: bool,
}

impl Default for Deframer {
    fn default() -> Self {
        Self { cobs: CobsDecoder::default(), content: Vec::with_capacity(MAX_DECODED), dropping: false }
    }
}

impl Deframer {
    /// Takes a byte; returns what it completes.
    pub fn byte(&mut self, byte: u8) -> Option<Deframed<'_>> {
        if self.dropping {
            self.dropping = byte != DELIMITER;
            return None;
        }
        let content = match self.cobs.byte(byte) {
            CobsByte::Content => byte,
            CobsByte::Zero => 0,
            CobsByte::Overhead => return None,
            CobsByte::First => {
                self.content.clear();
                return None;
            }
            CobsByte::End => return Some(check_crc(&self.content)),
            CobsByte::Broken => return Some(Deframed::Short),
        };
        if self.content.len() == MAX_DECODED {
            self.cobs = CobsDecoder::default();
            self.dropping = true;
            return Some(Deframed::Overlong);
        }
        self.content.push(content);
        None
    }

    pub const fn is_open(&self) -> bool {
        self.dropping || self.cobs.is_open()
    }
}

fn check_crc(content: &[u8]) -> Deframed<'_> {
    match content.split_last_chunk::<CRC_LEN>() {
        Some((frame, crc)) if content.len() >= MIN_DECODED => {
            let (found, expected) = (u32::from_le_bytes(*crc), CRC.checksum(frame));
            match *frame {
                [address, kind, ref body @ ..] if found == expected => {
                    Deframed::Frame(Frame { address, kind, body })
                }
                _ => Deframed::BadCrc { found, expected },
            }
        }
        _ => Deframed::Short,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn last(deframer: &mut Deframer, bytes: &[u8]) -> Option<(u8, u8, Vec<u8>)> {
        let mut found = None;
        for &byte in bytes {
            if let Some(Deframed::Frame(frame)) = deframer.byte(byte) {
                found = Some((frame.address, frame.kind, frame.body.to_vec()));
            }
        }
        found
    }

    #[test]
    fn emit_and_parse_are_inverses() {
        let mut deframer = Deframer::default();
        for len in [0, 1, 7, 246, 247, 248, 249, 250, 251, 252, 253, 254, 255, 508, 594] {
            for fill in [0_u8, 1, 0xff] {
                let body: Vec<u8> = (0..len).map(|i| if i % 97 == 5 { !fill } else { fill }).collect();
                let wire = emit(7, 0x42, &body);
                assert_eq!(wire.iter().filter(|&&byte| byte == DELIMITER).count(), 1);
                let found = Some((7, 0x42, body));
                assert_eq!(last(&mut deframer, &wire), found, "{len} x {fill}");
                assert_eq!(decode_frame(&wire), found, "{len} x {fill}");
                assert_eq!(decode_frame(&wire[..wire.len() - 1]), found, "{len} x {fill}");
                assert_eq!(decode_frame(&[wire.clone(), wire].concat()), None, "{len} x {fill}");
            }
        }
    }

    #[test]
    fn what_is_no_frame_is_not_decoded() {
        let mut wire = emit(7, 4, &[1, 2, 3]);
        assert_eq!(decode_frame(&[]), None);
        assert_eq!(decode_frame(&[DELIMITER]), None);
        assert_eq!(decode_frame(&wire[1..]), None);
        wire[3] ^= 1;
        assert_eq!(decode_frame(&wire), None);
        assert_eq!(decode_frame(&[1; 1000]), None);
    }

    #[test]
    fn frames_and_replies_have_the_bytes_of_the_contract() {
        assert_eq!(CRC.checksum(b"123456789"), 0xe306_9283, "the published value of CRC-32/ISCSI");
        let with_cobs = |content: &[u8]| {
            let crc = CRC.checksum(content).to_le_bytes();
            let mut wire = cobs::encode_vec(&[content, &crc].concat());
            wire.push(0);
            wire
        };
        assert_eq!(emit(7, Kind::Status as u8, &[]), with_cobs(&[7, 4]));
        assert_eq!(emit(7, Kind::Status as u8, &[]).len(), 8);
        let status = Status {
            state: State::Stopped,
            free: 5,
            expected_seq: 6,
            faults: 0x0180,
            ticks_done: 0x0102_0304,
        };
        let bytes = [3, 5, 6, 0x80, 0x01, 4, 3, 2, 1];
        let ack = Reply { address: 9, result: Ok(Kind::Stop), status };
        assert_eq!(ack.emit(None), with_cobs(&[&[9, 0x85], bytes.as_slice()].concat()));
        let nak = Reply { address: 9, result: Err(Reason::QueueFull), status };
        assert_eq!(nak.emit(None), with_cobs(&[&[9, 0xff, 2], bytes.as_slice()].concat()));
        assert_eq!((ack.emit(None).len(), nak.emit(None).len()), (17, 18));
        let positions = Positions::new(&[3, -1200, i32::MIN]).expect("three channels");
        let counters = [3, 0, 0, 0, 0x50, 0xfb, 0xff, 0xff, 0, 0, 0, 0x80];
        let reply = Reply { address: 9, result: Ok(Kind::Positions), status };
        assert_eq!(
            reply.emit(Some(&positions)),
            with_cobs(&[&[9, 0x87], bytes.as_slice(), &counters].concat())
        );
    }

    #[test]
    fn reply_length_depends_on_kind_and_channels() {
        let status = Status { state: State::Ready, free: 1, expected_seq: 1, faults: 0, ticks_done: 0 };
        for channels in 1..=16 {
            for fill in [0, -1, 0x0101_0101] {
                let positions = Positions::new(&[fill; 16][..channels]);
                let reply = Reply { address: 9, result: Ok(Kind::Positions), status };
                let length = 17 + 4 * channels;
                assert_eq!(reply.emit(positions.as_ref()).len(), length, "{channels} x {fill}");
                assert_eq!(reply_len(Kind::Positions, channels as u8), length);
            }
            assert_eq!(reply_len(Kind::Status, channels as u8), 18, "a NAK");
        }
        assert_eq!(REPLY_LEN, 81);
    }

    #[test]
    fn a_ticks_body_is_validated_by_its_count_and_its_length() {
        // Body, channels, ticks and first byte of each.
        type Row<'a> = (&'a [u8], u8, Option<&'a [u8]>);
        let long = [&[3, 32], [1; 64].as_slice()].concat();
        let too_long = [&[3, 33], [1; 66].as_slice()].concat();
        let rows: [Row<'_>; 8] = [
            (&[], 2, None),
            (&[1], 2, None),
            (&[1, 0], 2, None),
            (&[1, 1, 5], 2, None),
            (&[1, 1, 5, 6], 2, Some(&[5])),
            (&[1, 2, 5, 6, 7, 8], 2, Some(&[5, 7])),
            (&long, 2, Some(&[1; 32])),
            (&too_long, 2, None),
        ];
        for (body, channels, expected) in rows {
            let ticks = Ticks::parse(body, channels);
            let firsts = ticks.map(|ticks| ticks.iter().map(|tick| tick[0]).collect::<Vec<_>>());
            assert_eq!(firsts.as_deref(), expected, "{body:?}");
            if let Some(ticks) = ticks {
                assert_eq!(
                    (ticks.seq, ticks.count(), ticks.commands()),
                    (body[0], body[1].into(), &body[2..])
                );
                assert_eq!(Ticks::emit(ticks.seq, channels, ticks.commands()), body);
            }
        }
    }

    #[test]
    fn frames_that_are_no_replies_are_rejected() {
        let body = [1; STATUS_LEN];
        // Kind, body, whether it is one.
        let longer = |by: usize| [&body, [1; 68].get(..by).expect("at most 68")].concat();
        let rows: [(u8, &[u8], bool); 16] = [
            (0x87, &longer(4), true),
            (0x87, &longer(64), true),
            (0x87, &body, false),
            (0x87, &longer(3), false),
            (0x87, &longer(5), false),
            (0x87, &longer(68), false),
            (0x87, &body[1..], false),
            (0x07, &longer(4), false),
            (0x84, &longer(4), false),
            (0x84, &body, true),
            (0x04, &body, false),
            (0x80, &body, false),
            (0x84, &body[1..], false),
            (0xff, &[&[7], body.as_slice()].concat(), true),
            (0xff, &[&[8], body.as_slice()].concat(), false),
            (0xff, &[], false),
        ];
        for (kind, body, expected) in rows {
            let frame = Frame { address: 1, kind, body };
            assert_eq!(Reply::parse(frame).is_some(), expected, "{kind:#x} {body:?}");
            assert_eq!(frame.positions().is_some(), expected && kind == 0x87, "{kind:#x} {body:?}");
        }
    }

    #[test]
    fn encoding_and_decoding_replies_are_inverses() {
        let status =
            Status { state: State::Moving, free: 3, expected_seq: 0, faults: 0x82, ticks_done: 0x0100_0000 };
        let (kinds, reasons) = (Kind::ALL.iter().copied().map(Ok), Reason::ALL.iter().copied().map(Err));
        for (result, channels) in kinds.chain(reasons).flat_map(|result| [(result, 1), (result, 16)]) {
            let reply = Reply { address: 9, result, status };
            let counters = [0, 1, -1, i32::MIN, i32::MAX, 256, -256, 7, 0, 0, 0, 0, 0, 0, 0, 9];
            let positions = Positions::new(&counters[..channels]).filter(|_| result == Ok(Kind::Positions));
            let wire = reply.emit(positions.as_ref());
            assert!(wire.len() <= REPLY_LEN);
            let mut deframer = Deframer::default();
            let parsed = wire.iter().find_map(|&byte| match deframer.byte(byte) {
                Some(Deframed::Frame(frame)) => Some((Reply::parse(frame), frame.positions())),
                _ => None,
            });
            assert_eq!(parsed, Some((Some(reply), positions)));
        }
    }

    /// The results of `bytes`, each with the index of the byte that completed it.
    fn outcomes(bytes: &[u8]) -> Vec<(usize, &'static str)> {
        let mut deframer = Deframer::default();
        let mut found = Vec::new();
        for (index, &byte) in bytes.iter().enumerate() {
            let name = match deframer.byte(byte) {
                None => continue,
                Some(Deframed::Frame(_)) => "frame",
                Some(Deframed::Short) => "short",
                Some(Deframed::BadCrc { .. }) => "bad CRC",
                Some(Deframed::Overlong) => "overlong",
            };
            found.push((index, name));
        }
        found
    }

    #[test]
    fn invalid_frames_are_reported_at_the_byte_that_shows_it() {
        assert_eq!(outcomes(&[0, 0, 0]), []);
        assert_eq!(outcomes(&[1, 0]), [(1, "short")]);
        assert_eq!(outcomes(&[5, 1, 0]), [(2, "short")], "not COBS");
        assert_eq!(outcomes(&[6, 1, 2, 3, 4, 5, 0]), [(6, "short")], "five bytes");
        assert_eq!(outcomes(&[7, 1, 2, 3, 4, 5, 6, 0]), [(7, "bad CRC")], "six bytes");
    }

    #[test]
    fn the_601st_byte_is_too_many_even_as_an_implied_zero() {
        // A code of 2 stands for one byte and a zero; the zero counts only if the frame goes on.
        let mut implied: Vec<u8> = [2, 1].repeat(300);
        implied.extend([0]);
        assert_eq!(outcomes(&implied), [(600, "bad CRC")], "599 bytes, without the last zero");
        let mut implied: Vec<u8> = [2, 1].repeat(300);
        implied.extend([2, 1, 0, 2, 1, 0]);
        assert_eq!(
            outcomes(&implied),
            [(601, "overlong"), (605, "short")],
            "the 600th byte is a zero, the next is too many"
        );
        // 254 + 254 + 92 bytes are 600; the code after them stands for a zero, the 601st.
        let mut full = Vec::new();
        for len in [254_usize, 254, 92] {
            full.push(len as u8 + 1);
            full.extend(core::iter::repeat_n(1, len));
        }
        let overlong = full.len();
        full.extend([1, 0]);
        assert_eq!(outcomes(&full), [(overlong, "overlong")]);
    }
}
