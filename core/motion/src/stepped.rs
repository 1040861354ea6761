//! Moves that are given by the times of their steps: acceleration tables (DESIGN B2, B3).
//!
//! ```text
//! position   k - 1/2 at step k, straight between; B1's R of it counts the steps.
//!            0 at the start, n at the end, so the first interval climbs half a step
//!            and the last half step comes with the last pulse.
//! ```

/// How far past a step's place the curve stands at the very time of the step, in steps. With it
/// R counts the step at its own time to the left as well as to the right.
const PAST_THE_STEP: f64 = 1.0 / 1_048_576.0;

/// Position at `t` in steps, without sign, of a move of `count` steps, of which `fallen` have
/// fallen by then; step k (from 1) falls at `step_s(k)`, and `step_s(0)` is the start.
pub(super) fn position(t: f64, fallen: u64, count: u64, step_s: impl Fn(u64) -> f64) -> f64 {
    if fallen >= count || t <= 0.0 {
        return fallen as f64;
    }
    let (from, to) = (step_s(fallen), step_s(fallen + 1));
    let part = (t - from) / (to - from);
    if fallen == 0 {
        // Half a step in the first interval, and short of it until the step falls.
        part * (0.5 - PAST_THE_STEP)
    } else {
        fallen as f64 - 0.5 + PAST_THE_STEP + part * (1.0 - 2.0 * PAST_THE_STEP)
    }
}

/// Steps of `count` that have fallen by `t`, from a guess that can be off by a rounding: the times
/// themselves decide.
pub(super) fn fallen(t: f64, guess: u64, count: u64, step_s: impl Fn(u64) -> f64) -> u64 {
    let mut fallen = if guess > count { count } else { guess };
    while fallen > 0 && step_s(fallen) > t {
        fallen -= 1;
    }
    while fallen < count && step_s(fallen + 1) <= t {
        fallen += 1;
    }
    fallen
}
