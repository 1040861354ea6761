//! `stepscope tables`: the step times of a scenario's axes as tables for a firmware, and what each form costs.

use crate::{failure::Failure, files, scenarios};
use clap::{Args, ValueEnum};
use std::{
    io::{self, Write},
    num::NonZeroU32,
    path::PathBuf,
};
use stepscope_core::{
    inspect::{
        source_code::{Language, Source, headline, is_name},
        step_tables::tolerance_cycles,
    },
    motion::{
        AxisPlan, Cause, plan_lists,
        quantise::{EntryFormat, Form, Stored, Tolerance, stored},
        round_half_up,
    },
    peripheral::{config::Config, segment::PulseTimes},
    scenario::{Motion, Problem, Scenario, Source as ScenarioSource, ValueError, of_config, of_motion},
};

/// What `stepscope tables` takes.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario, a JSON file whose source is a motion; `-` reads standard input.
    scenario: PathBuf,
    /// How the step times are kept; a summary without it shows all three.
    #[arg(long, value_enum)]
    form: Option<FormName>,
    /// Greatest error of a step in a compressed table, in us.
    #[arg(long, value_name = "US", default_value = "25", value_parser = micros)]
    error_us: f64,
    /// In a compressed table no step is off by more than this part of the shorter interval beside it: 2 for a half.
    #[arg(long, value_name = "N")]
    interval_part: Option<NonZeroU32>,
    /// Widths of an entry: q16 (20 bytes, 1/65536 cycle), q8 (8 bytes, 1/256 cycle), ticks (8 bytes, whole
    /// cycles). A summary without it shows all of them.
    #[arg(long, value_name = "WIDTHS", value_parser = widths)]
    entries: Option<EntryFormat>,
    /// What is written: source code or CSV of one axis, or a summary of all.
    #[arg(long, value_enum, default_value = "summary")]
    format: Written,
    /// The axis whose table is written, from 0.
    #[arg(long, value_name = "K", default_value = "0")]
    axis: usize,
    /// Name of the table in source code: small letters, digits and underscores. `axis_K` without it.
    #[arg(long, value_parser = name)]
    name: Option<String>,
    /// Where it goes (`-`: standard output).
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
}

/// How step times are kept.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum FormName {
    /// Every step in its cycle.
    Exact,
    /// The motion's own table.
    Document,
    /// Few entries, with a greatest error.
    Compressed,
}

impl FormName {
    const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Document => "document",
            Self::Compressed => "compressed",
        }
    }
}

/// What is written.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Written {
    /// C99.
    C,
    /// C for avr-gcc, in program memory.
    Avr,
    /// Rust.
    Rust,
    /// Comma-separated values.
    Csv,
    /// What each form costs and how good it is.
    Summary,
}

impl Written {
    const fn language(self) -> Option<Language> {
        match self {
            Self::C => Some(Language::C),
            Self::Avr => Some(Language::Avr),
            Self::Rust => Some(Language::Rust),
            Self::Csv => Some(Language::Csv),
            Self::Summary => None,
        }
    }
}

fn micros(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|error| format!("{error}"))?;
    if (0.0..=1e9).contains(&value) { Ok(value) } else { Err("give 0 to 1e9".to_owned()) }
}

fn widths(text: &str) -> Result<EntryFormat, String> {
    let found = EntryFormat::ALL.into_iter().find(|format| format.name == text);
    found.ok_or_else(|| "give q16, q8 or ticks".to_owned())
}

fn name(text: &str) -> Result<String, String> {
    if is_name(text) {
        Ok(text.to_owned())
    } else {
        Err("give up to 32 small letters, digits and underscores, a letter first and not letters alone"
            .to_owned())
    }
}

/// The axes of a scenario, ready to be kept.
struct Axes {
    path: PathBuf,
    title: String,
    clock_hz: u32,
    pulse: PulseTimes,
    plans: Vec<AxisPlan>,
    tolerance: Tolerance,
}

impl Axes {
    fn new(arguments: &Arguments) -> Result<Self, Failure> {
        let path = arguments.scenario.clone();
        let Scenario { title, clock_hz, bus, line, source, .. } = scenarios::read(&path)?;
        let wrong = |problems| Failure::Scenario(path.clone(), problems);
        let ScenarioSource::Motion(Motion { axes, .. }) = &source else {
            let detail =
                "no motion, so there is nothing to make tables of; give a scenario with source.motion";
            return Err(wrong(vec![Problem::new("source", ValueError::Conflict { detail })]));
        };
        let config = Config::of_segments(clock_hz, &bus, &line.serial()).map_err(of_config).map_err(wrong)?;
        let plans = plan_lists([("source.motion.axes".to_owned(), axes.as_slice())])
            .map_err(of_motion)
            .map_err(wrong)?;
        let cycles = tolerance_cycles(arguments.error_us, clock_hz);
        let tolerance = Tolerance { cycles, interval_part: arguments.interval_part };
        let plans = plans.into_iter().flatten().collect();
        Ok(Self { pulse: PulseTimes::from(&config), path, title, clock_hz, plans, tolerance })
    }

    fn kept(&self, plan: &AxisPlan, form: FormName, format: EntryFormat) -> Result<Stored, Cause> {
        let form = match form {
            FormName::Exact => Form::Exact,
            FormName::Document => Form::Document,
            FormName::Compressed => Form::Compressed(self.tolerance),
        };
        stored(plan, form, format, self.pulse, self.clock_hz)
    }

    fn refused(&self, axis: usize, cause: Cause) -> Failure {
        let problem = Problem::new(format!("source.motion.axes[{axis}]"), cause);
        Failure::Scenario(self.path.clone(), vec![problem])
    }
}

/// Writes the table, or the summary.
pub(crate) fn tables(arguments: &Arguments) -> Result<(), Failure> {
    let axes = Axes::new(arguments)?;
    let failed = |error| Failure::File(arguments.out.clone(), error);
    let Some(language) = arguments.format.language() else {
        let mut out = files::create(&arguments.out).map_err(failed)?;
        return summary(&axes, arguments, &mut out).and_then(|()| out.flush()).map_err(failed);
    };
    let axis = arguments.axis;
    let plan = axes.plans.get(axis);
    let plan = plan.ok_or_else(|| Failure::Axis(axes.path.clone(), axis, axes.plans.len()))?;
    let form = arguments.form.unwrap_or(FormName::Compressed);
    let format = arguments.entries.unwrap_or(EntryFormat::Q16);
    let table = axes.kept(plan, form, format).map_err(|cause| axes.refused(axis, cause))?;
    let name = arguments.name.clone().unwrap_or_else(|| format!("axis_{axis}"));
    let title = headline(&axes.title, axis, form.name());
    let source = Source { name: &name, title: &title, clock_hz: axes.clock_hz, table: &table };
    let mut text = String::new();
    source.write(language, &mut text).map_err(|error| failed(io::Error::other(error)))?;
    let write = || {
        let mut out = files::create(&arguments.out)?;
        out.write_all(text.as_bytes())?;
        out.flush()
    };
    write().map_err(failed)
}

/// A row for each axis, form and width.
fn summary(axes: &Axes, arguments: &Arguments, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "axis form       entries    count        bytes  document_bytes      steps  largest_error_us  rms_error_us"
    )?;
    let forms = [FormName::Exact, FormName::Document, FormName::Compressed];
    for (axis, plan) in axes.plans.iter().enumerate() {
        for form in forms.into_iter().filter(|form| arguments.form.is_none_or(|only| only == *form)) {
            for format in EntryFormat::ALL {
                if arguments.entries.is_some_and(|only| only != format) {
                    continue;
                }
                write!(out, "{axis:4} {:10} {:7}", form.name(), format.name)?;
                match axes.kept(plan, form, format) {
                    Ok(table) => row(&table, axes.clock_hz, out)?,
                    Err(cause) => writeln!(out, "  {cause}")?,
                }
            }
        }
    }
    Ok(())
}

fn row(table: &Stored, clock_hz: u32, out: &mut impl Write) -> io::Result<()> {
    let document = table.document_bytes.map_or_else(|| "-".to_owned(), |bytes| bytes.to_string());
    let micros = |cycles: f64| round_half_up(cycles * 1e9 / f64::from(clock_hz)) as f64 / 1e3;
    writeln!(
        out,
        " {:8} {:12} {document:>15} {:10} {:17.3} {:13.3}",
        table.entries.len(),
        table.bytes(),
        table.error.steps,
        micros(table.error.greatest as f64),
        micros(table.error.rms())
    )
}
