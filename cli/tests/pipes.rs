//! Named pipes and shell pipes as inputs and outputs.

use crate::program::stepscope;
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
};
use stepscope_core::scenario::presets::{CONTROLLER_PRESETS, PLANT_PRESETS, PRESETS};

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("pipes-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn make_pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().expect("mkfifo starts").success());
}

fn preset(id: &str) -> &'static str {
    let all = PRESETS.iter().chain(PLANT_PRESETS).chain(CONTROLLER_PRESETS);
    all.into_iter().find(|preset| preset.id == id).expect("a preset").json
}

/// Every input of every command: arguments before, arguments after, contents.
fn inputs() -> Vec<(&'static [&'static str], &'static [&'static str], &'static str)> {
    let dump =
        "$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 1! #12 0! #90 1! #92 0!";
    vec![
        (&["run"], &[], "{}"),
        (&["run", "framed-link", "--driver"], &[], r#"{"step_high_ns":1}"#),
        (&["faults"], &["--seeds", "1"], preset("framed-link")),
        (&["tables"], &[], "{}"),
        (&["tables", "--steps"], &[], "cycle,dir\n10,1\n500,0\n"),
        (&["measures"], &[], "{}"),
        (&["steps"], &["--planned"], "{}"),
        (&["curve"], &[], "{}"),
        (&["spectrum"], &[], "{}"),
        (&["torque"], &["--motor", "song-2021"], "{}"),
        (&["plant"], &[], preset("resonance-full-steps")),
        (&["settling"], &[], preset("resonance-full-steps")),
        (&["limits"], &["--steps", "2"], preset("resonance-full-steps")),
        (&["resonance"], &["--to", "20"], preset("resonance-full-steps")),
        (&["capture"], &[], dump),
        (&["capture", "recorded-step-table", "--against"], &["--json"], "{}"),
        (&["capture", "recorded-step-table", "--driver"], &[], r#"{"step_high_ns":1}"#),
        (&["check"], &[], r#"{"checks":[{"run":"framed-link"}]}"#),
        (&["powercut"], &["--cuts", "2"], preset("zhang-2012-controller")),
        (&["calibrate"], &[], "length_mm,steps\n100,3995\n200,8005\n300,12010\n"),
        (&["sine", "segments"], &[], preset("sine-2022-d00054")),
        (&["points"], &["--straight"], "0,0\n1,100\n"),
    ]
}

#[test]
fn every_input_can_be_a_pipe() {
    let folder = folder("inputs");
    fs::create_dir(folder.join("pipe")).expect("a folder");
    let (file, pipe) = (folder.join("input"), folder.join("pipe/input"));
    let call = |(before, after, _): &(&[&str], &[&str], &str), path: &Path| {
        let path = path.display().to_string();
        let (code, out, err) = stepscope(&[before, &[path.as_str()] as &[&str], after].concat(), "");
        (code, out.replace(&path, "PATH"), err.replace(&path, "PATH"))
    };
    for input in inputs() {
        fs::write(&file, input.2).expect("a file");
        let expected = call(&input, &file);
        assert!(matches!(expected.0, Some(0 | 3)) && !expected.1.is_empty(), "{input:?}: {expected:?}");
        make_pipe(&pipe);
        let to = pipe.clone();
        let text = input.2.to_owned();
        // Ends with the test if nothing reads.
        thread::spawn(move || fs::write(to, text));
        assert_eq!(call(&input, &pipe), expected, "{input:?}");
        fs::remove_file(&pipe).expect("it was there");
    }
}

/// All of them wait in parallel.
#[test]
fn a_named_pipe_without_another_end_is_an_error() {
    let folder = folder("alone");
    let [pipe, out] = ["pipe", "out"].map(|name| {
        make_pipe(&folder.join(name));
        folder.join(name).display().to_string()
    });
    let mut lines: Vec<Vec<&str>> = inputs()
        .iter()
        .map(|(before, after, _)| [before, &[pipe.as_str()] as &[&str], after].concat())
        .collect();
    lines.push(vec!["serve", &pipe, "--tcp", "127.0.0.1:0"]);
    lines.push(vec!["send", &pipe, "--port", "/dev/null"]);
    lines.push(vec!["run", "framed-link", "--trace", &out]);
    lines.push(vec!["tables", "framed-link", "--out", &out]);
    let start = |line: Vec<&str>| {
        let child = Command::new(env!("CARGO_BIN_EXE_stepscope"))
            .args(&line)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        (format!("{line:?}"), line.contains(&"--driver"), child.expect("it starts"))
    };
    let children: Vec<_> = lines.into_iter().map(start).collect();
    for (line, is_option, child) in children {
        let output = child.wait_with_output().expect("it ends");
        let err = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(if is_option { 2 } else { 1 }), "{line}: {err}");
        assert!(err.contains(": no other program opened this named pipe within "), "{line}: {err}");
    }
}

#[test]
fn records_only_to_files() {
    let folder = folder("recording");
    make_pipe(&folder.join("pipe"));
    fs::create_dir(folder.join("dir.session.json")).expect("a folder");
    for given in ["-", "/dev/stdout", "/dev/null", "/dev/fd/1", "pipe", "pipe/", "new/", ".", "dir.json"] {
        let output = Command::new(env!("CARGO_BIN_EXE_stepscope"))
            .args(["serve", "framed-link", "--tcp", "127.0.0.1:0", "--record", given])
            .current_dir(&folder)
            .stdin(Stdio::null())
            .output()
            .expect("it starts");
        let err = String::from_utf8(output.stderr).expect("text");
        assert_eq!(
            (output.status.code(), output.stdout.as_slice()),
            (Some(2), &[] as &[u8]),
            "{given}: {err}"
        );
        assert!(err.contains("not a file; a recording has two"), "{given}: {err}");
    }
    let mut left: Vec<_> =
        fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("one").file_name()).collect();
    left.sort();
    assert_eq!(left, ["dir.session.json", "pipe"]);
    assert!(!Path::new("/dev/null.session.json").exists() && !Path::new("/dev/stdout.session.json").exists());
    for arguments in [&["man", "--dir", "-"] as &[&str], &["serve", "framed-link", "--pty", "-"]] {
        let (code, _, err) = stepscope(arguments, "");
        assert!(
            code == Some(2) && err.contains(": standard output is not a link or a folder"),
            "{arguments:?}: {err}"
        );
    }
}
