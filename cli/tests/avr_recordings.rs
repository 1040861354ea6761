//! Makes the recordings in `core/capture/recordings` again: builds `firmware/avr` with avr-gcc from exported tables,
//! runs it in simavr and compares edge by edge.
//!
//! `cargo xtask test --only avr` installs the tools and runs it. `STEPSCOPE_BLESS=1` writes the recordings; then
//! measure the numbers in their README again.
#![allow(clippy::expect_used, clippy::panic, reason = "a missing file or program fails the test")]

mod avr;

use avr::{call, compile, folder, in_the_repository};
use serde_json::Value as Json;
use std::{
    collections::BTreeMap,
    env,
    ffi::OsStr,
    fmt::Write,
    fs,
    path::{Path, PathBuf},
};
use vcd::{Command as Entry, IdCode, Parser, ScopeItem, TimescaleUnit, Value};

/// The compiler of the recordings; others differ by some cycles.
const COMPILER: &str = "5.4.0";

/// Tolerance for another compiler.
const OTHER_COMPILER_NS: u64 = 20_000;

/// A logic analyzer's session is sampled at 10 MHz: every 10th unit of simavr's 10 ns.
const SAMPLED: &str = "vcd:downsample=10";

fn recording(name: &str) -> PathBuf {
    in_the_repository("core/capture/recordings", name)
}

fn simulated(folder: &Path, program: &str) -> PathBuf {
    let elf = format!("{program}.elf");
    compile(folder, &elf, &[&format!("{program}.c"), &format!("{program}_pins.c")]);
    call(folder, "simavr", &[&elf]);
    folder.join(format!("{program}.vcd"))
}

type Edges = BTreeMap<String, Vec<(u64, bool)>>;

fn edges(dump: &Path) -> Edges {
    let text = fs::read(dump).unwrap_or_else(|error| panic!("{}: {error}", dump.display()));
    let mut parser = Parser::new(&text[..]);
    let header = parser.parse_header().expect("a header");
    let unit_ns = match header.timescale.expect("a timescale") {
        (count, TimescaleUnit::NS) => u64::from(count),
        (count, unit) => panic!("a timescale of {count} {unit}"),
    };
    let Some(ScopeItem::Scope(scope)) = header.items.iter().find(|item| matches!(item, ScopeItem::Scope(_)))
    else {
        panic!("no module");
    };
    let vars =
        scope.items.iter().filter_map(|item| if let ScopeItem::Var(var) = item { Some(var) } else { None });
    let names: BTreeMap<IdCode, &str> = vars.map(|var| (var.code, var.reference.as_str())).collect();
    let (mut now, mut edges) = (0, Edges::new());
    for entry in parser {
        match entry.expect("an entry") {
            Entry::Timestamp(at) => now = at * unit_ns,
            // The program has not set this pin yet.
            Entry::ChangeScalar(_, Value::X) => {}
            Entry::ChangeScalar(code, value) => {
                edges.entry(names[&code].to_owned()).or_default().push((now, value == Value::V1));
            }
            _ => {}
        }
    }
    edges
}

fn compare(found: &Edges, expected: &Edges, folder: &Path) {
    let compiler = call(folder, "avr-gcc", &["-dumpversion"]);
    if compiler.trim() == COMPILER {
        assert!(
            found == expected,
            "{} is not what is recorded: after a change, or with another simavr than 1.6, \
             STEPSCOPE_BLESS=1 writes the recording",
            folder.display()
        );
        return;
    }
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (signal, expected) in expected {
        assert_eq!(found[signal].len(), expected.len(), "edges of {signal}");
        for (found, expected) in found[signal].iter().zip(expected) {
            let near = found.0.abs_diff(expected.0) <= OTHER_COMPILER_NS;
            assert!(near && found.1 == expected.1, "{signal}: {found:?} and not {expected:?}");
        }
    }
}

fn bless(made: &Path, recording: &Path) {
    if env::var_os("STEPSCOPE_BLESS").is_some() {
        fs::copy(made, recording).expect("it is written");
    }
}

#[test]
#[ignore = "builds for an AVR and runs simavr: cargo xtask test --only avr"]
fn the_step_table_recording_matches_its_program() {
    let (folder, scenario) = (folder("step_table"), recording("step-table.json"));
    let export = "--format avr --with-walker --name plan --out plan.h";
    let options = export.split_whitespace().map(OsStr::new);
    let line: Vec<&OsStr> = [OsStr::new("tables"), scenario.as_os_str()].into_iter().chain(options).collect();
    call(&folder, "stepscope", &line);
    let dump = simulated(&folder, "step_table");
    let recording = recording("step-table.vcd");
    bless(&dump, &recording);
    compare(&edges(&dump), &edges(&recording), &folder);
}

/// Rules of MISRA C:2012 that `stepscope_walk.h` lists as deviations.
const DEVIATIONS: [&str; 4] =
    ["misra-c2012-2.5]", "misra-c2012-2.3]", "misra-c2012-8.9]", "misra-c2012-20.7]"];

#[test]
#[ignore = "builds for an AVR and calls cppcheck: cargo xtask test --only avr"]
fn exported_tables_compile_for_an_avr_and_pass_cppcheck() {
    let (folder, scenario) = (folder("tables"), recording("step-table.json"));
    for (entries, time) in [("ticks", "uint32_t"), ("q8", "uint32_t"), ("q16", "uint64_t")] {
        let export = format!("--entries {entries} --format avr --with-walker --name plan --out table.h");
        let options = export.split_whitespace().map(OsStr::new);
        let line = [OsStr::new("tables"), scenario.as_os_str()].into_iter().chain(options);
        call(&folder, "stepscope", &line.collect::<Vec<_>>());
        let program = format!(
            "#include \"table.h\"\nint main(void)\n{{\n    plan_walk walk;\n    {time} cycles;\n    plan_begin(&walk);\n    \
             while (plan_next(&walk, &cycles) != STEPSCOPE_END) {{}}\n    return (int)walk.right;\n}}\n"
        );
        fs::write(folder.join("walk.c"), program).expect("a file");
        let strict = "-mmcu=atmega328p -std=gnu99 -Os -Wall -Wextra -Wpedantic -Wconversion -Werror -c -o walk.o walk.c";
        call(&folder, "avr-gcc", &strict.split(' ').collect::<Vec<_>>());
        let check = "--enable=all --std=c99 --quiet --suppress=missingIncludeSystem -UPROGMEM walk.c";
        let clean = format!("--error-exitcode=1 {check}");
        assert_eq!(call(&folder, "cppcheck", &clean.split(' ').collect::<Vec<_>>()), "", "{entries}");
        let misra = format!("--addon=misra {check}");
        let found = call(&folder, "cppcheck", &misra.split(' ').collect::<Vec<_>>());
        assert!(found.contains(DEVIATIONS[0]), "the add-on has run: {found}");
        let ours =
            found.lines().filter(|line| line.starts_with("stepscope_walk.h") || line.starts_with("table.h"));
        for line in ours.filter(|line| line.contains("misra-")) {
            assert!(DEVIATIONS.iter().any(|rule| line.ends_with(rule)), "{entries}: {line}");
        }
    }
}

/// The packets and pace of the scenario's host, as `packets.h`.
fn packets_of(scenario: &str) -> String {
    let scenario: Json = serde_json::from_str(scenario).expect("a scenario");
    let number = |value: &Json| value.as_u64().expect("a whole number");
    let sends = scenario["source"]["line"]["sends"].as_array().expect("sends");
    let bytes: Vec<&str> = sends.iter().map(|send| send["bytes"].as_str().expect("bytes")).collect();
    let starts: Vec<u64> = sends.iter().map(|send| number(&send["start_cycle"])).collect();
    let tick = starts[1] - starts[0];
    assert!(starts.windows(2).all(|pair| pair[1] - pair[0] == tick), "one pace: {starts:?}");
    let (clock_hz, baud) = (number(&scenario["clock_hz"]), number(&scenario["line"]["baud"]));
    assert_eq!(clock_hz % baud, 0, "a bit is a whole number of cycles");
    let numbers = [
        ("PACKETS", bytes.len() as u64),
        ("PACKET_BYTES", bytes[0].len() as u64 / 2),
        ("TICK_CYCLES", tick),
        ("BIT_CYCLES", clock_hz / baud),
    ];
    let mut text = String::from("#include <stdint.h>\n#include <avr/pgmspace.h>\n\n");
    for (name, number) in numbers {
        writeln!(text, "#define {name} {number}").expect("room");
    }
    text.push_str("\nstatic const uint8_t packets[PACKETS][PACKET_BYTES] PROGMEM = {\n");
    for packet in bytes {
        let row = (0..packet.len()).step_by(2).map(|at| format!("0x{}", &packet[at..at + 2]));
        writeln!(text, "    {{ {} }},", row.collect::<Vec<_>>().join(", ")).expect("room");
    }
    text + "};\n"
}

#[test]
#[ignore = "builds for an AVR and runs simavr: cargo xtask test --only avr"]
fn the_late_packet_recording_matches_its_program() {
    let (folder, scenario) = (folder("packet_host"), recording("late-packet.json"));
    let script = "--line sent.json".split_whitespace().map(OsStr::new);
    let line: Vec<&OsStr> = [OsStr::new("run"), scenario.as_os_str()].into_iter().chain(script).collect();
    call(&folder, "stepscope", &line);
    let sent = fs::read_to_string(folder.join("sent.json")).expect("the sent bytes");
    fs::write(folder.join("packets.h"), packets_of(&sent)).expect("a file");
    let dump = simulated(&folder, "packet_host");
    let sigrok = |arguments: [&OsStr; 6]| call(&folder, "sigrok-cli", &arguments);
    let [input, i, output, o] = ["-I", "-i", "-O", "-o"].map(OsStr::new);
    let session = folder.join("late-packet.sr");
    call(&folder, "sigrok-cli", &[input, OsStr::new(SAMPLED), i, dump.as_os_str(), o, session.as_os_str()]);
    let recording = recording("late-packet.sr");
    bless(&session, &recording);
    let edges_of = |session: &Path, name: &str| {
        let dump = folder.join(name);
        sigrok([i, session.as_os_str(), output, OsStr::new("vcd"), o, dump.as_os_str()]);
        edges(&dump)
    };
    compare(&edges_of(&session, "made.vcd"), &edges_of(&recording, "recorded.vcd"), &folder);
}
