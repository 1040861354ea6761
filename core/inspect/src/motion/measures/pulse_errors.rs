//! Errors of pulses in time and position.
//!
//! A pulse is compared with the step of the same position and direction that is nearest in time, so canceled or lost steps
//! do not shift the others.

use alloc::vec::Vec;
use serde::Serialize;
use stepscope_motion::AxisPlan;
use stepscope_peripheral::trace::Step;

/// Time errors in s, positive if late; position errors in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PulseErrors {
    pub pulses: u64,
    pub largest_s: f64,
    pub largest_at_s: f64,
    pub mean_s: f64,
    pub rms_s: f64,
    /// Travel of the ideal motion within the time error.
    pub largest_steps: f64,
    pub rms_steps: f64,
}

#[derive(Default)]
struct Errors {
    found: PulseErrors,
    time: f64,
    time_square: f64,
    position_square: f64,
}

impl Errors {
    fn add(&mut self, at_s: f64, late_s: f64, steps: f64) {
        self.found.pulses += 1;
        self.time += late_s;
        self.time_square += late_s * late_s;
        self.position_square += steps * steps;
        if libm::fabs(late_s) > libm::fabs(self.found.largest_s) {
            (self.found.largest_s, self.found.largest_at_s) = (late_s, at_s);
        }
        if libm::fabs(steps) > libm::fabs(self.found.largest_steps) {
            self.found.largest_steps = steps;
        }
    }

    fn ended(self) -> PulseErrors {
        let count = self.found.pulses.max(1) as f64;
        PulseErrors {
            mean_s: self.time / count,
            rms_s: libm::sqrt(self.time_square / count),
            rms_steps: libm::sqrt(self.position_square / count),
            ..self.found
        }
    }
}

pub(super) fn due_steps(plan: &AxisPlan, clock_hz: u32) -> (Vec<Step>, PulseErrors) {
    let hz = f64::from(clock_hz);
    let (mut errors, mut position) = (Errors::default(), 0);
    let steps = plan
        .due_instants(clock_hz)
        .map(|(ideal, due)| {
            let direction = if due.right { 1 } else { -1 };
            position += direction;
            let at_s = due.cycle as f64 / hz;
            errors.add(at_s, (due.cycle as f64 - ideal) / hz, distance(plan, ideal / hz, at_s, hz));
            Step { cycle: due.cycle, position }
        })
        .collect();
    (steps, errors.ended())
}

pub(super) fn by_position(plan: &AxisPlan, due: &[Step], actual: &[Step], hz: f64) -> (PulseErrors, u64) {
    let runs = runs(due);
    let (mut errors, mut stray) = (Errors::default(), 0);
    for (index, pulse) in actual.iter().enumerate() {
        match nearest(&runs, due, pulse, Step::direction(actual, index)) {
            Some(step) => {
                let (at_s, due_s) = (pulse.cycle as f64 / hz, step.cycle as f64 / hz);
                errors.add(at_s, at_s - due_s, distance(plan, due_s, at_s, hz));
            }
            None => stray += 1,
        }
    }
    (errors.ended(), stray)
}

/// Travel of the ideal motion, a cycle earlier, because a table's curve ends with a jump of half a step.
fn distance(plan: &AxisPlan, from_s: f64, to_s: f64, hz: f64) -> f64 {
    plan.position(to_s - 1.0 / hz) - plan.position(from_s - 1.0 / hz)
}

struct Run {
    first: usize,
    cycle: u64,
    count: usize,
    direction: i32,
}

/// Runs searched on either side of a pulse's time.
const NEAR_RUNS: usize = 3;

fn runs(due: &[Step]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (first, step) in due.iter().enumerate() {
        let direction = Step::direction(due, first);
        match runs.last_mut() {
            Some(run) if run.direction == direction => run.count += 1,
            _ => runs.push(Run { first, cycle: step.cycle, count: 1, direction }),
        }
    }
    runs
}

/// The step of the pulse's position and direction nearest in time; the earlier of equals.
fn nearest<'d>(runs: &[Run], due: &'d [Step], pulse: &Step, direction: i32) -> Option<&'d Step> {
    let after = runs.partition_point(|run| run.cycle <= pulse.cycle);
    let near = runs.iter().skip(after.saturating_sub(NEAR_RUNS)).take(2 * NEAR_RUNS);
    let steps = near.filter(|run| run.direction == direction).filter_map(|run| {
        let first = due.get(run.first)?;
        let past = i64::from(pulse.position) - i64::from(first.position);
        let index = usize::try_from(past * i64::from(direction)).ok()?;
        if index < run.count { due.get(run.first + index) } else { None }
    });
    steps.min_by_key(|step| step.cycle.abs_diff(pulse.cycle))
}
