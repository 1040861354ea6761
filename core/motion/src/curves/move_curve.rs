//! A planned move as a part of another curve: cut, stretched or shaped.

use crate::curves::phases::State;
use crate::timing::Schedule;
use alloc::vec::Vec;

/// A curve that a new target can cut at any time.
#[allow(private_bounds, reason = "only this crate implements it")]
pub trait MoveCurve: Schedule {
    /// Period in s and number of periods of an oscillation; `None` for other moves.
    fn repeats(&self) -> Option<(f64, u32)>;

    /// Whole position at `t` s, and the number of steps before it in both directions.
    fn due_within(&self, t: f64) -> (i64, u64);

    /// The state at `t` by the formula that holds at `within_s`.
    fn state(&self, t: f64, within_s: f64) -> State;

    /// The state just before `t`.
    fn state_before(&self, t: f64) -> State;

    /// Times in s between which the formula is the same; if it repeats, only in the first period.
    fn changes_s(&self) -> Vec<f64>;
}
