//! Fixed-point numbers with a fraction of 320 bits, to which the planners' cycles are compared. They share no code with the
//! planners. A number means its shortest decimal.

use num_bigint::{BigInt, BigUint};
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::LazyLock;

const BITS: u64 = 320;
/// Bits of the fraction that are compared; formulas here lose fewer than the others.
const EQUAL_BITS: u64 = 200;

#[derive(Clone, Debug, PartialEq, PartialOrd)]
pub(crate) struct Fixed(BigInt);

pub(crate) static PI: LazyLock<Fixed> = LazyLock::new(|| {
    // Machin: pi/4 = 4*arctan(1/5) - arctan(1/239).
    let arctan = |under: i64| {
        let (mut term, mut sum, mut k) = (whole(1) / whole(under), whole(0), 0);
        while term != whole(0) {
            let part = term.clone() / whole(2 * k + 1);
            sum = if k % 2 == 0 { sum + part } else { sum - part };
            term = term / whole(under * under);
            k += 1;
        }
        sum
    };
    (arctan(5) * whole(4) - arctan(239)) * whole(4)
});

pub(crate) fn whole(number: i64) -> Fixed {
    Fixed(BigInt::from(number) << BITS)
}

/// The shortest decimal of a number.
pub(crate) fn decimal(number: f64) -> Fixed {
    let text = format!("{number:e}");
    let (digits, exponent) = text.split_once('e').expect("it is printed with an exponent");
    let (units, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let exponent: i64 = exponent.parse::<i64>().expect("it is whole") - fraction.len() as i64;
    let digits: BigInt = format!("{units}{fraction}").parse().expect("they are digits");
    let ten = BigInt::from(10).pow(exponent.unsigned_abs() as u32);
    Fixed(if exponent < 0 { (digits << BITS) / ten } else { (digits * ten) << BITS })
}

impl Fixed {
    /// Compares only the exact bits.
    pub(crate) fn order(&self, other: &Self) -> Ordering {
        let off = &self.0 - &other.0;
        if off.bits() < BITS - EQUAL_BITS { Ordering::Equal } else { off.cmp(&BigInt::ZERO) }
    }

    pub(crate) fn is_positive(&self) -> bool {
        self.0 > BigInt::ZERO
    }

    /// Whether it is in the middle between two integers.
    pub(crate) fn is_half(&self) -> bool {
        (self.clone() * whole(2)).order(&whole(2 * self.rounded() - 1)) == Ordering::Equal
    }

    /// floor(x + 1/2).
    pub(crate) fn rounded(&self) -> i64 {
        let half = BigInt::from(1) << (BITS - 1);
        i64::try_from((&self.0 + half) >> BITS).expect("it is a count of steps")
    }

    pub(crate) fn square_root(&self) -> Self {
        Self((&self.0 << BITS).sqrt())
    }

    pub(crate) fn cube_root(&self) -> Self {
        Self((&self.0 << (2 * BITS)).cbrt())
    }

    pub(crate) fn to_f64(&self) -> f64 {
        let (sign, parts) = (self.0 < BigInt::ZERO, self.0.magnitude());
        let shift = parts.bits().saturating_sub(60);
        let upper: BigUint = parts >> shift;
        let upper = u64::try_from(&upper).expect("it has 60 bits") as f64;
        libm::scalbn(if sign { -upper } else { upper }, (shift as i64 - BITS as i64) as i32)
    }

    /// Sum of sign(k)*x^k/k! over all k.
    fn series(&self, sign: impl Fn(u32) -> i32) -> Self {
        let (mut term, mut sum, mut k) = (whole(1), whole(0), 0);
        while term.0 != BigInt::ZERO && term.0 != BigInt::from(-1) {
            sum = match sign(k) {
                1 => sum + term.clone(),
                -1 => sum - term.clone(),
                _ => sum,
            };
            k += 1;
            term = Self((term.0 * &self.0 / k) >> BITS);
        }
        sum
    }

    pub(crate) fn sine(&self) -> Self {
        self.series(|k| [0, 1, 0, -1][k as usize % 4])
    }

    pub(crate) fn cosine(&self) -> Self {
        self.series(|k| [1, 0, -1, 0][k as usize % 4])
    }

    pub(crate) fn exponential(&self) -> Self {
        // (e^(x/64))^64 needs fewer terms.
        let mut power = (self.clone() / whole(64)).series(|_| 1);
        for _ in 0..6 {
            power = power.clone() * power;
        }
        power
    }

    /// By Newton's method from the root of `libm`.
    pub(crate) fn logarithm(&self) -> Self {
        let mut x = decimal(libm::log(self.to_f64()));
        for _ in 0..4 {
            // Each step triples the digits.
            let power = x.exponential();
            x = x + whole(2) * (self.clone() - power.clone()) / (self.clone() + power);
        }
        x
    }
}

macro_rules! operations {
    ($($trait:ident $name:ident |$a:ident, $b:ident| $result:expr;)*) => {$(
        impl $trait for Fixed {
            type Output = Self;

            fn $name(self, other: Self) -> Self {
                let ($a, $b) = (self.0, other.0);
                Self($result)
            }
        }
    )*};
}

operations! {
    Add add |a, b| a + b;
    Sub sub |a, b| a - b;
    Mul mul |a, b| (a * b) >> BITS;
    Div div |a, b| (a << BITS) / b;
}

impl Neg for Fixed {
    type Output = Self;

    fn neg(self) -> Self {
        Self(-self.0)
    }
}

#[test]
fn functions_are_exact_to_320_bits() {
    let digits = |x: &Fixed| {
        let ten = BigInt::from(10).pow(60);
        ((&x.0 * ten) >> BITS).to_string()
    };
    assert_eq!(digits(&PI), "3141592653589793238462643383279502884197169399375105820974944");
    assert_eq!(
        digits(&whole(1).exponential()),
        "2718281828459045235360287471352662497757247093699959574966967"
    );
    assert_eq!(
        digits(&whole(2).square_root()),
        "1414213562373095048801688724209698078569671875376948073176679"
    );
    assert_eq!(digits(&whole(8).cube_root()), digits(&whole(2)));
    assert_eq!(
        digits(&whole(10).logarithm()),
        "2302585092994045684017991454684364207601101488628772976033327"
    );
    let sixth = PI.clone() / whole(6);
    assert_eq!(sixth.sine().order(&decimal(0.5)), Ordering::Equal);
    assert_eq!((sixth * whole(2)).cosine().order(&decimal(0.5)), Ordering::Equal);
    assert_eq!(decimal(-0.1).order(&(whole(-1) / whole(10))), Ordering::Equal);
    assert_eq!((decimal(1e22).to_f64(), decimal(1.5e-7).to_f64()), (1e22, 1.5e-7));
}
