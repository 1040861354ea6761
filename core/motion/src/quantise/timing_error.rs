//! How far the steps of a list are from where they are due (DESIGN B8).

use crate::ScheduledStep;
use stepscope_peripheral::segment::{FRACTION_BITS, Segment, SegmentList};

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
    /// Takes a step into account that is so many cycles early or late.
    #[inline]
    fn step(&mut self, off: u64) {
        self.steps += 1;
        self.greatest = self.greatest.max(off);
        // By halves: not every target has a product of 128 bits.
        let (upper, lower) = (off >> 32, off & 0xffff_ffff);
        let mixed = u128::from(upper * lower) << 33;
        let square = (u128::from(upper * upper) << 64) + mixed + u128::from(lower * lower);
        self.squares = self.squares.saturating_add(square);
    }

    /// Takes so many steps into account, with the greatest of their errors and the sum of their squares.
    #[inline]
    pub(super) fn steps(&mut self, steps: usize, greatest: u64, squares: u64) {
        (self.steps, self.greatest) = (self.steps + steps as u64, self.greatest.max(greatest));
        self.squares = self.squares.saturating_add(squares.into());
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
        let mut error = Self::default();
        let mut due = due.into_iter();
        let mut time: u64 = 0;
        for segment in &list.segments {
            match *segment {
                Segment::Dwell(dwell) => time = time.wrapping_add(dwell),
                Segment::Steps { count, mut interval, add, right } => {
                    for _ in 0..count {
                        time = time.wrapping_add(interval);
                        interval = interval.wrapping_add_signed(add);
                        let step = due.next().filter(|step| step.right == right)?;
                        error.step((time >> FRACTION_BITS).abs_diff(step.cycle));
                    }
                }
            }
        }
        due.next().is_none().then_some(error)
    }
}
