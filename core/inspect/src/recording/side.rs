//! One side of a comparison: the steps, or bytes, of the recording or of the plan.

use serde::Serialize;
use stepscope_peripheral::trace::Step;

/// Steps, or bytes, by a clock of their own.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    /// All of a channel.
    pub steps: &'a [Step],
    /// Cycles per second.
    pub clock_hz: u32,
    /// The values of bytes; empty for steps.
    pub values: &'a [u8],
}

impl Side<'_> {
    /// Cycles from a step to another, negative where that is earlier.
    pub(super) fn since(&self, from: usize, index: usize) -> Option<i128> {
        Some(i128::from(self.steps.get(index)?.cycle) - i128::from(self.steps.get(from)?.cycle))
    }

    /// Seconds from the first step to a step of the side.
    pub(super) fn seconds(&self, step: &Step) -> f64 {
        let first = self.steps.first().map_or(0, |first| first.cycle);
        // Times that go back, which no recording has, stay times.
        step.cycle.wrapping_sub(first).cast_signed() as f64 / f64::from(self.clock_hz.max(1))
    }

    /// Seconds from the first step to step `index`.
    pub(super) fn at_s(&self, index: usize) -> Option<f64> {
        self.steps.get(index).map(|step| self.seconds(step))
    }

    /// The sign of a step's direction.
    pub(super) fn direction(&self, index: usize) -> i32 {
        Step::direction(self.steps, index).signum()
    }
}

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// The steps of a channel.
    Steps,
    /// The bytes of RX.
    Bytes,
}

impl Kind {
    /// In words, several of them.
    #[must_use]
    pub const fn plural(self) -> &'static str {
        match self {
            Self::Steps => "steps",
            Self::Bytes => "bytes",
        }
    }

    /// In words, one of them.
    #[must_use]
    pub const fn singular(self) -> &'static str {
        match self {
            Self::Steps => "step",
            Self::Bytes => "byte",
        }
    }
}
