//! A list of steps always has the same entries (DESIGN B8): a search may become faster, but must not choose others.

use rand_xoshiro::{
    Xoshiro256PlusPlus,
    rand_core::{Rng, SeedableRng},
};
use std::num::NonZeroU32;
use stepscope_motion::{
    ScheduledStep,
    mechanics::{Acceleration, Distance, Jerk, Speed},
    moves::{Axis, JerkLimited, Move, Sine, Staircase, Trapezoid, TrapezoidMethod},
    plan_axis,
    step_tables::{Compressed, EntryFormat, Side, Tolerance, compressed, compressed_quickly},
};
use stepscope_peripheral::{
    segment::{PulseTimes, Segment},
    units::Cycles,
};

const CLOCK_HZ: u32 = 16_000_000;
const PULSE: PulseTimes = PulseTimes { width: Cycles(16), setup: Cycles(2), hold: Cycles(2) };
/// Narrow numbers, so that each limit matters.
const NARROW: EntryFormat = EntryFormat::new("narrow", 2, [16, 8, 8]).expect("valid widths");

fn steps(given: Move) -> Vec<ScheduledStep> {
    let axis = Axis { moves: vec![given], ..Axis::default() };
    plan_axis(&axis, "x").expect("a valid move").due_steps(CLOCK_HZ).collect()
}

fn lists() -> [Vec<ScheduledStep>; 5] {
    let trapezoid = Trapezoid {
        distance: Distance::Steps(-900.0),
        method: TrapezoidMethod::Exact,
        ..Trapezoid::default()
    };
    let jerk_limited = JerkLimited {
        distance: Distance::Steps(700.0),
        max_speed: Speed::StepsPerSecond(6000.0),
        max_acceleration: Acceleration::StepsPerSecond2(40_000.0),
        max_jerk: Jerk::StepsPerSecond3(1e6),
        ..JerkLimited::default()
    };
    let sine = Sine { amplitude: Distance::Steps(110.0), period_s: 0.3, periods: 2 };
    let staircase = Staircase { distance: Distance::Steps(800.0), ..Staircase::default() };
    // Noise, reversals and pauses longer than any interval of the narrow format.
    let mut noise = Xoshiro256PlusPlus::seed_from_u64(1);
    let (mut cycle, mut right) = (0, false);
    let noisy = (0..600).map(|_| {
        let draw = noise.next_u64();
        right ^= draw.is_multiple_of(67);
        cycle += if draw.is_multiple_of(101) { 70_000 } else { 4000 + draw % 90 };
        ScheduledStep { cycle, right }
    });
    [
        steps(Move::Trapezoid(trapezoid)),
        steps(Move::JerkLimited(jerk_limited)),
        steps(Move::Sine(sine)),
        steps(Move::Staircase(staircase)),
        noisy.collect(),
    ]
}

/// FNV-1a of all numbers of the entries.
fn digest(made: &Compressed) -> u64 {
    let numbers = made.list.segments.iter().flat_map(|segment| match *segment {
        Segment::Dwell(time) => [0, time, 0, 0],
        Segment::Steps { count, interval, add, right } => {
            [u64::from(count), interval, add.cast_unsigned(), 1 + u64::from(right)]
        }
    });
    numbers.flat_map(u64::to_le_bytes).fold(0xcbf2_9ce4_8422_2325, |digest, byte| {
        (digest ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// Number of entries, surplus and digest.
type Found = (usize, Option<u64>, u64);

fn found(made: &Compressed) -> Found {
    (made.list.segments.len(), made.surplus, digest(made))
}

fn check(format: EntryFormat, cycles: u64, side: Side, expected: [(Found, Found); 5]) {
    let tolerance = Tolerance { cycles: Cycles(cycles), interval_part: NonZeroU32::new(2), side };
    let found = lists().map(|steps| {
        let fewest = compressed(steps.iter().copied(), tolerance, format, PULSE).expect("it fits");
        let quick = compressed_quickly(steps.iter().copied(), tolerance, format, PULSE).expect("it fits");
        (found(&fewest), found(&quick))
    });
    assert_eq!(found, expected, "{} with {cycles} cycles, {side:?}", format.name);
}

#[test]
fn exact_cycles_always_have_the_same_entries() {
    check(
        EntryFormat::Q8,
        0,
        Side::Both,
        [
            ((243, Some(0), 0x52c3_ca73_de1d_d97f), (253, None, 0xdf0f_d113_a518_a3bc)),
            ((185, Some(0), 0x239f_4a97_043e_8685), (193, None, 0x0eae_ac3c_2325_f3ea)),
            ((444, Some(0), 0x18b7_6db9_c457_6c84), (444, None, 0x4e09_5687_b6d0_e285)),
            ((1, Some(0), 0x4ee0_26e8_d0d2_17a4), (1, None, 0x4ee0_26e8_d0d2_17a4)),
            ((300, Some(0), 0x2a8e_38b0_cc46_33a9), (300, None, 0xa15e_8db9_7f3b_f20d)),
        ],
    );
}

#[test]
fn narrow_windows_always_have_the_same_entries() {
    check(
        EntryFormat::TICKS,
        40,
        Side::Both,
        [
            ((52, Some(0), 0xa1d7_8512_4ce4_ed2a), (56, None, 0xb2cc_d845_494b_e585)),
            ((46, Some(0), 0x4a05_c835_359e_079f), (49, None, 0x3d6f_10b0_21a5_3799)),
            ((111, Some(0), 0x97f6_bb4e_ab8c_4d74), (115, None, 0xe4a5_5cbe_3918_58c2)),
            ((1, Some(0), 0x4ee0_26e8_d0d2_17a4), (1, None, 0x4ee0_26e8_d0d2_17a4)),
            ((45, Some(0), 0x5114_d4cb_32f6_9a7c), (54, None, 0x2378_cec4_e312_909d)),
        ],
    );
}

#[test]
fn wide_windows_always_have_the_same_entries() {
    check(
        EntryFormat::TICKS,
        400,
        Side::Early,
        [
            ((30, Some(0), 0x9512_24f0_4aea_780e), (32, None, 0x35fd_350b_6d53_2847)),
            ((29, Some(0), 0x9314_ecc5_0e03_ba86), (30, None, 0xf2ec_8078_4adb_ed01)),
            ((71, Some(0), 0x6608_1655_c172_cd8b), (75, None, 0xfb2c_c96b_091d_ce7f)),
            ((1, Some(0), 0x4ee0_26e8_d0d2_17a4), (1, None, 0x4ee0_26e8_d0d2_17a4)),
            ((14, Some(0), 0x2938_18f9_8331_d139), (15, None, 0xe9dd_3495_1798_f4da)),
        ],
    );
}

#[test]
fn narrow_numbers_always_have_the_same_entries() {
    check(
        NARROW,
        100,
        Side::Both,
        [
            ((242, Some(8), 0xe95a_349e_b49f_fecf), (253, None, 0x1775_ae93_538b_39e5)),
            ((108, Some(0), 0xc79b_5536_91bc_9003), (125, None, 0xe891_913f_c6e7_c3fa)),
            ((312, Some(0), 0xf8b1_459b_cc62_c5f5), (364, None, 0xef03_a3c8_3caa_a8ed)),
            ((4, Some(0), 0xa064_208f_5910_1ae8), (4, None, 0xbddc_0d31_cb19_cc41)),
            ((20, Some(0), 0xcd66_de07_94e6_ec22), (22, None, 0x0467_5acf_7291_52d2)),
        ],
    );
}
