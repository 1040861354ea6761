//! Motor, supply and load of an axis; motion owns the types.

use crate::schema::{OWN, SONG, label, rows::fields};
use crate::schema::{SHEETS, rows::words};
use stepscope_motion::motor::{Decay, Drive, Regulator};
use stepscope_motion::{limits, motor::Motor};
use stepscope_plant::limits as plant;

fields! {
    /// Motor of the axis with its supply and load. It does not affect the run: `stepscope torque` and the page report with
    /// it whether a plan needs more torque than the motor has. The defaults are the motor of Song, Han, Lu 2021, table 3.
    /// The supply and the load, which they do not give, are assumed.
    ///
    /// Full step and microsteps come from the mechanics. `direct` mechanics have none, so they cannot have a motor. The
    /// model: [torque.md](torque.md).
    Motor {
        /// Current per phase, both phases on.
        rated_current_a: f64 => label("Rated current").unit("A").number(limits::RATED_CURRENT_A)
            .term("Rated current", "Current per phase for which the data sheet gives the holding torque, both phases on.")
            .from(SONG),
        /// Resistance per phase.
        resistance_ohm: f64 => label("Resistance").unit("Ω").number(limits::RESISTANCE_OHM)
            .term("Resistance", "Resistance of one phase. At low rates it determines the required voltage.")
            .from(SONG),
        /// Inductance per phase.
        inductance_mh: f64 => label("Inductance").unit("mH").number(limits::INDUCTANCE_MH)
            .term("Inductance", "Inductance of one phase. At high rates the current cannot follow, so the torque falls.")
            .from(SONG),
        /// Holding torque, both phases at the rated current.
        holding_torque_mn_m: f64 => label("Holding torque").named("holding_torque_mN_m").unit("mN·m")
            .number(limits::HOLDING_TORQUE_MN_M)
            .term("Holding torque", "Torque with both phases at the rated current. One phase alone at the rated current has 1/√2 of this torque. The back-EMF constant is derived from the holding torque.")
            .from(SONG),
        /// Inertia of the rotor.
        rotor_inertia_g_cm2: f64 => label("Rotor inertia").unit("g·cm²").number(limits::INERTIA_G_CM2)
            .term("Rotor inertia", "Torque for the acceleration = (rotor + load inertia) × acceleration.")
            .from(SONG),
        /// Supply voltage of the driver; an assumption.
        supply_v: f64 => label("Supply").unit("V").number(limits::SUPPLY_V)
            .term("Supply", "Supply voltage of the driver. A higher voltage keeps the current up to a higher rate.")
            .from(OWN),
        /// Peak phase current of the driver.
        peak_current_a: Option<f64> => label("Peak current").unit("A")
            .range_text("0.001 to 1.4143 times the rated current")
            .null_means("the rated current")
            .term("Peak current", "Amplitude of the phase currents. √2 times the rated current heats the motor as much as the rated current in both phases.")
            .from(OWN),
        /// Inertia of the load at the motor shaft.
        load_inertia_g_cm2: f64 => label("Load inertia").unit("g·cm²").number(limits::INERTIA_G_CM2)
            .term("Load inertia", "Inertia of the load at the motor shaft. Behind a gear of n : 1 divide it by n².")
            .from(OWN),
        /// Torque of the load at the motor shaft.
        load_torque_mn_m: f64 => label("Load torque").named("load_torque_mN_m").unit("mN·m")
            .number(limits::LOAD_TORQUE_MN_M)
            .term("Load torque", "Torque that opposes the motion, such as friction or cutting. It helps when decelerating.")
            .from(OWN),
        /// Highest rate known to work with the load.
        working_rate_hz: Option<f64> => label("Working rate").unit("steps/s").number(limits::WORKING_RATE_HZ)
            .null_means("only the torque limits it")
            .term("Working rate", "Highest rate known to work with the load, f_s. Song 2021 states 19200 Hz.")
            .from(SONG),
        /// Coulomb friction of the rotor.
        friction_mn_m: f64 => label("Friction").named("friction_mN_m").only_if_set().unit("mN·m").number(plant::TORQUE_MN_M).from(OWN),
        /// Friction at rest.
        stiction_mn_m: Option<f64> => label("Stiction").named("stiction_mN_m").only_if_set().unit("mN·m").range_text("friction to 1000000").null_means("the friction").from(OWN),
        /// Friction proportional to the speed.
        viscous_un_m_s: f64 => label("Viscous friction").named("viscous_uN_m_s").only_if_set().unit("µN·m·s").number(plant::VISCOUS_UN_M_S).from(OWN),
        /// Amplitude of the torque that holds the unpowered rotor.
        detent_torque_mn_m: f64 => label("Detent torque").named("detent_torque_mN_m").only_if_set().unit("mN·m").range_text("0 to half the holding torque").from(OWN),
        /// A constant torque to the left.
        gravity_torque_mn_m: f64 => label("Gravity").named("gravity_torque_mN_m").only_if_set().unit("mN·m").number(plant::SIGNED_TORQUE_MN_M).from(OWN),
        /// Amplitude of a torque that is periodic in the load angle.
        sine_torque_mn_m: f64 => label("Periodic torque").named("sine_torque_mN_m").only_if_set().unit("mN·m").number(plant::TORQUE_MN_M).from(OWN),
        /// Periods of the periodic torque per turn of the load.
        sine_per_turn: f64 => label("Periods per turn").only_if_set().number(plant::SINE_PER_TURN).from(OWN),
        /// Phase of the periodic torque.
        sine_phase_deg: f64 => label("Phase").only_if_set().unit("°").number(plant::SINE_PHASE_DEG).from(OWN),
        /// Stiffness of the coupling between rotor and load. With one they are two masses.
        coupling_n_m_rad: Option<f64> => label("Coupling").named("coupling_N_m_rad").only_if_set().unit("N·m/rad").number(plant::COUPLING_N_M_RAD).null_means("rigid").from(OWN),
        /// Damping of the coupling.
        coupling_un_m_s: f64 => label("Coupling damping").named("coupling_uN_m_s").only_if_set().unit("µN·m·s").number(plant::VISCOUS_UN_M_S).from(OWN),
        /// Current control of the driver.
        drive: Drive => label("Driver").named("driver").only_if_set(),
    }
}

fields! {
    /// Only used with `plant`.
    Drive {
        /// How the driver controls the phase currents.
        regulator: Regulator => label("Current control").named("current_control").from(SHEETS),
        /// How the current decays while the phase is off.
        decay: Decay => label("Decay").from(SHEETS),
        /// Fraction of the off time with fast decay, for mixed and automatic decay.
        decay_share: f64 => label("Fast decay fraction").named("fast_decay_fraction").number(plant::SHARE).from(SHEETS),
        /// Off time of the chopper.
        off_us: f64 => label("Off time").named("off_time_us").unit("µs").number(plant::CHOPPER_US).from(SHEETS),
        /// Minimum on-time of the chopper.
        blank_us: f64 => label("Blanking time").named("blanking_time_us").unit("µs").number(plant::CHOPPER_US).from(SHEETS),
        /// Steps of the DAC from 0 to the peak current.
        dac_levels: Option<u16> => label("DAC steps").whole(plant::DAC_LEVELS).null_means("not quantized").from(SHEETS),
        /// Resistance of the bridge in series with a phase.
        bridge_ohm: f64 => label("Bridge").unit("Ω").number(plant::BRIDGE_OHM).from(SHEETS),
        /// Forward voltage of one diode.
        diode_v: f64 => label("Diode").unit("V").number(plant::DIODE_V).from(SHEETS),
    }
}

words! {
    Regulator {
        Averaged = "averaged", "averaged": "average of an ideal chopper";
        Chopper = "chopper", "chopper": "fixed off time, evaluated at grid points";
    }
    Decay {
        Slow = "slow", "slow": "the phase is short-circuited";
        Fast = "fast", "fast": "the supply opposes the current";
        Mixed = "mixed", "mixed": "fast for the fast decay fraction of the off time, then slow";
        Auto = "auto", "automatic": "mixed if the target fell at the last step, slow if it rose";
    }
}
