//! Positions of moves that are given by the times of their steps (DESIGN B2, B3): k - 1/2 at step k, straight between, so
//! R of it counts the steps. In the instant of a step R counts it if it goes to the right, and not yet if it goes to the
//! left, as where a curve crosses a half-integer (B7).

/// How far from a step's place the curve keeps before and after the step, in steps: so R of it counts as many steps as
/// have fallen, whatever the last digit of the place between two of them.
pub(crate) const PAST_THE_STEP: f64 = 1.0 / 1_048_576.0;

/// Position at `t` in steps, without sign, of a move of `count` steps, of which `fallen` have
/// fallen by then; step k (from 1) falls at `step_s(k)`, and `step_s(0)` is the start.
pub(crate) fn position(t: f64, fallen: u64, count: u64, step_s: impl Fn(u64) -> f64) -> f64 {
    if fallen >= count || t <= 0.0 {
        return fallen as f64;
    }
    let (from, to) = (step_s(fallen), step_s(fallen + 1));
    let part = (t - from) / (to - from);
    if fallen > 0 && t == from {
        // The half itself: R counts it to the right, and not to the left.
        fallen as f64 - 0.5
    } else if fallen == 0 {
        // Half a step in the first interval, and short of it until the step falls.
        part * (0.5 - PAST_THE_STEP)
    } else {
        fallen as f64 - 0.5 + PAST_THE_STEP + part * (1.0 - 2.0 * PAST_THE_STEP)
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Counts {
    /// At once.
    Then,
    /// Only after it.
    After,
}

impl Counts {
    /// The steps of a move that goes to the right or to the left (B7).
    pub(crate) const fn of(steps: i64) -> Self {
        if steps < 0 { Self::After } else { Self::Then }
    }
}

/// Steps of `count` that have fallen by `t`, from a guess that can be off by a rounding, and by a step that falls just then: the
/// times themselves decide.
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
