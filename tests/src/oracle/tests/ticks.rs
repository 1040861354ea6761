//! A7: starts and ends of ticks, the slots of a count, counters, and refusals.

use super::*;

#[test]
fn an_idle_sequencer_starts_a_tick_in_the_next_cycle() {
    // p = 153, c0 = 154: DIR takes its level at c0, STEP rises at s + D = 155.
    let run = run(&base(), &sent(&[(1, &[0x81])], 400));
    assert_eq!(edges(&run, bits::DIR), [(154, true)]);
    assert_eq!(edges(&run, bits::STEP), [(155, true), (157, false)]);
}

#[test]
fn the_next_tick_starts_after_the_last_one_and_its_commit() {
    // "c0 = max(p + 1, e)": ticks of 4*50 = 200 cycles, the first from 154 to e = 354.
    let config = Config { step_period: 50, ..base() };
    for (second_start, p, c0) in
        [(161, 313, 354), (200, 352, 354), (201, 353, 354), (202, 354, 355), (203, 355, 356)]
    {
        let run = run(&config, &sent(&[(1, &[0x01]), (second_start, &[0x81])], 1_000));
        assert_eq!(edges(&run, bits::DIR), [(c0, true)], "p = {p}");
        assert_eq!(steps(&run, 0), [155, c0 + 1], "p = {p}");
    }
}

#[test]
fn queued_ticks_follow_each_other_without_a_pause() {
    // Four packets at 153, 313, 473, 633; ticks of 400 cycles at 154, 554, 954, 1354; a step in every slot, Ts
    // = 100.
    let config = Config { step_period: 100, queue_depth: 3, ..base() };
    let run = run(&config, &sent(&[(1, &[4, 4, 4, 4])], 2_000));
    let expected: Vec<u64> = (0..16).map(|slot| 155 + 100 * slot).collect();
    assert_eq!(steps(&run, 0), expected);
    assert_eq!((run.ticks_done, run.positions[0]), (4, -16));
}

#[test]
fn ticks_are_counted_at_their_end() {
    // e = 154 + 40 = 194: a run of 194 cycles ends with 193, one of 195 with 194.
    for (cycles, expected) in [(154, 0), (194, 0), (195, 1), (400, 1)] {
        assert_eq!(run(&base(), &sent(&[(1, &[0x81])], cycles)).ticks_done, expected, "{cycles} cycles");
    }
    // A tick without counts is a tick.
    assert_eq!(run(&base(), &sent(&[(1, &[0x00])], 195)).ticks_done, 1);
}

#[test]
fn burst_steps_in_the_first_slots_and_spread_over_the_tick() {
    // burst "if k < c"; spread "floor(((k+1)*c + h)/M) > floor((k*c + h)/M) with h = floor(M/2)".
    let rows: &[(u64, u64, &[u64], &[u64])] = &[
        // M, c, burst, spread
        (4, 0, &[], &[]),
        (4, 1, &[0], &[1]),
        (4, 2, &[0, 1], &[0, 2]),
        (4, 3, &[0, 1, 2], &[0, 1, 3]),
        (4, 4, &[0, 1, 2, 3], &[0, 1, 2, 3]),
        (5, 1, &[0], &[2]),
        (5, 2, &[0, 1], &[1, 3]),
        (5, 3, &[0, 1, 2], &[0, 2, 4]),
        (5, 4, &[0, 1, 2, 3], &[0, 1, 3, 4]),
        (1, 1, &[0], &[0]),
        (10, 3, &[0, 1, 2], &[1, 4, 8]),
    ];
    for &(slots, count, burst, spread) in rows {
        for (is_spread, expected) in [(false, burst), (true, spread)] {
            let config = Config { slots, spread: is_spread, ..base() };
            let fired: Vec<u64> = (0..slots).filter(|&k| fires(&config, count, k)).collect();
            assert_eq!(fired, expected, "M = {slots}, c = {count}, spread = {is_spread}");
            // Slot k starts at c0 + k*Ts = 154 + 10*k.
            let run = run(&config, &sent(&[(1, &[count as u8])], 400));
            assert_eq!(steps(&run, 0), expected.iter().map(|k| 155 + 10 * k).collect::<Vec<_>>());
        }
    }
}

#[test]
fn a_spread_tick_has_the_requested_steps() {
    for slots in 1..=127 {
        let config = Config { slots, spread: true, ..base() };
        for count in 0..=slots {
            assert_eq!((0..slots).filter(|&k| fires(&config, count, k)).count() as u64, count);
        }
    }
}

#[test]
fn positions_count_rises_by_the_direction_of_the_same_cycle() {
    // Right 3, then left 1: DIR changes at c0 = 314, where with D = 0 STEP rises too.
    let config = Config { dir_setup: 0, ..base() };
    let input = |cycles| sent(&[(1, &[0x83, 0x01])], cycles);
    let full = run(&config, &input(500));
    assert_eq!(steps(&full, 0), [154, 164, 174, 314]);
    assert_eq!(edges(&full, bits::DIR), [(154, true), (314, false)]);
    assert_eq!(full.positions[0], 2);
    // A rise in the last cycle of the run counts; a later one does not.
    for (cycles, position) in [(154, 0), (155, 1), (164, 1), (165, 2), (175, 3), (314, 3), (315, 2)] {
        assert_eq!(run(&config, &input(cycles)).positions[0], position, "{cycles} cycles");
    }
}

#[test]
fn when_idle_step_is_0_and_dir_keeps_its_level() {
    let run = run(&Config { channels: 2, ..base() }, &sent(&[(1, &[0x81, 0x01])], 3_000));
    assert_eq!(edges(&run, bits::DIR), [(314, true)]);
    assert_eq!(run.trace.last(), Some(&(317, 1 << 16 | 0b0111 << 32)));
}

#[test]
fn configurations_are_refused_by_the_timing_rules() {
    // W = 2, D + H = 2: L = 4.
    let simultaneous = |step_period| Config { step_period, ..base() };
    let common = |step_period| Config { step_period, common_dir: true, ..base() };
    let staggered = |channels, step_period| Config { channels, step_period, staggered: true, ..base() };
    let both =
        |step_period, settle| Config { step_period, settle, common_dir: true, ..staggered(3, step_period) };
    let rows = [
        (false, simultaneous(4)),
        (true, simultaneous(3)),
        (false, common(8)),
        (true, common(7)),
        (false, staggered(1, 4)),
        (false, staggered(3, 12)),
        (true, staggered(3, 11)),
        (true, staggered(3, 0)),
        (false, both(12, 4)),
        (true, both(12, 3)),
        (true, both(11, 4)),
        // max(D + H, 1): L = 3 with neither set-up nor hold.
        (false, Config { dir_setup: 0, dir_hold: 0, ..simultaneous(3) }),
        (true, Config { dir_setup: 0, dir_hold: 0, ..simultaneous(2) }),
        (false, Config { dir_setup: 0, dir_hold: 1, ..simultaneous(3) }),
        (true, Config { dir_setup: 2, dir_hold: 1, ..simultaneous(4) }),
        (true, Config { pulse_width: 0, ..base() }),
        // B = 11 and 10.
        (false, Config { clock_hz: 10_500, ..base() }),
        (true, Config { clock_hz: 10_499, ..base() }),
        (false, Config { channels: 16, ..base() }),
        (true, Config { channels: 17, ..base() }),
        (true, Config { channels: 0, ..base() }),
        (false, Config { slots: 127, ..base() }),
        (true, Config { slots: 128, ..base() }),
        (true, Config { slots: 0, ..base() }),
        (false, Config { queue_depth: 255, ..base() }),
        (true, Config { queue_depth: 256, ..base() }),
        (true, Config { queue_depth: 0, ..base() }),
        (false, Config { address: Some(254), ..base() }),
        (true, Config { address: Some(255), ..base() }),
    ];
    for (expected, config) in rows {
        assert_eq!(refused(&config), expected, "{config:?}");
    }
}
