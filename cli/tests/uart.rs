//! Serial lines in recordings: `stepscope capture` decodes them correctly or reports what is missing.

use crate::program::stepscope;
use serde_json::Value;
use std::path::Path;

fn recording(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/recordings").join(name).display().to_string()
}

fn bytes(options: &[&str], input: &str) -> Vec<u8> {
    let (code, out, err) = stepscope(&[&["capture"], options, &["--bytes", "-"]].concat(), input);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{options:?}");
    let byte = |row: &str| u8::from_str_radix(row.rsplit(',').next().expect("a field"), 16).expect("a byte");
    out.lines().skip(1).map(byte).collect()
}

fn line(options: &[&str], input: &str) -> Value {
    let (code, out, err) = stepscope(&[&["capture"], options, &["--json"]].concat(), input);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{options:?}");
    let all: Value = serde_json::from_str(&out).expect("JSON");
    all["tables"]["lines"][0].clone()
}

/// Levels of one channel; `stop` is the time of the stop bits and the gap after a byte, in ns.
fn table(name: &str, bytes: &[u8], bit_ns: u64, stop: u64, inverted: bool) -> String {
    let mut text = format!("Time [s],{name}\n0.0,{}\n", u8::from(!inverted));
    let (mut at, mut before) = (100_000, true);
    for byte in bytes {
        for bit in 0..9 {
            let level = (u16::from(*byte) << 1) >> bit & 1 == 1;
            if level != before {
                text += &format!("0.{at:09},{}\n", u8::from(level != inverted));
            }
            (at, before) = (at + bit_ns, level);
        }
        if !before {
            text += &format!("0.{at:09},{}\n", u8::from(!inverted));
        }
        (at, before) = (at + stop * bit_ns / 10, true);
    }
    text
}

#[test]
fn decodes_every_byte_with_few_samples_and_any_gaps() {
    let hello = bytes(&[&recording("hello-921600-5MHz.sr"), "--map", "RX=TX"], "");
    assert_eq!(hello, b"Hello World!\r\n".repeat(3));
    let found = bytes(&[&recording("silent-wrong-4.30.sr")], "");
    assert_eq!((found.len(), &found[..8]), (40, &[0x82, 0xb7, 0x0e, 0xee, 0x7f, 0x1a, 0x50, 0x39][..]));
    for name in ["rx-random-gaps.csv", "d3-fifth-bit.csv"] {
        let found = bytes(&[&recording(name)], "");
        assert!(found.len() == 112 && found.starts_with(b"M114 X:12.50"), "{name}");
        let line = line(&[&recording(name)], "");
        assert_eq!((&line["line"], &line["baud"]), (&"RX".into(), &115_200.into()), "{name}");
        assert_eq!((&line["framing_errors"], &line["problem"]), (&0.into(), &Value::Null), "{name}");
    }
}

#[test]
fn proposes_and_accepts_parity() {
    let file = recording("8e1.csv");
    assert_eq!(bytes(&[&file, "--uart", "8E1"], ""), b"Hello World!\r\n".repeat(3));
    for options in [&[][..], &["--map", "RX=RX"], &["--bytes", "-"], &["--json"]] {
        let (code, out, err) = stepscope(&[&["capture", &file], options].concat(), "");
        assert_eq!((code, out.as_str()), (Some(2), ""), "{options:?}");
        assert!(err.contains("the errors look like even parity: try --uart 8E1"), "{err}");
    }
    let given = line(&[&file, "--baud", "115200"], "");
    assert_eq!(given["framing_errors"], 30);
    assert!(given["hint"].as_str().is_some_and(|hint| hint.contains("try --uart 8E1")), "{given}");
    let (code, _, err) = stepscope(&["capture", &file, "--uart", "8O1"], "");
    assert!(code == Some(2) && err.contains("try --uart 8E1"), "{err}");
    let (code, _, err) = stepscope(&["capture", &file, "--uart", "9N1"], "");
    assert!(code == Some(2) && err.contains("use 7 or 8 data bits, parity N, E or O"), "{err}");
    // 7E1 has as many bits as 8N1.
    let text = b"Hello, World 0123456789";
    let even: Vec<u8> = text.iter().map(|byte| byte | ((byte.count_ones() % 2) as u8) << 7).collect();
    let seven = table("RX", &even, 8681, 10, false);
    let found = line(&["-"], &seven);
    assert!(found["hint"].as_str().is_some_and(|hint| hint.ends_with("try --uart 7E1")), "{found}");
    assert_eq!(bytes(&["-", "--uart", "7E1"], &seven), text);
    let mut wrong = even;
    wrong[3] ^= 0x80;
    assert_eq!(line(&["-", "--uart", "7E1"], &table("RX", &wrong, 8681, 10, false))["parity_errors"], 1);
}

#[test]
fn requires_a_bit_rate_if_none_fits() {
    // Random pulses, with steps on other channels.
    let mut state = 1_u64;
    let mut noise = "Time [s],RX,STEP\n0.0,1,0\n".to_owned();
    let mut at = 0_u64;
    for k in 0..400 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        at += 3000 + (state >> 33) % 50_000;
        noise += &format!("0.{at:09},{},{}\n", k % 2, u8::from(k / 2 % 20 == 0));
    }
    for (map, code) in [(&["--map", "RX=RX"][..], 2), (&["--map", "RX=RX,STEP0=STEP"], 2), (&[], 0)] {
        let (found, out, err) = stepscope(&[&["capture", "-"], map].concat(), &noise);
        assert_eq!(found, Some(code), "{map:?} {out}{err}");
        let all = out + &err;
        assert!(all.contains("RX: no bit rate fits its pulses") && all.contains("--baud"), "{all}");
        assert!(!all.contains("bytes,"), "{all}");
    }
    // A byte with one low pulse fits several rates.
    let zero = table("RX", &[0], 8681, 10, false);
    let (code, _, err) = stepscope(&["capture", "-"], &zero);
    assert!(code == Some(2) && err.contains("several bit rates (38400, 115200, 76800)"), "{err}");
    assert_eq!(bytes(&["-", "--baud", "115200"], &zero), [0]);
}

#[test]
fn proposes_a_serial_line_of_either_polarity_as_rx() {
    let text = b"G1 X10 Y20 F600\r\nok\r\n".repeat(4);
    for (name, stop, inverted, map) in [
        ("CH1", 10, false, "RX=CH1"),
        ("CH1", 13, false, "RX=CH1"),
        ("CH1", 137, true, "RX=!CH1"),
        ("RX", 10, true, "RX=!RX"),
        ("TX", 25, true, "TX=!TX"),
    ] {
        let input = table(name, &text, 17_361, stop, inverted);
        let (code, out, err) = stepscope(&["capture", "-", "--json"], &input);
        assert_eq!((code, err.as_str()), (Some(0), ""));
        let all: Value = serde_json::from_str(&out).expect("JSON");
        assert_eq!(all["tables"]["recording"][0]["map"], map);
        assert_eq!(all["tables"]["lines"][0]["baud"], 57_600, "{map}");
        assert_eq!(bytes(&["-"], &input), text, "{map}");
    }
    let inverted = table("A", &text, 17_361, 10, true);
    let (code, _, err) = stepscope(&["capture", "-", "--map", "RX=A"], &inverted);
    assert!(code == Some(2) && err.contains("the line looks inverted: map it with !"), "{err}");
    // An inverting map for a line that is not inverted.
    let upright = table("A", &text, 17_361, 10, false);
    let (code, _, err) = stepscope(&["capture", "-", "--map", "RX=!A"], &upright);
    assert!(
        code == Some(2) && err.contains("the line looks inverted: map it without !, such as RX=CH1"),
        "{err}"
    );
}
