//! Recordings of whole runs, with one limit for all commands.

use crate::failure::Failure;
use std::path::Path;
use stepscope_core::inspect::trace::stored_run::Recording;
use stepscope_core::{inspect::trace::stored_run::record_run, sim::Experiment};

/// The recording of the scenario's first controller.
///
/// # Errors
/// [`Failure::LongAnalysis`].
pub(crate) fn of(path: &Path, experiment: &Experiment) -> Result<Recording, Failure> {
    let (_, recordings) =
        record_run(experiment, 1).map_err(|why| Failure::LongAnalysis(path.to_owned(), why))?;
    Ok(recordings.into_iter().next().unwrap_or_default())
}
