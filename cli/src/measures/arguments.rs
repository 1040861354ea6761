//! The arguments of `stepscope measures`.

use crate::quantity::whole;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario: a JSON file, or a preset's name; `-` reads standard input. Where its source is no motion there is no
    /// ideal curve, and the steps themselves are measured.
    pub(super) scenario: PathBuf,
    /// Axis, or channel, from 0 (default: that of the scenario's `analysis`)
    #[arg(long, value_name = "K", value_parser = whole::<usize>(0..=u64::MAX))]
    pub(super) axis: Option<usize>,
    /// Output format: text, one JSON object, or a table of one figure per row
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: Written,
    /// Print all figures as JSON: one object of tables (docs/command.md)
    #[arg(long, conflicts_with = "format")]
    pub(super) json: bool,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Written {
    Text,
    Json,
    Csv,
}
