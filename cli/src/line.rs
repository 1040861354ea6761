//! `stepscope run --line`: what was done to the line in a run, as a scenario of its own.

use crate::{failure::Failure, output::Out, scenario_file};
use std::{io::Write, path::Path};
use stepscope_core::{
    scenario::Scenario,
    sim::{Experiment, Run, scripted},
};

/// Writes the scenario that gives the same traces without host, noise and motion.
pub(crate) fn write(
    (path, mut out): (&Path, Out),
    scenario: Scenario,
    experiment: &Experiment,
    run: &Run,
) -> Result<(), Failure> {
    let scripted = scripted(scenario, experiment, run);
    // A long noisy run may have more forced levels than a scenario may.
    let text =
        scenario_file::text(path, &scripted, "end the run sooner with run_cycles, or give a shorter motion")?;
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.map_err(|error| Failure::File(path.to_owned(), error))
}
