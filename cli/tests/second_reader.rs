//! A value change dump as GTKWave's own programs read it: `vcd2fst` makes its waveform file of it,
//! `fst2vcd` tells what stands in that, and it is the trace.
//!
//! `cargo xtask test --only vcd` runs it, and installs GTKWave first; without the feature `gtkwave` there is no such test.
#![allow(clippy::expect_used, clippy::panic, reason = "what is missing fails the test")]

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
use vcd::{Command as Entry, IdCode, Parser, ScopeItem, Value};

/// Two controllers and replies, at a clock of which no cycle is a whole number of picoseconds.
const FRAMED: &str = r#"{
    "clock_hz": 14745600, "bus": { "channels": 2 },
    "line": { "protocol": "framed", "noise": { "seed": 3, "lost_bytes_ppm": 20000, "glitches_ppm": 20000 } },
    "source": { "packets": { "packets": [ "8102", "8304", "0506", "8708" ] } } }"#;

/// The changes of each signal: time in ps, and the level from then on.
type Edges = BTreeMap<String, Vec<(u64, bool)>>;

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn call(program: &Path, arguments: &[&Path]) {
    let output = Command::new(program).args(arguments).output().expect("the program starts");
    assert!(output.status.success(), "{}: {output:?}", program.display());
}

/// The edges of a trace, at floor(cycle*10^12/clock_hz).
fn edges_of_trace(text: &str, clock_hz: u64, channels: u8) -> Edges {
    let records: Vec<Record> = text.lines().map(|line| parse_line(line).expect("a record")).collect();
    let stamp = |cycle: u64| (u128::from(cycle) * 1_000_000_000_000 / u128::from(clock_hz)) as u64;
    let signal = |bit: u32| {
        let mut edges: Vec<(u64, bool)> =
            records.iter().map(|record| (stamp(record.cycle.0), record.levels.has(1 << bit))).collect();
        edges.dedup_by_key(|edge| edge.1);
        (name(bit).expect("it has a name"), edges)
    };
    shown_signals(channels).map(signal).collect()
}

/// The edges that a value change dump tells of.
fn edges_of_dump(text: &[u8]) -> Edges {
    let mut parser = Parser::new(text);
    let header = parser.parse_header().expect("a header");
    assert_eq!(header.timescale, Some((1, vcd::TimescaleUnit::PS)));
    let scope = header.find_scope(&["stepscope"]).expect("the module");
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
            Entry::Timestamp(at) => now = at,
            // Before its first level a signal is unknown.
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

#[test]
fn a_second_program_reads_the_same_edges() {
    let [to_waves, from_waves] = ["vcd2fst", "fst2vcd"].map(|program| {
        which::which(program).unwrap_or_else(|_| {
            panic!("GTKWave's {program} is not on PATH; `cargo xtask test --only vcd` installs it")
        })
    });
    let preset = PRESETS.iter().find(|preset| preset.id == "patent-2019-four-motors").expect("it is there");
    for (title, json, clock_hz, channels) in
        [("preset", preset.json, preset.scenario().clock_hz, 4), ("framed", FRAMED, 14_745_600, 2)]
    {
        let file = |ending: &str| path(&format!("second-reader-{title}.{ending}"));
        let (scenario, trace, dump, waves, told) =
            (file("json"), file("trace"), file("vcd"), file("fst"), file("told.vcd"));
        fs::write(&scenario, json).expect("a file");
        let stepscope = Path::new(env!("CARGO_BIN_EXE_stepscope"));
        let options = ["run", "--trace", "--vcd"].map(Path::new);
        call(stepscope, &[options[0], &scenario, options[1], &trace, options[2], &dump]);
        call(&to_waves, &[&dump, &waves]);
        call(&from_waves, &[Path::new("-f"), &waves, Path::new("-o"), &told]);
        let expected =
            edges_of_trace(&fs::read_to_string(trace).expect("the trace"), clock_hz.into(), channels);
        let found = edges_of_dump(&fs::read(told).expect("what the program tells"));
        assert!(
            expected.values().map(Vec::len).sum::<usize>() > 100,
            "{title}: there is something to compare"
        );
        assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>(), "{title}");
        for (signal, edges) in &expected {
            assert_eq!(found[signal], *edges, "{title}: {signal}");
        }
    }
}
