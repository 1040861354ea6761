//! Position, speed and acceleration as minimum and maximum per pixel column, for the ideal motion and for the pulses.

use crate::motion::actual_motion::Pulses;
use alloc::{vec, vec::Vec};
use stepscope_motion::{AxisPlan, Breakpoints, Interval};
use stepscope_peripheral::trace::Step;

/// Up to this number, all intervals of a column are evaluated; of more, every 16th and the last.
const MAX_INTERVALS: usize = 256;
/// Up to this number, a line follows all intervals of a column; for more it connects minimum and maximum.
const MAX_FOLLOWED: usize = 32;
const POINTS: usize = 4;
/// Up to this number of steps per column, an outline is exact.
const MAX_OUTLINED: usize = 16;

/// Minimum and maximum per column; NaN where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    pub min: Vec<f64>,
    pub max: Vec<f64>,
}

impl Band {
    pub(crate) fn new(columns: usize) -> Self {
        Self { min: vec![f64::NAN; columns], max: vec![f64::NAN; columns] }
    }

    pub(crate) fn take(&mut self, column: usize, value: f64) {
        if let (Some(min), Some(max)) = (self.min.get_mut(column), self.max.get_mut(column)) {
            *min = libm::fmin(*min, value);
            *max = libm::fmax(*max, value);
        }
    }

    /// Adds the value 0 to the columns of a time without motion.
    pub(crate) fn add_standstill(&mut self, window: Window, from_s: f64, to_s: f64) {
        if to_s > from_s {
            window.columns(from_s, to_s).for_each(|column| self.take(column, 0.0));
        }
    }
}

/// A time window in s, divided into pixel columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    pub start_s: f64,
    pub end_s: f64,
    pub columns: usize,
}

impl Window {
    fn width_s(&self) -> f64 {
        (self.end_s - self.start_s) / self.columns as f64
    }

    pub fn center_s(&self, column: usize) -> f64 {
        self.start_s + (column as f64 + 0.5) * self.width_s()
    }

    /// The column of a time; negative before the window.
    pub(crate) fn column(&self, time_s: f64) -> i64 {
        libm::floor((time_s - self.start_s) / self.width_s()) as i64
    }

    pub(crate) fn edge_s(&self, column: usize) -> f64 {
        self.start_s + column as f64 * self.width_s()
    }

    /// The columns that overlap a time range. An empty range has one, unless it is outside of the window.
    pub(crate) fn columns(&self, from_s: f64, to_s: f64) -> core::ops::Range<usize> {
        let inside = |column: i64| column.clamp(0, self.columns as i64) as usize;
        let after = libm::ceil((to_s - self.start_s) / self.width_s()) as i64;
        inside(self.column(from_s))..inside(after.max(self.column(from_s).saturating_add(1)))
    }
}

/// The ideal motion, in steps, steps/s and steps/s^2.
#[derive(Clone, Debug, PartialEq)]
pub struct Ideal {
    pub position: Band,
    pub speed: Band,
    pub acceleration: Band,
}

/// The ideal motion of an axis that starts at `zero_s`. Curves are monotonic between breakpoints, so a column's
/// extremes are at its ends and at both sides of its breakpoints.
pub fn ideal(plan: &AxisPlan, zero_s: f64, window: Window) -> Ideal {
    let n = window.columns;
    let mut bands = Ideal { position: Band::new(n), speed: Band::new(n), acceleration: Band::new(n) };
    let breakpoints = Breakpoints::of(plan);
    let mut period = None;
    for column in 0..n {
        let (from, to) = (window.edge_s(column) - zero_s, window.edge_s(column + 1) - zero_s);
        let extremes = match breakpoints.period_within(from, to) {
            // If a column has several equal periods, one is evaluated.
            Some(bounds) => match period {
                Some((known, extremes)) if known == bounds => extremes,
                _ => {
                    let extremes = extremes(plan, &breakpoints, bounds.0, bounds.1);
                    period = Some((bounds, extremes));
                    extremes
                }
            },
            None => extremes(plan, &breakpoints, from, to),
        };
        let bands = [&mut bands.position, &mut bands.speed, &mut bands.acceleration];
        for (band, values) in bands.into_iter().zip(extremes) {
            values.into_iter().for_each(|value| band.take(column, value));
        }
    }
    bands
}

/// The ideal motion as points of lines, in steps, steps/s and steps/s^2.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IdealLine {
    /// Times in s; a breakpoint has two points.
    pub time_s: Vec<f64>,
    pub position: Vec<f64>,
    pub speed: Vec<f64>,
    pub acceleration: Vec<f64>,
}

impl IdealLine {
    fn push(&mut self, time_s: f64, [position, speed, acceleration]: [f64; 3]) {
        self.time_s.push(time_s);
        self.position.push(position);
        self.speed.push(speed);
        self.acceleration.push(acceleration);
    }
}

/// Smooth intervals have several points per column; a column with too many intervals has its minimum and maximum.
pub fn ideal_line(plan: &AxisPlan, zero_s: f64, window: Window) -> IdealLine {
    let breakpoints = Breakpoints::of(plan);
    let mut line = IdealLine::default();
    let mut few = Vec::with_capacity(MAX_FOLLOWED);
    for column in 0..window.columns {
        let (from, to) = (window.edge_s(column) - zero_s, window.edge_s(column + 1) - zero_s);
        let mut followed = breakpoints.period_within(from, to).is_none();
        few.clear();
        if followed {
            breakpoints.intervals(from, to, &mut |interval| {
                followed = followed && few.len() < MAX_FOLLOWED && interval.times == 1.0;
                if followed {
                    few.push(interval);
                }
            });
        }
        if followed {
            few.iter().for_each(|interval| follow(plan, zero_s, *interval, to - from, &mut line));
        } else {
            let (from, to) = breakpoints.period_within(from, to).unwrap_or((from, to));
            let [position, speed, acceleration] = extremes(plan, &breakpoints, from, to);
            for end in [0, 1] {
                line.push(window.center_s(column), [position[end], speed[end], acceleration[end]]);
            }
        }
    }
    line
}

fn follow(plan: &AxisPlan, zero_s: f64, interval: Interval, column_s: f64, line: &mut IdealLine) {
    let length_s = interval.to_s - interval.from_s;
    let parts = libm::fmax(1.0, libm::ceil(POINTS as f64 * length_s / column_s)) as usize;
    let inset = length_s * 1e-9;
    for part in 0..=parts {
        let t = interval.from_s + length_s * (part as f64 / parts as f64);
        let inside = libm::fmin(libm::fmax(t, interval.from_s + inset), interval.to_s - inset);
        line.push(t + zero_s, [plan.position(inside), plan.speed(inside), plan.acceleration(inside)]);
    }
}

fn extremes(plan: &AxisPlan, breakpoints: &Breakpoints, from_s: f64, to_s: f64) -> [[f64; 2]; 3] {
    let mut found = [[f64::NAN; 2]; 3];
    let mut follow = |interval: Interval| {
        // Just inside: at a breakpoint itself the value may be that of the other side.
        let inset = (interval.to_s - interval.from_s) * 1e-9;
        for t in [interval.from_s + inset, interval.to_s - inset] {
            let values = [plan.position(t), plan.speed(t), plan.acceleration(t)];
            for ([min, max], value) in found.iter_mut().zip(values) {
                *min = libm::fmin(*min, value);
                *max = libm::fmax(*max, value);
            }
        }
    };
    let (mut count, mut last) = (0, None);
    breakpoints.intervals(from_s, to_s, &mut |interval| {
        count += 1;
        last = Some(interval);
        if count <= MAX_INTERVALS || count % 16 == 0 {
            follow(interval);
        }
    });
    if let Some(last) = last {
        follow(last);
    }
    found
}

/// The motion of the pulses, in steps and steps/s.
#[derive(Clone, Debug, PartialEq)]
pub struct Actual {
    pub position: Band,
    pub speed: Band,
}

pub fn actual(pulses: &Pulses<'_>, window: Window) -> Actual {
    let mut bands = Actual { position: Band::new(window.columns), speed: Band::new(window.columns) };
    let hz = pulses.hz();
    let mut next = pulses.steps.partition_point(|step| (step.cycle as f64 / hz) < window.start_s);
    let before = next.checked_sub(1).and_then(|last| pulses.steps.get(last));
    let mut position = before.map_or(0, |step| step.position);
    for column in 0..window.columns {
        bands.position.take(column, f64::from(position));
        let comes = |step: &&Step| window.column(step.cycle as f64 / hz) <= column as i64;
        while let Some(step) = pulses.steps.get(next).filter(comes) {
            position = step.position;
            bands.position.take(column, f64::from(position));
            next += 1;
        }
    }
    let mut moved_to = window.start_s;
    pulses.rates(window.start_s, window.end_s, &mut |rate| {
        if rate.to_s <= window.start_s || rate.from_s >= window.end_s {
            return;
        }
        bands.speed.add_standstill(window, moved_to, rate.from_s);
        for column in window.columns(rate.from_s, rate.to_s) {
            bands.speed.take(column, rate.speed);
        }
        moved_to = rate.to_s;
    });
    bands.speed.add_standstill(window, moved_to, window.end_s);
    bands
}

/// The motion of many axes' pulses at once: exact for few steps per column, else from the positions at the edges of each
/// column, whose speed is the mean of the column.
pub fn outline(pulses: &Pulses<'_>, window: Window) -> Actual {
    let steps = pulses.steps_until(window.end_s) - pulses.steps_until(window.start_s);
    if steps <= MAX_OUTLINED * window.columns {
        return actual(pulses, window);
    }
    let mut bands = Actual { position: Band::new(window.columns), speed: Band::new(window.columns) };
    let mut position = f64::from(pulses.position_at(window.start_s));
    for column in 0..window.columns {
        let end = f64::from(pulses.position_at(window.edge_s(column + 1)));
        bands.position.take(column, position);
        bands.position.take(column, end);
        bands.speed.take(column, (end - position) / window.width_s());
        position = end;
    }
    bands
}

/// Whether a plan has an acceleration: not if its speed is constant or only jumps.
pub fn has_acceleration(plan: &AxisPlan) -> bool {
    plan.peaks().acceleration > 0.0
}

/// The acceleration of steps without a plan; NaN where it is unknown.
pub fn actual_acceleration(pulses: &Pulses<'_>, window: Window) -> Band {
    let mut band = Band::new(window.columns);
    pulses.accelerations(window.start_s, window.end_s, &mut |from_s, to_s, value| {
        window.columns(from_s, to_s).for_each(|column| band.take(column, value));
    });
    band
}

#[cfg(test)]
mod tests;
