//! Options that select listed motors and drivers: `--motor`, `--motor-driver`, `stepscope plant --motors`.

use crate::failure::{Failure, no_plant};
use crate::{json::Tables, quantity::whole, scenarios, terminal};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use serde_json::json;
use std::io::{self, Write};
use std::{borrow::Cow, path::Path, sync::Arc};
use stepscope_core::inspect::plant::motors::{self, DRIVES, DriveSheet, MOTORS, MotorSheet};
use stepscope_core::scenario::{Compact, Scenario};
use stepscope_core::sim::Experiment;

#[derive(Args)]
pub(crate) struct MotorReplacement {
    /// Replace all motors with this one, at its rated current
    ///
    /// `stepscope plant --motors` lists the motors. Supply and load do not change.
    #[arg(long, value_name = "MOTOR", value_parser = motor_parser(), hide_possible_values = true)]
    motor: Option<&'static MotorSheet>,
    /// Replace all motor drivers with this one
    ///
    /// `stepscope plant --motors` lists the motor drivers.
    #[arg(long, alias = "drive", value_name = "DRIVER", value_parser = drive_parser(), hide_possible_values = true)]
    motor_driver: Option<&'static DriveSheet>,
}

#[derive(Args)]
pub(crate) struct NamedMotor {
    /// Replace all motors with this one, at its rated current
    ///
    /// `stepscope plant --motors` lists the motors. Supply and load do not change; if the scenario has no motor, they are
    /// 24 V and no load.
    #[arg(long, value_name = "MOTOR", value_parser = motor_parser(), hide_possible_values = true)]
    pub(crate) motor: Option<&'static MotorSheet>,
    /// Microsteps per full step of --motor, unless axes define their own (default: 16)
    #[arg(long, value_name = "N", requires = "motor", value_parser = whole::<u16>(1..=512))]
    pub(crate) microsteps: Option<u16>,
}

impl NamedMotor {
    pub(crate) fn apply_to(&self, scenario: &mut Scenario) {
        let Some(motor) = self.motor else { return };
        motor.apply_to(scenario);
        let motors = scenario.plant.iter_mut().flat_map(|plant| &mut plant.motors);
        motors.for_each(|entry| entry.microsteps = self.microsteps.unwrap_or(entry.microsteps));
    }

    pub(crate) fn applied_to<'a>(&self, scenario: &'a Scenario) -> Cow<'a, Scenario> {
        if self.motor.is_none() {
            return Cow::Borrowed(scenario);
        }
        let mut scenario = scenario.clone();
        scenario.plant.get_or_insert_default();
        self.apply_to(&mut scenario);
        Cow::Owned(scenario)
    }
}

fn motor_parser() -> impl TypedValueParser<Value = &'static MotorSheet> {
    let values = MOTORS.iter().map(|sheet| PossibleValue::new(sheet.id).help(sheet.name));
    PossibleValuesParser::new(values).try_map(|id| motors::motor(&id).ok_or("unknown motor"))
}

fn drive_parser() -> impl TypedValueParser<Value = &'static DriveSheet> {
    let values = DRIVES.iter().map(|sheet| PossibleValue::new(sheet.id).help(sheet.name));
    PossibleValuesParser::new(values).try_map(|id| motors::drive(&id).ok_or("unknown driver"))
}

fn check_plant(path: &Path, scenario: &Scenario) -> Result<(), Failure> {
    scenario.plant.as_ref().map(|_| ()).ok_or_else(|| no_plant(path))
}

impl MotorReplacement {
    /// The scenario must have a plant; `-` is standard input.
    pub(crate) fn validated(&self, path: &Path) -> Result<(Arc<Scenario>, Arc<Experiment>), Failure> {
        if self.motor.is_none() && self.motor_driver.is_none() {
            return scenarios::validated_after(path, |scenario| check_plant(path, scenario));
        }
        let mut scenario = scenarios::read(path)?;
        check_plant(path, &scenario)?;
        if let Some(motor) = self.motor {
            motor.apply_to(&mut scenario);
        }
        if let Some(drive) = self.motor_driver {
            drive.apply_to(&mut scenario);
        }
        let experiment =
            Experiment::new(&scenario).map_err(|problems| Failure::Scenario(path.to_owned(), problems))?;
        Ok((Arc::new(scenario), Arc::new(experiment)))
    }
}

pub(crate) fn list(as_json: bool) -> Result<(), Failure> {
    if as_json {
        let motor = |sheet: &MotorSheet| {
            json!({
                "id": sheet.id, "name": sheet.name, "full_step_deg": sheet.full_step_deg,
                "rated_current_a": sheet.rated_current_a, "resistance_ohm": sheet.resistance_ohm,
                "inductance_mh": sheet.inductance_mh, "holding_torque_mn_m": sheet.holding_torque_mn_m,
                "rotor_inertia_g_cm2": sheet.rotor_inertia_g_cm2,
                "detent_torque_mn_m": sheet.detent_torque_mn_m, "friction_mn_m": sheet.friction_mn_m,
                "viscous_un_m_s": sheet.viscous_un_m_s, "source": sheet.source,
                "typical": sheet.typical.join(" "),
            })
        };
        let drive = |sheet: &DriveSheet| {
            let drive = &sheet.drive;
            json!({
                "id": sheet.id, "name": sheet.name, "regulator": drive.regulator.compact(),
                "decay": drive.decay.compact(), "decay_share": drive.decay_share, "off_us": drive.off_us,
                "blank_us": drive.blank_us, "dac_levels": drive.dac_levels, "bridge_ohm": drive.bridge_ohm,
                "diode_v": drive.diode_v, "source": sheet.source, "typical": sheet.typical.join(" "),
            })
        };
        let tables = Tables::of("plant").with("motors", MOTORS.iter().map(motor));
        return tables.with("drives", DRIVES.iter().map(drive)).print();
    }
    print_list(&mut terminal::out()).map_err(Failure::output)
}

fn print_list(out: &mut impl Write) -> io::Result<()> {
    for sheet in MOTORS {
        writeln!(out, "{:14} {}", sheet.id, sheet.name)?;
        writeln!(
            out,
            "{:14} {} deg, {} ohm, {} mH, rotor {} g*cm^2, detent {} mN*m, friction {} mN*m, viscous {} uN*m*s",
            "",
            sheet.full_step_deg,
            sheet.resistance_ohm,
            sheet.inductance_mh,
            sheet.rotor_inertia_g_cm2,
            sheet.detent_torque_mn_m,
            sheet.friction_mn_m,
            sheet.viscous_un_m_s
        )?;
        print_sources(out, sheet.source, sheet.typical)?;
    }
    writeln!(out, "\ndrivers")?;
    for sheet in DRIVES {
        let drive = &sheet.drive;
        writeln!(out, "{:14} {}", sheet.id, sheet.name)?;
        writeln!(
            out,
            "{:14} {}, {} decay, fast share {}, off {} us, blank {} us, bridge {} ohm, diode {} V{}",
            "",
            json_text(&drive.regulator),
            json_text(&drive.decay),
            drive.decay_share,
            drive.off_us,
            drive.blank_us,
            drive.bridge_ohm,
            drive.diode_v,
            drive.dac_levels.map(|levels| format!(", converter of {levels} steps")).unwrap_or_default()
        )?;
        print_sources(out, sheet.source, sheet.typical)?;
    }
    Ok(())
}

/// The value as in a scenario's JSON.
fn json_text(value: &impl Compact) -> String {
    value.compact().as_str().unwrap_or_default().to_owned()
}

fn print_sources(out: &mut impl Write, source: &str, typical: &[&str]) -> io::Result<()> {
    writeln!(out, "{:14} {source}", "")?;
    writeln!(out, "{:14} typical values, not from the data sheet: {}", "", typical.join(", "))
}
