//! A correctly rounded square root in integer arithmetic: the same bits as IEEE 754, without a mathematics library.

/// The square root of `x`, correctly rounded; NaN below 0. x = m*2^e with e even and 109 or 110 bits in m
/// has the root r*2^(e/2), where r is the integer root of m. r has 55 bits, two more than an f64; the remainder decides
/// whether the cut-off bits are exactly a half.
pub(crate) fn square_root(x: f64) -> f64 {
    if x.is_nan() || x < 0.0 {
        return f64::NAN;
    }
    if x == 0.0 || x == f64::INFINITY {
        return x;
    }
    let bits = x.to_bits();
    let (fraction, exponent) = (bits & ((1 << 52) - 1), (bits >> 52) as i32);
    let (significand, exponent) =
        if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) };
    // Normalizes numbers below the smallest normal one.
    let shift = significand.leading_zeros() as i32 - 11;
    let (significand, exponent) = (significand << shift, exponent - shift);
    let odd = exponent & 1;
    let m = u128::from(significand) << (56 + odd);
    let half_exponent = (exponent - odd - 56) / 2;
    let root = integer_root(m);
    let sticky = u64::from(u128::from(root) * u128::from(root) != m);
    // The root has 55 bits, with the sticky bit 56; the conversion rounds them to 53, ties to even.
    let rounded = ((root << 1) | sticky) as f64;
    rounded * power_of_two(half_exponent - 1)
}

/// The integer part of the root, bit by bit.
fn integer_root(m: u128) -> u64 {
    let (mut remainder, mut root, mut bit) = (m, 0_u128, 1_u128 << 126);
    while bit > m {
        bit >>= 2;
    }
    while bit != 0 {
        if remainder >= root + bit {
            remainder -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
        bit >>= 2;
    }
    root as u64
}

/// 2^n for a normal number, which every root is.
const fn power_of_two(n: i32) -> f64 {
    f64::from_bits(((1023 + n) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_equals_that_of_the_platform() {
        let grid = (0..200_000_u64).map(|i| f64::from_bits(i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 1));
        let near_one = (0..2000).map(|i| 1.0 + f64::from(i) * f64::EPSILON);
        let special = [
            0.0,
            -0.0,
            5e-324,
            1e-320,
            2.0,
            3.0,
            4.0,
            0.25,
            -1.0,
            f64::MAX,
            f64::MIN_POSITIVE,
            f64::INFINITY,
        ];
        for x in grid.chain(near_one).chain(special) {
            let (found, expected) = (square_root(x), x.sqrt());
            assert!(found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan()), "{x:e}");
        }
    }
}
