//! The motor with its load in the phasor model.

use crate::motion::torque::moment::Moment;
use core::f64::consts::{PI, SQRT_2};
use stepscope_motion::mechanics::{Mechanics, Rotary};
use stepscope_motion::{AxisPlan, MAX_SPEED, bisection::border, moves::Axis};
use stepscope_scenario::{PlantMotor, PlantSettings, Scenario};
use stepscope_sim::axes_of;

const MILLI: f64 = 1000.0;
/// kg*m^2 per g*cm^2.
const GRAM_CM2: f64 = 1e-7;
const MIN_PERIOD_S: f64 = 1e-6;

/// A motor with its driver, supply and load, in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    constant: f64,
    current_a: f64,
    supply_v: f64,
    resistance_ohm: f64,
    inductance_h: f64,
    pole_pairs: f64,
    step_rad: f64,
    inertia_kg_m2: f64,
    load_n_m: f64,
    working_rate: Option<f64>,
}

impl Machine {
    /// `None` without a motor, or if the mechanics have no angle.
    pub fn of(axis: &Axis) -> Option<Self> {
        let motor = axis.motor.as_ref()?;
        let (full_step_deg, step_deg) = (axis.mechanics.full_step_deg()?, axis.mechanics.step_deg()?);
        Some(Self {
            constant: motor.holding_torque_mn_m / MILLI / (SQRT_2 * motor.rated_current_a),
            current_a: motor.peak_current_a.unwrap_or(motor.rated_current_a),
            supply_v: motor.supply_v,
            resistance_ohm: motor.resistance_ohm,
            inductance_h: motor.inductance_mh / 1000.0,
            pole_pairs: 90.0 / full_step_deg,
            step_rad: step_deg * PI / 180.0,
            inertia_kg_m2: (motor.rotor_inertia_g_cm2 + motor.load_inertia_g_cm2) * GRAM_CM2,
            load_n_m: motor.load_torque_mn_m / MILLI,
            working_rate: motor.working_rate_hz,
        })
    }

    /// The motor of a plant, without a working rate.
    pub fn of_plant(motor: &stepscope_plant::parameters::MotorModel, supply_v: f64) -> Self {
        Self {
            constant: motor.holding_torque_mn_m / MILLI / (SQRT_2 * motor.rated_current_a),
            current_a: motor.peak_current_a,
            supply_v,
            resistance_ohm: motor.resistance_ohm,
            inductance_h: motor.inductance_mh / 1000.0,
            pole_pairs: 90.0 / motor.full_step_deg,
            step_rad: motor.full_step_deg / f64::from(motor.microsteps) * PI / 180.0,
            inertia_kg_m2: (motor.rotor_inertia_g_cm2 + motor.load_inertia_g_cm2) * GRAM_CM2,
            load_n_m: motor.load_torque_mn_m / MILLI,
            working_rate: None,
        }
    }

    /// The motor of the channel's axis, otherwise the motor of the scenario's plant.
    pub fn of_channel(scenario: &Scenario, controller: usize, channel: usize) -> Option<Self> {
        let axis = axes_of(scenario, controller).get(channel);
        if let Some(machine) = axis.and_then(Self::of) {
            return Some(machine);
        }
        let PlantSettings { motors, .. } = scenario.plant.as_ref()?;
        let PlantMotor { full_step_deg, microsteps, motor } =
            motors.get(channel).or(motors.last()).cloned().unwrap_or_default();
        let mechanics = axis.map(|axis| axis.mechanics.clone()).filter(|_| motors.is_empty());
        let rotary = || Mechanics::Rotary(Rotary { full_step_deg, microsteps });
        let mechanics = mechanics.filter(|m| m.full_step_deg().is_some()).unwrap_or_else(rotary);
        Self::of(&Axis { mechanics, motor: Some(motor), ..Axis::default() })
    }

    /// Period of the rotor in the field of the regulated current, in s: 2*pi*sqrt(J/(p*k*I)), at least 1 us.
    pub fn natural_period_s(&self) -> f64 {
        let stiffness = self.pole_pairs * self.constant * self.current_a;
        libm::fmax(2.0 * PI * libm::sqrt(self.inertia_kg_m2 / stiffness), MIN_PERIOD_S)
    }

    pub(super) fn microsteps_of_half_a_step(&self) -> usize {
        libm::fmax(1.0, libm::round(PI / (4.0 * self.pole_pairs * self.step_rad))) as usize
    }

    /// The maximum rate in steps/s that the motor's data states.
    pub fn working_rate(&self) -> Option<f64> {
        self.working_rate
    }

    pub fn load_mn_m(&self) -> f64 {
        self.load_n_m * MILLI
    }

    /// In mN*m, at a rate in steps/s. Below 0 the motor brakes at any current, so it cannot stay in step.
    pub fn available_mn_m(&self, rate: f64) -> f64 {
        let speed = libm::fabs(rate) * self.step_rad;
        let back_emf = self.constant * speed;
        let (r, x) = (self.resistance_ohm, self.pole_pairs * speed * self.inductance_h);
        let square = r * r + x * x;
        // The disc of the voltage: around -E/Z = -E*(R - j*X)/|Z|^2.
        let center = (-back_emf * r / square, back_emf * x / square);
        let radius = self.supply_v / libm::sqrt(square);
        MILLI * self.constant * max_real_part(self.current_a, center, radius)
    }

    /// Torque in mN*m that a signed speed and acceleration need; negative if the motor brakes.
    pub fn needed_mn_m(&self, speed: f64, acceleration: f64) -> f64 {
        // From standstill it moves in the direction of the acceleration.
        let ahead = if speed == 0.0 { acceleration } else { speed };
        if ahead == 0.0 {
            return 0.0;
        }
        let turning = self.inertia_kg_m2 * self.step_rad * acceleration * libm::copysign(1.0, ahead);
        MILLI * (turning + self.load_n_m)
    }

    pub(super) fn at(&self, plan: &AxisPlan, at_s: f64) -> Moment {
        self.moment(at_s, plan.speed(at_s), plan.acceleration(at_s))
    }

    pub(super) fn moment(&self, at_s: f64, speed: f64, acceleration: f64) -> Moment {
        Moment {
            at_s,
            rate: libm::fabs(speed),
            needed_mn_m: self.needed_mn_m(speed, acceleration),
            available_mn_m: self.available_mn_m(speed),
        }
    }

    /// Maximum rate in steps/s with the full regulated current; `None` if above 10^7 steps/s.
    pub fn corner_rate(&self) -> Option<f64> {
        highest_rate(|rate| {
            let speed = rate * self.step_rad;
            let real = self.constant * speed + self.resistance_ohm * self.current_a;
            let imaginary = self.pole_pairs * speed * self.inductance_h * self.current_a;
            real * real + imaginary * imaginary <= self.supply_v * self.supply_v
        })
    }

    /// Maximum rate in steps/s with enough torque for the load; 0 for none, `None` if above 10^7 steps/s.
    pub fn torque_rate(&self) -> Option<f64> {
        highest_rate(|rate| self.available_mn_m(rate) >= self.load_mn_m())
    }

    /// f_s of Song 2021: the lower of [`Self::torque_rate`] and [`Self::working_rate`], in steps/s.
    pub fn max_rate(&self) -> Option<f64> {
        match (self.torque_rate(), self.working_rate) {
            (Some(by_torque), Some(stated)) => Some(libm::fmin(by_torque, stated)),
            (by_torque, stated) => by_torque.or(stated),
        }
    }

    /// `points` rates from 0 to `max_rate` with their available torque.
    pub fn curve(&self, max_rate: f64, points: u32) -> impl Iterator<Item = (f64, f64)> + '_ {
        let last = f64::from(points.saturating_sub(1).max(1));
        (0..points).map(move |point| {
            let rate = max_rate * f64::from(point) / last;
            (rate, self.available_mn_m(rate))
        })
    }

    /// The rate up to which to draw a curve, in steps/s.
    pub fn shown_rate(&self, used: f64) -> f64 {
        let corner = self.corner_rate().unwrap_or(0.0);
        let usable = self.max_rate().unwrap_or(0.0);
        let max = libm::fmax(libm::fmax(used, usable), 2.0 * corner);
        libm::fmin(libm::fmax(1.1 * max, 1.0), MAX_SPEED)
    }
}

/// Maximum real part of the intersection of two discs, or of the second's point nearest to the first.
fn max_real_part(own: f64, center: (f64, f64), radius: f64) -> f64 {
    let (re, im) = center;
    let distance = libm::sqrt(re * re + im * im);
    let length = |x: f64, y: f64| libm::sqrt(x * x + y * y);
    if length(own - re, im) <= radius {
        return own;
    }
    if length(re + radius, im) <= own {
        return re + radius;
    }
    if distance > own + radius {
        return re * (1.0 - radius / distance);
    }
    // The intersection of both circles with the larger real part.
    let along = (own * own - radius * radius + distance * distance) / (2.0 * distance);
    let across = libm::sqrt(libm::fmax(own * own - along * along, 0.0));
    (along * re + across * libm::fabs(im)) / distance
}

/// The maximum rate up to which `holds`; 0 for none, `None` for all.
fn highest_rate(holds: impl Fn(f64) -> bool) -> Option<f64> {
    if holds(MAX_SPEED) {
        return None;
    }
    Some(border(0.0, MAX_SPEED, holds).0)
}
