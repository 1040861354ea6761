//! The shaped curve of an axis: the sum of its curve at several delays (Singer and Seering 1990).
//!
//! ```text
//! s_shaped(t) = A_1*s(t) + A_2*s(t - T_2) + …       s keeps its first value before 0 and its last one after its end
//! ```

use crate::curves::move_curve::MoveCurve;
use crate::curves::numeric::Shape;
use crate::curves::phases::{RelativeState, State};
use crate::shaper::Impulse;
use alloc::vec::Vec;

/// A move of the axis: its start in s and in whole steps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part<P> {
    pub(crate) start_s: f64,
    pub(crate) start_steps: i64,
    pub(crate) curve: P,
}

/// The moves of an axis and the impulses that shape them.
#[derive(Clone, Debug, PartialEq)]
pub struct Shaped<P> {
    /// Invariant: each starts at the end of the previous one.
    parts: Vec<Part<P>>,
    /// Duration of the unshaped moves in s.
    moves_s: f64,
    end: f64,
    impulses: Vec<Impulse>,
    /// Changes of the unshaped formula in s, rising, from 0 to its end.
    changes_s: Vec<f64>,
}

/// The formula changes too often: the number of changes of the shaped curve.
pub(crate) struct TooManyChanges(pub(crate) u64);

impl<P: MoveCurve> Shaped<P> {
    /// Shapes moves that last `moves_s` and end at position `end`; the changes of the shaped formula are limited to `max`.
    pub(crate) fn new(
        parts: Vec<Part<P>>,
        (moves_s, end): (f64, f64),
        impulses: &[Impulse],
        max: u64,
    ) -> Result<Self, TooManyChanges> {
        let mut changes_s = Vec::from([0.0]);
        let mut needed = 0_u64;
        for part in &parts {
            let own_s = part.curve.changes_s();
            let (period_s, periods) = part.curve.repeats().unwrap_or((part.curve.duration_s(), 1));
            let per_period = own_s.len() as u64 * impulses.len() as u64;
            needed = needed.saturating_add(per_period.saturating_mul(periods.into()));
            if needed > max {
                return Err(TooManyChanges(needed));
            }
            let end_s = part.start_s + part.curve.duration_s();
            // A cut oscillation ends within the period after the last whole one.
            for period in 0..=periods {
                let start_s = part.start_s + f64::from(period) * period_s;
                let of_period = own_s.iter().map(|change_s| start_s + change_s);
                changes_s.extend(of_period.take_while(|change_s| *change_s < end_s));
            }
            changes_s.push(end_s);
        }
        changes_s.sort_by(f64::total_cmp);
        Ok(Self { parts, moves_s, end, impulses: impulses.to_vec(), changes_s })
    }

    pub(crate) fn duration_s(&self) -> f64 {
        self.moves_s + self.impulses.last().map_or(0.0, |last| last.time_s)
    }

    /// The unshaped state at `t` by the formula that holds at `within_s`.
    fn unshaped(&self, t: f64, within_s: f64) -> State {
        if within_s <= 0.0 {
            return State::default();
        }
        let after = self.parts.partition_point(|part| part.start_s <= within_s);
        let Some(part) = self.parts.get(after.saturating_sub(1)).filter(|_| within_s < self.moves_s) else {
            return State { position: self.end, ..State::default() };
        };
        let state = part.curve.state(t - part.start_s, within_s - part.start_s);
        State { position: part.start_steps as f64 + state.position, ..state }
    }
}

impl<P: MoveCurve> Shape for Shaped<P> {
    fn end_position(&self) -> f64 {
        self.end
    }

    fn parts(&self) -> u32 {
        4
    }

    fn changes_s(&self) -> Vec<f64> {
        let delayed = |impulse: &Impulse| {
            let time_s = impulse.time_s;
            self.changes_s.iter().map(move |change_s| time_s + change_s)
        };
        let mut all: Vec<f64> = self.impulses.iter().flat_map(delayed).collect();
        all.retain(|change_s| *change_s > 0.0 && *change_s < self.duration_s());
        all.push(self.duration_s());
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    }

    fn state(&self, t: f64, within_s: f64) -> RelativeState {
        let sum = self.impulses.iter().fold(State::default(), |sum, Impulse { amplitude, time_s }| {
            let State { position, speed, acceleration } = self.unshaped(t - time_s, within_s - time_s);
            State {
                position: sum.position + amplitude * position,
                speed: sum.speed + amplitude * speed,
                acceleration: sum.acceleration + amplitude * acceleration,
            }
        });
        RelativeState { origin: 0.0, state: sum }
    }
}
