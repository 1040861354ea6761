//! The schema as JSON Schema (draft 2020-12), for editors and for programs that write scenarios.
//!
//! It has the names of the newest version. Rules between fields, and ranges that depend on other fields, are left to
//! [`Scenario::check`].

use crate::schema::{Field, Group, Limit, Type, Typed, Word, markdown::range_of};
use crate::{Scenario, VERSION, compact};
use alloc::format;
use alloc::string::String;
use serde_json::{Map, Value, json};

const DRAFT: &str = "https://json-schema.org/draft/2020-12/schema";
/// Pairs of digits, with ASCII white space anywhere.
const HEX: &str = r"^[ \t\n\f\r]*([0-9a-fA-F][ \t\n\f\r]*[0-9a-fA-F][ \t\n\f\r]*)*$";

/// The JSON Schema of a scenario, as text with indentation and a line feed at its end.
pub fn json_schema() -> String {
    let mut groups = Map::new();
    let root = schema_of(&Scenario::TYPE, Limit::Type, &mut groups);
    let mut schema = json!({
        "$schema": DRAFT,
        "title": "Stepscope scenario",
        "description": format!("A scenario of Stepscope, version {VERSION}. Every field has a default."),
        "$defs": groups,
    });
    if let (Value::Object(schema), Value::Object(root)) = (&mut schema, root) {
        schema.extend(root);
    }
    format!("{schema:#}\n")
}

fn schema_of(ty: &Type, limit: Limit, groups: &mut Map<String, Value>) -> Value {
    match ty {
        Type::Whole { min, max } => match limit {
            Limit::Whole(min, max) => json!({ "type": "integer", "minimum": min, "maximum": max }),
            Limit::Signed(min, max) => json!({ "type": "integer", "minimum": min, "maximum": max }),
            Limit::Number(min, max) => json!({ "type": "integer", "minimum": min, "maximum": max }),
            _ => json!({ "type": "integer", "minimum": min, "maximum": max }),
        },
        Type::Number => match limit {
            Limit::Number(min, max) => json!({ "type": "number", "minimum": min, "maximum": max }),
            _ => json!({ "type": "number" }),
        },
        Type::Bool => json!({ "type": "boolean" }),
        Type::Text => match limit {
            Limit::Length(min, max, _) => json!({ "type": "string", "minLength": min, "maxLength": max }),
            _ => json!({ "type": "string" }),
        },
        Type::Hex => json!({ "type": "string", "pattern": HEX }),
        Type::Point => json!({
            "type": "array",
            "prefixItems": [{ "type": "number", "title": "time in s" }, { "type": "number", "title": "position" }],
            "minItems": 2,
            "maxItems": 2,
        }),
        Type::Word(words) => json!({ "enum": words.iter().flat_map(spellings).collect::<Value>() }),
        Type::Group(group) => {
            if !groups.contains_key(group.name) {
                groups.insert(group.name.into(), Value::Null);
                let described = group_of(group, groups);
                groups.insert(group.name.into(), described);
            }
            json!({ "$ref": format!("#/$defs/{}", group.name) })
        }
        Type::Optional(inner) => json!({ "anyOf": [schema_of(inner, limit, groups), { "type": "null" }] }),
        Type::List(inner) => {
            let items = schema_of(inner, Limit::Type, groups);
            match limit {
                Limit::Length(min, max, _) => {
                    json!({ "type": "array", "items": items, "minItems": min, "maxItems": max })
                }
                _ => json!({ "type": "array", "items": items }),
            }
        }
    }
}

/// A word of digits may also be written as a number.
fn spellings(word: &Word) -> impl Iterator<Item = Value> {
    let number = word.name.parse::<u64>().ok().map(Value::from);
    [Value::from(word.name)].into_iter().chain(number)
}

fn group_of(group: &Group, groups: &mut Map<String, Value>) -> Value {
    let default = compact::value_of((group.blank)().parts(), compact::Fields::All);
    let mut properties = Map::new();
    for field in group.fields {
        let mut schema = schema_of(&field.ty, field.limit, groups);
        if let Value::Object(schema) = &mut schema {
            schema.insert("title".into(), field.label.into());
            schema.insert("description".into(), description(field).into());
            if let Some(default) = default.get(field.name).filter(|_| !group.is_choice) {
                schema.insert("default".into(), default.clone());
            }
        }
        properties.insert(field.name.into(), schema);
    }
    let mut schema = json!({
        "type": "object",
        "description": group.doc.trim(),
        "properties": properties,
        "additionalProperties": false,
    });
    if let (Value::Object(schema), true) = (&mut schema, group.is_choice) {
        schema.insert("minProperties".into(), 1.into());
        schema.insert("maxProperties".into(), 1.into());
    }
    schema
}

/// The field's documentation, its unit or range where the schema cannot state it, and the meaning of null.
fn description(field: &Field) -> String {
    let mut text = String::from(field.text());
    match (field.limit, field.unit) {
        (Limit::Text(_), "") => text += &format!(" Range: {}.", range_of(field)),
        (Limit::Text(_), unit) => text += &format!(" Unit: {unit}; range: {}.", range_of(field)),
        (Limit::Number(..), _) if matches!(field.ty, Type::Group(_)) => {
            text += &format!(" Range: {}.", range_of(field));
        }
        (_, "") => {}
        (_, unit) => text += &format!(" Unit: {unit}."),
    }
    if !field.null_means.is_empty() {
        text += &format!(" null: {}.", field.null_means);
    }
    text
}
