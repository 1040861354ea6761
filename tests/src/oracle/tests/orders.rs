//! A6: accepted and refused frames, the precedence of refusals, and replies.

use super::*;
use State::{Busy, Moving, Ready, Stopped};
use kinds::*;

fn framed() -> Config {
    Config { framed: true, address: Some(5), queue_depth: 40, ..base() }
}

/// Long slots: a tick is 4*50000 cycles, longer than any conversation below.
fn slow() -> Config {
    Config { step_period: 50_000, queue_depth: 3, ..framed() }
}

/// Frames far enough apart for every reply (DE falls at p + 3056 at the latest, after POSITIONS at
/// p + 13136: 81 bytes).
fn conversation(frames: &[Vec<u8>]) -> Input {
    let mut sends = Vec::new();
    let mut start = 1;
    for frame in frames {
        sends.push((start, frame.clone()));
        start += 160 * frame.len() as u64 + if *frame == order(POSITIONS) { 13_200 } else { 3_100 };
    }
    Input { sends, forced: Vec::new(), cycles: start }
}

fn ticks(seq: u8, orders: &[u8]) -> Vec<u8> {
    frame(5, TICKS, &[&[seq, orders.len() as u8], orders].concat())
}

fn order(kind: u8) -> Vec<u8> {
    frame(5, kind, &[])
}

/// A status whose faults are in the low byte, and ticks_done under 256.
fn status(state: State, free: u8, seq: u8, faults: u16, ticks_done: u8) -> Vec<u8> {
    vec![state as u8, free, seq, faults as u8, 0, ticks_done, 0, 0, 0]
}

fn ack(kind: u8, status: &[u8]) -> Option<Vec<u8>> {
    Some(frame(5, kind | 0x80, status))
}

fn nak(reason: u8, status: &[u8]) -> Option<Vec<u8>> {
    Some(frame(5, NAK, &[&[reason], status].concat()))
}

/// A frame and its reply, if there is one.
type Turn = (Vec<u8>, Option<Vec<u8>>);

/// Compares the replies to the frames with the given ones.
fn check(config: &Config, turns: &[Turn]) {
    let frames: Vec<Vec<u8>> = turns.iter().map(|(frame, _)| frame.clone()).collect();
    let input = conversation(&frames);
    let said = said(config, &run(config, &input), input.cycles);
    let replies: Vec<&[u8]> = said.split_inclusive(|byte| *byte == 0).collect();
    let expected: Vec<&Vec<u8>> = turns.iter().filter_map(|(_, reply)| reply.as_ref()).collect();
    for (index, (reply, expected)) in replies.iter().zip(&expected).enumerate() {
        assert_eq!(reply, expected, "reply {index} to {frames:02X?}");
    }
    assert_eq!(replies.len(), expected.len(), "{frames:02X?}");
}

#[test]
fn a_reply_is_address_kind_status_and_check() {
    // `05 84 01 02 0000000 7A418B54`, `05 FF 01 01 02 00 40 00000 3946DF48`, `05 87 01 02 0000000 00000000 88C001CE`;
    // the CRCs were computed separately.
    let config = Config { queue_depth: 2, ..framed() };
    let rows: &[(Vec<u8>, &[u8])] = &[
        (order(STATUS), &[5, 5, 0x84, 1, 2, 1, 1, 1, 1, 1, 1, 5, 0x7A, 0x41, 0x8B, 0x54, 0]),
        (ticks(9, &[0]), &[6, 5, 0xFF, 1, 1, 2, 2, 0x40, 1, 1, 1, 1, 5, 0x39, 0x46, 0xDF, 0x48, 0]),
        (order(POSITIONS), &[5, 5, 0x87, 1, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 5, 0x88, 0xC0, 0x01, 0xCE, 0]),
    ];
    for (order, reply) in rows {
        let input = conversation(std::slice::from_ref(order));
        assert_eq!(said(&config, &run(&config, &input), input.cycles), *reply);
    }
}

#[test]
fn other_addresses_are_ignored_and_255_gets_no_reply() {
    let idle = status(Ready, 3, 0, 0, 0);
    check(
        &slow(),
        &[
            (frame(6, TICKS, &[0, 1, 1]), None),
            (frame(6, STOP, &[]), None),
            (frame(6, 0x77, &[]), None),
            (order(STATUS), ack(STATUS, &idle)),
            (frame(255, TICKS, &[0, 1, 1]), None),
            (order(STATUS), ack(STATUS, &status(Moving, 3, 1, 0, 0))),
            // "uses and advances seq, sets flags".
            (frame(255, TICKS, &[7, 1, 1]), None),
            (frame(255, TICKS, &[1, 1, 5]), None),
            (frame(255, TICKS, &[1, 4, 1, 1, 1, 1]), None),
            (frame(255, 0x77, &[]), None),
            (frame(255, STATUS, &[1]), None),
            (frame(255, POSITIONS, &[]), None),
            (frame(255, POSITIONS, &[1]), None),
            (frame(6, POSITIONS, &[]), None),
            (order(STATUS), ack(STATUS, &status(Moving, 3, 1, BAD_SEQ | TOO_MANY_STEPS | QUEUE_OVERFLOW, 0))),
            (frame(255, STOP, &[]), None),
            (order(STATUS), ack(STATUS, &status(Stopped, 3, 1, 0x70, 0))),
        ],
    );
}

#[test]
fn the_default_address_is_0() {
    let config = Config { address: None, ..slow() };
    let reply = frame(0, STATUS | 0x80, &status(Ready, 3, 0, 0, 0));
    check(&config, &[(frame(0, STATUS, &[]), Some(reply)), (order(STATUS), None)]);
}

#[test]
fn invalid_frames_get_no_reply() {
    let mut damaged = order(STATUS);
    damaged[3] ^= 1;
    let seen = status(Ready, 3, 0, CRC | SHORT_PACKET, 0);
    check(&slow(), &[(damaged, None), (vec![3, 5, 4, 0], None), (order(STATUS), ack(STATUS, &seen))]);
}

#[test]
fn an_invalid_body_is_refused_first_and_sets_no_fault() {
    let idle = status(Ready, 40, 0, 0, 0);
    let bad = |body: &[u8]| (frame(5, TICKS, body), nak(6, &idle));
    check(
        &framed(),
        &[
            bad(&[]),
            bad(&[0]),
            bad(&[0, 0]),
            bad(&[0, 1]),
            bad(&[0, 1, 0, 0]),
            bad(&[0, 2, 0]),
            bad(&[&[0, 33], &[0; 33][..]].concat()),
            // Takes precedence over the seq, and over too many steps.
            bad(&[9, 1]),
            bad(&[0, 1, 0x7F, 0x7F]),
        ],
    );
    // count*n bytes: three channels.
    let config = Config { channels: 3, ..slow() };
    let body = |count: u8, bytes: usize| frame(5, TICKS, &[&[0, count], &vec![1; bytes][..]].concat());
    check(
        &config,
        &[
            (body(2, 5), nak(6, &status(Ready, 3, 0, 0, 0))),
            (body(2, 6), ack(TICKS, &status(Moving, 1, 1, 0, 0))),
        ],
    );
}

#[test]
fn up_to_32_ticks_are_queued_all_or_none() {
    check(
        &Config { queue_depth: 33, ..slow() },
        &[
            (ticks(0, &[1; 32]), ack(TICKS, &status(Moving, 1, 1, 0, 0))),
            // The first runs: two places are free.
            (ticks(1, &[1; 3]), nak(2, &status(Moving, 2, 1, QUEUE_OVERFLOW, 0))),
            (ticks(1, &[1; 2]), ack(TICKS, &status(Moving, 0, 2, QUEUE_OVERFLOW, 0))),
            (ticks(2, &[1]), nak(2, &status(Moving, 0, 2, QUEUE_OVERFLOW, 0))),
        ],
    );
}

#[test]
fn a_repeat_is_acknowledged_and_not_queued_again() {
    let moving = status(Moving, 3, 1, 0, 0);
    check(
        &slow(),
        &[
            // At p the tick is still queued.
            (ticks(0, &[1]), ack(TICKS, &status(Moving, 2, 1, 0, 0))),
            (ticks(0, &[1]), ack(TICKS, &moving)),
            (ticks(0, &[1]), ack(TICKS, &moving)),
            // Only the seq identifies a repeat, not its contents or the free places.
            (ticks(0, &[0x7F; 9]), ack(TICKS, &moving)),
            (frame(5, TICKS, &[0, 1]), nak(6, &moving)),
            (order(STOP), ack(STOP, &status(Stopped, 3, 1, 0, 0))),
            (ticks(0, &[1]), ack(TICKS, &status(Stopped, 3, 1, 0, 0))),
        ],
    );
}

#[test]
fn a_seq_that_is_neither_expected_nor_repeated_is_bad() {
    let bad = status(Ready, 40, 0, BAD_SEQ, 0);
    check(
        &framed(),
        &[
            // The seq before the expected one, but nothing was accepted yet.
            (ticks(255, &[0]), nak(1, &bad)),
            (ticks(1, &[0]), nak(1, &bad)),
            (ticks(0, &[0]), ack(TICKS, &status(Moving, 39, 1, BAD_SEQ, 0))),
            (ticks(255, &[0]), nak(1, &status(Ready, 40, 1, BAD_SEQ, 1))),
            (ticks(2, &[0]), nak(1, &status(Ready, 40, 1, BAD_SEQ, 1))),
            (order(RESYNC), ack(RESYNC, &status(Ready, 40, 0, 0, 1))),
            // Nor since RESYNC.
            (ticks(255, &[0]), nak(1, &status(Ready, 40, 0, BAD_SEQ, 1))),
            (ticks(0, &[0]), ack(TICKS, &status(Moving, 39, 1, BAD_SEQ, 1))),
            (ticks(0, &[0]), ack(TICKS, &status(Ready, 40, 1, BAD_SEQ, 2))),
        ],
    );
    // Takes precedence over too many steps and a full queue; STOPPED and BUSY have lower precedence.
    check(
        &Config { boot: 1_000_000, ..slow() },
        &[
            (ticks(1, &[0x7F; 9]), nak(1, &status(Busy, 3, 0, BAD_SEQ, 0))),
            (order(STOP), ack(STOP, &status(Stopped, 3, 0, BAD_SEQ, 0))),
            (ticks(1, &[0x7F; 9]), nak(1, &status(Stopped, 3, 0, BAD_SEQ, 0))),
        ],
    );
}

#[test]
fn the_seq_wraps_after_255_and_a_repeat_does_too() {
    let mut turns: Vec<Turn> = (0..=255).map(|seq| (frame(255, TICKS, &[seq, 1, 0]), None)).collect();
    let done = |count: u64, seq: u8, state, free: u8| {
        let mut status = vec![state as u8, free, seq, 0, 0];
        status.extend((count as u32).to_le_bytes());
        status
    };
    turns.push((ticks(255, &[0]), ack(TICKS, &done(256, 0, Ready, 40))));
    turns.push((ticks(0, &[0]), ack(TICKS, &done(256, 1, Moving, 39))));
    turns.push((order(STATUS), ack(STATUS, &done(257, 1, Ready, 40))));
    check(&framed(), &turns);
}

#[test]
fn refusals_have_their_order_of_precedence() {
    let stopped = status(Stopped, 3, 0, 0, 0);
    check(
        &Config { boot: 1_000_000, ..slow() },
        &[
            (ticks(0, &[0x7F; 9]), nak(4, &status(Busy, 3, 0, 0, 0))),
            (order(STOP), ack(STOP, &stopped)),
            (ticks(0, &[0x7F; 9]), nak(5, &stopped)),
            (order(ENABLE), ack(ENABLE, &status(Busy, 3, 0, 0, 0))),
            (ticks(0, &[1]), nak(4, &status(Busy, 3, 0, 0, 0))),
        ],
    );
    check(
        &slow(),
        &[
            (ticks(0, &[5; 9]), nak(3, &status(Ready, 3, 0, TOO_MANY_STEPS, 0))),
            (ticks(0, &[4; 9]), nak(2, &status(Ready, 3, 0, TOO_MANY_STEPS | QUEUE_OVERFLOW, 0))),
            // One command that is too large drops all of them.
            (ticks(0, &[1, 0x85]), nak(3, &status(Ready, 3, 0, TOO_MANY_STEPS | QUEUE_OVERFLOW, 0))),
        ],
    );
}

#[test]
fn boot_ends_with_its_last_cycle_for_frames_too() {
    // TICKS of one tick is 11 bytes: p = 1 + 10*160 + 152 = 1753.
    for (boot, reply) in
        [(1_753, ack(TICKS, &status(Moving, 2, 1, 0, 0))), (1_754, nak(4, &status(Busy, 3, 0, 0, 0)))]
    {
        check(&Config { boot, ..slow() }, &[(ticks(0, &[1]), reply)]);
    }
}

#[test]
fn all_kinds_but_ticks_work_during_boot() {
    let busy = status(Busy, 3, 0, 0, 0);
    let stopped = status(Stopped, 3, 0, 0, 0);
    check(
        &Config { boot: 1_000_000, ..slow() },
        &[
            (order(STATUS), ack(STATUS, &busy)),
            (order(DISABLE), ack(DISABLE, &stopped)),
            (order(ENABLE), ack(ENABLE, &busy)),
            (order(STOP), ack(STOP, &stopped)),
            (order(STATUS), ack(STATUS, &stopped)),
            (order(ENABLE), ack(ENABLE, &busy)),
            (ticks(3, &[1]), nak(1, &status(Busy, 3, 0, BAD_SEQ, 0))),
            (order(RESYNC), ack(RESYNC, &busy)),
            (order(POSITIONS), ack(POSITIONS, &[busy, vec![0; 4]].concat())),
        ],
    );
}

#[test]
fn positions_are_little_endian_per_channel_after_the_status() {
    // 300 ticks of four steps left on channel 1, then one with three steps right on channel 0 and one on channel 2.
    let config = Config { channels: 3, ..framed() };
    let ticks = |seq: u8, count: u8, orders: [u8; 3]| {
        (frame(255, TICKS, &[&[seq, count], &orders.repeat(count.into())[..]].concat()), None)
    };
    let mut turns: Vec<Turn> = (0..10).map(|seq| ticks(seq, 30, [0, 4, 0x80])).collect();
    turns.push(ticks(10, 1, [0x83, 0x80, 0x81]));
    let told = |faults: u8, seq: u8, positions: [i32; 3]| {
        let mut body = vec![Ready as u8, 40, seq, faults, 0];
        body.extend(301_u32.to_le_bytes());
        body.extend(positions.iter().flat_map(|position| position.to_le_bytes()));
        body
    };
    // 3, -1200 = 0xFFFFFB50, 1.
    let body = told(UNDERRUN as u8, 11, [3, -1200, 1]);
    assert_eq!(body[9..], [3, 0, 0, 0, 0x50, 0xFB, 0xFF, 0xFF, 1, 0, 0, 0]);
    turns.push((order(POSITIONS), ack(POSITIONS, &body)));
    // "only reset sets them to 0".
    turns.push((order(RESYNC), ack(RESYNC, &told(0, 0, [0; 3])[..9])));
    turns.push((order(POSITIONS), ack(POSITIONS, &told(0, 0, [3, -1200, 1]))));
    check(&config, &turns);
}

#[test]
fn unexpected_bodies_and_unknown_kinds_are_refused() {
    let idle = status(Ready, 3, 0, 0, 0);
    for kind in [ENABLE, DISABLE, STATUS, STOP, RESYNC, POSITIONS] {
        check(&slow(), &[(frame(5, kind, &[0]), nak(6, &idle)), (order(STATUS), ack(STATUS, &idle))]);
    }
    for kind in [0x00, 0x08, 0x09, 0x81, 0x87, 0x84, 0xFF] {
        check(&slow(), &[(order(kind), nak(7, &idle)), (frame(5, kind, &[1, 2]), nak(7, &idle))]);
    }
    // Takes precedence over BUSY.
    let moving = status(Moving, 3, 1, 0, 0);
    check(
        &slow(),
        &[
            (ticks(0, &[1]), ack(TICKS, &status(Moving, 2, 1, 0, 0))),
            (frame(5, DISABLE, &[0]), nak(6, &moving)),
            (order(DISABLE), nak(4, &moving)),
        ],
    );
}

#[test]
fn stop_keeps_seq_faults_and_ticks_done() {
    // The first tick, 4*1000 cycles, ends before the next frame arrives: UNDERRUN.
    let config = Config { step_period: 1_000, ..framed() };
    check(
        &config,
        &[
            (ticks(0, &[1]), ack(TICKS, &status(Moving, 39, 1, 0, 0))),
            (ticks(1, &[1, 1, 1]), ack(TICKS, &status(Moving, 37, 2, UNDERRUN, 1))),
            // Two of them have ended; the third began 4000 cycles after the second, and 3 frames later.
            (order(STOP), ack(STOP, &status(Stopped, 40, 2, UNDERRUN, 2))),
            (order(ENABLE), ack(ENABLE, &status(Ready, 40, 2, UNDERRUN, 2))),
            (order(RESYNC), ack(RESYNC, &status(Ready, 40, 0, 0, 2))),
            (order(STATUS), ack(STATUS, &status(Ready, 40, 0, 0, 2))),
        ],
    );
}

#[test]
fn a_run_ends_with_the_seq_state_and_free_places_of_a_status() {
    let end = |config: &Config, frames: &[Vec<u8>]| {
        let run = run(config, &conversation(frames));
        (run.state, run.free, run.expected_seq)
    };
    assert_eq!(end(&slow(), &[]), (Ready, 3, 0));
    assert_eq!(end(&slow(), &[ticks(0, &[1, 1])]), (Moving, 2, 1));
    assert_eq!(end(&slow(), &[ticks(0, &[1, 1]), order(STOP)]), (Stopped, 3, 1));
    // A frame of 8 bytes and 3100 cycles: the run is the cycles 0..=4380.
    for (boot, state) in [(4_381, Busy), (4_380, Ready)] {
        assert_eq!(end(&Config { boot, ..slow() }, &[order(STATUS)]).0, state);
    }
}
