//! The parameters of a plant: motors with loads and drivers, supply, sensors (PLANT F9). [`limits`](crate::limits) has their
//! ranges. Torques and inertias are seen from the rotor's shaft.
//!
//! ```
//! use stepscope_plant::{Plant, parameters::{DriverModel, MotorModel, CurrentControl, Setup}};
//!
//! let drive = DriverModel { regulator: CurrentControl::Chopper, ..DriverModel::default() };
//! let setup = Setup { motors: vec![MotorModel { microsteps: 1, drive, ..MotorModel::default() }], ..Setup::default() };
//! let plant = Plant::new(&setup).expect("a valid setup");
//! assert_eq!(plant.step_cycles(), 16, "a grid step is 1 us with a chopper");
//! ```

use alloc::vec::Vec;
use stepscope_peripheral::parameters;

/// How a driver regulates the current of a phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CurrentControl {
    /// The mean of an ideal chopper.
    #[default]
    Averaged,
    /// A chopper with fixed off-time that switches at grid points.
    Chopper,
}

/// How fast the current of a phase decays while it is off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CurrentDecay {
    /// The phase is short-circuited.
    Slow,
    /// The bus voltage drives the current back.
    #[default]
    Fast,
    /// Fast for this share of the off-time, 0..=1, then slow.
    Mixed(f64),
    /// Like `Mixed` after a step that lowered the target current, else slow.
    Auto(f64),
}

impl CurrentDecay {
    /// The fast share before the first step, 0..=1.
    pub const fn first_share(self) -> f64 {
        match self {
            Self::Slow => 0.0,
            Self::Fast => 1.0,
            Self::Mixed(share) | Self::Auto(share) => share,
        }
    }
}

parameters! { (Clone, Debug, PartialEq)
    /// The driver of a motor.
    pub struct DriverModel {
        pub regulator: CurrentControl = CurrentControl::Averaged,
        pub decay: CurrentDecay = CurrentDecay::Fast,
        pub off_us: f64 = 20.0,
        /// Minimum on-time of a chopper.
        pub blank_us: f64 = 1.0,
        /// Steps of the digital-to-analog converter from 0 to the peak current; `None` for an ideal one.
        pub dac_levels: Option<u16> = None,
        pub bridge_ohm: f64 = 0.0,
        /// Forward voltage of one diode of the bridge.
        pub diode_v: f64 = 0.7,
    }

    /// A two-phase hybrid stepper motor with its load and driver. The defaults are the same as in a scenario.
    pub struct MotorModel {
        pub full_step_deg: f64 = 1.8,
        pub microsteps: u16 = 16,
        /// Rated current of a phase, both phases on.
        pub rated_current_a: f64 = 1.5,
        pub peak_current_a: f64 = 1.5,
        pub resistance_ohm: f64 = 1.6,
        pub inductance_mh: f64 = 4.3,
        /// With both phases at the rated current.
        pub holding_torque_mn_m: f64 = 400.0,
        pub rotor_inertia_g_cm2: f64 = 45.0,
        pub load_inertia_g_cm2: f64 = 0.0,
        pub load_torque_mn_m: f64 = 0.0,
        pub friction_mn_m: f64 = 5.0,
        /// Breakaway torque; `None` for the friction.
        pub stiction_mn_m: Option<f64> = None,
        pub viscous_un_m_s: f64 = 300.0,
        pub detent_torque_mn_m: f64 = 0.0,
        pub gravity_torque_mn_m: f64 = 0.0,
        /// Amplitude of a torque that depends on the angle of the load.
        pub sine_torque_mn_m: f64 = 0.0,
        pub sine_per_turn: f64 = 1.0,
        pub sine_phase_deg: f64 = 0.0,
        /// Stiffness of the coupling in N*m/rad; without it rotor and load are one mass.
        pub coupling_n_m_rad: Option<f64> = None,
        pub coupling_un_m_s: f64 = 0.0,
        pub drive: DriverModel = DriverModel::default(),
    }

    /// The supply of all motors of a plant.
    pub struct Supply {
        pub supply_v: f64 = 24.0,
        /// Resistance of the source; has an effect only with a buffer.
        pub source_ohm: f64 = 0.1,
        /// Capacitance at the drivers; without it the bus has the source voltage.
        pub buffer_uf: Option<f64> = None,
        /// Whether the source accepts reverse current.
        pub source_sinks: bool = false,
        pub idle_ma: f64 = 0.0,
    }

    /// Low-pass filters and a converter behind a sensor.
    pub struct SensorChain {
        pub bandwidth_hz: f64 = 3000.0,
        pub poles: u8 = 1,
        pub adc_steps: u32 = 1,
        /// Value of one step of the converter.
        pub lsb: f64 = 0.024_414_062_5,
        /// Maximum code; the minimum is its negative.
        pub adc_max: u32 = 2047,
    }

    /// The encoder on each rotor: 4096 codes per turn, like the AS5600.
    pub struct Encoder {
        pub period_steps: u32 = 1000,
        /// Added to the angle, in codes.
        pub offset_lsb: f64 = 0.0,
        pub noise_lsb: f64 = 0.0,
        /// Half of the play in codes.
        pub hysteresis_lsb: f64 = 0.0,
        pub seed: u64 = 0,
    }

    /// When the current sensor reports an overload.
    pub struct Protection {
        pub threshold_a: f64 = 2.0,
        /// Consecutive conversions at or above the threshold.
        pub samples: u32 = 4,
    }

    /// A whole plant: the motors on the bus of one controller.
    pub struct Setup {
        pub clock_hz: u32 = 16_000_000,
        /// Cycles per grid step; `None` for 5 us, or 1 us with a chopper.
        pub step_cycles: Option<u32> = None,
        pub supply: Supply = Supply::default(),
        /// The sensor of the supply current, in A.
        pub current_sensor: SensorChain = SensorChain::default(),
        pub encoder: Encoder = Encoder::default(),
        /// An accelerometer on each load, in rad/s^2; `None` for none.
        pub accelerometer: Option<SensorChain> = None,
        pub protection: Option<Protection> = None,
        pub motors: Vec<MotorModel> = Vec::new(),
    }
}

impl Setup {
    /// Cycles per grid step: `step_cycles`, or 5 us, or 1 us with a chopper, at least one.
    pub fn grid_cycles(&self) -> u32 {
        let chops = self.motors.iter().any(|motor| motor.drive.regulator == CurrentControl::Chopper);
        let per_second = if chops { 1_000_000 } else { 200_000 };
        self.step_cycles.unwrap_or((self.clock_hz / per_second).max(1))
    }

    /// The motor of one channel by itself on this supply, without overload protection, for searches; `None` without it.
    pub fn single_motor(&self, channel: usize) -> Option<Self> {
        let motor = self.motors.get(channel)?.clone();
        Some(Self { motors: alloc::vec![motor], protection: None, ..self.clone() })
    }
}

impl MotorModel {
    /// Steps per turn, rounded.
    pub fn steps_per_turn(&self) -> u64 {
        (360.0 / self.full_step_deg * f64::from(self.microsteps) + 0.5) as u64
    }
}
