//! The motor of an axis, its driver's supply and its load, which motion owns.

use crate::schema::{OWN, SONG, label, rows::fields};
use crate::schema::{SHEETS, rows::words};
use stepscope_motion::motor::{Decay, Drive, Regulator};
use stepscope_motion::{limits, motor::Motor};
use stepscope_plant::limits as plant;

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
        /// Coulomb friction of the rotor.
        friction_mn_m: f64 => label("Friction").only_if_set().unit("mN·m").number(plant::TORQUE_MN_M).from(OWN),
        /// What has to be overcome at rest.
        stiction_mn_m: Option<f64> => label("Stiction").only_if_set().unit("mN·m").follows("friction to 1000000").empty("the friction").from(OWN),
        /// Friction that grows with the speed.
        viscous_un_m_s: f64 => label("Viscous friction").only_if_set().unit("µN·m·s").number(plant::VISCOUS_UN_M_S).from(OWN),
        /// Amplitude of the torque with which the unpowered rotor holds its full steps.
        detent_torque_mn_m: f64 => label("Detent torque").only_if_set().unit("mN·m").follows("0 to half the holding torque").from(OWN),
        /// A constant torque to the left.
        gravity_torque_mn_m: f64 => label("Gravity").only_if_set().unit("mN·m").number(plant::SIGNED_TORQUE_MN_M).from(OWN),
        /// Amplitude of a torque that goes round with the load.
        sine_torque_mn_m: f64 => label("Turning torque").only_if_set().unit("mN·m").number(plant::TORQUE_MN_M).from(OWN),
        /// Its periods in a turn of the load.
        sine_per_turn: f64 => label("Its periods a turn").only_if_set().number(plant::SINE_PER_TURN).from(OWN),
        /// Its phase.
        sine_phase_deg: f64 => label("Its phase").only_if_set().unit("°").number(plant::SINE_PHASE_DEG).from(OWN),
        /// Stiffness of a coupling between rotor and load, which then are two masses.
        coupling_n_m_rad: Option<f64> => label("Coupling").only_if_set().unit("N·m/rad").number(plant::COUPLING_N_M_RAD).empty("rigid").from(OWN),
        /// Damping of the coupling.
        coupling_un_m_s: f64 => label("Its damping").only_if_set().unit("µN·m·s").number(plant::VISCOUS_UN_M_S).from(OWN),
        /// How its driver holds the currents.
        drive: Drive => label("Driver").only_if_set(),
    }
}

fields! {
    /// Of effect in a plant only.
    Drive {
        /// How it holds the phase currents.
        regulator: Regulator => label("Regulator").from(SHEETS),
        /// How a current decays while its phase is off.
        decay: Decay => label("Decay").from(SHEETS),
        /// Share of the off-time that decays fast, where the decay is mixed or automatic.
        decay_share: f64 => label("Fast share").number(plant::SHARE).from(SHEETS),
        /// Off-time of a chopper.
        off_us: f64 => label("Off-time").unit("µs").number(plant::CHOPPER_US).from(SHEETS),
        /// Least on-time of a chopper.
        blank_us: f64 => label("Blanking").unit("µs").number(plant::CHOPPER_US).from(SHEETS),
        /// Steps of its converter from 0 to the peak current.
        dac_levels: Option<u16> => label("Converter's steps").whole(plant::DAC_LEVELS).empty("as fine as numbers").from(SHEETS),
        /// Resistance of the bridge in series with a phase.
        bridge_ohm: f64 => label("Bridge").unit("Ω").number(plant::BRIDGE_OHM).from(SHEETS),
        /// Forward voltage of one of its diodes.
        diode_v: f64 => label("Diode").unit("V").number(plant::DIODE_V).from(SHEETS),
    }
}

words! {
    Regulator {
        /// the mean of an ideal chopper
        Averaged = "averaged", "averaged";
        /// fixed off-time, decided at grid points
        Chopper = "chopper", "chopper";
    }
    Decay {
        /// the phase is short-circuited
        Slow = "slow", "slow";
        /// the supply works against the current
        Fast = "fast", "fast";
        /// fast for `decay_share` of the off-time, then slow
        Mixed = "mixed", "mixed";
        /// mixed where the target fell at the last step, slow where it rose
        Auto = "auto", "automatic";
    }
}
