//! When the steps of an axis fall due, one after another (DESIGN B1).
//!
//! ```text
//! cycle = floor(t*clock_hz + 1/2)     t where s(t) = k - 1/2, or the time that a table gives
//! ```
//!
//! A move's own times are formed in cycles from its start, those of a timer's table in whole
//! numbers; to them comes the start of the move, and the sum is rounded once.

use crate::{AxisPlan, Curve, Profile, profile::each, step_times::cycle};
use alloc::boxed::Box;

/// A step that is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScheduledStep {
    /// Its cycle, from the motion's start on.
    pub cycle: u64,
    /// Whether it goes to the right.
    pub right: bool,
}

/// Cycles from the start of a move, not rounded, and whether the step goes to the right.
type Due<'p> = Box<dyn Iterator<Item = (f64, bool)> + 'p>;

impl AxisPlan {
    /// Steps of all moves, whichever way they go.
    #[must_use]
    pub fn step_count(&self) -> u64 {
        self.moves().iter().fold(0, |sum: u64, planned| sum.saturating_add(planned.profile.step_count()))
    }

    /// All steps in the order of their times, in cycles of a clock of `clock_hz`.
    pub fn due_steps(&self, clock_hz: u32) -> impl Iterator<Item = ScheduledStep> + '_ {
        self.due_instants(clock_hz).map(|(_, due)| due)
    }

    /// All steps, each with its instant before B1 rounds it, in cycles of a clock of `clock_hz`.
    pub fn due_instants(&self, clock_hz: u32) -> impl Iterator<Item = (f64, ScheduledStep)> + '_ {
        self.moves().iter().flat_map(move |planned| {
            let start = planned.start_s * f64::from(clock_hz);
            due(&planned.profile, clock_hz).map(move |(cycles, right)| {
                let instant = start + cycles;
                (instant, ScheduledStep { cycle: cycle(instant), right })
            })
        })
    }
}

impl Profile {
    /// The cycle of step `k` (from 1) after the move's start, of a clock of `clock_hz`, without iterating
    /// over those before it; `None` past the last one, and for sine segments, whose steps are only known in their order.
    #[must_use]
    pub fn step_cycle(&self, k: u64, clock_hz: u32) -> Option<u64> {
        if k == 0 || k > self.step_count() {
            return None;
        }
        let (clock, place) = (f64::from(clock_hz), k as f64 - 0.5);
        let cycles = match self {
            Self::Trapezoid(curve) => return curve.step_times(clock_hz).nth(usize::try_from(k - 1).ok()?),
            Self::TrapezoidTable(table) => table.step_cycles(k, clock_hz),
            Self::Staircase(staircase) => staircase.step_s(k) * clock,
            Self::Sine(sine) => sine.due_half(k) * (sine.period_s() / 2.0 * clock),
            Self::Points(points) => points.step_s(k)? * clock,
            Self::Constant(constant) => place * (clock / libm::fabs(constant.speed(0.0))),
            Self::SineSegments(_) | Self::Dwell(_) => return None,
            one_way => one_way.time_s(place) * clock,
        };
        Some(cycle(cycles))
    }
}

/// A kind that does not stand here by itself goes one way, and its curve is asked for each step's time.
fn due(profile: &Profile, clock_hz: u32) -> Due<'_> {
    let clock = f64::from(clock_hz);
    let (right, steps) = (profile.steps() >= 0, 1..=profile.steps().unsigned_abs());
    // Where the curve crosses the half-integer of each step.
    let places = steps.clone().map(|k| k as f64 - 0.5);
    match profile {
        Profile::Trapezoid(curve) => {
            let mut times = curve.step_times(clock_hz);
            Box::new(core::iter::from_fn(move || times.next_unrounded().map(|cycles| (cycles, right))))
        }
        Profile::TrapezoidTable(table) => {
            Box::new(steps.map(move |k| (table.step_cycles(k, clock_hz), right)))
        }
        Profile::Staircase(staircase) => Box::new(steps.map(move |k| (staircase.step_s(k) * clock, right))),
        Profile::SineSegments(sine) => {
            let cycles_per_point = sine.point_s() * clock;
            Box::new(sine.due_points().map(move |(point, right)| (point * cycles_per_point, right)))
        }
        Profile::Sine(sine) => {
            let cycles_per_half = sine.period_s() / 2.0 * clock;
            Box::new(sine.due_halves().map(move |(half, right)| (half * cycles_per_half, right)))
        }
        Profile::Points(points) => Box::new(points.due_s().map(move |(t, right)| (t * clock, right))),
        Profile::Constant(constant) => {
            let cycles_per_step = clock / libm::fabs(constant.speed(0.0));
            Box::new(places.map(move |place| (place * cycles_per_step, right)))
        }
        Profile::Dwell(_) => Box::new(core::iter::empty()),
        one_way => each!(one_way, curve => {
            Box::new(places.map(move |place| (curve.time_s(place) * clock, right)))
        }),
    }
}
