//! Curves: the position of an axis over time, and the times of its steps (DESIGN Part B). One file per kind of move:
//!
//! ```text
//! trapezoid, trapezoid_table     B2    / uniform acceleration, exact or by a table of timer reloads \
//! staircase                      B3    _-_     a staircase of constant rates
//! cosine, sliced, ramps          B4    ( S )   a distance in a given time, with shaped ramps
//! sine_segments, sine            B5 B6 \/\/    around a middle position
//! jerk_limited, points           B6    within limits, or through points
//! constant_velocity              B6    ---     one rate, or a dwell
//! phases, between_speeds, retarget, way_points, speed_ramps    between two speeds, to a new target, through points
//! numeric                        steps of these, which may start between two steps and reverse
//! cut, stretched, shaped         made of other curves
//! ```
//!
//! ```
//! use stepscope_motion::{Curve, curves::{Cosine, JerkLimited, JerkLimits}};
//!
//! // One turn of 3200 steps in 0.4 s, of which half accelerates.
//! let turn = Cosine::new(3200, 0.4, 0.2);
//! assert_eq!((turn.top_speed(), turn.position(0.2)), (16_000.0, 1600.0));
//! let limits = JerkLimits { speed: 10_000.0, acceleration: 100_000.0, jerk: 2_000_000.0 };
//! assert!(JerkLimited::new(3200, limits).peaks().speed <= 10_000.0);
//! ```

pub(crate) mod acceleration_table;
pub(crate) mod between_speeds;
pub(crate) mod breakpoints;
mod climb;
pub(crate) mod constant_velocity;
pub(crate) mod cosine;
mod cubic;
pub(crate) mod curve;
pub(crate) mod cut;
pub(crate) mod jerk_limited;
mod mirrored;
pub(crate) mod move_curve;
pub(crate) mod numeric;
pub(crate) mod oscillation;
pub(crate) mod phases;
pub(crate) mod points;
pub mod polyline;
pub(crate) mod ramp;
pub(crate) mod ramps;
pub(crate) mod retarget;
pub(crate) mod shaped;
pub(crate) mod sine;
pub(crate) mod sine_segments;
pub(crate) mod sliced;
pub(crate) mod speed_ramps;
pub(crate) mod staircase;
pub(crate) mod staircase_table;
pub(crate) mod stepped;
pub(crate) mod stretched;
pub(crate) mod trapezoid;
pub(crate) mod trapezoid_table;
pub(crate) mod way_points;

pub use acceleration_table::AccelerationTable;
pub use constant_velocity::{ConstantVelocity, Dwell};
pub use cosine::Cosine;
pub use cut::Cut;
pub use jerk_limited::{JerkLimited, Limits as JerkLimits};
pub use numeric::Numeric;
pub use points::Points;
pub use ramp::{Exponential, Ramp, Sigmoid, longest_ramp_s};
pub use ramps::Ramps;
pub use sine::Sine;
pub use sine_segments::{Memory, Segment, SineSegments};
pub use sliced::{NotSliced, Slice, Sliced, TimeError};
pub use staircase::Staircase;
pub use staircase_table::StaircaseTable;
pub use stretched::Stretched;
pub use trapezoid::Trapezoid;
pub use trapezoid_table::{NoTable, TrapezoidTable};
