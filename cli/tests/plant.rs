//! `stepscope plant`, `settling`, `limits` and `resonance` in scripts.

use crate::program::stepscope;
use serde_json::Value;
use std::fs;
use vcd::{Command, Parser};

#[test]
fn the_summary_reports_whether_each_motor_follows() {
    let (code, out, err) = stepscope(&["plant", "song-2021-stall"], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    for line in [
        "motor 0          loses 188 full steps, first at 2.73 ms in step 53",
        "bus              24.000 to 24.000 V",
    ] {
        assert!(out.lines().any(|found| found == line), "{line}\nis not in\n{out}");
    }
    assert!(out.starts_with("plant digest     "), "{out}");
    let (_, digest, _) = stepscope(&["plant", "song-2021-stall", "--digest"], "");
    assert_eq!(format!("plant digest     {digest}"), out.split_inclusive('\n').next().expect("a line"));
    let (_, out, _) = stepscope(&["plant", "patent-2019-overload"], "");
    assert!(out.contains("overload         in cycle "), "{out}");
}

#[test]
fn rejects_a_scenario_without_a_plant_with_a_remedy() {
    for command in ["plant", "settling", "limits", "resonance"] {
        let (code, out, err) = stepscope(&[command, "-"], "{}");
        assert_eq!((code, out.as_str()), (Some(2), ""));
        assert!(
            err.ends_with(
                "plant: the scenario has no plant, so there are no motors to simulate; add \"plant\": {}\n"
            ),
            "{err}"
        );
    }
    let (code, _, err) = stepscope(&["plant", "-"], r#"{"plant":{"source_ohm":0}}"#);
    assert!(code == Some(2) && err.contains("plant.source_ohm: 0 Ω is out of range"), "{err}");
    assert_eq!(stepscope(&["plant", "-", "--controller", "1"], r#"{"plant":{}}"#).0, Some(2));
    assert_eq!(stepscope(&["limits", "-", "--channel", "1"], r#"{"plant":{}}"#).0, Some(2));
    for options in [["limits", "--ramp", "0"], ["settling", "--share", "1"], ["resonance", "--step", "0"]] {
        let (code, _, err) = stepscope(&[options[0], "-", options[1], options[2]], r#"{"plant":{}}"#);
        assert!(code == Some(2) && err.contains(options[1]), "{err}");
    }
}

#[test]
fn accepts_listed_motors_and_drivers() {
    let (code, out, err) = stepscope(&["plant", "--motors"], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    for word in ["17hs4401       NEMA 17, MotionKing", "\ndrivers\n", "\ntmc2209 "] {
        assert!(out.contains(word), "{word}\n{out}");
    }
    let (_, out, _) = stepscope(&["plant", "--motors", "--json"], "");
    let tables = serde_json::from_str::<Value>(&out).expect("JSON")["tables"].clone();
    assert_eq!(tables["motors"][0]["id"], "song-2021");
    assert_eq!(tables["drives"][1]["decay"], "auto");
    // The listed default motor with another driver.
    let digest =
        |options: &[&str]| stepscope(&[&["plant", "song-2021-motor", "--digest"], options].concat(), "").1;
    assert_eq!(digest(&["--motor", "song-2021", "--drive", "ideal"]), digest(&[]));
    assert_ne!(digest(&["--motor", "17hs4401"]), digest(&[]));
    assert_ne!(digest(&["--drive", "a4988"]), digest(&[]));
    // The larger rotor cannot start as fast.
    let limits = |motor: &str| -> f64 {
        let (code, out, err) = stepscope(&["limits", "-", "--json", "--motor", motor], r#"{"plant":{}}"#);
        assert_eq!((code, err.as_str()), (Some(0), ""));
        let json: Value = serde_json::from_str(&out).expect("JSON");
        json["tables"]["limits"][0]["start_stop_steps_s"].as_f64().expect("a rate")
    };
    assert!(limits("as1060") < 0.6 * limits("song-2021"));
    for (option, expected) in [("--motor", "invalid value"), ("--drive", "possible values: ideal")] {
        let (code, _, err) = stepscope(&["resonance", "-", option, "none"], r#"{"plant":{}}"#);
        assert!(code == Some(2) && err.contains(expected), "{err}");
    }
    assert_eq!(stepscope(&["plant", "-", "--motors"], r#"{"plant":{}}"#).0, Some(2));
}

#[test]
fn warns_of_a_grid_too_coarse_for_the_rotor() {
    let json = r#"{"plant":{},"source":{"motion":{"axes":[{"motor":{"sine_torque_mn_m":1000000,"sine_per_turn":1000}}]}}}"#;
    let (code, out, err) = stepscope(&["plant", "-"], json);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let warning =
        out.lines().find(|line| line.starts_with("  warning: the rotor moves ")).expect("a warning");
    assert!(warning.ends_with("the result is meaningless; use a smaller step_cycles than 80"), "{warning}");
    let (_, out, _) = stepscope(&["plant", "song-2021-stall"], "");
    assert!(!out.contains("warning"), "{out}");
}

#[test]
fn writes_points_as_a_table_and_as_real_variables() {
    let folder = tempfile::tempdir().expect("a folder");
    let (csv, dump) = (folder.path().join("points.csv"), folder.path().join("points.vcd"));
    let arguments = [
        "plant",
        "-",
        "--every",
        "100",
        "--csv",
        csv.to_str().expect("text"),
        "--vcd",
        dump.to_str().expect("text"),
    ];
    let (code, _, err) = stepscope(&arguments, r#"{"plant":{},"run_cycles":800000}"#);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let table = fs::read_to_string(csv).expect("it is written");
    let rows: Vec<&str> = table.lines().collect();
    assert_eq!(rows.len(), 1 + 100);
    assert!(
        rows[0].starts_with("cycle,time_s,bus_v,load_a,sensor_a,sensor_code,command0,rotor0,"),
        "{}",
        rows[0]
    );
    assert!(rows[1].starts_with("8000,0.0005,24,"), "{}", rows[1]);
    let bytes = fs::read(dump).expect("it is written");
    let mut parser = Parser::new(bytes.as_slice());
    let header = parser.parse_header().expect("a head");
    let rotor = header.find_var(&["stepscope", "rotor0"]).expect("a variable").code;
    let (mut times, mut last) = (vec![], None);
    for command in parser {
        match command.expect("it reads") {
            Command::Timestamp(time) => times.push(time),
            Command::ChangeReal(code, value) if code == rotor => last = Some(value),
            _ => {}
        }
    }
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]), "time goes back");
    let in_table: f64 = rows[100].split(',').nth(7).expect("a column").parse().expect("a number");
    assert_eq!(last, Some(in_table));
}

#[test]
fn plant_results_are_json_tables() {
    let tables = |arguments: &[&str], input: &str| {
        let (code, out, err) = stepscope(arguments, input);
        assert_eq!(code, Some(0), "{err}");
        serde_json::from_str::<Value>(&out).expect("JSON")["tables"].clone()
    };
    let plant = tables(&["plant", "song-2021-stall", "--json"], "");
    assert_eq!(plant["motors"][0]["lost_full_steps"], 188);
    assert_eq!(plant["slips"].as_array().expect("a list").len(), 47);
    let settling = tables(&["settling", "patent-2019-figure-2", "--json"], "");
    assert_eq!(settling["settling"].as_array().expect("a list").len(), 4);
    let limits = tables(&["limits", "-", "--json"], r#"{"plant":{}}"#);
    let rate = limits["limits"][0]["start_stop_steps_s"].as_f64().expect("a rate");
    assert!((rate - 34_700.0).abs() < 500.0, "{rate}");
    let map = tables(
        &["resonance", "resonance-full-steps", "--from", "200", "--to", "264", "--rung", "16", "--json"],
        "",
    );
    let loses: Vec<&Value> =
        map["resonance"].as_array().expect("a list").iter().map(|row| &row["loses_steps"]).collect();
    assert_eq!(loses, [false, true, true, true, false]);
}

#[test]
fn writes_the_settling_time_into_a_scenario() {
    let (code, out, err) = stepscope(&["settling", "patent-2019-figure-2", "--write", "-"], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let scenario: Value = serde_json::from_str(&out).expect("JSON");
    let cycles = scenario["bus"]["settle_cycles"].as_u64().expect("cycles");
    assert!((8144..8340).contains(&cycles), "{cycles}");
    assert_eq!(scenario["bus"]["channels"], 4);
}

#[test]
fn threads_do_not_change_the_map() {
    let map = |threads: &str| {
        stepscope(&["resonance", "-", "--to", "100", "--threads", threads], r#"{"plant":{}}"#).1
    };
    assert_eq!(map("1"), map("3"));
    assert_eq!(map("1").lines().count(), 1 + 21);
}

#[test]
fn plant_commands_print_progress_on_request() {
    for command in ["plant", "limits", "resonance", "settling"] {
        let (code, _, err) = stepscope(&[command, "-", "--progress"], r#"{"plant":{}}"#);
        assert_eq!(code, Some(0));
        assert!(err.starts_with(&format!("{command}: ")) && err.contains(" %"), "{err}");
    }
}
