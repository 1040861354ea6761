//! What the page calls: the core behind wasm-bindgen. Nothing is decided here.
//!
//! | feature | what it has | where the page loads it |
//! | --- | --- | --- |
//! | `run` | scenarios judged and run ([`Simulation`]), links read and written | in a worker |
//! | `charts` | charts as pictures | in the same module, on the main thread |
//! | `capture` | files of logic analysers, read and mapped | in a module of its own, with the first such file, in a worker |
//! | `study` | long questions: the study, what a motor can do, a file held against a run | in a module of its own, later, in further workers |

#[cfg(feature = "capture")]
mod capture;
#[cfg(feature = "charts")]
mod charts;
#[cfg(feature = "study")]
mod compare;
mod convert;
#[cfg(feature = "run")]
mod curves;
#[cfg(feature = "run")]
mod files;
#[cfg(any(feature = "run", feature = "study"))]
mod judged;
#[cfg(feature = "run")]
mod link;
#[cfg(feature = "study")]
mod measures;
#[cfg(feature = "study")]
mod motors;
#[cfg(feature = "run")]
mod packets;
#[cfg(feature = "run")]
mod plant;
#[cfg(feature = "run")]
mod pulses;
#[cfg(feature = "study")]
mod remedies;
#[cfg(feature = "study")]
mod replay;
#[cfg(feature = "run")]
mod scenarios;
#[cfg(feature = "run")]
mod schema;
#[cfg(feature = "run")]
mod simulation;
#[cfg(feature = "study")]
mod sine;
#[cfg(feature = "run")]
mod spectrum;
#[cfg(feature = "run")]
mod summary;
#[cfg(feature = "study")]
mod tables;
#[cfg(feature = "run")]
mod timing;
#[cfg(feature = "study")]
mod torque;
#[cfg(feature = "study")]
mod trace_file;
#[cfg(feature = "run")]
mod verify;

#[cfg(feature = "capture")]
pub use capture::{CaptureFile, sample_facts};
#[cfg(any(feature = "run", feature = "study"))]
pub use judged::Judged;
#[cfg(feature = "run")]
pub use link::{decode_link, link_part, link_with};
#[cfg(feature = "study")]
pub use measures::step_figures;
#[cfg(feature = "study")]
pub use motors::{sheets, with_motor};
#[cfg(feature = "study")]
pub use replay::replay;
#[cfg(feature = "run")]
pub use scenarios::{default_scenario, presets, version};
#[cfg(feature = "run")]
pub use schema::schema;
#[cfg(feature = "run")]
pub use simulation::Simulation;
#[cfg(feature = "study")]
pub use sine::{sine_best, sine_rows, sine_vertices};
#[cfg(feature = "run")]
pub use timing::drivers;
#[cfg(feature = "study")]
pub use trace_file::TraceFile;
