//! Position, speed and acceleration over a stretch of time, as the least and greatest value in
//! each pixel column: of the ideal motion, and of the one that the simulated pulses make.
//!
//! ```
//! use stepscope_inspect::motion::curves::{Window, ideal};
//! use stepscope_motion::{moves::Axis, plan_axis};
//!
//! let plan = plan_axis(&Axis::default(), "x").expect("it can be planned");
//! let curves = ideal(&plan, 0.0, Window { start_s: 0.0, end_s: 0.4, columns: 4 });
//! let top = curves.speed.max.iter().fold(0.0, |top: f64, speed| top.max(*speed));
//! assert_eq!(top, 16_000.0); // no column leaves a peak out
//! ```

use crate::motion::actual_motion::Pulses;
use alloc::{vec, vec::Vec};
use stepscope_motion::{AxisPlan, Breakpoints, Interval};
use stepscope_peripheral::trace::Step;

/// Smooth intervals of a column that are all looked at; of more, every 16th and the last. Only a table
/// of some hundred thousand rows has as many, and its speed rises from row to row.
const MAX_INTERVALS: usize = 256;
/// Smooth intervals of a column that a line follows one by one; of more it goes from the least to the greatest value.
const MAX_FOLLOWED: usize = 32;
/// Points of a line in a column without breakpoints.
const POINTS: usize = 4;

/// The least and greatest value in each column; NaN where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Least values.
    pub min: Vec<f64>,
    /// Greatest values.
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
}

impl Band {
    /// Nothing moves from one time to another.
    pub(crate) fn still(&mut self, window: Window, from_s: f64, to_s: f64) {
        if to_s > from_s {
            window.columns(from_s, to_s).for_each(|column| self.take(column, 0.0));
        }
    }
}

/// A stretch of time in columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Its start in s.
    pub start_s: f64,
    /// Its end in s.
    pub end_s: f64,
    /// Columns.
    pub columns: usize,
}

impl Window {
    fn width_s(&self) -> f64 {
        (self.end_s - self.start_s) / self.columns as f64
    }

    /// The middle of a column in s.
    #[must_use]
    pub fn centre_s(&self, column: usize) -> f64 {
        self.start_s + (column as f64 + 0.5) * self.width_s()
    }

    /// The column of a time, which may lie outside.
    pub(crate) fn column(&self, time_s: f64) -> i64 {
        libm::floor((time_s - self.start_s) / self.width_s()) as i64
    }

    /// The start of a column in s; the end of the one before.
    pub(crate) fn edge_s(&self, column: usize) -> f64 {
        self.start_s + column as f64 * self.width_s()
    }

    /// The columns that a stretch of time has a part in. One of no length has one, unless it lies
    /// outside.
    pub(crate) fn columns(&self, from_s: f64, to_s: f64) -> core::ops::Range<usize> {
        let inside = |column: i64| column.clamp(0, self.columns as i64) as usize;
        let after = libm::ceil((to_s - self.start_s) / self.width_s()) as i64;
        inside(self.column(from_s))..inside(after.max(self.column(from_s).saturating_add(1)))
    }
}

/// Position in steps, speed in steps/s, acceleration in steps/s^2 of the ideal motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Ideal {
    /// Position in steps from the start.
    pub position: Band,
    /// Speed in steps/s.
    pub speed: Band,
    /// Acceleration in steps/s^2.
    pub acceleration: Band,
}

/// The ideal motion of an axis whose time 0 is at `zero_s`.
///
/// Between two breakpoints every curve rises, falls or stays, so a column's extremes are at its own ends
/// and at either side of the breakpoints in it.
#[must_use]
pub fn ideal(plan: &AxisPlan, zero_s: f64, window: Window) -> Ideal {
    let n = window.columns;
    let mut bands = Ideal { position: Band::new(n), speed: Band::new(n), acceleration: Band::new(n) };
    let breakpoints = Breakpoints::of(plan);
    let mut period = None;
    for column in 0..n {
        let (from, to) = (window.edge_s(column) - zero_s, window.edge_s(column + 1) - zero_s);
        let extremes = match breakpoints.period_within(from, to) {
            // Thousands of periods over a few columns are one period's work.
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

/// Points on the ideal motion, to be joined by straight lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IdealLine {
    /// Times in s, of the window; at a breakpoint two points stand at one time.
    pub time_s: Vec<f64>,
    /// Position in steps from the start.
    pub position: Vec<f64>,
    /// Speed in steps/s.
    pub speed: Vec<f64>,
    /// Acceleration in steps/s^2.
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

/// The ideal motion of an axis whose time 0 is at `zero_s`, as the lines that a chart of so many columns draws: each
/// smooth interval is followed from end to end, several points to a column, so that on a chart a hundred columns high
/// no corner can be seen. Where a column holds more intervals than that shows, the line visits its least and its
/// greatest values.
#[must_use]
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
                line.push(window.centre_s(column), [position[end], speed[end], acceleration[end]]);
            }
        }
    }
    line
}

/// Points on an interval, from just inside its start to just inside its end.
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

/// Least and greatest position, speed and acceleration of a stretch.
fn extremes(plan: &AxisPlan, breakpoints: &Breakpoints, from_s: f64, to_s: f64) -> [[f64; 2]; 3] {
    let mut found = [[f64::NAN; 2]; 3];
    let mut look = |interval: Interval| {
        // Just inside: at a joint itself the value may be that of the other side.
        let inset = (interval.to_s - interval.from_s) * 1e-9;
        for t in [interval.from_s + inset, interval.to_s - inset] {
            let values = [plan.position(t), plan.speed(t), plan.acceleration(t)];
            for ([least, greatest], value) in found.iter_mut().zip(values) {
                *least = libm::fmin(*least, value);
                *greatest = libm::fmax(*greatest, value);
            }
        }
    };
    let (mut count, mut last) = (0, None);
    breakpoints.intervals(from_s, to_s, &mut |interval| {
        count += 1;
        last = Some(interval);
        if count <= MAX_INTERVALS || count % 16 == 0 {
            look(interval);
        }
    });
    if let Some(last) = last {
        look(last);
    }
    found
}

/// What the pulses really do.
#[derive(Clone, Debug, PartialEq)]
pub struct Actual {
    /// Position in steps from the start.
    pub position: Band,
    /// Speed in steps/s: of a tick its steps by its length, of a segment's step 1 by its interval,
    /// and 0 where neither is.
    pub speed: Band,
}

/// The motion that the pulses of a channel make.
#[must_use]
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
        bands.speed.still(window, moved_to, rate.from_s);
        for column in window.columns(rate.from_s, rate.to_s) {
            bands.speed.take(column, rate.speed);
        }
        moved_to = rate.to_s;
    });
    bands.speed.still(window, moved_to, window.end_s);
    bands
}

/// The acceleration of steps that no plan is known of ([`Pulses::accelerations`]); nothing where it is not known.
#[must_use]
pub fn actual_acceleration(pulses: &Pulses<'_>, window: Window) -> Band {
    let mut band = Band::new(window.columns);
    pulses.accelerations(window.start_s, window.end_s, &mut |from_s, to_s, value| {
        window.columns(from_s, to_s).for_each(|column| band.take(column, value));
    });
    band
}

#[cfg(test)]
mod tests;
