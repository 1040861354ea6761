//! Moves whose second half mirrors their first (DESIGN B2, B4).
//!
//! ```text
//! n   |        .-'      s(t) = first half(t)           up to T/2
//! n/2 |      /                = n - first half(T - t)  from there on
//!     | _.-'
//!     +-----------      so the end is exactly n, and speed and acceleration need one half alone
//!       T/2      T
//! ```

use crate::curves::curve::greater;
use alloc::vec::Vec;

/// Parts that a cosine's ramp is cut into; even, so that the middle of the ramp, where its acceleration is greatest, is
/// a breakpoint.
pub(crate) const RAMP_PARTS: u32 = 64;

/// The ends of so many equal parts of a ramp, in s.
pub(crate) fn parts_s(ramp_s: f64, parts: u32) -> impl Iterator<Item = f64> {
    (1..=parts).map(move |part| ramp_s * f64::from(part) / f64::from(parts))
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mirrored {
    /// Left negative.
    pub(crate) steps: i64,
    pub(crate) duration_s: f64,
}

impl Mirrored {
    /// Steps without sign.
    pub(crate) fn count(&self) -> f64 {
        self.steps.unsigned_abs() as f64
    }

    pub(crate) fn signed(&self, magnitude: f64) -> f64 {
        if self.steps < 0 { -magnitude } else { magnitude }
    }

    fn is_first_half(&self, t: f64) -> bool {
        t <= self.duration_s / 2.0
    }

    /// Time from the nearer end, 0 at both and outside.
    pub(crate) fn nearer_end(&self, t: f64) -> f64 {
        greater(0.0, if self.is_first_half(t) { t } else { self.duration_s - t })
    }

    /// s(t), of s in the first half in steps without sign.
    pub(crate) fn position(&self, t: f64, first_half: impl Fn(f64) -> f64) -> f64 {
        let travelled = first_half(self.nearer_end(t));
        // The middle belongs to both halves; without this they could pass it by a rounding.
        let half = self.count() / 2.0;
        let travelled = if travelled > half { half } else { travelled };
        self.signed(if self.is_first_half(t) { travelled } else { self.count() - travelled })
    }

    /// When the move is at `place`, in s, of when its first half is at a place; both in steps without
    /// sign, `place` 0 to all.
    pub(crate) fn time_s(&self, place: f64, climb_s: impl Fn(f64) -> f64) -> f64 {
        let left = self.count() - place;
        if place <= left { climb_s(place) } else { self.duration_s - climb_s(left) }
    }

    /// The positions at which the formula changes, of those in the first half.
    pub(crate) fn joints(&self, first_half: &[f64]) -> Vec<f64> {
        let count = self.count();
        let before = first_half.iter().copied().filter(|joint| *joint < count / 2.0);
        let after: Vec<f64> = before.clone().map(|joint| count - joint).collect();
        before.chain([count / 2.0]).chain(after.into_iter().rev()).collect()
    }

    pub(crate) fn acceleration(&self, t: f64, magnitude: f64) -> f64 {
        self.signed(if self.is_first_half(t) { magnitude } else { -magnitude })
    }

    pub(crate) fn breakpoints_s(&self, first_half: impl Iterator<Item = f64>) -> Vec<f64> {
        let middle = self.duration_s / 2.0;
        let mut all: Vec<f64> = first_half.filter(|breakpoint| *breakpoint < middle).collect();
        let second_half: Vec<f64> = all.iter().rev().map(|breakpoint| self.duration_s - breakpoint).collect();
        all.push(middle);
        all.extend(second_half);
        all
    }
}
