//! The arguments of `stepscope measures`.

use crate::options::{Json, Out};
use crate::quantity::whole;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario: a JSON file or a preset's name; `-` reads standard input
    ///
    /// If its source is not a motion, there is no ideal curve: the steps themselves are measured.
    pub(super) scenario: PathBuf,
    /// Axis or channel, from 0 (default: the scenario's analysis.axis)
    #[arg(long, value_name = "K", value_parser = whole::<usize>(0..=u64::MAX))]
    pub(super) axis: Option<usize>,
    /// Output format
    #[arg(long, value_enum, default_value = "text", conflicts_with = "json")]
    pub(super) format: Written,
    #[command(flatten)]
    pub(super) json: Json,
    #[command(flatten)]
    pub(super) out: Out,
}

#[derive(Clone, Copy, ValueEnum)]
pub(super) enum Written {
    /// Text
    Text,
    /// One JSON object
    Json,
    /// One figure per row
    Csv,
}
