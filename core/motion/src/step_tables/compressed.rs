//! Compresses steps into few entries (DESIGN B8): every step is within a tolerance of its due cycle.
//!
//! ```text
//! due      |    |   |  |  | | | |         a window around each due cycle
//! window  [ ]  [ ] [ ][ ] …               error <= tolerance
//! entry    \___ interval, add, count      one parabola through the windows of its steps
//! ```
//!
//! Times are computed in the integers of the format, as in the segment engine: the number of steps is exact, no step leaves
//! its window, and only the error of an entry's last step affects the next entry.
//!
//! If the windows are narrow enough, the fewest entries are searched for ([`super::fewest`]). Otherwise, and for the quick
//! search, each entry is the longest whose last step is near the middle of its window ([`super::longest`]). The longest entry
//! of all would end at the edge of a window, a bad start for the next entry: such lists have about an eighth more entries.

use super::fewest::{self, FoundEntry, Section};
use super::longest::{LookAhead, Window};
use super::{entry_format::EntryFormat, segments::START, timing_error::TimingError};
use crate::ScheduledStep;
use crate::problem::{Cause, ValueError};
use alloc::{collections::VecDeque, vec::Vec};
use core::num::NonZeroU32;
use stepscope_peripheral::segment::{LAST_CYCLE, PulseTimes, Segment, SegmentList};
use stepscope_peripheral::units::Cycles;

pub const MAX_TOLERANCE: Cycles = Cycles(1 << 24);
/// Maximum entries of a list: 64 MB.
const MAX_ENTRIES: usize = 2_000_000;
/// Maximum work of the search for the fewest entries, in pairs of interval and add: about two seconds, and ten
/// microseconds per step of the list.
const WORK: u64 = 1 << 28;
const WORK_PER_STEP: u64 = 1 << 10;
const LAST: u64 = LAST_CYCLE.0 - START.0;
const READ: usize = 256;

/// Which errors a tolerance allows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Side {
    /// Early or late.
    #[default]
    Both,
    /// Only early, like Klipper's step compression.
    Early,
}

/// Maximum timing error of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tolerance {
    /// At most [`MAX_TOLERANCE`].
    pub cycles: Cycles,
    /// Also limits the error to a part of the shorter interval next to the step, or for [`Side::Early`] of the interval before
    /// it: 2 for a half.
    pub interval_part: Option<NonZeroU32>,
    pub side: Side,
}

impl Tolerance {
    /// A number of cycles to both sides, independent of the intervals.
    pub const fn of(cycles: Cycles) -> Self {
        Self { cycles, interval_part: None, side: Side::Both }
    }

    fn window(self, due: u64, before: u64, after: Option<u64>) -> (u64, u64) {
        let shorter = match (self.side, after) {
            (Side::Both, Some(after)) => after.min(before),
            (Side::Early, _) | (Side::Both, None) => before,
        };
        let part = self.interval_part.map_or(u64::MAX, |part| shorter / u64::from(part.get()));
        let distance = part.min(self.cycles.0);
        let late = if self.side == Side::Both { distance } else { 0 };
        (due.saturating_sub(distance), due.saturating_add(late))
    }
}

/// A compressed list.
#[derive(Clone, Debug, PartialEq)]
pub struct Compressed {
    pub list: SegmentList,
    pub error: TimingError,
    /// Maximum number of entries above the minimum: 0 if the list is proven minimal, more if it was cut into sections, `None`
    /// if the search for the minimum was not run or not completed.
    pub surplus: Option<u64>,
}

/// Compresses the steps of one axis, whose cycles count from the start of the motion, into the fewest entries of `format`.
/// If the windows are too wide for that search, it works like [`compressed_quickly`].
/// Errors: a tolerance that is too large; a step too soon for `pulse`, or too late for 48.16 fixed point; too many entries.
pub fn compressed(
    steps: impl IntoIterator<Item = ScheduledStep>,
    tolerance: Tolerance,
    format: EntryFormat,
    pulse: PulseTimes,
) -> Result<Compressed, Cause> {
    let mut compression = Compression::new(steps.into_iter(), tolerance, format, pulse)?;
    let surplus = compression.fewest()?;
    compression.quick()?;
    Ok(Compressed { surplus, ..compression.end() })
}

/// Compresses into few entries, each the longest that ends near the middle of a window, in a fraction of the time.
/// Errors: as [`compressed`].
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

struct Compression<I> {
    windows: Windows<I>,
    writer: Writer,
}

impl<I: Iterator<Item = ScheduledStep>> Compression<I> {
    fn new(steps: I, tolerance: Tolerance, format: EntryFormat, pulse: PulseTimes) -> Result<Self, Cause> {
        if tolerance.cycles > MAX_TOLERANCE {
            let (given, max) = (tolerance.cycles.0, MAX_TOLERANCE.0);
            return Err(ValueError::too_much(given, max, "cycles of tolerance").into());
        }
        let mut windows = Windows {
            steps,
            next: None,
            returned: Vec::new(),
            tolerance,
            format,
            pulse,
            last_cycle: 0,
            count: 0,
        };
        windows.read();
        Ok(Self { windows, writer: Writer::new(format) })
    }

    /// Compresses into the fewest entries; returns the surplus, or `None` if steps are left.
    fn fewest(&mut self) -> Result<Option<u64>, Cause> {
        let mut ready = VecDeque::new();
        let (last, surplus) = self.sections(&mut ready)?;
        self.windows.put_back(last, &ready);
        Ok(surplus)
    }

    /// Compresses sections; returns the cycle of the last compressed step, and the surplus. `ready` gets the steps that were
    /// read but not compressed.
    fn sections(&mut self, ready: &mut VecDeque<(Window, bool)>) -> Result<(u64, Option<u64>), Cause> {
        let (format, pulse) = (self.windows.format, self.windows.pulse);
        let min = pulse.min_interval().0 << format.fraction_bits;
        let (mut last, mut cuts, mut work) = (0, 0, WORK);
        loop {
            while let Some(step) = self.windows.next.filter(|_| ready.len() < fewest::MAX_STEPS) {
                ready.push_back((self.windows.window()?, step.right));
            }
            let more = self.windows.next.is_some();
            let steps = ready.make_contiguous();
            let Some((first, _)) = steps.first() else { return Ok((last, Some(cuts))) };
            if steps.iter().any(|(window, _)| window.high - window.low >= fewest::MAX_WIDTH) {
                return Ok((last, None));
            }
            let is_near =
                |before: u64, window: &Window| window.high.saturating_sub(before) <= format.max_interval();
            if !is_near(self.writer.time, first) {
                self.writer.wait(first.single_step(self.writer.time, min, format).wait);
            }
            // A section ends before a pause that is longer than any interval.
            let pairs = steps.iter().zip(steps.iter().skip(1));
            let length =
                1 + pairs.take_while(|((before, _), (window, _))| is_near(before.low, window)).count();
            let is_cut = more && length == steps.len();
            // If some times of the two steps are close enough, another list may not need the wait.
            let may_not_need_wait =
                steps.get(length - 1).zip(steps.get(length)).is_some_and(|((before, _), (window, _))| {
                    window.low.saturating_sub(before.high) <= format.max_interval()
                });
            let section =
                Section::new(format, min, self.writer.time, steps.get(..length).unwrap_or_default());
            let Some(left) = work.checked_sub(length as u64) else { return Ok((last, None)) };
            work = left;
            let Some(entries) = section.fewest_entries(is_cut, &mut work) else { return Ok((last, None)) };
            let done = self.writer.entries(&entries, steps);
            last = steps.get(done.wrapping_sub(1)).map_or(last, |(window, _)| window.due_cycle);
            // Only compressed steps count, because the others are searched again in the next section.
            work += WORK_PER_STEP * done as u64;
            cuts += u64::from(is_cut || done < length) + 2 * u64::from(may_not_need_wait);
            ready.drain(..done);
            self.writer.check_length()?;
        }
    }

    fn quick(&mut self) -> Result<(), Cause> {
        let Self { windows, writer } = self;
        let mut ahead = LookAhead::new(windows.format, windows.pulse.min_interval().0);
        let mut length = 64;
        while let Some(ScheduledStep { right, .. }) = windows.next {
            windows.fill(right, &mut ahead)?;
            while let Some(longest) =
                ahead.longest(writer.time, length, |ahead| windows.fill(right, ahead))?
            {
                writer.wait(longest.wait);
                let windows = ahead.first_windows(longest.count);
                writer.steps(windows.iter(), (longest.interval, longest.add, right));
                ahead.remove(longest.count);
                length = longest.count;
                writer.check_length()?;
            }
        }
        Ok(())
    }

    fn end(self) -> Compressed {
        let list = SegmentList { start: START, segments: self.writer.segments };
        Compressed { list, error: self.writer.error, surplus: None }
    }
}

struct Windows<I> {
    steps: I,
    next: Option<ScheduledStep>,
    /// Steps to be read again, the last first.
    returned: Vec<ScheduledStep>,
    tolerance: Tolerance,
    format: EntryFormat,
    pulse: PulseTimes,
    last_cycle: u64,
    count: u64,
}

impl<I: Iterator<Item = ScheduledStep>> Windows<I> {
    fn read(&mut self) {
        self.next = self.returned.pop().or_else(|| self.steps.next());
    }

    fn put_back(&mut self, last_cycle: u64, steps: &VecDeque<(Window, bool)>) {
        (self.last_cycle, self.count) = (last_cycle, self.count - steps.len() as u64);
        self.returned.extend(self.next);
        let steps = steps.iter().rev();
        self.returned
            .extend(steps.map(|(window, right)| ScheduledStep { cycle: window.due_cycle, right: *right }));
        self.read();
    }

    /// Reads windows of steps in one direction; returns false after the last of them.
    fn fill(&mut self, right: bool, ahead: &mut LookAhead) -> Result<bool, Cause> {
        for _ in 0..READ {
            if self.next.is_none_or(|step| step.right != right) {
                return Ok(false);
            }
            let window = self.window()?;
            ahead.windows_mut().push(window);
        }
        Ok(true)
    }

    fn window(&mut self) -> Result<Window, Cause> {
        let step = self.next.ok_or(Cause::EmptySegment)?;
        self.read();
        let after = self.next.map(|after| after.cycle.saturating_sub(step.cycle));
        self.count += 1;
        let before = step.cycle.saturating_sub(self.last_cycle);
        if before < self.pulse.min_interval().0 {
            return Err(Cause::StepTooSoon { step: self.count, interval: before, pulse: self.pulse });
        }
        self.last_cycle = step.cycle;
        let (earliest, latest) = self.tolerance.window(step.cycle, before, after);
        if latest > LAST {
            return Err(ValueError::too_much(latest, LAST, "cycles").into());
        }
        Ok(Window::of(step.cycle, (earliest, latest), self.format))
    }
}

pub(super) fn check_entries(count: usize) -> Result<(), Cause> {
    if count <= MAX_ENTRIES {
        return Ok(());
    }
    Err(ValueError::too_much(count as u64, MAX_ENTRIES as u64, "entries").into())
}

struct Writer {
    format: EntryFormat,
    segments: Vec<Segment>,
    error: TimingError,
    time: u64,
}

impl Writer {
    fn new(format: EntryFormat) -> Self {
        Self { format, segments: Vec::new(), error: TimingError::default(), time: 0 }
    }

    fn wait(&mut self, wait: u64) {
        if wait > 0 {
            self.time += wait;
            self.segments.push(Segment::Dwell(wait << self.format.dropped_bits()));
        }
    }

    fn check_length(&self) -> Result<(), Cause> {
        check_entries(self.segments.len())
    }

    /// Writes the entries of the first of `steps`; returns how many these are.
    fn entries(&mut self, entries: &[FoundEntry], steps: &[(Window, bool)]) -> usize {
        let mut done = 0;
        for &FoundEntry { count, interval, add } in entries {
            let entry_steps = steps.get(done..done + count).unwrap_or_default();
            let right = entry_steps.first().is_some_and(|(_, right)| *right);
            self.steps(entry_steps.iter().map(|(window, _)| window), (interval as u64, add, right));
            done += count;
        }
        done
    }

    fn steps<'w>(
        &mut self,
        windows: impl ExactSizeIterator<Item = &'w Window>,
        (interval, add, right): (u64, i64, bool),
    ) {
        let (count, mut next) = (windows.len() as u32, interval);
        for window in windows {
            self.time = self.time.wrapping_add(next);
            next = next.wrapping_add_signed(add);
            debug_assert!(
                (window.low..=window.high).contains(&self.time),
                "{} is not in {window:?}",
                self.time
            );
            self.error.add((self.time >> self.format.fraction_bits).abs_diff(window.due_cycle));
        }
        let shift = self.format.dropped_bits();
        let (interval, add) = (interval << shift, add << shift);
        if !self.extends_last(count, interval, add, right) {
            self.segments.push(Segment::Steps { count, interval, add, right });
        }
    }

    /// Appends the steps to the last segment if they continue it.
    fn extends_last(&mut self, more: u32, interval: u64, add: i64, right: bool) -> bool {
        let max = self.format.max_count();
        let Some(Segment::Steps { count, interval: first, add: grows, right: same }) =
            self.segments.last_mut()
        else {
            return false;
        };
        let next = first.wrapping_add_signed(grows.wrapping_mul(i64::from(*count)));
        let all = count.checked_add(more).filter(|all| *all <= max);
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

    /// Cycles that rise and fall by about 2^63, whose 64-bit differences look like rises.
    #[test]
    fn refuses_cycles_beyond_the_last_one() {
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
        assert!(made.error.max_cycles <= tolerance.cycles.0 && made.error.steps == due.len() as u64);
        assert_eq!(made.surplus, Some(0));
        made.list.segments.len()
    }

    #[test]
    fn a_parabola_is_one_entry() {
        let rows: [(Vec<u64>, usize); 5] = [
            (vec![], 0),
            (vec![7], 1),
            ((1..=1000).map(|k| k * 80).collect(), 1),
            ((1..=1000).map(|k| k * 20_000 - k * (k - 1) / 2 * 3).collect(), 1),
            // More steps than the count of an entry.
            ((1..=70_000).map(|k| k * 80).collect(), 2),
        ];
        for (due, expected) in rows {
            assert_eq!(entries(&due, 0), expected, "{:?}", due.get(..3));
        }
    }

    #[test]
    fn a_quick_entry_may_have_the_steepest_add() {
        // Intervals of 10 and 100 cycles, and the reverse.
        for due in [[10, 110], [100, 110]] {
            let made = compressed_quickly(right(&due), Tolerance::of(Cycles(0)), EntryFormat::TICKS, PULSE);
            assert_eq!(made.map(|made| made.list.segments.len()), Ok(1), "{due:?}");
        }
    }

    #[test]
    fn a_change_of_direction_and_a_long_pause_end_an_entry() {
        let mut due: Vec<ScheduledStep> = right(&[10, 20, 30]);
        due.extend([40, 50, 1 << 40].map(|cycle| ScheduledStep { cycle, right: false }));
        let made = compressed(due.clone(), Tolerance::of(Cycles(0)), EntryFormat::TICKS, PULSE).unwrap();
        let directions: Vec<Option<bool>> = made
            .list
            .segments
            .iter()
            .map(|segment| match segment {
                Segment::Steps { right, .. } => Some(*right),
                Segment::Dwell(_) => None,
            })
            .collect();
        assert_eq!(directions, [Some(true), Some(false), None, Some(false)]);
        assert_eq!(TimingError::of(&made.list, due), Some(made.error));
    }

    #[test]
    fn steps_can_be_in_the_last_cycles() {
        let last = LAST_CYCLE.0 - 1;
        let due = [last - 20, last - 10, last];
        for format in EntryFormat::ALL {
            let made = compressed(right(&due), Tolerance::of(Cycles(0)), format, PULSE);
            assert_eq!(made.map(|made| made.error.max_cycles), Ok(0), "{}", format.name);
        }
        let late = compressed(right(&due), Tolerance::of(Cycles(1)), EntryFormat::Q16, PULSE);
        let cause = ValueError::TooMuch { given: last as f64 + 1.0, max: last as f64, of: "cycles" };
        assert_eq!(late, Err(cause.into()));
        let soon = compressed(right(&[5, 6]), Tolerance::of(Cycles(1)), EntryFormat::Q16, PULSE);
        assert_eq!(soon, Err(Cause::StepTooSoon { step: 2, interval: 1, pulse: PULSE }));
    }
}
