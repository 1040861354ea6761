//! The schema as JSON, for the page:
//!
//! ```text
//! { root: "Scenario", documents: { id: { short, title } },
//!   groups: { Bus: { doc, choice: false, default: { … }, fields: [ { name, label, text, type, unit, range, … } ] }, … } }
//! type: "whole" | "number" | "bool" | "text" | "hex" | "point" | { words: [ { name, label, text } ] } | { group: "Bus" }
//!       | { optional: type } | { list: type }
//! ```

use crate::schema::{DOCUMENTS, Field, Group, Limit, Type, Typed, When, markdown::range_of};
use crate::{Scenario, compact};
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use serde_json::{Map, Value, json};

/// The schema as JSON text.
pub fn describe() -> String {
    let mut groups = Map::new();
    let root = type_of(&Scenario::TYPE, &mut groups);
    let mut documents = Map::new();
    for document in DOCUMENTS {
        documents.insert(document.id.into(), json!({ "short": document.short, "title": document.title }));
    }
    json!({ "root": root, "documents": documents, "groups": groups }).to_string()
}

fn type_of(ty: &Type, groups: &mut Map<String, Value>) -> Value {
    match ty {
        Type::Whole { .. } => "whole".into(),
        Type::Number => "number".into(),
        Type::Bool => "bool".into(),
        Type::Text => "text".into(),
        Type::Hex => "hex".into(),
        Type::Point => "point".into(),
        Type::Word(words) => {
            let word = |word: &crate::schema::Word| json!({ "name": word.name, "label": word.label, "text": word.doc.trim() });
            json!({ "words": words.iter().map(word).collect::<Vec<_>>() })
        }
        Type::Group(group) => {
            if !groups.contains_key(group.name) {
                groups.insert(group.name.into(), Value::Null);
                let described = group_of(group, groups);
                groups.insert(group.name.into(), described);
            }
            json!({ "group": group.name })
        }
        Type::Optional(inner) => json!({ "optional": type_of(inner, groups) }),
        Type::List(inner) => json!({ "list": type_of(inner, groups) }),
    }
}

fn group_of(group: &Group, groups: &mut Map<String, Value>) -> Value {
    let fields: Vec<Value> = group.fields.iter().map(|field| field_of(field, groups)).collect();
    let default = compact::value_of((group.blank)().parts(), compact::Fields::All);
    json!({ "doc": group.doc.trim(), "choice": group.is_choice, "default": default, "fields": fields })
}

fn field_of(field: &Field, groups: &mut Map<String, Value>) -> Value {
    let mut map = Map::new();
    let texts = [
        ("name", field.name),
        ("label", field.label),
        ("text", field.text()),
        ("unit", field.unit),
        ("empty", field.null_means),
        ("term", field.term),
        ("explained", field.explanation),
        ("from", field.document.map_or("", |document| document.id)),
    ];
    for (name, text) in texts.into_iter().filter(|(_, text)| !text.is_empty()) {
        map.insert(name.into(), text.into());
    }
    map.insert("type".into(), type_of(&field.ty, groups));
    map.insert("range".into(), range_of(field).into());
    if let Limit::Length(_, max, _) = field.limit {
        map.insert("most".into(), max.into());
    }
    if let Some(When { field, is_path, is }) = field.when {
        map.insert("when".into(), json!({ if is_path { "path" } else { "key" }: field, "is": is }));
    }
    Value::Object(map)
}
