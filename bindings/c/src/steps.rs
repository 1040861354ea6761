//! Step times of a plan, and the first difference of two lists of steps.

use crate::error::{ErrorHandle, guarded};
use crate::handle;
use crate::pointer::{self, Buffer};
use crate::scenario::{ScenarioHandle, StoredScenario};
use crate::status::{Failure, PROBLEMS, RANGE, Status, checked};
use stepscope_core::prelude::{Cycles, Problems, ScheduledStep, first_difference};
use stepscope_core::sim::{MAX_RECORDS, axis_plan};

/// A step: the cycle in which STEP rises, and its direction.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Step {
    /// Cycles since reset (of a run), or from the start of the motion (of a plan).
    pub cycle: u64,
    /// +1 right, -1 left.
    pub direction: i32,
    /// 0.
    pub reserved: u32,
}

impl Step {
    pub(crate) const fn new(cycle: u64, is_right: bool) -> Self {
        Self { cycle, direction: if is_right { 1 } else { -1 }, reserved: 0 }
    }
}

/// A refusal of a controller or an axis is a status of its own.
fn refused(problems: &Problems) -> Failure {
    let failure = Failure::of(problems);
    let is_number = |(path, _): &(String, String)| path == "controller" || path == "axis";
    Failure { status: if failure.lines.iter().all(is_number) { RANGE } else { PROBLEMS }, ..failure }
}

/// The steps of an axis as planned, in cycles of the scenario's clock from the start of the motion. Writes at most `capacity`
/// of them to `out`, and their number, up to 24000000, to `*count`. `out` NULL with capacity 0 returns only the count.
/// `controller` and `axis` count from 0.
///
/// Returns STEPSCOPE_PROBLEMS (the scenario is refused, or is no motion), _RANGE (no such controller or axis),
/// _BUFFER (there are more than `capacity`), _NULL, _HANDLE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_step_times(
    scenario: *const ScenarioHandle,
    controller: u32,
    axis: u32,
    out: *mut Step,
    capacity: usize,
    count: *mut usize,
    error: *mut *mut ErrorHandle,
) -> Status {
    // SAFETY: the header asks for pointers that are NULL or valid, `out` for `capacity` steps.
    unsafe {
        guarded(error, || {
            let buffer = Buffer::new(out, capacity, count)?;
            let scenario = handle::get::<StoredScenario>(scenario)?;
            let experiment = scenario.0.experiment().map_err(Failure::of)?;
            let plan = axis_plan(experiment, controller as usize, axis as usize);
            let plan = plan.map_err(|problems| refused(&problems))?;
            if plan.step_count() > MAX_RECORDS / 2 {
                let message = "the axis has more than 24000000 planned steps; use a shorter motion";
                return Err(Failure::new(PROBLEMS, "source", message));
            }
            let steps = plan.due_steps(experiment.config().clock_hz());
            buffer.fill(steps.map(|step| Step::new(step.cycle, step.right)))
        })
    }
}

/// The first index at which two lists of steps differ: cycles more than `within_cycles` apart, another direction, or the end
/// of one list. Writes STEPSCOPE_NONE if they agree; a difference of exactly `within_cycles` is none. A direction above 0 is
/// right. A list without steps may be NULL.
///
/// Returns STEPSCOPE_NULL, _RANGE (a list is longer than memory).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_first_difference(
    expected: *const Step,
    expected_count: usize,
    found: *const Step,
    found_count: usize,
    within_cycles: u64,
    index: *mut usize,
) -> Status {
    let scheduled = |steps: &[Step]| -> Vec<ScheduledStep> {
        let step = |step: &Step| ScheduledStep { cycle: step.cycle, right: step.direction > 0 };
        steps.iter().map(step).collect()
    };
    checked(|| {
        // SAFETY: the header asks for pointers that are NULL or valid, the lists for as many steps.
        unsafe {
            pointer::put("index", index, usize::MAX)?;
            let expected = scheduled(pointer::items("expected", expected, expected_count)?);
            let found = scheduled(pointer::items("found", found, found_count)?);
            let first = first_difference(&expected, &found, Cycles(within_cycles));
            pointer::put("index", index, first.unwrap_or(usize::MAX))
        }
    })
}
