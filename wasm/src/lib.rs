//! What the page calls: the core behind wasm-bindgen. Nothing is decided here.
//!
//! The page loads this module twice: in a worker, where scenarios are judged, links read and
//! written and [`Simulation`] runs, and on the main thread, where the charts are drawn.

mod charts;
mod compare;
mod convert;
mod curves;
mod files;
mod judged;
mod link;
mod measures;
mod packets;
mod pulses;
mod schema;
mod simulation;
mod sine;
mod spectrum;
mod summary;
mod tables;
mod timing;
mod torque;
mod verify;

pub use judged::{Judged, default_scenario, presets, version};
pub use link::{decode_link, link_part, link_with, replay};
pub use schema::schema;
pub use simulation::Simulation;
pub use sine::{sine_best, sine_rows, sine_vertices};
pub use timing::drivers;
