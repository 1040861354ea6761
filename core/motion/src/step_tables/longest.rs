//! The longest entry from a given time on (DESIGN B8): one parabola through as many windows as possible.
//!
//! Whether an entry of n steps exists is tested with some of its steps first ([`super::feasible_window`]): every eighth, and
//! those that an earlier try has missed. If these allow no interval and add, neither do all; if they do, the entry is
//! replayed through all of them, and the steps that it misses most are added. So a length is refused only with proof and
//! accepted only after a replay, and few lengths are replayed.

use crate::problem::Cause;
use crate::step_tables::{
    entry_format::EntryFormat,
    feasible_window::{self, Fit, Gate},
};
use alloc::vec::Vec;

/// Maximum number of steps read ahead: 24 bytes each.
const MAX_AHEAD: usize = 1 << 20;
const SAMPLES: usize = 8;
/// Maximum time of an entry in units, so that all sums of [`feasible_window`] fit in 64 bits.
const MAX_SPAN: u64 = 1 << 56;
// Gates reach to twice of it, and the steepest add a unit farther.
const _: () = assert!(2 * MAX_SPAN + MAX_AHEAD as u64 * MAX_AHEAD as u64 <= feasible_window::MAX_TIME);

#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub(super) due: u64,
    pub(super) low: u64,
    pub(super) high: u64,
}

impl Window {
    pub(super) fn of(due: u64, (earliest, latest): (u64, u64), format: EntryFormat) -> Self {
        let [low, last] = [earliest, latest].map(|cycle| cycle << format.fraction_bits);
        Self { due, low, high: last | ((1 << format.fraction_bits) - 1) }
    }

    /// An entry with this step only from a time on, as near to the middle of its window as the minimum interval allows.
    pub(super) fn first(&self, from: u64, min_interval: u64, format: EntryFormat) -> Longest {
        let middle = self.low + (self.high - self.low) / 2;
        let time = middle.max(from + min_interval);
        let interval = time - from;
        let max = format.max_interval();
        // A wait that is too long for an entry comes before it.
        let wait = if self.high - from > max { interval.saturating_sub(max / 2) } else { 0 };
        Longest { wait, interval: interval - wait, add: 0, count: 1 }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Longest {
    pub(super) wait: u64,
    pub(super) interval: u64,
    pub(super) add: i64,
    pub(super) count: usize,
}

pub(super) struct Ahead {
    format: EntryFormat,
    /// Minimum interval of two steps in units.
    least: u64,
    windows: Vec<Window>,
    /// Number of used windows.
    front: usize,
    /// Whether the last window ends the run of steps.
    ended: bool,
    /// Steps, from 1, missed by earlier tries.
    missed: Vec<usize>,
    gates: Vec<Gate>,
    from: u64,
}

impl Ahead {
    pub(super) fn new(format: EntryFormat, least_cycles: u64) -> Self {
        Self {
            format,
            least: least_cycles << format.fraction_bits,
            windows: Vec::new(),
            front: 0,
            ended: false,
            missed: Vec::new(),
            gates: Vec::new(),
            from: 0,
        }
    }

    pub(super) fn more(&mut self) -> &mut Vec<Window> {
        self.ended = false;
        &mut self.windows
    }

    pub(super) fn taken(&self, count: usize) -> &[Window] {
        let left = self.left();
        left.get(..count).unwrap_or(left)
    }

    pub(super) fn take(&mut self, count: usize) {
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

    /// The longest entry that begins at `from`; `None` if no step is left. `guess` is an estimate of its length; `fill`
    /// reads more windows and returns whether there may be more.
    pub(super) fn longest(
        &mut self,
        from: u64,
        guess: usize,
        mut fill: impl FnMut(&mut Self) -> Result<bool, Cause>,
    ) -> Result<Option<Longest>, Cause> {
        self.from = from;
        self.missed.clear();
        let most = MAX_AHEAD.min(self.format.max_count() as usize);
        let mut read = |ahead: &mut Self, n: usize| -> Result<(), Cause> {
            while ahead.left().len() < n && !ahead.ended {
                ahead.ended = !fill(ahead)?;
            }
            Ok(())
        };
        read(self, 2)?;
        let Some(first) = self.first() else { return Ok(None) };
        if first.wait > 0 {
            return Ok(Some(first));
        }
        // Accepted after replay, accepted by the samples, refused by the samples.
        let (mut taken, mut sampled, mut refused) = (first, 1, most + 1);
        let mut add = None;
        let mut n = guess + guess / 8;
        loop {
            let top = refused - 1;
            if sampled < top {
                n = n.clamp(sampled + 1, top);
                read(self, n)?;
                let there = self.left().len();
                if there < n {
                    (refused, n) = (there + 1, there.max(1));
                    continue;
                }
                match self.fit(n, add, false) {
                    Some(fit) => {
                        (sampled, add) = (n, Some(fit.add));
                        n = if refused > most { n + n / 4 + 1 } else { sampled + (refused - sampled) / 2 };
                    }
                    None => {
                        refused = n;
                        // Twice as far back as before, until a length passes.
                        n = if sampled > taken.count {
                            sampled + (refused - sampled) / 2
                        } else {
                            n - n / 8 - 1
                        };
                    }
                }
                continue;
            }
            if sampled == taken.count {
                // In whole cycles without a tolerance every entry begins in a due cycle.
                let limited = sampled == most || self.ends_with(sampled) || self.format.fraction_bits == 0;
                let count = if limited || !self.is_tight(sampled) { sampled } else { sampled - sampled / 8 };
                return Ok(Some(Longest { count, ..taken }));
            }
            match self.replay(sampled, add) {
                Some(longest) => taken = longest,
                None => {
                    refused = sampled;
                    n = sampled - sampled / 16 - 1;
                    sampled = taken.count;
                    add = None;
                }
            }
        }
    }

    fn first(&self) -> Option<Longest> {
        Some(self.window(1)?.first(self.from, self.least, self.format))
    }

    /// An entry of `n` steps that misses none; `None` with proof that there is none.
    fn replay(&mut self, n: usize, mut add: Option<i64>) -> Option<Longest> {
        loop {
            let fit = self.fit(n, add, true)?;
            let interval = fit.least + (fit.most - fit.least) / 2;
            let missed = self.missed(n, interval, fit.add);
            if missed == [None, None] {
                return Some(Longest { wait: 0, interval: interval as u64, add: fit.add, count: n });
            }
            self.missed.extend(missed.into_iter().flatten());
            add = Some(fit.add);
        }
    }

    /// The steps, from 1, that miss their windows most, before and after.
    fn missed(&self, n: usize, interval: i64, add: i64) -> [Option<usize>; 2] {
        let (mut early, mut late) = ((0, None), (0, None));
        let (mut time, mut next) = (self.from, interval);
        for (step, window) in (1..).zip(self.taken(n)) {
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

    /// An interval and an add for `n` >= 2 steps that pass the samples and the missed steps.
    fn fit(&mut self, n: usize, add: Option<i64>, centre: bool) -> Option<Fit> {
        let last = *self.window(n)?;
        let span = last.high.wrapping_sub(self.from);
        if span > MAX_SPAN {
            return None;
        }
        self.gather(n, span as i64);
        let count = n as i64;
        // Intervals are not negative, so add*n*(n - 1)/2 is at most the whole time.
        let steepest = span as i64 / (count * (count - 1) / 2) + 1;
        let adds = (self.format.min_add().max(-steepest), self.format.max_add().min(steepest));
        let guess = add.unwrap_or_else(|| self.bend(n));
        feasible_window::fit(&self.gates, adds, guess, centre)
    }

    fn bend(&self, n: usize) -> i64 {
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

    /// Collects the gates of an entry of `n` >= 2 steps with a maximum duration `span`: of samples, missed steps, and the
    /// minimum and maximum interval.
    fn gather(&mut self, n: usize, span: i64) {
        self.gates.clear();
        let count = n as i64;
        let (least, most) = (self.least as i64, self.format.max_interval().min(MAX_SPAN) as i64);
        // Twice the interval that the last gate allows at the steepest add: a longer one needs no gate.
        let most = most.min(4 * (span / count + 1) + 2 * count);
        let most = |n: i64| most.saturating_mul(n).min(2 * MAX_SPAN as i64);
        // The last interval, interval + (n - 1)*add, is the line's value at step 2*n - 1.
        let end = 2 * count - 1;
        self.gates.push(Gate { n: 1, low: least, high: most(1) });
        self.gates.push(Gate { n: end, low: least * end, high: most(end) });
        for part in 1..SAMPLES {
            let step = n * part / SAMPLES;
            if step > 0 && step < n {
                self.gate(step);
            }
        }
        for index in 0..self.missed.len() {
            if let Some(&step) = self.missed.get(index).filter(|step| **step < n) {
                self.gate(step);
            }
        }
        self.gate(n);
        let free = self.ends_with(n) || self.is_tight(n);
        if let Some(gate) = self.gates.last_mut().filter(|_| !free) {
            // Due cycles are rounded, so the curve may be anywhere within a cycle.
            let wide = gate.high - gate.low;
            let narrow = (wide / 8 + (1 << self.format.fraction_bits)).max(count).min(wide);
            gate.low += (wide - narrow) / 2;
            gate.high = gate.low + narrow;
        }
    }

    /// Whether the run ends with step `n`, so that it may end anywhere in its last window.
    fn ends_with(&self, n: usize) -> bool {
        self.ended && n == self.left().len()
    }

    /// Whether the window of step `n` is a single cycle. Its middle is then off the curve by the rounding, and an entry that
    /// goes beyond its end follows the curve better.
    fn is_tight(&self, n: usize) -> bool {
        self.window(n).is_some_and(|window| window.high - window.low < 1 << self.format.fraction_bits)
    }

    fn gate(&mut self, step: usize) {
        if let Some(window) = self.window(step) {
            let (low, high) = (window.low.wrapping_sub(self.from), window.high.wrapping_sub(self.from));
            self.gates.push(Gate { n: step as i64, low: low as i64, high: high as i64 });
        }
    }
}
