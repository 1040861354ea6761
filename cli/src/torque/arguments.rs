//! The arguments of `stepscope torque`.

use crate::{motors::Named, quantity::whole};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario: a JSON file, or a preset's name; `-` reads standard input. Of a source without a motion (segments,
    /// packets, a line script) the steps of its run are judged, for the motors of its plant.
    pub(super) scenario: PathBuf,
    /// Axis, or channel, from 0 (default: all; for a curve, 0)
    #[arg(long, value_name = "K", value_parser = whole::<usize>(0..=u64::MAX))]
    pub(super) axis: Option<usize>,
    /// Output format: the demand on each motor, or the curve of one motor as CSV
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: Written,
    /// Output file (`-`: standard output)
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub(super) out: PathBuf,
    /// Run the plant, too, even if it takes long, and compare both models
    #[arg(long, conflicts_with = "format")]
    pub(super) plant: bool,
    #[command(flatten)]
    pub(super) named: Named,
    /// Print the result as JSON: one object of tables (docs/command.md)
    #[arg(long, conflicts_with = "format")]
    pub(super) json: bool,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(super) enum Written {
    /// Words and numbers.
    Text,
    /// The torque-speed curve: available torque at each rate.
    Csv,
}
