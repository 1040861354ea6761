//! The moves of an axis: what each kind is asked, with its defaults (DESIGN Part B).
//!
//! ```
//! use stepscope_motion::{
//!     mechanics::Distance,
//!     moves::{Axis, Cosine, Dwell, Move},
//!     plan_axis,
//! };
//!
//! let go = Move::Cosine(Cosine { distance: Distance::Steps(1600.0), ..Cosine::default() });
//! let wait = Move::Dwell(Dwell { duration_s: 0.25 });
//! let axis = Axis { moves: vec![go, wait], ..Axis::default() };
//! let plan = plan_axis(&axis, "x").expect("it holds");
//! assert_eq!((plan.steps(), plan.duration_s()), (1600, 0.65));
//! ```

use crate::{
    mechanics::{Acceleration, Distance, Jerk, Mechanics, Speed},
    motor::Motor,
    parameters::parameters,
};
use alloc::{vec, vec::Vec};

/// One move of an axis (DESIGN Part B).
#[derive(Clone, Debug, PartialEq)]
pub enum Move {
    /// Uniform acceleration by table (B2).
    Trapezoid(Trapezoid),
    /// Fixed length by a staircase of rates (B3).
    Staircase(Staircase),
    /// Cosine S-curve with exact distance and exact time (B4).
    Cosine(Cosine),
    /// Ramps of another shape with exact distance and exact time (B4).
    Ramps(Ramps),
    /// Sine as segments of fixed rate (B5).
    SineSegments(SineSegments),
    /// Sine with every step in its place (B6).
    Sine(Sine),
    /// Seven phases from rest to rest (B6).
    JerkLimited(JerkLimited),
    /// A curve through points (B6).
    Points(Points),
    /// One rate from end to end (B6).
    Constant(Constant),
    /// Standing still (B6).
    Dwell(Dwell),
}

impl Move {
    /// The time in s that it names, `None` of a kind whose time follows from other numbers.
    #[must_use]
    pub fn requested_s(&self) -> Option<f64> {
        match self {
            Self::Cosine(cosine) => Some(cosine.duration_s),
            Self::Ramps(ramps) => Some(ramps.duration_s),
            Self::SineSegments(sine) => Some(sine.period_s * f64::from(sine.periods)),
            Self::Sine(sine) => Some(sine.period_s * f64::from(sine.periods)),
            Self::Points(given) => {
                let (first, last) = (given.points.first()?, given.points.last()?);
                Some(last.time_s - first.time_s)
            }
            Self::Dwell(dwell) => Some(dwell.duration_s),
            Self::Trapezoid(_) | Self::Staircase(_) | Self::JerkLimited(_) | Self::Constant(_) => None,
        }
    }
}

impl Default for Move {
    fn default() -> Self {
        Self::Cosine(Cosine::default())
    }
}

parameters! {
    /// Trapezoid by acceleration table (B2, Sonobe 2011).
    pub struct Trapezoid {
        /// How far; negative is left.
        pub distance: Distance = Distance::Steps(2000.0),
        /// Speed of the first step.
        pub start_speed: Speed = Speed::StepsPerSecond(250.0),
        /// Speed of the plateau.
        pub top_speed: Speed = Speed::StepsPerSecond(4000.0),
        /// Acceleration and deceleration.
        pub acceleration: Acceleration = Acceleration::StepsPerSecond2(9000.0),
        /// Whose step times.
        pub method: TrapezoidMethod = TrapezoidMethod::Table,
        /// Clock of the timer whose reload the table holds, in Hz; only the table uses it.
        pub timer_hz: u32 = 1_000_000,
    }
}

/// Whose step times a trapezoid has (B2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TrapezoidMethod {
    /// The paper's: a table of whole pulse rates, one a step, and a timer's whole reload.
    #[default]
    Table,
    /// Every step where the ideal curve crosses its half-integer (B1).
    Exact,
}

parameters! {
    /// Fixed length by a staircase of rates (B3, Zhang 2012).
    pub struct Staircase {
        /// How far, the paper's L; negative is left.
        pub distance: Distance = Distance::Steps(10_000.0),
        /// Speed of the plateau, f_s; at or below the start speed that of the whole move.
        pub top_speed: Speed = Speed::StepsPerSecond(5000.0),
        /// Acceleration level 1 to 5: 1000 to 5000 steps/s^2.
        pub level: u8 = 3,
        /// What becomes of a move that is too short to reach its top speed.
        pub short_move: ShortMove = ShortMove::Document,
        /// First rate of the table, f_1.
        pub start_speed: Speed = Speed::StepsPerSecond(1000.0),
        /// The table ends with the first rate above this, f_max; no top speed may be above it.
        pub max_speed: Speed = Speed::StepsPerSecond(20_000.0),
    }
}

/// What becomes of a move that is too short to reach its top speed (B3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShortMove {
    /// The paper's: the whole move at the start speed.
    #[default]
    Document,
    /// Up as many rows of the table as fit, and down again.
    Reverse,
}

parameters! {
    /// Cosine S-curve (B4, Song, Han, Lu 2021): so many steps in so much time.
    pub struct Cosine {
        /// How far; negative is left.
        pub distance: Distance = Distance::Steps(3200.0),
        /// Time of the whole move in s.
        pub duration_s: f64 = 0.4,
        /// Time of each ramp in s, at most half of the duration.
        pub ramp_s: f64 = 0.2,
        /// Whose step times.
        pub method: CosineMethod = CosineMethod::Exact,
        /// Length of a slice in s, the paper's TS, 0.00001 to 0.1; only `sliced` uses it.
        pub slice_s: f64 = 0.001,
    }
}

/// Whose step times a cosine S-curve has (B4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CosineMethod {
    /// Every step where the ideal curve crosses its half-integer (B1).
    #[default]
    Exact,
    /// The paper's: slices of whole steps, compensated until their sum is right.
    Sliced,
}

parameters! {
    /// Ramps of a shape (B4): so many steps in so much time, as the cosine S-curve has it.
    pub struct Ramps {
        /// How far; negative is left.
        pub distance: Distance = Distance::Steps(3200.0),
        /// Time of the whole move in s.
        pub duration_s: f64 = 0.4,
        /// Time of each ramp in s, at most half of the duration.
        pub ramp_s: f64 = 0.2,
        /// What the ramps look like.
        pub shape: RampShape = RampShape::Sigmoid,
        /// The x of 1/(1 + e^-x) goes from minus to plus this over a ramp, 0.1 to 20; only the sigmoid uses it.
        pub sigmoid_range: f64 = 6.0,
        /// Time constants of the exponential within a ramp, 0.1 to 20; only the exponential uses it.
        pub time_constants: f64 = 4.0,
    }
}

/// What a ramp looks like (B4; Song, Han, Lu 2021, table 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RampShape {
    /// The middle of 1/(1 + e^-x), shifted and stretched so that it begins at rest and ends at top speed: one that
    /// is only cut off never gets there.
    #[default]
    Sigmoid,
    /// 3x^2 - 2x^3: a cubic Bezier curve with the control values 0, 0, 1, 1.
    Bezier,
    /// Uniform acceleration, a trapezoid.
    Straight,
    /// The approach of an exponential: steep at first, as a motor's torque falls with its rate.
    Exponential,
}

parameters! {
    /// Sine as segments of fixed rate (B5), from the right extreme to the left one and back.
    pub struct SineSegments {
        /// From the middle to an extreme.
        pub amplitude: Distance = Distance::Steps(1000.0),
        /// Time of one period in s.
        pub period_s: f64 = 0.5,
        /// How many whole periods.
        pub periods: u32 = 4,
        /// Largest deviation of a segment from the sine, d1, in parts of the amplitude.
        pub max_deviation: f64 = 0.006,
    }
}

parameters! {
    /// Exact sine (B6, B1's rule), from the right extreme to the left one and back.
    pub struct Sine {
        /// From the middle to an extreme.
        pub amplitude: Distance = Distance::Steps(1000.0),
        /// Time of one period in s.
        pub period_s: f64 = 0.5,
        /// How many whole periods.
        pub periods: u32 = 4,
    }
}

parameters! {
    /// Jerk-limited move of seven phases (B6): from rest to rest as fast as its limits let it.
    pub struct JerkLimited {
        /// How far; negative is left.
        pub distance: Distance = Distance::Steps(3200.0),
        /// Maximum speed.
        pub max_speed: Speed = Speed::StepsPerSecond(10_000.0),
        /// Maximum acceleration and deceleration.
        pub max_acceleration: Acceleration = Acceleration::StepsPerSecond2(100_000.0),
        /// Maximum change of the acceleration in a second.
        pub max_jerk: Jerk = Jerk::StepsPerSecond3(2_000_000.0),
    }
}

parameters! {
    /// One rate from end to end (B6).
    pub struct Constant {
        /// How far; negative is left.
        pub distance: Distance = Distance::Steps(1000.0),
        /// How fast.
        pub speed: Speed = Speed::StepsPerSecond(1000.0),
    }
}

parameters! {
    /// Standing still (B6).
    pub struct Dwell {
        /// How long, in s.
        pub duration_s: f64 = 0.1,
    }
}

/// Maximum points of a move.
pub const MAX_POINTS: usize = 4096;

parameters! {
    /// A curve through points (B6).
    pub struct Points {
        /// Unit of the positions.
        pub unit: PointUnit = PointUnit::Steps,
        /// How the curve goes from point to point.
        pub interpolation: Interpolation = Interpolation::Smooth,
        /// 2 to 4096 points, their times rising by 1 ns at least.
        pub points: Vec<Point> =
            vec![Point { time_s: 0.0, position: 0.0 }, Point { time_s: 0.5, position: 1000.0 }],
    }
}

/// Unit of the positions of points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PointUnit {
    /// Steps.
    #[default]
    Steps,
    /// Millimetres.
    Millimetres,
    /// Degrees.
    Degrees,
}

impl PointUnit {
    /// A position in this unit.
    #[must_use]
    pub const fn of(self, position: f64) -> Distance {
        match self {
            Self::Steps => Distance::Steps(position),
            Self::Millimetres => Distance::Millimetres(position),
            Self::Degrees => Distance::Degrees(position),
        }
    }
}

/// How a curve goes from point to point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Straight: the speed jumps at each point.
    Straight,
    /// By cubics that turn only where the points do, from rest to rest.
    #[default]
    Smooth,
}

/// A point of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Time in s; the first point's is the start of the move.
    pub time_s: f64,
    /// Position in the unit of the points; the first point's is where the move starts.
    pub position: f64,
}

parameters! {
    /// One axis: its mechanics and the moves that it makes one after another.
    pub struct Axis {
        /// What one step is (DESIGN B1).
        pub mechanics: Mechanics = Mechanics::default(),
        /// Up to 64 moves.
        pub moves: Vec<Move> = vec![Move::default()],
        /// Its motor, driver supply and load; without it nothing is said of torque.
        pub motor: Option<Motor> = None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_requested_where_it_is_a_parameter() {
        let point = |time_s| Point { time_s, position: 0.0 };
        let points = vec![point(0.5), point(0.7), point(2.0)];
        let rows = [
            (Move::Cosine(Cosine { duration_s: 0.3, ..Cosine::default() }), Some(0.3)),
            (Move::Ramps(Ramps { duration_s: 0.7, ..Ramps::default() }), Some(0.7)),
            (Move::Sine(Sine { period_s: 0.5, periods: 3, ..Sine::default() }), Some(1.5)),
            (
                Move::SineSegments(SineSegments { period_s: 0.25, periods: 3, ..SineSegments::default() }),
                Some(0.75),
            ),
            (Move::Points(Points { points, ..Points::default() }), Some(1.5)),
            (Move::Points(Points { points: Vec::new(), ..Points::default() }), None),
            (Move::Dwell(Dwell { duration_s: 0.25 }), Some(0.25)),
            (Move::Trapezoid(Trapezoid::default()), None),
            (Move::Staircase(Staircase::default()), None),
            (Move::JerkLimited(JerkLimited::default()), None),
            (Move::Constant(Constant::default()), None),
        ];
        for (given, requested_s) in rows {
            assert_eq!(given.requested_s(), requested_s, "{given:?}");
        }
    }
}
