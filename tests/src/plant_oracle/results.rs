//! F8: results from a series of samples (cycle, value), and from the end of a move.

use super::run::Run;

/// One step of a motor at standstill, measured by a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepSeen {
    /// Mean of the previous ten T_step.
    pub i_q: f64,
    /// Minimum of i - i_q in the T_step after it.
    pub least: f64,
    /// Maximum of i - i_q there.
    pub greatest: f64,
    /// delta t_p by the patent, in cycles from the rise.
    pub reached: Option<u64>,
    /// delta t_p until settled, in cycles from the rise.
    pub settled: Option<u64>,
}

/// Both delta t_p of the step that rises in `rise`, from samples (cycle, value); `None` without samples on both sides.
///
/// Reading: the samples are those in (rise - 10*T_step, rise] and (rise, rise + T_step], as F7 has them; a sample in
/// the cycle of the rise is before it. Of equal maxima the first is t_max. `settled` is `None` if the last sample
/// in the window is outside of the tolerance, or if there is none.
pub fn step_seen(series: &[(u64, f64)], rise: u64, t_step: u64, share: f64) -> Option<StepSeen> {
    let from = rise.saturating_sub(10 * t_step);
    let before: Vec<f64> =
        series.iter().filter(|&&(at, _)| at > from && at <= rise).map(|&(_, value)| value).collect();
    let after: Vec<(u64, f64)> =
        series.iter().filter(|&&(at, _)| at > rise && at <= rise + t_step).copied().collect();
    if before.is_empty() || after.is_empty() {
        return None;
    }
    let mut sum = 0.0;
    for value in &before {
        sum += value;
    }
    let i_q = sum / before.len() as f64;

    let (mut peak, mut least, mut greatest) = (0.0f64, f64::INFINITY, f64::NEG_INFINITY);
    let mut t_max = rise;
    for &(at, value) in &after {
        let away = value - i_q;
        peak = peak.max(away.abs());
        least = least.min(away);
        if away > greatest {
            greatest = away;
            t_max = at;
        }
    }
    // Clarified: with P = 0 there is no settling time.
    let reached = after.iter().find(|&&(at, value)| peak > 0.0 && at >= t_max && value - i_q <= share * peak);
    let settled = match after.iter().rposition(|&(_, value)| (value - i_q).abs() > share * peak) {
        Some(last) if last + 1 < after.len() => Some(after[last].0 - rise),
        _ => None,
    };
    Some(StepSeen { i_q, least, greatest, reached: reached.map(|&(at, _)| at - rise), settled })
}

/// Maximum deviations from `i_q` from a cycle on: of either sign, positive, negative (as a number below 0).
pub fn peaks(series: &[(u64, f64)], i_q: f64, from: u64) -> (f64, f64, f64) {
    let mut peaks = (0.0f64, 0.0f64, 0.0f64);
    for &(_, value) in series.iter().filter(|&&(at, _)| at >= from) {
        let away = value - i_q;
        peaks = (peaks.0.max(away.abs()), peaks.1.max(away), peaks.2.min(away));
    }
    peaks
}

/// The end of a move, at grid points after its last STEP.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoveEnd {
    /// Maximum of x - final command in the move's direction, full steps.
    pub overshoot: f64,
    /// Last cycle with |x - final x| > 0.05, from the last STEP's rise; 0 without one.
    pub settling_cycles: u64,
    /// u/microsteps - x at the last point.
    pub rest_error: f64,
}

/// Overshoot and settling of the motor at `index` of the run's lists, whose last STEP rises in `last_rise`.
///
/// Reading: "after the last STEP" begins with the first point after its rise, and "the move's direction" is `right`.
pub fn move_end(run: &Run, index: usize, microsteps: u32, last_rise: u64, right: bool) -> Option<MoveEnd> {
    let last = run.points.last()?.motors[index];
    let command = last.u as f64 / f64::from(microsteps);
    let mut end = MoveEnd { overshoot: f64::NEG_INFINITY, settling_cycles: 0, rest_error: command - last.x };
    for point in run.points.iter().filter(|point| point.cycle > last_rise) {
        let x = point.motors[index].x;
        let past = if right { x - command } else { command - x };
        end.overshoot = end.overshoot.max(past);
        if (x - last.x).abs() > 0.05 {
            end.settling_cycles = point.cycle - last_rise;
        }
    }
    Some(end)
}
