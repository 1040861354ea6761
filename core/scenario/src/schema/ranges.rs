//! Checks single numbers and lengths against their rows. Other crates check their own types.

use crate::schema::{Field, Group, Limit, Type};
use crate::{Parts, ToParts, Validator, ValueError};
use serde_json::Value;

pub(crate) fn check_ranges(part: &dyn ToParts, validator: &mut Validator) {
    match part.parts() {
        Parts::Fields(Group { is_external: true, .. }, _) => {}
        Parts::Fields(group, values) => {
            for (field, (value, _)) in group.fields.iter().zip(values) {
                let outside = validator.enter(field.name);
                check_field(field, value, validator);
                validator.leave(outside);
            }
        }
        Parts::Kind(name, value) => validator.at(name, |here| check_ranges(value, here)),
        Parts::List(entries) => {
            for (index, entry) in entries.into_iter().enumerate() {
                validator.at_entry(index, |here| check_ranges(entry, here));
            }
        }
        Parts::Value(_) | Parts::Number(_) => {}
    }
}

fn check_field(field: &Field, value: &dyn ToParts, validator: &mut Validator) {
    match field.limit {
        Limit::Type | Limit::Text(_) => {}
        Limit::Whole(min, max) => {
            if let Parts::Value(Value::Number(number)) = value.parts()
                && let Some(given) = number.as_u64()
            {
                validator.whole("", given, min..=max, field.unit);
            }
        }
        Limit::Signed(min, max) => {
            if let Parts::Value(Value::Number(number)) = value.parts()
                && let Some(given) = number.as_i64()
                && !(min..=max).contains(&given)
            {
                let (given, min, max) = (given as f64, min as f64, max as f64);
                validator.add("", ValueError::Range { given, min, max, unit: field.unit });
            }
        }
        Limit::Number(min, max) => {
            if let Parts::Number(given) = value.parts()
                && !(min..=max).contains(&given)
            {
                validator.add("", ValueError::Range { given, min, max, unit: field.unit });
            }
        }
        Limit::Length(min, max, of) => {
            let given = match value.parts() {
                Parts::Value(Value::String(text)) => text.chars().count(),
                Parts::List(entries) => entries.len(),
                _ => min,
            };
            validator.length("", given, min..=max, of);
        }
    }
    if holds_limits(&field.ty) {
        check_ranges(value, validator);
    }
}

/// Long lists of types without limits are not walked.
fn holds_limits(ty: &Type) -> bool {
    match ty {
        Type::Group(group) => {
            let is_checked = |field: &Field| {
                !matches!(field.limit, Limit::Type | Limit::Text(_)) || holds_limits(&field.ty)
            };
            !group.is_external && group.fields.iter().any(is_checked)
        }
        Type::Optional(inner) | Type::List(inner) => holds_limits(inner),
        _ => false,
    }
}
