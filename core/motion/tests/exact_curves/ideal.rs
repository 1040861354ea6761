//! The ideal position of a motion, from the formulas of DESIGN B2, B4 and B6 in [`Fixed`] numbers, independently of the
//! planners.

use crate::fixed::{Fixed, PI, decimal, whole};
use std::cmp::Ordering;
use stepscope_motion::moves::{Interpolation, RampShape};

/// Compares the position at a time in s with that of step k; both from the move's start.
type Compare = Box<dyn Fn(u64, &Fixed) -> Ordering>;

pub(crate) struct Ideal {
    pub(crate) duration: Fixed,
    pub(crate) compare: Compare,
}

fn position(k: u64) -> Fixed {
    whole(2 * k as i64 - 1) / whole(2)
}

/// Half periods from one extreme to the other, A*(1 - cos(2*pi*t/T)).
pub(crate) fn sine(amplitude: i64, period_s: f64, periods: u32) -> Ideal {
    let (amplitude, period) = (amplitude.abs(), decimal(period_s));
    let half = period.clone() / whole(2);
    let travel = 2 * amplitude as u64;
    let duration = period.clone() * whole(periods.into());
    let compare = move |k: u64, t: &Fixed| {
        let since = t.clone() - half.clone() * whole(((k - 1) / travel) as i64);
        if !since.is_positive() {
            return Ordering::Less;
        }
        if (since.clone() - half.clone()).is_positive() {
            return Ordering::Greater;
        }
        let phase = whole(2) * PI.clone() * since / period.clone();
        let travelled = whole(amplitude) * (whole(1) - phase.cosine());
        travelled.order(&position((k - 1) % travel + 1))
    };
    Ideal { duration, compare: Box::new(compare) }
}

/// A move whose second half mirrors its first; `first` is the travel in the first half.
fn mirrored(steps: i64, duration: Fixed, first: impl Fn(Fixed) -> Fixed + 'static) -> Ideal {
    let (steps, own) = (whole(steps.abs()), duration.clone());
    let compare = move |k: u64, t: &Fixed| {
        let way = if !t.is_positive() {
            whole(0)
        } else if (own.clone() - t.clone() - t.clone()).is_positive() {
            first(t.clone())
        } else if (own.clone() - t.clone()).is_positive() {
            steps.clone() - first(own.clone() - t.clone())
        } else {
            steps.clone()
        };
        way.order(&position(k))
    };
    Ideal { duration, compare: Box::new(compare) }
}

pub(crate) fn cosine(steps: i64, duration_s: f64, ramp_s: f64) -> Ideal {
    let (duration, ramp) = (decimal(duration_s), decimal(ramp_s));
    let top = whole(steps.abs()) / (duration.clone() - ramp.clone());
    mirrored(steps, duration, move |t| {
        if (ramp.clone() - t.clone()).is_positive() {
            let sine = (PI.clone() * t.clone() / ramp.clone()).sine();
            top.clone() / whole(2) * (t - ramp.clone() / PI.clone() * sine)
        } else {
            top.clone() * (t - ramp.clone() / whole(2))
        }
    })
}

pub(crate) fn trapezoid(steps: i64, start: f64, top: f64, acceleration: f64) -> Ideal {
    let [n, v0, v1, a] = [whole(steps.abs()), decimal(start), decimal(top), decimal(acceleration)];
    // The tip of a triangle, v^2 = v0^2 + 2*a*s.
    let tip = (v0.clone() * v0.clone() + a.clone() * n.clone()).square_root();
    let peak = if tip < v1 { tip } else { v1 };
    let ramp = (peak.clone() - v0.clone()) / a.clone();
    let ramp_steps = (v0.clone() + peak.clone()) * ramp.clone() / whole(2);
    let duration = whole(2) * ramp.clone() + (n - whole(2) * ramp_steps.clone()) / peak.clone();
    mirrored(steps, duration, move |t| {
        if (ramp.clone() - t.clone()).is_positive() {
            (v0.clone() + a.clone() * t.clone() / whole(2)) * t
        } else {
            ramp_steps.clone() + peak.clone() * (t - ramp.clone())
        }
    })
}

/// Relative speed and travel of a shape, directly from its logarithms and exponentials.
pub(crate) fn shape(shape: RampShape, parameter: f64) -> impl Fn(Fixed) -> Fixed {
    let (one, parameter) = (whole(1), decimal(parameter));
    // Sigmoid: S(u) = 1/(1 + e^-u), whose integral is ln(1 + e^u), from -r to u = r*(2x - 1).
    let logistic = |u: Fixed| whole(1) / (whole(1) + (-u).exponential());
    let (low, high) = (logistic(-parameter.clone()), logistic(parameter.clone()));
    let integral = |u: Fixed| (whole(1) + u.exponential()).logarithm();
    move |x| match shape {
        RampShape::Sigmoid => {
            let r = parameter.clone();
            let u = r.clone() * (whole(2) * x.clone() - one.clone());
            let area = (integral(u) - integral(-r.clone())) / (whole(2) * r) - low.clone() * x;
            area / (high.clone() - low.clone())
        }
        RampShape::Bezier => {
            x.clone() * x.clone() * x.clone() - x.clone() * x.clone() * x.clone() * x / whole(2)
        }
        RampShape::Straight => x.clone() * x / whole(2),
        RampShape::Exponential => {
            let k = parameter.clone();
            let way = x.clone() - (one.clone() - (-(k.clone() * x)).exponential()) / k.clone();
            way / (one.clone() - (-k).exponential())
        }
    }
}

pub(crate) fn ramps(
    (steps, duration_s, ramp_s): (i64, f64, f64),
    way: impl Fn(Fixed) -> Fixed + 'static,
) -> Ideal {
    let (duration, ramp) = (decimal(duration_s), decimal(ramp_s));
    // The time that a ramp takes longer than its travel at top speed.
    let lost = ramp.clone() * (whole(1) - way(whole(1)));
    let top = whole(steps.abs()) / (duration.clone() - whole(2) * lost.clone());
    mirrored(steps, duration, move |t| {
        if (ramp.clone() - t.clone()).is_positive() {
            top.clone() * ramp.clone() * way(t / ramp.clone())
        } else {
            top.clone() * (t - lost.clone())
        }
    })
}

/// The seven phases, from the limits.
pub(crate) fn jerk_limited(steps: i64, speed: f64, acceleration: f64, jerk: f64) -> Ideal {
    let [n, v, a, j] = [whole(steps.abs()), decimal(speed), decimal(acceleration), decimal(jerk)];
    let least = |a: Fixed, b: Fixed| if b < a { b } else { a };
    // The duration of a jerk phase is the minimum that one of the limits allows.
    let by_speed = least(a / j.clone(), (v.clone() / j.clone()).square_root());
    let jerk_s = least(by_speed, (n.clone() / (whole(2) * j.clone())).cube_root());
    // The constant acceleration ends at the top speed, or at half of the distance.
    let acceleration = j.clone() * jerk_s.clone();
    let to_speed = v / acceleration.clone() - jerk_s.clone();
    let square = jerk_s.clone() * jerk_s.clone() + whole(4) * n.clone() / acceleration.clone();
    let to_way = (square.square_root() - whole(3) * jerk_s.clone()) / whole(2);
    let steady_s = least(to_speed, to_way);
    let steady_s = if steady_s.is_positive() { steady_s } else { whole(0) };
    let peak = acceleration.clone() * (jerk_s.clone() + steady_s.clone());
    let ramp_s = whole(2) * jerk_s.clone() + steady_s.clone();
    let ramp = peak.clone() * ramp_s.clone() / whole(2);
    let duration = whole(2) * ramp_s.clone() + (n - whole(2) * ramp.clone()) / peak.clone();
    mirrored(steps, duration, move |t| {
        let cubed = |x: Fixed| x.clone() * x.clone() * x;
        if t <= jerk_s {
            j.clone() * cubed(t) / whole(6)
        } else if t <= jerk_s.clone() + steady_s.clone() {
            let (x, t_j) = (t - jerk_s.clone(), jerk_s.clone());
            j.clone() * cubed(t_j.clone()) / whole(6)
                + acceleration.clone() * t_j / whole(2) * x.clone()
                + acceleration.clone() * x.clone() * x / whole(2)
        } else if t <= ramp_s {
            let left = ramp_s.clone() - t;
            ramp.clone() - (peak.clone() * left.clone() - j.clone() * cubed(left) / whole(6))
        } else {
            ramp.clone() + peak.clone() * (t - ramp_s.clone())
        }
    })
}

/// Straight or by Steffen's cubics in Hermite's form; only the first point may be at a half step.
pub(crate) fn points(points: &[(f64, f64)], interpolation: Interpolation) -> Ideal {
    let zero = whole(0);
    let at: Vec<(Fixed, Fixed)> = points
        .iter()
        .map(|&(t, y)| (decimal(t) - decimal(points[0].0), decimal(y) - decimal(points[0].1)))
        .collect();
    let length = |index: usize| at[index + 1].0.clone() - at[index].0.clone();
    let mean = |index: usize| (at[index + 1].1.clone() - at[index].1.clone()) / length(index);
    let slope = |index: usize| {
        if index == 0 || index + 1 == at.len() {
            return whole(0);
        }
        let (d0, d1, h0, h1) = (mean(index - 1), mean(index), length(index - 1), length(index));
        let parabola = (d0.clone() * h1.clone() + d1.clone() * h0.clone()) / (h0 + h1);
        let least = |a: Fixed, b: Fixed| if b < a { b } else { a };
        let max = |a: Fixed, b: Fixed| if b > a { b } else { a };
        let two = whole(2);
        match (d0.is_positive(), d1.is_positive()) {
            (true, true) => least(least(two.clone() * d0, two * d1), parabola),
            (false, false) => max(max(two.clone() * d0, two * d1), parabola),
            _ => whole(0),
        }
    };
    let (mut pieces, mut before) = (Vec::new(), 0);
    for index in 0..at.len() - 1 {
        let (own, mean) = (length(index), mean(index));
        let (m0, m1) = match interpolation {
            Interpolation::Straight => (mean.clone(), mean.clone()),
            Interpolation::Smooth => (slope(index), slope(index + 1)),
        };
        let (from, to) = (at[index].1.rounded(), at[index + 1].1.rounded());
        let (since_s, since) = at[index].clone();
        let right = to > from;
        let way = move |t: &Fixed| {
            let x = (t.clone() - since_s.clone()) / own.clone();
            if x < whole(0) || x > whole(1) {
                return None;
            }
            let rest = whole(1) - x.clone();
            let bent = mean.clone() * x.clone() * x.clone() * (whole(3) - whole(2) * x.clone())
                + m0.clone() * x.clone() * rest.clone() * rest.clone()
                - m1.clone() * x.clone() * x * rest;
            Some(since.clone() + own.clone() * bent)
        };
        let start = at[index].0.clone();
        pieces.push((before..before + from.abs_diff(to), from, right, start, way));
        before += from.abs_diff(to);
    }
    let duration = at[at.len() - 1].0.clone();
    let compare = move |k: u64, t: &Fixed| {
        let own = pieces.iter().find(|(steps, ..)| steps.contains(&(k - 1)));
        let (steps, from, right, start, way) = own.expect("a piece has the step");
        let past = whole(2 * (k - 1 - steps.start) as i64 + 1) / whole(2);
        let position = whole(*from) + if *right { past } else { zero.clone() - past };
        match way(t) {
            None if t < start => Ordering::Less,
            None => Ordering::Greater,
            Some(way) if *right => way.order(&position),
            Some(way) => position.order(&way),
        }
    };
    Ideal { duration, compare: Box::new(compare) }
}

/// Steps with the times of a table in s, of a move of `duration`.
pub(crate) fn of_times(times: Vec<Fixed>, duration: Fixed) -> Ideal {
    let compare = move |k: u64, t: &Fixed| t.order(&times[k as usize - 1]);
    Ideal { duration, compare: Box::new(compare) }
}

/// The rows of a staircase, up and down: number of steps and rate.
pub(crate) fn staircase(rows: &[(u64, u64)]) -> Ideal {
    let (mut start, mut before, mut after) = (whole(0), 0, Vec::new());
    for &(steps, rate) in rows {
        after.push((before, rate, start.clone()));
        start = start + whole(steps as i64) / whole(rate as i64);
        before += steps;
    }
    let compare = move |k: u64, t: &Fixed| {
        let (before, rate, start) =
            after.iter().rfind(|(before, ..)| *before < k).expect("a row has the step");
        t.order(&(start.clone() + whole((k - before) as i64) / whole(*rate as i64)))
    };
    Ideal { duration: start, compare: Box::new(compare) }
}

/// Steps in the middles of equal parts of each interval: from, to and count.
pub(crate) fn intervals(intervals: impl Iterator<Item = (Fixed, Fixed, u64)>, duration: Fixed) -> Ideal {
    let times = intervals.flat_map(|(from, to, count)| {
        let length = to - from.clone();
        let after = move |k: u64| length.clone() * whole(2 * k as i64 + 1) / whole(2 * count as i64);
        (0..count).map(move |k| from.clone() + after(k))
    });
    of_times(times.collect(), duration)
}
