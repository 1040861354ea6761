//! Packets with their fields, outcomes and faults.
//!
//! ```
//! use stepscope_inspect::{packets::packet_table::PacketTable, trace::stored_run::record_run};
//! use stepscope_sim::Experiment;
//!
//! let experiment = Experiment::from_json("{}").expect("it is valid");
//! let (run, recordings) = record_run(&experiment, 1).expect("it is short");
//! let table = PacketTable::new(&experiment, &run, 0, &recordings[0].packets);
//! let row = table.row(0).expect("there are packets");
//! assert_eq!((row.kind, row.outcome.as_str()), ("packet", "queued"));
//! ```

pub mod dissector;
pub mod line_decoder;
pub mod log;
pub mod packet_table;
