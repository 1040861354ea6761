//! Compares the shapes with values of 60 digits and with each other.

use super::*;
use alloc::vec::Vec;

/// Ramp, x, g, G, g', computed with 60 digits.
type Row = (fn() -> Ramp, f64, f64, f64, f64);
const ROWS: &[Row] = &[
    (
        || Ramp::sigmoid(6.0),
        1e-6,
        2.974_538_647_024_846e-08,
        1.487_266_363_683_690_2e-14,
        0.029_745_564_060_324_085,
    ),
    (
        || Ramp::sigmoid(6.0),
        0.062_5,
        0.002_761_157_139_086_046,
        7.567_805_047_816_436e-05,
        0.062_624_203_889_025_83,
    ),
    (|| Ramp::sigmoid(6.0), 0.5, 0.5, 0.056_599_545_065_099_77, 3.014_909_469_941_067_7),
    (
        || Ramp::sigmoid(6.0),
        0.875,
        0.991_443_365_862_619_7,
        0.375_407_274_487_316_14,
        0.131_042_795_568_367_81,
    ),
    (
        || Ramp::sigmoid(0.1),
        1e-6,
        9.983_352_807_171_285e-07,
        4.991_676_395_273_116e-13,
        0.998_335_285_704_642_7,
    ),
    (
        || Ramp::sigmoid(0.1),
        0.062_5,
        0.062_414_630_379_138_2,
        0.001_950_266_865_263_852_5,
        0.998_919_979_001_012,
    ),
    (|| Ramp::sigmoid(0.1), 0.5, 0.5, 0.124_947_942_694_390_62, 1.000_833_194_477_505),
    (
        || Ramp::sigmoid(0.1),
        0.875,
        0.875_136_619_122_139_2,
        0.382_802_539_640_600_24,
        0.999_427_091_204_922_6,
    ),
    (
        || Ramp::sigmoid(20.0),
        1e-6,
        8.244_779_384_241_933e-14,
        4.122_362_209_523_132e-20,
        8.244_944_280_928_241e-08,
    ),
    (
        || Ramp::sigmoid(20.0),
        0.062_5,
        2.304_883_740_375_234_4e-08,
        4.473_988_412_541_678_6e-10,
        1.004_399_615_997_104_4e-06,
    ),
    (|| Ramp::sigmoid(20.0), 0.5, 0.5, 0.017_328_678_503_327_12, 10.000_000_041_223_073),
    (
        || Ramp::sigmoid(20.0),
        0.875,
        0.999_999_696_158_925_5,
        0.375_000_007_338_383_85,
        1.223_608_538_441_899_5e-05,
    ),
    (
        || Ramp::exponential(4.0),
        1e-6,
        4.074_621_292_207_079e-06,
        2.037_312_004_310_636_8e-12,
        4.074_613_142_969_928,
    ),
    (
        || Ramp::exponential(4.0),
        0.062_5,
        0.225_326_210_431_016_55,
        0.007_334_532_414_981_738,
        3.173_324_599_731_029_8,
    ),
    (
        || Ramp::exponential(4.0),
        0.5,
        0.880_797_077_977_882_4,
        0.289_129_410_687_416_43,
        0.551_441_129_543_566_4,
    ),
    (
        || Ramp::exponential(4.0),
        0.875,
        0.987_896_573_476_902_3,
        0.644_351_046_949_076_7,
        0.123_043_147_547_487_02,
    ),
    (
        || Ramp::exponential(0.1),
        1e-6,
        1.050_833_141_935_847e-06,
        5.254_165_797_248_663e-13,
        1.050_833_089_394_190_8,
    ),
    (
        || Ramp::exponential(0.1),
        0.062_5,
        0.065_472_260_714_401_63,
        0.002_048_139_404_424_311,
        1.044_285_968_406_064_8,
    ),
    (
        || Ramp::exponential(0.1),
        0.5,
        0.512_497_396_484_210_3,
        0.129_192_007_545_421_37,
        0.999_583_454_829_084,
    ),
    (
        || Ramp::exponential(0.1),
        0.875,
        0.880_399_907_400_381_2,
        0.390_791_377_674_356_23,
        0.962_793_203_737_466_8,
    ),
];

fn ramps() -> Vec<Ramp> {
    let parameters = [0.1, 1.0, 4.0, 6.0, 20.0];
    let curved = parameters.iter().flat_map(|&p| [Ramp::sigmoid(p), Ramp::exponential(p)]);
    [Ramp::Straight, Ramp::Bezier].into_iter().chain(curved).collect()
}

#[test]
fn each_shape_goes_from_0_to_1_and_integrates_its_slope() {
    for ramp in ramps() {
        assert_eq!((ramp.speed(0.0), ramp.travel(0.0)), (0.0, 0.0), "{ramp:?}");
        assert!((ramp.speed(1.0) - 1.0).abs() < 1e-15, "{ramp:?}");
        assert!((ramp.travel(1.0) - ramp.area()).abs() < 1e-15, "{ramp:?}: {}", ramp.travel(1.0));
        let (slots, mut travel, mut speed) = (20_000, 0.0, 0.0);
        let (mut steepest, mut sharpest, mut before) = (0.0_f64, 0.0_f64, None);
        for slot in 0..slots {
            let x = (f64::from(slot) + 0.5) / f64::from(slots);
            let slope = ramp.slope(x);
            travel += ramp.speed(x) / f64::from(slots);
            speed += slope / f64::from(slots);
            let end = f64::from(slot + 1) / f64::from(slots);
            assert!((travel - ramp.travel(end)).abs() < 1e-7, "{ramp:?} at {end}");
            assert!((speed - ramp.speed(end)).abs() < 1e-6, "{ramp:?} at {end}");
            steepest = steepest.max(slope);
            let bend = before.map_or(0.0, |before: f64| (slope - before).abs() * f64::from(slots));
            sharpest = sharpest.max(bend);
            before = Some(slope);
        }
        assert!((steepest - ramp.max_slope()).abs() <= 1e-3 * steepest, "{ramp:?}: {steepest}");
        let bend = ramp.max_curvature();
        assert!((sharpest - bend).abs() <= 2e-3 * bend.max(1e-6), "{ramp:?}: {sharpest} {bend}");
    }
}

#[test]
fn values_agree_with_a_calculator() {
    for (ramp, x, speed, travel, slope) in ROWS {
        let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 4e-15;
        assert!(near(ramp().speed(*x), *speed), "{:?} at {x}: {}", ramp(), ramp().speed(*x));
        assert!(near(ramp().travel(*x), *travel), "{:?} at {x}: {}", ramp(), ramp().travel(*x));
        assert!(near(ramp().slope(*x), *slope), "{:?} at {x}: {}", ramp(), ramp().slope(*x));
    }
    assert!((Ramp::exponential(4.0).area() - 0.768_657_360_363_773).abs() < 1e-14);
}

#[test]
fn at_travel_is_the_inverse_of_travel() {
    for ramp in ramps() {
        let area = ramp.area();
        let powers = (-40..0).map(|power| area * libm::exp2(f64::from(power)));
        let parts = (0..=1000).map(|part| area * f64::from(part) / 1000.0);
        for travel in powers.chain(parts) {
            let x = ramp.at_travel(travel);
            assert!((0.0..=1.0).contains(&x), "{ramp:?}: {x}");
            let error = (ramp.travel(x) - travel) / travel.max(1e-300);
            assert!(error.abs() < 2e-14, "{ramp:?} at {travel}: {x} is off by {error}");
        }
    }
}

#[test]
fn longest_ramp_follows_from_the_rate() {
    let longest = longest_ramp_s(3200, 0.4, 19_200.0, 0.5).unwrap();
    assert!((longest - 0.4 + 1.0 / 6.0).abs() < 1e-15, "{longest}");
    assert_eq!(longest_ramp_s(3200, 0.4, 8000.0, 0.5), Some(0.0));
    assert_eq!(longest_ramp_s(3200, 0.4, 7999.0, 0.5), None);
    // Ramps with a larger area can be longer.
    let area = Ramp::exponential(4.0).area();
    let ramp_s = longest_ramp_s(3200, 0.4, 10_000.0, area).unwrap();
    assert!((3200.0 / (0.4 - 2.0 * ramp_s * (1.0 - area)) - 10_000.0).abs() < 1e-8, "{ramp_s}");
}
