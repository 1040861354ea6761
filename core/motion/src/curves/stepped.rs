//! Positions of moves that are given by the times of their steps (DESIGN B2, B3): k - 1/2 at step k and linear between, so
//! that rounding counts the steps. At the very time of a step to the right rounding counts it, of one to the left not yet
//! (B7).

/// Distance in steps from k - 1/2 right before and after step k, so that rounding errors never change the count.
pub(crate) const PAST_THE_STEP: f64 = 1.0 / 1_048_576.0;

/// Position at `t` in steps without sign, after `fallen` of `count` steps; step k (from 1) is at `step_s(k)`, and
/// `step_s(0)` is the start.
pub(crate) fn position(t: f64, fallen: u64, count: u64, step_s: impl Fn(u64) -> f64) -> f64 {
    if fallen >= count || t <= 0.0 {
        return fallen as f64;
    }
    let (from, to) = (step_s(fallen), step_s(fallen + 1));
    let part = (t - from) / (to - from);
    if fallen > 0 && t == from {
        // Exactly the half: rounding counts it to the right, and not to the left.
        fallen as f64 - 0.5
    } else if fallen == 0 {
        // Half a step in the first interval, but less until the step.
        part * (0.5 - PAST_THE_STEP)
    } else {
        fallen as f64 - 0.5 + PAST_THE_STEP + part * (1.0 - 2.0 * PAST_THE_STEP)
    }
}

/// Whether a step counts at its very time.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Counts {
    Then,
    After,
}

impl Counts {
    /// For a move to the right or left (B7).
    pub(crate) const fn of(steps: i64) -> Self {
        if steps < 0 { Self::After } else { Self::Then }
    }
}

/// Number of steps of `count` by `t`. The guess may be wrong by a rounding and by a step at `t`; the times decide.
pub(crate) fn fallen(t: f64, guess: u64, count: u64, counts: Counts, step_s: impl Fn(u64) -> f64) -> u64 {
    let has_fallen = |k| match counts {
        Counts::Then => step_s(k) <= t,
        Counts::After => step_s(k) < t,
    };
    let guess = if guess > count { count } else { guess };
    let mut fallen = guess;
    while fallen > 0 && !has_fallen(fallen) {
        fallen -= 1;
    }
    while fallen < count && has_fallen(fallen + 1) {
        fallen += 1;
    }
    debug_assert!(
        fallen.abs_diff(guess) <= 2,
        "{fallen} steps have fallen by {t} s, and {guess} are guessed"
    );
    fallen
}
