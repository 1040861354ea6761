//! The study: comparisons, tables, torque, and tables of edges.

mod compare;
mod measures;
mod motors;
mod remedies;
mod replay;
mod sine;
mod tables;
mod torque;
mod trace_file;

pub use measures::step_figures;
pub use motors::{sheets, with_motor};
pub use replay::replay;
pub use sine::{sine_best, sine_rows, sine_vertices};
pub use tables::step_walker;
pub use trace_file::TraceFile;
