//! `stepscope measures` in scripts.

use crate::program::stepscope;

const MOTION: &str = r#"{ "bus": { "channels": 2 }, "source": { "motion": { "axes": [
    { "moves": [ { "constant": { "distance": { "steps": 100 }, "speed": { "steps_s": 1000 } } } ] },
    { "moves": [ { "sine_segments": { "amplitude": { "steps": 1000 }, "max_deviation": 0.006, "period_s": 0.5, "periods": 2 } } ] } ] } },
    "analysis": { "order": 99, "fft_length": 1000, "sensor_hz": 40 } }"#;

fn measures(options: &[&str], input: &str) -> (Option<i32>, String, String) {
    stepscope(&[&["measures", "-"], options].concat(), input)
}

#[test]
fn the_three_formats_have_the_same_figures() {
    let (code, json, err) = measures(&["--axis", "1", "--format", "json"], MOTION);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let json: serde_json::Value = serde_json::from_str(&json).expect("it is JSON");
    assert_eq!(json["axis"], 1);
    let (_, csv, _) = measures(&["--axis", "1", "--format", "csv"], MOTION);
    let mut reader = csv::Reader::from_reader(csv.as_bytes());
    let rows: Vec<Vec<String>> =
        reader.records().map(|row| row.expect("a row").iter().map(str::to_owned).collect()).collect();
    let (_, text, _) = measures(&["--axis", "1"], MOTION);
    // Group, measure, column; path in JSON, factor.
    let checks = [
        (["deviation", "rms", "ideal_to_steps"], "/steps/rms_steps", 1.0),
        (["deviation", "one_minus_correlation", "ideal_to_pulses"], "/pulses/uncorrelated", 1.0),
        (["deviation", "area_between", "steps_to_pulses"], "/ticks/area_steps_s", 1.0),
        (["deviation", "euclidean_distance", "ideal_to_pulses"], "/pulses/euclidean_steps", 1.0),
        (["pulses", "largest_time_error", "steps_to_pulses"], "/tick_errors/largest_s", 1e6),
        (["duration", "requested", ""], "/duration/requested_s", 1.0),
        (["peaks", "start_stop_rate", ""], "/peaks/start_stop_steps_s", 1.0),
        (["distortion", "acceleration_filtered", "ideal"], "/distortion/acceleration_filtered/ideal", 100.0),
        (["sine", "euclidean_per_amplitude", "sine_to_segments"], "/sine/euclidean", 1.0),
    ];
    for (names, pointer, factor) in checks {
        let row = rows.iter().find(|row| row[..3] == names);
        let Some(row) = row else { panic!("{names:?} in {csv}") };
        let found: f64 = row[3].parse().expect("a number");
        let expected = json.pointer(pointer).and_then(serde_json::Value::as_f64).expect("a number") * factor;
        assert!(found == expected && found != 0.0, "{names:?}: {found} {expected}");
        let words = names[1].replace('_', " ");
        assert!(text.lines().any(|line| line.trim_start().starts_with(&words)), "{names:?} in {text}");
    }
    // The published segments, and the requested order.
    assert_eq!((&json["sine"]["segments"], &json["distortion"]["order"]), (&6.into(), &99.into()));
    let ratio = |name: &str| json["distortion"][name]["ideal"].as_f64().expect("a ratio");
    assert!(ratio("position") < ratio("speed") && ratio("speed") < ratio("acceleration_filtered"));
    assert!(ratio("acceleration_filtered") < ratio("acceleration"));
}

#[test]
fn rejects_too_many_steps_before_the_run() {
    let sine = |steps: u32| {
        let sine = format!(r#"{{"sine":{{"amplitude":{{"steps":{steps}}},"period_s":1000,"periods":1}}}}"#);
        format!(
            r#"{{"bus":{{"channels":2}},"source":{{"motion":{{"axes":[{{"moves":[{sine}]}},{{"moves":[{sine}]}}]}}}}}}"#
        )
    };
    // 4 times the amplitude on each of two axes.
    let (code, out, err) = measures(&[], &sine(2_500_001));
    assert_eq!((code, out.as_str()), (Some(2), ""));
    let expected = "20000008 steps to be measured exceed the maximum of 20000000; use a shorter motion";
    assert!(err.contains(expected), "{err}");
}

#[test]
fn a_motion_without_a_period_has_no_distortion() {
    let (code, text, err) = measures(&[], MOTION);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(!text.contains("THD") && !text.contains("sine"), "{text}");
    let rows: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("deviation over 0.1 s")).collect();
    let ends: Vec<usize> = rows[..10].iter().map(|row| row.len()).collect();
    assert!(ends.iter().all(|end| *end == ends[0]), "{ends:?} in {text}");
    assert!(rows[1].contains(" 0.5"), "half a step: {}", rows[1]);
}

#[test]
fn explains_why_nothing_can_be_measured() {
    let rows: [(&[&str], &str, &str); 3] = [
        (
            &["--axis", "2"],
            MOTION,
            "--axis: 2 is out of range; the scenario has axes 0 to 1; use --axis 0 to 1",
        ),
        (&[], r#"{ "source": { "line": {} } }"#, "source: this channel makes no step"),
        (&[], r#"{ "analysis": { "sensor_hz": -1 } }"#, "analysis.sensor_hz: -1 Hz is out of range"),
    ];
    for (options, scenario, part) in rows {
        let (code, out, err) = measures(options, scenario);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{options:?}: {err}");
        assert!(err.contains(part), "{options:?}: {err}");
    }
}

#[test]
fn lists_the_published_segments_of_a_sine() {
    let (code, text, err) = stepscope(&["sine", "segments", "sine-2022-d00054"], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    let [head, rows @ ..] = rows.as_slice() else { panic!("{text}") };
    let column = |name: &str| {
        let place =
            head.iter().position(|each| *each == name).unwrap_or_else(|| panic!("no {name}: {head:?}"));
        rows.iter().map(|row| row[place].parse::<f64>().expect("a number")).collect::<Vec<_>>()
    };
    // SWorldJournal, issue 11: breakpoints of 2048 per period.
    assert_eq!(column("from_point"), [0.0, 67.0, 136.0, 208.0, 287.0, 381.0]);
    assert_eq!(column("to_point"), [67.0, 136.0, 208.0, 287.0, 381.0, 512.0]);
    for (steps, (rate, lasts)) in
        column("steps").iter().zip(column("rate_steps_s").iter().zip(column("duration_s")))
    {
        assert!((steps - rate * lasts).abs() < 1e-9 * steps, "{text}");
    }

    let (_, json, _) = stepscope(&["sine", "segments", "sine-2022-d00054", "--json"], "");
    let json: serde_json::Value = serde_json::from_str(&json).expect("it is JSON");
    let first = &json["tables"]["segments"][0];
    assert_eq!((&first["to_point"], &first["to_deg"]), (&67.into(), &(67.0 * 360.0 / 2048.0).into()));
    assert_eq!(first["steps"], column("steps")[0] as u64);

    for (arguments, expected) in [
        (["sine", "segments", "exact-sine"].as_slice(), "no move is a sine of segments"),
        (&["sine", "segments", "sine-2022-d00054", "--axis", "3"], "axis"),
    ] {
        let (code, _, err) = stepscope(arguments, "");
        assert!(code != Some(0) && err.contains(expected), "{arguments:?}: {err}");
    }
}

/// The motion has too many steps to plan, so each refusal below comes before planning.
#[test]
fn reports_missing_parts_before_planning() {
    const LONG: &str = r#"{ "source": { "motion": { "axes": [
        { "moves": [ { "constant": { "distance": { "steps": 1e9 }, "speed": { "steps_s": 1000 } } } ] } ] } } }"#;
    let (code, _, err) = stepscope(&["run", "-", "--digest"], LONG);
    assert!(code == Some(2) && err.contains("source.motion"), "{err}");
    let rows: [(&[&str], &str); 10] = [
        (&["sine", "segments", "-"], "no move is a sine of segments"),
        (&["sine", "segments", "-", "--axis", "7"], "--axis: 7 is out of range"),
        (&["powercut", "-"], "has no stand-alone controller"),
        (&["plant", "-"], "has no plant"),
        (&["limits", "-"], "has no plant"),
        (&["settling", "-"], "has no plant"),
        (&["run", "-", "--panel", "panel.txt"], "--panel: the scenario has no"),
        (&["run", "-", "--timing"], "has no driver"),
        (&["measures", "-", "--axis", "7"], "--axis: 7 is out of range"),
        (&["torque", "-"], "has no motor"),
    ];
    for (arguments, expected) in rows {
        let (code, _, err) = stepscope(arguments, LONG);
        assert!(code == Some(2) && err.contains(expected), "{arguments:?}: {code:?} {err}");
    }
}
