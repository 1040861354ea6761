//! A line on standard error that says how things stand, at most ten times a second.

use crate::terminal;
use std::{
    io::{self, IsTerminal, Write},
    time::{Duration, Instant},
};

const MIN_TIME: Duration = Duration::from_millis(100);

/// The line; on a terminal each overwrites the one before, elsewhere it is shown where it is wanted.
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

    /// Says it, if it is time to.
    pub(crate) fn tell(&mut self, text: impl FnOnce() -> String) {
        if !self.shown || self.last.is_some_and(|last| last.elapsed() < MIN_TIME) {
            return;
        }
        self.last = Some(Instant::now());
        let text = text();
        // Who has closed standard error does not want to know.
        let _ = if self.terminal {
            let wide = self.wide.max(text.chars().count());
            self.wide = text.chars().count();
            write!(io::stderr(), "\r").and_then(|()| write!(terminal::err(), "{text:wide$}"))
        } else {
            writeln!(terminal::err(), "{text}")
        };
    }

    /// Says something that stays.
    pub(crate) fn note(&mut self, text: &str) {
        let end = if self.terminal && self.wide > 0 { "\n" } else { "" };
        self.wide = 0;
        let _ = writeln!(terminal::err(), "{end}{text}");
    }
}

impl Drop for StatusLine {
    /// What follows begins on a line of its own.
    fn drop(&mut self) {
        if self.terminal && self.wide > 0 {
            let _ = writeln!(terminal::err());
        }
    }
}
