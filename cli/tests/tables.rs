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
    let options =
        ["tables", "--steps", "-", "--form", "compressed", "--entries", "q16", "--format", "c", "--name"];
    let (code, out, _) = stepscope(&[&options[..], &["captured"]].concat(), &list);
    assert!(code == Some(0) && out.contains("static const stepscope_q16_entry captured_entries["), "{out}");
    assert!(out.contains("#define CAPTURED_ENTRIES 4U\n") && out.contains(" * Steps -, CRC-32 "), "{out}");
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
    let rows: [(&[&str], &str, &[&str]); 5] = [
        (
            &["--format", "c"],
            "form exact, entries ticks\n",
            &[
                "/* axis_0: 20000 steps in ",
                "tables - --form exact --entries ticks --format c --name axis_0\n",
                "\n#ifndef AXIS_0_TABLE_H\n#define AXIS_0_TABLE_H\n",
                "static const stepscope_ticks_entry axis_0_entries[AXIS_0_ENTRIES] = {",
                "#define AXIS_0_MAX_ERROR_CYCLES 0UL",
                "\nSTEPSCOPE_TICKS_TABLE(axis_0)\n",
            ],
        ),
        (
            &["--format", "avr", "--axis", "1", "--form", "compressed"],
            "form compressed, entries ticks\n",
            &[
                "static const stepscope_ticks_entry axis_1_entries[AXIS_1_ENTRIES] PROGMEM = {",
                "tables - --axis 1 --form compressed --error-us 25 --entries ticks --format avr --name axis_1\n",
                "\nSTEPSCOPE_TICKS_TABLE_P(axis_1)\n",
            ],
        ),
        (
            &["--format", "c", "--axis", "all", "--name", "arm", "--form", "exact", "--entries", "q8"],
            "",
            &[
                " * arm_1: 6400 steps in ",
                "#ifndef ARM_TABLE_H\n",
                "STEPSCOPE_Q8_TABLE(arm_0)\n",
                "STEPSCOPE_Q8_TABLE(arm_1)\n",
                "tables - --axis all --form exact --entries q8 --format c --name arm\n",
            ],
        ),
        (
            &["--format", "rust", "--name", "x_axis", "--form", "exact", "--entries", "q16"],
            "",
            &["pub static X_AXIS_COUNT: [u32; ", "// Made by stepscope "],
        ),
        (&["--format", "csv", "--entries", "q8", "--form", "document"], "", &["interval_q8,count,add_q8\n"]),
    ];
    for (options, note, parts) in rows {
        let (code, out, err) = stepscope(&[&["tables", "-"], options].concat(), MOTION);
        assert_eq!((code, err.as_str()), (Some(0), note), "{options:?}");
        for part in parts {
            assert!(out.contains(part), "{options:?}: {part} in {}", &out[..out.len().min(800)]);
        }
        assert_eq!(stepscope(&[&["tables", "-"], options].concat(), MOTION).1, out, "the same bytes");
    }
}

/// The table and its walker, and the command of the table's head: run in a shell, it makes the same file.
#[cfg(unix)]
#[test]
fn a_table_states_the_command_that_reproduces_it() {
    use std::{
        env, fs,
        path::{Path, PathBuf},
        process::Command,
    };
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("tables-again");
    fs::create_dir_all(&folder).expect("a folder");
    // In a folder, so that the path would end a comment.
    let scenario = "it's a */ turn.json";
    fs::create_dir_all(folder.join("it's a *")).expect("a folder");
    fs::write(folder.join(scenario), MOTION).expect("a file");
    let program = env!("CARGO_BIN_EXE_stepscope");
    for options in [
        &["--format", "c", "--axis", "all"][..],
        &[
            "--format",
            "avr",
            "--form",
            "compressed",
            "--error-us",
            "12.5",
            "--search",
            "quick",
            "--window",
            "early",
        ],
        &["--format", "rust", "--axis", "1", "--name", "turn", "--entries", "q8"],
    ] {
        let out = folder.join("table.h");
        let mut first = Command::new(program);
        first.current_dir(&folder).args(["tables", scenario, "--out", "table.h"]).args(options);
        let first = first.output().expect("it starts");
        assert!(first.status.success(), "{first:?}");
        let text = fs::read_to_string(&out).expect("a file");
        let line = text.lines().find_map(|line| line.split_once("Made by stepscope ")).expect("its origin").1;
        let (_, command) = line.split_once(": ").expect("a command");
        let programs = Path::new(program).parent().expect("a folder").display();
        let path = format!("{programs}:{}", env::var("PATH").unwrap_or_default());
        let again =
            Command::new("bash").args(["-c", command]).env("PATH", path).current_dir(&folder).output();
        assert_eq!(String::from_utf8_lossy(&again.expect("a shell").stdout), text, "{command}");
    }
}

#[cfg(unix)]
#[test]
fn the_walker_is_written_with_or_without_a_table() {
    use std::{env, fs, path::PathBuf};
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("tables-walker");
    fs::create_dir_all(&folder).expect("a folder");
    let out = folder.join("turn.h").display().to_string();
    let options = ["tables", "-", "--format", "c", "--with-walker", "--out"];
    let (code, _, err) = stepscope(&[&options[..], &[&out]].concat(), MOTION);
    assert_eq!(code, Some(0), "{err}");
    let walker = fs::read_to_string(folder.join("stepscope_walk.h")).expect("the walker");
    assert_eq!(stepscope(&["tables", "--walker"], ""), (Some(0), walker, String::new()));
    let own_name = folder.join("stepscope_walk.h").display().to_string();
    for (options, why) in [
        (&["tables", "-", "--format", "c", "--with-walker"][..], "use --out FILE, or --walker"),
        (
            &["tables", "-", "--format", "rust", "--with-walker", "--out", &out],
            "use --format c or --format avr",
        ),
        (&["tables", "-", "--with-walker", "--out", &out], "use it with --format c"),
        (
            &["tables", "-", "--format", "c", "--with-walker", "--out", &own_name],
            "already the output of --out",
        ),
        (&["tables", "-", "--format", "csv", "--axis", "all"], "use --axis K"),
        (&["tables", "-", "--walker"], "cannot be used with"),
    ] {
        let (code, _, err) = stepscope(options, MOTION);
        assert!(code == Some(2) && err.contains(why), "{options:?}: {err}");
    }
}

#[cfg(unix)]
#[test]
fn a_check_compares_a_table_with_its_plan() {
    use std::{env, fs, path::PathBuf};
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("tables-check");
    fs::create_dir_all(&folder).expect("a folder");
    let out = folder.join("both.h").display().to_string();
    let options = ["tables", "-", "--format", "avr", "--form", "compressed", "--axis", "all", "--out", &out];
    assert_eq!(stepscope(&options, MOTION).0, Some(0));
    let (code, text, err) = stepscope(&["tables", "-", "--check", &out], MOTION);
    assert_eq!((code, err.as_str(), text.lines().count()), (Some(0), "", 2), "{text}");
    assert!(text.starts_with("axis_0, axis 0: passed: 20000 steps, largest error "), "{text}");
    // Without a file: of the table that would be written.
    let (code, text, _) = stepscope(&["tables", "-", "--axis", "1", "--entries", "q16", "--check"], MOTION);
    let expected = "axis_1, axis 1: passed: 6400 steps, largest error 0 cycles, at most 0 stated\n";
    assert_eq!((code, text.as_str()), (Some(0), expected));
    let table = fs::read_to_string(&out).expect("a file");
    let changed = table.replace("AXIS_1_MAX_ERROR_CYCLES ", "AXIS_1_MAX_ERROR_CYCLES 0UL //");
    fs::write(&out, changed.replace("0UL //", "0UL\n//")).expect("a file");
    let (code, text, err) = stepscope(&["tables", "-", "--check", &out], MOTION);
    assert_eq!(code, Some(3), "{text}");
    assert!(text.lines().nth(1).is_some_and(|row| row.contains("the table states at most 0")), "{text}");
    assert!(err.contains("1 of 2 tables differs from the plan"), "{err}");
    // The axis is that of the command in the header, and the stated times are compared, too.
    let options = ["tables", "-", "--format", "c", "--axis", "1", "--out", &out];
    assert_eq!(stepscope(&options, MOTION).0, Some(0));
    let (code, text, _) = stepscope(&["tables", "-", "--check", &out], MOTION);
    assert!(code == Some(0) && text.starts_with("axis_1, axis 1: passed: 6400 steps"), "{text}");
    let table = fs::read_to_string(&out).expect("a file");
    fs::write(&out, table.replace("AXIS_1_MAX_CYCLES ", "AXIS_1_MAX_CYCLES 9UL\n//")).expect("a file");
    let (code, text, err) = stepscope(&["tables", "-", "--check", &out], MOTION);
    assert!(code == Some(3) && text.contains("failed: MAX_CYCLES is 9, and "), "{text}");
    assert!(err.contains("1 of 1 table differs from the plan"), "{err}");
    let options = ["tables", "-", "--format", "avr", "--form", "compressed", "--axis", "all", "--out", &out];
    assert_eq!(stepscope(&options, MOTION).0, Some(0));
    for (options, scenario, why) in [
        (&["--check", &out][..], "{}", "2 tables from axis 0 on, but the scenario has 1"),
        (&["--check", "/dev/null"], MOTION, "no table; use a file of stepscope tables"),
        (&["--check", &out, "--entries", "q8"], MOTION, "--entries: has no effect on the table of a file"),
        (&["--check", &out, "--search", "quick"], MOTION, "--search: has no effect on the table of a file"),
        (&["--check", &out, "--format", "rust"], MOTION, "--format: has no effect on the table of a file"),
    ] {
        let (code, _, err) = stepscope(&[&["tables", "-"], options].concat(), scenario);
        assert!(code == Some(2) && err.contains(why), "{err}");
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
            .starts_with("warning: axis_0_entries has 248712 bytes; avr-gcc allows 32767 bytes per array; "),
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
fn rejects_keywords_and_names_of_the_walker() {
    for (name, why) in [
        ("turn", ""),
        ("is_a", ""),
        ("extruder", ""),
        ("stepscope_q8", "begin with \"stepscope\""),
        ("int", "\"int\" is a keyword of C, C++ or avr-libc; use another name"),
        ("sei", "\"sei\" is a keyword"),
        ("Turn", "not a valid name; use up to 32 lower-case letters"),
    ] {
        let (code, _, err) = stepscope(&["tables", "-", "--format", "c", "--name", name], MOTION);
        assert_eq!(code, if why.is_empty() { Some(0) } else { Some(2) }, "{name}: {err}");
        assert!(err.contains(why), "{name}: {err}");
    }
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
        (&["--format", "rust", "--form", "compressed", "--error-us", "1e8"], MOTION, "cycles of tolerance"),
    ];
    for (options, scenario, part) in rows {
        let (code, out, err) = stepscope(&[&["tables", "-"], options].concat(), scenario);
        assert_eq!((code, out.as_str()), (Some(2), ""), "{options:?}: {err}");
        assert!(err.contains(part), "{options:?}: {err}");
    }
}

#[test]
fn rejects_options_without_effect() {
    let rows: [(&[&str], &str); 9] = [
        (&["--form", "exact", "--error-us", "9"], "--error-us: only a compressed table"),
        (&["--format", "c", "--interval-part", "2"], "--interval-part: only a compressed table"),
        (&["--form", "document", "--window", "early"], "--window: only a compressed table"),
        (&["--check", "--search", "quick"], "--search: only a compressed table"),
        (&["--check", "--format", "rust"], "--format: only tables in C can be checked; use --format c"),
        (&["--format", "csv", "--check"], "--format: only tables in C can be checked"),
        (&["--name", "turn"], "--name: only source code has names; use --format c, avr or rust"),
        (&["--name", "turn", "--format", "csv"], "--name: only source code has names"),
        (&["--format", "c", "--form", "compressed", "--error-us", "25", "--search", "fewest"], ""),
    ];
    for (options, why) in rows {
        let (code, out, err) = stepscope(&[&["tables", "-"], options].concat(), MOTION);
        assert_eq!(code, Some(if why.is_empty() { 0 } else { 2 }), "{options:?}: {err}");
        assert!(out.is_empty() != why.is_empty() && err.contains(why), "{options:?}: {err}");
    }
    let (code, _, err) = stepscope(&["tables", "--walker", "--entries", "q8"], "");
    assert!(code == Some(2) && err.contains("cannot be used with"), "{err}");
}

#[test]
fn sine_tables_have_the_published_rows() {
    let sweep =
        ["sine", "sweep", "--from", "0.0054", "--to", "0.006", "--points", "2", "--max-harmonic", "1023"];
    let (code, out, _) = stepscope(&sweep, "");
    assert_eq!(code, Some(0));
    let rows: Vec<Vec<&str>> = out.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(
        (rows.len(), rows[1][..2].to_vec(), rows[2][..2].to_vec()),
        (3, vec!["0.0054", "6"], vec!["0.006", "6"])
    );
    for (row, published) in rows[1..].iter().zip([0.002_691_3, 0.002_671_0]) {
        let found: f64 = row[2].parse().expect("a number");
        assert!((found - published).abs() < 3e-6, "{row:?}");
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
    assert!(low > 0.5 && high > low && high < 1.02 * low, "{low} {high}");
    assert_eq!(stepscope(&["sine", "sweep", "--sensor-hz", "50"], "").0, Some(2));
    let (code, out, _) = stepscope(&["sine", "best", "--from", "0.005", "--to", "0.008"], "");
    assert_eq!((code, out.lines().count()), (Some(0), 2));
    let (_, six, _) = stepscope(&["sine", "best", "--segments", "6"], "");
    assert!(six.lines().nth(1).is_some_and(|row| row.split(',').nth(1) == Some("6")), "{six}");
    let (code, out, _) = stepscope(&["sine", "vertices", "--segments", "6", "--free"], "");
    assert_eq!((code, out.lines().count()), (Some(0), 8));
    let distortion = out.trim_end().rsplit(',').next().and_then(|ratio| ratio.parse::<f64>().ok());
    assert!(distortion.is_some_and(|ratio| ratio < 0.002_232), "{out}");
    assert_eq!(stepscope(&["sine", "vertices", "--segments", "33"], "").0, Some(2));
    assert_eq!(stepscope(&["sine", "sweep", "--from", "0"], "").0, Some(2));
}
