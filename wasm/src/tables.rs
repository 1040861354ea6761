//! The step times of an axis as tables for a firmware ([`StepTables`]).

use crate::{
    convert::object,
    judged::{Judged, listed},
};
use stepscope_core::inspect::step_tables::StepTables;
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
}

impl Judged {
    fn tables(&self, controller: usize, axis: usize) -> Result<StepTables<'_>, JsError> {
        StepTables::new(self.axis(controller, axis)?).map_err(|problems| listed(&problems))
    }
}
