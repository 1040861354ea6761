//! The motor of an axis with its supply and load, for torque computations and the simulated plant (DESIGN Part B). It does
//! not affect the edges of a run without a plant.
//!
//! The defaults are the motor of Song, Han and Lu 2021, table 3, without its rated voltage: with a current-regulating
//! driver the supply decides. The paper gives neither supply nor load, so 24 V, no inertia and no torque are assumed.
//!
//! ```
//! use stepscope_motion::{motor::Motor, moves::Axis, plan_axis};
//!
//! let motor = Motor { supply_v: 36.0, load_torque_mn_m: 50.0, ..Motor::default() };
//! let with_motor = Axis { motor: Some(motor), ..Axis::default() };
//! let plan = plan_axis(&with_motor, "x").expect("a valid axis");
//! assert_eq!(plan, plan_axis(&Axis::default(), "x").expect("a valid axis"));
//! ```

use stepscope_peripheral::parameters;

/// Maximum peak of the phase current in units of the rated current: slightly above the square root of two, at which a sine
/// heats the windings like the rated current in both.
pub const MAX_PEAK_CURRENT: f64 = 1.4143;

parameters! { (Clone, Debug, PartialEq)
    /// A two-phase hybrid stepper motor with a current-regulating bipolar driver, and its load.
    pub struct Motor {
        pub rated_current_a: f64 = 1.5,
        pub resistance_ohm: f64 = 1.6,
        pub inductance_mh: f64 = 4.3,
        /// With both phases at the rated current.
        pub holding_torque_mn_m: f64 = 400.0,
        pub rotor_inertia_g_cm2: f64 = 45.0,
        pub supply_v: f64 = 24.0,
        /// Peak of the regulated phase current; `None` for the rated current.
        pub peak_current_a: Option<f64> = None,
        /// Inertia of everything that turns with the rotor, seen from its shaft.
        pub load_inertia_g_cm2: f64 = 0.0,
        /// Torque that opposes the motion (friction, cutting), seen from the rotor's shaft.
        pub load_torque_mn_m: f64 = 0.0,
        /// Maximum rate at which the motor is known to work with its load; `None` if only the torque limits the rate.
        pub working_rate_hz: Option<f64> = None,
        /// Friction of the rotor, only in the plant; torque computations use `load_torque_mn_m` alone.
        pub friction_mn_m: f64 = 5.0,
        /// Breakaway torque; `None` for the friction.
        pub stiction_mn_m: Option<f64> = None,
        /// Viscous friction of the rotor in µN·m·s per rad.
        pub viscous_un_m_s: f64 = 300.0,
        /// Amplitude of the detent torque, which has four periods per electrical period.
        pub detent_torque_mn_m: f64 = 0.0,
        /// Constant torque on the load, such as the weight of a vertical axis.
        pub gravity_torque_mn_m: f64 = 0.0,
        /// Amplitude of a torque that depends on the angle of the load.
        pub sine_torque_mn_m: f64 = 0.0,
        /// Periods of the sine torque per turn of the load.
        pub sine_per_turn: f64 = 1.0,
        pub sine_phase_deg: f64 = 0.0,
        /// Stiffness of the coupling in N·m per rad; `None` makes rotor and load one mass.
        pub coupling_n_m_rad: Option<f64> = None,
        /// Damping of the coupling in µN·m·s per rad.
        pub coupling_un_m_s: f64 = 0.0,
        pub drive: Drive = Drive::default(),
    }

    /// The driver of a motor, for the plant.
    pub struct Drive {
        pub regulator: Regulator = Regulator::Averaged,
        pub decay: Decay = Decay::Fast,
        /// Share of the off-time with fast decay; only for mixed and automatic decay.
        pub decay_share: f64 = 0.31,
        pub off_us: f64 = 20.0,
        /// Time after switching on during which the chopper ignores the current.
        pub blank_us: f64 = 1.0,
        /// Steps of the digital-to-analog converter from 0 to the peak current; `None` for an ideal one.
        pub dac_levels: Option<u16> = None,
        /// Resistance of the bridge in series with a phase.
        pub bridge_ohm: f64 = 0.0,
        /// Forward voltage of one diode of the bridge.
        pub diode_v: f64 = 0.7,
    }
}

/// How the driver regulates the phase current.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Regulator {
    /// The mean of an ideal chopper.
    #[default]
    Averaged,
    /// A chopper with a fixed off-time.
    Chopper,
}

/// How the phase current falls during the off-time of a chopper.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decay {
    Slow,
    /// The bus voltage drives the current back.
    #[default]
    Fast,
    /// Fast for a share of the off-time, then slow.
    Mixed,
    /// Mixed while the target current falls, slow while it rises.
    Auto,
}
