//! `stepscope send` against `firmware/avr/tick_controller.c` in simavr, in real time over a pseudo-terminal; compares
//! the recorded pins with the model's.
//!
//! `cargo xtask test --only avr` installs the tools and runs it.
#![cfg(unix)]
#![allow(clippy::expect_used, clippy::panic, reason = "a missing file or program fails the test")]

mod avr;

use avr::{call, compile, folder, in_the_repository};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::{
    env,
    ffi::OsStr,
    fs,
    io::{BufRead, BufReader, Read},
    path::{Path, PathBuf},
    process::{Child, ChildStdout, Command, Output, Stdio},
    thread,
    time::Duration,
};

const SIMAVR: [&str; 2] = ["-I/usr/include/simavr", "-I/usr/local/include/simavr"];
/// Tolerance after aligning the first steps: other interrupts, and the few cycles of a timer check.
const WITHIN_US: f64 = 2.0;
/// A machine that stops for longer than the queue lasts stops the motors; the test is then repeated.
const ATTEMPTS: usize = 3;

struct Board {
    child: Child,
    out: BufReader<ChildStdout>,
    port: String,
    folder: PathBuf,
}

impl Board {
    /// Builds both programs in a folder of that name, and switches on.
    fn on(name: &str) -> Self {
        let folder = folder(name);
        let program = "tick_controller.elf";
        compile(&folder, program, &["tick_controller.c", "framed_line.c", "tick_controller_pins.c"]);
        let source = in_the_repository("firmware/avr", "uart_on_pty.c");
        let options =
            "-O2 -Wall -Wextra -Werror -std=gnu11 -o uart_on_pty".split_whitespace().map(OsStr::new);
        let line = SIMAVR.map(OsStr::new).into_iter().chain(options);
        let line = line.chain([source.as_os_str(), OsStr::new("-lsimavr")]);
        call(&folder, "cc", &line.collect::<Vec<_>>());
        let mut child = Command::new(folder.join("uart_on_pty"))
            .args([program, "250000"])
            .current_dir(&folder)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("it starts");
        let mut out = BufReader::new(child.stdout.take().expect("piped"));
        let mut port = String::new();
        // simavr prints, too.
        while !port.starts_with("pty:") {
            port.clear();
            assert!(out.read_line(&mut port).expect("text") > 0, "the port is printed");
        }
        Self { child, out, port: port.trim().to_owned(), folder }
    }

    /// Call after the port is closed.
    fn recording(mut self) -> PathBuf {
        let code = self.child.wait().expect("it is our own").code();
        let mut output = String::new();
        self.out.read_to_string(&mut output).expect("text");
        assert_eq!(code, Some(0), "{output}");
        self.folder.join("tick_controller.vcd")
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn stepscope(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stepscope"));
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn text(path: &Path) -> &str {
    path.to_str().expect("text")
}

fn ended(output: Output) -> (Option<i32>, String, String) {
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn run(arguments: &[&str]) -> (Option<i32>, String, String) {
    ended(stepscope(arguments).output().expect("it runs"))
}

fn scenario() -> PathBuf {
    in_the_repository("firmware/avr", "tick-controller.json")
}

fn sent(name: &str, scenario: &Path) -> PathBuf {
    for _ in 0..ATTEMPTS {
        let board = Board::on(name);
        let (code, out, err) = run(&["send", text(scenario), "--port", &board.port, "--slack", "500"]);
        let recording = board.recording();
        // The host or the board stopped for too long.
        if code == Some(3) && (err.contains("UNDERRUN") || err.contains("QUEUE_OVERFLOW")) {
            continue;
        }
        assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
        assert!(
            out.contains("ticks 500 of 500 done")
                && out.contains("positions 800 1000: the sums of the ticks"),
            "{out}"
        );
        assert!(out.contains("state READY, new faults none"), "{out}");
        return recording;
    }
    panic!("this machine stood still for longer than the queue lasts, {ATTEMPTS} times")
}

#[test]
#[ignore = "builds for an AVR and runs simavr: cargo xtask test --only avr"]
fn the_firmware_executes_all_ticks_and_its_pins_match_the_model() {
    let scenario = scenario();
    let recording = sent("done", &scenario);
    for (channel, steps) in [("0", 2400), ("1", 1000)] {
        let within = WITHIN_US.to_string();
        let arguments = ["capture", text(&recording), "--against", text(&scenario), "--channel", channel];
        let (code, out, err) = run(&[&arguments[..], &["--within-us", &within, "--json"]].concat());
        assert_eq!(code, Some(0), "{out}{err}");
        let report: Value = serde_json::from_str(&out).expect("JSON");
        let row = &report["tables"]["comparison"][0];
        let number = |column: &str| row[column].as_f64().unwrap_or_else(|| panic!("{column}: {row}"));
        assert_eq!(row["compares"], "steps", "{row}");
        let steps = Value::from(steps);
        assert_eq!([&row["recorded"], &row["model"], &row["compared"]], [&steps; 3], "{row}");
        // simavr's cycles are the model's, so there is no drift.
        assert!(number("drift_ppm").abs() < 1.0 && number("rms_s") < WITHIN_US * 1e-6, "{row}");
        let us = |column| 1e6 * number(column);
        println!(
            "channel {channel}: {steps} steps, {:.3} us at most, {:.3} us r.m.s., drift {:.3} ppm",
            us("largest_late_s"),
            us("rms_s"),
            number("drift_ppm")
        );
    }
}

#[test]
#[ignore = "builds for an AVR and runs simavr: cargo xtask test --only avr"]
fn ctrl_c_stops_the_firmware_and_reports_its_positions() {
    let board = Board::on("stopped");
    let arguments =
        ["send", text(&scenario()), "--port", &board.port, "--slack", "500", "--json"].map(str::to_owned);
    let sender = stepscope(&arguments.each_ref().map(String::as_str)).spawn().expect("it starts");
    thread::sleep(Duration::from_millis(500));
    let _ = kill_process(Pid::from_child(&sender), Signal::INT);
    let (code, out, err) = ended(sender.wait_with_output().expect("it ends"));
    assert_eq!(code, Some(130), "{out}{err}");
    let report: Value = serde_json::from_str(&out).expect("JSON");
    let row = &report["tables"]["controllers"][0];
    assert_eq!((&row["state"], &row["stop_acknowledged"]), (&"STOPPED".into(), &true.into()), "{out}");
    let reported: Vec<_> =
        (0..2).map(|channel| report["tables"]["positions"][channel]["reported"].as_i64()).collect();
    let recording = board.recording();
    let (_, out, _) = run(&["capture", text(&recording), "--json"]);
    let recorded: Value = serde_json::from_str(&out).expect("JSON");
    let steps: Vec<_> =
        (0..2).map(|channel| recorded["tables"]["steps"][channel]["position"].as_i64()).collect();
    assert_eq!(steps, reported, "{out}");
    // At the end the windings have no current.
    let edges = recording.with_file_name("edges.csv");
    let (code, out, err) = run(&["capture", text(&recording), "--csv", text(&edges)]);
    assert_eq!(code, Some(0), "{out}{err}");
    let edges = fs::read_to_string(&edges).expect("text");
    let mut lines = edges.lines();
    let column =
        lines.next().and_then(|head| head.split(',').position(|name| name == "EN")).expect("a column");
    assert_eq!(lines.last().and_then(|last| last.split(',').nth(column)), Some("0"), "{out}");
}

#[test]
#[ignore = "builds for an AVR and runs simavr: cargo xtask test --only avr"]
fn the_firmware_passes_the_checks_of_an_independent_host() {
    let python =
        env::var_os("STEPSCOPE_PYTHON").expect("`cargo xtask test --only avr` sets the path of Python");
    let judge = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/judges/host.py");
    let board = Board::on("judged");
    let judged =
        Command::new(python).arg("-B").arg(judge).args([&board.port, "7"]).output().expect("it runs");
    let (code, out, err) = ended(judged);
    assert_eq!(code, Some(0), "{err}");
    let positions: Vec<i64> =
        out.split_whitespace().take(2).map(|word| word.parse().expect("a number")).collect();
    let (_, out, _) = run(&["capture", text(&board.recording()), "--json"]);
    let recorded: Value = serde_json::from_str(&out).expect("JSON");
    let steps: Vec<_> =
        (0..2).filter_map(|channel| recorded["tables"]["steps"][channel]["position"].as_i64()).collect();
    assert_eq!(steps, positions, "{out}");
}
