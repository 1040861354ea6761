//! The curve of a move of any kind. [`Profile`], [`Profile::schedule`] and [`Profile::plan`] list the kinds.

mod constant;
mod jerk_limited;
mod periodic;
mod points;
mod staircase;
mod timed;
mod trapezoid;

use crate::curves::constant_velocity::{ConstantVelocity, Dwell};
use crate::curves::{
    cosine::Cosine, curve::Curve, jerk_limited::JerkLimited, oscillation::Oscillation, points::Points,
    ramps::Ramps, sine::Sine, sine_segments::SineSegments, sliced::Sliced, staircase::Staircase,
    trapezoid::Trapezoid, trapezoid_table::TrapezoidTable,
};
use crate::moves::{CosineMethod, Move, TrapezoidMethod};
use crate::timing::{CycleTime, MoveSteps, Schedule};
use crate::{planners::budget::Budget, planners::quantities::Quantities};
use core::ops::Deref;

/// The curve of a planned move, by its kind and method.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile {
    Trapezoid(Trapezoid),
    TrapezoidTable(TrapezoidTable),
    Staircase(Staircase),
    Cosine(Cosine),
    Sliced(Sliced),
    Ramps(Ramps),
    SineSegments(SineSegments),
    Sine(Sine),
    JerkLimited(JerkLimited),
    Points(Points),
    Constant(ConstantVelocity),
    Dwell(Dwell),
}

impl Profile {
    pub(crate) fn schedule(&self) -> &(dyn Schedule + 'static) {
        match self {
            Self::Trapezoid(curve) => curve,
            Self::TrapezoidTable(curve) => curve,
            Self::Staircase(curve) => curve,
            Self::Cosine(curve) => curve,
            Self::Sliced(curve) => curve,
            Self::Ramps(curve) => curve,
            Self::SineSegments(curve) => curve,
            Self::Sine(curve) => curve,
            Self::JerkLimited(curve) => curve,
            Self::Points(curve) => curve,
            Self::Constant(curve) => curve,
            Self::Dwell(curve) => curve,
        }
    }

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
                .at("sine_segments", |here| periodic::segments(here, given, budget))
                .map(Self::SineSegments),
            Move::Sine(given) => quantities.at("sine", |here| periodic::sine(here, given)).map(Self::Sine),
            Move::JerkLimited(given) => {
                quantities.at("jerk_limited", |here| jerk_limited::plan(here, given)).map(Self::JerkLimited)
            }
            Move::Points(given) => {
                quantities.at("points", |here| points::plan(here, given)).map(Self::Points)
            }
            Move::Constant(given) => {
                quantities.at("constant", |here| constant::constant(here, given)).map(Self::Constant)
            }
            Move::Dwell(given) => {
                quantities.at("dwell", |here| constant::dwell(here, given)).map(Self::Dwell)
            }
        }
    }

    /// Period in s and number of periods of an oscillation; `None` for other moves.
    pub fn repeats(&self) -> Option<(f64, u32)> {
        self.oscillation().map(|oscillation| (oscillation.period_s, oscillation.periods))
    }

    pub fn step_count(&self) -> u64 {
        match (self, self.oscillation()) {
            (_, Some(oscillation)) => oscillation.step_count(),
            (Self::Points(points), _) => points.step_count(),
            (one_way, _) => one_way.steps().unsigned_abs(),
        }
    }

    pub(crate) fn oscillation(&self) -> Option<&Oscillation> {
        match self {
            Self::Sine(Sine { oscillation }) | Self::SineSegments(SineSegments { oscillation, .. }) => {
                Some(oscillation)
            }
            _ => None,
        }
    }

    /// The cycle of step `k` (from 1) after the move's start, at `clock_hz`; `None` after the last step.
    pub fn step_cycle(&self, k: u64, clock_hz: u32) -> Option<u64> {
        let steps = MoveSteps::new(self.schedule(), CycleTime::default(), clock_hz);
        steps.step_after(k.checked_sub(1)?).map(|step| step.cycle)
    }

    pub(crate) fn ends_with_a_step(&self) -> bool {
        matches!(self, Self::TrapezoidTable(_) | Self::Staircase(_))
    }

    /// Whether the last step is not due yet at the end of the move, because it goes to the left (B7).
    pub(crate) fn last_step_is_after_end(&self) -> bool {
        self.ends_with_a_step() && self.steps() < 0
    }
}

impl Deref for Profile {
    type Target = dyn Curve;

    fn deref(&self) -> &Self::Target {
        self.schedule()
    }
}
