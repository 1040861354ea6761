//! Step tables as source code: compiled and run, they give the steps of the table (DESIGN Part D).
//!
//! The C compiler is `cc`, or the value of `STEPSCOPE_CC`; on most systems Rust's linker is a C compiler, too.

use crate::moves::{CLOCK_HZ, plan};
use std::{env, fmt::Write, fs, path::PathBuf, process::Command};
use stepscope_core::{
    inspect::export::source_code::{
        Language, NamedTable, Origin, Request, Source, WALKER, WALKER_FILE, read_c,
    },
    motion::{
        ScheduledStep,
        mechanics::{Distance, Speed},
        moves::{Constant, Cosine, Dwell, Move, SineSegments},
        step_tables::{EntryFormat, Form, Stored, Tolerance, stored},
    },
    peripheral::{
        segment::{FRACTION_BITS, PulseTimes, Segment},
        units::Cycles,
    },
    scenario::Scenario,
};

/// Walks a table as firmware does, prints cycle and direction of each step, and checks the macros of the table.
const WALK_C: &str = r#"#include "table.h"
#include "table.h"
#include <stdio.h>
int main(void) {
    static axis_0_walk walk;
    TIME cycles;
    unsigned long long time = 0, steps = 0, min = ~0ULL, max = 0;
    uint8_t event;
    int has_turned = 0;
    axis_0_begin(&walk);
    while ((event = axis_0_next(&walk, &cycles)) != STEPSCOPE_END) {
        time += cycles;
        /* A step has a time, and so has the event after a change of direction. */
        if (cycles == 0 && (event == STEPSCOPE_STEP || has_turned)) {
            return 3;
        }
        has_turned = cycles == 0;
        if ((event == STEPSCOPE_STEP || cycles != 0) && cycles < min) {
            min = cycles;
        }
        if (cycles > max) {
            max = cycles;
        }
        if (event == STEPSCOPE_STEP) {
            steps++;
            printf("%llu %d\n", time, walk.right);
        }
    }
    /* The end repeats. */
    if (axis_0_next(&walk, &cycles) != STEPSCOPE_END || cycles != 0) {
        return 1;
    }
    if (steps != AXIS_0_STEPS || min != AXIS_0_MIN_CYCLES || max != AXIS_0_MAX_CYCLES) {
        return 2;
    }
    fprintf(stderr, "%u\n", (unsigned)(AXIS_0_ENTRIES * sizeof axis_0_entries[0]));
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

/// Replaces avr-libc's header: program memory is normal memory.
const PGMSPACE: &str = r#"#include <string.h>
#define PROGMEM __attribute__((aligned(8)))
static inline uint16_t pgm_read_word(const void *at) { uint16_t n; memcpy(&n, at, sizeof n); return n; }
static inline uint32_t pgm_read_dword(const void *at) { uint32_t n; memcpy(&n, at, sizeof n); return n; }
"#;

/// A motion with reversals, pauses and curves.
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

/// The steps of the segment engine: next >> 16 after each interval (A8), from the start of the list.
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
    let request = Request {
        scenario: Some(b"test.json"),
        steps: None,
        axis: None,
        form: "exact",
        error_us: 0.0,
        interval_part: None,
        is_early: false,
        is_quick: false,
        entries: table.format.name,
        language: language.name(),
        name: "axis_0",
    };
    let origin = Origin::new(&request, &Scenario::default(), None);
    let tables = [NamedTable { name: "axis_0".into(), table }];
    let source = Source { name: "axis_0", tables: &tables, clock_hz: CLOCK_HZ, origin: &origin };
    source.write(language, &mut text).unwrap();
    text
}

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("source_code").join(name);
    fs::create_dir_all(folder.join("avr")).unwrap();
    folder
}

/// Compiles, runs and compares; returns the size that the program prints.
fn compare(name: &str, mut compiler: Command, program: &PathBuf, table: &Stored) -> String {
    let output = compiler.output().unwrap_or_else(|error| panic!("{compiler:?}: {error}"));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.is_empty(), "{name}: {said}");
    let run = Command::new(program).output().expect("what was compiled starts");
    assert!(run.status.success(), "{name}: {run:?}");
    assert!(String::from_utf8(run.stdout).unwrap() == expected(table), "{name}: other steps");
    String::from_utf8(run.stderr).unwrap()
}

const STRICT: [&str; 5] = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];

#[test]
fn a_table_compiled_as_c_and_for_avr_has_its_steps() {
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
            let is_avr = language == Language::Avr;
            let text = source(&table, language);
            assert_eq!(text.contains("PROGMEM"), is_avr);
            fs::write(folder.join("avr").join("pgmspace.h"), PGMSPACE).unwrap();
            fs::write(folder.join(WALKER_FILE), WALKER).unwrap();
            fs::write(folder.join("table.h"), text).unwrap();
            let (file, program) = (folder.join("walk.c"), folder.join("walk"));
            fs::write(&file, WALK_C).unwrap();
            let time = if table.format == EntryFormat::Q16 { "-DTIME=uint64_t" } else { "-DTIME=uint32_t" };
            let mut call = Command::new(&compiler);
            call.args(["-std=c11", time]).args(STRICT);
            // The walker of program memory, with the reads above.
            call.args(is_avr.then_some("-D__AVR__"))
                .arg("-I")
                .arg(&folder)
                .arg(&file)
                .arg("-o")
                .arg(&program);
            let bytes = compare(&name, call, &program, &table);
            // 64-bit numbers are aligned here.
            let entry = if table.format == EntryFormat::Q16 { 24 } else { 8 };
            assert_eq!(bytes.trim(), (entry * table.entries.len()).to_string(), "{name}");
        }
    }
}

#[test]
fn the_walker_is_c99_and_cpp11() {
    let folder = folder("walker");
    fs::write(folder.join(WALKER_FILE), WALKER).unwrap();
    fs::write(folder.join("table.h"), source(&tables()[0].1, Language::Avr)).unwrap();
    fs::write(folder.join("walk.c"), WALK_C).unwrap();
    for (compiler, language, standard) in [("cc", "c", "c99"), ("cc", "c", "c11"), ("c++", "c++", "c++11")] {
        let mut call = Command::new(compiler);
        call.args(["-DTIME=uint64_t", "-fsyntax-only", "-x", language])
            .arg(format!("-std={standard}"))
            .args(STRICT);
        // Without __AVR__, a table for an AVR compiles for this machine.
        let output = call.arg("-I").arg(&folder).arg(folder.join("walk.c")).output();
        let output = output.unwrap_or_else(|error| panic!("{compiler}: {error}; install gcc and g++"));
        assert!(output.status.success(), "{standard}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn a_table_read_back_matches_the_plan() {
    for (name, table) in tables() {
        let due = || {
            let mut steps = Vec::new();
            for line in expected(&table).lines() {
                let (cycle, right) = line.split_once(' ').unwrap();
                steps.push(ScheduledStep { cycle: cycle.parse().unwrap(), right: right == "1" });
            }
            steps
        };
        for language in [Language::C, Language::Avr] {
            let [mut found]: [_; 1] = read_c(&source(&table, language)).unwrap().try_into().unwrap();
            assert_eq!(found.entries, table.entries, "{name}");
            // The steps of the list itself, without an error.
            assert_eq!(found.check(due(), CLOCK_HZ), Ok(0), "{name}");
            let last = found.entries.last_mut().unwrap();
            last.interval += 1 << (table.format.fraction_bits() + 20);
            let refused = found.check(due(), CLOCK_HZ).unwrap_err();
            assert!(refused.starts_with("step "), "{name}: {refused}");
        }
    }
}

#[test]
fn a_table_compiled_as_rust_has_its_steps() {
    let rustc = env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    for (name, table) in tables() {
        let folder = folder(&format!("{name}_rust"));
        let (file, program) = (folder.join("table.rs"), folder.join("table"));
        fs::write(&file, source(&table, Language::Rust) + WALK_RUST).unwrap();
        let mut call = Command::new(&rustc);
        // Constants that the walker does not use are no error of the table.
        call.args(["--edition", "2024", "-D", "warnings", "-A", "dead_code"])
            .arg(&file)
            .arg("-o")
            .arg(&program);
        compare(&name, call, &program, &table);
    }
}

#[test]
fn a_csv_table_has_one_row_per_entry_and_a_header() {
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
    let steps = format!("{} steps in {} entries of 8 bytes, ", table.error.steps, table.entries.len());
    let error = format!("largest timing error {} cycles (", table.error.max_cycles);
    for part in [
        steps.as_str(),
        error.as_str(),
        "Clock: 16000000 Hz",
        "1/256 cycle",
        " % of the shortest step interval",
    ] {
        assert!(head.contains(part), "{part}: {}", &head[..900]);
    }
}
