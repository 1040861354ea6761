//! The events to compare: the steps of a channel or, without steps, the bytes of RX.

use super::alignment::{Alignment, Comparison, ExactTimes, Side};
use super::{differences::Differences, matching::Matching, serial::DecodedLine, tolerance::Tolerance};
use alloc::vec::Vec;
use serde::Serialize;
use stepscope_peripheral::signal::{Levels, Record};
use stepscope_peripheral::{trace::Step, trace::steps};

pub use super::compared_data::Kind;

/// Steps or bytes with their times.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Events {
    pub kind: Kind,
    pub clock_hz: u32,
    steps: Vec<Step>,
    values: Vec<u8>,
    exact: Option<ExactTimes>,
}

/// A recording compared with a plan, step by step or byte by byte.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EventComparison {
    pub kind: Kind,
    #[serde(flatten)]
    pub comparison: Comparison,
    pub differences: Differences,
    #[serde(skip)]
    pub matching: Matching,
    #[serde(skip)]
    /// The planned and the recorded event of the shared instant.
    pub aligned: (usize, usize),
}

impl EventComparison {
    pub const fn is_same(&self) -> bool {
        self.comparison.is_same()
    }
}

impl Events {
    /// Steps in cycles of `clock_hz`.
    pub const fn of_steps(steps: Vec<Step>, clock_hz: u32) -> Self {
        Self { kind: Kind::Steps, clock_hz, steps, values: Vec::new(), exact: None }
    }

    /// The bytes of a line, in cycles of `clock_hz`.
    pub fn of_bytes(decoded: &DecodedLine, clock_hz: u32) -> Self {
        let step =
            |(position, byte): (i32, &super::serial::DecodedByte)| Step { cycle: byte.start.0, position };
        Self {
            kind: Kind::Bytes,
            clock_hz,
            steps: (1..).zip(&decoded.bytes).map(step).collect(),
            values: decoded.bytes.iter().map(|byte| byte.byte).collect(),
            exact: None,
        }
    }

    /// Compares by exact times if there is one per step.
    pub fn with_exact(self, exact: Option<ExactTimes>) -> Self {
        let exact = exact.filter(|exact| exact.ticks.len() == self.steps.len());
        Self { exact, ..self }
    }

    /// The steps of a channel, or the bytes of RX at `baud`.
    pub fn of_records(records: &[Record], clock_hz: u32, kind: Kind, channel: u8, baud: u32) -> Self {
        match kind {
            Kind::Steps => Self::of_steps(steps(records, channel), clock_hz),
            Kind::Bytes => {
                Self::of_bytes(&super::serial::decode_line(records, Levels::RX, clock_hz, baud), clock_hz)
            }
        }
    }

    pub fn at_s(&self, index: usize) -> Option<f64> {
        self.steps.get(index).map(|step| step.cycle as f64 / f64::from(self.clock_hz))
    }

    pub const fn len(&self) -> usize {
        self.steps.len()
    }

    pub const fn is_empty(&self) -> bool {
        self.steps.is_empty()
    }

    /// Compares with a plan. The shared instant is planned event `aligned`, or the first match; `None` without it.
    pub fn compare(
        &self,
        model: &Self,
        aligned: Option<usize>,
        within: Tolerance,
    ) -> Option<EventComparison> {
        let alignment =
            Alignment { exact: self.exact.as_ref(), ..Alignment::of(self.side(), model.side(), aligned)? };
        Some(EventComparison {
            kind: self.kind,
            comparison: alignment.comparison(within),
            differences: Differences::of(&alignment, within),
            aligned: alignment.aligned,
            matching: alignment.matching,
        })
    }

    pub fn alignment<'a>(&'a self, model: &'a Self, found: &EventComparison) -> Alignment<'a> {
        let (recorded, model) = (self.side(), model.side());
        Alignment {
            recorded,
            model,
            matching: found.matching.clone(),
            aligned: found.aligned,
            exact: self.exact.as_ref(),
        }
    }

    fn side(&self) -> Side<'_> {
        Side { steps: &self.steps, clock_hz: self.clock_hz, values: &self.values }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn bytes_of_a_run_equal_themselves() {
        use crate::recording::{
            events::{Events, Kind},
            tolerance::Tolerance,
        };
        use crate::trace::stored_run::StoredRun;
        use stepscope_sim::Experiment;

        // The bytes of a run compared with themselves.
        let mut recording = StoredRun::default();
        Experiment::from_json("{}").expect("the default motion").run(&mut recording);
        let bytes = Events::of_records(&recording.trace, 16_000_000, Kind::Bytes, 0, 115_200);
        let found = bytes.compare(&bytes, None, Tolerance::ZERO).expect("there are bytes");
        assert_eq!((found.comparison.compared, found.differences.count), (200, 0));
        assert!(found.is_same());
    }
}
