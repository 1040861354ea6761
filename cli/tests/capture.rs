//! `stepscope capture` in scripts: reports, comparison with a scenario, output scenarios, and questions about
//! incomplete files.

use crate::program::stepscope;
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
};

const MOTION: &str = r#"{ "bus": { "channels": 2 }, "source": { "motion": { "engine": "segments", "axes": [
    { "moves": [ { "cosine": { "distance": { "steps": 400 } } }, { "cosine": { "distance": { "steps": -100 } } } ] },
    { "moves": [ { "constant": { "distance": { "steps": -300 }, "speed": { "steps_s": 5000 } } } ] } ] } } }"#;
const FRAMED: &str = r#"{"line":{"protocol":"framed","address":3}}"#;

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("capture").join(name);
    fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn text(path: &Path) -> String {
    path.display().to_string()
}

fn file(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    fs::write(&path, content).expect("a file");
    text(&path)
}

fn recording(name: &str) -> String {
    text(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/capture/recordings").join(name))
}

fn run(scenario: &str, outputs: &[&str]) -> String {
    let (code, out, err) = stepscope(&[&["run", scenario], outputs].concat(), "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    out
}

fn steps(recording: &str, options: &[&str]) -> Vec<u64> {
    let (code, out, err) = stepscope(&[&["capture", recording, "--steps", "-"], options].concat(), "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let rows = out.lines().skip(1).map(|row| row.split(',').next().and_then(|cycle| cycle.parse().ok()));
    rows.map(|cycle| cycle.expect("a cycle")).collect()
}

fn row(arguments: &[&str], table: &str) -> Value {
    let (_, out, err) = stepscope(&[arguments, &["--json"]].concat(), "");
    let all: Value = serde_json::from_str(&out).expect(&err);
    let rows = all["tables"][table].as_array().expect("a table");
    assert_eq!(rows.len(), 1, "{rows:#?}");
    rows[0].clone()
}

fn us(row: &Value, column: &str) -> f64 {
    row[column].as_f64().expect(column) * 1e6
}

#[test]
fn a_dump_of_a_run_matches_its_plan() {
    let folder = folder("same");
    let (motion, dump) = (file(&folder, "motion.json", MOTION), text(&folder.join("own.vcd")));
    run(&motion, &["--vcd", &dump]);
    for more in [&["--clock", "16000000"][..], &[], &["--channel", "1"]] {
        let (code, out, err) = stepscope(&[&["capture", &dump, "--against", &motion], more].concat(), "");
        assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
        assert!(
            out.contains("channel 0  500 steps: 400 right, 100 left, 1 turn; position 300 (0 to 400)\n"),
            "{out}"
        );
        assert!(
            out.contains("channel 1  300 steps: 0 right, 300 left, 0 turns; position -300 (-300 to 0)\n"),
            "{out}"
        );
        assert!(out.contains("  no step is off by more than 0.06"), "{out}");
    }
}

fn of_trace(line: &str) -> (u64, &str) {
    let (cycle, levels) = line.split_once(' ').expect("two words");
    (u64::from_str_radix(cycle, 16).expect("a cycle"), levels)
}

#[test]
fn names_the_first_late_step() {
    let folder = folder("late");
    let (motion, trace) = (file(&folder, "motion.json", MOTION), text(&folder.join("own.trace")));
    run(&motion, &["--trace", &trace]);
    // From the 124th rise of STEP0, move edges by 100 cycles.
    let own = fs::read_to_string(&trace).expect("a trace");
    let (mut rises, mut was_high) = (0, false);
    let rows = own.lines().map(|line| {
        let (mut cycle, levels) = of_trace(line);
        let is_high = u64::from_str_radix(levels, 16).expect("levels") & 1 == 1;
        rises += u32::from(is_high && !was_high);
        if rises == 124 && (is_high || was_high) {
            cycle += 100;
        }
        was_high = is_high;
        (cycle, levels)
    });
    let mut rows: Vec<(u64, &str)> = rows.collect();
    rows.sort_by_key(|(cycle, _)| *cycle);
    // Changes in between belong to the other channel; one row may have both, so only STEP0 is compared.
    let changed: String = rows.iter().map(|(cycle, levels)| format!("{cycle:x} {levels}\n")).collect();
    let changed = file(&folder, "late.trace", changed);
    let table = text(&folder.join("late.csv"));
    let line = ["capture", &changed, "--sample-rate", "16000000", "--against", &motion];
    let (code, _, err) = stepscope(&[&line[..], &["--late", &table]].concat(), "");
    assert_eq!(code, Some(3), "{err}");
    assert!(err.starts_with("the recording differs from the plan: step 123 is 6.250 us late, at "), "{err}");
    let late = fs::read_to_string(&table).expect("a table");
    let off: Vec<&str> = late.lines().skip(1).filter(|row| !row.contains(",0e0,0,")).collect();
    assert!(
        matches!(off[..], [row] if row.starts_with("123,123,") && row.contains(",6.25e-6,0,")),
        "{off:?}"
    );
    let (code, out, _) = stepscope(&[&line[..], &["--within-us", "7"]].concat(), "");
    assert_eq!(code, Some(0), "{out}");
    // Aligned to the late step, all others differ.
    let (code, _, err) = stepscope(&[&line[..], &["--align", "123"]].concat(), "");
    assert!(
        code == Some(3)
            && err.contains("123 steps off by up to 6.250 us (early) from step 0, at ")
            && err.contains("; 2 differences in all"),
        "{err}"
    );
}

#[test]
fn writes_a_scenario_with_exact_steps() {
    let folder = folder("steps");
    let (motion, dump) = (file(&folder, "motion.json", MOTION), text(&folder.join("own.vcd")));
    let (made, again) = (text(&folder.join("made.json")), text(&folder.join("again.vcd")));
    run(&motion, &["--vcd", &dump]);
    let clock = ["--clock", "16000000"];
    let (code, _, err) = stepscope(&[&["capture", &dump, "--scenario", &made], &clock[..]].concat(), "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    run(&made, &["--vcd", &again]);
    for channel in ["0", "1"] {
        let own = |dump: &str| {
            let of = ["--against", &motion, "--channel", channel];
            steps(dump, &[&of[..], &clock].concat())
        };
        let (recorded, made) = (own(&dump), own(&again));
        assert_eq!(recorded.len(), if channel == "0" { 500 } else { 300 });
        assert_eq!(made, recorded, "channel {channel}");
    }
    // An allowed error takes fewer segments, and no step exceeds it.
    let rough = text(&folder.join("rough.json"));
    let line = ["capture", &dump, "--scenario", &rough, "--error-us", "20", "--clock", "16000000"];
    assert_eq!(stepscope(&line, "").0, Some(0));
    let segments = |path: &str| fs::read_to_string(path).expect("a scenario").matches("\"count\"").count();
    assert!(segments(&rough) * 4 < segments(&made), "{} {}", segments(&rough), segments(&made));
    let compared = row(&["capture", &dump, "--against", &rough, "--within-us", "40"], "comparison");
    assert_eq!(compared["differing"], 0, "{compared:#}");
}

#[test]
fn writes_a_scenario_that_reproduces_a_framed_run() {
    let folder = folder("framed");
    let (framed, dump) = (file(&folder, "framed.json", FRAMED), text(&folder.join("own.vcd")));
    let (made, based) = (text(&folder.join("made.json")), text(&folder.join("based.json")));
    run(&framed, &["--vcd", &dump]);
    let original = run(&framed, &[]);
    let digest = |out: &str| out.lines().next().map(str::to_owned);
    let (code, out, err) = stepscope(&["capture", &dump, "--scenario", &made], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert!(
        out.contains(
            "\nRX: 115200 baud (115180 measured), 482 bytes, 29 frames for address 3 of 1 channel, 0 broken\n"
        ),
        "{out}"
    );
    assert_eq!(digest(&run(&made, &[])), digest(&original));
    let (code, _, err) = stepscope(&["capture", &dump, "--scenario", &based, "--against", &framed], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert_eq!(digest(&run(&based, &[])), digest(&original));
}

/// Expects this message and exit code for an incomplete command line.
fn check_messages(rows: &[(&str, &[&str], i32, &str)]) {
    for (input, options, code, expected) in rows {
        let (found, out, err) = stepscope(&[&["capture", "-"], *options].concat(), input);
        assert_eq!(found, Some(*code), "{options:?}: {out}{err}");
        assert!(err.contains(expected), "{options:?}: {err}");
    }
}

const LEVELS: &str = "STEP,DIR\n0,1\n1,1\n0,1\n0,1\n1,1\n0,1\n";
const DUMP: &str =
    "$timescale 1 us $end $scope module a $end $var wire 1 ! STEP $end $var wire 1 # D $end $upscope $end
$scope module b $end $var wire 1 % D $end $upscope $end $enddefinitions $end
#0 0! 0# 0% #10 1! #12 0! #20 1! #22 0!";

#[test]
fn names_the_option_for_missing_information() {
    let rate = "the file has no sample rate; use its sample rate in Hz";
    check_messages(&[
        (LEVELS, &[], 2, rate),
        (LEVELS, &["--sample-rate", "1000"], 0, ""),
        (
            LEVELS,
            &["--sample-rate", "0"],
            2,
            "'0' for '--sample-rate <HZ>': out of range; use 1 to 1000000000000",
        ),
        (
            "0 700000000\n5 700000001\nff 700000000\n",
            &[],
            2,
            "the file has no clock; use its clock as the sample rate in Hz",
        ),
        ("81 05\n", &[], 2, "the bytes have no times; use a bit rate"),
        ("81 05\n", &["--baud", "115200"], 0, ""),
        ("81 05\n", &["--baud", "0"], 2, "'0' for '--baud <BAUD>': out of range; use 1 to 1000000000"),
        (
            "Time [s],A,B\n0,0,0\n1,1,0\n2,0,1\n",
            &[],
            2,
            "; the channels are A, B; use a map, such as --map STEP0=A,DIR0=B",
        ),
        (DUMP, &["--clock", "5"], 2, "'5' for '--clock <HZ>': out of range; use 11 to 1000000000"),
    ]);
}

#[test]
fn assumes_a_bit_rate_from_byte_times_and_reports_it() {
    for (bytes, baud) in [
        // At least 96 us per byte; two bytes per line every 2 ms; ten bytes per line every ms.
        ("0.001: 81\n0.001096: 05\n0.003: 81\n", "104167"),
        ("0.010: 81 05\n0.012: 82 05\n0.014: 83 05\n", "115200"),
        ("0.010: 00 00 00 00 00 00 00 00 00 00 00 00\n0.011: 82 05\n", "120000"),
    ] {
        let (code, out, err) = stepscope(&["capture", "-"], bytes);
        assert_eq!((code, err.as_str()), (Some(0), ""));
        let expected = format!("{baud} baud is estimated from the times of its bytes; set the actual rate\n");
        assert!(out.contains(&expected) && out.contains(&format!("\nRX: {baud} baud, ")), "{out}");
        let (_, out, _) = stepscope(&["capture", "-", "--baud", "250000"], bytes);
        assert!(!out.contains("note") && out.contains("\nRX: 250000 baud, "), "{out}");
    }
}

#[test]
fn explains_invalid_maps() {
    check_messages(&[
        (DUMP, &["--map", "STEP0=STEP,DIR0=#1"], 0, ""),
        (DUMP, &["--map", "step0=!a.STEP"], 0, ""),
        (DUMP, &["--map", "STEP0"], 2, "--map: \"STEP0\" is not a pair; use SIGNAL=CHANNEL"),
        (DUMP, &["--map", "STEP16=STEP"], 2, "STEP16 is not a signal; use STEP0 to STEP15"),
        (DUMP, &["--map", "STEP0=PUL"], 2, "there is no channel PUL; use one of a.STEP, a.D, b.D"),
        (
            DUMP,
            &["--map", "STEP0=STEP,DIR0=D"],
            2,
            "more than one channel is named D; use its number, #0 for the first",
        ),
        (DUMP, &["--map", "STEP0=STEP,DIR0=STEP"], 2, "channel a.STEP is already STEP0"),
        (DUMP, &["--map", "STEP0=#0,STEP0=#1"], 2, "STEP0 has two channels"),
        (DUMP, &["--map", ""], 2, "no channel has a known signal"),
    ]);
}

#[test]
fn reports_the_readable_part_of_a_truncated_file() {
    let (code, out, err) = stepscope(&["capture", "-"], &format!("{DUMP} #30 1! #32 0"));
    assert_eq!(code, Some(1), "{err}");
    assert!(out.contains("channel 0  3 steps: 3 right"), "{out}");
    assert!(
        err.starts_with("-: the recording is truncated: line 3: ")
            && err.ends_with("; the results cover only the data before that point\n"),
        "{err}"
    );
    let (code, out, err) = stepscope(&["capture", "-"], "a word or two\n");
    assert_eq!((code, out.as_str()), (Some(2), ""));
    assert!(
        err.contains("unknown format, beginning with “a word or two”; use a value change dump (.vcd), "),
        "{err}"
    );
    let (code, _, err) = stepscope(&["capture", "-"], "");
    assert!(code == Some(2) && err.contains("the file is empty"), "{err}");
    let (code, _, err) = stepscope(&["capture", "there-is-no-such-file"], "");
    assert!(code == Some(1) && err.starts_with("there-is-no-such-file: "), "{err}");
    // A bad output is refused before anything is read.
    let dump = file(&folder("outputs"), "own.vcd", DUMP);
    let (code, _, err) = stepscope(&["capture", &dump, "--vcd", &dump], "");
    assert!(code == Some(2) && err.starts_with(&format!("--vcd: {dump} is an input")), "{err}");
}

#[test]
fn reads_its_own_output_files() {
    let folder = folder("files");
    let dump = file(&folder, "own.vcd", DUMP);
    let outputs = ["own.trace", "again.vcd", "own.csv", "bytes.csv"].map(|name| text(&folder.join(name)));
    let [trace, again, csv, bytes] = outputs.each_ref().map(String::as_str);
    let line = ["capture", &dump, "--trace", trace, "--vcd", again, "--csv", csv, "--bytes", bytes];
    assert_eq!(stepscope(&line, "").0, Some(0));
    let own = steps(&dump, &[]);
    assert_eq!(own, [10, 20]);
    let rate = ["--sample-rate", "1000000"];
    assert_eq!([steps(trace, &rate), steps(csv, &rate)], [own.clone(), own.clone()]);
    assert_eq!(steps(again, &["--clock", "1000000"]), own);
    assert_eq!(fs::read_to_string(bytes).expect("a table"), "line,start_cycle,start_s,bytes\n");
    let (_, list, _) = stepscope(&["capture", &dump, "--steps", "-", "--clock", "16000000"], "");
    let (code, out, err) = stepscope(&["tables", "--steps", "-", "--entries", "q16"], &list);
    assert!(code == Some(0) && out.lines().count() > 1, "{out}{err}");
}

#[test]
fn decodes_the_packets_and_replies_of_a_run() {
    let folder = folder("packets");
    let (dump, logged) = (text(&folder.join("own.vcd")), text(&folder.join("logged.csv")));
    let scenario = file(&folder, "framed.json", FRAMED);
    run(&scenario, &["--vcd", &dump, "--packets", &logged]);
    let (code, out, err) = stepscope(&["capture", &dump, "--packets", "-"], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let columns = |table: &str, names: &[&str]| -> Vec<Vec<String>> {
        let head: Vec<&str> = table.lines().next().expect("a head").split(',').collect();
        let places = names.iter().map(|name| head.iter().position(|each| each == name).expect("a column"));
        let places: Vec<usize> = places.collect();
        let row = |row: &str| {
            let cells: Vec<&str> = row.split(',').collect();
            places.iter().map(|place| cells[*place].to_owned()).collect()
        };
        table.lines().skip(1).map(row).collect()
    };
    let logged = fs::read_to_string(logged).expect("the run's table");
    assert_eq!(columns(&out, &["bytes"]), columns(&logged, &["bytes"]));
    let lines = columns(&out, &["kind", "line", "outcome"]);
    assert!(
        lines
            .iter()
            .all(|row| { ["reply TX CRC valid", "frame RX CRC valid"].contains(&row.join(" ").as_str()) }),
        "{lines:?}"
    );
    let replies = lines.iter().filter(|row| row[0] == "reply").count();
    assert!(replies > 5 && replies * 2 == lines.len(), "{replies} of {}", lines.len());
    assert!(out.contains("from 3: "), "{out}");
}

#[test]
fn checks_pulses_against_a_driver() {
    // A DRV8825 needs 1.9 us per level; the pulse at 40 us has 1 us.
    let short = DUMP.replace("#20 1!", "#20 1! #21 0!");
    let (code, out, err) = stepscope(&["capture", "-", "--driver", "drv8825", "--strict"], &short);
    assert!(code == Some(3) && err.contains("violation"), "{out}{err}");
    let (code, out, err) = stepscope(&["capture", "-", "--driver", "drv8825", "--strict"], DUMP);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
    let (code, _, err) = stepscope(&["capture", "-", "--timing"], DUMP);
    assert!(code == Some(2) && err.contains("the scenario has no driver"), "{err}");
}

fn dump_of(timescale: &str, interval: u64, width: u64) -> String {
    let head = format!(
        "$timescale {timescale} $end $var wire 1 ! STEP $end $var wire 1 d DIR $end $enddefinitions $end #0 0! 1d"
    );
    (1..=20).fold(head, |text, k| text + &format!(" #{} 1! #{} 0!", k * interval, k * interval + width))
}

#[test]
fn handles_timescales_without_a_whole_frequency_exactly() {
    for (timescale, interval, width, clock_hz, interval_s, high_ns, violations) in [
        ("83 ns", 120, 12, 1_000_000_000_u64, 9.96e-6, 996.0, 20),
        ("41667 ps", 240, 5, 1_000_000_000, 10.00008e-6, 208.3, 20),
        ("6666ps", 1000, 3, 1_000_000_000, 6.666e-6, 20.0, 20),
        // Exactly the driver's 1000 ns, and a tick less.
        ("250 ps", 40_000, 4000, 1_000_000_000, 10e-6, 1000.0, 0),
        ("125 ns", 80, 8, 8_000_000, 10e-6, 1000.0, 0),
        ("125 ns", 80, 7, 8_000_000, 10e-6, 875.0, 20),
        // 3.5 us is not a whole frequency, but whole cycles of 2 MHz.
        ("3500 ns", 100, 2, 2_000_000, 350e-6, 7000.0, 0),
        ("30 us", 100, 2, 100_000, 3e-3, 60_000.0, 0),
    ] {
        let dump = dump_of(timescale, interval, width);
        let (code, out, err) = stepscope(&["capture", "-", "--driver", "a4988", "--strict", "--json"], &dump);
        assert_eq!(code, Some(if violations > 0 { 3 } else { 0 }), "{timescale}: {err}");
        let all: Value = serde_json::from_str(&out).expect("JSON");
        let (file, steps, high) = (
            &all["tables"]["recording"][0],
            &all["tables"]["steps"][0],
            &all["tables"]["timing"].as_array().expect("rules")[0],
        );
        assert_eq!((&file["clock_hz"], &steps["steps"]), (&clock_hz.into(), &20.into()), "{timescale}");
        for name in ["shortest_interval_s", "longest_interval_s"] {
            let found = steps[name].as_f64().expect("a number");
            assert!((found / interval_s - 1.0).abs() < 1e-9, "{timescale} {name} {found}");
        }
        assert_eq!(steps["greatest_acceleration_steps_s2"], 0.0, "{timescale}");
        assert!((high["least_ns"].as_f64().expect("a number") - high_ns).abs() < 0.5, "{timescale} {high}");
        assert_eq!(high["violations"], violations, "{timescale}");
        let is_exact = file["rounding"].as_str().expect("text").contains("nothing is rounded");
        assert_eq!(is_exact, !timescale.ends_with("ps") || timescale == "250 ps", "{timescale}");
    }
}

#[test]
fn compares_limits_in_the_ticks_of_the_file() {
    let limit = "custom:step_high_ns=1000,step_low_ns=9000";
    // 100 ps has no whole clock up to 1 GHz: 999.9 ns would become 1000 cycles.
    for (interval, width, rule, least_ns) in [
        (100_001, 10_000, None, 1000.0),
        (100_001, 9999, Some("step_high"), 999.9),
        (99_999, 10_000, Some("step_low"), 8999.9),
    ] {
        let dump = dump_of("100 ps", interval, width);
        let line = ["capture", "-", "--driver", limit, "--strict", "--json"];
        let (code, out, err) = stepscope(&line, &dump);
        assert_eq!(code, Some(if rule.is_some() { 3 } else { 0 }), "{err}");
        let all: Value = serde_json::from_str(&out).expect("JSON");
        let timing = all["tables"]["timing"].as_array().expect("rules");
        let of = |name: &str| timing.iter().find(|row| row["rule"] == name).expect(name);
        assert_eq!(of(rule.unwrap_or("step_high"))["least_ns"], least_ns);
        let first = &all["tables"]["violations"][0];
        assert_eq!(first["rule"].as_str(), rule);
        if rule.is_some() {
            assert!(first["measured_cycles"].as_u64() < first["required_cycles"].as_u64(), "{first}");
        }
        let slow = [&line[..], &["--clock", "16000000"]].concat();
        assert_eq!(stepscope(&slow, &dump).0, code);
    }
}

#[test]
fn rounding_noise_of_floats_causes_no_violation() {
    let mut table = "time_s,STEP\n".to_owned();
    for k in 1..500_u32 {
        let rise = f64::from(k) * 5e-6;
        table += &format!("{rise:e},1\n{:e},0\n", rise + 1e-6);
    }
    let line = ["capture", "-", "--driver", "custom:step_high_ns=1000", "--strict"];
    let (code, out, err) = stepscope(&line, &table);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
}

#[test]
fn reports_rounding_to_a_slower_clock_without_violations() {
    // 1900 ns, as a DRV8825 needs, are 30.4 cycles of 16 MHz: some pulses become 30 cycles.
    let dump = dump_of("100 ns", 1003, 19);
    let line = ["capture", "-", "--driver", "drv8825", "--strict", "--clock", "16000000"];
    let (code, out, err) = stepscope(&line, &dump);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{out}");
    assert!(out.contains("times are rounded to the nearest cycle, by half a cycle at most"), "{out}");
    let (code, out, _) = stepscope(&line, &dump_of("100 ns", 1003, 18));
    assert!(code == Some(3) && out.contains("violations 20"), "{out}");
}

#[test]
fn a_strict_check_needs_steps() {
    let still = "$timescale 1 ns $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 0!";
    for (input, map) in [(still, "STEP0=STEP"), (DUMP, "EN=#0")] {
        let line = ["capture", "-", "--driver", "a4988", "--map", map];
        let (code, _, err) = stepscope(&[&line[..], &["--strict"]].concat(), input);
        assert!(code == Some(3) && err.contains("--strict: the recording has no steps"), "{err}");
        let (code, _, err) = stepscope(&line, input);
        assert_eq!((code, err.as_str()), (Some(0), ""));
    }
}

#[test]
fn json_has_the_documented_tables() {
    let (code, out, err) = stepscope(&["capture", "-", "--json"], DUMP);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let all: Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(all["command"], "capture");
    let tables = all["tables"].as_object().expect("tables");
    let names: Vec<&str> = tables.keys().map(String::as_str).collect();
    assert_eq!(names, ["channels", "comparison", "events", "lines", "notes", "recording", "steps"]);
    assert_eq!(tables["recording"][0]["map"], "STEP0=a.STEP");
    assert_eq!(
        (&tables["recording"][0]["count"], &tables["recording"][0]["map_proposed"]),
        (&5.into(), &true.into())
    );
    assert_eq!(tables["channels"].as_array().map(Vec::len), Some(3));
    assert_eq!(
        (&tables["steps"][0]["steps"], &tables["steps"][0]["greatest_rate_steps_s"]),
        (&2.into(), &1e5.into())
    );
    assert_eq!(tables["comparison"], Value::Array(Vec::new()));
    let names = |with: &[&str]| {
        let (_, out, _) = stepscope(&[&["capture", "-", "--json"], with].concat(), DUMP);
        let all: Value = serde_json::from_str(&out).expect("JSON");
        all["tables"].as_object().expect("tables").keys().cloned().collect::<Vec<_>>()
    };
    assert!(names(&["--driver", "a4988"]).ends_with(&["timing".to_owned(), "violations".to_owned()]));
}

/// The numbers of core/capture/recordings/README.md.
#[test]
fn the_step_table_recording_has_the_jitter_of_its_readme() {
    let (dump, plan) = (recording("step-table.vcd"), recording("step-table.json"));
    let line = ["capture", &dump, "--clock", "16000000", "--against", &plan];
    let found = row(&line, "comparison");
    assert_eq!((&found["recorded"], &found["compared"]), (&800.into(), &800.into()));
    assert_eq!((&found["largest_index"], &found["first_difference_index"]), (&589.into(), &84.into()));
    let cycles = |column| us(&found, column) * 16.0;
    assert_eq!(cycles("largest_late_s").round(), 113.0);
    assert_eq!((cycles("rms_s") * 10.0).round(), 180.0);
    assert_eq!((cycles("mean_s") * 10.0).round(), 43.0);
    assert!(found["drift_ppm"].as_f64().is_some_and(|drift| drift.abs() < 0.1), "{found:#}");
    // 42 steps were due while interrupts were disabled: at least 17 cycles late.
    let late_steps = row(&[&line[..], &["--within-us", "1"]].concat(), "comparison");
    assert_eq!(late_steps["differing"], 42);
    // The first step is 655 cycles later than in the scenario's run.
    assert_eq!(cycles("offset_s").round(), 655.0);
}

#[test]
fn the_late_packet_recording_has_the_gap_of_its_readme() {
    let folder = folder("packet");
    let (session, plan) = (recording("late-packet.sr"), recording("late-packet.json"));
    let line = ["capture", &session, "--against", &plan];
    let (code, out, err) = stepscope(&line, "");
    assert_eq!(code, Some(3), "{err}");
    // BUSY is no signal.
    assert!(out.contains("\nmap       RX=RX   (proposed; --map sets another)\n"), "{out}");
    assert!(
        out.contains("\nRX: 250000 baud (250285 measured), 120 bytes, raw packets of 2 bytes\n"),
        "{out}"
    );
    // Both bytes of packet 24 are 1.484 ms late and equal the scenario's.
    let found = row(&line, "comparison");
    assert_eq!((&found["compares"], &found["recorded"]), (&"bytes".into(), &120.into()));
    assert_eq!((&found["differing"], &found["first_difference_index"]), (&2.into(), &48.into()));
    assert_eq!((us(&found, "largest_late_s").round(), &found["other_values"]), (1484.0, &0.into()));
    // Start times in samples of 10 MHz.
    let (_, table, _) = stepscope(&["capture", &session, "--bytes", "-"], "");
    let starts: Vec<u64> = table
        .lines()
        .skip(1)
        .step_by(2)
        .map(|row| row.split(',').nth(1).and_then(|cycle| cycle.parse().ok()).expect("a cycle"))
        .collect();
    assert_eq!(starts.len(), 60);
    let late: Vec<u64> =
        (0..).zip(&starts).map(|(packet, start)| start - starts[0] - 20_000 * packet).collect();
    assert_eq!(late[24], 14_838);
    assert!((0..60).filter(|packet| *packet != 24).all(|packet| late[packet] <= 1), "{late:?}");
    // In the output scenario the controller makes all steps and ends later.
    let made = text(&folder.join("made.json"));
    let line = ["capture", &session, "--scenario", &made, "--against", &plan];
    assert_eq!(stepscope(&line, "").0, Some(3));
    let cycles = |out: &str| -> u64 {
        let line = out.lines().find_map(|line| line.strip_prefix("cycles "));
        line.and_then(|cycles| cycles.parse().ok()).expect("cycles")
    };
    let (planned, replayed) = (run(&plan, &[]), run(&made, &[]));
    assert!(replayed.contains("positions 1600"), "{replayed}");
    assert!((23_000..31_000).contains(&(cycles(&replayed) - cycles(&planned))), "{planned}{replayed}");
}

#[test]
fn checks_recorded_steps_against_a_known_motor() {
    let report = |options: &[&str]| {
        let (_, out, err) = stepscope(&[&["capture", "recorded-step-table"], options].concat(), "");
        assert!(!err.contains("error"), "{err}");
        out
    };
    assert!(!report(&[]).contains("torque"));
    let named = report(&["--motor", "nema-8"]);
    assert!(
        named.contains("\ntorque\nchannel 0: the scenario has no motion") && named.contains("enough torque"),
        "{named}"
    );
    // The scenario has a motor with its own microsteps.
    let model = r#"{"source":{"motion":{"axes":[{"motor":{"load_torque_mn_m":1000},"mechanics":{"rotary":{"microsteps":1}}}]}}}"#;
    let model = file(&folder("torque"), "model.json", model);
    let compared = report(&["--against", &model, "--json"]);
    let compared: Value = serde_json::from_str(&compared).expect("JSON");
    let row = &compared["tables"]["torque"][0];
    assert!(row["axis"] == 0 && row["enough"] == false && row["load_mn_m"] == 1000.0, "{row}");
    assert_eq!(compared["tables"]["shortages"][0]["axis"], 0);
}

/// A recording of the default motion in which `edit` replaces each step (index, cycle of 16 MHz) by any number of
/// steps.
fn edited(folder: &Path, name: &str, edit: impl Fn(usize, u64) -> Vec<(u64, bool)>) -> (String, String) {
    let (plan, trace) = (file(folder, "plan.json", "{}"), text(&folder.join("plan.trace")));
    run(&plan, &["--trace", &trace]);
    let cycles = steps(&trace, &["--sample-rate", "16000000"]);
    assert_eq!(cycles.len(), 3200);
    let mut dump = String::from(
        "$timescale 1 ps $end $var wire 1 s STEP $end $var wire 1 d DIR $end $enddefinitions $end\n",
    );
    let mut was = true;
    dump.push_str("#0 0s 1d\n");
    for (cycle, right) in cycles.iter().enumerate().flat_map(|(index, cycle)| edit(index, *cycle)) {
        let ps = cycle * 62_500;
        if right != was {
            dump.push_str(&format!("#{} {}d\n", ps - 1_000_000, u8::from(right)));
            was = right;
        }
        dump.push_str(&format!("#{ps} 1s\n#{} 0s\n", ps + 2_000_000));
    }
    (plan, file(folder, name, dump))
}

#[test]
fn lists_missing_extra_and_reversed_steps() {
    let folder = folder("events");
    let (plan, lacks) =
        edited(&folder, "lacks.vcd", |k, at| if k == 2000 { Vec::new() } else { vec![(at, true)] });
    let table = text(&folder.join("late.csv"));
    let (code, out, err) = stepscope(&["capture", &lacks, "--against", &plan, "--late", &table], "");
    assert_eq!(code, Some(3), "{out}{err}");
    assert_eq!(err, "the recording differs from the plan: 1 step missing after step 1999, at 225.6 ms\n");
    for expected in [
        "compared with the plan: 3199 steps recorded, 3200 planned, 3199 in both, 1 missing, 0 extra\n",
        "  late: maximum 0.000 us",
        "  drift 0.00 ppm; jitter maximum 0.000 us",
        "\n  1 step missing after step 1999, at 225.6 ms\n",
    ] {
        assert!(out.contains(expected), "{expected}: {out}");
    }
    let late = fs::read_to_string(&table).expect("a table");
    assert_eq!(
        late.lines().filter(|row| row.ends_with(",missing")).collect::<Vec<_>>(),
        ["2000,,,,,missing"]
    );
    assert!(late.lines().any(|row| row.starts_with("2001,2000,")), "{late}");
    let event = row(&["capture", &lacks, "--against", &plan], "events");
    assert_eq!(
        (&event["what"], &event["step"], &event["count"]),
        (&"missing".into(), &2000.into(), &1.into())
    );

    let (plan, several) = edited(&folder, "several.vcd", |k, at| match k {
        0 | 3150.. => Vec::new(),
        700 => vec![(at, true), (at + 500, true)],
        1500..1540 => vec![(at, false)],
        _ => vec![(at + if k == 2500 { 400 } else { 0 }, true)],
    });
    let (code, out, err) = stepscope(&["capture", &several, "--against", &plan, "--within-us", "20"], "");
    assert_eq!(code, Some(3), "{out}{err}");
    let rows: Vec<&str> = out.lines().skip_while(|row| !row.contains("before the first")).collect();
    let begin = [
        "  1 step missing before the first recorded step, at ",
        "  1 extra step after step 700, at ",
        "  40 steps in the wrong direction from step 1500, at ",
        "  step 2500 is 25.000 us late, at ",
        "  50 steps missing after step 3149, at ",
    ];
    assert!(rows.len() == 5 && rows.iter().zip(begin).all(|(row, begin)| row.starts_with(begin)), "{out}");
    assert!(err.ends_with("; 5 differences in all\n"), "{err}");
}

#[test]
fn a_delay_of_exactly_the_tolerance_is_no_difference() {
    let folder = folder("exactly");
    let (plan, late) =
        edited(&folder, "late.vcd", |k, at| vec![(at + if k == 2500 { 320 } else { 0 }, true)]);
    for (within, code) in [("20", 0), ("20.0", 0), ("2e1", 0), ("19.999999999999", 3), ("0", 3)] {
        let line = ["capture", &late, "--against", &plan, "--within-us", within];
        assert_eq!(stepscope(&line, "").0, Some(code), "{within}");
    }
    for within in ["NaN", "inf", "-1", "1e999", "20us", ""] {
        let line = ["capture", &late, "--against", &plan, "--within-us", within];
        let (code, _, err) = stepscope(&line, "");
        assert_eq!(code, Some(2), "{within}: {err}");
        assert!(err.contains("--within-us") && err.contains("use 0 to 1000000000 microseconds"), "{err}");
    }
    let (code, _, err) = stepscope(&["capture", &late, "--scenario", "-", "--error-us", "-1"], "");
    assert!(code == Some(2) && err.contains("out of range; use 0 to 1000000000 microseconds"), "{err}");
}

#[test]
fn custom_timing_limits_need_no_scenario() {
    let folder = folder("limits");
    // A step generator changes DIR while STEP may follow too soon: twice 0.5 ms, once 10 ms before a step.
    let dump = file(
        &folder,
        "stepgen.vcd",
        "$timescale 1 us $end $var wire 1 s step $end $var wire 1 d dir $end $enddefinitions $end
#0 0s 0d\n#20000 1s\n#21000 0s\n#24000 1s\n#25000 0s\n#25500 1d\n#26000 1s\n#27000 0s\n#30000 1s\n#31000 0s
#34000 0d\n#44000 1s\n#45000 0s\n",
    );
    let nested = r#"{"driver_timing":{"rules":{"dir_setup_ns":10000000}}}"#;
    let files = [
        file(&folder, "whole.json", nested),
        file(&folder, "rules.json", r#"{"rules":{"dir_setup_ns":10000000}}"#),
        file(&folder, "plain.json", r#"{"dir_setup_ns":10000000}"#),
    ];
    let given = ["custom:dir_setup_ns=10000000", "custom:dir_setup_ns=10000000, dir_hold_ns=0"];
    for driver in files.iter().map(String::as_str).chain(given) {
        let (code, out, err) = stepscope(&["capture", &dump, "--driver", driver, "--strict"], "");
        assert_eq!(
            (code, err.as_str()),
            (Some(3), "--strict: 2 violations of the driver's timing\n"),
            "{driver}: {out}"
        );
        assert!(out.contains("dir_setup       10000000       500000     -9500000"), "{out}");
        let (code, _, err) = stepscope(&["capture", &dump, "--driver", driver, "--timing"], "");
        assert_eq!((code, err.as_str()), (Some(0), ""), "{driver}");
    }
    for driver in ["custom:step_us=1", "custom:step_high_ns", "custom:", "custom:dir_hold_ns=-1"] {
        let (code, _, err) = stepscope(&["capture", &dump, "--driver", driver], "");
        assert_eq!(code, Some(2), "{driver}: {err}");
        assert!(
            err.contains("use step_high_ns, step_low_ns, dir_setup_ns, dir_hold_ns, enable_wake_ns"),
            "{driver}: {err}"
        );
    }
    for (driver, expected) in [
        (
            "custom:step=1",
            "--driver: custom:step=1: unknown limit step; a similar name is step_low_ns; use step_high_ns,",
        ),
        (
            "custom:dir_hold_ns=2000000000",
            "dir_hold_ns=2000000000: dir_hold_ns: 2000000000 ns is out of range; use 0 to",
        ),
    ] {
        let (code, _, err) = stepscope(&["run", "framed-link", "--driver", driver], "");
        assert!(code == Some(2) && err.contains(expected), "{err}");
    }
    let (code, _, err) = stepscope(&["run", "framed-link", "--driver", "nonesuch"], "");
    assert!(code == Some(2) && err.contains("use one of a4988, a4979, drv8825"), "{err}");
    // Its pulses have 2500 ns.
    for (limit, expected) in [(2500, 0), (2501, 3)] {
        let driver = format!("custom:step_high_ns={limit}");
        let (code, out, _) = stepscope(&["run", "framed-link", "--driver", &driver, "--strict"], "");
        assert_eq!(code, Some(expected), "{driver}: {out}");
        assert!(out.contains(&format!("step_high           {limit}         2500 ")), "{out}");
    }
    assert!(stepscope(&["drivers"], "").1.contains("--driver custom:step_high_ns="));
}
