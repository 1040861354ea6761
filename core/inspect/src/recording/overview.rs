//! Minimum and maximum of position and speed per pixel column, in one pass that stores no steps.

use crate::motion::curves::{Actual, Band, Window};
use stepscope_peripheral::trace::Step;

/// Position and speed of a whole recording in columns, computed in one pass.
#[derive(Clone, Debug)]
pub struct Overview {
    window: Window,
    hz: f64,
    position: Band,
    speed: Band,
    next: usize,
    position_steps: i32,
    last: Option<u64>,
    moved_to_s: f64,
}

impl Overview {
    /// The columns of a window of steps in cycles of `hz`.
    pub fn of(steps: impl IntoIterator<Item = Step>, hz: f64, window: Window) -> Actual {
        let mut overview = Self {
            window,
            hz,
            position: Band::new(window.columns),
            speed: Band::new(window.columns),
            next: 0,
            position_steps: 0,
            last: None,
            moved_to_s: window.start_s,
        };
        for step in steps {
            overview.take(step);
            // The first step after the end gives the speed up to the end.
            if step.cycle as f64 / hz > window.end_s {
                break;
            }
        }
        overview.fill_until(window.columns);
        overview.speed.add_standstill(window, overview.moved_to_s, window.end_s);
        Actual { position: overview.position, speed: overview.speed }
    }

    fn take(&mut self, step: Step) {
        let step_s = step.cycle as f64 / self.hz;
        if let Some(last) = self.last.replace(step.cycle).filter(|_| step_s > self.window.start_s) {
            let travel = f64::from(step.position.wrapping_sub(self.position_steps));
            self.add_speed(last as f64 / self.hz, step_s, self.hz / (step.cycle - last) as f64 * travel);
        }
        if step_s >= self.window.start_s {
            let column = self.window.column(step_s).max(0) as usize;
            self.fill_until(column.saturating_add(1).min(self.window.columns));
            self.position.take(column, f64::from(step.position));
        }
        self.position_steps = step.position;
    }

    /// Fills the columns before `column` with the current position.
    fn fill_until(&mut self, column: usize) {
        for column in self.next..column {
            self.position.take(column, f64::from(self.position_steps));
        }
        self.next = self.next.max(column);
    }

    fn add_speed(&mut self, from_s: f64, to_s: f64, speed: f64) {
        if from_s >= self.window.end_s {
            return;
        }
        self.speed.add_standstill(self.window, self.moved_to_s, from_s);
        for column in self.window.columns(from_s, to_s) {
            self.speed.take(column, speed);
        }
        self.moved_to_s = to_s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::{actual_motion::Pulses, curves::actual};
    use alloc::vec::Vec;

    /// Steps there and back with a dwell, in cycles of 1 us.
    fn steps() -> Vec<Step> {
        let (mut cycle, mut position) = (20_000, 0);
        let there = (0..300_u64).map(|k| (1, 2000 - 6 * k));
        let back = (0..250_u64).map(|k| (-1, if k == 0 { 90_000 } else { 400 + 3 * k }));
        let step = |(travel, interval)| {
            cycle += interval;
            position += travel;
            Step { cycle, position }
        };
        there.chain(back).map(step).collect()
    }

    #[test]
    fn one_pass_gives_the_columns_of_stored_steps() {
        let steps = steps();
        let pulses = Pulses::recorded(0, &steps, 1_000_000);
        let end_s = steps.last().expect("steps").cycle as f64 / 1e6;
        for (start_s, end_s, columns) in [
            (0.0, end_s, 100),
            (0.0, end_s * 1.3, 37),
            (0.1, 0.3, 7),
            (0.02, 0.023, 50),
            (0.4, 0.45, 1),
            (2.0 * end_s, 3.0 * end_s, 4),
        ] {
            let window = Window { start_s, end_s, columns };
            let (found, expected) =
                (Overview::of(steps.iter().copied(), 1e6, window), actual(&pulses, window));
            let close = |found: &[f64], expected: &[f64], what: &str| {
                assert_eq!(found.len(), expected.len());
                for (column, (found, expected)) in found.iter().zip(expected).enumerate() {
                    assert!(
                        (found - expected).abs() <= 1e-9 * expected.abs()
                            || found.is_nan() && expected.is_nan(),
                        "{what} of column {column} of {window:?}: {found} {expected}"
                    );
                }
            };
            close(&found.position.min, &expected.position.min, "min position");
            close(&found.position.max, &expected.position.max, "max position");
            close(&found.speed.min, &expected.speed.min, "min speed");
            close(&found.speed.max, &expected.speed.max, "max speed");
        }
    }

    #[test]
    fn without_steps_nothing_moves() {
        let window = Window { start_s: 0.0, end_s: 1.0, columns: 3 };
        let none = Overview::of([], 1e6, window);
        assert_eq!((none.position.max, none.speed.min), (Vec::from([0.0; 3]), Vec::from([0.0; 3])));
    }

    #[test]
    fn an_overview_has_the_maximum_of_each_column() {
        use crate::{motion::curves::Window, recording::overview::Overview};
        use stepscope_peripheral::trace::Step;

        // A step every 10 ms in the second of two halves.
        let steps = (1..=10).map(|k| Step { cycle: 100 + 10 * k, position: k as i32 });
        let found = Overview::of(steps, 1000.0, Window { start_s: 0.0, end_s: 0.21, columns: 2 });
        assert_eq!((found.position.max, found.speed.max), (vec![0.0, 10.0], vec![0.0, 100.0]));
    }
}
