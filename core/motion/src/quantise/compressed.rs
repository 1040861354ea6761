//! A step table with few entries (DESIGN B8): no step is off by more than a given number of cycles.
//!
//! ```text
//! due      |    |   |  |  | | | |         a window around each due cycle
//! window  [ ]  [ ] [ ][ ] …               error <= tolerance
//! entry    \___ interval, add, count      one parabola through the windows of its steps
//! ```
//!
//! The list is replayed as the segment engine replays it, in the integers of its format, so what is checked here is what
//! comes out at the STEP line: the number of steps is exact, no step leaves its window, and no error is carried from one
//! entry to the next but the one that the entry's last step has, which is in its window too.
//!
//! How few entries? The fewest that there are ([`super::fewest`]), where the windows are narrow enough for that search. For
//! all other lists, and where they are to be made quickly, each entry is the longest that there is from the time at which
//! the one before it ended, of those whose last step comes close to the middle of its window: an eighth of it and a cycle.
//! (Where the windows are the due cycles alone their middles say nothing, so there it is the longest of all, less an eighth.)
//! Without that condition the entries would be longer one by one and yet more in number, for an entry of greatest length
//! ends at the edge of a window, the worst place for the next one to begin. Where the third derivative of time over steps
//! hardly changes, let an entry that may begin and end anywhere in its windows have the length 1; then entries from middle
//! to middle have 0.87, and those that are as long as they can be, one after another, have 0.75.

use crate::quantise::{
    entry_format::EntryFormat,
    fewest::{self, Piece, Stretch},
    longest::{Ahead, Window},
    segments::START,
    timing_error::TimingError,
};
use crate::{
    ScheduledStep,
    problem::{Cause, ValueError},
};
use alloc::{boxed::Box, collections::VecDeque, vec::Vec};
use core::num::NonZeroU32;
use stepscope_peripheral::{
    segment::{FRACTION_BITS, LAST_CYCLE, PulseTimes, Segment, SegmentList},
    units::Cycles,
};

/// Greatest tolerance in cycles.
pub const MAX_TOLERANCE: Cycles = Cycles(1 << 24);
/// Most entries of a list: 64 MB.
pub(super) const MAX_ENTRIES: usize = 2_000_000;
/// What the search for the fewest entries may look at, in steps of an interval and an add: two seconds or so, and for each
/// step of the list ten microseconds more.
const WORK: u64 = 1 << 28;
const WORK_A_STEP: u64 = 1 << 10;
/// The last cycle of a list from its start on.
const LAST: u64 = LAST_CYCLE.0 - START.0;

/// On which side of its due cycle a step may be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// Early or late.
    #[default]
    Both,
    /// Early, never late: the window of Klipper's step compression.
    Early,
}

/// How far a step may be from its due cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tolerance {
    /// In cycles, at most [`MAX_TOLERANCE`].
    pub cycles: Cycles,
    /// Nor more than this part of the shorter of the intervals before and after it, or, of a step that is never late, of
    /// the interval before it: 2 for a half.
    pub interval_part: Option<NonZeroU32>,
    /// Which way.
    pub side: Side,
}

impl Tolerance {
    /// So many cycles either way, whatever the intervals are.
    #[must_use]
    pub const fn of(cycles: Cycles) -> Self {
        Self { cycles, interval_part: None, side: Side::Both }
    }

    /// That of a step between these intervals.
    fn between(self, before: u64, after: Option<u64>) -> u64 {
        let shorter = match (self.side, after) {
            (Side::Both, Some(after)) => after.min(before),
            (Side::Early, _) | (Side::Both, None) => before,
        };
        let most = self.cycles.0;
        match self.interval_part {
            // Where the part is not the less it is not formed.
            Some(part) if shorter < most.saturating_mul(part.get().into()) => {
                quotient(shorter, part).min(most)
            }
            _ => most,
        }
    }

    /// The earliest and the latest cycle of a step.
    fn window(self, due: u64, before: u64, after: Option<u64>) -> (u64, u64) {
        let off = self.between(before, after);
        let late = match self.side {
            Side::Both => off,
            Side::Early => 0,
        };
        (due.saturating_sub(off), due.saturating_add(late))
    }
}

/// A quotient; of numbers of 32 bits it is quicker, which not every target finds out by itself.
fn quotient(over: u64, under: NonZeroU32) -> u64 {
    u32::try_from(over).map_or_else(|_| over / u64::from(under.get()), |over| u64::from(over / under))
}

/// A compressed list and how good it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Compressed {
    /// What the segment engine runs.
    pub list: SegmentList,
    /// How far its steps are from their due cycles.
    pub error: TimingError,
    /// How many entries it may have more than the fewest: 0 where it is proven to have the fewest, more where it was cut
    /// into stretches, None where the fewest were not searched for, or not to the end.
    pub surplus: Option<u64>,
}

/// Compresses the steps of one axis, whose cycles count from the motion's start, into the fewest entries of `format`, or,
/// where its windows are too many units wide for that search, into those of [`compressed_quickly`].
///
/// # Errors
/// A tolerance that is too great; a step that comes too soon for `pulse`, or too late for 48.16 fixed point; too many
/// entries.
pub fn compressed(
    steps: impl IntoIterator<Item = ScheduledStep>,
    tolerance: Tolerance,
    format: EntryFormat,
    pulse: PulseTimes,
) -> Result<Compressed, Cause> {
    let mut compression = Compression::new(steps.into_iter(), tolerance, format, pulse)?;
    let mut ready = VecDeque::new();
    let (before, surplus) = compression.fewest(&mut ready)?;
    let mut rest = compression.go_on(before, ready);
    rest.quick()?;
    Ok(Compressed { surplus, ..rest.end() })
}

/// The same in few entries, each the longest that ends near the middle of a window: in a part of the time.
///
/// # Errors
/// As [`compressed`].
pub fn compressed_quickly(
    steps: impl IntoIterator<Item = ScheduledStep>,
    tolerance: Tolerance,
    format: EntryFormat,
    pulse: PulseTimes,
) -> Result<Compressed, Cause> {
    let mut compression = Compression::new(steps.into_iter(), tolerance, format, pulse)?;
    compression.quick()?;
    Ok(compression.end())
}

/// Steps on their way into entries.
struct Compression<I> {
    windows: Windows<I>,
    writer: Writer,
}

impl<I: Iterator<Item = ScheduledStep>> Compression<I> {
    fn new(steps: I, tolerance: Tolerance, format: EntryFormat, pulse: PulseTimes) -> Result<Self, Cause> {
        if tolerance.cycles > MAX_TOLERANCE {
            let (given, most) = (tolerance.cycles.0 as f64, MAX_TOLERANCE.0 as f64);
            return Err(ValueError::TooMuch { given, most, of: "cycles of tolerance" }.into());
        }
        Ok(Self { windows: Windows::new(steps, tolerance, format, pulse), writer: Writer::new(format) })
    }

    /// Stretch after stretch in the fewest entries: the cycle of the last step that was kept, and how many entries there
    /// may be more than the fewest, or None where steps are left, `ready` those of them that were read.
    fn fewest(&mut self, ready: &mut VecDeque<(Window, bool)>) -> Result<(u64, Option<u64>), Cause> {
        let (format, pulse) = (self.windows.ready.format, self.windows.ready.pulse);
        let least = pulse.min_interval().0 << format.fraction_bits;
        let (mut last, mut cuts, mut work) = (0, 0, WORK);
        loop {
            while let Some(step) = self.windows.next().filter(|_| ready.len() < fewest::MAX_STEPS) {
                ready.push_back((self.windows.window()?, step.right));
            }
            let more = self.windows.next().is_some();
            let steps = ready.make_contiguous();
            let Some((first, _)) = steps.first() else { return Ok((last, Some(cuts))) };
            if steps.iter().any(|(window, _)| window.high - window.low >= fewest::MAX_WIDTH) {
                return Ok((last, None));
            }
            let near =
                |before: u64, window: &Window| window.high.saturating_sub(before) <= format.most_interval();
            if !near(self.writer.time, first) {
                self.writer.wait(first.first(self.writer.time, least, format).wait);
            }
            // Up to a rest that no interval holds.
            let pairs = steps.iter().zip(steps.iter().skip(1));
            let there = 1 + pairs.take_while(|((before, _), (window, _))| near(before.low, window)).count();
            let is_cut = more && there == steps.len();
            // Where some times are near enough the wait may be one that another list does without.
            let waits =
                steps.get(there - 1).zip(steps.get(there)).is_some_and(|((before, _), (window, _))| {
                    window.low.saturating_sub(before.high) <= format.most_interval()
                });
            let stretch =
                Stretch::new(format, least, self.writer.time, steps.get(..there).unwrap_or_default());
            let Some(left) = work.checked_sub(there as u64) else { return Ok((last, None)) };
            work = left;
            let Some(pieces) = stretch.pieces(is_cut, &mut work) else { return Ok((last, None)) };
            let mut done = 0;
            for Piece { count, interval, add } in pieces {
                let kept = steps.get(done..done + count).unwrap_or_default();
                let right = kept.first().is_some_and(|(_, right)| *right);
                self.writer.steps(kept, |(window, _)| window, (interval as u64, add, right));
                (done, last) = (done + count, kept.last().map_or(last, |(window, _)| window.due));
            }
            // Of steps that are kept, so that many short pieces of a stretch cannot ask for it again and again.
            work += WORK_A_STEP * done as u64;
            cuts += u64::from(is_cut || done < there) + 2 * u64::from(waits);
            ready.drain(..done);
            self.writer.judge()?;
        }
    }

    /// The steps that are left, behind one that is due in the cycle `before`.
    fn go_on(
        self,
        before: u64,
        ready: VecDeque<(Window, bool)>,
    ) -> Compression<impl Iterator<Item = ScheduledStep>> {
        let Windows { steps, ready: Ready { tolerance, format, pulse, steps: read, at, end, count, .. } } =
            self.windows;
        let read = read.into_iter().take(end).skip(at);
        let count = count - ready.len() as u64;
        let ready = ready.into_iter().map(|(window, right)| ScheduledStep { cycle: window.due, right });
        let ready = ready.chain(read).chain(steps);
        let mut windows = Windows::new(ready, tolerance, format, pulse);
        (windows.ready.before, windows.ready.count) = (before, count);
        Compression { windows, writer: self.writer }
    }

    /// The rest, one entry after another.
    fn quick(&mut self) -> Result<(), Cause> {
        let Self { windows, writer } = self;
        let mut ahead = Ahead::new(windows.ready.format, windows.ready.pulse.min_interval().0);
        let mut length = 64;
        while windows.begin(&mut ahead)? {
            while let Some(longest) = ahead.longest(writer.time, length, |ahead| windows.fill(ahead))? {
                writer.wait(longest.wait);
                let entry = (longest.interval, longest.add, windows.ready.right);
                writer.steps(ahead.taken(longest.count), |window| window, entry);
                ahead.take(longest.count);
                length = longest.count;
                writer.judge()?;
            }
        }
        Ok(())
    }

    fn end(self) -> Compressed {
        let list = SegmentList { start: START, segments: self.writer.segments };
        Compressed { list, error: self.writer.error, surplus: None }
    }
}

/// Steps whose errors are summed at once: their squares stay in 64 bits.
const AT_ONCE: usize = 1 << 12;
const _: () = assert!(2 * MAX_TOLERANCE.0.ilog2() + AT_ONCE.ilog2() < u64::BITS);

/// Steps that are read at once, and windows that a run is read on by.
const READ: usize = 256;

/// The windows of the steps, run after run: a run goes one way.
struct Windows<I> {
    steps: I,
    ready: Ready,
}

/// Steps that were read, and what makes windows of them.
struct Ready {
    tolerance: Tolerance,
    format: EntryFormat,
    /// Of the format, in a cycle.
    units: u64,
    pulse: PulseTimes,
    /// Those before `at` have their windows; from `end` on there is room for the next.
    ///
    /// Invariant: two have none, as long as there are as many.
    steps: Box<[ScheduledStep; READ + 1]>,
    at: usize,
    end: usize,
    /// Cycle of the step before the next.
    before: u64,
    /// Steps that have their windows.
    count: u64,
    /// Which way the run goes.
    right: bool,
}

impl<I: Iterator<Item = ScheduledStep>> Windows<I> {
    fn new(steps: I, tolerance: Tolerance, format: EntryFormat, pulse: PulseTimes) -> Self {
        let ready = Ready {
            tolerance,
            format,
            units: 1 << format.fraction_bits,
            pulse,
            steps: Box::new([ScheduledStep { cycle: 0, right: false }; READ + 1]),
            at: 0,
            end: 0,
            before: 0,
            count: 0,
            right: false,
        };
        let mut windows = Self { steps, ready };
        windows.read();
        windows
    }

    /// Reads on where fewer than two steps have no window.
    fn read(&mut self) {
        let Self { steps, ready } = self;
        if ready.left().len() < 2 {
            ready.steps.copy_within(ready.at..ready.end, 0);
            let mut end = ready.end - ready.at;
            // From within, and into places that are there: so nothing is asked or called for each but what forms it.
            steps.by_ref().take(READ).for_each(|step| {
                if let Some(place) = ready.steps.get_mut(end) {
                    (*place, end) = (step, end + 1);
                }
            });
            (ready.at, ready.end) = (0, end);
        }
    }

    /// The next step.
    fn next(&self) -> Option<ScheduledStep> {
        self.ready.left().first().copied()
    }

    /// Begins the next run; false where no step is left.
    fn begin(&mut self, ahead: &mut Ahead) -> Result<bool, Cause> {
        let Some(next) = self.next() else { return Ok(false) };
        self.ready.right = next.right;
        self.fill(ahead)?;
        Ok(true)
    }

    /// Reads on, some steps of the run; false at its end.
    fn fill(&mut self, ahead: &mut Ahead) -> Result<bool, Cause> {
        let mut left = READ;
        while left > 0 {
            if self.next().is_none_or(|step| step.right != self.ready.right) {
                return Ok(false);
            }
            left -= self.ready.fill(left, ahead.more())?;
            self.read();
        }
        Ok(true)
    }

    /// The window of the next step.
    fn window(&mut self) -> Result<Window, Cause> {
        let window = self.ready.window();
        self.read();
        window
    }
}

impl Ready {
    /// Steps without windows.
    fn left(&self) -> &[ScheduledStep] {
        self.steps.get(self.at..self.end).unwrap_or_default()
    }

    /// Makes the windows of the run's next steps, `most` of them at most; says how many.
    #[inline(never)]
    fn fill(&mut self, most: usize, windows: &mut Vec<Window>) -> Result<usize, Cause> {
        let length = windows.len();
        let mut count = most.min(self.left().len().saturating_sub(1));
        if !self.make(count, windows) {
            windows.truncate(length);
            let run =
                self.left().iter().take(count.max(1)).take_while(|step| step.right == self.right).count();
            let is_shorter = run < count;
            count = run;
            if !(is_shorter && self.make(run, windows)) {
                // One after another: the last of all, or to the one that does not hold.
                windows.truncate(length);
                for _ in 0..run {
                    windows.push(self.window()?);
                }
                return Ok(run);
            }
        }
        if let Some(last) = self.left().get(..count).and_then(<[_]>::last) {
            (self.before, self.count, self.at) = (last.cycle, self.count + count as u64, self.at + count);
        }
        Ok(count)
    }

    /// Makes the windows of the next `count` steps, which a step follows; false where they may not hold, or not all of them
    /// go one way.
    fn make(&self, count: usize, windows: &mut Vec<Window>) -> bool {
        let Tolerance { cycles: Cycles(most), interval_part, side } = self.tolerance;
        let late = if side == Side::Both { u64::MAX } else { 0 };
        match interval_part {
            None => self.put(count, windows, |_, _| (most, most & late)),
            Some(part) => {
                let whole = most * u64::from(part.get());
                self.put(count, windows, |before, after| {
                    let shorter = before.min(after | !late);
                    let off = if shorter < whole { quotient(shorter, part).min(most) } else { most };
                    (off, off & late)
                })
            }
        }
    }

    /// The same, of a step that may be `off` early and late between two intervals.
    #[inline(always)]
    fn put(&self, count: usize, windows: &mut Vec<Window>, off: impl Fn(u64, u64) -> (u64, u64)) -> bool {
        let (steps, afters) = (self.left(), self.left().get(1..=count).unwrap_or_default());
        let (Some(first), Some(last), [between @ .., _]) =
            (steps.first(), steps.get(afters.len().wrapping_sub(1)), afters)
        else {
            return false;
        };
        let least = self.pulse.min_interval().0 as i64;
        let (mut due, mut before) = (first.cycle, first.cycle.saturating_sub(self.before));
        // As signed numbers, which a step that is due before the one before it makes negative.
        let mut shortest = before as i64;
        // Nothing is asked of a step and nothing called, so the loop keeps its numbers in registers.
        windows.extend(afters.iter().map(|next| {
            let after = next.cycle.wrapping_sub(due);
            let (early, late) = off(before, after);
            let (low, high) = (due.saturating_sub(early), due.wrapping_add(late));
            let window = Window::of(due, (low, high), self.units);
            shortest = shortest.min(before as i64);
            (due, before) = (next.cycle, after);
            window
        }));
        // None is due after one that is due later, so far as their cycles have no more than 63 bits: differences have a sign then.
        let is_fit = |step: &ScheduledStep| step.right == self.right && step.cycle <= i64::MAX as u64;
        shortest >= least && last.cycle <= LAST - MAX_TOLERANCE.0 && between.iter().chain([first]).all(is_fit)
    }

    /// The window of the next step.
    fn window(&mut self) -> Result<Window, Cause> {
        let (Some(&step), after) = (self.left().first(), self.left().get(1).copied()) else {
            return Err(Cause::NoSegmentSteps);
        };
        self.at += 1;
        self.count += 1;
        let before = step.cycle.saturating_sub(self.before);
        let after = after.map(|after| after.cycle.saturating_sub(step.cycle));
        if before < self.pulse.min_interval().0 {
            return Err(Cause::StepTooSoon { step: self.count, interval: before, pulse: self.pulse });
        }
        self.before = step.cycle;
        let (earliest, latest) = self.tolerance.window(step.cycle, before, after);
        if latest > LAST {
            return Err(ValueError::TooMuch { given: latest as f64, most: LAST as f64, of: "cycles" }.into());
        }
        Ok(Window::of(step.cycle, (earliest, latest), self.units))
    }
}

/// Writes the segments and replays them.
struct Writer {
    format: EntryFormat,
    segments: Vec<Segment>,
    error: TimingError,
    /// Time of the last step from the start, in units.
    time: u64,
}

impl Writer {
    fn new(format: EntryFormat) -> Self {
        Self { format, segments: Vec::new(), error: TimingError::default(), time: 0 }
    }

    fn shift(&self) -> u32 {
        FRACTION_BITS - self.format.fraction_bits
    }

    fn wait(&mut self, wait: u64) {
        if wait > 0 {
            self.time += wait;
            self.segments.push(Segment::Dwell(wait << self.shift()));
        }
    }

    /// Refuses a list that is too long.
    fn judge(&self) -> Result<(), Cause> {
        if self.segments.len() > MAX_ENTRIES {
            let (given, most) = (self.segments.len() as f64, MAX_ENTRIES as f64);
            return Err(ValueError::TooMuch { given, most, of: "entries" }.into());
        }
        Ok(())
    }

    /// Keeps steps, each with its window.
    fn steps<T>(
        &mut self,
        kept: &[T],
        window: impl Fn(&T) -> &Window,
        (interval, add, right): (u64, i64, bool),
    ) {
        let (bits, count) = (self.format.fraction_bits, kept.len() as u32);
        let (mut time, mut next) = (self.time, interval);
        for kept in kept.chunks(AT_ONCE) {
            let (mut greatest, mut squares) = (0, 0_u64);
            for window in kept.iter().map(&window) {
                time = time.wrapping_add(next);
                next = next.wrapping_add_signed(add);
                debug_assert!((window.low..=window.high).contains(&time), "{time} is not in {window:?}");
                let off = ((time >> bits).wrapping_sub(window.due) as i64).unsigned_abs();
                greatest = off.max(greatest);
                squares += off.wrapping_mul(off);
            }
            self.error.steps(kept.len(), greatest, squares.into());
        }
        let adds = u64::from(count) * u64::from(count).saturating_sub(1) / 2;
        let lasts = interval.wrapping_mul(count.into()).wrapping_add_signed(add.wrapping_mul(adds as i64));
        self.time = self.time.wrapping_add(lasts);
        let shift = self.shift();
        let (interval, add) = (interval << shift, add << shift);
        if !self.goes_on(count, interval, add, right) {
            self.segments.push(Segment::Steps { count, interval, add, right });
        }
    }

    /// Adds the steps to the last segment where they are its next ones.
    fn goes_on(&mut self, more: u32, interval: u64, add: i64, right: bool) -> bool {
        let most = self.format.most_count();
        let Some(Segment::Steps { count, interval: first, add: grows, right: same }) =
            self.segments.last_mut()
        else {
            return false;
        };
        let next = first.wrapping_add_signed(grows.wrapping_mul(i64::from(*count)));
        let all = count.checked_add(more).filter(|all| *all <= most);
        match all {
            Some(all) if next == interval && *grows == add && *same == right => {
                *count = all;
                true
            }
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    const PULSE: PulseTimes = PulseTimes { width: Cycles(1), setup: Cycles(0), hold: Cycles(0) };

    fn right(cycles: &[u64]) -> Vec<ScheduledStep> {
        cycles.iter().map(|&cycle| ScheduledStep { cycle, right: true }).collect()
    }

    /// Climbs and falls by about 2^63, which as differences of 64 bits look like climbs alone.
    #[test]
    fn a_list_that_falls_from_beyond_all_cycles_is_refused_as_too_long() {
        let far = 1 << 63;
        for climbs in [[2_000_000, far + 1_999_000, 1_998_000], [far, far + 5_000_000, 6_000_000]] {
            let cycles = [&[1_000_000][..], &climbs, &[7_000_000, 8_000_000, 9_000_000]].concat();
            for format in [EntryFormat::Q16, EntryFormat::TICKS] {
                let tolerance = Tolerance::of(Cycles(100));
                let made = compressed_quickly(right(&cycles), tolerance, format, PULSE);
                let Err(Cause::Value(ValueError::TooMuch { of: "cycles", .. })) = made else {
                    panic!("{cycles:?}: {:?}", made.err());
                };
            }
        }
    }

    fn entries(due: &[u64], tolerance: u64) -> usize {
        let tolerance = Tolerance::of(Cycles(tolerance));
        let made = compressed(right(due), tolerance, EntryFormat::TICKS, PULSE).unwrap();
        assert!(made.error.greatest <= tolerance.cycles.0 && made.error.steps == due.len() as u64);
        assert_eq!(made.surplus, Some(0));
        made.list.segments.len()
    }

    #[test]
    fn what_is_a_parabola_is_one_entry() {
        let rows: [(Vec<u64>, usize); 5] = [
            (vec![], 0),
            (vec![7], 1),
            ((1..=1000).map(|k| k * 80).collect(), 1),
            ((1..=1000).map(|k| k * 20_000 - k * (k - 1) / 2 * 3).collect(), 1),
            // 5/3 cycles of rounding only.
            ((1..=70_000).map(|k| k * 80).collect(), 2),
        ];
        for (due, expected) in rows {
            assert_eq!(entries(&due, 0), expected, "{:?}", due.get(..3));
        }
    }

    #[test]
    fn a_turn_and_a_long_rest_end_an_entry() {
        let mut due: Vec<ScheduledStep> = right(&[10, 20, 30]);
        due.extend([40, 50, 1 << 40].map(|cycle| ScheduledStep { cycle, right: false }));
        let made = compressed(due.clone(), Tolerance::of(Cycles(0)), EntryFormat::TICKS, PULSE).unwrap();
        let ways: Vec<Option<bool>> = made
            .list
            .segments
            .iter()
            .map(|segment| match segment {
                Segment::Steps { right, .. } => Some(*right),
                Segment::Dwell(_) => None,
            })
            .collect();
        assert_eq!(ways, [Some(true), Some(false), None, Some(false)]);
        assert_eq!(TimingError::of(&made.list, due), Some(made.error));
    }

    #[test]
    fn the_last_cycles_that_there_are_can_be_reached() {
        let last = LAST_CYCLE.0 - 1;
        let due = [last - 20, last - 10, last];
        for format in EntryFormat::ALL {
            let made = compressed(right(&due), Tolerance::of(Cycles(0)), format, PULSE);
            assert_eq!(made.map(|made| made.error.greatest), Ok(0), "{}", format.name);
        }
        let late = compressed(right(&due), Tolerance::of(Cycles(1)), EntryFormat::Q16, PULSE);
        let cause = ValueError::TooMuch { given: last as f64 + 1.0, most: last as f64, of: "cycles" };
        assert_eq!(late, Err(cause.into()));
        let soon = compressed(right(&[5, 6]), Tolerance::of(Cycles(1)), EntryFormat::Q16, PULSE);
        assert_eq!(soon, Err(Cause::StepTooSoon { step: 2, interval: 1, pulse: PULSE }));
    }
}
