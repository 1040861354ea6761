//! The range of each number of a plant (F9); rules that join several stand in [`stability`](crate::stability).
//!
//! ```
//! assert!(stepscope_plant::limits::SOURCE_OHM.contains(&0.1));
//! ```

use core::ops::RangeInclusive;

/// A friction, stiction, gravity's amount or amplitude in mN*m.
pub const TORQUE_MN_M: RangeInclusive<f64> = 0.0..=1e6;
/// A torque with a sign in mN*m.
pub const SIGNED_TORQUE_MN_M: RangeInclusive<f64> = -1e6..=1e6;
/// A viscous friction or damping in uN*m*s.
pub const VISCOUS_UN_M_S: RangeInclusive<f64> = 0.0..=1e9;
/// Periods of a torque in a turn.
pub const SINE_PER_TURN: RangeInclusive<f64> = 0.001..=1000.0;
/// A phase in degrees.
pub const SINE_PHASE_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// Stiffness of a coupling in N*m/rad.
pub const COUPLING_N_M_RAD: RangeInclusive<f64> = 0.001..=1e6;
/// The share of an off-time that decays fast.
pub const SHARE: RangeInclusive<f64> = 0.0..=1.0;
/// Off-time and blanking of a chopper in us.
pub const CHOPPER_US: RangeInclusive<f64> = 0.0..=1e6;
/// Steps of the converter of a driver.
pub const DAC_LEVELS: RangeInclusive<u64> = 1..=1023;
/// Resistance of a bridge in ohm.
pub const BRIDGE_OHM: RangeInclusive<f64> = 0.0..=10.0;
/// Forward voltage of a diode in V.
pub const DIODE_V: RangeInclusive<f64> = 0.0..=2.0;
/// Cycles of a grid step.
pub const STEP_CYCLES: RangeInclusive<u64> = 1..=1_000_000;
/// Resistance of the source in ohm.
pub const SOURCE_OHM: RangeInclusive<f64> = 0.001..=100.0;
/// Capacitance of the buffer in uF.
pub const BUFFER_UF: RangeInclusive<f64> = 10.0..=1e6;
/// Current of a driver for itself in mA.
pub const IDLE_MA: RangeInclusive<f64> = 0.0..=1e6;
/// Time that a run goes on after its last step, in s.
pub const TAIL_S: RangeInclusive<f64> = 0.0..=10.0;
/// Bandwidth of a sensor in Hz.
pub const BANDWIDTH_HZ: RangeInclusive<f64> = 0.1..=1e9;
/// Low passes of a sensor.
pub const POLES: RangeInclusive<u64> = 1..=3;
/// Grid steps from conversion to conversion, or from code to code.
pub const PERIOD_STEPS: RangeInclusive<u64> = 1..=1_000_000;
/// Step of a converter.
pub const LSB: RangeInclusive<f64> = 1e-6..=1000.0;
/// Maximum code of a converter.
pub const ADC_MAX: RangeInclusive<u64> = 1..=8_388_607;
/// Offset of an encoder in codes.
pub const OFFSET_LSB: RangeInclusive<f64> = -1e6..=1e6;
/// Noise and play of an encoder in codes.
pub const NOISE_LSB: RangeInclusive<f64> = 0.0..=1e6;
/// Seed of the noise: what a JSON number holds exactly.
pub const SEED: RangeInclusive<u64> = 0..=9_007_199_254_740_991;
/// Current of an overload in A.
pub const THRESHOLD_A: RangeInclusive<f64> = 0.001..=1e4;
/// Conversions in a row that are one.
pub const SAMPLES: RangeInclusive<u64> = 1..=1_000_000;
/// Most that each of the numbers of [`stability`](crate::stability) may be.
pub const STABLE: f64 = 0.25;
