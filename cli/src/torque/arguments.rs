//! What `stepscope torque` is asked for.

use crate::motors::Named;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// What `stepscope torque` takes.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The scenario: a JSON file, or a preset's name; `-` reads standard input. Of a source without a motion (segments,
    /// packets, a line script) the steps of its run are judged, for the motors of its plant.
    pub(super) scenario: PathBuf,
    /// Only this axis, or channel, from 0; the curve is of the first without it.
    #[arg(long, value_name = "K")]
    pub(super) axis: Option<usize>,
    /// What is written: what each axis asks of its motor, or the curve of one motor as CSV.
    #[arg(long, value_enum, default_value = "text")]
    pub(super) format: Written,
    /// Where it goes (`-`: standard output).
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub(super) out: PathBuf,
    /// Run the plant, too, also where the scenario has none or the run is long, and say whether both models agree.
    #[arg(long, conflicts_with = "format")]
    pub(super) plant: bool,
    #[command(flatten)]
    pub(super) named: Named,
    /// Write it as JSON: one object of tables (docs/command.md).
    #[arg(long, conflicts_with = "format")]
    pub(super) json: bool,
}

/// What is written.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(super) enum Written {
    /// Words and numbers.
    Text,
    /// The torque-speed curve: available torque at each rate.
    Csv,
}
