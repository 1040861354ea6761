//! `stepscope faults`: table, exit code, and the scenarios of its seeds.

use std::{fs, path::PathBuf, process::Command};

fn stepscope(arguments: &[&str]) -> (Option<i32>, String, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_stepscope")).args(arguments).output().expect("the command starts");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

fn row(table: &str, name: &str) -> Vec<u64> {
    let row = table.lines().find(|line| line.trim_start().starts_with(name)).expect(name);
    row.trim_start()[name.len()..]
        .split_whitespace()
        .map(|number| number.parse().expect("a number"))
        .collect()
}

#[test]
fn only_raw_lines_have_wrong_steps_with_any_number_of_threads() {
    let call = |threads| stepscope(&["faults", "--seeds", "300", "--threads", threads]);
    let (code, table, err) = call("1");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    assert_eq!(row(&table, "seeds"), [300, 300]);
    for name in
        ["missing", "wrong", "duplicated or not commanded", "wrong steps", "error of final positions, steps"]
    {
        let numbers = row(&table, name);
        assert!(numbers[0] == 0 && numbers[1] > 0, "{name}: {numbers:?}");
    }
    assert!(table.contains("raw: errors with seeds "), "{table}");
    assert_eq!(call("3"), (code, table, err));
}

#[test]
fn json_has_every_seed_with_errors() {
    let (code, out, _) = stepscope(&["faults", "--seeds", "300", "--protocol", "raw", "--json"]);
    assert_eq!(code, Some(0));
    let report: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    let rows = |table: &str| report["tables"][table].as_array().cloned().expect("a table");
    let counts = rows("counts");
    let count = counts.iter().find(|row| row["count"] == "seeds_with_errors").expect("a count");
    let seeds: Vec<u64> = rows("wrong_seeds").iter().filter_map(|row| row["seed"].as_u64()).collect();
    // More than the text names.
    assert!(seeds.len() > 8 && Some(seeds.len() as u64) == count["value"].as_u64(), "{count}: {seeds:?}");
    assert!(
        seeds.is_sorted_by(|seed, next| seed < next) && seeds.iter().all(|seed| *seed < 300),
        "{seeds:?}"
    );
}

#[test]
fn results_of_seed_ranges_add_up() {
    let frames = |options: &[&str]| {
        let all = [&["faults", "--protocol", "framed"], options].concat();
        row(&stepscope(&all).1, "frames or packets sent")[0]
    };
    let parts = frames(&["--seeds", "70"]) + frames(&["--from", "70", "--seeds", "80"]);
    assert_eq!(parts, frames(&["--seeds", "150"]));
    assert_eq!(frames(&["--seed", "149"]), frames(&["--from", "149", "--seeds", "1"]));
    // Seeds have 32 bits; larger ones are refused.
    let (_, table, _) = stepscope(&["faults", "--from", "4294967290", "--seeds", "6"]);
    assert_eq!(row(&table, "seeds"), [6, 6]);
    assert_eq!(stepscope(&["faults", "--from", "4294967290", "--seeds", "7"]).0, Some(2));
}

#[test]
fn a_seed_can_be_run_as_a_scenario_and_opened_as_a_link() {
    let seed = ["faults", "--seed", "8", "--protocol", "framed"];
    let (code, json, _) = stepscope(&[&seed[..], &["--scenario"]].concat());
    assert_eq!(code, Some(0));
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("seed.json").display().to_string();
    fs::write(&path, &json).expect("a file");
    let (code, status, _) = stepscope(&["run", &path]);
    assert_eq!(code, Some(0));
    let frames = row(&stepscope(&seed).1, "frames or packets sent")[0];
    assert!(status.contains(&format!("\nframes {frames} repeated ")), "{status}");
    let (_, link, _) = stepscope(&[&seed[..], &["--link"]].concat());
    assert_eq!(stepscope(&["open", link.trim()]).1, json);
    assert_eq!(stepscope(&["faults", "--link"]).0, Some(2), "a link is one seed's");
}

#[test]
fn uses_the_ticks_of_a_file_and_reports_its_problems() {
    let file = |name: &str, json: &str| {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name).display().to_string();
        fs::write(&path, json).expect("a file");
        path
    };
    let orders = r#"{ "source": { "packets": { "packets": [ "81", "02", "83", "04" ] } } }"#;
    let (code, table, _) = stepscope(&["faults", "--seeds", "20", &file("orders.json", orders)]);
    assert_eq!((code, row(&table, "ticks commanded")), (Some(0), vec![20 * 5, 20 * 4]));
    for (name, json, expected) in [
        ("typo.json", r#"{ "bus": { "slots": "many" } }"#, "bus.slots: "),
        ("script.json", r#"{ "source": { "line": {} } }"#, "source: the scenario has no ticks to disturb"),
    ] {
        let (code, out, err) = stepscope(&["faults", &file(name, json)]);
        assert_eq!((code, out.as_str()), (Some(2), ""));
        assert!(err.contains(expected), "{err}");
    }
}

#[test]
fn prints_progress_on_request() {
    let (code, _, err) = stepscope(&["faults", "--seeds", "200", "--protocol", "raw", "--progress"]);
    assert_eq!(code, Some(0));
    assert!(err.contains("faults: 100 %\n") && err.contains("faults: 200 seeds in "), "{err}");
}
