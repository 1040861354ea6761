//! Position, speed and acceleration over a stretch of time, as the least and greatest value in
//! each pixel column: of the ideal motion, and of the one that the simulated pulses make.

use crate::{
    motion::AxisPlan,
    scenario::Config,
    trace::{Recording, Step},
    wire::packet::Order,
};
use alloc::{vec, vec::Vec};

/// Looks at the ideal curve in each column; its moves' ends are looked at besides.
const LOOKS: usize = 8;

/// The least and greatest value in each column; NaN where there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Least values.
    pub min: Vec<f64>,
    /// Greatest values.
    pub max: Vec<f64>,
}

impl Band {
    fn new(columns: usize) -> Self {
        Self { min: vec![f64::NAN; columns], max: vec![f64::NAN; columns] }
    }

    fn take(&mut self, column: usize, value: f64) {
        if let (Some(min), Some(max)) = (self.min.get_mut(column), self.max.get_mut(column)) {
            *min = libm::fmin(*min, value);
            *max = libm::fmax(*max, value);
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
    fn column(&self, time_s: f64) -> i64 {
        libm::floor((time_s - self.start_s) / self.width_s()) as i64
    }

    /// The columns from one time to another that lie inside.
    fn columns(&self, from_s: f64, to_s: f64) -> core::ops::Range<usize> {
        let inside = |column: i64| column.clamp(0, self.columns as i64) as usize;
        inside(self.column(from_s))..inside(self.column(to_s).saturating_add(1))
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
#[must_use]
pub fn ideal(plan: &AxisPlan, zero_s: f64, window: Window) -> Ideal {
    let n = window.columns;
    let mut bands = Ideal { position: Band::new(n), speed: Band::new(n), acceleration: Band::new(n) };
    let mut look = |column: usize, time_s: f64| {
        let t = time_s - zero_s;
        bands.position.take(column, plan.position(t));
        bands.speed.take(column, plan.speed(t));
        bands.acceleration.take(column, plan.acceleration(t));
    };
    for column in 0..n {
        let from = window.start_s + column as f64 * window.width_s();
        for k in 0..=LOOKS {
            look(column, from + window.width_s() * k as f64 / LOOKS as f64);
        }
    }
    bands
}

/// What the pulses really do.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// Position in steps from the start.
    pub position: Band,
    /// Steps of a tick by its length, in steps/s; without ticks one step by the time since the one before.
    pub speed: Band,
}

/// The motion that the pulses of a channel make.
#[must_use]
pub fn made(recording: &Recording, steps: &[Step], channel: u8, config: &Config, window: Window) -> Made {
    let (clock_hz, hz) = (config.clock_hz(), f64::from(config.clock_hz()));
    let mut bands = Made { position: Band::new(window.columns), speed: Band::new(window.columns) };
    let mut next = steps.partition_point(|step| step.cycle as f64 / hz < window.start_s);
    let mut position = next.checked_sub(1).and_then(|i| steps.get(i)).map_or(0, |step| step.position);
    for column in 0..window.columns {
        bands.position.take(column, f64::from(position));
        while let Some(step) = steps.get(next).filter(|s| window.column(s.cycle as f64 / hz) <= column as i64)
        {
            position = step.position;
            bands.position.take(column, f64::from(position));
            next += 1;
        }
    }
    let log = &recording.packets;
    let tick_s = config.tick().0 as f64 / hz;
    let first = log.ticks().partition_point(|tick| tick.start.seconds(clock_hz) + tick_s < window.start_s);
    for tick in log.ticks().iter().skip(first) {
        let from_s = tick.start.seconds(clock_hz);
        if from_s > window.end_s {
            break;
        }
        let order = Order::parse(tick.orders.get(usize::from(channel)).copied().unwrap_or(0));
        let rate = f64::from(order.steps) / tick_s;
        for column in window.columns(from_s, from_s + tick_s) {
            bands.speed.take(column, if order.right { rate } else { -rate });
        }
    }
    if log.ticks().is_empty() {
        intervals(steps, hz, window, &mut bands.speed);
    }
    // Where no tick runs, nothing moves.
    for column in 0..window.columns {
        if bands.speed.min.get(column).is_some_and(|speed| speed.is_nan()) {
            bands.speed.take(column, 0.0);
        }
    }
    bands
}

/// The rate from each step to the next, as the later one's direction has it.
fn intervals(steps: &[Step], hz: f64, window: Window, speed: &mut Band) {
    let seconds = |step: &Step| step.cycle as f64 / hz;
    let first = steps.partition_point(|step| seconds(step) < window.start_s).max(1);
    for index in first..steps.len() {
        let (Some(before), Some(step)) = (steps.get(index - 1), steps.get(index)) else { break };
        let (from_s, to_s) = (seconds(before), seconds(step));
        if from_s > window.end_s {
            break;
        }
        let rate = f64::from(Step::direction(steps, index)) / (to_s - from_s);
        for column in window.columns(from_s, to_s) {
            speed.take(column, rate);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{run::Experiment, trace::steps};

    #[test]
    fn without_ticks_the_speed_is_that_of_the_intervals() {
        // 10 steps right, 1 ms apart, a pause of 5 ms, and 10 back, 0.5 ms apart.
        let json = r#"{"source":{"segments":{"channels":[{"segments":[
            {"steps":{"count":10}},{"dwell":{"length_q16":5242880000}},
            {"steps":{"count":10,"interval_q16":524288000,"dir":0}}]}]}}}"#;
        let experiment = Experiment::from_json(json).expect("no problems");
        let mut recording = Recording::default();
        experiment.run(&mut recording);
        let window = Window { start_s: 0.0, end_s: 0.022, columns: 22 };
        let steps = steps(&recording.trace, 0);
        let Made { speed, .. } = made(&recording, &steps, 0, experiment.config(), window);
        let rows = [(0, 0.0), (5, 1000.0), (12, -1.0 / 0.0055), (17, -2000.0), (21, 0.0)];
        for (column, expected) in rows {
            assert!((speed.min[column] - expected).abs() < 0.01, "{column}: {speed:?}");
            assert!((speed.max[column] - expected).abs() < 0.01, "{column}: {speed:?}");
        }
    }
}
