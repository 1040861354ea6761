//! Compares moves with shaped ramps with differences, integers and values of 60 digits.

use crate::{
    Curve,
    curves::{cosine::Cosine, ramps::*},
};
use alloc::vec::Vec;

fn shapes() -> [Ramp; 7] {
    let [a, b, c] = [1.0, 6.0, 20.0].map(Ramp::sigmoid);
    [Ramp::Straight, Ramp::Bezier, a, b, c, Ramp::exponential(0.1), Ramp::exponential(4.0)]
}

/// Various moves: (steps, duration, ramp).
const MOVES: &[(i64, f64, f64)] = &[
    (3200, 0.4, 0.2),
    (-6400, 0.4, 0.1),
    (6401, 0.3, 0.0),
    (1, 2.0, 1.0),
    (-2, 1e-6, 5e-7),
    (10, 1e-6, 5e-324),
    (1_000_000_000, 86_400.0, 43_200.0),
    (1_000_000_000, 86_400.0, 1e-6),
    (7, 86_400.0, 1.0),
];

#[test]
fn top_speeds_follow_from_the_area() {
    for ramp in [Ramp::Straight, Ramp::Bezier, Ramp::sigmoid(6.0)] {
        assert_eq!(Ramps::new(6400, 0.4, 0.2, ramp).top_speed(), Cosine::new(6400, 0.4, 0.2).top_speed());
    }
    // 6400/(0.4 - 0.4*(1 - 0.7686573603637741)).
    let found = Ramps::new(-6400, 0.4, 0.2, Ramp::exponential(4.0)).top_speed();
    assert!((found - 20_815.516_542_283_4).abs() < 1e-6, "{found}");
    let longest = Ramps::new(3200, 0.4, 0.2, Ramp::sigmoid(6.0)).longest_ramp_s(19_200.0).unwrap();
    assert!((longest - 0.233_333_3).abs() < 1e-6, "{longest}");
}

#[test]
fn sharper_shapes_have_more_breakpoints() {
    // 64 parts per ramp, and once more per 8 of the range or of the time constants; the middle belongs to both ramps.
    let rows = [
        (Ramp::Straight, 127),
        (Ramp::Bezier, 127),
        (Ramp::sigmoid(6.0), 127),
        (Ramp::sigmoid(8.0), 255),
        (Ramp::sigmoid(20.0), 383),
        (Ramp::exponential(4.0), 127),
        (Ramp::exponential(16.0), 383),
    ];
    for (ramp, expected) in rows {
        assert_eq!(Ramps::new(3200, 0.4, 0.2, ramp).breakpoints_s().len(), expected, "{ramp:?}");
    }
}

#[test]
fn ends_exactly_with_mirrored_halves_and_no_reversal() {
    for ramp in shapes() {
        for &(steps, duration_s, ramp_s) in MOVES {
            let curve = Ramps::new(steps, duration_s, ramp_s, ramp);
            assert_eq!((curve.position(0.0), curve.position(duration_s)), (0.0, steps as f64));
            let count = steps.unsigned_abs() as f64;
            let mut before = 0.0;
            for i in 0..=4000 {
                let t = duration_s * f64::from(i) / 4000.0;
                let position = libm::fabs(curve.position(t));
                assert!(
                    position >= before && position <= count,
                    "{ramp:?} {steps} at {t}: {before} {position}"
                );
                before = position;
                let mirrored = count - libm::fabs(curve.position(duration_s - t));
                assert!((position - mirrored).abs() <= 1e-13 * count, "{ramp:?} {steps} at {t}");
            }
        }
    }
}

#[test]
fn speed_and_acceleration_are_derivatives() {
    for ramp in shapes() {
        for (steps, duration_s, ramp_s) in [(3200, 0.4, 0.2), (-6400, 0.4, 0.1), (1, 2.0, 0.5)] {
            let curve = Ramps::new(steps, duration_s, ramp_s, ramp);
            let peaks = curve.peaks();
            let dt = duration_s * 1e-6;
            for i in 0..1000 {
                // Except at breakpoints.
                let t = duration_s * (f64::from(i) + 0.37) / 1000.0;
                let slope = |of: &dyn Fn(f64) -> f64| (of(t + dt) - of(t - dt)) / (2.0 * dt);
                let (speed, acceleration) = (slope(&|t| curve.position(t)), slope(&|t| curve.speed(t)));
                assert!((speed - curve.speed(t)).abs() < 1e-6 * peaks.speed, "{ramp:?} at {t}");
                let error = (acceleration - curve.acceleration(t)).abs();
                assert!(error < 1e-6 * peaks.acceleration, "{ramp:?} at {t}: {error}");
                assert!(curve.acceleration(t).abs() <= peaks.acceleration * (1.0 + 1e-12));
            }
        }
    }
}

#[test]
fn a_step_is_in_the_cycle_where_the_rounded_position_changes() {
    let clock = 16e6;
    for ramp in shapes() {
        for &(steps, duration_s, ramp_s) in MOVES {
            let curve = Ramps::new(steps, duration_s, ramp_s, ramp);
            let count = steps.unsigned_abs();
            // All steps of a short move; the first, the last and some others of a long one.
            let some = (0..1000).map(|i| 1 + i * (count - 1) / 999);
            let all: Vec<u64> =
                (1..=count.min(7000)).chain(some).chain(count.saturating_sub(99).max(1)..=count).collect();
            for k in all {
                let position = k as f64 - 0.5;
                let cycle = libm::floor(curve.time_s(position) * clock + 0.5);
                let at = |cycle: f64| libm::fabs(curve.position(cycle / clock));
                // The rounding error of the position.
                let digit = count as f64 * 4.0 * f64::EPSILON;
                let (before, after) = (at(cycle - 1.0), at(cycle + 1.0));
                assert!(
                    before <= position + digit && after >= position - digit,
                    "{ramp:?} {steps}: step {k} at {cycle}, {before} {after}"
                );
            }
        }
    }
}

/// Ramp, steps, duration, ramp time, and some steps with the nanoseconds in which they are due, by bisection of independent
/// formulas with 60 digits.
type Due = (fn() -> Ramp, i64, f64, f64, &'static [(u64, u64)]);
const DUE: &[Due] = &[
    (
        || Ramp::sigmoid(0.1),
        3_200,
        0.4,
        0.2,
        &[
            (1, 3_538_377),
            (2, 6_128_519),
            (458, 106_965_528),
            (1_600, 199_968_747),
            (3_199, 393_871_480),
            (3_200, 396_461_622),
        ],
    ),
    (
        || Ramp::sigmoid(0.1),
        1_000_000_000,
        86400.0,
        43200.0,
        &[
            (1, 1_367_242_392),
            (2, 2_368_133_197),
            (142_857_143, 23_095_537_902_610),
            (500_000_000, 43_199_999_978_399),
            (999_999_999, 86_397_631_866_802),
            (1_000_000_000, 86_398_632_757_607),
        ],
    ),
    (
        || Ramp::sigmoid(0.1),
        1_000_000_000,
        86400.0,
        0.001,
        &[
            (1, 294_060),
            (2, 509_219),
            (142_857_143, 12_342_857_469_142),
            (500_000_000, 43_199_999_956_800),
            (999_999_999, 86_399_999_490_780),
            (1_000_000_000, 86_399_999_705_939),
        ],
    ),
    (|| Ramp::sigmoid(0.1), 1, 2.0, 1.0, &[(1, 1_000_000_000)]),
    (|| Ramp::sigmoid(0.1), 3, 1e-06, 5e-07, &[(1, 288), (2, 499), (3, 711)]),
    (
        || Ramp::sigmoid(6.0),
        3_200,
        0.4,
        0.2,
        &[
            (1, 17_049_430),
            (2, 26_363_763),
            (458, 125_545_302),
            (1_600, 199_968_749),
            (3_199, 373_636_236),
            (3_200, 382_950_569),
        ],
    ),
    (
        || Ramp::sigmoid(6.0),
        1_000_000_000,
        86400.0,
        43200.0,
        &[
            (1, 7_918_023_612),
            (2, 13_710_758_111),
            (142_857_143, 27_111_933_228_979),
            (500_000_000, 43_199_999_978_399),
            (999_999_999, 86_386_289_241_888),
            (1_000_000_000, 86_392_081_976_387),
        ],
    ),
    (
        || Ramp::sigmoid(6.0),
        1_000_000_000,
        86400.0,
        0.001,
        &[
            (1, 470_610),
            (2, 611_197),
            (142_857_143, 12_342_857_469_142),
            (500_000_000, 43_199_999_956_800),
            (999_999_999, 86_399_999_388_802),
            (1_000_000_000, 86_399_999_529_389),
        ],
    ),
    (|| Ramp::sigmoid(6.0), 1, 2.0, 1.0, &[(1, 1_000_000_000)]),
    (|| Ramp::sigmoid(6.0), 3, 1e-06, 5e-07, &[(1, 327), (2, 499), (3, 672)]),
    (
        || Ramp::sigmoid(20.0),
        3_200,
        0.4,
        0.2,
        &[
            (1, 74_639_790),
            (2, 80_164_150),
            (458, 128_577_304),
            (1_600, 199_968_749),
            (3_199, 319_835_849),
            (3_200, 325_360_209),
        ],
    ),
    (
        || Ramp::sigmoid(20.0),
        1_000_000_000,
        86400.0,
        43200.0,
        &[
            (1, 2_794_000_583_745),
            (2, 3_796_497_469_610),
            (142_857_143, 27_767_860_315_636),
            (500_000_000, 43_199_999_978_399),
            (999_999_999, 82_603_502_530_389),
            (1_000_000_000, 83_605_999_416_254),
        ],
    ),
    (
        || Ramp::sigmoid(20.0),
        1_000_000_000,
        86400.0,
        0.001,
        &[
            (1, 538_310),
            (2, 629_459),
            (142_857_143, 12_342_857_469_142),
            (500_000_000, 43_199_999_956_800),
            (999_999_999, 86_399_999_370_540),
            (1_000_000_000, 86_399_999_461_689),
        ],
    ),
    (|| Ramp::sigmoid(20.0), 1, 2.0, 1.0, &[(1, 1_000_000_000)]),
    (|| Ramp::sigmoid(20.0), 3, 1e-06, 5e-07, &[(1, 333), (2, 499), (3, 666)]),
    (
        || Ramp::Bezier,
        3_200,
        0.4,
        0.2,
        &[
            (1, 10_871_572),
            (2, 15_745_535),
            (458, 117_422_453),
            (1_600, 199_968_749),
            (3_199, 384_254_464),
            (3_200, 389_128_427),
        ],
    ),
    (
        || Ramp::Bezier,
        1_000_000_000,
        86400.0,
        43200.0,
        &[
            (1, 34_292_400_239),
            (2, 49_461_095_351),
            (142_857_143, 25_355_587_275_603),
            (500_000_000, 43_199_999_978_399),
            (999_999_999, 86_350_538_904_648),
            (1_000_000_000, 86_365_707_599_760),
        ],
    ),
    (
        || Ramp::Bezier,
        1_000_000_000,
        86400.0,
        0.001,
        &[
            (1, 376_113),
            (2, 565_318),
            (142_857_143, 12_342_857_469_142),
            (500_000_000, 43_199_999_956_800),
            (999_999_999, 86_399_999_434_681),
            (1_000_000_000, 86_399_999_623_886),
        ],
    ),
    (|| Ramp::Bezier, 1, 2.0, 1.0, &[(1, 1_000_000_000)]),
    (|| Ramp::Bezier, 3, 1e-06, 5e-07, &[(1, 311), (2, 499), (3, 688)]),
    (
        || Ramp::exponential(0.1),
        3_200,
        0.4,
        0.2,
        &[
            (1, 3_478_585),
            (2, 6_026_365),
            (458, 106_123_399),
            (1_600, 199_968_226),
            (3_199, 393_973_634),
            (3_200, 396_521_414),
        ],
    ),
    (
        || Ramp::exponential(0.1),
        1_000_000_000,
        86400.0,
        43200.0,
        &[
            (1, 1_343_710_712),
            (2, 2_327_376_108),
            (142_857_143, 22_913_626_170_800),
            (500_000_000, 43_199_999_978_040),
            (999_999_999, 86_397_672_623_891),
            (1_000_000_000, 86_398_656_289_287),
        ],
    ),
    (
        || Ramp::exponential(0.1),
        1_000_000_000,
        86400.0,
        0.001,
        &[
            (1, 288_118),
            (2, 500_795),
            (142_857_143, 12_342_857_463_191),
            (500_000_000, 43_199_999_956_800),
            (999_999_999, 86_399_999_499_204),
            (1_000_000_000, 86_399_999_711_881),
        ],
    ),
    (|| Ramp::exponential(0.1), 1, 2.0, 1.0, &[(1, 1_000_000_000)]),
    (|| Ramp::exponential(0.1), 3, 1e-06, 5e-07, &[(1, 286), (2, 499), (3, 713)]),
    (
        || Ramp::exponential(4.0),
        3_200,
        0.4,
        0.2,
        &[
            (1, 2_187_497),
            (2, 3_809_188),
            (458, 83_795_612),
            (1_600, 199_951_958),
            (3_199, 396_190_811),
            (3_200, 397_812_502),
        ],
    ),
    (
        || Ramp::exponential(4.0),
        1_000_000_000,
        86400.0,
        43200.0,
        &[
            (1, 839_125_084),
            (2, 1_453_421_058),
            (142_857_143, 18_090_899_870_017),
            (500_000_000, 43_199_999_966_794),
            (999_999_999, 86_398_546_578_941),
            (1_000_000_000, 86_399_160_874_915),
        ],
    ),
    (
        || Ramp::exponential(4.0),
        1_000_000_000,
        86400.0,
        0.001,
        &[
            (1, 161_235),
            (2, 302_752),
            (142_857_143, 12_342_857_277_244),
            (500_000_000, 43_199_999_956_800),
            (999_999_999, 86_399_999_697_247),
            (1_000_000_000, 86_399_999_838_764),
        ],
    ),
    (|| Ramp::exponential(4.0), 1, 2.0, 1.0, &[(1, 1_000_000_000)]),
    (|| Ramp::exponential(4.0), 3, 1e-06, 5e-07, &[(1, 231), (2, 499), (3, 768)]),
    (
        || Ramp::exponential(20.0),
        3_200,
        0.4,
        0.2,
        &[
            (1, 1_109_881),
            (2, 1_948_748),
            (458, 64_312_019),
            (1_600, 199_940_624),
            (3_199, 398_051_251),
            (3_200, 398_890_118),
        ],
    ),
    (
        || Ramp::exponential(20.0),
        1_000_000_000,
        86400.0,
        43200.0,
        &[
            (1, 421_075_196),
            (2, 729_340_980),
            (142_857_143, 13_882_220_738_961),
            (500_000_000, 43_199_999_958_959),
            (999_999_999, 86_399_270_659_019),
            (1_000_000_000, 86_399_578_924_803),
        ],
    ),
    (
        || Ramp::exponential(20.0),
        1_000_000_000,
        86400.0,
        0.001,
        &[
            (1, 83_854),
            (2, 178_183),
            (142_857_143, 12_342_857_147_714),
            (500_000_000, 43_199_999_956_800),
            (999_999_999, 86_399_999_821_816),
            (1_000_000_000, 86_399_999_916_145),
        ],
    ),
    (|| Ramp::exponential(20.0), 1, 2.0, 1.0, &[(1, 1_000_000_000)]),
    (|| Ramp::exponential(20.0), 3, 1e-06, 5e-07, &[(1, 183), (2, 499), (3, 816)]),
];

#[test]
fn steps_are_within_a_nanosecond_of_values_of_60_digits() {
    for (ramp, steps, duration_s, ramp_s, due) in DUE {
        let curve = Ramps::new(*steps, *duration_s, *ramp_s, ramp());
        for &(k, nanosecond) in *due {
            let cycle = libm::floor(curve.time_s(k as f64 - 0.5) * 1e9 + 0.5) as u64;
            // The ideal is within the nanosecond that begins there.
            let near = cycle + 1 >= nanosecond && cycle <= nanosecond + 2;
            assert!(near, "{:?}: step {k} of {steps} at {cycle}, not {nanosecond}", ramp());
        }
    }
}

#[test]
fn steps_of_a_straight_ramp_agree_with_integers() {
    // 6400 steps in 0.4 s, ramps 0.2 s: s = f_max*t^2/(2*t_s) = 80000*t^2, so at c cycles of 16 MHz
    // s = c^2/3.2e9, and step k is due where c^2 = 1.6e9*(2k - 1).
    let curve = Ramps::new(6400, 0.4, 0.2, Ramp::Straight);
    for k in 1..=3200_i128 {
        let cycle = libm::floor(curve.time_s(k as f64 - 0.5) * 16e6 + 0.5) as i128;
        let level = 4 * 1_600_000_000 * (2 * k - 1);
        let square = |half_cycles: i128| half_cycles * half_cycles;
        assert!(square(2 * cycle - 1) <= level && level <= square(2 * cycle + 1), "step {k} at {cycle}");
    }
}

#[test]
fn peaks_follow_the_formulas() {
    // f_max = 16000, t_s = 0.2: slopes of 80000, bends of 400000.
    let peaks = |ramp| Ramps::new(3200, 0.4, 0.2, ramp).peaks();
    let straight = peaks(Ramp::Straight);
    assert_eq!(
        straight,
        Peaks { speed: 16_000.0, acceleration: 80_000.0, acceleration_jump: 160_000.0, ..Peaks::default() }
    );
    let bezier = peaks(Ramp::Bezier);
    assert_eq!((bezier.acceleration, bezier.jerk, bezier.acceleration_jump), (120_000.0, 2_400_000.0, 0.0));
    // r/(2*tanh(3)) = 3.014909…, 6/sinh(6) = 0.0297452…, 36*2/(3*sqrt(3))/tanh(3) = 13.92527….
    let sigmoid = peaks(Ramp::sigmoid(6.0));
    for (found, expected) in [
        (sigmoid.acceleration, 80_000.0 * 3.014_909_469_941),
        (sigmoid.acceleration_jump, 160_000.0 * 0.029_745_208_880_876),
        (sigmoid.jerk, 400_000.0 * 13.925_270_352_422_6),
    ] {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
    assert_eq!(Ramps::new(3200, 0.4, 0.0, Ramp::Bezier).peaks(), Peaks { speed: 8000.0, ..Peaks::default() });
}
