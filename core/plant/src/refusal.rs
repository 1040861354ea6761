//! Validation of a plant's parameters, with the numbers of each error.

use crate::{
    limits,
    parameters::{CurrentDecay, MotorModel, SensorChain, Setup},
    stability::{self, Measure},
};
use alloc::vec::Vec;
use core::{fmt, ops::RangeInclusive};
use stepscope_peripheral::signal::MAX_CHANNELS;

/// Why a [`Setup`] is no valid plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// A number is out of its range.
    Range { field: &'static str, given: f64, least: f64, greatest: f64 },
    /// A number of [`stability`](crate::stability) is above 0.25: the grid is too coarse for this motor.
    Unstable {
        measure: Measure,
        /// Its value at a whole grid step.
        value: f64,
        step_cycles: u32,
    },
    /// The source cannot supply the motors at rest.
    TooWeak {
        source_ohm: f64,
        /// Power of the windings at rest in W.
        power_w: f64,
    },
}

/// A refusal and its motor; `None` for the whole plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refused {
    pub channel: Option<usize>,
    pub refusal: Refusal,
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(channel) = self.channel {
            write!(f, "motor {channel}: ")?;
        }
        match self.refusal {
            Refusal::Range { field, given, least, greatest } => {
                write!(f, "{field}: {given} is out of range; give {least} to {greatest}")
            }
            Refusal::Unstable { measure, value, step_cycles } => write!(
                f,
                "{} is {value:.3} at grid steps of {step_cycles} cycles; at most {} is exact enough: give a \
                 smaller step_cycles, or {}",
                measure.formula(),
                limits::STABLE,
                match measure {
                    Measure::Electrical => "more inductance",
                    Measure::Rotor => "more inertia",
                    Measure::Spring => "more inertia or a softer coupling",
                    Measure::Damper => "more inertia or less damping of the coupling",
                }
            ),
            Refusal::TooWeak { source_ohm, power_w } => write!(
                f,
                "through {source_ohm} ohm the supply cannot give the {power_w:.1} W that the motors take \
                 at rest; give a smaller source_ohm"
            ),
        }
    }
}

impl core::error::Error for Refused {}

struct Ranges<'a>(&'a mut Vec<Refused>, Option<usize>);

impl Ranges<'_> {
    fn number(&mut self, field: &'static str, given: f64, range: &RangeInclusive<f64>) {
        // NaN is in no range.
        if !range.contains(&given) {
            let (least, greatest) = (*range.start(), *range.end());
            let refusal = Refusal::Range { field, given, least, greatest };
            self.0.push(Refused { channel: self.1, refusal });
        }
    }

    fn whole(&mut self, field: &'static str, given: u64, range: &RangeInclusive<u64>) {
        self.number(field, given as f64, &(*range.start() as f64..=*range.end() as f64));
    }
}

/// All errors of `setup` but a supply that is too weak, which only the first point shows.
pub(crate) fn validate(setup: &Setup) -> Vec<Refused> {
    let mut refused = Vec::new();
    let mut whole = Ranges(&mut refused, None);
    whole.whole("motors", setup.motors.len() as u64, &(1..=MAX_CHANNELS as u64));
    whole.whole("clock_hz", setup.clock_hz.into(), &(1..=1_000_000_000));
    whole.whole("step_cycles", setup.grid_cycles().into(), &limits::STEP_CYCLES);
    let supply = &setup.supply;
    whole.number("supply_v", supply.supply_v, &(0.1..=1000.0));
    whole.number("source_ohm", supply.source_ohm, &limits::SOURCE_OHM);
    whole.number("buffer_uf", supply.buffer_uf.unwrap_or(10.0), &limits::BUFFER_UF);
    whole.number("idle_ma", supply.idle_ma, &limits::IDLE_MA);
    for chain in core::iter::once(&setup.current_sensor).chain(&setup.accelerometer) {
        validate_chain(&mut whole, chain);
    }
    let encoder = &setup.encoder;
    whole.whole("encoder.period_steps", encoder.period_steps.into(), &limits::PERIOD_STEPS);
    whole.number("encoder.offset_lsb", encoder.offset_lsb, &limits::OFFSET_LSB);
    whole.number("encoder.noise_lsb", encoder.noise_lsb, &limits::NOISE_LSB);
    whole.number("encoder.hysteresis_lsb", encoder.hysteresis_lsb, &limits::NOISE_LSB);
    if let Some(protection) = &setup.protection {
        whole.number("protection.threshold_a", protection.threshold_a, &limits::THRESHOLD_A);
        whole.whole("protection.samples", protection.samples.into(), &limits::SAMPLES);
    }
    for (channel, motor) in setup.motors.iter().enumerate() {
        validate_motor(&mut Ranges(&mut refused, Some(channel)), motor);
    }
    if refused.is_empty() {
        let (cycles, clock_hz) = (setup.grid_cycles(), f64::from(setup.clock_hz));
        for (channel, motor) in setup.motors.iter().enumerate() {
            let measures = stability::measures(motor, f64::from(cycles) / clock_hz);
            refused.extend(measures.filter(|&(_, value)| value.is_nan() || value > limits::STABLE).map(
                |(measure, value)| Refused {
                    channel: Some(channel),
                    refusal: Refusal::Unstable { measure, value, step_cycles: cycles },
                },
            ));
        }
    }
    refused
}

fn validate_chain(ranges: &mut Ranges<'_>, chain: &SensorChain) {
    ranges.number("current_sensor.bandwidth_hz", chain.bandwidth_hz, &limits::BANDWIDTH_HZ);
    ranges.whole("current_sensor.poles", chain.poles.into(), &limits::POLES);
    ranges.whole("current_sensor.adc_steps", chain.adc_steps.into(), &limits::PERIOD_STEPS);
    ranges.number("current_sensor.lsb_a", chain.lsb, &limits::LSB);
    ranges.whole("current_sensor.adc_max", chain.adc_max.into(), &limits::ADC_MAX);
}

fn validate_motor(ranges: &mut Ranges<'_>, motor: &MotorModel) {
    let above_0 = f64::MIN_POSITIVE..=1e9;
    ranges.number("full_step_deg", motor.full_step_deg, &(0.001..=90.0));
    ranges.whole("microsteps", motor.microsteps.into(), &(1..=512));
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
    ranges.whole("drive.dac_levels", drive.dac_levels.unwrap_or(1).into(), &limits::DAC_LEVELS);
    ranges.number("drive.bridge_ohm", drive.bridge_ohm, &limits::BRIDGE_OHM);
    ranges.number("drive.diode_v", drive.diode_v, &limits::DIODE_V);
    if let CurrentDecay::Mixed(share) | CurrentDecay::Auto(share) = drive.decay {
        ranges.number("drive.decay.share", share, &limits::SHARE);
    }
}
