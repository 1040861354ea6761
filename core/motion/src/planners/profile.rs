//! The curve of a move of any kind. [`Profile`], [`Profile::schedule`] and [`Profile::plan`] list the kinds.

mod constant;
mod jerk_limited;
mod periodic;
mod points;
mod staircase;
mod timed;
mod trapezoid;

use crate::Peaks;
use crate::curves::constant_velocity::{ConstantVelocity, Dwell};
use crate::curves::{
    cosine::Cosine, curve::Curve, cut::Cut, jerk_limited::JerkLimited, move_curve::MoveCurve,
    numeric::Numeric, oscillation::Oscillation, phases::Phases, phases::State, points::Points, ramps::Ramps,
    shaped::Shaped, sine::Sine, sine_segments::SineSegments, sliced::Sliced, speed_ramps::SpeedRamps,
    staircase::Staircase, stretched::Stretched, trapezoid::Trapezoid, trapezoid_table::TrapezoidTable,
};
use crate::moves::{CosineMethod, Move, TrapezoidMethod};
use crate::planners::{budget::Budget, quantities::Quantities, start::Start};
use crate::round_half_up;
use crate::timing::{CycleTime, IsDueBefore, MoveSteps, Runs, Schedule};
use alloc::{boxed::Box, string::String, vec::Vec};
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
    /// Between two speeds within limits, to a new target, or through waypoints.
    Phases(Numeric<Phases>),
    /// Between two speeds in a given time.
    SpeedRamps(Numeric<SpeedRamps>),
    /// The first part of a move that a new target replaces.
    Cut(Box<Cut<Profile>>),
    /// A move that is slower because of its group.
    Stretched(Box<Stretched<Profile>>),
    /// All moves of an axis with an input shaper.
    Shaped(Box<Numeric<Shaped<Profile>>>),
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
            Self::Phases(curve) => curve,
            Self::SpeedRamps(curve) => curve,
            Self::Cut(curve) => &**curve,
            Self::Stretched(curve) => &**curve,
            Self::Shaped(curve) => &**curve,
        }
    }

    /// Plans a move that begins at `start`; a `retarget` is planned with the move that it cuts.
    pub(crate) fn plan(
        quantities: &mut Quantities<'_>,
        given: &Move,
        start: Start,
        budget: &mut Budget,
    ) -> Option<Self> {
        match given {
            Move::Trapezoid(given) => quantities.at("trapezoid", |here| match given.method {
                TrapezoidMethod::Exact => trapezoid::exact(here, given, start)
                    .map(|planned| planned.map(Self::Trapezoid, Self::Phases)),
                TrapezoidMethod::Table => {
                    trapezoid::table(here, given, start, budget).map(Self::TrapezoidTable)
                }
            }),
            Move::Staircase(given) => {
                quantities.at("staircase", |here| staircase::plan(here, given, budget)).map(Self::Staircase)
            }
            Move::Cosine(given) => quantities.at("cosine", |here| match given.method {
                CosineMethod::Exact => timed::cosine(here, given, start)
                    .map(|planned| planned.map(Self::Cosine, Self::SpeedRamps)),
                CosineMethod::Sliced => timed::sliced(here, given, start, budget).map(Self::Sliced),
            }),
            Move::Ramps(given) => quantities.at("ramps", |here| {
                timed::ramps(here, given, start).map(|planned| planned.map(Self::Ramps, Self::SpeedRamps))
            }),
            Move::SineSegments(given) => quantities
                .at("sine_segments", |here| periodic::segments(here, given, budget))
                .map(Self::SineSegments),
            Move::Sine(given) => quantities.at("sine", |here| periodic::sine(here, given)).map(Self::Sine),
            Move::JerkLimited(given) => quantities.at("jerk_limited", |here| {
                jerk_limited::plan(here, given, start)
                    .map(|planned| planned.map(Self::JerkLimited, Self::Phases))
            }),
            Move::Points(given) => {
                quantities.at("points", |here| points::plan(here, given)).map(Self::Points)
            }
            Move::Constant(given) => quantities.at("constant", |here| {
                constant::constant(here, given, start)
                    .map(|planned| planned.map(Self::Constant, Self::Phases))
            }),
            Move::Dwell(given) => {
                quantities.at("dwell", |here| constant::dwell(here, given)).map(Self::Dwell)
            }
            Move::Retarget(_) => None,
        }
    }

    /// Period in s and number of periods of an oscillation; `None` for other moves.
    pub fn repeats(&self) -> Option<(f64, u32)> {
        match self {
            Self::Cut(cut) => cut.repeats(),
            Self::Stretched(stretched) => stretched.repeats(),
            profile => profile.oscillation().map(|oscillation| (oscillation.period_s, oscillation.periods)),
        }
    }

    pub fn step_count(&self) -> u64 {
        match (self, self.oscillation()) {
            (_, Some(oscillation)) => oscillation.step_count(),
            (Self::Points(points), _) => points.step_count(),
            (Self::Phases(curve), _) => curve.step_count(),
            (Self::Shaped(curve), _) => curve.step_count(),
            (Self::Cut(cut), _) => cut.step_count(),
            (Self::Stretched(stretched), _) => stretched.base().step_count(),
            (one_way, _) => one_way.steps().unsigned_abs(),
        }
    }

    /// The exact position at the end minus the whole one.
    pub(crate) fn end_offset(&self) -> f64 {
        match self {
            Self::Phases(curve) => curve.end_offset(),
            Self::Shaped(curve) => curve.end_offset(),
            Self::Cut(cut) => cut.end().position - cut.steps() as f64,
            _ => 0.0,
        }
    }

    /// Whether such a move can begin between two steps.
    pub(crate) fn starts_between_steps(&self) -> bool {
        !self.follows_table() && !matches!(self, Self::Points(_) | Self::Sine(_))
    }

    /// Whether it follows a table instead of a curve, and so cannot be cut, grouped or shaped.
    pub(crate) fn follows_table(&self) -> bool {
        matches!(self, Self::TrapezoidTable(_) | Self::Staircase(_) | Self::Sliced(_) | Self::SineSegments(_))
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

/// Relative distance before a jump at which the value before it is read.
const JUST_BEFORE: f64 = 1e-12;
/// Smaller relative changes within that distance are no jumps.
const MIN_JUMP: f64 = 1e-6;
/// Relative distance from a change at which its formula is read.
const INSIDE: f64 = 1e-9;

/// The value before a jump; without a jump the more exact one.
fn before_jump(at: f64, before: f64) -> f64 {
    let is_jump = libm::fabs(at - before) > MIN_JUMP * (libm::fabs(at) + libm::fabs(before));
    if is_jump { before } else { at }
}

impl MoveCurve for Profile {
    fn repeats(&self) -> Option<(f64, u32)> {
        Self::repeats(self)
    }

    fn due_within(&self, t: f64) -> (i64, u64) {
        match (self, self.oscillation()) {
            (Self::Phases(curve), _) => curve.due_within(t),
            (Self::Shaped(curve), _) => curve.due_within(t),
            (Self::Points(points), _) => points.due_within(t),
            (_, Some(oscillation)) => oscillation.due_within(libm::fabs(self.position(t)), t),
            (Self::SpeedRamps(curve), _) => curve.due_within(t),
            (one_way, _) => {
                let count = round_half_up(libm::fabs(one_way.position(t))).unsigned_abs();
                let count = count.min(one_way.step_count());
                (if one_way.steps() < 0 { -(count as i64) } else { count as i64 }, count)
            }
        }
    }

    fn state(&self, t: f64, within_s: f64) -> State {
        match self {
            Self::Phases(curve) => curve.state(t, within_s),
            Self::SpeedRamps(curve) => curve.state(t, within_s),
            Self::Shaped(curve) => curve.state(t, within_s),
            Self::Stretched(stretched) => stretched.state(t, within_s),
            Self::Cut(cut) => cut.base().state(t, within_s),
            profile => {
                let inside_s = t + (within_s - t) * INSIDE;
                State {
                    position: profile.position(t),
                    speed: profile.speed(inside_s),
                    acceleration: profile.acceleration(inside_s),
                }
            }
        }
    }

    fn state_before(&self, t: f64) -> State {
        match self {
            Self::Phases(curve) => curve.state_before(t),
            Self::SpeedRamps(curve) => curve.state_before(t),
            profile => {
                let before_s = t - JUST_BEFORE * profile.duration_s();
                State {
                    position: profile.position(t),
                    speed: before_jump(profile.speed(t), profile.speed(before_s)),
                    acceleration: before_jump(profile.acceleration(t), profile.acceleration(before_s)),
                }
            }
        }
    }

    fn changes_s(&self) -> Vec<f64> {
        match self {
            Self::Phases(curve) => curve.interval_ends_s(),
            Self::SpeedRamps(curve) => curve.interval_ends_s(),
            profile => profile.breakpoints_s(),
        }
    }
}

/// So that curves can consist of profiles.
impl Schedule for Profile {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        self.schedule().duration(clock_hz)
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        self.schedule().runs(clock_hz)
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        self.schedule().is_due_before(clock_hz)
    }

    fn max_error_s(&self) -> f64 {
        self.schedule().max_error_s()
    }
}

impl Curve for Profile {
    fn duration_s(&self) -> f64 {
        self.schedule().duration_s()
    }

    fn steps(&self) -> i64 {
        self.schedule().steps()
    }

    fn position(&self, t: f64) -> f64 {
        self.schedule().position(t)
    }

    fn speed(&self, t: f64) -> f64 {
        self.schedule().speed(t)
    }

    fn acceleration(&self, t: f64) -> f64 {
        self.schedule().acceleration(t)
    }

    fn peaks(&self) -> Peaks {
        self.schedule().peaks()
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        self.schedule().breakpoints_s()
    }

    fn time_s(&self, position: f64) -> f64 {
        self.schedule().time_s(position)
    }

    fn detail(&self, limit_steps_s: f64) -> String {
        self.schedule().detail(limit_steps_s)
    }
}

impl Deref for Profile {
    type Target = dyn Curve;

    fn deref(&self) -> &Self::Target {
        self.schedule()
    }
}
