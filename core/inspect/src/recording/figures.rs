//! Figures of a channel's steps without a plan.

use crate::motion::step_acceleration::{self, HALF};
use alloc::collections::VecDeque;
use serde::Serialize;
use stepscope_peripheral::trace::Step;

/// Rates are 1/interval from step to step; times are in s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StepFigures {
    pub steps: u64,
    pub right: u64,
    pub left: u64,
    pub turns: u64,
    pub position: i32,
    pub least_position: i32,
    pub greatest_position: i32,
    pub first_s: f64,
    pub last_s: f64,
    pub shortest_interval_s: Option<f64>,
    pub shortest_at_s: Option<f64>,
    pub longest_interval_s: Option<f64>,
    /// `None` where two steps share a cycle.
    #[serde(rename = "greatest_rate_steps_s")]
    pub max_rate_steps_s: Option<f64>,
    pub mean_rate_steps_s: Option<f64>,
    /// Magnitude in steps/s^2 (over eight steps); 0 where rounding to cycles explains it.
    pub greatest_acceleration_steps_s2: Option<f64>,
    /// Maximum relative change of the interval in one direction: 0.1 for a tenth.
    pub greatest_interval_change: Option<f64>,
}

impl StepFigures {
    /// Takes steps in cycles of `clock_hz` without storing them; `None` where there is none.
    pub fn of(steps: impl IntoIterator<Item = Step>, clock_hz: u32) -> Option<Self> {
        Self::of_rate(steps, f64::from(clock_hz))
    }

    /// As [`Self::of`], with steps in ticks of `hz`.
    pub fn of_rate(steps: impl IntoIterator<Item = Step>, hz: f64) -> Option<Self> {
        let mut steps = steps.into_iter();
        let first = steps.next()?;
        let seconds = |cycle: u64| cycle as f64 / hz;
        let mut found = Self { first_s: seconds(first.cycle), ..Self::default() };
        let (mut shortest, mut longest) = (None::<(u64, u64)>, None::<u64>);
        let mut acceleration =
            Acceleration { hz, steps: VecDeque::with_capacity(2 * HALF + 1), certain: None, any: None };
        let (mut last, mut direction, mut interval_before) = (first, 0, None::<u64>);
        for step in core::iter::once(first).chain(steps) {
            let now =
                if found.steps == 0 { step.position } else { step.position.wrapping_sub(last.position) };
            *(if now > 0 { &mut found.right } else { &mut found.left }) += 1;
            found.least_position = found.least_position.min(step.position);
            found.greatest_position = found.greatest_position.max(step.position);
            acceleration.take(step);
            if found.steps > 0 {
                let turned = now != direction;
                found.turns += u64::from(turned);
                let interval = step.cycle - last.cycle;
                if shortest.is_none_or(|(min, _)| interval < min) {
                    shortest = Some((interval, step.cycle));
                }
                longest = longest.max(Some(interval));
                if let Some(before) = interval_before.filter(|before| !turned && *before > 0) {
                    let change = interval.abs_diff(before) as f64 / before as f64;
                    found.greatest_interval_change = max_of(found.greatest_interval_change, change);
                }
                interval_before = if turned { None } else { Some(interval) };
            }
            found.steps += 1;
            (last, direction) = (step, now);
        }
        (found.position, found.last_s) = (last.position, seconds(last.cycle));
        found.shortest_interval_s = shortest.map(|(interval, _)| seconds(interval));
        found.shortest_at_s = shortest.map(|(_, at)| seconds(at));
        found.longest_interval_s = longest.map(seconds);
        found.max_rate_steps_s =
            shortest.filter(|(interval, _)| *interval > 0).map(|(interval, _)| hz / interval as f64);
        let span = last.cycle - first.cycle;
        found.mean_rate_steps_s = (span > 0).then(|| (found.steps - 1) as f64 / seconds(span));
        let spread = shortest.zip(longest).map_or(0, |((shortest, _), longest)| longest - shortest);
        found.greatest_acceleration_steps_s2 = acceleration.max(spread);
        Some(found)
    }
}

fn max_of(known: Option<f64>, value: f64) -> Option<f64> {
    Some(known.map_or(value, |known| libm::fmax(known, value)))
}

struct Acceleration {
    hz: f64,
    steps: VecDeque<Step>,
    /// The maximum that rounding does not explain.
    certain: Option<f64>,
    any: Option<f64>,
}

/// Cycles of rounding in a difference of two intervals: three times, each off by half a cycle.
const ROUNDING: u64 = 2;

impl Acceleration {
    fn take(&mut self, to: Step) {
        if self.steps.len() > 2 * HALF {
            self.steps.pop_front();
        }
        self.steps.push_back(to);
        let Some(found) = step_acceleration::of(self.steps.make_contiguous(), HALF, self.hz) else { return };
        let span = |from: usize| Some(self.steps.get(from + HALF)?.cycle - self.steps.get(from)?.cycle);
        let explained =
            span(0).zip(span(HALF)).is_some_and(|(first, second)| first.abs_diff(second) <= ROUNDING);
        let found = libm::fabs(found);
        self.certain = max_of(self.certain, if explained { 0.0 } else { found });
        self.any = max_of(self.any, found);
    }

    /// For intervals that differ by up to `spread` cycles: a slow change shows even if rounding explains each one.
    fn max(&self, spread: u64) -> Option<f64> {
        if self.certain == Some(0.0) && spread > ROUNDING { self.any } else { self.certain }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn an_even_ramp_has_its_acceleration_and_a_single_step_no_rate() {
        // t = sqrt(2*s/a) for 2000 steps/s^2.
        let steps: Vec<Step> = (1..400)
            .map(|k| Step { cycle: (libm::sqrt(f64::from(k) / 1000.0) * 16e6) as u64, position: k })
            .collect();
        let found = StepFigures::of(steps.iter().copied(), 16_000_000).expect("steps");
        let acceleration = found.greatest_acceleration_steps_s2.expect("enough steps");
        assert!((acceleration - 2000.0).abs() < 20.0, "{acceleration}");
        assert_eq!((found.position, found.turns, found.steps), (399, 0, 399));
        let one = StepFigures::of(steps.first().copied(), 16_000_000).expect("a step");
        assert_eq!((one.max_rate_steps_s, one.mean_rate_steps_s), (None, None));
        assert_eq!(StepFigures::of([], 1), None);
    }

    #[test]
    fn rounding_is_no_acceleration_and_a_slow_ramp_is_one() {
        // (start interval and its change per step in 1/65536 cycle, whether the steps accelerate)
        for (interval, change, accelerates) in
            [(100 << 16, 0, false), (6_558_720, 0, false), (160 << 16, 820, true)]
        {
            let mut at = 0_u64;
            let steps = (0..4000_u64).map(|k| {
                at += interval - change * k;
                Step { cycle: at >> 16, position: k as i32 + 1 }
            });
            let found = StepFigures::of(steps.collect::<Vec<_>>(), 16_000_000).expect("steps");
            let acceleration = found.greatest_acceleration_steps_s2.expect("enough steps");
            assert_eq!(acceleration > 0.0, accelerates, "{interval}: {acceleration}");
        }
    }

    #[test]
    fn figures_of_the_steps_of_a_run() {
        use crate::recording::figures::StepFigures;
        use stepscope_peripheral::trace::Step;

        // Four steps right at 100 steps/s, and one back.
        let steps =
            [(10, 1), (20, 2), (30, 3), (40, 4), (60, 3)].map(|(cycle, position)| Step { cycle, position });
        let figures = StepFigures::of(steps, 1000).expect("there are steps");
        assert_eq!((figures.right, figures.left, figures.turns, figures.position), (4, 1, 1, 3));
        assert_eq!(figures.max_rate_steps_s, Some(100.0));
    }
}
