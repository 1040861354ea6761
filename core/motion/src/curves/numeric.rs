//! Curves whose steps are searched numerically: from a fractional position, with any number of reversals.
//!
//! ```text
//! position |     .-.          a step is due where the curve crosses a half-integer. Between two of the times from_s and
//!          |   /     \        to_s the position only rises or only falls, so each half-integer is crossed once.
//!          | -'       '-
//!          +-|--|--|--|-
//! ```
//!
//! Near ties are decided by the same formula in f64, so ticks and segments agree.

use crate::bisection::{Bracket, border};
use crate::curves::curve::{due_position, greater};
use crate::curves::phases::{Phases, RelativeState, State};
use crate::timing::{
    CycleTime, F106, Interpolated, IsDueBefore, MAX_ERROR, ROUNDING, Run, Runs, Schedule, due_near,
};
use crate::{Curve, Peaks, format::grouped, round_half_up};
use alloc::{boxed::Box, format, string::String, vec::Vec};

/// Maximum steps of Newton's method; bisection alone needs 60.
const MAX_NEWTON_STEPS: u32 = 100;
/// Relative distance from the ends of an interval at which its speed and acceleration are read.
const INSIDE: f64 = 1e-9;
/// Smaller relative changes of speed or acceleration between two intervals are those within [`INSIDE`].
const MIN_JUMP: f64 = 1e-6;

/// The formula of a curve: position, speed and acceleration at a time.
pub trait Shape {
    /// Times in s at which the formula changes, rising; the last one is the end.
    fn changes_s(&self) -> Vec<f64>;

    /// The state at `t` by the formula that holds at `within_s`.
    fn state(&self, t: f64, within_s: f64) -> RelativeState;

    /// The exact position at the end.
    fn end_position(&self) -> f64;

    /// Number of smooth parts per monotonic interval, for views.
    fn parts(&self) -> u32;

    /// Maximum magnitude of the jerk between its jumps; 0 if unknown.
    fn max_jerk(&self) -> f64 {
        0.0
    }

    /// What the description adds to the peaks.
    fn text(&self, _limit_steps_s: f64) -> String {
        String::new()
    }
}

impl Shape for Phases {
    fn changes_s(&self) -> Vec<f64> {
        self.ends_s().collect()
    }

    fn state(&self, t: f64, within_s: f64) -> RelativeState {
        self.state_by(t, within_s)
    }

    fn end_position(&self) -> f64 {
        self.end().position
    }

    fn parts(&self) -> u32 {
        8
    }

    fn max_jerk(&self) -> f64 {
        self.peak_jerk()
    }
}

/// A part of the curve in which the position does not reverse.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Interval {
    from_s: f64,
    to_s: f64,
    /// Whole positions at its ends.
    from: i64,
    to: i64,
    /// Steps in both directions up to its end.
    count: u64,
}

impl Interval {
    fn middle_s(&self) -> f64 {
        self.from_s + (self.to_s - self.from_s) / 2.0
    }

    fn is_rising(&self) -> bool {
        self.to > self.from
    }

    fn steps(&self) -> u64 {
        self.from.abs_diff(self.to)
    }

    /// The half-integer at which step `index` (from 0) of the interval is due.
    fn due_position(&self, index: f64) -> f64 {
        due_position(self.from, self.to, index)
    }
}

/// A curve whose steps are searched numerically.
#[derive(Clone, Debug, PartialEq)]
pub struct Numeric<S> {
    shape: S,
    /// Invariant: each starts at the end of the previous one, the first at 0.
    intervals: Vec<Interval>,
    /// Position at the start, -1/2 to 1/2: the axis may stand between two steps.
    start: f64,
    duration: F106,
}

impl<S: Shape> Numeric<S> {
    /// A curve of `duration` s that starts at position `start`.
    pub(crate) fn new(shape: S, start: f64, duration: F106) -> Self {
        let intervals = intervals_of(&shape);
        Self { shape, intervals, start, duration }
    }

    fn view(&self) -> View<'_> {
        View { shape: &self.shape, intervals: &self.intervals }
    }

    /// The position at the end minus the whole steps.
    pub(crate) fn end_offset(&self) -> f64 {
        self.shape.end_position() - self.steps() as f64
    }

    /// Number of steps in both directions.
    pub fn step_count(&self) -> u64 {
        self.view().step_count()
    }

    /// Upper bound on the distance from the start in steps: whole positions are at most half a step from the curve.
    pub(crate) fn max_distance(&self) -> f64 {
        let max = self.intervals.iter().map(|interval| interval.to.unsigned_abs()).max();
        max.unwrap_or(0) as f64 + 1.0
    }

    /// The state at `t`, at a change by the formula before it.
    pub(crate) fn state_before(&self, t: f64) -> State {
        self.view().state_before(t)
    }

    /// The state at `t` by the formula that holds at `within_s`.
    pub(crate) fn state(&self, t: f64, within_s: f64) -> State {
        self.view().state(t, within_s)
    }

    /// Ends of the monotonic intervals in s, rising.
    pub(crate) fn interval_ends_s(&self) -> Vec<f64> {
        self.intervals.iter().map(|interval| interval.to_s).collect()
    }

    /// Steps due by `t` s, relative to the start; `is_due` decides for step k (from 1) within `max_error`.
    pub(crate) fn due_by(&self, t: f64, max_error: f64, is_due: impl Fn(u64, bool) -> bool) -> i64 {
        self.view().due_by(t, max_error, &is_due)
    }

    /// Whole position at `t` s, and the number of steps before it in both directions.
    pub(crate) fn due_within(&self, t: f64) -> (i64, u64) {
        let due = self.due_by(t, 0.0, |_, _| true);
        let count = self
            .view()
            .interval_at(t)
            .map_or(0, |interval| interval.count - interval.steps() + interval.from.abs_diff(due));
        (due, count)
    }
}

impl Numeric<Phases> {
    /// The curve of phases from position `start` on.
    pub(crate) fn of_phases(phases: Phases, start: f64) -> Self {
        let duration = phases.duration_s().into();
        Self::new(phases, start, duration)
    }
}

fn intervals_of(shape: &dyn Shape) -> Vec<Interval> {
    let mut intervals: Vec<Interval> = Vec::new();
    let (mut from_s, mut from, mut count) = (0.0, 0_i64, 0_u64);
    let changes_s = shape.changes_s();
    let end_s = changes_s.last().copied().unwrap_or(0.0);
    let mut push = |to_s: f64, within_s: f64| {
        let position = if to_s >= end_s {
            shape.end_position()
        } else {
            shape.state(to_s, within_s).absolute().position
        };
        let to = round_half_up(position);
        count = count.saturating_add(from.abs_diff(to));
        intervals.push(Interval { from_s, to_s, from, to, count });
        (from_s, from) = (to_s, to);
    };
    let mut part_s = 0.0;
    for to_s in changes_s {
        let within_s = part_s + (to_s - part_s) / 2.0;
        for turn_s in turns_s(shape, part_s, to_s) {
            push(turn_s, within_s);
        }
        push(to_s, within_s);
        part_s = to_s;
    }
    intervals
}

/// A curve without the type of its shape, so that the code below exists once.
#[derive(Clone, Copy)]
struct View<'p> {
    shape: &'p dyn Shape,
    intervals: &'p [Interval],
}

impl<'p> View<'p> {
    fn step_count(self) -> u64 {
        self.intervals.last().map_or(0, |last| last.count)
    }

    fn state(self, t: f64, within_s: f64) -> State {
        self.shape.state(t, within_s).absolute()
    }

    fn state_in(self, interval: &Interval, t: f64) -> State {
        self.state(t, interval.middle_s())
    }

    fn state_before(self, t: f64) -> State {
        self.interval_at(t).map_or_else(|| self.state(t, t), |interval| self.state_in(interval, t))
    }

    fn interval_at(self, t: f64) -> Option<&'p Interval> {
        let at = self.intervals.partition_point(|interval| interval.to_s < t);
        self.intervals.get(at).or(self.intervals.last())
    }

    /// Steps that remain at `t` until `position` in the direction of the interval, above 0 before it, and the speed in that
    /// direction.
    fn missing(self, interval: &Interval, position: f64, t: f64) -> (f64, f64) {
        let RelativeState { origin, state } = self.shape.state(t, interval.middle_s());
        let missing = (position - origin) - state.position;
        if interval.is_rising() { (missing, state.speed) } else { (-missing, -state.speed) }
    }

    /// Time in s at which the curve crosses a position in an interval, and the maximum error.
    fn crossing(self, interval: &Interval, position: f64) -> (f64, f64) {
        let mut bracket = Bracket::new(interval.from_s, interval.to_s);
        let (mut t, mut slope) = (bracket.middle(), 0.0);
        for _ in 0..MAX_NEWTON_STEPS {
            let (missing, speed) = self.missing(interval, position, t);
            slope = speed;
            bracket.narrow(t, missing > 0.0);
            let next = t + missing / speed;
            let next = if next > bracket.low && next < bracket.high { next } else { bracket.middle() };
            let is_done = libm::fabs(next - t) <= f64::EPSILON * t;
            t = next;
            if is_done {
                break;
            }
        }
        // A point of rest has no bound.
        let s_per_step = if slope > 0.0 { 1.0 / slope } else { f64::INFINITY };
        let error_steps = 16.0 * ROUNDING * (libm::fabs(position) + 1.0);
        (t, MAX_ERROR * interval.to_s + error_steps * s_per_step)
    }

    fn due_by(self, t: f64, max_error: f64, is_due: &dyn Fn(u64, bool) -> bool) -> i64 {
        let Some(interval) = self.interval_at(t) else { return 0 };
        let steps = interval.steps();
        if steps == 0 {
            return interval.from;
        }
        let (missing, _) = self.missing(interval, interval.from as f64, t);
        let before = interval.count - steps;
        let right = interval.is_rising();
        let due = due_near(-missing, steps, max_error, |k| is_due(before + k, right)) as i64;
        if right { interval.from + due } else { interval.from - due }
    }

    fn runs(self, clock_hz: u32) -> Runs<'p> {
        let clock = f64::from(clock_hz);
        let moving = self.intervals.iter().filter(|interval| interval.steps() > 0);
        Box::new(moving.map(move |interval| {
            let times = Interpolated::new(interval.steps(), Vec::new(), move |index| {
                let (time_s, max_error_s) = self.crossing(interval, interval.due_position(index));
                (time_s * clock, max_error_s * clock)
            });
            Run { count: interval.steps(), right: interval.is_rising(), times: Box::new(times) }
        }))
    }

    /// Whether step `k` (from 1) is due before a time in cycles.
    fn is_due_before(self, k: u64, since: F106, clock_hz: u32) -> bool {
        let Some(earlier) = k.checked_sub(1) else { return true };
        let at = self.intervals.partition_point(|interval| interval.count <= earlier);
        let Some(interval) = self.intervals.get(at) else { return false };
        let t = since.high / f64::from(clock_hz);
        if t <= interval.from_s {
            return false;
        }
        if t > interval.to_s {
            return true;
        }
        let index = earlier - (interval.count - interval.steps());
        let (missing, _) = self.missing(interval, interval.due_position(index as f64), t);
        // A time slightly after an instant includes it.
        missing < 0.0 || (missing <= 0.0 && since.low > 0.0)
    }

    fn peaks(self) -> Peaks {
        let (mut peaks, mut before) = (Peaks::default(), None);
        for interval in self.intervals {
            let margin_s = (interval.to_s - interval.from_s) * INSIDE;
            let times_s = [interval.from_s + margin_s, interval.middle_s(), interval.to_s - margin_s];
            let [first, middle, last] = times_s.map(|t| self.state_in(interval, t));
            for state in [first, middle, last] {
                peaks.speed = greater(peaks.speed, libm::fabs(state.speed));
                peaks.acceleration = greater(peaks.acceleration, libm::fabs(state.acceleration));
            }
            if let Some(State { speed, acceleration, .. }) = before {
                let significant = |jump: f64, scale: f64| if jump > scale * MIN_JUMP { jump } else { 0.0 };
                let jump = significant(libm::fabs(first.speed - speed), peaks.speed);
                let of_acceleration =
                    significant(libm::fabs(first.acceleration - acceleration), peaks.acceleration);
                peaks.jump = greater(peaks.jump, jump);
                peaks.acceleration_jump = greater(peaks.acceleration_jump, of_acceleration);
            }
            before = Some(last);
        }
        Peaks { jerk: self.shape.max_jerk(), ..peaks }
    }

    fn breakpoints_s(self) -> Vec<f64> {
        let parts = self.shape.parts();
        let of_interval = |interval: &Interval| {
            let Interval { from_s, to_s, .. } = *interval;
            let at = move |part| from_s + (to_s - from_s) * f64::from(part) / f64::from(parts);
            (1..parts).map(at).chain([to_s])
        };
        self.intervals.iter().flat_map(of_interval).collect()
    }

    fn detail(self, limit_steps_s: f64) -> String {
        let peaks = self.peaks();
        let jerk =
            if peaks.jerk > 0.0 { format!(", {} steps/s\u{b3}", grouped(peaks.jerk)) } else { String::new() };
        peaks.to_text() + &jerk + &self.shape.text(limit_steps_s)
    }
}

/// Times within an interval of one formula at which the speed changes its sign, at most two.
fn turns_s(shape: &dyn Shape, from_s: f64, to_s: f64) -> Vec<f64> {
    let within_s = from_s + (to_s - from_s) / 2.0;
    let margin_s = (to_s - from_s) * INSIDE;
    let (first_s, last_s) = (from_s + margin_s, to_s - margin_s);
    let at = |t: f64| shape.state(t, within_s).state;
    // Where two numbers have opposite signs, the border between them.
    let change = |from_s: f64, to_s: f64, of: fn(State) -> f64| {
        let (first, last) = (of(at(from_s)), of(at(to_s)));
        let is_opposite = (first > 0.0 && last < 0.0) || (first < 0.0 && last > 0.0);
        is_opposite.then(|| border(from_s, to_s, |t| of(at(t)) * first > 0.0).1)
    };
    // The speed is monotonic between changes of the acceleration's sign.
    let middle_s = change(first_s, last_s, |state| state.acceleration);
    let bounds = [Some(first_s), middle_s, Some(last_s)];
    let bounds: Vec<f64> = bounds.into_iter().flatten().collect();
    let pairs = bounds.iter().zip(bounds.iter().skip(1));
    pairs.filter_map(|(from_s, to_s)| change(*from_s, *to_s, |state| state.speed)).collect()
}

impl<S: Shape> Schedule for Numeric<S> {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        CycleTime::of(self.duration * f64::from(clock_hz))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        self.view().runs(clock_hz)
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let view = self.view();
        Box::new(move |k, since| view.is_due_before(k, since, clock_hz))
    }
}

impl<S: Shape> Curve for Numeric<S> {
    fn duration_s(&self) -> f64 {
        self.duration.high
    }

    fn steps(&self) -> i64 {
        self.intervals.last().map_or(0, |last| last.to)
    }

    fn position(&self, t: f64) -> f64 {
        if t <= 0.0 {
            self.start
        } else if t >= self.duration_s() {
            self.shape.end_position()
        } else {
            self.state_before(t).position
        }
    }

    fn speed(&self, t: f64) -> f64 {
        self.state_before(t.clamp(0.0, self.duration_s())).speed
    }

    fn acceleration(&self, t: f64) -> f64 {
        self.state_before(t.clamp(0.0, self.duration_s())).acceleration
    }

    fn peaks(&self) -> Peaks {
        self.view().peaks()
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        self.view().breakpoints_s()
    }

    fn detail(&self, limit_steps_s: f64) -> String {
        self.view().detail(limit_steps_s)
    }
}
