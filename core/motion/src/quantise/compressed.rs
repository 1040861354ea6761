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
//! How few entries? Each entry is the longest that there is from the time at which the one before it ended, of those
//! whose last step comes close to the middle of its window: an eighth of it and a cycle. (Where the windows are the due
//! cycles alone their middles say nothing, so there it is the longest of all, less an eighth.) Without that condition the
//! entries would be longer one by one and yet more in number, for an entry of greatest length ends at the edge of a
//! window, the worst place for the next one to begin. Where the third derivative of time over steps hardly changes, let
//! an entry that may begin and end anywhere in its windows have the length 1; then entries from middle to middle have
//! 0.87, and those that are as long as they can be, one after another, have 0.75. The fewest of all are not searched for.

use crate::quantise::{
    entry_format::EntryFormat,
    longest::{Ahead, Window},
    segments::START,
    timing_error::TimingError,
};
use crate::{
    ScheduledStep,
    problem::{Cause, ValueError},
};
use alloc::vec::Vec;
use core::num::NonZeroU32;
use stepscope_peripheral::{
    segment::{FRACTION_BITS, LAST_CYCLE, PulseTimes, Segment, SegmentList},
    units::Cycles,
};

/// Greatest tolerance in cycles.
pub const MAX_TOLERANCE: Cycles = Cycles(1 << 24);
/// Most entries of a list: 64 MB.
pub(super) const MAX_ENTRIES: usize = 2_000_000;
/// How far a step may be from its due cycle, either way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tolerance {
    /// In cycles, at most [`MAX_TOLERANCE`].
    pub cycles: Cycles,
    /// Nor more than this part of the shorter of the intervals before and after it: 2 for a half.
    pub interval_part: Option<NonZeroU32>,
}

impl Tolerance {
    /// So many cycles, whatever the intervals are.
    #[must_use]
    pub const fn of(cycles: Cycles) -> Self {
        Self { cycles, interval_part: None }
    }

    /// That of a step between these intervals.
    fn between(self, before: u64, after: Option<u64>) -> u64 {
        let shorter = after.map_or(before, |after| after.min(before));
        let part = self.interval_part.map_or(u64::MAX, |part| shorter / u64::from(part.get()));
        self.cycles.0.min(part)
    }
}

/// A compressed list and how good it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Compressed {
    /// What the segment engine runs.
    pub list: SegmentList,
    /// How far its steps are from their due cycles.
    pub error: TimingError,
}

/// Compresses the steps of one axis, whose cycles count from the motion's start, into entries of `format`.
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
    if tolerance.cycles > MAX_TOLERANCE {
        let (given, most) = (tolerance.cycles.0 as f64, MAX_TOLERANCE.0 as f64);
        return Err(ValueError::TooMuch { given, most, of: "cycles of tolerance" }.into());
    }
    let mut windows = Windows::new(steps.into_iter(), tolerance, format, pulse);
    let mut writer = Writer::new(format);
    let mut ahead = Ahead::new(format, pulse.min_interval().0);
    let mut length = 64;
    while windows.begin(&mut ahead)? {
        while let Some(longest) = ahead.longest(writer.time, length, |ahead| windows.fill(ahead))? {
            writer.wait(longest.wait);
            writer.steps(ahead.taken(longest.count), longest.interval, longest.add, windows.right);
            ahead.take(longest.count);
            length = longest.count;
            if writer.segments.len() > MAX_ENTRIES {
                let (given, most) = (writer.segments.len() as f64, MAX_ENTRIES as f64);
                return Err(ValueError::TooMuch { given, most, of: "entries" }.into());
            }
        }
    }
    let list = SegmentList { start: START, segments: writer.segments };
    Ok(Compressed { list, error: writer.error })
}

/// The windows of the steps, run after run: a run goes one way.
struct Windows<I> {
    steps: I,
    tolerance: Tolerance,
    format: EntryFormat,
    pulse: PulseTimes,
    /// The next step, and the cycle of the one before it.
    next: Option<ScheduledStep>,
    before: u64,
    /// Steps that were read.
    count: u64,
    /// Which way the run goes.
    right: bool,
}

impl<I: Iterator<Item = ScheduledStep>> Windows<I> {
    fn new(mut steps: I, tolerance: Tolerance, format: EntryFormat, pulse: PulseTimes) -> Self {
        let next = steps.next();
        Self { steps, tolerance, format, pulse, next, before: 0, count: 0, right: false }
    }

    /// Begins the next run; false where no step is left.
    fn begin(&mut self, ahead: &mut Ahead) -> Result<bool, Cause> {
        let Some(next) = self.next else { return Ok(false) };
        self.right = next.right;
        self.fill(ahead)?;
        Ok(true)
    }

    /// Reads on, some steps of the run; false at its end.
    fn fill(&mut self, ahead: &mut Ahead) -> Result<bool, Cause> {
        for _ in 0..256 {
            let Some(step) = self.next.filter(|step| step.right == self.right) else { return Ok(false) };
            ahead.push(self.window(step)?);
        }
        Ok(true)
    }

    /// The window of the next step; the one after it becomes the next.
    fn window(&mut self, step: ScheduledStep) -> Result<Window, Cause> {
        self.count += 1;
        self.next = self.steps.next();
        let before = step.cycle.saturating_sub(self.before);
        let after = self.next.map(|next| next.cycle.saturating_sub(step.cycle));
        if before < self.pulse.min_interval().0 {
            return Err(Cause::StepTooSoon { step: self.count, interval: before, pulse: self.pulse });
        }
        self.before = step.cycle;
        let off = self.tolerance.between(before, after);
        let (earliest, latest) = (step.cycle.saturating_sub(off), step.cycle.saturating_add(off));
        let last = LAST_CYCLE.0 - START.0;
        if latest > last {
            return Err(ValueError::TooMuch { given: latest as f64, most: last as f64, of: "cycles" }.into());
        }
        let bits = self.format.fraction_bits;
        let fraction = (1 << bits) - 1;
        Ok(Window { due: step.cycle, low: earliest << bits, high: (latest << bits) | fraction })
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

    fn steps(&mut self, windows: &[Window], interval: u64, add: i64, right: bool) {
        let bits = self.format.fraction_bits;
        let mut next = interval;
        for window in windows {
            self.time = self.time.wrapping_add(next);
            next = next.wrapping_add_signed(add);
            debug_assert!(
                (window.low..=window.high).contains(&self.time),
                "{} is not in {window:?}",
                self.time
            );
            self.error.step((self.time >> bits).abs_diff(window.due));
        }
        let shift = self.shift();
        let (interval, add) = (interval << shift, add << shift);
        let count = windows.len() as u32;
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
    use alloc::{collections::BTreeSet, vec};
    use rand_xoshiro::{
        Xoshiro256StarStar,
        rand_core::{Rng, SeedableRng},
    };

    const PULSE: PulseTimes = PulseTimes { width: Cycles(1), setup: Cycles(0), hold: Cycles(0) };

    fn right(cycles: &[u64]) -> Vec<ScheduledStep> {
        cycles.iter().map(|&cycle| ScheduledStep { cycle, right: true }).collect()
    }

    fn entries(due: &[u64], tolerance: u64) -> usize {
        let tolerance = Tolerance::of(Cycles(tolerance));
        let made = compressed(right(due), tolerance, EntryFormat::TICKS, PULSE).unwrap();
        assert!(made.error.greatest <= tolerance.cycles.0 && made.error.steps == due.len() as u64);
        made.list.segments.len()
    }

    /// The fewest entries of whole cycles, all intervals and adds tried from every time that a step can have.
    fn fewest(due: &[u64], tolerance: u64) -> usize {
        // reached[n]: times that step n can have, n from 0.
        let mut reached: Vec<BTreeSet<u64>> = vec![BTreeSet::new(); due.len() + 1];
        reached[0].insert(0);
        for entries in 1.. {
            let before = reached.clone();
            for (step, times) in before.iter().enumerate() {
                for &time in times {
                    for interval in 2..=40_i64 {
                        for add in -20..=20_i64 {
                            let (mut time, mut next) = (time as i64, interval);
                            for (n, &due) in (step + 1..).zip(&due[step..]) {
                                time += next;
                                if next < 2 || time.abs_diff(due as i64) > tolerance {
                                    break;
                                }
                                reached[n].insert(time as u64);
                                next += add;
                            }
                        }
                    }
                }
            }
            if !reached[due.len()].is_empty() {
                return entries;
            }
        }
        unreachable!("each step can have an entry of its own")
    }

    #[test]
    fn small_lists_have_the_fewest_entries_or_hardly_more() {
        let mut noise = Xoshiro256StarStar::seed_from_u64(7);
        let (mut made, mut least, mut same) = (0, 0, 0);
        let all = 150;
        for _ in 0..all {
            let (mut gap, mut due, mut steps) = (4 + noise.next_u64() % 12, 0, Vec::new());
            for _ in 0..10 {
                gap = (gap + noise.next_u64() % 5).saturating_sub(2).max(2);
                due += gap;
                steps.push(due);
            }
            let tolerance = noise.next_u64() % 3;
            let (found, optimum) = (entries(&steps, tolerance), fewest(&steps, tolerance));
            assert!((optimum..=optimum + 2).contains(&found), "{steps:?} {tolerance}: {found} {optimum}");
            (made, least) = (made + found, least + optimum);
            same += usize::from(found == optimum);
        }
        assert!(same * 10 >= all * 9 && made * 100 <= least * 103, "{made} {least} {same}");
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
