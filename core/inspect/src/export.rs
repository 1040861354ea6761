//! Files of a run: value change dumps, CSV tables, step tables and source code.
//!
//! ```
//! use stepscope_inspect::export::step_tables::{StepTables, Subject};
//! use stepscope_sim::ValidatedScenario;
//!
//! let scenario = ValidatedScenario::from_json("{}"); // one turn of 3200 steps
//! let tables = StepTables::new(scenario.axis(0, 0).expect("one axis")).expect("its pulses fit");
//! let subject = Subject { file: "turn.json", controller: 0, axis: 0 };
//! let header = tables.source(&subject, ("exact", "ticks", 0.0), "c").expect("it has a table");
//! assert!(header.contains("#define AXIS_0_STEPS 3200UL"));
//! ```

pub mod panel;
pub mod plain_text;
pub mod source_code;
pub mod step_tables;
pub mod tables;
#[cfg(feature = "std")]
pub mod vcd;
