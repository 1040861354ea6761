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
//! Each entry is the longest that there is from where the entry before it ended, of those whose last step comes close to
//! the middle of its window (an eighth of it). Without that last condition entries would be longer one by one and yet
//! more in number: an entry of greatest length ends at the edge of a window, the worst place for the next one to begin.
//! Where the curve's third derivative is nearly constant, entries from middle to middle have 0.87 of the length that
//! entries with free ends had, from edge to edge 0.75. The fewest entries of all are not searched for.

use super::{
    entry_format::EntryFormat,
    longest::{Ahead, Window},
    stored::TimingError,
};
use crate::{
    motion::DueStep,
    scenario::Cause,
    segment::{FRACTION_BITS, LAST_CYCLE, PulseTimes, Segment, SegmentList},
    units::{Cycles, Instant},
};
use alloc::vec::Vec;
use core::num::NonZeroU32;

/// Greatest tolerance in cycles.
pub const MOST_TOLERANCE: Cycles = Cycles(1 << 24);
/// Most entries of a list: 64 MB.
const MOST_ENTRIES: usize = 2_000_000;
/// Where the motion's time 0 is: nothing starts before (A3).
const START: Instant = Instant(1);

/// How far a step may be from its due cycle, either way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tolerance {
    /// In cycles, at most [`MOST_TOLERANCE`].
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
    steps: impl IntoIterator<Item = DueStep>,
    tolerance: Tolerance,
    format: EntryFormat,
    pulse: PulseTimes,
) -> Result<Compressed, Cause> {
    if tolerance.cycles > MOST_TOLERANCE {
        let (given, most) = (tolerance.cycles.0 as f64, MOST_TOLERANCE.0 as f64);
        return Err(Cause::TooMuch { given, most, of: "cycles of tolerance" });
    }
    let mut windows = Windows::new(steps.into_iter(), tolerance, format, pulse)?;
    let mut writer = Writer::new(format);
    let mut ahead = Ahead::new(format, pulse.least_interval().0);
    let mut length = 64;
    while windows.begin(&mut ahead)? {
        while let Some(longest) = ahead.longest(writer.time, length, |ahead| windows.fill(ahead))? {
            writer.wait(longest.wait);
            writer.steps(ahead.taken(longest.count), longest.interval, longest.add, windows.right);
            ahead.take(longest.count);
            length = longest.count;
            if writer.segments.len() > MOST_ENTRIES {
                let (given, most) = (writer.segments.len() as f64, MOST_ENTRIES as f64);
                return Err(Cause::TooMuch { given, most, of: "entries" });
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
    next: Option<DueStep>,
    before: u64,
    /// Steps that were read.
    count: u64,
    /// Which way the run goes.
    right: bool,
}

impl<I: Iterator<Item = DueStep>> Windows<I> {
    fn new(
        mut steps: I,
        tolerance: Tolerance,
        format: EntryFormat,
        pulse: PulseTimes,
    ) -> Result<Self, Cause> {
        let next = steps.next();
        Ok(Self { steps, tolerance, format, pulse, next, before: 0, count: 0, right: false })
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
    fn window(&mut self, step: DueStep) -> Result<Window, Cause> {
        self.count += 1;
        self.next = self.steps.next();
        let before = step.cycle.saturating_sub(self.before);
        let after = self.next.map(|next| next.cycle.saturating_sub(step.cycle));
        if before < self.pulse.least_interval().0 {
            return Err(Cause::StepTooSoon { step: self.count, interval: before, pulse: self.pulse });
        }
        self.before = step.cycle;
        let off = self.tolerance.between(before, after);
        let (earliest, latest) = (step.cycle.saturating_sub(off), step.cycle.saturating_add(off));
        let last = LAST_CYCLE.0 - START.0;
        if latest > last {
            return Err(Cause::TooMuch { given: latest as f64, most: last as f64, of: "cycles" });
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
