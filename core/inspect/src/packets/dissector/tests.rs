//! Fields of frames that the host and the controller encode.

use super::*;
use stepscope_peripheral::{
    protocol::{FrameOutcome, State, Status},
    signal::PacketOutcome,
    wire::frame::emit,
};

const FRAME: RowOutcome = RowOutcome::Frame(FrameOutcome::OtherAddress);

fn read(protocol: Protocol, addressed: bool, bytes: &[u8], outcome: RowOutcome) -> Dissection {
    let meaning = Dissector { protocol, addressed, channels: &|_| 2 }.dissect(bytes, outcome);
    let mut end = 0;
    for field in &meaning.fields {
        assert!(end <= field.bytes.start && field.bytes.start < field.bytes.end, "{meaning:?}");
        end = field.bytes.end;
    }
    assert!(end <= bytes.len());
    meaning
}

/// One line `name bytes value` per field.
fn lines_of(meaning: &Dissection) -> Vec<String> {
    let line = |field: &Field| format!("{} {:?} {}", field.name, field.bytes, field.value);
    meaning.fields.iter().map(line).collect()
}

#[test]
fn a_raw_packet_has_one_command_per_channel() {
    let packet = RowOutcome::Packet(PacketOutcome::Queued);
    let plain = read(Protocol::Raw, false, &[0x85, 0x05, 0x80], packet);
    assert_eq!(lines_of(&plain), ["ch0 0..1 +5", "ch1 1..2 \u{2212}5", "ch2 2..3 0, right"]);
    assert_eq!(plain.crc, CrcCheck::None);
    let addressed = read(Protocol::Raw, true, &[255, 0], RowOutcome::Short);
    assert_eq!(lines_of(&addressed), ["address 0..1 255, all", "ch0 1..2 0, left"]);
    assert_eq!(
        lines_of(&read(Protocol::Raw, true, &[1, 2], RowOutcome::Ignored)),
        ["ignored 0..2 until a gap"]
    );
}

/// One line `name: high-low levels name value` per group of bits.
fn bits_of(meaning: &Dissection) -> Vec<String> {
    let line = |of: &str, BitGroup { high, low, levels, name, value }: &BitGroup| {
        format!("{of}: {high}-{low} {levels} {name} {value}")
    };
    let fields = meaning.fields.iter();
    fields.flat_map(|field| field.bits.iter().map(|group| line(&field.name, group))).collect()
}

#[test]
fn the_bits_of_commands_kinds_and_faults_are_explained() {
    let packet = RowOutcome::Packet(PacketOutcome::Queued);
    let raw = read(Protocol::Raw, true, &[3, 0x85, 0x7f], packet);
    let expected = [
        "ch0: 7-7 1 direction right",
        "ch0: 6-0 0000101 steps 5",
        "ch1: 7-7 0 direction left",
        "ch1: 6-0 1111111 steps 127",
    ];
    assert_eq!(bits_of(&raw), expected);
    // On the line COBS replaces the zero; its bits are those of the command.
    let wire = emit(0, 1, &Ticks::emit(7, 2, &[0, 1]));
    let framed = bits_of(&read(Protocol::Framed, false, &wire, FRAME));
    let expected = [
        "kind: 7-7 0 reply no",
        "kind: 6-0 0000001 kind TICKS",
        "tick 0 ch0: 7-7 0 direction left",
        "tick 0 ch0: 6-0 0000000 steps 0",
    ];
    assert_eq!(framed[..4], expected);
}

#[test]
fn commands_of_a_frame_have_their_bytes_on_the_line() {
    let wire = emit(0, 1, &Ticks::emit(7, 2, &[0x81, 0, 0, 3]));
    let meaning = read(Protocol::Framed, false, &wire, FRAME);
    let check = u32::from_le_bytes(CRC.checksum(&[0, 1, 7, 2, 0x81, 0, 0, 3]).to_le_bytes());
    let lines = lines_of(&meaning);
    assert_eq!(
        lines[..9],
        [
            "COBS 0..1 0 bytes to the next zero or the end",
            "address 1..2 0",
            "kind 2..3 TICKS",
            "seq 3..4 7",
            "count 4..5 2",
            "tick 0 ch0 5..6 +1",
            "tick 0 ch1 6..7 0, left",
            "tick 1 ch0 7..8 0, left",
            "tick 1 ch1 8..9 \u{2212}3",
        ]
    );
    assert_eq!(lines[9], format!("CRC 9..13 {check:08x}, valid"));
    assert_eq!(lines[10], "delimiter 13..14 00");
    assert_eq!(meaning.crc, CrcCheck::Compared { found: check, expected: check });
}

#[test]
fn a_reply_has_a_status_and_a_refusal_a_reason() {
    let status =
        Status { state: State::Moving, free: 3, expected_seq: 9, faults: 0x82, ticks_done: 0x0100_0000 };
    let acknowledged = Reply { address: 4, result: Ok(Kind::Status), status };
    let meaning = read(Protocol::Framed, false, &acknowledged.emit(None), RowOutcome::Reply(acknowledged));
    let expected = [
        "kind: 7-7 1 reply yes",
        "kind: 6-0 0000100 kind STATUS",
        "faults: 1-1 1 fault SHORT_PACKET",
        "faults: 7-7 1 fault UNDERRUN",
    ];
    assert_eq!(bits_of(&meaning), expected);
    let lines = lines_of(&meaning);
    assert_eq!(lines[2], "kind 2..3 ACK STATUS");
    assert_eq!(
        lines[3..8],
        [
            "state 3..4 MOVING",
            "free 4..5 3",
            "expected seq 5..6 9",
            "faults 6..8 SHORT_PACKET, UNDERRUN",
            "ticks done 8..12 16777216"
        ]
    );
    let refused = Reply { result: Err(Reason::Busy), ..acknowledged };
    let lines = lines_of(&read(Protocol::Framed, false, &refused.emit(None), RowOutcome::Reply(refused)));
    assert_eq!(lines[2..5], ["kind 2..3 NAK", "reason 3..4 4, BUSY", "state 4..5 MOVING"]);
}

#[test]
fn the_reply_to_positions_has_four_bytes_per_channel() {
    let status = Status { state: State::Ready, free: 4, expected_seq: 1, faults: 0, ticks_done: 2 };
    let reply = Reply { address: 5, result: Ok(Kind::Positions), status };
    let of = |counters: &[i32]| {
        let bytes = reply.emit(Positions::new(counters).as_ref());
        // Sent by the controller itself, and received by another one.
        let [own, received] = [RowOutcome::Reply(reply), FRAME].map(|outcome| {
            let mut summary = String::new();
            Dissector { protocol: Protocol::Framed, addressed: false, channels: &|_| 2 }.summary(
                &bytes,
                outcome,
                &mut summary,
            );
            (lines_of(&read(Protocol::Framed, false, &bytes, outcome)), summary)
        });
        assert_eq!(own, received);
        own
    };
    let (lines, summary) = of(&[3, -1200, 0]);
    assert_eq!(lines[2], "kind 2..3 ACK POSITIONS");
    assert_eq!(
        lines[7..11],
        [
            "ticks done 8..12 2",
            "position ch0 12..16 +3",
            "position ch1 16..20 \u{2212}1200",
            "position ch2 20..24 0"
        ]
    );
    assert!(lines[11].starts_with("CRC 24..28 ") && lines[11].ends_with("valid"), "{lines:?}");
    assert_eq!(
        summary,
        "from 5: ACK POSITIONS: READY, 4 free, seq 1, faults 0x00, 2 ticks done, ch0 at +3, ch1 at \u{2212}1200, ch2 at 0"
    );
    let (lines, summary) = of(&[i32::MIN]);
    assert_eq!(lines[8], "position 12..16 \u{2212}2147483648");
    assert!(summary.ends_with("2 ticks done, ch0 at \u{2212}2147483648"), "{summary}");
    assert_eq!(of(&[1; 16]).0.len(), 3 + 5 + 16 + 2);
    // The frame that requests them.
    let request = read(Protocol::Framed, false, &emit(5, 7, &[]), FRAME);
    assert_eq!(lines_of(&request)[2], "kind 2..3 POSITIONS");
}

#[test]
fn cobs_bytes_within_a_long_body_are_no_fields() {
    let commands: Vec<u8> = [1].repeat(600 - 8);
    let wire = emit(1, 9, &commands);
    let meaning = read(Protocol::Framed, false, &wire, FRAME);
    let codes: Vec<_> = meaning.fields.iter().filter(|field| field.name == "COBS").collect();
    assert_eq!(codes.len(), 1, "the others lie within the body: {meaning:?}");
    let check = meaning.fields.iter().find(|field| field.name == "CRC").expect("it has one");
    assert_eq!(check.bytes, wire.len() - 5..wire.len() - 1);
    assert!(check.value.ends_with("valid"));
}

#[test]
fn invalid_frames_are_dissected_up_to_the_fault() {
    let wire = emit(1, 4, &[]);
    let mut flipped = wire.clone();
    flipped[2] ^= 2;
    let meaning = read(Protocol::Framed, false, &flipped, FRAME);
    assert!(matches!(meaning.crc, CrcCheck::Compared { found, expected } if found != expected));
    assert!(lines_of(&meaning).iter().any(|line| line.starts_with("CRC") && line.contains("expected")));

    let cut = read(Protocol::Framed, false, &wire[..3], RowOutcome::Incomplete);
    assert_eq!(lines_of(&cut)[1..], ["address 1..2 1", "kind 2..3 STATUS"]);
    assert_eq!(cut.crc, CrcCheck::Missing);
    let late = [&[3, 9, 0, 0], wire.as_slice()].concat();
    let after = read(Protocol::Framed, false, &late, FRAME);
    assert_eq!(lines_of(&after)[0], "preceding bytes 0..4 not part of the frame");
    assert!(matches!(after.crc, CrcCheck::Compared { found, expected } if found == expected));
    for len in 0..=9 {
        for byte in [0, 1, 2, 0x80, 0xff] {
            let bytes = [byte].repeat(len);
            read(Protocol::Framed, false, &bytes, FRAME);
            read(Protocol::Raw, true, &bytes, RowOutcome::Incomplete);
        }
    }
}
