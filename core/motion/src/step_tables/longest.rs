//! Finds the longest entry from a given time on that ends near the middle of a window, where the next entry begins well
//! (DESIGN B8): one parabola through as many windows as possible. A unit is 2^-fraction_bits cycle.
//!
//! Whether an entry of n steps exists is first tested with gates ([`super::feasible_window`]): seven samples, the last step,
//! and steps that an earlier entry has missed. If these allow no interval and add, all steps do not either. Otherwise the
//! entry is replayed through all windows, and the steps that it misses most become gates. So few lengths are replayed.

use crate::problem::Cause;
use crate::step_tables::entry_format::EntryFormat;
use crate::step_tables::feasible_window::{self, Fit, Gate, Goal};
use alloc::vec::Vec;

/// Maximum number of steps read ahead: 24 bytes each.
const MAX_AHEAD: usize = 1 << 20;
/// The samples are between these parts of an entry.
const SAMPLE_PARTS: usize = 8;
/// Maximum time of an entry in units, so that all sums of [`feasible_window`] fit in 64 bits.
const MAX_SPAN: u64 = 1 << 56;
// The steepest add moves the gate of the last interval by (2*n - 1)*(n - 1)*(span/(n*(n - 1)/2) + 1), less than this sum.
const _: () = assert!(4 * MAX_SPAN + 2 * MAX_AHEAD as u64 * MAX_AHEAD as u64 <= feasible_window::MAX_TIME);

/// The times that a step may have, in units, and its due cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) due_cycle: u64,
    pub(super) low: u64,
    pub(super) high: u64,
}

impl Window {
    pub(super) fn of(due_cycle: u64, (earliest, latest): (u64, u64), format: EntryFormat) -> Self {
        let [low, last] = [earliest, latest].map(|cycle| cycle << format.fraction_bits);
        Self { due_cycle, low, high: last | ((1 << format.fraction_bits) - 1) }
    }

    /// An entry with only this step, as close to the middle of its window as the minimum interval after `from` allows.
    pub(super) fn single_step(&self, from: u64, min_interval: u64, format: EntryFormat) -> LongestEntry {
        let middle = self.low + (self.high - self.low) / 2;
        let time = middle.max(from + min_interval);
        let interval = time - from;
        let max = format.max_interval();
        // If the window's end is too far for one interval, a wait comes first. It leaves half an interval.
        // In a wide window there may be no need for one; a very short wait would be no time for a timer.
        let wait = if self.high - from > max { interval.saturating_sub(max / 2) } else { 0 };
        let wait = if wait < min_interval { 0 } else { wait };
        LongestEntry { wait, interval: interval - wait, add: 0, count: 1 }
    }
}

/// An entry, and a wait before it. Times are in units.
#[derive(Clone, Copy, Debug)]
pub(super) struct LongestEntry {
    pub(super) wait: u64,
    pub(super) interval: u64,
    pub(super) add: i64,
    pub(super) count: usize,
}

/// Windows of the next steps in one direction.
pub(super) struct LookAhead {
    format: EntryFormat,
    min_interval: u64,
    windows: Vec<Window>,
    front: usize,
    /// Whether the last window is that of the last step in this direction.
    has_last: bool,
    /// Steps (from 1) that earlier entries missed.
    missed: Vec<usize>,
    gates: Vec<Gate>,
    from: u64,
}

/// Gallops from the guess, then bisects between `sampled` and `refused`; restarts below an entry whose replay fails.
#[derive(Clone, Copy)]
struct Search {
    accepted: LongestEntry,
    /// Steps of the longest entry whose samples have passed.
    sampled: usize,
    /// Steps of the shortest refused entry; above the maximum count before the first refusal.
    refused: usize,
    add: Option<i64>,
    /// Steps of the next entry to sample.
    next: usize,
}

impl Search {
    fn middle(&self) -> usize {
        self.sampled + (self.refused - self.sampled) / 2
    }
}

impl LookAhead {
    pub(super) fn new(format: EntryFormat, min_cycles: u64) -> Self {
        Self {
            format,
            min_interval: min_cycles << format.fraction_bits,
            windows: Vec::new(),
            front: 0,
            has_last: false,
            missed: Vec::new(),
            gates: Vec::new(),
            from: 0,
        }
    }

    pub(super) fn windows_mut(&mut self) -> &mut Vec<Window> {
        self.has_last = false;
        &mut self.windows
    }

    pub(super) fn first_windows(&self, count: usize) -> &[Window] {
        let left = self.left();
        left.get(..count).unwrap_or(left)
    }

    pub(super) fn remove(&mut self, count: usize) {
        self.front += count;
        if self.front >= self.windows.len() / 2 {
            self.windows.drain(..self.front.min(self.windows.len()));
            self.front = 0;
        }
    }

    fn left(&self) -> &[Window] {
        self.windows.get(self.front..).unwrap_or_default()
    }

    fn window(&self, n: usize) -> Option<&Window> {
        self.windows.get(self.front + n - 1)
    }

    /// The longest entry that begins at `from`; `None` without steps. `guess` is an estimate of its length; `fill` reads more
    /// windows and returns whether there may be others.
    pub(super) fn longest(
        &mut self,
        from: u64,
        guess: usize,
        mut fill: impl FnMut(&mut Self) -> Result<bool, Cause>,
    ) -> Result<Option<LongestEntry>, Cause> {
        self.from = from;
        self.missed.clear();
        let max_count = MAX_AHEAD.min(self.format.max_count() as usize);
        let mut read = |ahead: &mut Self, n: usize| -> Result<(), Cause> {
            while ahead.left().len() < n && !ahead.has_last {
                ahead.has_last = !fill(ahead)?;
            }
            Ok(())
        };
        read(self, 2)?;
        let Some(first) = self.single_step() else { return Ok(None) };
        if first.wait > 0 {
            return Ok(Some(first));
        }
        let next = guess + guess / 8;
        let mut search = Search { accepted: first, sampled: 1, refused: max_count + 1, add: None, next };
        loop {
            let Search { accepted, sampled, refused, add, next } = search;
            if sampled + 1 < refused {
                let n = next.clamp(sampled + 1, refused - 1);
                read(self, n)?;
                self.sample(&mut search, n, max_count);
            } else if sampled == accepted.count {
                return Ok(Some(self.with_good_end(accepted, max_count)));
            } else if let Some(longest) = self.replay(sampled, add) {
                search.accepted = longest;
            } else {
                let next = sampled - sampled / 16 - 1;
                search = Search { accepted, sampled: accepted.count, refused: sampled, add: None, next };
            }
        }
    }

    /// Tests an entry of `n` steps with its samples.
    fn sample(&mut self, search: &mut Search, n: usize, max_count: usize) {
        let available = self.left().len();
        if available < n {
            (search.refused, search.next) = (available + 1, available.max(1));
        } else if let Some(fit) = self.fit(n, search.add, Goal::Any) {
            (search.sampled, search.add) = (n, Some(fit.add));
            search.next = if search.refused > max_count { n + n / 4 + 1 } else { search.middle() };
        } else {
            search.refused = n;
            let has_samples = search.sampled > search.accepted.count;
            search.next = if has_samples { search.middle() } else { n - n / 8 - 1 };
        }
    }

    /// Gives up the last eighth of an entry whose last window is a single cycle: the longest entry ends at an edge of the
    /// cycle, a shorter one closer to the curve. With integer intervals the cycle has only one time.
    fn with_good_end(&self, entry: LongestEntry, max_count: usize) -> LongestEntry {
        let count = entry.count;
        let is_limited = count == max_count || self.ends_with(count) || self.format.fraction_bits == 0;
        let count = if is_limited || !self.is_tight(count) { count } else { count - count / 8 };
        LongestEntry { count, ..entry }
    }

    fn single_step(&self) -> Option<LongestEntry> {
        Some(self.window(1)?.single_step(self.from, self.min_interval, self.format))
    }

    /// An entry of `n` steps in their windows; `None` if none exists.
    fn replay(&mut self, n: usize, mut add: Option<i64>) -> Option<LongestEntry> {
        loop {
            let fit = self.fit(n, add, Goal::Roomy)?;
            let interval = fit.min + (fit.max - fit.min) / 2;
            let missed = self.most_missed(n, interval, fit.add);
            if missed == [None, None] {
                return Some(LongestEntry { wait: 0, interval: interval as u64, add: fit.add, count: n });
            }
            self.missed.extend(missed.into_iter().flatten());
            add = Some(fit.add);
        }
    }

    /// The steps (from 1) that are farthest before and after their windows.
    fn most_missed(&self, n: usize, interval: i64, add: i64) -> [Option<usize>; 2] {
        let (mut early, mut late) = ((0, None), (0, None));
        let (mut time, mut next) = (self.from, interval);
        for (step, window) in (1..).zip(self.first_windows(n)) {
            time = time.wrapping_add_signed(next);
            next += add;
            let before = window.low.wrapping_sub(time) as i64;
            let after = time.wrapping_sub(window.high) as i64;
            if before > early.0 {
                early = (before, Some(step));
            }
            if after > late.0 {
                late = (after, Some(step));
            }
        }
        [early.1, late.1]
    }

    /// Intervals and an add for `n` >= 2 steps that pass the samples and the missed steps.
    fn fit(&mut self, n: usize, add: Option<i64>, goal: Goal) -> Option<Fit> {
        let last = *self.window(n)?;
        // If the window is before `from`, the difference wraps to a large number.
        let span = last.high.wrapping_sub(self.from);
        if span > MAX_SPAN {
            return None;
        }
        self.collect_gates(n, span as i64);
        let count = n as i64;
        // Intervals are not negative, so |add|*n*(n - 1)/2 is at most the duration.
        let steepest = span as i64 / (count * (count - 1) / 2) + 1;
        let adds = (self.format.min_add().max(-steepest), self.format.max_add().min(steepest));
        let guess = add.unwrap_or_else(|| self.guess_add(n));
        feasible_window::fit(&self.gates, adds, guess, goal)
    }

    /// The add of a parabola through the middles of two windows.
    fn guess_add(&self, n: usize) -> i64 {
        let middle = |n: usize| {
            let window = self.window(n)?;
            Some((window.low + (window.high - window.low) / 2).wrapping_sub(self.from) as i64)
        };
        let half = n / 2;
        let (Some(far), Some(near)) = (middle(n), middle(half)) else { return 0 };
        let [far, near, n, half] = [far, near, n as i64, half as i64].map(i128::from);
        let add = 2 * (far * half - near * n) / (n * half * (n - half));
        i64::try_from(add).unwrap_or(0)
    }

    /// Collects the gates of an entry of `n` >= 2 steps with a maximum duration of `span`: those of samples and missed steps,
    /// and of the minimum and maximum interval.
    fn collect_gates(&mut self, n: usize, span: i64) {
        self.gates.clear();
        let count = n as i64;
        let (min, max) = (self.min_interval as i64, self.format.max_interval().min(MAX_SPAN) as i64);
        // At the steepest add an interval is at most 2*span/n + n/2; twice as much limits only the sums.
        let max = max.min(4 * (span / count + 1) + 2 * count);
        let max_time = |n: i64| max.saturating_mul(n).min(2 * MAX_SPAN as i64);
        // (Time of step k)/k = interval + (k - 1)/2*add is a line; at k = 2*n - 1 it is the last interval.
        let end = 2 * count - 1;
        self.gates.push(Gate { n: 1, low: min, high: max_time(1) });
        self.gates.push(Gate { n: end, low: min * end, high: max_time(end) });
        for part in 1..SAMPLE_PARTS {
            let step = n * part / SAMPLE_PARTS;
            if step > 0 && step < n {
                self.add_gate(step);
            }
        }
        for index in 0..self.missed.len() {
            if let Some(&step) = self.missed.get(index).filter(|step| **step < n) {
                self.add_gate(step);
            }
        }
        self.add_gate(n);
        let may_end_anywhere = self.ends_with(n) || self.is_tight(n);
        if let Some(gate) = self.gates.last_mut().filter(|_| !may_end_anywhere) {
            // The middle eighth; a cycle more, because due cycles are rounded; and at least `count` units, because one unit
            // of the interval moves the end by as much.
            let width = gate.high - gate.low;
            let narrow = (width / 8 + (1 << self.format.fraction_bits)).max(count).min(width);
            gate.low += (width - narrow) / 2;
            gate.high = gate.low + narrow;
        }
    }

    /// Whether no step follows step `n` in this direction.
    fn ends_with(&self, n: usize) -> bool {
        self.has_last && n == self.left().len()
    }

    /// Whether the window of step `n` is a single cycle. The curve may be anywhere in it, so its middle is no better end.
    fn is_tight(&self, n: usize) -> bool {
        self.window(n).is_some_and(|window| window.high - window.low < 1 << self.format.fraction_bits)
    }

    fn add_gate(&mut self, step: usize) {
        if let Some(window) = self.window(step) {
            let (low, high) = (window.low.wrapping_sub(self.from), window.high.wrapping_sub(self.from));
            self.gates.push(Gate { n: step as i64, low: low as i64, high: high as i64 });
        }
    }
}
