//! A status line on standard error, updated at most ten times per second.

use crate::terminal;
use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

const MIN_TIME: Duration = Duration::from_millis(100);

/// On a terminal it is overwritten; elsewhere it is shown only on request.
pub(crate) struct StatusLine {
    shown: bool,
    terminal: bool,
    last: Option<Instant>,
    wide: usize,
}

impl StatusLine {
    pub(crate) fn new(wanted: bool) -> Self {
        let terminal = io::stderr().is_terminal();
        Self { shown: wanted || terminal, terminal, last: None, wide: 0 }
    }

    pub(crate) fn update(&mut self, text: impl FnOnce() -> String) {
        if !self.shown || self.last.is_some_and(|last| last.elapsed() < MIN_TIME) {
            return;
        }
        self.last = Some(Instant::now());
        let text = text();
        // If standard error is closed, the line is not needed.
        let _ = if self.terminal {
            let wide = self.wide.max(text.chars().count());
            self.wide = text.chars().count();
            write!(io::stderr(), "\r").and_then(|()| write!(terminal::err(), "{text:wide$}"))
        } else {
            writeln!(terminal::err(), "{text}")
        };
    }

    pub(crate) fn note(&mut self, text: &str) {
        let end = if self.terminal && self.wide > 0 { "\n" } else { "" };
        self.wide = 0;
        let _ = writeln!(terminal::err(), "{end}{text}");
    }
}

impl Drop for StatusLine {
    fn drop(&mut self) {
        if self.terminal && self.wide > 0 {
            let _ = writeln!(terminal::err());
        }
    }
}
