//! Reads value change dumps with GTKWave's (`vcd2fst`, `fst2vcd`) and sigrok's programs and compares every edge with
//! the trace.
//!
//! `cargo xtask test --only vcd` installs the tools and runs it.
#![allow(clippy::expect_used, clippy::panic, reason = "a missing file or program fails the test")]

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::Command,
};
use stepscope_core::{
    peripheral::{
        signal::{Record, name},
        trace::{parse_line, shown_signals},
    },
    scenario::presets::PRESETS,
};
use vcd::{Command as Entry, IdCode, Parser, ScopeItem, TimescaleUnit, Value};

/// Two controllers and replies; no cycle is a whole number of nanoseconds.
const FRAMED: &str = r#"{
    "clock_hz": 14745600, "bus": { "channels": 2 },
    "line": { "protocol": "framed", "noise": { "seed": 3, "lost_bytes_ppm": 20000, "glitches_ppm": 20000 } },
    "source": { "packets": { "packets": [ "8102", "8304", "0506", "8708" ] } } }"#;

/// Cycle and new level, per signal.
type Edges = BTreeMap<String, Vec<(u64, bool)>>;

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn program(name: &str) -> PathBuf {
    which::which(name)
        .unwrap_or_else(|_| panic!("{name} is not on PATH; `cargo xtask test --only vcd` installs it"))
}

fn call(program: &Path, arguments: &[&Path]) {
    let output = Command::new(program).args(arguments).output().expect("the program starts");
    assert!(output.status.success(), "{}: {output:?}", program.display());
}

fn run(title: &str, json: &str, more: &[&str]) -> (String, PathBuf) {
    let file = |ending: &str| path(&format!("second-reader-{title}.{ending}"));
    let (scenario, trace, dump) = (file("json"), file("trace"), file("vcd"));
    fs::write(&scenario, json).expect("a file");
    let more: Vec<&Path> = more.iter().map(Path::new).collect();
    let options = [Path::new("run"), &scenario, Path::new("--trace"), &trace, Path::new("--vcd"), &dump];
    call(Path::new(env!("CARGO_BIN_EXE_stepscope")), &[&options[..], &more].concat());
    (fs::read_to_string(trace).expect("the trace"), dump)
}

fn edges_of_trace(text: &str, channels: u8) -> Edges {
    let records: Vec<Record> = text.lines().map(|line| parse_line(line).expect("a record")).collect();
    let signal = |bit: u32| {
        let mut edges: Vec<(u64, bool)> =
            records.iter().map(|record| (record.cycle.0, record.levels.has(1 << bit))).collect();
        edges.dedup_by_key(|edge| edge.1);
        (name(bit).expect("it has a name"), edges)
    };
    shown_signals(channels).map(signal).collect()
}

/// Edges at round(t*clock_hz).
fn edges_of_dump(text: &[u8], scope: &str, clock_hz: u64) -> Edges {
    // sigrok-cli prints lines of its own first.
    let start = text.iter().position(|byte| *byte == b'$').unwrap_or(0);
    let mut parser = Parser::new(&text[start..]);
    let header = parser.parse_header().expect("a header");
    let (count, unit) = header.timescale.expect("a timescale");
    let a_second: u128 = match unit {
        TimescaleUnit::NS => 1_000_000_000,
        TimescaleUnit::PS => 1_000_000_000_000,
        other => panic!("a timescale in {other}"),
    };
    let cycle = |stamp: u64| {
        let twice = u128::from(stamp) * u128::from(count) * u128::from(clock_hz) * 2;
        ((twice + a_second) / (2 * a_second)) as u64
    };
    let scope = header.find_scope(&[scope]).expect("the module");
    let names: BTreeMap<IdCode, String> = scope
        .items
        .iter()
        .filter_map(|item| match item {
            ScopeItem::Var(var) => Some((var.code, var.reference.clone())),
            _ => None,
        })
        .collect();
    let (mut now, mut edges) = (0, Edges::new());
    for entry in parser {
        match entry.expect("an entry") {
            Entry::Timestamp(at) => now = cycle(at),
            // A signal is unknown before its first level.
            Entry::ChangeScalar(_, Value::X) => {}
            Entry::ChangeScalar(code, value) => {
                edges.entry(names[&code].clone()).or_default().push((now, value == Value::V1));
            }
            _ => {}
        }
    }
    edges.values_mut().for_each(|edges| edges.dedup_by_key(|edge| edge.1));
    edges
}

fn compare(found: &Edges, trace: &str, channels: u8, title: &str) {
    let expected = edges_of_trace(trace, channels);
    assert!(expected.values().map(Vec::len).sum::<usize>() > 100, "{title}: there is something to compare");
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>(), "{title}");
    for (signal, edges) in &expected {
        assert_eq!(found[signal], *edges, "{title}: {signal}");
    }
}

/// Title, scenario, clock, channels, dump options.
fn cases() -> [(&'static str, &'static str, u64, u8, &'static [&'static str]); 4] {
    let preset = PRESETS.iter().find(|preset| preset.id == "patent-2019-four-motors").expect("it is there");
    let clock_hz = preset.scenario().clock_hz.into();
    [
        ("preset", preset.json, clock_hz, 4, &[]),
        ("preset-10ns", preset.json, clock_hz, 4, &["--vcd-timescale", "10ns"]),
        ("framed", FRAMED, 14_745_600, 2, &[]),
        ("framed-1ps", FRAMED, 14_745_600, 2, &["--vcd-timescale", "1ps"]),
    ]
}

#[test]
#[ignore = "needs programs of GTKWave and sigrok: cargo xtask test --only vcd"]
fn gtkwave_reads_the_same_edges() {
    let [to_waves, from_waves] = ["vcd2fst", "fst2vcd"].map(program);
    for (title, json, clock_hz, channels, options) in cases() {
        let (trace, dump) = run(title, json, options);
        let (waves, copy) = (dump.with_extension("fst"), dump.with_extension("copy.vcd"));
        call(&to_waves, &[&dump, &waves]);
        call(&from_waves, &[Path::new("-f"), &waves, Path::new("-o"), &copy]);
        let found = edges_of_dump(&fs::read(copy).expect("its output"), "stepscope", clock_hz);
        compare(&found, &trace, channels, title);
    }
}

#[test]
#[ignore = "needs programs of GTKWave and sigrok: cargo xtask test --only vcd"]
fn sigrok_reads_the_same_edges() {
    let sigrok = program("sigrok-cli");
    // sigrok would take samples of 1 ps, which is far too slow.
    for (title, json, clock_hz, channels, options) in
        cases().into_iter().filter(|case| case.0 != "framed-1ps")
    {
        let title = format!("sigrok-{title}");
        let (trace, dump) = run(&title, json, options);
        let copy = dump.with_extension("copy.vcd");
        let arguments = ["-I", "vcd", "-i"].map(Path::new);
        let output = ["-O", "vcd", "-o"].map(Path::new);
        call(&sigrok, &[&arguments[..], &[&dump], &output, &[&copy]].concat());
        let found = edges_of_dump(&fs::read(copy).expect("its output"), "libsigrok", clock_hz);
        compare(&found, &trace, channels, &title);
    }
}

/// sigrok takes a sample per timescale unit, so a fine timescale makes a short move very long.
#[test]
#[ignore = "needs programs of GTKWave and sigrok: cargo xtask test --only vcd"]
fn sigrok_opens_a_dump_with_few_samples() {
    let sigrok = program("sigrok-cli");
    let (_, dump) = run("sigrok-move", "{}", &[]);
    let text = fs::read_to_string(&dump).expect("the dump");
    let scale = text.split_once("$timescale").and_then(|(_, rest)| rest.split_once("$end"));
    assert_eq!(scale.map(|(scale, _)| scale.trim()), Some("1 ns"), "the default");
    let nothing = ["-O", "null"].map(Path::new);
    call(&sigrok, &[&["-I", "vcd", "-i"].map(Path::new)[..], &[&dump], &nothing].concat());
}
