//! Validation of a plant's parameters, with the numbers of each error.

use crate::limits;
use crate::parameters::{CurrentDecay, MotorModel, SensorChain, Setup};
use crate::stability::{self, Criterion};
use alloc::vec::Vec;
use core::{fmt, ops::RangeInclusive};
use stepscope_peripheral::signal::MAX_CHANNELS;

/// Why a [`Setup`] is invalid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// A number is out of its range.
    Range { field: &'static str, given: f64, min: f64, max: f64 },
    /// A criterion of [`stability`](crate::stability) is above 0.25: the grid is too coarse for this motor.
    Unstable { criterion: Criterion, value: f64, step_cycles: u32 },
    /// The source cannot supply the power that the windings need at rest, in W.
    TooWeak { source_ohm: f64, power_w: f64 },
}

/// A refusal and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refused {
    /// Index of the motor; `None` for the whole plant.
    pub channel: Option<usize>,
    pub refusal: Refusal,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(channel) = self.channel {
            write!(f, "motor {channel}: ")?;
        }
        match self.refusal {
            Refusal::Range { field, given, min, max } => {
                write!(f, "{field}: {given} is out of range; use {min} to {max}")
            }
            Refusal::Unstable { criterion, value, step_cycles } => write!(
                f,
                "{} is {value:.3} at grid steps of {step_cycles} cycles, above the maximum of {}; use a smaller \
                 step_cycles, {}",
                criterion.formula(),
                limits::STABLE,
                match criterion {
                    Criterion::Electrical => "or more inductance",
                    Criterion::Rotor => "or more inertia",
                    Criterion::Spring => "more inertia, or a softer coupling",
                    Criterion::Damper => "more inertia, or less damping of the coupling",
                }
            ),
            Refusal::TooWeak { source_ohm, power_w } => write!(
                f,
                "{source_ohm} ohm is too high to supply the {power_w:.1} W of the motors at rest; use a smaller \
                 source_ohm"
            ),
        }
    }
}

impl core::error::Error for Refused {}

/// Checks numbers of a motor, or of the whole plant.
struct Ranges<'a> {
    refused: &'a mut Vec<Refused>,
    channel: Option<usize>,
}

impl Ranges<'_> {
    fn number(&mut self, field: &'static str, given: f64, range: &RangeInclusive<f64>) {
        // NaN is in no range.
        if !range.contains(&given) {
            let (min, max) = (*range.start(), *range.end());
            let refusal = Refusal::Range { field, given, min, max };
            self.refused.push(Refused { channel: self.channel, refusal });
        }
    }

    fn integer(&mut self, field: &'static str, given: u64, range: &RangeInclusive<u64>) {
        self.number(field, given as f64, &(*range.start() as f64..=*range.end() as f64));
    }
}

/// All errors of `setup`, except a weak supply, which [`Supply::new`](crate::supply::Supply::new) detects.
pub(crate) fn validate(setup: &Setup) -> Vec<Refused> {
    let mut refused = Vec::new();
    let mut ranges = Ranges { refused: &mut refused, channel: None };
    ranges.integer("motors", setup.motors.len() as u64, &(1..=MAX_CHANNELS as u64));
    ranges.integer("clock_hz", setup.clock_hz.into(), &(1..=1_000_000_000));
    ranges.integer("step_cycles", setup.grid_cycles().into(), &limits::STEP_CYCLES);
    let supply = &setup.supply;
    ranges.number("supply_v", supply.supply_v, &(0.1..=1000.0));
    ranges.number("source_ohm", supply.source_ohm, &limits::SOURCE_OHM);
    ranges.number("buffer_uf", supply.buffer_uf.unwrap_or(10.0), &limits::BUFFER_UF);
    ranges.number("idle_ma", supply.idle_ma, &limits::IDLE_MA);
    for chain in core::iter::once(&setup.current_sensor).chain(&setup.accelerometer) {
        validate_chain(&mut ranges, chain);
    }
    let encoder = &setup.encoder;
    ranges.integer("encoder.period_steps", encoder.period_steps.into(), &limits::PERIOD_STEPS);
    ranges.number("encoder.offset_lsb", encoder.offset_lsb, &limits::OFFSET_LSB);
    ranges.number("encoder.noise_lsb", encoder.noise_lsb, &limits::NOISE_LSB);
    ranges.number("encoder.hysteresis_lsb", encoder.hysteresis_lsb, &limits::NOISE_LSB);
    if let Some(protection) = &setup.protection {
        ranges.number("protection.threshold_a", protection.threshold_a, &limits::THRESHOLD_A);
        ranges.integer("protection.samples", protection.samples.into(), &limits::SAMPLES);
    }
    for (channel, motor) in setup.motors.iter().enumerate() {
        validate_motor(&mut Ranges { refused: &mut refused, channel: Some(channel) }, motor);
    }
    if refused.is_empty() {
        let (cycles, clock_hz) = (setup.grid_cycles(), f64::from(setup.clock_hz));
        for (channel, motor) in setup.motors.iter().enumerate() {
            let measures = stability::criteria(motor, f64::from(cycles) / clock_hz);
            refused.extend(measures.filter(|&(_, value)| value.is_nan() || value > limits::STABLE).map(
                |(criterion, value)| Refused {
                    channel: Some(channel),
                    refusal: Refusal::Unstable { criterion, value, step_cycles: cycles },
                },
            ));
        }
    }
    refused
}

fn validate_chain(ranges: &mut Ranges<'_>, chain: &SensorChain) {
    ranges.number("current_sensor.bandwidth_hz", chain.bandwidth_hz, &limits::BANDWIDTH_HZ);
    ranges.integer("current_sensor.poles", chain.poles.into(), &limits::POLES);
    ranges.integer("current_sensor.adc_steps", chain.adc_steps.into(), &limits::PERIOD_STEPS);
    ranges.number("current_sensor.lsb_a", chain.lsb, &limits::LSB);
    ranges.integer("current_sensor.adc_max", chain.adc_max.into(), &limits::ADC_MAX);
}

fn validate_motor(ranges: &mut Ranges<'_>, motor: &MotorModel) {
    let above_0 = f64::MIN_POSITIVE..=1e9;
    ranges.number("full_step_deg", motor.full_step_deg, &(0.001..=90.0));
    ranges.integer("microsteps", motor.microsteps.into(), &(1..=512));
    ranges.number("rated_current_a", motor.rated_current_a, &(0.001..=100.0));
    ranges.number("peak_current_a", motor.peak_current_a, &above_0);
    ranges.number("resistance_ohm", motor.resistance_ohm, &(0.001..=1000.0));
    ranges.number("inductance_mh", motor.inductance_mh, &(0.001..=10_000.0));
    let holding = motor.holding_torque_mn_m;
    ranges.number("holding_torque_mn_m", holding, &(0.001..=1e6));
    ranges.number("load_torque_mn_m", motor.load_torque_mn_m, &limits::TORQUE_MN_M);
    ranges.number("friction_mn_m", motor.friction_mn_m, &limits::TORQUE_MN_M);
    let stiction = motor.stiction_mn_m.unwrap_or(motor.friction_mn_m);
    ranges.number("stiction_mn_m", stiction, &(motor.friction_mn_m..=*limits::TORQUE_MN_M.end()));
    ranges.number("viscous_un_m_s", motor.viscous_un_m_s, &limits::VISCOUS_UN_M_S);
    ranges.number("detent_torque_mn_m", motor.detent_torque_mn_m, &(0.0..=0.5 * holding));
    ranges.number("gravity_torque_mn_m", motor.gravity_torque_mn_m, &limits::SIGNED_TORQUE_MN_M);
    ranges.number("sine_torque_mn_m", motor.sine_torque_mn_m, &limits::TORQUE_MN_M);
    ranges.number("sine_per_turn", motor.sine_per_turn, &limits::SINE_PER_TURN);
    ranges.number("sine_phase_deg", motor.sine_phase_deg, &limits::SINE_PHASE_DEG);
    // A coupling separates two masses, and each must be positive.
    let coupled = motor.coupling_n_m_rad.is_some();
    let (rotor, load) = (motor.rotor_inertia_g_cm2, motor.load_inertia_g_cm2);
    ranges.number("rotor_inertia_g_cm2", rotor, if coupled || load <= 0.0 { &above_0 } else { &(0.0..=1e9) });
    ranges.number("load_inertia_g_cm2", load, if coupled { &above_0 } else { &(0.0..=1e9) });
    ranges.number("coupling_n_m_rad", motor.coupling_n_m_rad.unwrap_or(1.0), &limits::COUPLING_N_M_RAD);
    ranges.number("coupling_un_m_s", motor.coupling_un_m_s, &limits::VISCOUS_UN_M_S);
    let drive = &motor.drive;
    ranges.number("drive.off_us", drive.off_us, &limits::CHOPPER_US);
    ranges.number("drive.blank_us", drive.blank_us, &limits::CHOPPER_US);
    ranges.integer("drive.dac_levels", drive.dac_levels.unwrap_or(1).into(), &limits::DAC_LEVELS);
    ranges.number("drive.bridge_ohm", drive.bridge_ohm, &limits::BRIDGE_OHM);
    ranges.number("drive.diode_v", drive.diode_v, &limits::DIODE_V);
    if let CurrentDecay::Mixed(share) | CurrentDecay::Auto(share) = drive.decay {
        ranges.number("drive.decay.share", share, &limits::SHARE);
    }
}
