//! F3's sine and cosine, its exponential's series, and F6's random numbers: + - * / only, without a math library.

/// 1.5*2^52: adding and subtracting it rounds to the nearest whole number, ties to even.
const SHIFT: f64 = 6755399441055744.0;

#[expect(clippy::approx_constant, reason = "the contract's digits")]
const S: [f64; 7] = [
    1.5707963267948966,
    -0.6459640975062463,
    0.07969262624616705,
    -0.004681754135318688,
    0.00016044118478735983,
    -3.598843235212085e-06,
    5.692172921967927e-08,
];
const C: [f64; 7] = [
    -1.2337005501361697,
    0.25366950790104803,
    -0.02086348076335296,
    0.0009192602748394266,
    -2.5202042373060607e-05,
    4.710874778818172e-07,
    -6.386603083791852e-09,
];

/// `nearest(q)` (F3): t - 6755399441055744 with t = q + 6755399441055744.
pub fn nearest(q: f64) -> f64 {
    let t = q + SHIFT;
    t - SHIFT
}

/// Sine and cosine of `q` quarter turns (F3).
pub fn sincos(q: f64) -> (f64, f64) {
    let n = nearest(q);
    let r = q - n;
    let z = r * r;
    let mut inner = S[6];
    for k in (0..6).rev() {
        inner = S[k] + z * inner;
    }
    let s = r * inner;
    let mut inner = C[6];
    for k in (0..6).rev() {
        inner = C[k] + z * inner;
    }
    let c = 1.0 + z * inner;
    // The remainder of two f64 is exact, even for a large n.
    match (n % 4.0) as i64 {
        1 | -3 => (c, -s),
        2 | -2 => (-s, -c),
        3 | -1 => (-c, s),
        _ => (s, c),
    }
}

/// (phi1, phi2) of F3 at z = R*h/L.
pub(super) fn phi(z: f64) -> (f64, f64) {
    let mut p = 1.0;
    for n in (3..=13).rev() {
        p = 1.0 - z / f64::from(n) * p;
    }
    let phi2 = 0.5 * p;
    let phi1 = 1.0 - z * phi2;
    (phi1, phi2)
}

/// exp(-z), z >= 0, by F6: "z halved to <= 0.25, 1 - z*phi1, squared back".
pub(super) fn exp_of_minus(z: f64) -> f64 {
    let mut z = z;
    let mut halvings = 0;
    while z > 0.25 {
        z *= 0.5;
        halvings += 1;
    }
    let mut e = 1.0 - z * phi(z).0;
    for _ in 0..halvings {
        e *= e;
    }
    e
}

/// `x` moved towards 0 by `step`, at most to 0.
pub(super) fn towards_zero(x: f64, step: f64) -> f64 {
    if x.abs() <= step {
        0.0
    } else if x > 0.0 {
        x - step
    } else {
        x + step
    }
}

/// SplitMix64.
#[derive(Debug, Clone)]
pub struct SplitMix64(pub u64);

impl SplitMix64 {
    /// 2^64 over the golden ratio: the step of the state.
    pub const GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(Self::GAMMA);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// The next number in [0, 1), from the top 53 bits.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / 9007199254740992.0
    }
}
