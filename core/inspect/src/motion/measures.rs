//! Measures of a run: ideal curve, scheduled steps and pulses, each compared with the one before (DESIGN B1).
//!
//! ```text
//! ideal   s(t)
//!   | step quantization: whole steps at whole cycles       `steps`   ideal against steps
//! steps   cycle = floor(t*clock_hz + 1/2)
//!   | tick quantization, the queue and the link            `ticks`   steps against pulses
//! pulses  rising STEP edges of the run                     `pulses`  ideal against pulses
//! ```
//!
//! Times start with the first tick or the segment list; a comparison ends when all motion has ended. Areas and means are
//! integrals of the curves.
//!
//! ```
//! use stepscope_inspect::motion::{actual_motion::Pulses, measures::Measures};
//! use stepscope_inspect::trace::stored_run::record_run;
//! use stepscope_peripheral::trace::steps;
//! use stepscope_sim::Experiment;
//!
//! let experiment = Experiment::from_json("{}").expect("it is valid");
//! let (_, runs) = record_run(&experiment, 1).expect("it is short");
//! let actual = steps(&runs[0].trace, 0);
//! let pulses = Pulses::of_run(0, &actual, &runs[0].packets, None, experiment.config());
//! let measures = Measures::of(&experiment.plans()[0], &pulses, None);
//! assert_eq!(measures.peaks.speed_steps_s, 16_000.0);
//! ```

mod curve_metrics;
mod pulse_errors;

pub use curve_metrics::{CurveMetrics, POINTS};
pub use pulse_errors::PulseErrors;

use crate::motion::actual_motion::Pulses;
use crate::motion::sine_polyline::{cosines, differences};
use alloc::vec::Vec;
use curve_metrics::{Sums, curve_and_steps, steps_and_steps};
use pulse_errors::{by_position, due_steps};
use serde::Serialize;
use stepscope_motion::{AxisPlan, Breakpoints, Profile, ValueError, curves::SineSegments, moves::Axis};
use stepscope_peripheral::trace::Step;

/// Maximum steps of a measured run; each takes about 82 bytes.
pub const MAX_STEPS: u64 = 20_000_000;

/// Whether plans have at most [`MAX_STEPS`] steps together.
pub fn within_bounds<'p>(plans: impl IntoIterator<Item = &'p AxisPlan>) -> Result<(), ValueError> {
    let steps = plans.into_iter().fold(0, |sum: u64, plan| sum.saturating_add(plan.step_count()));
    if steps > MAX_STEPS {
        return Err(ValueError::TooMuch {
            given: steps as f64,
            max: MAX_STEPS as f64,
            of: "steps to be measured",
        });
    }
    Ok(())
}

/// Tracking errors, counts, peaks and durations of an axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measures {
    pub length_s: f64,
    pub steps: CurveMetrics,
    pub ticks: CurveMetrics,
    pub pulses: CurveMetrics,
    /// Scheduled steps compared with ideal times.
    pub step_errors: PulseErrors,
    /// Pulses compared with scheduled steps.
    pub tick_errors: PulseErrors,
    pub counts: Counts,
    pub peaks: Extremes,
    pub duration: Duration,
    /// The first sine by segments: its polyline compared with the exact sine.
    pub sine: Option<SineMeasures>,
}

/// Numbers of planned and actual steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Counts {
    pub due: u64,
    /// Pulses; opposite steps within one tick cancel.
    pub actual: u64,
    /// Pulses without a step of that position and direction near that time.
    pub stray: u64,
}

/// Peaks of the ideal motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extremes {
    pub speed_steps_s: f64,
    pub acceleration_steps_s2: f64,
    pub jerk_steps_s3: f64,
    pub speed_jump_steps_s: f64,
    pub acceleration_jump_steps_s2: f64,
    /// Maximum jump of speed from or to standstill. A reversal is a stop and a start.
    pub start_stop_steps_s: f64,
}

/// Planned, requested and actual durations, in s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Duration {
    pub planned_s: f64,
    /// `None` if no move has a requested time; other moves count as planned.
    pub requested_s: Option<f64>,
    pub plan_error_s: Option<f64>,
    pub last_due_s: Option<f64>,
    pub last_pulse_s: Option<f64>,
    pub end_error_s: Option<f64>,
}

/// A polyline compared with the exact sine, at 512 points of a quarter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SineMeasures {
    pub segments: usize,
    /// Ev: Euclidean distance in parts of the amplitude.
    pub euclidean: f64,
    pub quarter: CurveMetrics,
}

impl Measures {
    /// Measures an axis. `requested` are the requested moves, if known. Check [`within_bounds`] first.
    pub fn of(plan: &AxisPlan, pulses: &Pulses<'_>, requested: Option<&Axis>) -> Self {
        let (zero, hz) = (pulses.zero(), pulses.hz());
        let shifted = |step: &Step| Step { cycle: step.cycle.saturating_sub(zero), ..*step };
        let actual: Vec<Step> = pulses.steps.iter().map(shifted).collect();
        let (due, step_errors) = due_steps(plan, pulses.clock_hz());
        let (tick_errors, stray) = by_position(plan, &due, &actual, hz);
        let last = |steps: &[Step]| steps.last().map(|step| step.cycle as f64 / hz);
        let (last_due_s, last_pulse_s) = (last(&due), last(&actual));
        // At least one cycle, so that the comparison is not empty.
        let ends = [Some(plan.duration_s()), last_due_s, last_pulse_s];
        let length_s = ends.into_iter().flatten().fold(1.0 / hz, libm::fmax);
        let breakpoints = Breakpoints::of(plan);
        let requested_s = requested.and_then(|axis| requested_s(axis, plan));
        Self {
            length_s,
            steps: curve_and_steps(plan, &breakpoints, &due, hz, length_s),
            ticks: steps_and_steps(&due, &actual, hz, length_s),
            pulses: curve_and_steps(plan, &breakpoints, &actual, hz, length_s),
            step_errors,
            tick_errors,
            counts: Counts { due: due.len() as u64, actual: actual.len() as u64, stray },
            peaks: extremes(plan, &breakpoints),
            duration: Duration {
                planned_s: plan.duration_s(),
                requested_s,
                plan_error_s: requested_s.map(|requested_s| plan.duration_s() - requested_s),
                last_due_s,
                last_pulse_s,
                end_error_s: last_pulse_s.zip(last_due_s).map(|(pulse, due)| pulse - due),
            },
            sine: plan.moves().iter().find_map(|planned| match &planned.profile {
                Profile::SineSegments(sine) => Some(polyline(sine)),
                _ => None,
            }),
        }
    }
}

/// The ideal curve of a plan compared with its pulses, as [`Measures::pulses`]. Check [`within_bounds`] first.
pub fn ideal_to_actual(plan: &AxisPlan, pulses: &Pulses<'_>) -> CurveMetrics {
    let (zero, hz) = (pulses.zero(), pulses.hz());
    let shifted = |step: &Step| Step { cycle: step.cycle.saturating_sub(zero), ..*step };
    let actual: Vec<Step> = pulses.steps.iter().map(shifted).collect();
    let last_s = actual.last().map_or(0.0, |step| step.cycle as f64 / hz);
    let length_s = libm::fmax(1.0 / hz, libm::fmax(plan.duration_s(), last_s));
    curve_and_steps(plan, &Breakpoints::of(plan), &actual, hz, length_s)
}

fn requested_s(axis: &Axis, plan: &AxisPlan) -> Option<f64> {
    // Groups and input shapers add to the moves or replace them.
    if axis.moves.len() != plan.moves().len() {
        return None;
    }
    let has_time = axis.moves.iter().any(|requested| requested.requested_s().is_some());
    let times = axis.moves.iter().zip(plan.moves());
    // In the order of the plan, so that the sum of equal times is equal.
    let sum = times.fold(0.0, |sum, (requested, planned)| {
        sum + requested.requested_s().unwrap_or_else(|| planned.profile.duration_s())
    });
    has_time.then_some(sum)
}

fn extremes(plan: &AxisPlan, breakpoints: &Breakpoints) -> Extremes {
    let peaks = plan.peaks();
    let (mut before, mut start_stop) = (0.0, 0.0);
    let mut note_change = |before: f64, after: f64| {
        if before * after <= 0.0 {
            start_stop = libm::fmax(start_stop, libm::fmax(libm::fabs(before), libm::fabs(after)));
        }
    };
    breakpoints.intervals(0.0, plan.duration_s(), &mut |interval| {
        // Just inside: at a breakpoint the speed is that of one side only.
        let inset = (interval.to_s - interval.from_s) * 1e-9;
        let speed = |t: f64, by: f64| plan.speed(t) + plan.acceleration(t) * by;
        note_change(before, speed(interval.from_s + inset, -inset));
        before = speed(interval.to_s - inset, inset);
    });
    note_change(before, 0.0);
    Extremes {
        speed_steps_s: peaks.speed,
        acceleration_steps_s2: peaks.acceleration,
        jerk_steps_s3: peaks.jerk,
        speed_jump_steps_s: peaks.jump,
        acceleration_jump_steps_s2: peaks.acceleration_jump,
        // For a curve that starts at speed 0 this is only rounding.
        start_stop_steps_s: if start_stop > 1e-9 * peaks.speed { start_stop } else { 0.0 },
    }
}

fn polyline(sine: &SineSegments) -> SineMeasures {
    let segments = sine.segments();
    let amplitude = segments.iter().map(|segment| segment.steps).sum::<u64>() as f64;
    let points: Vec<u16> = segments
        .iter()
        .map(|segment| segment.from)
        .chain(segments.last().map(|segment| segment.to))
        .collect();
    let mut sums = Sums::default();
    for (point, (cosine, off)) in differences(&points, &cosines()).enumerate() {
        let (cosine, off) = (cosine * amplitude, off * amplitude);
        let at_s = point as f64 * sine.point_s();
        sums.extreme(at_s, off);
        sums.sample(off);
        // Line and cosine meet at both ends, so a sum over the points is the trapezoid rule.
        sums.interval(&[(cosine, off, sine.point_s())]);
    }
    let quarter = sums.ended();
    SineMeasures { segments: segments.len(), euclidean: quarter.euclidean_steps / amplitude, quarter }
}

#[cfg(test)]
mod tests;
