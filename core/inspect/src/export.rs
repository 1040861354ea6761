//! Files of a run: value change dumps, CSV tables, step tables and source code.
//!
//! ```
//! use stepscope_inspect::export::step_tables::StepTables;
//! use stepscope_sim::ValidatedScenario;
//!
//! let scenario = ValidatedScenario::from_json("{}"); // one turn of 3200 steps
//! let tables = StepTables::new(scenario.axis(0, 0).expect("one axis")).expect("its pulses fit");
//! let header = tables.source(0, ("compressed", "q16", 25.0), "c").expect("it has a table");
//! assert!(header.contains("#define AXIS_0_STEPS 3200ull"));
//! ```

pub mod panel;
pub mod plain_text;
pub mod source_code;
pub mod step_tables;
pub mod tables;
#[cfg(feature = "std")]
pub mod vcd;
