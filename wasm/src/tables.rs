//! The step times of an axis as tables for a firmware: what each form costs, and its source code (DESIGN B8, Part D).

use crate::{
    convert::object,
    judged::{Judged, listed},
};
use serde::Serialize;
use stepscope_core::{
    inspect::source_code::{Language, Source, headline},
    motion::quantise::{EntryFormat, Form, Stored, Tolerance, stored},
    peripheral::{config::Config, segment::PulseTimes, units::Cycles},
    scenario::{Scenario, of_config},
    sim::SelectedAxis,
};
use wasm_bindgen::prelude::*;

/// What a table costs and how good it is.
#[derive(Serialize)]
struct Told {
    /// As many as the motion has: a list with another number is none.
    steps: u64,
    entries: usize,
    bytes: u64,
    /// As the motion's document keeps it.
    document_bytes: Option<u64>,
    largest_s: f64,
    rms_s: f64,
    /// Why there is no such table.
    why: Option<String>,
}

/// The axis whose table is requested.
struct Request<'a> {
    clock_hz: u32,
    pulse: PulseTimes,
    selected: SelectedAxis<'a>,
}

impl<'a> Request<'a> {
    fn new(selected: SelectedAxis<'a>) -> Result<Self, JsError> {
        let Scenario { clock_hz, line, .. } = selected.scenario;
        let config = Config::of_segments(*clock_hz, selected.bus, &line.serial());
        let config = config.map_err(of_config).map_err(|problems| listed(&problems))?;
        Ok(Self { clock_hz: *clock_hz, pulse: PulseTimes::from(&config), selected })
    }

    fn stored(&self, form: &str, widths: &str, error_us: f64) -> Result<Stored, String> {
        // One division, so that 25 us of 16 MHz are 400 cycles and not 399.
        let tolerance = Cycles((error_us * f64::from(self.clock_hz) / 1e6) as u64);
        let form = match form {
            "exact" => Form::Exact,
            "document" => Form::Document,
            _ => Form::Compressed(Tolerance::of(tolerance)),
        };
        let format = EntryFormat::ALL.into_iter().find(|format| format.name == widths);
        let format = format.unwrap_or(EntryFormat::Q16);
        stored(self.selected.plan, form, format, self.pulse, self.clock_hz).map_err(|cause| cause.to_string())
    }
}

#[wasm_bindgen]
impl Judged {
    /// What a table of an axis costs, `form` being `exact`, `document` or `compressed` with no step off by more than
    /// `error_us`, `widths` those of its entries: `{steps, entries, bytes, document_bytes, largest_s, rms_s, why}`.
    ///
    /// # Errors
    /// If the scenario has problems, or no such axis; why an axis has no such table is in the result.
    pub fn step_table(
        &self,
        controller: usize,
        axis: usize,
        form: &str,
        widths: &str,
        error_us: f64,
    ) -> Result<JsValue, JsError> {
        let request = Request::new(self.axis(controller, axis)?)?;
        let seconds = |cycles: f64| cycles / f64::from(request.clock_hz);
        object(&match request.stored(form, widths, error_us) {
            Ok(table) => Told {
                steps: table.error.steps,
                entries: table.entries.len(),
                bytes: table.bytes(),
                document_bytes: table.document_bytes,
                largest_s: seconds(table.error.greatest as f64),
                rms_s: seconds(table.error.rms()),
                why: None,
            },
            Err(why) => Told {
                steps: request.selected.plan.step_count(),
                entries: 0,
                bytes: 0,
                document_bytes: None,
                largest_s: 0.0,
                rms_s: 0.0,
                why: Some(why),
            },
        })
    }

    /// A table as source code, `language` being `c`, `avr`, `rust` or `csv`; the rest as [`step_table`].
    ///
    /// # Errors
    /// As [`step_table`], and if there is no such table.
    #[allow(clippy::too_many_arguments, reason = "JavaScript gives them one by one")]
    pub fn step_source(
        &self,
        controller: usize,
        axis: usize,
        form: &str,
        widths: &str,
        error_us: f64,
        language: &str,
    ) -> Result<String, JsError> {
        let request = Request::new(self.axis(controller, axis)?)?;
        let table = request.stored(form, widths, error_us).map_err(|why| JsError::new(&why))?;
        let language = match language {
            "avr" => Language::Avr,
            "rust" => Language::Rust,
            "csv" => Language::Csv,
            _ => Language::C,
        };
        let title = headline(&request.selected.scenario.title, axis, form);
        let name = format!("axis_{axis}");
        let source = Source { name: &name, title: &title, clock_hz: request.clock_hz, table: &table };
        let mut text = String::new();
        source.write(language, &mut text).map_err(|error| JsError::new(&error.to_string()))?;
        Ok(text)
    }
}
