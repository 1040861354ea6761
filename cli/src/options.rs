//! Options that several commands have.

use crate::quantity::whole;
use clap::Args;
use std::{num::NonZero, path::PathBuf};

#[derive(Args)]
pub(crate) struct Json {
    /// Print the results as JSON tables (format: docs/command.md)
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Args)]
pub(crate) struct Out {
    /// Output file; `-` is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    pub(crate) out: PathBuf,
}

#[derive(Args)]
pub(crate) struct ShowProgress {
    /// Show progress even if standard error is not a terminal
    #[arg(long)]
    pub(crate) progress: bool,
}

/// Options of work that uses all cores.
#[derive(Args)]
pub(crate) struct Work {
    /// Number of threads (default: one per core); does not affect the result
    #[arg(long, value_name = "N", value_parser = whole::<NonZero<usize>>(1..=u64::MAX))]
    pub(crate) threads: Option<NonZero<usize>>,
    #[command(flatten)]
    pub(crate) show: ShowProgress,
}
