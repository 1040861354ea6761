#![allow(clippy::expect_used, reason = "a missing file or program fails the test")]

use super::*;
use crate::plant::outcome::verdict;
use alloc::{format, string::String};
use std::{env, fs, path::Path};
use stepscope_scenario::Compact;
use stepscope_sim::{Experiment, plant_run::PlantRun};

/// The verdict on the motor of channel 0 after a slow move.
fn slow_move(change: impl FnOnce(&mut Scenario)) -> String {
    let mut scenario = Scenario::from_json(
        r#"{"plant":{},"source":{"motion":{"engine":"segments","axes":[
            {"moves":[{"cosine":{"distance":{"deg":18},"duration_s":0.1,"ramp_s":0.05}}]}]}}}"#,
    )
    .expect("reads");
    change(&mut scenario);
    let experiment = Experiment::new(&scenario).unwrap_or_else(|problems| panic!("{problems:?}"));
    let mut run = PlantRun::new(&experiment, vec![(Vec::new(), ())]).expect("a plant");
    run.finish();
    verdict(&run.results()[0].motors[0], 16_000_000, None)
}

#[test]
fn all_motors_and_drivers_follow_a_slow_move() {
    for sheet in MOTORS {
        assert_eq!(slow_move(|scenario| sheet.apply_to(scenario)), "follows", "{}", sheet.id);
    }
    for sheet in DRIVES {
        assert_eq!(slow_move(|scenario| sheet.apply_to(scenario)), "follows", "{}", sheet.id);
    }
}

#[test]
fn ids_are_unique() {
    let words: Vec<&str> = MOTORS.iter().map(|sheet| sheet.id).collect();
    for (index, sheet) in MOTORS.iter().enumerate() {
        assert!(!words[..index].contains(&sheet.id), "{} twice", sheet.id);
        assert_eq!(motor(sheet.id), Some(sheet));
        assert!(!sheet.name.is_empty() && !sheet.source.is_empty(), "{}", sheet.id);
    }
    for (index, sheet) in DRIVES.iter().enumerate() {
        assert!(DRIVES[..index].iter().all(|other| other.id != sheet.id), "{} twice", sheet.id);
        assert_eq!(drive(sheet.id), Some(sheet));
    }
}

#[test]
fn typical_figures_are_fields_of_the_scenario() {
    for (typical, path) in MOTORS
        .iter()
        .map(|sheet| (sheet.typical, ""))
        .chain(DRIVES.iter().map(|sheet| (sheet.typical, "driver")))
    {
        for field in typical {
            let inner = match path {
                "" => format!(r#"{{"{field}":1}}"#),
                _ => format!(r#"{{"{path}":{{"{field}":1}}}}"#),
            };
            let json = format!(r#"{{"version":3,"plant":{{"motors":[{{"motor":{inner}}}]}}}}"#);
            assert!(Scenario::from_json(&json).is_ok(), "{field}");
        }
    }
}

#[test]
fn motors_of_papers_equal_those_of_their_presets() {
    let default = Motor::default();
    assert_eq!(motor("song-2021").expect("listed").replacing(&default), default);
    assert_eq!(drive("ideal").expect("listed").drive, Drive::default());
    let presets = stepscope_scenario::presets::PLANT_PRESETS;
    let preset = presets.iter().find(|preset| preset.id == "patent-2019-figure-1").expect("it is there");
    let plant = preset.scenario().plant.expect("a plant");
    let given = &plant.motors[0].motor;
    assert_eq!(&motor("patent-2019").expect("listed").replacing(given), given);
}

#[test]
fn motors_are_replaced_and_supply_and_load_kept() {
    let json = r#"{"bus":{"channels":3},"plant":{"motors":[{"microsteps":2,"full_step_deg":0.9,"motor":{"supply_v":36}}]},
        "source":{"motion":{"axes":[
            {"motor":{"supply_v":36,"load_inertia_g_cm2":7,"peak_current_a":2,"drive":{"diode_v":1}}},
            {"mechanics":{"direct":{}}}, {}]}}}"#;
    let mut scenario = Scenario::from_json(json).expect("reads");
    motor("as1010").expect("listed").apply_to(&mut scenario);
    let setups = scenario.check().expect("holds").plants.expect("a plant").setups;
    let found: Vec<_> = setups[0]
        .motors
        .iter()
        .map(|m| {
            (
                m.inductance_mh,
                m.peak_current_a,
                m.full_step_deg,
                m.microsteps,
                m.load_inertia_g_cm2,
                m.drive.diode_v,
            )
        })
        .collect();
    let listed = (9.5, 1.0, 1.8, 2, 0.0, 0.7);
    assert_eq!(found, [(9.5, 1.0, 1.8, 16, 7.0, 1.0), listed, listed]);
    // Without a list the default motor of each channel changes; an axis keeps its mechanics.
    let mut scenario = Scenario::from_json(
        r#"{"bus":{"channels":2},"plant":{},"source":{"motion":{"axes":[{"mechanics":{"rotary":{"microsteps":8}}}]}}}"#,
    )
    .expect("reads");
    motor("as1010").expect("listed").apply_to(&mut scenario);
    let setups = scenario.check().expect("holds").plants.expect("a plant").setups;
    let found: Vec<_> = setups[0].motors.iter().map(|m| (m.inductance_mh, m.microsteps)).collect();
    assert_eq!(found, [(9.5, 8), (9.5, 16)]);
}

/// The tables of docs/motors.md.
fn markdown() -> String {
    let mut text = String::from(
        "| `--motor` | motor | A | Ω | mH | mN·m | g·cm² | detent mN·m | source; typical values |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for sheet in MOTORS {
        text += &format!(
            "| `{}` | {} | {} | {} | {} | {} | {} | {} | {}; {} |\n",
            sheet.id,
            sheet.name,
            sheet.rated_current_a,
            sheet.resistance_ohm,
            sheet.inductance_mh,
            sheet.holding_torque_mn_m,
            sheet.rotor_inertia_g_cm2,
            sheet.detent_torque_mn_m,
            sheet.source,
            code(sheet.typical)
        );
    }
    text += "\n| `--motor-driver` | driver | regulator, decay | fast share | off µs | blank µs | converter's steps | bridge Ω | diode V | \
             source; typical values |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for sheet in DRIVES {
        let Drive { regulator, decay, decay_share, off_us, blank_us, dac_levels, bridge_ohm, diode_v } =
            sheet.drive;
        let steps = dac_levels.map_or_else(|| "any".into(), |steps| format!("{steps}"));
        text += &format!(
            "| `{}` | {} | {}, {} | {decay_share} | {off_us} | {blank_us} | {steps} | {bridge_ohm} | {diode_v} | {}; {} |\n",
            sheet.id,
            sheet.name,
            word(&regulator),
            word(&decay),
            sheet.source,
            code(sheet.typical)
        );
    }
    text
}

/// The name in a scenario.
fn word(value: &impl Compact) -> String {
    value.compact().as_str().unwrap_or_default().into()
}

fn code(fields: &[&str]) -> String {
    fields.iter().map(|field| format!("`{field}`")).collect::<Vec<_>>().join(", ")
}

#[test]
fn tables_of_the_documentation_are_up_to_date() {
    const FROM: &str = "<!-- STEPSCOPE_BLESS=1 cargo test -p stepscope-inspect motors -->\n";
    const TO: &str = "<!-- end -->\n";
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/motors.md");
    let found = fs::read_to_string(&file).expect("docs/motors.md");
    let (before, rest) = found.split_once(FROM).expect("where the tables begin");
    let (_, after) = rest.split_once(TO).expect("where they end");
    let expected = format!("{before}{FROM}{}{TO}{after}", markdown());
    if env::var_os("STEPSCOPE_BLESS").is_some() {
        fs::write(&file, &expected).expect("docs/motors.md can be written");
    } else {
        assert!(
            found == expected,
            "docs/motors.md has other tables; STEPSCOPE_BLESS=1 cargo test -p stepscope-inspect writes them"
        );
    }
}
