//! Real-world recordings with independently computed results: exports of other programs, odd time bases, serial lines
//! with few samples per bit, channel names from the field. The files are in `cli/tests/recordings`.

use crate::program::stepscope;
use serde_json::Value;
use std::path::Path;

fn capture(file: &str, arguments: &[&str]) -> (Option<i32>, String, String) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recordings");
    let given = |text: &&str| match text.strip_prefix('@') {
        Some(name) => folder.join(name).display().to_string(),
        None => (*text).to_owned(),
    };
    let path = folder.join(file).display().to_string();
    let arguments: Vec<String> = arguments.iter().map(given).collect();
    let all = ["capture", &path].into_iter().chain(arguments.iter().map(String::as_str));
    stepscope(&all.collect::<Vec<_>>(), "")
}

fn tables(file: &str, arguments: &[&str]) -> Value {
    let (code, out, err) = capture(file, &[arguments, &["--json"]].concat());
    assert_eq!(code, Some(0), "{file} {arguments:?}: {err}");
    let all: Value = serde_json::from_str(&out).expect("JSON");
    all["tables"].clone()
}

#[test]
fn counts_steps_of_each_motor_by_direction() {
    // (file, options, steps to the right and to the left of each channel)
    for (file, options, expected) in [
        ("dsview.csv", &[][..], &[(20, 5)][..]),
        ("dsview-comma.csv", &[], &[(20, 5)]),
        ("j-string-var.vcd", &[], &[(10, 4)]),
        ("dir-late-unnamed.vcd", &[], &[(4, 4)]),
        ("two-motors-one-dir.vcd", &[], &[(25, 25), (25, 25)]),
        ("step-y-dir.csv", &[], &[(10, 10)]),
        ("ra-dec.csv", &[], &[(10, 10), (10, 10)]),
        ("step-en-first.csv", &[], &[(10, 10)]),
        ("verilator-like.vcd", &["--map", "STEP0=tb.motion.STEP,DIR0=tb.motion.DIR"], &[(30, 0)]),
        ("verilator-like.vcd", &[], &[(30, 0)]),
        ("waveforms.csv", &[], &[(12, 3)]),
        ("micros-head.csv", &[], &[(12, 3)]),
        ("sample-numbers.csv", &["--sample-rate", "1000000"], &[(12, 3)]),
        ("millis.csv", &[], &[(5, 8)]),
        ("cw-ccw.vcd", &["--map", "CW0=CW,CCW0=CCW"], &[(20, 12)]),
        ("dedge.vcd", &["--both-edges"], &[(40, 0)]),
    ] {
        let tables = tables(file, options);
        let steps = tables["steps"].as_array().expect("a table");
        let found: Vec<_> = steps.iter().map(|row| (row["right"].as_u64(), row["left"].as_u64())).collect();
        let expected: Vec<_> = expected.iter().map(|&(right, left)| (Some(right), Some(left))).collect();
        assert_eq!(found, expected, "{file} {options:?}");
    }
}

#[test]
fn reads_times_and_rates_of_files() {
    // (file, options, figure, value)
    for (file, options, figure, expected) in [
        ("dsview.csv", &[][..], "first_s", 0.001),
        ("dsview.csv", &[], "last_s", 0.031),
        ("dsview.csv", &[], "shortest_interval_s", 0.001),
        ("dsview.csv", &[], "longest_interval_s", 0.003),
        ("d-6666ps.vcd", &[], "shortest_interval_s", 6.666e-6),
        ("83ns.vcd", &[], "shortest_interval_s", 9.96e-6),
        ("83ns.vcd", &[], "longest_interval_s", 9.96e-6),
        ("83ns.vcd", &[], "greatest_acceleration_steps_s2", 0.0),
        ("41667ps-short.vcd", &[], "shortest_interval_s", 10e-6),
        ("verilator-like.vcd", &[], "greatest_rate_steps_s", 100_000.0),
        ("dedge.vcd", &["--both-edges"], "greatest_rate_steps_s", 10_000.0),
    ] {
        let tables = tables(file, options);
        let found = tables["steps"][0][figure].as_f64().expect(figure);
        let off = (found - expected).abs();
        assert!(off <= 1e-9 + expected.abs() * 1e-4, "{file}: {figure} is {found}, not {expected}");
    }
}

#[test]
fn decodes_the_bytes_that_were_sent() {
    let hello = b"Hello World!\r\n".repeat(3);
    // (file, options, how many bytes, the first of them)
    for (file, options, count, first) in [
        ("hexdump-C-hexletters.txt", &["--baud", "9600"][..], 16, &b"DEADBEEFCAFE0123"[..]),
        ("od-Ax.txt", &["--baud", "9600"], 16, b"DEADBEEFCAFE0123"),
        (
            "xxd.txt",
            &["--baud", "9600"],
            24,
            &[
                0x55, 0xaa, 1, 2, 0x83, 0x61, 0x62, 0x63, 0x64, 5, 0xfe, 0xed, 0, 0x11, 0x22, 0x33, 0x61,
                0x62, 0x63, 0x64, 0x65, 0x66, 0x30, 0x31,
            ],
        ),
        ("windterm-rows.txt", &["--baud", "9600"], 6, &[0x62, 0x65, 0x65, 0x66, 1, 2]),
        ("iso.txt", &[], 3, &[0x55, 0xaa, 1]),
        ("bracket.txt", &[], 5, &[0x55, 0xaa, 1, 2, 0x83]),
        ("jpnevulator.txt", &[], 6, &[0x55, 0xaa, 1, 2, 0x83, 0x61]),
        ("sigrok-cli-A.txt", &["--baud", "9600"], 3, &[0x55, 0xaa, 1]),
        ("hello-921600-5MHz.sr", &[], 42, &hello),
        ("silent-wrong-4.30.sr", &[], 40, &[0x82, 0xb7, 0x0e, 0xee, 0x7f, 0x1a, 0x50, 0x39]),
        ("rx-random-gaps.csv", &[], 112, b"M114 X:12.50 "),
        ("d3-fifth-bit.csv", &[], 112, b"M114 X:12.50 "),
        ("8e1.csv", &["--uart", "8E1"], 42, b""),
    ] {
        let tables = tables(file, options);
        let lines = tables["lines"].as_array().expect("a table");
        assert_eq!(lines.len(), 1, "{file}: {lines:?}");
        let found = (lines[0]["bytes"].as_u64(), lines[0]["framing_errors"].as_u64());
        assert_eq!(found, (Some(count), Some(0)), "{file}");
        let (_, out, _) = capture(file, &[options, &["--bytes", "-"]].concat());
        let bytes: Vec<u8> = out
            .lines()
            .skip(1)
            .filter_map(|row| u8::from_str_radix(row.rsplit(',').next()?, 16).ok())
            .collect();
        assert!(bytes.starts_with(first), "{file}: {bytes:02x?}");
        assert_eq!(bytes.len() as u64, count, "{file}");
    }
}

#[test]
fn never_guesses_missing_rates() {
    // (file, the option that the message names)
    for (file, expected) in [
        ("sample-numbers.csv", "--sample-rate"),
        ("csv-noname.txt", "--sample-rate"),
        ("us-noheader.csv", "--sample-rate"),
        ("xxd.txt", "--baud"),
        ("8e1.csv", "--baud"),
    ] {
        let (code, out, err) = capture(file, &[]);
        assert_eq!(code, Some(2), "{file}: {out}{err}");
        assert!(err.contains(expected), "{file}: {err}");
    }
    let (code, _, err) = capture("xxd.txt", &["--sample-rate", "1000000"]);
    assert!(code == Some(2) && err.contains("--baud"), "{err}");
    // With the rate, rows without a head are times with levels, or with a byte.
    assert_eq!(tables("us-noheader.csv", &["--sample-rate", "1000000"])["steps"][0]["left"], 3);
    assert_eq!(tables("csv-noname.txt", &["--sample-rate", "1000000"])["lines"][0]["bytes"], 3);
}

#[test]
fn counts_each_edge_as_a_step_even_one_tick_apart() {
    let rows = |row: &dyn Fn(u64) -> String| -> String { (0..=40).map(row).collect() };
    let dedge = format!("time_us,STEP\n{}", rows(&|k| format!("{k},{}\n", k % 2)));
    let encoder = format!("time_us,A,B\n{}", rows(&|k| format!("{k},{},{}\n", k.div_ceil(2) % 2, k / 2 % 2)));
    for (text, map) in [(dedge, "DEDGE0=STEP"), (encoder, "A0=A,B0=B")] {
        let (code, out, err) = stepscope(&["capture", "-", "--map", map, "--json"], &text);
        assert_eq!(code, Some(0), "{map}: {err}");
        let all: Value = serde_json::from_str(&out).expect("JSON");
        assert_eq!(all["tables"]["steps"][0]["right"], 40, "{map}: {out}");
    }
}

#[test]
fn suggests_parity_and_both_edges() {
    for (file, expected) in [("8e1.csv", "--uart 8E1"), ("dedge.vcd", "--both-edges")] {
        let (_, out, err) = capture(file, &[]);
        assert!((out.clone() + &err).contains(expected), "{file}: {out}{err}");
    }
}

#[test]
fn checks_the_real_widths_of_pulses() {
    for (file, driver, rule, count) in [
        ("83ns.vcd", "a4988", "step_high", 20),
        ("41667ps-short.vcd", "a4988", "step_high", 20),
        ("stepgen.vcd", "@rules.json", "dir_setup", 3),
    ] {
        let (code, out, err) = capture(file, &["--driver", driver, "--strict"]);
        assert_eq!(code, Some(3), "{file}: {out}{err}");
        let tables: Value =
            serde_json::from_str(&capture(file, &["--driver", driver, "--json"]).1).expect("JSON");
        let violations = tables["tables"]["violations"].as_array().expect("a table");
        assert_eq!(violations.len(), count, "{file}: {violations:?}");
        assert!(violations.iter().all(|row| row["rule"] == rule), "{file}: {violations:?}");
    }
}

#[test]
fn writes_steps_of_any_channel_without_a_plan() {
    let dump = "two-motors-one-dir.vcd";
    let (code, of_second, err) = capture(dump, &["--steps", "-", "--channel", "1"]);
    assert_eq!((code, of_second.lines().count(), err.as_str()), (Some(0), 51, ""));
    assert_ne!(of_second, capture(dump, &["--steps", "-"]).1);
    let (code, out, err) = capture(dump, &["--steps", "-", "--channel", "5"]);
    assert!(code == Some(2) && out.is_empty(), "{out}{err}");
    assert!(err.contains("--channel: 5 has no steps; use one of 0, 1"), "{err}");
    let (code, _, err) = capture(dump, &["--channel", "1"]);
    assert!(code == Some(2) && err.contains("--against") && err.contains("--steps"), "{err}");
}

#[test]
fn a_klipper_log_without_frequency_requires_a_clock() {
    let log = "reset_step_clock oid=3 clock=0\nqueue_step oid=3 interval=1000 count=3 add=0\n";
    let (code, out, err) = stepscope(&["capture", "-"], log);
    assert!(code == Some(2) && out.is_empty(), "{out}{err}");
    assert!(
        err.contains("has no CLOCK_FREQ; use the clock of its controller") && !err.contains("time_us"),
        "{err}"
    );
    let (code, out, err) = stepscope(&["capture", "-", "--sample-rate", "16000000"], log);
    assert!(code == Some(0) && out.contains("3 steps"), "{out}{err}");
}

#[test]
fn separates_directions_of_annotations_and_accepts_a_base() {
    let annotations = "uart-1: rx-data: 72\nuart-1: tx-data: 65\nuart-1: rx-data: 73\n";
    for (base, expected) in [("hex", ["72", "73", "65"]), ("dec", ["48", "49", "41"])] {
        let options = ["capture", "-", "--baud", "9600", "--bytes", "-", "--base", base];
        let (code, out, err) = stepscope(&options, annotations);
        let found: Vec<_> = out.lines().skip(1).map(|row| (&row[..2], &row[row.len() - 2..])).collect();
        let expected: Vec<_> = ["RX", "RX", "TX"].into_iter().zip(expected).collect();
        assert_eq!((code, found, err.as_str()), (Some(0), expected, ""), "{base}");
    }
    let (code, _, err) = stepscope(&["capture", "-", "--base", "12"], annotations);
    assert!(code == Some(2) && err.contains("use hex, dec, oct or bin"), "{err}");
}
