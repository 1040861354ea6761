//! Listed motors and drivers, with the source of each value.
//!
//! No data sheet states friction: the default motor's friction is scaled by the holding torque.
//! [`MotorSheet::typical`] lists all values that the source does not state.

use crate::motion::torque::Machine;
use alloc::vec::Vec;
use stepscope_motion::mechanics::{Mechanics, Rotary};
use stepscope_motion::motor::{Decay, Drive, Motor, Regulator};
use stepscope_motion::moves::Axis;
use stepscope_scenario::{PlantMotor, Scenario, Source};

/// Parameters of a listed motor, with their source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorSheet {
    pub id: &'static str,
    pub name: &'static str,
    pub full_step_deg: f64,
    pub rated_current_a: f64,
    pub resistance_ohm: f64,
    pub inductance_mh: f64,
    pub holding_torque_mn_m: f64,
    pub rotor_inertia_g_cm2: f64,
    /// 0 where the source does not state it.
    pub detent_torque_mn_m: f64,
    pub friction_mn_m: f64,
    pub viscous_un_m_s: f64,
    /// The document, and the values that it states.
    pub source: &'static str,
    /// Fields that the source does not state; they have typical values.
    pub typical: &'static [&'static str],
}

/// Parameters of a listed motor driver, with their source.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveSheet {
    pub id: &'static str,
    pub name: &'static str,
    pub drive: Drive,
    pub source: &'static str,
    pub typical: &'static [&'static str],
}

const FRICTIONS: &[&str] = &["friction_mN_m", "viscous_uN_m_s"];
const FRICTIONS_AND_DETENT: &[&str] = &["detent_torque_mN_m", "friction_mN_m", "viscous_uN_m_s"];

const INERTIA_AND_FRICTIONS: &[&str] =
    &["rotor_inertia_g_cm2", "detent_torque_mN_m", "friction_mN_m", "viscous_uN_m_s"];
const ALL: &[&str] = &[
    "rated_current_a",
    "resistance_ohm",
    "inductance_mh",
    "holding_torque_mN_m",
    "rotor_inertia_g_cm2",
    "detent_torque_mN_m",
    "friction_mN_m",
    "viscous_uN_m_s",
];

/// A 1.8 degree motor with the default friction in proportion to its holding torque.
const fn with_default_friction(
    [rated_current_a, resistance_ohm, inductance_mh]: [f64; 3],
    [holding_torque_mn_m, rotor_inertia_g_cm2, detent_torque_mn_m]: [f64; 3],
) -> MotorSheet {
    MotorSheet {
        id: "",
        name: "",
        full_step_deg: 1.8,
        rated_current_a,
        resistance_ohm,
        inductance_mh,
        holding_torque_mn_m,
        rotor_inertia_g_cm2,
        detent_torque_mn_m,
        friction_mn_m: holding_torque_mn_m / 80.0,
        viscous_un_m_s: holding_torque_mn_m * 0.75,
        source: "",
        typical: FRICTIONS_AND_DETENT,
    }
}

/// All motors. Rows are A, ohm, mH; mN*m, g*cm^2, mN*m of detent torque.
pub const MOTORS: &[MotorSheet] = &[
    MotorSheet {
        id: "song-2021",
        name: "Song, Han and Lu 2021: 1.5 A, 400 mN·m (the default)",
        source: "table 3 of the paper; it states no friction",
        ..with_default_friction([1.5, 1.6, 4.3], [400.0, 45.0, 0.0])
    },
    MotorSheet {
        id: "patent-2019",
        name: "For RU 2704486, figure 1: 1.5 A, 300 mN·m",
        friction_mn_m: 15.0,
        viscous_un_m_s: 1000.0,
        source: "not from the patent, which names no motor: the motor of the preset patent-2019-figure-1, which has a load of \
                 100 g·cm², 27 V and a bridge of 1 Ω",
        typical: ALL,
        ..with_default_friction([1.5, 1.6, 5.3], [300.0, 45.0, 0.0])
    },
    MotorSheet {
        id: "nema-8",
        name: "NEMA 8, 30 mm long: 0.6 A, 18 mN·m",
        source: "no data sheet: typical values",
        typical: ALL,
        ..with_default_friction([0.6, 6.5, 1.7], [18.0, 2.0, 0.0])
    },
    MotorSheet {
        id: "sy28sth45",
        name: "NEMA 11, Songyang SY28STH45-0674A: 0.67 A, 95 mN·m",
        source: "the maker's drawing of 2012 (current, resistance, inductance, torque)",
        typical: INERTIA_AND_FRICTIONS,
        ..with_default_friction([0.67, 6.8, 4.9], [95.0, 12.0, 0.0])
    },
    MotorSheet {
        id: "ms14hs5p4150",
        name: "NEMA 14, MOONS' MS14HS5P4150: 1.5 A, 400 mN·m",
        source: "the maker's values, from the motor list of klipper_tmc_autotune (current, resistance, inductance, \
                 torque)",
        typical: INERTIA_AND_FRICTIONS,
        ..with_default_friction([1.5, 2.2, 3.6], [400.0, 24.0, 0.0])
    },
    MotorSheet {
        id: "ss2422",
        name: "NEMA 17 flat, Sanyo Denki SS2422-5041: 1 A, 186 mN·m",
        source: "the maker's catalog, page 60, thin 42 mm motors",
        ..with_default_friction([1.0, 5.4, 2.9], [186.0, 28.0, 0.0])
    },
    MotorSheet {
        id: "17hs4401",
        name: "NEMA 17, MotionKing 17HS4401: 1.7 A, 400 mN·m",
        source: "the maker's table of the series 17HS, row 17HS4401",
        typical: FRICTIONS,
        ..with_default_friction([1.7, 1.5, 2.8], [400.0, 54.0, 22.0])
    },
    MotorSheet {
        id: "as1010",
        name: "NEMA 17, Beckhoff AS1010: 1 A, 380 mN·m",
        source: "the maker's documentation AS1000, technical data; cogging torque 14 to 16 mN·m",
        typical: FRICTIONS,
        ..with_default_friction([1.0, 4.1, 9.5], [380.0, 56.0, 15.0])
    },
    MotorSheet {
        id: "qsh5718-55",
        name: "NEMA 23, Trinamic QSH5718-55-30-098: 3 A, 980 mN·m",
        source: "the maker's technical data of QSH5718, where the rated current is RMS",
        typical: FRICTIONS,
        ..with_default_friction([3.0, 0.8, 2.1], [980.0, 209.0, 30.0])
    },
    MotorSheet {
        id: "as1050",
        name: "NEMA 23, Beckhoff AS1050: 5 A, 1200 mN·m",
        source: "the maker's documentation AS1000, technical data; cogging torque 46 to 58 mN·m",
        typical: FRICTIONS,
        ..with_default_friction([5.0, 0.28, 0.86], [1200.0, 360.0, 52.0])
    },
    MotorSheet {
        id: "as1060",
        name: "NEMA 34, Beckhoff AS1060: 5 A, 5000 mN·m",
        source: "the maker's documentation AS1000, technical data; cogging torque 147 to 215 mN·m",
        typical: FRICTIONS,
        ..with_default_friction([5.0, 0.36, 2.8], [5000.0, 3000.0, 181.0])
    },
];

/// Common values of the chips: slow decay while the current rises, mixed decay while it falls.
const CHIP: Drive = Drive {
    regulator: Regulator::Chopper,
    decay: Decay::Auto,
    decay_share: 0.3125,
    off_us: 30.0,
    blank_us: 1.0,
    dac_levels: None,
    bridge_ohm: 0.64,
    diode_v: 0.7,
};

/// All drivers. Those of the timing check have the same id there ([`drivers`](crate::trace::drivers)).
pub const DRIVES: &[DriveSheet] = &[
    DriveSheet {
        id: "ideal",
        name: "Mean current of an ideal chopper (the default)",
        drive: Drive {
            regulator: Regulator::Averaged,
            decay: Decay::Fast,
            decay_share: 0.31,
            off_us: 20.0,
            blank_us: 1.0,
            dac_levels: None,
            bridge_ohm: 0.0,
            diode_v: 0.7,
        },
        source: "no chip: the average behavior of a good one, simulated five times as fast",
        typical: &["diode_v"],
    },
    DriveSheet {
        id: "a4988",
        name: "Allegro A4988",
        drive: Drive { diode_v: 1.2, ..CHIP },
        source: "data sheet 4988-DS: 0.32 Ω source and sink, off-time 30 µs, slow or mixed decay, selected automatically; diodes at most \
                 1.2 V",
        typical: &["fast_decay_fraction", "blanking_time_us"],
    },
    DriveSheet {
        id: "a4979",
        name: "Allegro A4979",
        drive: Drive { bridge_ohm: 1.0, ..CHIP },
        source: "data sheet A4979-DS: 0.5 Ω source and sink, slow, mixed or automatic decay; times and shares are programmable, \
                 here the values of the A4988",
        typical: &["fast_decay_fraction", "off_time_us", "blanking_time_us", "diode_v"],
    },
    DriveSheet {
        id: "drv8825",
        name: "Texas Instruments DRV8825",
        drive: Drive { decay_share: 0.75, blank_us: 3.75, bridge_ohm: 0.4, ..CHIP },
        source: "data sheet SLVSA73: mixed decay, fast up to 75 % of a period. The chip chops at a fixed frequency; the \
                 model has a fixed off-time, here about the rest of a period",
        typical: &["off_time_us", "blanking_time_us", "bridge_ohm", "diode_v"],
    },
    DriveSheet {
        id: "tmc2209",
        name: "Trinamic TMC2209, as SpreadCycle",
        drive: Drive {
            decay: Decay::Mixed,
            decay_share: 0.2,
            off_us: 20.0,
            blank_us: 2.0,
            dac_levels: Some(255),
            bridge_ohm: 0.34,
            ..CHIP
        },
        source: "data sheet rev. 1.09: 0.17 Ω each side, sine table of 8 bits; its default \
                 TOFF = 3 is 9 to 10 µs at 12 MHz, twice per period. The hysteresis of SpreadCycle and StealthChop (voltage regulation) are not modeled",
        typical: &["fast_decay_fraction", "off_time_us", "blanking_time_us", "diode_v"],
    },
];

pub fn motor(id: &str) -> Option<&'static MotorSheet> {
    MOTORS.iter().find(|sheet| sheet.id == id)
}

pub fn drive(id: &str) -> Option<&'static DriveSheet> {
    DRIVES.iter().find(|sheet| sheet.id == id)
}

impl MotorSheet {
    /// This motor at its rated current, with supply, load and driver of `other`.
    pub fn replacing(&self, other: &Motor) -> Motor {
        Motor {
            rated_current_a: self.rated_current_a,
            resistance_ohm: self.resistance_ohm,
            inductance_mh: self.inductance_mh,
            holding_torque_mn_m: self.holding_torque_mn_m,
            rotor_inertia_g_cm2: self.rotor_inertia_g_cm2,
            peak_current_a: None,
            working_rate_hz: None,
            friction_mn_m: self.friction_mn_m,
            stiction_mn_m: None,
            viscous_un_m_s: self.viscous_un_m_s,
            detent_torque_mn_m: self.detent_torque_mn_m,
            ..other.clone()
        }
    }

    /// The motor without load, with the default supply and microsteps.
    pub fn machine(&self) -> Option<Machine> {
        let full = Rotary { full_step_deg: self.full_step_deg, ..Rotary::default() };
        let motor = Some(self.replacing(&Motor::default()));
        Machine::of(&Axis { mechanics: Mechanics::Rotary(full), motor, ..Axis::default() })
    }

    /// Replaces every motor of a scenario.
    pub fn apply_to(&self, scenario: &mut Scenario) {
        each_motor(scenario, |full_step_deg, motor| {
            *motor = self.replacing(motor);
            if let Some(full_step_deg) = full_step_deg {
                *full_step_deg = self.full_step_deg;
            }
        });
    }
}

impl DriveSheet {
    /// Replaces every driver of a scenario.
    pub fn apply_to(&self, scenario: &mut Scenario) {
        each_motor(scenario, |_, motor| motor.drive = self.drive.clone());
    }
}

fn each_motor(scenario: &mut Scenario, mut with: impl FnMut(Option<&mut f64>, &mut Motor)) {
    let listed = scenario.plant.as_ref().is_some_and(|plant| !plant.motors.is_empty());
    let first: Vec<&mut Axis> = match &mut scenario.source {
        Source::Motion(motion) => motion.axes.iter_mut().collect(),
        _ => Vec::new(),
    };
    let others = scenario.controllers.iter_mut().flat_map(|controller| controller.axes.iter_mut());
    for axis in first.into_iter().chain(others) {
        let full_step_deg = match &mut axis.mechanics {
            Mechanics::Rotary(m) => Some(&mut m.full_step_deg),
            Mechanics::Wheel(m) => Some(&mut m.full_step_deg),
            Mechanics::Screw(m) => Some(&mut m.full_step_deg),
            Mechanics::Direct(_) => None,
        };
        // An axis without a motor has the motor of the plant's list, or else the default motor.
        if axis.motor.is_none() && (listed || full_step_deg.is_none()) {
            continue;
        }
        with(full_step_deg, axis.motor.get_or_insert_default());
    }
    if let Some(plant) = &mut scenario.plant {
        if plant.motors.is_empty() {
            plant.motors.push(PlantMotor::default());
        }
        for entry in &mut plant.motors {
            with(Some(&mut entry.full_step_deg), &mut entry.motor);
        }
    }
}

#[cfg(test)]
mod tests;
