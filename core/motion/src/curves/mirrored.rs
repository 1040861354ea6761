//! Moves whose second half mirrors their first (DESIGN B2, B4).
//!
//! ```text
//! n   |        .-'      s(t) = first half(t)           up to T/2
//! n/2 |      /                = n - first half(T - t)  from there on
//!     | _.-'
//!     +-----------      so the end is exactly n
//! ```

use crate::curves::curve::{greater, lesser, signed};
use crate::{Curve, Peaks};
use alloc::{string::String, vec::Vec};

/// Number of intervals of a cosine ramp; even, so that the maximum acceleration in the middle is at a breakpoint.
pub(crate) const RAMP_PARTS: u32 = 64;

pub(crate) fn parts_s(ramp_s: f64, parts: u32) -> impl Iterator<Item = f64> {
    (1..=parts).map(move |part| ramp_s * f64::from(part) / f64::from(parts))
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mirrored {
    pub(crate) steps: i64,
    pub(crate) duration_s: f64,
}

impl Mirrored {
    pub(crate) fn count(&self) -> f64 {
        self.steps.unsigned_abs() as f64
    }

    pub(crate) fn signed(&self, magnitude: f64) -> f64 {
        signed(self.steps, magnitude)
    }

    fn is_first_half(&self, t: f64) -> bool {
        t <= self.duration_s / 2.0
    }

    /// Time from the nearer end of the move, 0 outside.
    pub(crate) fn nearer_end(&self, t: f64) -> f64 {
        greater(0.0, if self.is_first_half(t) { t } else { self.duration_s - t })
    }

    /// Adds the second half to the positions (without sign) at which the formula changes in the first half.
    pub(crate) fn changes(&self, first_half: &[f64]) -> Vec<f64> {
        let count = self.count();
        let before = first_half.iter().copied().filter(|position| *position < count / 2.0);
        let after: Vec<f64> = before.clone().map(|position| count - position).collect();
        before.chain([count / 2.0]).chain(after.into_iter().rev()).collect()
    }

    pub(crate) fn breakpoints_s(&self, first_half: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let middle = self.duration_s / 2.0;
        let mut all: Vec<f64> = first_half.into_iter().filter(|breakpoint| *breakpoint < middle).collect();
        let second_half: Vec<f64> = all.iter().rev().map(|breakpoint| self.duration_s - breakpoint).collect();
        all.push(middle);
        all.extend(second_half);
        all
    }
}

/// The first half of a move whose second half mirrors it: times from its start, positions in steps without sign.
pub(crate) trait MirroredCurve {
    fn halves(&self) -> &Mirrored;

    fn half_position(&self, t: f64) -> f64;

    fn half_speed(&self, t: f64) -> f64;

    /// `None` in a plateau.
    fn half_acceleration(&self, t: f64) -> Option<f64>;

    fn half_time_s(&self, position: f64) -> f64;

    fn half_breakpoints_s(&self) -> Vec<f64>;

    fn all_peaks(&self) -> Peaks;

    fn text(&self, _limit_steps_s: f64) -> String {
        self.all_peaks().to_text()
    }
}

impl<C: MirroredCurve> Curve for C {
    fn duration_s(&self) -> f64 {
        self.halves().duration_s
    }

    fn steps(&self) -> i64 {
        self.halves().steps
    }

    fn position(&self, t: f64) -> f64 {
        let halves = self.halves();
        // Without this limit, rounding could move the middle, which belongs to both halves.
        let travelled = lesser(self.half_position(halves.nearer_end(t)), halves.count() / 2.0);
        halves.signed(if halves.is_first_half(t) { travelled } else { halves.count() - travelled })
    }

    fn speed(&self, t: f64) -> f64 {
        self.halves().signed(self.half_speed(self.halves().nearer_end(t)))
    }

    fn acceleration(&self, t: f64) -> f64 {
        let halves = self.halves();
        self.half_acceleration(halves.nearer_end(t)).map_or(0.0, |magnitude| {
            halves.signed(if halves.is_first_half(t) { magnitude } else { -magnitude })
        })
    }

    fn peaks(&self) -> Peaks {
        self.all_peaks()
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        self.halves().breakpoints_s(self.half_breakpoints_s())
    }

    fn time_s(&self, position: f64) -> f64 {
        let steps_left = self.halves().count() - position;
        if position <= steps_left {
            self.half_time_s(position)
        } else {
            self.halves().duration_s - self.half_time_s(steps_left)
        }
    }

    fn detail(&self, limit_steps_s: f64) -> String {
        self.text(limit_steps_s)
    }
}
