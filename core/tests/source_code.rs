//! Step tables as source code: compiled and run they give the steps that the table has (DESIGN Part D).
//!
//! A C compiler is looked for as `cc`, or as `STEPSCOPE_CC` names it; Rust's own linker is one on most systems.

use crate::moves::{CLOCK_HZ, plan};
use std::{env, fmt::Write, fs, path::PathBuf, process::Command};
use stepscope_core::{
    inspect::export::source_code::{Language, Source},
    motion::{
        mechanics::{Distance, Speed},
        moves::{Constant, Cosine, Dwell, Move, SineSegments},
        step_tables::{EntryFormat, Form, Stored, Tolerance, stored},
    },
    peripheral::{
        segment::{FRACTION_BITS, PulseTimes, Segment},
        units::Cycles,
    },
};

/// Walks a table as its comment says, and prints the cycle and the way of each step.
const WALK_C: &str = r#"
#include <stdio.h>
int main(void) {
    uint64_t time = 0;
    int right = 0;
    for (unsigned long i = 0; i < AXIS_0_ENTRIES; i++) {
        uint64_t interval = READ_INTERVAL(&axis_0_interval[i]);
        uint32_t count = READ_COUNT(&axis_0_count[i]);
        int64_t add = READ_ADD(&axis_0_add[i]);
        if (count == 0) {
            time += interval;
            right = (int)add;
        }
        for (; count > 0; count--) {
            time += interval;
            interval += (uint64_t)add;
            printf("%llu %d\n", (unsigned long long)(time >> AXIS_0_FRACTION_BITS), right);
        }
    }
    fprintf(stderr, "%u\n", (unsigned)(AXIS_0_ENTRIES * (sizeof axis_0_interval[0] + sizeof axis_0_count[0] + sizeof axis_0_add[0])));
    return 0;
}
"#;

const WALK_RUST: &str = r#"
fn main() {
    let (mut time, mut right) = (0_u64, false);
    for ((&interval, &count), &add) in AXIS_0_INTERVAL.iter().zip(&AXIS_0_COUNT).zip(&AXIS_0_ADD) {
        let mut interval = u64::from(interval);
        if count == 0 {
            time += interval;
            right = add == 1;
        }
        for _ in 0..count {
            time += interval;
            interval = interval.wrapping_add_signed(add.into());
            println!("{} {}", time >> AXIS_0_FRACTION_BITS, u8::from(right));
        }
    }
}
"#;

/// What stands for avr-libc's header on this machine: program memory is memory.
const PGMSPACE: &str = "#define PROGMEM __attribute__((aligned(8)))\n";

/// A motion with turns, rests and curves.
fn table(form: Form, format: EntryFormat) -> Stored {
    let sine = SineSegments { amplitude: Distance::Steps(200.0), period_s: 0.2, ..SineSegments::default() };
    let moves = vec![
        Move::Cosine(Cosine {
            distance: Distance::Steps(-900.0),
            duration_s: 0.5,
            ramp_s: 0.2,
            ..Cosine::default()
        }),
        Move::Dwell(Dwell { duration_s: 400.0 }),
        Move::SineSegments(sine),
        Move::Constant(Constant {
            distance: Distance::Steps(70_000.0),
            speed: Speed::StepsPerSecond(100_000.0),
        }),
    ];
    let moves = if form == Form::Document { moves.into_iter().skip(1).collect() } else { moves };
    let pulse = PulseTimes { width: Cycles(20), setup: Cycles(5), hold: Cycles(0) };
    stored(&plan(moves), form, format, pulse, CLOCK_HZ).unwrap_or_else(|cause| panic!("{cause}"))
}

fn tables() -> Vec<(String, Stored)> {
    let compressed = Form::Compressed(Tolerance::of(Cycles(400)));
    let mut tables = Vec::new();
    for format in EntryFormat::ALL {
        for (name, form) in [("exact", Form::Exact), ("document", Form::Document), ("compressed", compressed)]
        {
            tables.push((format!("{name}_{}", format.name), table(form, format)));
        }
    }
    tables
}

/// The steps as the segment engine has them: next >> 16 after each interval (A8), from the list's start.
fn expected(table: &Stored) -> String {
    let (mut next, mut lines) = (0_u64, String::new());
    for segment in &table.list.segments {
        match *segment {
            Segment::Dwell(dwell) => next += dwell,
            Segment::Steps { count, mut interval, add, right } => {
                for _ in 0..count {
                    next += interval;
                    interval = interval.wrapping_add_signed(add);
                    writeln!(lines, "{} {}", next >> FRACTION_BITS, u8::from(right)).unwrap();
                }
            }
        }
    }
    lines
}

fn source(table: &Stored, language: Language) -> String {
    let mut text = String::new();
    let source = Source { name: "axis_0", title: "X of a test */", clock_hz: CLOCK_HZ, table };
    source.write(language, &mut text).unwrap();
    text
}

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("source_code").join(name);
    fs::create_dir_all(folder.join("avr")).unwrap();
    folder
}

/// Compiles, runs, and compares; gives what the program says of its size.
fn compare(name: &str, mut compiler: Command, program: &PathBuf, table: &Stored) -> String {
    let output = compiler.output().unwrap_or_else(|error| panic!("{compiler:?}: {error}"));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.is_empty(), "{name}: {said}");
    let run = Command::new(program).output().expect("what was compiled starts");
    assert!(run.status.success(), "{name}: {run:?}");
    assert!(String::from_utf8(run.stdout).unwrap() == expected(table), "{name}: other steps");
    String::from_utf8(run.stderr).unwrap()
}

#[test]
fn compiled_as_c_and_for_avr_a_table_gives_its_steps() {
    let compiler = env::var("STEPSCOPE_CC").unwrap_or_else(|_| "cc".to_owned());
    assert!(
        Command::new(&compiler).arg("--version").output().is_ok(),
        "{compiler} does not start: install a C compiler (Debian: `apt-get install gcc` as root) so that `cc` is on PATH, \
         or name one in STEPSCOPE_CC"
    );
    for (name, table) in tables() {
        for (kind, language) in [("c", Language::C), ("avr", Language::Avr)] {
            let name = format!("{name}_{kind}");
            let folder = folder(&name);
            let read = if language == Language::Avr { "pgm_read_any" } else { "*" };
            let mut text = source(&table, language);
            assert_eq!(text.contains("PROGMEM"), language == Language::Avr);
            for what in ["INTERVAL", "COUNT", "ADD"] {
                writeln!(text, "#define READ_{what}(at) {read}(at)").unwrap();
            }
            text.push_str(WALK_C);
            let header = format!("{PGMSPACE}#define pgm_read_any(at) (*(at))\n");
            fs::write(folder.join("avr").join("pgmspace.h"), header).unwrap();
            let (file, program) = (folder.join("table.c"), folder.join("table"));
            fs::write(&file, text).unwrap();
            let mut call = Command::new(&compiler);
            call.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-I"]).arg(&folder);
            call.arg(&file).arg("-o").arg(&program);
            let bytes = compare(&name, call, &program, &table);
            assert_eq!(bytes.trim(), table.bytes().to_string(), "{name}");
        }
    }
}

#[test]
fn compiled_as_rust_a_table_gives_its_steps() {
    let rustc = env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    for (name, table) in tables() {
        let folder = folder(&format!("{name}_rust"));
        let (file, program) = (folder.join("table.rs"), folder.join("table"));
        fs::write(&file, source(&table, Language::Rust) + WALK_RUST).unwrap();
        let mut call = Command::new(&rustc);
        // The constants that the walk does not need are no fault of the table.
        call.args(["--edition", "2024", "-D", "warnings", "-A", "dead_code"])
            .arg(&file)
            .arg("-o")
            .arg(&program);
        compare(&name, call, &program, &table);
    }
}

#[test]
fn a_csv_table_has_a_row_for_each_entry_and_a_head_says_what_it_is() {
    let table = table(Form::Compressed(Tolerance::of(Cycles(400))), EntryFormat::Q8);
    let csv = source(&table, Language::Csv);
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("interval_q8,count,add_q8"));
    let rows: Vec<String> = table
        .entries
        .iter()
        .map(|entry| format!("{},{},{}", entry.interval, entry.count, entry.add))
        .collect();
    assert!(lines.eq(rows.iter().map(String::as_str)));
    let head = source(&table, Language::Rust);
    let steps = format!("{} steps in {} entries of 8 bytes (q8)", table.error.steps, table.entries.len());
    let error = format!("Largest timing error {} cycles", table.error.max_cycles);
    for part in [steps.as_str(), error.as_str(), "Clock: 16000000 Hz", "1/256 cycle"] {
        assert!(head.contains(part), "{part}: {}", &head[..900]);
    }
}
