//! The command in scripts: JSON, completions, manual pages, exit codes.

use crate::program::stepscope;
use serde_json::{Map, Value};
use std::{fs, path::PathBuf};

const MOTION: &str = r#"{ "bus": { "channels": 2 }, "source": { "motion": { "axes": [
    { "moves": [ { "cosine": {} } ], "motor": { "working_rate_hz": 19200 } },
    { "moves": [ { "sine_segments": { "amplitude": { "steps": 1000 }, "max_deviation": 0.006, "period_s": 0.5, "periods": 2 } } ] } ] } } }"#;

/// Checks the documented shape.
fn tables(arguments: &[&str], input: &str) -> Map<String, Value> {
    let (code, out, err) = stepscope(arguments, input);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{arguments:?}");
    let whole: Value = serde_json::from_str(&out).expect("it is JSON");
    let whole = whole.as_object().expect("one object");
    assert_eq!(whole.keys().collect::<Vec<_>>(), ["command", "stepscope", "tables"], "{arguments:?}");
    assert_eq!(whole["stepscope"], env!("CARGO_PKG_VERSION"));
    let command = whole["command"].as_str().expect("a text");
    assert!(arguments.join(" ").starts_with(command), "{command} of {arguments:?}");
    let tables = whole["tables"].as_object().expect("a map of tables");
    for (name, rows) in tables {
        let rows = rows.as_array().expect(name);
        let columns = |row: &Value| row.as_object().expect(name).keys().cloned().collect::<Vec<_>>();
        for row in rows {
            assert_eq!(columns(row), columns(&rows[0]), "{arguments:?}: the columns of {name}");
            let cells = row.as_object().expect(name).values();
            assert!(cells.into_iter().all(|cell| !cell.is_array() && !cell.is_object()), "{name}: {row}");
        }
    }
    tables.clone()
}

fn rows<'t>(tables: &'t Map<String, Value>, name: &str) -> &'t Vec<Value> {
    tables.get(name).and_then(Value::as_array).unwrap_or_else(|| panic!("no table {name} in {tables:?}"))
}

#[test]
fn every_json_table_has_the_documented_shape() {
    let measured = "length_mm,steps\n100,3995\n200,8005\n300,12010\n";
    let cases: [(&[&str], &str, &[&str]); 12] = [
        (&["run", "-"], MOTION, &["run", "controllers", "positions"]),
        (&["run", "-", "--driver", "tmc2209", "--link"], MOTION, &["timing", "links", "run"]),
        (&["tables", "-"], MOTION, &["tables"]),
        (&["measures", "-", "--axis", "1"], MOTION, &["figures"]),
        (&["torque", "-"], MOTION, &["axes", "ramps"]),
        (&["calibrate", "-"], measured, &["fits"]),
        (&["sine", "sweep", "--points", "3"], "", &["polylines"]),
        (&["sine", "best", "--from", "0.005", "--to", "0.008"], "", &["polylines"]),
        (&["sine", "vertices", "--segments", "3"], "", &["vertices"]),
        (&["faults", "--seeds", "20"], "", &["counts"]),
        (&["presets"], "", &["presets"]),
        (&["drivers"], "", &["drivers", "rules"]),
    ];
    for (arguments, input, expected) in cases {
        let found = tables(&[arguments, &["--json"]].concat(), input);
        for name in expected {
            assert!(!rows(&found, name).is_empty(), "{arguments:?}: {name}");
        }
    }
}

#[test]
fn json_and_text_have_the_same_figures() {
    let preset = stepscope(&["presets", "four-controllers-framed"], "").1;
    let found = tables(&["run", "-", "--json"], &preset);
    let text = stepscope(&["run", "-"], &preset).1;
    let digests: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("digest ")).collect();
    let controllers = rows(&found, "controllers");
    assert_eq!(
        controllers.iter().map(|row| row["digest"].as_str().expect("a text")).collect::<Vec<_>>(),
        digests
    );
    for (index, row) in controllers.iter().enumerate() {
        assert_eq!(row["controller"], index);
        assert!(text.contains(&format!("\ncontroller {index}\nrecords {}\n", row["records"])), "{text}");
    }
    let host = &rows(&found, "host")[0];
    assert!(text.contains(&format!("\nframes {} repeated {} ", host["frames"], host["repeated"])), "{text}");
    let third = tables(&["run", "-", "--controller", "2", "--json"], &preset);
    assert_eq!(rows(&third, "controllers"), &controllers[2..3]);

    let found =
        tables(&["run", "-", "--timing", "--json"], &stepscope(&["presets", "driver-timing-broken"], "").1);
    let rule = rows(&found, "timing").iter().find(|row| row["rule"] == "dir_setup").expect("a rule");
    assert_eq!(
        ["required_ns", "least_ns", "spare_ns", "at_cycle", "channel", "violations"]
            .map(|column| rule[column].as_f64()),
        [650.0, 500.0, -150.0, 2930.0, 0.0, 3.0].map(Some)
    );
    // JSON does not change the exit code.
    let broken = stepscope(&["presets", "driver-timing-broken"], "").1;
    assert_eq!(stepscope(&["run", "-", "--strict", "--json"], &broken).0, Some(3));
}

/// What a shell's script receives for the last of these words.
fn completed(words: &[&str]) -> Vec<String> {
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_stepscope"))
        .args([&["--", "stepscope"], words].concat())
        .env("STEPSCOPE_COMPLETE", "bash")
        .env("_CLAP_COMPLETE_INDEX", words.len().to_string())
        .env("_CLAP_IFS", "\n")
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("it starts");
    assert!(output.status.success(), "{output:?}");
    String::from_utf8(output.stdout).expect("text").lines().map(|line| line.trim().to_owned()).collect()
}

#[test]
fn a_shell_completes_commands_options_presets_and_files() {
    let rows: &[(&[&str], &str)] = &[
        (&["meas"], "measures"),
        (&["run", "--vcd-t"], "--vcd-timescale"),
        (&["run", "song-2021-o"], "song-2021-one-turn"),
        (&["capture", "recorded-s"], "recorded-step-table"),
        (&["capture", "x", "--against", "song-2021-o"], "song-2021-one-turn"),
        (&["faults", "framed-l"], "framed-link"),
        (&["presets", "zhang-2012-z"], "zhang-2012-zero-by-jog"),
        (&["run", "x", "--driver", "a49"], "a4988"),
        (&["plant", "x", "--motor", "17"], "17hs4401"),
        (&["run", "Cargo.t"], "Cargo.toml"),
    ];
    for (words, expected) in rows {
        let found = completed(words);
        assert!(found.iter().any(|line| line == expected), "{words:?}: {found:?}");
    }
}

#[test]
fn writes_shell_scripts_and_manual_pages() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (code, out, err) = stepscope(&["completions", shell], "");
        assert_eq!((code, err.as_str()), (Some(0), ""), "{shell}");
        assert!(["STEPSCOPE_COMPLETE", "stepscope"].iter().all(|word| out.contains(word)), "{shell}: {out}");
    }
    let (code, page, _) = stepscope(&["man"], "");
    assert_eq!(code, Some(0));
    assert!(page.contains(".TH stepscope 1") && page.contains("Exit codes"), "{page}");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("man");
    let (code, out, err) = stepscope(&["man", "--dir", &folder.display().to_string()], "");
    assert_eq!((code, out.as_str(), err.as_str()), (Some(0), "", ""));
    for name in ["stepscope", "stepscope-run", "stepscope-sine-sweep", "stepscope-tables"] {
        let page = fs::read_to_string(folder.join(format!("{name}.1"))).expect(name);
        assert!(page.starts_with(".ie") || page.contains(".TH"), "{name}");
    }
}
