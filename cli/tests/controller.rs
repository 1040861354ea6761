//! Stand-alone controllers in scripts: status, panel files, power cuts.

use crate::program::stepscope;
use serde_json::Value;
use vcd::{Command, Parser};

#[test]
fn status_has_state_position_trust_and_wear() {
    let (code, out, err) = stepscope(&["run", "zhang-2012-controller"], "");
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let line = "panel 0 READY trust HELD position 17233 axis_error 0 records 5 most_writes 1 presses_without_meaning 0";
    assert!(out.lines().any(|found| found == line), "{out}");
    let (_, out, _) = stepscope(&["run", "controller-power-cut-lost", "--json"], "");
    let tables = serde_json::from_str::<Value>(&out).expect("JSON")["tables"].clone();
    let panel = &tables["panels"][0];
    assert_eq!(
        (&panel["state"], &panel["alarm"], &panel["trust"]),
        (&"ALARM".into(), &"TRUST".into(), &"LOST".into())
    );
    assert_eq!(tables["panel_digest"][0]["digest"].as_str().map(str::len), Some(16));
}

#[test]
fn writes_panel_records_as_a_table() {
    let (code, out, _) = stepscope(&["run", "zhang-2012-zero-by-jog", "--panel", "-"], "");
    assert_eq!(code, Some(0));
    let rows: Vec<&str> = out.lines().collect();
    assert_eq!(rows[0], "controller,cycle,time_s,word,position,display,state,alarm,trust,outputs,group,loop");
    assert_eq!(rows[1], "0,0,0,1,0,0,SELF_TEST,,LOST,0,0,0");
    // Five steps in half a second at 10 Hz, then ok.
    assert!(rows.contains(&"0,25760001,1.6100000625,267,515,9,DEBUG,,HELD,0,0,0"), "{out}");
    assert_eq!(rows.last(), Some(&"0,30560001,1.9100000625,514,0,0,READY,,SURE,0,0,0"));
    let (code, _, err) = stepscope(&["run", "-", "--panel", "-"], "{}");
    assert!(code == Some(2) && err.contains("no stand-alone controller"), "{err}");
}

#[test]
fn tables_and_dumps_have_states_and_inputs() {
    let (_, out, _) = stepscope(&["run", "controller-emergency-stop", "--csv", "-"], "");
    let mut rows = out.lines();
    let head = "cycle,time_s,STEP0,DIR0,EN,RX,TX,DE,state0,alarm0,trust0,outputs0,group0,loop0,estop_0,clear_0,start_0";
    assert_eq!(rows.next(), Some(head));
    let of = |cycle: &str| out.lines().find(|row| row.starts_with(cycle)).expect("a row").to_owned();
    // In the pulse, and in the cycle after it.
    assert!(of("41197009,").ends_with(",1,1,1,1,1,0,RUNNING,,HELD,0,1,1,1,0,0"), "{}", of("41197009,"));
    assert!(of("41197010,").ends_with(",0,1,0,1,1,0,ALARM,ESTOP,LOST,0,0,0,1,0,0"), "{}", of("41197010,"));
    let (_, dump, _) = stepscope(&["run", "controller-emergency-stop", "--vcd", "-"], "");
    let mut parser = Parser::new(dump.as_bytes());
    let header = parser.parse_header().expect("a head");
    let state = header.find_var(&["stepscope", "state0"]).expect("it is there").code;
    let states: Vec<u64> = parser
        .filter_map(|command| match command.expect("a command") {
            Command::ChangeVector(code, bits) if code == state => {
                Some(bits.iter().fold(0, |word, bit| word * 2 + u64::from(bit == vcd::Value::V1)))
            }
            _ => None,
        })
        .collect();
    // SELF_TEST, READY, RUNNING, ALARM, READY.
    assert_eq!(states, [1, 2, 3, 13, 2]);
}

#[test]
fn counts_power_cuts_and_finds_the_minimum_hold_up() {
    let short = r#"{"clock_hz":100000,"bus":{"pulse_width_cycles":2},"source":{"standalone":[{"self_test_cycles":10,
        "debounce_cycles":0,"max_speed_hz":1000,"groups":[{"move":{"length":2,"speed_hz":1000}}],
        "memory":{"byte_write_cycles":10},"inputs":[{"cycle":400,"input":"start"}]}]}}"#;
    let (code, out, err) = stepscope(&["powercut", "-", "--json"], short);
    assert_eq!((code, err.as_str()), (Some(0), ""));
    let tables = serde_json::from_str::<Value>(&out).expect("JSON")["tables"].clone();
    assert_eq!(tables["hold_up"][0]["least_hold_up_cycles"], 17 * 10 - 1);
    let rows = tables["cuts"].as_array().expect("rows");
    let length = rows[0]["cuts"].as_u64().expect("a number");
    assert!(length > 2000, "every cycle of a short run: {length}");
    for row in rows {
        let parts = ["known", "lost", "never_known", "old_zero", "silently_wrong"];
        let sum: u64 = parts.iter().map(|part| row[*part].as_u64().expect("a number")).sum();
        assert_eq!((row["cuts"].as_u64(), &row["silently_wrong"]), (Some(sum), &0.into()), "{row}");
    }
    let lost = |hold_up: u64| {
        let row = rows.iter().find(|row| row["policy"] == "power_loss" && row["hold_up_cycles"] == hold_up);
        row.and_then(|row| row["lost"].as_u64()).expect("a row")
    };
    assert!(lost(0) > lost(168) && lost(168) > 0 && lost(169) == 0);
    // 8 slots, two records per power cycle.
    assert_eq!(tables["wear"][0]["life_power_cycles"], 400_000);
    let (code, _, err) = stepscope(&["powercut", "-"], "{}");
    assert!(code == Some(2) && err.contains("no stand-alone controller"), "{err}");
}

#[test]
fn rejects_an_endless_program_and_names_its_groups() {
    let scenario = r#"{"source":{"standalone":[{"debounce_cycles":0,"memory":{"byte_write_cycles":1},
        "groups":[{"set":{}},{"set":{"level":0}},{"jump":{}}],"inputs":[{"cycle":3000,"input":"start"}]}]}}"#;
    let (code, _, err) = stepscope(&["run", "-"], scenario);
    assert_eq!(code, Some(2));
    let message = "source.standalone[0].groups: groups 1 to 3 repeat without end; add a move, a wait or a jump out of them";
    assert!(err.contains(message), "{err}");
}

#[test]
fn reports_presses_without_effect_with_cycle_and_state() {
    let scenario = r#"{"source":{"standalone":[{"debounce_cycles":0,"memory":{"byte_write_cycles":1},
        "inputs":[{"cycle":3000,"input":"pause"},{"cycle":4000,"input":"key_7"}]}]}}"#;
    let (code, out, _) = stepscope(&["run", "-"], scenario);
    assert_eq!(code, Some(0));
    for line in [
        "press 0 pause in cycle 3000 did nothing in READY",
        "press 0 key_7 in cycle 4000 did nothing in READY",
    ] {
        assert!(out.lines().any(|found| found == line), "{line}\n{out}");
    }
    let (_, out, _) = stepscope(&["run", "-", "--json"], scenario);
    let tables = serde_json::from_str::<Value>(&out).expect("JSON")["tables"].clone();
    assert_eq!(tables["presses_without_meaning"][1]["button"], "key_7");
}
