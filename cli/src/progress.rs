//! How far a long command has come, on standard error.

use std::io::{self, IsTerminal, Write};

/// A line that says how far it is, in per cent; nothing where nobody looks.
pub(crate) struct Progress {
    shown: bool,
    what: &'static str,
    percent: Option<u64>,
}

impl Progress {
    /// Progress of `what`, shown on a terminal, or wherever it is `wanted`.
    pub(crate) fn new(what: &'static str, wanted: bool) -> Self {
        Self { shown: wanted || io::stderr().is_terminal(), what, percent: None }
    }

    /// Says that `done` of `all` is done, if that is another per cent.
    pub(crate) fn tell(&mut self, done: u64, all: u64) {
        let percent = (u128::from(done.min(all)) * 100 / u128::from(all.max(1))) as u64;
        if self.shown && self.percent.is_none_or(|before| before < percent) {
            self.percent = Some(percent);
            // On a terminal each overwrites the one before; elsewhere each is a line.
            let end = if io::stderr().is_terminal() { '\r' } else { '\n' };
            // Who has closed standard error does not want to know.
            let _ = write!(io::stderr(), "{}: {percent:3} %{end}", self.what);
        }
    }
}

impl Drop for Progress {
    /// What follows begins on a line of its own.
    fn drop(&mut self) {
        if self.percent.is_some() && io::stderr().is_terminal() {
            let _ = writeln!(io::stderr());
        }
    }
}
