//! The files that `stepscope run` writes, links and presets.

use std::{fs, path::PathBuf, process::Command};
use stepscope_core::scenario::presets::{
    CONTROLLER_PLANT_PRESETS, CONTROLLER_PRESETS, PLANT_PRESETS, PRESETS,
};

fn stepscope(arguments: &[&str]) -> (Option<i32>, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_stepscope")).args(arguments).output().expect("the command starts");
    (output.status.code(), String::from_utf8(output.stdout).expect("text"))
}

fn file(name: &str) -> (PathBuf, String) {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let text = path.display().to_string();
    (path, text)
}

fn preset(id: &str, name: &str) -> String {
    let (path, text) = file(name);
    fs::write(path, stepscope(&["presets", id]).1).expect("a file");
    text
}

#[test]
fn a_run_of_the_exported_line_has_the_same_trace() {
    let ids =
        ["song-2021-plateau", "patent-2019-sixteen-motors", "glitches-and-breaks", "sonobe-2011-segments"];
    for id in ids {
        let scenario = preset(id, &format!("{id}.json"));
        let (_, line) = file(&format!("{id}-line.json"));
        assert_eq!(stepscope(&["run", &scenario, "--line", &line]), (Some(0), String::new()), "{id}");
        let digest = stepscope(&["run", &scenario, "--digest"]);
        assert_eq!(stepscope(&["run", &line, "--digest"]), digest, "{id}");
    }
}

#[test]
fn a_link_opens_as_its_scenario() {
    let scenario = preset("sonobe-2011-table", "linked.json");
    let (code, link) = stepscope(&["run", &scenario, "--link"]);
    assert_eq!(code, Some(0));
    let address = format!("http://127.0.0.1:8080/{}", link.trim());
    let (path, opened) = file("opened.json");
    fs::write(path, stepscope(&["open", &address]).1).expect("a file");
    assert_eq!(stepscope(&["run", &opened, "--digest"]), stepscope(&["run", &scenario, "--digest"]));
    assert_eq!(stepscope(&["open", "c=1.j"]), (Some(2), String::new()));
}

fn stderr_of(arguments: &[&str]) -> (Option<i32>, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_stepscope")).args(arguments).output().expect("the command starts");
    (output.status.code(), String::from_utf8(output.stderr).expect("text"))
}

#[test]
fn verifies_a_link_and_locates_the_first_difference() {
    let scenario = preset("sonobe-2011-table", "verified.json");
    let link = stepscope(&["run", &scenario, "--link"]).1.trim().to_owned();
    let digest = stepscope(&["run", &scenario, "--digest"]).1;
    let (code, err) = stderr_of(&["open", &link, "--verify"]);
    assert_eq!(code, Some(0));
    assert!(err.starts_with("identical to the sender's run: ") && err.contains(digest.trim()), "{err}");

    // Another scenario with this one's digests.
    let other = preset("song-2021-plateau", "verified-other.json");
    let other = stepscope(&["run", &other, "--link"]).1;
    let (foreign, _) = other.split_once("&d=").expect("digests");
    let (own, digests) = link.split_once("&d=").expect("digests");
    let (code, err) = stderr_of(&["open", &format!("{foreign}&d={digests}"), "--verify"]);
    assert_eq!(code, Some(3));
    assert!(
        err.starts_with("the run differs from the sender's: the first difference is between edge "),
        "{err}"
    );

    let (code, err) = stderr_of(&["open", own, "--verify"]);
    assert!(code == Some(2) && err.contains("no d= part"), "{err}");
    let (code, err) = stderr_of(&["open", &link[..link.len() - 1], "--verify"]);
    assert!(code == Some(2) && err.contains("cut short"), "{err}");
    assert_eq!(stderr_of(&["open", &link[..link.len() - 1]]), (Some(0), String::new()), "it still opens");

    // The digests of one controller do not fit a scenario of several.
    let several = preset("four-controllers-framed", "verified-several.json");
    let link = stepscope(&["run", &several, "--link"]).1;
    assert_eq!(stderr_of(&["open", link.trim(), "--verify"]).0, Some(0));
    let (scenario, _) = link.split_once("&d=").expect("digests");
    let (code, err) = stderr_of(&["open", &format!("{scenario}&d={digests}"), "--verify"]);
    assert!(code == Some(3) && err.starts_with("the link has digests of 1 controllers, but"), "{err}");
}

#[test]
fn tables_have_a_row_for_each_record_and_each_packet() {
    let scenario = preset("patent-2019-addressed", "tables.json");
    let (csv_path, csv) = file("signals.csv");
    let (packets_path, packets) = file("packets.csv");
    let (trace_path, trace) = file("tables.trace");
    let arguments = ["run", &scenario, "--csv", &csv, "--packets", &packets, "--trace", &trace];
    assert_eq!(stepscope(&arguments).0, Some(0));
    let lines = |path| fs::read_to_string(path).expect("a file").lines().count();
    assert_eq!(lines(csv_path), lines(trace_path) + 1, "a header and one row per record");
    let packets = fs::read_to_string(packets_path).expect("a file");
    let outcomes: Vec<&str> = packets.lines().skip(1).filter_map(|row| row.split(',').nth(3)).collect();
    let expected =
        ["queued", "another address", "queued", "dropped: TOO_MANY_STEPS", "dropped: SHORT_PACKET"];
    assert_eq!(outcomes, expected);
}

#[test]
fn a_dump_has_the_signals_of_used_channels() {
    let scenario = preset("patent-2019-four-motors", "dump.json");
    let (path, vcd) = file("dump.vcd");
    assert_eq!(stepscope(&["run", &scenario, "--vcd", &vcd]).0, Some(0));
    let text = fs::read_to_string(path).expect("a file");
    let variables: Vec<&str> = text.lines().filter(|line| line.starts_with("$var")).collect();
    assert_eq!(variables.len(), 4 * 2 + 4, "{variables:?}");
    assert!(text.contains("STEP3") && text.contains("DE") && !text.contains("STEP4"));
}

#[test]
fn lists_every_preset_and_rejects_unknown_names() {
    let (code, list) = stepscope(&["presets"]);
    let all = [PRESETS, PLANT_PRESETS, CONTROLLER_PRESETS, CONTROLLER_PLANT_PRESETS];
    assert_eq!((code, list.lines().count()), (Some(0), all.iter().map(|list| list.len()).sum()));
    assert_eq!(stepscope(&["presets", "no-such"]), (Some(2), String::new()));
}
