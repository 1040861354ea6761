//! Limits and messages for inputs.

use crate::program::stepscope;
use std::{
    fs::{self, File},
    io::{BufWriter, Write},
    path::PathBuf,
    process::{Command, Stdio},
};
use stepscope_core::scenario::{MAX_TEXT_BYTES, presets::PRESETS};

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name)
}

#[test]
fn stops_reading_endless_input_at_the_limit() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_stepscope"))
        .args(["run", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    let mut stdin = child.stdin.take().expect("it is piped");
    let braces = "{\n".repeat(1 << 15);
    let mut written = 0;
    while stdin.write_all(braces.as_bytes()).is_ok() {
        written += braces.len();
        assert!(written < 2 * MAX_TEXT_BYTES, "it reads on and on");
    }
    let output = child.wait_with_output().expect("it ends");
    let err = String::from_utf8(output.stderr).expect("text");
    assert_eq!(output.status.code(), Some(2), "{err}");
    assert!(err.starts_with("-: more than 67108864 bytes; "), "{err}");
    assert!(written <= MAX_TEXT_BYTES + (1 << 20), "{written} bytes");
}

/// As `yes '{'` prints it, at maximum length: nested braces need no additional memory.
#[test]
fn rejects_nested_braces_as_invalid_json() {
    let braces = "{\"bus\":".repeat(1 << 20);
    let (code, out, err) = stepscope(&["run", "-"], &braces);
    assert_eq!((code, out.as_str()), (Some(2), ""));
    assert!(err.contains("invalid JSON at line 1, column "), "{err}");
}

/// Maximum resident memory in bytes, as the system counted it.
#[cfg(target_os = "linux")]
fn peak(arguments: &[&str]) -> u64 {
    use std::{thread, time::Duration};
    let mut child = Command::new(env!("CARGO_BIN_EXE_stepscope"))
        .args(arguments)
        .stdout(Stdio::null())
        .spawn()
        .expect("it starts");
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().expect("a child").is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let high = text.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
        peak = high.and_then(|kilobytes| kilobytes.parse().ok()).unwrap_or(0).max(peak);
        thread::sleep(Duration::from_millis(2));
    }
    assert!(child.wait().expect("it ends").success());
    peak * 1024
}

#[cfg(target_os = "linux")]
#[test]
fn a_million_segments_need_at_most_ten_times_the_memory_of_their_text() {
    let path = file("million.json");
    let mut out = BufWriter::new(File::create(&path).expect("a file"));
    let begun = r#"{"run_cycles":1000,"source":{"segments":{"channels":[{"segments":["#;
    write!(out, "{begun}").expect("room");
    for index in 0..1_000_000 {
        let comma = if index == 0 { "" } else { "," };
        let interval = 1_048_576_000 + index;
        write!(out, r#"{comma}{{"steps":{{"count":1,"interval_q16":{interval},"dir":1}}}}"#).expect("room");
    }
    write!(out, "]}}]}}}}}}").expect("room");
    out.into_inner().expect("room");
    let text = fs::metadata(&path).expect("a file").len();
    let peak = peak(&["run", &path.display().to_string(), "--digest"]);
    println!("text {text} bytes, memory {peak} bytes: {:.2} times", peak as f64 / text as f64);
    assert!(peak > text && peak <= 10 * text, "{peak} bytes for {text}");
}

/// An entry takes more memory than its text, so the number of entries is limited.
#[test]
fn rejects_too_many_entries() {
    let sends = vec!["{}"; 6_000_000].join(",");
    let (code, out, err) =
        stepscope(&["run", "-"], &format!(r#"{{"source":{{"line":{{"sends":[{sends}]}}}}}}"#));
    assert_eq!((code, out.as_str()), (Some(2), ""));
    assert!(err.contains("source.line.sends: 6000000 entries; use at most "), "{err}");
}

#[test]
fn rejects_duplicate_fields_with_their_paths() {
    for (given, path) in [
        (r#"{"clock_hz":16000000,"clock_hz":8000000}"#, "clock_hz"),
        (r#"{"bus":{"slots":5,"channels":1,"slots":5}}"#, "bus.slots"),
        (
            r#"{"source":{"motion":{"axes":[{"moves":[{"cosine":{"ramp_s":0.1,"ramp_s":0.2}}]}]}}}"#,
            "source.motion.axes[0].moves[0].cosine.ramp_s",
        ),
        (r#"{"version":1,"bus":{"pulses":"staggered","pulses":"staggered"}}"#, "bus.pulses"),
    ] {
        let (code, out, err) = stepscope(&["run", "-"], given);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{given}");
        assert_eq!(err, format!("-: 1 problem\n  {path}: duplicate field; use it once\n"), "{given}");
    }
    let both = r#"{"source":{"motion":{"axes":[{"moves":[{"dwell":{},"dwell":{}}]}]}}}"#;
    let (code, _, err) = stepscope(&["run", "-"], both);
    assert!(code == Some(2) && err.contains("moves[0]: an object with 2 keys"), "{err}");
}

#[test]
fn accepts_whole_numbers_with_decimals_or_exponents() {
    let plain = stepscope(&["run", "-", "--digest"], r#"{"clock_hz":16000000,"bus":{"slots":50}}"#);
    assert_eq!(plain.0, Some(0));
    for given in
        [r#"{"clock_hz":16000000.0,"bus":{"slots":50.0}}"#, r#"{"clock_hz":1.6e7,"bus":{"slots":5E1}}"#]
    {
        assert_eq!(stepscope(&["run", "-", "--digest"], given), plain, "{given}");
    }
}

#[test]
fn names_the_command_for_another_kind_of_file() {
    let steps = "time_us,dir\n22361,right\n31623,right\n";
    let rows: &[(&[&str], &str, &str)] = &[
        (&["run", "-"], "$date today $end\n", "expected value; open a recording with stepscope capture"),
        (
            &["capture", "-"],
            steps,
            "a table of step times, not of levels; use it with stepscope tables --steps",
        ),
        (
            &["tables", "--steps", "-"],
            "time_s,position\n0,0\n0.1,40\n",
            "line 1: the table has positions, not step times; use stepscope points",
        ),
    ];
    for (arguments, input, expected) in rows {
        let (code, out, err) = stepscope(arguments, input);
        assert!(matches!(code, Some(1 | 2)), "{arguments:?}: {code:?} {out}");
        assert!(err.contains(expected), "{arguments:?}: {err}");
    }
}

/// Segments have no line, so an address would not help.
#[test]
fn reports_only_the_controllers_that_segments_cannot_have() {
    let scenario = r#"{"source":{"segments":{"channels":[{"segments":[{"dwell":{}}]}]}},"controllers":[{}]}"#;
    let (code, _, err) = stepscope(&["run", "-"], scenario);
    assert_eq!(code, Some(2), "{err}");
    assert_eq!(
        err.lines().skip(1).collect::<Vec<_>>(),
        ["  controllers: segments run only one controller; remove the others, or choose ticks"]
    );
}

#[test]
fn states_the_allowed_range_for_a_wrong_type() {
    for (given, expected) in [
        (r#"{"clock_hz":-1}"#, "clock_hz: -1 is out of range; use 11 to 1000000000 Hz"),
        (r#"{"clock_hz":16000000.5}"#, "clock_hz: 16000000.5 is not a whole number; use 11 to 1000000000 Hz"),
        (r#"{"bus":{"slots":300}}"#, "bus.slots: 300 is out of range; use 1 to 127"),
        (
            r#"{"bus":{"channels":"four"}}"#,
            "bus.channels: \u{201c}four\u{201d} is not a whole number; use 1 to 16",
        ),
        (r#"{"run_cycles":1e30}"#, "run_cycles: 1e30 is out of range; use 1 to 9000000000000000 cycles"),
        (r#"{"title":5}"#, "title: 5 is not valid; use a text of 0 to 120 characters"),
        (
            r#"{"controllers":{}}"#,
            "controllers: an object is not valid; use a list of 0 to 31 additional controllers",
        ),
        (r#"{"version":"x"}"#, "version: \u{201c}x\u{201d} is not a whole number; use 1 to 3"),
        (r#"{"analysis":{"sensor_hz":"x"}}"#, "analysis.sensor_hz: \u{201c}x\u{201d} is not a number; use "),
        (
            r#"{"title":"\ud800"}"#,
            "title: a text with half of a surrogate pair is not valid; use a text of 0 to 120",
        ),
    ] {
        let (code, _, err) = stepscope(&["run", "-"], given);
        assert_eq!(code, Some(2), "{given}");
        assert!(err.lines().nth(1).is_some_and(|line| line.trim().starts_with(expected)), "{given}: {err}");
    }
}

#[test]
fn accepts_preset_names_in_place_of_files() {
    let preset = PRESETS.iter().find(|preset| preset.id == "sonobe-2011-table").expect("it is there");
    for arguments in [
        &["run"] as &[&str],
        &["measures"],
        &["steps"],
        &["curve"],
        &["spectrum"],
        &["tables", "--form", "compressed"],
        &["faults", "--seeds", "2"],
        &["run", "--link"],
    ] {
        let call = |scenario: &str, input: &str| {
            stepscope(&[&[arguments[0], scenario], &arguments[1..]].concat(), input)
        };
        let (code, out, err) = call(preset.id, "");
        assert_eq!(code, Some(0), "{arguments:?}: {err}");
        assert_eq!(out, call("-", preset.json).1, "{arguments:?}");
    }
    // An existing file wins over a preset of the same name.
    let folder = file("preset-name");
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join(preset.id), r#"{"clock_hz":0}"#).expect("a file");
    let output = Command::new(env!("CARGO_BIN_EXE_stepscope"))
        .args(["run", preset.id])
        .current_dir(&folder)
        .output()
        .expect("it starts");
    assert_eq!(output.status.code(), Some(2));
    let (code, _, err) = stepscope(&["run", "no-such-preset"], "");
    assert!(code == Some(1) && err.starts_with("no-such-preset: "), "{err}");
}
