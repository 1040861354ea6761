//! Scenarios that the command writes can be read again.

use crate::program::stepscope;
use std::{fs, path::PathBuf};
use stepscope_core::scenario::{
    Scenario,
    presets::{CONTROLLER_PLANT_PRESETS, CONTROLLER_PRESETS},
};

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("written-{name}"));
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Stand-alone controllers have no line, so the inputs are written.
#[test]
fn a_run_of_exported_inputs_is_the_same() {
    let folder = folder("stand-alone");
    for preset in CONTROLLER_PRESETS.iter().chain(CONTROLLER_PLANT_PRESETS) {
        let line = folder.join(format!("{}.json", preset.id)).display().to_string();
        let (code, out, err) = stepscope(&["run", preset.id, "--line", &line], "");
        assert_eq!((code, out.as_str()), (Some(0), ""), "{}: {err}", preset.id);
        let text = fs::read_to_string(&line).expect("it is written");
        assert!(text.contains("\"standalone\""), "{}: {text}", preset.id);
        let run = |scenario: &str| stepscope(&["run", scenario], "").1;
        assert_eq!(run(&line), run(preset.id), "{}", preset.id);
    }
}

#[test]
fn writes_long_scenarios_short_enough_to_be_read() {
    let folder = folder("long");
    let line = folder.join("line.json").display().to_string();
    let motion = r#"{"source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":45000},"speed":{"steps_s":500}}}]}]}}}"#;
    let (code, out, err) = stepscope(&["run", "-", "--line", &line], motion);
    assert_eq!((code, out.as_str(), err.as_str()), (Some(0), "", ""));
    let text = fs::read_to_string(&line).expect("it is written");
    let scenario = Scenario::from_json(&text).expect("it reads");
    let whole = scenario.to_json();
    assert!(whole.len() > 4 << 20 && text.len() < whole.len() / 2, "{} of {} bytes", text.len(), whole.len());
    // A short one has every field.
    let (_, out, _) = stepscope(&["points", "-", "--straight"], "0,0\n1,5\n");
    assert_eq!(out, Scenario::from_json(&out).expect("it reads").to_json() + "\n");
}
