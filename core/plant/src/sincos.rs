//! Sine and cosine of quarter turns, and parts of an exponential: polynomials of + - * / only, so every target has the
//! same bits (PLANT F3).

/// 3*2^51: adding it to a number rounds the number to an integer, ties to even.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Coefficients of sine and cosine, highest power first.
const TERMS: [[f64; 2]; 7] = [
    [5.692_172_921_967_927e-8, -6.386_603_083_791_852e-9],
    [-3.598_843_235_212_085e-6, 4.710_874_778_818_172e-7],
    [0.000_160_441_184_787_359_83, -2.520_204_237_306_060_7e-5],
    [-0.004_681_754_135_318_688, 0.000_919_260_274_839_426_6],
    [0.079_692_626_246_167_05, -0.020_863_480_763_352_96],
    [-0.645_964_097_506_246_3, 0.253_669_507_901_048_03],
    [core::f64::consts::FRAC_PI_2, -1.233_700_550_136_169_7],
];

/// From 2^51 on, the last bits of the sum with [`ROUND`] differ from the integer's.
const FAR: f64 = 2_251_799_813_685_248.0;

/// The nearest integer, ties to even, for |q| below 2^51.
pub(crate) fn nearest(q: f64) -> f64 {
    (q + ROUND) - ROUND
}

/// Sine and cosine of `q` quarter turns.
///
/// ```
/// assert_eq!(stepscope_plant::sincos(1.0), (1.0, 0.0));
/// assert!((stepscope_plant::sincos(0.5).0 - 0.5_f64.sqrt()).abs() < 1e-11);
/// ```
pub fn sincos(q: f64) -> (f64, f64) {
    let t = q + ROUND;
    let n = t - ROUND;
    let r = q - n;
    let z = r * r;
    let [highest, rest @ ..] = &TERMS;
    let [s, c] = rest.iter().fold(*highest, |[s, c], [of_s, of_c]| [of_s + z * s, of_c + z * c]);
    let (s, c) = (r * s, 1.0 + z * c);
    // 3*2^51 has zeros in the last bits, so those of the sum are the integer's.
    let quarter = if n > -FAR && n < FAR { t.to_bits() & 3 } else { far_quarter(n) };
    let (sine, cosine) = if quarter & 1 == 0 { (s, c) } else { (c, s) };
    let sign_bit = |is_negative| (is_negative as u64) << 63;
    (
        f64::from_bits(sine.to_bits() ^ sign_bit(quarter & 2 != 0)),
        f64::from_bits(cosine.to_bits() ^ sign_bit((quarter + 1) & 2 != 0)),
    )
}

#[cold]
fn far_quarter(n: f64) -> u64 {
    // The remainder of floats is exact.
    (n % 4.0) as i64 as u64 & 3
}

/// (phi1, phi2) = ((1 - e^-z)/z, (e^-z - 1 + z)/z^2), exact to the last digits for 0 <= z <= 0.25.
pub(crate) fn phi(z: f64) -> (f64, f64) {
    let mut p = 1.0;
    for n in (3..=13).rev() {
        p = 1.0 - z / f64::from(n) * p;
    }
    let phi2 = 0.5 * p;
    (1.0 - z * phi2, phi2)
}

/// 1 - e^-z for z >= 0, by halving z to at most 0.25 and squaring back.
pub(crate) fn one_minus_exp(z: f64) -> f64 {
    let (mut z, mut halvings) = (z, 0);
    while z > 0.25 && halvings < 2000 {
        z *= 0.5;
        halvings += 1;
    }
    let mut e = 1.0 - z * phi(z).0;
    for _ in 0..halvings {
        e *= e;
    }
    1.0 - e
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_of_quarter_turns_are_right_to_eleven_digits() {
        for i in -4000..4000 {
            let q = f64::from(i) * 0.0137;
            let (s, c) = sincos(q);
            let turned = q * core::f64::consts::FRAC_PI_2;
            #[expect(clippy::disallowed_methods, reason = "an independent result, in a test")]
            let expected = turned.sin_cos();
            assert!((s - expected.0).abs() < 2e-11 && (c - expected.1).abs() < 2e-11, "{q}: {s} {c}");
        }
    }

    #[test]
    fn whole_quarters_are_exact_and_signs_follow_the_quarter() {
        let rows = [(0.0, 0.0, 1.0), (1.0, 1.0, 0.0), (2.0, 0.0, -1.0), (3.0, -1.0, 0.0), (-1.0, -1.0, 0.0)];
        for (q, s, c) in rows {
            assert_eq!(sincos(q), (s, c), "{q}");
        }
        assert!(sincos(2.25).0 < 0.0 && sincos(2.25).1 < 0.0);
        assert!(sincos(1.75).0 > 0.0 && sincos(1.75).1 < 0.0);
    }

    #[test]
    fn halves_go_to_the_even_number() {
        for (q, expected) in [(0.5, 0.0), (1.5, 2.0), (-0.5, 0.0), (2.4, 2.0), (-2.6, -3.0)] {
            assert_eq!(nearest(q), expected, "{q}");
        }
    }

    #[test]
    fn one_minus_exp_equals_that_of_the_platform() {
        for i in 0..400 {
            let z = f64::from(i) * 0.03;
            #[expect(clippy::disallowed_methods, reason = "an independent result, in a test")]
            let expected = -(-z).exp_m1();
            assert!((one_minus_exp(z) - expected).abs() < 1e-14, "{z}");
        }
        assert_eq!((phi(0.0), one_minus_exp(0.0)), ((1.0, 0.5), 0.0));
    }
}
