//! Writes scenarios that can be read again: they are validated, and refused if too long, before a file is created.

use crate::{failure::Failure, output, terminal};
use std::{io::Write, path::Path};
use stepscope_core::scenario::{MAX_TEXT_BYTES, Scenario};

/// The text for the file `path`. `help` says how to shorten it.
pub(crate) fn text(path: &Path, scenario: &Scenario, help: &'static str) -> Result<String, Failure> {
    scenario.check().map_err(|problems| Failure::Scenario(path.to_owned(), problems))?;
    let text = scenario.to_file_json().ok_or_else(|| {
        let why = format!("not written: the scenario has more than {MAX_TEXT_BYTES} bytes and could not be read again; {help}");
        Failure::Invalid(path.to_owned(), why)
    })?;
    let mut text = terminal::json(&text);
    text.push('\n');
    Ok(text)
}

/// Writes the scenario to `out`; a message names its source, `from`.
pub(crate) fn write(out: &Path, from: &Path, scenario: &Scenario, help: &'static str) -> Result<(), Failure> {
    let text = text(from, scenario, help)?;
    output::write_new(out, |out| out.write_all(text.as_bytes()))
}
