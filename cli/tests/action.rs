//! The action's script, with a release of this build.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const TAG: &str = "v0.0.1";
const NAME: &str = "stepscope-0.0.1-x86_64-unknown-linux-musl";

fn run(command: &mut Command) -> Output {
    let output = command.output().expect("it starts");
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

/// A folder with a project, and a server's folder with a release, as `cargo xtask release` packs it.
fn folder(name: &str, list: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("action-{name}"));
    let _ = fs::remove_dir_all(&folder);
    let (project, release) = (folder.join("project"), folder.join("releases").join(TAG));
    let program = release.join(NAME).join("bin");
    for made in [&project, &program] {
        fs::create_dir_all(made).expect("a folder");
    }
    fs::copy(env!("CARGO_BIN_EXE_stepscope"), program.join("stepscope")).expect("the program");
    run(Command::new("tar").current_dir(&release).args(["-czf", &format!("{NAME}.tar.gz"), NAME]));
    let sums = run(Command::new("sha256sum").current_dir(&release).arg(format!("{NAME}.tar.gz")));
    fs::write(release.join("SHA256SUMS"), sums.stdout).expect("a file");
    fs::write(project.join("stepscope-checks.json"), list).expect("a file");
    folder
}

/// Exit code, standard output, standard error, outputs and summary.
type Ended = (Option<i32>, String, String, String, String);

fn action(folder: &Path) -> Ended {
    action_with(folder, &[])
}

fn action_with(folder: &Path, variables: &[(&str, &str)]) -> Ended {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..");
    let file = |name: &str| folder.join(name);
    let output = Command::new("bash")
        .arg(root.join("action.sh"))
        .current_dir(file("project"))
        .envs([("CHECKS", "stepscope-checks.json"), ("VERSION", TAG), ("REPORT", "report")])
        .envs([("RUNNER_OS", "Linux"), ("RUNNER_ARCH", "X64")])
        .env("RELEASES", format!("file://{}", file("releases").display()))
        .env("ACTION_PATH", &root)
        .env("RUNNER_TEMP", file("temporary"))
        .env("GITHUB_OUTPUT", file("outputs"))
        .env("GITHUB_STEP_SUMMARY", file("job.md"))
        .envs(variables.iter().copied())
        .output()
        .expect("bash starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    let read = |name: &str| fs::read_to_string(file(name)).unwrap_or_default();
    (output.status.code(), text(output.stdout), text(output.stderr), read("outputs"), read("job.md"))
}

#[test]
fn passing_checks_pass_the_action() {
    let folder = folder("passing", r#"{"checks":[{"run":"framed-link"}]}"#);
    let (code, out, err, outputs, summary) = action(&folder);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
    assert_eq!(out, "passed framed-link\n1 passed, 0 failed\n");
    assert_eq!(outputs, "status=passed\njunit=report/junit.xml\n");
    assert!(summary.starts_with("### Stepscope: 1 passed, 0 failed\n"), "{summary}");
    assert!(folder.join("project/report/junit.xml").exists());
}

#[test]
fn a_failed_check_is_an_annotation_and_its_exit_code() {
    let list = r#"{"checks":[{"name":"50 % <a> & \"b\"","run":"framed-link","digest":"0000000000000000"}]}"#;
    let (code, out, _, outputs, _) = action(&folder("failed", list));
    assert_eq!((code, outputs.lines().next()), (Some(3), Some("status=failed")), "{out}");
    assert!(out.contains("\n::error file=framed-link::50 %25 <a> & \"b\": the digest is "), "{out}");
    let (code, out, _, outputs, _) = action(&folder("error", r#"{"checks":[{"run":"missing.json"}]}"#));
    assert_eq!((code, outputs.lines().next()), (Some(1), Some("status=error")), "{out}");
    assert!(out.contains("\n::error file=missing.json::missing.json: "), "{out}");
}

#[test]
fn an_invalid_list_is_an_annotation_and_writes_no_report() {
    let folder = folder("wrong", r#"{"checks":[{"run":"x","digest":"50 %"}]}"#);
    fs::create_dir_all(folder.join("project/report")).expect("a folder");
    for (name, text) in [("junit.xml", "<testcase classname=\"old\""), ("summary.md", "old")] {
        fs::write(folder.join("project/report").join(name), text).expect("a report of an earlier run");
    }
    let (code, out, err, outputs, summary) = action(&folder);
    assert_eq!((code, summary.as_str()), (Some(2), ""));
    assert_eq!(outputs, "status=error\njunit=report/junit.xml\n");
    let why = "checks[0].digest: 50 %25 is not a digest; use 16 digits of 0-9 and a-f";
    assert!(out.starts_with("::error file=stepscope-checks.json::") && out.contains(why), "{out}");
    assert_eq!(out.lines().count(), 1, "{out}");
    assert!(err.contains("checks[0].digest: 50 % is not a digest"), "{err}");
    assert!(!folder.join("project/report/junit.xml").exists());
}

#[test]
fn annotations_name_files_from_the_top_of_the_project() {
    let folder = folder("below", "{}");
    let tests = folder.join("project/hw");
    fs::create_dir_all(&tests).expect("a folder");
    fs::write(tests.join("own, 1.json"), "{").expect("a file");
    let list = r#"{"checks":[{"run":"own, 1.json"},{"run":"framed-link","digest":"0000000000000000"}]}"#;
    fs::write(tests.join("list.json"), list).expect("a file");
    let (code, out, ..) = action_with(&folder, &[("CHECKS", "hw/list.json")]);
    assert_eq!(code, Some(2), "{out}");
    assert!(out.contains("\n::error file=hw/own%2C 1.json::own, 1.json: "), "{out}");
    assert!(out.contains("\n::error file=framed-link::framed-link: the digest is "), "{out}");
}

#[test]
fn without_a_release_the_sources_are_built() {
    let folder = folder("sources", r#"{"checks":[{"run":"framed-link"}]}"#);
    let programs = folder.join("programs");
    fs::create_dir_all(&programs).expect("a folder");
    let cargo = |script: &str| {
        let path = programs.join("cargo");
        fs::write(&path, format!("#!/bin/sh\n{script}\n")).expect("a script");
        run(Command::new("chmod").arg("+x").arg(path));
    };
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap_or_default());
    let program = env!("CARGO_BIN_EXE_stepscope");
    // cargo install --locked --quiet --path FOLDER --root FOLDER
    cargo(&format!("mkdir -p \"$7/bin\" && cp '{program}' \"$7/bin/stepscope\""));
    let with =
        |variables: &[(&str, &str)]| action_with(&folder, &[&[("PATH", path.as_str())], variables].concat());
    let (code, _, err, outputs, _) = with(&[("VERSION", "v9.9.9")]);
    assert_eq!((code, outputs.as_str()), (Some(0), "status=passed\njunit=report/junit.xml\n"), "{err}");
    let warning = "::warning::Release v9.9.9 can't be fetched; building stepscope from the action's sources";
    assert!(err.lines().any(|line| line == warning), "{err}");
    let (code, _, err, ..) = with(&[("VERSION", ""), ("ACTION_REF", "main"), ("RUNNER_ARCH", "RISCV64")]);
    let note = "There is no release for this runner; building stepscope from the action's sources\n";
    assert_eq!((code, err.as_str()), (Some(0), note));
    cargo("exit 101");
    fs::remove_file(folder.join("outputs")).expect("outputs");
    let (code, _, err, outputs, _) = with(&[("VERSION", "v9.9.9")]);
    assert_eq!((code, outputs.as_str()), (Some(1), "status=error\njunit=report/junit.xml\n"));
    assert!(err.contains("\n::error::stepscope can't be built; install Rust, or use a version"), "{err}");
}

#[test]
fn a_damaged_release_is_rejected() {
    let folder = folder("damaged", r#"{"checks":[{"run":"framed-link"}]}"#);
    let archive = folder.join("releases").join(TAG).join(format!("{NAME}.tar.gz"));
    let mut bytes = fs::read(&archive).expect("the release");
    *bytes.last_mut().expect("bytes") ^= 1;
    fs::write(&archive, bytes).expect("a file");
    let (code, out, err, outputs, _) = action(&folder);
    assert_eq!((code, out.as_str()), (Some(1), ""), "{err}");
    assert_eq!(outputs, "status=error\njunit=report/junit.xml\n");
    assert!(
        err.contains(&format!("::error::{NAME}.tar.gz differs from SHA256SUMS of release {TAG}")),
        "{err}"
    );
    // A sum that fits an archive that does not open.
    let sums = run(Command::new("bash")
        .current_dir(archive.parent().expect("a folder"))
        .args(["-c", &format!("echo no > {NAME}.tar.gz && sha256sum {NAME}.tar.gz > SHA256SUMS")]));
    assert!(sums.stdout.is_empty());
    let (code, _, err, ..) = action(&folder);
    assert!(
        code == Some(1)
            && err.contains(&format!("::error::{NAME}.tar.gz of release {TAG} can't be unpacked")),
        "{err}"
    );
}
