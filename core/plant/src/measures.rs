//! Running measures of a plant (PLANT F8): following error, slips, overshoot, settling after the last step, currents, voltage.
//!
//! When a rotor settled depends on its final position, which is known only at the end. `Tail` saves the positions since the
//! last STEP that are above (below) all later ones: only these can be the last one outside of the final tolerance.
//!
//! ```
//! use stepscope_plant::{Plant, measures::Measures, parameters::{MotorModel, Setup}};
//!
//! let setup = Setup { motors: vec![MotorModel::default()], ..Setup::default() };
//! let mut plant = Plant::new(&setup).expect("a valid setup");
//! let mut measures = Measures::new(&plant);
//! plant.advance(16_000, &mut measures);
//! let result = measures.result(&plant);
//! assert_eq!((result.motors[0].lost, result.motors[0].overshoot), (0, None));
//! assert_eq!((result.bus_v.min, result.bus_v.max), (24.0, 24.0));
//! ```

use crate::plant::{Observer, Plant};
use crate::{energy::EnergyBalance, lost_steps::Slip, root::square_root, settling::Deviation, state::State};
use alloc::vec::Vec;

/// Maximum number of slips saved with their cycles; all are counted.
pub const MAX_SLIPS: usize = 10_000;
/// Maximum distance of a settled rotor from its final position, in full steps.
const SETTLED: f64 = 0.05;

/// Minimum, maximum and root mean square of a value over grid points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Minimum; infinite before the first point.
    pub min: f64,
    /// Maximum; minus infinity before the first point.
    pub max: f64,
    squares: f64,
    points: u64,
}

impl Default for Extremes {
    fn default() -> Self {
        Self { min: f64::INFINITY, max: f64::NEG_INFINITY, squares: 0.0, points: 0 }
    }
}

impl Extremes {
    fn add(&mut self, value: f64) {
        if value < self.min {
            self.min = value;
        }
        if value > self.max {
            self.max = value;
        }
        self.squares += value * value;
        self.points += 1;
    }

    /// Root mean square; 0 before the first point.
    pub fn rms(&self) -> f64 {
        if self.points == 0 { 0.0 } else { square_root(self.squares / self.points as f64) }
    }

    /// Largest absolute value; 0 before the first point.
    pub fn peak(&self) -> f64 {
        if self.points == 0 { 0.0 } else { self.max.max(-self.min) }
    }
}

/// Positions of a rotor since its last STEP that can decide when it has settled, with their cycles.
#[derive(Clone, Debug, Default)]
struct Tail {
    above: Vec<(u64, f64)>,
    below: Vec<(u64, f64)>,
}

impl Tail {
    fn clear(&mut self) {
        self.above.clear();
        self.below.clear();
    }

    fn add(&mut self, cycle: u64, x: f64) {
        while self.above.last().is_some_and(|&(_, value)| value <= x) {
            self.above.pop();
        }
        self.above.push((cycle, x));
        while self.below.last().is_some_and(|&(_, value)| value >= x) {
            self.below.pop();
        }
        self.below.push((cycle, x));
    }

    /// The last cycle in which the position was more than `tolerance` away from `end`.
    fn last_outside(&self, end: f64, tolerance: f64) -> Option<u64> {
        let above = self.above.iter().rev().find(|&&(_, x)| x - end > tolerance);
        let below = self.below.iter().rev().find(|&&(_, x)| end - x > tolerance);
        above.into_iter().chain(below).map(|&(cycle, _)| cycle).max()
    }
}

/// The last step of a motor, and the extremes of its position since then.
#[derive(Clone, Debug)]
struct LastStep {
    cycle: u64,
    right: bool,
    min: f64,
    max: f64,
}

#[derive(Clone, Debug, Default)]
struct MotorMeasures {
    following_error: Peak,
    max_speed: Peak,
    max_load_speed: f64,
    currents: [Extremes; 2],
    slips: Vec<Slip>,
    slip_count: u64,
    first_slip_step: Option<u64>,
    last_step: Option<LastStep>,
    tail: Tail,
}

/// An observer that measures all motors and the supply.
#[derive(Clone, Debug, Default)]
pub struct Measures {
    motors: Vec<MotorMeasures>,
    load: Extremes,
    bus: Extremes,
    collapsed: Option<u64>,
    /// Sum and number of the readings of the current sensor before the first step.
    rest_readings: f64,
    rest_points: u64,
    has_stepped: bool,
    /// Steps per motor, and the sensor readings from the first motor's fifth step on.
    steps: Vec<u64>,
    sensor: Extremes,
}

/// The deviation starts with this step of the first motor.
const FIRST_MEASURED_STEP: u64 = 5;
/// Minimum steps of each motor for a deviation.
const MIN_STEPS: u64 = 8;

/// An extreme value and its grid point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peak {
    pub value: f64,
    pub cycle: u64,
}

/// The measures of a motor.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorResult {
    pub state: State,
    /// Commanded position in full steps.
    pub command: f64,
    /// Lost full steps, positive to the right.
    pub lost: i64,
    /// The first [`MAX_SLIPS`] slips of four full steps.
    pub slips: Vec<Slip>,
    pub slip_count: u64,
    /// Steps before the first slip.
    pub first_slip_step: Option<u64>,
    /// Command minus position where their distance is maximal, in full steps.
    pub following_error: Peak,
    /// Maximum speed of the rotor without sign, in full steps/s.
    pub max_speed: Peak,
    /// Maximum speed of the load without sign, in full steps/s; without a coupling the rotor's.
    pub max_load_speed: f64,
    /// Distance beyond the last command in the direction of the last step, in full steps; `None` without a step.
    pub overshoot: Option<f64>,
    /// Cycles from the last step until the rotor stays within 0.05 full steps of its final position; `None` without a step.
    pub settling: Option<u64>,
    pub last_step: Option<u64>,
    /// Larger peak of both phase currents in A.
    pub phase_peak_a: f64,
    /// Root mean square of both phase currents in A.
    pub phase_rms_a: f64,
    pub energy: EnergyBalance,
}

/// The measures of a plant.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantResult {
    pub cycle: u64,
    pub digest: u64,
    pub motors: Vec<MotorResult>,
    /// Supply current in A.
    pub load_a: Extremes,
    /// Bus voltage in V.
    pub bus_v: Extremes,
    /// Cycle of the first point at which the bus is at 1/16 of the source voltage or less.
    pub collapsed: Option<u64>,
    /// Deviation of the measured supply current from its mean before the first step, from the first motor's fifth step
    /// on; `None` if a motor makes fewer than eight steps.
    pub deviation: Option<Deviation>,
}

impl Measures {
    /// Measures from the plant's first point on.
    pub fn new(plant: &Plant) -> Self {
        let motors = alloc::vec![MotorMeasures::default(); plant.motors()];
        let mut new = Self { motors, steps: alloc::vec![0; plant.motors()], ..Self::default() };
        new.bus.add(plant.bus_v());
        new
    }

    /// The measures so far.
    pub fn result(&self, plant: &Plant) -> PlantResult {
        PlantResult {
            cycle: plant.cycle(),
            digest: plant.digest(),
            motors: self
                .motors
                .iter()
                .enumerate()
                .map(|(channel, motor)| motor.result(plant, channel))
                .collect(),
            load_a: self.load,
            bus_v: self.bus,
            collapsed: self.collapsed,
            deviation: self.deviation(),
        }
    }

    fn deviation(&self) -> Option<Deviation> {
        let has_enough_steps = self.steps.iter().all(|&steps| steps >= MIN_STEPS);
        if !has_enough_steps || self.rest_points == 0 || self.sensor.points == 0 {
            return None;
        }
        let rest_a = self.rest_readings / self.rest_points as f64;
        let (above_a, below_a) = (self.sensor.max - rest_a, rest_a - self.sensor.min);
        Some(Deviation { rest_a, above_a: above_a.max(0.0), below_a: below_a.max(0.0) })
    }

    /// The first [`MAX_SLIPS`] slips of a motor so far.
    pub fn slips(&self, channel: usize) -> &[Slip] {
        self.motors.get(channel).map_or(&[], |motor| &motor.slips)
    }
}

impl MotorMeasures {
    fn result(&self, plant: &Plant, channel: usize) -> MotorResult {
        let state = plant.state(channel).copied().unwrap_or_default();
        let command = plant.command(channel);
        let last = self.last_step.as_ref();
        let [a, b] = self.currents;
        let points = (a.points + b.points).max(1) as f64;
        MotorResult {
            state,
            command,
            lost: plant.lost(channel),
            slips: self.slips.clone(),
            slip_count: self.slip_count,
            first_slip_step: self.first_slip_step,
            following_error: self.following_error,
            max_speed: self.max_speed,
            max_load_speed: self.max_load_speed,
            overshoot: last.map(|last| if last.right { last.max - command } else { command - last.min }),
            settling: last.map(|last| {
                self.tail.last_outside(state.x, SETTLED).map_or(0, |cycle| cycle.saturating_sub(last.cycle))
            }),
            last_step: last.map(|last| last.cycle),
            phase_peak_a: a.peak().max(b.peak()),
            phase_rms_a: square_root((a.squares + b.squares) / points),
            energy: plant.energy(channel).unwrap_or_default(),
        }
    }

    fn point(&mut self, state: &State, command: f64, cycle: u64) {
        let error = command - state.x;
        if error.abs() > self.following_error.value.abs() {
            self.following_error = Peak { value: error, cycle };
        }
        if state.w.abs() > self.max_speed.value {
            self.max_speed = Peak { value: state.w.abs(), cycle };
        }
        self.max_load_speed = self.max_load_speed.max(state.w_load.abs());
        self.currents[0].add(state.i_a);
        self.currents[1].add(state.i_b);
        if let Some(last) = &mut self.last_step {
            if state.x < last.min {
                last.min = state.x;
            }
            if state.x > last.max {
                last.max = state.x;
            }
            self.tail.add(cycle, state.x);
        }
    }
}

impl Observer for Measures {
    fn point(&mut self, plant: &Plant) {
        let cycle = plant.cycle();
        for (channel, motor) in self.motors.iter_mut().enumerate() {
            if let Some(state) = plant.state(channel) {
                motor.point(state, plant.command(channel), cycle);
            }
        }
        self.load.add(plant.load_a());
        let reading = plant.current_sensor().filtered();
        if !self.has_stepped {
            self.rest_readings += reading;
            self.rest_points += 1;
        } else if self.steps.first().is_some_and(|&steps| steps >= FIRST_MEASURED_STEP) {
            self.sensor.add(reading);
        }
        self.bus.add(plant.bus_v());
        if plant.has_collapsed() && self.collapsed.is_none() {
            self.collapsed = Some(cycle);
        }
    }

    fn slip(&mut self, channel: usize, slip: Slip) {
        if let Some(motor) = self.motors.get_mut(channel) {
            motor.slip_count += 1;
            motor.first_slip_step = motor.first_slip_step.or_else(|| self.steps.get(channel).copied());
            if motor.slips.len() < MAX_SLIPS {
                motor.slips.push(slip);
            }
        }
    }

    fn steps(&mut self, cycle: u64, rises: u16, right: u16) {
        self.has_stepped = true;
        for (channel, steps) in self.steps.iter_mut().enumerate() {
            *steps += u64::from(rises >> channel & 1);
        }
        for (channel, motor) in self.motors.iter_mut().enumerate() {
            if rises >> channel & 1 != 0 {
                let right = right >> channel & 1 != 0;
                motor.last_step = Some(LastStep { cycle, right, min: f64::INFINITY, max: f64::NEG_INFINITY });
                motor.tail.clear();
            }
        }
    }
}
