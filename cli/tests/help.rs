//! Help pages and suggestions.

use crate::program::stepscope;
#[cfg(unix)]
use std::{
    fs,
    io::{BufRead, BufReader, Read},
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// The commands that a help page lists, with the words before them.
fn commands(before: &[String]) -> Vec<Vec<String>> {
    let words: Vec<&str> = before.iter().map(String::as_str).chain(["--help"]).collect();
    let help = stepscope(&words, "").1;
    let listed =
        help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = listed.filter_map(|line| line.strip_prefix("  ").filter(|line| !line.starts_with(' ')));
    let names = names.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    names.map(|name| before.iter().cloned().chain([name.to_owned()]).collect()).collect()
}

#[cfg(unix)]
fn examples(command: &[String]) -> Vec<String> {
    let words: Vec<&str> = command.iter().map(String::as_str).chain(["--help"]).collect();
    let help = stepscope(&words, "").1;
    let examples = help.lines().skip_while(|line| *line != "Examples:").skip(1);
    examples.filter_map(|line| line.strip_prefix("  ")).map(str::to_owned).collect()
}

#[cfg(unix)]
fn shell(line: &str, folder: &Path) -> Command {
    let programs = Path::new(env!("CARGO_BIN_EXE_stepscope")).parent().expect("a folder");
    let mut path = programs.as_os_str().to_owned();
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let mut command = Command::new("sh");
    command.args(["-c", line]).current_dir(folder).env("PATH", path);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// An empty folder.
#[cfg(unix)]
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

#[cfg(unix)]
#[test]
fn every_example_runs_as_printed_in_an_empty_folder() {
    let mut all = vec![Vec::new()];
    all.extend(commands(&[]));
    all.extend(commands(&["sine".to_owned()]));
    let is_live =
        |command: &Vec<String>| ["serve", "send"].iter().any(|live| command.iter().any(|word| word == live));
    all.retain(|command| !is_live(command));
    assert!(all.len() >= 20, "{all:?}");
    for command in all {
        let lines = examples(&command);
        assert_eq!(lines.len(), 2, "{command:?}");
        for line in lines {
            let folder = folder("examples");
            let output = shell(&line, &folder).output().expect("sh starts");
            assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
            let is_written = fs::read_dir(&folder).expect("a folder").count() > 0;
            let writes = [" -o ", " --vcd ", " --csv ", " --dir ", " --junit ", " > "]
                .iter()
                .any(|word| line.contains(word));
            assert_eq!(is_written, writes, "{line}");
        }
    }
}

/// Ends with the test.
#[cfg(unix)]
struct Running(std::process::Child);

#[cfg(unix)]
impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The examples of `serve` and `send` connect to each other in pairs.
#[cfg(unix)]
#[test]
fn the_examples_of_live_commands_run_with_each_other() {
    let pairs = examples(&["serve".to_owned()]).into_iter().zip(examples(&["send".to_owned()]));
    for (serve, send) in pairs {
        let folder = folder("live-examples");
        // A busy machine replies late.
        let server = shell(&format!("exec {serve} --lag 60000"), &folder).spawn().expect("sh starts");
        let mut server = Running(server);
        let mut out = BufReader::new(server.0.stdout.take().expect("piped"));
        let mut address = String::new();
        out.read_line(&mut address).expect("text");
        if address.is_empty() {
            // Another program has the port.
            let mut err = String::new();
            server.0.stderr.take().expect("piped").read_to_string(&mut err).expect("text");
            assert!(serve.contains("--tcp") && err.contains("in use"), "{serve}: {err}");
            continue;
        }
        let output = shell(&format!("{send} --slack 2000"), &folder).output().expect("sh starts");
        let err = String::from_utf8_lossy(&output.stderr).into_owned();
        // A queue that ran empty on a busy machine is reported, with 3.
        let code = output.status.code();
        assert!(code == Some(0) || code == Some(3) && err.contains("UNDERRUN"), "{send}: {err}");
        let pid = rustix::process::Pid::from_child(&server.0);
        rustix::process::kill_process(pid, rustix::process::Signal::TERM).expect("it runs");
        drop(out);
        // Standard output is closed, so the exit code may be 141.
        server.0.wait().expect("it ends");
        assert_eq!(folder.join("session.json").exists(), serve.contains("--record session.json"));
    }
}

#[test]
fn suggests_similar_names() {
    let rows: &[(&[&str], &str, &str)] = &[
        (&["calibrat"], "", "a similar subcommand exists: 'calibrate'"),
        (&["run", "-", "--trase", "x"], "{}", "a similar argument exists: '--trace'"),
        (&["run", "song-2021-one-trun"], "", "a similar name is song-2021-one-turn"),
        (&["capture", "recorded-step-tabel"], "", "a similar name is recorded-step-table"),
        (&["presets", "framed-lnik"], "", "a similar name is framed-link"),
        (&["run", "-", "--driver", "a4989"], "{}", "a similar name is a4988"),
        (&["plant", "framed-link", "--motor", "17hs4402"], "", "a similar value exists: '17hs4401'"),
        (&["run", "-"], r#"{"clok_hz": 1}"#, "a similar name is clock_hz"),
        (&["run", "-"], r#"{"bus": {"chanels": 1}}"#, "a similar name is channels"),
        (&["run", "-", "--driver", "custom:step_hihg_ns=1"], "{}", "a similar name is step_high_ns"),
    ];
    for (arguments, input, expected) in rows {
        let (code, out, err) = stepscope(arguments, input);
        assert!(matches!(code, Some(1 | 2)) && out.is_empty(), "{arguments:?}: {code:?} {out}");
        assert!(err.contains(expected), "{arguments:?}: {err}");
    }
    let (_, _, err) = stepscope(&["run", "-"], r#"{"temperature": 1}"#);
    assert!(err.contains("temperature") && !err.contains("similar name"), "{err}");
    assert_eq!(commands(&[]).len(), 26, "a new command has a page in cli/src/help.rs");
}

#[test]
fn writes_standard_output_to_a_file_with_o() {
    let folder = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join("written-with-o").display().to_string();
    let table = "0,0\n1,5\n";
    let calls: &[(&[&str], &str)] = &[
        (&["presets"], ""),
        (&["presets", "--json"], ""),
        (&["presets", "framed-link"], ""),
        (&["open", "#c=2.j.e30.90f7e4f5"], ""),
        (&["points", "-"], table),
        (&["measures", "framed-link"], ""),
        (&["measures", "framed-link", "--json"], ""),
        (&["measures", "two-controllers-raw", "--format", "csv"], ""),
        (&["steps", "framed-link"], ""),
        (&["curve", "framed-link", "--format", "json"], ""),
        (&["spectrum", "sine-2022-d00054"], ""),
        (&["schema"], ""),
        (&["resonance", "-", "--to", "20"], r#"{"plant":{}}"#),
        (&["completions", "zsh"], ""),
        (&["sine", "vertices", "--segments", "2"], ""),
    ];
    for (arguments, input) in calls {
        let _ = std::fs::remove_file(&path);
        let (code, out, err) = stepscope(arguments, input);
        assert_eq!((code, err.as_str()), (Some(0), ""), "{arguments:?}");
        let (code, printed, err) = stepscope(&[arguments, &["-o", &path][..]].concat(), input);
        assert_eq!((code, printed.as_str(), err.as_str()), (Some(0), "", ""), "{arguments:?}");
        assert_eq!(std::fs::read_to_string(&path).expect("it is written"), out, "{arguments:?}");
    }
    let (code, _, err) = stepscope(&["faults", "--seed", "1", "-o", &path], "");
    assert!(code == Some(2) && err.starts_with("--protocol: both gives two scenarios"), "{err}");
    let raw = stepscope(&["faults", "--seed", "1", "--protocol", "raw", "--scenario"], "").1;
    assert_eq!(stepscope(&["faults", "--seed", "1", "--protocol", "raw", "-o", &path], "").0, Some(0));
    assert_eq!(std::fs::read_to_string(&path).expect("it is written"), raw);
}

/// Standard error is a terminal, as for a person.
#[cfg(target_os = "linux")]
#[test]
fn long_work_shows_a_bar_on_a_terminal_and_ends_with_a_line() {
    use rustix::{
        process::{Pid, Signal, kill_process},
        pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
    };
    let folder = folder("progress");
    // Up to 2000 s.
    let moves = |steps: u32| {
        format!(
            r#"{{"clock_hz":1000000,"bus":{{"step_period_cycles":50,"pulse_width_cycles":4,"dir_setup_cycles":4}},"line":{{"baud":57600}},
            "source":{{"motion":{{"axes":[{{"moves":[{{"constant":{{"distance":{{"steps":{steps}}},"speed":{{"steps_s":15000}}}}}}]}}]}}}}}}"#
        )
    };
    fs::write(folder.join("long.json"), moves(30_000_000)).expect("a file");
    fs::write(folder.join("short.json"), moves(100)).expect("a file");
    let run = |scenario: &str, ci: bool| {
        let master =
            openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).expect("a terminal");
        grantpt(&master).and_then(|()| unlockpt(&master)).expect("it can be opened");
        let name = ptsname(&master, Vec::new()).expect("a name").into_string().expect("text");
        let slave = fs::OpenOptions::new().read(true).write(true).open(name).expect("it opens");
        let mut command = Command::new(env!("CARGO_BIN_EXE_stepscope"));
        command.args(["run", scenario, "--trace", "t.trace"]).current_dir(&folder).stderr(slave);
        command.stdin(Stdio::null()).stdout(Stdio::null()).env("TERM", "xterm").env_remove("CI");
        if ci {
            command.env("CI", "true");
        }
        (fs::File::from(master), command.spawn().expect("it starts"))
    };
    // A terminal whose other end is closed reports an error at its end.
    let rest = |mut terminal: fs::File| {
        let (mut bytes, mut buffer) = (Vec::new(), [0; 1024]);
        while let Ok(count @ 1..) = terminal.read(&mut buffer) {
            bytes.extend_from_slice(&buffer[..count]);
        }
        String::from_utf8_lossy(&bytes).into_owned()
    };
    let (mut terminal, mut child) = run("long.json", false);
    let (mut seen, mut buffer) = (String::new(), [0; 1024]);
    while !(seen.contains("run [") && seen.contains(" left")) {
        let count = terminal.read(&mut buffer).expect("the run goes on");
        seen += &String::from_utf8_lossy(&buffer[..count]);
    }
    kill_process(Pid::from_child(&child), Signal::TERM).expect("it runs");
    assert_eq!(child.wait().expect("it ends").code(), Some(130));
    for (ci, expected) in [(false, true), (true, false)] {
        let (terminal, mut child) = run("short.json", ci);
        assert!(child.wait().expect("it ends").success());
        let text = rest(terminal);
        let is_line = text.trim_end().ends_with("; wrote t.trace") && text.contains(" records, ");
        assert_eq!((is_line, text.is_empty()), (expected, !expected), "{text:?}");
    }
}
