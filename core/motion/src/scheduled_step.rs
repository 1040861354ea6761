//! When the steps of an axis fall due, one after another (DESIGN B1).
//!
//! ```text
//! cycle = floor(t*clock_hz + 1/2)     t where s(t) = k - 1/2, or the time that a table gives
//! ```
//!
//! A move's own times are formed in cycles from its start, those of a timer's table and of one rate in whole
//! numbers, those of a curve in f64; to them comes the start of the move, which the decimals of those before it make, and
//! the sum is rounded once. Where the digits of an f64 do not decide that, `crossing` does.

use crate::{
    AxisPlan, Curve, PlannedMove, Profile, StepTimes,
    crossing::{MAX_OFF, Rounding, exact_cycle},
    cycle_time::{CycleTime, Quotient, Quotients},
    double::Double,
    exact::Exact,
    oscillation::Runs,
    points::PieceSteps,
    series::{BLOCK, BySeries, MAX_REST, MiddleTime, OfBlock, Series, Times},
};
use alloc::boxed::Box;
use core::ops::ControlFlow;

/// A step that is due.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScheduledStep {
    /// Its cycle, from the motion's start on.
    pub cycle: u64,
    /// Whether it goes to the right.
    pub right: bool,
}

impl AxisPlan {
    /// Steps of all moves, whichever way they go.
    #[must_use]
    pub fn step_count(&self) -> u64 {
        self.moves().iter().fold(0, |sum: u64, planned| sum.saturating_add(planned.profile.step_count()))
    }

    /// All steps in the order of their times, in cycles of a clock of `clock_hz`.
    pub fn due_steps(&self, clock_hz: u32) -> impl Iterator<Item = ScheduledStep> + '_ {
        DueSteps::of(self, clock_hz, false).map(|(_, due)| due)
    }

    /// All steps, each with its instant before B1 rounds it, in cycles of a clock of `clock_hz`.
    pub fn due_instants(&self, clock_hz: u32) -> impl Iterator<Item = (f64, ScheduledStep)> + '_ {
        DueSteps::of(self, clock_hz, true)
    }
}

/// A step with its instant before it is rounded.
type Due = (f64, ScheduledStep);

/// Steps that are formed at once. Each number has an array of its own, as the loops that write them take several at a time.
struct Block {
    /// Whether the instants are asked for: 0 where not.
    has_instants: bool,
    instants: [f64; BLOCK],
    cycles: [u64; BLOCK],
    right: [bool; BLOCK],
}

impl Block {
    fn new(has_instants: bool) -> Self {
        Self { has_instants, instants: [0.0; BLOCK], cycles: [0; BLOCK], right: [false; BLOCK] }
    }

    /// Its steps from one on and before another.
    fn steps(&self, from: usize, to: usize) -> impl Iterator<Item = Due> {
        let steps = self.instants.iter().zip(&self.cycles).zip(&self.right).take(to).skip(from);
        steps.map(|((instant, &cycle), &right)| (*instant, ScheduledStep { cycle, right }))
    }

    /// Writes the instants of steps that are due so many cycles after another, if they are asked for.
    fn put_instants(&mut self, from: f64, cycles: &[f64; BLOCK]) {
        if self.has_instants {
            for (instant, cycles) in self.instants.iter_mut().zip(cycles) {
                *instant = from + cycles;
            }
        }
    }
}

/// What forms a move's steps.
trait Form {
    /// Writes the next ones from the block's beginning on, and says how many: none at the end.
    fn next_block(&mut self, block: &mut Block) -> usize;
}

/// The steps of a move, each with its instant, one after another.
type Steps<'p> = Box<dyn Form + 'p>;

/// The steps of an axis, move after move.
struct DueSteps<'p> {
    moves: core::slice::Iter<'p, PlannedMove>,
    /// Of the next move.
    start: CycleTime,
    clock_hz: u32,
    /// Of this move.
    form: Option<Steps<'p>>,
    block: Block,
    /// Of the block the next one, and how many there are.
    at: usize,
    len: usize,
}

impl<'p> DueSteps<'p> {
    fn of(plan: &'p AxisPlan, clock_hz: u32, has_instants: bool) -> Self {
        let (moves, start, block) = (plan.moves().iter(), CycleTime::default(), Block::new(has_instants));
        Self { moves, start, clock_hz, form: None, block, at: 0, len: 0 }
    }

    /// Forms the next steps; whether there are any.
    #[inline(never)]
    fn next_block(&mut self) -> bool {
        loop {
            self.at = 0;
            self.len = self.form.as_mut().map_or(0, |form| form.next_block(&mut self.block));
            if self.len > 0 {
                return true;
            }
            let Some(PlannedMove { profile, .. }) = self.moves.next() else { return false };
            self.form = due_from(profile, self.start, self.clock_hz);
            self.start = self.start.plus(profile.length(self.clock_hz));
        }
    }
}

impl Iterator for DueSteps<'_> {
    type Item = Due;

    #[inline]
    fn next(&mut self) -> Option<Due> {
        if self.at >= self.len && !self.next_block() {
            return None;
        }
        let Block { instants, cycles, right, .. } = &self.block;
        let at = self.at % BLOCK;
        self.at += 1;
        Some((instants[at], ScheduledStep { cycle: cycles[at], right: right[at] }))
    }

    /// Block by block.
    #[inline]
    fn fold<T, F: FnMut(T, Due) -> T>(mut self, first: T, mut f: F) -> T {
        let mut folded = first;
        while self.at < self.len || self.next_block() {
            folded = self.block.steps(self.at, self.len).fold(folded, &mut f);
            self.at = self.len;
        }
        folded
    }
}

/// The steps of a move that starts at `start`: of a timer's table and of one rate the quotients that whole numbers make,
/// of the others those of their times in f64; none where it has none.
fn due_from(profile: &Profile, start: CycleTime, clock_hz: u32) -> Option<Steps<'_>> {
    let clock = f64::from(clock_hz);
    let (right, count) = (profile.steps() >= 0, profile.steps().unsigned_abs());
    let steps = 1..count + 1;
    let form: Steps<'_> = match profile {
        Profile::Trapezoid(curve) => {
            let times = curve.step_times(clock_hz);
            scheduled(profile, start, clock_hz, OfTrapezoid { times, right })
        }
        Profile::TrapezoidTable(table) => {
            Box::new(OfQuotients::new(table.step_quotients(clock_hz), start, right))
        }
        Profile::Staircase(staircase) => {
            let times = staircase.due_s().map(move |due_s| (due_s * clock, right));
            scheduled(profile, start, clock_hz, times)
        }
        Profile::SineSegments(sine) => {
            scheduled(profile, start, clock_hz, OfRuns(sine.due_points(sine.point_s() * clock)))
        }
        Profile::Sine(sine) => {
            scheduled(profile, start, clock_hz, OfRuns(sine.due_halves(sine.period_s() / 2.0 * clock)))
        }
        Profile::Points(points) => {
            Box::new(OfPoints { pieces: points.due(), piece: None, cycles: [0.0; BLOCK], start, clock_hz })
        }
        Profile::Constant(constant) => match constant.even_steps(clock_hz) {
            Some(even) => Box::new(OfQuotients::new(even.steps(count), start, right)),
            None => {
                let cycles_per_step = clock / constant.exact_speed().high;
                let times = steps.map(move |k| ((k as f64 - 0.5) * cycles_per_step, right));
                scheduled(profile, start, clock_hz, times)
            }
        },
        Profile::Dwell(_) => return None,
        Profile::Sliced(curve) => {
            scheduled(profile, start, clock_hz, curve.due_s().map(move |due_s| (due_s * clock, right)))
        }
        Profile::Cosine(curve) => by_series(profile, Box::new(*curve), start, clock_hz),
        Profile::Ramps(curve) => by_series(profile, Box::new(*curve), start, clock_hz),
        Profile::JerkLimited(curve) => by_series(profile, Box::new(*curve), start, clock_hz),
    };
    Some(form)
}

/// Steps that are due at quotients of whole numbers after the move's start, all one way.
struct OfQuotients<Q> {
    times: Q,
    /// Of a block's steps.
    rests: [u64; BLOCK],
    start: CycleTime,
    right: bool,
}

impl<Q: Quotients> OfQuotients<Q> {
    fn new(times: Q, start: CycleTime, right: bool) -> Self {
        Self { times, rests: [0; BLOCK], start, right }
    }
}

impl<Q: Quotients> Form for OfQuotients<Q> {
    fn next_block(&mut self, block: &mut Block) -> usize {
        let Self { times, rests, start, right } = self;
        let Block { has_instants, instants, cycles, right: directions } = block;
        *directions = [*right; BLOCK];
        // The whole cycles first.
        let (len, under) = (times.next_block(cycles, rests), times.under());
        if !*has_instants && start.part == Double::default() {
            for (cycle, rest) in cycles.iter_mut().zip(&*rests).take(len) {
                *cycle = Quotient { whole: *cycle, rest: *rest, under }.cycle_after(start.whole);
            }
        } else {
            for ((instant, cycle), rest) in instants.iter_mut().zip(cycles).zip(&*rests).take(len) {
                (*instant, *cycle) = Quotient { whole: *cycle, rest: *rest, under }.after(*start);
            }
        }
        len
    }
}

/// The steps of a move that starts at `start`, of their times in cycles from there on and their directions.
fn scheduled<'p>(
    profile: &'p Profile,
    start: CycleTime,
    clock_hz: u32,
    times: impl UnroundedTimes + 'p,
) -> Steps<'p> {
    let (rounding, is_due_before) = profile.rounding(start, clock_hz);
    let exact_times = profile.exact_times(clock_hz);
    let ends = Ends { first: 1, start, rounding, exact_times, is_due_before };
    Box::new(OfTimes { times, cycles: [0.0; BLOCK], ends })
}

/// Times of a move's steps in cycles from its start, not rounded, with their directions.
trait UnroundedTimes {
    /// Writes the next times, and with them the directions, from the blocks' beginning on, and says how many: none at the
    /// end.
    fn next_block(&mut self, cycles: &mut [f64; BLOCK], right: &mut [bool; BLOCK]) -> usize;
}

/// Told one by one.
impl<I: Iterator<Item = (f64, bool)>> UnroundedTimes for I {
    fn next_block(&mut self, cycles: &mut [f64; BLOCK], right: &mut [bool; BLOCK]) -> usize {
        let mut len = 0;
        let _ = self.try_for_each(|(time, goes_right)| {
            (cycles[len % BLOCK], right[len % BLOCK]) = (time, goes_right);
            len += 1;
            if len < BLOCK { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        len
    }
}

/// Of a trapezoid, all one way.
struct OfTrapezoid {
    times: StepTimes,
    right: bool,
}

impl UnroundedTimes for OfTrapezoid {
    fn next_block(&mut self, cycles: &mut [f64; BLOCK], right: &mut [bool; BLOCK]) -> usize {
        *right = [self.right; BLOCK];
        self.times.next_block(cycles)
    }
}

/// Of an oscillation, from one run to the next.
struct OfRuns<R>(R);

impl<R: Runs> UnroundedTimes for OfRuns<R> {
    fn next_block(&mut self, cycles: &mut [f64; BLOCK], right: &mut [bool; BLOCK]) -> usize {
        let mut len = 0;
        while let Some(rest) = cycles.get_mut(len..).filter(|rest| !rest.is_empty()) {
            let (formed, goes_right) = self.0.next_run(rest);
            if formed == 0 {
                break;
            }
            // All of them at once, as a block seldom has two runs.
            if len == 0 {
                *right = [goes_right; BLOCK];
            } else {
                right.iter_mut().skip(len).for_each(|right| *right = goes_right);
            }
            len += formed;
        }
        len
    }
}

/// Steps whose times are rounded.
struct OfTimes<'p, T> {
    times: T,
    /// Of a block's steps, from the move's start on.
    cycles: [f64; BLOCK],
    ends: Ends<'p>,
}

impl<T: UnroundedTimes> Form for OfTimes<'_, T> {
    fn next_block(&mut self, block: &mut Block) -> usize {
        let len = self.times.next_block(&mut self.cycles, &mut block.right);
        self.ends.put(block, &self.cycles, len);
        len
    }
}

/// What makes cycles of times.
struct Ends<'p> {
    /// The next step, from 1.
    first: u64,
    start: CycleTime,
    rounding: Rounding,
    /// Of curves whose steps would take long to judge.
    exact_times: Option<ExactTimes<'p>>,
    is_due_before: IsDueBefore<'p>,
}

impl Ends<'_> {
    /// Writes the instants and cycles of a block's `len` steps.
    #[inline(never)]
    fn put(&mut self, block: &mut Block, cycles: &[f64; BLOCK], len: usize) {
        let (start, rounding) = (self.start.cycles(), self.rounding);
        // All of them without a question, as in `rounded`: a loop that calls nothing keeps its numbers in registers.
        let mut are_certain = true;
        for (cycle, cycles) in block.cycles.iter_mut().zip(cycles).take(len) {
            let from_middle;
            (*cycle, from_middle) = rounding.after_start(0, *cycles);
            are_certain &= rounding.is_certain(from_middle);
        }
        block.put_instants(start, cycles);
        if !are_certain {
            for ((k, cycle), cycles) in (self.first..).zip(block.cycles.iter_mut().take(len)).zip(cycles) {
                if rounding.is_certain(rounding.after_start(0, *cycles).1) {
                    continue;
                }
                let exact = self.exact_times.as_mut().and_then(|time| exact_cycle(self.start, time(k)));
                *cycle = exact
                    .unwrap_or_else(|| rounding.cycle((0, *cycles), |since| (self.is_due_before)(k, since)));
            }
        }
        self.first += len as u64;
    }
}

/// The steps of a move that goes one way along a curve with power series.
fn by_series<'p>(
    profile: &'p Profile,
    curve: Box<dyn Series + 'p>,
    start: CycleTime,
    clock_hz: u32,
) -> Steps<'p> {
    let clock = f64::from(clock_hz);
    let times = BySeries::new(curve, clock, 0.5, profile.steps().unsigned_abs());
    let judge = Judge { off: profile.off(clock), is_due_before: profile.is_due_before(clock_hz) };
    Box::new(OfSeries { times, cycles: [0.0; BLOCK], judge, right: profile.steps() >= 0, start })
}

/// Steps whose times come many at once.
struct OfSeries<'p> {
    times: BySeries<'p>,
    /// Of a block's steps.
    cycles: [f64; BLOCK],
    judge: Judge<'p>,
    right: bool,
    start: CycleTime,
}

/// What tells when a step is due where f64 does not.
struct Judge<'p> {
    /// How far a time that is searched for may be off, in cycles.
    off: f64,
    is_due_before: IsDueBefore<'p>,
}

/// How far off a time in f64 may be, in cycles, for the middle of a block not to be told anew: one step in 500 is judged
/// then, and a block has as many.
const MAX_OFF_IN_BLOCK: f64 = 1.0 / 1024.0;

impl Judge<'_> {
    /// When a step (from 0) is due near a time that f64 does not tell well.
    fn exactly(&self, step: u64, near: MiddleTime) -> Option<MiddleTime> {
        if self.off <= MAX_OFF_IN_BLOCK {
            return None;
        }
        let whole = Double::from(near.whole);
        let is_due_by = |part: f64| (self.is_due_before)(step + 1, whole + part.into());
        let (mut low, mut high) = (near.part - self.off, near.part + self.off);
        if is_due_by(low) || !is_due_by(high) {
            return None;
        }
        while high - low > MAX_REST {
            let middle = low + (high - low) / 2.0;
            if is_due_by(middle) { high = middle } else { low = middle }
        }
        Some(MiddleTime { part: high, is_exact: true, ..near })
    }
}

impl Form for OfSeries<'_> {
    fn next_block(&mut self, block: &mut Block) -> usize {
        let Self { times, cycles, judge, right, start } = self;
        let Some(found) = times.times(cycles, &|step, near| judge.exactly(step, near)) else { return 0 };
        let by_search = Rounding::new(*start, judge.off);
        let rounding = |of_block: OfBlock| match of_block.time.is_exact {
            true => Rounding::new(*start, of_block.off + MAX_REST),
            false => by_search.less(of_block.off),
        };
        rounded(block, (cycles, found), (*start, *right), &rounding, &|step| {
            let cycles = times.searched(step);
            let cycle = by_search.cycle((0, cycles), |since| (judge.is_due_before)(step + 1, since));
            (start.cycles() + cycles, cycle)
        })
    }
}

/// The steps of a curve through points, piece after piece.
struct OfPoints<'p, I> {
    pieces: I,
    piece: Option<(PieceSteps<'p>, BySeries<'p>)>,
    /// Of a block's steps.
    cycles: [f64; BLOCK],
    start: CycleTime,
    clock_hz: u32,
}

impl<'p, I: Iterator<Item = PieceSteps<'p>>> OfPoints<'p, I> {
    /// The next steps of a piece that has some.
    fn next_times(&mut self) -> Option<(PieceSteps<'p>, Times)> {
        loop {
            if let Some((steps, by_series)) = &mut self.piece
                && let Some(found) = by_series.times(&mut self.cycles, &|_, _| None)
            {
                return Some((*steps, found));
            }
            let steps = self.pieces.next()?;
            self.piece = Some((steps, steps.by_series(self.clock_hz)));
        }
    }
}

impl<'p, I: Iterator<Item = PieceSteps<'p>>> Form for OfPoints<'p, I> {
    fn next_block(&mut self, block: &mut Block) -> usize {
        let Some((steps, found)) = self.next_times() else { return 0 };
        let (start, clock_hz) = (self.start, self.clock_hz);
        let rounding = |OfBlock { off, least_speed, .. }| {
            Rounding::new(start, off + steps.off_s(least_speed) * f64::from(clock_hz))
        };
        rounded(block, (&self.cycles, found), (start, steps.right()), &rounding, &|step| {
            steps.due(step).cycle(start, clock_hz)
        })
    }
}

/// Writes the steps whose times a block tells, in cycles after the start of their move, and where it does not tell them
/// what is found by a search: the instant and the cycle of a step (from 0). Says how many.
#[inline]
fn rounded(
    block: &mut Block,
    (cycles, Times { first, len, of_block }): (&[f64; BLOCK], Times),
    (start, right): (CycleTime, bool),
    rounding: &dyn Fn(OfBlock) -> Rounding,
    searched: &dyn Fn(u64) -> (f64, u64),
) -> usize {
    block.right = [right; BLOCK];
    let Some(of_block) = of_block else {
        for (step, place) in (first..).zip(0..len) {
            (block.instants[place % BLOCK], block.cycles[place % BLOCK]) = searched(step);
        }
        return len;
    };
    let (whole, rounding) = (of_block.time.whole, rounding(of_block));
    let from = start.cycles() + whole as f64;
    // All of them without a question, which is seldom of use.
    let mut are_certain = true;
    for (cycle, cycles) in block.cycles.iter_mut().zip(cycles).take(len) {
        let from_middle;
        (*cycle, from_middle) = rounding.after_start(whole, *cycles);
        are_certain &= rounding.is_certain(from_middle);
    }
    block.put_instants(from, cycles);
    if !are_certain {
        for ((step, place), cycles) in (first..).zip(0..len).zip(cycles) {
            if !rounding.is_certain(rounding.after_start(whole, *cycles).1) {
                (block.instants[place % BLOCK], block.cycles[place % BLOCK]) = searched(step);
            }
        }
    }
    len
}

/// Whether a step (from 1) is due before a time in cycles from its move's start.
pub(super) type IsDueBefore<'p> = Box<dyn Fn(u64, Double) -> bool + 'p>;

/// When a step (from 1) is due in cycles from its move's start, in 106 bits.
type ExactTimes<'p> = Box<dyn FnMut(u64) -> Double + 'p>;

impl Profile {
    /// How long the move lasts: what its decimals make, where it is told by them.
    pub(super) fn length(&self, clock_hz: u32) -> CycleTime {
        let clock = f64::from(clock_hz);
        let told =
            |duration_s: f64, times: f64| CycleTime::exact(&Exact::of(duration_s).times(times).times(clock));
        match self {
            Self::TrapezoidTable(table) => table.step_time(self.steps().unsigned_abs(), clock_hz).time(),
            Self::Constant(constant) => {
                let steps = Double::from(self.steps().unsigned_abs());
                CycleTime::of(steps / constant.exact_speed() * clock.into())
            }
            Self::Sine(sine) => told(sine.period_s(), sine.periods().into()),
            Self::SineSegments(sine) => told(sine.period_s(), sine.periods().into()),
            Self::Cosine(_) | Self::Ramps(_) | Self::Dwell(_) => told(self.duration_s(), 1.0),
            Self::Points(points) => CycleTime::of(points.exact_duration() * clock.into()),
            Self::Trapezoid(curve) => CycleTime::of(curve.exact_duration() * clock.into()),
            Self::JerkLimited(curve) => CycleTime::of(curve.exact_duration() * clock.into()),
            Self::Staircase(curve) => CycleTime::of(curve.exact_duration() * clock.into()),
            Self::Sliced(curve) => CycleTime::of(curve.exact_duration() * clock.into()),
        }
    }

    /// How far the times of its steps in f64 may be off, in cycles of a clock.
    pub(super) fn off(&self, clock: f64) -> f64 {
        match self {
            Self::Trapezoid(curve) => curve.off(clock),
            Self::Staircase(curve) => curve.off_s() * clock,
            Self::Sliced(curve) => curve.off_s() * clock,
            _ => MAX_OFF * self.duration_s() * clock,
        }
    }

    /// Whether a step is due before a time, for certain.
    pub(super) fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        match self {
            Self::Trapezoid(curve) => Box::new(curve.is_due_before(clock_hz)),
            Self::Staircase(curve) => Box::new(curve.is_due_before(clock_hz)),
            Self::Sliced(curve) => Box::new(curve.is_due_before(clock_hz)),
            Self::Cosine(curve) => Box::new(curve.is_due_before(clock_hz)),
            Self::Ramps(curve) => Box::new(curve.is_due_before(clock_hz)),
            Self::JerkLimited(curve) => Box::new(curve.is_due_before(clock_hz)),
            Self::Sine(sine) => Box::new(sine.is_due_before(clock_hz)),
            Self::SineSegments(sine) => {
                let time = sine.exact_times(clock_hz);
                Box::new(move |k, since| since.exceeds(time(k)))
            }
            Self::Constant(constant) => {
                let interval = Double::from(f64::from(clock_hz)) / constant.exact_speed();
                Box::new(move |k, since| since.exceeds(interval * (k as f64 - 0.5).into()))
            }
            Self::TrapezoidTable(table) => {
                Box::new(move |k, since| since.exceeds(table.step_time(k, clock_hz).time().double()))
            }
            // They are asked by their pieces, or have none.
            Self::Points(_) | Self::Dwell(_) => Box::new(|_, _| false),
        }
    }

    /// When its steps are due, where that is quicker than to judge the edges next to them.
    fn exact_times(&self, clock_hz: u32) -> Option<ExactTimes<'_>> {
        match self {
            Self::Sine(sine) => Some(Box::new(sine.exact_times(clock_hz))),
            Self::SineSegments(sine) => Some(Box::new(sine.exact_times(clock_hz))),
            _ => None,
        }
    }

    /// How the times of its steps in f64 become cycles, if it starts at `start`, and what judges them where they do not
    /// tell.
    fn rounding(&self, start: CycleTime, clock_hz: u32) -> (Rounding, IsDueBefore<'_>) {
        (Rounding::new(start, self.off(clock_hz.into())), self.is_due_before(clock_hz))
    }

    /// The cycle of step `k` (from 1) after the move's start, of a clock of `clock_hz`, without iterating
    /// over those before it; `None` past the last one, and for sine segments, whose steps are only known in their order.
    #[must_use]
    pub fn step_cycle(&self, k: u64, clock_hz: u32) -> Option<u64> {
        if k == 0 || k > self.step_count() {
            return None;
        }
        let (clock, place, start) = (f64::from(clock_hz), k as f64 - 0.5, CycleTime::default());
        let cycles = match self {
            Self::Trapezoid(curve) => return curve.step_times(clock_hz).nth(usize::try_from(k - 1).ok()?),
            Self::TrapezoidTable(table) => return Some(table.step_time(k, clock_hz).after(start).1),
            Self::Staircase(staircase) => staircase.step_s(k) * clock,
            Self::Sine(sine) => sine.due_half(k) * (sine.period_s() / 2.0 * clock),
            Self::Points(points) => {
                return Some(points.step(k)?.cycle(start, clock_hz).1);
            }
            Self::Constant(constant) => match constant.even_steps(clock_hz) {
                Some(even) => return Some(even.step(k).after(start).1),
                None => place * (clock / constant.exact_speed().high),
            },
            Self::SineSegments(_) | Self::Dwell(_) => return None,
            one_way => one_way.time_s(place) * clock,
        };
        let (rounding, is_due_before) = self.rounding(start, clock_hz);
        Some(rounding.cycle((0, cycles), |since| is_due_before(k, since)))
    }
}

#[cfg(test)]
mod tests;
