//! Sensors: low-pass filters and converters of current and acceleration, and encoders (PLANT F6).

use crate::motor_constants::TURN;
use crate::parameters::{self, SensorChain};
use crate::sincos::{nearest, one_minus_exp};
use alloc::vec::Vec;

/// Low-pass filters and a converter behind a sensor.
#[derive(Clone, Debug)]
pub struct SignalChain {
    poles: Vec<f64>,
    /// Share by which an output approaches its input in a grid step.
    factor: f64,
    adc_steps: u32,
    /// Grid steps until the next conversion.
    wait: u32,
    lsb: f64,
    adc_max: f64,
    code: i32,
}

impl SignalChain {
    /// A chain in steady state at the input `steady`, on a grid of `h` seconds.
    pub(crate) fn new(chain: &SensorChain, h: f64, steady: f64) -> Self {
        let mut new = Self {
            poles: alloc::vec![steady; usize::from(chain.poles)],
            factor: one_minus_exp(TURN * chain.bandwidth_hz * h),
            adc_steps: chain.adc_steps,
            wait: chain.adc_steps,
            lsb: chain.lsb,
            adc_max: f64::from(chain.adc_max),
            code: 0,
        };
        new.code = new.convert();
        new
    }

    /// Runs one grid step; returns whether a conversion was made.
    pub(crate) fn advance(&mut self, input: f64) -> bool {
        let mut input = input;
        for s in &mut self.poles {
            *s += (input - *s) * self.factor;
            input = *s;
        }
        self.wait -= 1;
        let converts = self.wait == 0;
        if converts {
            self.wait = self.adc_steps;
            self.code = self.convert();
        }
        converts
    }

    fn convert(&self) -> i32 {
        nearest(self.filtered() / self.lsb).clamp(-self.adc_max, self.adc_max) as i32
    }

    /// Output of the last filter.
    pub fn filtered(&self) -> f64 {
        self.poles.last().copied().unwrap_or(0.0)
    }

    /// Code of the latest conversion.
    pub const fn code(&self) -> i32 {
        self.code
    }

    /// Value of the latest conversion.
    pub fn reading(&self) -> f64 {
        f64::from(self.code) * self.lsb
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Encoder {
    turns_per_step: f64,
    offset: f64,
    noise: f64,
    hysteresis: f64,
    random: SplitMix64,
    /// Angle in codes, after the play.
    out: f64,
    pub(crate) code: u16,
}

impl Encoder {
    pub(crate) fn new(encoder: &parameters::Encoder, channel: u64, full_step_deg: f64) -> Self {
        let seed = encoder.seed ^ (channel + 1).wrapping_mul(SplitMix64::STEP);
        Self {
            turns_per_step: full_step_deg / 360.0,
            offset: encoder.offset_lsb,
            noise: encoder.noise_lsb,
            hysteresis: encoder.hysteresis_lsb,
            random: SplitMix64(seed),
            out: 0.0,
            code: 0,
        }
    }

    pub(crate) fn read(&mut self, x: f64) {
        let noise = self.noise * (self.random.next() - self.random.next());
        let input = x * self.turns_per_step * 4096.0 + self.offset + noise;
        if input > self.out + self.hysteresis {
            self.out = input - self.hysteresis;
        } else if input < self.out - self.hysteresis {
            self.out = input + self.hysteresis;
        }
        self.code = floor(self.out).rem_euclid(4096) as u16;
    }
}

fn floor(x: f64) -> i64 {
    let whole = x as i64;
    whole - i64::from(whole as f64 > x)
}

#[derive(Clone, Debug)]
struct SplitMix64(u64);

impl SplitMix64 {
    const STEP: u64 = 0x9e37_79b9_7f4a_7c15;

    /// The top 53 bits of the next value, as a fraction of 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(Self::STEP);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splitmix64_gives_its_published_values() {
        // Of seed 1234567: 6457827717110365317, 3203168211198807973.
        let mut random = SplitMix64(1_234_567);
        let expected = [6_457_827_717_110_365_317_u64, 3_203_168_211_198_807_973];
        for value in expected {
            assert_eq!(random.next(), (value >> 11) as f64 / (1_u64 << 53) as f64);
        }
    }

    #[test]
    fn an_encoder_has_play_and_wraps_after_one_turn() {
        let given = parameters::Encoder { hysteresis_lsb: 2.0, ..parameters::Encoder::default() };
        let mut encoder = Encoder::new(&given, 0, 1.8);
        let step = 4096.0 / 200.0;
        for (x, expected) in
            [(1.0, 18), (0.85, 18), (0.5, 12), (0.55, 12), (-1.0, 4077), (200.0, 4094), (201.0, 18)]
        {
            encoder.read(x);
            assert_eq!(encoder.code, expected, "{x}: {}", x * step);
        }
    }

    #[test]
    fn a_chain_settles_at_its_input_and_its_code_saturates() {
        let given = SensorChain { poles: 2, adc_steps: 3, adc_max: 50, ..SensorChain::default() };
        let mut chain = SignalChain::new(&given, 5e-6, 0.5);
        assert_eq!((chain.code(), chain.filtered()), (20, 0.5));
        let converts: Vec<bool> = (0..6).map(|_| chain.advance(0.5)).collect();
        assert_eq!(converts, [false, false, true, false, false, true]);
        for _ in 0..9000 {
            chain.advance(-3.0);
        }
        assert!((chain.filtered() + 3.0).abs() < 1e-9);
        assert_eq!(chain.code(), -50);
    }
}
