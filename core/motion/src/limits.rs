//! The range of each number of a plan (DESIGN Part B); rules that combine several are checked with the curve.
//!
//! ```
//! use stepscope_motion::{MAX_SPEED, limits};
//!
//! assert!(limits::MICROSTEPS.contains(&256.0));
//! assert_eq!(*limits::SPEED_STEPS_S.end(), MAX_SPEED);
//! ```

use crate::{MAX_SPEED, motor::MAX_PEAK_CURRENT, moves::MAX_POINTS};
use core::ops::RangeInclusive;

pub const FULL_STEP_DEG: RangeInclusive<f64> = 0.001..=90.0;
pub const MICROSTEPS: RangeInclusive<f64> = 1.0..=512.0;
/// A radius, a lead or the length of a step.
pub const LENGTH_MM: RangeInclusive<f64> = 1e-6..=1e6;

/// A distance; it must round to at least one step.
pub const STEPS: RangeInclusive<f64> = -1e9..=1e9;
pub const SPEED_STEPS_S: RangeInclusive<f64> = 1e-6..=MAX_SPEED;
/// A rate in a table. The minimum rounds to one pulse per second.
pub const TABLE_RATE_STEPS_S: RangeInclusive<f64> = 0.5..=MAX_SPEED;
pub const ACCELERATION_STEPS_S2: RangeInclusive<f64> = 1e-6..=1e13;
pub const JERK_STEPS_S3: RangeInclusive<f64> = 1e-6..=1e19;

/// Duration of a move or a period.
pub const DURATION_S: RangeInclusive<f64> = 1e-6..=86_400.0;
/// Duration of a ramp or a dwell.
pub const PAUSE_S: RangeInclusive<f64> = 0.0..=*DURATION_S.end();
pub const SLICE_S: RangeInclusive<f64> = 1e-5..=0.1;
pub const TIMER_HZ: RangeInclusive<f64> = 1.0..=u32::MAX as f64;
pub const LEVEL: RangeInclusive<f64> = 1.0..=5.0;
/// Range of a sigmoid or time constants of an exponential. Smaller values give a straight ramp to one part in a thousand,
/// larger ones a speed that hardly changes for most of the ramp.
pub const RAMP_PARAMETER: RangeInclusive<f64> = 0.1..=20.0;
pub const PERIODS: RangeInclusive<f64> = 1.0..=1e6;
/// Maximum deviation d1, in units of the amplitude.
pub const MAX_DEVIATION: RangeInclusive<f64> = 0.0..=1.0;
pub const POINTS: RangeInclusive<usize> = 2..=MAX_POINTS;
pub const MOVES: RangeInclusive<usize> = 1..=64;
/// Groups of a motion.
pub const GROUPS: RangeInclusive<usize> = 0..=64;
/// Points of a group.
pub const WAY_POINTS: RangeInclusive<usize> = 1..=4096;
/// A speed at the start or the end of a move, or a start-stop speed.
pub const EDGE_SPEED_STEPS_S: RangeInclusive<f64> = 0.0..=MAX_SPEED;
/// A speed with a direction.
pub const SIGNED_SPEED_STEPS_S: RangeInclusive<f64> = -MAX_SPEED..=MAX_SPEED;
/// Time of a cut after the start of the move.
pub const CUT_S: RangeInclusive<f64> = 1e-9..=*DURATION_S.end();
/// Frequency of a vibration.
pub const SHAPER_HZ: RangeInclusive<f64> = 0.1..=10_000.0;

pub const RATED_CURRENT_A: RangeInclusive<f64> = 0.001..=100.0;
/// Peak of the phase current in units of the rated current.
pub const PEAK_CURRENT: RangeInclusive<f64> = 0.001..=MAX_PEAK_CURRENT;
pub const RESISTANCE_OHM: RangeInclusive<f64> = 0.001..=1000.0;
pub const INDUCTANCE_MH: RangeInclusive<f64> = 0.001..=10_000.0;
pub const HOLDING_TORQUE_MN_M: RangeInclusive<f64> = 0.001..=1e6;
pub const INERTIA_G_CM2: RangeInclusive<f64> = 0.0..=1e9;
pub const SUPPLY_V: RangeInclusive<f64> = 0.1..=1000.0;
pub const LOAD_TORQUE_MN_M: RangeInclusive<f64> = 0.0..=1e6;
/// Rate at which a motor is known to work.
pub const WORKING_RATE_HZ: RangeInclusive<f64> = 1.0..=MAX_SPEED;
