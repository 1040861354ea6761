//! `cargo xtask bench --live` measures `stepscope serve`. A thread that only sleeps shows how much delay the machine
//! itself adds.
//!
//! - replies: delay after their cycle, one controller at 115200 baud (LIVE H2);
//! - load: processor time per session time, with 1, 4 and 32 active controllers;
//! - a day: 86400 s at full speed, 16 channels moving, and the server's memory.
#![cfg_attr(
    not(target_os = "linux"),
    allow(dead_code, unused_imports, reason = "processes are inspected in /proc")
)]
#![allow(clippy::expect_used, clippy::panic, reason = "a missing program ends the measurement")]

use std::{
    fmt::Write as _,
    fs,
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    path::{Path, PathBuf},
    process::{Child, ChildStdout, Command, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};
use stepscope_core::peripheral::protocol::Kind;
use stepscope_core::peripheral::wire::frame::{Ticks, emit};

const SECONDS: u32 = 20;
const BARS_MS: [f64; 9] = [0.1, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0];

#[cfg(not(target_os = "linux"))]
fn main() {
    println!("processes are inspected in /proc, which only Linux has");
}

#[cfg(target_os = "linux")]
fn main() {
    replies();
    load();
    day();
}

fn file(name: &str, text: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).expect("a file");
    path
}

fn text(path: &Path) -> &str {
    path.to_str().expect("text")
}

/// `controllers` on a line, each with a motor at 2000 steps/s; ticks of 100 slots of `slot` cycles, `ticks` per
/// frame.
fn scenario(controllers: usize, (baud, slot, ticks): (u32, u32, u32), seconds: u32) -> String {
    let axes = format!(
        r#"[ {{ "moves": [ {{ "constant": {{ "speed": {{ "steps_s": 2000 }}, "distance": {{ "steps": {} }} }} }} ] }} ]"#,
        2000 * seconds
    );
    // The queue covers a machine that stops for more than a second.
    let bus = format!(r#"{{ "step_period_cycles": {slot}, "queue_depth": 200, "self_test_cycles": 0 }}"#);
    let other = |address| format!(r#"{{ "address": {address}, "bus": {bus}, "axes": {axes} }}"#);
    let others: Vec<String> = (1..controllers).map(other).collect();
    let others = if others.is_empty() {
        String::new()
    } else {
        format!(r#""controllers": [ {} ],"#, others.join(", "))
    };
    format!(
        r#"{{ "bus": {bus}, {others}
            "line": {{ "protocol": "framed", "address": 0, "baud": {baud},
                "host": {{ "ticks_per_frame": {ticks}, "attempts": 40 }} }},
            "source": {{ "motion": {{ "axes": {axes} }} }} }}"#
    )
}

struct Server {
    child: Child,
    out: BufReader<ChildStdout>,
    address: String,
}

impl Server {
    fn start(scenario: &Path, more: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_stepscope"))
            .args(["serve", text(scenario), "--tcp", "127.0.0.1:0", "--lag", "60000"])
            .args(more)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("it starts");
        let mut out = BufReader::new(child.stdout.take().expect("piped"));
        let mut address = String::new();
        out.read_line(&mut address).expect("a line");
        Self { child, out, address: address.trim().to_owned() }
    }

    fn proc(&self, name: &str) -> String {
        fs::read_to_string(format!("/proc/{}/{name}", self.child.id())).expect("it runs")
    }

    /// Seconds on a processor, and seconds waiting for one.
    fn processor_s(&self) -> (f64, f64) {
        let schedstat = self.proc("schedstat");
        let mut ns = schedstat.split_whitespace().map(|word| word.parse::<f64>().expect("a number"));
        let mut next = || ns.next().expect("a number") / 1e9;
        (next(), next())
    }

    /// Current and maximum memory, in MB.
    fn memory_mb(&self) -> (f64, f64) {
        let status = self.proc("status");
        let of = |name: &str| {
            let line = status.lines().find_map(|line| line.strip_prefix(name)).expect("a row");
            line.split_whitespace().next().and_then(|kb| kb.parse::<f64>().ok()).expect("a number") / 1024.0
        };
        (of("VmRSS:"), of("VmHWM:"))
    }

    fn end(mut self) -> String {
        let mut kill = Command::new("kill");
        let ended = kill.args(["-TERM", &self.child.id().to_string()]).status();
        assert!(ended.is_ok_and(|status| status.success()), "kill fails");
        let mut output = String::new();
        self.out.read_to_string(&mut output).expect("text");
        let _ = self.child.wait();
        output
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Returns whether every tick is confirmed.
fn send(scenario: &Path, server: &Server) -> bool {
    let mut send = Command::new(env!("CARGO_BIN_EXE_stepscope"));
    send.args(["send", text(scenario), "--port", &server.address, "--slack", "5000"]);
    send.stdout(Stdio::null()).status().expect("it runs").success()
}

/// Measures how late a thread wakes from repeated sleeps of 5 ms.
struct Sleeper {
    until: Arc<AtomicBool>,
    thread: thread::JoinHandle<Vec<f64>>,
}

impl Sleeper {
    fn start() -> Self {
        let until = Arc::new(AtomicBool::new(false));
        let is_over = Arc::clone(&until);
        let thread = thread::spawn(move || {
            let (mut late, wait) = (Vec::new(), Duration::from_millis(5));
            while !is_over.load(Ordering::Relaxed) {
                let begun = Instant::now();
                thread::sleep(wait);
                late.push((begun.elapsed() - wait).as_secs_f64() * 1e3);
            }
            late
        });
        Self { until, thread }
    }

    fn end(self) -> String {
        self.until.store(true, Ordering::Relaxed);
        let late = self.thread.join().expect("it ends");
        let mut line = format!("{:8} late", late.len());
        let mut below = 0.0;
        for end in BARS_MS {
            let count = late.iter().filter(|&&ms| ms > below && ms <= end).count();
            if count > 0 {
                let _ = write!(line, " <={end}ms:{count}");
            }
            below = end;
        }
        line + &format!(" worst:{:.2}ms", late.iter().copied().fold(0.0, f64::max))
    }
}

fn replies() {
    println!("replies, {SECONDS} s, one controller at 115200 baud, and a thread that only sleeps");
    let scenario = file("live-replies.json", &scenario(1, (115_200, 320, 2), SECONDS));
    let (server, sleeper) = (Server::start(&scenario, &[]), Sleeper::start());
    let done = send(&scenario, &server);
    let (_, waited_s) = server.processor_s();
    let (slept, output) = (sleeper.end(), server.end());
    let late = output.lines().find(|line| line.starts_with("replies ")).unwrap_or("no replies");
    println!("  {late}\n  sleeper {slept}");
    println!("  the server waited for a processor for {:.1} ms in all; confirmed: {done}\n", 1e3 * waited_s);
}

fn load() {
    println!("load, {SECONDS} s: processor time in parts of the session's");
    for controllers in [1, 4, 32] {
        let name = format!("live-load-{controllers}.json");
        let scenario = file(&name, &scenario(controllers, (1_000_000, 1280, 32), SECONDS));
        let server = Server::start(&scenario, &[]);
        let idle = 5.0;
        thread::sleep(Duration::from_secs_f64(idle));
        let (idle_s, _) = server.processor_s();
        let begun = Instant::now();
        let done = send(&scenario, &server);
        let whole_s = begun.elapsed().as_secs_f64();
        let (busy_s, _) = server.processor_s();
        let (memory, _) = server.memory_mb();
        println!(
            "  {controllers:2} controllers: {:5.2} % idle, {:5.2} % moving, {memory:.1} MB; confirmed: {done}",
            100.0 * idle_s / idle,
            100.0 * (busy_s - idle_s) / whole_s
        );
        drop(server);
    }
    println!();
}

/// Ticks of 16 channels: 31 with a step each, alternating in direction, and one idle.
fn day() {
    const HOURS: u64 = 24;
    // 20 ms: M = 100 slots of 200 us. At 9600 baud a frame of 32 ticks takes nearly that long.
    const TICK_MS: u64 = 20;
    const TICKS: u64 = 32;
    let json = r#"{ "bus": { "channels": 16, "step_period_cycles": 3200, "queue_depth": 64, "self_test_cycles": 0 },
        "line": { "protocol": "framed", "address": 0, "baud": 9600 } }"#;
    println!("a day of session at full speed, 16 channels moving");
    let server = Server::start(&file("live-day.json", json), &["--pace", "max"]);
    let mut port = TcpStream::connect(server.address.trim_start_matches("tcp:")).expect("it listens");
    port.set_nodelay(true).expect("a socket");
    let commands: Vec<u8> =
        (0..16 * TICKS as usize).map(|index| (1 + index % 3) as u8 | (index as u8 & 1) << 7).collect();
    let mut request = |kind: Kind, body: &[u8]| {
        port.write_all(&emit(0, kind as u8, body)).expect("a server");
        let (mut reply, mut byte) = (Vec::new(), [1]);
        while byte[0] != 0 {
            port.read_exact(&mut byte).expect("a reply");
            reply.push(byte[0]);
        }
        reply
    };
    let begun = Instant::now();
    let frames = HOURS * 3_600_000 / (TICK_MS * TICKS);
    println!("  session  memory now   at most   bytes so far   time taken");
    let (mut reported, mut settled_mb) = (0, f64::MAX);
    for frame in 0..=frames {
        let hours = frame * TICK_MS * TICKS / 3_600_000;
        if frame == 0 || hours > reported && [1, 2, 3, 6, 12, 18, HOURS].contains(&hours) {
            reported = hours;
            let ((now, max), body) = (server.memory_mb(), 2 + commands.len() as u64);
            println!(
                "  {hours:5} h {now:9.1} MB {max:6.1} MB {:12.1} MB {:10.1} s",
                (frame * body) as f64 / 1e6,
                begun.elapsed().as_secs_f64()
            );
            // By now the recording is full, so nothing is added to it.
            if hours == 3 {
                settled_mb = now;
            }
            assert!(hours < 3 || now < 1.2 * settled_mb, "the server grows");
        }
        if frame < frames {
            let ticks = Ticks::emit(frame as u8, 16, &commands);
            // The queue holds two frames; a refused frame is repeated.
            while request(Kind::Ticks, &ticks).get(2) == Some(&0xff) {}
        }
    }
    println!(
        "{}",
        server
            .end()
            .lines()
            .filter(|line| line.starts_with("ticks_done"))
            .fold(String::new(), |all, line| all + "  " + line)
    );
}
