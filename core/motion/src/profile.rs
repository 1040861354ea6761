//! The curve of one move, of any family: what the planner makes and everything after it asks.

use crate::{
    constant_velocity::{Constant, Dwell},
    cosine::Cosine,
    curve::{Curve, Peaks},
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
