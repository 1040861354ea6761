//! `stepscope calibrate`: steps per millimeter from measured lengths (DESIGN B3, Zhang 2012).

use crate::{failure::Failure, json::Tables, options::Json, scenarios, terminal};
use clap::Args;
use serde_json::json;
use std::io::{self, Write};
use std::path::PathBuf;
use stepscope_core::inspect::motion::calibration::{Calibration, Fit, Pair};

/// Possible columns of a length, with mm per unit.
const LENGTHS: [(&str, f64); 3] = [("length_mm", 1.0), ("length_cm", 10.0), ("length_m", 1000.0)];

#[derive(Args)]
pub(crate) struct Arguments {
    /// CSV table with the columns length_mm (or length_cm, length_m) and steps; `-` reads standard input
    table: PathBuf,
    #[command(flatten)]
    json: Json,
}

pub(crate) fn calibrate(arguments: &Arguments) -> Result<(), Failure> {
    let text = scenarios::text(&arguments.table)?;
    let bad = |what| Failure::Invalid(arguments.table.clone(), what);
    let pairs = pairs(&text).map_err(bad)?;
    let found = Calibration::of(&pairs).map_err(|error| bad(error.to_string()))?;
    if arguments.json.json {
        return tables(&found, &pairs).print();
    }
    print(&found, &pairs).map_err(Failure::output)
}

fn tables(found: &Calibration, pairs: &[Pair]) -> Tables {
    let row = |name: &str, fit: &Fit| {
        let k = fit.steps_per_unit;
        let (index, largest) = fit.largest().unzip();
        json!({
            "fit": name,
            "pairs": pairs.len(),
            "steps_per_mm": k,
            "step_mm": 1.0 / k,
            "offset_steps": fit.offset_steps,
            "rms_residual_steps": fit.rms(),
            "largest_residual_steps": largest,
            "largest_at_mm": index.and_then(|index| pairs.get(index)).map(|pair| pair.length),
        })
    };
    let fits = [row("through_origin", &found.through_origin), row("with_offset", &found.with_offset)];
    Tables::of("calibrate").with("fits", fits)
}

fn pairs(text: &str) -> Result<Vec<Pair>, String> {
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
    let head = reader.headers().map_err(|error| error.to_string())?.clone();
    let column = |name: &str| head.iter().position(|field| field == name);
    let length = LENGTHS.iter().find_map(|(name, mm)| Some((column(name)?, *name, *mm)));
    let missing = "use a first row with the columns length_mm (or length_cm, length_m) and steps";
    let (length, length_name, mm) = length.ok_or_else(|| format!("no column has lengths; {missing}"))?;
    let steps = column("steps").ok_or_else(|| format!("there is no column steps; {missing}"))?;
    let mut pairs = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| error.to_string())?;
        let line = record.position().map_or(0, csv::Position::line);
        let number = |at: usize, name: &str| {
            let given = record.get(at).unwrap_or_default();
            let number = given.parse::<f64>().ok().filter(|number| number.is_finite());
            number.ok_or_else(|| {
                format!("line {line}: {name}: \"{given}\" is not a number; use digits and a decimal point")
            })
        };
        pairs.push(Pair { length: mm * number(length, length_name)?, steps: number(steps, "steps")? });
    }
    Ok(pairs)
}

fn print(found: &Calibration, pairs: &[Pair]) -> io::Result<()> {
    let mut out = terminal::out();
    writeln!(out, "pairs               {}", pairs.len())?;
    writeln!(out, "steps = k*length")?;
    print_fit(&found.through_origin, pairs, &mut out)?;
    writeln!(out, "steps = k*length + offset")?;
    let with_offset = &found.with_offset;
    let offset_mm = with_offset.offset_steps / with_offset.steps_per_unit;
    writeln!(out, "  offset            {:.3} steps, {offset_mm:.6} mm", with_offset.offset_steps)?;
    print_fit(with_offset, pairs, &mut out)?;
    let step_mm = 1.0 / found.through_origin.steps_per_unit;
    writeln!(out, "\"mechanics\": {{ \"direct\": {{ \"step_mm\": {step_mm} }} }}")
}

/// Uses an exponent if the decimals would cut off significant digits, or the text would be long.
fn digits(number: f64, decimals: usize) -> String {
    if (1e-3..1e9).contains(&number) { format!("{number:.decimals$}") } else { format!("{number:.9e}") }
}

fn print_fit(fit: &Fit, pairs: &[Pair], out: &mut impl Write) -> io::Result<()> {
    let k = fit.steps_per_unit;
    writeln!(out, "  k                 {} steps/mm, {} mm per step", digits(k, 6), digits(1.0 / k, 9))?;
    writeln!(out, "  RMS residual      {:.3} steps, {:.6} mm", fit.rms(), fit.rms() / k)?;
    let Some((index, largest)) = fit.largest() else { return Ok(()) };
    let length = pairs.get(index).map_or(0.0, |pair| pair.length);
    writeln!(out, "  largest residual  {largest:.3} steps, {:.6} mm, at {length} mm", largest / k)
}
