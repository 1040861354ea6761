//! The table of a motion's paper as segments (DESIGN B8): consecutive rates, each for some steps.
//!
//! An interval is rounded once, to the unit of the format. This error accumulates over the steps of a rate, as in a
//! controller that counts such intervals.

use crate::curves::{
    sine_segments::SineSegments, staircase_table::StaircaseTable, trapezoid_table::TrapezoidTable,
};
use crate::problem::{Cause, ValueError};
use crate::step_tables::{compressed::check_entries, entry_format::EntryFormat, segments::START};
use crate::{AxisPlan, Curve, Profile, round_half_up};
use alloc::{boxed::Box, vec::Vec};
use stepscope_peripheral::segment::{FRACTION_BITS, Segment, SegmentList};

/// Steps at a constant rate. Times are in cycles.
#[derive(Clone, Copy, Debug)]
struct Rate {
    /// From the end of the previous rate to the first step.
    first: f64,
    interval: f64,
    count: u64,
    right: bool,
    /// From the end of the previous rate to the end of this one.
    duration: f64,
}

/// The table of the plan, with times in units of `format`; an error for a move without a table, or too many rows.
pub(super) fn document(plan: &AxisPlan, format: EntryFormat, clock_hz: u32) -> Result<SegmentList, Cause> {
    let clock = f64::from(clock_hz);
    let mut table = Table { format, segments: Vec::new() };
    let mut last_step = 0.0;
    for planned in plan.moves() {
        let mut now = planned.start_s * clock;
        for rate in rates(&planned.profile, clock_hz)? {
            // Relative to the last step instead of the end of the previous rate.
            let first = now + rate.first - last_step;
            if rate.count > 0 {
                table.add_rate(Rate { first, ..rate })?;
                last_step = now + rate.first + (rate.count - 1) as f64 * rate.interval;
            }
            now += rate.duration;
        }
    }
    Ok(SegmentList { start: START, segments: table.segments })
}

/// Bytes of the plan's tables as in their papers; `None` if a move has no table. A row of a staircase has a rate and its steps,
/// a slice its steps and rate, 2 bytes each; a constant rate an interval and a count, a dwell its time, 4 bytes each.
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

fn rates(profile: &Profile, clock_hz: u32) -> Result<Box<dyn Iterator<Item = Rate> + '_>, Cause> {
    let clock = f64::from(clock_hz);
    let right = profile.steps() >= 0;
    // The first step follows after one interval.
    let rate = move |interval: f64, count: u64| {
        let duration = count as f64 * interval;
        Rate { first: interval, interval, count, right, duration }
    };
    Ok(match profile {
        Profile::TrapezoidTable(table) => {
            let rows = table.used_rows() - 1;
            let cycles =
                move |row| table.table().reload(row) as f64 * clock / f64::from(table.table().timer_hz());
            let plateau = table.steps().unsigned_abs() - 2 * rows;
            let up = (0..rows).map(move |row| rate(cycles(row), 1));
            let down = (0..rows).rev().map(move |row| rate(cycles(row), 1));
            Box::new(up.chain([rate(cycles(rows), plateau)]).chain(down))
        }
        Profile::Staircase(staircase) => {
            let rows = staircase.ramp_rows();
            let row = move |n| rate(clock / staircase.table().rate(n) as f64, StaircaseTable::steps_in(n));
            let plateau =
                staircase.plateau_rate().map(|top| rate(clock / top as f64, staircase.plateau_steps()));
            Box::new((1..=rows).map(row).chain(plateau).chain((1..=rows).rev().map(row)))
        }
        Profile::Sliced(sliced) => Box::new(sliced.slices().map(move |slice| {
            let duration = (slice.to_s - slice.from_s) * clock;
            let interval = duration / f64::from(slice.steps.max(1));
            Rate { first: interval / 2.0, interval, count: slice.steps.into(), right, duration }
        })),
        Profile::SineSegments(sine) => Box::new(sine_rates(sine, clock)),
        Profile::Constant(constant) => {
            let interval = clock / libm::fabs(constant.speed(0.0));
            let steps = rate(interval, profile.steps().unsigned_abs());
            Box::new([Rate { first: interval / 2.0, ..steps }].into_iter())
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
    sine.motion_segments().filter(|segment| segment.steps > 0).map(move |segment| {
        let interval = (segment.to - segment.from) * cycles_per_point / segment.steps as f64;
        let duration = segment.steps as f64 * interval;
        Rate { first: interval / 2.0, interval, count: segment.steps, right: segment.right, duration }
    })
}

struct Table {
    format: EntryFormat,
    segments: Vec<Segment>,
}

impl Table {
    fn add_rate(&mut self, rate: Rate) -> Result<(), Cause> {
        let (first, interval) = (self.rounded(rate.first), self.rounded(rate.interval));
        if first == interval {
            self.add_steps(rate.count, interval, rate.right);
        } else {
            self.add_steps(1, first, rate.right);
            self.add_steps(rate.count - 1, interval, rate.right);
        }
        check_entries(self.segments.len())
    }

    fn rounded(&self, cycles: f64) -> u64 {
        let units = round_half_up(cycles * f64::from(1_u32 << self.format.fraction_bits));
        units.max(0).unsigned_abs() << (FRACTION_BITS - self.format.fraction_bits)
    }

    fn add_steps(&mut self, mut count: u64, interval: u64, right: bool) {
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
