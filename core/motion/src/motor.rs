//! The motor of an axis, its driver's supply and its load: what torque against rate follows from
//! in `inspect`. A motor changes nothing in a run.
//!
//! The defaults are the motor of Song, Han and Lu 2021, table 3. Its rated voltage of 3.8 V is not
//! among them: by the same table 1.5 A through 1.6 ohm need 2.4 V, and with a current-regulating driver
//! the supply decides, not the rated voltage. The document does not give its supply, its load or what
//! the motor has to overcome; 24 V, no inertia and no torque stand for them.
//!
//! ```
//! use stepscope_motion::{motor::Motor, moves::Axis, plan_axis};
//!
//! let motor = Motor { supply_v: 36.0, load_torque_mn_m: 50.0, ..Motor::default() };
//! let with_motor = Axis { motor: Some(motor), ..Axis::default() };
//! let plan = plan_axis(&with_motor, "x").expect("it holds");
//! assert_eq!(plan, plan_axis(&Axis::default(), "x").expect("it holds"));
//! ```

use crate::parameters::parameters;

/// Maximum of the peak phase current, in parts of the rated current: a little over the square root of two,
/// with which a sine heats the windings as much as the rated current in both does.
pub const MAX_PEAK_CURRENT: f64 = 1.4143;

parameters! {
    /// A two-phase hybrid stepping motor with a bipolar driver that regulates its current, and its load.
    pub struct Motor {
        /// Rated current of a phase in A, both phases on.
        pub rated_current_a: f64 = 1.5,
        /// Resistance of a phase in ohm.
        pub resistance_ohm: f64 = 1.6,
        /// Inductance of a phase in mH.
        pub inductance_mh: f64 = 4.3,
        /// Holding torque in mN*m, both phases at the rated current.
        pub holding_torque_mn_m: f64 = 400.0,
        /// Inertia of the rotor in g*cm^2.
        pub rotor_inertia_g_cm2: f64 = 45.0,
        /// Supply voltage of the driver in V.
        pub supply_v: f64 = 24.0,
        /// Peak of the phase current that the driver regulates, in A; without it the rated current.
        pub peak_current_a: Option<f64> = None,
        /// Inertia of all that turns with the rotor, seen from its shaft, in g*cm^2.
        pub load_inertia_g_cm2: f64 = 0.0,
        /// Torque that opposes the motion (friction, cutting), seen from the rotor's shaft, in mN*m.
        pub load_torque_mn_m: f64 = 0.0,
        /// Highest rate in steps/s at which the motor is known to work with its load, as its maker or a
        /// test gives it (the paper's f_s); without it only the torque limits the rate.
        pub working_rate_hz: Option<f64> = None,
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
        /// Stiffness of a coupling between rotor and load in N*m/rad; without it they are one mass.
        pub coupling_n_m_rad: Option<f64> = None,
        /// Damping of the coupling in uN*m*s.
        pub coupling_un_m_s: f64 = 0.0,
        /// How its driver works.
        pub drive: Drive = Drive::default(),
    }

    /// The driver of a motor, as a plant needs to know it.
    pub struct Drive {
        /// How it holds the phase currents.
        pub regulator: Regulator = Regulator::Averaged,
        /// How a current decays while its phase is off.
        pub decay: Decay = Decay::Fast,
        /// Share of an off-time that decays fast, where the decay is mixed or automatic.
        pub decay_share: f64 = 0.31,
        /// Off-time of a chopper in us.
        pub off_us: f64 = 20.0,
        /// Minimum on-time of a chopper in us.
        pub blank_us: f64 = 1.0,
        /// Steps of the driver's converter from 0 to the peak current; without it they are as fine as numbers.
        pub dac_levels: Option<u16> = None,
        /// Resistance of the bridge in series with a phase, in ohm.
        pub bridge_ohm: f64 = 0.0,
        /// Forward voltage of one of its diodes in V.
        pub diode_v: f64 = 0.7,
    }
}

/// How a driver holds the phase currents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Regulator {
    /// The mean of an ideal chopper.
    #[default]
    Averaged,
    /// A chopper with a fixed off-time.
    Chopper,
}

/// How a current decays while its phase is off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decay {
    /// The phase is short-circuited.
    Slow,
    /// The supply works against the current.
    #[default]
    Fast,
    /// Fast for a share of the off-time, then slow.
    Mixed,
    /// Mixed while the current's target falls, slow while it rises.
    Auto,
}
