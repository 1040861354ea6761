//! `stepscope tables`: step times of a scenario's axes as tables for a firmware.

mod export;
mod options;

use self::options::{FormName, Search, WindowName, Written};
use crate::failure::{Failure, Numbered};
use crate::options::{Json, Out};
use crate::quantity::{Microseconds, whole};
use crate::{json::Tables, output, run_recording, scenarios, steps::steps_of_table};
use clap::Args;
use serde_json::json;
use std::io::{self, Write};
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};
use stepscope_core::{
    inspect::export::{
        source_code::{WALKER, check_name},
        step_tables::{scheduled, tolerance_cycles},
    },
    motion::{
        AxisPlan, Cause, ScheduledStep, plan_lists, round_half_up,
        step_tables::{EntryFormat, Form, Stored, Tolerance, stored, stored_steps},
    },
    peripheral::{config::Config, segment::PulseTimes, trace::steps},
    scenario::{Problem, Scenario, Source as ScenarioSource, ValueError, of_config, of_motion},
    sim::Experiment,
};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario: a JSON file or a preset's name; `-` reads standard input
    ///
    /// If its source is not a motion, the steps of its run are used. With --steps, only its clock and pulse times are
    /// used (default: 16 MHz and the default bus).
    #[arg(required_unless_present_any = ["steps", "walker"])]
    scenario: Option<PathBuf>,
    /// Read step times from a CSV table, as axis 0
    ///
    /// One row per step. The column cycle, time_s, time_ms or time_us has the time from the start; the column dir has
    /// the direction: 1 or right, 0 or left.
    #[arg(long, value_name = "FILE")]
    steps: Option<PathBuf>,
    /// Form of the table (default: exact; for a summary, all)
    #[arg(long, value_enum)]
    form: Option<FormName>,
    /// Maximum error of a step in a compressed table, in us (default: 25)
    #[arg(long, value_name = "US")]
    error_us: Option<Microseconds>,
    /// Maximum error of a step in a compressed table, as 1/N of a step interval (Klipper: 2)
    ///
    /// Applies in addition to --error-us. The interval is the shorter of the two next to the step; with --window early,
    /// the one before it.
    #[arg(long, value_name = "N", value_parser = whole::<NonZeroU32>(1..=u32::MAX.into()))]
    interval_part: Option<NonZeroU32>,
    /// Allowed direction of the error in a compressed table (default: both)
    #[arg(long, value_enum)]
    window: Option<WindowName>,
    /// Search method of a compressed table (default: fewest)
    ///
    /// With q8 and q16, fewest differs from quick only if the maximum error is below 2048 units of the format (q8:
    /// 8 cycles, q16: 1/32 cycle).
    #[arg(long, value_enum)]
    search: Option<Search>,
    /// Format of an entry: q16, q8, ticks or klipper (default: ticks; for a summary, all)
    ///
    /// q16 has 20 bytes and a resolution of 1/65536 cycle, q8 has 8 bytes and 1/256 cycle, ticks has 8 bytes and whole
    /// cycles. klipper is another name for ticks: the arguments of Klipper's queue_step.
    #[arg(long, value_name = "FORMAT", value_parser = entry_format)]
    entries: Option<EntryFormat>,
    /// Output format
    #[arg(long, value_enum, default_value = "summary", conflicts_with = "json")]
    format: Written,
    /// Axis, from 0, or all in one file (default: 0; for a summary, all)
    #[arg(long, value_name = "K", value_parser = axis_choice)]
    axis: Option<AxisChoice>,
    /// Name of the table in source code (default: axis_K)
    ///
    /// Use up to 32 lower-case letters, digits and underscores after a first letter. Keywords of C, C++ and avr-libc are
    /// refused, and names that begin with stepscope. With --axis all the tables are NAME_0, NAME_1 and so on.
    #[arg(long, value_parser = table_name, conflicts_with = "json")]
    name: Option<String>,
    /// Also write stepscope_walk.h, which tables in C include, next to --out
    #[arg(long)]
    with_walker: bool,
    /// Write only stepscope_walk.h
    #[arg(long, conflicts_with_all = ["scenario", "steps", "with_walker", "check", "json", "name", "form",
        "entries", "error_us", "interval_part", "window", "search", "format", "axis"])]
    walker: bool,
    /// Compare a table with the plan, step by step; exit code 3 if it differs
    ///
    /// FILE is a table in C; without FILE, the table that --format c would write is compared. The direction of each step must
    /// be that of the plan, and its time must be within the error that the table states. The stated shortest and longest event
    /// must be correct, too. The first table of a file belongs to --axis, by default the axis in its header. No file is
    /// written.
    #[arg(long, value_name = "FILE", num_args = 0..=1, conflicts_with_all = ["json", "with_walker"])]
    check: Option<Option<PathBuf>>,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    out: Out,
}

/// Maximum error of a compressed table by default, in us.
const ERROR_US: f64 = 25.0;

impl Arguments {
    fn error_us(&self) -> f64 {
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
enum AxisChoice {
    One(usize),
    All,
}

fn axis_choice(text: &str) -> Result<AxisChoice, String> {
    if text == "all" {
        return Ok(AxisChoice::All);
    }
    whole::<usize>(0..=u64::MAX)(text).map(AxisChoice::One).map_err(|why| format!("{why}, or all"))
}

struct Axes {
    path: PathBuf,
    scenario: Scenario,
    /// The text of `--steps`.
    listed: Option<String>,
    clock_hz: u32,
    pulse: PulseTimes,
    axes: Vec<Steps>,
    tolerance: Tolerance,
    search: Search,
}

enum Steps {
    Planned(AxisPlan),
    Listed(Vec<ScheduledStep>),
}

impl Axes {
    fn new(arguments: &Arguments) -> Result<Self, Failure> {
        let scenario = arguments.scenario.as_deref().map(scenarios::read).transpose()?.unwrap_or_default();
        let path = arguments.scenario.clone().unwrap_or_else(|| PathBuf::from("the default scenario"));
        let wrong = |problems| Failure::Scenario(path.clone(), problems);
        // Without a motion, use the steps of the scenario's run.
        let run_steps = match (&scenario.source, &arguments.steps) {
            (ScenarioSource::Motion(_), _) | (_, Some(_)) => None,
            _ => Some(steps_of_run(&path, &scenario)?),
        };
        let clock_hz = scenario.clock_hz;
        let config = Config::of_segments(clock_hz, &scenario.bus, &scenario.line.serial());
        let pulse = PulseTimes::from(&config.map_err(of_config).map_err(wrong)?);
        let cycles = tolerance_cycles(arguments.error_us(), clock_hz);
        let (interval_part, search) = (arguments.interval_part, arguments.search.unwrap_or_default());
        let tolerance =
            Tolerance { cycles, interval_part, side: arguments.window.unwrap_or_default().side() };
        let listed = arguments.steps.as_deref().map(scenarios::text).transpose()?;
        let (path, axes) = if let (Some(list), Some(text)) = (&arguments.steps, &listed) {
            let steps = steps_of_table(text, clock_hz).map_err(|why| Failure::Invalid(list.clone(), why))?;
            (list.clone(), vec![Steps::Listed(steps)])
        } else if let Some(run_steps) = run_steps {
            (path, run_steps.into_iter().map(Steps::Listed).collect())
        } else {
            let list = match &scenario.source {
                ScenarioSource::Motion(motion) => Some(motion.axis_list()),
                _ => None,
            };
            let plans = plan_lists(list);
            let plans = plans.map_err(of_motion).map_err(wrong)?;
            (path, plans.into_iter().flatten().map(Steps::Planned).collect())
        };
        Ok(Self { path, scenario, listed, clock_hz, pulse, axes, tolerance, search })
    }

    fn stored(&self, steps: &Steps, form: FormName, format: EntryFormat) -> Result<Stored, Cause> {
        let form = match (form, self.search) {
            (FormName::Exact, _) => Form::Exact,
            (FormName::Document, _) => Form::Document,
            (FormName::Compressed, Search::Fewest) => Form::Compressed(self.tolerance),
            (FormName::Compressed, Search::Quick) => Form::Quick(self.tolerance),
        };
        match steps {
            Steps::Planned(plan) => stored(plan, form, format, self.pulse, self.clock_hz),
            Steps::Listed(steps) => stored_steps(steps, form, format, self.pulse),
        }
    }

    fn failure(&self, axis: usize, cause: Cause) -> Failure {
        if let Some(Steps::Listed(_)) = self.axes.get(axis) {
            return Failure::Invalid(self.path.clone(), cause.to_string());
        }
        let problem = Problem::new(format!("source.motion.axes[{axis}]"), cause);
        Failure::Scenario(self.path.clone(), problem.into())
    }
}

/// Steps of the scenario's run from cycle 1, for each channel up to the last one with steps.
fn steps_of_run(path: &Path, scenario: &Scenario) -> Result<Vec<Vec<ScheduledStep>>, Failure> {
    let wrong = |problems| Failure::Scenario(path.to_owned(), problems);
    let experiment = Experiment::new(scenario).map_err(wrong)?;
    let recording = run_recording::of(path, &experiment)?;
    let of = |channel| scheduled(&steps(&recording.trace, channel));
    let mut all: Vec<_> = (0..experiment.config().channels()).map(of).collect();
    while all.last().is_some_and(Vec::is_empty) {
        all.pop();
    }
    if all.is_empty() {
        let detail = "no channel has steps, so there is no table; use a scenario with steps, or --steps";
        return Err(wrong(Problem::new("source", ValueError::Conflict { detail }).into()));
    }
    Ok(all)
}

pub(crate) fn tables(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.walker {
        return output::write_new(&arguments.out.out, |out| out.write_all(WALKER.as_bytes()));
    }
    options::check(arguments)?;
    let axes = Axes::new(arguments)?;
    let count = axes.axes.len();
    let is_summary = arguments.format == Written::Summary && arguments.check.is_none();
    let axis = match arguments.axis {
        Some(AxisChoice::One(axis)) => axis,
        Some(AxisChoice::All) | None => 0,
    };
    if axis >= count {
        return Err(Failure::index(&axes.path, Numbered::Axes, axis, count, is_summary));
    }
    if let Some(file) = &arguments.check {
        return export::check(&axes, arguments, file.as_deref());
    }
    let Some(language) = arguments.format.language() else {
        if arguments.with_walker {
            let why = "--with-walker: a summary needs no walker; use it with --format c or --format avr";
            return Err(Failure::Option(why.to_owned()));
        }
        return output::write_new(&arguments.out.out, |out| {
            if arguments.json.json {
                json_tables(&axes, arguments).write(out)
            } else {
                print_summary(&axes, arguments, out)
            }
        });
    };
    export::write(&axes, arguments, language)
}

/// The table of each axis, form and entry format, or the reason why there is none.
fn all_tables<'a>(
    axes: &'a Axes,
    arguments: &'a Arguments,
) -> impl Iterator<Item = (usize, FormName, EntryFormat, Result<Stored, Cause>)> + 'a {
    let forms = [FormName::Exact, FormName::Document, FormName::Compressed];
    let forms = forms.into_iter().filter(|form| arguments.form.is_none_or(|only| only == *form));
    let formats = EntryFormat::ALL.into_iter();
    let formats = formats.filter(|format| arguments.entries.is_none_or(|only| only == *format));
    let chosen = axes.axes.iter().enumerate().filter(|(axis, _)| match arguments.axis {
        Some(AxisChoice::One(only)) => only == *axis,
        Some(AxisChoice::All) | None => true,
    });
    chosen.flat_map(move |(axis, steps)| {
        let formats = formats.clone();
        forms.clone().flat_map(move |form| {
            formats.clone().map(move |format| (axis, form, format, axes.stored(steps, form, format)))
        })
    })
}

fn print_summary(axes: &Axes, arguments: &Arguments, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "axis form       entries    count        bytes  document_bytes      steps  largest_error_us  rms_error_us    turns  wire_bytes  surplus"
    )?;
    for (axis, form, format, table) in all_tables(axes, arguments) {
        write!(out, "{axis:4} {:10} {:7}", form.name(), format.name)?;
        match table {
            Ok(table) => print_row(&table, axes.clock_hz, out)?,
            Err(cause) => writeln!(out, "  {cause}")?,
        }
    }
    Ok(())
}

fn json_tables(axes: &Axes, arguments: &Arguments) -> Tables {
    let micros = |cycles: f64| cycles * 1e6 / f64::from(axes.clock_hz.max(1));
    let rows = all_tables(axes, arguments).map(|(axis, form, format, table)| {
        let why = table.as_ref().err().map(ToString::to_string);
        let table = table.as_ref().ok();
        json!({
            "axis": axis,
            "form": form.name(),
            "entries": format.name,
            "count": table.map(|table| table.entries.len()),
            "bytes": table.map(Stored::bytes),
            "document_bytes": table.and_then(|table| table.document_bytes),
            "steps": table.map(|table| table.error.steps),
            "largest_error_us": table.map(|table| micros(table.error.max_cycles as f64)),
            "rms_error_us": table.map(|table| micros(table.error.rms())),
            "turns": table.map(Stored::entries_without_steps),
            "wire_bytes": table.and_then(Stored::wire_bytes),
            "surplus": table.and_then(|table| table.surplus),
            "why_not": why,
        })
    });
    Tables::of("tables").with("tables", rows)
}

fn print_row(table: &Stored, clock_hz: u32, out: &mut impl Write) -> io::Result<()> {
    let shown = |number: Option<u64>| number.map_or_else(|| "-".to_owned(), |number| number.to_string());
    let micros = |cycles: f64| round_half_up(cycles * 1e9 / f64::from(clock_hz)) as f64 / 1e3;
    writeln!(
        out,
        " {:8} {:12} {:>15} {:10} {:17.3} {:13.3} {:8} {:>11} {:>8}",
        table.entries.len(),
        table.bytes(),
        shown(table.document_bytes),
        table.error.steps,
        micros(table.error.max_cycles as f64),
        micros(table.error.rms()),
        table.entries_without_steps(),
        shown(table.wire_bytes()),
        shown(table.surplus)
    )
}
