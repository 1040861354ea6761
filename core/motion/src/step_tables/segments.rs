//! The exact segments of a motion (DESIGN B8).
//!
//! ```text
//! step k of an axis   cycle START + floor(t*clock_hz + 1/2)     START = 1, the motion's time 0
//! interval            from step to step, the first from START
//! ```
//!
//! Each step has its exact cycle, so the channels stay synchronous. Steps whose intervals differ by a constant share a
//! segment, from which the engine reproduces exactly these cycles.

use super::AxesPath;
use crate::problem::{Cause, Problem, ValueError};
use crate::{AxisPlan, Problems, ScheduledStep};
use alloc::vec::Vec;
use stepscope_peripheral::{
    segment::{CheckedSegments, FRACTION_BITS, LAST_CYCLE, PulseTimes, Segment, SegmentList},
    units::Instant,
};

/// Maximum steps of all axes: a list has up to one segment of 32 bytes per two steps.
pub(super) const MAX_STEPS: u64 = 4_000_000;
/// Time 0 of the motion: nothing starts before cycle 1 (A3).
pub(super) const START: Instant = Instant(1);

/// The exact segments of the plans, one per channel, for pulses of `pulse`.
/// Errors: too many plans or steps; or the first step of each axis that is too soon for a pulse, also after the start of the
/// motion, or too late for 48.16 fixed point.
pub fn exact_segments(
    plans: &[AxisPlan],
    at: AxesPath<'_>,
    channels: u8,
    pulse: PulseTimes,
    clock_hz: u32,
) -> Result<CheckedSegments, Problems> {
    if plans.len() > channels.into() {
        let cause = ValueError::Length { given: plans.len(), min: 1, max: channels.into(), of: "axes" };
        return Err(Problem::new(at.axes, cause).into());
    }
    let steps = plans.iter().fold(0, |sum: u64, plan| sum.saturating_add(plan.step_count()));
    if steps > MAX_STEPS {
        return Err(Problem::new(at.whole, ValueError::too_much(steps, MAX_STEPS, "steps")).into());
    }
    let (mut lists, mut problems) = (Vec::new(), Vec::new());
    for (axis, plan) in plans.iter().enumerate() {
        match exact(plan.due_steps(clock_hz), pulse) {
            Ok(list) => lists.push(list),
            Err(cause) => problems.push(Problem::new(at.axis(axis), cause)),
        }
    }
    Problems::check(problems)?;
    CheckedSegments::new(pulse, lists, 1).map_err(|refused| {
        let axis = refused.first().map_or(0, |refused| refused.channel);
        Problem::new(at.axis(axis), Cause::EmptySegment).into()
    })
}

/// The exact list of one axis' steps; an error for the first one that is too soon or too late.
pub(super) fn exact(
    steps: impl Iterator<Item = ScheduledStep>,
    pulse: PulseTimes,
) -> Result<SegmentList, Cause> {
    let min = pulse.min_interval().0;
    let last = LAST_CYCLE.0 - START.0;
    let mut merge = Merge::default();
    let mut previous_cycle = 0;
    for (step, due) in (1..).zip(steps) {
        let interval = due.cycle.saturating_sub(previous_cycle);
        if interval < min {
            return Err(Cause::StepTooSoon { step, interval, pulse });
        }
        if due.cycle > last {
            return Err(ValueError::too_much(due.cycle, last, "cycles").into());
        }
        merge.add_step(interval << FRACTION_BITS, due.right);
        previous_cycle = due.cycle;
    }
    Ok(SegmentList { start: START, segments: merge.end() })
}

/// Merges steps into the fewest segments: a segment takes each next step whose interval it predicts.
#[derive(Default)]
struct Merge {
    segments: Vec<Segment>,
    open: Option<Open>,
}

/// The segment to which the next step may be added.
#[derive(Clone, Copy)]
struct Open {
    count: u32,
    first: u64,
    last: u64,
    add: i64,
    right: bool,
}

impl Open {
    fn with_step(self, interval: u64, right: bool) -> Option<Self> {
        let add = interval.checked_signed_diff(self.last)?;
        let belongs = right == self.right && (self.count == 1 || add == self.add);
        let count = self.count.checked_add(1).filter(|_| belongs)?;
        Some(Self { count, last: interval, add, ..self })
    }
}

impl Merge {
    fn add_step(&mut self, interval: u64, right: bool) {
        let grown = self.open.and_then(|open| open.with_step(interval, right));
        if grown.is_none() {
            self.close();
        }
        self.open = Some(grown.unwrap_or(Open { count: 1, first: interval, last: interval, add: 0, right }));
    }

    fn close(&mut self) {
        if let Some(Open { count, first, add, right, .. }) = self.open.take() {
            self.segments.push(Segment::Steps { count, interval: first, add, right });
        }
    }

    fn end(mut self) -> Vec<Segment> {
        self.close();
        self.segments
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        mechanics::{Acceleration, Distance, Speed},
        moves::{Axis, Constant, Dwell, Move, Trapezoid},
        plan_axis,
    };
    use stepscope_peripheral::units::Cycles;

    const PULSE: PulseTimes = PulseTimes { width: Cycles(30), setup: Cycles(10), hold: Cycles(0) };

    fn plan(moves: Vec<Move>) -> AxisPlan {
        plan_axis(&Axis { moves, ..Axis::default() }, "axis").unwrap()
    }

    fn constant(steps: f64, steps_s: f64) -> Move {
        let (distance, speed) = (Distance::Steps(steps), Speed::StepsPerSecond(steps_s));
        Move::Constant(Constant { distance, speed })
    }

    /// Steps, interval and growth in whole cycles, right.
    type Plain = (u32, u64, i64, bool);

    /// Segments of one axis at 1 MHz.
    fn segments(moves: Vec<Move>) -> Vec<Plain> {
        let found = exact_segments(&[plan(moves)], AxesPath::MOTION, 1, PULSE, 1_000_000).unwrap();
        let list = &found.lists()[0];
        assert_eq!(list.start, Instant(1));
        let plain = list.segments.iter().map(|segment| match *segment {
            Segment::Steps { count, interval, add, right } => {
                assert_eq!((interval % 65_536, add % 65_536), (0, 0));
                (count, interval >> 16, add >> 16, right)
            }
            Segment::Dwell(_) => panic!("an exact list has none"),
        });
        plain.collect()
    }

    fn cycles(segments: &[Plain]) -> Vec<u64> {
        let mut cycles = Vec::new();
        let mut now = 0;
        for &(count, mut interval, add, _) in segments {
            for _ in 0..count {
                now += interval;
                cycles.push(now);
                interval = interval.wrapping_add_signed(add);
            }
        }
        cycles
    }

    #[test]
    fn steps_whose_intervals_differ_by_a_constant_share_a_segment() {
        let dwell = |duration_s| Move::Dwell(Dwell { duration_s });
        // The first step is due half a period after the start.
        let rows: [(Vec<Move>, &[Plain]); 4] = [
            (vec![dwell(1.0)], &[]),
            (vec![constant(-1.0, 1000.0)], &[(1, 500, 0, false)]),
            (vec![constant(10.0, 1000.0)], &[(2, 500, 500, true), (8, 1000, 0, true)]),
            (
                vec![constant(3.0, 1000.0), dwell(0.01), constant(-3.0, 2000.0)],
                &[(2, 500, 500, true), (1, 1000, 0, true), (2, 10_750, -10_250, false), (1, 500, 0, false)],
            ),
        ];
        for (moves, expected) in rows {
            assert_eq!(segments(moves.clone()), expected, "{moves:?}");
        }
    }

    #[test]
    fn an_acceleration_table_has_its_reloads() {
        let table = Move::Trapezoid(Trapezoid {
            distance: Distance::Steps(300.0),
            start_speed: Some(Speed::StepsPerSecond(250.0)),
            max_speed: Speed::StepsPerSecond(1200.0),
            max_acceleration: Acceleration::StepsPerSecond2(9000.0),
            ..Trapezoid::default()
        });
        let plan = plan(vec![table.clone(), Move::Dwell(Dwell { duration_s: 0.1 }), table.clone()]);
        let crate::Profile::TrapezoidTable(curve) = &plan.moves()[0].profile else { panic!("{plan:?}") };
        let once: Vec<u64> = (1..=300).map(|k| curve.step_ticks(k)).collect();
        let again = once.iter().map(|ticks| once[299] + 100_000 + ticks);
        let found = cycles(&segments(vec![table.clone(), Move::Dwell(Dwell { duration_s: 0.1 }), table]));
        assert!(found.iter().copied().eq(once.iter().copied().chain(again)), "{found:?}");
        // If the clock is not a multiple of the timer's, each time is rounded half up.
        for clock_hz in [16_000_000, 999_999, 1_500_000, 7] {
            let rounded =
                |&ticks: &u64| (2 * u128::from(ticks) * u128::from(clock_hz) + 1_000_000) / 2_000_000;
            let found = plan.due_steps(clock_hz).take(300).map(|due| u128::from(due.cycle));
            assert!(found.eq(once.iter().map(rounded)), "{clock_hz} Hz");
        }
    }

    #[test]
    fn reports_a_step_that_is_too_soon_with_its_numbers() {
        let too_soon = |step, interval| Cause::StepTooSoon { step, interval, pulse: PULSE };
        let refused = |moves: &[Move]| exact(plan(moves.to_vec()).due_steps(1_000_000), PULSE).err();
        // 40 cycles per step, except for the first with half of it.
        assert_eq!(refused(&[constant(5.0, 12_500.0)]), None);
        assert_eq!(refused(&[constant(5.0, 12_700.0)]), Some(too_soon(1, 39)));
        assert_eq!(refused(&[constant(5.0, 1000.0), constant(5.0, 25_000.0)]), None);
        assert_eq!(refused(&[constant(5.0, 1000.0), constant(5.0, 25_700.0)]), Some(too_soon(7, 39)));
        let plans = [plan(vec![constant(5.0, 1000.0)]), plan(vec![constant(5.0, 25_700.0)])];
        let problem = exact_segments(&plans, AxesPath::MOTION, 2, PULSE, 1_000_000).unwrap_err();
        assert_eq!(problem[..], [Problem::new("source.motion.axes[1]", too_soon(1, 19))]);
    }

    #[test]
    fn each_plan_needs_a_channel_but_not_each_channel_a_plan() {
        let plans = [plan(vec![constant(5.0, 1000.0)]), plan(vec![constant(5.0, 500.0)])];
        let lists = |channels| {
            exact_segments(&plans, AxesPath::MOTION, channels, PULSE, 1_000_000)
                .map(|found| found.lists().len())
        };
        let cause = ValueError::Length { given: 2, min: 1, max: 1, of: "axes" };
        assert_eq!(lists(1), Err(Problem::new("source.motion.axes", cause).into()));
        assert_eq!([2, 3].map(lists), [Ok(2), Ok(2)]);
    }

    #[test]
    fn refuses_too_much_with_its_numbers() {
        let many = [plan(vec![constant(2_000_001.0, 1e4)]), plan(vec![constant(-2_000_000.0, 1e4)])];
        let cause = ValueError::TooMuch { given: 4_000_001.0, max: 4_000_000.0, of: "steps" };
        let found = exact_segments(&many, AxesPath::MOTION, 2, PULSE, 1_000_000);
        assert_eq!(found, Err(Problem::new("source.motion", cause).into()));
        // 2^48 cycles of 1 GHz are 281474.98 s.
        let late = [plan(vec![constant(2.0, 1.0), constant(1.0, 4e-6), constant(9.0, 1.0)])];
        assert!(exact_segments(&late, AxesPath::MOTION, 1, PULSE, 1_000_000_000).is_ok());
        let late = [plan(vec![constant(2.0, 1.0), constant(2.0, 4e-6), constant(9.0, 1.0)])];
        let found = exact_segments(&late, AxesPath::MOTION, 1, PULSE, 1_000_000_000).unwrap_err();
        assert!(
            matches!(found[0].cause, Cause::Value(ValueError::TooMuch { of: "cycles", .. })),
            "{found:?}"
        );
        // A difference of intervals that is too large for one segment.
        let dwell = Move::Dwell(Dwell { duration_s: 86_400.0 });
        let wide = [plan(vec![constant(2.0, 1.0), dwell.clone(), dwell, constant(9.0, 1.0)])];
        let found = exact_segments(&wide, AxesPath::MOTION, 1, PULSE, 1_000_000_000).unwrap();
        assert_eq!((found.steps(), found.lists()[0].segments.len()), (11, 3));
    }
}
