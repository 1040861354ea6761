//! The arguments of `stepscope torque`.

use crate::options::{Json, Out};
use crate::{motors::NamedMotor, quantity::whole};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Args)]
pub(crate) struct Arguments {
    /// Scenario: a JSON file or a preset's name; `-` reads standard input
    ///
    /// If its source is not a motion, the steps of its run are checked, with the motors of its plant.
    pub(super) scenario: PathBuf,
    /// Axis or channel, from 0 (default: all; for a curve, 0)
    #[arg(long, value_name = "K", value_parser = whole::<usize>(0..=u64::MAX))]
    pub(super) axis: Option<usize>,
    /// Output format
    #[arg(long, value_enum, default_value = "text", conflicts_with_all = ["plant", "json"])]
    pub(super) format: Written,
    /// Also simulate the motors, even if it takes long, and compare both models
    #[arg(long)]
    pub(super) plant: bool,
    #[command(flatten)]
    pub(super) named: NamedMotor,
    #[command(flatten)]
    pub(super) json: Json,
    #[command(flatten)]
    pub(super) out: Out,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
pub(super) enum Written {
    /// Demand on each motor
    Text,
    /// Torque-speed curve of one motor
    Csv,
}
