//! A7: positions of pulses and DIR changes in a slot, in each of the four modes.
//!
//! Three channels without addresses: three bytes without pauses from cycle 1 are committed at 473, so c0 =
//! 474 for the first tick. All times below are relative to c0.

use super::*;

const C0: u64 = 474;

fn three() -> Config {
    Config { channels: 3, step_period: 30, settle: 8, ..base() }
}

/// STEP edges of channels 0..=2 and DIR changes of channel 0, relative to c0, of a tick with these commands.
#[derive(Debug, PartialEq)]
struct Slots {
    step: [Vec<u64>; 3],
    dir: Vec<(u64, bool)>,
}

fn tick(config: &Config, orders: [u8; 3]) -> Slots {
    let run = run(config, &sent(&[(1, &orders)], 2_000));
    let edges =
        |bit| edges(&run, bit).into_iter().map(|(cycle, level)| (cycle - C0, level)).collect::<Vec<_>>();
    let step = [0, 1, 2].map(|channel| edges(channel).into_iter().map(|(cycle, _)| cycle).collect());
    if config.common_dir {
        // "all used channels' bits show the one line", and those of others stay 0.
        assert_eq!(edges(bits::DIR), edges(bits::DIR + 1));
        assert_eq!(edges(bits::DIR), edges(bits::DIR + 2));
        assert_eq!(edges(bits::DIR + 3), []);
    }
    Slots { step, dir: edges(bits::DIR) }
}

/// Commands, then STEP edges per channel and DIR changes, relative to c0.
type Row<'a> = ([u8; 3], [&'a [u64]; 3], &'a [(u64, bool)]);

fn check(config: &Config, rows: &[Row]) {
    for (orders, step, dir) in rows {
        let expected = Slots { step: step.map(<[u64]>::to_vec), dir: dir.to_vec() };
        assert_eq!(tick(config, *orders), expected, "{orders:02X?}");
    }
}

#[test]
fn simultaneous_channels_all_rise_at_s_plus_d() {
    let config = Config { dir_setup: 3, pulse_width: 5, ..three() };
    check(
        &config,
        &[
            ([0x81, 0x01, 0x81], [&[3, 8], &[3, 8], &[3, 8]], &[(0, true)]),
            ([0x02, 0x81, 0x00], [&[3, 8, 33, 38], &[3, 8], &[]], &[]),
        ],
    );
}

#[test]
fn dir_takes_its_level_at_c0_even_with_a_count_of_0() {
    check(&three(), &[([0x80, 0x00, 0x00], [&[], &[], &[]], &[(0, true)])]);
    // The next tick reverses it.
    let run = run(&three(), &sent(&[(1, &[0x80, 0x80, 0x00, 0x00, 0x80, 0x80])], 2_000));
    assert_eq!(edges(&run, bits::DIR), [(474, true), (954, false)]);
    assert_eq!(edges(&run, bits::DIR + 1), [(474, true)]);
    assert_eq!(edges(&run, bits::DIR + 2), [(954, true)]);
    assert_eq!(edges(&run, bits::DIR + 3), []);
}

#[test]
fn the_jth_staggered_channel_rises_j_d_later() {
    // "d = min(dp, floor(Ts/nd))": dp = 8, Ts = 30: 8 for nd = 1..=3. D = 1, W = 2.
    let config = Config { staggered: true, ..three() };
    check(
        &config,
        &[
            ([0x01, 0x01, 0x01], [&[1, 3], &[9, 11], &[17, 19]], &[]),
            // j counts the stepping channels in ascending order, right or left.
            ([0x00, 0x01, 0x81], [&[], &[1, 3], &[9, 11]], &[]),
            // The second slot starts at 30, with two.
            ([0x01, 0x02, 0x02], [&[1, 3], &[9, 11, 31, 33], &[17, 19, 39, 41]], &[]),
        ],
    );
    // dp = 14: d = 10 for three, 14 for two.
    let config = Config { settle: 14, ..config };
    check(
        &config,
        &[
            ([0x01, 0x01, 0x01], [&[1, 3], &[11, 13], &[21, 23]], &[]),
            ([0x01, 0x00, 0x01], [&[1, 3], &[], &[15, 17]], &[]),
        ],
    );
    // Ts = 31 rounds down: floor(31/3) = 10, floor(31/2) = 15.
    let config = Config { settle: 100, step_period: 31, ..config };
    check(
        &config,
        &[
            ([0x01, 0x01, 0x01], [&[1, 3], &[11, 13], &[21, 23]], &[]),
            ([0x01, 0x00, 0x01], [&[1, 3], &[], &[16, 18]], &[]),
        ],
    );
    // dp = 0 is simultaneous.
    let config = Config { settle: 0, ..config };
    check(&config, &[([0x01, 0x01, 0x01], [&[1, 3], &[1, 3], &[1, 3]], &[])]);
}

#[test]
fn staggered_edges_match_the_patents_numbers() {
    // Part E: Ts = 2.048 ms, dp = 0.518 ms, four motors: d = 0.512 ms. At 1 MHz, B = 16; committed at 633.
    let config = Config {
        clock_hz: 1_000_000,
        baud: 62_500,
        receiver_baud: 62_500,
        channels: 4,
        step_period: 2_048,
        settle: 518,
        staggered: true,
        ..base()
    };
    let run = run(&config, &sent(&[(1, &[1, 1, 1, 1])], 4_000));
    for channel in 0..4 {
        assert_eq!(steps(&run, channel), [634 + 1 + 512 * u64::from(channel)]);
    }
}

#[test]
fn with_a_common_dir_left_steps_precede_right_steps() {
    // W = 5, D = 3, H = 2: DIR = 0 at s, left at 3, DIR = 1 at D + W + H = 10, right at 2D + W + H = 13.
    let config = Config { common_dir: true, pulse_width: 5, dir_setup: 3, dir_hold: 2, ..three() };
    check(
        &config,
        &[
            ([0x01, 0x81, 0x01], [&[3, 8], &[13, 18], &[3, 8]], &[(10, true)]),
            // "both DIR changes happen even if all go one way".
            ([0x02, 0x00, 0x00], [&[3, 8, 33, 38], &[], &[]], &[(10, true), (30, false), (40, true)]),
            ([0x00, 0x82, 0x00], [&[], &[13, 18, 43, 48], &[]], &[(10, true), (30, false), (40, true)]),
            // "if nd > 0", and "nothing moves at c0".
            ([0x80, 0x80, 0x80], [&[], &[], &[]], &[]),
        ],
    );
    let spread = Config { spread: true, ..config };
    // M = 4, c = 1 steps in slot 1 only.
    check(&spread, &[([0x01, 0x81, 0x00], [&[33, 38], &[43, 48], &[]], &[(40, true)])]);
}

#[test]
fn minimum_times_give_the_patents_five_cycle_sequence() {
    let config =
        Config { common_dir: true, pulse_width: 1, dir_setup: 1, dir_hold: 0, step_period: 4, ..three() };
    assert!(!refused(&config));
    check(
        &config,
        &[([0x02, 0x82, 0x00], [&[1, 2, 5, 6], &[3, 4, 7, 8], &[]], &[(2, true), (4, false), (6, true)])],
    );
}

#[test]
fn staggered_with_common_dir_left_channels_precede_right_ones() {
    // d = 8, D = 1, W = 2; "DIR = 1 at (rise of the first right one) - D".
    let config = Config { common_dir: true, staggered: true, ..three() };
    check(
        &config,
        &[
            ([0x81, 0x01, 0x81], [&[9, 11], &[1, 3], &[17, 19]], &[(8, true)]),
            ([0x81, 0x01, 0x01], [&[17, 19], &[1, 3], &[9, 11]], &[(16, true)]),
            // Only right steps: DIR = 1 at s, and no reversal in the next slot.
            ([0x81, 0x82, 0x00], [&[1, 3], &[9, 11, 31, 33], &[]], &[(0, true)]),
            // "DIR = 0 at s if there is a left one".
            ([0x02, 0x81, 0x00], [&[1, 3, 31, 33], &[9, 11], &[]], &[(8, true), (30, false)]),
            // Only left steps: no change from reset.
            ([0x02, 0x00, 0x01], [&[1, 3, 31, 33], &[], &[9, 11]], &[]),
            ([0x80, 0x80, 0x80], [&[], &[], &[]], &[]),
        ],
    );
    // D = 3, W = 2, H = 2: L = 7 <= 8 = d.
    let config = Config { dir_setup: 3, dir_hold: 2, ..config };
    check(&config, &[([0x81, 0x01, 0x81], [&[11, 13], &[3, 5], &[19, 21]], &[(8, true)])]);
}

#[test]
fn positions_count_by_the_common_dir_at_the_rise() {
    for staggered in [false, true] {
        let config = Config { common_dir: true, staggered, dir_setup: 0, ..three() };
        let run = run(&config, &sent(&[(1, &[0x83, 0x02, 0x81])], 2_000));
        assert_eq!(run.positions[..3], [3, -2, 1], "staggered = {staggered}");
    }
}

#[test]
fn unused_channels_stay_0() {
    for common_dir in [false, true] {
        let config = Config { channels: 2, common_dir, ..three() };
        let run = run(&config, &sent(&[(1, &[0x84, 0x84])], 1_000));
        for &(_, levels) in &run.trace {
            assert_eq!(levels & 0xFFFC_FFFC, 0);
        }
        assert_eq!(run.positions[2..], [0; 14]);
    }
}
