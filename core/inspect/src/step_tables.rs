//! The step times of a selected axis as tables for a firmware: what each form costs, and its source code (DESIGN B8).
//!
//! ```
//! use stepscope_inspect::step_tables::StepTables;
//! use stepscope_sim::Judged;
//!
//! let judged = Judged::from_json("{}");
//! let tables = StepTables::new(judged.axis(0, 0).expect("one axis")).expect("its pulses fit");
//! let (exact, compressed) = (tables.cost("exact", "q16", 0.0), tables.cost("compressed", "q16", 25.0));
//! assert_eq!((exact.steps, compressed.steps), (3200, 3200));
//! assert!(compressed.bytes < exact.bytes / 4);
//! ```

use crate::source_code::{Language, Source, headline};
use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use serde::Serialize;
use stepscope_motion::quantise::{EntryFormat, Form, Stored, Tolerance, stored_quickly};
use stepscope_peripheral::{config::Config, segment::PulseTimes, units::Cycles};
use stepscope_scenario::{Problem, of_config};
use stepscope_sim::SelectedAxis;

/// The tables of one axis.
#[derive(Clone, Debug)]
pub struct StepTables<'a> {
    selected: SelectedAxis<'a>,
    pulse: PulseTimes,
}

/// What a table costs and how good it is.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TableCost {
    /// As many as the motion has: a list with another number is none.
    pub steps: u64,
    /// Entries of the table.
    pub entries: usize,
    /// Bytes of its entries.
    pub bytes: u64,
    /// As the motion's document keeps it.
    pub document_bytes: Option<u64>,
    /// Greatest error of a step.
    pub largest_s: f64,
    /// Root mean square of the errors.
    pub rms_s: f64,
    /// Why there is no such table.
    pub why: Option<String>,
}

/// A greatest error in us as whole cycles.
#[must_use]
pub fn tolerance_cycles(error_us: f64, clock_hz: u32) -> Cycles {
    // One division, so that 25 us of 16 MHz are 400 cycles and not 399.
    Cycles((error_us * f64::from(clock_hz) / 1e6) as u64)
}

impl<'a> StepTables<'a> {
    /// Of an axis, at the pulses of its bus.
    ///
    /// # Errors
    /// If the bus cannot run segments.
    pub fn new(selected: SelectedAxis<'a>) -> Result<Self, Vec<Problem>> {
        let scenario = selected.scenario;
        let config = Config::of_segments(scenario.clock_hz, selected.bus, &scenario.line.serial());
        Ok(Self { pulse: PulseTimes::from(&config.map_err(of_config)?), selected })
    }

    /// A table; `form` is `exact`, `document` or `compressed` with no step off by more than `error_us`, `widths` the
    /// name of an [`EntryFormat`]. A compressed one is made quickly, since it is made while one types; the command
    /// searches for the fewest entries.
    ///
    /// # Errors
    /// Why there is no such table.
    pub fn stored(&self, form: &str, widths: &str, error_us: f64) -> Result<Stored, String> {
        let clock_hz = self.selected.scenario.clock_hz;
        let form = match form {
            "exact" => Form::Exact,
            "document" => Form::Document,
            _ => Form::Compressed(Tolerance::of(tolerance_cycles(error_us, clock_hz))),
        };
        let format = EntryFormat::ALL.into_iter().find(|format| format.name == widths);
        let format = format.unwrap_or(EntryFormat::Q16);
        stored_quickly(self.selected.plan, form, format, self.pulse, clock_hz)
            .map_err(|cause| cause.to_string())
    }

    /// What a table costs, or why there is none.
    #[must_use]
    pub fn cost(&self, form: &str, widths: &str, error_us: f64) -> TableCost {
        let seconds = |cycles: f64| cycles / f64::from(self.selected.scenario.clock_hz);
        match self.stored(form, widths, error_us) {
            Ok(table) => TableCost {
                steps: table.error.steps,
                entries: table.entries.len(),
                bytes: table.bytes(),
                document_bytes: table.document_bytes,
                largest_s: seconds(table.error.greatest as f64),
                rms_s: seconds(table.error.rms()),
                why: None,
            },
            Err(why) => {
                let steps = self.selected.plan.step_count();
                TableCost { steps, why: Some(why), ..TableCost::default() }
            }
        }
    }

    /// A table of axis `axis` as source code, `language` being `c`, `avr`, `rust` or `csv`.
    ///
    /// # Errors
    /// Why there is no such table.
    pub fn source(
        &self,
        axis: usize,
        (form, widths, error_us): (&str, &str, f64),
        language: &str,
    ) -> Result<String, String> {
        let table = self.stored(form, widths, error_us)?;
        let language = match language {
            "avr" => Language::Avr,
            "rust" => Language::Rust,
            "csv" => Language::Csv,
            _ => Language::C,
        };
        let title = headline(&self.selected.scenario.title, axis, form);
        let (name, clock_hz) = (format!("axis_{axis}"), self.selected.scenario.clock_hz);
        let mut text = String::new();
        let source = Source { name: &name, title: &title, clock_hz, table: &table };
        source.write(language, &mut text).map_err(|error| error.to_string())?;
        Ok(text)
    }
}
