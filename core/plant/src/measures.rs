//! Running measures of a plant (PLANT F8): following error, slips, overshoot, settling after the last step, currents, voltage.
//!
//! When a rotor settled depends on its final position, which is known only at the end. `SettlingCandidates` saves the positions
//! that can be the last one outside of the final tolerance.
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
//! assert_eq!((result.supply_v.min, result.supply_v.max), (24.0, 24.0));
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
pub struct Statistics {
    /// Minimum; infinite before the first point.
    pub min: f64,
    /// Maximum; minus infinity before the first point.
    pub max: f64,
    squares: f64,
    points: u64,
}

impl Default for Statistics {
    fn default() -> Self {
        Self { min: f64::INFINITY, max: f64::NEG_INFINITY, squares: 0.0, points: 0 }
    }
}

impl Statistics {
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

/// Positions of a rotor since its last STEP, with their cycles, in two monotonic stacks. A position that a later one exceeds
/// cannot be the last one above the final tolerance, so it is dropped; likewise below it.
#[derive(Clone, Debug, Default)]
struct SettlingCandidates {
    falling: Vec<(u64, f64)>,
    rising: Vec<(u64, f64)>,
}

impl SettlingCandidates {
    fn clear(&mut self) {
        self.falling.clear();
        self.rising.clear();
    }

    fn add(&mut self, cycle: u64, x: f64) {
        while self.falling.last().is_some_and(|&(_, value)| value <= x) {
            self.falling.pop();
        }
        self.falling.push((cycle, x));
        while self.rising.last().is_some_and(|&(_, value)| value >= x) {
            self.rising.pop();
        }
        self.rising.push((cycle, x));
    }

    /// The last cycle in which the position was more than `tolerance` away from `end`.
    fn last_outside(&self, end: f64, tolerance: f64) -> Option<u64> {
        let above = self.falling.iter().rev().find(|&&(_, x)| x - end > tolerance);
        let below = self.rising.iter().rev().find(|&&(_, x)| end - x > tolerance);
        above.into_iter().chain(below).map(|&(cycle, _)| cycle).max()
    }
}

/// The last step of a motor, and the extremes of its position at the grid points since then.
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
    currents: [Statistics; 2],
    slips: Vec<Slip>,
    slip_count: u64,
    steps_until_first_slip: Option<u64>,
    last_step: Option<LastStep>,
    candidates: SettlingCandidates,
}

/// An observer that measures all motors and the supply.
#[derive(Clone, Debug, Default)]
pub struct Measures {
    motors: Vec<MotorMeasures>,
    supply_current: Statistics,
    supply_voltage: Statistics,
    collapsed: Option<u64>,
    /// Sum of the current sensor's readings before the first step.
    idle_readings_sum: f64,
    idle_readings: u64,
    has_stepped: bool,
    steps: Vec<u64>,
    /// The sensor's readings from step [`FIRST_MEASURED_STEP`] of the first motor on.
    sensor: Statistics,
}

/// The deviation of the supply current uses samples from this step of the first motor on.
const FIRST_MEASURED_STEP: u64 = 5;
/// Minimum steps of each motor for a deviation of the supply current.
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
    /// Steps until the first slip, the one that slipped included.
    pub steps_until_first_slip: Option<u64>,
    /// Command minus position where their distance is maximal, in full steps.
    pub following_error: Peak,
    /// Maximum speed of the rotor without sign, in full steps/s.
    pub max_speed: Peak,
    /// Maximum speed of the load without sign, in full steps/s; without a coupling the rotor's.
    pub max_load_speed: f64,
    /// Distance beyond the last command in the direction of the last step, in full steps; negative if the rotor stayed short of
    /// it. `None` before the first grid point after a step.
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
    pub supply_a: Statistics,
    /// Supply voltage at the drivers in V.
    pub supply_v: Statistics,
    /// Cycle of the first point at which this voltage is at 1/16 of the source voltage or less.
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
        // The voltage at the start is a minimum or maximum that grid points may not reach again.
        new.supply_voltage.add(plant.supply_v());
        new
    }

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
            supply_a: self.supply_current,
            supply_v: self.supply_voltage,
            collapsed: self.collapsed,
            deviation: self.deviation(),
        }
    }

    fn deviation(&self) -> Option<Deviation> {
        let has_enough_steps = self.steps.iter().all(|&steps| steps >= MIN_STEPS);
        if !has_enough_steps || self.idle_readings == 0 || self.sensor.points == 0 {
            return None;
        }
        let rest_a = self.idle_readings_sum / self.idle_readings as f64;
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
            steps_until_first_slip: self.steps_until_first_slip,
            following_error: self.following_error,
            max_speed: self.max_speed,
            max_load_speed: self.max_load_speed,
            overshoot: last
                .filter(|last| last.min <= last.max)
                .map(|last| if last.right { last.max - command } else { command - last.min }),
            settling: last.map(|last| {
                self.candidates
                    .last_outside(state.x, SETTLED)
                    .map_or(0, |cycle| cycle.saturating_sub(last.cycle))
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
            self.candidates.add(cycle, state.x);
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
        self.supply_current.add(plant.supply_a());
        let reading = plant.current_sensor().filtered();
        if !self.has_stepped {
            self.idle_readings_sum += reading;
            self.idle_readings += 1;
        } else if self.steps.first().is_some_and(|&steps| steps >= FIRST_MEASURED_STEP) {
            self.sensor.add(reading);
        }
        self.supply_voltage.add(plant.supply_v());
        if plant.has_collapsed() && self.collapsed.is_none() {
            self.collapsed = Some(cycle);
        }
    }

    fn slip(&mut self, channel: usize, slip: Slip) {
        if let Some(motor) = self.motors.get_mut(channel) {
            motor.slip_count += 1;
            motor.steps_until_first_slip =
                motor.steps_until_first_slip.or_else(|| self.steps.get(channel).copied());
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
                motor.candidates.clear();
            }
        }
    }
}
