//! The JSON Schema accepts what the reader accepts, and rejects what the reader rejects.

use jsonschema::Validator;
use serde_json::Value;
use stepscope_scenario::{
    Compact, Scenario,
    presets::{CONTROLLER_PRESETS, PLANT_PRESETS, PRESETS},
    schema::json_schema,
};

fn validator() -> Validator {
    let schema: Value = serde_json::from_str(&json_schema()).expect("JSON");
    jsonschema::draft202012::meta::validate(&schema).expect("a schema of its draft");
    jsonschema::draft202012::new(&schema).expect("a schema")
}

fn errors(validator: &Validator, json: &str) -> Vec<String> {
    let value: Value = serde_json::from_str(json).expect("JSON");
    validator.iter_errors(&value).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

#[test]
fn the_schema_accepts_every_preset_in_every_form() {
    let validator = validator();
    for preset in PRESETS.iter().chain(PLANT_PRESETS).chain(CONTROLLER_PRESETS) {
        let scenario: Scenario = preset.json.parse().expect(preset.id);
        for json in [preset.json.to_owned(), scenario.to_json(), scenario.compact().to_string()] {
            assert_eq!(errors(&validator, &json), [""; 0], "{}", preset.id);
        }
    }
    assert_eq!(errors(&validator, "{}"), [""; 0]);
}

#[test]
fn the_schema_rejects_invalid_names_types_and_ranges() {
    let validator = validator();
    let rows = [
        (r#"[]"#, ""),
        (r#"{"bus":{"slot":3}}"#, "/bus"),
        (r#"{"bus":{"slots":128}}"#, "/bus/slots"),
        (r#"{"bus":{"slots":"100"}}"#, "/bus/slots"),
        (r#"{"bus":{"distribution":"evenly"}}"#, "/bus/distribution"),
        (r#"{"title":5}"#, "/title"),
        (r#"{"clock_hz":1.5}"#, "/clock_hz"),
        (r#"{"source":{}}"#, "/source"),
        (r#"{"source":{"motion":{},"packets":{}}}"#, "/source"),
        (r#"{"source":{"motion":{"axes":[{"moves":[{"dwel":{}}]}]}}}"#, "/source/motion/axes/0/moves/0"),
        (r#"{"source":{"packets":{"packets":["8z"]}}}"#, "/source/packets/packets/0"),
        (r#"{"source":{"packets":{"packets":["801"]}}}"#, "/source/packets/packets/0"),
        (
            r#"{"source":{"motion":{"axes":[{"moves":[{"points":{"points":[[0,0],[1]]}}]}]}}}"#,
            "/source/motion/axes/0/moves/0/points/points/1",
        ),
    ];
    for (json, path) in rows {
        let found = errors(&validator, json);
        assert!(found.iter().any(|error| error.starts_with(&format!("{path}: "))), "{json}: {found:?}");
        let is_refused = json.parse::<Scenario>().and_then(|scenario| scenario.check()).is_err();
        assert!(is_refused, "{json}");
    }
    for json in [r#"{"source":{"packets":{"packets":["80 01\n7F"]}}}"#, r#"{"clock_hz":16e6}"#] {
        assert_eq!(errors(&validator, json), [""; 0], "{json}");
        assert!(json.parse::<Scenario>().is_ok(), "{json}");
    }
}
