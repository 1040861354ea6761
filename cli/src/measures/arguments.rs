//! What `stepscope measures` takes on its command line.

use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// What `stepscope measures` takes.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario: a JSON file, or a preset's name; `-` reads standard input. Where its source is no motion there is no
    /// ideal curve, and the steps themselves are measured.
    pub(super) scenario: PathBuf,
    /// The axis, or channel, from 0; that of the scenario's `analysis` without it.
    #[arg(long, value_name = "K")]
    pub(super) axis: Option<usize>,
    /// How it is written: for the eye, as one JSON object, or as a table of one figure a row.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: Written,
    /// Write all figures as JSON: one object of tables, a figure a row (docs/command.md).
    #[arg(long, conflicts_with = "format")]
    pub(super) json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Written {
    Text,
    Json,
    Csv,
}
