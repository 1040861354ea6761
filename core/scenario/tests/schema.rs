//! Files and texts that are derived from the schema: `docs/scenario.md`, which `STEPSCOPE_BLESS=1 cargo test -p
//! stepscope-scenario` writes, and the description for the page.

use std::{env, fs, path::Path};
use stepscope_scenario::{
    Scenario,
    schema::{DOCUMENTS, Field, Group, Limit, Type, Typed, describe, markdown},
};

#[test]
fn the_documentation_matches_the_schema() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scenario.md");
    let expected = markdown();
    if env::var_os("STEPSCOPE_BLESS").is_some() {
        fs::write(&file, &expected).expect("docs/scenario.md can be written");
    }
    let found = fs::read_to_string(&file).expect("docs/scenario.md");
    assert!(found == expected, "docs/scenario.md differs from the schema; STEPSCOPE_BLESS=1 writes it");
}

/// Each field and kind, with its path of names.
fn each(ty: &Type, path: &str, seen: &mut Vec<&'static str>, what: &mut impl FnMut(&str, &Group, &Field)) {
    match ty {
        Type::Group(group) if !seen.contains(&group.name) => {
            seen.push(group.name);
            for field in group.fields {
                let path = format!("{path}.{}", field.name);
                what(&path, group, field);
                each(&field.ty, &path, seen, what);
            }
        }
        Type::Optional(inner) | Type::List(inner) => each(inner, path, seen, what),
        _ => {}
    }
}

fn problems(mut wrong: impl FnMut(&Group, &Field) -> bool) -> Vec<String> {
    let mut found = Vec::new();
    each(&Scenario::TYPE, "", &mut Vec::new(), &mut |path, group, field| {
        if wrong(group, field) {
            found.push(path.to_owned());
        }
    });
    found
}

#[test]
fn every_field_has_a_label_and_a_help_text() {
    assert_eq!(problems(|_, field| field.text().is_empty() || field.label.is_empty()), [""; 0]);
}

#[test]
fn the_pages_explanations_match_the_schema() {
    let mut said = std::collections::BTreeMap::new();
    each(&Scenario::TYPE, "", &mut Vec::new(), &mut |_, group, field| {
        if !field.explanation.is_empty() {
            said.insert(format!("{}.{}", group.name, field.name), [field.term, field.explanation]);
        }
    });
    let mut text = String::from(
        "/** What the terms of a scenario's fields mean: written from the schema by its test, STEPSCOPE_BLESS=1. */\n",
    );
    text += "/** @type {{[id: string]: [string, string]}}  The card's head and its text. */\nexport const EXPLAINED = {\n";
    for (id, [term, explanation]) in said {
        let [term, explanation] =
            [term, explanation].map(|text| serde_json::to_string(text).expect("a text"));
        let line = format!("  \"{id}\": [{term}, {explanation}],\n");
        // Wrapped like the formatter does.
        let broken = format!("  \"{id}\": [\n    {term},\n    {explanation},\n  ],\n");
        text += if line.trim_end().chars().count() <= 120 { &line } else { &broken };
    }
    text += "};\n";
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web/help/explained.js");
    if std::env::var_os("STEPSCOPE_BLESS").is_some() {
        fs::write(file, &text).expect("the file can be written");
    }
    assert_eq!(
        fs::read_to_string(file).unwrap_or_default(),
        text,
        "STEPSCOPE_BLESS=1 writes web/help/explained.js"
    );
}

#[test]
fn every_field_of_the_form_has_an_explanation() {
    // Segments are typed as lines, and the version cannot be edited.
    let asked = |group: &Group, field: &Field| {
        let quantity = |group: &Group| group.is_choice && matches!(group.fields[0].ty, Type::Number);
        let one = match field.ty {
            Type::Group(group) => quantity(group),
            Type::Optional(Type::Group(_)) | Type::List(Type::Group(_)) => false,
            _ => true,
        };
        one && !group.is_choice
            && !["StepSegment", "DwellSegment"].contains(&group.name)
            && field.name != "version"
    };
    // Fields of a plant have no explanation yet; the form shows their doc text.
    let of_plant = ["PlantSettings", "CurrentSensor", "Encoder", "Protection", "PlantMotor", "Drive"];
    let begins = ["friction", "stiction", "viscous", "detent", "gravity", "sine_", "coupling"];
    let of_plant = |group: &Group, field: &Field| {
        of_plant.contains(&group.name)
            || (group.name == "Motor" && begins.iter().any(|begin| field.name.starts_with(begin)))
    };
    // Neither have groups, limits and input shapers.
    let of_groups = [
        "AxisLimits",
        "GroupMove",
        "LineGroup",
        "ShaperSettings",
        "SpeedTarget",
        "TimeGroup",
        "WayPoint",
        "WayPointGroup",
    ];
    // Neither have the numbers of a stand-alone controller; its words have cards.
    let mut of_panel = Vec::new();
    each(&Scenario::TYPE, "", &mut Vec::new(), &mut |path, group, _| {
        if path.starts_with(".source.standalone.") && !group.is_external {
            of_panel.push(group.name);
        }
    });
    let unexplained = |group: &Group, field: &Field| {
        asked(group, field)
            && field.explanation.is_empty()
            && !of_plant(group, field)
            && !of_groups.contains(&group.name)
            && !of_panel.contains(&group.name)
    };
    assert_eq!(problems(unexplained), [""; 0]);
}

#[test]
fn ranges_fit_their_types_and_optional_fields_explain_null() {
    let optional = |ty: &Type| matches!(ty, Type::Optional(_));
    assert_eq!(problems(|_, field| optional(&field.ty) == field.null_means.is_empty()), [""; 0], "null");
    let bare = |ty: &Type| match *ty {
        Type::Optional(inner) => *inner,
        ty => ty,
    };
    let wrong = |group: &Group, field: &Field| match (field.limit, bare(&field.ty)) {
        (Limit::Type | Limit::Text(_), _) => false,
        (Limit::Whole(min, max), Type::Whole { max: type_max, .. }) => min > max || max > type_max,
        (Limit::Signed(min, max), Type::Whole { min: type_min, .. }) => min > max || min < type_min,
        (Limit::Number(min, max), Type::Number | Type::Group(_)) => min > max,
        // The crate that owns the type validates it as a float.
        (Limit::Number(min, max), Type::Whole { .. }) => min > max || !group.is_external,
        (Limit::Length(min, max, of), Type::Text | Type::List(_)) => min > max || of.is_empty(),
        _ => true,
    };
    assert_eq!(problems(wrong), [""; 0]);
}

#[test]
fn a_condition_names_a_field_and_one_of_its_values() {
    let mut all = Vec::new();
    each(&Scenario::TYPE, "", &mut Vec::new(), &mut |path, _, field| {
        all.push((path.trim_start_matches('.').to_owned(), *field));
    });
    for (path, field) in &all {
        let Some(when) = field.when else { continue };
        let beside = format!("{}.{}", path.rsplit_once('.').map_or("", |(before, _)| before), when.field);
        let other = if when.is_path { when.field } else { beside.as_str() };
        let (_, other) = all.iter().find(|(path, _)| path == other).expect("there is such a field");
        let Type::Word(words) = other.ty else { panic!("{path}: {} is no word", when.field) };
        assert!(words.iter().any(|word| word.name == when.is), "{path}: {}", when.is);
    }
}

#[test]
fn the_schema_of_the_page_has_every_default() {
    let schema: serde_json::Value = serde_json::from_str(&describe()).expect("JSON");
    let mut scenario =
        serde_json::from_str::<serde_json::Value>(&Scenario::default().to_json()).expect("JSON");
    // A plant is written only if there is one.
    scenario["plant"] = serde_json::Value::Null;
    // The same applies to groups, limits, input shapers and the speeds at the ends of moves.
    let motion = &mut scenario["source"]["motion"];
    motion["groups"] = serde_json::json!([]);
    let axis = &mut motion["axes"][0];
    axis["limits"] = schema["groups"]["AxisLimits"]["default"].clone();
    axis["input_shaper"] = serde_json::Value::Null;
    for speed in ["start_speed", "end_speed"] {
        axis["moves"][0]["cosine"][speed] = serde_json::Value::Null;
    }
    assert_eq!(schema["groups"]["Scenario"]["default"], scenario);
    for (name, group) in schema["groups"].as_object().expect("groups") {
        let default = group["default"].as_object().expect("a map");
        let names: Vec<&str> = group["fields"]
            .as_array()
            .expect("fields")
            .iter()
            .filter_map(|field| field["name"].as_str())
            .collect();
        if group["choice"] == true {
            assert!(default.keys().all(|kind| names.contains(&kind.as_str())), "{name}");
        } else {
            let mut sorted = names.clone();
            sorted.sort_unstable();
            assert_eq!(default.keys().map(String::as_str).collect::<Vec<_>>(), sorted, "{name}");
        }
    }
    let ids: Vec<&str> = DOCUMENTS.iter().map(|document| document.id).collect();
    assert!(schema["documents"].as_object().expect("documents").keys().all(|id| ids.contains(&id.as_str())));
}
