//! The table of a motion's paper as segments (DESIGN B8): its rates, each held for some steps.
//!
//! An interval is rounded once, to the unit of the format. The rounding of a rate adds up over its steps, as in a controller
//! that counts such intervals: that is the table's timing error.

use crate::step_tables::{compressed::MAX_ENTRIES, entry_format::EntryFormat, segments::START};
use crate::{
    AxisPlan, Curve, Profile,
    curves::{sine_segments::SineSegments, trapezoid_table::TrapezoidTable},
    problem::{Cause, ValueError},
    round_half_up,
};
use alloc::{boxed::Box, vec::Vec};
use stepscope_peripheral::segment::{FRACTION_BITS, Segment, SegmentList};

#[derive(Clone, Copy, Debug)]
struct Rate {
    /// From the end of the rate before to the first step.
    first: f64,
    each: f64,
    count: u64,
    right: bool,
    /// Duration, from the end of the rate before.
    lasts: f64,
}

/// The table of the plan, with times in units of `format`.
///
/// # Errors
/// A move without a table, or too many rows.
pub(super) fn document(plan: &AxisPlan, format: EntryFormat, clock_hz: u32) -> Result<SegmentList, Cause> {
    let clock = f64::from(clock_hz);
    let mut table = Table { format, segments: Vec::new() };
    let mut last = 0.0;
    for planned in plan.moves() {
        let start = planned.start_s * clock;
        let mut now = start;
        for rate in rates(&planned.profile, clock_hz)? {
            // Relative to the last step instead of the end of the rate before.
            let first = now + rate.first - last;
            if rate.count > 0 {
                table.rate(Rate { first, ..rate })?;
                last = now + rate.first + (rate.count - 1) as f64 * rate.each;
            }
            now += rate.lasts;
        }
    }
    Ok(SegmentList { start: START, segments: table.segments })
}

/// Bytes of the plan's tables as in their papers; `None` if a move has none.
///
/// A row of an acceleration table is a reload of 2 bytes, or 4 if one needs them; of a staircase a rate and its steps, 4
/// bytes together; sine segments are those of a quarter ([`SineSegments::memory`]). A constant rate is a 4-byte interval
/// and a 4-byte count, a dwell a 4-byte time. A sliced move has steps and rate, 2 bytes each, per slice.
pub(super) fn document_bytes(plan: &AxisPlan) -> Option<u64> {
    plan.moves().iter().try_fold(0, |sum: u64, planned| {
        let bytes = match &planned.profile {
            Profile::TrapezoidTable(table) => table.used_rows() * reload_bytes(table),
            Profile::Staircase(staircase) => 4 * (staircase.ramp_rows() + 1),
            Profile::SineSegments(sine) => sine.memory().segments,
            Profile::Sliced(sliced) => 4 * sliced.slice_count(),
            Profile::Constant(_) => 8,
            Profile::Dwell(_) => 4,
            _ => return None,
        };
        Some(sum + bytes)
    })
}

fn reload_bytes(table: &TrapezoidTable) -> u64 {
    if table.table().reload(0) > u16::MAX.into() { 4 } else { 2 }
}

/// The rates of a move, one after another.
fn rates(profile: &Profile, clock_hz: u32) -> Result<Box<dyn Iterator<Item = Rate> + '_>, Cause> {
    let clock = f64::from(clock_hz);
    let right = profile.steps() >= 0;
    let held =
        move |each: f64, count: u64| Rate { first: each, each, count, right, lasts: count as f64 * each };
    Ok(match profile {
        Profile::TrapezoidTable(table) => {
            let rows = table.used_rows() - 1;
            let cycles =
                move |row| table.table().reload(row) as f64 * clock / f64::from(table.table().timer_hz());
            let plateau = table.steps().unsigned_abs() - 2 * rows;
            let up = (0..rows).map(move |row| held(cycles(row), 1));
            let down = (0..rows).rev().map(move |row| held(cycles(row), 1));
            Box::new(up.chain([held(cycles(rows), plateau)]).chain(down))
        }
        Profile::Staircase(staircase) => {
            let rows = staircase.ramp_rows();
            let row = move |n| {
                held(
                    clock / staircase.table().rate(n) as f64,
                    crate::curves::staircase_table::StaircaseTable::steps_in(n),
                )
            };
            let plateau =
                staircase.plateau_rate().map(|rate| held(clock / rate as f64, staircase.plateau_steps()));
            Box::new((1..=rows).map(row).chain(plateau).chain((1..=rows).rev().map(row)))
        }
        Profile::Sliced(sliced) => Box::new(sliced.slices().map(move |(from, to, count)| {
            let lasts = (to - from) * clock;
            let each = lasts / f64::from(count.max(1));
            Rate { first: each / 2.0, each, count: count.into(), right, lasts }
        })),
        Profile::SineSegments(sine) => Box::new(sine_rates(sine, clock)),
        Profile::Constant(constant) => {
            let each = clock / libm::fabs(constant.speed(0.0));
            Box::new([Rate { first: each / 2.0, ..held(each, profile.steps().unsigned_abs()) }].into_iter())
        }
        Profile::Dwell(_) => Box::new(core::iter::empty()),
        _ => {
            let detail = "this kind of move has no table; use the form exact or compressed, or a move planned by a table";
            return Err(ValueError::Conflict { detail }.into());
        }
    })
}

fn sine_rates(sine: &SineSegments, clock: f64) -> impl Iterator<Item = Rate> + '_ {
    let cycles_per_point = sine.point_s() * clock;
    sine.pieces().filter(|piece| piece.steps > 0).map(move |piece| {
        let each = (piece.to - piece.from) * cycles_per_point / piece.steps as f64;
        let lasts = piece.steps as f64 * each;
        Rate { first: each / 2.0, each, count: piece.steps, right: piece.right, lasts }
    })
}

struct Table {
    format: EntryFormat,
    segments: Vec<Segment>,
}

impl Table {
    fn rate(&mut self, rate: Rate) -> Result<(), Cause> {
        let (first, each) = (self.rounded(rate.first), self.rounded(rate.each));
        if first == each {
            self.steps(rate.count, each, rate.right);
        } else {
            self.steps(1, first, rate.right);
            self.steps(rate.count - 1, each, rate.right);
        }
        if self.segments.len() > MAX_ENTRIES {
            return Err(
                ValueError::too_much(self.segments.len() as u64, MAX_ENTRIES as u64, "entries").into()
            );
        }
        Ok(())
    }

    /// In 1/65536 cycle, rounded to the format's unit.
    fn rounded(&self, cycles: f64) -> u64 {
        let units = round_half_up(cycles * f64::from(1_u32 << self.format.fraction_bits));
        units.max(0).unsigned_abs() << (FRACTION_BITS - self.format.fraction_bits)
    }

    fn steps(&mut self, mut count: u64, interval: u64, right: bool) {
        while count > 0 {
            let part = count.min(u32::MAX.into()) as u32;
            count -= u64::from(part);
            match self.segments.last_mut() {
                Some(Segment::Steps { count: before, interval: same, right: direction, .. })
                    if *same == interval && *direction == right && before.checked_add(part).is_some() =>
                {
                    *before += part;
                }
                _ => self.segments.push(Segment::Steps { count: part, interval, add: 0, right }),
            }
        }
    }
}
