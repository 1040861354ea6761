//! Recordings of whole runs, with one limit for all commands.

use crate::failure::Failure;
use std::path::Path;
use stepscope_core::inspect::trace::stored_run::{StoredRun, record_run};
use stepscope_core::sim::Experiment;

/// The recording of the scenario's first controller. Errors: [`Failure::Invalid`] if the run is too long to be stored.
pub(crate) fn of(path: &Path, experiment: &Experiment) -> Result<StoredRun, Failure> {
    let (_, recordings) =
        record_run(experiment, 1).map_err(|error| Failure::invalid(path, error.to_string()))?;
    Ok(recordings.into_iter().next().unwrap_or_default())
}
