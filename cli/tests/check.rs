//! `stepscope check` at a desk and in CI.

use crate::program::stepscope;
use std::{
    fs,
    path::{Path, PathBuf},
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
fn differences_have_a_line_and_a_place_in_both_reports() {
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
fn checks_that_cannot_be_made_are_errors() {
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
            r#"{"checks":[{"capture":"own.vcd","against":"turn.json","channel":16},{"run":"turn.json"}]}"#,
            2,
            "error own.vcd: error: invalid value '16'",
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
        assert!(err.contains("a check could not be made; see its line"), "{err}");
        assert!(
            fs::read_to_string(folder.join("junit.xml")).expect("a report").contains("<error message="),
            "{list}"
        );
    }
}

#[test]
fn a_list_with_mistakes_is_refused_with_all_of_them() {
    let list = r#"{"checks":[5,{},{"run":"turn.json","digets":"x"},{"run":"turn.json","digest":"ABC"},
        {"capture":"own.vcd"},{"run":"--trace=x"},{"capture":"own.vcd","against":"turn.json","within_us":"20"}]}"#;
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

#[test]
fn a_table_is_made_again_from_its_head() {
    let folder = folder("table", r#"{"checks":[{"table":"turn.h"}]}"#);
    let source = folder.join("turn.json").display().to_string();
    let words = ["tables", &source, "--form", "exact", "--format", "c", "--name", "turn_1"];
    let (code, table, _) = stepscope(&words, "");
    assert_eq!(code, Some(0));
    // The head of the table: the command with the path from the table's folder.
    let command = "stepscope tables turn.json --form exact --format c --name turn_1";
    let head = format!("/* Made by {command} */\n");
    let write = |text: &str| fs::write(folder.join("turn.h"), text).expect("a file");
    if table.contains("stepscope tables ") {
        write(&table);
        assert_eq!(check(&folder).0, Some(0), "{}", check(&folder).1);
    } else {
        write(&format!("{head}{table}"));
        let (code, out, _) = check(&folder);
        assert!(code == Some(3) && out.starts_with("failed turn.h: line 1 differs from the table"), "{out}");
    }
    write(&table.replacen("1U", "2U", 1).replace("Made by", "made by"));
    assert_ne!(check(&folder).0, Some(0));
}
