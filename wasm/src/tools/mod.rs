//! The study, recordings, exports and real serial lines.

mod capture;
mod compare;
mod live;
mod measures;
mod motors;
mod remedies;
mod replay;
mod sine;
mod tables;
mod torque;
mod trace_file;

pub use capture::{CaptureFile, sample_facts};
pub use live::{LiveDevice, LiveHost, LiveRawHost, live_is_raw};
pub use measures::step_figures;
pub use motors::{sheets, with_motor};
pub use replay::replay;
pub use sine::{sine_best, sine_rows, sine_vertices};
pub use tables::step_walker;
pub use trace_file::TraceFile;
