//! Writes docs/scenario.md: one section per group, one row per field.

use crate::schema::{Field, Group, Limit, Type, Typed, Word};
use crate::upgrade::{FIELDS, Rename, WORDS};
use crate::{Parts, Scenario, ToParts, VERSION};
use alloc::string::{String, ToString};
use alloc::{format, vec::Vec};
use core::fmt::Write as _;

/// Whole scenarios, which a test of the command runs.
const EXAMPLES: &str = include_str!("examples.md");

/// The documentation of the format, in Markdown.
pub fn markdown() -> String {
    let mut out = format!("# The scenario format, version {VERSION}\n\n{EXAMPLES}\n## Fields\n\n");
    let mut done = Vec::new();
    if let Type::Group(root) = Scenario::TYPE {
        section(&mut out, root, ("", ""), &mut done);
    }
    quantities(&mut out, &done);
    former_names(&mut out);
    out.push_str(
        "## Links\n\nA link contains a scenario, and can contain the view and the digests of a run: [links.md](links.md).\n",
    );
    out
}

/// Writes a group, then its groups at their first occurrence.
fn section(
    out: &mut String,
    group: &'static Group,
    (path, label): (&str, &str),
    done: &mut Vec<&'static Group>,
) {
    if done.iter().any(|other| other.name == group.name) {
        return;
    }
    done.push(group);
    if is_quantity(group) {
        return;
    }
    if !path.is_empty() {
        let _ = writeln!(out, "## `{path}`: {label}\n");
    }
    write_doc(out, group.doc);
    if group.is_choice {
        out.push_str("| kind | | meaning |\n| --- | --- | --- |\n");
        for kind in group.fields {
            let _ = writeln!(out, "| `{}` | {} | {} |", kind.name, kind.label, one_line(kind.doc));
        }
    } else if !group.fields.is_empty() {
        out.push_str("| field | unit, range | default | meaning |\n| --- | --- | --- | --- |\n");
        let blank = (group.blank)();
        if let Parts::Fields(_, values) = blank.parts() {
            for (field, (value, _)) in group.fields.iter().zip(values) {
                field_row(out, field, value);
            }
        }
    }
    out.push('\n');
    for field in group.fields {
        let below = if path.is_empty() { field.name.to_string() } else { format!("{path}.{}", field.name) };
        sections_of_type(out, &field.ty, (&below, field.label), done);
    }
}

fn sections_of_type(
    out: &mut String,
    ty: &Type,
    (path, label): (&str, &str),
    done: &mut Vec<&'static Group>,
) {
    match ty {
        Type::Group(group) => section(out, group, (path, label), done),
        Type::Optional(inner) => sections_of_type(out, inner, (path, label), done),
        Type::List(inner) => sections_of_type(out, inner, (&format!("{path}[]"), label), done),
        _ => {}
    }
}

fn field_row(out: &mut String, field: &Field, default: &dyn ToParts) {
    let quantity = quantity_of(&field.ty).map(|group| group.name.to_lowercase());
    let unit = quantity.as_deref().unwrap_or(field.unit);
    let range = range_of(field);
    let mut allowed: Vec<&str> = [unit, &range].into_iter().filter(|text| !text.is_empty()).collect();
    match field.ty {
        Type::Optional(Type::Group(group)) if !is_quantity(group) => allowed.push("`null`, or as below"),
        Type::Optional(_) => allowed.push("or `null`"),
        _ => {}
    }
    let mut meaning = one_line(field.doc);
    let stop = meaning.pop().filter(|last| *last != '.');
    meaning.extend(stop);
    if let Type::Word(words) = field.ty {
        let each = |word: &Word| format!("`\"{}\"` {}", word.name, one_line(word.doc));
        let _ = write!(meaning, ": {}", words.iter().map(each).collect::<Vec<_>>().join("; "));
    }
    if !field.null_means.is_empty() {
        let _ = write!(meaning, "; `null`: {}", field.null_means);
    }
    if let Some(when) = field.when {
        let _ = write!(meaning, "; only where `{}` is `\"{}\"`", when.field, when.is);
    }
    let _ = writeln!(
        out,
        "| `{}` | {} | {} | {meaning} |",
        field.name,
        allowed.join(", ").replace(", or `", " or `"),
        default_of(&field.ty, default)
    );
}

/// Groups with their own section are left out.
fn default_of(ty: &Type, default: &dyn ToParts) -> String {
    match (ty, default.parts()) {
        (Type::Group(group) | Type::Optional(Type::Group(group)), Parts::Kind(name, value))
            if is_quantity(group) =>
        {
            let unit = group.fields.iter().find(|kind| kind.name == name).map_or("", |kind| kind.label);
            format!("{} {unit}", value_text(value))
        }
        (Type::Group(_), Parts::Kind(name, _)) => format!("`{name}`"),
        (Type::Group(_), _) => "see below".into(),
        (Type::List(Type::Point), _) => format!("`{}`", value_text(default)),
        (Type::List(_), Parts::List(entries)) if entries.is_empty() => "none".into(),
        (Type::List(_), Parts::List(entries)) => {
            format!("{} of them", entries.len()).replace("1 of them", "one")
        }
        (Type::Text, Parts::Value(value)) if value.as_str().is_some_and(|text| !text.is_empty()) => {
            format!("`{value}`")
        }
        (Type::Text | Type::Hex, _) => "empty".into(),
        (Type::Word(_) | Type::Optional(_), _) => format!("`{}`", value_text(default)),
        _ => value_text(default),
    }
}

fn value_text(value: &dyn ToParts) -> String {
    match value.parts() {
        Parts::Number(number) => number.to_string(),
        Parts::List(entries) => {
            let entries: Vec<String> = entries.into_iter().map(value_text).collect();
            format!("[{}]", entries.join(", "))
        }
        Parts::Value(value) => value.to_string(),
        Parts::Fields(..) | Parts::Kind(..) => String::new(),
    }
}

/// Empty if every value of the type is allowed.
pub(crate) fn range_of(field: &Field) -> String {
    match field.limit {
        Limit::Whole(min, max) => format!("{} to {}", power(min as f64), power(max as f64)),
        Limit::Signed(min, max) => format!("{} to {}", signed(min), signed(max)),
        Limit::Number(min, max) => match quantity_of(&field.ty) {
            Some(_) => format!("{} to {} {}", power(min), power(max), field.unit),
            None => format!("{} to {}", power(min), power(max)),
        },
        Limit::Length(0, max, of) => format!("up to {max} {of}"),
        Limit::Length(min, max, of) => format!("{min} to {max} {of}"),
        Limit::Text(words) => words.into(),
        Limit::Type => match field.ty {
            Type::Whole { min, max } => format!("{} to {}", binary(min.into()), binary(max.into())),
            _ => String::new(),
        },
    }
}

fn binary(bound: i128) -> String {
    match bound {
        0..=255 => bound.to_string(),
        _ if bound < 0 => format!("-2^{}", bound.unsigned_abs().trailing_zeros()),
        _ => format!("2^{} - 1", (bound + 1).trailing_zeros()),
    }
}

fn signed(bound: i64) -> String {
    let size = bound.unsigned_abs();
    if size > 1 << 20 && size.is_power_of_two() {
        return format!("{}2^{}", if bound < 0 { "-" } else { "" }, size.trailing_zeros());
    }
    power(bound as f64)
}

/// Large and small numbers as a power of ten, one less than that, or a power of two.
fn power(number: f64) -> String {
    let magnitude = libm::fabs(number);
    if magnitude == 0.0 || (1e-3..1e6).contains(&magnitude) {
        return number.to_string();
    }
    let ten = |number: f64| match format!("{number:e}").split_once('e') {
        Some(("1", power)) => Some(format!("10^{power}")),
        Some(("-1", power)) => Some(format!("-10^{power}")),
        Some((digits, power)) if digits.len() <= 4 => Some(format!("{digits}*10^{power}")),
        _ => None,
    };
    ten(number)
        .or_else(|| (number as u64).wrapping_add(1).is_power_of_two().then(|| binary(number as i128)))
        .or_else(|| ten(number + 1.0).map(|text| format!("{text} - 1")))
        .unwrap_or_else(|| number.to_string())
}

fn write_doc(out: &mut String, doc: &str) {
    for line in doc.lines() {
        let _ = writeln!(out, "{}", line.strip_prefix(' ').unwrap_or(line));
    }
    out.push('\n');
}

fn one_line(doc: &str) -> String {
    doc.trim().replace('|', "\\|")
}

fn is_quantity(group: &Group) -> bool {
    group.is_choice && group.fields.iter().all(|kind| matches!(kind.ty, Type::Number))
}

fn quantity_of(ty: &Type) -> Option<&'static Group> {
    match ty {
        Type::Group(group) | Type::Optional(Type::Group(group)) if is_quantity(group) => Some(group),
        _ => None,
    }
}

fn former_names(out: &mut String) {
    out.push_str("## Former names\n\nNames of versions 1 and 2. They are accepted up to that version, and in a scenario without `version`.\n\n");
    out.push_str("| former name | up to version | name |\n| --- | --- | --- |\n");
    for Rename { old, new, last_version } in
        FIELDS.iter().chain(WORDS).filter(|one| one.last_version < VERSION)
    {
        let _ = writeln!(out, "| `{old}` | {last_version} | `{new}` |");
    }
    out.push('\n');
}

fn quantities(out: &mut String, groups: &[&'static Group]) {
    out.push_str("## Numbers with a unit\n\nAn object with one key, the unit: `{ \"mm\": 250 }`.\n\n");
    out.push_str("| | units | |\n| --- | --- | --- |\n");
    for group in groups.iter().filter(|group| is_quantity(group)) {
        let units = group.fields.iter().map(|kind| format!("`{}`", kind.name)).collect::<Vec<_>>();
        let _ = writeln!(
            out,
            "| {} | {} | {} |",
            group.name.to_lowercase(),
            units.join(", "),
            one_line(group.doc)
        );
    }
    out.push('\n');
}
