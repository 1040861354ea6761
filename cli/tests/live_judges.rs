//! `serve` and `send` with independent software: a host and a device in Python (pyserial, COBS, CRC-32C), connected
//! by socat.
//!
//! `cargo xtask test --only live` installs the tools and runs it.
#![cfg(unix)]
#![allow(clippy::expect_used, clippy::panic, reason = "a missing file or program fails the test")]

use rustix::process::{Pid, Signal, kill_process};
use std::{
    env, fs,
    io::{BufRead, BufReader, Read},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread,
    time::Duration,
};

const DEVICE: &str = r#"{ "bus": { "channels": 2 }, "line": { "protocol": "framed" } }"#;
/// 1.5 s of two motors for `device.py`; the queue covers a delay of 0.2 s.
const MOTION: &str = r#"{ "bus": { "channels": 2, "queue_depth": 200 }, "line": { "protocol": "framed", "address": 3, "host": { "attempts": 40 } },
    "source": { "motion": { "axes": [
        { "moves": [ { "constant": { "speed": { "steps_s": 1000 }, "distance": { "steps": 1500 } } } ] },
        { "moves": [ { "constant": { "speed": { "steps_s": 700 }, "distance": { "steps": -900 } } } ] } ] } } }"#;

fn file(name: &str, text: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("judges-{name}"));
    fs::write(&path, text).expect("a file");
    path
}

/// Ends the child when dropped.
struct Running {
    child: Child,
    out: BufReader<std::process::ChildStdout>,
    first: String,
}

impl Running {
    fn start(mut command: Command) -> Self {
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::inherit());
        let mut child = command.spawn().expect("it starts");
        let mut out = BufReader::new(child.stdout.take().expect("piped"));
        let mut first = String::new();
        out.read_line(&mut first).expect("a line");
        Self { child, out, first: first.trim().to_owned() }
    }

    fn rest(mut self) -> (Option<i32>, String) {
        let mut out = String::new();
        self.out.read_to_string(&mut out).expect("text");
        (self.child.wait().expect("it ends").code(), out)
    }

    fn end(self) -> (Option<i32>, String) {
        let _ = kill_process(Pid::from_child(&self.child), Signal::TERM);
        self.rest()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn stepscope(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stepscope"));
    command.args(arguments);
    command
}

fn python(script: &str, arguments: &[&str]) -> Command {
    let judges = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/judges");
    let python =
        env::var_os("STEPSCOPE_PYTHON").expect("`cargo xtask test --only live` sets the path of Python");
    let mut command = Command::new(python);
    command.arg("-B").arg(judges.join(script)).args(arguments);
    command
}

fn text(path: &Path) -> &str {
    path.to_str().expect("text")
}

/// Compares the host's commands with the model's steps.
fn served(place: &[&str], pace: &str, seed: u64) {
    let scenario = file("device.json", DEVICE);
    let record = file(&format!("recording-{seed}.json"), "");
    let more = ["--record", text(&record), "--pace", pace, "--lag", "1000"];
    let server = Running::start(stepscope(&[&["serve", text(&scenario)], place, &more].concat()));
    let judged = python("host.py", &[&server.first, &seed.to_string()]).output().expect("it runs");
    let (code, out) = server.end();
    let positions = String::from_utf8_lossy(&judged.stdout).into_owned();
    assert!(judged.status.success(), "{place:?} {pace}: {}\n{out}", String::from_utf8_lossy(&judged.stderr));
    assert_eq!(code, Some(0), "{out}");
    let words: Vec<&str> = positions.split_whitespace().collect();
    let [first, second, ticks] = words[..] else { panic!("{positions}") };
    assert!(out.contains(&format!("positions {first} {second}\n")), "{positions} {out}");
    assert!(out.contains(&format!("ticks_done {ticks}\n")), "{positions} {out}");
    let digest = stepscope(&["run", text(&record), "--digest"]).output().expect("it runs").stdout;
    assert!(out.contains(&format!("digest {}", String::from_utf8_lossy(&digest))), "{out}");
}

#[test]
#[ignore = "needs Python and socat: cargo xtask test --only live"]
fn serves_a_pyserial_host_by_pseudo_terminal_and_socket() {
    served(&["--pty"], "1", 1);
    served(&["--tcp", "127.0.0.1:0"], "1", 2);
    served(&["--tcp", "127.0.0.1:0"], "10", 3);
    served(&["--pty"], "max", 4);
}

#[test]
#[ignore = "needs Python and socat: cargo xtask test --only live"]
fn a_python_device_executes_all_ticks_despite_lost_replies() {
    let scenario = file("motion.json", MOTION);
    for seed in ["1", "2", "3"] {
        let device = Running::start(python("device.py", &[seed]));
        let port = format!("tcp:127.0.0.1:{}", device.first);
        let sent = stepscope(&["send", text(&scenario), "--port", &port, "--slack", "30"])
            .output()
            .expect("it runs");
        let (out, err) = (String::from_utf8_lossy(&sent.stdout), String::from_utf8_lossy(&sent.stderr));
        assert_eq!(sent.status.code(), Some(0), "{out}{err}");
        assert!(
            out.contains("positions 1550 -907: the sums of the ticks") && !out.contains(" repeated 0 "),
            "{out}"
        );
        let (_, report) = device.rest();
        let words: Vec<&str> = report.split_whitespace().collect();
        assert_eq!(words[1..], ["1550", "-907"], "{report}");
        // The device also counts the opening tick.
        let ticks = words[0].parse::<u32>().expect("a number") - 1;
        assert!(out.contains(&format!("ticks {ticks} of {ticks} done")), "{report} {out}");
    }
}

#[test]
#[ignore = "needs Python and socat: cargo xtask test --only live"]
fn serve_and_send_work_over_ports_of_socat() {
    let scenario = file("socat.json", MOTION);
    let ends = ["a", "b"].map(|end| scenario.with_file_name(format!("judges-socat-{end}")));
    let pty = |end: &Path| format!("pty,raw,echo=0,link={}", text(end));
    let mut socat =
        Command::new("socat").args(ends.each_ref().map(|end| pty(end))).spawn().expect("socat is there");
    while !ends.iter().all(|end| end.exists()) {
        assert!(socat.try_wait().expect("a child").is_none(), "socat has ended");
        thread::sleep(Duration::from_millis(10));
    }
    let server =
        Running::start(stepscope(&["serve", text(&scenario), "--port", text(&ends[0]), "--lag", "1000"]));
    let sent = stepscope(&["send", text(&scenario), "--port", text(&ends[1]), "--slack", "500"]).output();
    let sent = sent.expect("it runs");
    let (code, report) = server.end();
    let _ = (socat.kill(), socat.wait());
    let out = String::from_utf8_lossy(&sent.stdout);
    assert_eq!(sent.status.code(), Some(0), "{out} {}", String::from_utf8_lossy(&sent.stderr));
    assert!(out.contains("positions 1500 -900: the sums of the ticks"), "{out}");
    assert!(code == Some(0) && report.contains("positions 1500 -900\n"), "{report}");
}

#[test]
#[ignore = "needs Python and socat: cargo xtask test --only live"]
fn a_suspended_host_repeats_frames_and_no_tick_is_wrong() {
    let scenario = file("host-stopped.json", MOTION);
    let server =
        Running::start(stepscope(&["serve", text(&scenario), "--tcp", "127.0.0.1:0", "--lag", "1000"]));
    let arguments = ["send", text(&scenario), "--port", &server.first];
    let sender =
        stepscope(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    thread::sleep(Duration::from_millis(500));
    let _ = kill_process(Pid::from_child(&sender), Signal::STOP);
    thread::sleep(Duration::from_secs(2));
    let _ = kill_process(Pid::from_child(&sender), Signal::CONT);
    let sent = sender.wait_with_output().expect("it ends");
    let (out, err) = (String::from_utf8_lossy(&sent.stdout), String::from_utf8_lossy(&sent.stderr));
    let (_, report) = server.end();
    // The queue ran empty, which is a reported fault.
    assert_eq!(sent.status.code(), Some(3), "{out}{err}");
    assert!(out.contains("controller 0 address 3: done") && err.contains("UNDERRUN"), "{out}{err}");
    assert!(report.contains("positions 1500 -900\n"), "{report}");
}

#[test]
#[ignore = "needs Python and socat: cargo xtask test --only live"]
fn the_python_example_of_the_documentation_runs() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/how-to/connect-a-program.md");
    let page = fs::read_to_string(page).expect("the page");
    let (_, from) = page.split_once("```python\n").expect("lines of Python");
    let (lines, _) = from.split_once("```").expect("their end");
    assert!(lines.lines().count() <= 12 && lines.contains("\"/tmp/stepscope\""), "{lines}");
    let link = file("documented-port", "");
    fs::remove_file(&link).expect("it was made");
    let server = Running::start(stepscope(&["serve", "framed-link", "--pty", text(&link), "--lag", "1000"]));
    let script = file("documented.py", &lines.replace("/tmp/stepscope", text(&link)));
    let python =
        env::var_os("STEPSCOPE_PYTHON").expect("`cargo xtask test --only live` sets the path of Python");
    let ran = Command::new(python).arg(script).output().expect("it runs");
    let out = String::from_utf8_lossy(&ran.stdout);
    assert!(ran.status.success(), "{out}{}", String::from_utf8_lossy(&ran.stderr));
    // ACK of STATUS: READY, 16 places free; of TICKS: MOVING; of POSITIONS.
    let begins: Vec<&str> = out.lines().map(|line| &line[..20.min(line.len())]).collect();
    assert_eq!(begins[..2], ["status    01 84 01 1", "ticks     01 81 02 0"], "{out}");
    assert!(begins[2].starts_with("positions 01 87 "), "{out}");
    let (code, report) = server.end();
    assert!(code == Some(0) && report.contains("positions 5 -3\n"), "{report}");
}
