//! Runs in slices; the worker reads messages between them.

use crate::convert::object;
use serde::Serialize;
use stepscope_core::inspect::plant::log::PlantLog;
use stepscope_core::peripheral::{signal::Sink, units::Instant};
use stepscope_core::sim::{Experiment, Run, RunLimits};
use wasm_bindgen::prelude::*;

/// Maximum records of all controllers, of 16 bytes each.
const MAX_RECORDS: u64 = 40_000_000;

#[derive(Serialize)]
struct Progress {
    done: bool,
    cycle: u64,
    end_cycle: u64,
    records: u64,
}

/// Runs for about `max_records` more records of a controller, or grid steps of its plant. Returns true at the end.
pub(crate) fn advance<S: Sink>(
    experiment: &Experiment,
    run: &mut Run,
    max_records: u32,
    sinks: &mut [S],
    logs: &mut [Option<&mut PlantLog>],
) -> bool {
    let records = u64::from(max_records.max(1));
    match experiment.plants() {
        None => run.advance_each(records, sinks),
        Some(plants) => {
            let step = plants.setups.iter().map(|setup| u64::from(setup.grid_cycles())).min().unwrap_or(1);
            let cycle = Instant(run.cycles().0.saturating_add(records * step));
            run.advance_observed(RunLimits { cycle, records }, sinks, logs)
        }
    }
}

/// Progress, with the records of all controllers. Errors: for more than [`MAX_RECORDS`].
pub(crate) fn progress(
    experiment: &Experiment,
    run: &Run,
    done: bool,
    records: u64,
) -> Result<JsValue, JsError> {
    if records > MAX_RECORDS {
        return Err(JsError::new(&format!(
            "the run has more than {MAX_RECORDS} edges, the maximum of the page; shorten the motion, or use the stepscope command"
        )));
    }
    let cycle = run.cycles().0;
    let end_cycle = if done { cycle } else { experiment.cost().end_cycle.max(cycle) };
    object(&Progress { done, cycle, end_cycle, records })
}
