//! Progress of a long command, in percent on standard error.

use std::io::{self, IsTerminal, Write};

pub(crate) struct Progress {
    shown: bool,
    what: &'static str,
    percent: Option<u64>,
}

impl Progress {
    /// Shown on a terminal, or if `wanted`.
    pub(crate) fn new(what: &'static str, wanted: bool) -> Self {
        Self { shown: wanted || io::stderr().is_terminal(), what, percent: None }
    }

    pub(crate) fn tell(&mut self, done: u64, all: u64) {
        let percent = (u128::from(done.min(all)) * 100 / u128::from(all.max(1))) as u64;
        if self.shown && self.percent.is_none_or(|before| before < percent) {
            self.percent = Some(percent);
            // On a terminal each line overwrites the one before.
            let end = if io::stderr().is_terminal() { '\r' } else { '\n' };
            // If standard error is closed, progress is not needed.
            let _ = write!(io::stderr(), "{}: {percent:3} %{end}", self.what);
        }
    }
}

impl Drop for Progress {
    /// Start a new line for later output.
    fn drop(&mut self) {
        if self.percent.is_some() && io::stderr().is_terminal() {
            let _ = writeln!(io::stderr());
        }
    }
}
