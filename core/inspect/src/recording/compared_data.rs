//! One side of a comparison: recording or plan.

use alloc::vec::Vec;
use serde::Serialize;
use stepscope_capture::timebase::Timebase;
use stepscope_peripheral::trace::Step;

/// Steps or bytes of a recording or a plan.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    pub steps: &'a [Step],
    pub clock_hz: u32,
    /// The values of bytes; empty for steps.
    pub values: &'a [u8],
}

impl Side<'_> {
    pub(super) fn since(&self, from: usize, index: usize) -> Option<i128> {
        Some(i128::from(self.steps.get(index)?.cycle) - i128::from(self.steps.get(from)?.cycle))
    }

    pub(super) fn seconds(&self, step: &Step) -> f64 {
        let first = self.steps.first().map_or(0, |first| first.cycle);
        // Steps may be out of order.
        step.cycle.wrapping_sub(first).cast_signed() as f64 / f64::from(self.clock_hz.max(1))
    }

    pub(super) fn at_s(&self, index: usize) -> Option<f64> {
        self.steps.get(index).map(|step| self.seconds(step))
    }

    pub(super) fn direction(&self, index: usize) -> i32 {
        Step::direction(self.steps, index).signum()
    }
}

/// The exact times of steps whose cycles are rounded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExactTimes {
    pub ticks: Vec<u64>,
    pub base: Timebase,
}

/// What a comparison compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Steps,
    Bytes,
}

impl Kind {
    pub const fn plural(self) -> &'static str {
        match self {
            Self::Steps => "steps",
            Self::Bytes => "bytes",
        }
    }

    pub const fn singular(self) -> &'static str {
        match self {
            Self::Steps => "step",
            Self::Bytes => "byte",
        }
    }
}
