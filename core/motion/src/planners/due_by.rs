//! Number of steps due by a cycle (DESIGN B7).
//!
//! ```text
//!  position |     .--'      R(s) = floor(s + 1/2) at the cycle E. If s in f64 is within its error of a half, step k there
//!  k-1/2    |--[-x-]--      decides (`rounding`): is it due before E? At E itself a step to the right is due, one to the
//!           +-----E---      left not yet. So ticks and segments of a motion always agree.
//! ```

use crate::curves::numeric::{Numeric, Shape};
use crate::curves::{
    oscillation::Oscillation, sine::Sine, sine_segments::SineSegments, stepped::PAST_THE_STEP,
    trapezoid_table::TrapezoidTable,
};
use crate::timing::{CycleTime, F106, IsDueBefore, MAX_ERROR, due_near, tie};
use crate::{AxisPlan, Curve, PlannedMove, Profile};

/// Counts the steps of an axis that are due by one cycle after another.
///
/// ```
/// use stepscope_motion::{moves::Axis, plan_axis};
///
/// let plan = plan_axis(&Axis::default(), "x").expect("a valid axis");
/// let mut due = plan.due_by(16_000_000);
/// assert_eq!((due.steps(0), due.steps(u64::MAX)), (0, plan.steps()));
/// ```
pub struct DueBy<'p> {
    clock_hz: u32,
    moves: &'p [PlannedMove],
    current: Option<CurrentMove<'p>>,
    total_steps: i64,
}

struct CurrentMove<'p> {
    planned: &'p PlannedMove,
    start: CycleTime,
    end: CycleTime,
    max_error: f64,
    is_due_before: IsDueBefore<'p>,
    /// Steps of the move due by the previous cycle, where the next search begins.
    due: i64,
}

impl AxisPlan {
    /// Returns a counter of the steps due by cycles at `clock_hz`.
    pub fn due_by(&self, clock_hz: u32) -> DueBy<'_> {
        let (clock_hz, moves) = (clock_hz.max(1), self.moves());
        let current = moves.first().map(|planned| CurrentMove::new(planned, CycleTime::default(), clock_hz));
        DueBy { clock_hz, moves, current, total_steps: self.steps() }
    }

    /// Minimum number of spans of `cycles`, at least one, until all moves have ended and all steps are due.
    pub(crate) fn spans(&self, cycles: u64, clock_hz: u32) -> u64 {
        let cycles = cycles.max(1);
        let end = self.moves().iter().fold(CycleTime::default(), |end, planned| {
            end.plus(planned.profile.schedule().duration(clock_hz.max(1)))
        });
        let mut spans = (end.whole / cycles).max(1);
        // One more if the end is within a span, or if the last step is due in the cycle after the span.
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
    /// Steps due by `cycle`, which must not be less than in the previous call.
    pub fn steps(&mut self, cycle: u64) -> i64 {
        while let Some(current) = &mut self.current {
            let end = current.end;
            if !end.is_by(cycle) {
                // A move starts at a whole step, so only its own part is rounded.
                return current.steps(cycle, self.clock_hz);
            }
            let PlannedMove { profile, start_steps, .. } = current.planned;
            if profile.last_step_is_after_end() && end.is_at(cycle) {
                return start_steps + profile.steps() + 1;
            }
            self.moves = self.moves.get(1..).unwrap_or_default();
            self.current = self.moves.first().map(|planned| CurrentMove::new(planned, end, self.clock_hz));
        }
        self.total_steps
    }
}

impl Profile {
    /// Maximum error of a position in f64: the error of the time at maximum speed, and the same number of roundings of the
    /// travel.
    fn max_position_error(&self) -> f64 {
        let (max_distance, factor) = match (self, self.oscillation()) {
            (Self::Cut(cut), _) => return cut.base().max_position_error(),
            (Self::Stretched(stretched), _) => return 2.0 * stretched.base().max_position_error(),
            (Self::Phases(curve), _) => (curve.max_distance(), 1.0),
            (Self::Shaped(curve), _) => (curve.max_distance(), 1.0),
            (_, Some(oscillation)) => (2.0 * oscillation.amplitude as f64, 1.0),
            (Self::Points(points), _) => (points.max_distance(), points.max_error_factor()),
            (one_way, _) => (one_way.steps().unsigned_abs() as f64, 1.0),
        };
        // The curve of a staircase has this distance from a half before and after a step.
        let distance = if matches!(self, Self::Staircase(_)) { 2.0 * PAST_THE_STEP } else { 0.0 };
        // Both the time and the curve's formula have this error.
        let error_s = self.schedule().max_error_s() + MAX_ERROR * self.duration_s();
        (self.peaks().speed * error_s + MAX_ERROR * max_distance) * factor + distance
    }
}

#[derive(Clone, Copy)]
struct Elapsed {
    cycle: u64,
    start: CycleTime,
    clock_hz: u32,
    /// Time of the curve per time, not 1 only for a stretched move.
    factor: F106,
}

impl Elapsed {
    /// In s, with the error of an f64.
    fn since_f64(self) -> f64 {
        let cycles = self.cycle.wrapping_sub(self.start.whole) as i64 as f64;
        (cycles - self.start.part.high) / f64::from(self.clock_hz) * self.factor.high
    }

    /// In cycles, in 106 bits; a tie later for a step to the right, which is due at the cycle itself, and a tie earlier for
    /// one to the left.
    fn since_exact(self, right: bool) -> F106 {
        let since = F106::from(self.cycle.wrapping_sub(self.start.whole)) - self.start.part;
        let tie = tie(self.cycle);
        if right { since + tie } else { since - tie }
    }
}

impl<'p> CurrentMove<'p> {
    fn new(planned: &'p PlannedMove, start: CycleTime, clock_hz: u32) -> Self {
        let schedule = planned.profile.schedule();
        Self {
            planned,
            start,
            end: start.plus(schedule.duration(clock_hz)),
            max_error: planned.profile.max_position_error(),
            is_due_before: schedule.is_due_before(clock_hz),
            due: 0,
        }
    }

    fn steps(&mut self, cycle: u64, clock_hz: u32) -> i64 {
        let elapsed = Elapsed { cycle, start: self.start, clock_hz, factor: 1.0.into() };
        self.due = self.due_of(&self.planned.profile, elapsed);
        self.planned.start_steps.saturating_add(self.due)
    }

    fn due_of(&self, profile: &Profile, elapsed: Elapsed) -> i64 {
        let clock_hz = elapsed.clock_hz;
        match profile {
            Profile::Cut(cut) => self.due_of(cut.base(), elapsed),
            Profile::Stretched(stretched) => {
                self.due_of(stretched.base(), Elapsed { factor: stretched.factor(), ..elapsed })
            }
            Profile::Phases(curve) => self.numeric_due(curve, elapsed),
            Profile::SpeedRamps(curve) => self.numeric_due(curve, elapsed),
            Profile::Shaped(curve) => self.numeric_due(curve, elapsed),
            Profile::TrapezoidTable(table) => self.table_due(table, elapsed),
            Profile::Points(points) => points.due_by(elapsed.since_f64(), self.max_error, |right| {
                elapsed.since_exact(right) / f64::from(clock_hz) * elapsed.factor
            }),
            Profile::Sine(Sine { oscillation }) | Profile::SineSegments(SineSegments { oscillation, .. }) => {
                self.oscillation_due(oscillation, profile, elapsed)
            }
            one_way => self.one_way_due(one_way, elapsed),
        }
    }

    fn numeric_due<S: Shape>(&self, curve: &Numeric<S>, elapsed: Elapsed) -> i64 {
        curve.due_by(elapsed.since_f64(), self.max_error, |k, right| self.is_due(k, right, elapsed))
    }

    fn is_due(&self, k: u64, right: bool, elapsed: Elapsed) -> bool {
        (self.is_due_before)(k, elapsed.since_exact(right))
    }

    /// A table has exact times instead of an exact position, so the times of the two nearest steps are compared.
    fn table_due(&self, table: &TrapezoidTable, elapsed: Elapsed) -> i64 {
        let (count, right, t) = (table.steps().unsigned_abs(), table.steps() >= 0, elapsed.since_f64());
        let is_near = |k: u64| {
            (1..=count).contains(&k) && libm::fabs(table.step_s(k) - t) <= MAX_ERROR * table.duration_s()
        };
        let mut due = table.steps_due(t, self.due).unsigned_abs();
        if is_near(due + 1) {
            due += u64::from(self.is_due(due + 1, right, elapsed));
        } else if is_near(due) {
            due -= u64::from(!self.is_due(due, right, elapsed));
        }
        signed(due, right)
    }

    /// An oscillation reverses after each half period, so its steps are counted from the last extreme.
    fn oscillation_due(&self, oscillation: &Oscillation, profile: &Profile, elapsed: Elapsed) -> i64 {
        let t = elapsed.since_f64();
        let steps_per_half = 2 * oscillation.amplitude;
        let half = (2.0 * t / oscillation.period_s) as u64;
        let (returns, right) = (half % 2 == 1, oscillation.goes_right(half));
        let from_start = libm::fabs(profile.position(t));
        let from_extreme = if returns { steps_per_half as f64 - from_start } else { from_start };
        let due = due_near(from_extreme, steps_per_half, self.max_error, |k| {
            self.is_due(half * steps_per_half + k, right, elapsed)
        });
        signed(if returns { steps_per_half - due } else { due }, !oscillation.starts_right)
    }

    fn one_way_due(&self, profile: &Profile, elapsed: Elapsed) -> i64 {
        let (count, right) = (profile.steps().unsigned_abs(), profile.steps() >= 0);
        let mut travel = libm::fabs(profile.position(elapsed.since_f64()));
        // The move has not ended, so a step at its end is not due.
        let last = count as f64 - 0.5;
        if profile.ends_with_a_step() && travel > last {
            travel = last;
        }
        signed(due_near(travel, count, self.max_error, |k| self.is_due(k, right, elapsed)), right)
    }
}

fn signed(steps: u64, right: bool) -> i64 {
    if right { steps as i64 } else { -(steps as i64) }
}
