//! Tables as files of source code, and `--check`.

use super::axes::{Axes, Steps};
use super::options::{Arguments, AxisChoice, FormName, Search, WindowName};
use crate::failure::{Failure, plural};
use crate::output::{self, Outputs, STANDARD};
use crate::{progress, scenarios, terminal};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use stepscope_core::inspect::export::source_code::{
    Language, NamedTable, Origin, Request, Source, WALKER, WALKER_FILE, WrittenTable, first_axis, read_c,
};
use stepscope_core::motion::step_tables::{EntryFormat, Stored};

/// The chosen tables, and the options that made them.
struct Chosen {
    /// Base of the names, and of the include guard.
    name: String,
    /// As on the command line; `None` for axis 0.
    axis: Option<String>,
    form: FormName,
    format: EntryFormat,
    tables: Vec<(String, Stored)>,
}

impl Chosen {
    fn new(axes: &Axes, arguments: &Arguments) -> Result<Self, Failure> {
        let (form, format) = (arguments.form, arguments.entries);
        let form = form.unwrap_or(FormName::Exact);
        let format = format.unwrap_or(EntryFormat::TICKS);
        let given = arguments.name.as_deref();
        let table = |axis: usize, steps: &Steps, name: String| {
            let stored = axes.stored(steps, form, format).map_err(|cause| axes.failure(axis, cause))?;
            Ok((name, stored))
        };
        let (name, axis, numbers) = match arguments.axis {
            Some(AxisChoice::All) => (given.unwrap_or("axis").to_owned(), Some("all".to_owned()), None),
            Some(AxisChoice::One(axis)) => {
                let name = given.map_or_else(|| format!("axis_{axis}"), str::to_owned);
                (name, (axis > 0).then(|| axis.to_string()), Some(axis))
            }
            None => (given.unwrap_or("axis_0").to_owned(), None, Some(0)),
        };
        let chosen =
            axes.axes.iter().enumerate().filter(|(axis, _)| numbers.is_none_or(|only| only == *axis));
        let tables: Result<Vec<_>, Failure> = chosen
            .map(|(axis, steps)| {
                let name = numbers.map_or_else(|| format!("{name}_{axis}"), |_| name.clone());
                table(axis, steps, name)
            })
            .collect();
        Ok(Self { tables: tables?, name, axis, form, format })
    }

    /// The text of the file, and the warnings that are in it.
    fn text(
        &self,
        axes: &Axes,
        arguments: &Arguments,
        language: Language,
    ) -> Result<(String, Vec<String>), Failure> {
        let bytes =
            |path: &Option<PathBuf>| path.as_ref().map(|path| path.as_os_str().as_encoded_bytes().to_vec());
        let (scenario, steps) = (bytes(&arguments.scenario), bytes(&arguments.steps));
        let request = Request {
            scenario: scenario.as_deref(),
            steps: steps.as_deref(),
            axis: self.axis.as_deref(),
            form: self.form.name(),
            error_us: arguments.error_us(),
            interval_part: arguments.interval_part.map(Into::into),
            is_early: arguments.window == Some(WindowName::Early),
            is_quick: arguments.search == Some(Search::Quick),
            entries: self.format.name,
            language: language.name(),
            name: &self.name,
        };
        let origin = Origin::new(&request, &axes.scenario, axes.listed.as_deref());
        let tables: Vec<_> =
            self.tables.iter().map(|(name, table)| NamedTable { name: name.clone(), table }).collect();
        let source = Source { name: &self.name, tables: &tables, clock_hz: axes.clock_hz, origin: &origin };
        let mut text = String::new();
        source
            .write(language, &mut text)
            .map_err(|error| Failure::File(arguments.out.out.clone(), io::Error::other(error)))?;
        Ok((text, source.warnings(language)))
    }
}

pub(super) fn write(axes: &Axes, arguments: &Arguments, language: Language) -> Result<(), Failure> {
    if language == Language::Csv && matches!(arguments.axis, Some(AxisChoice::All)) {
        let why = "--axis all: a CSV file has one table; use --axis K, or --format c, avr or rust";
        return Err(Failure::Option(why.to_owned()));
    }
    let walker = arguments.with_walker.then(|| walker_path(arguments, language)).transpose()?;
    let chosen = Chosen::new(axes, arguments)?;
    let (text, warnings) = chosen.text(axes, arguments, language)?;
    let out = arguments.out.out.as_path();
    let inputs = arguments.scenario.iter().chain(&arguments.steps);
    let outputs = [("out", out)].into_iter().chain(walker.as_deref().map(|walker| ("with_walker", walker)));
    let mut files = Outputs::check(inputs, outputs)?;
    let mut file = |path: &Path, text: &str| {
        let mut out = files.create(path)?;
        out.write_all(text.as_bytes())
            .and_then(|()| out.flush())
            .map_err(|error| Failure::File(path.to_owned(), error))
    };
    file(out, &text)?;
    if let Some(walker) = &walker {
        file(walker, WALKER)?;
    }
    progress::print_written(&files.commit()?);
    let mut notes = warnings.into_iter().map(|warning| format!("warning: {warning}")).collect::<Vec<_>>();
    if arguments.form.is_none() || arguments.entries.is_none() {
        notes.push(format!("form {}, entries {}", chosen.form.name(), chosen.format.name));
    }
    for note in notes {
        let _ = writeln!(terminal::err(), "{note}");
    }
    Ok(())
}

fn walker_path(arguments: &Arguments, language: Language) -> Result<PathBuf, Failure> {
    let out = arguments.out.out.as_path();
    let why = match language {
        Language::C | Language::Avr if out != Path::new(STANDARD) => {
            return Ok(out.with_file_name(WALKER_FILE));
        }
        Language::C | Language::Avr => {
            "--with-walker: the walker is written next to the table; use --out FILE, or --walker for standard output"
        }
        Language::Rust | Language::Csv => {
            "--with-walker: only tables in C need the walker; use --format c or --format avr"
        }
    };
    Err(Failure::Option(why.to_owned()))
}

/// `--check`: compares the tables of `file`, or those that would be written.
pub(super) fn check(axes: &Axes, arguments: &Arguments, file: Option<&Path>) -> Result<(), Failure> {
    let (tables, axis) = match file {
        Some(path) => {
            let text = scenarios::text(path)?;
            let tables = read_c(&text).map_err(|why| Failure::Invalid(path.to_owned(), why))?;
            (tables, first_axis(&text))
        }
        None => {
            let language = arguments.format.language().unwrap_or(Language::C);
            let language = if language == Language::Avr { Language::Avr } else { Language::C };
            let (text, _) = Chosen::new(axes, arguments)?.text(axes, arguments, language)?;
            let tables = read_c(&text).map_err(|why| Failure::Invalid(axes.path.clone(), why))?;
            (tables, 0)
        }
    };
    let first = match arguments.axis {
        Some(AxisChoice::One(axis)) => axis,
        Some(AxisChoice::All) => 0,
        None => axis,
    };
    let (count, plans) = (tables.len(), axes.axes.len());
    if first + count > plans {
        let path = file.unwrap_or(&axes.path).to_owned();
        let why = format!(
            "{count} table{} from axis {first} on, but the scenario has {plans}; use the scenario of the tables",
            plural(count as u64)
        );
        return Err(Failure::Invalid(path, why));
    }
    let compared = tables.iter().zip(axes.axes.iter().enumerate().skip(first));
    let rows: Vec<_> =
        compared.map(|(table, (axis, steps))| row(table, axis, steps, axes.clock_hz)).collect();
    output::write_new(&arguments.out.out, |out| rows.iter().try_for_each(|(_, row)| writeln!(out, "{row}")))?;
    match rows.iter().filter(|(passed, _)| !passed).count() {
        0 => Ok(()),
        differ => {
            let (s, verb) = (plural(count as u64), if differ == 1 { "differs" } else { "differ" });
            Err(Failure::Check(format!("--check: {differ} of {count} table{s} {verb} from the plan")))
        }
    }
}

/// Whether a table passed, and its line.
fn row(table: &WrittenTable, axis: usize, steps: &Steps, clock_hz: u32) -> (bool, String) {
    let found = match steps {
        Steps::Planned(plan) => table.check(plan.due_steps(clock_hz), clock_hz),
        Steps::Listed(steps) => table.check(steps.iter().copied(), clock_hz),
    };
    let WrittenTable { name, steps, max_error_cycles, .. } = table;
    let result = match &found {
        Ok(largest) => {
            format!(
                "passed: {steps} step{}, largest error {largest} cycle{}, at most {max_error_cycles} stated",
                plural(*steps),
                plural(*largest)
            )
        }
        Err(why) => format!("failed: {why}"),
    };
    (found.is_ok(), format!("{name}, axis {axis}: {result}"))
}
