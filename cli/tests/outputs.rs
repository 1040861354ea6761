//! Outputs: mistakes, Ctrl-C, full disks and closed pipes destroy nothing.

use crate::program::stepscope;
use std::{
    fs,
    io::Read,
    path::PathBuf,
    process::{Command, Stdio},
    thread,
    time::Duration,
};

/// 2000 s of motion: long enough to be interrupted.
const LONG: &str = r#"{"clock_hz":1000000,"bus":{"step_period_cycles":50,"pulse_width_cycles":4,"dir_setup_cycles":4},
    "line":{"baud":57600},"source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":30000000},"speed":{"steps_s":15000}}}]}]}}}"#;

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("outputs-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn files(folder: &PathBuf) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn in_folder(folder: &PathBuf, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_stepscope"))
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .expect("it starts");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[test]
fn rejects_an_output_that_is_an_input_or_another_output() {
    let folder = folder("same");
    fs::create_dir(folder.join("sub")).expect("a folder");
    fs::write(folder.join("in.json"), "{}").expect("a file");
    fs::write(folder.join("old.csv"), "old").expect("a file");
    fs::hard_link(folder.join("in.json"), folder.join("hard.json")).expect("a link");
    fs::hard_link(folder.join("old.csv"), folder.join("hard.csv")).expect("a link");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("in.json", folder.join("soft.json")).expect("a link");
        std::os::unix::fs::symlink("new.vcd", folder.join("soft.vcd")).expect("a link");
    }
    let input = "is an input and would be overwritten";
    let twice = " is already the output of --";
    let standard = ": standard output is already used by --";
    let rows: &[(&[&str], &str)] = &[
        (&["run", "in.json", "--trace", "in.json"], input),
        (&["run", "in.json", "--line", "./sub/../in.json"], input),
        (&["run", "in.json", "--vcd", "hard.json"], input),
        (&["run", "in.json", "--violations", "in.json", "--driver", "a4988"], input),
        (&["tables", "in.json", "--out", "in.json"], input),
        (&["tables", "in.json", "--format", "c", "--out", "hard.json"], input),
        (&["torque", "in.json", "--out", "in.json"], input),
        (&["run", "in.json", "--trace", "new.csv", "--csv", "new.csv"], twice),
        (&["run", "in.json", "--trace", "new.csv", "--csv", "sub/../new.csv"], twice),
        (&["run", "in.json", "--trace", "old.csv", "--packets", "hard.csv"], twice),
        (&["run", "in.json", "--trace", "-", "--csv", "-"], standard),
        (&["run", "in.json", "--line", "-", "--json"], standard),
        #[cfg(unix)]
        (&["run", "in.json", "--packets", "soft.json"], input),
        #[cfg(unix)]
        (&["run", "in.json", "--trace", "new.vcd", "--vcd", "soft.vcd"], twice),
        #[cfg(unix)]
        (&["run", "in.json", "--trace", "-", "--vcd", "/dev/stdout"], standard),
    ];
    let before = files(&folder);
    for (arguments, expected) in rows {
        let (code, out, err) = in_folder(&folder, arguments);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{arguments:?}: {err}");
        assert!(err.contains(expected), "{arguments:?}: {err}");
        assert_eq!(files(&folder), before, "{arguments:?}");
    }
    assert_eq!(fs::read_to_string(folder.join("in.json")).expect("a file"), "{}");
    assert_eq!(fs::read_to_string(folder.join("old.csv")).expect("a file"), "old");
}

#[test]
fn names_a_folder_that_does_not_exist() {
    let folder = folder("missing");
    fs::write(folder.join("in.json"), "{}").expect("a file");
    let (code, out, err) = in_folder(&folder, &["run", "in.json", "--vcd", "nope/x.vcd"]);
    assert_eq!((code, out.as_str()), (Some(1), ""));
    assert_eq!(err, "nope/x.vcd: the folder nope does not exist; create it, or use another path\n");
}

/// A compared scenario is an input, too.
#[test]
fn capture_does_not_overwrite_the_compared_scenario() {
    let folder = folder("compared");
    fs::write(folder.join("s.json"), "{}").expect("a file");
    for output in ["--scenario", "--late", "--vcd"] {
        let arguments = ["capture", "recorded-step-table", "--against", "s.json", output, "s.json"];
        let (code, out, err) = in_folder(&folder, &arguments);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{output}");
        assert!(err.contains(": s.json is an input and would be overwritten"), "{err}");
    }
    let (code, _, err) = in_folder(&folder, &["tables", "in.json", "--steps", "s.json", "--out", "./s.json"]);
    assert!(code == Some(2) && err.contains("is an input"), "{err}");
    assert_eq!(fs::read_to_string(folder.join("s.json")).expect("a file"), "{}");
}

/// The system decides what a device is, not the folder.
#[cfg(target_os = "linux")]
#[test]
fn writes_a_file_in_a_folder_of_devices() {
    let path = PathBuf::from(format!("/dev/shm/stepscope-test-{}.trace", std::process::id()));
    let name = path.display().to_string();
    let (code, _, err) = stepscope(&["run", "-", "--trace", &name], "{}");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let text = fs::read_to_string(&path).expect("it is written");
    fs::remove_file(&path).expect("it was there");
    for standard in ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "-"] {
        assert_eq!(
            stepscope(&["run", "-", "--trace", standard], "{}"),
            (Some(0), text.clone(), String::new())
        );
    }
}

#[test]
fn replaces_files_atomically_and_leaves_no_others() {
    let folder = folder("replaced");
    fs::write(folder.join("in.json"), "{}").expect("a file");
    fs::write(folder.join("old.trace"), "old").expect("a file");
    #[cfg(unix)]
    {
        use std::os::unix::fs::{PermissionsExt, symlink};
        fs::set_permissions(folder.join("old.trace"), PermissionsExt::from_mode(0o640)).expect("a file");
        symlink("old.trace", folder.join("soft.trace")).expect("a link");
    }
    let trace = if cfg!(unix) { "soft.trace" } else { "old.trace" };
    let (code, out, err) = in_folder(&folder, &["run", "in.json", "--trace", trace, "--csv", "new.csv"]);
    assert_eq!((code, out.as_str(), err.as_str()), (Some(0), "", ""));
    let text = fs::read_to_string(folder.join("old.trace")).expect("a file");
    assert_eq!(text, in_folder(&folder, &["run", "in.json", "--trace", "-"]).1);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = |name| fs::metadata(folder.join(name)).expect("a file").permissions().mode() & 0o777;
        assert_eq!(mode("old.trace"), 0o640, "as it was");
        // Permissions are those of a new file, not of a temporary one.
        fs::write(folder.join("plain"), "").expect("a file");
        assert_eq!(mode("new.csv"), mode("plain"));
        fs::remove_file(folder.join("plain")).expect("it was there");
        assert!(fs::symlink_metadata(folder.join("soft.trace")).expect("a link").is_symlink());
        fs::remove_file(folder.join("soft.trace")).expect("it was there");
    }
    assert_eq!(files(&folder), ["in.json", "new.csv", "old.trace"]);
}

#[test]
fn a_failing_command_changes_no_file() {
    let folder = folder("failed");
    fs::write(folder.join("in.json"), "{}").expect("a file");
    fs::write(folder.join("old.trace"), "old").expect("a file");
    let line = if cfg!(target_os = "linux") { "/dev/full" } else { "no-folder/line.json" };
    let (code, out, err) =
        in_folder(&folder, &["run", "in.json", "--trace", "old.trace", "--vcd", "new.vcd", "--line", line]);
    assert_eq!((code, out.as_str()), (Some(1), ""), "{err}");
    assert!(err.starts_with(line), "{err}");
    assert_eq!(files(&folder), ["in.json", "old.trace"]);
    assert_eq!(fs::read_to_string(folder.join("old.trace")).expect("a file"), "old");
}

#[test]
fn rejects_a_folder_as_output() {
    let folder = folder("names");
    fs::create_dir(folder.join("there")).expect("a folder");
    for name in ["new/", "there/", "there", "."] {
        let (code, out, err) = in_folder(&folder, &["run", "framed-link", "--trace", name]);
        assert_eq!((code, out.as_str()), (Some(1), ""), "{name}: {err}");
        assert!(err.starts_with(&format!("{name}: ")), "{err}");
    }
    assert_eq!(files(&folder), ["there"]);
}

#[cfg(target_os = "linux")]
#[test]
fn reports_a_full_disk_and_does_not_replace_devices() {
    for arguments in [
        &["run", "-", "--trace", "/dev/full"] as &[&str],
        &["run", "-", "--vcd", "/dev/full"],
        &["run", "-", "--packets", "/dev/full"],
        &["tables", "-", "--out", "/dev/full"],
    ] {
        let (code, _, err) = stepscope(arguments, "{}");
        assert_eq!(code, Some(1), "{arguments:?}");
        assert!(err.starts_with("/dev/full: "), "{err}");
    }
    let (code, _, err) = stepscope(&["run", "-", "--trace", "/dev/null", "--vcd", "/dev/null"], "{}");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    use std::os::unix::fs::FileTypeExt;
    assert!(fs::metadata("/dev/null").expect("it is there").file_type().is_char_device());
}

/// The command inherits ignored signals, as under nohup.
#[cfg(unix)]
fn signals_are_ignored() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask & (1 | 1 << 1 | 1 << 14) != 0
}

/// Ends a run in the middle by a signal, and gives its exit code.
#[cfg(unix)]
fn ended_by(signal: &str, folder: &PathBuf) -> Option<i32> {
    fs::write(folder.join("in.json"), LONG).expect("a file");
    fs::write(folder.join("old.trace"), "old").expect("a file");
    let mut child = Command::new(env!("CARGO_BIN_EXE_stepscope"))
        .args(["run", "in.json", "--trace", "old.trace", "--vcd", "new.vcd"])
        .current_dir(folder)
        .spawn()
        .expect("it starts");
    while files(folder).len() < 4 {
        assert!(child.try_wait().expect("a child").is_none(), "it has ended");
        thread::sleep(Duration::from_millis(5));
    }
    let killed = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill starts");
    assert!(killed.success());
    child.wait().expect("it ends").code()
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_existing_files_unchanged() {
    for signal in ["-INT", "-TERM"].into_iter().filter(|_| !signals_are_ignored()) {
        let folder = folder(&format!("ended{signal}"));
        assert_eq!(ended_by(signal, &folder), Some(130), "{signal}");
        assert_eq!(files(&folder), ["in.json", "old.trace"], "{signal}");
        assert_eq!(fs::read_to_string(folder.join("old.trace")).expect("a file"), "old");
    }
    // SIGKILL leaves temporary files, but no incomplete output.
    let folder = folder("ended-KILL");
    assert_eq!(ended_by("-KILL", &folder), None);
    let left = files(&folder);
    assert_eq!(left.iter().filter(|name| name.ends_with(".part")).count(), 2, "{left:?}");
    assert_eq!(fs::read_to_string(folder.join("old.trace")).expect("a file"), "old");
    assert!(!folder.join("new.vcd").exists());
}

/// Like `| head -1`.
#[test]
fn a_closed_pipe_ends_a_command_silently() {
    let folder = folder("pipe");
    fs::write(folder.join("in.json"), LONG).expect("a file");
    for arguments in [
        &["run", "in.json", "--trace", "-"] as &[&str],
        &["run", "in.json", "--vcd", "-"],
        // About 20 times a pipe's capacity.
        &["sine", "sweep", "--points", "20000"],
    ] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_stepscope"))
            .args(arguments)
            .current_dir(&folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("it starts");
        let mut out = child.stdout.take().expect("it is piped");
        let mut first = [0];
        out.read_exact(&mut first).expect("there is something");
        drop(out);
        let output = child.wait_with_output().expect("it ends");
        let err = String::from_utf8(output.stderr).expect("text");
        assert_eq!((output.status.code(), err.as_str()), (Some(141), ""), "{arguments:?}");
    }
}
