//! The step times of an axis, or of a run, as tables for a firmware ([`StepTables`]).

use crate::{
    convert::{object, records},
    judged::{Judged, listed},
};
use stepscope_core::{inspect::export::step_tables::StepTables, peripheral::trace::steps, sim::bus_of};
use wasm_bindgen::prelude::*;

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
        object(&self.tables(controller, axis)?.cost(form, widths, error_us))
    }

    /// A table as source code, `language` being `c`, `avr`, `rust` or `csv`; the rest as [`Judged::step_table`].
    ///
    /// # Errors
    /// As [`Judged::step_table`], and if there is no such table.
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
        let source = self.tables(controller, axis)?.source(axis, (form, widths, error_us), language);
        source.map_err(|why| JsError::new(&why))
    }

    /// The same of a channel that has no plan: `run` is what the views show of it, records as `Simulation::records_of` gives
    /// them.
    ///
    /// # Errors
    /// If the scenario has problems, or the bus cannot run segments.
    #[allow(clippy::too_many_arguments, reason = "JavaScript gives them one by one")]
    pub fn step_table_of_run(
        &self,
        controller: usize,
        channel: u8,
        run: &[u8],
        form: &str,
        widths: &str,
        error_us: f64,
    ) -> Result<JsValue, JsError> {
        object(&self.tables_of_run(controller, channel, run)?.cost(form, widths, error_us))
    }

    /// A table of that as source code, `language` as in [`Judged::step_source`].
    ///
    /// # Errors
    /// As [`Judged::step_table_of_run`], and if there is no such table.
    #[allow(clippy::too_many_arguments, reason = "JavaScript gives them one by one")]
    pub fn step_source_of_run(
        &self,
        controller: usize,
        channel: u8,
        run: &[u8],
        form: &str,
        widths: &str,
        error_us: f64,
        language: &str,
    ) -> Result<String, JsError> {
        let tables = self.tables_of_run(controller, channel, run)?;
        let source = tables.source(channel.into(), (form, widths, error_us), language);
        source.map_err(|why| JsError::new(&why))
    }
}

impl Judged {
    fn tables(&self, controller: usize, axis: usize) -> Result<StepTables<'_>, JsError> {
        StepTables::new(self.axis(controller, axis)?).map_err(|problems| listed(&problems))
    }

    fn tables_of_run(&self, controller: usize, channel: u8, run: &[u8]) -> Result<StepTables<'_>, JsError> {
        self.0.experiment().map_err(listed)?;
        let scenario = self.0.scenario();
        let bus = bus_of(scenario, controller).unwrap_or(&scenario.bus);
        let trace: Vec<_> = records(run).collect();
        StepTables::of_steps(scenario, bus, &steps(&trace, channel)).map_err(|problems| listed(&problems))
    }
}
