//! Progress of long work on standard error, and a last line that sums it up.

use crate::terminal::{self, Escaped};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};
use std::{fmt, path::PathBuf};

/// Work that ends sooner shows no bar.
const DELAY: Duration = Duration::from_millis(400);
const TEMPLATE: &str = "{prefix} [{bar:30}] {percent:>3} %, {eta} left";
/// Resolution of the bar.
const LENGTH: u64 = 1000;

#[derive(Clone, Copy, PartialEq)]
enum Style {
    Bar,
    /// A line per percent, for programs.
    Lines,
    Hidden,
}

impl Style {
    /// A bar on a terminal; elsewhere nothing, or lines if requested.
    fn new(is_requested: bool) -> Self {
        match (io::stderr().is_terminal() && std::env::var_os("CI").is_none(), is_requested) {
            (true, _) => Self::Bar,
            (false, true) => Self::Lines,
            (false, false) => Self::Hidden,
        }
    }
}

pub(crate) struct Progress {
    command: &'static str,
    style: Style,
    start: Instant,
    /// Equal parts of the work, and those that are done.
    parts: u64,
    done: u64,
    bar: Option<ProgressBar>,
    percent: Option<u64>,
}

impl Progress {
    pub(crate) fn new(command: &'static str, is_requested: bool) -> Self {
        let (style, start) = (Style::new(is_requested), Instant::now());
        Self { command, style, start, parts: 1, done: 0, bar: None, percent: None }
    }

    pub(crate) fn with_parts(mut self, parts: usize) -> Self {
        self.parts = parts.max(1) as u64;
        self
    }

    pub(crate) fn next_part(&mut self) {
        self.done += 1;
    }

    pub(crate) fn update(&mut self, done: u64, all: u64) {
        let all = all.max(1);
        let done_units = u128::from(self.done.min(self.parts)) * u128::from(all) + u128::from(done.min(all));
        let total_units = u128::from(self.parts) * u128::from(all);
        let of = |length: u64| {
            u64::try_from(done_units * u128::from(length) / total_units).unwrap_or(length).min(length)
        };
        match self.style {
            Style::Hidden => {}
            Style::Bar if self.start.elapsed() < DELAY => {}
            Style::Bar => {
                let at = of(LENGTH);
                self.bar.get_or_insert_with(|| bar(self.command, self.start.elapsed())).set_position(at);
            }
            Style::Lines => {
                let percent = of(100);
                if self.percent.is_none_or(|before| before < percent) {
                    self.percent = Some(percent);
                    // If standard error is closed, progress is not needed.
                    let _ = writeln!(io::stderr(), "{}: {percent:3} %", self.command);
                }
            }
        }
    }

    /// Ends with a line: what was done, in what time, and the files that were written.
    pub(crate) fn end(mut self, done: impl fmt::Display, written: &[PathBuf]) {
        let took = self.start.elapsed();
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
        match self.style {
            Style::Hidden => return,
            Style::Bar if took < DELAY && written.is_empty() => return,
            Style::Bar | Style::Lines => {}
        }
        let files = Files(written);
        let _ = writeln!(terminal::err(), "{}: {done} in {:.1} s{files}", self.command, took.as_secs_f64());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn bar(command: &'static str, elapsed: Duration) -> ProgressBar {
    let style = ProgressStyle::with_template(TEMPLATE).unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::new(LENGTH).with_style(style.progress_chars("#> ")).with_prefix(command);
    bar.with_elapsed(elapsed)
}

/// On a terminal, names the files that quick work has written.
pub(crate) fn print_written(written: &[PathBuf]) {
    if !written.is_empty() && Style::new(false) == Style::Bar {
        let text = Files(written).to_string();
        let _ = writeln!(terminal::err(), "{}", text.trim_start_matches("; "));
    }
}

struct Files<'a>(&'a [PathBuf]);

impl fmt::Display for Files<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, path) in self.0.iter().enumerate() {
            write!(f, "{}{}", if index == 0 { "; wrote " } else { ", " }, Escaped::path(path))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_continues_the_percentage_of_the_last() {
        let mut progress = Progress::new("parts", false).with_parts(4);
        progress.style = Style::Lines;
        let mut seen = Vec::new();
        for _ in 0..4 {
            for done in [0, 5, 10] {
                progress.update(done, 10);
                seen.extend(progress.percent);
            }
            progress.next_part();
        }
        assert_eq!(seen, [0, 12, 25, 25, 37, 50, 50, 62, 75, 75, 87, 100]);
    }

    #[test]
    fn lists_the_written_files() {
        let paths = ["a.vcd", "b\u{1b}.csv"].map(PathBuf::from);
        assert_eq!(Files(&paths).to_string(), "; wrote a.vcd, b\\u{1b}.csv");
        assert_eq!(Files(&[]).to_string(), "");
    }
}
