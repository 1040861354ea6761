//! `stepscope tables`: step times of a scenario's axes as tables for a firmware.

mod axes;
mod export;
mod options;

pub(crate) use self::options::Arguments;

use self::axes::Axes;
use self::options::{AxisChoice, FormName, Written};
use crate::failure::{Failure, Numbered};
use crate::{json::Tables, output};
use serde_json::json;
use std::io::{self, Write};
use stepscope_core::{
    inspect::export::source_code::WALKER,
    motion::{
        Cause, round_half_up,
        step_tables::{EntryFormat, Stored},
    },
};

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
