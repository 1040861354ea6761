//! Reads JSON into the scenario's types in one pass and reports every field with a wrong type or name.
//!
//! Unreadable values keep their defaults. Unlike serde, this does not accept a list for an object.

use crate::schema::{Field, Group, Limit, Type};
use crate::upgrade::{self, Rename};
use crate::{Cause, Json, Problems, Validator};
use alloc::string::{String, ToString};
use alloc::{borrow::ToOwned, format, vec::Vec};
use core::{fmt::Display, mem::size_of};

/// Limits memory: a short text can contain very many empty entries.
const MAX_LIST_BYTES: usize = 256 << 20;

/// A type that can be read from JSON.
pub trait ReadJson {
    /// Reads a value. Returns false, noted in `reader`, if it has the wrong type.
    fn read(&mut self, value: Json<'_>, reader: &mut JsonReader) -> bool;

    /// The initial value of a list entry.
    fn blank() -> Self
    where
        Self: Sized;
}

/// Path, problems and rules while reading.
#[derive(Default)]
pub struct JsonReader {
    validator: Validator,
    row: Option<&'static Field>,
    /// Version of the text, which decides which old names are accepted.
    version: u32,
}

/// Returns all problems, at most [`stepscope_motion::MAX_PROBLEMS`].
pub(super) fn read_into(target: &mut dyn ReadJson, value: Json<'_>, version: u32) -> Option<Problems> {
    let mut reader = JsonReader { version, ..JsonReader::default() };
    target.read(value, &mut reader);
    reader.validator.problems()
}

impl JsonReader {
    fn note(&mut self, detail: String) {
        self.validator.add("", Cause::Type { detail });
    }

    /// Reports a wrong type; always returns false.
    pub(super) fn reject_type(&mut self, value: Json<'_>, expected: &str) -> bool {
        self.note(format!("{} is not valid; use {expected}", describe(value)));
        false
    }

    /// Reports a wrong value; always returns false.
    pub(super) fn reject(&mut self, detail: String) -> bool {
        self.note(detail);
        false
    }

    /// Reports the field's own range, if it has one. `kind` is what the value should be, or `None` if it is only out of
    /// range.
    fn reject_number(
        &mut self,
        value: Json<'_>,
        kind: Option<&str>,
        range: Option<(&dyn Display, &dyn Display)>,
    ) -> bool {
        let row = self.row.filter(|row| !row.unit.is_empty());
        let unit = row.map_or_else(String::new, |row| format!(" {}", row.unit));
        let of_type = || range.map_or_else(|| "a number".to_owned(), |(min, max)| format!("{min} to {max}"));
        let range = match self.row.map(|row| row.limit) {
            Some(Limit::Whole(min, max)) => format!("{min} to {max}{unit}"),
            Some(Limit::Signed(min, max)) => format!("{min} to {max}{unit}"),
            Some(Limit::Number(min, max)) => format!("{min} to {max}{unit}"),
            Some(Limit::Text(words)) => words.to_owned(),
            _ => of_type(),
        };
        let problem = kind.map_or_else(|| "out of range".to_owned(), |kind| format!("not {kind}"));
        self.reject(format!("{} is {problem}; use {range}", describe(value)))
    }

    /// Reports the allowed length, if the field has one.
    fn reject_length(&mut self, value: Json<'_>, kind: &str) -> bool {
        let length = match self.row.map(|row| row.limit) {
            Some(Limit::Length(min, max, of)) => format!(" of {min} to {max} {of}"),
            _ => String::new(),
        };
        self.reject_type(value, &format!("{kind}{length}"))
    }

    pub(super) fn read_field(
        &mut self,
        row: Option<&'static Field>,
        name: &str,
        value: Json<'_>,
        target: &mut dyn ReadJson,
    ) -> bool {
        let (path_before, row_before) = (self.validator.enter(name), core::mem::replace(&mut self.row, row));
        let is_read = target.read(value, self);
        self.row = row_before;
        self.validator.leave(path_before);
        is_read
    }

    pub(super) fn read_entry(&mut self, index: usize, value: Json<'_>, target: &mut dyn ReadJson) -> bool {
        let (path_before, row_before) = (self.validator.enter_entry(index), self.row.take());
        let is_read = target.read(value, self);
        self.row = row_before;
        self.validator.leave(path_before);
        is_read
    }

    /// False, and reported, if it is not an object.
    fn map<'v>(
        &mut self,
        value: Json<'v>,
        expected: &str,
        each: &mut dyn FnMut(&mut Self, &str, Json<'v>),
    ) -> bool {
        if !value.is_map() {
            return self.reject_type(value, expected);
        }
        if !value.members(&mut |name, value| each(self, name, value)) {
            return self.reject("a name is not valid Unicode; use another name".to_owned());
        }
        true
    }

    /// Reads the fields of `group`; `targets` are in the group's order. Missing fields keep their values; of duplicates
    /// the first counts.
    pub(super) fn fields(
        &mut self,
        value: Json<'_>,
        group: &'static Group,
        targets: &mut [&mut dyn ReadJson],
    ) -> bool {
        let mut given = Vec::new();
        // A new name wins over the old one wherever it is in the text.
        let mut renamed = Vec::new();
        let is_map = self.map(value, "an object with named fields", &mut |reader, name, value| {
            let index = group.fields.iter().position(|field| field.name == name);
            let target = index.and_then(|index| Some((index, targets.get_mut(index)?)));
            match (target, upgrade::renamed_field(name, group)) {
                (Some((index, target)), _) => reader.field(group, &mut given, (name, index), value, *target),
                (None, Some(rename)) if reader.version <= rename.last_version => {
                    renamed.push((rename, value))
                }
                (None, rename) => reader.unknown(name, group, rename),
            }
        });
        let current = given.clone();
        for (rename, value) in renamed {
            let index = group.fields.iter().position(|field| field.name == rename.new);
            match index.and_then(|index| Some((index, targets.get_mut(index)?))) {
                Some((index, target)) if !current.contains(&rename.new) => {
                    self.field(group, &mut given, (rename.old, index), value, *target);
                }
                _ => {
                    let detail = format!("duplicate field: {} is its new name; use one of them", rename.new);
                    self.validator.add(rename.old, Cause::Type { detail });
                }
            }
        }
        is_map
    }

    /// Reads one field, unless the text has given its name before.
    fn field(
        &mut self,
        group: &'static Group,
        given: &mut Vec<&'static str>,
        (written, index): (&str, usize),
        value: Json<'_>,
        target: &mut dyn ReadJson,
    ) {
        let Some(row) = group.fields.get(index) else { return };
        if given.contains(&row.name) {
            let detail = "duplicate field; use it once".to_owned();
            return self.validator.add(written, Cause::Type { detail });
        }
        given.push(row.name);
        self.read_field(Some(row), row.name, value, target);
    }

    fn unknown(&mut self, name: &str, group: &Group, rename: Option<&Rename>) {
        let detail = match rename {
            Some(Rename { new, last_version, .. }) => {
                format!("unknown field; use {new}, its name since version {}", last_version + 1)
            }
            None => format!("unknown field; use one of {}", group.names()),
        };
        self.validator.add(name, Cause::Type { detail });
    }

    pub(super) fn choice<'v>(
        &mut self,
        value: Json<'v>,
        group: &'static Group,
    ) -> Option<(&'static Field, Json<'v>)> {
        let expected = expected_kinds(group);
        let (mut first, mut count) = (None, 0_usize);
        let is_map = self.map(value, &expected, &mut |_, name, content| {
            count += 1;
            first.get_or_insert_with(|| {
                let kind = group.fields.iter().find(|kind| kind.name == name);
                (kind.ok_or_else(|| name.to_owned()), content)
            });
        });
        if !is_map {
            return None;
        }
        match first {
            Some((Ok(kind), content)) if count == 1 => return Some((kind, content)),
            Some((Err(name), _)) if count == 1 => {
                self.note(format!("unknown kind \u{201c}{name}\u{201d}; use one of {}", group.names()));
            }
            _ => self.note(format!("an object with {count} keys; use {expected}")),
        }
        None
    }

    /// Returns the index of a word. Accepts old words and the numbers that some words replace.
    pub(super) fn word(&mut self, value: Json<'_>, words: &[&str]) -> Option<usize> {
        let index_of = |text: &str| words.iter().position(|word| *word == text);
        let renamed = |text: &str| {
            let mut renames = upgrade::WORDS.iter().filter(|rename| rename.old == text);
            renames.find_map(|rename| Some((index_of(rename.new)?, rename)))
        };
        let number =
            value.whole().filter(|(is_negative, _)| !is_negative).map(|(_, number)| number.to_string());
        let text = value.text();
        let written = text.as_deref().or(number.as_deref()).unwrap_or_default();
        match (index_of(written), renamed(written)) {
            (Some(index), _) => return Some(index),
            (None, Some((index, rename))) if self.version <= rename.last_version => return Some(index),
            (None, Some((_, rename))) => self.note(format!(
                "{} is not a word of this field; use {}, its name since version {}",
                describe(value),
                rename.new,
                rename.last_version + 1
            )),
            (None, None) => {
                self.note(format!("{} is unknown; use one of {}", describe(value), words.join(", ")));
            }
        }
        None
    }
}

/// The hint names the group's own kinds: `{"mm": 250}` is wrong where a segment is expected.
fn expected_kinds(group: &Group) -> String {
    let example = match group.fields.first() {
        Some(Field { name, ty: Type::Number, .. }) => format!("{{\"{name}\": 250}}"),
        Some(Field { name, ty: Type::List(_), .. }) => format!("{{\"{name}\": [\u{2026}]}}"),
        Some(Field { name, .. }) => format!("{{\"{name}\": {{\u{2026}}}}}"),
        None => "{}".to_owned(),
    };
    format!("an object with one key ({}), such as {example}", group.names())
}

fn describe(value: Json<'_>) -> String {
    const LONGEST: usize = 40;
    let short = |text: &str| match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}\u{2026}", text.get(..end).unwrap_or_default()),
        None => text.to_owned(),
    };
    if value.is_null() {
        "null".to_owned()
    } else if value.is_list() {
        "a list".to_owned()
    } else if value.is_map() {
        "an object".to_owned()
    } else if value.raw().starts_with('"') {
        let text = value.text();
        text.map_or_else(
            || "a text with half of a surrogate pair".to_owned(),
            |text| format!("\u{201c}{}\u{201d}", short(&text)),
        )
    } else {
        short(value.raw())
    }
}

macro_rules! whole {
    ($($ty:ty: $negative:expr),*) => {$(
        impl ReadJson for $ty {
            fn read(&mut self, value: Json<'_>, reader: &mut JsonReader) -> bool {
                let negative: fn(u64) -> Option<Self> = $negative;
                let found = value.whole().and_then(|(is_negative, magnitude)| {
                    if is_negative { negative(magnitude) } else { Self::try_from(magnitude).ok() }
                });
                match found {
                    Some(number) => {
                        *self = number;
                        true
                    }
                    None => {
                        let kind = (!value.is_whole_number()).then_some("a whole number");
                        reader.reject_number(value, kind, Some((&Self::MIN, &Self::MAX)))
                    }
                }
            }

            fn blank() -> Self {
                0
            }
        }
    )*};
}
whole!(u8: |_| None, u16: |_| None, u32: |_| None, u64: |_| None, i64: |magnitude| 0_i64.checked_sub_unsigned(magnitude));

impl ReadJson for f64 {
    fn read(&mut self, value: Json<'_>, reader: &mut JsonReader) -> bool {
        match value.number() {
            Some(number) => {
                *self = number;
                true
            }
            None => reader.reject_number(value, (!value.is_number()).then_some("a number"), None),
        }
    }

    fn blank() -> Self {
        0.0
    }
}

impl ReadJson for bool {
    fn read(&mut self, value: Json<'_>, reader: &mut JsonReader) -> bool {
        match value.raw() {
            "true" => *self = true,
            "false" => *self = false,
            _ => return reader.reject_type(value, "true or false"),
        }
        true
    }

    fn blank() -> Self {
        false
    }
}

impl ReadJson for String {
    fn read(&mut self, value: Json<'_>, reader: &mut JsonReader) -> bool {
        match value.text() {
            Some(text) => {
                *self = text.to_string();
                true
            }
            None => reader.reject_length(value, "a text"),
        }
    }

    fn blank() -> Self {
        Self::new()
    }
}

impl<T: ReadJson> ReadJson for Option<T> {
    fn read(&mut self, value: Json<'_>, reader: &mut JsonReader) -> bool {
        if value.is_null() {
            *self = None;
            return true;
        }
        let mut inner = T::blank();
        let is_read = inner.read(value, reader);
        if is_read {
            *self = Some(inner);
        }
        is_read
    }

    fn blank() -> Self {
        None
    }
}

impl<T: ReadJson> ReadJson for Vec<T> {
    fn read(&mut self, value: Json<'_>, reader: &mut JsonReader) -> bool {
        if !value.is_list() {
            return reader.reject_length(value, "a list");
        }
        self.clear();
        let max = MAX_LIST_BYTES / size_of::<T>().max(1);
        let mut index = 0_usize;
        value.entries(&mut |entry| {
            if index < max {
                // An unreadable entry stays blank, so that the others keep their indexes.
                let mut target = T::blank();
                reader.read_entry(index, entry, &mut target);
                self.push(target);
            }
            index += 1;
        });
        if index > max {
            *self = Self::new();
            return reader.reject(format!("{index} entries; use at most {max}"));
        }
        true
    }

    fn blank() -> Self {
        Self::new()
    }
}
