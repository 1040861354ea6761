//! Finds the fewest entries through the windows of a list's steps (DESIGN B8).
//!
//! ```text
//! layer e      for each step, the times of its window that at most e entries can reach: one bit per time
//! full         the last step of a layer that can have any time of its window
//! last         the last step of a layer that can have any time at all
//! ```
//!
//! The number of the first layer that reaches the last step is the minimum. The path back through the layers is the list. The
//! search is exhaustive:
//!
//! 1. An entry without its last or first steps is an entry. So entries only need to begin at steps from the layer's full step
//!    to its last.
//! 2. From each of these steps, every interval and add that the windows allow is tried. Each window narrows the range of
//!    start times ([`Section::narrowed`]), which are processed together, as a shifted copy of the step's bits.
//! 3. Entries of one and two steps have a closed form ([`Section::one_and_two`]), short ones are tried per time
//!    ([`Section::short`]), and entries to full steps are skipped. The other combinations are about the square of a window's
//!    width over the cube of the count.
//!
//! A long list is cut into sections, which costs at most one entry per cut if neighboring windows do not overlap.

use crate::step_tables::{entry_format::EntryFormat, feasible_window::ceiling, longest::Window};
use alloc::{vec, vec::Vec};
use core::ops::RangeInclusive;

/// Maximum width of a window in units, because the work grows with its square.
pub(super) const MAX_WIDTH: u64 = 1 << 12;
pub(super) const MAX_STEPS: usize = 1 << 17;
/// Maximum steps of an entry that is tried per time.
const SHORT: usize = 4;
/// Maximum words of a section's layers, 32 MB; larger sections are cut.
const MAX_WORDS: usize = 1 << 22;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FoundEntry {
    pub(super) count: usize,
    pub(super) interval: i64,
    pub(super) add: i64,
}

/// The times of a step, in units from the section's start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct StepWindow {
    low: i64,
    high: i64,
    due: i64,
    /// The last step before the next change of direction; an entry that begins here ends there at the latest.
    last_in_direction: usize,
}

impl StepWindow {
    const fn width(self) -> usize {
        (self.high - self.low + 1) as usize
    }
}

/// Steps that are searched together. Step 0 is their start.
pub(super) struct Section {
    format: EntryFormat,
    min_interval: i64,
    max_interval: i64,
    windows: Vec<StepWindow>,
    stride: usize,
}

/// The times that a number of entries can reach, from step `first` on.
struct Layer {
    first: usize,
    stride: usize,
    words: Vec<u64>,
}

/// Times of one step at which entries begin.
#[derive(Clone, Copy)]
struct StartTimes<'a> {
    step: usize,
    bits: &'a [u64],
    first: i64,
    last: i64,
}

impl Section {
    /// The steps of `given`, each with its direction, after the time `from`. No window is wider than [`MAX_WIDTH`] or
    /// farther from the one before than an entry's interval allows.
    pub(super) fn new(format: EntryFormat, min_interval: u64, from: u64, given: &[(Window, bool)]) -> Self {
        let time = |units: u64| units.wrapping_sub(from) as i64;
        let mut windows = vec![StepWindow { low: 0, high: 0, due: 0, last_in_direction: 0 }];
        windows.extend(given.iter().map(|(window, _)| StepWindow {
            low: time(window.low),
            high: time(window.high),
            due: time(window.due_cycle << format.fraction_bits),
            last_in_direction: 0,
        }));
        let mut last_in_direction = given.len();
        for (step, window) in windows.iter_mut().enumerate().rev() {
            window.last_in_direction = last_in_direction;
            let directions = step.checked_sub(1).and_then(|before| given.get(before..=step));
            if let Some([(_, before), (_, after)]) = directions
                && before != after
            {
                last_in_direction = step;
            }
        }
        let stride = windows.iter().map(|window| window.width().div_ceil(64)).max().unwrap_or(1);
        let max_interval = i64::try_from(format.max_interval()).unwrap_or(i64::MAX);
        Self { format, min_interval: min_interval as i64, max_interval, windows, stride }
    }

    /// The fewest entries to the last step or, if the list `is_cut` after it, to a step from which to continue. Subtracts the
    /// work done from `work`; `None` if it is not enough.
    pub(super) fn fewest_entries(&self, is_cut: bool, work: &mut u64) -> Option<Vec<FoundEntry>> {
        let last = self.windows.len() - 1;
        let mut words = vec![0; self.stride];
        words[0] = 1;
        let mut layers = vec![Layer { first: 0, stride: self.stride, words }];
        let mut words_used = 0;
        while let Some(layer) = layers.last().filter(|layer| layer.last() < last) {
            let next = self.next(layer, work)?;
            if next.last() <= layer.last() {
                return None;
            }
            words_used += next.words.len();
            if layers.len() > 1 && (words_used > MAX_WORDS || is_cut && next.last() == last) {
                break;
            }
            layers.push(next);
        }
        self.path_back(&layers)
    }

    /// The layer with one more entry; `None` if `work` is not enough.
    fn next(&self, layer: &Layer, work: &mut u64) -> Option<Layer> {
        let mut next = Layer { first: layer.first, stride: self.stride, words: layer.words.clone() };
        let mut spent = layer.words.len() as u64;
        for step in layer.first..=layer.last() {
            if let Some(begin) = self.begin(layer, step) {
                spent += self.one_and_two(begin, &mut next);
            }
        }
        *work = work.checked_sub(spent)?;
        // The first step that is not full in the next layer.
        let mut open = layer.first;
        for step in layer.first..=layer.last() {
            while next.is_full(open, self.windows.get(open).map_or(0, |window| window.width())) {
                open += 1;
            }
            if let Some(begin) = self.begin(layer, step) {
                let min_count = open.saturating_sub(step).max(3);
                let mut spent = 0;
                for count in min_count..=SHORT {
                    spent += self.short(begin, count, &mut next);
                }
                spent += self.longer(begin, layer, min_count.max(SHORT + 1), &mut next);
                *work = work.checked_sub(spent)?;
            }
        }
        next.remove_before_last_full(&self.windows);
        Some(next)
    }

    fn begin<'a>(&self, layer: &'a Layer, step: usize) -> Option<StartTimes<'a>> {
        let bits = layer.bits(step)?;
        let (first, last) = ends(bits)?;
        let low = self.windows[step].low;
        Some(StartTimes { step, bits, first: low + first, last: low + last })
    }

    /// Marks the times that entries of one and two steps reach; returns the number of start times examined.
    fn one_and_two(&self, begin: StartTimes<'_>, next: &mut Layer) -> u64 {
        let Some(&one) = self.windows.get(begin.step + 1) else { return 1 };
        next.set(begin.step + 1, one, (begin.first + self.min_interval, one.high));
        let Some(&two) = self
            .windows
            .get(begin.step + 2)
            .filter(|_| begin.step + 2 <= self.windows[begin.step].last_in_direction)
        else {
            return 1;
        };
        let (min_add, max_add) = (self.format.min_add(), self.format.max_add());
        // The times of the first step determine the range of the second.
        let range = |from: i64| {
            let (min_one, max_one) =
                (one.low.max(from + self.min_interval), one.high.min(from + self.max_interval));
            (min_one <= max_one).then(|| {
                let low = (min_one + self.min_interval).max((2 * min_one - from).saturating_add(min_add));
                let high = (max_one + self.max_interval).min((2 * max_one - from).saturating_add(max_add));
                (low, high)
            })
        };
        let low = self.windows[begin.step].low;
        let mut spent = 1;
        for from in times(begin.bits).map(|bit| low + bit) {
            spent += 1;
            let Some((low, high)) = range(from) else { continue };
            next.set(begin.step + 2, two, (low, high));
            if high >= two.high
                && low <= two.low.max(one.low.max(from + self.min_interval) + self.min_interval)
            {
                // Later start times reach no other times.
                return spent;
            }
        }
        spent
    }

    /// Marks the times that entries of `count` >= 3 steps reach; returns the number of steps examined. With
    /// time 0 at the start and `time` at the end, step m is at m*time/count - add*m*(count - m)/2: so the windows allow a
    /// range of adds, and the interval is an integer for every add, or for every second.
    fn short(&self, begin: StartTimes<'_>, count: usize, next: &mut Layer) -> u64 {
        let end = begin.step + count;
        let Some(&window) =
            self.windows.get(end).filter(|_| end <= self.windows[begin.step].last_in_direction)
        else {
            return 1;
        };
        let inner = &self.windows[begin.step + 1..end];
        let (low, mut spent) = (self.windows[begin.step].low, 1);
        for time in window.low..=window.high {
            if next.bits(end).is_some_and(|bits| is_set(bits, time - window.low)) {
                continue;
            }
            let is_reached = times(begin.bits).any(|bit| {
                spent += 1;
                self.has_short_entry(low + bit, time, inner)
            });
            if is_reached {
                next.set(end, window, (time, time));
            }
        }
        spent
    }

    /// Whether an entry goes from a time through the inner windows to a time after them.
    fn has_short_entry(&self, from: i64, time: i64, inner: &[StepWindow]) -> bool {
        let (n, duration) = (inner.len() as i64 + 1, time - from);
        let odd = match duration.rem_euclid(n) {
            0 => 0,
            part if 2 * part == n => 1,
            _ => return false,
        };
        let (mut min, mut max) = self.adds_of(duration, n);
        for (m, window) in (1..).zip(inner) {
            let (bend, far) = (n * m * (n - m), 2 * m * duration);
            min = min.max(ceiling(far - 2 * n * (window.high - from), bend));
            max = max.min((far - 2 * n * (window.low - from)).div_euclid(bend));
        }
        // With an even count every second add has an integer interval.
        if n % 2 == 0 && min.rem_euclid(2) != odd { min < max } else { min <= max }
    }

    /// The adds of `n` steps whose first and last intervals are in range.
    fn adds_of(&self, duration: i64, n: i64) -> (i64, i64) {
        // The mean interval is duration/n, and the outer ones differ from it by half of n - 1 adds.
        let room = (duration - n * self.min_interval).min(n * self.max_interval - duration);
        let max = (2 * room).div_euclid(n * (n - 1));
        ((-max).max(self.format.min_add()), max.min(self.format.max_add()))
    }

    /// Marks the times that entries of at least `min_count` steps reach; returns the number of combinations examined.
    fn longer(&self, begin: StartTimes<'_>, layer: &Layer, min_count: usize, next: &mut Layer) -> u64 {
        let (step, mut spent) = (begin.step, 8);
        let last = self.windows[step].last_in_direction.min(step + self.format.max_count() as usize);
        let Some(&target) = self.windows.get(step + min_count).filter(|_| step + min_count <= last) else {
            return spent;
        };
        let mut exits = vec![0; self.stride];
        for add in self.adds(begin, min_count, target) {
            spent += 8;
            for interval in self.intervals(begin, min_count, target, add) {
                spent += 1 + self.stride as u64 / 4;
                let Some(exit) = self.exits(begin, layer, interval, &mut exits) else { continue };
                let (mut range, mut time, mut now) = ((exit.first, exit.last), 0, interval);
                for count in 1..=last - step {
                    spent += 1;
                    time += now;
                    let Some(narrowed) = self.narrowed(range, step + count, time, now) else { break };
                    (range, now) = (narrowed, now + add);
                    if count >= min_count && !next.reached(exit, &self.windows, step + count, range, time) {
                        break;
                    }
                }
            }
        }
        spent
    }

    /// The part of a range of start times from which a step, `time` later, is in its window; `None` if there is none, or if
    /// the interval `now` is out of range.
    fn narrowed(&self, (first, last): (i64, i64), step: usize, time: i64, now: i64) -> Option<(i64, i64)> {
        let window = self.windows.get(step)?;
        let range = (first.max(window.low - time), last.min(window.high - time));
        (range.0 <= range.1 && (self.min_interval..=self.max_interval).contains(&now)).then_some(range)
    }

    /// The start times from which the entry's first step leaves the layer.
    fn exits<'a>(
        &self,
        begin: StartTimes<'a>,
        layer: &Layer,
        interval: i64,
        exits: &'a mut [u64],
    ) -> Option<StartTimes<'a>> {
        let Some(after) = layer.bits(begin.step + 1) else { return Some(begin) };
        let (here, there) = (self.windows[begin.step].low, self.windows[begin.step + 1].low);
        let (mut first, mut last) = (None, 0);
        for index in (begin.first - here) / 64..=(begin.last - here) / 64 {
            let exit = begin.bits[index as usize] & !word_at(after, index * 64 + here + interval - there);
            exits[index as usize] = exit;
            if exit != 0 {
                first = first.or(Some(index * 64 + i64::from(exit.trailing_zeros())));
                last = index * 64 + 63 - i64::from(exit.leading_zeros());
            }
        }
        Some(StartTimes { step: begin.step, bits: exits, first: here + first?, last: here + last })
    }

    fn adds(&self, begin: StartTimes<'_>, count: usize, target: StepWindow) -> RangeInclusive<i64> {
        let half = count / 2;
        let (n, h) = (count as i128, half as i128);
        // The add of a parabola through the start, `near` after `half` steps, and `far` after `count` steps, times `over`.
        let through = |far: i64, near: i64| 2 * (i128::from(far) * h - i128::from(near) * n);
        let middle = self.windows[begin.step + half];
        let over = n * h * (n - h);
        let min = through(target.low - begin.last, middle.high - begin.first);
        let max = through(target.high - begin.first, middle.low - begin.last);
        let min = min.div_euclid(over) + i128::from(min.rem_euclid(over) > 0);
        let min = min.max(self.format.min_add().into());
        let max = max.div_euclid(over).min(self.format.max_add().into());
        let narrow = |add: i128| i64::try_from(add).unwrap_or(if add < 0 { i64::MIN } else { i64::MAX });
        narrow(min)..=narrow(max)
    }

    fn intervals(
        &self,
        begin: StartTimes<'_>,
        count: usize,
        target: StepWindow,
        add: i64,
    ) -> RangeInclusive<i64> {
        let grows = add * (count as i64 - 1);
        let mut min = self.min_interval.max(self.min_interval - grows);
        let mut max = self.max_interval.min(self.max_interval - grows);
        let mut n = 1;
        while n <= count && min <= max {
            let window = if n == count { target } else { self.windows[begin.step + n] };
            let (steps, bend) = (n as i64, add * triangle(n));
            min = min.max(ceiling(window.low - begin.last - bend, steps));
            max = max.min((window.high - begin.first - bend).div_euclid(steps));
            n = if n < count { (n + 1 + count / 8).min(count) } else { n + 1 };
        }
        min..=max
    }

    /// The entries back from the end of the last layer; among its times that closest to the due cycle.
    fn path_back(&self, layers: &[Layer]) -> Option<Vec<FoundEntry>> {
        let end = layers.last()?;
        let mut step = end.last();
        let window = self.windows[step];
        let all = times(end.bits(step)?).map(|bit| window.low + bit);
        let mut time = all.min_by_key(|time| time.abs_diff(window.due))?;
        let mut entries = Vec::with_capacity(layers.len());
        for layer in layers.iter().rev().skip(1) {
            let (start_step, start_time, entry) = self.entry_to(layer, step, time)?;
            (step, time) = (start_step, start_time);
            entries.push(entry);
        }
        entries.reverse();
        Some(entries)
    }

    fn entry_to(&self, layer: &Layer, step: usize, time: i64) -> Option<(usize, i64, FoundEntry)> {
        let target = StepWindow { low: time, high: time, ..self.windows[step] };
        let earliest = step.saturating_sub(self.format.max_count() as usize);
        for from in layer.first.max(earliest)..=layer.last().min(step.checked_sub(1)?) {
            let Some(begin) = self.begin(layer, from) else { continue };
            let (low, count) = (self.windows[from].low, step - from);
            if count == 1 {
                let start = times(begin.bits)
                    .map(|bit| low + bit)
                    .find(|start| (self.min_interval..=self.max_interval).contains(&(time - start)));
                let Some(start) = start else { continue };
                return Some((from, start, FoundEntry { count, interval: time - start, add: 0 }));
            }
            if step > self.windows[from].last_in_direction {
                continue;
            }
            for add in self.adds(begin, count, target) {
                for interval in self.intervals(begin, count, target, add) {
                    let start = time - interval * count as i64 - add * triangle(count);
                    let is_start =
                        (begin.first..=begin.last).contains(&start) && is_set(begin.bits, start - low);
                    if is_start && self.passes(from, start, FoundEntry { count, interval, add }) {
                        return Some((from, start, FoundEntry { count, interval, add }));
                    }
                }
            }
        }
        None
    }

    fn passes(&self, from: usize, start: i64, entry: FoundEntry) -> bool {
        let (mut time, mut now) = (0, entry.interval);
        (1..=entry.count).all(|n| {
            time += now;
            let passes = self.narrowed((start, start), from + n, time, now).is_some();
            now += entry.add;
            passes
        })
    }
}

impl Layer {
    fn last(&self) -> usize {
        self.first + self.words.len() / self.stride - 1
    }

    fn bits(&self, step: usize) -> Option<&[u64]> {
        let at = step.checked_sub(self.first)? * self.stride;
        self.words.get(at..at + self.stride)
    }

    fn bits_mut(&mut self, step: usize) -> &mut [u64] {
        let at = (step - self.first) * self.stride;
        if self.words.len() < at + self.stride {
            self.words.resize(at + self.stride, 0);
        }
        &mut self.words[at..at + self.stride]
    }

    fn set(&mut self, step: usize, window: StepWindow, (first, last): (i64, i64)) {
        let (first, last) = (first.max(window.low) - window.low, last.min(window.high) - window.low);
        if first <= last {
            for (index, word) in (0_i64..).step_by(64).zip(self.bits_mut(step)) {
                *word |= ones(first - index, last - index);
            }
        }
    }

    /// Marks the times that are `time` after start times of a range; returns whether there are any.
    fn reached(
        &mut self,
        begin: StartTimes<'_>,
        windows: &[StepWindow],
        step: usize,
        (first, last): (i64, i64),
        time: i64,
    ) -> bool {
        let (here, there) = (windows[begin.step].low, windows[step].low);
        let (first, last) = (first - here, last - here);
        let mut any = false;
        for index in first / 64..=last / 64 {
            let word = begin.bits[index as usize] & ones(first - index * 64, last - index * 64);
            if word != 0 {
                any = true;
                let to = index * 64 + here + time - there;
                let (at, shift) = (to.div_euclid(64), to.rem_euclid(64));
                let bits = self.bits_mut(step);
                if let Some(bits) = usize::try_from(at).ok().and_then(|at| bits.get_mut(at)) {
                    *bits |= word << shift;
                }
                if shift > 0
                    && let Some(bits) = usize::try_from(at + 1).ok().and_then(|at| bits.get_mut(at))
                {
                    *bits |= word >> (64 - shift);
                }
            }
        }
        any
    }

    fn is_full(&self, step: usize, width: usize) -> bool {
        let Some(bits) = self.bits(step) else { return false };
        (0..).step_by(64).zip(bits).all(|(index, word)| *word == ones(-index, width as i64 - 1 - index))
    }

    fn remove_before_last_full(&mut self, windows: &[StepWindow]) {
        let full = (self.first..=self.last()).rev().find(|step| self.is_full(*step, windows[*step].width()));
        if let Some(full) = full {
            self.words.drain(..(full - self.first) * self.stride);
            self.first = full;
        }
    }
}

/// n*(n - 1)/2, the number of adds in n steps.
const fn triangle(n: usize) -> i64 {
    (n * (n - 1) / 2) as i64
}

/// A word with ones from bit `first` to bit `last`, which may be outside.
const fn ones(first: i64, last: i64) -> u64 {
    if last < 0 || first > 63 || first > last {
        return 0;
    }
    let from = if first < 0 { 0 } else { first };
    let to = if last > 63 { 63 } else { last };
    (u64::MAX << from) & (u64::MAX >> (63 - to))
}

fn word_at(bits: &[u64], at: i64) -> u64 {
    let (index, shift) = (at.div_euclid(64), at.rem_euclid(64));
    let word =
        |index: i64| usize::try_from(index).ok().and_then(|index| bits.get(index)).copied().unwrap_or(0);
    if shift == 0 { word(index) } else { word(index) >> shift | word(index + 1) << (64 - shift) }
}

fn is_set(bits: &[u64], at: i64) -> bool {
    word_at(bits, at) & 1 == 1
}

fn ends(bits: &[u64]) -> Option<(i64, i64)> {
    let first = bits.iter().position(|word| *word != 0)?;
    let last = bits.iter().rposition(|word| *word != 0)?;
    let (low, high) = (bits[first].trailing_zeros(), 63 - bits[last].leading_zeros());
    Some((first as i64 * 64 + i64::from(low), last as i64 * 64 + i64::from(high)))
}

fn times(bits: &[u64]) -> impl Iterator<Item = i64> + '_ {
    let words = bits.iter().zip((0..).step_by(64));
    words.flat_map(|(word, at)| (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| at + bit))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten steps every 100 cycles and five every 300 cycles: two entries.
    fn two_rates() -> Vec<(Window, bool)> {
        let times = (1..=10).map(|n| 100 * n).chain((1..=5).map(|n| 1000 + 300 * n));
        times.map(|due| (Window { due_cycle: due, low: due, high: due }, true)).collect()
    }

    #[test]
    fn a_cut_section_leaves_its_last_entry_to_the_next_section() {
        let windows = two_rates();
        let section = Section::new(EntryFormat::TICKS, 1, 0, &windows);
        let counts = |is_cut| {
            let entries = section.fewest_entries(is_cut, &mut 1_000_000).unwrap();
            entries.iter().map(|entry| entry.count).collect::<Vec<_>>()
        };
        assert_eq!(counts(false).iter().sum::<usize>(), 15);
        assert_eq!(counts(false).len(), 2);
        let cut = counts(true);
        assert_eq!(cut.len(), 1);
        assert!(cut[0] >= 10, "{cut:?}");
    }

    #[test]
    fn a_single_entry_to_the_end_remains_in_a_cut_section() {
        let windows = two_rates();
        let section = Section::new(EntryFormat::TICKS, 1, 0, &windows[..10]);
        for is_cut in [false, true] {
            let entries = section.fewest_entries(is_cut, &mut 1_000_000).unwrap();
            assert_eq!(entries.iter().map(|entry| entry.count).collect::<Vec<_>>(), [10], "{is_cut}");
        }
    }

    /// Whether the work is enough decides how a list is searched, so its entries depend on every unit.
    #[test]
    fn counts_the_work_of_a_search() {
        // About every 100 cycles, slower from step to step, with windows of 1, 9 and 200 times, and a reversal.
        let needed = [0, 8, 199].map(|width| {
            let window = |n: u64| {
                let due = 100 * n + n * n / 2;
                (Window { due_cycle: due, low: due, high: due + width }, n <= 20)
            };
            let windows: Vec<(Window, bool)> = (1..=30).map(window).collect();
            let section = Section::new(EntryFormat::TICKS, 1, 0, &windows);
            let mut left = 100_000_000;
            assert!(section.fewest_entries(false, &mut left).is_some(), "{width}");
            let needed = 100_000_000 - left;
            assert!(section.fewest_entries(false, &mut needed.clone()).is_some(), "{width}");
            assert_eq!(section.fewest_entries(false, &mut (needed - 1)), None, "{width}");
            needed
        });
        assert_eq!(needed, [221, 981, 101_302]);
    }
}
