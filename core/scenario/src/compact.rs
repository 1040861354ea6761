//! Writes scenario types as JSON: canonical (for links), whole, or short.

use crate::schema::{Parts, ToParts};
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use serde_json::{Map, Value};

/// A value with a canonical JSON: fixed order, defaults omitted. Equal values have equal canonical JSON, and reading
/// it returns an equal value.
pub trait Compact: ToParts {
    /// The canonical JSON.
    fn compact(&self) -> Value
    where
        Self: Sized,
    {
        value_of(self.parts(), Fields::Differing)
    }
}

impl<T: ToParts> Compact for T {}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Fields {
    Differing,
    All,
}

pub(super) fn value_of(parts: Parts<'_>, which: Fields) -> Value {
    match parts {
        Parts::Value(value) => value,
        // -0.0 equals 0.0 and is written the same.
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

/// Writes all fields like `serde_json::to_string_pretty`, starting at depth `indent`. Stops when the text exceeds
/// `max_bytes` bytes.
pub(super) fn write_whole(out: &mut String, value: &dyn ToParts, indent: usize, max_bytes: usize) {
    if out.len() > max_bytes {
        return;
    }
    let begin_line = |out: &mut String, first: bool| {
        out.push_str(if first { "\n" } else { ",\n" });
        (0..=indent).for_each(|_| out.push_str("  "));
    };
    let named = |out: &mut String, name: &str, value: &dyn ToParts| {
        out.push_str(&alloc::format!("\"{name}\": "));
        write_whole(out, value, indent + 1, max_bytes);
    };
    let brackets = match value.parts() {
        Parts::Value(value) => return out.push_str(&value.to_string()),
        Parts::Number(number) => return out.push_str(&Value::from(number).to_string()),
        Parts::List(entries) if entries.is_empty() => return out.push_str("[]"),
        Parts::Fields(_, values) if values.is_empty() => return out.push_str("{}"),
        Parts::List(entries) => {
            out.push('[');
            for (index, entry) in entries.into_iter().enumerate() {
                begin_line(out, index == 0);
                write_whole(out, entry, indent + 1, max_bytes);
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

/// Gives the version of all names, so it is always written.
const VERSION: &str = "version";

/// Writes without defaults and indentation: one list entry per line, numbers in a row. Stops when the text exceeds
/// `max_bytes` bytes.
pub(super) fn write_short(out: &mut String, value: &dyn ToParts, max_bytes: usize) {
    if out.len() > max_bytes {
        return;
    }
    match value.parts() {
        Parts::Value(value) => out.push_str(&value.to_string()),
        Parts::Number(number) => out.push_str(&Value::from(number + 0.0).to_string()),
        Parts::List(entries) => {
            let is_plain = |entry: &&dyn ToParts| matches!(entry.parts(), Parts::Value(_) | Parts::Number(_));
            let between = if entries.first().is_none_or(is_plain) { "" } else { "\n" };
            out.push('[');
            for (index, entry) in entries.into_iter().enumerate() {
                out.push_str(if index == 0 { "" } else { "," });
                out.push_str(between);
                write_short(out, entry, max_bytes);
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
                write_short(out, value, max_bytes);
            }
            out.push('}');
        }
        Parts::Kind(name, value) => {
            out.push_str(&alloc::format!("{{\"{name}\":"));
            write_short(out, value, max_bytes);
            out.push('}');
        }
    }
}

macro_rules! plain {
    ($($ty:ty),*) => {$(
        impl ToParts for $ty {
            fn parts(&self) -> Parts<'_> {
                Parts::Value(Value::from(self.clone()))
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
        self.as_ref().map_or(Parts::Value(Value::Null), ToParts::parts)
    }
}

impl<T: ToParts> ToParts for Vec<T> {
    fn parts(&self) -> Parts<'_> {
        Parts::List(self.iter().map(|entry| entry as &dyn ToParts).collect())
    }
}

/// The names of a choice's kinds in JSON.
pub trait Kinds {
    /// Names in declaration order.
    const KINDS: &'static [&'static str];
}
