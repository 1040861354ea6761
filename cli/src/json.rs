//! Tables for scripts: whatever `--json` is given to prints one object of one shape (docs/command.md).
//!
//! ```text
//! { "stepscope": "0.1.0", "command": "presets", "tables": { "presets": [ { "id": "…", "title": "…" }, … ] } }
//! ```
//!
//! A table is a list of rows, a row a map with the table's columns, all of them in each row; a cell is a number, a text, a
//! truth value, or null where there is none. Units stand in the columns' names.

use crate::{failure::Failure, terminal};
use serde_json::{Map, Value, json};
use std::io::{self, Write};

/// What a command found, as tables.
pub(crate) struct Tables {
    command: &'static str,
    tables: Map<String, Value>,
}

impl Tables {
    /// Of a command, as yet none.
    pub(crate) fn of(command: &'static str) -> Self {
        Self { command, tables: Map::new() }
    }

    /// With one more table.
    pub(crate) fn with(mut self, name: &str, rows: impl IntoIterator<Item = Value>) -> Self {
        self.tables.insert(name.to_owned(), rows.into_iter().collect());
        self
    }

    /// Writes them as one object.
    pub(crate) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let version = env!("CARGO_PKG_VERSION");
        let whole = json!({ "stepscope": version, "command": self.command, "tables": self.tables });
        writeln!(out, "{}", terminal::json(&format!("{whole:#}")))
    }

    /// Writes them to standard output.
    pub(crate) fn print(&self) -> Result<(), Failure> {
        let mut out = io::BufWriter::new(io::stdout().lock());
        self.write(&mut out).and_then(|()| out.flush()).map_err(Failure::output)
    }
}
