//! Which recorded step is which planned step, where steps are missing from the recording or additional in it.
//!
//! ```text
//! plan       |   |   |   |   |   |        runs: planned 0.. with recorded 0.., then planned 3.. with recorded 2..
//! recorded   |   |       |   | : |              (one missing), then planned 5.. with recorded 5.. (one extra)
//! ```
//!
//! A beam search: hypotheses walk along both lists, and each follows the clock of the recording by a filter of offset and
//! rate, so that drift of a few percent and jitter of part of an interval leave the match as it is. A step that does not come
//! when it is due makes further hypotheses: steps are missing, steps are extra, this step is late, or all from here on
//! are. The cheapest wins once the steps behind it have shown which one fits. At most 16 hypotheses live at a time, and
//! their number in total is bounded, so time and memory grow linearly with the steps.
//!
//! ```
//! use stepscope_inspect::recording::{alignment::Side, matching::Matching};
//! use stepscope_peripheral::trace::Step;
//!
//! // The third of seven steps is missing from the recording.
//! let steps = |cycles: &[u64]| -> Vec<Step> {
//!     (1..).zip(cycles).map(|(position, &cycle)| Step { cycle, position }).collect()
//! };
//! let (plan, recorded) = (steps(&[100, 200, 300, 400, 500, 600, 700]), steps(&[100, 200, 400, 500, 600, 700]));
//! let side = |steps| Side { steps, clock_hz: 1_000_000, values: &[] };
//! let matching = Matching::of(side(&recorded), side(&plan));
//! assert_eq!([1, 2, 3].map(|step| matching.recorded(step)), [Some(1), None, Some(2)]);
//! ```

use super::side::Side;
use alloc::{rc::Rc, vec, vec::Vec};

/// A planned and a recorded step.
type Pair = (usize, usize);

/// Planned steps that are matched with recorded ones, one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// The first planned step, from 0.
    pub model: usize,
    /// The recorded step that it is.
    pub recorded: usize,
    /// How many follow each other on both sides, this one included.
    pub count: usize,
    /// Matched steps before it.
    before: usize,
}

/// All matched steps, in runs without a missing or extra step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Matching {
    runs: Vec<Run>,
}

impl Matching {
    /// Matches two lists of steps, or of bytes.
    #[must_use]
    pub fn of(recorded: Side<'_>, model: Side<'_>) -> Self {
        let Some((end, starts)) = Search::new(recorded, model).run() else { return Self::default() };
        let mut found = Self::default();
        let ends = starts.iter().skip(1).copied().chain([end]);
        for ((model, recorded), (next_model, next_recorded)) in starts.iter().copied().zip(ends) {
            let count = (next_model - model).min(next_recorded - recorded);
            if count > 0 {
                found.runs.push(Run { model, recorded, count, before: found.len() });
            }
        }
        found
    }

    /// The runs, in order.
    #[must_use]
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Matched steps.
    #[must_use]
    pub fn len(&self) -> usize {
        self.runs.last().map_or(0, |last| last.before + last.count)
    }

    /// Whether none is matched.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Matched step number `index`: the planned and the recorded step.
    #[must_use]
    pub fn pair(&self, index: usize) -> Option<(usize, usize)> {
        let after = self.runs.partition_point(|run| run.before <= index);
        let run = self.runs.get(after.checked_sub(1)?)?;
        let within = index - run.before;
        (within < run.count).then_some((run.model + within, run.recorded + within))
    }

    /// The recorded step that a planned step is; `None` where it is missing.
    #[must_use]
    pub fn recorded(&self, model: usize) -> Option<usize> {
        let after = self.runs.partition_point(|run| run.model <= model);
        let run = self.runs.get(after.checked_sub(1)?)?;
        (model - run.model < run.count).then(|| run.recorded + model - run.model)
    }
}

/// Hypotheses that live at a time.
const WIDTH: usize = 16;
/// A hypothesis that costs so much more than the best one is dropped.
const MARGIN: f64 = 2.25;
/// Only what costs at most so much more than the best one makes further hypotheses of gaps.
const SPAWNING: f64 = 1.0;
/// Steps that are looked for as missing, or extra, whatever the clock says.
const NEAR: usize = 3;
/// The same before the first match, where no clock is known.
const NEAR_START: usize = 16;
/// What a gap before the first match costs more: without a clock one is soon mistaken for jitter.
const START: f64 = 1.6;
/// Intervals that a start far from the first steps is found by.
const SIGNATURE: usize = 32;
/// Part of the interval within which a step is on time beyond doubt.
const CLEAN: f64 = 0.125;
/// Part of the interval from which on a step is late.
const LATE: f64 = 0.5;
/// Greatest difference of the clocks' rates.
const MAX_SLOPE: f64 = 0.125;
/// A gap so few steps after another of its kind is cheaper: bounces and bursts come together.
const AGAIN_WITHIN: usize = 4;

/// What a hypothesis costs; one gap costs 1.
#[derive(Clone, Copy, Debug)]
struct Costs {
    /// The first late step of several.
    late_first: f64,
    /// Each step that is late by half an interval; more by up to 3.5 times.
    late: f64,
    /// All steps from here on are late.
    shift: f64,
    /// The first step of several in the wrong direction, or byte with another value.
    differs_first: f64,
    /// Each other one of them.
    differs: f64,
    /// All of them at most.
    differs_most: f64,
}

/// Steps say by their times which is which.
const STEPS: Costs =
    Costs { late_first: 1.2, late: 0.1, shift: 1.5, differs_first: 0.3, differs: 0.05, differs_most: 1.0 };
/// Bytes say it by their values; a sender is late as it likes.
const BYTES: Costs =
    Costs { late_first: 0.3, late: 0.02, shift: 0.3, differs_first: 0.35, differs: 0.1, differs_most: 2.0 };

/// A gap of so many steps, each doubling of which costs a little.
fn gap(count: usize) -> f64 {
    if count == 0 { 0.0 } else { 1.0 + 0.05 * f64::from(count.ilog2() + 1) }
}

/// How late the recording is, as the steps matched so far have it.
#[derive(Clone, Copy, Debug)]
struct Clock {
    /// Of the last step that it follows, in s of the plan.
    at_s: f64,
    late_s: f64,
    /// Seconds of lateness per second.
    slope: f64,
    /// Steps that it follows, and a few more, so that the first ones do not turn it.
    seen: u32,
}

impl Clock {
    const fn new(at_s: f64, late_s: f64) -> Self {
        Self { at_s, late_s, slope: 0.0, seen: 9 }
    }

    fn late_at(&self, at_s: f64) -> f64 {
        self.late_s + self.slope * (at_s - self.at_s)
    }

    /// With one more step: a filter whose memory grows up to some steps for the offset and some dozens for the rate.
    fn follow(&self, at_s: f64, late_s: f64) -> Self {
        let seen = self.seen.saturating_add(1);
        let n = f64::from(seen);
        let both = (n + 1.0) * (n + 2.0);
        let alpha = libm::fmax(2.0 * (2.0 * n + 1.0) / both, 0.25);
        let beta = libm::fmax(6.0 / both, 1.0 / 256.0);
        let (expected, passed) = (self.late_at(at_s), at_s - self.at_s);
        let off = late_s - expected;
        let turned = if passed > 0.0 { beta * off / passed } else { 0.0 };
        let slope = (self.slope + turned).clamp(-MAX_SLOPE, MAX_SLOPE);
        Self { at_s, late_s: expected + alpha * off, slope, seen }
    }
}

/// Where a run begins; those before it behind it. Shared by the hypotheses that have it in common.
#[derive(Debug)]
struct Start {
    model: usize,
    recorded: usize,
    before: Option<Rc<Start>>,
}

impl Drop for Start {
    fn drop(&mut self) {
        // One by one: a long list would need as many frames of the stack.
        let mut next = self.before.take();
        while let Some(mut start) = next.and_then(Rc::into_inner) {
            next = start.before.take();
        }
    }
}

/// A gap on one side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Gap {
    Missing(usize),
    Extra(usize),
}

/// A hypothesis: all steps before these are matched, missing or extra.
#[derive(Clone, Debug)]
struct Hypothesis {
    model: usize,
    recorded: usize,
    cost: f64,
    /// With what the rest costs at least.
    estimate: f64,
    clock: Option<Clock>,
    is_late: bool,
    /// What the steps in the wrong direction, or other bytes, have cost that end here; 0 if the last one was right.
    differing: f64,
    /// Where the last gap was, and whether steps were missing.
    last_gap: Option<(usize, bool)>,
    start: Rc<Start>,
}

struct Search<'a> {
    recorded: Side<'a>,
    model: Side<'a>,
    costs: Costs,
    /// No interval counts for less, in s: two cycles of the slower clock.
    least_s: f64,
    living: Vec<Hypothesis>,
    /// The cheapest that has come to an end.
    best: Option<Hypothesis>,
    /// Gaps that may still be tried.
    left: usize,
}

impl<'a> Search<'a> {
    fn new(recorded: Side<'a>, model: Side<'a>) -> Self {
        let slower = recorded.clock_hz.min(model.clock_hz).max(1);
        let steps = recorded.steps.len().saturating_add(model.steps.len());
        Self {
            recorded,
            model,
            costs: if model.values.is_empty() { STEPS } else { BYTES },
            least_s: 2.0 / f64::from(slower),
            living: Vec::with_capacity(WIDTH),
            best: None,
            left: steps.saturating_mul(32).saturating_add(1 << 20),
        }
    }

    /// The end of the cheapest hypothesis, and where its runs begin.
    fn run(mut self) -> Option<(Pair, Vec<Pair>)> {
        self.begin();
        while let Some(next) = self.next() {
            self.go_on(next);
        }
        let best = self.best?;
        let mut starts = vec![(best.start.model, best.start.recorded)];
        let mut before = best.start.before.as_deref();
        while let Some(start) = before {
            starts.push((start.model, start.recorded));
            before = start.before.as_deref();
        }
        starts.reverse();
        Some(((best.model, best.recorded), starts))
    }

    /// All ways in which the lists may begin.
    fn begin(&mut self) {
        let mut starts = vec![(0, 0)];
        if self.unlike(self.recorded, 0, self.model, 0) > 0.02 * SIGNATURE as f64 {
            let far = |hay: Side<'a>, needle: Side<'a>| self.find(hay, needle).filter(|at| *at > NEAR_START);
            starts.extend(far(self.model, self.recorded).map(|at| (at, 0)));
            starts.extend(far(self.recorded, self.model).map(|at| (0, at)));
        }
        starts.extend((1..=NEAR_START).flat_map(|count| [(count, 0), (0, count)]));
        for (model, recorded) in starts {
            if model < self.model.steps.len() && recorded < self.recorded.steps.len() {
                let start = Hypothesis {
                    model,
                    recorded,
                    cost: START * gap(model.max(recorded)),
                    estimate: 0.0,
                    clock: None,
                    is_late: false,
                    differing: 0.0,
                    last_gap: None,
                    start: Rc::new(Start { model, recorded, before: None }),
                };
                self.step(&start, None);
            }
        }
    }

    /// How unlike the intervals from two steps on are, each as a part of the second's.
    fn unlike(&self, one: Side<'a>, from: usize, other: Side<'a>, other_from: usize) -> f64 {
        let interval = |side: &Side<'a>, index: usize| Some(side.at_s(index + 1)? - side.at_s(index)?);
        let mut sum = 0.0;
        for index in 0..SIGNATURE {
            let found = interval(&one, from + index).zip(interval(&other, other_from + index));
            let Some((own, due)) = found else { return if index == 0 { f64::INFINITY } else { sum } };
            sum += libm::fabs(own - due) / libm::fmax(due, self.least_s);
            if sum > SIGNATURE as f64 {
                break;
            }
        }
        sum
    }

    /// Where the intervals that the needle begins with are found, if they are anywhere.
    fn find(&self, hay: Side<'a>, needle: Side<'a>) -> Option<usize> {
        if needle.steps.len() <= SIGNATURE {
            return None;
        }
        let (mut least, mut found) = (0.1 * SIGNATURE as f64, None);
        for at in 0..=hay.steps.len().checked_sub(SIGNATURE + 1)? {
            let unlike = self.unlike(hay, at, needle, 0);
            // Where all are alike the first is taken.
            if unlike < 0.9 * least {
                (least, found) = (unlike, Some(at));
            }
        }
        found
    }

    /// The hypothesis that is least far, taken out; those that cost too much are dropped.
    fn next(&mut self) -> Option<Hypothesis> {
        let most = self.least_estimate() + MARGIN;
        self.living.retain(|living| living.estimate <= most);
        let far = |living: &Hypothesis| living.model + living.recorded;
        let mut least = 0;
        for (index, living) in self.living.iter().enumerate().skip(1) {
            if self.living.get(least).is_some_and(|found| far(living) < far(found)) {
                least = index;
            }
        }
        (least < self.living.len()).then(|| self.living.swap_remove(least))
    }

    fn least_estimate(&self) -> f64 {
        let best = self.best.as_ref().map_or(f64::INFINITY, |best| best.estimate);
        self.living.iter().fold(best, |least, living| libm::fmin(least, living.estimate))
    }

    /// What a hypothesis can become by its next steps.
    fn go_on(&mut self, mut hypothesis: Hypothesis) {
        // Alone, and on time, it needs no others.
        while self.living.is_empty() && self.follow(&mut hypothesis) {}
        if self.is_ended(&hypothesis) {
            let end = Some(hypothesis);
            let cost = |of: &Option<Hypothesis>| of.as_ref().map_or(f64::INFINITY, |of| of.estimate);
            if cost(&end) < cost(&self.best) {
                self.best = end;
            }
            return;
        }
        let is_clean = self.step(&hypothesis, None);
        let most = self.least_estimate() + SPAWNING;
        if is_clean || hypothesis.estimate > most || self.left == 0 {
            return;
        }
        let mut gaps = Vec::with_capacity(2 * NEAR + 4);
        for count in 1..=NEAR {
            gaps.extend([Gap::Missing(count), Gap::Extra(count)]);
        }
        self.due_gaps(&hypothesis, &mut gaps);
        for gap in gaps {
            self.left = self.left.saturating_sub(1);
            self.step(&hypothesis, Some(gap));
        }
    }

    /// Gaps behind which the next step comes when it is due.
    fn due_gaps(&self, hypothesis: &Hypothesis, gaps: &mut Vec<Gap>) {
        let Hypothesis { model, recorded, .. } = *hypothesis;
        let (Some(clock), Some(due), Some(came)) =
            (hypothesis.clock, self.model.at_s(model), self.recorded.at_s(recorded))
        else {
            return;
        };
        // When the plan has what was recorded, and the other way round.
        let planned = clock.at_s + (came - clock.at_s - clock.late_s) / (1.0 + clock.slope);
        let comes = due + clock.late_at(due);
        let near = |side: Side<'a>, from: usize, at_s: f64| {
            let rest = side.steps.get(from..).unwrap_or_default();
            let after = rest.partition_point(|step| side.seconds(step) < at_s);
            [after.saturating_sub(1), after].into_iter().filter(|count| *count > NEAR)
        };
        gaps.extend(near(self.model, model, planned).map(Gap::Missing));
        gaps.extend(near(self.recorded, recorded, comes).map(Gap::Extra));
    }

    fn is_ended(&self, hypothesis: &Hypothesis) -> bool {
        hypothesis.model >= self.model.steps.len() || hypothesis.recorded >= self.recorded.steps.len()
    }

    /// The interval about a planned step, the shorter one, in s.
    fn interval_s(&self, model: usize) -> f64 {
        let at = |index: Option<usize>| index.and_then(|index| self.model.at_s(index));
        let here = at(Some(model)).unwrap_or(0.0);
        let before = at(model.checked_sub(1)).map_or(f64::INFINITY, |before| here - before);
        let after = at(model.checked_add(1)).map_or(f64::INFINITY, |after| after - here);
        libm::fmax(libm::fmin(before, after), self.least_s)
    }

    /// Goes one step on where it is on time beyond doubt, in its direction and with its value.
    fn follow(&self, hypothesis: &mut Hypothesis) -> bool {
        let Hypothesis { model, recorded, .. } = *hypothesis;
        let (Some(clock), Some(due), Some(came)) =
            (hypothesis.clock, self.model.at_s(model), self.recorded.at_s(recorded))
        else {
            return false;
        };
        let off = libm::fabs(came - due - clock.late_at(due)) / self.interval_s(model);
        if off > CLEAN || hypothesis.differing > 0.0 || self.differs(model, recorded) {
            return false;
        }
        hypothesis.clock = Some(clock.follow(due, came - due));
        hypothesis.is_late = false;
        (hypothesis.model, hypothesis.recorded) = (model + 1, recorded + 1);
        hypothesis.cost += self.costs.late * 4.0 * off * off;
        hypothesis.estimate = hypothesis.cost + self.rest(hypothesis);
        true
    }

    /// Whether the direction, or the value, is another.
    fn differs(&self, model: usize, recorded: usize) -> bool {
        self.model.direction(model) != self.recorded.direction(recorded)
            || self.model.values.get(model) != self.recorded.values.get(recorded)
    }

    /// What the rest costs at least: a gap, where one side has more left.
    fn rest(&self, hypothesis: &Hypothesis) -> f64 {
        let model = self.model.steps.len().saturating_sub(hypothesis.model);
        gap(model.abs_diff(self.recorded.steps.len().saturating_sub(hypothesis.recorded)))
    }

    /// Matches the next steps behind a gap, if there is one: on time or late, or with all that follow. Whether it was on time
    /// beyond doubt.
    fn step(&mut self, from: &Hypothesis, behind: Option<Gap>) -> bool {
        let (mut model, mut recorded, mut cost) = (from.model, from.recorded, from.cost);
        let (mut last_gap, mut start) = (from.last_gap, None);
        if let Some(found) = behind {
            let (count, is_missing) = match found {
                Gap::Missing(count) => (count, true),
                Gap::Extra(count) => (count, false),
            };
            let is_again = last_gap.is_some_and(|(at, was_missing)| {
                was_missing == is_missing && model.saturating_sub(at) <= AGAIN_WITHIN
            });
            cost += if is_again { gap(count) - 0.85 } else { gap(count) };
            if is_missing {
                model += count
            } else {
                recorded += count
            }
            last_gap = Some((model, is_missing));
            start = Some(Rc::new(Start { model, recorded, before: Some(Rc::clone(&from.start)) }));
        }
        let (Some(due), Some(came)) = (self.model.at_s(model), self.recorded.at_s(recorded)) else {
            return false;
        };
        let late_s = came - due;
        let off =
            from.clock.map_or(0.0, |clock| libm::fabs(late_s - clock.late_at(due)) / self.interval_s(model));
        let is_late = off > LATE;
        let differs = self.differs(model, recorded);
        let mut differing = 0.0;
        if differs {
            let of = &self.costs;
            let more = if from.differing > 0.0 { from.differing + of.differs } else { of.differs_first };
            differing = libm::fmin(more, of.differs_most);
            cost += differing - from.differing;
        }
        let of = self.costs;
        let each = if is_late { libm::fmin(LATE + off, 3.5) } else { 4.0 * off * off };
        let first = if from.is_late && is_late { 0.0 } else { ((off - 0.4) / 0.6).clamp(0.0, 1.0) };
        let clock = from.clock.unwrap_or(Clock::new(due, late_s));
        let start = start.unwrap_or_else(|| Rc::clone(&from.start));
        let mut next = Hypothesis {
            model: model + 1,
            recorded: recorded + 1,
            cost: cost + of.late * each + of.late_first * first,
            estimate: 0.0,
            clock: Some(if is_late { clock } else { clock.follow(due, late_s) }),
            is_late,
            differing,
            last_gap,
            start,
        };
        next.estimate = next.cost + self.rest(&next);
        if first > 0.0 || is_late {
            let mut shifted = Hypothesis {
                cost: cost + of.shift,
                clock: Some(Clock { at_s: due, late_s, ..clock }),
                is_late: false,
                ..next.clone()
            };
            shifted.estimate = shifted.cost + self.rest(&shifted);
            self.push(shifted);
        }
        self.push(next);
        off <= CLEAN && differs == (from.differing > 0.0)
    }

    /// Takes a hypothesis in, in the place of one that is at the same steps and has the same clock, or of the one that costs
    /// most.
    fn push(&mut self, next: Hypothesis) {
        let late = |of: &Hypothesis| of.clock.map_or(0.0, |clock| clock.late_s);
        let near_s = self.interval_s(next.model.saturating_sub(1)) / 4.0;
        let is_same = |of: &&mut Hypothesis| {
            of.model == next.model
                && of.recorded == next.recorded
                && libm::fabs(late(of) - late(&next)) <= near_s
        };
        if let Some(same) = self.living.iter_mut().find(is_same) {
            if next.cost < same.cost {
                *same = next;
            }
        } else if self.living.len() < WIDTH {
            self.living.push(next);
        } else if let Some(worst) =
            self.living.iter_mut().max_by(|one, other| one.estimate.total_cmp(&other.estimate))
            && next.estimate < worst.estimate
        {
            *worst = next;
        }
    }
}

#[cfg(test)]
mod tests;
