//! How the scenario's types are declared: once, with their defaults.
//!
//! [`settings!`] declares a struct and its defaults in one place; from that follow `Default`,
//! [`Read`], with every field optional and unknown ones refused, and [`Compact`]: the canonical form
//! that a link carries, fixed in order, with what equals its default left out.

use alloc::{
    string::{String, ToString},
    vec::Vec,
};
use serde_json::{Map, Value};

/// What a value of a scenario is made of: all that writing it needs to know, so that writing is code of its
/// own and not of every type.
pub enum Parts<'a> {
    /// A value in one piece.
    Whole(Value),
    /// A number that may be -0.0.
    Number(f64),
    /// A list.
    List(Vec<&'a dyn Compact>),
    /// Names, their values, and whether the value differs from its default.
    Fields(Vec<(&'static str, &'a dyn Compact, bool)>),
}

/// A value with a canonical JSON: fixed order, defaults left out.
///
/// Reading it back gives an equal value, and equal values have the same canonical form.
pub trait Compact {
    /// What it is made of.
    fn parts(&self) -> Parts<'_>;

    /// The canonical form.
    fn compact(&self) -> Value
    where
        Self: Sized,
    {
        compacted(self.parts())
    }
}

fn compacted(parts: Parts<'_>) -> Value {
    match parts {
        Parts::Whole(value) => value,
        // -0.0 equals 0.0, so it is written like it.
        Parts::Number(number) => Value::from(number + 0.0),
        Parts::List(entries) => entries.into_iter().map(|entry| compacted(entry.parts())).collect(),
        Parts::Fields(fields) => {
            let mut map = Map::new();
            for (name, value, _) in fields.into_iter().filter(|(_, _, differs)| *differs) {
                map.insert(name.into(), compacted(value.parts()));
            }
            Value::Object(map)
        }
    }
}

/// Writes a value with all its fields in the order of their declaration, as
/// `serde_json::to_string_pretty` does; `indent` is the depth of the line that it begins in.
pub(super) fn write_whole(out: &mut String, value: &dyn Compact, indent: usize) {
    let begin_line = |out: &mut String, first: bool| {
        out.push_str(if first { "\n" } else { ",\n" });
        (0..=indent).for_each(|_| out.push_str("  "));
    };
    let brackets = match value.parts() {
        Parts::Whole(value) => return out.push_str(&value.to_string()),
        Parts::Number(number) => return out.push_str(&Value::from(number).to_string()),
        Parts::List(entries) if entries.is_empty() => return out.push_str("[]"),
        Parts::Fields(fields) if fields.is_empty() => return out.push_str("{}"),
        Parts::List(entries) => {
            out.push('[');
            for (index, entry) in entries.into_iter().enumerate() {
                begin_line(out, index == 0);
                write_whole(out, entry, indent + 1);
            }
            ']'
        }
        Parts::Fields(fields) => {
            out.push('{');
            for (index, (name, value, _)) in fields.into_iter().enumerate() {
                begin_line(out, index == 0);
                out.push_str(&alloc::format!("\"{name}\": "));
                write_whole(out, value, indent + 1);
            }
            '}'
        }
    };
    out.push('\n');
    (0..indent).for_each(|_| out.push_str("  "));
    out.push(brackets);
}

macro_rules! plain {
    ($($ty:ty),*) => {$(
        impl Compact for $ty {
            fn parts(&self) -> Parts<'_> {
                Parts::Whole(Value::from(self.clone()))
            }
        }
    )*};
}
plain!(u8, u16, u32, u64, i64, String);

impl Compact for f64 {
    fn parts(&self) -> Parts<'_> {
        Parts::Number(*self)
    }
}

impl<T: Compact> Compact for Option<T> {
    fn parts(&self) -> Parts<'_> {
        self.as_ref().map_or(Parts::Whole(Value::Null), Compact::parts)
    }
}

impl<T: Compact> Compact for Vec<T> {
    fn parts(&self) -> Parts<'_> {
        Parts::List(self.iter().map(|entry| entry as &dyn Compact).collect())
    }
}

/// Declares a struct of the scenario and its defaults.
macro_rules! settings {
    ($(#[$meta:meta])* pub struct $name:ident {
        $($(#[$field_meta:meta])* pub $field:ident: $ty:ty = $default:expr,)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name {
            $($(#[$field_meta])* pub $field: $ty,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        $crate::compact::fields! { $name { $($field,)* } }
    };
}

/// Maps the fields of a struct onto names, in this order.
macro_rules! fields {
    ($($name:ty { $($field:ident,)* })*) => {$(
        impl $crate::Compact for $name {
            fn parts(&self) -> $crate::Parts<'_> {
                let default = Self::default();
                $crate::Parts::Fields(alloc::vec![
                    $((stringify!($field), &self.$field, self.$field != default.$field),)*
                ])
            }
        }

        impl $crate::Read for $name {
            fn read(&mut self, value: &serde_json::Value, reader: &mut $crate::Reader) -> bool {
                reader.fields(value, &mut [$((stringify!($field), &mut self.$field),)*])
            }

            fn blank() -> Self {
                Self::default()
            }
        }
    )*};
}

/// Declares an enum of the scenario, whose kinds are named by a key.
macro_rules! choices {
    ($(#[$meta:meta])* pub enum $name:ident {
        $($(#[$variant_meta:meta])* $variant:ident($ty:ty) = $key:literal,)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub enum $name {
            $($(#[$variant_meta])* $variant($ty),)*
        }

        $crate::compact::kinds! { $name { $($variant($ty) = $key,)* } }
    };
}

/// The names of all kinds of a choice, as JSON writes them.
pub trait Kinds {
    /// In the order of their declaration.
    const KINDS: &'static [&'static str];
}

/// Maps the kinds of an enum onto names.
macro_rules! kinds {
    ($($name:ty { $($variant:ident($ty:ty) = $key:literal,)* })*) => {$(
        impl $crate::Kinds for $name {
            const KINDS: &'static [&'static str] = &[$($key),*];
        }

        impl $crate::Compact for $name {
            // A map of one key.
            fn parts(&self) -> $crate::Parts<'_> {
                match self {
                    $(Self::$variant(inner) => $crate::Parts::Fields(alloc::vec![($key, inner, true)]),)*
                }
            }
        }

        impl $crate::Read for $name {
            fn read(&mut self, value: &serde_json::Value, reader: &mut $crate::Reader) -> bool {
                let Some((name, content)) = reader.choice(value, <Self as $crate::Kinds>::KINDS) else { return false };
                match name {
                    $($key => {
                        let mut inner = <$ty as $crate::Read>::blank();
                        let taken = reader.below(name, content, &mut inner);
                        if taken {
                            *self = Self::$variant(inner);
                        }
                        taken
                    })*
                    _ => false,
                }
            }

            /// The last kind: the one that asks least.
            fn blank() -> Self {
                $crate::compact::last!($($variant($ty)),*)
            }
        }
    )*};
}

/// The last of a choice's kinds, blank.
macro_rules! last {
    ($variant:ident($ty:ty)) => {
        Self::$variant(<$ty as $crate::Read>::blank())
    };
    ($variant:ident($ty:ty), $($rest:tt)+) => {
        $crate::compact::last!($($rest)+)
    };
}

pub(crate) use {choices, fields, kinds, last, settings};

/// Maps the variants of an enum onto words.
macro_rules! words {
    ($($ty:ty { $($variant:ident = $word:literal,)* })*) => {$(
        impl $crate::Compact for $ty {
            fn parts(&self) -> $crate::Parts<'_> {
                $crate::Parts::Whole(serde_json::Value::from(match self {
                    $(Self::$variant => $word,)*
                }))
            }
        }

        impl $crate::Read for $ty {
            fn read(&mut self, value: &serde_json::Value, reader: &mut $crate::Reader) -> bool {
                let found = reader.word(value, &[$($word),*]);
                let kinds = [$(Self::$variant),*];
                let found = found.and_then(|place| kinds.into_iter().nth(place));
                *self = found.unwrap_or(*self);
                found.is_some()
            }

            fn blank() -> Self {
                let [first, ..] = [$(Self::$variant),*];
                first
            }
        }
    )*};
}

pub(crate) use words;
