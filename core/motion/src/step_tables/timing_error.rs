//! Timing errors of the steps of a list: their distances from the due cycles (DESIGN B8).

use crate::ScheduledStep;
use stepscope_peripheral::segment::{FRACTION_BITS, Segment, SegmentList};

/// Timing errors of steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TimingError {
    pub steps: u64,
    /// Maximum error in cycles, early or late.
    pub max_cycles: u64,
    /// Sum of squares in cycles^2.
    squares: u128,
}

impl TimingError {
    pub(super) fn add(&mut self, distance: u64) {
        self.steps += 1;
        self.max_cycles = self.max_cycles.max(distance);
        self.squares = self.squares.saturating_add(u128::from(distance) * u128::from(distance));
    }

    /// Root mean square in cycles; 0 without steps.
    pub fn rms(&self) -> f64 {
        if self.steps == 0 { 0.0 } else { libm::sqrt(self.squares as f64 / self.steps as f64) }
    }

    /// The timing errors of a list whose steps are due at `due`, in cycles from the list's start; `None` if the number of steps
    /// or a direction differs.
    pub fn of(list: &SegmentList, due: impl IntoIterator<Item = ScheduledStep>) -> Option<Self> {
        let (mut error, mut time, mut due) = (Self::default(), 0_u64, due.into_iter());
        for segment in &list.segments {
            match *segment {
                Segment::Dwell(dwell) => time = time.wrapping_add(dwell),
                Segment::Steps { count, mut interval, add, right } => {
                    for _ in 0..count {
                        let step = due.next().filter(|step| step.right == right)?;
                        time = time.wrapping_add(interval);
                        interval = interval.wrapping_add_signed(add);
                        error.add((time >> FRACTION_BITS).abs_diff(step.cycle));
                    }
                }
            }
        }
        due.next().is_none().then_some(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{vec, vec::Vec};
    use stepscope_peripheral::{segment::SegmentList, units::Instant};

    /// The steps of a list, step i (from 0) `error(i)` cycles late.
    fn with_errors(list: &SegmentList, error: impl Fn(u64) -> u64) -> Vec<ScheduledStep> {
        let (mut time, mut due) = (0, Vec::new());
        for segment in &list.segments {
            match *segment {
                Segment::Dwell(dwell) => time += dwell,
                Segment::Steps { count, mut interval, add, right } => {
                    for _ in 0..count {
                        time += interval;
                        interval = interval.wrapping_add_signed(add);
                        due.push(ScheduledStep {
                            cycle: (time >> FRACTION_BITS) + error(due.len() as u64),
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
    fn sums_errors_of_every_size_exactly() {
        let list = list();
        // Up to 16 cycles, about 2^28 cycles, and 2^40 cycles, whose squares exceed 64 bits.
        for bits in [4, 28, 29, 40] {
            let error = |step: u64| step.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (64 - bits);
            let errors: Vec<u64> = (0..1001).map(error).collect();
            let expected = TimingError {
                steps: 1001,
                max_cycles: *errors.iter().max().unwrap(),
                squares: errors.iter().map(|error| u128::from(*error).pow(2)).sum(),
            };
            assert_eq!(TimingError::of(&list, with_errors(&list, error)), Some(expected), "{bits} bits");
        }
    }

    #[test]
    fn handles_the_last_cycles_of_64_bits() {
        let steps = Segment::Steps { count: 1, interval: 1 << FRACTION_BITS, add: 0, right: true };
        let list = SegmentList { start: Instant(1), segments: vec![steps] };
        for cycle in [u64::MAX, u64::MAX - 4, (1 << 63) + 2, 1 << 63, (1 << 63) - 1] {
            let found = TimingError::of(&list, [ScheduledStep { cycle, right: true }]).unwrap();
            let error = cycle - 1;
            let expected = TimingError { steps: 1, max_cycles: error, squares: u128::from(error).pow(2) };
            assert_eq!(found, expected, "{cycle}");
        }
    }

    #[test]
    fn another_number_of_steps_or_direction_gives_none() {
        let list = list();
        let due = with_errors(&list, |_| 0);
        assert_eq!(
            TimingError::of(&list, due.iter().copied()).map(|error| (error.steps, error.max_cycles)),
            Some((1001, 0))
        );
        for step in [0, 1, 255, 256, 257, 700, 701, 1000] {
            let mut reversed = due.clone();
            reversed[step].right = !reversed[step].right;
            assert_eq!(TimingError::of(&list, reversed), None, "step {step} is reversed");
            assert_eq!(TimingError::of(&list, due.iter().copied().take(step)), None, "{step} steps");
        }
        assert_eq!(TimingError::of(&list, due.iter().copied().chain(due.last().copied())), None, "one more");
    }
}
