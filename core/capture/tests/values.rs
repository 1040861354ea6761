//! Values that have several meanings: numbers of any base, lengths, directions and times of logs, units of positions.

use crate::common::{check, read_bytes, summary};
use stepscope_capture::read::{Base, Limits, ReadOptions, read_with_options};

#[test]
fn annotations_of_any_base_are_read_and_unclear_ones_are_not_guessed() {
    let timed = |texts: &str| -> String {
        texts
            .split(' ')
            .enumerate()
            .map(|(at, text)| format!("{}-{} uart-1: rx-data: {text}\n", 10 * at, 10 * at + 9))
            .collect()
    };
    let late = "- bytes without an annotated start bit are timed by their first data bit, one bit late";
    let unclear = "- the bytes may be hexadecimal or decimal and are read as hexadecimal; if they are decimal, print them \
                   with format=hex";
    let text = "the annotations have no bytes in hexadecimal; print rx-data or tx-data with format=hex (sigrok-cli -A \
                uart=rx-data)";
    for (texts, expected) in [
        (
            "72 101 108 7",
            format!("0:0:48 10:0:65 20:0:6c 30:0:07 end 30\n- the bytes are read as decimal\n{late}"),
        ),
        ("1 0 9", format!("0:0:01 10:0:00 20:0:09 end 20\n- the bytes are read as decimal\n{late}")),
        ("110 145 007", format!("0:0:48 10:0:65 20:0:07 end 20\n- the bytes are read as octal\n{late}")),
        ("01001000 00000111", format!("0:0:48 10:0:07 end 10\n- the bytes are read as binary\n{late}")),
        ("48 6C 65", format!("0:0:48 10:0:6c 20:0:65 end 20\n{late}")),
        ("48 65", format!("0:0:48 10:0:65 end 10\n{unclear}\n{late}")),
        (
            "110 145",
            format!(
                "end 10\n{late}\n! line 2: the bytes may be octal or decimal; print them with format=hex (sigrok-cli -P uart:format=hex)"
            ),
        ),
        (
            "4C 7 65",
            format!(
                "0:0:4c end 0\n{late}\n! line 3: byte 1 (the first is 0) is not hexadecimal; print all bytes with format=hex"
            ),
        ),
        // sigrok's format=ascii prints control characters like this.
        ("1 2 [0D]", format!("end 10\n- skipped other annotations: [0D]\n{late}\n! line 3: {text}")),
        ("H 1 2", format!("end 20\n- skipped other annotations: H\n{late}\n! line 3: {text}")),
    ] {
        assert_eq!(summary(&read_bytes(timed(texts))), format!("Annotations [RX] {expected}"), "{texts}");
    }
    // The user may set the base.
    let wanted = ReadOptions { base: Some(Base::Decimal), ..ReadOptions::default() };
    let read = |text: &str| {
        read_with_options(std::io::Cursor::new(text.to_owned()), &Limits::default(), &wanted, &mut |_| true)
    };
    assert_eq!(summary(&read(&timed("72 65"))), format!("Annotations [RX] 0:0:48 10:0:41 end 10\n{late}"));
    assert_eq!(
        summary(&read("t_us,value\n0,65\n10,173\n")),
        "HexBytes 1/1000000 [bytes] 0:0:41 10:0:ad end 10"
    );
}

#[test]
fn byte_counts_arrows_and_minutes_of_logs_are_not_bytes() {
    let first = |time: &str| {
        format!("\n- the first time is “{time}” and is read as 0; all other times are relative to it")
    };
    let both = "- RX and TX are named as in the log; if the host wrote the log, map RX=TX,TX=RX: the host's TX is the controller's RX";
    let minutes = "- times have no seconds, so all bytes of a minute have the same time";
    check(&[
        // A direction at the end.
        (
            "[12:00:00.1] 55 AA ->\n[12:00:00.2] 01 <-\n",
            &format!(
                "SerialLog 1/10 [TX RX] 0:0:55 0:0:aa 1:1:01 end 1{}\n{both}",
                first("[12:00:00.1] 55 AA ->")
            ),
        ),
        ("0.1: 55 AA TX\n0.2: 01 RX\n", &format!("HexBytes 1/10 [TX RX] 1:0:55 1:0:aa 2:1:01 end 2\n{both}")),
        (
            "t_us,data,dir\n0,55 AA,->\n10,01,<-\n",
            &format!("HexBytes 1/1000000 [TX RX] 0:0:55 0:0:aa 10:1:01 end 10\n{both}"),
        ),
        // Text after bytes is skipped.
        (
            "[12:00:00.1] 2d 3e  ->\n",
            &format!("SerialLog 1/10 [bytes] 0:0:2d 0:0:3e end 0{}", first("[12:00:00.1] 2d 3e  ->")),
        ),
        (
            "55 AA ->\n",
            "HexBytes [] end 0\n! line 1: “55 AA ->” has a direction but no time; use a time on each line, or bytes of one direction only",
        ),
        // Numbers of bytes.
        (
            "12:00:00.5 RX: (02) 41 42\n12:00:00.6 RX (2 bytes): 41 42\n12:00:00.7 RX [10] 00 01 02 03 04 05 06 07 08 09\n\
             12:00:00.8 RX len=1: 41\n",
            &format!(
                "SerialLog 1/10 [RX] 0:0:41 0:0:42 1:0:41 1:0:42 2:0:00 2:0:01 2:0:02 2:0:03 2:0:04 2:0:05 2:0:06 2:0:07 \
                 2:0:08 2:0:09 3:0:41 end 3{}",
                first("12:00:00.5 RX: (02) 41 42")
            ),
        ),
        (
            "12:00:00.5 RX: (04) 41 42\n",
            &format!(
                "SerialLog 1/10 [RX] 0:0:41 0:0:42 end 0{}\n- 1 numbers in brackets differ from the number of bytes in their lines and are skipped",
                first("12:00:00.5 RX: (04) 41 42")
            ),
        ),
        (
            "12:00:00.5 RX 04: 41 42\n",
            &format!(
                "SerialLog 1/10 [] end 0{}\n! line 1: “04:” before “41 42” may be a byte or a byte count; remove it, or write all bytes in one form",
                first("12:00:00.5 RX 04: 41 42")
            ),
        ),
        ("(02) 41 42\n", "HexBytes [bytes] 0:0:41 1:0:42 end 1"),
        (
            "12:00:00.5 [41] [42] [43]\n",
            &format!(
                "SerialLog 1/10 [bytes] 0:0:41 0:0:42 0:0:43 end 0{}",
                first("12:00:00.5 [41] [42] [43]")
            ),
        ),
        // Times without seconds; bytes with colons between them.
        (
            "12:00 41 42\n12:01 43\n",
            &format!("SerialLog 1/1 [bytes] 0:0:41 0:0:42 60:0:43 end 60{}\n{minutes}", first("12:00 41 42")),
        ),
        (
            "[12:00] RX: 41\n",
            &format!("SerialLog 1/1 [RX] 0:0:41 end 0{}\n{minutes}", first("[12:00] RX: 41")),
        ),
        (
            "2026-11-26 12:00 41\n2026-11-26 12:02 42\n",
            &format!(
                "SerialLog 1/1 [bytes] 0:0:41 120:0:42 end 120{}\n{minutes}",
                first("2026-11-26 12:00 41")
            ),
        ),
        (
            "01:02:03\n",
            &format!(
                "SerialLog 1/1 [] end 0{}\n! line 1: the file has no bytes; record again",
                first("01:02:03")
            ),
        ),
        ("12:00\n", "HexBytes [bytes] 0:0:12 1:0:00 end 1"),
        ("12:00 41:42\n", "HexBytes [bytes] 0:0:12 1:0:00 2:0:41 3:0:42 end 3"),
        // Seconds since 1970 count from the first.
        (
            "[1700000000.123] 41\n[1700000000.125] 42\n",
            &format!("SerialLog 1/1000 [bytes] 0:0:41 2:0:42 end 2{}", first("[1700000000.123] 41")),
        ),
        (
            "1700000000.5 RX 41\n1700000001 RX 42\n",
            &format!(
                "HexBytes 1/10 [RX] 0:0:41 end 0{}\n! line 2: “1700000001” is not a byte; use two hexadecimal digits per byte, such as 55 AA 0x01",
                first("1700000000.5 RX 41")
            ),
        ),
    ]);
}

#[test]
fn numbers_next_to_times_are_hexadecimal_only_if_unambiguous() {
    let unclear = "- the bytes may be hexadecimal or decimal and are read as hexadecimal; if they are decimal, name the column dec (t_us,dec)";
    check(&[
        ("t_us,value\n0,65\n10,173\n20,7\n", "HexBytes 1/1000000 [bytes] 0:0:41 10:0:ad 20:0:07 end 20"),
        ("t_us,value\n0,65\n10,AD\n", "HexBytes 1/1000000 [bytes] 0:0:65 10:0:ad end 10"),
        ("t_us,dec\n0,65\n10,66\n", "HexBytes 1/1000000 [bytes] 0:0:41 10:0:42 end 10"),
        ("t_us,hex\n0,65\n10,66\n", "HexBytes 1/1000000 [bytes] 0:0:65 10:0:66 end 10"),
        ("t_us,byte\n0,65\n10,66\n", &format!("HexBytes 1/1000000 [bytes] 0:0:65 10:0:66 end 10\n{unclear}")),
        ("t_us,data\n0,200\n10,66\n", "HexBytes 1/1000000 [bytes] 0:0:c8 10:0:42 end 10"),
        ("time_s,NN\n0.5,4A\n1.0,42\n", "HexBytes 1/10 [bytes] 5:0:4a 10:0:42 end 10"),
        (
            "t_us,dec\n0,65\n10,256\n",
            "HexBytes 1/1000000 [bytes] 0:0:41 end 10\n! line 3: “256” is not a decimal byte; use 0 to 255",
        ),
        ("10,4A\n20,42\n", "HexBytes [bytes] 10:0:4a 20:0:42 end 20"),
        ("10 41\n20 42\n", "HexBytes [bytes] 0:0:10 1:0:41 2:0:20 3:0:42 end 3"),
    ]);
    for text in [
        "t_us,value\n0,0\n10,1\n",
        "10,41\n20,42\n",
        "10;41\n20;42\n",
        "t_us,value\n0,65\n10,66\n",
        "time,NN\n10,41\n20,42\n",
    ] {
        let reading = read_bytes(text);
        assert!(reading.error.is_some() && reading.capture.is_empty(), "{text}: {}", summary(&reading));
    }
}

#[test]
fn hexadecimal_counts_and_bytes_with_colons_are_distinguished() {
    let log = "12:00:00.5 RX [0A] 00 01 02 03 04 05 06 07 08 09\n";
    let bytes = |text: &str| {
        let reading = read_bytes(text);
        assert!(reading.error.is_none(), "{}", summary(&reading));
        reading.capture.bytes.iter().map(|byte| byte.byte).collect::<Vec<_>>()
    };
    assert_eq!(bytes(log), [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]);
    assert_eq!(bytes("01:02:03:04\n05:06:07:08\n"), [1, 2, 3, 4, 5, 6, 7, 8]);
    // Not a number of bytes: it may be a byte.
    assert!(read_bytes("12:00:00.5 RX [0B] 00 01\n").error.is_some());
    // Bits and decimal bytes without classes.
    let bits = "0-9 uart-1: Start bit\n10-19 uart-1: 1\n20-29 uart-1: 0\n10-99 uart-1: 200\n";
    assert!(read_bytes(bits).error.is_some());
}

#[test]
fn times_with_too_many_places_are_rounded_with_a_note() {
    check(&[
        (
            "time_s,STEP\n0,0\n5.000000000000013e-06,1\n0.00001,0\n",
            "LevelsCsv 1/1000000000000000000 [STEP] 0:0 5000000000000:1 10000000000000:0 end 10000000000000\n\
             - times have too many decimal places and are rounded to the nearest 1e-18 s",
        ),
        // 64 bits are 18 s of these units: later times need coarser units.
        (
            "time_s,STEP\n0,0\n0.30000000000000004,1\n2000,0\n",
            "LevelsCsv 1/1000000000000000 [STEP] 0:0 300000000000000:1 2000000000000000000:0 end 2000000000000000000\n\
             - times have too many decimal places and are rounded to the nearest 1e-15 s",
        ),
        // Changes at different times stay separate.
        (
            "time_s,STEP\n0,0\n1e-18,1\n2e-18,0\n2000,1\n",
            "LevelsCsv 1/1000000000000000000 [STEP] 0:0 1:1 2:0 end 2\n! line 5: the time “2000” does not fit into 64 bits; use times relative to the start of the recording",
        ),
        (
            "time_s,STEP\n1700000000.25,0\n1700000000.5,1\n",
            "LevelsCsv 1/100 [STEP] 0:0 25:1 end 25\n- the first time is “1700000000.25” and is read as 0; all other times are relative to it",
        ),
    ]);
}

#[test]
fn positions_in_other_units_than_steps_are_refused() {
    for (name, unit) in [
        ("position_mm", "mm"),
        ("Position [mm]", "mm"),
        ("pos_um", "µm"),
        ("position (µm)", "µm"),
        ("pos_cm", "cm"),
        ("pos_m", "m"),
        ("position_in", "inch"),
        ("pos_inch", "inch"),
        ("Position (inches)", "inch"),
        ("pos [mil]", "mil"),
        ("angle (deg)", "degree"),
        ("position_degrees", "degree"),
        ("angle [rad]", "radian"),
        ("pos_rev", "turn"),
        ("pos_turns", "turn"),
    ] {
        let error = read_bytes(format!("time_s,{name}\n0,0\n1,2\n")).error.expect("it is refused");
        let expected = format!(
            "is in {unit}, not in steps; multiply it by the steps per {unit}, round it, and name it position"
        );
        assert!(error.message.ends_with(&expected), "{error}");
    }
}

#[test]
fn positions_in_steps_are_accepted_and_an_unknown_unit_is_named() {
    for name in ["position", "pos_x", "position_steps", "Position [steps]", "pos (microsteps)", "position []"]
    {
        let reading = read_bytes(format!("time_s,{name}\n0,0\n1,2\n"));
        assert_eq!((reading.capture.positions.len(), reading.error), (2, None), "{name}");
    }
    let error = read_bytes("time_s,Position [furlong]\n0,0\n1,2\n").error.expect("it is refused");
    assert!(
        error.message.starts_with("the column “Position [furlong]” has the unknown unit furlong"),
        "{error}"
    );
    assert!(error.message.ends_with("steps, step, microsteps, microstep, usteps, pulses, counts"), "{error}");
}

#[test]
fn two_sample_rates_in_one_file_are_refused() {
    for (head, other) in [
        ("; libsigrok4DSL\n; Sample rate: 1 MHz\n", "; Sample rate: 250 MHz\n"),
        ("# Sample rate: 1 MHz\n", "\n# Sample rate: 250 MHz\n"),
    ] {
        let error = read_bytes(format!("{head}{other}sample,STEP\n0,0\n5,1\n")).error.expect("it is refused");
        let (lines, first) = (head.lines().count() + other.lines().count(), head.lines().count());
        let expected =
            format!("line {lines}: the sample rate “250 MHz” differs from “1 MHz” in line {first}; ");
        assert!(error.to_string().starts_with(&expected), "{error}");
    }
    let twice = read_bytes("# Sample rate: 1 MHz\n# Sample rate: 1000 kHz\nsample,STEP\n0,0\n5,1\n");
    assert_eq!((twice.error, twice.capture.timebase.map(|base| base.parts())), (None, Some((1, 1_000_000))));
    let sigrok =
        "; CSV generated by libsigrok 0.5.2\n; Samplerate: 1 MHz\n; Samplerate: 2 MHz\nlogic\n0\n1\n";
    let error = read_bytes(sigrok).error.expect("it is refused").to_string();
    assert!(error.starts_with("line 3: the sample rate “2 MHz” differs from “1 MHz” in line 2; "), "{error}");
}
