//! `stepscope run --line`: writes a run's line as a scenario.

use crate::{failure::Failure, output::Out, scenario_file};
use std::{io::Write, path::Path};
use stepscope_core::scenario::Scenario;
use stepscope_core::sim::{Experiment, Run, scripted};

/// The scenario gives the same traces without host, noise and motion.
pub(crate) fn write(
    (path, mut out): (&Path, Out),
    scenario: Scenario,
    experiment: &Experiment,
    run: &Run,
) -> Result<(), Failure> {
    let scripted = scripted(scenario, experiment, run);
    // A long noisy run may have more forced levels than a scenario allows.
    let text =
        scenario_file::text(path, &scripted, "end the run earlier with run_cycles, or use a shorter motion")?;
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    written.map_err(|error| Failure::File(path.to_owned(), error))
}
