//! How far the steps of a list are from where they are due (DESIGN B8).

use crate::ScheduledStep;
use stepscope_peripheral::segment::{FRACTION_BITS, Segment, SegmentList};

/// Steps whose errors are summed at once, and cycles below which each of them is for the sum of their squares to have 64 bits.
const AT_ONCE: usize = 256;
const MANY: u64 = 1 << 28;
const _: () = assert!(2 * MANY.ilog2() + AT_ONCE.ilog2() <= u64::BITS);

/// How far steps are from their due cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TimingError {
    /// Steps.
    pub steps: u64,
    /// Greatest error of a step in cycles, early or late.
    pub greatest: u64,
    /// Sum of all errors' squares in cycles^2.
    squares: u128,
}

impl TimingError {
    /// Takes so many steps into account, with the greatest of their errors and the sum of their squares.
    #[inline]
    pub(super) fn steps(&mut self, steps: usize, greatest: u64, squares: u128) {
        (self.steps, self.greatest) = (self.steps + steps as u64, self.greatest.max(greatest));
        self.squares = self.squares.saturating_add(squares);
    }

    /// Root of the mean square in cycles; 0 of no steps.
    #[must_use]
    pub fn rms(&self) -> f64 {
        if self.steps == 0 { 0.0 } else { libm::sqrt(self.squares as f64 / self.steps as f64) }
    }

    /// That of a list whose steps are to come at `due`, in cycles from the list's start; None if it has another number of
    /// steps, or one goes the other way.
    #[must_use]
    pub fn of(list: &SegmentList, due: impl IntoIterator<Item = ScheduledStep>) -> Option<Self> {
        let mut due = due.into_iter();
        let mut listed = Listed::new(&list.segments);
        let mut steps = [ScheduledStep { cycle: 0, right: false }; AT_ONCE];
        loop {
            // Into places that are there, and with nothing else: either loop keeps its numbers in registers.
            let mut len = 0;
            due.by_ref().take(AT_ONCE).for_each(|step| {
                if let Some(place) = steps.get_mut(len) {
                    (*place, len) = (step, len + 1);
                }
            });
            if !listed.take(steps.get(..len)?) {
                return None;
            }
            if len < AT_ONCE {
                listed.next_segment();
                return (listed.left == 0).then_some(listed.error);
            }
        }
    }
}

/// The steps of a list, one after another.
struct Listed<'l> {
    segments: core::slice::Iter<'l, Segment>,
    /// Of the segment where it is: the steps to come, the interval to the next and what each is longer, and their way.
    left: usize,
    interval: u64,
    add: i64,
    right: bool,
    /// Of the last step, in 1/65536 cycle.
    time: u64,
    error: TimingError,
}

impl<'l> Listed<'l> {
    fn new(segments: &'l [Segment]) -> Self {
        let (segments, error) = (segments.iter(), TimingError::default());
        Self { segments, left: 0, interval: 0, add: 0, right: true, time: 0, error }
    }

    /// Goes on to the next segment with steps, where this one has none left.
    fn next_segment(&mut self) {
        while self.left == 0 {
            match self.segments.next() {
                Some(&Segment::Dwell(dwell)) => self.time = self.time.wrapping_add(dwell),
                Some(&Segment::Steps { count, interval, add, right }) => {
                    (self.left, self.interval) = (count as usize, interval);
                    (self.add, self.right) = (add, right);
                }
                None => return,
            }
        }
    }

    /// Takes the next steps into account, which are due then; whether there are as many that go those ways.
    #[inline(never)]
    fn take(&mut self, mut due: &[ScheduledStep]) -> bool {
        let mut go_that_way = true;
        while !due.is_empty() {
            self.next_segment();
            if self.left == 0 {
                return false;
            }
            let (steps, rest) = due.split_at(self.left.min(due.len()));
            let (mut time, mut interval, add, right) = (self.time, self.interval, self.add, self.right);
            let (mut greatest, mut squares, mut seen) = (0, 0_u64, 0);
            for step in steps {
                time = time.wrapping_add(interval);
                interval = interval.wrapping_add_signed(add);
                let off = ((time >> FRACTION_BITS).wrapping_sub(step.cycle) as i64).unsigned_abs();
                greatest = off.max(greatest);
                squares = squares.wrapping_add(off.wrapping_mul(off));
                seen |= step.cycle;
                go_that_way &= step.right == right;
            }
            self.left -= steps.len();
            let is_near = greatest < MANY && seen < 1 << 63;
            let (greatest, squares) = if is_near { (greatest, squares.into()) } else { self.far_off(steps) };
            self.error.steps(steps.len(), greatest, squares);
            (self.time, self.interval) = (time, interval);
            due = rest;
        }
        go_that_way
    }

    /// The greatest of the next steps' errors and the sum of their squares, which 64 bits may not hold.
    #[cold]
    fn far_off(&self, steps: &[ScheduledStep]) -> (u64, u128) {
        let (mut time, mut interval) = (self.time, self.interval);
        steps.iter().fold((0, 0), |(greatest, sum): (u64, u128), step| {
            time = time.wrapping_add(interval);
            interval = interval.wrapping_add_signed(self.add);
            let off = (time >> FRACTION_BITS).abs_diff(step.cycle);
            (greatest.max(off), sum.saturating_add(u128::from(off) * u128::from(off)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{vec, vec::Vec};
    use stepscope_peripheral::{segment::SegmentList, units::Instant};

    /// The steps of a list, each so many cycles away from where it stands.
    fn away(list: &SegmentList, off: impl Fn(u64) -> u64) -> Vec<ScheduledStep> {
        let (mut time, mut due) = (0, Vec::new());
        for segment in &list.segments {
            match *segment {
                Segment::Dwell(dwell) => time += dwell,
                Segment::Steps { count, mut interval, add, right } => {
                    for _ in 0..count {
                        time += interval;
                        interval = interval.wrapping_add_signed(add);
                        due.push(ScheduledStep {
                            cycle: (time >> FRACTION_BITS) + off(due.len() as u64),
                            right,
                        });
                    }
                }
            }
        }
        due
    }

    fn list() -> SegmentList {
        let steps = |count, interval, add, right| Segment::Steps { count, interval, add, right };
        let segments = vec![
            steps(1, 3 << 20, 0, true),
            Segment::Dwell(5 << 20),
            Segment::Dwell(1),
            steps(0, 1 << 20, 0, true),
            steps(700, 1 << 20, 77, true),
            steps(300, 2 << 20, -1000, false),
        ];
        SegmentList { start: Instant(1), segments }
    }

    #[test]
    fn errors_of_every_size_are_summed_without_a_rounding() {
        let list = list();
        // Up to 16 cycles, up to about 2^28 within some steps and beyond in others, and so far that no 64 bits hold a square.
        for bits in [4, 28, 29, 40] {
            let off = |step: u64| step.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - bits);
            let offs: Vec<u64> = (0..1001).map(off).collect();
            let expected = TimingError {
                steps: 1001,
                greatest: *offs.iter().max().unwrap(),
                squares: offs.iter().map(|off| u128::from(*off) * u128::from(*off)).sum(),
            };
            assert_eq!(TimingError::of(&list, away(&list, off)), Some(expected), "{bits} bits");
        }
    }

    #[test]
    fn a_step_that_is_due_in_the_last_cycles_of_all_is_as_far_off_as_it_is() {
        let steps = Segment::Steps { count: 1, interval: 1 << FRACTION_BITS, add: 0, right: true };
        let list = SegmentList { start: Instant(1), segments: vec![steps] };
        for cycle in [u64::MAX, u64::MAX - 4, (1 << 63) + 2, 1 << 63, (1 << 63) - 1] {
            let found = TimingError::of(&list, [ScheduledStep { cycle, right: true }]).unwrap();
            let off = cycle - 1;
            let expected =
                TimingError { steps: 1, greatest: off, squares: u128::from(off) * u128::from(off) };
            assert_eq!(found, expected, "{cycle}");
        }
    }

    #[test]
    fn another_number_of_steps_or_another_way_has_no_error() {
        let list = list();
        let due = away(&list, |_| 0);
        assert_eq!(
            TimingError::of(&list, due.iter().copied()).map(|error| (error.steps, error.greatest)),
            Some((1001, 0))
        );
        for step in [0, 1, 255, 256, 257, 700, 701, 1000] {
            let mut turned = due.clone();
            turned[step].right = !turned[step].right;
            assert_eq!(TimingError::of(&list, turned), None, "step {step} goes the other way");
            assert_eq!(TimingError::of(&list, due.iter().copied().take(step)), None, "{step} steps");
        }
        assert_eq!(TimingError::of(&list, due.iter().copied().chain(due.last().copied())), None, "one more");
    }
}
