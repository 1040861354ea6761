//! Ideal positions of a motion, from the design's formulas (DESIGN B2, B4, B6) in 32 digits, independent of the
//! planners' methods.

use super::wide::{PI, Wide};
use stepscope_core::motion::moves::{Interpolation, Point};

/// Travel of a move at a time in s from its start; to the right, and within the move.
pub(crate) type Way = Box<dyn Fn(Wide) -> Wide>;

/// A move in one direction.
pub(crate) struct Ideal {
    pub(crate) duration: Wide,
    pub(crate) way: Way,
}

fn wide(x: f64) -> Wide {
    Wide::from(x)
}

/// The first half as given, the second its mirror image.
fn mirrored(steps: Wide, duration: Wide, first: impl Fn(Wide) -> Wide + 'static) -> Ideal {
    let half = duration / wide(2.0);
    let way = move |t: Wide| if t <= half { first(t) } else { steps - first(duration - t) };
    Ideal { duration, way: Box::new(way) }
}

pub(crate) fn constant(steps: f64, speed: f64) -> Ideal {
    Ideal { duration: wide(steps) / wide(speed), way: Box::new(move |t| t * wide(speed)) }
}

pub(crate) fn trapezoid(steps: f64, start: f64, top: f64, acceleration: f64) -> Ideal {
    let [n, v0, v1, a] = [steps, start, top, acceleration].map(wide);
    let two = wide(2.0);
    let tip = (v0 * v0 + a * n).sqrt();
    let peak = v1.min(tip);
    let ramp_s = (peak - v0) / a;
    let ramp = (v0 + peak) * ramp_s / two;
    let duration = two * ramp_s + (n - two * ramp).max(wide(0.0)) / peak;
    mirrored(
        n,
        duration,
        move |t| {
            if t <= ramp_s { (v0 + a * t / two) * t } else { ramp + peak * (t - ramp_s) }
        },
    )
}

pub(crate) fn cosine(steps: f64, duration_s: f64, ramp_s: f64) -> Ideal {
    let [n, duration, ramp_s] = [steps, duration_s, ramp_s].map(wide);
    let (top, two) = (n / (duration - ramp_s), wide(2.0));
    mirrored(n, duration, move |t| {
        if t < ramp_s {
            let phase = PI * t / ramp_s;
            top / two * ramp_s / PI * (phase - phase.sin())
        } else {
            top * (t - ramp_s / two)
        }
    })
}

/// The seven phases, computed from the limits: times of the jerk and of the constant acceleration.
pub(crate) fn jerk_limited(steps: f64, speed: f64, acceleration: f64, jerk: f64) -> Ideal {
    let [n, v, a, j] = [steps, speed, acceleration, jerk].map(wide);
    let (zero, two, six) = (wide(0.0), wide(2.0), wide(6.0));
    // Duration of a jerk phase that each limit allows; the minimum applies.
    let jerk_s = (a / j).min((v / j).sqrt()).min((n / (two * j)).cbrt());
    // Duration of constant acceleration: up to the top speed, or until half of the distance is used.
    let to_speed = v / (j * jerk_s) - jerk_s;
    let acceleration = j * jerk_s;
    let root = (jerk_s * jerk_s + wide(4.0) * n / acceleration).sqrt();
    let to_way = (root - wide(3.0) * jerk_s) / two;
    let steady_s = to_speed.min(to_way).max(zero);
    let peak = acceleration * (jerk_s + steady_s);
    let ramp_s = two * jerk_s + steady_s;
    let ramp = peak * ramp_s / two;
    let duration = two * ramp_s + (n - two * ramp).max(zero) / peak;
    mirrored(n, duration, move |t| {
        if t <= jerk_s {
            j * t * t * t / six
        } else if t <= jerk_s + steady_s {
            let x = t - jerk_s;
            j * jerk_s * jerk_s * jerk_s / six + j * jerk_s * jerk_s / two * x + acceleration * x * x / two
        } else if t <= ramp_s {
            let left = ramp_s - t;
            ramp - (peak * left - j * left * left * left / six)
        } else {
            ramp + peak * (t - ramp_s)
        }
    })
}

/// Half a period from its extreme on.
pub(crate) fn half_sine(amplitude: f64, period_s: f64) -> Ideal {
    let (two, period) = (wide(2.0), wide(period_s));
    let way = move |t: Wide| {
        let sine = (PI * t / period).sin();
        two * wide(amplitude) * sine * sine
    };
    Ideal { duration: period / two, way: Box::new(way) }
}

/// The pieces between points, each with its start, direction and distance.
pub(crate) fn pieces(points: &[Point], interpolation: Interpolation) -> Vec<(Wide, bool, Ideal)> {
    let [two, three] = [2.0, 3.0].map(wide);
    let (zero_s, zero) = (wide(points[0].time_s), wide(points[0].position));
    let at: Vec<(Wide, Wide)> =
        points.iter().map(|point| (wide(point.time_s) - zero_s, wide(point.position) - zero)).collect();
    let mean: Vec<Wide> =
        at.windows(2).map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)).collect();
    let absolute = |x: Wide| x.max(-x);
    // Steffen's slope at the middle one of three points.
    let slope = |index: usize| {
        let zero = wide(0.0);
        if index == 0 || index == mean.len() {
            return zero;
        }
        let (before, after) = (mean[index - 1], mean[index]);
        let (h0, h1) = (at[index].0 - at[index - 1].0, at[index + 1].0 - at[index].0);
        let parabola = (before * h1 + after * h0) / (h0 + h1);
        let most = (two * absolute(before).min(absolute(after))).min(absolute(parabola));
        match (before > zero, after > zero) {
            (true, true) => most,
            (false, false) if before < zero && after < zero => -most,
            _ => zero,
        }
    };
    mean.iter()
        .enumerate()
        .map(|(index, &mean)| {
            let ((from_s, _), (to_s, _)) = (at[index], at[index + 1]);
            let (length, right) = (to_s - from_s, mean > wide(0.0));
            let (m0, m1) = match interpolation {
                Interpolation::Straight => (mean, mean),
                Interpolation::Smooth => (slope(index), slope(index + 1)),
            };
            // Hermite's form.
            let way = move |t: Wide| {
                let x = t / length;
                let one = wide(1.0);
                let way = length
                    * (mean * x * x * (three - two * x) + m0 * x * (one - x) * (one - x)
                        - m1 * x * x * (one - x));
                if right { way } else { -way }
            };
            (from_s, right, Ideal { duration: length, way: Box::new(way) })
        })
        .collect()
}
