//! `stepscope tables` and `stepscope sine` in scripts.

use crate::program::stepscope;

const MOTION: &str = r#"{ "title": "A table", "bus": { "channels": 2 }, "source": { "motion": { "axes": [
    { "moves": [ { "trapezoid": { "distance": { "steps": 20000 }, "start_speed": { "steps_s": 250 },
        "top_speed": { "steps_s": 5000 }, "acceleration": { "steps_s2": 9000 }, "method": "table" } } ] },
    { "moves": [ { "cosine": { "distance": { "steps": -6400 }, "duration_s": 2, "ramp_s": 0.5 } } ] } ] } } }"#;

#[test]
fn a_summary_has_a_row_per_axis_form_and_format() {
    let (code, out, err) = stepscope(&["tables", "-"], MOTION);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let rows: Vec<Vec<&str>> = out.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(rows.len(), 1 + 2 * 3 * 3);
    // Steps, and the largest error in us.
    let of = |row: usize| (rows[row][6], rows[row][7]);
    assert_eq!((&rows[1][..3], of(1)), (["0", "exact", "q16"].as_slice(), ("20000", "0.000")));
    // The timer's ticks are whole cycles of the clock.
    assert_eq!((&rows[6][..3], of(6)), (["0", "document", "ticks"].as_slice(), ("20000", "0.000")));
    assert!(out.contains("1 document   q16      this kind of move has no table"), "{out}");
    let count = |row: usize| rows[row][3].parse::<u32>().expect("a count");
    assert!(count(7) < 60 && rows[7][..3] == ["0", "compressed", "q16"], "{out}");
    let tight =
        stepscope(&["tables", "-", "--form", "compressed", "--error-us", "0.1", "--entries", "q8"], MOTION);
    assert_eq!(tight.1.lines().count(), 3);
    assert!(tight.1.lines().nth(2).is_some_and(|line| line.contains(" 0.063 ")), "{}", tight.1);
}

/// Klipper's own program makes 52 entries of the default motion.
#[test]
fn supports_klippers_window_and_entries() {
    let options = ["tables", "-", "--form", "compressed", "--entries", "klipper", "--interval-part", "2"];
    let row = |more: &[&str]| -> Vec<String> {
        let (code, out, err) = stepscope(&[&options, more].concat(), "{}");
        assert_eq!((code, err.as_str()), (Some(0), ""));
        out.lines().nth(1).expect("a row").split_whitespace().map(str::to_owned).collect()
    };
    let early = row(&["--window", "early"]);
    // Entries including the turn, bytes, surplus, bytes on the line, turns.
    assert_eq!(early[2..5], ["ticks", "49", "392"]);
    assert_eq!(early[9..], ["1", "358", "0"], "{early:?}");
    assert!(row(&[])[3].parse::<u32>().expect("a count") <= 49);
    let quick = row(&["--window", "early", "--search", "quick"]);
    assert!(quick[3].parse::<u32>().expect("a count") > 49 && quick[11] == "-", "{quick:?}");
    let (_, json, _) = stepscope(&[&options[..], &["--json"]].concat(), "{}");
    assert!(
        ["\"turns\":1", "\"wire_bytes\":", "\"surplus\":0"]
            .iter()
            .all(|cell| { json.split_whitespace().collect::<String>().contains(cell) }),
        "{json}"
    );
}

#[test]
fn compresses_steps_of_a_csv_table() {
    // 1000 steps 100 us apart, every seventh 3 us late, and 500 back.
    let direction = |k: u64| if k < 1000 { "right" } else { "left" };
    let row = |k: u64| format!("{},{}\n", 100 * (k + 1) + 3 * u64::from(k.is_multiple_of(7)), direction(k));
    let list: String = std::iter::once("time_us,dir\n".to_owned()).chain((0..1500).map(row)).collect();
    let (code, out, err) = stepscope(&["tables", "--steps", "-", "--entries", "q16"], &list);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let rows: Vec<Vec<&str>> = out.lines().map(|line| line.split_whitespace().collect()).collect();
    let count = |row: usize| rows[row][3].parse::<u32>().expect("a count");
    assert_eq!((&rows[1][..3], rows[1][6], rows[1][7]), (["0", "exact", "q16"].as_slice(), "1500", "0.000"));
    assert!(out.contains("a list of steps has no table"), "{out}");
    // An entry and a turn in each direction.
    assert!(count(1) > 200 && count(3) == 4, "{out}");
    let (code, out, _) =
        stepscope(&["tables", "--steps", "-", "--format", "c", "--name", "captured_1"], &list);
    assert!(code == Some(0) && out.contains("static const uint64_t captured_1_interval[4]"), "{out}");
    for (list, expected) in
        [("cycle\n100\n110\n", "step 2"), ("cycle\n1\nlater\n", "line 3: cycle: \"later\" is out of range")]
    {
        let (code, _, err) = stepscope(&["tables", "--steps", "-", "--format", "csv"], list);
        assert!(code == Some(2) && err.contains(expected), "{err}");
    }
}

#[test]
fn rejects_a_table_of_too_many_steps_before_planning() {
    let motion = r#"{"source":{"motion":{"axes":[{"moves":[{"sine_segments":{"amplitude":{"steps":1e9},"period_s":86400,"periods":1}}]}]}}}"#;
    let (code, out, err) = stepscope(&["tables", "-"], motion);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let refused = |form: &str, max: &str| {
        let expected = format!(
            "4000000000 steps of a table exceed the maximum of {max}; use a shorter motion, or a table for each part of it"
        );
        out.lines().filter(|row| row.contains(form) && row.contains(&expected)).count()
    };
    let found =
        [refused("exact", "4000000"), refused("document", "100000000"), refused("compressed", "100000000")];
    assert_eq!(found, [3; 3], "{out}");
}

#[test]
fn writes_tables_in_each_language() {
    let rows: [(&[&str], &[&str]); 4] = [
        (
            &["--format", "c"],
            &[
                "A table: axis 0, compressed step table",
                "\n#ifndef AXIS_0_H\n#define AXIS_0_H\n",
                "static const uint64_t axis_0_interval[",
                " * time reaches ",
            ],
        ),
        (
            &["--format", "avr", "--entries", "ticks", "--axis", "1"],
            &["static const int16_t axis_1_add[", "] PROGMEM = {", "ul, "],
        ),
        (&["--format", "rust", "--name", "x_axis", "--form", "exact"], &["pub static X_AXIS_COUNT: [u32; "]),
        (&["--format", "csv", "--entries", "q8", "--form", "document"], &["interval_q8,count,add_q8\n"]),
    ];
    for (options, parts) in rows {
        let (code, out, err) = stepscope(&[&["tables", "-"], options].concat(), MOTION);
        assert_eq!((code, err.as_str()), (Some(0), ""), "{options:?}");
        for part in parts {
            assert!(out.contains(part), "{options:?}: {part} in {}", &out[..out.len().min(800)]);
        }
    }
}

/// The files compile without warnings, twice in one source. The walk, in the types of the comment, ends at the time
/// and step of the comment.
#[cfg(unix)]
#[test]
fn exported_c_compiles_and_ends_at_the_stated_time() {
    use std::{env, fs, path::PathBuf, process::Command};
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("tables-c");
    fs::create_dir_all(folder.join("avr")).expect("a folder");
    fs::write(folder.join("avr/pgmspace.h"), "#define PROGMEM\n").expect("a file");
    for format in ["c", "avr"] {
        for entries in ["q16", "q8", "ticks"] {
            let out = folder.join("table.h").display().to_string();
            let options =
                ["tables", "-", "--format", format, "--entries", entries, "--name", "x_axis", "--out", &out];
            let (code, _, err) = stepscope(&options, MOTION);
            assert_eq!((code, err.as_str()), (Some(0), ""), "{options:?}");
            let text = fs::read_to_string(&out).expect("a file");
            let line =
                text.lines().find_map(|line| line.strip_prefix(" * time reaches ")).expect("a comment");
            let (time, rest) = line.split_once(": ").expect("a time");
            let width = rest.split_once('(').and_then(|(_, rest)| rest.split_once(')')).expect("a type").0;
            let main = format!(
                r#"#include "table.h"
#include "table.h"
#include <stdio.h>
int main(void) {{
    {width} time = 0;
    unsigned long long steps = 0;
    for (unsigned long i = 0; i < X_AXIS_ENTRIES; i++) {{
        uint64_t interval = x_axis_interval[i];
        if (x_axis_count[i] == 0) time += ({width})interval;
        for (uint32_t n = 0; n < x_axis_count[i]; n++) {{
            time += ({width})interval;
            steps++;
            interval += (uint64_t)(int64_t)x_axis_add[i];
        }}
    }}
    printf("%llu %d", (unsigned long long)time, steps == X_AXIS_STEPS);
    return 0;
}}
"#
            );
            fs::write(folder.join("main.c"), main).expect("a file");
            let compiler = env::var("CC").unwrap_or_else(|_| "cc".to_owned());
            let compiled = Command::new(compiler)
                .args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-I.", "-o", "sum", "main.c"])
                .current_dir(&folder)
                .output()
                .expect("there is a compiler of C, as Rust's linker is one");
            assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
            let ran = Command::new(folder.join("sum")).output().expect("it starts");
            assert_eq!(String::from_utf8_lossy(&ran.stdout), format!("{time} 1"), "{format} {entries}");
        }
    }
}

#[test]
fn warns_of_arrays_too_large_for_the_compiler() {
    let motion = r#"{ "clock_hz": 200000000, "source": { "motion": { "axes": [ { "moves": [
        { "sine": { "amplitude": { "steps": 20000 }, "period_s": 40, "periods": 1 } } ] } ] } } }"#;
    let options = ["tables", "-", "--form", "exact", "--entries", "ticks", "--format"];
    let (code, out, err) = stepscope(&[&options[..], &["avr"]].concat(), motion);
    assert_eq!(code, Some(0), "{err}");
    let warning = err.lines().next().expect("a warning");
    assert!(
        warning
            .starts_with("warning: axis_0_interval has 124356 bytes; avr-gcc allows 32767 bytes per array; "),
        "{err}"
    );
    assert!(
        out.contains(&format!(" * WARNING: {}.", warning.trim_start_matches("warning: "))),
        "it is in the file"
    );
    // Rust has no such limit.
    assert_eq!(stepscope(&[&options[..], &["rust"]].concat(), motion).2, "");
}

#[test]
fn rejects_names_reserved_in_c() {
    for name in ["string_1", "memory_x", "is_a", "total_1", "uint8_t", "e1_axis", "isr_x", "int"] {
        let (code, _, err) = stepscope(&["tables", "-", "--format", "c", "--name", name], MOTION);
        let expected = if name == "is_a" { Some(0) } else { Some(2) };
        assert_eq!(code, expected, "{name}: {err}");
    }
    let help = stepscope(&["tables", "--help"], "").1;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains("They begin with is, to, str, mem, wcs or e and a letter"), "{help}");
}

#[test]
fn explains_why_there_is_no_table() {
    let rows: [(&[&str], &str, &str); 5] = [
        (
            &["--format", "c", "--axis", "2"],
            MOTION,
            "--axis: 2 is out of range; the scenario has axes 0 to 1; use --axis 0 to 1",
        ),
        (
            &["--format", "c", "--axis", "1", "--form", "document"],
            MOTION,
            "axes[1]: this kind of move has no table",
        ),
        (&[], r#"{ "source": { "line": {} } }"#, "source: no channel has steps"),
        (&["--error-us=-1"], MOTION, "use 0 to 1000000000"),
        (&["--format", "rust", "--error-us", "1e8"], MOTION, "cycles of tolerance"),
    ];
    for (options, scenario, part) in rows {
        let (code, out, err) = stepscope(&[&["tables", "-"], options].concat(), scenario);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{options:?}: {err}");
        assert!(err.contains(part), "{options:?}: {err}");
    }
}

#[test]
fn sine_tables_have_the_published_rows() {
    let sweep = ["sine", "sweep", "--from", "0.0054", "--to", "0.006", "--points", "2", "--order", "1023"];
    let (code, out, _) = stepscope(&sweep, "");
    assert_eq!(code, Some(0));
    let rows: Vec<Vec<&str>> = out.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(
        (rows.len(), rows[1][..2].to_vec(), rows[2][..2].to_vec()),
        (3, vec!["0.0054", "6"], vec!["0.006", "6"])
    );
    for (row, percent) in rows[1..].iter().zip([0.269_13, 0.267_10]) {
        let found: f64 = row[2].parse().expect("a number");
        assert!((found - percent).abs() < 3e-4, "{row:?}");
    }
    // With an accelerometer of 50 Hz at 2 Hz the last column hardly grows with the order.
    let filtered = |order: &str| -> f64 {
        let sensor = ["--sensor-hz", "50", "--period-s", "0.5", "--points", "2", "--order", order];
        let (code, out, _) = stepscope(&[&["sine", "sweep"], sensor.as_slice()].concat(), "");
        assert_eq!((code, out.lines().next().map(|head| head.split(',').count())), (Some(0), Some(7)));
        let last = out.trim_end().rsplit(',').next().and_then(|filtered| filtered.parse().ok());
        last.expect("a number")
    };
    let (low, high) = (filtered("999"), filtered("9999"));
    assert!(low > 50.0 && high > low && high < 1.02 * low, "{low} {high}");
    assert_eq!(stepscope(&["sine", "sweep", "--sensor-hz", "50"], "").0, Some(2));
    let (code, out, _) = stepscope(&["sine", "best", "--from", "0.005", "--to", "0.008"], "");
    assert_eq!((code, out.lines().count()), (Some(0), 2));
    let (_, six, _) = stepscope(&["sine", "best", "--segments", "6"], "");
    assert!(six.lines().nth(1).is_some_and(|row| row.split(',').nth(1) == Some("6")), "{six}");
    let (code, out, _) = stepscope(&["sine", "vertices", "--segments", "6", "--free"], "");
    assert_eq!((code, out.lines().count()), (Some(0), 8));
    let percent = out.trim_end().rsplit(',').next().and_then(|percent| percent.parse::<f64>().ok());
    assert!(percent.is_some_and(|percent| percent < 0.2232), "{out}");
    assert_eq!(stepscope(&["sine", "vertices", "--segments", "33"], "").0, Some(2));
    assert_eq!(stepscope(&["sine", "sweep", "--from", "0"], "").0, Some(2));
}
