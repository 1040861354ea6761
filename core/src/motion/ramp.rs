//! The shapes of a ramp: how the speed goes from nothing to its top (DESIGN B4; Song, Han, Lu 2021, table 1).
//!
//! Over the ramp's own time x = t/t_s, from 0 to 1, a shape g goes from exactly 0 to exactly 1, and the
//! speed is f_max*g(x). Of each shape everything has a closed form:
//!
//! ```text
//!  1 |        .--         g(x)   part of the top speed
//!    |      /             G(x)   its integral from 0, so the way is f_max*t_s*G(x)
//!    |    /               A      G(1), the ramp's area: f_max = n/(T - 2*t_s*(1 - A))
//!  0 | _-'
//!    +-----------         straight      g = x                                  A = 1/2
//!      0        1         bezier        g = 3x^2 - 2x^3                         A = 1/2
//!                         sigmoid       g = (S(u) - S(-r))/(S(r) - S(-r))       A = 1/2
//!                                       S(u) = 1/(1 + e^-u), u = r*(2x - 1)
//!                         exponential   g = (1 - e^-kx)/(1 - e^-k)              A = 1/(1 - e^-k) - 1/k
//! ```
//!
//! A sigmoid has no end: the document finds that one that is cut off at +-r stops short of its speed and
//! starts with a jump. Here it is shifted and stretched, so that both ends are met exactly; what is left of
//! the cut is the acceleration, which jumps at both.
//!
//! Near the start all terms of these formulas but one cancel; each is written so that none does, and a time
//! in the ramp has its digits there too.

use super::square_root;

/// Newton's steps after which a place is taken as it is; from the guesses here seven do.
const MOST_STEPS: u32 = 100;

/// The longest ramp in s with which `steps` in `duration_s` keep their top speed at or under `speed` steps/s,
/// for ramps of the area `area` (1/2 for every symmetric shape), of which a move can use up to half of its
/// duration; `None` where the move is too fast with no ramp at all.
///
/// The document's t_s <= t_i - n/f_s (B4), and for any other area t_s <= (t_i - n/f_s)/(2*(1 - area)).
#[must_use]
pub fn longest_ramp_s(steps: u64, duration_s: f64, speed: f64, area: f64) -> Option<f64> {
    let ramp_s = (duration_s - steps as f64 / speed) / (2.0 * (1.0 - area));
    (ramp_s >= 0.0).then_some(ramp_s)
}

/// A ramp's shape, over x of 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ramp {
    /// A logistic function's middle.
    Sigmoid(Sigmoid),
    /// A cubic Bezier curve with the control values 0, 0, 1, 1 at even times.
    Bezier,
    /// A straight line, so a trapezoid.
    Straight,
    /// The approach of an exponential, steep at first: as a motor's torque falls with its rate.
    Exponential(Exponential),
}

/// 1/(1 + e^-u) between -range and +range, stretched to begin at 0 and to end at 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigmoid {
    range: f64,
    /// tanh(range/2): how much of its whole height the range has.
    part: f64,
    /// sinh(range/2).
    sinh: f64,
    /// 1/(1 + e^range), where the range begins.
    low: f64,
}

/// 1 - e^-u from 0 to so many time constants, stretched to end at 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exponential {
    constants: f64,
    /// 1 - e^-constants: how far it comes by itself.
    part: f64,
}

impl Ramp {
    /// A sigmoid from -`range` to +`range`, which is above 0.
    #[must_use]
    pub fn sigmoid(range: f64) -> Self {
        let half = range / 2.0;
        let low = 1.0 / (1.0 + libm::exp(range));
        Self::Sigmoid(Sigmoid { range, part: libm::tanh(half), sinh: libm::sinh(half), low })
    }

    /// An exponential of so many time constants, above 0.
    #[must_use]
    pub fn exponential(constants: f64) -> Self {
        Self::Exponential(Exponential { constants, part: -libm::expm1(-constants) })
    }

    /// A = G(1), at least 1/2: the part of the ramp's time at top speed that has the ramp's way.
    #[must_use]
    pub fn area(&self) -> f64 {
        match self {
            Self::Exponential(curve) => curve.way(1.0),
            _ => 0.5,
        }
    }

    /// g(x), the part of the top speed.
    #[must_use]
    pub fn speed(&self, x: f64) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.speed(x),
            Self::Bezier => x * x * (3.0 - 2.0 * x),
            Self::Straight => x,
            Self::Exponential(curve) => -libm::expm1(-curve.constants * x) / curve.part,
        }
    }

    /// G(x), the way in parts of that which the whole ramp's time has at top speed.
    #[must_use]
    pub fn way(&self, x: f64) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.way(x),
            Self::Bezier => x * x * x * (1.0 - x / 2.0),
            Self::Straight => x * x / 2.0,
            Self::Exponential(curve) => curve.way(x),
        }
    }

    /// g'(x); times f_max/t_s it is the acceleration.
    #[must_use]
    pub fn slope(&self, x: f64) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.slope(x),
            Self::Bezier => 6.0 * x * (1.0 - x),
            Self::Straight => 1.0,
            Self::Exponential(Exponential { constants, part }) => {
                constants * libm::exp(-constants * x) / part
            }
        }
    }

    /// The greatest g'.
    #[must_use]
    pub fn greatest_slope(&self) -> f64 {
        match self {
            Self::Sigmoid(_) | Self::Bezier => self.slope(0.5),
            Self::Straight | Self::Exponential(_) => self.slope(0.0),
        }
    }

    /// The greatest |g''|; times f_max/t_s^2 it is the jerk.
    #[must_use]
    pub fn greatest_bend(&self) -> f64 {
        match self {
            Self::Sigmoid(curve) => curve.greatest_bend(),
            Self::Bezier => 6.0,
            Self::Straight => 0.0,
            Self::Exponential(Exponential { constants, part }) => constants * constants / part,
        }
    }

    /// How sharply it bends against a cosine: more of it has to be cut into more pieces.
    pub(super) fn sharpness(&self) -> f64 {
        match self {
            Self::Sigmoid(Sigmoid { range, .. }) => *range,
            Self::Exponential(Exponential { constants, .. }) => *constants,
            Self::Bezier | Self::Straight => 0.0,
        }
    }

    /// The x of 0..=1 with G(x) = `way`, 0..=[`Ramp::area`], to the last digits.
    #[must_use]
    pub fn at_way(&self, way: f64) -> f64 {
        let guess = match self {
            _ if way <= 0.0 => return 0.0,
            Self::Straight => return least(square_root(2.0 * way), 1.0),
            Self::Bezier => {
                // From x^3 = way/(1 - x/2), once put into itself.
                let root = libm::cbrt(way);
                libm::cbrt(way / (1.0 - root / 2.0))
            }
            Self::Sigmoid(curve) => curve.guess(way),
            Self::Exponential(curve) => curve.guess(way),
        };
        self.newton(way, least(guess, 1.0))
    }

    /// From a guess to the x with G(x) = `way`. G rises and bends upwards, so from above Newton's steps
    /// fall towards it; a step that leaves what is known of it is halved into it.
    fn newton(&self, way: f64, guess: f64) -> f64 {
        let (mut low, mut high, mut x) = (0.0, 1.0, guess);
        for _ in 0..MOST_STEPS {
            let over = self.way(x) - way;
            if over < 0.0 {
                low = x
            } else {
                high = x
            }
            let next = x - over / self.speed(x);
            if libm::fabs(next - x) <= 4.0 * f64::EPSILON * x {
                return least(next, 1.0);
            }
            x = if next > low && next < high { next } else { low + (high - low) / 2.0 };
        }
        x
    }
}

impl Sigmoid {
    fn speed(&self, x: f64) -> f64 {
        // tanh a + tanh b = sinh(a + b)/(cosh a*cosh b), and a + b is 0 at the start.
        let middle = libm::cosh(self.range * (x - 0.5));
        libm::sinh(self.range * x) / (2.0 * middle * self.sinh)
    }

    fn slope(&self, x: f64) -> f64 {
        let middle = libm::cosh(self.range * (x - 0.5));
        self.range / (2.0 * self.part * middle * middle)
    }

    /// G = (ln(1 + p*(e^z - 1)) - p*z)/(2*r*tanh(r/2)) with z = 2*r*x and p = S(-r).
    fn way(&self, x: f64) -> f64 {
        let (p, z) = (self.low, 2.0 * self.range * x);
        let climbed = p * libm::expm1(z);
        let area = if z <= 1.0 {
            // Both logarithm and exponential without their first terms, which cancel.
            logarithm_rest(climbed) + p * exponential_rest(z)
        } else {
            libm::log1p(climbed) - p * z
        };
        area / (2.0 * self.range * self.part)
    }

    /// Of G's formula e^z - 1 - z is as good as a square while z is small, and as e^z later.
    fn guess(&self, way: f64) -> f64 {
        let area = 2.0 * self.range * self.part * way;
        let rest = libm::expm1(area) / (self.low * (1.0 - self.low));
        libm::log1p(rest + square_root(2.0 * rest)) / (2.0 * self.range)
    }

    fn greatest_bend(&self) -> f64 {
        // |g''| = r^2*tanh(v)*(1 - tanh(v)^2)/tanh(r/2) with v up to r/2, greatest where tanh(v)^2 = 1/3.
        let steepest = square_root(1.0 / 3.0);
        let tanh = least(self.part, steepest);
        self.range * self.range * tanh * (1.0 - tanh * tanh) / self.part
    }
}

impl Exponential {
    /// G = (e^-z - 1 + z)/(k*(1 - e^-k)) with z = k*x.
    fn way(&self, x: f64) -> f64 {
        exponential_rest(-self.constants * x) / (self.constants * self.part)
    }

    /// The first terms of the series of z over the square root of twice the way.
    fn guess(&self, way: f64) -> f64 {
        let rest = way * self.constants * self.part;
        (square_root(2.0 * rest) + rest / 3.0) / self.constants
    }
}

fn least(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// e^z - 1 - z, with all digits also where both nearly cancel.
fn exponential_rest(z: f64) -> f64 {
    if libm::fabs(z) > 0.5 {
        return libm::expm1(z) - z;
    }
    // z^2/2! + z^3/3! + …, thirteen terms; the next is under 2^-53 of the sum.
    let mut sum = 1.0;
    for k in (3..15).rev() {
        sum = 1.0 + sum * z / f64::from(k);
    }
    sum * z * z / 2.0
}

/// ln(1 + x) - x for x of 0..=1, with all digits also where both nearly cancel.
fn logarithm_rest(x: f64) -> f64 {
    // With s = x/(2 + x), up to 1/3, ln(1 + x) = 2*(s + s^3/3 + s^5/5 + …), and 2*s - x = -x*s.
    let s = x / (2.0 + x);
    let square = s * s;
    let mut sum = 0.0;
    for k in (1..17).rev() {
        sum = square * (sum + 1.0 / f64::from(2 * k + 1));
    }
    s * (2.0 * sum - x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// Ramp, x, g, G, g', from 60 digits.
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
    fn each_goes_from_exactly_nothing_to_all_and_is_its_slopes_integral() {
        for ramp in ramps() {
            assert_eq!((ramp.speed(0.0), ramp.way(0.0)), (0.0, 0.0), "{ramp:?}");
            assert!((ramp.speed(1.0) - 1.0).abs() < 1e-15, "{ramp:?}");
            assert!((ramp.way(1.0) - ramp.area()).abs() < 1e-15, "{ramp:?}: {}", ramp.way(1.0));
            let (slots, mut way, mut speed) = (20_000, 0.0, 0.0);
            let (mut steepest, mut sharpest, mut before) = (0.0_f64, 0.0_f64, None);
            for slot in 0..slots {
                let x = (f64::from(slot) + 0.5) / f64::from(slots);
                let slope = ramp.slope(x);
                way += ramp.speed(x) / f64::from(slots);
                speed += slope / f64::from(slots);
                let end = f64::from(slot + 1) / f64::from(slots);
                assert!((way - ramp.way(end)).abs() < 1e-7, "{ramp:?} at {end}");
                assert!((speed - ramp.speed(end)).abs() < 1e-6, "{ramp:?} at {end}");
                steepest = steepest.max(slope);
                let bend = before.map_or(0.0, |before: f64| (slope - before).abs() * f64::from(slots));
                sharpest = sharpest.max(bend);
                before = Some(slope);
            }
            assert!((steepest - ramp.greatest_slope()).abs() <= 1e-3 * steepest, "{ramp:?}: {steepest}");
            let bend = ramp.greatest_bend();
            assert!((sharpest - bend).abs() <= 2e-3 * bend.max(1e-6), "{ramp:?}: {sharpest} {bend}");
        }
    }

    #[test]
    fn the_numbers_that_a_calculator_gives_come_out() {
        for (ramp, x, speed, way, slope) in ROWS {
            let near = |found: f64, expected: f64| (found / expected - 1.0).abs() < 4e-15;
            assert!(near(ramp().speed(*x), *speed), "{:?} at {x}: {}", ramp(), ramp().speed(*x));
            assert!(near(ramp().way(*x), *way), "{:?} at {x}: {}", ramp(), ramp().way(*x));
            assert!(near(ramp().slope(*x), *slope), "{:?} at {x}: {}", ramp(), ramp().slope(*x));
        }
        assert!((Ramp::exponential(4.0).area() - 0.768_657_360_363_773).abs() < 1e-14);
    }

    #[test]
    fn a_ways_place_is_found_to_the_last_digits() {
        for ramp in ramps() {
            let area = ramp.area();
            let powers = (-40..0).map(|power| area * libm::exp2(f64::from(power)));
            let parts = (0..=1000).map(|part| area * f64::from(part) / 1000.0);
            for way in powers.chain(parts) {
                let x = ramp.at_way(way);
                assert!((0.0..=1.0).contains(&x), "{ramp:?}: {x}");
                let error = (ramp.way(x) - way) / way.max(1e-300);
                assert!(error.abs() < 2e-14, "{ramp:?} at {way}: {x} is off by {error}");
            }
        }
    }

    #[test]
    fn a_rate_limits_the_ramp() {
        let longest = longest_ramp_s(3200, 0.4, 19_200.0, 0.5).unwrap();
        assert!((longest - 0.4 + 1.0 / 6.0).abs() < 1e-15, "{longest}");
        assert_eq!(longest_ramp_s(3200, 0.4, 8000.0, 0.5), Some(0.0));
        assert_eq!(longest_ramp_s(3200, 0.4, 7999.0, 0.5), None);
        // With more area in the ramp it may be longer; so that the area is that of the rate, not half of it.
        let area = Ramp::exponential(4.0).area();
        let ramp_s = longest_ramp_s(3200, 0.4, 10_000.0, area).unwrap();
        assert!((3200.0 / (0.4 - 2.0 * ramp_s * (1.0 - area)) - 10_000.0).abs() < 1e-8, "{ramp_s}");
    }
}
