//! The plant in time: edges in, a grid of points out (PLANT F1).
//!
//! ```text
//! point n            n*N: state, EN and commands before any change in that cycle
//! grid step          each motor by itself, in sub-steps that end where its STEP rises or EN changes
//! point n + 1        supply current, voltage, sensors, lost steps, digest; then choppers decide
//! ```

use crate::lost_steps::{LostSteps, Slip};
use crate::refusal::{Refusal, Refused, validate};
use crate::sensors::{Encoder, SignalChain};
use crate::{
    digest::Digest, energy::EnergyBalance, parameters::Setup, rotor::Rotor, state::State, supply::Supply,
};
use alloc::vec::Vec;
use stepscope_peripheral::signal::{Levels, Record};

/// Drivers, motors, supply and sensors on the bus of one controller. [`Plant::record`] takes the edges of the bus,
/// [`Plant::advance`] declares that none comes before a cycle. How a run is divided into calls does not affect the result.
#[derive(Clone, Debug)]
pub struct Plant {
    clock_hz: f64,
    step_cycles: u64,
    /// Grid step in s.
    h: f64,
    /// Cycle of the point before the current grid step.
    point: u64,
    levels: Levels,
    motors: Vec<Rotor>,
    supply: Supply,
    current: SignalChain,
    encoders: Vec<Encoder>,
    encoder_period: u32,
    encoder_wait: u32,
    accelerometers: Vec<Accelerometer>,
    lost: Vec<LostSteps>,
    overload: Option<Overload>,
    digest: Digest,
    events: PointEvents,
}

/// What happened at the latest point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PointEvents {
    /// The current sensor made a conversion.
    pub converted: bool,
    pub encoded: bool,
    pub overload: bool,
}

/// Observes a plant while it runs.
pub trait Observer {
    /// Called at each grid point, after the plant has reached it.
    fn point(&mut self, plant: &Plant);

    /// A motor slipped by four full steps.
    fn slip(&mut self, _channel: usize, _slip: Slip) {}

    /// STEP rises on the channels of the mask `_rises`, with the DIR levels `_right`.
    fn steps(&mut self, _cycle: u64, _rises: u16, _right: u16) {}
}

impl Observer for () {
    fn point(&mut self, _: &Plant) {}
}

impl<A: Observer, B: Observer> Observer for (A, B) {
    fn point(&mut self, plant: &Plant) {
        self.0.point(plant);
        self.1.point(plant);
    }

    fn slip(&mut self, channel: usize, slip: Slip) {
        self.0.slip(channel, slip);
        self.1.slip(channel, slip);
    }

    fn steps(&mut self, cycle: u64, rises: u16, right: u16) {
        self.0.steps(cycle, rises, right);
        self.1.steps(cycle, rises, right);
    }
}

impl<O: Observer> Observer for &mut O {
    fn point(&mut self, plant: &Plant) {
        (**self).point(plant);
    }

    fn slip(&mut self, channel: usize, slip: Slip) {
        (**self).slip(channel, slip);
    }

    fn steps(&mut self, cycle: u64, rises: u16, right: u16) {
        (**self).steps(cycle, rises, right);
    }
}

impl<O: Observer> Observer for Option<O> {
    fn point(&mut self, plant: &Plant) {
        if let Some(observer) = self {
            observer.point(plant);
        }
    }

    fn slip(&mut self, channel: usize, slip: Slip) {
        if let Some(observer) = self {
            observer.slip(channel, slip);
        }
    }

    fn steps(&mut self, cycle: u64, rises: u16, right: u16) {
        if let Some(observer) = self {
            observer.steps(cycle, rises, right);
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Overload {
    threshold_a: f64,
    samples: u32,
    in_a_row: u32,
    /// Cycle and result of the latest two conversions; true at or above the threshold.
    latest: [(u64, bool); 2],
}

impl Overload {
    fn add_conversion(&mut self, cycle: u64, is_over: bool) {
        self.in_a_row = if is_over { self.in_a_row.saturating_add(1) } else { 0 };
        self.latest = [self.latest[1], (cycle, is_over)];
    }

    /// EN rises again in cycle `rise`. A conversion in the cycle before, in which ENABLE came, already counts: conversions
    /// come last in a cycle.
    fn restart(&mut self, rise: u64) {
        let counts = |(cycle, is_over): &&(u64, bool)| *is_over && cycle + 1 >= rise;
        self.in_a_row = self.latest.iter().rev().take_while(counts).count() as u32;
    }
}

#[derive(Clone, Debug)]
struct Accelerometer {
    chain: SignalChain,
    last_speed: f64,
}

impl Plant {
    /// A plant at point 0: currents at their targets, rotors at rest.
    /// Errors: every number out of range; if there is none, every violated limit of stability, or a supply too weak.
    pub fn new(setup: &Setup) -> Result<Self, Vec<Refused>> {
        let refused = validate(setup);
        if !refused.is_empty() {
            return Err(refused);
        }
        let (clock_hz, step_cycles) = (f64::from(setup.clock_hz), setup.grid_cycles());
        let h = f64::from(step_cycles) / clock_hz;
        let rotor = |motor| Rotor::new(motor, clock_hz, step_cycles);
        let mut motors: Vec<Rotor> = setup.motors.iter().map(rotor).collect();
        let power_w = motors.iter().map(Rotor::first_power).fold(0.0, |sum, power| sum + power);
        let source_ohm = setup.supply.source_ohm;
        let supply = Supply::new(&setup.supply, h, motors.len(), power_w).ok_or_else(|| {
            alloc::vec![Refused { channel: None, refusal: Refusal::TooWeak { source_ohm, power_w } }]
        })?;
        for motor in &mut motors {
            motor.driver.decide(motor.state.i_a, motor.state.i_b);
        }
        let encoder = |(channel, motor): (usize, &crate::parameters::MotorModel)| {
            Encoder::new(&setup.encoder, channel as u64, motor.full_step_deg)
        };
        let accelerometers = setup.accelerometer.iter().flat_map(|chain| {
            let one = Accelerometer { chain: SignalChain::new(chain, h, 0.0), last_speed: 0.0 };
            core::iter::repeat_n(one, motors.len())
        });
        Ok(Self {
            clock_hz,
            step_cycles: step_cycles.into(),
            h,
            point: 0,
            levels: Levels::RESET,
            current: SignalChain::new(&setup.current_sensor, h, supply.current),
            encoders: setup.motors.iter().enumerate().map(encoder).collect(),
            encoder_period: setup.encoder.period_steps,
            encoder_wait: setup.encoder.period_steps,
            accelerometers: accelerometers.collect(),
            lost: alloc::vec![LostSteps::default(); motors.len()],
            overload: setup.protection.as_ref().map(|p| Overload {
                threshold_a: p.threshold_a,
                samples: p.samples,
                in_a_row: 0,
                latest: [(0, false); 2],
            }),
            digest: Digest::default(),
            events: PointEvents::default(),
            motors,
            supply,
        })
    }

    /// Sets the levels from a cycle on. Records must be in order.
    pub fn record(&mut self, record: Record, observer: &mut dyn Observer) {
        let cycle = record.cycle.0;
        self.advance(cycle, observer);
        let before = core::mem::replace(&mut self.levels, record.levels);
        let offset = cycle.saturating_sub(self.point);
        let (was_powered, is_powered) = (before.has(Levels::EN), record.levels.has(Levels::EN));
        if was_powered != is_powered {
            for (motor, lost) in self.motors.iter_mut().zip(&mut self.lost) {
                motor.advance(offset, self.supply.voltage, was_powered);
                if is_powered {
                    motor.driver.power_up();
                    lost.power_up(motor.driver.command() - motor.state.x);
                }
            }
            if let Some(overload) = self.overload.as_mut().filter(|_| is_powered) {
                overload.restart(cycle);
            }
        }
        let rises = record.levels.step() & !before.step();
        if rises == 0 {
            return;
        }
        observer.steps(cycle, rises, record.levels.dir());
        for (channel, motor) in self.motors.iter_mut().enumerate() {
            if rises >> channel & 1 != 0 {
                motor.advance(offset, self.supply.voltage, is_powered);
                motor.driver.step(record.levels.dir() >> channel & 1 != 0);
            }
        }
    }

    /// Runs up to the last grid point at or before `cycle`.
    pub fn advance(&mut self, cycle: u64, observer: &mut dyn Observer) {
        while self.next_point() <= cycle {
            self.grid_step(observer);
        }
    }

    fn grid_step(&mut self, observer: &mut dyn Observer) {
        let (powered, supply_v) = (self.levels.has(Levels::EN), self.supply.voltage);
        let mut energy = 0.0;
        for motor in &mut self.motors {
            energy += motor.finish(supply_v, powered);
        }
        self.supply.advance(energy);
        self.point += self.step_cycles;
        self.events =
            PointEvents { converted: self.current.advance(self.supply.current), ..PointEvents::default() };
        self.read_encoders_and_accelerometers();
        if powered {
            for (channel, (motor, lost)) in self.motors.iter_mut().zip(&mut self.lost).enumerate() {
                let error = motor.driver.command() - motor.state.x;
                if let Some(slip) = lost.update(error, self.point) {
                    observer.slip(channel, slip);
                }
            }
        }
        if let Some(overload) = self.overload.as_mut().filter(|_| self.events.converted) {
            let is_over = self.current.reading() >= overload.threshold_a;
            overload.add_conversion(self.point, is_over);
            self.events.overload = overload.in_a_row == overload.samples;
        }
        if self.digest.count_point() {
            self.digest_point();
        }
        observer.point(self);
        if powered {
            for motor in &mut self.motors {
                motor.driver.decide(motor.state.i_a, motor.state.i_b);
            }
        }
    }

    fn read_encoders_and_accelerometers(&mut self) {
        self.encoder_wait -= 1;
        if self.encoder_wait == 0 {
            self.encoder_wait = self.encoder_period;
            self.events.encoded = true;
            for (encoder, motor) in self.encoders.iter_mut().zip(&self.motors) {
                encoder.read(motor.state.x);
            }
        }
        for (accelerometer, motor) in self.accelerometers.iter_mut().zip(&self.motors) {
            let speed = motor.state.w_load;
            let last_speed = core::mem::replace(&mut accelerometer.last_speed, speed);
            accelerometer.chain.advance((speed - last_speed) / self.h * motor.constants.g);
        }
    }

    fn digest_point(&mut self) {
        self.digest.cycle(self.point);
        self.digest.numbers(&[self.supply.voltage, self.supply.current]);
        for motor in &self.motors {
            let State { x, w, i_a, i_b, .. } = motor.state;
            self.digest.numbers(&[x, w, i_a, i_b]);
        }
    }

    fn next_point(&self) -> u64 {
        self.point.saturating_add(self.step_cycles)
    }

    /// Cycle of the latest point.
    pub const fn cycle(&self) -> u64 {
        self.point
    }

    pub const fn step_cycles(&self) -> u64 {
        self.step_cycles
    }

    pub const fn clock_hz(&self) -> f64 {
        self.clock_hz
    }

    pub fn motors(&self) -> usize {
        self.motors.len()
    }

    /// A motor's state at the latest point, or after its latest sub-step. `None` without such a channel.
    pub fn state(&self, channel: usize) -> Option<&State> {
        self.motors.get(channel).map(|motor| &motor.state)
    }

    /// Commanded position in full steps; 0 without such a channel.
    pub fn command(&self, channel: usize) -> f64 {
        self.motors.get(channel).map_or(0.0, |motor| motor.driver.command())
    }

    /// Lost full steps of a motor so far; positive where it lost steps to the right.
    pub fn lost(&self, channel: usize) -> i64 {
        self.lost.get(channel).map_or(0, |lost| lost.full_steps())
    }

    pub const fn is_powered(&self) -> bool {
        self.levels.has(Levels::EN)
    }

    /// Supply voltage at the drivers in V.
    pub const fn supply_v(&self) -> f64 {
        self.supply.voltage
    }

    /// Supply current of all drivers in the last grid step, in A.
    pub const fn supply_a(&self) -> f64 {
        self.supply.current
    }

    /// Whether the supply voltage is at 1/16 of the source voltage or less.
    pub const fn has_collapsed(&self) -> bool {
        self.supply.has_collapsed
    }

    /// The sensor of the supply current, in A.
    pub const fn current_sensor(&self) -> &SignalChain {
        &self.current
    }

    /// The latest code of a motor's encoder, 0..=4095.
    pub fn encoder(&self, channel: usize) -> u16 {
        self.encoders.get(channel).map_or(0, |encoder| encoder.code)
    }

    /// The accelerometer on a motor's load, in rad/s^2, if there is one.
    pub fn accelerometer(&self, channel: usize) -> Option<&SignalChain> {
        self.accelerometers.get(channel).map(|accelerometer| &accelerometer.chain)
    }

    pub const fn events(&self) -> PointEvents {
        self.events
    }

    /// A motor's energies since the start; `None` without such a channel.
    pub fn energy(&self, channel: usize) -> Option<EnergyBalance> {
        self.motors.get(channel).map(|motor| motor.energy.balance(&motor.constants, &motor.state))
    }

    /// Digest of all points so far; it identifies a run of the plant.
    pub fn digest(&self) -> u64 {
        self.digest.value()
    }

    /// Sets a motor's state, for tests of the equations.
    pub fn set_state(&mut self, channel: usize, state: State) {
        if let Some(motor) = self.motors.get_mut(channel) {
            motor.state = state;
            motor.energy = crate::energy::EnergyAccount::new(&motor.constants, &motor.state);
        }
    }
}
