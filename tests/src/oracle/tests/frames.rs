//! A6 on the wire: CRC, COBS, valid frames, and the faults of invalid ones.

use super::super::frames::{Frame, Frames};
use super::*;

fn framed() -> Config {
    Config { framed: true, address: Some(5), ..base() }
}

/// The fault flags after bytes without pauses from cycle 1 on.
fn faults(bytes: &[u8]) -> u16 {
    let cycles = byte_start(&framed(), 1, bytes.len() as u64) + 1;
    run(&framed(), &sent(&[(1, bytes)], cycles)).faults
}

#[test]
fn the_crc_is_crc_32_iscsi() {
    // The catalogue's check value, and RFC 3720's examples.
    assert_eq!(crc32c(b"123456789"), 0xE306_9283);
    assert_eq!(crc32c(&[0x00; 32]), 0x8A91_36AA);
    assert_eq!(crc32c(&[0xFF; 32]), 0x62A8_AB43);
    assert_eq!(crc32c(&(0..32).collect::<Vec<u8>>()), 0x46DD_794E);
    assert_eq!(crc32c(&[]), 0);
}

/// `first..=last`.
fn to(first: u8, last: u8) -> Vec<u8> {
    (first..=last).collect()
}

#[test]
fn cobs_matches_the_examples_of_its_paper() {
    let packet = [0x45, 0x00, 0x00, 0x2C, 0x4C, 0x79, 0x00, 0x00, 0x40, 0x06, 0x4F, 0x37];
    let encoded = [0x02, 0x45, 0x01, 0x04, 0x2C, 0x4C, 0x79, 0x01, 0x05, 0x40, 0x06, 0x4F, 0x37];
    assert_eq!(cobs(&packet), encoded);
    let rows: &[(Vec<u8>, Vec<u8>)] = &[
        (vec![], vec![1]),
        (vec![0], vec![1, 1]),
        (vec![0, 0], vec![1, 1, 1]),
        (vec![0, 0x11, 0], vec![1, 2, 0x11, 1]),
        (vec![0x11, 0x22, 0, 0x33], vec![3, 0x11, 0x22, 2, 0x33]),
        (vec![0x11, 0x22, 0x33, 0x44], vec![5, 0x11, 0x22, 0x33, 0x44]),
        (vec![0x11, 0, 0, 0], vec![2, 0x11, 1, 1, 1]),
        // 254 bytes that are not zero fill a block, without an implied zero.
        (to(1, 254), [vec![255], to(1, 254)].concat()),
        ([vec![0], to(1, 254)].concat(), [vec![1, 255], to(1, 254)].concat()),
        (to(1, 255), [vec![255], to(1, 254), vec![2, 255]].concat()),
        ([to(2, 255), vec![0]].concat(), [vec![255], to(2, 255), vec![1, 1]].concat()),
        ([to(3, 255), vec![0, 1]].concat(), [vec![254], to(3, 255), vec![2, 1]].concat()),
    ];
    for (bytes, encoded) in rows {
        assert_eq!(&cobs(bytes), encoded, "{bytes:02X?}");
    }
}

#[test]
fn a_frame_is_cobs_of_its_fields_and_crc_and_a_zero() {
    // The CRCs were computed separately, bit by bit from the other end.
    assert_eq!(frame(5, 4, &[]), [7, 5, 4, 0x66, 0x19, 0xD3, 0x6B, 0]);
    assert_eq!(frame(0, 4, &[]), [1, 6, 4, 0xCD, 0xE0, 0xFB, 0x36, 0]);
    assert_eq!(frame(5, 1, &[0, 1, 0x81]), [3, 5, 1, 7, 1, 0x81, 0x9D, 0x2D, 0x5C, 0x23, 0]);
}

#[test]
fn encoding_and_decoding_frames_are_inverses() {
    for length in (0..=594).chain([600, 700]) {
        for body in [vec![0; length], vec![7; length], (0..length).map(|i| (i % 251) as u8).collect()] {
            let mut frames = Frames::default();
            let mut heard = Vec::new();
            // Twice, after an empty run.
            for byte in [vec![0], frame(9, 0xA5, &body), vec![0], frame(9, 0xA5, &body)].concat() {
                heard.extend(frames.hear(byte).transpose());
            }
            let good = Frame { address: 9, kind: 0xA5, body };
            let expected =
                if length <= 594 { vec![Ok(good.clone()), Ok(good)] } else { vec![Err(OVERLONG); 2] };
            assert!(heard == expected, "{length}: {heard:02X?}");
        }
    }
}

#[test]
fn invalid_frames_set_their_documented_fault() {
    let status = frame(5, 4, &[]);
    let flipped = |byte: usize| {
        let mut bytes = status.clone();
        bytes[byte] ^= 0x20;
        bytes
    };
    let rows: &[(u16, Vec<u8>)] = &[
        (0, status.clone()),
        // "an empty run (0x00 after 0x00) is nothing", also the first.
        (0, vec![0]),
        (0, [vec![0, 0], frame(255, 4, &[]), vec![0, 0], frame(255, 4, &[]), vec![0]].concat()),
        // Fewer than 6 decoded bytes: 0, 1, 5; and 6 with a wrong CRC.
        (SHORT_PACKET, vec![1, 0]),
        (SHORT_PACKET, vec![2, 9, 0]),
        (SHORT_PACKET, vec![6, 1, 2, 3, 4, 5, 0]),
        (SHORT_PACKET, vec![1, 1, 1, 1, 1, 1, 0]),
        (CRC, vec![7, 1, 2, 3, 4, 5, 6, 0]),
        (CRC, vec![1, 1, 1, 1, 1, 1, 1, 0]),
        // Not COBS: the block ends too early, or a last code has no block.
        (SHORT_PACKET, vec![8, 1, 2, 3, 4, 5, 6, 0]),
        (SHORT_PACKET, vec![7, 1, 2, 3, 4, 5, 6, 2, 0]),
        (SHORT_PACKET, [vec![0xFF], vec![9; 253], vec![0]].concat()),
        // The code 0xFF ends a run with its last byte, and one that has a code 0x01 more.
        (CRC, [vec![0xFF], vec![9; 254], vec![0]].concat()),
        (CRC, [vec![0xFF], vec![9; 254], vec![1, 0]].concat()),
        // Nothing is checked before the 0x00.
        (0, status[..7].to_vec()),
        (0, vec![8; 60]),
        // A flipped bit in the address, the kind, the CRC; in the code byte (7 becomes 0x27).
        (CRC, flipped(1)),
        (CRC, flipped(2)),
        (CRC, flipped(6)),
        (SHORT_PACKET, flipped(0)),
        // A lost and a duplicated byte.
        (SHORT_PACKET, [&status[..3], &status[4..]].concat()),
        (SHORT_PACKET, [&status[..3], &status[2..]].concat()),
        // The CRC is checked before the address.
        (CRC, [vec![7, 6], status[2..].to_vec()].concat()),
        (0, frame(6, 4, &[])),
    ];
    for (expected, bytes) in rows {
        assert_eq!(faults(bytes), *expected, "{bytes:02X?}");
    }
}

#[test]
fn the_601st_decoded_byte_is_overlong_in_its_cycle() {
    // 254 + 254 + 92 = 600 bytes, or 93 for 601.
    let blocks =
        |last: usize| [vec![255], vec![9; 254], vec![255], vec![9; 254], vec![last as u8 + 1], vec![9; last]];
    let zeros = |codes: usize| vec![1; codes];
    let rows: &[(Vec<u8>, Option<u64>)] = &[
        ([blocks(92).concat(), vec![0]].concat(), None),
        // The 604th byte on the wire, delivered at 1 + 603*160 + 152.
        ([blocks(93).concat(), vec![0]].concat(), Some(96_633)),
        ([blocks(200).concat(), vec![0]].concat(), Some(96_633)),
        // "a zero that COBS owes counts when the next code byte arrives": 601 codes decode to 600 zeros.
        ([zeros(601), vec![0]].concat(), None),
        // The 602nd, delivered at 1 + 601*160 + 152.
        ([zeros(602), vec![0]].concat(), Some(96_313)),
        // 600 bytes and an implied zero, when the next code arrives: the 604th byte again.
        ([blocks(92).concat(), vec![2, 9, 0]].concat(), Some(96_633)),
        // Bytes up to the next 0x00 set "no further flag": here they are not COBS, either.
        ([zeros(602), vec![200, 1, 0]].concat(), Some(96_313)),
    ];
    for (bytes, overlong) in rows {
        let after = [bytes.clone(), frame(255, 6, &[]), vec![7, 1, 0]].concat();
        let flags = |cycles: u64| run(&framed(), &sent(&[(1, bytes)], cycles)).faults;
        match overlong {
            // A wrong CRC, detected at the 0x00.
            None => assert_eq!(faults(bytes), CRC),
            Some(cycle) => {
                assert_eq!((flags(*cycle), flags(cycle + 1)), (0, OVERLONG), "{} bytes", bytes.len());
                assert_eq!(faults(bytes), OVERLONG);
            }
        }
        // The next frame is received (RESYNC clears the flags), and the next fault is flagged.
        assert_eq!(faults(&after), SHORT_PACKET, "{} bytes", bytes.len());
    }
}

#[test]
fn a_byte_with_a_framing_error_is_missing_from_its_frame() {
    let status = frame(5, 4, &[]);
    // Byte j's stop bit is sampled at 1 + 160*j + 152.
    let broken = |bytes: &[u8], j: u64, cycles: u64| {
        let input = Input { forced: vec![(1 + 160 * j + 152, 1, false)], ..sent(&[(1, bytes)], cycles) };
        run(&framed(), &input).faults
    };
    // FRAMING in its own cycle, and SHORT_PACKET where the 0x00 ends a run that is no longer COBS.
    assert_eq!(broken(&status, 3, 633), 0);
    assert_eq!(broken(&status, 3, 634), FRAMING);
    assert_eq!(broken(&status, 3, 1_273), FRAMING);
    assert_eq!(broken(&status, 3, 1_274), FRAMING | SHORT_PACKET);
    // The byte after the missing code byte becomes the code: 5, then 4 bytes, then 0xD3 with too few bytes.
    assert_eq!(broken(&status, 0, 3_000), FRAMING | SHORT_PACKET);
    // A missing byte that leaves the COBS valid: the last of `3 5 1 7 1 …` is duplicated here, one of them is missing.
    let duplicated = [&status[..7], &[0x6B, 0]].concat();
    assert_eq!(broken(&duplicated, 9, 3_000), SHORT_PACKET);
    assert_eq!(broken(&duplicated, 7, 3_000), FRAMING);
    // Missing zeros change nothing else in the blocks: the CRC is wrong.
    let zeros = frame(5, 4, &[0, 0, 0]);
    assert_eq!(zeros[..6], [3, 5, 4, 1, 1, 5]);
    assert_eq!(broken(&zeros, 3, 3_000), FRAMING | CRC);
    // A missing 0x00 joins two frames.
    let two = [status.clone(), status.clone()].concat();
    assert_eq!(broken(&two, 7, 3_000), FRAMING | CRC);
    // Before a frame's first byte it has no effect, and a run of missing bytes only is empty.
    let after_noise = [vec![0x55], status].concat();
    assert_eq!(broken(&after_noise, 0, 3_000), FRAMING);
    assert_eq!(broken(&[0x55, 0], 0, 3_000), FRAMING);
    // Also while OVERLONG drops bytes.
    let overlong = [vec![1; 610], vec![0]].concat();
    assert_eq!(broken(&overlong, 605, 98_000), FRAMING | OVERLONG);
}

#[test]
fn pauses_inside_a_frame_do_not_matter() {
    let status = frame(5, 4, &[]);
    let input = sent(&[(1, &status[..4]), (20_000, &status[4..])], 30_000);
    let run = run(&framed(), &input);
    assert_eq!(run.faults, 0);
    // The 0x00 is delivered at 20000 + 3*160 + 152 = 20632; DE rises 10 bit times later.
    assert_eq!(rises(&run, bits::DE), [20_792]);
}
