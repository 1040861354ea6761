//! Scenarios that a command writes. What is written can be read again: it is validated first, short enough, and refused before
//! a file is begun where it is not.

use crate::{failure::Failure, terminal};
use std::{
    io::{self, Write},
    path::Path,
};
use stepscope_core::scenario::Scenario;

/// The text of a scenario for the file `path`, with its last line feed. `help` says what makes it shorter.
///
/// # Errors
/// If the scenario has problems, or is longer than one that is read.
pub(crate) fn text(path: &Path, scenario: &Scenario, help: &'static str) -> Result<String, Failure> {
    scenario.check().map_err(|problems| Failure::Scenario(path.to_owned(), problems))?;
    let text = scenario.to_file_json().ok_or_else(|| Failure::LongScenario(path.to_owned(), help))?;
    let mut text = terminal::json(&text);
    text.push('\n');
    Ok(text)
}

/// Prints a scenario.
///
/// # Errors
/// As [`text`], and those of standard output.
pub(crate) fn print(path: &Path, scenario: &Scenario, help: &'static str) -> Result<(), Failure> {
    let text = text(path, scenario, help)?;
    io::stdout().write_all(text.as_bytes()).map_err(Failure::output)
}
