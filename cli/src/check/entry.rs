//! The entries of a list of checks, and the command lines that make them.

use crate::{failure::Failure, suggest};
use serde_json::{Map, Value};
use std::path::Path;

/// Maximum number of checks of a file.
const MAX_CHECKS: usize = 10_000;

pub(super) struct Entry {
    pub(super) name: String,
    pub(super) driver: Option<String>,
    pub(super) kind: Kind,
}

pub(super) enum Kind {
    /// A recording and the scenario that it is compared with; options as words.
    Capture {
        file: String,
        against: String,
        options: Vec<String>,
    },
    Run {
        scenario: String,
        digest: Option<String>,
    },
    /// `run` replaces the scenario of the table's own command.
    Table {
        table: String,
        run: Option<String>,
    },
}

impl Entry {
    /// The file that is checked.
    pub(super) fn file(&self) -> &str {
        match &self.kind {
            Kind::Capture { file, .. } => file,
            Kind::Run { scenario, .. } => scenario,
            Kind::Table { table, .. } => table,
        }
    }

    fn driver_words(&self, is_strict: bool) -> impl Iterator<Item = String> {
        let driver = self.driver.iter().flat_map(|driver| ["--driver".to_owned(), driver.clone()]);
        driver.chain(is_strict.then(|| "--strict".to_owned()))
    }

    pub(super) fn capture_words(&self, is_strict: bool) -> Vec<String> {
        let Kind::Capture { file, against, options } = &self.kind else { return Vec::new() };
        let words = ["capture", file, "--against", against].map(str::to_owned);
        words.into_iter().chain(options.clone()).chain(self.driver_words(is_strict)).collect()
    }

    pub(super) fn run_words(&self, is_strict: bool) -> Vec<String> {
        let Kind::Run { scenario, .. } = &self.kind else { return Vec::new() };
        let words = ["run", scenario, "--digest"].map(str::to_owned);
        words.into_iter().chain(self.driver_words(is_strict)).collect()
    }
}

/// Reads a list of checks.
///
/// # Errors
/// [`Failure::Invalid`] with every problem.
pub(super) fn read(path: &Path, text: &str, command: &mut clap::Command) -> Result<Vec<Entry>, Failure> {
    let wrong = |why: String| Failure::Invalid(path.to_owned(), why);
    let value: Value = serde_json::from_str(text)
        .map_err(|error| wrong(format!("not JSON: {error}; use {{\"checks\": [ … ]}}")))?;
    let list = match &value {
        Value::Object(object) if object.len() == 1 => object.get("checks").and_then(Value::as_array),
        _ => None,
    };
    let list =
        list.ok_or_else(|| wrong("use one object with the list checks, {\"checks\": [ … ]}".to_owned()))?;
    if list.is_empty() || list.len() > MAX_CHECKS {
        return Err(wrong(format!("{} checks; use 1 to {MAX_CHECKS}", list.len())));
    }
    let (mut entries, mut problems) = (Vec::new(), Vec::new());
    for (index, value) in list.iter().enumerate() {
        let mut reader = Reader { path: format!("checks[{index}]"), problems: &mut problems, command };
        entries.extend(reader.entry(value));
    }
    if problems.is_empty() { Ok(entries) } else { Err(wrong(problems.join("\n  "))) }
}

const CAPTURE: &[&str] =
    &["name", "capture", "against", "channel", "align", "within_us", "map", "clock_hz", "baud", "driver"];
const RUN: &[&str] = &["name", "run", "digest", "driver"];
const TABLE: &[&str] = &["name", "table", "run"];

struct Reader<'p> {
    path: String,
    problems: &'p mut Vec<String>,
    command: &'p mut clap::Command,
}

impl Reader<'_> {
    fn note(&mut self, field: &str, why: &str) {
        let dot = if field.is_empty() { "" } else { "." };
        self.problems.push(format!("{}{dot}{field}: {why}", self.path));
    }

    /// `None`, and noted, if it is not a text.
    fn text(&mut self, object: &Map<String, Value>, field: &str) -> Option<String> {
        match object.get(field)? {
            Value::String(text) if !text.is_empty() && !text.starts_with('-') => Some(text.clone()),
            other => {
                self.note(field, &format!("{other} is not valid; use a text that begins with no hyphen"));
                None
            }
        }
    }

    /// A name is no word of a command line, so that it may begin with a hyphen.
    fn name(&mut self, object: &Map<String, Value>) -> Option<String> {
        match object.get("name")? {
            Value::String(text) if !text.is_empty() => Some(text.clone()),
            other => {
                self.note("name", &format!("{other} is not valid; use a text"));
                None
            }
        }
    }

    fn required(&mut self, object: &Map<String, Value>, field: &str) -> Option<String> {
        if !object.contains_key(field) {
            self.note(field, "missing; use the name of a file");
        }
        self.text(object, field)
    }

    fn number(&mut self, object: &Map<String, Value>, field: &str) -> Option<String> {
        match object.get(field)? {
            Value::Number(number) => Some(number.to_string()),
            other => {
                self.note(field, &format!("{other} is not valid; use a number"));
                None
            }
        }
    }

    /// Notes the options that the command itself refuses, such as a number that is out of range.
    fn check_words(&mut self, words: &[String]) {
        let words = ["stepscope"].into_iter().chain(words.iter().map(String::as_str));
        if let Err(error) = self.command.try_get_matches_from_mut(words) {
            let text = error.to_string();
            let lines = text.lines().map(str::trim).take_while(|line| !line.is_empty());
            let text = lines.collect::<Vec<_>>().join("; ");
            self.note("", text.strip_prefix("error: ").unwrap_or(&text));
        }
    }

    fn entry(&mut self, value: &Value) -> Option<Entry> {
        let before = self.problems.len();
        let Value::Object(object) = value else {
            self.note("", "not an object; use one with capture, run or table");
            return None;
        };
        let fields = match ["capture", "table", "run"].into_iter().find(|kind| object.contains_key(*kind)) {
            Some("capture") => CAPTURE,
            Some("table") => TABLE,
            Some(_) => RUN,
            None => {
                self.note("", "no check; use one of capture, run and table");
                return None;
            }
        };
        for name in object.keys().filter(|name| !fields.contains(&name.as_str())) {
            let hint = suggest::hint(name, fields.iter().copied());
            self.note(name, &format!("unknown field{hint}; use one of {}", fields.join(", ")));
        }
        let (name, driver) = (self.name(object), self.text(object, "driver"));
        let kind = if fields == CAPTURE {
            let file = self.required(object, "capture")?;
            let against = self.required(object, "against")?;
            Kind::Capture { file, against, options: self.options(object) }
        } else if fields == TABLE {
            Kind::Table { table: self.required(object, "table")?, run: self.text(object, "run") }
        } else {
            let scenario = self.required(object, "run")?;
            Kind::Run { scenario, digest: self.digest(object) }
        };
        let entry = Entry { name: String::new(), driver, kind };
        if fields == CAPTURE {
            self.check_words(&entry.capture_words(false));
        }
        let name = name.unwrap_or_else(|| entry.file().to_owned());
        (self.problems.len() == before).then_some(Entry { name, ..entry })
    }

    fn options(&mut self, object: &Map<String, Value>) -> Vec<String> {
        let mut words = Vec::new();
        for (field, option) in [
            ("channel", "--channel"),
            ("align", "--align"),
            ("within_us", "--within-us"),
            ("clock_hz", "--clock"),
            ("baud", "--baud"),
        ] {
            words.extend(self.number(object, field).into_iter().flat_map(|value| [option.to_owned(), value]));
        }
        words.extend(self.text(object, "map").into_iter().flat_map(|map| ["--map".to_owned(), map]));
        words
    }

    fn digest(&mut self, object: &Map<String, Value>) -> Option<String> {
        let digest = self.text(object, "digest")?;
        let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
        if digest.len() != 16 || !digest.bytes().all(is_digit) {
            self.note("digest", &format!("{digest} is not a digest; use 16 digits of 0-9 and a-f"));
        }
        Some(digest)
    }
}
