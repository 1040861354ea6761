//! Untrusted scenarios and links: any input gets a result, and accepted ones have bounded work (PAGE "Share link").
//!
//! Time is not measured. The work of reading is bounded by the length of the text, that of a run by its computed cost.

use miniz_oxide::deflate::compress_to_vec;
use proptest::{prelude::*, sample::Index};
use serde_json::{Map, Value, json};
use stepscope_core::scenario::{
    Scenario,
    link::{LinkError, MAX_FRAGMENT_BYTES, MAX_JSON_BYTES, decode, encode},
    presets::PRESETS,
};
use stepscope_tests::{
    effort,
    fuzzing::{
        link::{around, open},
        scenario::{drive, judge},
    },
    scenarios::{driven, segmented, small, typed},
};

/// Any JSON, with the names of scenarios.
fn value() -> impl Strategy<Value = Value> {
    let name = prop_oneof![
        2 => prop::sample::select(vec!["steps", "mm", "bus", "source", "motion", "moves", "bytes", "__proto__", ""]),
        1 => Just("constructor"),
    ];
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<u64>().prop_map(Value::from),
        // Numbers that no type can represent; see `print`.
        prop::sample::select(vec!["@1e999", "@-1e999", "@123456789012345678901234567890", "@1e-999", "@-0"])
            .prop_map(Value::from),
        prop::sample::select(vec!["", "80", "8", "burst", "\u{0}", "𝄞", "-1", "ten"]).prop_map(Value::from),
    ];
    leaf.prop_recursive(3, 12, 4, move |inner| {
        prop_oneof![
            prop::collection::vec(inner.clone(), 0..4).prop_map(Value::from),
            prop::collection::vec((name.clone(), inner), 0..4).prop_map(|fields| {
                Value::Object(
                    fields.into_iter().map(|(name, value)| (name.to_owned(), value)).collect::<Map<_, _>>(),
                )
            }),
        ]
    })
}

/// JSON text; texts that begin with @ are printed as numbers.
fn print(value: &Value) -> String {
    let mut text = value.to_string();
    while let Some(start) = text.find("\"@") {
        let end = start + 2 + text[start + 2..].find('"').unwrap_or(0);
        text = format!("{}{}{}", &text[..start], &text[start + 2..end], &text[end + 1..]);
    }
    text
}

/// One change of a JSON document.
#[derive(Clone, Debug)]
enum Change {
    Replace(Index, Value),
    Remove(Index),
    Add(Index, Value),
    Nest(Index, usize),
    /// A number is replaced by another one of its kind.
    Number(Index, f64),
}

fn change() -> impl Strategy<Value = Change> {
    let odd = vec![
        0.0, 1.0, 2.0, 16.0, 17.0, 127.0, 255.0, 1e-9, 0.5, 1e3, 1e5, 1e6, 1e7, 1e9, 4e9, 1e15, 9e15, 1e300,
    ];
    prop_oneof![
        2 => (any::<Index>(), value()).prop_map(|(at, value)| Change::Replace(at, value)),
        1 => any::<Index>().prop_map(Change::Remove),
        1 => (any::<Index>(), value()).prop_map(|(at, value)| Change::Add(at, value)),
        1 => (any::<Index>(), 1..200_usize).prop_map(|(at, depth)| Change::Nest(at, depth)),
        4 => (any::<Index>(), prop::sample::select(odd)).prop_map(|(at, number)| Change::Number(at, number)),
    ]
}

/// Paths to all values in a document that `which` accepts.
fn paths(value: &Value, which: fn(&Value) -> bool) -> Vec<String> {
    let below = |(name, inner): (String, &Value)| {
        paths(inner, which).into_iter().map(move |path| format!("/{name}{path}")).collect::<Vec<_>>()
    };
    let mut found: Vec<String> = match value {
        Value::Object(map) => {
            map.iter().map(|(k, v)| (k.replace('~', "~0").replace('/', "~1"), v)).flat_map(below).collect()
        }
        Value::Array(list) => {
            list.iter().enumerate().map(|(i, v)| (i.to_string(), v)).flat_map(below).collect()
        }
        _ => Vec::new(),
    };
    if which(value) {
        found.push(String::new());
    }
    found
}

fn apply(document: &mut Value, change: &Change) {
    let (Change::Replace(index, _)
    | Change::Remove(index)
    | Change::Add(index, _)
    | Change::Nest(index, _)
    | Change::Number(index, _)) = change;
    let places =
        paths(document, if matches!(change, Change::Number(..)) { Value::is_number } else { |_| true });
    if places.is_empty() {
        return;
    }
    let path: &String = index.get(&places);
    let Some(place) = document.pointer_mut(path) else { return };
    match change {
        Change::Replace(_, value) => *place = value.clone(),
        Change::Remove(_) => *place = Value::Null,
        Change::Add(_, value) => match place {
            Value::Object(map) => {
                map.insert("added".into(), value.clone());
            }
            Value::Array(list) => list.push(value.clone()),
            other => *other = json!([other, value]),
        },
        Change::Nest(_, depth) => {
            for _ in 0..*depth {
                *place = json!([place.take()]);
            }
        }
        // An integer stays one, so that its value is validated and not only its type.
        Change::Number(_, number) => {
            *place = if place.is_f64() { json!(number) } else { json!(*number as u64) }
        }
    }
}

/// A scenario's JSON with some changes; if only numbers change, it is often still valid.
fn changed(scenario: &Scenario, changes: &[Change]) -> String {
    let mut document: Value = serde_json::from_str(&scenario.to_json()).unwrap_or_default();
    changes.iter().for_each(|change| apply(&mut document, change));
    print(&document)
}

proptest! {
    #![proptest_config(effort::cases(3_000))]

    #[test]
    fn no_text_causes_a_panic(text in prop_oneof![any::<String>(), "[\\[\\]{}\",:0-9a-e.@-]{0,80}"]) {
        let _ = judge(&text);
        open(&text);
        open(&format!("c={text}"));
    }

    #[test]
    fn no_changed_scenario_causes_a_panic(
        scenario in prop_oneof![small(), segmented(), typed()],
        changes in prop::collection::vec(change(), 1..6),
    ) {
        let _ = judge(&changed(&scenario, &changes));
    }

    /// A valid scenario has short runs: its cycles, and the grid steps of all motors, are computed before.
    #[test]
    fn plants_of_any_numbers_run_with_the_same_bits(scenario in driven()) {
        if let Ok(experiment) = judge(&scenario.to_json())
            && experiment.cost().motor_grid_steps <= 100_000
        {
            let made = drive(&experiment);
            prop_assert!(made <= experiment.cost().motor_grid_steps, "{made}");
        }
    }

    #[test]
    fn no_link_with_a_valid_crc_causes_a_panic(
        scenario in prop_oneof![small(), typed()],
        changes in prop::collection::vec(change(), 0..3),
        noise in prop::collection::vec((any::<Index>(), any::<u8>()), 0..4),
        codec in prop::sample::select(vec!['z', 'j', 'x', '.']),
        deflated in any::<bool>(),
    ) {
        let json = changed(&scenario, &changes);
        let mut payload = if deflated { compress_to_vec(json.as_bytes(), 6) } else { json.into_bytes() };
        for (index, byte) in noise {
            let at = index.index(payload.len());
            payload[at] = byte;
        }
        open(&around(codec, &payload));
    }

    #[test]
    fn a_changed_link_is_rejected(
        preset in prop::sample::select(PRESETS),
        changes in prop::collection::vec((any::<Index>(), "[!-~]"), 1..5),
    ) {
        let link = encode(&preset.scenario()).expect("a preset fits in a link");
        let mut characters: Vec<char> = link.chars().collect();
        for (index, with) in changes {
            let at = index.index(characters.len());
            characters.splice(at..=at, with.chars());
        }
        let changed: String = characters.into_iter().collect();
        // A CRC-32 detects all but one in four thousand million of these.
        prop_assert!(changed == link || decode(&changed).is_err(), "{}", changed);
    }

    /// Only numbers change, so many of these are valid: their cost is computed and limited.
    #[test]
    fn accepted_scenarios_have_bounded_work(
        preset in prop::sample::select(PRESETS),
        changes in prop::collection::vec(
            (any::<Index>(), prop::sample::select(vec![1.0, 2.0, 16.0, 127.0, 1e-3, 0.5, 1e3, 1e5, 1e7, 4e9]))
                .prop_map(|(at, number)| Change::Number(at, number)),
            1..3,
        ),
    ) {
        let _ = judge(&changed(&preset.scenario(), &changes));
    }
}

#[test]
fn truncated_and_changed_links_of_presets_are_rejected() {
    for preset in PRESETS {
        let link = encode(&preset.scenario()).expect("a preset fits in a link");
        assert_eq!(decode(&link), Ok(preset.scenario()), "{}", preset.id);
        for length in 0..link.len() {
            assert!(decode(&link[..length]).is_err(), "{} cut to {length}", preset.id);
        }
        let mut bytes = link.clone().into_bytes();
        for at in 0..bytes.len() {
            let own = bytes[at];
            for with in (b'!'..=b'~').filter(|with| *with != own) {
                bytes[at] = with;
                let flipped = std::str::from_utf8(&bytes).expect("ASCII");
                assert!(decode(flipped).is_err(), "{}: {flipped}", preset.id);
            }
            bytes[at] = own;
        }
    }
}

#[test]
fn a_payload_may_reach_but_not_exceed_its_limit() {
    let padded = |length: usize| compress_to_vec(format!("{{}}{}", " ".repeat(length - 2)).as_bytes(), 10);
    assert_eq!(decode(&around('z', &padded(MAX_JSON_BYTES))), Ok(Scenario::default()));
    let refusal = Err(LinkError::Payload { most: MAX_JSON_BYTES });
    for length in [MAX_JSON_BYTES + 1, 10 * MAX_JSON_BYTES, 10 << 20] {
        let bomb = around('z', &padded(length));
        assert!(bomb.len() <= MAX_FRAGMENT_BYTES, "{length} bytes fit in a fragment");
        assert_eq!(decode(&bomb), refusal, "{length} bytes");
    }
}

#[test]
fn deep_nesting_and_long_invalid_lists_are_rejected() {
    let depth = 200_000;
    let texts = [
        "[".repeat(depth),
        "{\"a\":".repeat(depth),
        format!("{}{}", "[".repeat(depth), "]".repeat(depth)),
        format!("{{\"source\":{}}}", "{\"motion\":".repeat(depth)),
        format!("{{\"source\":{{\"packets\":{{\"packets\":[{}\"00\"]}}}}}}", "7,".repeat(depth)),
        format!("{{{}\"title\":\"\"}}", "\"x\":1,".repeat(depth)),
        format!("{{{}\"title\":\"\"}}", (0..20_000).map(|i| format!("\"x{i}\":1,")).collect::<String>()),
    ];
    for text in texts {
        assert!(judge(&text).is_err(), "{}…", &text[..20]);
    }
}
