//! Lines with several controllers, replies and noise: status, packet table, and the exported line.

use std::{fs, path::PathBuf, process::Command};

/// Three controllers, one of them idle, on a line with all kinds of faults.
const NOISY: &str = r#"{
    "bus": { "channels": 2 },
    "line": { "baud": 230400, "protocol": "framed", "address": 5, "host": { "attempts": 100 },
        "glitches": [ { "start_cycle": 400000, "length_cycles": 3000, "level": 0 } ],
        "noise": { "seed": 11, "flipped_bits_ppm": 1000, "lost_bytes_ppm": 5000, "duplicated_bytes_ppm": 5000,
            "glitches_ppm": 10000, "lost_replies_ppm": 100000, "host_crashes_ppm": 50000 } },
    "source": { "motion": { "axes": [
        { "moves": [ { "constant": { "distance": { "steps": 60 }, "speed": { "steps_s": 1000 } } } ] },
        { "moves": [ { "constant": { "distance": { "steps": -30 }, "speed": { "steps_s": 700 } } } ] } ] } },
    "controllers": [
        { "address": 9 },
        { "address": 7, "receiver_baud": 228000, "bus": { "step_period_cycles": 400 }, "axes": [
            { "moves": [ { "constant": { "distance": { "steps": -40 }, "speed": { "steps_s": 1000 } } } ] } ] } ] }"#;

fn stepscope(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_stepscope")).args(arguments).output().expect("the command starts");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn file(name: &str) -> String {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name).display().to_string()
}

fn scenario(name: &str, json: &str) -> String {
    let path = file(name);
    fs::write(&path, json).expect("a file");
    path
}

fn out(arguments: &[&str]) -> String {
    let (code, out, err) = stepscope(arguments);
    assert_eq!((code, err.as_str()), (Some(0), ""), "{arguments:?}");
    out
}

#[test]
fn each_controller_has_its_digest_status_and_files() {
    let scenario = scenario("controllers.json", NOISY);
    let digests = out(&["run", &scenario, "--digest"]);
    let digests: Vec<&str> = digests.lines().collect();
    assert_eq!(digests.len(), 3);
    for (index, digest) in digests.iter().enumerate() {
        let k = index.to_string();
        assert_eq!(out(&["run", &scenario, "--controller", &k, "--digest"]).trim(), *digest);
        let trace = file("controller.trace");
        assert_eq!(out(&["run", &scenario, "--controller", &k, "--trace", &trace]), "");
        let records = fs::read_to_string(&trace).expect("a trace").lines().count();
        let status = out(&["run", &scenario, "--controller", &k]);
        let lines: Vec<&str> = status.lines().collect();
        assert_eq!(lines[0], format!("digest {digest}"));
        assert_eq!(lines[2], format!("records {records}"), "the file is that controller's");
    }
    let status = out(&["run", &scenario]);
    let lines: Vec<&str> = status.lines().filter(|line| !line.starts_with("records ")).collect();
    assert_eq!(lines[..3], digests.iter().map(|digest| format!("digest {digest}")).collect::<Vec<_>>());
    let block = |from: usize| lines[from..from + 6].to_vec();
    assert_eq!((block(4)[0], block(4)[2], block(4)[5]), ("controller 0", "positions 60 -30", "host done"));
    assert_eq!((block(10)[0], block(10)[2]), ("controller 1", "positions 0"));
    // The host sends nothing to controller 1, which has no commands.
    assert!(block(10)[4].starts_with("state READY"), "{status}");
    assert_eq!((block(15)[0], block(15)[2], block(15)[5]), ("controller 2", "positions -40", "host done"));
    assert!(lines[21].starts_with("frames ") && lines[22].starts_with("line_load "), "{status}");
    assert_eq!(lines.len(), 23);
}

#[test]
fn rejects_a_controller_out_of_range() {
    let (several, one) = (scenario("three.json", NOISY), scenario("one.json", "{}"));
    for (path, given, expected) in
        [(&several, "3", "use --controller 0 to 2"), (&one, "1", "the scenario has only controller 0")]
    {
        let (code, out, err) = stepscope(&["run", path, "--controller", given]);
        assert_eq!((code, out.as_str()), (Some(2), ""));
        assert!(err.contains(expected), "{err}");
    }
}

#[test]
fn reports_why_a_host_gave_up_and_its_progress() {
    let json = r#"{ "line": { "protocol": "framed", "receiver_baud": 100000 } }"#;
    let status = out(&["run", &scenario("deaf.json", json)]);
    assert!(status.contains("ticks_done 0\n") && status.contains("\nhost given up: no reply\n"), "{status}");
    assert!(status.contains("\nframes 10 repeated 9 replies 0 "), "{status}");
}

/// The exported line includes the noise and needs no host or motion.
#[test]
fn a_run_of_an_exported_noisy_line_has_the_same_traces() {
    let raw = r#"{ "bus": { "channels": 2 }, "line": { "address": 3,
            "glitches": [ { "start_cycle": 90000, "length_cycles": 90000, "level": 1 } ],
            "noise": { "seed": 5, "flipped_bits_ppm": 5000, "lost_bytes_ppm": 20000,
                "duplicated_bytes_ppm": 20000, "glitches_ppm": 50000, "host_crashes_ppm": 50000 } },
        "controllers": [ { "address": 4, "bus": { "channels": 2 } } ] }"#;
    let cut = NOISY.replacen("\"bus\"", "\"run_cycles\": 500000, \"bus\"", 1);
    for (title, json) in [("framed", NOISY), ("raw", raw), ("cut", &cut)] {
        let scenario = scenario(&format!("{title}.json"), json);
        let line = file(&format!("{title}-line.json"));
        assert_eq!(out(&["run", &scenario, "--line", &line]), "");
        assert_eq!(out(&["run", &line, "--digest"]), out(&["run", &scenario, "--digest"]), "{title}");
        let written: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(&line).expect("the line")).expect("JSON");
        let forced = written["line"]["glitches"].as_array().map_or(0, Vec::len);
        assert!(forced > 1, "{title}: noise forced something");
        assert!(written["source"]["line"]["sends"].as_array().is_some_and(|sends| sends.len() > 5));
        // Exporting it again gives the same.
        let again = file(&format!("{title}-again.json"));
        assert_eq!(out(&["run", &line, "--line", &again]), "");
        assert_eq!(fs::read(&again).expect("the line"), fs::read(&line).expect("the line"), "{title}");
    }
}

#[test]
fn the_packet_table_is_valid_csv() {
    let (scenario, table) = (scenario("table.json", NOISY), file("table.csv"));
    out(&["run", &scenario, "--packets", &table]);
    let mut reader = csv::Reader::from_path(&table).expect("a table");
    let head: Vec<String> = reader.headers().expect("a head").iter().map(str::to_owned).collect();
    let columns = "start_cycle,end_cycle,bytes,outcome,tick_start_cycle,tick_end_cycle,kind,\
                   number,start_s,end_s,gap_s,meaning,tick_start_s,tick_end_s";
    assert_eq!(head.join(","), columns);
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("its fields")).collect();
    let with_commas = rows.iter().filter(|row| row[3].starts_with("ACK TICKS: ") && row[3].contains(", "));
    assert!(with_commas.count() > 0);
    for row in &rows {
        let (start, end): (u64, u64) = (row[0].parse().expect("a cycle"), row[1].parse().expect("a cycle"));
        assert!(start <= end && row[2].bytes().all(|digit| digit.is_ascii_hexdigit()), "{row:?}");
    }
}

/// A shared line has replies of other controllers; a table that is sent again omits them.
#[test]
fn rereads_only_the_packets_of_the_host() {
    let preset = stepscope_core::scenario::presets::PRESETS.iter();
    let preset = preset.into_iter().find(|preset| preset.id == "four-controllers-framed").expect("a preset");
    let path = scenario("shared.json", preset.json);
    let (table, line) = (file("shared.csv"), file("shared-line.json"));
    assert_eq!(out(&["run", &path, "--packets", &table, "--line", &line]), "");
    let text = fs::read_to_string(&table).expect("the table");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let kinds: Vec<String> = reader.records().map(|row| row.expect("a row")[6].to_owned()).collect();
    let of = |kind: &str| kinds.iter().filter(|each| *each == kind).count();
    assert_eq!(of("frame") + of("reply"), kinds.len());
    let script = stepscope_core::scenario::LineScript::recorded(&text, preset.scenario().clock_hz);
    let sends = script.expect("a table").sends;
    let written = fs::read_to_string(&line).expect("the line");
    let sent = stepscope_core::scenario::Scenario::from_json(&written).expect("a scenario").source;
    let stepscope_core::scenario::Source::Line(sent) = sent else { unreachable!("a line script") };
    assert_eq!(of("frame"), sent.sends.len());
    assert_eq!(sends, sent.sends);
}

#[test]
fn a_run_prints_progress_on_request() {
    let scenario = scenario("progress.json", NOISY);
    let (code, out, err) = stepscope(&["run", &scenario, "--digest", "--progress"]);
    assert_eq!(code, Some(0));
    let lines: Vec<&str> = err.lines().collect();
    let [.., percent, sum] = lines[..] else { panic!("{err}") };
    assert!(percent == "run: 100 %" && sum.starts_with("run: ") && sum.contains(" records, "), "{err}");
    assert_eq!(out.lines().count(), 3);
}
