//! A sink for controllers whose signals nobody asked for.

use stepscope_peripheral::signal::{Record, Sink};

/// Takes what no one asked for.
pub(super) struct Ignored;

impl Sink for Ignored {
    fn record(&mut self, _: Record) {}
}
