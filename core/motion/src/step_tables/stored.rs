//! How a controller can keep a motion's step times, and what each form costs (DESIGN B8).
//!
//! ```text
//! exact        every step in its cycle, in few entries
//! document     the motion's own table, where it has one
//! compressed   the fewest entries, no step further from its due cycle than allowed
//! ```

use crate::step_tables::{
    compressed::{Tolerance, compressed, compressed_quickly},
    document::{document, document_bytes},
    entry_format::{Entry, EntryFormat},
    segments::{MAX_STEPS, exact},
    timing_error::TimingError,
    wire_bytes::wire_bytes,
};
use crate::{
    AxisPlan, ScheduledStep,
    problem::{Cause, ValueError},
};
use alloc::{vec, vec::Vec};
use stepscope_peripheral::{
    segment::{CheckedSegments, PulseTimes, Refusal, SegmentList},
    units::Cycles,
};

/// Maximum steps of one axis' compressed list or of its document's table: each step is looked at.
pub const MAX_TABLE_STEPS: u64 = 100_000_000;

/// How step times are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Every step in its cycle.
    Exact,
    /// The motion's own table.
    Document,
    /// With the fewest entries, or few.
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
    /// Of a compressed list: the maximum number of entries beyond the minimum.
    pub surplus: Option<u64>,
}

impl Stored {
    /// Bytes of the entries.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.entries.len() as u64 * self.format.bytes()
    }

    /// Entries without steps: turns and waits. Klipper counts its `queue_step` without them.
    #[must_use]
    pub fn turns(&self) -> usize {
        self.entries.iter().filter(|entry| entry.count == 0).count()
    }

    /// Bytes on the line to a controller that speaks Klipper's protocol: commands as it packs them, in blocks of up to 64
    /// bytes. None of a format whose numbers its `queue_step` does not take: it takes those of [`EntryFormat::TICKS`].
    #[must_use]
    pub fn wire_bytes(&self) -> Option<u64> {
        wire_bytes(self.format, &self.entries)
    }
}

/// Keeps the step times of `plan` in a form.
///
/// # Errors
/// What [`compressed`] refuses; more than 4 000 000 steps for the exact list, or [`MAX_TABLE_STEPS`] for another; a
/// move without a table of its own for the paper's, or a rate of it that is too high for `pulse`. A number of steps
/// is refused before one of them is looked at.
pub fn stored(
    plan: &AxisPlan,
    form: Form,
    format: EntryFormat,
    pulse: PulseTimes,
    clock_hz: u32,
) -> Result<Stored, Cause> {
    of_plan(plan, form, Target { format, pulse, search: Search::Fewest }, clock_hz)
}

/// The same, with a compressed list by [`compressed_quickly`].
///
/// # Errors
/// As [`stored`].
pub fn stored_quickly(
    plan: &AxisPlan,
    form: Form,
    format: EntryFormat,
    pulse: PulseTimes,
    clock_hz: u32,
) -> Result<Stored, Cause> {
    of_plan(plan, form, Target { format, pulse, search: Search::Quick }, clock_hz)
}

/// Keeps step times of any origin in a form; they count from the start on and do not fall.
///
/// ```
/// use stepscope_motion::{ScheduledStep, step_tables::{EntryFormat, Form, stored_steps}};
/// use stepscope_peripheral::{segment::PulseTimes, units::Cycles};
///
/// let pulse = PulseTimes { width: Cycles(30), setup: Cycles(10), hold: Cycles(0) };
/// let steps: Vec<_> = (1..=10).map(|k| ScheduledStep { cycle: 1000 * k, right: true }).collect();
/// let table = stored_steps(&steps, Form::Exact, EntryFormat::TICKS, pulse).expect("there is time for each pulse");
/// // The turn to the right, and all steps.
/// assert_eq!((table.entries.len(), table.error.greatest), (2, 0));
/// ```
///
/// # Errors
/// As [`stored`]; [`Form::Document`], because a list has no document.
pub fn stored_steps(
    steps: &[ScheduledStep],
    form: Form,
    format: EntryFormat,
    pulse: PulseTimes,
) -> Result<Stored, Cause> {
    of_list(steps, form, Target { format, pulse, search: Search::Fewest })
}

/// The same, with a compressed list by [`compressed_quickly`].
///
/// # Errors
/// As [`stored_steps`].
pub fn stored_steps_quickly(
    steps: &[ScheduledStep],
    form: Form,
    format: EntryFormat,
    pulse: PulseTimes,
) -> Result<Stored, Cause> {
    of_list(steps, form, Target { format, pulse, search: Search::Quick })
}

#[derive(Clone, Copy)]
enum Search {
    Fewest,
    Quick,
}

#[derive(Clone, Copy)]
struct Target {
    format: EntryFormat,
    pulse: PulseTimes,
    search: Search,
}

fn of_plan(plan: &AxisPlan, form: Form, target: Target, clock_hz: u32) -> Result<Stored, Cause> {
    check_count(plan.step_count(), form)?;
    let own_table = || document(plan, target.format, clock_hz);
    Ok(Stored {
        document_bytes: document_bytes(plan),
        ..table(|| plan.due_steps(clock_hz), own_table, form, target)?
    })
}

fn of_list(steps: &[ScheduledStep], form: Form, target: Target) -> Result<Stored, Cause> {
    check_count(steps.len() as u64, form)?;
    let own_table = || {
        let detail = "a list of steps has no table of its own; give the form exact or compressed";
        Err(ValueError::Conflict { detail }.into())
    };
    table(|| steps.iter().copied(), own_table, form, target)
}

fn check_count(steps: u64, form: Form) -> Result<(), Cause> {
    let most = form.most_steps();
    if steps <= most {
        return Ok(());
    }
    Err(ValueError::TooMuch { given: steps as f64, most: most as f64, of: "steps of a table" }.into())
}

fn table<I: Iterator<Item = ScheduledStep>>(
    due: impl Fn() -> I,
    own_table: impl Fn() -> Result<SegmentList, Cause>,
    form: Form,
    Target { format, pulse, search }: Target,
) -> Result<Stored, Cause> {
    let (list, error, surplus) = match form {
        Form::Exact => (smallest_exact(&due, format, pulse)?, None, None),
        Form::Document => (own_table()?, None, None),
        Form::Compressed(tolerance) => {
            let found = match search {
                Search::Fewest => compressed(due(), tolerance, format, pulse),
                Search::Quick => compressed_quickly(due(), tolerance, format, pulse),
            }?;
            (found.list, Some(found.error), found.surplus)
        }
    };
    let list = checked(list, pulse)?;
    let error = match error {
        Some(error) => error,
        None => TimingError::of(&list, due()).ok_or(Cause::NoSegmentSteps)?,
    };
    let entries = format.pack(&list)?;
    Ok(Stored { list, format, entries, document_bytes: None, error, surplus })
}

/// Every step in its cycle, in as few entries as whole intervals allow, or, where these are fewer, in those that a search
/// finds with fractions of a cycle.
///
/// Of whole cycles no list is shorter: a step stands in its cycle or not, so whichever entry comes before, each that
/// begins there may have the same length, and the longest leaves the fewest steps for those after it. (That is so as long as
/// each interval fits into an entry's field.)
fn smallest_exact<I: Iterator<Item = ScheduledStep>>(
    due: impl Fn() -> I,
    format: EntryFormat,
    pulse: PulseTimes,
) -> Result<SegmentList, Cause> {
    let whole = exact(due(), pulse)?;
    if format.fraction_bits == 0 {
        return Ok(whole);
    }
    let parts = compressed_quickly(due(), Tolerance::of(Cycles(0)), format, pulse).map(|made| made.list);
    match parts {
        Ok(parts) if format.entries(&parts)? < format.entries(&whole)? => Ok(parts),
        // Also where there would be too many of them.
        _ => Ok(whole),
    }
}

fn checked(list: SegmentList, pulse: PulseTimes) -> Result<SegmentList, Cause> {
    match CheckedSegments::new(pulse, vec![list], 1) {
        Ok(found) => Ok(found.into_lists().pop().ok_or(Cause::NoSegmentSteps)?),
        Err(refused) => Err(match refused.first().map(|refused| refused.refusal) {
            Some(Refusal::Interval { step, interval }) => Cause::SegmentInterval { step, interval, pulse },
            Some(Refusal::End { next }) => Cause::SegmentEnd { next },
            _ => Cause::NoSegmentSteps,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_entries_without_steps() {
        let cycles = [1000, 2000, 3000, 3700, 4400, 5100];
        let steps = cycles.map(|cycle| ScheduledStep { cycle, right: true });
        let pulse = PulseTimes { width: Cycles(30), setup: Cycles(10), hold: Cycles(0) };
        let table = stored_steps(&steps, Form::Exact, EntryFormat::TICKS, pulse).unwrap();
        // Two intervals, before them the turn to the right.
        assert_eq!((table.entries.len(), table.turns()), (3, 1));
    }
}
