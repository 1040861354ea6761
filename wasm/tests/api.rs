//! What the page may rely on: the shape of each answer, and that no text makes the module fail.
#![cfg(target_arch = "wasm32")]

mod js;

use js::{get, list, number, text};
use js_sys::{Float64Array, Uint32Array};
use stepscope_wasm::{
    ValidatedScenario,
    study::{sheets, with_motor},
    view::{Simulation, default_scenario, drivers, open_link, presets, version},
};
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_dedicated_worker);

/// The value of a call that must succeed.
fn expect_ok<T, E>(result: Result<T, E>) -> T {
    result.unwrap_or_else(|_| unreachable!("the call failed"))
}

/// The value, which must exist.
fn expect_some<T>(found: Option<T>) -> T {
    found.unwrap_or_else(|| unreachable!("it is missing"))
}

/// The validation of a scenario.
fn check(json: &str) -> Result<JsValue, wasm_bindgen::JsError> {
    ValidatedScenario::new(json).check()
}

fn encode_link(json: &str) -> Result<String, wasm_bindgen::JsError> {
    ValidatedScenario::new(json).link()
}

/// A finished run.
fn finished(json: &str) -> Simulation {
    let mut simulation = expect_ok(ValidatedScenario::new(json).run());
    while !get(&expect_ok(simulation.advance(100_000)), "done").is_truthy() {}
    simulation
}

fn paths(validation: &JsValue) -> Vec<String> {
    list(validation, "problems").iter().map(|problem| text(problem, "path")).collect()
}

fn positions(controller: &JsValue) -> Vec<f64> {
    list(controller, "positions").iter().filter_map(JsValue::as_f64).collect()
}

/// The finished run of a preset.
fn preset(id: &str) -> Simulation {
    let all = expect_ok(presets()).unchecked_into::<js_sys::Array>().to_vec();
    let found = all.iter().find(|preset| text(preset, "id") == id);
    finished(&found.map(|preset| text(preset, "scenario")).unwrap_or_default())
}

/// All packet rows of the selected controller.
fn rows(simulation: &Simulation) -> Vec<JsValue> {
    list(&expect_ok(simulation.packets(0, u32::MAX)), "rows")
}

/// Numbers of a typed array.
fn numbers(object: &JsValue, name: &str) -> Vec<f64> {
    get(object, name).unchecked_into::<Float64Array>().to_vec()
}

#[wasm_bindgen_test]
fn a_valid_scenario_is_checked_with_its_derived_values() {
    let validation = expect_ok(check(&default_scenario()));
    assert_eq!(paths(&validation), [""; 0]);
    assert_eq!(text(&validation, "scenario"), default_scenario());
    let derived = get(&validation, "derived");
    let first = &list(&derived, "controllers")[0];
    assert_eq!(number(first, "tick_s"), 0.002);
    assert_eq!(number(first, "limit_steps_s"), 50_000.0);
    assert_eq!(number(&list(first, "axes")[0], "steps"), 3200.0);
    assert_eq!(number(&list(first, "axes")[0], "peak_speed_steps_s"), 16_000.0);
    let cost = get(&validation, "cost");
    assert!(!get(&cost, "over_budget").is_truthy() && text(&cost, "message").is_empty());
    assert!(number(&cost, "edges") > 6400.0);
    assert!(!version().is_empty());
}

#[wasm_bindgen_test]
fn all_problems_of_an_invalid_scenario_are_listed_with_their_paths() {
    let rows: [(&str, &[&str]); 7] = [
        ("", &[""]),
        ("{", &[""]),
        ("[]", &[""]),
        ("null", &[""]),
        (r#"{"bus":{"slots":0,"channels":"x"}}"#, &["bus.channels", "bus.slots"]),
        (r#"{"version":7}"#, &["version"]),
        (
            r#"{"source":{"motion":{"axes":[{"moves":[{"cosine":{"ramp_s":0.3}}]}]}}}"#,
            &["source.motion.axes[0].moves[0].cosine.ramp_s"],
        ),
    ];
    for (given, expected) in rows {
        let validation = expect_ok(check(given));
        let mut found = paths(&validation);
        found.sort();
        assert_eq!(found, expected, "{given}");
        assert!(list(&validation, "problems").iter().all(|problem| !text(problem, "message").is_empty()));
        assert!(get(&validation, "derived").is_null() && get(&validation, "cost").is_null(), "{given}");
        assert!(paths(&expect_ok(check(&text(&validation, "scenario")))).len() <= expected.len(), "{given}");
        assert!(ValidatedScenario::new(given).run().is_err(), "{given}");
    }
}

#[wasm_bindgen_test]
fn links_are_decoded_and_invalid_ones_state_the_error() {
    let all = expect_ok(presets()).unchecked_into::<js_sys::Array>().to_vec();
    assert!(!all.is_empty());
    for preset in &all {
        let scenario = text(preset, "scenario");
        let link = expect_ok(encode_link(&scenario));
        let opened = expect_ok(open_link(&format!("#{link}&v=views")));
        assert_eq!(text(&opened, "scenario"), scenario, "{}", text(preset, "id"));
        assert!(!get(&opened, "over_budget").is_truthy(), "{}", text(preset, "id"));
        assert!(!text(preset, "task").is_empty() && text(preset, "view").contains('t'));
    }
    let link = expect_ok(encode_link(&default_scenario()));
    for (given, why) in [
        (String::new(), "no scenario"),
        ("v=1".into(), "no scenario"),
        (link[..link.len() - 1].into(), "cut short"),
        (link.replacen("c=3.", "c=4.", 1), "newer version"),
        ("c=1".repeat(10_000), "too long"),
        ("c=1.z.__proto__.00000000".into(), "cut short"),
    ] {
        let error = text(&expect_ok(open_link(&given)), "error");
        assert!(error.contains(why), "{why}: {error}");
    }
    assert!(encode_link("{").is_err());
    let long = format!(r#"{{"source":{{"packets":{{"packets":[{}"00"]}}}}}}"#, r#""00","#.repeat(20_000));
    assert!(encode_link(&long).is_err(), "more than a link carries");
}

#[wasm_bindgen_test]
fn stand_alone_controllers_have_a_run_and_panels() {
    let all = expect_ok(presets()).unchecked_into::<js_sys::Array>().to_vec();
    let scenarios = all.iter().map(|preset| (text(preset, "id"), text(preset, "scenario")));
    let standalone: Vec<_> = scenarios.filter(|(_, scenario)| scenario.contains("\"standalone\"")).collect();
    assert!(standalone.len() > 5);
    for (id, scenario) in standalone {
        let mut run = expect_ok(ValidatedScenario::new(&scenario).run());
        while !get(&expect_ok(run.advance(1000)), "done").is_truthy() {}
        let summary = expect_ok(run.summary());
        assert!(!get(&summary, "recorded").is_truthy(), "{id}");
        let panel = JsValue::from(expect_some(run.panel(0)));
        let shown = numbers(&panel, "records");
        assert!(shown.len() >= 4 && !numbers(&panel, "inputs").is_empty(), "{id}");
        // The state at the last record is that record's.
        let [cycle, word, position, display] = shown[shown.len() - 4..] else { unreachable!("four numbers") };
        let at = expect_some(run.panel_at(0, cycle + 1.0));
        assert_eq!(at[..3], [word, position, display], "{id}");
    }
    assert!(finished("{}").panel(0).is_none());
}

#[wasm_bindgen_test]
fn a_link_over_the_budget_is_marked() {
    // Ten million edges of STEP.
    let scenario = r#"{"bus":{"channels":1,"slots":127,"step_period_cycles":100},"line":{"baud":1000000},
        "source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":5000000},"speed":{"steps_s":150000}}}]}]}}}"#;
    let opened = expect_ok(open_link(&expect_ok(encode_link(scenario))));
    assert!(get(&opened, "over_budget").is_truthy());
    assert!(text(&opened, "message").contains("edges"));
}

#[wasm_bindgen_test]
fn the_default_motion_has_curves_pulses_and_packets() {
    let mut simulation = finished(&default_scenario());
    let summary = expect_ok(simulation.summary());
    assert!(!get(&summary, "framed").is_truthy() && get(&summary, "host").is_null());
    let [only] = &list(&summary, "controllers")[..] else { unreachable!("there is one controller") };
    assert_eq!(positions(only), [3200.0]);
    assert_eq!(number(only, "ticks_done"), 200.0);
    assert_eq!(list(&get(only, "faults"), "names").len(), 0);
    assert_eq!(text(only, "digest").len(), 16);
    assert!(get(only, "address").is_null() && get(only, "state").is_null());
    assert!(get(only, "violations").is_null());

    let end_s = number(&summary, "end_s");
    let motion = simulation.motion(0, 0.0, end_s, 50);
    assert!(get(&motion, "has_ideal").is_truthy());
    for name in ["position", "speed", "acceleration", "actual_position", "actual_speed"] {
        let (least, most) =
            (numbers(&motion, &format!("{name}_min")), numbers(&motion, &format!("{name}_max")));
        assert_eq!((least.len(), most.len()), (50, 50), "{name}");
        assert!(
            least.iter().zip(&most).all(|(a, b)| a <= b || a.is_nan() && b.is_nan()),
            "{name}: {least:?} {most:?}"
        );
    }
    assert_eq!(numbers(&motion, "actual_position_max").last(), Some(&3200.0));

    let packets = expect_ok(simulation.packets(100, 3));
    assert_eq!(number(&packets, "total"), 200.0);
    let rows = list(&packets, "rows");
    assert_eq!(rows.len(), 3);
    assert_eq!((number(&rows[0], "index"), text(&rows[0], "outcome").as_str()), (100.0, "queued"));
    assert!(text(&rows[0], "fields").starts_with("ch0 +") && text(&rows[0], "hex").len() == 2);
    assert!(number(&rows[0], "tick_start_cycle") > number(&rows[0], "end_cycle"));
    assert_eq!(list(&expect_ok(simulation.packets(200, 5)), "rows").len(), 0);

    let spectrum = expect_ok(simulation.spectrum());
    for name in ["ideal", "pulses"] {
        let lines = numbers(&get(&spectrum, name), "position");
        assert_eq!(lines.len(), 40, "{name}");
        assert!(
            lines.iter().all(|amplitude| amplitude.is_finite() && *amplitude >= 0.0),
            "{name}: {lines:?}"
        );
        assert!(get(&get(&spectrum, name), "thd_position").is_null(), "the motion does not repeat");
    }
    assert!(!text(&spectrum, "note").is_empty());
}

#[wasm_bindgen_test]
fn edges_are_found_in_both_directions_and_are_in_the_columns() {
    // The golden case `tick`: STEP rises at 0x108 and 0x188, falls at 0x118 and 0x198.
    let case = stepscope_tests::golden::CASES.iter().find(|case| case.name == "tick");
    let simulation = finished(case.and_then(|case| case.json().ok()).unwrap_or_default());
    let rows = [
        (0.0, true, "any", Some(0x108)),
        (264.0, true, "any", Some(0x118)),
        (264.0, true, "rise", Some(0x188)),
        (0x198.into(), true, "any", None),
        (1e15, false, "any", Some(0x198)),
        (f64::from(0x198), false, "fall", Some(0x118)),
        (f64::from(0x108), false, "any", None),
        (-1.0, true, "rise", Some(0x108)),
        (f64::NAN, true, "rise", Some(0x108)),
    ];
    for (cycle, forward, kind, expected) in rows {
        let found = simulation.next_edge(0, cycle, forward, kind);
        assert_eq!(found, expected.map(f64::from), "{kind} from {cycle}, forward {forward}");
    }
    assert_eq!(simulation.next_edge(200, 0.0, true, "any"), None);

    // Four columns of 0x40 cycles from 0x100 on: STEP and DIR are bits 0 and 16.
    let pulses = simulation.pulses(256.0, 512.0, 4, 0);
    let low_words = |name: &str| -> Vec<u32> {
        let words: Uint32Array = get(&pulses, name).unchecked_into();
        words.to_vec().into_iter().step_by(2).map(|word| word & 0x1_0001).collect()
    };
    assert_eq!(low_words("high"), [0x1_0001, 0x1_0000, 0x1_0001, 0x1_0000]);
    assert_eq!(low_words("low"), [1, 1, 1, 1]);
    assert_eq!(low_words("last"), [0x1_0000; 4]);
    let empty: Uint32Array = get(&simulation.pulses(5.0, 1.0, 0, 0), "high").unchecked_into();
    assert_eq!(empty.length(), 2, "at least one column");
    let margins: Uint32Array = get(&simulation.pulses(256.0, 512.0, 4, 5), "high").unchecked_into();
    assert_eq!(margins.to_vec()[..2], [0, 0], "the first column of the margin ends before reset");
    assert_eq!(margins.length(), 2 * 14);

    let pulse = expect_ok(simulation.pulse_at(0, 0x110.into()));
    assert!(get(&pulse, "high").is_truthy());
    assert_eq!(["begin", "end", "next"].map(|name| number(&pulse, name)), [264.0, 280.0, 392.0]);
    let edges = |bit, cycle, forward, most| {
        let found = expect_ok(simulation.edges(bit, cycle, forward, most));
        let cycles: Vec<f64> = list(&found, "rows").iter().map(|row| number(row, "cycle")).collect();
        (cycles, get(&found, "more").is_truthy())
    };
    assert_eq!(edges(Some(0), -1.0, true, 3), (vec![264.0, 280.0, 392.0], true));
    assert_eq!(edges(Some(0), 281.0, false, 9), (vec![264.0, 280.0], false));
    assert_eq!(edges(Some(0), 280.0, true, 9), (vec![392.0, 408.0], false));
    assert_eq!(edges(None, 408.0, false, 1), (vec![392.0], true));
}

#[wasm_bindgen_test]
fn every_timing_violation_of_a_driver_is_listed_with_its_cycle() {
    assert!(expect_ok(finished(&default_scenario()).timing()).is_null(), "no driver, no check");
    let simulation = preset("driver-timing-broken");
    assert_eq!(number(&list(&expect_ok(simulation.summary()), "controllers")[0], "violations"), 131.0);
    let timing = expect_ok(simulation.timing());
    assert_eq!((text(&timing, "driver").as_str(), number(&timing, "total")), ("drv8825", 131.0));
    let rules = list(&timing, "rules");
    let totals: Vec<(String, f64, f64)> = rules
        .iter()
        .map(|rule| (text(rule, "rule"), number(rule, "required_ns"), number(rule, "violations")))
        .collect();
    let expected = [
        ("step_high", 1900.0, 128.0),
        ("step_low", 1900.0, 0.0),
        ("dir_setup", 650.0, 3.0),
        ("dir_hold", 650.0, 0.0),
        ("enable_wake", 650.0, 0.0),
    ];
    assert_eq!(totals, expected.map(|(name, required, count)| (name.to_owned(), required, count)));
    assert_eq!(list(&rules[0], "by_channel").len(), 1);
    assert_eq!(number(&get(&rules[2], "shortest"), "measured_cycles"), 8.0);

    let violations = list(&timing, "violations");
    assert_eq!(violations.len(), 131);
    let first = number(&violations[0], "cycle");
    assert_eq!(
        (text(&violations[0], "rule").as_str(), number(&violations[0], "required_cycles")),
        ("dir_setup", 11.0)
    );
    for (cycle, forward, expected) in [
        (-1.0, true, Some(0)),
        (f64::NAN, true, Some(0)),
        (first, true, Some(1)),
        (first, false, None),
        (1e15, false, Some(130)),
        (1e15, true, None),
    ] {
        assert_eq!(simulation.next_violation(cycle, forward), expected, "{cycle}, forward {forward}");
    }
    let listed = expect_ok(drivers()).unchecked_into::<js_sys::Array>().to_vec();
    assert!(listed.iter().any(
        |sheet| text(sheet, "id") == "drv8825" && number(&get(sheet, "rules"), "step_high_ns") == 1900.0
    ));
}

#[wasm_bindgen_test]
fn frames_and_replies_are_explained_and_the_host_reports_its_outcome() {
    let simulation = preset("framed-link");
    let summary = expect_ok(simulation.summary());
    assert!(get(&summary, "framed").is_truthy());
    let load = number(&summary, "line_load");
    assert!(load > 0.1 && load < 1.0, "{load}");
    let only = &list(&summary, "controllers")[0];
    assert_eq!((number(only, "address"), text(only, "state").as_str()), (1.0, "READY"));
    assert_eq!(positions(only), [3200.0, -1600.0]);
    let host = get(&summary, "host");
    let job = &list(&host, "jobs")[0];
    assert_eq!(text(job, "progress"), "done");
    assert_eq!(number(job, "ticks"), number(only, "ticks_done"));
    assert_eq!(number(job, "acknowledged"), number(job, "ticks"));
    assert!(get(job, "why").is_null());
    assert_eq!(number(&host, "repeated"), 0.0);

    let rows = rows(&simulation);
    assert_eq!(rows.len() as f64, number(&host, "frames") + number(&host, "replies"));
    let told = |index: usize| {
        let row = &rows[index];
        ["kind", "fields", "outcome", "mark"].map(|name| text(row, name))
    };
    assert_eq!(told(0), ["frame", "to 1: STATUS", "STATUS done", "good"]);
    let reply = "from 1: ACK STATUS: READY, 16 free, seq 0, faults 0x00, 0 ticks done";
    assert_eq!(told(1), ["reply", reply, "acknowledged", "good"]);
    assert_eq!(told(2), ["frame", "to 1: POSITIONS", "POSITIONS done", "good"]);
    let [kind, fields, outcome, mark] = told(4);
    assert!(fields.starts_with("to 1: TICKS seq 0, 8 ticks, ch0 +"), "{fields}");
    assert_eq!((kind.as_str(), outcome.as_str(), mark.as_str()), ("frame", "8 ticks queued", "good"));

    // The frame's eight ticks, one after another, from its first to its last.
    let (start, end) = (number(&rows[4], "tick_start_cycle"), number(&rows[4], "tick_end_cycle"));
    let ticks = list(&expect_ok(simulation.ticks_in(start, end - 1.0, 100)), "rows");
    assert_eq!(ticks.len(), 8);
    assert!(ticks.iter().all(|tick| number(tick, "row") == 4.0));
    assert_eq!(number(&ticks[0], "start_cycle"), start);
    assert_eq!(number(&ticks[7], "end_cycle"), end);
    assert!(get(&expect_ok(simulation.ticks_in(start, end - 1.0, 7)), "more").is_truthy());
    // The reply is on the line while the first of these ticks runs.
    let (start, end) = (number(&rows[5], "start_cycle"), number(&rows[5], "end_cycle"));
    assert!(start > number(&rows[4], "tick_start_cycle"));
    let touching = list(&expect_ok(simulation.packets_in(start, end, 9)), "rows");
    let indices: Vec<f64> = touching.iter().map(|row| number(row, "index")).collect();
    assert_eq!(indices, [5.0]);
    assert!(list(&expect_ok(simulation.packets_in(0.0, end, 2)), "rows").is_empty(), "more than two");

    // The reply's bytes one after another, and what they mean.
    let decoded = expect_ok(simulation.decoded(start, end, 99, 99));
    let tx = get(&decoded, "tx");
    let bytes = list(&tx, "bytes");
    let spoken: Vec<String> =
        bytes.iter().filter_map(|span| list(span, "texts").first().and_then(JsValue::as_string)).collect();
    assert_eq!(spoken.join(" "), text(&rows[5], "hex"));
    assert_eq!((number(&bytes[0], "start"), list(&tx, "bits").len()), (start, 10 * bytes.len()));
    let fields: Vec<String> = list(&tx, "fields")
        .iter()
        .filter_map(|span| list(span, "texts").first().and_then(JsValue::as_string))
        .collect();
    for wanted in ["address: 1", "kind: ACK TICKS", "state: MOVING", "delimiter: 00"] {
        assert!(fields.iter().any(|field| field == wanted), "no `{wanted}` in {fields:?}");
    }
    assert!(get(&expect_ok(simulation.decoded(0.0, end, 3, 3)), "more").is_truthy());
}

#[wasm_bindgen_test]
fn the_views_show_the_selected_controller() {
    let mut simulation = preset("four-controllers-framed");
    let summary = expect_ok(simulation.summary());
    let controllers = list(&summary, "controllers");
    let addresses: Vec<f64> = controllers.iter().map(|controller| number(controller, "address")).collect();
    assert_eq!(addresses, [1.0, 2.0, 3.0, 4.0]);
    let jobs = list(&get(&summary, "host"), "jobs");
    assert!(jobs.iter().all(|job| text(job, "progress") == "done"));
    let expected: [&[f64]; 4] = [&[2400.0, -2400.0], &[500.0], &[1600.0], &[0.0, 0.0]];
    for (controller, expected) in controllers.iter().zip(expected) {
        assert_eq!(positions(controller), expected);
    }
    let end_s = number(&summary, "end_s");
    for (index, expected) in expected.iter().enumerate() {
        simulation.select(index as u32);
        let made = numbers(&simulation.motion(0, 0.0, end_s, 20), "actual_position_max");
        assert_eq!(made.last(), Some(&expected[0]), "controller {index}");
        let rows = rows(&simulation);
        let own = |kind: &str| {
            rows.iter().filter(|row| text(row, "kind") == kind && text(row, "mark") == "good").count()
        };
        assert_eq!(own("frame"), own("reply"), "controller {index}");
        let foreign: Vec<&JsValue> = rows.iter().filter(|row| text(row, "mark") == "foreign").collect();
        assert!(foreign.iter().all(|row| text(row, "outcome") == "another address"));
        // The others' frames name their own channels, and their replies are read too.
        assert!(foreign.iter().any(|row| text(row, "kind") == "reply"), "controller {index}");
        let spectrum = expect_ok(simulation.spectrum());
        assert!(get(&spectrum, "ideal").is_object(), "controller {index}");
    }
    simulation.select(4);
    let made = numbers(&simulation.motion(0, 0.0, end_s, 20), "actual_position_max");
    assert_eq!(made.last(), Some(&0.0), "there is no fifth one: still the fourth");
}

#[wasm_bindgen_test]
fn retries_overcome_noise_and_another_seed_changes_the_run() {
    let digest =
        |simulation: &Simulation| text(&list(&expect_ok(simulation.summary()), "controllers")[0], "digest");
    let noisy = preset("framed-noisy-line");
    let summary = expect_ok(noisy.summary());
    let host = get(&summary, "host");
    assert!(number(&host, "repeated") > 0.0);
    assert_eq!(text(&list(&host, "jobs")[0], "progress"), "done");
    assert_eq!(positions(&list(&summary, "controllers")[0]), [3200.0, -1600.0]);
    let marks: Vec<(String, String)> =
        rows(&noisy).iter().map(|row| (text(row, "mark"), text(row, "outcome"))).collect();
    for (mark, outcome) in [("repeated", "not queued again"), ("bad", "expected")] {
        assert!(marks.iter().any(|(m, o)| m == mark && o.contains(outcome)), "{mark} {outcome}: {marks:?}");
    }
    let seeded = |seed: u32| {
        finished(&format!(
            r#"{{"line":{{"protocol":"framed","noise":{{"seed":{seed},"flipped_bits_ppm":1000}}}}}}"#
        ))
    };
    assert_eq!(digest(&seeded(1)), digest(&seeded(1)));
    assert_ne!(digest(&seeded(1)), digest(&seeded(2)));
}

#[wasm_bindgen_test]
fn a_host_that_gives_up_reports_the_cause() {
    let silent = finished(r#"{"line":{"protocol":"framed","noise":{"lost_bytes_ppm":1000000}}}"#);
    let job = &list(&get(&expect_ok(silent.summary()), "host"), "jobs")[0];
    assert_eq!((text(job, "progress").as_str(), text(job, "why").as_str()), ("given_up", "no reply"));
    let stop =
        r#"{"line":{"protocol":"framed"},"source":{"line":{"sends":[{"start_cycle":2000,"frame":"ff05"}]}}}"#;
    let summary = expect_ok(finished(stop).summary());
    assert!(get(&summary, "host").is_null(), "the host of a script does not wait for replies");
    assert_eq!(text(&list(&summary, "controllers")[0], "state"), "STOPPED");
}

#[wasm_bindgen_test]
fn measures_are_of_the_requested_axis() {
    let scenario = ValidatedScenario::new(
        r#"{"bus":{"channels":2},"source":{"motion":{"axes":[{},{"moves":[{"constant":{"distance":{"steps":100}}}]}]}}}"#,
    );
    let counts = |measures: &JsValue| number(&get(measures, "counts"), "due");
    assert_eq!([0, 1].map(|axis| counts(&expect_ok(scenario.measures(0, axis)))), [3200.0, 100.0]);
    let measures = expect_ok(scenario.measures(0, 1));
    assert!((number(&get(&measures, "steps"), "rms_steps") - 0.288_675).abs() < 1e-5);
    assert!(get(&measures, "sine").is_null() && get(&get(&measures, "duration"), "requested_s").is_null());
    assert!(expect_ok(scenario.measures(0, 2)).is_null(), "there is no third axis");
}

#[wasm_bindgen_test]
fn the_plant_columns_are_of_the_requested_motor() {
    let simulation = finished(r#"{"bus":{"channels":2},"plant":{},"source":{"motion":{"axes":[{},{}]}}}"#);
    let report = expect_ok(simulation.plant());
    let motors = list(&report, "motors");
    assert_eq!((motors.len(), text(&motors[1], "verdict").as_str()), (2, "follows"));
    let end = number(&expect_ok(simulation.summary()), "end_cycle");
    let curves = expect_some(simulation.plant_curves(1, 0.0, end, 300));
    let greatest = numbers(&get(&curves, "rotor"), "max");
    assert!(greatest.len() > 300 && greatest.len() <= 602, "{}", greatest.len());
    let at_end = expect_some(simulation.plant_at(1, end));
    assert_eq!(number(&at_end, "rotor"), number(&motors[1], "rotor_full_steps"));
    assert!(simulation.plant_curves(2, 0.0, end, 300).is_none(), "there is no third motor");
    assert!(expect_ok(finished("{}").plant()).is_null());
}

#[wasm_bindgen_test]
fn a_motor_of_the_list_replaces_the_scenarios_motor() {
    let sheets = expect_ok(sheets());
    assert!(list(&sheets, "motors").len() >= 8 && list(&sheets, "drives").len() >= 4);
    let made = with_motor("{}", "17hs4401", "a4988");
    assert!(made.contains("\"plant\"") && made.contains("\"resistance_ohm\": 1.5"), "{made}");
    let scenario = ValidatedScenario::new(&made);
    assert!(list(&expect_ok(scenario.check()), "problems").is_empty());
    // As `stepscope limits` has it for the default motor.
    let usual = ValidatedScenario::new(r#"{"plant":{}}"#);
    let rate = expect_some(expect_ok(usual.start_stop(0, 0)));
    assert!((rate - 34_700.0).abs() < 400.0, "{rate}");
    assert!(usual.start_stop(0, 1).is_err() && ValidatedScenario::new("{}").start_stop(0, 0).is_err());
    let map = expect_ok(usual.resonance(0, 0, 100.0, 50.0, 3));
    assert_eq!(numbers(&map, "oscillation").len(), 3);
}
