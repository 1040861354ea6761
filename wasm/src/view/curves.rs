//! Data of the motion view: curves in columns, readings between cursors, and comparison with another run.

use crate::convert::{field, numbers, object};
use crate::{scenario::config, view::simulation::Simulation};
use js_sys::{Array, Object};
use serde::Serialize;
use stepscope_core::inspect::motion::actual_motion::Pulses;
use stepscope_core::inspect::motion::cursor_stats::{self, CursorStats};
use stepscope_core::inspect::motion::curves::{self, Window};
use stepscope_core::inspect::motion::position_error::{self, Scaled};
use stepscope_core::inspect::motion::run_figures::{self, AxisRun, ComparedFigure};
use stepscope_core::{motion::AxisPlan, peripheral::signal::Levels};
use wasm_bindgen::prelude::*;

/// Position, speed and acceleration (if any) at two cursors and between them.
#[derive(Serialize)]
struct Readings {
    at_a: Vec<f64>,
    at_b: Vec<f64>,
    mean: Vec<f64>,
    rms: Vec<f64>,
}

#[derive(Serialize)]
struct BothReadings {
    ideal: Option<Readings>,
    actual: Readings,
}

#[derive(Serialize)]
struct Deviation {
    common_s: f64,
    largest: f64,
    at_s: f64,
    rms: f64,
}

impl Readings {
    fn new(mut at: [Vec<f64>; 2], CursorStats { position, speed, acceleration }: CursorStats) -> Self {
        let moments = [Some(position), Some(speed), acceleration];
        at.iter_mut().for_each(|at| at.truncate(moments.iter().flatten().count()));
        let [at_a, at_b] = at;
        Self {
            at_a,
            at_b,
            mean: moments.iter().flatten().map(|moments| moments.mean).collect(),
            rms: moments.iter().flatten().map(|moments| moments.rms).collect(),
        }
    }
}

#[derive(Serialize)]
struct Comparison {
    figures: Vec<ComparedFigure>,
    deviation: Deviation,
}

/// Points of an ideal line in each column.
const POINTS_PER_COLUMN: u32 = 4;

#[wasm_bindgen]
impl Simulation {
    /// Position, speed and acceleration of an axis: minimum and maximum of each column, and points of the ideal curve. The
    /// pulses have an acceleration only without a plan.
    pub fn motion(&mut self, axis: u8, t0_s: f64, t1_s: f64, columns: u32) -> Object {
        let window = window(t0_s, t1_s, columns);
        let result = Object::new();
        let centers: Vec<f64> = (0..window.columns).map(|column| window.center_s(column)).collect();
        numbers(&result, "x", &centers);
        let plan = self.plan(axis);
        let plan_is_none = plan.is_none();
        let has_acceleration = plan.map(curves::has_acceleration);
        field(&result, "has_ideal", &plan.is_some().into());
        if let Some(plan) = plan {
            let ideal = curves::ideal(plan, self.zero_s(), window);
            for (name, band) in
                [("position", ideal.position), ("speed", ideal.speed), ("acceleration", ideal.acceleration)]
            {
                numbers(&result, &format!("{name}_min"), &band.min);
                numbers(&result, &format!("{name}_max"), &band.max);
            }
            let line = curves::ideal_line(plan, self.zero_s(), window);
            for (name, values) in [
                ("time_s", line.time_s),
                ("position", line.position),
                ("speed", line.speed),
                ("acceleration", line.acceleration),
            ] {
                numbers(&result, &format!("line_{name}"), &values);
            }
        }
        self.count_steps(axis);
        let pulses = self.pulses_of(axis);
        let curves::Actual { position, speed } = curves::actual(&pulses, window);
        let has_acceleration = has_acceleration.unwrap_or_else(|| pulses.have_acceleration());
        field(&result, "has_acceleration", &has_acceleration.into());
        let acceleration = plan_is_none.then(|| curves::actual_acceleration(&pulses, window));
        let bands = [
            ("actual_position", Some(position)),
            ("actual_speed", Some(speed)),
            ("actual_acceleration", acceleration),
        ];
        for (name, band) in bands.into_iter().filter_map(|(name, band)| Some((name, band?))) {
            numbers(&result, &format!("{name}_min"), &band.min);
            numbers(&result, &format!("{name}_max"), &band.max);
        }
        result
    }

    /// Records of one axis and RX, as for [`Simulation::record`].
    pub fn records_of(&self, axis: u8) -> Vec<u8> {
        let axis = axis % 16;
        let mask = 1 << axis | 1 << (Levels::DIR_SHIFT + u32::from(axis)) | Levels::RX;
        let mut bytes = Vec::new();
        let mut last = None;
        for record in &self.selected().stored.trace {
            let levels = record.levels.0 & mask;
            if last.replace(levels) != Some(levels) {
                bytes.extend(record.cycle.0.to_le_bytes());
                bytes.extend(levels.to_le_bytes());
            }
        }
        bytes
    }

    /// Readings at two cursors and between them (`BothReadings`), in steps and s. The pulses have an acceleration only
    /// without a plan; it may be NaN at a cursor.
    pub fn between(&mut self, axis: u8, a_cycle: f64, b_cycle: f64) -> Result<JsValue, JsError> {
        let hz = f64::from(self.experiment.config().clock_hz());
        let at = [a_cycle / hz, b_cycle / hz];
        // At least one cycle.
        let (from, to) = (at[0].min(at[1]), at[0].max(at[1]).max(at[0].min(at[1]) + 1.0 / hz));
        let zero_s = self.zero_s();
        let ideal = self.plan(axis).map(|plan| {
            let read = |t: f64| {
                Vec::from([plan.position(t - zero_s), plan.speed(t - zero_s), plan.acceleration(t - zero_s)])
            };
            Readings::new(at.map(read), cursor_stats::ideal(plan, zero_s, from, to))
        });
        self.count_steps(axis);
        let pulses = self.pulses_of(axis);
        let read = |t: f64| {
            let acceleration = pulses.acceleration_at(t).unwrap_or(f64::NAN);
            Vec::from([f64::from(pulses.position_at(t)), pulses.speed_at(t), acceleration])
        };
        let mut stats = cursor_stats::actual(&pulses, from, to);
        if ideal.is_none() {
            stats.acceleration = cursor_stats::actual_acceleration(&pulses, from, to);
        }
        let actual = Readings::new(at.map(read), stats);
        object(&BothReadings { ideal, actual })
    }

    /// Difference of the positions of this and another run in columns, `{min, max}`. `units` has the length of a step in each
    /// run, `span_s` the start and end.
    pub fn difference(
        &mut self,
        other: &mut Simulation,
        axis: u8,
        other_axis: u8,
        units: &[f64],
        span_s: &[f64],
        columns: u32,
    ) -> Object {
        let &[from, to] = span_s else { return Object::new() };
        let common_s = self.end_s().min(other.end_s());
        let (first, second) = (self.scaled(axis, units.first()), other.scaled(other_axis, units.get(1)));
        let band = position_error::difference(first, second, common_s, window(from, to, columns));
        let result = Object::new();
        numbers(&result, "min", &band.min);
        numbers(&result, "max", &band.max);
        result
    }

    /// Figures of this run after those of another one, and the deviation of the positions: `{figures, deviation}`.
    pub fn compared(
        &mut self,
        other: &mut Simulation,
        axis: u8,
        other_axis: u8,
        units: &[f64],
    ) -> Result<JsValue, JsError> {
        let unit = |index| units.get(index).copied().unwrap_or(1.0);
        let figures =
            run_figures::compare(&other.axis_run(other_axis, unit(1)), &self.axis_run(axis, unit(0)));
        let common_s = self.end_s().min(other.end_s());
        let (first, second) = (self.scaled(axis, units.first()), other.scaled(other_axis, units.get(1)));
        let position_error::PositionError { largest, at_s, rms } =
            position_error::compare(first, second, common_s);
        let deviation = Deviation { common_s, largest, at_s, rms };
        object(&Comparison { figures, deviation })
    }

    /// The motion of several axes at once, a coarser outline of each: `time_s` and lines of a planned axis, else `x` and the
    /// minimum and maximum of the pulses.
    pub fn outlines(&mut self, axes: &[u8], t0_s: f64, t1_s: f64, columns: u32) -> Array {
        let coarse = window(t0_s, t1_s, columns.div_ceil(POINTS_PER_COLUMN));
        axes.iter().map(|&axis| self.outline(axis, coarse, window(t0_s, t1_s, columns))).collect()
    }
}

impl Simulation {
    fn outline(&mut self, axis: u8, coarse: Window, fine: Window) -> Object {
        let result = Object::new();
        if let Some(plan) = self.plan(axis) {
            field(&result, "has_acceleration", &curves::has_acceleration(plan).into());
            let line = curves::ideal_line(plan, self.zero_s(), coarse);
            for (name, values) in [
                ("time_s", line.time_s),
                ("position", line.position),
                ("speed", line.speed),
                ("acceleration", line.acceleration),
            ] {
                numbers(&result, name, &values);
            }
            return result;
        }
        self.count_steps(axis);
        let curves::Actual { position, speed } = curves::outline(&self.pulses_of(axis), fine);
        let centers: Vec<f64> = (0..fine.columns).map(|column| fine.center_s(column)).collect();
        numbers(&result, "time_s", &centers);
        for (name, band) in [("position", position), ("speed", speed)] {
            numbers(&result, &format!("{name}_min"), &band.min);
            numbers(&result, &format!("{name}_max"), &band.max);
        }
        result
    }

    fn axis_run(&mut self, axis: u8, unit: f64) -> AxisRun<'_> {
        self.count_steps(axis);
        let results = self.run.results();
        let motor = results.get(self.selected).and_then(|plant| plant.motors.get(usize::from(axis)));
        let lost_full_steps = motor.map(|motor| motor.lost);
        AxisRun {
            scenario: &self.scenario,
            plan: self.plan(axis),
            pulses: self.pulses_of(axis),
            lost_full_steps,
            unit,
        }
    }

    pub(crate) fn plan(&self, axis: u8) -> Option<&AxisPlan> {
        self.experiment.plans_of(self.selected).get(usize::from(axis))
    }

    /// Start of the motions, in s.
    fn zero_s(&self) -> f64 {
        let first = self.selected().stored.first_tick();
        first.map_or(0.0, |start| start.seconds(self.experiment.config().clock_hz()))
    }

    fn end_s(&self) -> f64 {
        self.run.cycles().0.max(1) as f64 / f64::from(self.experiment.config().clock_hz())
    }

    pub(crate) fn count_steps(&mut self, channel: u8) {
        self.recordings[self.selected].count_steps(channel);
    }

    pub(crate) fn pulses_of(&self, channel: u8) -> Pulses<'_> {
        let recorded = self.selected();
        if self.recorded.is_some() && self.selected == 0 {
            return Pulses::recorded(
                channel,
                recorded.steps_of(channel),
                self.experiment.config().clock_hz(),
            );
        }
        Pulses::of_run(
            channel,
            recorded.steps_of(channel),
            &recorded.stored.packets,
            self.experiment.segments().and_then(|all| all.lists().get(usize::from(channel))),
            config(&self.experiment, self.selected),
        )
    }

    fn scaled(&mut self, channel: u8, unit: Option<&f64>) -> Scaled<'_> {
        self.count_steps(channel);
        let pulses = self.pulses_of(channel);
        Scaled { steps: pulses.steps, hz: pulses.hz(), unit: unit.copied().unwrap_or(1.0) }
    }
}

fn window(start_s: f64, end_s: f64, columns: u32) -> Window {
    Window { start_s, end_s, columns: columns.clamp(1, 10_000) as usize }
}
