//! F6 and F7's sensors: low passes, ADC, encoder, overload protection.

use super::numbers::{SplitMix64, exp_of_minus, nearest};
use super::parameters::{CurrentSensor, Encoder, Protection};

/// cf = 1 - exp(-2*pi*bandwidth_hz*h) (F6).
pub fn low_pass_factor(bandwidth_hz: f64, h: f64) -> f64 {
    // Reading: pi is the nearest f64, so that 2*pi is exactly twice it; from left to right.
    1.0 - exp_of_minus(2.0 * std::f64::consts::PI * bandwidth_hz * h)
}

/// A chain of equal low passes with an ADC.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sensor {
    factor: f64,
    poles: Vec<f64>,
    lsb: f64,
    adc_max: f64,
    pub(super) adc_steps: u64,
}

impl Sensor {
    /// In the steady state at `start`.
    pub(super) fn new(sensor: &CurrentSensor, h: f64, start: f64) -> Self {
        Self {
            factor: low_pass_factor(sensor.bandwidth_hz, h),
            poles: vec![start; sensor.poles],
            lsb: sensor.lsb_a,
            adc_max: f64::from(sensor.adc_max),
            adc_steps: sensor.adc_steps,
        }
    }

    /// Processes the input of one grid step. Reading: the input of a pole is the new output of the previous pole.
    pub(super) fn advance(&mut self, input: f64) {
        let mut input = input;
        for s in &mut self.poles {
            *s += (input - *s) * self.factor;
            input = *s;
        }
    }

    /// Output of the last pole.
    pub(super) fn value(&self) -> f64 {
        self.poles[self.poles.len() - 1]
    }

    /// The ADC's code.
    pub(super) fn code(&self) -> i64 {
        let mut code = nearest(self.value() / self.lsb);
        if code > self.adc_max {
            code = self.adc_max;
        }
        if code < -self.adc_max {
            code = -self.adc_max;
        }
        code as i64
    }
}

/// An AS5600.
#[derive(Debug, Clone)]
pub(super) struct EncoderState {
    encoder: Encoder,
    turn: f64,
    out: f64,
    noise: SplitMix64,
}

impl EncoderState {
    pub(super) fn new(encoder: &Encoder, channel: usize, full_step_deg: f64) -> Self {
        let noise = SplitMix64(encoder.seed ^ (channel as u64 + 1).wrapping_mul(SplitMix64::GAMMA));
        Self { encoder: encoder.clone(), turn: full_step_deg / 360.0, out: 0.0, noise }
    }

    /// The code at one of its points. Reading: U is drawn first, then U'; both for each code, even without noise.
    pub(super) fn code(&mut self, x: f64) -> u16 {
        let u = self.noise.unit();
        let u_too = self.noise.unit();
        let value = x * self.turn * 4096.0 + self.encoder.offset_lsb + self.encoder.noise_lsb * (u - u_too);
        // Reading: the play moves `out`: to value - play if the value is above out + play, and likewise below.
        let play = self.encoder.hysteresis_lsb;
        if value > self.out + play {
            self.out = value - play;
        } else if value < self.out - play {
            self.out = value + play;
        }
        (self.out.floor() as i64).rem_euclid(4096) as u16
    }
}

/// F7's protection.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Watch {
    protection: Protection,
    in_a_row: u32,
    /// The first cycle in which it reports OVERLOAD.
    pub(super) tripped: Option<u64>,
}

impl Watch {
    pub(super) fn new(protection: &Protection) -> Self {
        Self { protection: protection.clone(), in_a_row: 0, tripped: None }
    }

    /// An ADC value at a grid point in `cycle`.
    pub(super) fn sample(&mut self, cycle: u64, code: i64, lsb_a: f64) {
        if code as f64 * lsb_a >= self.protection.threshold_a {
            self.in_a_row += 1;
        } else {
            self.in_a_row = 0;
        }
        if self.in_a_row >= self.protection.samples && self.tripped.is_none() {
            self.tripped = Some(cycle);
        }
    }

    /// "ENABLE begins the count anew."
    pub(super) fn enabled(&mut self) {
        self.in_a_row = 0;
    }
}
