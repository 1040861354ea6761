//! `stepscope torque` and `stepscope calibrate` in scripts.

use crate::program::stepscope;

fn axes(axes: &str) -> String {
    format!(r#"{{"bus":{{"channels":2}},"source":{{"motion":{{"axes":[{axes}]}}}}}}"#)
}

#[test]
fn reports_enough_torque_and_the_longest_ramp() {
    let scenario = axes(r#"{"moves":[{"cosine":{}}],"motor":{"working_rate_hz":19200}},{}"#);
    let (code, out, err) = stepscope(&["torque", "-"], &scenario);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let expected = "\
axis 0
  full torque      282.8 mN*m, up to 30945 steps/s
  maximum rate     not limited by torque (load 0.0 mN*m)
  working rate     19200 steps/s, as specified
  minimum margin   281.7 mN*m: at 0.100000 s, 8000 steps/s, 1.1 needed of 282.8 mN*m
  enough torque throughout
  move 0           3200 steps in 0.4 s
    under 19200 steps/s  a ramp of at most 0.2333 s; the longest possible is 0.2000 s
    enough torque with ramps of 0.0004 to 0.2000 s
";
    assert_eq!(out, expected);
}

#[test]
fn warns_of_a_torque_shortage_with_numbers_and_a_remedy() {
    let scenario = axes(
        r#"{},{"moves":[{"cosine":{}},{"trapezoid":{}}],"motor":{"load_inertia_g_cm2":9955,"load_torque_mn_m":100}}"#,
    );
    let (code, out, _) = stepscope(&["torque", "-"], &scenario);
    assert_eq!(code, Some(0), "a warning is no error");
    for line in [
        "  minimum margin   -63.9 mN*m: at 0.100000 s, 8000 steps/s, 346.7 needed of 282.8 mN*m",
        "  jump of speed    250 steps/s at once; the start-stop rate must be higher",
        "  warning: too little torque in 1 interval; allow more time, or use gentler ramps, less load or a higher supply voltage",
        "    0.053133 to 0.146867 s: 63.9 mN*m short at 0.100000 s, 8000 steps/s, 346.7 needed of 282.8 mN*m",
        "    no ramp leaves enough torque; allow more time or reduce the load",
    ] {
        assert!(out.lines().any(|found| found == line), "{line}\nis not in\n{out}");
    }
    let (code, _, err) = stepscope(&["torque", "-", "--axis", "0"], &scenario);
    assert_eq!(code, Some(2));
    assert!(err.contains("source.motion.axes[0].motor: the axis has no motor; use --motor"), "{err}");
    assert_eq!(stepscope(&["torque", "-", "--axis", "2"], &scenario).0, Some(2));
    let direct = axes(r#"{"mechanics":{"direct":{}},"motor":{}}"#);
    let (code, _, err) = stepscope(&["torque", "-"], &direct);
    assert!(code == Some(2) && err.contains("use rotary, wheel or screw"), "{err}");
}

#[test]
fn compares_the_torque_curve_with_the_plant() {
    let (code, out, err) = stepscope(&["torque", "song-2021-motor"], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(out.contains("\n  plant            follows; both models agree\n"), "{out}");
    let (_, out, _) = stepscope(&["torque", "song-2021-stall"], "");
    let line = "  plant            loses 188 full steps, first at 2.73 ms in step 53; the models differ\n    the speed jumps by ";
    assert!(out.contains(line), "{out}");
    let (_, out, _) = stepscope(&["torque", "song-2021-stall", "--json"], "");
    let json: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(json["tables"]["axes"][0]["models_agree"], false);
    // Without a plant, --plant simulates one, and its problems are reported.
    let scenario = axes(r#"{"motor":{}},{"motor":{"supply_v":36}}"#);
    let (_, out, _) = stepscope(&["torque", "-"], &scenario);
    assert!(!out.contains("plant"), "{out}");
    let (code, _, err) = stepscope(&["torque", "-", "--plant"], &scenario);
    assert!(code == Some(2) && err.contains("36 V, but the first motor has 24 V"), "{err}");
    let (_, out, _) = stepscope(&["torque", "-", "--plant"], &axes(r#"{"motor":{}},{"motor":{}}"#));
    assert_eq!(out.matches("follows; both models agree").count(), 2, "{out}");
    // A broken or long plant runs only on request.
    let scenario = r#"{"plant":{"source_ohm":0},"source":{"motion":{"axes":[{"motor":{}}]}}}"#;
    let (code, out, _) = stepscope(&["torque", "-"], scenario);
    assert!(
        code == Some(0) && out.contains("  plant            not run: the scenario has problems"),
        "{out}"
    );
    let scenario = r#"{"run_cycles":10000000000,"plant":{},"source":{"motion":{"axes":[{"motor":{}}]}}}"#;
    let (code, out, _) = stepscope(&["torque", "-"], scenario);
    assert!(
        code == Some(0) && out.contains("grid steps of all motors; use --plant to run it anyway"),
        "{out}"
    );
}

#[test]
fn names_the_limit_of_ramps() {
    let of = |moved: &str, motor: &str| {
        let (code, out, err) =
            stepscope(&["torque", "-"], &axes(&format!(r#"{{"moves":[{moved}],"motor":{motor}}}"#)));
        assert_eq!((code, err.as_str()), (Some(0), ""));
        out
    };
    let by_rate = "    the torque would suffice for ramps of 0.0004 to 0.2000 s, but those exceed the working rate; allow more time\n";
    let out = of(r#"{"cosine":{"ramp_s":0}}"#, r#"{"working_rate_hz":8000}"#);
    let without = "    enough torque without ramps, if the motor starts and stops at that rate\n";
    assert!(
        out.contains("  enough torque throughout\n") && out.contains(&(without.to_owned() + by_rate)),
        "{out}"
    );
    let out = of(r#"{"cosine":{"ramp_s":0.1}}"#, r#"{"working_rate_hz":8000}"#);
    assert!(out.contains("above the working rate of 8000 steps/s") && out.contains(by_rate), "{out}");
    assert!(!out.contains("no ramp"), "{out}");
    let out = of(r#"{"cosine":{}}"#, r#"{"load_torque_mn_m":1e6}"#);
    assert!(out.contains("  maximum rate     none with a load of 1000000.0 mN*m\n"), "{out}");
    assert!(
        out.contains("    the load needs more torque than the motor has at any rate; reduce the load\n"),
        "{out}"
    );
    assert!(!out.contains("inf"), "{out}");
    // 0.1 V drives no current at this rate.
    let out = of(r#"{"constant":{"speed":{"steps_s":100000}}}"#, r#"{"supply_v":0.1}"#);
    assert!(
        out.contains("  standing torque  11.8 mN*m; the supply is too low for the whole current"),
        "{out}"
    );
    assert!(out.contains("  maximum rate     271 steps/s with a load of 0.0 mN*m\n"), "{out}");
    assert!(
        out.contains("  warning: too little torque in 1 interval") && !out.contains("throughout"),
        "{out}"
    );
}

#[test]
fn the_torque_curve_starts_at_full_torque_and_falls() {
    let scenario = axes(r#"{"motor":{}}"#);
    let (code, out, _) = stepscope(&["torque", "-", "--format", "csv"], &scenario);
    assert_eq!(code, Some(0));
    let mut lines = out.lines();
    assert_eq!(lines.next(), Some("rate_hz,available_mn_m"));
    let rows: Vec<(f64, f64)> = lines
        .map(|line| line.split_once(',').expect("two columns"))
        .map(|(rate, torque)| (rate.parse().expect("a rate"), torque.parse().expect("a torque")))
        .collect();
    assert_eq!((rows.len(), rows[0]), (201, (0.0, 282.842_712)));
    assert!(rows.windows(2).all(|pair| pair[1].0 > pair[0].0 && pair[1].1 <= pair[0].1));
    assert!(rows[200].1 < 200.0);
}

#[test]
fn fits_steps_per_millimeter_and_prints_mechanics() {
    let table = "length_cm, steps\n10,5650\n30.5,17232.5\n45,25425\n";
    let (code, out, err) = stepscope(&["calibrate", "-"], table);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(out.contains("  k                 56.500000 steps/mm, 0.017699115 mm per step\n"), "{out}");
    assert!(out.contains("  offset            0.000 steps, 0.000000 mm\n"), "{out}");
    let mechanics = out.lines().last().expect("a last line");
    // The result is valid in a scenario.
    let scenario = axes(&format!(r#"{{{mechanics},"moves":[{{"cosine":{{"distance":{{"mm":100}}}}}}]}}"#));
    let (code, status, _) = stepscope(&["run", "-"], &scenario);
    assert_eq!(code, Some(0));
    assert!(status.contains("5650"), "{status}");
}

#[test]
fn prints_very_few_steps_per_millimeter_with_all_digits() {
    let (code, out, _) = stepscope(&["calibrate", "-"], "length_mm,steps\n0,0\n1e12,1\n");
    assert_eq!(code, Some(0));
    assert!(
        out.contains("  k                 1.000000000e-12 steps/mm, 1.000000000e12 mm per step\n"),
        "{out}"
    );
}

#[test]
fn rejects_tables_that_fix_no_line() {
    for (table, expected) in [
        ("a,b\n1,2\n", "no column has lengths; use a first row"),
        ("length_mm\n1\n", "there is no column steps; use a first row"),
        ("length_mm,steps\n1,2\n", "1 pair of length and steps; use at least 2"),
        ("length_mm,steps\n1,2\n1,3\n", "all pairs have length 1; add a pair with another length"),
        (
            "length_mm,steps\n1e-200,1\n2e-200,2\n",
            "pair 1 has length 1e-200 and 1.0 steps; use numbers from 1e-12",
        ),
        (
            "length_mm,steps\n1,2\n2,x\n",
            "line 3: steps: \"x\" is not a number; use digits and a decimal point",
        ),
        (
            "length_mm,steps\n1,2\n2,nan\n",
            "line 3: steps: \"nan\" is not a number; use digits and a decimal point",
        ),
    ] {
        let (code, _, err) = stepscope(&["calibrate", "-"], table);
        assert_eq!(code, Some(2), "{table}");
        assert!(err.contains(expected), "{err}");
    }
}

/// A turn of 3200 steps as segments, on two channels.
fn lists(plant: &str) -> String {
    let motion = r#"{"bus":{"channels":2},"source":{"motion":{"engine":"segments","axes":[{},{}]}}}"#;
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("torque_lists.csv");
    let table = path.to_str().expect("a name");
    assert_eq!(stepscope(&["run", "-", "--csv", table], motion).0, Some(0));
    let (code, out, err) = stepscope(&["capture", table, "--sample-rate", "16000000", "--scenario", "-"], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    out.trim_end().strip_suffix('}').expect("an object").to_owned() + plant + "}"
}

#[test]
fn checks_steps_without_a_motion_against_a_motor() {
    let (code, _, err) = stepscope(&["torque", "-"], &lists(""));
    assert!(
        code == Some(2) && err.contains("plant: the scenario has no motor; use --motor, or \"plant\": {}"),
        "{err}"
    );
    let heavy = r#","plant":{"motors":[{},{"motor":{"load_inertia_g_cm2":9955,"load_torque_mN_m":100}}]}"#;
    let (code, out, err) = stepscope(&["torque", "-"], &lists(heavy));
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let (light, heavy_lines) = out.split_once("channel 1: ").expect("both channels");
    assert!(light.starts_with("channel 0: the scenario has no motion, so the steps themselves are checked, over the rotor's natural period of 3.544 ms\n"), "{out}");
    for line in ["  enough torque throughout\n", "  plant            follows; both models agree\n"] {
        assert!(light.contains(line), "{line}{out}");
    }
    assert!(heavy_lines.contains("  warning: too little torque in 1 interval"), "{out}");
    assert!(heavy_lines.contains("  plant            loses "), "{out}");
    assert!(heavy_lines.contains("both models agree"), "{out}");

    // A named motor at other microsteps, without a plant, on one channel.
    let named = ["torque", "-", "--motor", "nema-8", "--microsteps", "2", "--axis", "1"];
    let (code, out, err) = stepscope(&named, &lists(""));
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(out.starts_with("channel 1: ") && !out.contains("channel 0") && !out.contains("plant"), "{out}");
    assert!(out.contains("  full torque      12.7 mN*m, up to "), "{out}");
    let (_, json, _) = stepscope(&[&named[..], &["--json"]].concat(), &lists(""));
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let row = &json["tables"]["axes"][0];
    assert!(row["axis"] == 1 && row["window_s"].as_f64().is_some_and(|window_s| window_s < 0.01), "{row}");
    let (_, csv, _) = stepscope(&["torque", "-", "--motor", "nema-8", "--format", "csv"], &lists(""));
    assert!(csv.starts_with("rate_hz,available_mn_m\n0.000,12.7"), "{csv}");

    let rows: [(&[&str], &str, &str); 4] = [
        (&["--axis", "2"], "", "--axis: 2 is out of range"),
        (&["--motor", "nema-9"], "", "a similar value exists"),
        (&["--microsteps", "4"], "", "--motor"),
        (
            &["--axis", "1", "--motor", "nema-8"],
            r#","bus":{"channels":2},"source":{"line":{}}"#,
            "source: the selected channels make no step",
        ),
    ];
    for (options, scenario, expected) in rows {
        let scenario = if scenario.is_empty() { lists("") } else { format!("{{{}}}", &scenario[1..]) };
        let (code, _, err) = stepscope(&[&["torque", "-"], options].concat(), &scenario);
        assert!(code == Some(2) && err.contains(expected), "{options:?}: {err}");
    }
    let (code, _, err) =
        stepscope(&["torque", "-", "--motor", "nema-8", "--microsteps", "4"], &axes(r#"{"motor":{}},{}"#));
    assert!(code == Some(2) && err.contains("the axes of a motion have their own microsteps"), "{err}");
    // For a motion the named motor replaces those of its axes.
    let (_, out, _) = stepscope(&["torque", "-", "--motor", "nema-8"], &axes("{},{}"));
    assert_eq!(out.matches("  full torque      12.7 mN*m").count(), 2, "{out}");
}
