//! Steps per unit of length by least squares over measured pairs (DESIGN B3, Zhang 2012).
//!
//! ```text
//! steps = k*length            k = sum(l*s)/sum(l*l)                 through the origin
//! steps = k*length + offset   k = sum((l-l')*(s-s'))/sum((l-l')^2)  l', s': means
//! ```
//!
//! An offset indicates backlash or a wrong zero.

use alloc::vec::Vec;
use core::fmt;

/// Maximum magnitude, and 1/minimum: sums of squares stay finite and above 0.
const MAX_MAGNITUDE: f64 = 1e12;
const MIN_MAGNITUDE: f64 = 1e-12;

/// A measured length in any unit, and its steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    pub length: f64,
    pub steps: f64,
}

/// A straight line through pairs of length and steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Steps per unit; above 0.
    pub steps_per_unit: f64,
    pub offset_steps: f64,
    /// Steps of each pair minus the line's value.
    pub residuals: Vec<f64>,
}

impl Fit {
    fn new(pairs: &[Pair], steps_per_unit: f64, offset_steps: f64) -> Self {
        let residual = |pair: &Pair| pair.steps - (steps_per_unit * pair.length + offset_steps);
        Self { steps_per_unit, offset_steps, residuals: pairs.iter().map(residual).collect() }
    }

    /// RMS residual in steps.
    pub fn rms(&self) -> f64 {
        let sum: f64 = self.residuals.iter().map(|residual| residual * residual).sum();
        libm::sqrt(sum / self.residuals.len().max(1) as f64)
    }

    /// Index and steps of the largest residual, the first of equals.
    pub fn largest(&self) -> Option<(usize, f64)> {
        let mut found: Option<(usize, f64)> = None;
        for (index, residual) in self.residuals.iter().enumerate() {
            if found.is_none_or(|(_, largest)| libm::fabs(*residual) > libm::fabs(largest)) {
                found = Some((index, *residual));
            }
        }
        found
    }
}

/// The least-squares lines with and without an offset.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    pub through_origin: Fit,
    pub with_offset: Fit,
}

/// Why pairs have no line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BadPairs {
    TooFew {
        given: usize,
    },
    /// Not a number, or out of range in magnitude.
    Number {
        index: usize,
        pair: Pair,
    },
    OneLength {
        length: f64,
    },
    /// Longer lengths do not have more steps.
    NotRising {
        steps_per_unit: f64,
    },
}

impl fmt::Display for BadPairs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { given } => write!(
                f,
                "{given} pair{} of length and steps; use at least 2, with different lengths",
                if *given == 1 { "" } else { "s" }
            ),
            Self::Number { index, pair } => write!(
                f,
                "pair {} has length {:?} and {:?} steps; use numbers from 1e-12 to 1e12, or from -1e12 to -1e-12, or 0",
                index + 1,
                pair.length,
                pair.steps
            ),
            Self::OneLength { length } => {
                write!(f, "all pairs have length {length}; add a pair with another length")
            }
            Self::NotRising { steps_per_unit } => write!(
                f,
                "{steps_per_unit:?} steps per unit: steps must increase with length; use the same sign for both, and check the order of the columns"
            ),
        }
    }
}

impl core::error::Error for BadPairs {}

impl Calibration {
    /// Fits both lines. Sums go in the given order, so equal input gives equal bits on every machine.
    pub fn of(pairs: &[Pair]) -> Result<Self, BadPairs> {
        if pairs.len() < 2 {
            return Err(BadPairs::TooFew { given: pairs.len() });
        }
        let is_valid =
            |value: f64| value == 0.0 || (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&libm::fabs(value));
        if let Some((index, pair)) =
            pairs.iter().enumerate().find(|(_, pair)| !is_valid(pair.length) || !is_valid(pair.steps))
        {
            return Err(BadPairs::Number { index, pair: *pair });
        }
        let length = pairs.first().map_or(0.0, |pair| pair.length);
        if pairs.iter().all(|pair| pair.length == length) {
            return Err(BadPairs::OneLength { length });
        }
        let slope = |length_0: f64, steps_0: f64| {
            let (mut product, mut square) = (0.0, 0.0);
            for pair in pairs {
                let length = pair.length - length_0;
                product += length * (pair.steps - steps_0);
                square += length * length;
            }
            let steps_per_unit = product / square;
            let rises = steps_per_unit.is_finite() && steps_per_unit > 0.0;
            if rises { Ok(steps_per_unit) } else { Err(BadPairs::NotRising { steps_per_unit }) }
        };
        let mean = |of: fn(&Pair) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
        let (length_mean, steps_mean) = (mean(|pair| pair.length), mean(|pair| pair.steps));
        let (through, free) = (slope(0.0, 0.0)?, slope(length_mean, steps_mean)?);
        Ok(Self {
            through_origin: Fit::new(pairs, through, 0.0),
            with_offset: Fit::new(pairs, free, steps_mean - free * length_mean),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    fn pairs(rows: &[(f64, f64)]) -> Vec<Pair> {
        rows.iter().map(|&(length, steps)| Pair { length, steps }).collect()
    }

    #[test]
    fn exact_pairs_are_fitted_exactly() {
        // Zhang's 565 pulses a cm, and the same from a zero 2 cm off.
        let found = Calibration::of(&pairs(&[(10.0, 5650.0), (30.5, 17_232.5), (45.0, 25_425.0)])).unwrap();
        assert!((found.through_origin.steps_per_unit - 565.0).abs() < 1e-10, "{found:?}");
        assert!(found.through_origin.rms() < 1e-9 && found.with_offset.offset_steps.abs() < 1e-9);
        let found = Calibration::of(&pairs(&[(12.0, 5650.0), (32.0, 16_950.0), (47.0, 25_425.0)])).unwrap();
        assert!((found.with_offset.steps_per_unit - 565.0).abs() < 1e-10, "{found:?}");
        assert!((found.with_offset.offset_steps + 1130.0).abs() < 1e-8);
        assert!(found.with_offset.rms() < 1e-9 && found.through_origin.rms() > 100.0);
    }

    /// By hand: sum(l*s) = 1*3 + 2*5 + 4*8 = 45, sum(l*l) = 21; means 7/3 and 16/3; 23/14 and 3/2.
    #[test]
    fn both_lines_equal_a_calculation_by_hand() {
        let given = pairs(&[(1.0, 3.0), (2.0, 5.0), (4.0, 8.0)]);
        let Calibration { through_origin, with_offset } = Calibration::of(&given).unwrap();
        assert!((through_origin.steps_per_unit - 45.0 / 21.0).abs() < 1e-15);
        assert_eq!(through_origin.offset_steps, 0.0);
        assert!((with_offset.steps_per_unit - 23.0 / 14.0).abs() < 1e-14, "{with_offset:?}");
        assert!((with_offset.offset_steps - 1.5).abs() < 1e-14);
        let (index, largest) = through_origin.largest().unwrap();
        assert_eq!(index, 0);
        assert!((largest - 6.0 / 7.0).abs() < 1e-14, "{largest}");
        let squares = [6.0_f64 / 7.0, 5.0 / 7.0, -4.0 / 7.0].map(|residual| residual * residual);
        assert!((through_origin.rms() - (squares.iter().sum::<f64>() / 3.0).sqrt()).abs() < 1e-14);
    }

    /// A least-squares line has a smaller sum of squares than its neighbors.
    #[test]
    fn neighboring_lines_have_larger_residuals() {
        let given: Vec<Pair> = (1..40)
            .map(|i| Pair {
                length: f64::from(i * i % 37),
                steps: f64::from(i * i % 37) * 56.5 + f64::from(i * 7 % 11),
            })
            .collect();
        let found = Calibration::of(&given).unwrap();
        for (k, offset) in [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-2), (0.0, -1e-2)] {
            let fit = &found.with_offset;
            let moved = Fit::new(&given, fit.steps_per_unit + k, fit.offset_steps + offset);
            assert!(moved.rms() > fit.rms());
            if k != 0.0 {
                let fit = &found.through_origin;
                assert!(Fit::new(&given, fit.steps_per_unit + k, 0.0).rms() > fit.rms());
            }
        }
    }

    #[test]
    fn minimum_and_maximum_magnitudes_are_fitted() {
        for (length, steps) in [(1e-12, 1e12), (1e12, 1e-12)] {
            let found = Calibration::of(&pairs(&[(0.0, 0.0), (length, steps)])).unwrap();
            for fit in [&found.through_origin, &found.with_offset] {
                assert!((fit.steps_per_unit / (steps / length) - 1.0).abs() < 1e-12, "{found:?}");
            }
        }
    }

    #[test]
    fn pairs_without_a_line_are_rejected_with_their_values() {
        let rows: [(&[(f64, f64)], &str); 8] = [
            (&[], "0 pairs of length and steps; use at least 2, with different lengths"),
            (&[(1.0, 2.0)], "1 pair of length and steps; use at least 2, with different lengths"),
            (
                &[(1.0, 2.0), (f64::NAN, 2.0)],
                "pair 2 has length NaN and 2.0 steps; use numbers from 1e-12 to 1e12, or from -1e12 to -1e-12, or 0",
            ),
            // Their squares are 0.
            (
                &[(1e-200, 1.0), (2e-200, 2.0)],
                "pair 1 has length 1e-200 and 1.0 steps; use numbers from 1e-12 to 1e12, or from -1e12 to -1e-12, or 0",
            ),
            (
                &[(1.0, f64::INFINITY), (2.0, 2.0)],
                "pair 1 has length 1.0 and inf steps; use numbers from 1e-12 to 1e12, or from -1e12 to -1e-12, or 0",
            ),
            (&[(3.0, 2.0), (3.0, 4.0)], "all pairs have length 3; add a pair with another length"),
            (
                &[(1.0, -2.0), (2.0, -4.0)],
                "-2.0 steps per unit: steps must increase with length; use the same sign for both, and check the order of the columns",
            ),
            (
                &[(1.0, 5.0), (2.0, 5.0)],
                "0.0 steps per unit: steps must increase with length; use the same sign for both, and check the order of the columns",
            ),
        ];
        for (given, expected) in rows {
            let found = Calibration::of(&pairs(given)).err().map(|error| error.to_string());
            assert_eq!(found.as_deref(), Some(expected), "{given:?}");
        }
    }

    #[test]
    fn steps_per_mm_of_measured_lengths() {
        use crate::motion::calibration::{BadPairs, Calibration, Pair};

        let measured =
            [(10.0, 801.0), (20.0, 1601.0), (40.0, 3201.0)].map(|(length, steps)| Pair { length, steps });
        let fit = Calibration::of(&measured).expect("they have a line").with_offset;
        assert_eq!((fit.steps_per_unit.round(), fit.offset_steps.round()), (80.0, 1.0)); // one step of backlash
        assert_eq!(Calibration::of(&measured[..1]), Err(BadPairs::TooFew { given: 1 }));
    }
}
