//! What a plant is made of: motors with their loads and drivers, the supply, the sensors (F9).
//!
//! Units are in the names; torques and inertias are seen from the rotor's shaft. [`limits`](crate::limits) has the range
//! of each number.
//!
//! ```
//! use stepscope_plant::{Plant, parameters::{DriverModel, MotorModel, CurrentControl, Setup}};
//!
//! let drive = DriverModel { regulator: CurrentControl::Chopper, ..DriverModel::default() };
//! let setup = Setup { motors: vec![MotorModel { microsteps: 1, drive, ..MotorModel::default() }], ..Setup::default() };
//! let plant = Plant::new(&setup).expect("it holds");
//! assert_eq!(plant.step_cycles(), 16, "a grid step is a microsecond where a driver chops");
//! ```

use alloc::vec::Vec;

/// Declares a struct with public fields, each with its default.
macro_rules! parameters {
    ($($(#[$meta:meta])* pub struct $name:ident {
        $($(#[$field_meta:meta])* pub $field:ident: $ty:ty = $default:expr,)*
    })*) => {$(
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name {
            $($(#[$field_meta])* pub $field: $ty,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }
    )*};
}

/// How the driver holds the phase currents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CurrentControl {
    /// The mean of an ideal chopper.
    #[default]
    Averaged,
    /// Fixed off-time, decided at grid points.
    Chopper,
}

/// How fast a current decays while its phase is off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum CurrentDecay {
    /// The phase is short-circuited.
    Slow,
    /// The supply works against the current.
    #[default]
    Fast,
    /// Fast for this share of the off-time, 0..=1, then slow.
    Mixed(f64),
    /// As `Mixed` where the current's target fell at the last step, slow where it rose.
    Auto(f64),
}

impl CurrentDecay {
    /// The share that is fast before the first step, 0..=1.
    #[must_use]
    pub const fn first_share(self) -> f64 {
        match self {
            Self::Slow => 0.0,
            Self::Fast => 1.0,
            Self::Mixed(share) | Self::Auto(share) => share,
        }
    }
}

parameters! {
    /// The driver of one motor.
    pub struct DriverModel {
        /// How it holds the currents.
        pub regulator: CurrentControl = CurrentControl::Averaged,
        /// How they decay.
        pub decay: CurrentDecay = CurrentDecay::Fast,
        /// Off-time of a chopper in us.
        pub off_us: f64 = 20.0,
        /// Minimum on-time of a chopper in us.
        pub blank_us: f64 = 1.0,
        /// Steps of the digital-to-analogue converter from 0 to the peak current; without it they are as fine as f64.
        pub dac_levels: Option<u16> = None,
        /// Resistance of the bridge in series with a phase, in ohm.
        pub bridge_ohm: f64 = 0.0,
        /// Forward voltage of one of the bridge's diodes in V.
        pub diode_v: f64 = 0.7,
    }

    /// A two-phase hybrid stepping motor, what turns with it, and its driver. The defaults are those of a scenario.
    pub struct MotorModel {
        /// Full step in degrees.
        pub full_step_deg: f64 = 1.8,
        /// Microsteps in a full step.
        pub microsteps: u16 = 16,
        /// Rated current of a phase in A, both phases on.
        pub rated_current_a: f64 = 1.5,
        /// Peak of the phase current that the driver holds, in A.
        pub peak_current_a: f64 = 1.5,
        /// Resistance of a phase in ohm.
        pub resistance_ohm: f64 = 1.6,
        /// Inductance of a phase in mH.
        pub inductance_mh: f64 = 4.3,
        /// Holding torque in mN*m, both phases at the rated current.
        pub holding_torque_mn_m: f64 = 400.0,
        /// Inertia of the rotor in g*cm^2.
        pub rotor_inertia_g_cm2: f64 = 45.0,
        /// Inertia of the load in g*cm^2.
        pub load_inertia_g_cm2: f64 = 0.0,
        /// Coulomb friction of the load in mN*m.
        pub load_torque_mn_m: f64 = 0.0,
        /// Coulomb friction of the rotor in mN*m.
        pub friction_mn_m: f64 = 5.0,
        /// What has to be overcome at rest, in mN*m; without it the friction.
        pub stiction_mn_m: Option<f64> = None,
        /// Viscous friction in uN*m*s.
        pub viscous_un_m_s: f64 = 300.0,
        /// Amplitude of the detent torque in mN*m.
        pub detent_torque_mn_m: f64 = 0.0,
        /// A constant torque to the left in mN*m.
        pub gravity_torque_mn_m: f64 = 0.0,
        /// Amplitude of a torque that goes round with the load, in mN*m.
        pub sine_torque_mn_m: f64 = 0.0,
        /// Its periods in a turn of the load.
        pub sine_per_turn: f64 = 1.0,
        /// Its phase in degrees.
        pub sine_phase_deg: f64 = 0.0,
        /// Stiffness of the coupling in N*m/rad; without it rotor and load are one mass.
        pub coupling_n_m_rad: Option<f64> = None,
        /// Damping of the coupling in uN*m*s.
        pub coupling_un_m_s: f64 = 0.0,
        /// Its driver.
        pub drive: DriverModel = DriverModel::default(),
    }

    /// The supply of all motors of a plant.
    pub struct Supply {
        /// Voltage of the source in V.
        pub supply_v: f64 = 24.0,
        /// Resistance of the source in ohm; of effect with a buffer only.
        pub source_ohm: f64 = 0.1,
        /// Capacitance at the drivers in uF; without it the bus has the source's voltage.
        pub buffer_uf: Option<f64> = None,
        /// Whether the source takes current back.
        pub source_sinks: bool = false,
        /// Current that each driver draws for itself, in mA.
        pub idle_ma: f64 = 0.0,
    }

    /// Low passes and a converter behind a sensor.
    pub struct SensorChain {
        /// Bandwidth of each low pass in Hz.
        pub bandwidth_hz: f64 = 3000.0,
        /// How many low passes.
        pub poles: u8 = 1,
        /// Grid steps from conversion to conversion.
        pub adc_steps: u32 = 1,
        /// What one step of the converter stands for.
        pub lsb: f64 = 0.024_414_062_5,
        /// Its maximum code; the least is its negative.
        pub adc_max: u32 = 2047,
    }

    /// The encoder on each rotor: 4096 codes a turn, as the AS5600.
    pub struct Encoder {
        /// Grid steps from code to code.
        pub period_steps: u32 = 1000,
        /// Added to the angle, in codes.
        pub offset_lsb: f64 = 0.0,
        /// Maximum noise in codes.
        pub noise_lsb: f64 = 0.0,
        /// Half of the play in codes.
        pub hysteresis_lsb: f64 = 0.0,
        /// Seed of the noise.
        pub seed: u64 = 0,
    }

    /// When the current sensor reports an overload.
    pub struct Protection {
        /// From this current on, in A.
        pub threshold_a: f64 = 2.0,
        /// So many conversions in a row.
        pub samples: u32 = 4,
    }

    /// A whole plant: the motors behind the bus of one controller.
    pub struct Setup {
        /// Cycles a second.
        pub clock_hz: u32 = 16_000_000,
        /// Cycles of a grid step; without it 5 us, where a driver chops 1 us.
        pub step_cycles: Option<u32> = None,
        /// The supply.
        pub supply: Supply = Supply::default(),
        /// The sensor of the supply current, in A.
        pub current_sensor: SensorChain = SensorChain::default(),
        /// The encoders.
        pub encoder: Encoder = Encoder::default(),
        /// An accelerometer on each load, in rad/s^2; without it there is none.
        pub accelerometer: Option<SensorChain> = None,
        /// The protection against overload, where there is one.
        pub protection: Option<Protection> = None,
        /// The motor of channel 0, 1, ….
        pub motors: Vec<MotorModel> = Vec::new(),
    }
}

impl Setup {
    /// Cycles of a grid step: `step_cycles`, or 5 us, where a driver chops 1 us, at least one.
    #[must_use]
    pub fn grid_cycles(&self) -> u32 {
        let chops = self.motors.iter().any(|motor| motor.drive.regulator == CurrentControl::Chopper);
        let a_second = if chops { 1_000_000 } else { 200_000 };
        self.step_cycles.unwrap_or((self.clock_hz / a_second).max(1))
    }

    /// The motor of one channel alone on this supply, with nothing that stops it: what searches look at.
    #[must_use]
    pub fn alone(&self, channel: usize) -> Option<Self> {
        let motor = self.motors.get(channel)?.clone();
        Some(Self { motors: alloc::vec![motor], protection: None, ..self.clone() })
    }
}

impl MotorModel {
    /// Steps of a turn, rounded.
    #[must_use]
    pub fn steps_a_turn(&self) -> u64 {
        (360.0 / self.full_step_deg * f64::from(self.microsteps) + 0.5) as u64
    }
}
