//! Number of steps due by a cycle (DESIGN B7).
//!
//! ```text
//!  position |     .--'      R(s) = floor(s + 1/2) at the cycle E. If s in f64 is within its error of a half, step k there
//!  k-1/2    |--[-x-]--      decides (`rounding`): is it due before E? At E itself a step to the right is due, one to the
//!           +-----E---      left not yet. So ticks and segments of a motion always agree.
//! ```

use crate::{
    AxisPlan, PlannedMove, Profile,
    curves::{sine::Sine, sine_segments::SineSegments, stepped::PAST_THE_STEP},
    timing::{CycleTime, Double, IsDueBefore, MAX_ERROR, tie},
};

/// Steps of an axis due by one cycle after another.
///
/// ```
/// use stepscope_motion::{moves::Axis, plan_axis};
///
/// let plan = plan_axis(&Axis::default(), "x").expect("it holds");
/// let mut due = plan.due_by(16_000_000);
/// assert_eq!((due.steps(0), due.steps(u64::MAX)), (0, plan.steps()));
/// ```
pub struct DueBy<'p> {
    clock_hz: u32,
    moves: &'p [PlannedMove],
    current: Option<Current<'p>>,
    end: CycleTime,
    steps: i64,
}

struct Current<'p> {
    planned: &'p PlannedMove,
    start: CycleTime,
    max_error: f64,
    is_due_before: IsDueBefore<'p>,
    due: i64,
}

impl AxisPlan {
    /// Returns how many steps are due by cycles at `clock_hz`.
    #[must_use]
    pub fn due_by(&self, clock_hz: u32) -> DueBy<'_> {
        let clock_hz = clock_hz.max(1);
        let (start, moves) = (CycleTime::default(), self.moves());
        let current = moves.first().map(|planned| Current::new(planned, start, clock_hz));
        let end = moves.first().map_or(start, |planned| planned.profile.schedule().length(clock_hz));
        DueBy { clock_hz, moves, current, end, steps: self.steps() }
    }

    /// Minimum number of whole spans of `cycles`, at least one, until all moves have ended and all steps are due.
    pub(crate) fn spans(&self, cycles: u64, clock_hz: u32) -> u64 {
        let length = |end: CycleTime, planned: &PlannedMove| {
            end.plus(planned.profile.schedule().length(clock_hz.max(1)))
        };
        let cycles = cycles.max(1);
        let end = self.moves().iter().fold(CycleTime::default(), length);
        let mut spans = (end.whole / cycles).max(1);
        // One more for a rest, and for a last step at the very end of the span, which belongs to the next.
        while !end.is_by(spans.saturating_mul(cycles))
            || self.due_by(clock_hz).steps(spans.saturating_mul(cycles)) != self.steps()
        {
            if spans.saturating_mul(cycles) == u64::MAX {
                break;
            }
            spans += 1;
        }
        spans
    }
}

impl DueBy<'_> {
    /// Steps due by a cycle. Cycles must not fall from one call to the next.
    ///
    /// A move starts at a whole step, so only its own part is rounded.
    pub fn steps(&mut self, cycle: u64) -> i64 {
        while self.end.is_by(cycle) {
            let Some(Current { planned: PlannedMove { profile, start_steps, .. }, .. }) = &self.current
            else {
                break;
            };
            if profile.last_step_waits() && self.end.is_at(cycle) {
                return start_steps + profile.steps() + 1;
            }
            self.moves = self.moves.get(1..).unwrap_or_default();
            self.current = self.moves.first().map(|planned| Current::new(planned, self.end, self.clock_hz));
            let length = self.moves.first().map(|planned| planned.profile.schedule().length(self.clock_hz));
            self.end = self.end.plus(length.unwrap_or_default());
        }
        match &mut self.current {
            Some(current) => current.steps(cycle, self.clock_hz),
            None => self.steps,
        }
    }
}

impl Profile {
    /// Maximum error of a position in f64: the error of the time at maximum speed, and as many roundings of the travel.
    fn max_position_error(&self) -> f64 {
        let (reach, factor) = match (self, self.oscillation()) {
            (_, Some(oscillation)) => (2.0 * oscillation.amplitude as f64, 1.0),
            (Self::Points(points), _) => (points.reach(), points.max_error_factor()),
            (one_way, _) => (one_way.steps().unsigned_abs() as f64, 1.0),
        };
        // The curve of a staircase keeps this distance from a half before and after a step.
        let distance = if matches!(self, Self::Staircase(_)) { 2.0 * PAST_THE_STEP } else { 0.0 };
        // Both the time and the curve's formula have this error.
        let error_s = self.schedule().max_error_s() + MAX_ERROR * self.duration_s();
        (self.peaks().speed * error_s + MAX_ERROR * reach) * factor + distance
    }
}

impl<'p> Current<'p> {
    fn new(planned: &'p PlannedMove, start: CycleTime, clock_hz: u32) -> Self {
        let profile = &planned.profile;
        Self {
            planned,
            start,
            max_error: profile.max_position_error(),
            is_due_before: profile.schedule().is_due_before(clock_hz),
            due: 0,
        }
    }

    fn steps(&mut self, cycle: u64, clock_hz: u32) -> i64 {
        let clock = f64::from(clock_hz);
        let since = cycle.wrapping_sub(self.start.whole) as i64 as f64;
        let t = (since - self.start.part.high) / clock;
        // At the cycle itself a step to the right is due, one to the left only after it.
        let since = |right: bool| {
            let since = Double::from(cycle.wrapping_sub(self.start.whole)) - self.start.part;
            let tie = tie(cycle);
            if right { since + tie } else { since - tie }
        };
        let is_due = |k: u64, right: bool| (self.is_due_before)(k, since(right));
        let profile = &self.planned.profile;
        let (count, right) = (profile.steps().unsigned_abs(), profile.steps() >= 0);
        let due = match profile {
            Profile::TrapezoidTable(table) => {
                let fallen = table.steps_due(t, self.due).unsigned_abs();
                let is_near = |k: u64| {
                    (1..=count).contains(&k)
                        && libm::fabs(table.step_s(k) - t) <= MAX_ERROR * profile.duration_s()
                };
                let fallen = match (is_near(fallen), is_near(fallen + 1)) {
                    (_, true) => fallen + u64::from(is_due(fallen + 1, right)),
                    (true, _) => fallen - u64::from(!is_due(fallen, right)),
                    _ => fallen,
                };
                if right { fallen as i64 } else { -(fallen as i64) }
            }
            Profile::Points(points) => points.due_by(t, self.max_error, |right| since(right) / clock),
            Profile::Sine(Sine { oscillation }) | Profile::SineSegments(SineSegments { oscillation, .. }) => {
                let travel = 2 * oscillation.amplitude;
                let half = (2.0 * t / oscillation.period_s) as u64;
                let from_start = libm::fabs(profile.position(t));
                let (back, right) = (half % 2 == 1, oscillation.goes_right(half));
                let travelled = if back { travel as f64 - from_start } else { from_start };
                let due = due_near(travelled, travel, self.max_error, |k| is_due(half * travel + k, right));
                let from_start = if back { travel - due } else { due } as i64;
                if oscillation.starts_right { -from_start } else { from_start }
            }
            one_way => {
                let travelled = libm::fabs(one_way.position(t));
                // The move has not ended, so its last step is not due.
                let last = count as f64 - 0.5;
                let travelled = if one_way.ends_with_a_step() && travelled > last { last } else { travelled };
                let due = due_near(travelled, count, self.max_error, |k| is_due(k, right));
                if right { due as i64 } else { -(due as i64) }
            }
        };
        self.due = due;
        self.planned.start_steps.saturating_add(due)
    }
}

/// How many of `count` steps, step k at k - 1/2, are due at a position in f64.
fn due_near(position: f64, count: u64, max_error: f64, is_due: impl Fn(u64) -> bool) -> u64 {
    let past = position + 0.5;
    let k = (past + 0.5) as u64;
    if libm::fabs(past - k as f64) > max_error || k == 0 || k > count {
        return (past as u64).min(count);
    }
    k - u64::from(!is_due(k))
}
