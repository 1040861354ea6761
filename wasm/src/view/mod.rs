//! The first screen: validation, runs, data of the views, charts and links.

mod advance;
mod charts;
mod curves;
mod files;
mod link;
mod packets;
mod panel;
mod panel_log;
mod plant;
mod presets;
mod pulses;
mod scenarios;
mod schema;
mod simulation;
mod spectrum;
mod summary;
mod timing;
mod verify;

pub use link::{link_part, link_with, open_link};
pub use presets::presets;
pub use scenarios::{default_scenario, version};
pub use schema::schema;
pub use simulation::Simulation;
pub use timing::drivers;
