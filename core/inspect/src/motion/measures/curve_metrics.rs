//! Compares two position curves: distance, correlation, deviation, area.
//!
//! Integrals go from breakpoint to breakpoint and from step to step, split where the deviation changes sign, by
//! three-point Gauss-Legendre.

use crate::motion::{
    cursor_stats::POINTS as GAUSS,
    position_error::{Difference, Scaled},
};
use serde::Serialize;
use stepscope_motion::{AxisPlan, Breakpoints, Interval};
use stepscope_peripheral::trace::Step;

/// Samples of [`CurveMetrics::sum_of_squares_steps2`].
pub const POINTS: u32 = 2048;

/// Deviation of the second curve from the first, in steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CurveMetrics {
    pub largest_steps: f64,
    pub largest_at_s: f64,
    pub rms_steps: f64,
    /// Integral of |second - first|, in steps times s.
    pub area_steps_s: f64,
    /// Integral of second - first, in steps times s; 0 where only rounding is left.
    pub area_difference_steps_s: f64,
    pub points: u32,
    pub sum_of_squares_steps2: f64,
    pub euclidean_steps: f64,
    /// -1 to 1; `None` if a curve is constant.
    pub correlation: Option<f64>,
    /// 1 less the correlation, which keeps its digits near 1.
    pub uncorrelated: Option<f64>,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    seconds: f64,
    first: f64,
    first_square: f64,
    product: f64,
    off: f64,
    off_square: f64,
    area: f64,
    largest: f64,
    largest_at_s: f64,
    points: u32,
    sampled_square: f64,
}

impl Sums {
    pub(super) fn interval(&mut self, samples: &[(f64, f64, f64)]) {
        let mut off_sum = 0.0;
        for &(first, off, seconds) in samples {
            self.seconds += seconds;
            self.first += first * seconds;
            self.first_square += first * first * seconds;
            self.product += first * off * seconds;
            self.off_square += off * off * seconds;
            off_sum += off * seconds;
        }
        self.off += off_sum;
        self.area += libm::fabs(off_sum);
    }

    pub(super) fn extreme(&mut self, at_s: f64, off: f64) {
        if libm::fabs(off) > libm::fabs(self.largest) {
            (self.largest, self.largest_at_s) = (off, at_s);
        }
    }

    pub(super) fn sample(&mut self, off: f64) {
        self.points += 1;
        self.sampled_square += off * off;
    }

    pub(super) fn ended(self) -> CurveMetrics {
        let mean = |sum: f64| if self.seconds > 0.0 { sum / self.seconds } else { 0.0 };
        let (first, off) = (mean(self.first), mean(self.off));
        let of_first = mean(self.first_square) - first * first;
        let of_off = mean(self.off_square) - off * off;
        let of_both = mean(self.product) - first * off;
        let of_second = of_first + 2.0 * of_both + of_off;
        // A constant curve leaves only rounding.
        let rounding = 1e-12 * mean(self.first_square);
        let correlation = (of_first > rounding && of_second > rounding)
            .then(|| (of_first + of_both) / libm::sqrt(of_first * of_second));
        let uncorrelated = correlation.map(|correlation| {
            // 1 - r^2 = (1 - r)*(1 + r), without the cancellation in 1 - r.
            let square = (of_first * of_off - of_both * of_both) / (of_first * of_second);
            if correlation > 0.0 { libm::fmax(0.0, square / (1.0 + correlation)) } else { 1.0 - correlation }
        });
        CurveMetrics {
            largest_steps: self.largest,
            largest_at_s: self.largest_at_s,
            rms_steps: libm::sqrt(mean(self.off_square)),
            area_steps_s: self.area,
            area_difference_steps_s: if libm::fabs(self.off) > 1e-12 * self.area { self.off } else { 0.0 },
            points: self.points,
            sum_of_squares_steps2: self.sampled_square,
            euclidean_steps: libm::sqrt(self.sampled_square),
            correlation: correlation.map(|correlation| correlation.clamp(-1.0, 1.0)),
            uncorrelated,
        }
    }
}

pub(super) fn curve_and_steps(
    plan: &AxisPlan,
    breakpoints: &Breakpoints,
    steps: &[Step],
    hz: f64,
    length_s: f64,
) -> CurveMetrics {
    let mut sums = Sums::default();
    let (mut since_s, mut held) = (0.0, 0.0);
    let mut add_interval = |since_s: f64, to_s: f64, held: f64| {
        breakpoints
            .intervals(since_s, to_s, &mut |interval| curve_and_held(plan, interval, held, hz, &mut sums));
    };
    for step in steps {
        let at_s = step.cycle as f64 / hz;
        add_interval(since_s, at_s, held);
        (since_s, held) = (at_s, f64::from(step.position));
    }
    add_interval(since_s, length_s, held);
    sample(&mut sums, length_s, |t| position_at(steps, hz, t) - plan.position(t));
    sums.ended()
}

fn curve_and_held(plan: &AxisPlan, interval: Interval, held: f64, hz: f64, sums: &mut Sums) {
    let off = |t: f64| held - plan.position(t);
    // Just inside: a table's curve ends with a jump of half a step.
    let inset = (interval.to_s - interval.from_s) * 1e-9;
    let ends = [interval.from_s + inset, interval.to_s - inset].map(|t| (t, off(t)));
    // A shorter interval than a cycle is rounding of the step's time.
    if (interval.to_s - interval.from_s) * hz > 0.75 {
        ends.into_iter().for_each(|(t, off)| sums.extreme(t, off));
    }
    let middle_s = if ends[0].1 * ends[1].1 < 0.0 { crossing(ends, off) } else { interval.to_s };
    for (from_s, to_s) in [(interval.from_s, middle_s), (middle_s, interval.to_s)] {
        let (middle, half) = ((from_s + to_s) / 2.0, (to_s - from_s) / 2.0);
        if half > 0.0 {
            sums.interval(&GAUSS.map(|(point, weight)| {
                let position = plan.position(middle + half * point);
                (position, held - position, 2.0 * half * weight * interval.times)
            }));
        }
    }
}

/// The zero of a monotonic deviation, by false position (Illinois).
fn crossing([mut low, mut high]: [(f64, f64); 2], off: impl Fn(f64) -> f64) -> f64 {
    let mut low_side = None;
    for _ in 0..50 {
        let t = low.0 + (high.0 - low.0) * low.1 / (low.1 - high.1);
        let value = off(t);
        // The error in area is of second order.
        if libm::fabs(value) < 1e-9 {
            return t;
        }
        if (value < 0.0) == (low.1 < 0.0) {
            low = (t, value);
            if low_side == Some(false) {
                high.1 /= 2.0;
            }
            low_side = Some(false);
        } else {
            high = (t, value);
            if low_side == Some(true) {
                low.1 /= 2.0;
            }
            low_side = Some(true);
        }
    }
    (low.0 + high.0) / 2.0
}

pub(super) fn steps_and_steps(first: &[Step], second: &[Step], hz: f64, length_s: f64) -> CurveMetrics {
    let mut sums = Sums::default();
    // From before the start, so that a step in cycle 0 is a change.
    let mut positions = Difference::from([first, second].map(|steps| Scaled { steps, hz, unit: 1.0 }), -1.0);
    let (mut since_s, mut held) = (0.0, [0.0; 2]);
    let mut add_interval = |since_s: f64, to_s: f64, [first, second]: [f64; 2]| {
        if to_s > since_s {
            sums.extreme(since_s, second - first);
            sums.interval(&[(first, second - first, to_s - since_s)]);
        }
    };
    positions.changes(length_s, &mut |time_s, now| {
        add_interval(since_s, time_s, held);
        (since_s, held) = (time_s, now);
    });
    add_interval(since_s, length_s, held);
    sample(&mut sums, length_s, |t| position_at(second, hz, t) - position_at(first, hz, t));
    sums.ended()
}

fn sample(sums: &mut Sums, length_s: f64, off: impl Fn(f64) -> f64) {
    (0..POINTS).for_each(|point| sums.sample(off(length_s * (f64::from(point) / f64::from(POINTS)))));
}

fn position_at(steps: &[Step], hz: f64, time_s: f64) -> f64 {
    let after = steps.partition_point(|step| step.cycle as f64 / hz <= time_s);
    after.checked_sub(1).and_then(|last| steps.get(last)).map_or(0.0, |step| f64::from(step.position))
}
