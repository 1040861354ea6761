//! The range of each number of a plant (PLANT F9); [`stability`](crate::stability) has rules that combine several.
//!
//! ```
//! assert!(stepscope_plant::limits::SOURCE_OHM.contains(&0.1));
//! ```

use core::ops::RangeInclusive;

/// Friction, stiction, detent, or the amplitude of a torque.
pub const TORQUE_MN_M: RangeInclusive<f64> = 0.0..=1e6;
/// Gravity; positive to the left.
pub const SIGNED_TORQUE_MN_M: RangeInclusive<f64> = -1e6..=1e6;
pub const VISCOUS_UN_M_S: RangeInclusive<f64> = 0.0..=1e9;
pub const SINE_PER_TURN: RangeInclusive<f64> = 0.001..=1000.0;
pub const SINE_PHASE_DEG: RangeInclusive<f64> = -360.0..=360.0;
pub const COUPLING_N_M_RAD: RangeInclusive<f64> = 0.001..=1e6;
/// Share of the off-time with fast decay.
pub const SHARE: RangeInclusive<f64> = 0.0..=1.0;
/// Off-time and blanking of a chopper.
pub const CHOPPER_US: RangeInclusive<f64> = 0.0..=1e6;
pub const DAC_LEVELS: RangeInclusive<u64> = 1..=1023;
pub const BRIDGE_OHM: RangeInclusive<f64> = 0.0..=10.0;
pub const DIODE_V: RangeInclusive<f64> = 0.0..=2.0;
pub const STEP_CYCLES: RangeInclusive<u64> = 1..=1_000_000;
pub const SOURCE_OHM: RangeInclusive<f64> = 0.001..=100.0;
pub const BUFFER_UF: RangeInclusive<f64> = 10.0..=1e6;
pub const IDLE_MA: RangeInclusive<f64> = 0.0..=1e6;
/// Duration of a run after its last step.
pub const TAIL_S: RangeInclusive<f64> = 0.0..=10.0;
pub const BANDWIDTH_HZ: RangeInclusive<f64> = 0.1..=1e9;
pub const POLES: RangeInclusive<u64> = 1..=3;
/// Grid steps per conversion of a sensor.
pub const PERIOD_STEPS: RangeInclusive<u64> = 1..=1_000_000;
/// Step of a converter in its unit.
pub const LSB: RangeInclusive<f64> = 1e-6..=1000.0;
pub const ADC_MAX: RangeInclusive<u64> = 1..=8_388_607;
/// Offset of an encoder in codes.
pub const OFFSET_LSB: RangeInclusive<f64> = -1e6..=1e6;
/// Noise and play of an encoder in codes.
pub const NOISE_LSB: RangeInclusive<f64> = 0.0..=1e6;
/// Seed of the noise: the integers that a JSON number holds exactly.
pub const SEED: RangeInclusive<u64> = 0..=9_007_199_254_740_991;
pub const THRESHOLD_A: RangeInclusive<f64> = 0.001..=1e4;
/// Consecutive conversions of an overload.
pub const SAMPLES: RangeInclusive<u64> = 1..=1_000_000;
/// Maximum of each number of [`stability`](crate::stability).
pub const STABLE: f64 = 0.25;
