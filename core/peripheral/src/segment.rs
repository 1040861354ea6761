//! Segments for the segment engine, and the rules for a list of them (DESIGN A8).
//!
//! ```text
//! next = start << 16                     48.16 fixed point: 1/65536 cycle
//! each step   next += interval           STEP rises at next >> 16
//!             interval += add
//! dwell       next += dwell
//! ```
//!
//! The intervals of a segment grow by a constant, so the first or last interval is the shortest, and the length has a
//! closed form: validation takes the same time for any number of steps.
//!
//! ```
//! use stepscope_peripheral::{segment::{CheckedSegments, PulseTimes, Refusal, Segment, SegmentList}, units::{Cycles,
//!     Instant}};
//!
//! let pulse = PulseTimes { width: Cycles(40), setup: Cycles(40), hold: Cycles(0) };
//! // A ramp: 100 steps, the first after 2000 cycles, each next interval 10 cycles shorter.
//! let ramp = |add| Segment::Steps { count: 100, interval: 2000 << 16, add, right: true };
//! let list = |add| vec![SegmentList { start: Instant(1), segments: vec![ramp(add)] }];
//!
//! let checked = CheckedSegments::new(pulse, list(-10 << 16), 1).expect("pulses do not overlap");
//! assert_eq!(checked.steps(), 100);
//!
//! // With 20 cycles, the 98th step comes too soon after the one before it.
//! let refused = CheckedSegments::new(pulse, list(-20 << 16), 1).unwrap_err();
//! assert_eq!(refused[0].refusal, Refusal::Interval { step: 97, interval: 60 << 16 });
//! ```

use crate::signal::MAX_CHANNELS;
use crate::units::{Cycles, Instant};
use alloc::vec::Vec;

/// Bits of a cycle's fraction: all times of a segment are in 1/65536 cycle.
pub const FRACTION_BITS: u32 = 16;
/// The last cycle of 48.16 fixed point.
pub const LAST_CYCLE: Instant = Instant(u64::MAX >> FRACTION_BITS);

/// Steps of one channel, or a pause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Segment {
    /// At least one step, the first after `interval`, which grows by `add` after each; both in 1/65536 cycle. Right is DIR 1.
    Steps { count: u32, interval: u64, add: i64, right: bool },
    /// A pause in 1/65536 cycle; 0 is allowed.
    Dwell(u64),
}

/// The segments of one channel, one after another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SegmentList {
    /// Start of the first segment, cycle 1 or later.
    pub start: Instant,
    pub segments: Vec<Segment>,
}

/// Times of a step pulse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PulseTimes {
    /// W: time that STEP is high.
    pub width: Cycles,
    /// D: time from a change of DIR to the rise of STEP.
    pub setup: Cycles,
    /// H: time from the fall of STEP to a change of DIR.
    pub hold: Cycles,
}

impl PulseTimes {
    /// The minimum step interval, W + max(H + D, 1).
    pub const fn min_interval(self) -> Cycles {
        let around = self.hold.0.saturating_add(self.setup.0);
        Cycles(self.width.0.saturating_add(if around == 0 { 1 } else { around }))
    }
}

/// Why a list of segments is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// There are more lists than channels.
    NoChannel,
    /// The start is before cycle 1, or after [`LAST_CYCLE`].
    Start,
    /// A segment of steps has a count of 0.
    NoSteps,
    /// An interval in 1/65536 cycle is too short for a pulse or exceeds 64 bits: the first such step of the segment, from 0.
    Interval { step: u32, interval: i128 },
    /// The last step or the end of a dwell, in 1/65536 cycle, exceeds 64 bits.
    End { next: i128 },
}

/// A refusal and its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refused {
    pub channel: usize,
    /// Index of the segment; `None` where the list itself is refused.
    pub segment: Option<usize>,
    pub refusal: Refusal,
}

/// Valid lists, one per channel.
/// Invariant: every time fits in u64, and no two pulses of a channel overlap.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CheckedSegments {
    pulse: PulseTimes,
    lists: Vec<SegmentList>,
    steps: u64,
    dir_changes: u64,
    end: Instant,
}

impl CheckedSegments {
    /// Validates the lists of channels 0, 1, ….
    /// Errors: the first `max` refusals, of each list up to a time beyond 64 bits; a segment with a bad interval takes no time.
    pub fn new(pulse: PulseTimes, lists: Vec<SegmentList>, max: usize) -> Result<Self, Vec<Refused>> {
        let mut refused = Vec::new();
        let mut all = Self { pulse, lists: Vec::new(), steps: 0, dir_changes: 0, end: Instant::RESET };
        for (channel, list) in lists.iter().enumerate() {
            all.validate(list, &mut |segment, refusal| {
                let refusal = if channel < MAX_CHANNELS { refusal } else { Refusal::NoChannel };
                if refused.len() < max {
                    refused.push(Refused { channel, segment, refusal });
                }
            });
            if channel >= MAX_CHANNELS && refused.len() < max {
                refused.push(Refused { channel, segment: None, refusal: Refusal::NoChannel });
            }
        }
        all.lists = lists;
        debug_assert!(
            !refused.is_empty() || all.end.0 <= LAST_CYCLE.0.saturating_add(pulse.width.0),
            "the last step leaves 48.16 fixed point"
        );
        if refused.is_empty() { Ok(all) } else { Err(refused) }
    }

    fn validate(&mut self, list: &SegmentList, refuse: &mut dyn FnMut(Option<usize>, Refusal)) {
        if list.start == Instant::RESET || list.start > LAST_CYCLE {
            return refuse(None, Refusal::Start);
        }
        let mut next = i128::from(list.start.0) << FRACTION_BITS;
        let (mut level, mut last_step) = (false, None);
        for (index, segment) in list.segments.iter().enumerate() {
            match *segment {
                Segment::Steps { count: 0, .. } => refuse(Some(index), Refusal::NoSteps),
                Segment::Steps { count, interval, add, right } => {
                    if let Some((step, interval)) = self.first_invalid(count, interval, add) {
                        refuse(Some(index), Refusal::Interval { step, interval });
                        continue;
                    }
                    next += length(count, interval, add);
                    last_step = Some(next);
                    self.steps = self.steps.saturating_add(count.into());
                    self.dir_changes += u64::from(right != level);
                    level = right;
                }
                Segment::Dwell(dwell) => next += i128::from(dwell),
            }
            if next > i128::from(u64::MAX) {
                return refuse(Some(index), Refusal::End { next });
            }
        }
        if let Some(last_step) = last_step {
            let rise = Instant((last_step >> FRACTION_BITS) as u64);
            self.end = self.end.max(rise + self.pulse.width);
        }
    }

    fn first_invalid(&self, count: u32, interval: u64, add: i64) -> Option<(u32, i128)> {
        let min = i128::from(self.pulse.min_interval().0) << FRACTION_BITS;
        let max = i128::from(u64::MAX);
        let at = |step: u32| i128::from(interval) + i128::from(step) * i128::from(add);
        let is_invalid = |step: u32| !(min..=max).contains(&at(step));
        let (first, last) = (at(0), count.saturating_sub(1));
        let step = if is_invalid(0) {
            0
        } else if !is_invalid(last) {
            return None;
        } else if add < 0 {
            ((first - min) / -i128::from(add) + 1) as u32
        } else {
            ((max - first) / i128::from(add) + 1) as u32
        };
        debug_assert!(
            is_invalid(step) && !step.checked_sub(1).is_some_and(is_invalid),
            "step {step} is not the first"
        );
        Some((step, at(step)))
    }

    pub const fn pulse(&self) -> PulseTimes {
        self.pulse
    }

    /// The lists of channels 0, 1, ….
    pub fn lists(&self) -> &[SegmentList] {
        &self.lists
    }

    pub fn into_lists(self) -> Vec<SegmentList> {
        self.lists
    }

    /// Steps of all channels.
    pub const fn steps(&self) -> u64 {
        self.steps
    }

    /// Maximum number of records: the first, two per step, and one per change of DIR.
    pub const fn max_records(&self) -> u64 {
        self.steps.saturating_mul(2).saturating_add(self.dir_changes).saturating_add(1)
    }

    /// The last cycle in which a signal changes; 0 without steps.
    pub const fn end(&self) -> Instant {
        self.end
    }
}

/// Length of a segment in 1/65536 cycle.
fn length(count: u32, interval: u64, add: i64) -> i128 {
    let count = i128::from(count);
    count * i128::from(interval) + i128::from(add) * (count * (count - 1) / 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    const PULSE: PulseTimes = PulseTimes { width: Cycles(3), setup: Cycles(2), hold: Cycles(1) };
    /// (W + max(H + D, 1)) << 16
    const MIN: u64 = 6 << 16;

    fn steps(count: u32, interval: u64, add: i64) -> Segment {
        Segment::Steps { count, interval, add, right: true }
    }

    fn refusals(start: u64, segments: Vec<Segment>) -> Vec<(Option<usize>, Refusal)> {
        let list = SegmentList { start: Instant(start), segments };
        let refused = CheckedSegments::new(PULSE, vec![list], 100).err().unwrap_or_default();
        refused.into_iter().map(|refused| (refused.segment, refused.refusal)).collect()
    }

    #[test]
    fn each_limit_is_accepted_and_one_beyond_is_refused() {
        let interval = |step, interval| Refusal::Interval { step, interval };
        let min = i128::from(MIN);
        // Start, segment, refusal.
        let rows = [
            (0, Segment::Dwell(0), Some((None, Refusal::Start))),
            (LAST_CYCLE.0, Segment::Dwell(0xffff), None),
            (LAST_CYCLE.0 + 1, Segment::Dwell(0), Some((None, Refusal::Start))),
            (LAST_CYCLE.0, Segment::Dwell(0x1_0000), Some((Some(0), Refusal::End { next: 1 << 64 }))),
            (1, steps(0, MIN, 0), Some((Some(0), Refusal::NoSteps))),
            (1, steps(1, MIN, i64::MIN), None),
            (1, steps(1, MIN - 1, 0), Some((Some(0), interval(0, min - 1)))),
            (1, steps(4, MIN + 3, -1), None),
            (1, steps(5, MIN + 3, -1), Some((Some(0), interval(4, min - 1)))),
            (1, steps(9, MIN + 3, -2), Some((Some(0), interval(2, min - 1)))),
            (1, steps(u32::MAX, MIN, 0), None),
            (1, steps(u32::MAX, MIN + u64::from(u32::MAX) - 1, -1), None),
            (
                1,
                steps(u32::MAX, MIN + u64::from(u32::MAX) - 2, -1),
                Some((Some(0), interval(u32::MAX - 1, min - 1))),
            ),
        ];
        for (start, segment, expected) in rows {
            assert_eq!(refusals(start, vec![segment]), Vec::from_iter(expected), "{start} {segment:?}");
        }
    }

    #[test]
    fn intervals_and_times_beyond_64_bits_are_different_refusals() {
        let max = i128::from(u64::MAX);
        let found = refusals(1, vec![steps(2, u64::MAX - 0x10_0000, i64::MAX)]);
        let interval = max - 0x10_0000 + i128::from(i64::MAX);
        assert_eq!(found, [(Some(0), Refusal::Interval { step: 1, interval })]);
        let found = refusals(1, vec![steps(2, u64::MAX - 0x10_0000, 0)]);
        assert_eq!(found, [(Some(0), Refusal::End { next: 2 * (max - 0x10_0000) + 0x1_0000 })]);
        // Two steps of half the time each, to the last 65536th.
        let half = (u64::MAX - 0x1_0000) / 2;
        assert_eq!(refusals(1, vec![steps(2, half, 0), Segment::Dwell(1)]), []);
        let found = refusals(1, vec![steps(2, half, 0), Segment::Dwell(2), Segment::Dwell(5)]);
        assert_eq!(found, [(Some(1), Refusal::End { next: max + 1 })]);
        // The maximum numbers do not overflow.
        let found = refusals(1, vec![steps(u32::MAX, u64::MAX, i64::MAX), steps(u32::MAX, 0, i64::MIN)]);
        assert_eq!(found.len(), 2);
    }

    #[test]
    fn minimum_interval_has_the_pulse_and_dir_times_or_one_cycle() {
        // W, D, H, minimum interval.
        let rows = [(1, 0, 0, 2), (3, 2, 1, 6), (3, 0, 1, 4), (3, 1, 0, 4), (u64::MAX, 5, 5, u64::MAX)];
        for (width, setup, hold, expected) in rows {
            let pulse = PulseTimes { width: Cycles(width), setup: Cycles(setup), hold: Cycles(hold) };
            assert_eq!(pulse.min_interval(), Cycles(expected), "{pulse:?}");
        }
    }

    #[test]
    fn steps_records_and_end_are_known_before_the_run() {
        let ten_steps = |right| Segment::Steps { count: 10, interval: MIN, add: 0, right };
        let list = |start, segments| SegmentList { start: Instant(start), segments };
        let lists = vec![
            list(5, vec![ten_steps(false), ten_steps(true), ten_steps(true), Segment::Dwell(1 << 40)]),
            list(1, vec![Segment::Dwell(7)]),
            list(100, vec![ten_steps(true)]),
        ];
        let lists = CheckedSegments::new(PULSE, lists, 100).unwrap();
        assert_eq!((lists.steps(), lists.max_records()), (40, 1 + 80 + 2));
        assert_eq!(lists.end(), Instant(5 + 30 * 6 + 3));
        let lists = vec![list(1, vec![]); 17];
        let refused = CheckedSegments::new(PULSE, lists, 100).unwrap_err();
        assert_eq!(refused, [Refused { channel: 16, segment: None, refusal: Refusal::NoChannel }]);
    }
}
