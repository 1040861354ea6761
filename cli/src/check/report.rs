//! The results of checks: lines, JUnit XML, Markdown.

use super::entry::Entry;
use crate::{failure::Failure, output::Out, terminal::Escaped};
use std::fmt;
use std::io::{self, Write};

pub(super) type Writer = fn(&Results<'_>, &mut Out) -> io::Result<()>;

pub(super) enum Outcome {
    Passed,
    /// The first difference.
    Failed(String),
    /// The exit code, and why the check could not run.
    Error(i32, String),
}

pub(super) struct CheckResult<'e> {
    pub(super) entry: &'e Entry,
    pub(super) outcome: Outcome,
    pub(super) seconds: f64,
}

#[derive(Default)]
pub(super) struct Results<'e>(Vec<CheckResult<'e>>);

impl Outcome {
    /// Of a call with this exit code and these errors.
    pub(super) fn of_code(code: i32, err: &str) -> Self {
        let why = err.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join("; ");
        match code {
            0 => Self::Passed,
            3 => Self::Failed(why),
            code => Self::Error(code, why),
        }
    }

    const fn word(&self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed(_) => "failed",
            Self::Error(..) => "error",
        }
    }

    fn why(&self) -> &str {
        match self {
            Self::Passed => "",
            Self::Failed(why) | Self::Error(_, why) => why,
        }
    }
}

impl fmt::Display for CheckResult<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A line feed in a name could begin a command to the runner.
        write!(f, "{} {}", self.outcome.word(), Escaped(&self.entry.name))?;
        let why = self.outcome.why();
        if why.is_empty() { Ok(()) } else { write!(f, ": {}", Escaped(why)) }
    }
}

impl<'e> Results<'e> {
    pub(super) fn add(&mut self, result: CheckResult<'e>) {
        self.0.push(result);
    }

    fn count(&self, is: impl Fn(&Outcome) -> bool) -> usize {
        self.0.iter().filter(|result| is(&result.outcome)).count()
    }

    fn failed(&self) -> usize {
        self.count(|outcome| matches!(outcome, Outcome::Failed(_)))
    }

    fn errors(&self) -> usize {
        self.count(|outcome| matches!(outcome, Outcome::Error(..)))
    }

    /// A check that could not run takes precedence over one that failed.
    pub(super) fn failure(&self) -> Option<Failure> {
        let codes = || {
            self.0.iter().filter_map(|result| match &result.outcome {
                Outcome::Error(code, _) => Some((*code, result.entry.file())),
                _ => None,
            })
        };
        let why = || "a check could not run; see its line".to_owned();
        if let Some((_, file)) = codes().find(|(code, _)| *code == 1) {
            return Some(Failure::Unusable(file.to_owned(), why()));
        }
        if let Some((_, file)) = codes().next() {
            return Some(Failure::Invalid(file.into(), why()));
        }
        match self.failed() {
            0 => None,
            1 => Some(Failure::Check("1 check failed".to_owned())),
            failed => Some(Failure::Check(format!("{failed} checks failed"))),
        }
    }
}

impl fmt::Display for Results<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let passed = self.count(|outcome| matches!(outcome, Outcome::Passed));
        write!(f, "{passed} passed, {} failed", self.failed())?;
        match self.errors() {
            0 => Ok(()),
            1 => f.write_str(", 1 error"),
            errors => write!(f, ", {errors} errors"),
        }
    }
}

/// Text of an attribute or element. XML 1.0 has no other control characters.
fn xml(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

pub(super) fn write_junit(results: &Results<'_>, out: &mut Out) -> io::Result<()> {
    let time: f64 = results.0.iter().map(|result| result.seconds).sum();
    let (tests, failures, errors) = (results.0.len(), results.failed(), results.errors());
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>")?;
    writeln!(
        out,
        "  <testsuite name=\"stepscope\" tests=\"{tests}\" failures=\"{failures}\" errors=\"{errors}\" time=\"{time:.3}\">"
    )?;
    for CheckResult { entry, outcome, seconds } in &results.0 {
        let (file, name, why) = (xml(entry.file()), xml(&entry.name), xml(outcome.why()));
        write!(out, "    <testcase classname=\"{file}\" name=\"{name}\" time=\"{seconds:.3}\"")?;
        match outcome {
            Outcome::Passed => writeln!(out, "/>")?,
            Outcome::Failed(_) => writeln!(out, "><failure message=\"{why}\"/></testcase>")?,
            Outcome::Error(..) => writeln!(out, "><error message=\"{why}\"/></testcase>")?,
        }
    }
    writeln!(out, "  </testsuite>\n</testsuites>")
}

/// Text of a table's cell.
fn cell(text: &str) -> String {
    let escaped = |c: char| matches!(c, '\\' | '|' | '`' | '*' | '_' | '<' | '[' | ']');
    let mut out = String::new();
    for c in text.chars() {
        if escaped(c) {
            out.push('\\');
        }
        out.push(if c.is_control() { ' ' } else { c });
    }
    out
}

pub(super) fn write_markdown(results: &Results<'_>, out: &mut Out) -> io::Result<()> {
    writeln!(out, "### Stepscope: {results}\n\n| check | file | result | |\n| --- | --- | --- | --- |")?;
    for result in &results.0 {
        let (name, file) = (cell(&result.entry.name), cell(result.entry.file()));
        writeln!(out, "| {name} | {file} | {} | {} |", result.outcome.word(), cell(result.outcome.why()))?;
    }
    Ok(())
}
