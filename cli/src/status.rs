//! What `stepscope run` prints: digests, and what controllers and host have come to.

use std::io::{self, Write};
use stepscope_core::sim::Summary;

/// One digest a line.
pub(crate) fn digests(summary: &Summary) -> io::Result<()> {
    let mut out = io::stdout().lock();
    summary.controllers.iter().try_for_each(|controller| writeln!(out, "{:016x}", controller.digest))
}

/// Digests, and the summary below them.
pub(crate) fn print(summary: &Summary) -> io::Result<()> {
    let mut out = io::stdout().lock();
    for controller in &summary.controllers {
        writeln!(out, "digest {:016x}", controller.digest)?;
    }
    write!(out, "{summary}")
}
