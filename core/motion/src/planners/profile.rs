//! The curve of one move, of any family: what each kind of move becomes, and everything after it asks.
//!
//! Which kinds there are stands here three times: [`Profile`] declares them, `each!` tells them apart for what all
//! curves can do, and [`Profile::plan`] makes them of what is asked.

mod points;
mod staircase;
mod timed;
mod trapezoid;

use crate::{
    curves::{
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
    },
    moves::{CosineMethod, Move, TrapezoidMethod},
    planners::budget::Budget,
    planners::quantities::Quantities,
    timing::{CycleTime, IsDueBefore, MoveSteps, Runs, Schedule},
};
use alloc::{string::String, vec::Vec};

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

/// Does the same with the curve of any kind, compiled for each.
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
    pub(crate) fn plan(quantities: &mut Quantities<'_>, given: &Move, budget: &mut Budget) -> Option<Self> {
        match given {
            Move::Trapezoid(given) => quantities.at("trapezoid", |here| match given.method {
                TrapezoidMethod::Exact => trapezoid::exact(here, given).map(Self::Trapezoid),
                TrapezoidMethod::Table => trapezoid::table(here, given, budget).map(Self::TrapezoidTable),
            }),
            Move::Staircase(given) => {
                quantities.at("staircase", |here| staircase::plan(here, given, budget)).map(Self::Staircase)
            }
            Move::Cosine(given) => quantities.at("cosine", |here| match given.method {
                CosineMethod::Exact => timed::cosine(here, given).map(Self::Cosine),
                CosineMethod::Sliced => timed::sliced(here, given, budget).map(Self::Sliced),
            }),
            Move::Ramps(given) => quantities.at("ramps", |here| timed::ramps(here, given)).map(Self::Ramps),
            Move::SineSegments(given) => quantities
                .at("sine_segments", |here| SineSegments::plan(here, given, budget))
                .map(Self::SineSegments),
            Move::Sine(given) => quantities.at("sine", |here| Sine::plan(here, given)).map(Self::Sine),
            Move::JerkLimited(given) => {
                quantities.at("jerk_limited", |here| JerkLimited::plan(here, given)).map(Self::JerkLimited)
            }
            Move::Points(given) => {
                quantities.at("points", |here| points::plan(here, given)).map(Self::Points)
            }
            Move::Constant(given) => {
                quantities.at("constant", |here| Constant::plan(here, given)).map(Self::Constant)
            }
            Move::Dwell(given) => quantities.at("dwell", |here| Dwell::plan(here, given)).map(Self::Dwell),
        }
    }

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

impl Profile {
    /// The cycle of step `k` (from 1) after the move's start, of a clock of `clock_hz`; `None` past the last one. It iterates over
    /// the steps before it: for all steps in turn plan the axis.
    #[must_use]
    pub fn step_cycle(&self, k: u64, clock_hz: u32) -> Option<u64> {
        let steps = MoveSteps::new(self, CycleTime::default(), clock_hz);
        steps.after(k.checked_sub(1)?).map(|step| step.cycle)
    }

    pub(crate) fn ends_with_a_step(&self) -> bool {
        matches!(self, Self::TrapezoidTable(_) | Self::Staircase(_))
    }

    /// Whether that step is not due yet in that instant: of one to the left (B7).
    pub(crate) fn last_step_waits(&self) -> bool {
        self.ends_with_a_step() && self.steps() < 0
    }
}

impl Schedule for Profile {
    fn length(&self, clock_hz: u32) -> CycleTime {
        each!(self, curve => curve.length(clock_hz))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        each!(self, curve => curve.runs(clock_hz))
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        each!(self, curve => curve.is_due_before(clock_hz))
    }

    fn off_s(&self) -> f64 {
        each!(self, curve => curve.off_s())
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

    fn breakpoints_s(&self) -> Vec<f64> {
        each!(self, curve => curve.breakpoints_s())
    }

    fn time_s(&self, place: f64) -> f64 {
        each!(self, curve => curve.time_s(place))
    }

    fn detail(&self, limit_steps_s: f64) -> String {
        each!(self, curve => curve.detail(limit_steps_s))
    }
}
