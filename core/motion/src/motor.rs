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

/// Most of the peak phase current, in parts of the rated current: a little over the square root of two,
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
        /// test gives it (the document's f_s); without it only the torque limits the rate.
        pub working_rate_hz: Option<f64> = None,
    }
}
