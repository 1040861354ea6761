//! The types of the schema.

use alloc::{boxed::Box, string::String, vec::Vec};
use core::ops::RangeInclusive;
use serde_json::Value;
use stepscope_motion::moves::Point;

/// The parts of a value. Code that writes values needs no generics.
pub enum Parts<'a> {
    /// A text, an integer, a bool or null.
    Value(Value),
    /// A number that may have a fraction.
    Number(f64),
    /// The entries of a list.
    List(Vec<&'a dyn ToParts>),
    /// The fields of a group in order, and whether each differs from its default.
    Fields(&'static Group, Vec<(&'a dyn ToParts, bool)>),
    /// The name of a choice's kind, and its settings.
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
    /// Name in JSON.
    pub name: &'static str,
    /// Documentation; each line begins with a space.
    pub doc: &'static str,
    /// Type in JSON.
    pub ty: Type,
    /// Label in the form.
    pub label: &'static str,
    /// Unit; empty for a plain number.
    pub unit: &'static str,
    /// Allowed values.
    pub limit: Limit,
    /// Meaning of null; empty if null is not allowed.
    pub null_means: &'static str,
    /// Title of the help card; empty without a card.
    pub term: &'static str,
    /// Text of the help card.
    pub explanation: &'static str,
    /// The paper that it comes from.
    pub document: Option<&'static Document>,
    /// When it is used; `None` for always.
    pub when: Option<When>,
    /// Written only if it differs from the default.
    pub only_if_set: bool,
}

/// A field's type in JSON.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs, reason = "fields are named as in Rust's types")]
pub enum Type {
    /// An integer with the range of its Rust type.
    Whole { min: i64, max: u64 },
    /// A number that may have a fraction.
    Number,
    /// True or false.
    Bool,
    /// A text.
    Text,
    /// Bytes in hexadecimal.
    Hex,
    /// A point of a curve: time in s and position.
    Point,
    /// One of some words.
    Word(&'static [Word]),
    /// An object with fields, or with the one key of a choice.
    Group(&'static Group),
    /// The type, or null.
    Optional(&'static Type),
    /// A list of the type.
    List(&'static Type),
}

/// A word of a choice without settings.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    /// Name in JSON.
    pub name: &'static str,
    /// Label in the form.
    pub label: &'static str,
    /// Meaning.
    pub doc: &'static str,
}

/// The fields of a struct, or the kinds of an enum.
#[derive(Debug)]
pub struct Group {
    /// Name of the Rust type.
    pub name: &'static str,
    /// Documentation in Markdown.
    pub doc: &'static str,
    /// Its fields, or its kinds.
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
    /// Every value of the type.
    Type,
    /// Minimum and maximum of an integer.
    Whole(u64, u64),
    /// Minimum and maximum of an integer that may be negative.
    Signed(i64, i64),
    /// Minimum and maximum of a number.
    Number(f64, f64),
    /// Minimum and maximum number of characters or entries, and their name.
    Length(usize, usize, &'static str),
    /// A range that depends on other fields, as text.
    Text(&'static str),
}

/// A field that is used only if another field has a value.
#[derive(Clone, Copy, Debug)]
pub struct When {
    /// The other field: its path, or its name in the same group.
    pub field: &'static str,
    /// Whether `field` is a whole path.
    pub is_path: bool,
    /// The value of the other field.
    pub is: &'static str,
}

/// The source of an experiment or a term.
#[derive(Debug, PartialEq, Eq)]
pub struct Document {
    /// Name in the schema's JSON.
    pub id: &'static str,
    /// Short name for people.
    pub short: &'static str,
    /// Author, year, title.
    pub title: &'static str,
}

/// Patent RU 2704486.
pub const PATENT: &Document = &Document {
    id: "patent",
    short: "RU 2704486, 2019",
    title: "Patent RU 2704486 C1, 2019: tick-by-tick control of several stepper motors over USB (Russian)",
};
/// Sonobe 2011.
pub const SONOBE: &Document = &Document {
    id: "sonobe",
    short: "Sonobe 2011",
    title: "Y. Sonobe, University of Electro-Communications, 2011: speed control of stepper motors, trapezoidal acceleration by table (slides, Japanese)",
};
/// Song, Han and Lu 2021.
pub const SONG: &Document = &Document {
    id: "song",
    short: "Song 2021",
    title: "Song, Han, Lu, 2021: exact S-curve control of a stepper motor. Electric Machines & Control Application 48 (11), page 27 (Chinese)",
};
/// SWorldJournal 2022.
pub const SINE: &Document = &Document {
    id: "sine",
    short: "SWorldJournal 2022",
    title: "SWorldJournal, issue 11, part 1, 2022: sinusoidal motion of a vibration-calibration carriage as a sum of segments of fixed speed (Ukrainian)",
};
/// Zhang 2012.
pub const ZHANG: &Document = &Document {
    id: "zhang",
    short: "Zhang 2012",
    title: "Zhang, 2012: design of a single-axis fixed-length controller for a stepper motor on an ATmega128 (Chinese)",
};
/// Data sheets of drivers.
pub const SHEETS: &Document = &Document {
    id: "sheets",
    short: "driver data sheets",
    title: "Data sheets of the drivers: Allegro A4988 (4988-DS), Texas Instruments DRV8825 (SLVSA73), Trinamic TMC2209 (rev. 1.09) and others",
};
/// Defined by Stepscope.
pub const OWN: &Document = &Document {
    id: "own",
    short: "Stepscope",
    title: "Stepscope: the framed protocol, the line model and the bit-exact link, described in docs/ of the source",
};
/// All sources.
pub const DOCUMENTS: [&Document; 7] = [PATENT, SONOBE, SONG, SINE, ZHANG, SHEETS, OWN];

pub(crate) const fn label(label: &'static str) -> Field {
    Field {
        name: "",
        doc: "",
        ty: Type::Number,
        label,
        unit: "",
        limit: Limit::Type,
        null_means: "",
        term: "",
        explanation: "",
        document: None,
        when: None,
        only_if_set: false,
    }
}

/// Removes `r#` from the Rust name of a field such as `r#return`.
const fn without_raw_prefix(name: &'static str) -> &'static str {
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
        let name = if self.name.is_empty() { without_raw_prefix(rust_name) } else { self.name };
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

    pub(crate) const fn range_text(self, range: &'static str) -> Self {
        Self { limit: Limit::Text(range), ..self }
    }

    pub(crate) const fn only_if_set(self) -> Self {
        Self { only_if_set: true, ..self }
    }

    pub(crate) const fn null_means(self, null_means: &'static str) -> Self {
        Self { null_means, ..self }
    }

    pub(crate) const fn term(self, term: &'static str, explanation: &'static str) -> Self {
        if cfg!(feature = "explanations") { Self { term, explanation, ..self } } else { self }
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
            const TYPE: Type = Type::Whole { min: <$ty>::MIN as i64, max: <$ty>::MAX as u64 };
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
