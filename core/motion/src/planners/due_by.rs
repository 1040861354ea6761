//! How many steps are due by a cycle (DESIGN B7).
//!
//! ```text
//!  position |     .--'      R(s) = floor(s + 1/2) at the cycle E. Where s in f64 is within its error of a half, the step
//!  k-1/2    |--[-x-]--      k there decides (`rounding`): is it due before E? At E itself a step to the right is due,
//!           +-----E---      one to the left is not yet. So ticks and segments of a motion always agree.
//! ```

use crate::{
    AxisPlan, Curve, PlannedMove, Profile,
    curves::{sine::Sine, sine_segments::SineSegments, stepped::PAST_THE_STEP},
    timing::{CycleTime, Double, IsDueBefore, MAX_OFF, Schedule, tie},
};

/// The steps of an axis that are due by one cycle after another.
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
    /// From the move of now on.
    moves: &'p [PlannedMove],
    now: Option<Now<'p>>,
    /// When the move of now ends.
    end: CycleTime,
    /// Where the last move ends.
    steps: i64,
}

struct Now<'p> {
    planned: &'p PlannedMove,
    start: CycleTime,
    /// How far a place in f64 may be off.
    off: f64,
    is_due_before: IsDueBefore<'p>,
    /// Steps of the move that were due before.
    due: i64,
}

impl AxisPlan {
    /// Tells how many steps are due by a cycle of a clock of `clock_hz`.
    #[must_use]
    pub fn due_by(&self, clock_hz: u32) -> DueBy<'_> {
        let clock_hz = clock_hz.max(1);
        let (start, moves) = (CycleTime::default(), self.moves());
        let now = moves.first().map(|planned| Now::new(planned, start, clock_hz));
        let end = moves.first().map_or(start, |planned| planned.profile.length(clock_hz));
        DueBy { clock_hz, moves, now, end, steps: self.steps() }
    }

    /// The fewest whole spans of so many cycles, at least one, by whose end all moves have ended and all steps are due.
    pub(crate) fn spans(&self, cycles: u64, clock_hz: u32) -> u64 {
        let length =
            |end: CycleTime, planned: &PlannedMove| end.plus(planned.profile.length(clock_hz.max(1)));
        let end = self.moves().iter().fold(CycleTime::default(), length);
        let mut spans = (end.whole / cycles.max(1)).max(1);
        // One more where there is a rest, and where the last step is due in the very instant in which the span ends, and
        // goes into the next.
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
    /// Steps due by a cycle: B1's rounding of the position there (B7). Cycles do not fall from one call to the next.
    ///
    /// A move starts at a whole step, so only its own part is rounded.
    pub fn steps(&mut self, cycle: u64) -> i64 {
        while self.end.is_by(cycle) {
            let Some(Now { planned: PlannedMove { profile, start_steps, .. }, .. }) = &self.now else {
                break;
            };
            if profile.last_step_waits() && self.end.is_at(cycle) {
                return start_steps + profile.steps() + 1;
            }
            self.moves = self.moves.get(1..).unwrap_or_default();
            self.now = self.moves.first().map(|planned| Now::new(planned, self.end, self.clock_hz));
            let length = self.moves.first().map(|planned| planned.profile.length(self.clock_hz));
            self.end = self.end.plus(length.unwrap_or_default());
        }
        match &mut self.now {
            Some(now) => now.steps(cycle, self.clock_hz),
            None => self.steps,
        }
    }
}

impl Profile {
    /// How far a position in f64 may be off from the curve's at a time: what the digits of the time make at the highest
    /// speed, and as many roundings of the way itself.
    fn place_off(&self) -> f64 {
        let (reach, times) = match self {
            Self::Sine(Sine { oscillation }) | Self::SineSegments(SineSegments { oscillation, .. }) => {
                (2.0 * oscillation.amplitude as f64, 1.0)
            }
            Self::Points(points) => (points.reach(), points.most_times()),
            one_way => (one_way.steps().unsigned_abs() as f64, 1.0),
        };
        // The curve of a staircase keeps that far from the place of a step, before it and after it.
        let beside = if matches!(self, Self::Staircase(_)) { 2.0 * PAST_THE_STEP } else { 0.0 };
        // Both the time's own digits and those of the curve's formula.
        let off_s = self.off_s() + MAX_OFF * self.duration_s();
        (self.peaks().speed * off_s + MAX_OFF * reach) * times + beside
    }
}

impl<'p> Now<'p> {
    fn new(planned: &'p PlannedMove, start: CycleTime, clock_hz: u32) -> Self {
        let profile = &planned.profile;
        Self {
            planned,
            start,
            off: profile.place_off(),
            is_due_before: profile.is_due_before(clock_hz),
            due: 0,
        }
    }

    fn steps(&mut self, cycle: u64, clock_hz: u32) -> i64 {
        let clock = f64::from(clock_hz);
        let since = cycle.wrapping_sub(self.start.whole) as i64 as f64;
        let t = (since - self.start.part.high) / clock;
        // A step to the right is due at the cycle itself, one to the left after it.
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
                        && libm::fabs(table.step_s(k) - t) <= MAX_OFF * profile.duration_s()
                };
                let fallen = match (is_near(fallen), is_near(fallen + 1)) {
                    (_, true) => fallen + u64::from(is_due(fallen + 1, right)),
                    (true, _) => fallen - u64::from(!is_due(fallen, right)),
                    _ => fallen,
                };
                if right { fallen as i64 } else { -(fallen as i64) }
            }
            Profile::Points(points) => points.due_by(t, self.off, |right| since(right) / clock),
            Profile::Sine(Sine { oscillation }) | Profile::SineSegments(SineSegments { oscillation, .. }) => {
                let travel = 2 * oscillation.amplitude;
                let half = (2.0 * t / oscillation.period_s) as u64;
                let from_start = libm::fabs(profile.position(t));
                let (back, right) = (half % 2 == 1, oscillation.goes_right(half));
                let place = if back { travel as f64 - from_start } else { from_start };
                let made = near(place, travel, self.off, |k| is_due(half * travel + k, right));
                let from_start = if back { travel - made } else { made } as i64;
                if oscillation.starts_right { -from_start } else { from_start }
            }
            one_way => {
                let place = libm::fabs(one_way.position(t));
                // The whole way is made when the move has ended, which it has not.
                let last = count as f64 - 0.5;
                let place = if one_way.ends_with_a_step() && place > last { last } else { place };
                let made = near(place, count, self.off, |k| is_due(k, right));
                if right { made as i64 } else { -(made as i64) }
            }
        };
        self.due = due;
        self.planned.start_steps.saturating_add(due)
    }
}

/// How many of `count` steps are due at a place, in f64, of a way on which step k is at k - 1/2.
fn near(place: f64, count: u64, off: f64, is_due: impl Fn(u64) -> bool) -> u64 {
    let past = place + 0.5;
    let k = (past + 0.5) as u64;
    if libm::fabs(past - k as f64) > off || k == 0 || k > count {
        return (past as u64).min(count);
    }
    k - u64::from(!is_due(k))
}
