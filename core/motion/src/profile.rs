//! What all motions share: a curve over time, in steps (DESIGN B1).

use crate::{
    constant_velocity::{Constant, Dwell},
    cosine::Cosine,
    format::describe,
    jerk_limited::JerkLimited,
    points::Points,
    ramps::Ramps,
    sine::Sine,
    sine_segments::SineSegments,
    sliced::Sliced,
    staircase::Staircase,
    trapezoid::Trapezoid,
    trapezoid_table::TrapezoidTable,
};
use alloc::string::String;

/// The curve of one move: position, speed and acceleration over time since the move's start.
///
/// Times are in s, positions in steps from the move's own start, left negative. Before the start a
/// curve stands at 0, after its end at [`Curve::steps`].
pub trait Curve {
    /// How long the move lasts, in s.
    fn duration_s(&self) -> f64;

    /// Where it ends, in steps from its start.
    fn steps(&self) -> i64;

    /// Position at `t`: B1's rounding of it gives the steps due by `t`, and at the end it is
    /// exactly [`Curve::steps`].
    fn position(&self, t: f64) -> f64;

    /// Speed at `t` in steps/s: at the start the first that the move has, at the end the last.
    fn speed(&self, t: f64) -> f64;

    /// Acceleration at `t` in steps/s^2; where the speed jumps it has no value, and none is given.
    fn acceleration(&self, t: f64) -> f64;

    /// The greatest values within the move; what its start and its end jump by is the axis' to know.
    fn peaks(&self) -> Peaks;

    /// What a user wants to know of the move beside its times, in a few words, on a bus that can
    /// give `limit_steps_s`; empty where there is nothing to say.
    fn detail(&self, _limit_steps_s: f64) -> String {
        describe(self.peaks())
    }
}

/// The greatest magnitudes of a move or an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Speed in steps/s.
    pub speed: f64,
    /// Acceleration in steps/s^2 where the speed has no jump.
    pub acceleration: f64,
    /// Jump of speed in steps/s: what a motor has to follow at once (its start-stop rate).
    pub jump: f64,
    /// Jerk in steps/s^3 where the acceleration has no jump; 0 where the acceleration only jumps.
    pub jerk: f64,
    /// Jump of acceleration in steps/s^2; there the jerk has no bound. At a jump of speed it is that from
    /// the acceleration before to the one after.
    pub acceleration_jump: f64,
}

impl Peaks {
    /// The greater of both, each by itself.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            speed: greater(self.speed, other.speed),
            acceleration: greater(self.acceleration, other.acceleration),
            jump: greater(self.jump, other.jump),
            jerk: greater(self.jerk, other.jerk),
            acceleration_jump: greater(self.acceleration_jump, other.acceleration_jump),
        }
    }
}

/// The greater of two magnitudes.
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// The curve of one move, of any family.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    /// Uniform acceleration, every step where the curve crosses its half-integer (B2, B1).
    Trapezoid(Trapezoid),
    /// Uniform acceleration by table (B2).
    TrapezoidTable(TrapezoidTable),
    /// Fixed length by a staircase of rates (B3).
    Staircase(Staircase),
    /// Cosine S-curve (B4, `exact`).
    Cosine(Cosine),
    /// Cosine S-curve in slices (B4, `sliced`).
    Sliced(Sliced),
    /// Ramps of another shape (B4).
    Ramps(Ramps),
    /// Sine by segments (B5).
    SineSegments(SineSegments),
    /// Exact sine (B6).
    Sine(Sine),
    /// Seven phases from rest to rest (B6).
    JerkLimited(JerkLimited),
    /// A curve through points (B6).
    Points(Points),
    /// One rate (B6).
    Constant(Constant),
    /// Standing still (B6).
    Dwell(Dwell),
}

macro_rules! each {
    ($profile:expr, $curve:ident => $what:expr) => {
        match $profile {
            Profile::Trapezoid($curve) => $what,
            Profile::TrapezoidTable($curve) => $what,
            Profile::Staircase($curve) => $what,
            Profile::Cosine($curve) => $what,
            Profile::Sliced($curve) => $what,
            Profile::Ramps($curve) => $what,
            Profile::SineSegments($curve) => $what,
            Profile::Sine($curve) => $what,
            Profile::JerkLimited($curve) => $what,
            Profile::Points($curve) => $what,
            Profile::Constant($curve) => $what,
            Profile::Dwell($curve) => $what,
        }
    };
}

impl Profile {
    /// The period in s and how many of them, of a move that repeats itself.
    #[must_use]
    pub fn repeats(&self) -> Option<(f64, u32)> {
        match self {
            Self::SineSegments(sine) => Some((sine.period_s(), sine.periods())),
            Self::Sine(sine) => Some((sine.period_s(), sine.periods())),
            _ => None,
        }
    }

    /// Steps of the move, whichever way they go.
    #[must_use]
    pub fn step_count(&self) -> u64 {
        match self {
            Self::SineSegments(sine) => sine.step_count(),
            Self::Sine(sine) => sine.step_count(),
            Self::Points(points) => points.step_count(),
            one_way => one_way.steps().unsigned_abs(),
        }
    }
}

impl Curve for Profile {
    fn duration_s(&self) -> f64 {
        each!(self, curve => curve.duration_s())
    }

    fn steps(&self) -> i64 {
        each!(self, curve => curve.steps())
    }

    fn position(&self, t: f64) -> f64 {
        each!(self, curve => curve.position(t))
    }

    fn speed(&self, t: f64) -> f64 {
        each!(self, curve => curve.speed(t))
    }

    fn acceleration(&self, t: f64) -> f64 {
        each!(self, curve => curve.acceleration(t))
    }

    fn peaks(&self) -> Peaks {
        each!(self, curve => curve.peaks())
    }

    fn detail(&self, limit_steps_s: f64) -> String {
        each!(self, curve => curve.detail(limit_steps_s))
    }
}
