//! The JSON of `--json`: one object of tables (docs/command.md).
//!
//! A table is a list of rows with the same columns. A cell is a number, a text, a Boolean or null. Column names
//! contain units.

use crate::{failure::Failure, terminal};
use serde_json::{Map, Value, json};
use std::io::{self, Write};

pub(crate) struct Tables {
    command: &'static str,
    tables: Map<String, Value>,
}

impl Tables {
    pub(crate) fn of(command: &'static str) -> Self {
        Self { command, tables: Map::new() }
    }

    pub(crate) fn with(mut self, name: &str, rows: impl IntoIterator<Item = Value>) -> Self {
        self.tables.insert(name.to_owned(), rows.into_iter().collect());
        self
    }

    pub(crate) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let version = env!("CARGO_PKG_VERSION");
        let document = json!({ "stepscope": version, "command": self.command, "tables": self.tables });
        writeln!(out, "{}", terminal::json(&format!("{document:#}")))
    }

    pub(crate) fn print(&self) -> Result<(), Failure> {
        let mut out = io::BufWriter::new(io::stdout().lock());
        self.write(&mut out).and_then(|()| out.flush()).map_err(Failure::output)
    }
}
