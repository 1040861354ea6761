//! Positions of moves that are given by the times of their steps (DESIGN B2, B3): k - 1/2 at step k and linear between, so
//! that rounding counts the steps. Rounding counts a step to the right at its exact time, and one to the left only after it
//! (B7).

/// Distance in steps from k - 1/2 right before and after step k, so that rounding errors never change the count.
pub(crate) const PAST_THE_STEP: f64 = 1.0 / 1_048_576.0;

/// Position at `t` in steps without sign, after `due` of `count` steps; step k (from 1) is at `step_s(k)`, and `step_s(0)` is
/// the start.
pub(crate) fn position(t: f64, due: u64, count: u64, step_s: impl Fn(u64) -> f64) -> f64 {
    if due >= count || t <= 0.0 {
        return due as f64;
    }
    let (from, to) = (step_s(due), step_s(due + 1));
    let part = (t - from) / (to - from);
    if due > 0 && t == from {
        // The exact half, which rounding counts to the right but not to the left.
        due as f64 - 0.5
    } else if due == 0 {
        // Half a step in the first interval, but less until the step.
        part * (0.5 - PAST_THE_STEP)
    } else {
        due as f64 - 0.5 + PAST_THE_STEP + part * (1.0 - 2.0 * PAST_THE_STEP)
    }
}

/// Whether a step counts at its exact time.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum ExactTime {
    Included,
    Excluded,
}

impl ExactTime {
    /// For a move to the right or left (B7).
    pub(crate) const fn of(steps: i64) -> Self {
        if steps < 0 { Self::Excluded } else { Self::Included }
    }
}

/// Number of steps of `count` that are due by `t`. The guess may be wrong by a rounding and by a step at `t`.
pub(crate) fn steps_due(
    t: f64,
    guess: u64,
    count: u64,
    exact_time: ExactTime,
    step_s: impl Fn(u64) -> f64,
) -> u64 {
    let is_due = |k| match exact_time {
        ExactTime::Included => step_s(k) <= t,
        ExactTime::Excluded => step_s(k) < t,
    };
    let guess = if guess > count { count } else { guess };
    let mut due = guess;
    while due > 0 && !is_due(due) {
        due -= 1;
    }
    while due < count && is_due(due + 1) {
        due += 1;
    }
    debug_assert!(due.abs_diff(guess) <= 2, "{due} steps are due by {t} s, but the guess is {guess}");
    due
}
