//! The scenario's types as JSON: the canonical form that a link carries, fixed in order, with what equals its default
//! left out; and the whole form, every field written.

use crate::schema::{Parts, ToParts};
use alloc::{
    string::{String, ToString},
    vec::Vec,
};
use serde_json::{Map, Value};

/// A value with a canonical JSON: fixed order, defaults left out.
///
/// Reading it back gives an equal value, and equal values have the same canonical form.
pub trait Compact: ToParts {
    /// The canonical form.
    fn compact(&self) -> Value
    where
        Self: Sized,
    {
        value_of(self.parts(), Fields::Differing)
    }
}

impl<T: ToParts> Compact for T {}

/// Which fields are written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Fields {
    /// Those that differ from their defaults.
    Differing,
    /// Every one.
    All,
}

/// A value as JSON.
pub(super) fn value_of(parts: Parts<'_>, which: Fields) -> Value {
    match parts {
        Parts::Whole(value) => value,
        // -0.0 equals 0.0, so it is written like it.
        Parts::Number(number) => Value::from(number + 0.0),
        Parts::List(entries) => entries.into_iter().map(|entry| value_of(entry.parts(), which)).collect(),
        Parts::Fields(group, values) => {
            let mut map = Map::new();
            for (field, (value, differs)) in group.fields.iter().zip(values) {
                if differs || which == Fields::All {
                    map.insert(field.name.to_string(), value_of(value.parts(), which));
                }
            }
            Value::Object(map)
        }
        Parts::Kind(name, value) => {
            let mut map = Map::new();
            map.insert(name.to_string(), value_of(value.parts(), which));
            Value::Object(map)
        }
    }
}

/// Writes a value with all its fields in the order of their declaration, as
/// `serde_json::to_string_pretty` does; `indent` is the depth of the line that it begins in. A text that gets longer than `most`
/// bytes is left where it is.
pub(super) fn write_whole(out: &mut String, value: &dyn ToParts, indent: usize, most: usize) {
    if out.len() > most {
        return;
    }
    let begin_line = |out: &mut String, first: bool| {
        out.push_str(if first { "\n" } else { ",\n" });
        (0..=indent).for_each(|_| out.push_str("  "));
    };
    let named = |out: &mut String, name: &str, value: &dyn ToParts| {
        out.push_str(&alloc::format!("\"{name}\": "));
        write_whole(out, value, indent + 1, most);
    };
    let brackets = match value.parts() {
        Parts::Whole(value) => return out.push_str(&value.to_string()),
        Parts::Number(number) => return out.push_str(&Value::from(number).to_string()),
        Parts::List(entries) if entries.is_empty() => return out.push_str("[]"),
        Parts::Fields(_, values) if values.is_empty() => return out.push_str("{}"),
        Parts::List(entries) => {
            out.push('[');
            for (index, entry) in entries.into_iter().enumerate() {
                begin_line(out, index == 0);
                write_whole(out, entry, indent + 1, most);
            }
            ']'
        }
        Parts::Fields(group, values) => {
            out.push('{');
            let written = group.fields.iter().zip(values);
            let written = written.filter(|(field, (_, differs))| *differs || !field.only_if_set);
            for (index, (field, (value, _))) in written.enumerate() {
                begin_line(out, index == 0);
                named(out, field.name, value);
            }
            '}'
        }
        Parts::Kind(name, value) => {
            out.push('{');
            begin_line(out, true);
            named(out, name, value);
            '}'
        }
    };
    out.push('\n');
    (0..indent).for_each(|_| out.push_str("  "));
    out.push(brackets);
}

/// The name of the field that says which names the others have: it is written wherever a text stands by itself.
const VERSION: &str = "version";

/// Writes a value without the fields that are at their defaults, and without indentation: the entries of a list one per line,
/// numbers side by side. Half as long as the whole form or less. A text that gets longer than `most` bytes is left where it is.
pub(super) fn write_short(out: &mut String, value: &dyn ToParts, most: usize) {
    if out.len() > most {
        return;
    }
    match value.parts() {
        Parts::Whole(value) => out.push_str(&value.to_string()),
        Parts::Number(number) => out.push_str(&Value::from(number + 0.0).to_string()),
        Parts::List(entries) => {
            let is_plain = |entry: &&dyn ToParts| matches!(entry.parts(), Parts::Whole(_) | Parts::Number(_));
            let between = if entries.first().is_none_or(is_plain) { "" } else { "\n" };
            out.push('[');
            for (index, entry) in entries.into_iter().enumerate() {
                out.push_str(if index == 0 { "" } else { "," });
                out.push_str(between);
                write_short(out, entry, most);
            }
            out.push_str(between);
            out.push(']');
        }
        Parts::Fields(group, values) => {
            out.push('{');
            let written = group.fields.iter().zip(values);
            let written = written.filter(|(field, (_, differs))| *differs || field.name == VERSION);
            for (index, (field, (value, _))) in written.enumerate() {
                out.push_str(if index == 0 { "" } else { "," });
                out.push_str(&alloc::format!("\"{}\":", field.name));
                write_short(out, value, most);
            }
            out.push('}');
        }
        Parts::Kind(name, value) => {
            out.push_str(&alloc::format!("{{\"{name}\":"));
            write_short(out, value, most);
            out.push('}');
        }
    }
}

macro_rules! plain {
    ($($ty:ty),*) => {$(
        impl ToParts for $ty {
            fn parts(&self) -> Parts<'_> {
                Parts::Whole(Value::from(self.clone()))
            }
        }
    )*};
}
plain!(u8, u16, u32, u64, i64, String);
plain!(bool);

impl ToParts for f64 {
    fn parts(&self) -> Parts<'_> {
        Parts::Number(*self)
    }
}

impl<T: ToParts> ToParts for Option<T> {
    fn parts(&self) -> Parts<'_> {
        self.as_ref().map_or(Parts::Whole(Value::Null), ToParts::parts)
    }
}

impl<T: ToParts> ToParts for Vec<T> {
    fn parts(&self) -> Parts<'_> {
        Parts::List(self.iter().map(|entry| entry as &dyn ToParts).collect())
    }
}

/// The names of all kinds of a choice, as JSON writes them.
pub trait Kinds {
    /// In the order of their declaration.
    const KINDS: &'static [&'static str];
}
