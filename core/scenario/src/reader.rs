//! JSON into the scenario's types: one walk that lists every field of the wrong type or name.
//!
//! Each type says by [`Read`] what it takes; the walk itself is code of its own and not of every type, so
//! that the page carries it once. What cannot be read keeps its default. It is stricter than serde, which
//! takes a map's fields from a list, by their order: a scenario has names.

use crate::{Cause, Problem, Validator};
use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use serde_json::{Map, Value};

/// A part of a scenario that JSON can say.
pub trait Read {
    /// Takes a value. False where it is of another kind altogether, which `reader` has noted: then nothing
    /// was taken. A map is taken also where some of its fields are not.
    fn read(&mut self, value: &Value, reader: &mut Reader) -> bool;

    /// What a value is read into where nothing stands yet, such as an entry of a list.
    fn blank() -> Self
    where
        Self: Sized;
}

/// What is wrong with what was read so far, and the way to the value that is being read.
#[derive(Default)]
pub struct Reader {
    validator: Validator,
}

/// Reads a value into `target`; gives every problem, each with its path, at most [`stepscope_motion::problem::MAX_PROBLEMS`].
pub(super) fn read_into(target: &mut dyn Read, value: &Value) -> Vec<Problem> {
    let mut reader = Reader::default();
    target.read(value, &mut reader);
    reader.validator.problems()
}

impl Reader {
    fn note(&mut self, detail: String) {
        self.validator.add("", Cause::Type { detail });
    }

    /// Notes that a value is of another kind, and what would do. Always false.
    pub(super) fn refuse(&mut self, value: &Value, wanted: &str) -> bool {
        self.note(format!("{}; give {wanted}", describe(value)));
        false
    }

    /// Notes what is wrong with a value of the right kind. Always false.
    pub(super) fn wrong(&mut self, detail: String) -> bool {
        self.note(detail);
        false
    }

    /// Reads what stands one step further in, under a name.
    pub(super) fn below(&mut self, name: &str, value: &Value, target: &mut dyn Read) -> bool {
        let outside = self.validator.enter(name);
        let taken = target.read(value, self);
        self.validator.leave(outside);
        taken
    }

    /// Reads an entry of a list.
    pub(super) fn entry(&mut self, index: usize, value: &Value, target: &mut dyn Read) -> bool {
        let outside = self.validator.enter_entry(index);
        let taken = target.read(value, self);
        self.validator.leave(outside);
        taken
    }

    fn map<'v>(&mut self, value: &'v Value, wanted: &str) -> Option<&'v Map<String, Value>> {
        let map = value.as_object();
        if map.is_none() {
            self.refuse(value, wanted);
        }
        map
    }

    /// Reads a map of names and values; those that are not given stay as they are.
    pub(super) fn fields(&mut self, value: &Value, fields: &mut [(&'static str, &mut dyn Read)]) -> bool {
        let Some(map) = self.map(value, "a map of names and values") else { return false };
        for (name, value) in map {
            if let Some((_, target)) = fields.iter_mut().find(|(field, _)| field == name) {
                self.below(name, value, *target);
            } else {
                let names: Vec<&str> = fields.iter().map(|(field, _)| *field).collect();
                let detail = format!("there is no such field; give one of {}", names.join(", "));
                self.validator.add(name, Cause::Type { detail });
            }
        }
        true
    }

    /// The name of a choice, which is in `kinds`, and its value: the only ones of a map.
    pub(super) fn choice<'v>(&mut self, value: &'v Value, kinds: &[&str]) -> Option<(&'v str, &'v Value)> {
        let wanted = "a map of one key that names the choice, such as {\"mm\": 250}";
        let map = self.map(value, wanted)?;
        let (Some((name, content)), 1) = (map.iter().next(), map.len()) else {
            self.note(format!("a map of {} keys; give {wanted}", map.len()));
            return None;
        };
        if kinds.contains(&name.as_str()) {
            return Some((name, content));
        }
        self.note(format!("\u{201c}{name}\u{201d} is no choice here; give one of {}", kinds.join(", ")));
        None
    }

    /// Reads one of some words, and gives its place among them.
    pub(super) fn word(&mut self, value: &Value, words: &[&str]) -> Option<usize> {
        let found = value.as_str().and_then(|text| words.iter().position(|word| *word == text));
        if found.is_none() {
            self.refuse(value, &format!("one of {}", words.join(", ")));
        }
        found
    }
}

/// A value as it is told to people.
fn describe(value: &Value) -> String {
    const LONGEST: usize = 40;
    match value {
        Value::Null => "nothing (null)".into(),
        Value::Bool(_) | Value::Number(_) => value.to_string(),
        Value::String(text) if text.chars().count() > LONGEST => {
            format!("\u{201c}{}\u{2026}\u{201d}", text.chars().take(LONGEST).collect::<String>())
        }
        Value::String(text) => format!("\u{201c}{text}\u{201d}"),
        Value::Array(_) => "a list".into(),
        Value::Object(_) => "a map".into(),
    }
}

macro_rules! whole {
    ($($ty:ty: $as:ident),*) => {$(
        impl Read for $ty {
            fn read(&mut self, value: &Value, reader: &mut Reader) -> bool {
                match value.$as().and_then(|number| Self::try_from(number).ok()) {
                    Some(number) => {
                        *self = number;
                        true
                    }
                    None => reader.refuse(value, &format!("a whole number from {} to {}", Self::MIN, Self::MAX)),
                }
            }

            fn blank() -> Self {
                0
            }
        }
    )*};
}
whole!(u8: as_u64, u16: as_u64, u32: as_u64, u64: as_u64, i64: as_i64);

impl Read for f64 {
    fn read(&mut self, value: &Value, reader: &mut Reader) -> bool {
        match value.as_f64() {
            Some(number) => {
                *self = number;
                true
            }
            None => reader.refuse(value, "a number"),
        }
    }

    fn blank() -> Self {
        0.0
    }
}

impl Read for String {
    fn read(&mut self, value: &Value, reader: &mut Reader) -> bool {
        match value.as_str() {
            Some(text) => {
                *self = text.into();
                true
            }
            None => reader.refuse(value, "a text"),
        }
    }

    fn blank() -> Self {
        Self::new()
    }
}

impl<T: Read> Read for Option<T> {
    fn read(&mut self, value: &Value, reader: &mut Reader) -> bool {
        if value.is_null() {
            *self = None;
            return true;
        }
        let mut inner = T::blank();
        let taken = inner.read(value, reader);
        if taken {
            *self = Some(inner);
        }
        taken
    }

    fn blank() -> Self {
        None
    }
}

impl<T: Read> Read for Vec<T> {
    fn read(&mut self, value: &Value, reader: &mut Reader) -> bool {
        let Some(entries) = value.as_array() else { return reader.refuse(value, "a list") };
        self.clear();
        for (index, entry) in entries.iter().enumerate() {
            // An entry that is not taken stays blank, so that the others keep their places.
            let mut target = T::blank();
            reader.entry(index, entry, &mut target);
            self.push(target);
        }
        true
    }

    fn blank() -> Self {
        Self::new()
    }
}
