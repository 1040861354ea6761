//! Motions: position, speed and acceleration of an axis over time, and its ticks, segments and step tables (DESIGN
//! Part B).
//!
//! ```text
//! moves, groups, mechanics, motor    the input from a scenario, and its limits
//! shaper                             impulses that cancel a vibration
//! curves                             position over time, one file per kind of move
//! timing                             when each step is due, with clock-cycle accuracy
//! planners                           from moves to curves, axis by axis
//! step_tables                        from steps to ticks, segments and tables
//! ```
//!
//! Positions are in steps, as f64; only [`round_half_up`] rounds them. Mathematics beyond + - * / and the square root comes
//! from `libm`, so a plan has the same bits on every target.
//!
//! ```
//! use stepscope_motion::{moves::Axis, plan_axis};
//!
//! // By default an axis makes one turn of 3200 steps with a cosine S-curve.
//! let plan = plan_axis(&Axis::default(), "x").expect("a valid axis");
//! assert_eq!((plan.steps(), plan.duration_s()), (3200, 0.4));
//! assert_eq!((plan.position(0.2), plan.speed(0.2)), (1600.0, 16_000.0));
//! ```
#![cfg_attr(not(any(test, feature = "std")), no_std)]
#![allow(missing_docs, reason = "a field whose name has its unit needs no comment that repeats it")]

extern crate alloc;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod bisection;
pub mod curves;
pub mod excitation;
mod format;
pub mod groups;
pub mod limits;
pub mod mechanics;
pub mod motor;
pub mod moves;
mod planners;
pub mod problem;
mod problems;
pub mod shaper;
pub mod step_tables;
mod timing;
mod validator;

pub use curves::breakpoints::{Breakpoints, Interval};
pub use curves::curve::{Curve, Peaks};
pub use format::grouped;
pub use planners::axis::{AxisPlan, PlannedMove};
pub use planners::plan::{AxisList, plan_axis, plan_lists, plan_move};
pub use planners::{due_by::DueBy, profile::Profile};
pub use problem::{Cause, Problem, ValueError};
pub use problems::{MAX_PROBLEMS, Problems, WiderCause};
pub use timing::ScheduledStep;
pub use validator::Validator;

/// Maximum speed of a motion in steps/s.
pub const MAX_SPEED: f64 = 1e7;

/// floor(x + 1/2), exact because the sum is not formed: 0.49999999999999994 gives 0. Saturates; NaN gives 0.
pub fn round_half_up(x: f64) -> i64 {
    // Truncation is faster than `libm::floor` on every target. Both differences are exact, because |x - truncated| < 1.
    let truncated = x as i64;
    let fraction = x - truncated as f64;
    if fraction >= 0.5 {
        truncated.saturating_add(1)
    } else if fraction < -0.5 {
        truncated.saturating_sub(1)
    } else {
        truncated
    }
}

/// IEEE 754 defines every bit of a square root, so each target may use its own: that of wasm is ten times as fast as `libm`'s.
fn square_root(x: f64) -> f64 {
    #[cfg(feature = "std")]
    let root = x.sqrt();
    #[cfg(not(feature = "std"))]
    let root = libm::sqrt(x);
    root
}

#[cfg(test)]
mod tests {
    use super::{round_half_up, square_root};

    #[test]
    fn square_root_has_the_bits_of_libm() {
        let grid = (0..100_000_u64).map(|i| f64::from_bits(i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 1));
        for x in grid.chain([0.0, -0.0, 1e-320, 2.0, -1.0, f64::MAX, f64::INFINITY]) {
            let (found, expected) = (square_root(x), libm::sqrt(x));
            assert!(found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan()), "{x}");
        }
    }

    #[test]
    fn rounds_at_exactly_half_up() {
        let below_half = 0.499_999_999_999_999_94;
        let rows = [
            (0.0, 0),
            (0.5, 1),
            (below_half, 0),
            (-0.5, 0),
            (-0.500_000_000_000_000_1, -1),
            (-below_half, 0),
            (1.5, 2),
            (-1.5, -1),
            (2.4, 2),
            (-2.6, -3),
            (4_503_599_627_370_497.5, 4_503_599_627_370_498),
            (1e300, i64::MAX),
            (-1e300, i64::MIN),
            (f64::INFINITY, i64::MAX),
            (f64::NAN, 0),
        ];
        for (given, expected) in rows {
            assert_eq!(round_half_up(given), expected, "{given}");
        }
    }
}
