//! The beam search.

use super::clock::Clock;
use super::costs::{AGAIN, BYTES, CLEAN, Costs, LATE, STEPS, gap};
use crate::recording::compared_data::Side;
use alloc::{rc::Rc, vec, vec::Vec};

pub(super) type Pair = (usize, usize);

const WIDTH: usize = 16;
/// Maximum extra cost of a hypothesis.
const MARGIN: f64 = 2.5;
/// Maximum extra cost of a hypothesis that may try gaps.
const SPAWNING: f64 = 1.5;
/// Gaps up to this length are always tried.
const NEAR: usize = 3;
/// Starts up to this step are always tried.
const NEAR_START: usize = 8;
/// Intervals that identify a start far from the first steps.
const SIGNATURE: usize = 32;
/// A gap this few steps after one of its kind is cheaper.
const AGAIN_WITHIN: usize = 1;
/// Steps after which hypotheses are compared.
const BLOCK: usize = 64;
/// Blocks in which a start is compared with other starts.
const TRIAL: usize = 512;
/// Cost of an unmatched pair: above the cost of a step on time.
const UNMATCHED: f64 = 0.3;

/// The start of a run, linked to the run before. Hypotheses share their common runs.
#[derive(Debug)]
struct Start {
    model: usize,
    recorded: usize,
    before: Option<Rc<Start>>,
}

impl Drop for Start {
    fn drop(&mut self) {
        // A recursive drop would overflow the stack.
        let mut next = self.before.take();
        while let Some(mut start) = next.and_then(Rc::into_inner) {
            next = start.before.take();
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Gap {
    Missing(usize),
    Extra(usize),
}

/// All steps before these are matched, missing or extra.
#[derive(Clone, Debug)]
struct Hypothesis {
    model: usize,
    recorded: usize,
    matched: usize,
    cost: f64,
    /// The cost, and the minimum cost of the remaining steps.
    estimate: f64,
    clock: Option<Clock>,
    late: f64,
    differing: f64,
    last_gap: Option<(usize, bool)>,
    start: Rc<Start>,
}

impl Hypothesis {
    const fn block(&self) -> usize {
        (self.model + self.recorded) / BLOCK
    }
}

pub(super) struct Search<'a> {
    recorded: Side<'a>,
    model: Side<'a>,
    costs: Costs,
    /// Minimum interval in s: two cycles of the slower clock.
    min_interval_s: f64,
    beam: Vec<Hypothesis>,
    best: Option<Hypothesis>,
    /// Minimum estimate of all starts per block.
    trial: Vec<f64>,
    trial_end: f64,
    block: usize,
    /// A start after many steps has no cost of their jitter, so it sets no limit for other starts.
    is_far: bool,
    /// Maximum gaps per start: bounds the time on recordings that are unlike the plan.
    pub(super) max_gaps: usize,
    tried_gaps: usize,
    pub(super) all_tried_gaps: usize,
}

impl<'a> Search<'a> {
    pub(super) fn new(recorded: Side<'a>, model: Side<'a>) -> Self {
        let slower = recorded.clock_hz.min(model.clock_hz).max(1);
        let steps = recorded.steps.len().saturating_add(model.steps.len());
        Self {
            recorded,
            model,
            costs: if model.values.is_empty() { STEPS } else { BYTES },
            min_interval_s: 2.0 / f64::from(slower),
            beam: Vec::with_capacity(WIDTH),
            best: None,
            trial: vec![f64::INFINITY; TRIAL],
            trial_end: f64::INFINITY,
            block: 0,
            is_far: false,
            max_gaps: steps.saturating_mul(16).saturating_add(1 << 20),
            tried_gaps: 0,
            all_tried_gaps: 0,
        }
    }

    pub(super) fn run(&mut self) -> Option<(Pair, Vec<Pair>)> {
        // One after the other, because starts would displace each other in the beam.
        for (model, recorded) in self.starts() {
            self.begin(model, recorded);
            while let Some(next) = self.take_next() {
                self.expand(next);
            }
        }
        let best = self.best.as_ref()?;
        let mut starts = vec![(best.start.model, best.start.recorded)];
        let mut before = best.start.before.as_deref();
        while let Some(start) = before {
            starts.push((start.model, start.recorded));
            before = start.before.as_deref();
        }
        starts.reverse();
        Some(((best.model, best.recorded), starts))
    }

    fn starts(&self) -> Vec<Pair> {
        let mut starts = vec![(0, 0)];
        if self.mismatch(self.recorded, 0, self.model, 0) > 0.02 * SIGNATURE as f64 {
            let far = |hay: Side<'a>, needle: Side<'a>| self.find(hay, needle).filter(|at| *at > NEAR_START);
            starts.extend(far(self.model, self.recorded).map(|at| (at, 0)));
            starts.extend(far(self.recorded, self.model).map(|at| (0, at)));
        }
        starts.extend((1..=NEAR_START).flat_map(|count| [(count, 0), (0, count)]));
        let (planned, came) = (self.model.steps.len(), self.recorded.steps.len());
        starts.retain(|(model, recorded)| *model < planned && *recorded < came);
        starts
    }

    fn begin(&mut self, model: usize, recorded: usize) {
        self.block = 0;
        self.tried_gaps = 0;
        self.is_far = model.max(recorded) > NEAR_START;
        let start = Hypothesis {
            model,
            recorded,
            matched: 0,
            cost: gap(model.max(recorded)),
            estimate: 0.0,
            clock: None,
            late: 0.0,
            differing: 0.0,
            last_gap: None,
            start: Rc::new(Start { model, recorded, before: None }),
        };
        self.match_next(&start, None);
    }

    /// Sum of the relative differences of the next intervals of two sides.
    fn mismatch(&self, one: Side<'a>, from: usize, other: Side<'a>, other_from: usize) -> f64 {
        let interval = |side: &Side<'a>, index: usize| Some(side.at_s(index + 1)? - side.at_s(index)?);
        let mut sum = 0.0;
        for index in 0..SIGNATURE {
            let found = interval(&one, from + index).zip(interval(&other, other_from + index));
            let Some((own, due)) = found else { return if index == 0 { f64::INFINITY } else { sum } };
            sum += libm::fabs(own - due) / libm::fmax(due, self.min_interval_s);
            if sum > SIGNATURE as f64 {
                break;
            }
        }
        sum
    }

    /// Where the first intervals of `needle` are in `hay`.
    fn find(&self, hay: Side<'a>, needle: Side<'a>) -> Option<usize> {
        if needle.steps.len() <= SIGNATURE {
            return None;
        }
        let (mut min, mut found) = (0.1 * SIGNATURE as f64, None);
        for at in 0..=hay.steps.len().checked_sub(SIGNATURE + 1)? {
            let mismatch = self.mismatch(hay, at, needle, 0);
            if mismatch < 0.9 * min {
                (min, found) = (mismatch, Some(at));
            }
        }
        found
    }

    /// Takes the hypothesis with the fewest steps and drops the expensive ones.
    fn take_next(&mut self) -> Option<Hypothesis> {
        let block = self.beam.iter().map(Hypothesis::block).min()?;
        let min = self.beam.iter().fold(f64::INFINITY, |min, of| libm::fmin(min, of.estimate));
        let mut max = libm::fmin(min + MARGIN, self.best_estimate());
        if block > self.block {
            // Compare with other starts at the end of each block.
            if let Some(others) = self.trial.get_mut(block) {
                max = libm::fmin(max, *others + 2.0 * MARGIN);
                if !self.is_far {
                    *others = libm::fmin(*others, min);
                }
            } else if self.block < TRIAL {
                max = libm::fmin(max, self.trial_end);
                if !self.is_far {
                    self.trial_end = libm::fmin(self.trial_end, min);
                }
            }
            self.block = block;
        }
        self.beam.retain(|of| of.estimate < max);
        let steps = |of: &Hypothesis| of.model + of.recorded;
        let (first, _) = self.beam.iter().enumerate().min_by_key(|(_, of)| steps(of))?;
        Some(self.beam.swap_remove(first))
    }

    fn best_estimate(&self) -> f64 {
        self.best.as_ref().map_or(f64::INFINITY, |best| best.estimate)
    }

    fn least_estimate(&self) -> f64 {
        self.beam.iter().fold(self.best_estimate(), |min, of| libm::fmin(min, of.estimate))
    }

    /// Extends a hypothesis to the end of its block, or by the alternatives for a step that is not on time.
    fn expand(&mut self, mut hypothesis: Hypothesis) {
        let block = hypothesis.block();
        while self.follow(&mut hypothesis) {
            if hypothesis.block() > block {
                return self.push(hypothesis);
            }
        }
        if self.is_ended(&hypothesis) {
            let pairs = self.model.steps.len().min(self.recorded.steps.len());
            hypothesis.estimate += UNMATCHED * pairs.saturating_sub(hypothesis.matched) as f64;
            if hypothesis.estimate < self.best_estimate() {
                self.best = Some(hypothesis);
            }
            return;
        }
        let is_clean = self.match_next(&hypothesis, None);
        let max = self.least_estimate() + SPAWNING;
        if is_clean || hypothesis.estimate > max || self.tried_gaps >= self.max_gaps {
            return;
        }
        let mut gaps = Vec::with_capacity(2 * NEAR + 4);
        for count in 1..=NEAR {
            gaps.extend([Gap::Missing(count), Gap::Extra(count)]);
        }
        self.add_gaps_by_time(&hypothesis, &mut gaps);
        for gap in gaps {
            self.tried_gaps += 1;
            self.all_tried_gaps += 1;
            self.match_next(&hypothesis, Some(gap));
        }
    }

    /// Adds the longer gaps after which the next step is on time.
    fn add_gaps_by_time(&self, hypothesis: &Hypothesis, gaps: &mut Vec<Gap>) {
        let Hypothesis { model, recorded, .. } = *hypothesis;
        let (Some(clock), Some(due), Some(came)) =
            (hypothesis.clock, self.model.at_s(model), self.recorded.at_s(recorded))
        else {
            return;
        };
        let near = |side: Side<'a>, from: usize, at_s: f64| {
            let rest = side.steps.get(from..).unwrap_or_default();
            let after = rest.partition_point(|step| side.seconds(step) < at_s);
            [after.saturating_sub(1), after].into_iter().filter(|count| *count > NEAR)
        };
        gaps.extend(near(self.model, model, clock.planned_at(came)).map(Gap::Missing));
        gaps.extend(near(self.recorded, recorded, due + clock.late_at(due)).map(Gap::Extra));
    }

    fn is_ended(&self, hypothesis: &Hypothesis) -> bool {
        hypothesis.model >= self.model.steps.len() || hypothesis.recorded >= self.recorded.steps.len()
    }

    fn interval_s(&self, model: usize) -> f64 {
        let at = |index: Option<usize>| index.and_then(|index| self.model.at_s(index));
        let here = at(Some(model)).unwrap_or(0.0);
        let before = at(model.checked_sub(1)).map_or(f64::INFINITY, |before| here - before);
        let after = at(model.checked_add(1)).map_or(f64::INFINITY, |after| after - here);
        libm::fmax(libm::fmin(before, after), self.min_interval_s)
    }

    /// Advances by one step if it is on time and has the right direction or value.
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
        hypothesis.late = 0.0;
        hypothesis.matched += 1;
        (hypothesis.model, hypothesis.recorded) = (model + 1, recorded + 1);
        hypothesis.cost += self.costs.off(off);
        hypothesis.estimate = hypothesis.cost + self.remaining_cost(hypothesis);
        true
    }

    fn differs(&self, model: usize, recorded: usize) -> bool {
        self.model.direction(model) != self.recorded.direction(recorded)
            || self.model.values.get(model) != self.recorded.values.get(recorded)
    }

    fn remaining_cost(&self, hypothesis: &Hypothesis) -> f64 {
        let model = self.model.steps.len().saturating_sub(hypothesis.model);
        gap(model.abs_diff(self.recorded.steps.len().saturating_sub(hypothesis.recorded)))
    }

    /// Matches the next step, after an optional gap. Returns whether it is on time.
    fn match_next(&mut self, from: &Hypothesis, gap_before: Option<Gap>) -> bool {
        let (mut model, mut recorded, mut cost) = (from.model, from.recorded, from.cost);
        let (mut last_gap, mut start) = (from.last_gap, None);
        if let Some(found) = gap_before {
            let (count, is_missing) = match found {
                Gap::Missing(count) => (count, true),
                Gap::Extra(count) => (count, false),
            };
            let is_again = last_gap.is_some_and(|(at, was_missing)| {
                was_missing == is_missing && model.saturating_sub(at) <= AGAIN_WITHIN
            });
            cost += gap(count) - if is_again { AGAIN } else { 0.0 };
            if is_missing {
                model += count;
            } else {
                recorded += count;
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
        let differs = self.differs(model, recorded);
        let mut differing = 0.0;
        if differs {
            differing = self.costs.differing_run(from.differing);
            cost += differing - from.differing;
        }
        let late_run = self.costs.late_run(off);
        let late = if late_run > 0.0 { libm::fmax(from.late, late_run) } else { 0.0 };
        let clock = from.clock.unwrap_or(Clock::new(due, late_s));
        let start = start.unwrap_or_else(|| Rc::clone(&from.start));
        let mut next = Hypothesis {
            model: model + 1,
            recorded: recorded + 1,
            matched: from.matched + 1,
            cost: cost + self.costs.off(off) + libm::fmax(late - from.late, 0.0),
            estimate: 0.0,
            clock: Some(if off > LATE { clock } else { clock.follow(due, late_s) }),
            late,
            differing,
            last_gap,
            start,
        };
        next.estimate = next.cost + self.remaining_cost(&next);
        if late > 0.0 {
            let mut shifted = Hypothesis {
                cost: cost + self.costs.shift,
                clock: Some(clock.shifted(due, late_s)),
                late: 0.0,
                ..next.clone()
            };
            shifted.estimate = shifted.cost + self.remaining_cost(&shifted);
            self.push(shifted);
        }
        self.push(next);
        off <= CLEAN && differs == (from.differing > 0.0)
    }

    /// Adds a hypothesis. It replaces one at the same steps with the same clock, or the one with the highest cost.
    fn push(&mut self, next: Hypothesis) {
        let late = |of: &Hypothesis| of.clock.map_or(0.0, |clock| clock.late_s());
        let near_s = self.interval_s(next.model.saturating_sub(1)) / 4.0;
        let is_same = |of: &&mut Hypothesis| {
            of.model == next.model
                && of.recorded == next.recorded
                && libm::fabs(late(of) - late(&next)) <= near_s
        };
        if let Some(same) = self.beam.iter_mut().find(is_same) {
            if next.cost < same.cost {
                *same = next;
            }
        } else if self.beam.len() < WIDTH {
            self.beam.push(next);
        } else if let Some(worst) =
            self.beam.iter_mut().max_by(|one, other| one.estimate.total_cmp(&other.estimate))
            && next.estimate < worst.estimate
        {
            *worst = next;
        }
    }
}
