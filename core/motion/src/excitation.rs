//! Phase sequences of a two-phase motor (DESIGN B2, Sonobe 2011): the currents of phases A and B after k steps.
//!
//! ```text
//!               k   0   1   2   3   4   5   6   7   8
//! one-phase     A  +1   0  -1   0  +1                      full steps, one phase on
//!               B   0  +1   0  -1   0
//! two-phase     A  +1  -1  -1  +1  +1                      full steps, both on: sqrt(2) times the torque,
//!               B  +1  +1  -1  -1  +1                      half a step from the one-phase positions
//! 1-2-phase     A  +1  +1   0  -1  -1  -1   0  +1  +1      half steps, one and both alternately
//!               B   0  +1  +1  +1   0  -1  -1  -1   0
//! microstep n   A   cos(90 deg*k/n)                        1/n of a full step, constant torque
//!               B   sin(90 deg*k/n)
//! ```
//!
//! Four full steps are one electrical period: the rotor has moved by one tooth, and the currents repeat.

use core::f64::consts::FRAC_PI_2;

/// A phase sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Excitation {
    OnePhase,
    TwoPhase,
    /// One and two phases alternately: half steps.
    OneTwoPhase,
    /// Sine and cosine in this number of microsteps per full step; 0 counts as 1.
    Microstep(u16),
}

impl Excitation {
    /// Steps of this excitation per full step of the motor.
    pub fn steps_per_full_step(self) -> u16 {
        match self {
            Self::OnePhase | Self::TwoPhase => 1,
            Self::OneTwoPhase => 2,
            Self::Microstep(microsteps) => microsteps.max(1),
        }
    }

    /// Steps of this excitation per electrical period.
    pub fn steps_per_period(self) -> u32 {
        4 * u32::from(self.steps_per_full_step())
    }

    /// The currents of phases A and B after `steps` steps to the right (left negative), -1 to 1 of the peak.
    pub fn currents(self, steps: i64) -> (f64, f64) {
        let per_full = i64::from(self.steps_per_full_step());
        let phase = steps.rem_euclid(4 * per_full);
        let (quarter, step) = (phase / per_full, phase % per_full);
        let (a, b) = match self {
            Self::TwoPhase => (1.0, 1.0),
            _ if step == 0 => (1.0, 0.0),
            Self::OnePhase | Self::OneTwoPhase => (1.0, 1.0),
            Self::Microstep(_) => {
                let angle = FRAC_PI_2 * step as f64 / per_full as f64;
                (libm::cos(angle), libm::sin(angle))
            }
        };
        // A quarter of the period turns A into B and B into -A. Adding 0 avoids -0.
        match quarter {
            0 => (a, b),
            1 => (0.0 - b, a),
            2 => (0.0 - a, 0.0 - b),
            _ => (b, 0.0 - a),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    const ALL: [Excitation; 6] = [
        Excitation::OnePhase,
        Excitation::TwoPhase,
        Excitation::OneTwoPhase,
        Excitation::Microstep(1),
        Excitation::Microstep(16),
        Excitation::Microstep(512),
    ];

    #[test]
    fn has_the_sequences_of_the_drawing() {
        let rows: [(Excitation, &[(f64, f64)]); 3] = [
            (Excitation::OnePhase, &[(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]),
            (Excitation::TwoPhase, &[(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]),
            (
                Excitation::OneTwoPhase,
                &[
                    (1.0, 0.0),
                    (1.0, 1.0),
                    (0.0, 1.0),
                    (-1.0, 1.0),
                    (-1.0, 0.0),
                    (-1.0, -1.0),
                    (0.0, -1.0),
                    (1.0, -1.0),
                ],
            ),
        ];
        for (excitation, expected) in rows {
            let period = excitation.steps_per_period();
            assert_eq!(period as usize, expected.len());
            let found: Vec<_> = (0..period).map(|k| excitation.currents(k.into())).collect();
            assert_eq!(found, expected, "{excitation:?}");
        }
    }

    #[test]
    fn microsteps_are_a_cosine_and_a_sine_with_exact_full_steps() {
        for n in [1_u16, 2, 16, 512] {
            let excitation = Excitation::Microstep(n);
            assert_eq!(excitation.steps_per_period(), 4 * u32::from(n));
            for k in 0..4 * i64::from(n) {
                let (a, b) = excitation.currents(k);
                let angle = FRAC_PI_2 * k as f64 / f64::from(n);
                assert!((a - libm::cos(angle)).abs() < 1e-15 && (b - libm::sin(angle)).abs() < 1e-15);
                assert!((a * a + b * b - 1.0).abs() < 1e-15);
            }
            let full: Vec<_> = (0..4).map(|k| excitation.currents(k * i64::from(n))).collect();
            assert_eq!(full, [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]);
        }
        assert_eq!(Excitation::Microstep(0).currents(1), Excitation::OnePhase.currents(1));
    }

    #[test]
    fn currents_are_periodic_and_reversed_to_the_left() {
        for excitation in ALL {
            let period = i64::from(excitation.steps_per_period());
            for k in -period..period {
                assert_eq!(excitation.currents(k), excitation.currents(k + 3 * period), "{excitation:?} {k}");
                let larger = excitation.currents(k).1.abs().max(excitation.currents(k).0.abs());
                assert!(larger > 0.7 && larger <= 1.0);
            }
            // The current vector rotates in the same direction with every step.
            for k in 0..period {
                let ((a, b), (next_a, next_b)) = (excitation.currents(k), excitation.currents(k + 1));
                assert!(a * next_b - b * next_a > 0.0, "{excitation:?} {k}");
            }
        }
        // 2^63 is a whole number of periods of 2048 steps.
        let fine = Excitation::Microstep(512);
        assert_eq!(fine.currents(i64::MIN), (1.0, 0.0));
        assert_eq!(fine.currents(i64::MAX), fine.currents(-1));
    }
}
