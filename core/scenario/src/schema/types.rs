//! The types of the schema.

#![allow(missing_docs, reason = "only names that need one have a text")]

use alloc::{boxed::Box, string::String, vec::Vec};
use core::ops::RangeInclusive;
use serde_json::Value;
use stepscope_motion::moves::Point;

/// The parts of a value. Code that writes values needs no generics.
pub enum Parts<'a> {
    Whole(Value),
    Number(f64),
    List(Vec<&'a dyn ToParts>),
    /// The fields of a group in order, and whether each differs from its default.
    Fields(&'static Group, Vec<(&'a dyn ToParts, bool)>),
    Kind(&'static str, &'a dyn ToParts),
}

/// A value that can be split into parts.
pub trait ToParts {
    /// Its parts.
    fn parts(&self) -> Parts<'_>;
}

/// A field of a group, or a kind of a choice.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    pub name: &'static str,
    /// Documentation; each line begins with a space.
    pub doc: &'static str,
    pub ty: Type,
    pub label: &'static str,
    /// Unit; empty for a plain number.
    pub unit: &'static str,
    pub limit: Limit,
    /// Meaning of null.
    pub empty: &'static str,
    /// Title of the help card; empty without a card.
    pub term: &'static str,
    /// Text of the help card.
    pub explained: &'static str,
    /// The paper that it comes from.
    pub document: Option<&'static Document>,
    /// When it is used; `None` for always.
    pub when: Option<When>,
    /// Written only if it differs from the default.
    pub only_if_set: bool,
}

/// A field's type in JSON.
#[derive(Clone, Copy, Debug)]
pub enum Type {
    Whole {
        least: i64,
        most: u64,
    },
    Number,
    Bool,
    Text,
    Hex,
    /// A point of a curve: time in s and position.
    Point,
    /// One of some words.
    Word(&'static [Word]),
    /// An object with fields, or with the one key of a choice.
    Group(&'static Group),
    Optional(&'static Type),
    List(&'static Type),
}

/// A word of a choice without settings.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    pub name: &'static str,
    pub label: &'static str,
    pub doc: &'static str,
}

/// The fields of a struct, or the kinds of an enum.
#[derive(Debug)]
pub struct Group {
    pub name: &'static str,
    /// Documentation in Markdown.
    pub doc: &'static str,
    pub fields: &'static [Field],
    /// Whether it is a choice of one.
    pub is_choice: bool,
    /// Whether another crate owns and checks the type.
    pub is_external: bool,
    /// A value with all defaults.
    pub blank: fn() -> Box<dyn ToParts>,
}

/// The allowed values of a single field.
#[derive(Clone, Copy, Debug)]
pub enum Limit {
    Type,
    Whole(u64, u64),
    /// A range that may be negative.
    Signed(i64, i64),
    Number(f64, f64),
    /// A number of characters or entries, and their name.
    Length(usize, usize, &'static str),
    /// A range that depends on other fields, as text.
    Follows(&'static str),
}

/// A field that is used only if another field has a value.
#[derive(Clone, Copy, Debug)]
pub struct When {
    /// The other field: its path, or its name in the same group.
    pub field: &'static str,
    /// Whether `field` is a whole path.
    pub is_path: bool,
    pub is: &'static str,
}

/// The source of an experiment or a term.
#[derive(Debug, PartialEq, Eq)]
pub struct Document {
    pub id: &'static str,
    /// Short name for people.
    pub short: &'static str,
    /// Author, year, title.
    pub title: &'static str,
}

pub const PATENT: &Document = &Document {
    id: "patent",
    short: "RU 2704486, 2019",
    title: "Patent RU 2704486 C1, 2019: tick-by-tick control of several stepper motors over USB (Russian)",
};
pub const SONOBE: &Document = &Document {
    id: "sonobe",
    short: "Sonobe 2011",
    title: "Y. Sonobe, University of Electro-Communications, 2011: speed control of stepper motors, trapezoidal acceleration by table (slides, Japanese)",
};
pub const SONG: &Document = &Document {
    id: "song",
    short: "Song 2021",
    title: "Song, Han, Lu, 2021: exact S-curve control of a stepper motor. Electric Machines & Control Application 48 (11), page 27 (Chinese)",
};
pub const SINE: &Document = &Document {
    id: "sine",
    short: "SWorldJournal 2022",
    title: "SWorldJournal, issue 11, part 1, 2022: sinusoidal motion of a vibration-calibration carriage as a sum of segments of fixed speed (Ukrainian)",
};
pub const ZHANG: &Document = &Document {
    id: "zhang",
    short: "Zhang 2012",
    title: "Zhang, 2012: design of a single-axis fixed-length controller for a stepper motor on an ATmega128 (Chinese)",
};
pub const SHEETS: &Document = &Document {
    id: "sheets",
    short: "driver data sheets",
    title: "Data sheets of the drivers: Allegro A4988 (4988-DS), Texas Instruments DRV8825 (SLVSA73), Trinamic TMC2209 (rev. 1.09) and others",
};
pub const OWN: &Document = &Document {
    id: "own",
    short: "Stepscope",
    title: "Stepscope: the framed protocol, the line model and the bit-exact link, described in docs/ of the source",
};
pub const DOCUMENTS: [&Document; 7] = [PATENT, SONOBE, SONG, SINE, ZHANG, SHEETS, OWN];

pub(crate) const fn label(label: &'static str) -> Field {
    Field {
        name: "",
        doc: "",
        ty: Type::Number,
        label,
        unit: "",
        limit: Limit::Type,
        empty: "",
        term: "",
        explained: "",
        document: None,
        when: None,
        only_if_set: false,
    }
}

/// Removes `r#`.
const fn plain(name: &'static str) -> &'static str {
    match name.as_bytes() {
        [b'r', b'#', rest @ ..] => match core::str::from_utf8(rest) {
            Ok(rest) => rest,
            Err(_) => name,
        },
        _ => name,
    }
}

impl Group {
    /// The names of its fields or kinds, as a list for messages.
    pub(crate) fn names(&self) -> String {
        self.fields.iter().map(|field| field.name).collect::<Vec<_>>().join(", ")
    }
}

impl Field {
    /// Completes a row. Without [`Self::named`] the name in JSON is the Rust name.
    pub(crate) const fn declared(self, rust_name: &'static str, doc: &'static str, ty: Type) -> Self {
        let name = if self.name.is_empty() { plain(rust_name) } else { self.name };
        Self { name, doc, ty, ..self }
    }

    /// The name in JSON, where Rust spells names in another way.
    pub(crate) const fn named(self, name: &'static str) -> Self {
        Self { name, ..self }
    }

    pub(crate) const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    pub(crate) const fn whole(self, range: RangeInclusive<u64>) -> Self {
        Self { limit: Limit::Whole(*range.start(), *range.end()), ..self }
    }

    pub(crate) const fn signed(self, range: RangeInclusive<i64>) -> Self {
        Self { limit: Limit::Signed(*range.start(), *range.end()), ..self }
    }

    pub(crate) const fn number(self, range: RangeInclusive<f64>) -> Self {
        Self { limit: Limit::Number(*range.start(), *range.end()), ..self }
    }

    pub(crate) const fn length(self, range: RangeInclusive<usize>, of: &'static str) -> Self {
        Self { limit: Limit::Length(*range.start(), *range.end(), of), ..self }
    }

    pub(crate) const fn follows(self, range: &'static str) -> Self {
        Self { limit: Limit::Follows(range), ..self }
    }

    pub(crate) const fn only_if_set(self) -> Self {
        Self { only_if_set: true, ..self }
    }

    pub(crate) const fn empty(self, empty: &'static str) -> Self {
        Self { empty, ..self }
    }

    pub(crate) const fn term(self, term: &'static str, explained: &'static str) -> Self {
        if cfg!(feature = "explanations") { Self { term, explained, ..self } } else { self }
    }

    pub(crate) const fn from(self, document: &'static Document) -> Self {
        Self { document: Some(document), ..self }
    }

    pub(crate) const fn when(self, field: &'static str, is: &'static str) -> Self {
        Self { when: Some(When { field, is_path: false, is }), ..self }
    }

    pub(crate) const fn when_at(self, field: &'static str, is: &'static str) -> Self {
        Self { when: Some(When { field, is_path: true, is }), ..self }
    }

    /// The documentation as one line.
    #[must_use]
    pub fn text(&self) -> &'static str {
        self.doc.trim()
    }
}

/// A type that a field may have.
pub trait Typed {
    /// Its type in JSON.
    const TYPE: Type;
}

macro_rules! whole {
    ($($ty:ty),*) => {$(
        impl Typed for $ty {
            const TYPE: Type = Type::Whole { least: <$ty>::MIN as i64, most: <$ty>::MAX as u64 };
        }
    )*};
}
whole!(u8, u16, u32, u64, i64);

impl Typed for f64 {
    const TYPE: Type = Type::Number;
}

impl Typed for bool {
    const TYPE: Type = Type::Bool;
}

impl Typed for String {
    const TYPE: Type = Type::Text;
}

impl Typed for Point {
    const TYPE: Type = Type::Point;
}

impl<T: Typed> Typed for Option<T> {
    const TYPE: Type = Type::Optional(&T::TYPE);
}

impl<T: Typed> Typed for Vec<T> {
    const TYPE: Type = Type::List(&T::TYPE);
}
