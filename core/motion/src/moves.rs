//! The moves of an axis, with their defaults (DESIGN Part B).
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
//! let plan = plan_axis(&axis, "x").expect("a valid axis");
//! assert_eq!((plan.steps(), plan.duration_s()), (1600, 0.65));
//! ```

use crate::mechanics::{Acceleration, Distance, Jerk, Mechanics, Speed};
use crate::motor::Motor;
use crate::shaper::InputShaper;
use alloc::{vec, vec::Vec};
use stepscope_peripheral::parameters;

/// One move of an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Move {
    Trapezoid(Trapezoid),
    Staircase(Staircase),
    Cosine(Cosine),
    Ramps(Ramps),
    SineSegments(SineSegments),
    Sine(Sine),
    JerkLimited(JerkLimited),
    Points(Points),
    Constant(Constant),
    Retarget(Retarget),
    Dwell(Dwell),
}

impl Move {
    /// The requested duration in s; `None` if it follows from other numbers.
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
            Self::Trapezoid(_)
            | Self::Staircase(_)
            | Self::JerkLimited(_)
            | Self::Constant(_)
            | Self::Retarget(_) => None,
        }
    }

    /// The unit of its distance, amplitude or positions, as in JSON; `None` for a dwell or a new target.
    pub const fn unit(&self) -> Option<&'static str> {
        Some(match self {
            Self::Trapezoid(Trapezoid { distance, .. })
            | Self::Staircase(Staircase { distance, .. })
            | Self::Cosine(Cosine { distance, .. })
            | Self::Ramps(Ramps { distance, .. })
            | Self::JerkLimited(JerkLimited { distance, .. })
            | Self::Constant(Constant { distance, .. }) => distance.unit(),
            Self::SineSegments(sine) => sine.amplitude.unit(),
            Self::Sine(sine) => sine.amplitude.unit(),
            Self::Points(points) => points.unit.of(0.0).unit(),
            Self::Dwell(_) | Self::Retarget(_) => return None,
        })
    }
}

impl Default for Move {
    fn default() -> Self {
        Self::Cosine(Cosine::default())
    }
}

parameters! { (Clone, Debug, PartialEq)
    /// Trapezoid by acceleration table (Sonobe 2011).
    pub struct Trapezoid {
        /// Negative to the left, like every distance.
        pub distance: Distance = Distance::Steps(2000.0),
        /// Along the move; `None` takes over the previous move's end speed.
        pub start_speed: Option<Speed> = Some(Speed::StepsPerSecond(250.0)),
        /// `None` is a given start speed, or 0.
        pub end_speed: Option<Speed> = None,
        pub max_speed: Speed = Speed::StepsPerSecond(4000.0),
        pub max_acceleration: Acceleration = Acceleration::StepsPerSecond2(9000.0),
        /// `None` is the acceleration.
        pub deceleration: Option<Acceleration> = None,
        pub method: TrapezoidMethod = TrapezoidMethod::Table,
        /// Clock of the timer that counts the reloads; only for the table.
        pub timer_hz: u32 = 1_000_000,
    }

    /// Fixed distance by a staircase of rates (Zhang 2012).
    pub struct Staircase {
        /// The paper's L.
        pub distance: Distance = Distance::Steps(10_000.0),
        /// Speed of the plateau, the paper's f_s. The whole move has this speed if it is not above the start speed.
        pub top_speed: Speed = Speed::StepsPerSecond(5000.0),
        /// Acceleration level 1 to 5: 1000 to 5000 steps/s^2.
        pub level: u8 = 3,
        pub short_move: ShortMove = ShortMove::Document,
        /// First rate of the table, f_1.
        pub start_speed: Speed = Speed::StepsPerSecond(1000.0),
        /// The paper's f_max: the table ends with the first rate above it, and the top speed is at most this.
        pub max_speed: Speed = Speed::StepsPerSecond(20_000.0),
    }

    /// Cosine S-curve (Song, Han, Lu 2021): a distance in a given time.
    pub struct Cosine {
        pub distance: Distance = Distance::Steps(3200.0),
        pub duration_s: f64 = 0.4,
        /// Duration of each ramp, at most half of the move.
        pub ramp_s: f64 = 0.2,
        pub method: CosineMethod = CosineMethod::Exact,
        /// Length of a slice, the paper's TS, 0.00001 to 0.1; only for `sliced`.
        pub slice_s: f64 = 0.001,
        /// Along the move; `None` takes over the previous move's end speed.
        pub start_speed: Option<Speed> = None,
        /// `None` is 0.
        pub end_speed: Option<Speed> = None,
    }

    /// Shaped ramps: a distance in a given time, like the cosine S-curve.
    pub struct Ramps {
        pub distance: Distance = Distance::Steps(3200.0),
        pub duration_s: f64 = 0.4,
        pub ramp_s: f64 = 0.2,
        pub shape: RampShape = RampShape::Sigmoid,
        /// In a ramp x of 1/(1 + e^-x) goes from minus to plus this value, 0.1 to 20; only for the sigmoid.
        pub sigmoid_range: f64 = 6.0,
        /// Time constants per ramp, 0.1 to 20; only for the exponential.
        pub time_constants: f64 = 4.0,
        /// Along the move; `None` takes over the previous move's end speed.
        pub start_speed: Option<Speed> = None,
        /// `None` is 0.
        pub end_speed: Option<Speed> = None,
    }

    /// Sine as segments of constant rate (SWorldJournal issue 11), from the right extreme to the left one and back.
    pub struct SineSegments {
        pub amplitude: Distance = Distance::Steps(1000.0),
        pub period_s: f64 = 0.5,
        pub periods: u32 = 4,
        /// Maximum deviation of a segment from the sine, d1, in units of the amplitude.
        pub max_deviation: f64 = 0.006,
    }

    /// Exact sine, from the right extreme to the left one and back.
    pub struct Sine {
        pub amplitude: Distance = Distance::Steps(1000.0),
        pub period_s: f64 = 0.5,
        pub periods: u32 = 4,
    }

    /// Jerk-limited move of seven phases: from rest to rest as fast as its limits allow.
    pub struct JerkLimited {
        pub distance: Distance = Distance::Steps(3200.0),
        pub max_speed: Speed = Speed::StepsPerSecond(10_000.0),
        pub max_acceleration: Acceleration = Acceleration::StepsPerSecond2(100_000.0),
        pub max_jerk: Jerk = Jerk::StepsPerSecond3(2_000_000.0),
        /// `None` is the acceleration.
        pub max_deceleration: Option<Acceleration> = None,
        /// Along the move; `None` takes over the previous move's end speed.
        pub start_speed: Option<Speed> = None,
        /// `None` is 0.
        pub end_speed: Option<Speed> = None,
    }

    /// A new target, which replaces the rest of the previous move.
    pub struct Retarget {
        /// Time of the cut, after the start of the previous move.
        pub at_s: f64 = 0.1,
        pub target: Target = Target::Stop(Stop {}),
        pub profile: LimitedProfile = LimitedProfile::JerkLimited,
        /// `None` is the axis' limit.
        pub max_speed: Option<Speed> = None,
        /// `None` is the axis' limit.
        pub max_acceleration: Option<Acceleration> = None,
        /// `None` is the axis' limit, or without one the acceleration of this move.
        pub max_deceleration: Option<Acceleration> = None,
        /// `None` is the axis' limit.
        pub max_jerk: Option<Jerk> = None,
    }

    /// A speed as a target.
    pub struct SpeedTarget {
        /// Negative to the left.
        pub speed: Speed = Speed::StepsPerSecond(0.0),
        /// Time at that speed.
        pub hold_s: f64 = 0.0,
    }

    /// The fastest stop.
    pub struct Stop {}

    /// Limits of an axis, for moves without limits.
    pub struct AxisLimits {
        pub max_speed: Speed = Speed::StepsPerSecond(10_000.0),
        pub max_acceleration: Acceleration = Acceleration::StepsPerSecond2(100_000.0),
        /// `None` is the acceleration.
        pub max_deceleration: Option<Acceleration> = None,
        pub max_jerk: Jerk = Jerk::StepsPerSecond3(2_000_000.0),
        /// Maximum jump of the speed; `None` is not checked.
        pub start_stop_speed: Option<Speed> = None,
    }

    /// A distance at a constant speed, without ramps.
    pub struct Constant {
        pub distance: Distance = Distance::Steps(1000.0),
        pub speed: Speed = Speed::StepsPerSecond(1000.0),
    }

    /// A pause.
    pub struct Dwell {
        pub duration_s: f64 = 0.1,
    }

    /// A curve through points, by lines or smooth (Steffen 1990).
    pub struct Points {
        pub unit: PointUnit = PointUnit::Steps,
        pub interpolation: Interpolation = Interpolation::Smooth,
        /// 2 to 4096 points; their times rise by at least 1 ns.
        pub points: Vec<Point> =
            vec![Point { time_s: 0.0, position: 0.0 }, Point { time_s: 0.5, position: 1000.0 }],
    }

    /// One axis: its mechanics and its moves, one after another.
    pub struct Axis {
        pub mechanics: Mechanics = Mechanics::default(),
        /// Up to 64 moves.
        pub moves: Vec<Move> = vec![Move::default()],
        /// Motor, supply and load; `None` skips the torque computations.
        pub motor: Option<Motor> = None,
        pub limits: AxisLimits = AxisLimits::default(),
        /// Shapes all moves of the axis.
        pub input_shaper: Option<InputShaper> = None,
    }
}

/// A new target of a move.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// From the start of the motion; the axis comes to rest there.
    Position(Distance),
    Speed(SpeedTarget),
    Stop(Stop),
}

/// Profile of a move within limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LimitedProfile {
    #[default]
    JerkLimited,
    /// The acceleration jumps; the jerk is not limited.
    Trapezoid,
}

/// Step times of a trapezoid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TrapezoidMethod {
    /// The paper's: a table with an integer pulse rate and an integer timer reload per step.
    #[default]
    Table,
    /// Step k is due where the ideal curve crosses k - 1/2.
    Exact,
}

/// What happens to a move too short to reach its top speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShortMove {
    /// The paper's: the whole move at the start speed.
    #[default]
    Document,
    /// As many rows of the table as fit, up and down again.
    Reverse,
}

/// Step times of a cosine S-curve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CosineMethod {
    /// Step k is due where the ideal curve crosses k - 1/2.
    #[default]
    Exact,
    /// The paper's: slices of whole steps, compensated until they add up to the distance.
    Sliced,
}

/// Shape of a ramp (Song, Han, Lu 2021, table 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RampShape {
    /// The middle of 1/(1 + e^-x), shifted and stretched from rest to top speed.
    #[default]
    Sigmoid,
    /// 3x^2 - 2x^3: a cubic Bezier curve with the control values 0, 0, 1, 1.
    Bezier,
    /// Uniform acceleration: a trapezoid.
    Straight,
    /// Steep at first, as a motor's torque falls with its rate.
    Exponential,
}

impl Ramps {
    /// The default move with another shape; `parameter` is the range of a sigmoid, or the time constants of an exponential.
    pub fn shaped(shape: RampShape, parameter: f64) -> Self {
        let ramps = Self { shape, ..Self::default() };
        match shape {
            RampShape::Sigmoid => Self { sigmoid_range: parameter, ..ramps },
            RampShape::Exponential => Self { time_constants: parameter, ..ramps },
            RampShape::Bezier | RampShape::Straight => ramps,
        }
    }
}

/// Maximum points per move.
pub const MAX_POINTS: usize = 4096;

/// Unit of the positions of points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PointUnit {
    #[default]
    Steps,
    Millimeters,
    Degrees,
}

impl PointUnit {
    /// A position in this unit.
    pub const fn of(self, position: f64) -> Distance {
        match self {
            Self::Steps => Distance::Steps(position),
            Self::Millimeters => Distance::Millimeters(position),
            Self::Degrees => Distance::Degrees(position),
        }
    }
}

/// How points are connected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// By lines: the speed jumps at each point.
    Straight,
    /// By monotone cubics, which reverse only at points, from rest to rest.
    #[default]
    Smooth,
}

/// A point of a curve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// The first point's time is the start of the move.
    pub time_s: f64,
    /// In the unit of the points; the move starts at the first point.
    pub position: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requested_duration_exists_where_it_is_a_parameter() {
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
            (Move::Retarget(Retarget::default()), None),
            (Move::Constant(Constant::default()), None),
        ];
        for (given, requested_s) in rows {
            assert_eq!(given.requested_s(), requested_s, "{given:?}");
        }
    }
}
