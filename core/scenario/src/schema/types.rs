//! What a schema is made of: rows of fields with all that is said of them, and the parts of a value that has rows.

use alloc::{boxed::Box, string::String, vec::Vec};
use core::ops::RangeInclusive;
use serde_json::Value;
use stepscope_motion::moves::Point;

/// What a value of a scenario is made of: all that writing it needs to know, so that writing is code of its
/// own and not of every type.
pub enum Parts<'a> {
    /// A value in one piece.
    Whole(Value),
    /// A number that may be -0.0.
    Number(f64),
    /// A list.
    List(Vec<&'a dyn ToParts>),
    /// The values of a group's fields, in its order, and whether each differs from its default.
    Fields(&'static Group, Vec<(&'a dyn ToParts, bool)>),
    /// A kind by its name, and what is in it.
    Kind(&'static str, &'a dyn ToParts),
}

/// A value of a scenario, which can be taken apart.
pub trait ToParts {
    /// What it is made of.
    fn parts(&self) -> Parts<'_>;
}

/// A field of a group, or a kind of a choice, and all that is said of it.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Its name in JSON.
    pub name: &'static str,
    /// What it is, as text of the documentation: with the blank before each line.
    pub doc: &'static str,
    /// What JSON holds.
    pub ty: Type,
    /// Its name in the form.
    pub label: &'static str,
    /// Unit in which it counts, as people write it; empty for a plain number.
    pub unit: &'static str,
    /// Which values are allowed.
    pub limit: Limit,
    /// What it means if nothing (null) is given.
    pub empty: &'static str,
    /// What the help's card is headed with; empty where there is none.
    pub term: &'static str,
    /// What the help's card says.
    pub explained: &'static str,
    /// The document that it comes from.
    pub document: Option<&'static Document>,
    /// When it matters; without it always.
    pub when: Option<When>,
    /// Whether it is written only where it differs from its default: a field that not every program knows, as the page, which
    /// has no plant.
    pub only_if_set: bool,
}

/// What JSON holds for a field.
#[derive(Clone, Copy, Debug)]
pub enum Type {
    /// A whole number.
    Whole {
        /// Least of its type.
        least: i64,
        /// Greatest of its type.
        most: u64,
    },
    /// A number.
    Number,
    /// Yes or no: true or false.
    Bool,
    /// A text.
    Text,
    /// Bytes in hexadecimal.
    Hex,
    /// A point of a curve: time in s and position.
    Point,
    /// One of some words.
    Word(&'static [Word]),
    /// A map of fields, or of the one key that names a choice.
    Group(&'static Group),
    /// Nothing (null), or another type.
    Optional(&'static Type),
    /// A list.
    List(&'static Type),
}

/// One of the words of a choice without anything inside.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    /// As JSON writes it.
    pub name: &'static str,
    /// As the form writes it.
    pub label: &'static str,
    /// What it means.
    pub doc: &'static str,
}

/// The fields of a struct, or the kinds of an enum.
#[derive(Debug)]
pub struct Group {
    /// Name of the type.
    pub name: &'static str,
    /// What it is, line by line; Markdown.
    pub doc: &'static str,
    /// Its fields or kinds in their order.
    pub fields: &'static [Field],
    /// Whether JSON holds one of them, and not all.
    pub is_choice: bool,
    /// Whether another crate owns the type, and judges its numbers.
    pub is_external: bool,
    /// One with all defaults.
    pub blank: fn() -> Box<dyn ToParts>,
}

/// Which values a field may have by itself.
#[derive(Clone, Copy, Debug)]
pub enum Limit {
    /// All of its type.
    Type,
    /// Whole numbers of a range.
    Whole(u64, u64),
    /// Whole numbers of a range that may be below 0.
    Signed(i64, i64),
    /// Numbers of a range.
    Number(f64, f64),
    /// So many of what is counted: characters of a text, entries of a list.
    Length(usize, usize, &'static str),
    /// A range that follows from other fields, in words; a rule judges it.
    Follows(&'static str),
}

/// A field matters only while another one has a value.
#[derive(Clone, Copy, Debug)]
pub struct When {
    /// The other one: its path, or its name beside the field.
    pub field: &'static str,
    /// Whether `field` is a whole path.
    pub is_path: bool,
    /// The value.
    pub is: &'static str,
}

/// Where an experiment or a term comes from.
#[derive(Debug, PartialEq, Eq)]
pub struct Document {
    /// Short name for machines.
    pub id: &'static str,
    /// Short name for people.
    pub short: &'static str,
    /// Author, year, title.
    pub title: &'static str,
}

/// RU 2704486.
pub const PATENT: &Document = &Document {
    id: "patent",
    short: "patent RU 2704486, 2019",
    title: "Patent RU 2704486 C1, 2019: tick-by-tick control of several stepper motors over USB (Russian)",
};
/// Sonobe 2011.
pub const SONOBE: &Document = &Document {
    id: "sonobe",
    short: "Sonobe 2011",
    title: "Y. Sonobe, University of Electro-Communications, 2011: speed control of stepper motors, trapezoidal acceleration by table (slides, Japanese)",
};
/// Song, Han, Lu 2021.
pub const SONG: &Document = &Document {
    id: "song",
    short: "Song, Han, Lu 2021",
    title: "Song, Han, Lu: exact S-curve control of a stepper motor. Electric Machines & Control Application 48 (11), 2021, page 27 (Chinese)",
};
/// SWorldJournal, issue 11.
pub const SINE: &Document = &Document {
    id: "sine",
    short: "SWorldJournal, issue 11",
    title: "SWorldJournal, issue 11, part 1: sinusoidal motion of a vibration-calibration carriage as a sum of segments of fixed speed (Ukrainian)",
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
    short: "drivers' data sheets",
    title: "Data sheets of the drivers: Allegro A4988 (4988-DS), Texas Instruments DRV8825 (SLVSA73), Trinamic TMC2209 (rev. 1.09) and their like",
};
/// What no document has.
pub const OWN: &Document = &Document {
    id: "own",
    short: "Stepscope's own",
    title: "Stepscope's own: the framed protocol, the line model and the bit-exact link, described in docs/ of the source",
};
/// All of them.
pub const DOCUMENTS: [&Document; 7] = [PATENT, SONOBE, SONG, SINE, ZHANG, SHEETS, OWN];

/// Begins a row, with the field's name in the form.
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

impl Field {
    /// In which unit it counts.
    pub(crate) const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// A whole number of a range.
    pub(crate) const fn whole(self, range: RangeInclusive<u64>) -> Self {
        Self { limit: Limit::Whole(*range.start(), *range.end()), ..self }
    }

    /// A whole number of a range that may be below 0.
    pub(crate) const fn signed(self, range: RangeInclusive<i64>) -> Self {
        Self { limit: Limit::Signed(*range.start(), *range.end()), ..self }
    }

    /// A number of a range.
    pub(crate) const fn number(self, range: RangeInclusive<f64>) -> Self {
        Self { limit: Limit::Number(*range.start(), *range.end()), ..self }
    }

    /// How many `of` something it has.
    pub(crate) const fn length(self, range: RangeInclusive<usize>, of: &'static str) -> Self {
        Self { limit: Limit::Length(*range.start(), *range.end(), of), ..self }
    }

    /// Its range in words, where it follows from other fields.
    pub(crate) const fn follows(self, range: &'static str) -> Self {
        Self { limit: Limit::Follows(range), ..self }
    }

    /// Written to a file only where it differs from its default.
    pub(crate) const fn only_if_set(self) -> Self {
        Self { only_if_set: true, ..self }
    }

    /// What nothing (null) means.
    pub(crate) const fn empty(self, empty: &'static str) -> Self {
        Self { empty, ..self }
    }

    /// The help's card: its head and its text, which a build without the feature `explanations` leaves out.
    pub(crate) const fn term(self, term: &'static str, explained: &'static str) -> Self {
        if cfg!(feature = "explanations") { Self { term, explained, ..self } } else { self }
    }

    /// Which document it comes from.
    pub(crate) const fn from(self, document: &'static Document) -> Self {
        Self { document: Some(document), ..self }
    }

    /// It matters only while the field beside it has this value.
    pub(crate) const fn when(self, field: &'static str, is: &'static str) -> Self {
        Self { when: Some(When { field, is_path: false, is }), ..self }
    }

    /// It matters only while the field at this path has this value.
    pub(crate) const fn when_at(self, field: &'static str, is: &'static str) -> Self {
        Self { when: Some(When { field, is_path: true, is }), ..self }
    }

    /// What it is, in one line.
    #[must_use]
    pub fn text(&self) -> &'static str {
        self.doc.trim()
    }
}

/// A type that a field may have.
pub trait Typed {
    /// What JSON holds for it.
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
