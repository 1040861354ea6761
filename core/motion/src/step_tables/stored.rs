//! Forms in which a controller can store a motion's step times, and their size (DESIGN B8).

use crate::problem::{Cause, ValueError};
use crate::step_tables::compressed::{Compressed, Tolerance, compressed, compressed_quickly};
use crate::step_tables::document::{document, document_bytes};
use crate::step_tables::entry_format::{Entry, EntryFormat};
use crate::step_tables::segments::{MAX_STEPS, exact};
use crate::step_tables::{timing_error::TimingError, walk::TableWalk, wire_bytes::wire_bytes};
use crate::{AxisPlan, ScheduledStep};
use alloc::{vec, vec::Vec};
use stepscope_peripheral::segment::{CheckedSegments, PulseTimes, SegmentList};
use stepscope_peripheral::units::Cycles;

/// Maximum steps of one axis' compressed list or document table.
pub const MAX_TABLE_STEPS: u64 = 100_000_000;

/// Form of stored step times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Every step in its exact cycle, in few entries.
    Exact,
    /// The table of the motion's paper.
    Document,
    /// The fewest entries ([`compressed`]).
    Compressed(Tolerance),
    /// Few entries, found in a fraction of the time ([`compressed_quickly`]).
    Quick(Tolerance),
}

impl Form {
    const fn max_steps(self) -> u64 {
        match self {
            Self::Exact => MAX_STEPS,
            Self::Document | Self::Compressed(_) | Self::Quick(_) => MAX_TABLE_STEPS,
        }
    }
}

/// Stored step times.
#[derive(Clone, Debug, PartialEq)]
pub struct Stored {
    pub list: SegmentList,
    pub format: EntryFormat,
    pub entries: Vec<Entry>,
    /// Bytes of the tables as in their papers, which store a ramp only once; `None` if a move has no table.
    pub document_bytes: Option<u64>,
    pub error: TimingError,
    /// For a compressed list: see [`Compressed::surplus`].
    pub surplus: Option<u64>,
}

impl Stored {
    pub fn bytes(&self) -> u64 {
        self.entries.len() as u64 * self.format.bytes()
    }

    /// Walks the entries as firmware does.
    pub fn walk(&self) -> TableWalk<'_> {
        TableWalk::new(&self.entries, self.format)
    }

    /// Number of entries without steps: changes of direction and waits, which are no `queue_step` of Klipper.
    pub fn entries_without_steps(&self) -> usize {
        self.entries.iter().filter(|entry| entry.count == 0).count()
    }

    /// Bytes on the line with Klipper's protocol, in blocks of up to 64 bytes; `None` for a format whose numbers its
    /// `queue_step` does not accept.
    pub fn wire_bytes(&self) -> Option<u64> {
        wire_bytes(self.format, &self.entries)
    }
}

/// Stores the step times of `plan` in a form.
/// Errors: more than 4 000 000 steps for the exact form, or [`MAX_TABLE_STEPS`] for others; for the paper's table, a move
/// without one, or a rate too high for `pulse`; else as [`compressed`].
pub fn stored(
    plan: &AxisPlan,
    form: Form,
    format: EntryFormat,
    pulse: PulseTimes,
    clock_hz: u32,
) -> Result<Stored, Cause> {
    check_count(plan.step_count(), form)?;
    let own_table = || document(plan, format, clock_hz);
    Ok(Stored {
        document_bytes: document_bytes(plan),
        ..table(|| plan.due_steps(clock_hz), own_table, form, format, pulse)?
    })
}

/// Stores step times of any origin in a form. They count from the start and must not decrease.
///
/// ```
/// use stepscope_motion::{ScheduledStep, step_tables::{EntryFormat, Form, stored_steps}};
/// use stepscope_peripheral::{segment::PulseTimes, units::Cycles};
///
/// let pulse = PulseTimes { width: Cycles(30), setup: Cycles(10), hold: Cycles(0) };
/// let steps: Vec<_> = (1..=10).map(|k| ScheduledStep { cycle: 1000 * k, right: true }).collect();
/// let table = stored_steps(&steps, Form::Exact, EntryFormat::TICKS, pulse).expect("there is time for each pulse");
/// // The direction to the right, and all steps.
/// assert_eq!((table.entries.len(), table.error.max_cycles), (2, 0));
/// ```
/// Errors: as [`stored`]; [`Form::Document`], because a list of steps has no paper.
pub fn stored_steps(
    steps: &[ScheduledStep],
    form: Form,
    format: EntryFormat,
    pulse: PulseTimes,
) -> Result<Stored, Cause> {
    check_count(steps.len() as u64, form)?;
    let own_table = || {
        let detail = "a list of steps has no table; use the form exact or compressed";
        Err(ValueError::Conflict { detail }.into())
    };
    table(|| steps.iter().copied(), own_table, form, format, pulse)
}

fn check_count(steps: u64, form: Form) -> Result<(), Cause> {
    let max = form.max_steps();
    if steps <= max {
        return Ok(());
    }
    Err(ValueError::too_much(steps, max, "steps of a table").into())
}

fn table<I: Iterator<Item = ScheduledStep>>(
    due: impl Fn() -> I,
    own_table: impl Fn() -> Result<SegmentList, Cause>,
    form: Form,
    format: EntryFormat,
    pulse: PulseTimes,
) -> Result<Stored, Cause> {
    let parts = |Compressed { list, error, surplus }| (list, Some(error), surplus);
    let (list, error, surplus) = match form {
        Form::Exact => (smallest_exact(&due, format, pulse)?, None, None),
        Form::Document => (own_table()?, None, None),
        Form::Compressed(tolerance) => parts(compressed(due(), tolerance, format, pulse)?),
        Form::Quick(tolerance) => parts(compressed_quickly(due(), tolerance, format, pulse)?),
    };
    let list = checked(list, pulse)?;
    let error = match error {
        Some(error) => error,
        None => TimingError::of(&list, due()).ok_or(Cause::EmptySegment)?,
    };
    let entries = format.pack(&list)?;
    Ok(Stored { list, format, entries, document_bytes: None, error, surplus })
}

/// Each step in its exact cycle, in the fewest entries with integer intervals, or with fractional ones if a search finds fewer.
/// With integers the longest entries are the fewest, because the length of an entry depends only on its first step (while each
/// interval fits into an entry).
fn smallest_exact<I: Iterator<Item = ScheduledStep>>(
    due: impl Fn() -> I,
    format: EntryFormat,
    pulse: PulseTimes,
) -> Result<SegmentList, Cause> {
    let with_integers = exact(due(), pulse)?;
    if format.fraction_bits == 0 {
        return Ok(with_integers);
    }
    let quick = compressed_quickly(due(), Tolerance::of(Cycles(0)), format, pulse);
    match quick.map(|quick| quick.list) {
        Ok(with_fractions) if format.pack(&with_fractions)?.len() < format.pack(&with_integers)?.len() => {
            Ok(with_fractions)
        }
        _ => Ok(with_integers),
    }
}

fn checked(list: SegmentList, pulse: PulseTimes) -> Result<SegmentList, Cause> {
    match CheckedSegments::new(pulse, vec![list], 1) {
        Ok(found) => Ok(found.into_lists().pop().ok_or(Cause::EmptySegment)?),
        Err(refused) => {
            let first = refused.first().map(|refused| Cause::of_refusal(refused.refusal, pulse));
            Err(first.unwrap_or(Cause::EmptySegment))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_and_changes_of_direction_are_entries_without_steps() {
        let cycles = [1000, 2000, 3000, 3700, 4400, 5100];
        let steps = cycles.map(|cycle| ScheduledStep { cycle, right: true });
        let pulse = PulseTimes { width: Cycles(30), setup: Cycles(10), hold: Cycles(0) };
        let table = stored_steps(&steps, Form::Exact, EntryFormat::TICKS, pulse).unwrap();
        // The direction to the right, and two intervals.
        assert_eq!((table.entries.len(), table.entries_without_steps()), (3, 1));
    }
}
