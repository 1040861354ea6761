//! Options of `stepscope tables`, and those that would have no effect.

use crate::failure::Failure;
use crate::options::{Json, Out};
use crate::quantity::{Microseconds, whole};
use clap::{Args, ValueEnum};
use std::num::NonZeroU32;
use std::path::PathBuf;
use stepscope_core::inspect::export::source_code::{Language, check_name};
use stepscope_core::motion::step_tables::{EntryFormat, Side};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario: a JSON file or a preset's name; `-` reads standard input
    ///
    /// If its source is not a motion, the steps of its run are used. With --steps, only its clock and pulse times are
    /// used (default: 16 MHz and the default bus).
    #[arg(required_unless_present_any = ["steps", "walker"])]
    pub(super) scenario: Option<PathBuf>,
    /// Read step times from a CSV table, as axis 0
    ///
    /// One row per step. The column cycle, time_s, time_ms or time_us has the time from the start; the column dir has
    /// the direction: 1 or right, 0 or left.
    #[arg(long, value_name = "FILE")]
    pub(super) steps: Option<PathBuf>,
    /// Form of the table (default: exact; for a summary, all)
    #[arg(long, value_enum)]
    pub(super) form: Option<FormName>,
    /// Maximum error of a step in a compressed table, in us (default: 25)
    #[arg(long, value_name = "US")]
    pub(super) error_us: Option<Microseconds>,
    /// Maximum error of a step in a compressed table, as 1/N of a step interval (Klipper: 2)
    ///
    /// Applies in addition to --error-us. The interval is the shorter of the two next to the step; with --window early,
    /// the one before it.
    #[arg(long, value_name = "N", value_parser = whole::<NonZeroU32>(1..=u32::MAX.into()))]
    pub(super) interval_part: Option<NonZeroU32>,
    /// Allowed direction of the error in a compressed table (default: both)
    #[arg(long, value_enum)]
    pub(super) window: Option<WindowName>,
    /// Search method of a compressed table (default: fewest)
    ///
    /// With q8 and q16, fewest differs from quick only if the maximum error is below 2048 units of the format (q8:
    /// 8 cycles, q16: 1/32 cycle).
    #[arg(long, value_enum)]
    pub(super) search: Option<Search>,
    /// Format of an entry: q16, q8, ticks or klipper (default: ticks; for a summary, all)
    ///
    /// q16 has 20 bytes and a resolution of 1/65536 cycle, q8 has 8 bytes and 1/256 cycle, ticks has 8 bytes and whole
    /// cycles. klipper is another name for ticks: the arguments of Klipper's queue_step.
    #[arg(long, value_name = "FORMAT", value_parser = entry_format)]
    pub(super) entries: Option<EntryFormat>,
    /// Output format
    #[arg(long, value_enum, default_value = "summary", conflicts_with = "json")]
    pub(super) format: Written,
    /// Axis, from 0, or all in one file (default: 0; for a summary, all)
    #[arg(long, value_name = "K", value_parser = axis_choice)]
    pub(super) axis: Option<AxisChoice>,
    /// Name of the table in source code (default: axis_K)
    ///
    /// Use up to 32 lower-case letters, digits and underscores after a first letter. Keywords of C, C++ and avr-libc are
    /// refused, and names that begin with stepscope. With --axis all the tables are NAME_0, NAME_1 and so on.
    #[arg(long, value_parser = table_name, conflicts_with = "json")]
    pub(super) name: Option<String>,
    /// Also write stepscope_walk.h, which tables in C include, next to --out
    #[arg(long)]
    pub(super) with_walker: bool,
    /// Write only stepscope_walk.h
    #[arg(long, conflicts_with_all = ["scenario", "steps", "with_walker", "check", "json", "name", "form",
        "entries", "error_us", "interval_part", "window", "search", "format", "axis"])]
    pub(super) walker: bool,
    /// Compare a table with the plan, step by step; exit code 3 if it differs
    ///
    /// FILE is a table in C; without FILE, the table that --format c would write is compared. Each step must have the planned
    /// direction, and its time must be within the error stated in the table. The stated minimum and maximum time between
    /// events must also match. The first table is compared with --axis (default: the axis in the file's header), the next
    /// table with the next axis. No file is written.
    #[arg(long, value_name = "FILE", num_args = 0..=1, conflicts_with_all = ["json", "with_walker"])]
    pub(super) check: Option<Option<PathBuf>>,
    #[command(flatten)]
    pub(super) json: Json,
    #[command(flatten)]
    pub(super) out: Out,
}

/// Maximum error of a compressed table by default, in us.
const ERROR_US: f64 = 25.0;

impl Arguments {
    pub(super) fn error_us(&self) -> f64 {
        self.error_us.map_or(ERROR_US, Microseconds::get)
    }
}

fn entry_format(text: &str) -> Result<EntryFormat, String> {
    let name = if text == "klipper" { EntryFormat::TICKS.name } else { text };
    let found = EntryFormat::ALL.into_iter().find(|format| format.name == name);
    found.ok_or_else(|| "unknown format; use q16, q8, ticks or klipper".to_owned())
}

fn table_name(text: &str) -> Result<String, String> {
    check_name(text).map(|()| text.to_owned())
}

#[derive(Clone, Copy)]
pub(super) enum AxisChoice {
    One(usize),
    All,
}

fn axis_choice(text: &str) -> Result<AxisChoice, String> {
    if text == "all" {
        return Ok(AxisChoice::All);
    }
    whole::<usize>(0..=u64::MAX)(text).map(AxisChoice::One).map_err(|why| format!("{why}, or all"))
}

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
    /// Fewest entries. If the minimum is not proven, the summary column `surplus` states the maximum number of extra entries
    #[default]
    Fewest,
    /// Hundreds of times faster: each entry is the longest one whose last step is near the middle of its allowed time range
    Quick,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(super) enum FormName {
    /// Each step in its exact cycle
    Exact,
    /// The move's table as in its paper (Sonobe 2011, Zhang 2012); other moves have none
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
