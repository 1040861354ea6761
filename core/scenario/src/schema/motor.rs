//! The motor of an axis, its driver's supply and its load, which motion owns.

use crate::schema::{OWN, SONG, label, rows::fields};
use stepscope_motion::{limits, motor::Motor};

fields! {
    /// The axis' motor with its supply and load. It changes nothing in a run: `stepscope torque` and the page say by it
    /// whether a plan asks for more torque than there is. The defaults are the motor of Song, Han and Lu 2021, table 3
    /// (its 3.8 V is left out: with a driver that regulates the current only the supply counts, which the document does
    /// not give, nor its load).
    ///
    /// The motor's angle and microsteps are the mechanics'; on `direct` mechanics, which have none, a motor is refused.
    /// The model behind it: [torque.md](torque.md).
    Motor {
        /// Current of a phase, both phases on.
        rated_current_a: f64 => label("Rated current")
            .unit("A")
            .number(limits::RATED_CURRENT_A)
            .term("Rated current", "Current of each phase at which the data sheet gives the holding torque, with both phases on.")
            .from(SONG),
        /// Of a phase.
        resistance_ohm: f64 => label("Resistance")
            .unit("Ω")
            .number(limits::RESISTANCE_OHM)
            .term("Resistance", "Of one phase. At low rates the supply has to overcome little more.")
            .from(SONG),
        /// Of a phase.
        inductance_mh: f64 => label("Inductance")
            .unit("mH")
            .number(limits::INDUCTANCE_MH)
            .term("Inductance", "Of one phase. It keeps the current from following at high rates, so the torque falls there.")
            .from(SONG),
        /// Both phases at the rated current.
        holding_torque_mn_m: f64 => label("Holding torque")
            .unit("mN·m")
            .number(limits::HOLDING_TORQUE_MN_M)
            .term("Holding torque", "With both phases at the rated current. One phase at its peak has 1/√2 of it. It also tells the back-EMF.")
            .from(SONG),
        /// Of the rotor.
        rotor_inertia_g_cm2: f64 => label("Rotor inertia")
            .unit("g·cm²")
            .number(limits::INERTIA_G_CM2)
            .term("Rotor inertia", "Torque for the acceleration = (rotor + load inertia) × acceleration.")
            .from(SONG),
        /// Of the driver. The document gives none.
        supply_v: f64 => label("Supply")
            .unit("V")
            .number(limits::SUPPLY_V)
            .term("Supply", "Voltage of the driver's supply. The higher it is, the higher the rate up to which the driver holds its current.")
            .from(OWN),
        /// Peak of the phase current that the driver regulates.
        peak_current_a: Option<f64> => label("Peak current")
            .unit("A")
            .follows("0.001 to 1.4143 times the rated current")
            .empty("the rated current")
            .term("Peak current", "Amplitude of the phase currents that the driver regulates; √2 times the rated current heats the motor as much as the rated current in both phases does.")
            .from(OWN),
        /// What turns with the rotor, seen from the motor's shaft.
        load_inertia_g_cm2: f64 => label("Load inertia")
            .unit("g·cm²")
            .number(limits::INERTIA_G_CM2)
            .term("Load inertia", "Of all that turns with the rotor, seen from its shaft; behind a gear of n : 1 divided by n².")
            .from(OWN),
        /// What opposes the motion, seen from the motor's shaft.
        load_torque_mn_m: f64 => label("Load torque")
            .unit("mN·m")
            .number(limits::LOAD_TORQUE_MN_M)
            .term("Load torque", "What opposes the motion: friction, cutting. It helps when slowing down.")
            .from(OWN),
        /// Highest rate at which the motor is known to work with its load.
        working_rate_hz: Option<f64> => label("Working rate")
            .unit("steps/s")
            .number(limits::WORKING_RATE_HZ)
            .empty("only the torque limits it")
            .term("Working rate", "Highest rate at which the motor is known to work with its load, f_s. The document states 19200 Hz for its motor and does not derive it.")
            .from(SONG),
    }
}
