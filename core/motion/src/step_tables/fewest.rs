//! The fewest entries through the windows of a list's steps (DESIGN B8).
//!
//! ```text
//! layer e      for each step, the times of its window that at most e entries can reach: one bit per time
//! full         the last step of a layer that can have any time of its window
//! last         the last step of a layer that can have any time at all
//! ```
//!
//! The number of the first layer that reaches the last step is the minimum, and the path back through the layers is the
//! list. The search is exhaustive:
//!
//! 1. An entry without its last or first steps is an entry. So a layer never shrinks from a step to the next, and entries
//!    only need to begin from the layer's full step to its last.
//! 2. From each of these steps every interval and add that the windows allow is tried. The start times are a range that
//!    each window narrows ([`Section::narrowed`]), so they are processed together, as a shifted copy of the step's bits.
//! 3. Entries of one and two steps have a closed form ([`Section::one_and_two`]), short ones are tried per time
//!    ([`Section::short`]), and entries to full steps are skipped. What is left is about the square of a window's width over
//!    the cube of the count.
//!
//! A long list is cut into sections, which costs at most one entry per cut if neighboring windows do not overlap.

use crate::step_tables::{entry_format::EntryFormat, feasible_window::ceiling, longest::Window};
use alloc::{vec, vec::Vec};

/// Maximum width of a window in units: the work grows with its square.
pub(super) const MAX_WIDTH: u64 = 1 << 12;
pub(super) const MAX_STEPS: usize = 1 << 17;
const SHORT: usize = 4;
/// Maximum words of a section's layers, 32 MB; larger sections are cut.
const MAX_WORDS: usize = 1 << 22;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Piece {
    pub(super) count: usize,
    pub(super) interval: i64,
    pub(super) add: i64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct StepWindow {
    low: i64,
    high: i64,
    due: i64,
    /// The last step of an entry that begins here: the direction changes after it.
    end: usize,
}

impl StepWindow {
    const fn width(self) -> usize {
        (self.high - self.low + 1) as usize
    }
}

/// Steps that are searched together. Step 0 is their start.
pub(super) struct Section {
    format: EntryFormat,
    /// Minimum and maximum interval in units.
    least: i64,
    most: i64,
    windows: Vec<StepWindow>,
    /// Words per step.
    stride: usize,
}

struct Layer {
    first: usize,
    stride: usize,
    words: Vec<u64>,
}

#[derive(Clone, Copy)]
struct Begin<'a> {
    step: usize,
    bits: &'a [u64],
    first: i64,
    last: i64,
}

impl Section {
    /// The steps of `given`, each with its direction, after the time `from`. No window is wider than [`MAX_WIDTH`] or
    /// farther from the one before than an entry's interval allows.
    pub(super) fn new(format: EntryFormat, least: u64, from: u64, given: &[(Window, bool)]) -> Self {
        let time = |units: u64| units.wrapping_sub(from) as i64;
        let mut windows = vec![StepWindow { low: 0, high: 0, due: 0, end: 0 }];
        windows.extend(given.iter().map(|(window, _)| StepWindow {
            low: time(window.low),
            high: time(window.high),
            due: time(window.due << format.fraction_bits),
            end: 0,
        }));
        let mut end = given.len();
        for (step, window) in windows.iter_mut().enumerate().rev() {
            window.end = end;
            let directions = step.checked_sub(1).and_then(|before| given.get(before..=step));
            if let Some([(_, before), (_, after)]) = directions
                && before != after
            {
                end = step;
            }
        }
        let stride = windows.iter().map(|window| window.width().div_ceil(64)).max().unwrap_or(1);
        let most = i64::try_from(format.max_interval()).unwrap_or(i64::MAX);
        Self { format, least: least as i64, most, windows, stride }
    }

    /// The fewest entries to the last step or, if `more` steps follow, to a step from which to continue. `None` if more than
    /// `work` is needed, from which the work done is subtracted.
    pub(super) fn pieces(&self, more: bool, work: &mut u64) -> Option<Vec<Piece>> {
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
            if layers.len() > 1 && (words_used > MAX_WORDS || more && next.last() == last) {
                break;
            }
            layers.push(next);
        }
        self.path_back(&layers)
    }

    fn next(&self, layer: &Layer, work: &mut u64) -> Option<Layer> {
        let mut next = Layer { first: layer.first, stride: self.stride, words: layer.words.clone() };
        // The copy, and the search for entries of one and two steps.
        let mut spent = layer.words.len() as u64;
        for step in layer.first..=layer.last() {
            if let Some(begin) = self.begin(layer, step) {
                spent += self.one_and_two(begin, &mut next);
            }
        }
        *work = work.checked_sub(spent)?;
        let mut open = layer.first;
        for step in layer.first..=layer.last() {
            while next.is_full(open, self.windows.get(open).map_or(0, |window| window.width())) {
                open += 1;
            }
            if let Some(begin) = self.begin(layer, step) {
                let least = open.saturating_sub(step).max(3);
                let mut spent = 0;
                for count in least..=SHORT {
                    spent += self.short(begin, count, &mut next);
                }
                spent += self.longer(begin, layer, least.max(SHORT + 1), &mut next);
                *work = work.checked_sub(spent)?;
            }
        }
        next.forget(&self.windows);
        Some(next)
    }

    fn begin<'a>(&self, layer: &'a Layer, step: usize) -> Option<Begin<'a>> {
        let bits = layer.bits(step)?;
        let (first, last) = ends(bits)?;
        let low = self.windows[step].low;
        Some(Begin { step, bits, first: low + first, last: low + last })
    }

    fn one_and_two(&self, begin: Begin<'_>, next: &mut Layer) -> u64 {
        let Some(&one) = self.windows.get(begin.step + 1) else { return 1 };
        next.set(begin.step + 1, one, (begin.first + self.least, one.high));
        let Some(&two) =
            self.windows.get(begin.step + 2).filter(|_| begin.step + 2 <= self.windows[begin.step].end)
        else {
            return 1;
        };
        let (min_add, max_add) = (self.format.min_add(), self.format.max_add());
        // The minimum and the maximum interval through the first window determine the range.
        let range = |from: i64| {
            let (soon, late) = (one.low.max(from + self.least), one.high.min(from + self.most));
            (soon <= late).then(|| {
                let low = (soon + self.least).max((2 * soon - from).saturating_add(min_add));
                let high = (late + self.most).min((2 * late - from).saturating_add(max_add));
                (low, high)
            })
        };
        let low = self.windows[begin.step].low;
        let mut spent = 1;
        for from in times(begin.bits).map(|bit| low + bit) {
            spent += 1;
            let Some((low, high)) = range(from) else { continue };
            next.set(begin.step + 2, two, (low, high));
            if high >= two.high && low <= two.low.max(one.low.max(from + self.least) + self.least) {
                // No later one reaches other times.
                return spent;
            }
        }
        spent
    }

    /// Marks the times that entries of `count` >= 3 steps reach; returns the number of steps examined.
    ///
    /// With time 0 at the start and `time` at the end, step m is at m*time/count - add*m*(count - m)/2: so the windows
    /// allow a range of adds, and the interval is an integer for every add, or for every second.
    fn short(&self, begin: Begin<'_>, count: usize, next: &mut Layer) -> u64 {
        let end = begin.step + count;
        let Some(&window) = self.windows.get(end).filter(|_| end <= self.windows[begin.step].end) else {
            return 1;
        };
        let inner = &self.windows[begin.step + 1..end];
        let (n, low, mut spent) = (count as i64, self.windows[begin.step].low, 1);
        for time in window.low..=window.high {
            if next.bits(end).is_some_and(|bits| is_set(bits, time - window.low)) {
                continue;
            }
            let passes = times(begin.bits).any(|bit| {
                spent += 1;
                let from = low + bit;
                let lasts = time - from;
                let odd = match lasts.rem_euclid(n) {
                    0 => 0,
                    part if 2 * part == n => 1,
                    _ => return false,
                };
                let (mut least, mut most) = self.adds_of(lasts, n);
                for (m, window) in (1..).zip(inner) {
                    let (bend, far) = (n * m * (n - m), 2 * m * lasts);
                    least = least.max(ceiling(far - 2 * n * (window.high - from), bend));
                    most = most.min((far - 2 * n * (window.low - from)).div_euclid(bend));
                }
                // With an even count every second add has an integer interval.
                if n % 2 == 0 && (least - odd).rem_euclid(2) == 1 { least < most } else { least <= most }
            });
            if passes {
                next.set(end, window, (time, time));
            }
        }
        spent
    }

    fn adds_of(&self, lasts: i64, n: i64) -> (i64, i64) {
        // Their mean is lasts/n, and the outer ones differ from it by half of n - 1 adds.
        let room = (lasts - n * self.least).min(n * self.most - lasts);
        let most = (2 * room).div_euclid(n * (n - 1));
        ((-most).max(self.format.min_add()), most.min(self.format.max_add()))
    }

    fn longer(&self, begin: Begin<'_>, layer: &Layer, least: usize, next: &mut Layer) -> u64 {
        let (step, mut spent) = (begin.step, 8);
        let last = self.windows[step].end.min(step + self.format.max_count() as usize);
        let Some(&target) = self.windows.get(step + least).filter(|_| step + least <= last) else {
            return spent;
        };
        let mut exits = vec![0; self.stride];
        for add in self.adds(begin, least, target) {
            spent += 8;
            for interval in self.intervals(begin, least, target, add) {
                spent += 1 + self.stride as u64 / 4;
                let Some(exit) = self.exits(begin, layer, interval, &mut exits) else { continue };
                let (mut range, mut time, mut now) = ((exit.first, exit.last), 0, interval);
                for count in 1..=last - step {
                    spent += 1;
                    time += now;
                    let Some(narrowed) = self.narrowed(range, step + count, time, now) else { break };
                    (range, now) = (narrowed, now + add);
                    if count >= least && !next.reached(exit, &self.windows, step + count, range, time) {
                        break;
                    }
                }
            }
        }
        spent
    }

    fn narrowed(&self, (first, last): (i64, i64), step: usize, time: i64, now: i64) -> Option<(i64, i64)> {
        let window = self.windows.get(step)?;
        let range = (first.max(window.low - time), last.min(window.high - time));
        (range.0 <= range.1 && (self.least..=self.most).contains(&now)).then_some(range)
    }

    /// Of the start times those from which the entry's first step leaves the layer.
    fn exits<'a>(
        &self,
        begin: Begin<'a>,
        layer: &Layer,
        interval: i64,
        exits: &'a mut [u64],
    ) -> Option<Begin<'a>> {
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
        Some(Begin { step: begin.step, bits: exits, first: here + first?, last: here + last })
    }

    /// The adds of entries of `count` >= 2 steps that may end in `target`.
    fn adds(&self, begin: Begin<'_>, count: usize, target: StepWindow) -> core::ops::RangeInclusive<i64> {
        let half = count / 2;
        let (n, h) = (count as i128, half as i128);
        // A parabola through three points.
        let through = |far: i64, near: i64| 2 * (i128::from(far) * h - i128::from(near) * n);
        let middle = self.windows[begin.step + half];
        let over = n * h * (n - h);
        let least = through(target.low - begin.last, middle.high - begin.first);
        let most = through(target.high - begin.first, middle.low - begin.last);
        let least = least.div_euclid(over) + i128::from(least.rem_euclid(over) > 0);
        let least = least.max(self.format.min_add().into());
        let most = most.div_euclid(over).min(self.format.max_add().into());
        let narrow = |add: i128| i64::try_from(add).unwrap_or(if add < 0 { i64::MIN } else { i64::MAX });
        narrow(least)..=narrow(most)
    }

    fn intervals(
        &self,
        begin: Begin<'_>,
        count: usize,
        target: StepWindow,
        add: i64,
    ) -> core::ops::RangeInclusive<i64> {
        let grows = add * (count as i64 - 1);
        let mut least = self.least.max(self.least - grows);
        let mut most = self.most.min(self.most - grows);
        let mut n = 1;
        while n <= count && least <= most {
            let window = if n == count { target } else { self.windows[begin.step + n] };
            let (steps, bend) = (n as i64, add * triangle(n));
            least = least.max(ceiling(window.low - begin.last - bend, steps));
            most = most.min((window.high - begin.first - bend).div_euclid(steps));
            n = if n < count { (n + 1 + count / 8).min(count) } else { n + 1 };
        }
        least..=most
    }

    fn path_back(&self, layers: &[Layer]) -> Option<Vec<Piece>> {
        let end = layers.last()?;
        let mut step = end.last();
        let window = self.windows[step];
        let all = times(end.bits(step)?).map(|bit| window.low + bit);
        let mut time = all.min_by_key(|time| time.abs_diff(window.due))?;
        let mut pieces = Vec::with_capacity(layers.len());
        for layer in layers.iter().rev().skip(1) {
            let (begins, from, piece) = self.piece(layer, step, time)?;
            (step, time) = (begins, from);
            pieces.push(piece);
        }
        pieces.reverse();
        Some(pieces)
    }

    /// An entry from the layer to a step's time, and its start.
    fn piece(&self, layer: &Layer, step: usize, time: i64) -> Option<(usize, i64, Piece)> {
        let target = StepWindow { low: time, high: time, ..self.windows[step] };
        let earliest = step.saturating_sub(self.format.max_count() as usize);
        for from in layer.first.max(earliest)..=layer.last().min(step.checked_sub(1)?) {
            let Some(begin) = self.begin(layer, from) else { continue };
            let (low, count) = (self.windows[from].low, step - from);
            if count == 1 {
                let start = times(begin.bits)
                    .map(|bit| low + bit)
                    .find(|start| (self.least..=self.most).contains(&(time - start)));
                let Some(start) = start else { continue };
                return Some((from, start, Piece { count, interval: time - start, add: 0 }));
            }
            if step > self.windows[from].end {
                continue;
            }
            for add in self.adds(begin, count, target) {
                for interval in self.intervals(begin, count, target, add) {
                    let start = time - interval * count as i64 - add * triangle(count);
                    let there =
                        (begin.first..=begin.last).contains(&start) && is_set(begin.bits, start - low);
                    if there && self.passes(from, start, Piece { count, interval, add }) {
                        return Some((from, start, Piece { count, interval, add }));
                    }
                }
            }
        }
        None
    }

    fn passes(&self, from: usize, start: i64, piece: Piece) -> bool {
        let (mut time, mut now) = (0, piece.interval);
        (1..=piece.count).all(|n| {
            time += now;
            let passes = self.narrowed((start, start), from + n, time, now).is_some();
            now += piece.add;
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

    fn reached(
        &mut self,
        begin: Begin<'_>,
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

    fn forget(&mut self, windows: &[StepWindow]) {
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

/// The 64 bits from `at` on.
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

    /// Ten steps every 100 cycles, five every 300: two entries.
    fn two_rates() -> Vec<(Window, bool)> {
        let times = (1..=10).map(|n| 100 * n).chain((1..=5).map(|n| 1000 + 300 * n));
        times.map(|due| (Window { due, low: due, high: due }, true)).collect()
    }

    #[test]
    fn a_section_with_more_behind_it_leaves_its_last_entry_to_the_next_section() {
        let windows = two_rates();
        let section = Section::new(EntryFormat::TICKS, 1, 0, &windows);
        let counts = |more| {
            let pieces = section.pieces(more, &mut 1_000_000).unwrap();
            pieces.iter().map(|piece| piece.count).collect::<Vec<_>>()
        };
        assert_eq!(counts(false).iter().sum::<usize>(), 15);
        assert_eq!(counts(false).len(), 2);
        let cut = counts(true);
        assert_eq!(cut.len(), 1);
        assert!(cut[0] >= 10, "{cut:?}");
    }

    #[test]
    fn an_entry_that_alone_reaches_the_end_is_kept_whatever_is_behind_it() {
        let windows = two_rates();
        let section = Section::new(EntryFormat::TICKS, 1, 0, &windows[..10]);
        for more in [false, true] {
            let pieces = section.pieces(more, &mut 1_000_000).unwrap();
            assert_eq!(pieces.iter().map(|piece| piece.count).collect::<Vec<_>>(), [10], "{more}");
        }
    }
}
