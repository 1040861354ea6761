//! What the page calls: the core behind wasm-bindgen. Nothing is decided here.
//!
//! | feature | what it has | where the page loads it |
//! | --- | --- | --- |
//! | `run` | scenarios judged and run ([`Simulation`]), links read and written | in a worker |
//! | `charts` | charts as pictures | in the same module, on the main thread |
//! | `capture` | files of logic analysers, read and mapped | in a module of its own, with the first such file, in a worker |
//! | `live` | the host of a real device, and the device of a real host | in a module of its own, with the first of them, in a worker |
//! | `panel` | stand-alone controllers judged and run, for the first to look at what they made | in a module of its own, with the first such scenario, in the same worker |
//! | `study` | long questions: the study, what a motor can do, a file held against a run | in a module of its own, later, in further workers |

#[cfg(any(feature = "run", feature = "panel"))]
mod advance;
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
#[cfg(any(feature = "run", feature = "study", feature = "panel"))]
mod judged;
#[cfg(any(feature = "run", feature = "panel"))]
mod link;
#[cfg(feature = "live")]
mod live;
#[cfg(feature = "study")]
mod measures;
#[cfg(feature = "study")]
mod motors;
#[cfg(feature = "run")]
mod packets;
#[cfg(feature = "panel")]
mod panel;
#[cfg(any(feature = "run", feature = "panel"))]
mod plant;
#[cfg(feature = "run")]
mod presets;
#[cfg(feature = "run")]
mod pulses;
#[cfg(feature = "study")]
mod remedies;
#[cfg(feature = "study")]
mod replay;
#[cfg(any(feature = "run", feature = "panel"))]
mod scenarios;
#[cfg(any(feature = "run", feature = "panel"))]
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
#[cfg(any(feature = "run", feature = "study", feature = "panel"))]
pub use judged::Judged;
#[cfg(any(feature = "run", feature = "panel"))]
pub use link::open_link;
#[cfg(feature = "run")]
pub use link::{link_part, link_with, pack_link, unpack_link};
#[cfg(feature = "live")]
pub use live::{LiveDevice, LiveHost, LiveRawHost, live_is_raw};
#[cfg(feature = "study")]
pub use measures::step_figures;
#[cfg(feature = "study")]
pub use motors::{sheets, with_motor};
#[cfg(feature = "panel")]
pub use panel::{PanelRun, panel_preset};
#[cfg(feature = "run")]
pub use presets::presets;
#[cfg(feature = "study")]
pub use replay::replay;
#[cfg(any(feature = "run", feature = "panel"))]
pub use scenarios::{default_scenario, version};
#[cfg(any(feature = "run", feature = "panel"))]
pub use schema::schema;
#[cfg(feature = "run")]
pub use simulation::Simulation;
#[cfg(feature = "study")]
pub use sine::{sine_best, sine_rows, sine_vertices};
#[cfg(feature = "run")]
pub use timing::drivers;
#[cfg(feature = "study")]
pub use trace_file::TraceFile;
