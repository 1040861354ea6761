//! A6 and A7 to the cycle: when a command takes effect, STOP and DISABLE near a tick's end, UNDERRUN.
//!
//! A tick of four slots of 2000 cycles, by a frame that arrives in P = 2753: c0 = 2754, STEP rises at 2764, 4764,
//! 6764, 8764 and falls 500 cycles later, e = 10754. Frames for 255 get no reply, so
//! they may follow each other.

use super::*;
use kinds::*;

const P: u64 = 2_753;
const E: u64 = 10_754;

fn long() -> Config {
    Config {
        framed: true,
        address: Some(5),
        step_period: 2_000,
        pulse_width: 500,
        dir_setup: 10,
        dir_hold: 10,
        queue_depth: 8,
        ..base()
    }
}

/// A frame sent so that its 0x00 is delivered in cycle `p`.
fn arriving(p: u64, address: u8, kind: u8, body: &[u8]) -> (u64, Vec<u8>) {
    let bytes = frame(address, kind, body);
    (p - 152 - 160 * (bytes.len() as u64 - 1), bytes)
}

/// A command for all, in cycle `p`.
fn order(p: u64, kind: u8) -> (u64, Vec<u8>) {
    arriving(p, 255, kind, &[])
}

/// TICKS for all, one channel, in cycle `p`.
fn ticks(p: u64, seq: u8, orders: &[u8]) -> (u64, Vec<u8>) {
    arriving(p, 255, TICKS, &[&[seq, orders.len() as u8], orders].concat())
}

fn run_sent(config: &Config, sends: &[(u64, Vec<u8>)], cycles: u64) -> Run {
    for pair in sends.windows(2) {
        assert!(pair[0].0 + 160 * pair[0].1.len() as u64 <= pair[1].0, "sends overlap");
    }
    run(config, &Input { sends: sends.to_vec(), forced: Vec::new(), cycles })
}

#[test]
fn ticks_start_in_the_cycle_after_the_zero_without_pauses() {
    let run = run_sent(&long(), &[ticks(3_000, 0, &[0x81, 0x01, 0x81])], 40_000);
    assert_eq!(edges(&run, bits::DIR), [(3_001, true), (11_001, false), (19_001, true)]);
    assert_eq!(steps(&run, 0), [3_011, 11_011, 19_011]);
    assert_eq!((run.ticks_done, run.positions[0]), (3, 1));
}

#[test]
fn en_follows_commands_in_the_next_cycle() {
    let orders = [order(2_000, DISABLE), order(4_000, DISABLE), order(6_000, ENABLE), order(8_000, ENABLE)];
    let run = run_sent(&long(), &orders, 10_000);
    assert_eq!(edges(&run, bits::EN), [(2_001, false), (6_001, true)]);
    assert_eq!((run.state, run.faults), (State::Ready, 0));
    assert!(edges(&run, bits::DE).is_empty());
}

#[test]
fn stop_ends_everything_in_the_next_cycle() {
    // During the second pulse; before it; in its first cycle; in the pause after it.
    let rows: &[(u64, &[(u64, bool)])] = &[
        (5_000, &[(4_764, true), (5_001, false)]),
        (4_762, &[]),
        (4_763, &[]),
        (4_764, &[(4_764, true), (4_765, false)]),
        (5_262, &[(4_764, true), (5_263, false)]),
        (5_263, &[(4_764, true), (5_264, false)]),
        (5_500, &[(4_764, true), (5_264, false)]),
    ];
    for (p, second) in rows {
        let run = run_sent(&long(), &[ticks(P, 0, &[0x84, 0x04]), order(*p, STOP)], 30_000);
        let step = [&[(2_764, true), (3_264, false)], *second].concat();
        assert_eq!(edges(&run, bits::STEP), step, "STOP at {p}");
        // "a pulse that STOP cuts short counts" (A3).
        assert_eq!(run.positions[0], step.len() as i32 / 2, "STOP at {p}");
        assert_eq!(edges(&run, bits::EN), [(p + 1, false)]);
        // "DIR, expected seq, faults and ticks_done stay"; no UNDERRUN.
        assert_eq!(edges(&run, bits::DIR), [(2_754, true)]);
        assert_eq!((run.expected_seq, run.faults, run.ticks_done), (1, 0, 0));
        assert_eq!((run.state, run.free), (State::Stopped, 8));
    }
}

#[test]
fn stop_in_the_last_cycle_of_a_tick_cancels_the_next_start() {
    // With D = 0, STEP rises with c0 itself.
    let config = Config { dir_setup: 0, ..long() };
    let stopped_at = |p| run_sent(&config, &[ticks(P, 0, &[0x84, 0x04]), order(p, STOP)], 30_000);
    // p = e - 1: not counted, and the second tick does not start at e.
    let run = stopped_at(E - 1);
    assert_eq!((run.ticks_done, run.positions[0], run.faults), (0, 4, 0));
    assert_eq!(edges(&run, bits::DIR), [(2_754, true)]);
    // p = e: the first is counted; the second has c0 = p and is canceled after its first cycle, in which STEP rose
    // and DIR changed.
    let run = stopped_at(E);
    assert_eq!((run.ticks_done, run.positions[0], run.faults), (1, 3, 0));
    assert_eq!(edges(&run, bits::DIR), [(2_754, true), (E, false)]);
    assert_eq!(edges(&run, bits::STEP)[8..], [(E, true), (E + 1, false)]);
}

#[test]
fn after_stop_the_next_tick_starts_immediately() {
    let orders = [
        ticks(P, 0, &[0x84, 0x84]),
        order(5_000, STOP),
        // STOPPED: not queued, and the seq does not advance.
        ticks(7_000, 1, &[0x84]),
        order(8_500, ENABLE),
        ticks(10_300, 1, &[0x01]),
    ];
    let run = run_sent(&long(), &orders, 40_000);
    assert_eq!(edges(&run, bits::EN), [(5_001, false), (8_501, true)]);
    assert_eq!(steps(&run, 0), [2_764, 4_764, 10_311]);
    assert_eq!(edges(&run, bits::DIR), [(2_754, true), (10_301, false)]);
    assert_eq!((run.ticks_done, run.expected_seq, run.positions[0]), (1, 2, 1));
}

#[test]
fn disable_is_busy_until_the_end_of_a_tick() {
    let disabled = |orders: &[u8], p| {
        let run = run_sent(&long(), &[ticks(P, 0, orders), order(p, DISABLE)], 40_000);
        (edges(&run, bits::EN), run.ticks_done)
    };
    assert_eq!(disabled(&[4], E - 1), (vec![], 1));
    assert_eq!(disabled(&[4], E), (vec![(E + 1, false)], 1));
    // Another tick starts at e.
    assert_eq!(disabled(&[4, 4], E), (vec![], 2));
    assert_eq!(disabled(&[4, 4], E + 8_000), (vec![(E + 8_001, false)], 2));
    // A tick without steps also runs.
    assert_eq!(disabled(&[0], E - 1), (vec![], 1));
}

#[test]
fn a_status_has_the_state_after_the_sequencer() {
    let status_at = |orders: &[u8], p: u64| {
        let sends = [ticks(P, 0, orders), arriving(p, 5, STATUS, &[])];
        said(&long(), &run_sent(&long(), &sends, 20_000), 20_000)
    };
    let reply = |state, free, faults, done| frame(5, 0x84, &[state, free, 1, faults as u8, 0, done, 0, 0, 0]);
    // A place freed at c0 = p is free at p; e itself is counted.
    assert_eq!(status_at(&[4, 4], E - 1), reply(2, 7, 0, 0));
    assert_eq!(status_at(&[4, 4], E), reply(2, 8, 0, 1));
    assert_eq!(status_at(&[4], E - 1), reply(2, 8, 0, 0));
    assert_eq!(status_at(&[4], E), reply(1, 8, UNDERRUN, 1));
}

#[test]
fn positions_include_rises_in_the_cycle_of_the_frame() {
    let positions_at = |orders: &[u8], sends: &[(u64, Vec<u8>)], p: u64| {
        let sends = [&[ticks(P, 0, orders)], sends, &[arriving(p, 5, POSITIONS, &[])]].concat();
        said(&long(), &run_sent(&long(), &sends, 20_000), 20_000)
    };
    let reply = |state, free, faults, done, position: i32| {
        let status = [state, free, 1, faults as u8, 0, done, 0, 0, 0];
        frame(5, 0x87, &[&status[..], &position.to_le_bytes()].concat())
    };
    // STEP rises in 4764 and falls in 5264; the last time in 8764.
    for (p, steps) in [(4_763, 1), (4_764, 2), (4_765, 2), (5_264, 2), (8_763, 3), (8_764, 4), (E - 1, 4)] {
        assert_eq!(positions_at(&[0x84], &[], p), reply(2, 8, 0, 0, steps), "p = {p}");
        assert_eq!(positions_at(&[4], &[], p), reply(2, 8, 0, 0, -steps), "p = {p}");
    }
    assert_eq!(positions_at(&[0x84], &[], E), reply(1, 8, UNDERRUN, 1, 4));
    // The second tick moves back, from 10764 on.
    assert_eq!(positions_at(&[0x84, 4], &[], 10_763), reply(2, 8, 0, 1, 4));
    assert_eq!(positions_at(&[0x84, 4], &[], 10_764), reply(2, 8, 0, 1, 3));
    // "a pulse that STOP cuts short counts": STOP in 4764 itself, and one cycle before the rise.
    for (stop, steps) in [(4_763, 1), (4_764, 2)] {
        assert_eq!(positions_at(&[0x84], &[order(stop, STOP)], 8_000), reply(3, 8, 0, 0, steps), "{stop}");
    }
}

#[test]
fn a_place_freed_in_the_cycle_of_the_frame_is_free() {
    let config = Config { queue_depth: 1, ..long() };
    for (p, faults, done) in [(E - 1, QUEUE_OVERFLOW, 2), (E, 0, 3)] {
        // The first runs; the second occupies the place until e.
        let sends = [ticks(P, 0, &[0]), ticks(5_000, 1, &[0]), ticks(p, 2, &[0])];
        let run = run_sent(&config, &sends, 40_000);
        assert_eq!((run.faults, run.ticks_done), (faults, done), "p = {p}");
    }
}

#[test]
fn underrun_is_a_moving_tick_without_a_successor() {
    let faults = |config: &Config, sends: &[(u64, Vec<u8>)], cycles| run_sent(config, sends, cycles).faults;
    let first = |orders: &[u8]| ticks(P, 0, orders);
    // In cycle e.
    assert_eq!(faults(&long(), &[first(&[4])], E), 0);
    assert_eq!(faults(&long(), &[first(&[4])], E + 1), UNDERRUN);
    // "a tick of zero counts is the host's way to say 'this was the last'", whatever its direction.
    assert_eq!(faults(&long(), &[first(&[0])], 40_000), 0);
    assert_eq!(faults(&long(), &[first(&[0x80])], 40_000), 0);
    assert_eq!(faults(&long(), &[first(&[4, 0])], 40_000), 0);
    assert_eq!(faults(&long(), &[first(&[0, 4])], 40_000), UNDERRUN);
    // "some count".
    let two = Config { channels: 2, ..long() };
    let both = |orders: &[u8]| [arriving(2_000, 255, TICKS, &[&[0, 1], orders].concat())];
    assert_eq!(faults(&two, &both(&[0, 1]), 40_000), UNDERRUN);
    assert_eq!(faults(&two, &both(&[0, 0x80]), 40_000), 0);
    // "orders that come with p = e - 1 follow without a pause", those with p = e do not.
    for (p, faults, c0) in [(E - 1, 0, E), (E, UNDERRUN, E + 1)] {
        let run = run_sent(&long(), &[first(&[4]), ticks(p, 1, &[0x81, 0])], 40_000);
        assert_eq!((run.faults, edges(&run, bits::DIR)[0]), (faults, (c0, true)), "p = {p}");
    }
    // RESYNC in that cycle comes after it, one cycle earlier before it.
    assert_eq!(faults(&long(), &[first(&[4]), order(E - 1, RESYNC)], 40_000), UNDERRUN);
    assert_eq!(faults(&long(), &[first(&[4]), order(E, RESYNC)], 40_000), 0);
    // "never because of STOP".
    assert_eq!(faults(&long(), &[first(&[4]), order(E - 1, STOP)], 40_000), 0);
    // "in framed mode".
    let raw = Config { framed: false, address: None, ..long() };
    assert_eq!(faults(&raw, &[(1, vec![4])], 40_000), 0);
}
