//! How a controller can keep a motion's step times, and what each form costs (DESIGN B8).
//!
//! ```text
//! exact        every step in its cycle; steps whose intervals differ by a constant share a segment
//! document     the motion's own table, where it has one
//! compressed   few entries, no step further from its due cycle than allowed
//! ```

use crate::quantise::{
    compressed::{Tolerance, compressed},
    document::{document, document_bytes},
    entry_format::{Entry, EntryFormat},
    segments::{MAX_STEPS, exact},
    timing_error::TimingError,
};
use crate::{
    AxisPlan,
    problem::{Cause, ValueError},
};
use alloc::{vec, vec::Vec};
use stepscope_peripheral::segment::{CheckedSegments, PulseTimes, Refusal, SegmentList};

/// Most steps of one axis' compressed list or of its document's table: each step is looked at.
pub const MAX_TABLE_STEPS: u64 = 100_000_000;

/// How step times are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Every step in its cycle.
    Exact,
    /// The motion's own table.
    Document,
    /// With few entries.
    Compressed(Tolerance),
}

impl Form {
    const fn most_steps(self) -> u64 {
        match self {
            Self::Exact => MAX_STEPS,
            Self::Document | Self::Compressed(_) => MAX_TABLE_STEPS,
        }
    }
}

/// The step times of one axis in one form.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    /// What the segment engine runs.
    pub list: SegmentList,
    /// Widths of the entries.
    pub format: EntryFormat,
    /// The list in these widths.
    pub entries: Vec<Entry>,
    /// Bytes of the tables as their documents keep them, which are run up and down again; None where a move has no
    /// table.
    pub document_bytes: Option<u64>,
    /// How far the steps are from their due cycles.
    pub error: TimingError,
}

impl Stored {
    /// Bytes of the entries.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.entries.len() as u64 * self.format.bytes()
    }
}

/// Keeps the step times of `plan` in a form.
///
/// # Errors
/// What [`compressed`] refuses; more than 4 000 000 steps for the exact list, or [`MAX_TABLE_STEPS`] for another; a
/// move without a table of its own for the document's, or a rate of it that is too high for `pulse`. A number of steps
/// is refused before one of them is looked at.
pub fn stored(
    plan: &AxisPlan,
    form: Form,
    format: EntryFormat,
    pulse: PulseTimes,
    clock_hz: u32,
) -> Result<Stored, Cause> {
    let (steps, most) = (plan.step_count(), form.most_steps());
    if steps > most {
        return Err(
            ValueError::TooMuch { given: steps as f64, most: most as f64, of: "steps of a table" }.into()
        );
    }
    let (list, error) = match form {
        Form::Exact => (exact(plan, pulse, clock_hz)?, None),
        Form::Document => (document(plan, format, clock_hz)?, None),
        Form::Compressed(tolerance) => {
            let made = compressed(plan.due_steps(clock_hz), tolerance, format, pulse)?;
            (made.list, Some(made.error))
        }
    };
    let list = judged(list, pulse)?;
    let error = match error {
        Some(error) => error,
        None => TimingError::of(&list, plan.due_steps(clock_hz)).ok_or(Cause::NoSegmentSteps)?,
    };
    let entries = format.pack(&list)?;
    Ok(Stored { list, format, entries, document_bytes: document_bytes(plan), error })
}

/// The list, if the segment engine runs it.
fn judged(list: SegmentList, pulse: PulseTimes) -> Result<SegmentList, Cause> {
    match CheckedSegments::new(pulse, vec![list], 1) {
        Ok(checked) => Ok(checked.into_lists().pop().ok_or(Cause::NoSegmentSteps)?),
        Err(refused) => Err(match refused.first().map(|refused| refused.refusal) {
            Some(Refusal::Interval { step, interval }) => Cause::SegmentInterval { step, interval, pulse },
            Some(Refusal::End { next }) => Cause::SegmentEnd { next },
            _ => Cause::NoSegmentSteps,
        }),
    }
}
