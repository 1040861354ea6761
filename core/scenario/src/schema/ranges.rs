//! Checks single numbers and lengths against their rows. Other crates check their own types.

use crate::{
    Parts, ToParts, Validator, ValueError,
    schema::{Field, Group, Limit, Type},
};
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
        Parts::Whole(_) | Parts::Number(_) => {}
    }
}

fn check_field(field: &Field, value: &dyn ToParts, validator: &mut Validator) {
    match field.limit {
        Limit::Type | Limit::Follows(_) => {}
        Limit::Whole(least, most) => {
            if let Parts::Whole(Value::Number(number)) = value.parts()
                && let Some(given) = number.as_u64()
            {
                validator.whole("", given, least..=most, field.unit);
            }
        }
        Limit::Signed(least, most) => {
            if let Parts::Whole(Value::Number(number)) = value.parts()
                && let Some(given) = number.as_i64()
                && !(least..=most).contains(&given)
            {
                let (given, least, most) = (given as f64, least as f64, most as f64);
                validator.add("", ValueError::Range { given, min: least, max: most, unit: field.unit });
            }
        }
        Limit::Number(least, most) => {
            if let Parts::Number(given) = value.parts()
                && !(least..=most).contains(&given)
            {
                validator.add("", ValueError::Range { given, min: least, max: most, unit: field.unit });
            }
        }
        Limit::Length(least, most, of) => {
            let given = match value.parts() {
                Parts::Whole(Value::String(text)) => text.chars().count(),
                Parts::List(entries) => entries.len(),
                _ => least,
            };
            validator.length("", given, least..=most, of);
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
                !matches!(field.limit, Limit::Type | Limit::Follows(_)) || holds_limits(&field.ty)
            };
            !group.is_external && group.fields.iter().any(is_checked)
        }
        Type::Optional(inner) | Type::List(inner) => holds_limits(inner),
        _ => false,
    }
}
