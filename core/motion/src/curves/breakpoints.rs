//! Times at which the formula of a motion changes (DESIGN Part B). Between them position, speed and acceleration are smooth
//! and monotonic: the extremes are at the ends, and three-point Gauss quadrature integrates them and their squares.

use crate::AxisPlan;
use crate::curves::curve::{greater, lesser};
use alloc::vec::Vec;

/// A part of a motion without breakpoints inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub from_s: f64,
    pub to_s: f64,
    /// Number of intervals that it represents, each one sine period after the previous one.
    pub times: f64,
}

#[derive(Clone, Debug)]
struct MoveBreakpoints {
    start_s: f64,
    end_s: f64,
    /// Breakpoints of the first period, relative to the start of the move, rising.
    breakpoints: Vec<f64>,
    period_s: Option<f64>,
}

/// The breakpoints of an axis.
#[derive(Clone, Debug)]
pub struct Breakpoints {
    moves: Vec<MoveBreakpoints>,
}

impl Breakpoints {
    pub fn of(plan: &AxisPlan) -> Self {
        let moves = plan.moves().iter().map(|planned| {
            let period_s = planned.profile.repeats().map(|(period_s, _)| period_s);
            let end_s = planned.start_s + planned.profile.duration_s();
            let breakpoints = planned.profile.breakpoints_s();
            debug_assert!(breakpoints.is_sorted(), "breakpoints are not sorted: {breakpoints:?}");
            MoveBreakpoints { start_s: planned.start_s, end_s, breakpoints, period_s }
        });
        Self { moves: moves.collect() }
    }

    /// The first period as (start, end) in s of the periodic move that contains the window, if the window is at least as
    /// long: then a curve has the same extremes in both.
    pub fn period_within(&self, from_s: f64, to_s: f64) -> Option<(f64, f64)> {
        let planned_move = self.moves.get(self.moves.partition_point(|planned| planned.end_s <= from_s))?;
        let period_s = planned_move.period_s.filter(|period_s| to_s - from_s >= *period_s)?;
        let inside = from_s >= planned_move.start_s && to_s <= planned_move.end_s;
        inside.then_some((planned_move.start_s, planned_move.start_s + period_s))
    }

    /// Reports the smooth intervals of a time window. Of whole periods only the first is reported, with their number.
    pub fn intervals(&self, from_s: f64, to_s: f64, report: &mut dyn FnMut(Interval)) {
        let report_once = |from_s: f64, to_s: f64, report: &mut dyn FnMut(Interval)| {
            if to_s > from_s {
                report(Interval { from_s, to_s, times: 1.0 });
            }
        };
        let begin = self.moves.first().map_or(f64::INFINITY, |first| first.start_s);
        let end = self.moves.last().map_or(f64::INFINITY, |last| last.end_s);
        report_once(from_s, lesser(begin, to_s), report);
        let first = self.moves.partition_point(|planned| planned.end_s <= from_s);
        for planned_move in
            self.moves.iter().skip(first).take_while(|planned_move| planned_move.start_s < to_s)
        {
            planned_move.intervals(
                greater(from_s, planned_move.start_s),
                lesser(to_s, planned_move.end_s),
                report,
            );
        }
        report_once(greater(from_s, end), to_s, report);
    }
}

impl MoveBreakpoints {
    fn intervals(&self, from_s: f64, to_s: f64, report: &mut dyn FnMut(Interval)) {
        let Some(period_s) = self.period_s else { return self.cut(from_s, to_s, 0.0, 1.0, report) };
        // The whole periods within the window are those from `first` to `last`.
        let (first, last) =
            (libm::ceil((from_s - self.start_s) / period_s), libm::floor((to_s - self.start_s) / period_s));
        if last - first < 1.0 {
            let middle = lesser(to_s, greater(from_s, self.start_s + first * period_s));
            self.cut(from_s, middle, (first - 1.0) * period_s, 1.0, report);
            return self.cut(middle, to_s, first * period_s, 1.0, report);
        }
        let (begin, end) = (first * period_s, last * period_s);
        self.cut(from_s, self.start_s + begin, begin - period_s, 1.0, report);
        self.cut(self.start_s + begin, self.start_s + begin + period_s, begin, last - first, report);
        self.cut(self.start_s + end, to_s, end, 1.0, report);
    }

    fn cut(&self, from_s: f64, to_s: f64, shift_s: f64, times: f64, report: &mut dyn FnMut(Interval)) {
        let origin_s = self.start_s + shift_s;
        let mut from = from_s;
        let first = self.breakpoints.partition_point(|breakpoint| origin_s + breakpoint <= from_s);
        for breakpoint in self.breakpoints.iter().skip(first).map(|breakpoint| origin_s + breakpoint) {
            if breakpoint >= to_s {
                break;
            }
            if breakpoint > from {
                report(Interval { from_s: from, to_s: breakpoint, times });
                from = breakpoint;
            }
        }
        if to_s > from {
            report(Interval { from_s: from, to_s, times });
        }
    }
}
