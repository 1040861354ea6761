//! Step tables of an axis or a run for firmware ([`StepTables`]).

use crate::convert::{object, records};
use crate::scenario::{ValidatedScenario, listed};
use stepscope_core::inspect::export::source_code::WALKER;
use stepscope_core::inspect::export::step_tables::{StepTables, Subject};
use stepscope_core::{peripheral::trace::steps, sim::bus_of};
use wasm_bindgen::prelude::*;

/// The file `stepscope_walk.h`, which tables in C include.
#[wasm_bindgen]
pub fn step_walker() -> String {
    WALKER.to_owned()
}

#[wasm_bindgen]
impl ValidatedScenario {
    /// Size and error of a table. `form` is `exact`, `document` or `compressed`, with at most `error_us`.
    /// Errors: if the scenario has problems, or no such axis. The result has other reasons in `why`.
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

    /// A table as source code; `language` is `c`, `avr`, `rust` or `csv`, and `file` the name of the scenario's file.
    /// Errors: as [`ValidatedScenario::step_table`], or if the table is impossible.
    #[allow(clippy::too_many_arguments, reason = "JavaScript passes plain values")]
    pub fn step_source(
        &self,
        controller: usize,
        axis: usize,
        form: &str,
        widths: &str,
        error_us: f64,
        language: &str,
        file: &str,
    ) -> Result<String, JsError> {
        let subject = Subject { file, controller, axis };
        let source = self.tables(controller, axis)?.source(&subject, (form, widths, error_us), language);
        source.map_err(|why| JsError::new(&why))
    }

    /// Size and error of a table of a channel without a plan, from the records of `Simulation::records_of`.
    /// Errors: if the scenario has problems, or the bus cannot run segments.
    #[allow(clippy::too_many_arguments, reason = "JavaScript passes plain values")]
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

    /// That table as source code, as [`ValidatedScenario::step_source`].
    /// Errors: as [`ValidatedScenario::step_table_of_run`], or if the table is impossible.
    #[allow(clippy::too_many_arguments, reason = "JavaScript passes plain values")]
    pub fn step_source_of_run(
        &self,
        controller: usize,
        channel: u8,
        run: &[u8],
        form: &str,
        widths: &str,
        error_us: f64,
        language: &str,
        file: &str,
    ) -> Result<String, JsError> {
        let tables = self.tables_of_run(controller, channel, run)?;
        let subject = Subject { file, controller, axis: channel.into() };
        let source = tables.source(&subject, (form, widths, error_us), language);
        source.map_err(|why| JsError::new(&why))
    }
}

impl ValidatedScenario {
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
