//! `stepscope steps`, `curve`, `spectrum` and `schema` in scripts.

use crate::program::stepscope;
use serde_json::Value;
use std::{fs, path::PathBuf, process::Command};
use stepscope_core::{prelude::*, sim};

const MOTION: &str = r#"{ "bus": { "channels": 2 }, "source": { "motion": { "axes": [
    { "moves": [ { "constant": { "distance": { "steps": 100 }, "speed": { "steps_s": 1000 } } } ] },
    { "moves": [ { "sine_segments": { "amplitude": { "steps": 1000 }, "max_deviation": 0.006, "period_s": 0.5, "periods": 2 } } ] } ] } },
    "analysis": { "max_harmonic": 9 } }"#;

fn printed(arguments: &[&str], input: &str) -> String {
    let (code, out, err) = stepscope(arguments, input);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{arguments:?}");
    out
}

fn json(arguments: &[&str], input: &str) -> Value {
    serde_json::from_str(&printed(&[arguments, &["--format", "json"]].concat(), input)).expect("JSON")
}

/// Header and rows of a table.
fn table(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let head = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    let number = |text: &str| text.parse().expect("a number");
    (head, reader.records().map(|row| row.expect("a row").iter().map(number).collect()).collect())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(|value| value.as_f64().expect("a number")).collect()
}

#[test]
fn steps_come_from_the_run_or_the_plan() {
    let scenario: Scenario = MOTION.parse().expect("it reads");
    let run = run(&scenario).expect("it runs");
    for axis in [0_u8, 1] {
        let of_axis = axis.to_string();
        let (head, rows) = table(&printed(&["steps", "-", "--axis", &of_axis], MOTION));
        assert_eq!(head, ["cycle", "time_s", "direction"]);
        let steps = run.steps(axis);
        assert_eq!(rows.len(), steps.len());
        for (index, (row, step)) in rows.iter().zip(&steps).enumerate() {
            let direction = Step::direction(&steps, index);
            assert_eq!(row, &[step.cycle as f64, step.cycle as f64 / 16e6, f64::from(direction)]);
        }
        let planned = json(&["steps", "-", "--planned", "--axis", &of_axis], MOTION);
        let due = step_times(&scenario, axis.into()).expect("a plan");
        assert_eq!(numbers(&planned["cycle"]), due.iter().map(|step| step.cycle as f64).collect::<Vec<_>>());
        let directions: Vec<f64> = due.iter().map(|step| if step.right { 1.0 } else { -1.0 }).collect();
        assert_eq!(numbers(&planned["direction"]), directions);
        assert_eq!((&planned["axis"], &planned["clock_hz"]), (&axis.into(), &16_000_000.into()));
    }
    // Steps without a motion, and the table as an input.
    let packets = r#"{"source":{"packets":{"packets":["83","02"]}}}"#;
    let steps = printed(&["steps", "-"], packets);
    assert_eq!(table(&steps).1.iter().map(|row| row[2]).collect::<Vec<_>>(), [1.0, 1.0, 1.0, -1.0, -1.0]);
    assert!(printed(&["tables", "--steps", "-"], &steps).contains("exact"));
}

#[test]
fn numpy_reads_the_same_steps() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("axis-data");
    fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("steps.npy");
    printed(&["steps", "-", "--axis", "1", "--format", "npy", "-o", &path.display().to_string()], MOTION);
    let bytes = fs::read(&path).expect("it is written");
    let length = usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = std::str::from_utf8(&bytes[10..10 + length]).expect("text");
    let (_, rows) = table(&printed(&["steps", "-", "--axis", "1"], MOTION));
    let fields = "('cycle', '<i8'), ('time_s', '<f8'), ('direction', '|i1')";
    let expected = format!("{{'descr': [{fields}], 'fortran_order': False, 'shape': ({},), }}", rows.len());
    assert_eq!((&bytes[..8], header.trim_end()), (&b"\x93NUMPY\x01\x00"[..], expected.as_str()));
    assert!((10 + length).is_multiple_of(64) && header.ends_with('\n'));
    let records: Vec<&[u8]> = bytes[10 + length..].chunks(17).collect();
    assert_eq!(records.len(), rows.len());
    for (record, row) in records.iter().zip(&rows) {
        let number = |at: usize| <[u8; 8]>::try_from(&record[at..at + 8]).expect("eight bytes");
        assert_eq!(i64::from_le_bytes(number(0)) as f64, row[0]);
        assert_eq!(f64::from_le_bytes(number(8)), row[1]);
        assert_eq!(f64::from(i8::from_le_bytes([record[16]])), row[2]);
    }
    let script = "import numpy, sys; a = numpy.load(sys.argv[1]); print(len(a), a['cycle'].sum(), a['direction'].sum())";
    let output = Command::new("python3").args(["-c", script]).arg(&path).output();
    // Where NumPy is installed, it reads the file.
    if let Some(output) = output.ok().filter(|output| output.status.success()) {
        let sum = |column: usize| rows.iter().map(|row| row[column] as i64).sum::<i64>();
        let expected = format!("{} {} {}\n", rows.len(), sum(0), sum(2));
        assert_eq!(String::from_utf8_lossy(&output.stdout), expected);
    }
}

#[test]
fn a_curve_samples_the_plan_at_equal_intervals() {
    let experiment = sim::Experiment::from_json(MOTION).expect("it runs");
    let plan = &experiment.plans()[1];
    let (head, rows) = table(&printed(&["curve", "-", "--axis", "1", "--points", "11"], MOTION));
    assert_eq!(head, ["time_s", "position", "speed", "acceleration"]);
    assert_eq!((rows.len(), rows[0][0], rows[10][0]), (11, 0.0, plan.duration_s()));
    for row in &rows {
        let time_s = row[0];
        assert_eq!(row[1..], [plan.position(time_s), plan.speed(time_s), plan.acceleration(time_s)]);
    }
    let curve = json(&["curve", "-", "--axis", "1", "--points", "11"], MOTION);
    for (column, name) in head.iter().enumerate() {
        assert_eq!(numbers(&curve[name]), rows.iter().map(|row| row[column]).collect::<Vec<_>>());
    }
    assert_eq!(printed(&["curve", "-"], "{}").lines().count(), 1 + 1000);
}

#[test]
fn spectrum_and_measures_agree_on_distortion() {
    let measures = json(&["measures", "-", "--axis", "1"], MOTION);
    for of in ["ideal", "pulses"] {
        let spectrum = json(&["spectrum", "-", "--axis", "1", "--of", of], MOTION);
        for quantity in ["position", "speed", "acceleration"] {
            assert_eq!(spectrum[format!("{quantity}_thd")], measures["distortion"][quantity][of], "{of}");
            assert_eq!(numbers(&spectrum[quantity]).len(), 9, "the scenario's order");
        }
        assert_eq!(numbers(&spectrum["frequency_hz"])[..2], [2.0, 4.0]);
        assert_eq!((&spectrum["period_s"], &spectrum["periods"]), (&0.5.into(), &2.into()));
        assert!(spectrum["start_s"].is_number());
    }
    let (head, rows) = table(&printed(&["spectrum", "-", "--axis", "1"], MOTION));
    assert_eq!((head.join(","), rows.len()), ("frequency_hz,position,speed,acceleration".to_owned(), 9));
    // A motion that does not repeat has no distortion.
    assert_eq!(json(&["spectrum", "-"], "{}")["position_thd"], Value::Null);
}

#[test]
fn an_axis_without_a_plan_or_a_motion_is_rejected() {
    let packets = r#"{"source":{"packets":{"packets":["83"]}}}"#;
    let idle = r#"{"source":{"packets":{"packets":["00"]}}}"#;
    let rows: &[(&[&str], &str, &str)] = &[
        (&["curve", "-"], packets, "source: only a motion has a plan; use a source of kind motion"),
        (&["steps", "-", "--planned"], packets, "source: only a motion has a plan"),
        (
            &["steps", "-", "--planned"],
            r#"{"source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":24000001},"speed":{"steps_s":40000}}}]}]}}}"#,
            "source: the axis has more than 24000000 planned steps; use a shorter motion",
        ),
        (&["spectrum", "-", "--of", "ideal"], packets, "source: only a motion has a plan"),
        (
            &["steps", "-", "--axis", "1"],
            packets,
            "--axis: 1 is out of range; the scenario has only channel 0",
        ),
        (&["spectrum", "-"], idle, "the axis has no spectrum, because it does not move; use another --axis"),
        (&["steps", "-", "--format", "xml"], "{}", "invalid value 'xml' for '--format <FORMAT>'"),
    ];
    for (arguments, input, expected) in rows {
        let (code, out, err) = stepscope(arguments, input);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{arguments:?}: {err}");
        assert!(err.contains(expected), "{arguments:?}: {err}");
    }
    assert_eq!(printed(&["steps", "-"], idle), "cycle,time_s,direction\n");
}

#[test]
fn the_schema_is_valid_for_its_json_schema_draft() {
    let schema: Value = serde_json::from_str(&printed(&["schema"], "")).expect("JSON");
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
    assert_eq!(schema["$defs"]["Bus"]["properties"]["slots"]["maximum"], 127);
}
