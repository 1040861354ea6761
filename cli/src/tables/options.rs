//! Choices of `stepscope tables`, and options that would have no effect.

use super::Arguments;
use crate::failure::Failure;
use clap::ValueEnum;
use stepscope_core::{inspect::export::source_code::Language, motion::step_tables::Side};

#[derive(Clone, Copy, Default, PartialEq, ValueEnum)]
pub(super) enum WindowName {
    /// Early and late
    #[default]
    Both,
    /// Only early, as in Klipper
    Early,
}

impl WindowName {
    pub(super) const fn side(self) -> Side {
        match self {
            Self::Both => Side::Both,
            Self::Early => Side::Early,
        }
    }
}

#[derive(Clone, Copy, Default, PartialEq, ValueEnum)]
pub(super) enum Search {
    /// Fewest entries; if this cannot be proven, column surplus of the summary is an upper bound on the excess
    #[default]
    Fewest,
    /// Hundreds of times faster: each entry is the longest one that ends near the middle of a window
    Quick,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(super) enum FormName {
    /// Each step in its exact cycle
    Exact,
    /// The table described by the paper of the motion
    Document,
    /// Few entries, within a maximum error
    Compressed,
}

impl FormName {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Document => "document",
            Self::Compressed => "compressed",
        }
    }
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(super) enum Written {
    /// C99
    C,
    /// C for avr-gcc, in program memory
    Avr,
    /// Rust
    Rust,
    /// Comma-separated values
    Csv,
    /// Size and errors of each form
    Summary,
}

impl Written {
    pub(super) const fn language(self) -> Option<Language> {
        match self {
            Self::C => Some(Language::C),
            Self::Avr => Some(Language::Avr),
            Self::Rust => Some(Language::Rust),
            Self::Csv => Some(Language::Csv),
            Self::Summary => None,
        }
    }
}

/// Refuses options without effect, because the user expects one.
pub(super) fn check(arguments: &Arguments) -> Result<(), Failure> {
    let given = |options: &[(&'static str, bool)]| {
        options.iter().find(|(_, is_given)| *is_given).map(|(option, _)| *option)
    };
    let of_search = [
        ("--error-us", arguments.error_us.is_some()),
        ("--interval-part", arguments.interval_part.is_some()),
        ("--window", arguments.window.is_some()),
        ("--search", arguments.search.is_some()),
    ];
    let of_table = [
        ("--form", arguments.form.is_some()),
        ("--entries", arguments.entries.is_some()),
        ("--format", arguments.format != Written::Summary),
        ("--name", arguments.name.is_some()),
    ];
    let refused = |option: &str, why: &str| Err(Failure::Option(format!("{option}: {why}")));
    if matches!(arguments.check, Some(Some(_)))
        && let Some(option) = given(&of_table).or_else(|| given(&of_search))
    {
        return refused(option, "has no effect on the table of a file; use --check without FILE");
    }
    let is_checked = arguments.check.is_some();
    if is_checked && matches!(arguments.format, Written::Rust | Written::Csv) {
        return refused("--format", "only tables in C can be checked; use --format c or --format avr");
    }
    let is_summary = arguments.format == Written::Summary && !is_checked;
    if arguments.name.is_some() && (is_summary || arguments.format == Written::Csv) {
        return refused("--name", "only source code has names; use --format c, avr or rust");
    }
    // A summary without --form has compressed tables, too.
    let is_compressed = arguments.form.map_or(is_summary, |form| form == FormName::Compressed);
    match given(&of_search) {
        Some(option) if !is_compressed => {
            refused(option, "only a compressed table has a maximum error; use --form compressed")
        }
        _ => Ok(()),
    }
}
