//! The range of each number that a plan holds by itself; rules that join several stand where the curve is made.
//!
//! ```
//! use stepscope_motion::{MAX_SPEED, limits};
//!
//! assert!(limits::MICROSTEPS.contains(&256.0));
//! assert_eq!(*limits::SPEED_STEPS_S.end(), MAX_SPEED);
//! ```

use crate::{MAX_SPEED, motor::MAX_PEAK_CURRENT, moves::MAX_POINTS};
use core::ops::RangeInclusive;

/// Full step of a motor in degrees.
pub const FULL_STEP_DEG: RangeInclusive<f64> = 0.001..=90.0;
/// Microsteps in a full step.
pub const MICROSTEPS: RangeInclusive<f64> = 1.0..=512.0;
/// A radius, a lead or a step in mm.
pub const LENGTH_MM: RangeInclusive<f64> = 1e-6..=1e6;

/// A way in steps; under one step it is none.
pub const STEPS: RangeInclusive<f64> = -1e9..=1e9;
/// A speed in steps/s that must not be 0.
pub const SPEED_STEPS_S: RangeInclusive<f64> = 1e-6..=MAX_SPEED;
/// A rate of a table in steps/s: the least rounds to a pulse a second.
pub const TABLE_RATE_STEPS_S: RangeInclusive<f64> = 0.5..=MAX_SPEED;
/// An acceleration in steps/s^2.
pub const ACCELERATION_STEPS_S2: RangeInclusive<f64> = 1e-6..=1e13;
/// A jerk in steps/s^3.
pub const JERK_STEPS_S3: RangeInclusive<f64> = 1e-6..=1e19;

/// Time of a move or of a period in s.
pub const DURATION_S: RangeInclusive<f64> = 1e-6..=86_400.0;
/// Time of a ramp or of standing still in s.
pub const PAUSE_S: RangeInclusive<f64> = 0.0..=*DURATION_S.end();
/// A slice in s (B4).
pub const SLICE_S: RangeInclusive<f64> = 1e-5..=0.1;
/// Clock of a table's timer in Hz (B2).
pub const TIMER_HZ: RangeInclusive<f64> = 1.0..=u32::MAX as f64;
/// Acceleration level (B3).
pub const LEVEL: RangeInclusive<f64> = 1.0..=5.0;
/// How much of its curve a ramp of a sigmoid or an exponential may be: below this it is straight to a part in a
/// thousand, above it stands still but for a small part of its time.
pub const RAMP_PARAMETER: RangeInclusive<f64> = 0.1..=20.0;
/// Periods of a sine.
pub const PERIODS: RangeInclusive<f64> = 1.0..=1e6;
/// Largest deviation d1 (B5), in parts of the amplitude.
pub const MAX_DEVIATION: RangeInclusive<f64> = 0.0..=1.0;
/// Points of a curve (B6).
pub const POINTS: RangeInclusive<usize> = 2..=MAX_POINTS;
/// Moves of an axis.
pub const MOVES: RangeInclusive<usize> = 1..=64;

/// Rated current of a phase in A.
pub const RATED_CURRENT_A: RangeInclusive<f64> = 0.001..=100.0;
/// The peak of the phase current in parts of the rated one.
pub const PEAK_CURRENT: RangeInclusive<f64> = 0.001..=MAX_PEAK_CURRENT;
/// Resistance of a phase in ohm.
pub const RESISTANCE_OHM: RangeInclusive<f64> = 0.001..=1000.0;
/// Inductance of a phase in mH.
pub const INDUCTANCE_MH: RangeInclusive<f64> = 0.001..=10_000.0;
/// Holding torque in mN*m.
pub const HOLDING_TORQUE_MN_M: RangeInclusive<f64> = 0.001..=1e6;
/// An inertia in g*cm^2.
pub const INERTIA_G_CM2: RangeInclusive<f64> = 0.0..=1e9;
/// Supply of a driver in V.
pub const SUPPLY_V: RangeInclusive<f64> = 0.1..=1000.0;
/// Torque of a load in mN*m.
pub const LOAD_TORQUE_MN_M: RangeInclusive<f64> = 0.0..=1e6;
/// Rate that a motor is known to do, in steps/s.
pub const WORKING_RATE_HZ: RangeInclusive<f64> = 1.0..=MAX_SPEED;
