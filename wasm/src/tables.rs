//! The step times of an axis as tables for a firmware: what each form costs, and its source code (DESIGN B8, Part D).

use crate::{
    convert::object,
    subject::{Subject, listed},
};
use serde::Serialize;
use stepscope_core::scenario::of_config;
use stepscope_core::{
    inspect::source_code::{Language, Source, headline},
    motion::{
        AxisPlan,
        quantise::{EntryFormat, Form, Stored, Tolerance, stored},
    },
    peripheral::{config::Config, segment::PulseTimes, units::Cycles},
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

/// The axis whose table is asked for.
struct Asked {
    title: String,
    clock_hz: u32,
    pulse: PulseTimes,
    plan: AxisPlan,
}

impl Asked {
    fn new(json: &str, controller: usize, axis: usize) -> Result<Self, JsError> {
        let Subject { title, clock_hz, line, bus, plan, .. } = Subject::of(json, controller, axis)?;
        let config =
            Config::of_segments(clock_hz, &bus, &line.serial()).map_err(of_config).map_err(listed)?;
        Ok(Self { title, clock_hz, pulse: PulseTimes::from(&config), plan })
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
        stored(&self.plan, form, format, self.pulse, self.clock_hz).map_err(|cause| cause.to_string())
    }
}

/// What a table of an axis costs, `form` being `exact`, `document` or `compressed` with no step off by more than
/// `error_us`, `widths` those of its entries: `{steps, entries, bytes, document_bytes, largest_s, rms_s, why}`.
///
/// # Errors
/// If the scenario has problems, or no such axis; why an axis has no such table is in the result.
#[wasm_bindgen]
pub fn step_table(
    json: &str,
    controller: usize,
    axis: usize,
    form: &str,
    widths: &str,
    error_us: f64,
) -> Result<JsValue, JsError> {
    let asked = Asked::new(json, controller, axis)?;
    let seconds = |cycles: f64| cycles / f64::from(asked.clock_hz);
    object(&match asked.stored(form, widths, error_us) {
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
            steps: asked.plan.step_count(),
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
#[wasm_bindgen]
pub fn step_source(
    json: &str,
    controller: usize,
    axis: usize,
    form: &str,
    widths: &str,
    error_us: f64,
    language: &str,
) -> Result<String, JsError> {
    let asked = Asked::new(json, controller, axis)?;
    let table = asked.stored(form, widths, error_us).map_err(|why| JsError::new(&why))?;
    let language = match language {
        "avr" => Language::Avr,
        "rust" => Language::Rust,
        "csv" => Language::Csv,
        _ => Language::C,
    };
    let title = headline(&asked.title, axis, form);
    let name = format!("axis_{axis}");
    let source = Source { name: &name, title: &title, clock_hz: asked.clock_hz, table: &table };
    let mut text = String::new();
    source.write(language, &mut text).map_err(|error| JsError::new(&error.to_string()))?;
    Ok(text)
}
