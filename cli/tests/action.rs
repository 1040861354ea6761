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
fn action(folder: &Path) -> (Option<i32>, String, String, String, String) {
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
    let (code, out, _, outputs, _) = action(&folder("wrong", "[]"));
    assert_eq!((code, outputs.lines().next()), (Some(2), Some("status=error")), "{out}");
}

#[test]
fn a_damaged_release_is_refused() {
    let folder = folder("damaged", r#"{"checks":[{"run":"framed-link"}]}"#);
    let archive = folder.join("releases").join(TAG).join(format!("{NAME}.tar.gz"));
    let mut bytes = fs::read(&archive).expect("the release");
    *bytes.last_mut().expect("bytes") ^= 1;
    fs::write(&archive, bytes).expect("a file");
    let (code, out, err, ..) = action(&folder);
    assert_eq!((code, out.as_str()), (Some(1), ""), "{err}");
    assert!(
        err.contains(&format!("::error::{NAME}.tar.gz differs from SHA256SUMS of release {TAG}")),
        "{err}"
    );
}
