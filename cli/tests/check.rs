//! `stepscope check` at a desk and in CI.

use crate::program::stepscope;
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// A folder with the sample files and this list.
fn folder(name: &str, list: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("check-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    let samples = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/samples");
    for sample in ["own.vcd", "turn.json"] {
        fs::copy(samples.join(sample), folder.join(sample)).expect("a sample");
    }
    fs::write(folder.join("list.json"), list).expect("a file");
    folder
}

fn check(folder: &Path) -> (Option<i32>, String, String) {
    let file = |name: &str| folder.join(name).display().to_string();
    let (list, junit, summary) = (file("list.json"), file("junit.xml"), file("summary.md"));
    stepscope(&["check", &list, "--junit", &junit, "--summary", &summary], "")
}

const PASSING: &str = r#"{ "checks": [
    { "name": "edges", "run": "turn.json", "digest": "4403b749346a0bd0" },
    { "run": "framed-link", "driver": "a4988" },
    { "name": "wide", "capture": "own.vcd", "against": "turn.json", "within_us": 1e9, "align": 0, "channel": 0 } ] }"#;

const DIFFERING: &str = r#"{ "checks": [
    { "name": "a <wrong> & |long| name", "run": "turn.json", "digest": "0000000000000000" },
    { "capture": "own.vcd", "against": "turn.json", "within_us": 20 },
    { "name": "edges", "run": "turn.json", "digest": "4403b749346a0bd0" } ] }"#;

#[test]
fn differences_have_a_line_and_a_location_in_both_reports() {
    let folder = folder("differing", DIFFERING);
    let (code, out, err) = check(&folder);
    assert_eq!((code, err.as_str()), (Some(3), "2 checks failed\n"), "{out}");
    let lines: Vec<&str> = out.lines().collect();
    assert_eq!(lines.len(), 4, "{out}");
    assert_eq!(
        lines[0],
        "failed a <wrong> & |long| name: the digest is 4403b749346a0bd0, not 0000000000000000"
    );
    assert!(
        lines[1].starts_with("failed own.vcd: the recording differs from the plan: 1 step missing"),
        "{out}"
    );
    assert_eq!(lines[2..], ["passed edges", "1 passed, 2 failed"]);
    let junit = fs::read_to_string(folder.join("junit.xml")).expect("a report");
    assert!(
        junit.contains(r#"<testsuite name="stepscope" tests="3" failures="2" errors="0" time=""#),
        "{junit}"
    );
    assert!(
        junit.contains(r#"<testcase classname="turn.json" name="a &lt;wrong&gt; &amp; |long| name" time=""#),
        "{junit}"
    );
    assert!(
        junit.contains(r#"<failure message="the recording differs from the plan: 1 step missing"#),
        "{junit}"
    );
    assert!(junit.starts_with("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n"), "{junit}");
    let summary = fs::read_to_string(folder.join("summary.md")).expect("a report");
    assert!(summary.starts_with("### Stepscope: 1 passed, 2 failed\n"), "{summary}");
    assert!(
        summary.contains("| a \\<wrong> & \\|long\\| name | turn.json | failed | the digest is"),
        "{summary}"
    );
}

#[test]
fn checks_that_cannot_run_are_errors() {
    for (list, expected_code, line) in [
        (
            r#"{"checks":[{"run":"missing.json"},{"run":"turn.json"}]}"#,
            1,
            "error missing.json: missing.json: ",
        ),
        (r#"{"checks":[{"run":"own.vcd"},{"run":"turn.json"}]}"#, 2, "error own.vcd: own.vcd: "),
        (
            r#"{"checks":[{"table":"turn.json"},{"run":"turn.json"}]}"#,
            2,
            "error turn.json: the table has no line with its command",
        ),
        (
            r#"{"checks":[{"run":"turn.json","digest":"0000000000000000"},{"run":"turn.json","driver":"a4989"}]}"#,
            2,
            "failed turn.json: ",
        ),
    ] {
        let folder = folder("errors", list);
        let (code, out, err) = check(&folder);
        assert_eq!(code, Some(expected_code), "{list}: {out}{err}");
        assert!(out.starts_with(line) && out.contains(", 1 error\n"), "{list}: {out}");
        assert!(err.contains("a check could not run; see its line"), "{err}");
        assert!(
            fs::read_to_string(folder.join("junit.xml")).expect("a report").contains("<error message="),
            "{list}"
        );
    }
}

#[test]
fn all_mistakes_of_a_list_are_reported_together() {
    let list = r#"{"checks":[5,{},{"run":"turn.json","digets":"x"},{"run":"turn.json","digest":"ABC"},
        {"capture":"own.vcd"},{"run":"--trace=x"},{"capture":"own.vcd","against":"turn.json","within_us":"20"},
        {"capture":"own.vcd","against":"turn.json","channel":16},{"capture":"own.vcd","against":"turn.json","align":1e3},
        {"name":"","run":"turn.json"}]}"#;
    let folder = folder("mistakes", list);
    let (code, out, err) = check(&folder);
    assert_eq!((code, out.as_str()), (Some(2), ""), "{err}");
    for expected in [
        "checks[0]: not an object; use one with capture, run or table",
        "checks[1]: no check; use one of capture, run and table",
        "checks[2].digets: unknown field; a similar name is digest; use one of name, run, digest, driver",
        "checks[3].digest: ABC is not a digest; use 16 digits of 0-9 and a-f",
        "checks[4].against: missing; use the name of a file",
        "checks[5].run: \"--trace=x\" is not valid; use a text that begins with no hyphen",
        "checks[6].within_us: \"20\" is not valid; use a number",
        "checks[7]: invalid value '16' for '--channel <K>': ",
        "checks[8]: invalid value '1000.0' for '--align <STEP>': ",
        "checks[9].name: \"\" is not valid; use a text",
    ] {
        assert!(err.contains(expected), "{expected}: {err}");
    }
    for (list, expected) in [
        ("{", "not JSON: "),
        ("[]", "use one object with the list checks"),
        (r#"{"checks":[]}"#, "0 checks; use 1 to 10000"),
    ] {
        let (code, _, err) = stepscope(&["check", "-"], list);
        assert!(code == Some(2) && err.contains(expected), "{list}: {err}");
    }
}

#[test]
fn passing_checks_end_with_0_and_reports_can_be_printed() {
    let folder = folder("passing", PASSING);
    let (code, out, err) = check(&folder);
    assert!(out.starts_with("passed edges\npassed framed-link\n"), "{out}{err}");
    let list = folder.join("list.json").display().to_string();
    let (_, printed, _) = stepscope(&["check", &list, "--summary", "-"], "");
    assert_eq!(printed, fs::read_to_string(folder.join("summary.md")).expect("a report"));
    assert_eq!(code, Some(3), "one step is missing at any tolerance: {out}");
    let (code, out, err) = stepscope(&["check", "-"], r#"{"checks":[{"run":"framed-link"}]}"#);
    assert_eq!((code, out.as_str(), err.as_str()), (Some(0), "passed framed-link\n1 passed, 0 failed\n", ""));
}

/// Exports a table in the folder, as its user does.
fn export(folder: &Path, words: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stepscope"));
    let output = command.current_dir(folder).arg("tables").args(words).output().expect("it starts");
    assert!(output.status.success(), "{output:?}");
}

#[test]
fn table_commands_run_in_the_folder_of_the_list() {
    let folder = folder("table", r#"{"checks":[{"table":"gen/turn.h"},{"table":"gen/rows.rs"}]}"#);
    fs::create_dir_all(folder.join("gen")).expect("a folder");
    fs::copy(folder.join("turn.json"), folder.join("my turn's.json")).expect("a file");
    fs::write(folder.join("Zähler.csv"), "cycle,dir\n1000,1\n3000,1\n").expect("a file");
    export(
        &folder,
        &["my turn's.json", "--form", "exact", "--format", "c", "--name", "turn_1", "-o", "gen/turn.h"],
    );
    export(&folder, &["--steps", "Zähler.csv", "--format", "rust", "-o", "gen/rows.rs"]);
    let passed =
        (Some(0), "passed gen/turn.h\npassed gen/rows.rs\n2 passed, 0 failed\n".to_owned(), String::new());
    assert_eq!(check(&folder), passed);
    let stored = fs::read_to_string(folder.join("gen/turn.h")).expect("the table");
    let write = |text: &str| fs::write(folder.join("gen/turn.h"), text).expect("a file");
    // Another version made the same table.
    write(&stored.replace(concat!("stepscope ", env!("CARGO_PKG_VERSION"), ":"), "stepscope 0.1.0:"));
    assert_eq!(check(&folder), passed);
    let entries = stored.find("_entries[").expect("the entries");
    let (head, body) = stored.split_at(entries);
    write(&format!("{head}{}", body.replacen("1U", "2U", 1)));
    let (code, out, _) = check(&folder);
    let line = head.lines().count() + 1;
    let why = format!(
        "failed gen/turn.h: line {line} differs from the command's current output; export the table again"
    );
    assert_eq!((code, out.lines().next()), (Some(3), Some(why.as_str())));
}

#[test]
fn a_table_is_compared_with_another_scenario() {
    let list =
        r#"{"checks":[{"table":"turn.h","run":"renamed.json"},{"table":"turn.h","run":"framed-link"}]}"#;
    let folder = folder("table-run", list);
    fs::copy(folder.join("turn.json"), folder.join("renamed.json")).expect("a file");
    export(&folder, &["turn.json", "--format", "c", "-o", "turn.h"]);
    let (code, out, err) = check(&folder);
    assert!(code == Some(3) && out.starts_with("passed turn.h\nfailed turn.h: line "), "{out}{err}");
}

#[test]
fn the_command_in_a_tables_header_writes_no_file() {
    for option in ["--out=stolen", "-ostolen", "--out stolen", "-o stolen", "--with-walker"] {
        let folder = folder("head", r#"{"checks":[{"table":"turn.h"}]}"#);
        let head =
            format!("/* Made by stepscope 0.2.0: stepscope tables turn.json --format c {option}\n */\n");
        fs::write(folder.join("turn.h"), head).expect("a file");
        let (code, out, _) = check(&folder);
        assert!(code == Some(2) && out.starts_with("error turn.h: the command of the table has -"), "{out}");
        assert!(!folder.join("stolen").exists() && !folder.join("stepscope_walk.h").exists(), "{option}");
    }
}

#[test]
fn a_line_break_in_a_name_is_escaped() {
    let list = r#"{"checks":[{"name":"- a\n::error::x\t\u001b[2J","run":"framed-link"}]}"#;
    let (code, out, _) = stepscope(&["check", "-"], list);
    let line = r"passed - a\u{a}::error::x\u{9}\u{1b}[2J";
    assert_eq!((code, out), (Some(0), format!("{line}\n1 passed, 0 failed\n")));
}
