//! Bytes as the framed protocol (DESIGN A6): the decoder agrees in each byte with a simple one that has all
//! bytes at once, and frames, ticks and replies round-trip.

use crc::{CRC_32_ISCSI, Crc};
use stepscope_core::peripheral::wire::frame::{Deframed, Deframer, Frame, Reply, Ticks, emit};

/// Maximum and minimum decoded bytes of a frame.
const MOST: usize = 600;
const LEAST: usize = 6;
/// Maximum bytes of a body: a frame without address, kind and CRC.
const MAX_BODY: usize = MOST - LEAST;

/// Result of a byte: its index among all bytes, and the frame or the name of the fault.
type RowOutcome = (usize, Result<(u8, u8, Vec<u8>), &'static str>);

/// Reads bytes as a stream, and as the contents of a valid frame after this stream.
///
/// # Panics
/// If a property is violated.
pub fn check(data: &[u8]) {
    let found = verdicts(data);
    assert_eq!(found, expected(data));
    for (address, kind, body) in found.into_iter().filter_map(|(_, verdict)| verdict.ok()) {
        read_as_written(Frame { address, kind, body: &body });
    }
    if let [address, kind, body @ ..] = data
        && body.len() <= MAX_BODY
    {
        read_as_written(Frame { address: *address, kind: *kind, body });
        let mut stream = data.to_vec();
        stream.push(0);
        let sent = emit(*address, *kind, body);
        let last = stream.len() + sent.len() - 1;
        stream.extend(sent);
        let after = verdicts(&stream).pop();
        assert_eq!(after, Some((last, Ok((*address, *kind, body.to_vec())))), "after an end mark");
    }
}

/// Frames of all kinds, replies, and streams without frames.
#[must_use]
pub fn seeds() -> Vec<Vec<u8>> {
    let status = [2, 3, 7, 0x82, 0, 1, 0, 0, 0];
    let ticks = [1_u8, 32].map(|count| emit(7, 1, &Ticks::emit(9, 2, &[0x85, 5].repeat(count.into()))));
    let others = (2..=8).map(|kind| emit(255, kind, &[]));
    let acks = (1..=6).map(|kind| emit(7, kind | 0x80, &status));
    let positions = [1, 3, 16, 17]
        .map(|channels| emit(7, 0x87, &[&status[..], &[0x80, 1, 0, 0xff].repeat(channels)].concat()));
    let naks = (1..=7).map(|reason| emit(7, 0xff, &[&[reason][..], &status].concat()));
    let long = [MAX_BODY - 1, MAX_BODY, MAX_BODY + 1].map(|length| emit(0, 1, &vec![1; length]));
    let zeros = emit(0, 0, &vec![0; MAX_BODY]);
    let no_frames = [vec![0, 0, 1, 0], vec![5, 1, 0, 6, 1, 2, 3, 4, 5, 0]];
    ticks
        .into_iter()
        .chain(others)
        .chain(acks)
        .chain(positions)
        .chain(naks)
        .chain(long)
        .chain([zeros])
        .chain(no_frames)
        .collect()
}

/// Result of the core's decoder.
fn verdicts(bytes: &[u8]) -> Vec<RowOutcome> {
    let mut deframer = Deframer::default();
    let of = |deframed: Deframed<'_>| match deframed {
        Deframed::Frame(frame) => Ok((frame.address, frame.kind, frame.body.to_vec())),
        Deframed::Short => Err("short"),
        Deframed::BadCrc { .. } => Err("check"),
        Deframed::Overlong => Err("overlong"),
    };
    let each = bytes.iter().enumerate();
    each.filter_map(|(index, &byte)| Some((index, deframer.byte(byte).map(of)?))).collect()
}

/// Result by A6: run by run, each up to its delimiter.
fn expected(bytes: &[u8]) -> Vec<RowOutcome> {
    let mut verdicts = Vec::new();
    let mut start = 0;
    for run in bytes.split(|byte| *byte == 0) {
        let end = start + run.len();
        let (content, is_cobs) = decoded(run);
        if let Some((index, _)) = content.get(MOST) {
            verdicts.push((start + index, Err("overlong")));
        } else if end < bytes.len() && !run.is_empty() {
            let content: Vec<u8> = content.into_iter().map(|(_, byte)| byte).collect();
            verdicts.push((end, if is_cobs { judged(&content) } else { Err("short") }));
        }
        start = end + 1;
    }
    verdicts
}

/// The decoded bytes of a run, each with the index of the byte that shows it (the next code shows a zero), and
/// whether the run ends at the end of a block.
fn decoded(run: &[u8]) -> (Vec<(usize, u8)>, bool) {
    let mut content = Vec::new();
    let mut code_at = 0;
    while let Some(&code) = run.get(code_at) {
        let next = code_at + usize::from(code);
        content.extend((code_at + 1..next).filter_map(|index| Some((index, *run.get(index)?))));
        if next > run.len() {
            return (content, false);
        }
        if code < 255 && next < run.len() {
            content.push((next, 0));
        }
        code_at = next;
    }
    (content, true)
}

fn judged(content: &[u8]) -> Result<(u8, u8, Vec<u8>), &'static str> {
    let Some((held, check)) = content.split_last_chunk::<4>() else { return Err("short") };
    match held {
        [address, kind, body @ ..] if check_of(held) == *check => Ok((*address, *kind, body.to_vec())),
        [_, _, ..] => Err("check"),
        _ => Err("short"),
    }
}

fn check_of(held: &[u8]) -> [u8; 4] {
    Crc::<u32>::new(&CRC_32_ISCSI).checksum(held).to_le_bytes()
}

/// The contents of a frame round-trip.
fn read_as_written(frame: Frame<'_>) {
    if let Some(reply) = Reply::parse(frame) {
        let told = frame.positions();
        let sent = reply.emit(told.as_ref());
        let mut deframer = Deframer::default();
        let again = sent.iter().find_map(|&byte| match deframer.byte(byte) {
            Some(Deframed::Frame(frame)) => Some((Reply::parse(frame), frame.positions())),
            _ => None,
        });
        assert_eq!(again, Some((Some(reply), told)));
    }
    for channels in 1..=16 {
        if let Some(ticks) = Ticks::parse(frame.body, channels) {
            assert!((1..=32).contains(&ticks.count()), "{} ticks", ticks.count());
            assert_eq!(ticks.iter().count(), ticks.count());
            assert_eq!(Ticks::emit(ticks.seq, channels, ticks.commands()), frame.body);
        }
    }
}
