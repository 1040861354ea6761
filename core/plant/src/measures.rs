//! Running measures of a plant (F8): following error, slips, overshoot and settling after the last step, currents, voltage.
//!
//! Where a rotor comes to rest is known at the end alone. Until then `Tail` keeps of its positions since the last STEP
//! those above (and below) all that came later: among them is the last one that was too far off, whatever the end is.
//!
//! ```
//! use stepscope_plant::{Plant, measures::Measures, parameters::{MotorModel, Setup}};
//!
//! let setup = Setup { motors: vec![MotorModel::default()], ..Setup::default() };
//! let mut plant = Plant::new(&setup).expect("it holds");
//! let mut measures = Measures::new(&plant);
//! plant.advance(16_000, &mut measures);
//! let result = measures.result(&plant);
//! assert_eq!((result.motors[0].lost, result.motors[0].overshoot), (0, None));
//! assert_eq!((result.bus_v.least, result.bus_v.greatest), (24.0, 24.0));
//! ```

use crate::{
    energy::EnergyBalance,
    lost_steps::Slip,
    plant::{Observer, Plant},
    root::square_root,
    settling::Deviation,
    state::State,
};
use alloc::vec::Vec;

/// Slips of a motor that are kept with their cycles; all are counted.
pub const MAX_SLIPS: usize = 10_000;
/// How far from its place a rotor is still moving, in full steps.
pub const SETTLED: f64 = 0.05;

/// Minimum, maximum and mean square of something at points.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Extremes {
    pub least: f64,
    pub greatest: f64,
    squares: f64,
    points: u64,
}

impl Default for Extremes {
    fn default() -> Self {
        Self { least: f64::INFINITY, greatest: f64::NEG_INFINITY, squares: 0.0, points: 0 }
    }
}

impl Extremes {
    #[inline(always)]
    fn add(&mut self, value: f64) {
        if value < self.least {
            self.least = value;
        }
        if value > self.greatest {
            self.greatest = value;
        }
        self.squares += value * value;
        self.points += 1;
    }

    /// The root of the mean square; 0 before the first point.
    #[must_use]
    pub fn rms(&self) -> f64 {
        if self.points == 0 { 0.0 } else { square_root(self.squares / self.points as f64) }
    }

    /// The maximum amount; 0 before the first point.
    #[must_use]
    pub fn peak(&self) -> f64 {
        if self.points == 0 { 0.0 } else { self.greatest.max(-self.least) }
    }
}

/// The positions of a rotor since its last STEP, as far as the end may ask for them.
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

    #[inline(always)]
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

    /// The last cycle at which it was more than `off` from `end`.
    fn last_off(&self, end: f64, off: f64) -> Option<u64> {
        let above = self.above.iter().rev().find(|&&(_, x)| x - end > off);
        let below = self.below.iter().rev().find(|&&(_, x)| end - x > off);
        above.into_iter().chain(below).map(|&(cycle, _)| cycle).max()
    }
}

#[derive(Clone, Debug)]
struct AfterStep {
    cycle: u64,
    right: bool,
    least: f64,
    greatest: f64,
}

#[derive(Clone, Debug, Default)]
struct MotorModel {
    worst: (f64, u64),
    fastest: (f64, u64),
    fastest_load: f64,
    currents: [Extremes; 2],
    slips: Vec<Slip>,
    slip_count: u64,
    first_slip_step: Option<u64>,
    last: Option<AfterStep>,
    tail: Tail,
}

/// Takes the measures of a whole run.
#[derive(Clone, Debug, Default)]
pub struct Measures {
    motors: Vec<MotorModel>,
    load: Extremes,
    bus: Extremes,
    collapsed: Option<u64>,
    /// Sum and count of the sensor's readings before the first step.
    rest: (f64, u64),
    has_stepped: bool,
    /// Steps of each motor, and the sensor's readings from the first motor's fifth on.
    steps: Vec<u64>,
    sensor: Extremes,
}

/// Steps of the first motor before the supply current's deviation counts, and steps of each that there must be.
const FIRST_STEPS: u64 = 5;
const MIN_STEPS: u64 = 8;

/// What one motor did.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct MotorResult {
    pub state: State,
    /// Where it is told to be, in full steps.
    pub command: f64,
    /// Lost full steps, positive to the right.
    pub lost: i64,
    /// Each slip of four full steps, the first [`MAX_SLIPS`] of them.
    pub slips: Vec<Slip>,
    pub slip_count: u64,
    /// How many STEPs had come by the first slip.
    pub first_slip_step: Option<u64>,
    /// The maximum amount by which it was off its command, in full steps, with its sign (positive: behind to the left), and
    /// the point's cycle.
    pub following_error: (f64, u64),
    /// The rotor's maximum speed in full steps/s, without sign, and the point's cycle.
    pub fastest: (f64, u64),
    /// The load's maximum speed; the rotor's where no coupling is between them.
    pub fastest_load: f64,
    /// Its last STEP, and by how much it went past its last command, in full steps in that direction; `None` without a step.
    pub overshoot: Option<f64>,
    /// Cycles from the last STEP until it stays within 0.05 full steps of where it ends; `None` without a step.
    pub settling: Option<u64>,
    pub last_step: Option<u64>,
    /// Peak of the greater phase current in A.
    pub phase_peak_a: f64,
    /// Root of the mean square of both phase currents in A.
    pub phase_rms_a: f64,
    pub energy: EnergyBalance,
}

/// What a plant did.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct PlantResult {
    pub cycle: u64,
    pub digest: u64,
    /// The motor of channel 0, 1, ….
    pub motors: Vec<MotorResult>,
    /// Current of the supply in A.
    pub load_a: Extremes,
    /// Voltage of the bus in V.
    pub bus_v: Extremes,
    /// The first point at which the bus had fallen to a sixteenth of the source's voltage.
    pub collapsed: Option<u64>,
    /// How far the sensor of the supply current went from its rest before the first step, from the first motor's fifth step
    /// on; `None` where a motor makes fewer than eight.
    pub deviation: Option<Deviation>,
}

impl Measures {
    /// Measures that begin at the plant's first point.
    #[must_use]
    pub fn new(plant: &Plant) -> Self {
        let motors = alloc::vec![MotorModel::default(); plant.motors()];
        let mut new = Self { motors, steps: alloc::vec![0; plant.motors()], ..Self::default() };
        new.bus.add(plant.bus_v());
        new
    }

    /// What the plant has done until now.
    #[must_use]
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
        let enough = self.steps.iter().all(|&steps| steps >= MIN_STEPS);
        if !enough || self.rest.1 == 0 || self.sensor.points == 0 {
            return None;
        }
        let rest_a = self.rest.0 / self.rest.1 as f64;
        let (above_a, below_a) = (self.sensor.greatest - rest_a, rest_a - self.sensor.least);
        Some(Deviation { rest_a, above_a: above_a.max(0.0), below_a: below_a.max(0.0) })
    }

    /// The slips so far of a motor, the first [`MAX_SLIPS`] of them.
    #[must_use]
    pub fn slips(&self, channel: usize) -> &[Slip] {
        self.motors.get(channel).map_or(&[], |motor| &motor.slips)
    }
}

impl MotorModel {
    fn result(&self, plant: &Plant, channel: usize) -> MotorResult {
        let state = plant.state(channel).copied().unwrap_or_default();
        let command = plant.command(channel);
        let last = self.last.as_ref();
        let [a, b] = self.currents;
        let points = (a.points + b.points).max(1) as f64;
        MotorResult {
            state,
            command,
            lost: plant.lost(channel),
            slips: self.slips.clone(),
            slip_count: self.slip_count,
            first_slip_step: self.first_slip_step,
            following_error: self.worst,
            fastest: self.fastest,
            fastest_load: self.fastest_load,
            overshoot: last
                .map(|last| if last.right { last.greatest - command } else { command - last.least }),
            settling: last.map(|last| {
                self.tail.last_off(state.x, SETTLED).map_or(0, |cycle| cycle.saturating_sub(last.cycle))
            }),
            last_step: last.map(|last| last.cycle),
            phase_peak_a: a.peak().max(b.peak()),
            phase_rms_a: square_root((a.squares + b.squares) / points),
            energy: plant.energy(channel).unwrap_or_default(),
        }
    }

    #[inline(always)]
    fn point(&mut self, state: &State, command: f64, cycle: u64) {
        let error = command - state.x;
        if error.abs() > self.worst.0.abs() {
            self.worst = (error, cycle);
        }
        if state.w.abs() > self.fastest.0 {
            self.fastest = (state.w.abs(), cycle);
        }
        self.fastest_load = self.fastest_load.max(state.w_load.abs());
        self.currents[0].add(state.i_a);
        self.currents[1].add(state.i_b);
        if let Some(last) = &mut self.last {
            if state.x < last.least {
                last.least = state.x;
            }
            if state.x > last.greatest {
                last.greatest = state.x;
            }
            self.tail.add(cycle, state.x);
        }
    }
}

impl Observer for Measures {
    #[inline(always)]
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
            self.rest = (self.rest.0 + reading, self.rest.1 + 1);
        } else if self.steps.first().is_some_and(|&steps| steps >= FIRST_STEPS) {
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
                motor.last =
                    Some(AfterStep { cycle, right, least: f64::INFINITY, greatest: f64::NEG_INFINITY });
                motor.tail.clear();
            }
        }
    }
}
