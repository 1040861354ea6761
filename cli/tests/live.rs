//! `stepscope serve` and `stepscope send`: against each other, against test devices, and with failures in between.

use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use std::{
    fs,
    io::{BufRead, BufReader, Read, Write},
    net::{Shutdown, TcpListener, TcpStream},
    path::{Path, PathBuf},
    process::{Child, ChildStderr, ChildStdout, Command, Output, Stdio},
    thread,
    time::Duration,
};
use stepscope_core::peripheral::{
    protocol::{Kind, Reason, Reply, State, Status},
    wire::frame::{Deframed, Deframer, Ticks, emit},
};

/// Four ticks of two channels in one frame, the last without steps: no machine is too slow for this.
const FEW: &str = r#"{ "bus": { "channels": 2 }, "line": { "protocol": "framed" },
    "source": { "packets": { "packets": [ "8102", "8304", "8201" ] } } }"#;
/// Four seconds.
const LONG: &str = r#"{ "line": { "protocol": "framed" }, "source": { "motion": { "axes": [
    { "moves": [ { "constant": { "speed": { "steps_s": 2000 }, "distance": { "steps": 8000 } } } ] } ] } } }"#;
const RAW: &str = r#"{ "bus": { "channels": 2, "queue_depth": 100 }, "line": { "address": 7 },
    "source": { "packets": { "packets": [ "078102", "078304", "078201", "078000" ] } } }"#;

fn file(name: &str, text: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("live-{name}"));
    fs::write(&path, text).expect("a file");
    path
}

fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_stepscope"));
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn text(path: &Path) -> &str {
    path.to_str().expect("text")
}

struct Server {
    child: Child,
    out: BufReader<ChildStdout>,
    err: BufReader<ChildStderr>,
    address: String,
}

impl Server {
    fn start(arguments: &[&str]) -> Self {
        let mut child = command(&[&["serve"], arguments].concat()).spawn().expect("it starts");
        let mut out = BufReader::new(child.stdout.take().expect("piped"));
        let err = BufReader::new(child.stderr.take().expect("piped"));
        let mut address = String::new();
        out.read_line(&mut address).expect("it prints its address");
        Self { child, out, err, address: address.trim().to_owned() }
    }

    fn signal(&self, signal: Signal) {
        signal_to(&self.child, signal);
    }

    fn end(mut self) -> (Option<i32>, String, String) {
        self.signal(Signal::TERM);
        self.wait()
    }

    fn wait(&mut self) -> (Option<i32>, String, String) {
        let (mut out, mut err) = (String::new(), String::new());
        self.out.read_to_string(&mut out).expect("text");
        self.err.read_to_string(&mut err).expect("text");
        (self.child.wait().expect("it ends").code(), out, err)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn signal_to(child: &Child, signal: Signal) {
    let _ = kill_process(Pid::from_child(child), signal);
}

fn ended(output: Output) -> (Option<i32>, String, String) {
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn send(scenario: &Path, port: &str, more: &[&str]) -> (Option<i32>, String, String) {
    let arguments = [&["send", text(scenario), "--port", port], more].concat();
    ended(command(&arguments).output().expect("it runs"))
}

fn run_digest(scenario: &Path) -> String {
    ended(command(&["run", text(scenario), "--digest"]).output().expect("it runs")).1.trim().to_owned()
}

#[test]
fn executes_all_ticks_and_records_the_session() {
    let scenario = file("done.json", FEW);
    let record = scenario.with_file_name("live-done-recording.json");
    let link = scenario.with_file_name("live-done-port");
    for connection in [&["--pty", text(&link)][..], &["--tcp", "127.0.0.1:0"]] {
        for pace in ["1", "max"] {
            let more = ["--record", text(&record), "--once", "--pace", pace];
            let mut server = Server::start(&[&[text(&scenario)], connection, &more].concat());
            let port = if connection[0] == "--pty" {
                format!("pty:{}", text(&link))
            } else {
                server.address.clone()
            };
            // A pseudo-terminal shows no end to wait for.
            let (code, out, err) = send(&scenario, &port, &["--slack", "500"]);
            assert_eq!((code, err.as_str()), (Some(0), ""), "{connection:?} {pace}: {out}");
            assert!(out.contains("controller 0 address 0: done\n  ticks 4 of 4 done"), "{out}");
            let confirmed = "positions 6 -7: the sums of the ticks\n  state READY, new faults none";
            assert!(out.contains(confirmed), "{out}");
            let (code, out, err) = server.wait();
            // A loaded machine may be too slow, which is reported.
            assert!(code == Some(0) || code == Some(3) && err.contains("not in real time"), "{code:?} {err}");
            assert!(err.contains("recorded") && out.contains("positions 6 -7\n"), "{out}{err}");
            let digest = out.lines().find_map(|line| line.strip_prefix("digest ")).expect("a digest");
            assert_eq!(run_digest(&record), digest, "{connection:?} {pace}");
            let shared = out.lines().find(|line| line.starts_with("#c=")).expect("a link");
            let (code, _, err) = ended(command(&["open", shared, "--verify"]).output().expect("it runs"));
            assert_eq!(code, Some(0), "{err}");
            let times = fs::read_to_string(record.with_file_name("live-done-recording.session.json"));
            let times: Value = serde_json::from_str(&times.expect("it is there")).expect("it is JSON");
            assert_eq!((&times["digests"][0], &times["pace"]), (&Value::from(digest), &Value::from(pace)));
            assert!(times["replies"].as_array().is_some_and(|replies| replies.len() >= 5));
            assert!(!link.exists(), "the link is removed with the session");
        }
    }
}

#[test]
fn raw_packets_are_sent_but_not_reported_as_done() {
    let scenario = file("raw.json", RAW);
    let server = Server::start(&[text(&scenario), "--tcp", "127.0.0.1:0"]);
    let (code, out, err) = send(&scenario, &server.address, &["--lead", "3"]);
    assert_eq!(code, Some(3), "{out}");
    assert!(err.contains("sent, not verified"), "{err}");
    assert!(out.contains("sent 4 of 4 packets; not verified") && !out.contains("done"), "{out}");
    thread::sleep(Duration::from_millis(100));
    let (code, out, err) = send(&scenario, &server.address, &["--json"]);
    let report: Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{code:?} {out} {err}"));
    let row = &report["tables"]["send"][0];
    assert_eq!((&row["outcome"], &row["packets_sent"]), (&Value::from("not verified"), &Value::from(4)));
    thread::sleep(Duration::from_millis(300));
    let (_, out, _) = server.end();
    assert!(out.contains("positions 12 -14\n"), "{out}");
}

#[test]
fn ctrl_c_stops_the_motor_and_reports_its_position() {
    let scenario = file("stopped.json", LONG);
    let server = Server::start(&[text(&scenario), "--tcp", "127.0.0.1:0", "--lag", "2000"]);
    let arguments = ["send", text(&scenario), "--port", &server.address, "--json", "--slack", "1000"];
    let sender = command(&arguments).spawn().expect("it starts");
    // The motion is under way.
    thread::sleep(Duration::from_millis(1000));
    signal_to(&sender, Signal::INT);
    let (code, out, err) = ended(sender.wait_with_output().expect("it ends"));
    assert_eq!(code, Some(130), "{out}{err}");
    let report: Value = serde_json::from_str(&out).expect("it is JSON");
    let row = &report["tables"]["controllers"][0];
    let stopped = (&Value::from("STOPPED"), &Value::from(true));
    assert_eq!((&row["state"], &row["stop_acknowledged"]), stopped, "{out}");
    assert_ne!(report["tables"]["send"][0]["outcome"], "done");
    let position = |column: &str| report["tables"]["positions"][0][column].as_i64().expect("a number");
    let bounds = position("steps_of_done_ticks")..=position("steps_with_the_next_tick");
    let reported = position("reported");
    assert!(bounds.contains(&reported), "{out}");
    let (_, out, _) = server.end();
    assert!(
        out.contains(&format!("positions {reported}\n")) && out.contains("state STOPPED"),
        "{reported} {out}"
    );
}

#[test]
fn a_lost_port_ends_with_4_and_reports_the_first_unconfirmed_tick() {
    let scenario = file("lost.json", LONG);
    let link = scenario.with_file_name("live-lost-port");
    for connection in [&["--pty", text(&link)][..], &["--tcp", "127.0.0.1:0"], &["--pty", text(&link)]] {
        // A session replaces the link that an earlier one left behind.
        let server = Server::start(&[&[text(&scenario)], connection].concat());
        let port =
            if connection[0] == "--pty" { format!("pty:{}", text(&link)) } else { server.address.clone() };
        let arguments = ["send", text(&scenario), "--port", &port, "--slack", "500"];
        let sender = command(&arguments).spawn().expect("it starts");
        thread::sleep(Duration::from_millis(700));
        server.signal(Signal::KILL);
        let (code, out, err) = ended(sender.wait_with_output().expect("it ends"));
        assert_eq!(code, Some(4), "{connection:?} {out}{err}");
        assert!(out.contains("is the first that is not confirmed"), "{out}{err}");
        assert!(err.contains("the port was lost"), "{err}");
    }
    let _ = fs::remove_file(&link);
}

#[test]
fn reports_a_suspended_server_and_keeps_the_run_exact() {
    let scenario = file("still.json", FEW);
    let record = scenario.with_file_name("live-still-recording.json");
    let server = Server::start(&[text(&scenario), "--tcp", "127.0.0.1:0", "--record", text(&record)]);
    thread::sleep(Duration::from_millis(100));
    server.signal(Signal::STOP);
    thread::sleep(Duration::from_secs(2));
    server.signal(Signal::CONT);
    let (code, out, _) = send(&scenario, &server.address, &["--slack", "1000"]);
    assert_eq!(code, Some(0), "{out}");
    let (code, out, err) = server.end();
    assert_eq!(code, Some(3), "{out}{err}");
    assert!(out.contains("\nstretches ") && err.contains("recorded"), "{out}{err}");
    assert!(err.contains("not in real time"), "{err}");
    assert!(out.contains(&format!("digest {}\n", run_digest(&record))), "{out}");
}

#[test]
fn serves_one_client_and_refuses_a_second() {
    let scenario = file("one.json", FEW);
    let server = Server::start(&[text(&scenario), "--tcp", "127.0.0.1:0"]);
    let address = server.address.strip_prefix("tcp:").expect("an address");
    let first = TcpStream::connect(address).expect("the first");
    thread::sleep(Duration::from_millis(200));
    let mut message = String::new();
    TcpStream::connect(address).expect("a second").read_to_string(&mut message).expect("text");
    assert!(message.contains("another client is connected"), "{message}");
    drop(first);
    let (_, _, err) = server.end();
    assert!(err.contains("was refused"), "{err}");
}

#[test]
fn keeps_a_recording_that_cannot_be_renamed() {
    let scenario = file("kept.json", FEW);
    let record = scenario.with_file_name("live-kept-recording.json");
    let _ = fs::remove_dir(&record);
    let server = Server::start(&[text(&scenario), "--tcp", "127.0.0.1:0", "--record", text(&record)]);
    let (code, out, err) = send(&scenario, &server.address, &["--slack", "1000"]);
    assert_eq!(code, Some(0), "{out}{err}");
    fs::create_dir(&record).expect("the name is free");
    let (code, out, err) = server.end();
    let _ = fs::remove_dir(&record);
    assert_eq!(code, Some(1), "{out}{err}");
    let named =
        err.lines().position(|line| line.starts_with(text(&record))).expect("the name and the reason");
    let kept: Vec<&str> = err.lines().skip(named + 1).map(str::trim).collect();
    let [recorded, times] = kept[..] else { panic!("two files: {err}") };
    let digest = out.lines().find_map(|line| line.strip_prefix("digest ")).expect("a digest");
    assert_eq!(run_digest(Path::new(recorded)), digest);
    assert!(fs::read_to_string(times).expect("it is there").contains(digest));
    for path in [recorded, times] {
        fs::remove_file(path).expect("it is there");
    }
}

/// A device that executes everything at once, but does not know POSITIONS.
fn old_device(listener: &TcpListener) {
    let (mut stream, _) = listener.accept().expect("a host");
    let (mut deframer, mut buffer) = (Deframer::default(), [0; 256]);
    let (mut seq, mut ticks_done, mut state) = (0_u8, 0_u32, State::Ready);
    while let Ok(count @ 1..) = stream.read(&mut buffer) {
        for &byte in &buffer[..count] {
            let Some(Deframed::Frame(frame)) = deframer.byte(byte) else { continue };
            let kind = Kind::parse(frame.kind).expect("a kind");
            if let Some(ticks) = Ticks::parse(frame.body, 2).filter(|_| kind == Kind::Ticks) {
                (seq, ticks_done) = (seq.wrapping_add(1), ticks_done + ticks.count() as u32);
            }
            if kind == Kind::Stop {
                state = State::Stopped;
            }
            let answer = if kind == Kind::Positions { Err(Reason::UnknownKind) } else { Ok(kind) };
            let status = Status { state, free: 16, expected_seq: seq, faults: 0, ticks_done };
            let _ = stream.write_all(&(Reply { address: frame.address, result: answer, status }).emit(None));
        }
    }
}

#[test]
fn a_device_without_positions_is_not_reported_as_done() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = format!("tcp:{}", listener.local_addr().expect("an address"));
    let device = thread::spawn(move || old_device(&listener));
    let (code, out, err) = send(&file("old.json", FEW), &port, &[]);
    assert_eq!(code, Some(3), "{out}");
    assert!(out.contains("all ticks are counted, but the controller does not report positions"), "{out}");
    assert!(out.contains("ticks 4 of 4 done") && err.contains("does not report positions"), "{out}{err}");
    device.join().expect("it ends");
}

#[test]
fn gives_up_on_a_silent_or_invalid_device() {
    for nonsense in [&b""[..], b"hello\n", &[0; 40], &[0xff; 700]] {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = format!("tcp:{}", listener.local_addr().expect("an address"));
        let device = thread::spawn(move || {
            let (mut stream, _) = listener.accept().expect("a host");
            let mut buffer = [0; 256];
            while let Ok(1..) = stream.read(&mut buffer) {
                let _ = stream.write_all(nonsense);
            }
        });
        let (code, out, err) = send(&file("silent.json", FEW), &port, &["--slack", "5"]);
        assert_eq!(code, Some(3), "{out}{err}");
        assert!(out.contains("given up: no reply") && out.contains("the job never started"), "{out}");
        device.join().expect("it ends");
    }
}

/// Forwards bytes and cuts the connection after these numbers.
fn cut_after(server: &str, to_device: usize, to_host: usize) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = format!("tcp:{}", listener.local_addr().expect("an address"));
    let device = TcpStream::connect(server.strip_prefix("tcp:").expect("an address")).expect("it serves");
    thread::spawn(move || {
        let (host, _) = listener.accept().expect("a host");
        let pass = |mut from: TcpStream, mut to: TcpStream, max: usize| {
            move || {
                let mut byte = [0];
                for _ in 0..max {
                    if !matches!(from.read(&mut byte), Ok(1)) || to.write_all(&byte).is_err() {
                        break;
                    }
                }
                let _ = (from.shutdown(Shutdown::Both), to.shutdown(Shutdown::Both));
            }
        };
        let copy = |stream: &TcpStream| stream.try_clone().expect("a copy");
        let there = thread::spawn(pass(copy(&host), copy(&device), to_device));
        let back = thread::spawn(pass(device, host, to_host));
        let _ = (there.join(), back.join());
    });
    port
}

#[test]
fn a_cut_connection_reports_no_unconfirmed_ticks_as_done() {
    // The host sends 7 frames of 8 to 18 bytes and gets replies of 17 or 25. Unit tests of sessions cut at every
    // byte.
    let scenario = file("cut.json", FEW);
    let server = Server::start(&[text(&scenario), "--tcp", "127.0.0.1:0", "--pace", "max"]);
    for (to_device, to_host) in [
        (0, usize::MAX),
        (8, usize::MAX),
        (19, usize::MAX),
        (30, usize::MAX),
        (45, usize::MAX),
        (usize::MAX, 0),
        (usize::MAX, 17),
        (usize::MAX, 50),
        (usize::MAX, 80),
        (usize::MAX, 95),
    ] {
        let port = cut_after(&server.address, to_device, to_host);
        let (code, out, err) = send(&scenario, &port, &["--slack", "500"]);
        assert_eq!(code, Some(4), "{to_device} {to_host}: {out}{err}");
        assert!(!out.contains(": done"), "{to_device} {to_host}: {out}");
        // The server sees that the client has gone before the next one comes.
        thread::sleep(Duration::from_millis(100));
    }
    let (code, out, err) = send(&scenario, &server.address, &[]);
    assert_eq!(code, Some(0), "the next client is served: {out}{err}");
}

#[test]
fn rejects_invalid_sessions_before_sending() {
    let (framed, raw) = (file("refused.json", FEW), file("refused-raw.json", RAW));
    let segments = file("refused-segments.json", r#"{ "source": { "motion": { "engine": "segments" } } }"#);
    let script =
        file("refused-script.json", r#"{ "line": { "protocol": "framed" }, "source": { "line": {} } }"#);
    let (framed, raw) = (text(&framed), text(&raw));
    let link = file("refused-link", "not a link");
    let cases: [(&[&str], i32, &str); 12] = [
        (&["serve", framed], 2, "--pty"),
        (&["serve", framed, "--tcp", "0.0.0.0:0"], 2, "--allow-remote"),
        (&["serve", framed, "--tcp", "127.0.0.1:0", "--pace", "0"], 2, "0.001 to 100"),
        (&["serve", framed, "--port", "/dev/no-such-port"], 1, "No such file"),
        (&["serve", framed, "--pty", text(&link)], 1, "exists"),
        (&["serve", text(&segments), "--tcp", "127.0.0.1:0"], 2, "without a serial line"),
        (&["serve", framed, "--tcp", "127.0.0.1:0", "--record", framed], 2, "would be overwritten"),
        (&["send", framed, "--port", "/dev/null"], 1, "/dev/null"),
        // Refused before the port is opened, which would fail with 1.
        (&["send", text(&script), "--port", "/dev/no-such-port"], 2, "use a motion or packets"),
        (&["send", framed, "--port", "tcp:127.0.0.1:1"], 1, "refused"),
        (&["send", framed, "--port", "pty:/dev/null", "--rs485", "rts"], 2, "9600"),
        (&["send", raw, "--port", "tcp:127.0.0.1:1", "--lead", "100"], 2, "a queue of 100"),
    ];
    for (arguments, code, why) in cases {
        let (ended, out, err) = ended(command(arguments).output().expect("it runs"));
        assert!(ended == Some(code) && err.contains(why), "{arguments:?}: {ended:?} {out} {err}");
    }
}

/// Ready after 1 ms; moves 100 steps at 1000 Hz from its zero.
const PANEL: &str = r#"{ "source": { "standalone": [ { "debounce_cycles": 1000, "groups": [ { "move": { "length": 10, "speed_hz": 1000 } } ],
    "memory": { "byte_write_cycles": 10, "hold_up_cycles": 1000 }, "inputs": [ { "cycle": 400, "input": "estop" } ] } ] } }"#;

fn serve_lines(arguments: &[&str], lines: &str) -> (Option<i32>, String, String) {
    let mut child =
        command(&[&["serve"], arguments].concat()).stdin(Stdio::piped()).spawn().expect("it starts");
    child.stdin.take().expect("piped").write_all(lines.as_bytes()).expect("it reads");
    ended(child.wait_with_output().expect("it ends"))
}

#[test]
fn operates_buttons_by_lines_and_records_them() {
    let scenario = file("panel.json", PANEL);
    let record = scenario.with_file_name("live-panel-recording.json");
    let lines = "wait 5ms\npress start 20ms\ndance\npress start 20ms\nwait 200ms\nlimit_max 1\npress 7\nwait 1ms\nhelp\npress start 5ms\npower 0 1ms";
    for pace in ["max", "1"] {
        let more = ["--record", text(&record), "--once", "--pace", pace, "--lag", "5000"];
        let (code, out, err) = serve_lines(&[&[text(&scenario)], &more[..]].concat(), lines);
        assert_eq!(code, Some(0), "{pace}: {out}{err}");
        assert!(out.starts_with("stdin\n") && err.contains("recorded"), "{out}{err}");
        for expected in ["dance: unknown word or input", "7: unknown input", "release NAME", "limit_max"] {
            assert!(err.contains(expected), "{expected}: {err}");
        }
        assert!(out.contains("\npositions 100\n"), "{out}");
        // After the power cut it is READY with its zero from memory, so HELD.
        assert!(out.contains("panel 0 READY trust HELD position 100 "), "{out}");
        let line = |start: &str| out.lines().find(|line| line.starts_with(start)).expect(start).to_owned();
        assert_eq!(line("digest "), format!("digest {}", run_digest(&record)), "{pace}");
        let (_, replay, _) = ended(command(&["run", text(&record)]).output().expect("it runs"));
        assert!(replay.contains(&line("panels ")) && replay.contains(&line("panel 0 ")), "{replay}{out}");
        let recorded: Value =
            serde_json::from_str(&fs::read_to_string(&record).expect("it is there")).expect("JSON");
        let inputs = recorded["source"]["standalone"][0]["inputs"].as_array().expect("inputs");
        // The scenario's own presses are left out. The second press during the first only changes the release.
        assert_eq!(inputs.len(), 8, "{inputs:?}");
        let cycle = |index: usize| inputs[index]["cycle"].as_u64().expect("a cycle");
        assert_eq!(cycle(2) - cycle(1), 16 * 20_000, "20 ms");
    }
}

#[test]
fn reports_presses_without_effect_and_rejects_ports() {
    let scenario = file("panel-idle.json", PANEL);
    let lines = "wait 5ms\npress pause 20ms\nwait 50ms\nestop 1\nestop 0\n1: press start\n";
    let (code, _, err) = serve_lines(&[text(&scenario), "--once", "--pace", "max"], lines);
    assert_eq!(code, Some(0), "{err}");
    assert!(
        err.contains("pause has no effect in READY") && err.contains("there is no such controller"),
        "{err}"
    );
    let arguments = ["serve", text(&scenario), "--tcp", "127.0.0.1:0"];
    let (code, _, err) = ended(command(&arguments).output().expect("it runs"));
    assert!(code == Some(2) && err.contains("has no line") && err.contains("omit --pty"), "{err}");
}

fn reply(stream: &mut TcpStream) -> Vec<u8> {
    let mut reply = Vec::new();
    let mut byte = [1];
    stream.set_read_timeout(Some(Duration::from_secs(60))).expect("it can be");
    while byte != [0] {
        stream.read_exact(&mut byte).expect("a reply");
        reply.extend(byte);
    }
    reply
}

#[cfg(target_os = "linux")]
fn threads(child: &Child) -> String {
    let threads = fs::read_dir(format!("/proc/{}/task", child.id())).into_iter().flatten().flatten();
    // A thread may end meanwhile.
    threads.filter_map(|thread| fs::read_to_string(thread.path().join("comm")).ok()).collect()
}

#[cfg(target_os = "linux")]
fn memory(child: &Child) -> u64 {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).expect("it runs");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("a line");
    line.trim().trim_end_matches(" kB").parse().expect("a number")
}

#[test]
#[cfg(target_os = "linux")]
fn limits_buffered_input_and_serves_the_next_client() {
    let scenario = file("flood.json", FEW);
    for pace in ["0.001", "1", "max"] {
        let server =
            Server::start(&[text(&scenario), "--tcp", "127.0.0.1:0", "--pace", pace, "--lag", "60000"]);
        let address = server.address.strip_prefix("tcp:").expect("an address");
        let mut flood = TcpStream::connect(address).expect("it listens");
        // STATUS again and again causes replies, too.
        let status = emit(0, Kind::Status as u8, &[]);
        let chunk = status.repeat(1 << 13);
        flood.set_write_timeout(Some(Duration::from_millis(300))).expect("it can be");
        let (mut sent, mut refused) = (0, 0);
        // Without a pace the model takes as much as it can.
        let max = if pace == "max" { 6 << 20 } else { 50 << 20 };
        while sent < max && refused < 3 {
            match flood.write(&chunk) {
                Ok(count) => sent += count,
                Err(_) => refused += 1,
            }
        }
        assert!(pace == "max" || sent < max, "{pace}: the server reads all of it");
        assert!(memory(&server.child) < 60_000, "{pace}: {} KiB", memory(&server.child));
        drop(flood);
        if pace == "0.001" {
            // A byte takes 87 ms.
            server.signal(Signal::TERM);
            continue;
        }
        // The next client's first reply is to its own frame. A reply during the end of the flood is lost.
        let mut stream = None;
        for _ in 0..200 {
            let mut next = TcpStream::connect(address).expect("it listens");
            next.set_read_timeout(Some(Duration::from_secs(2))).expect("it can be");
            // The delimiter ends a frame that the previous client left incomplete.
            let sent = next.write_all(&[&[0], &emit(0, Kind::Positions as u8, &[])[..]].concat());
            let mut first = [0];
            if sent.is_ok() && matches!(next.peek(&mut first), Ok(1)) && first != *b"s" {
                stream = Some(next);
                break;
            }
        }
        let mut stream = stream.expect("the next client is served");
        let reply = reply(&mut stream);
        assert_eq!(reply.len(), 17 + 4 * 2, "{pace}: {reply:?}");
        drop(stream);
        let (_, out, err) = server.end();
        let dropped = err.contains("dropped ") && out.contains("bytes_dropped ");
        assert!(pace == "max" || dropped, "{pace}: {out}{err}");
    }
}

#[test]
fn a_half_closed_client_still_receives_replies() {
    let scenario = file("half.json", FEW);
    let mut server = Server::start(&[text(&scenario), "--tcp", "127.0.0.1:0", "--once", "--lag", "60000"]);
    let address = server.address.strip_prefix("tcp:").expect("an address");
    let mut stream = TcpStream::connect(address).expect("it listens");
    stream.write_all(&emit(0, Kind::Status as u8, &[]).repeat(3)).expect("it reads");
    stream.shutdown(Shutdown::Write).expect("it is open");
    let mut replies = Vec::new();
    stream.read_to_end(&mut replies).expect("replies");
    // Sent without a pause, the second one collides with the reply to the first.
    assert!(replies.len() >= 17 && replies.len() % 17 == 0, "{}", replies.len());
    let (code, out, err) = server.wait();
    assert_eq!(code, Some(0), "{out}{err}");
    assert!(out.contains("bytes_heard 24\n"), "{out}");
}

#[test]
#[cfg(target_os = "linux")]
fn keeps_links_of_running_sessions_and_replaces_stale_ones() {
    let scenario = file("link.json", FEW);
    let link = scenario.with_file_name("live-link-port");
    let _ = fs::remove_file(&link);
    // A client that came and went would end this session.
    let mut first = Server::start(&[text(&scenario), "--pty", text(&link), "--once"]);
    let target = fs::read_link(&link).expect("it is there");
    let (code, out, err) =
        ended(command(&["serve", text(&scenario), "--pty", text(&link)]).output().expect("it runs"));
    assert!(
        code == Some(1) && err.contains("a running session") && err.contains("end that session"),
        "{code:?} {out}{err}"
    );
    assert_eq!(fs::read_link(&link).expect("it is still there"), target);
    thread::sleep(Duration::from_millis(100));
    assert!(first.child.try_wait().expect("a child").is_none(), "the first session continues");
    first.signal(Signal::KILL);
    drop(first);
    assert!(link.is_symlink(), "a killed session leaves the link");
    let second = Server::start(&[text(&scenario), "--pty", text(&link)]);
    assert_eq!(second.address, format!("pty:{}", fs::read_link(&link).expect("it is there").display()));
    drop(second.end());
    assert!(!link.is_symlink());
}

#[test]
#[cfg(target_os = "linux")]
fn ctrl_c_ends_the_wait_for_a_connection() {
    // A queued connection of a listener with backlog 0 is neither accepted nor refused.
    let listener =
        rustix::net::socket(rustix::net::AddressFamily::INET, rustix::net::SocketType::STREAM, None)
            .expect("a socket");
    let any = std::net::SocketAddrV4::new(std::net::Ipv4Addr::LOCALHOST, 0);
    rustix::net::bind(&listener, &any).expect("a port");
    rustix::net::listen(&listener, 0).expect("it listens");
    let listener = TcpListener::from(listener);
    let address = listener.local_addr().expect("an address");
    let filling: Vec<TcpStream> =
        std::iter::repeat_with(|| TcpStream::connect_timeout(&address, Duration::from_millis(200)))
            .map_while(Result::ok)
            .take(64)
            .collect();
    let scenario = file("connect.json", FEW);
    for signal in [Signal::INT, Signal::TERM] {
        let mut sender = command(&["send", text(&scenario), "--port", &format!("tcp:{address}")])
            .spawn()
            .expect("it starts");
        // Connecting takes connection in a thread.
        while !threads(&sender).contains("connect\n") {
            assert!(sender.try_wait().expect("a child").is_none(), "it has ended");
            thread::sleep(Duration::from_millis(2));
        }
        signal_to(&sender, signal);
        let (code, out, err) = ended(sender.wait_with_output().expect("it ends"));
        assert_eq!(code, Some(130), "{out}{err}");
    }
    drop(filling);
}

#[test]
fn a_closed_standard_output_does_not_prevent_stop_or_recording() {
    // Forty seconds: the signal comes before the end.
    let scenario = file("closed.json", &LONG.replace("8000", "80000"));
    let record = scenario.with_file_name("live-closed-recording.json");
    let _ = fs::remove_file(&record);
    let mut server = Server::start(&[
        text(&scenario),
        "--tcp",
        "127.0.0.1:0",
        "--record",
        text(&record),
        "--lag",
        "60000",
        "--progress",
    ]);
    let mut sender = command(&["send", text(&scenario), "--port", &server.address, "--slack", "1000"])
        .spawn()
        .expect("it starts");
    drop(sender.stdout.take());
    let mut status = String::new();
    while !status.contains("positions ") || status.contains("positions 0") {
        status.clear();
        assert!(server.err.read_line(&mut status).expect("text") > 0, "the server has ended");
        assert!(sender.try_wait().expect("a child").is_none(), "the job has ended: {status}");
    }
    signal_to(&sender, Signal::INT);
    let output = sender.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(141), "{}", String::from_utf8_lossy(&output.stderr));
    // The server's last output has no reader either.
    server.out = BufReader::new(
        Command::new("true").stdout(Stdio::piped()).spawn().expect("it runs").stdout.take().expect("piped"),
    );
    let (code, _, err) = server.end();
    assert!(code == Some(141) && err.contains("recorded"), "{code:?} {err}");
    let state = ended(command(&["run", text(&record)]).output().expect("it runs")).1;
    assert!(state.contains("state STOPPED"), "{state}");
}

#[test]
fn rejects_an_endless_jog() {
    let held = r#"{ "cycle": 320000, "input": "jog_plus" }"#;
    let scenario = |name: &str, inputs: &str, more: &str| {
        let controller =
            r#""debounce_cycles": 1000, "memory": { "byte_write_cycles": 10, "hold_up_cycles": 1000 }"#;
        let axis = if more == "axis" { r#", "axis": { "max_switch_at_steps": 50 }"# } else { "" };
        let end = if more == "end" { r#", "run_cycles": 16000000"# } else { "" };
        file(
            name,
            &format!(
                r#"{{ "source": {{ "standalone": [ {{ {controller}{axis}, "inputs": [ {inputs} ] }} ] }}{end} }}"#
            ),
        )
    };
    let run = |path: &Path| ended(command(&["run", text(path)]).output().expect("it runs"));
    let endless = scenario("jog.json", held, "");
    let (code, out, err) = run(&endless);
    assert!(
        code == Some(2) && err.contains("run_cycles: ") && err.contains("jog button stays pressed"),
        "{code:?} {out}{err}"
    );
    let released = format!(r#"{held}, {{ "cycle": 3200000, "input": "jog_plus", "level": 0 }}"#);
    for path in [
        scenario("jog-end.json", held, "end"),
        scenario("jog-axis.json", held, "axis"),
        scenario("jog-off.json", &released, ""),
    ] {
        let (code, out, err) = run(&path);
        assert_eq!(code, Some(0), "{path:?}: {out}{err}");
    }
    let record = endless.with_file_name("live-jog-recording.json");
    let arguments = [text(&endless), "--once", "--pace", "max", "--record", text(&record)];
    let (code, out, err) = serve_lines(&arguments, "wait 20ms\npress jog_plus\nwait 100ms\n");
    assert!(
        code == Some(0) && err.contains("still pressed") && err.contains("recorded"),
        "{code:?} {out}{err}"
    );
}
