//! The macros that declare rows. They expand to names and places only; the shared code is not generic.

/// A struct of the scenario with rows and defaults.
macro_rules! settings {
    ($(#[doc = $doc:literal])* pub struct $name:ident {
        $($(#[doc = $field_doc:literal])* pub $field:ident: $ty:ty = $default:expr => $row:expr,)*
    }) => {
        $(#[doc = $doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name {
            $($(#[doc = $field_doc])* pub $field: $ty,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        $crate::schema::rows::rows! { false; $(#[doc = $doc])* $name {
            $($(#[doc = $field_doc])* $field: $ty => $row,)*
        } }
    };
}

/// Rows for another crate's struct.
macro_rules! fields {
    ($($(#[doc = $doc:literal])* $name:ident {
        $($(#[doc = $field_doc:literal])* $field:ident: $ty:ty => $row:expr,)*
    })*) => {$(
        $crate::schema::rows::rows! { true; $(#[doc = $doc])* $name {
            $($(#[doc = $field_doc])* $field: $ty => $row,)*
        } }
    )*};
}

/// Rows, reader and writer of a struct.
macro_rules! rows {
    ($foreign:literal; $(#[doc = $doc:literal])* $name:ident {
        $($(#[doc = $field_doc:literal])* $field:ident: $ty:ty => $row:expr,)*
    }) => {
        impl $crate::schema::Typed for $name {
            const TYPE: $crate::schema::Type = {
                const FIELDS: &[$crate::schema::Field] = &[$(
                    $row.declared(stringify!($field), concat!($($field_doc),*), <$ty as $crate::schema::Typed>::TYPE)
                ),*];
                const GROUP: &$crate::schema::Group = &$crate::schema::Group {
                    name: stringify!($name),
                    doc: concat!($($doc, "\n"),*),
                    fields: FIELDS,
                    is_choice: false,
                    is_external: $foreign,
                    blank: || alloc::boxed::Box::new($name::default()),
                };
                $crate::schema::Type::Group(GROUP)
            };
        }

        impl $crate::schema::ToParts for $name {
            fn parts(&self) -> $crate::schema::Parts<'_> {
                let default = Self::default();
                // Unused for a struct without fields.
                let _ = &default;
                // A field without a row does not compile.
                let Self { $($field,)* } = self;
                $crate::schema::Parts::Fields(
                    $crate::schema::rows::group::<Self>(),
                    <[_]>::into_vec(alloc::boxed::Box::new([
                        $(($field as &dyn $crate::schema::ToParts, *$field != default.$field),)*
                    ])),
                )
            }
        }

        impl $crate::ReadJson for $name {
            fn read(&mut self, value: $crate::Json<'_>, reader: &mut $crate::JsonReader) -> bool {
                reader.fields(value, $crate::schema::rows::group::<Self>(), &mut [$(&mut self.$field),*])
            }

            fn blank() -> Self {
                Self::default()
            }
        }
    };
}

/// An enum of the scenario with a row per kind.
macro_rules! choices {
    ($(#[doc = $doc:literal])* pub enum $name:ident {
        $($(#[doc = $kind_doc:literal])* $variant:ident($ty:ty) = $key:literal => $row:expr,)*
    }) => {
        $(#[doc = $doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub enum $name {
            $($(#[doc = $kind_doc])* $variant($ty),)*
        }

        $crate::schema::rows::kinds! { $(#[doc = $doc])* $name {
            $($(#[doc = $kind_doc])* $variant($ty) = $key => $row,)*
        } }
    };
}

/// Rows for another crate's enum; JSON has a map with one key.
macro_rules! kinds {
    ($($(#[doc = $doc:literal])* $name:ident {
        $($(#[doc = $kind_doc:literal])* $variant:ident($ty:ty) = $key:literal => $row:expr,)*
    })*) => {$(
        impl $crate::Kinds for $name {
            const KINDS: &'static [&'static str] = &[$($key),*];
        }

        impl $crate::schema::Typed for $name {
            const TYPE: $crate::schema::Type = {
                const KINDS: &[$crate::schema::Field] = &[$(
                    $row.declared($key, concat!($($kind_doc),*), <$ty as $crate::schema::Typed>::TYPE)
                ),*];
                const GROUP: &$crate::schema::Group = &$crate::schema::Group {
                    name: stringify!($name),
                    doc: concat!($($doc, "\n"),*),
                    fields: KINDS,
                    is_choice: true,
                    is_external: false,
                    blank: || alloc::boxed::Box::new(<$name as $crate::ReadJson>::blank()),
                };
                $crate::schema::Type::Group(GROUP)
            };
        }

        impl $crate::schema::ToParts for $name {
            fn parts(&self) -> $crate::schema::Parts<'_> {
                match self {
                    $(Self::$variant(inner) => $crate::schema::Parts::Kind($key, inner),)*
                }
            }
        }

        impl $crate::ReadJson for $name {
            fn read(&mut self, value: $crate::Json<'_>, reader: &mut $crate::JsonReader) -> bool {
                let kinds = $crate::schema::rows::group::<Self>();
                let Some((kind, content)) = reader.choice(value, kinds) else { return false };
                match kind.name {
                    $($key => {
                        let mut inner = <$ty as $crate::ReadJson>::blank();
                        let is_read = reader.read_field(Some(kind), kind.name, content, &mut inner);
                        if is_read {
                            *self = Self::$variant(inner);
                        }
                        is_read
                    })*
                    _ => false,
                }
            }

            /// The kind with the fewest fields.
            fn blank() -> Self {
                $crate::schema::rows::last!($($variant($ty)),*)
            }
        }
    )*};
}

macro_rules! last {
    ($variant:ident($ty:ty)) => {
        Self::$variant(<$ty as $crate::ReadJson>::blank())
    };
    ($variant:ident($ty:ty), $($rest:tt)+) => {
        $crate::schema::rows::last!($($rest)+)
    };
}

/// Words for an enum's variants: `Variant = "word", "label in the form": "meaning in docs/scenario.md";`.
macro_rules! words {
    ($($ty:ty { $($variant:ident = $word:literal, $label:literal: $meaning:expr;)* })*) => {$(
        impl $crate::schema::Typed for $ty {
            const TYPE: $crate::schema::Type = {
                const WORDS: &[$crate::schema::Word] =
                    &[$($crate::schema::Word { name: $word, label: $label, doc: $meaning }),*];
                $crate::schema::Type::Word(WORDS)
            };
        }

        impl $crate::schema::ToParts for $ty {
            fn parts(&self) -> $crate::schema::Parts<'_> {
                $crate::schema::Parts::Value(serde_json::Value::from(match self {
                    $(Self::$variant => $word,)*
                }))
            }
        }

        impl $crate::ReadJson for $ty {
            fn read(&mut self, value: $crate::Json<'_>, reader: &mut $crate::JsonReader) -> bool {
                let found = reader.word(value, &[$($word),*]);
                let kinds = [$(Self::$variant),*];
                let found = found.and_then(|index| kinds.into_iter().nth(index));
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

/// The same for an enum of the scenario.
macro_rules! word_enums {
    ($($(#[doc = $doc:literal])* pub enum $name:ident {
        $($(#[doc = $word_doc:literal])* $variant:ident = $word:literal => label($label:literal);)*
    })*) => {$(
        $(#[doc = $doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name {
            $($(#[doc = $word_doc])* $variant,)*
        }

        $crate::schema::rows::words! { $name {
            $($variant = $word, $label: concat!($($word_doc),*);)*
        } }
    )*};
}

use crate::schema::{Group, Type, Typed};

const NONE: &Group = &Group {
    name: "",
    doc: "",
    fields: &[],
    is_choice: false,
    is_external: false,
    blank: || alloc::boxed::Box::new(0_u8),
};

pub(crate) const fn group<T: Typed>() -> &'static Group {
    match T::TYPE {
        Type::Group(group) => group,
        _ => NONE,
    }
}

pub(crate) use {choices, fields, kinds, last, rows, settings, word_enums, words};
