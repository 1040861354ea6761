//! Exit codes of every command, as in docs/command.md.

use crate::program::stepscope;
use std::{
    fs,
    path::PathBuf,
    process::{Command, Stdio},
};

/// Every command that reads a file: the arguments before and after the file.
const READERS: &[(&[&str], &[&str])] = &[
    (&["run"], &[]),
    (&["serve"], &["--tcp", "127.0.0.1:0"]),
    (&["send"], &["--port", "/dev/null"]),
    (&["faults"], &["--seeds", "1"]),
    (&["tables"], &[]),
    (&["tables", "--steps"], &[]),
    (&["measures"], &[]),
    (&["steps"], &[]),
    (&["curve"], &[]),
    (&["spectrum"], &[]),
    (&["torque"], &[]),
    (&["plant"], &[]),
    (&["settling"], &[]),
    (&["limits"], &[]),
    (&["resonance"], &[]),
    (&["capture"], &[]),
    (&["capture", "recorded-step-table", "--against"], &[]),
    (&["check"], &[]),
    (&["powercut"], &[]),
    (&["calibrate"], &[]),
    (&["sine", "segments"], &[]),
    (&["points"], &[]),
];

/// The link of `{}`.
const LINK: &str = "#c=2.j.e30.90f7e4f5";

/// A quick call of each command that prints something.
const PRINTERS: &[&[&str]] = &[
    &["--help"],
    &["run", "--help"],
    &["--version"],
    &["run", "-"],
    &["run", "-", "--json"],
    &["run", "-", "--link"],
    &["run", "-", "--trace", "-"],
    &["run", "-", "--line", "-"],
    &["run", "-", "--timing", "--driver", "a4988"],
    &["faults", "--seeds", "1"],
    &["faults", "--seed", "1", "--scenario"],
    &["tables", "-"],
    &["measures", "-"],
    &["steps", "-"],
    &["curve", "-", "--points", "2"],
    &["spectrum", "-"],
    &["schema"],
    &["torque", "-", "--motor", "song-2021"],
    &["plant", "--motors"],
    &["capture", "recorded-step-table"],
    &["sine", "sweep", "--points", "2"],
    &["sine", "vertices", "--segments", "2"],
    &["open", LINK],
    &["presets"],
    &["presets", "zhang-2012-controller"],
    &["presets", "--json"],
    &["drivers"],
    &["completions", "bash"],
    &["man"],
];

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("exit-codes-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn read(reader: &(&[&str], &[&str]), file: &str) -> (Option<i32>, String) {
    let (code, out, err) = stepscope(&[reader.0, &[file], reader.1].concat(), "");
    assert_eq!(out, "", "{reader:?} {file}");
    (code, err)
}

#[test]
fn an_unreadable_file_ends_every_command_with_1() {
    let folder = folder("unreadable");
    let (missing, directory) = (folder.join("missing"), folder.clone());
    for reader in READERS {
        for path in [&missing, &directory] {
            let path = path.display().to_string();
            let (code, err) = read(reader, &path);
            assert_eq!(code, Some(1), "{reader:?} {path}: {err}");
            assert!(err.starts_with(&format!("{path}: ")), "{reader:?}: {err}");
        }
    }
}

#[test]
fn an_invalid_file_ends_every_command_with_2() {
    let folder = folder("else");
    for (name, content) in [("zero", r#"{"clock_hz":0}"#.as_bytes()), ("binary", &[0xff, 0x00, 0xfe, 0x80])] {
        let path = folder.join(name);
        fs::write(&path, content).expect("a file");
        let path = path.display().to_string();
        for reader in READERS {
            let (code, err) = read(reader, &path);
            assert_eq!(code, Some(2), "{reader:?} {name}: {err}");
            assert!(err.starts_with(&path), "{reader:?}: {err}");
        }
    }
}

#[test]
fn rejects_seeds_out_of_range() {
    for (options, expected) in [
        (&["--seeds", "0"] as &[&str], "'0' for '--seeds <N>': out of range; use 1 to 4294967295"),
        (
            &["--from", "4294967295"],
            "--from 4294967295 with --seeds 1000: the last seed is 4294967295; use --seeds 1 to 1",
        ),
        (&["--from", "4294967294", "--seeds", "3"], "use --seeds 1 to 2, or a lower --from"),
        (&["--from", "4294967296"], "'4294967296' for '--from <SEED>': out of range; use 0 to 4294967295"),
    ] {
        let (code, out, err) = stepscope(&[&["faults"], options].concat(), "");
        assert_eq!((code, out.as_str()), (Some(2), ""), "{options:?}");
        assert!(err.contains(expected), "{err}");
    }
    let (code, out, _) = stepscope(&["faults", "--from", "4294967294", "--seeds", "2"], "");
    assert!(code == Some(0) && out.contains("2             2\n"), "{out}");
}

#[test]
fn invalid_numbers_end_every_command_with_2() {
    let options: &[&[&str]] = &[
        &["capture", "recorded-step-table", "--against", "{}", "--within-us"],
        &["capture", "recorded-step-table", "--scenario", "-", "--error-us"],
        &["tables", "-", "--error-us"],
        &["settling", "-", "--share"],
        &["limits", "-", "--ramp"],
        &["resonance", "-", "--from"],
        &["resonance", "-", "--to"],
        &["resonance", "-", "--step"],
        &["points", "-", "--unit", "mm", "--step-mm"],
        &["sine", "sweep", "--from"],
        &["sine", "best", "--to"],
        &["sine", "sweep", "--period-s", "1", "--sensor-hz"],
        &["sine", "sweep", "--sensor-hz", "1", "--period-s"],
    ];
    for option in options {
        for value in ["NaN", "-nan", "inf", "-inf", "-1", "1e999", "", "1e400"] {
            let name = option.last().expect("an option");
            // One word: "-nan" alone would be an option.
            let given = format!("{name}={value}");
            let all = [&option[..option.len() - 1], &[given.as_str()]].concat();
            let (code, out, err) = stepscope(&all, "{}");
            assert_eq!((code, out.as_str()), (Some(2), ""), "{all:?}");
            assert!(err.contains(name) && (value.is_empty() || err.contains("; use ")), "{all:?}: {err}");
        }
    }
    for arguments in [
        &["resonance", "resonance-full-steps", "--from", "100", "--to", "50"] as &[&str],
        &["resonance", "resonance-full-steps", "--to", "1000000", "--rung", "0.000001"],
        &["capture", "recorded-step-table", "--clock", "0"],
        &["capture", "recorded-step-table", "--sample-rate", "-1"],
        &["run", "-", "--controller", "-1"],
        &["powercut", "zhang-2012-controller", "--cuts", "0"],
        &["limits", "-", "--threads", "0"],
        &["limits", "resonance-full-steps", "--steps", "10000001"],
    ] {
        let (code, out, err) = stepscope(arguments, "{}");
        assert_eq!((code, out.as_str()), (Some(2), ""), "{arguments:?}: {err}");
    }
}

/// The message has the value given and what is allowed.
#[test]
fn rejects_reversed_ranges_and_indexes_out_of_range() {
    let sweep = "--to: 0.002 is below --from 0.06; use --to 0.06 to 1";
    let axis =
        "--axis: 18446744073709551615 is out of range; the scenario has axes 0 to 1; use --axis 0 to 1";
    let controller = "--controller: 18446744073709551615 is out of range; the scenario has only controller 0; use --controller 0";
    let channel = "--channel: 18446744073709551615 is out of range; the scenario has only channel 0; use --channel 0, or omit it for all";
    const MAX_INDEX: &str = "18446744073709551615";
    let rows: &[(&[&str], &str)] = &[
        (&["sine", "sweep", "--from", "0.06", "--to", "0.002"], sweep),
        (&["sine", "best", "--from", "0.06", "--to", "0.002"], sweep),
        (&["sine", "best", "--segments", "0"], "'0' for '--segments <N>': out of range; use 1 or more"),
        (
            &["sine", "best", "--segments", MAX_INDEX],
            "--segments: 18446744073709551615 is out of range for deviations from 0.002 to 0.06; use 2 to 10",
        ),
        (&["sine", "vertices", "--segments", "33"], "out of range; use 1 to 32"),
        (
            &["sine", "segments", "sine-2022-d00054", "--axis", MAX_INDEX],
            "--axis: 18446744073709551615 is out of range; the scenario has only axis 0; use --axis 0, or omit it for all",
        ),
        (&["tables", "framed-link", "--axis", MAX_INDEX], axis),
        (&["tables", "framed-link", "--axis", MAX_INDEX, "--json"], axis),
        (&["tables", "framed-link", "--axis", MAX_INDEX, "--format", "c"], axis),
        (&["measures", "framed-link", "--axis", MAX_INDEX], axis),
        (&["steps", "framed-link", "--planned", "--axis", MAX_INDEX], axis),
        (&["curve", "framed-link", "--axis", MAX_INDEX], axis),
        (&["spectrum", "framed-link", "--axis", MAX_INDEX], axis),
        (&["curve", "framed-link", "--points", "1"], "out of range; use 2 to 1000000"),
        (&["torque", "framed-link", "--axis", MAX_INDEX], axis),
        (&["run", "framed-link", "--controller", MAX_INDEX], controller),
        (&["plant", "resonance-full-steps", "--controller", MAX_INDEX], controller),
        (&["settling", "resonance-full-steps", "--channel", MAX_INDEX], channel),
        (&["limits", "resonance-full-steps", "--channel", MAX_INDEX], channel),
        (&["resonance", "resonance-full-steps", "--channel", MAX_INDEX], channel),
        (
            &["limits", "patent-2019-overload", "--channel", "4"],
            "--channel: 4 is out of range; the scenario has channels 0 to 3; use --channel 0 to 3, or omit it for all",
        ),
        (
            &["resonance", "resonance-full-steps", "--from", "3", "--to", "2"],
            "--to: 2 is below --from 3; use 3 or more",
        ),
        (
            &["settling", "resonance-full-steps", "--t-step", "1"],
            "--t-step: 1 cycles are out of range; use 80 to ",
        ),
        (
            &["capture", "recorded-step-table", "--against", "framed-link", "--channel", "16"],
            "'16' for '--channel <K>': out of range; use 0 to 15",
        ),
        (
            &["capture", "recorded-step-table", "--against", "framed-link", "--align", MAX_INDEX],
            "--align: 18446744073709551615 is out of range; the run has ",
        ),
        (&["capture", "recorded-step-table", "--map", "STEP16=#0"], "use STEP0 to STEP15"),
        (&["capture", "recorded-step-table", "--map", "STEP0=#99"], "there is no channel #99; use one of "),
        (&["send", "framed-link", "--port", "/dev/null", "--lead", "255"], "out of range; use 0 to 254"),
        (&["serve", "framed-link", "--tcp", "127.0.0.1:99999"], "use both, such as 127.0.0.1:4000"),
        (&["serve", "framed-link", "--tcp", "127.0.0.1:0", "--pace=-1"], "use 0.001 to 100"),
    ];
    for (arguments, expected) in rows {
        let (code, out, err) = stepscope(arguments, "");
        assert_eq!((code, out.as_str()), (Some(2), ""), "{arguments:?}: {err}");
        assert!(err.contains(expected), "{arguments:?}: {err}");
    }
    let (code, out, err) = stepscope(&["tables", "framed-link", "--axis", "1", "--form", "exact"], "");
    assert_eq!((code, err.as_str(), out.lines().count()), (Some(0), "", 4), "{out}");
    assert!(out.lines().skip(1).all(|line| line.starts_with("   1 exact")), "{out}");
    // Both ends may be equal.
    assert_eq!(stepscope(&["sine", "best", "--from", "0.01", "--to", "0.01"], "").0, Some(0));
}

/// A run itself may have any length.
#[test]
fn rejects_the_analysis_of_four_billion_steps() {
    let long = r#"{"source":{"segments":{"channels":[{"segments":[{"steps":{"count":4294967295}}]}]}}}"#;
    for arguments in [
        &["tables", "-"] as &[&str],
        &["measures", "-"],
        &["steps", "-"],
        &["spectrum", "-"],
        &["torque", "-", "--motor", "song-2021"],
        &["capture", "recorded-step-table", "--against", "-"],
    ] {
        let (code, out, err) = stepscope(arguments, long);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{arguments:?}");
        assert!(
            err.starts_with("-: 4294967295 steps are too many; the maximum is 24000000; "),
            "{arguments:?}: {err}"
        );
    }
}

#[test]
fn starts_at_most_four_threads_per_core() {
    let (code, out, err) = stepscope(&["faults", "--seeds", "1", "--threads", "100000"], "");
    assert_eq!(code, Some(0));
    assert!(err.starts_with("--threads: 100000 is more than 4 per core; "), "{err}");
    assert_eq!(out, stepscope(&["faults", "--seeds", "1"], "").1);
}

/// Like `| head`, but before the first byte.
#[test]
fn a_closed_standard_output_ends_every_command_silently_with_141() {
    for arguments in PRINTERS {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let folder = folder("closed");
        fs::write(folder.join("in.json"), "{}").expect("a file");
        let input = fs::File::open(folder.join("in.json")).expect("a file");
        let output = Command::new(env!("CARGO_BIN_EXE_stepscope"))
            .args(*arguments)
            .stdin(input)
            .stdout(writer)
            .stderr(Stdio::piped())
            .output()
            .expect("it starts");
        let err = String::from_utf8(output.stderr).expect("text");
        assert_eq!((output.status.code(), err.as_str()), (Some(141), ""), "{arguments:?}");
    }
}

#[test]
fn open_validates_the_scenario_like_run() {
    // A motion with too many ticks for a run.
    let scenario = r#"{"source":{"motion":{"axes":[{"moves":[{"dwell":{"duration_s":86400}},{"dwell":{"duration_s":86400}},{"constant":{}}]}]}}}"#;
    let (code, _, err) = stepscope(&["run", "-"], scenario);
    assert_eq!(code, Some(2), "{err}");
    let scenario = stepscope_core::scenario::Scenario::from_json(scenario).expect("it reads");
    let link = stepscope_core::scenario::link::encode(&scenario).expect("it is short");
    let (code, out, opened) = stepscope(&["open", &format!("#{link}")], "");
    assert_eq!((code, out.as_str()), (Some(2), ""));
    assert_eq!(opened.lines().skip(1).collect::<Vec<_>>(), err.lines().skip(1).collect::<Vec<_>>());
}

/// A command that waits for a pipe nobody writes to has not begun to write.
#[cfg(target_os = "linux")]
#[test]
fn a_signal_ends_a_waiting_command_with_130() {
    use std::{os::unix::fs::OpenOptionsExt as _, thread, time::Duration};
    let folder = folder("signals");
    let pipe = folder.join("pipe");
    let made = Command::new("mkfifo").arg(&pipe).status().expect("mkfifo starts");
    assert!(made.success());
    for (reader, signal) in READERS.iter().flat_map(|reader| [(reader, "-TERM"), (reader, "-INT")]) {
        let mut child = Command::new(env!("CARGO_BIN_EXE_stepscope"))
            .args(reader.0)
            .arg(&pipe)
            .args(reader.1)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        // Opening a pipe for writing without waiting succeeds only when the command waits for its bytes.
        let nonblocking = rustix::fs::OFlags::NONBLOCK.bits().cast_signed();
        let writer = loop {
            match fs::OpenOptions::new().write(true).custom_flags(nonblocking).open(&pipe) {
                Ok(writer) => break writer,
                Err(_) => assert!(child.try_wait().expect("a child").is_none(), "{reader:?} has ended"),
            }
            thread::sleep(Duration::from_millis(2));
        };
        let killed = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
        assert!(killed.success());
        // A command that ignored the signal would end with another exit code at the end of the bytes.
        for _ in 0..3000 {
            if child.try_wait().expect("a child").is_some() {
                break;
            }
            thread::sleep(Duration::from_millis(10));
        }
        drop(writer);
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130), "{reader:?} {signal}");
        assert_eq!((output.stdout, output.stderr), (vec![], vec![]), "{reader:?} {signal}");
    }
}

/// A shell lets background commands ignore Ctrl-C, but not a request to end.
#[cfg(target_os = "linux")]
#[test]
fn a_signal_ends_a_background_command_with_130() {
    let folder = folder("background");
    let script = format!(
        "cd '{}' && mkfifo pipe && {{ '{}' run pipe & }}; p=$!; \
         until [ \"$(ls /proc/$p/task | wc -l)\" -ge 2 ]; do sleep 0.01; done; \
         kill -INT $p; kill -TERM $p; wait $p; echo $?",
        folder.display(),
        env!("CARGO_BIN_EXE_stepscope")
    );
    let output = Command::new("sh").args(["-c", &script]).output().expect("sh starts");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "130\n", "{output:?}");
}

#[cfg(unix)]
#[test]
fn reads_a_pipe_like_a_file() {
    let scenario = r#"{"title":"through a pipe"}"#;
    let expected = stepscope(&["run", "-", "--digest"], scenario).1;
    let trace = stepscope(&["run", "-", "--vcd", "-"], scenario).1;
    let folder = folder("pipes");
    fs::write(folder.join("in.json"), scenario).expect("a file");
    fs::write(folder.join("edges.vcd"), trace).expect("a file");
    let through = |content: &str, command: &str| {
        let program = env!("CARGO_BIN_EXE_stepscope");
        let script = format!("rm -f pipe; mkfifo pipe; cat {content} > pipe & '{program}' {command}; wait");
        let output =
            Command::new("sh").args(["-c", &script]).current_dir(&folder).output().expect("sh starts");
        (output.status.code(), String::from_utf8(output.stdout).expect("text"))
    };
    assert_eq!(through("in.json", "run pipe --digest"), (Some(0), expected));
    let steps = stepscope(&["capture", &folder.join("edges.vcd").display().to_string(), "--steps", "-"], "");
    assert!(steps.0 == Some(0) && steps.1.lines().count() > 3000, "{steps:?}");
    assert_eq!(through("edges.vcd", "capture pipe --steps -").1, steps.1);
}
