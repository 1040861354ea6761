//! A curve through given points (DESIGN B6): positions at times, connected by lines or smoothly.
//!
//! ```text
//!  straight  |   /\        lines: the speed jumps at each point
//!            |  /  \____
//!  smooth    |   .-.       one cubic per pair of points (Steffen 1990): it reverses only where the points do, and starts
//!            | .'   '-._   and ends at rest
//! ```
//!
//! A reversal that only touches a half-integer from below does not cross it, so no step is due, although the rounded
//! position is one more there. After the end the position is the last one rounded.

mod max_error;
mod passed;

use crate::curves::cubic::{Crossing, Cubic, slope_between};
use crate::curves::curve::{due_position, greater};
use crate::timing::{CycleTime, Exact, F106, Interpolated, IsDueBefore, MAX_ERROR, Run, Runs, Schedule};
use crate::{Curve, Peaks, format::grouped, moves::Interpolation, round_half_up};
use alloc::{boxed::Box, format, string::String, vec::Vec};
use max_error::{MaxError, max_errors};

/// Intervals between breakpoints of a smooth curve, divided among its pieces.
const CURVE_PARTS: u32 = 256;

/// A point in 106 bits, relative to the first one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    pub(crate) time_s: F106,
    pub(crate) position: F106,
}

/// A curve through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// Invariant: one more than pieces, the first at 0.
    exact: Vec<Point>,
    max_errors: Vec<MaxError>,
    /// Invariant: at least one; each starts at the end of the previous one, the first at 0.
    pieces: Vec<Cubic>,
    /// Position in whole steps at the end of each piece.
    end_positions: Vec<i64>,
    /// Number of steps in both directions up to the end of each piece.
    end_counts: Vec<u64>,
    interpolation: Interpolation,
}

impl Points {
    /// A curve through at least two points (time in s, position in steps) with rising times; `None` for others.
    pub fn new(points: &[(f64, f64)], interpolation: Interpolation) -> Option<Self> {
        let &(first_s, first) = points.first()?;
        if !points.iter().all(|(t, y)| t.is_finite() && y.is_finite()) {
            return None;
        }
        let from_first = |(t, y): &(f64, f64)| Point {
            time_s: Exact::difference(*t, first_s).double(),
            position: Exact::difference(*y, first).double(),
        };
        Self::from_exact(points.iter().map(from_first).collect(), interpolation)
    }

    pub(crate) fn from_exact(exact: Vec<Point>, interpolation: Interpolation) -> Option<Self> {
        let mut pieces: Vec<Cubic> = Vec::with_capacity(exact.len());
        let mut slopes: Vec<(f64, f64)> = Vec::with_capacity(exact.len());
        for (start, end) in exact.iter().zip(exact.iter().skip(1)) {
            let (from_s, to_s) = (start.time_s.high, end.time_s.high);
            let (from, to) = (start.position.high, end.position.high);
            if to_s > from_s {
                let speed = (to - from) / (to_s - from_s);
                slopes.push((to_s - from_s, speed));
                pieces.push(Cubic { from_s, to_s, from, to, from_speed: speed, to_speed: speed });
            }
        }
        if pieces.is_empty() || pieces.len() + 1 != exact.len() {
            return None;
        }
        let is_smooth = interpolation == Interpolation::Smooth;
        if is_smooth {
            set_smooth_slopes(&mut pieces, &slopes);
        }
        let end_positions = end_positions(&pieces, &exact);
        debug_assert!(
            end_positions.len() == pieces.len() && pieces.first().is_some_and(|first| first.from_s == 0.0)
        );
        debug_assert!(pieces.is_sorted_by(|piece, next| piece.to_s == next.from_s && piece.to == next.from));
        let max_errors = max_errors(&pieces, is_smooth);
        let (mut from, mut count) = (0_i64, 0_u64);
        let mut end_counts = Vec::with_capacity(pieces.len());
        for to in &end_positions {
            count = count.saturating_add(from.abs_diff(*to));
            from = *to;
            end_counts.push(count);
        }
        Some(Self { exact, max_errors, pieces, end_positions, end_counts, interpolation })
    }

    /// Number of steps in both directions.
    pub fn step_count(&self) -> u64 {
        self.end_counts.last().copied().unwrap_or(0)
    }

    /// The maximum distance from the start, in steps.
    pub fn max_distance(&self) -> f64 {
        self.pieces.iter().fold(0.0, |max, piece| greater(max, libm::fabs(piece.to)))
    }

    /// Maximum factor by which a piece multiplies the error of a time or position.
    pub(crate) fn max_error_factor(&self) -> f64 {
        let max_s = self.max_errors.iter().fold(0.0, |max, error| greater(max, error.time_s));
        max_s / (MAX_ERROR * self.duration_s())
    }

    /// The piece (from 0) with the maximum speed, and that speed in steps/s.
    pub fn fastest_piece(&self) -> (usize, f64) {
        let speeds = self.pieces.iter().map(peak_speed).enumerate();
        speeds.fold((0, 0.0), |max, each| if each.1 > max.1 { each } else { max })
    }

    /// Whole position at `t` s, and the number of steps before it in both directions.
    pub(crate) fn due_within(&self, t: f64) -> (i64, u64) {
        let index = self.pieces.partition_point(|piece| piece.to_s < t).min(self.pieces.len() - 1);
        let (before, count) = match index.checked_sub(1) {
            Some(previous) => (self.end_positions.get(previous), self.end_counts.get(previous)),
            None => (Some(&0), Some(&0)),
        };
        let (Some(before), Some(count), Some(to)) = (before, count, self.end_positions.get(index)) else {
            return (0, 0);
        };
        let due = round_half_up(self.position(t)).clamp(*before.min(to), *before.max(to));
        (due, count + before.abs_diff(due))
    }

    fn pieces_with_positions(&self) -> impl Iterator<Item = (&Cubic, i64, i64)> + '_ {
        let starts = core::iter::once(&0).chain(&self.end_positions);
        self.pieces.iter().zip(starts.zip(&self.end_positions)).map(|(piece, (from, to))| (piece, *from, *to))
    }

    /// The piece of step `k` (from 1), and the position at which it is due.
    fn piece_of_step(&self, k: u64) -> Option<(usize, f64)> {
        let earlier_steps = k.checked_sub(1)?;
        let index = self.end_counts.partition_point(|end| *end <= earlier_steps);
        let to = *self.end_positions.get(index)?;
        let (from, count_before) = match index.checked_sub(1) {
            Some(previous) => (*self.end_positions.get(previous)?, *self.end_counts.get(previous)?),
            None => (0, 0),
        };
        Some((index, due_position(from, to, (earlier_steps - count_before) as f64)))
    }

    fn piece_at(&self, t: f64) -> Option<&Cubic> {
        self.pieces.get(self.pieces.partition_point(|piece| piece.to_s <= t)).or(self.pieces.last())
    }
}

impl Schedule for Points {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        let duration_s = self.exact.last().map_or_else(F106::default, |last| last.time_s);
        CycleTime::of(duration_s * f64::from(clock_hz))
    }

    /// One run per piece, because the direction can change at points.
    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let clock = f64::from(clock_hz);
        let pieces =
            self.pieces_with_positions().zip(&self.max_errors).filter(|((_, from, to), _)| from != to);
        Box::new(pieces.map(move |((piece, from, to), error)| {
            let count = from.abs_diff(to);
            let times = Interpolated::new(count, Vec::new(), move |step| {
                let Crossing { time_s, s_per_step } = piece.crossing(due_position(from, to, step));
                // NaN, at the end of a piece, has no bound.
                let s_per_step = if s_per_step >= 0.0 { s_per_step } else { f64::INFINITY };
                (time_s * clock, (error.time_s + error.travel * s_per_step) * clock)
            });
            Run { count, right: to > from, times: Box::new(times) }
        }))
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        Box::new(move |k, since| {
            let since = since / f64::from(clock_hz);
            self.piece_of_step(k).is_some_and(|(index, position)| self.is_past(index, position, since))
        })
    }
}

fn end_positions(pieces: &[Cubic], exact: &[Point]) -> Vec<i64> {
    // Whether the curve goes left after the end of each piece, immediately or after a standstill.
    let mut goes_left = false;
    let mut goes_left_next: Vec<bool> = Vec::with_capacity(pieces.len());
    for piece in pieces.iter().rev() {
        goes_left_next.push(goes_left);
        goes_left = piece.to < piece.from || (piece.to == piece.from && goes_left);
    }
    goes_left_next.reverse();
    let mut went_right = false;
    let ends = pieces.iter().zip(exact.iter().skip(1)).zip(goes_left_next);
    let positions = ends.map(|((piece, end), goes_left)| {
        went_right = piece.to > piece.from || (piece.to == piece.from && went_right);
        let due = round_half_up(end.position.high);
        let half = F106::from(due as f64 - 0.5);
        // The f64 may be the half although the point is less.
        let is_below = half > end.position;
        let only_touches = went_right && goes_left && end.position <= half;
        if is_below || only_touches { due - 1 } else { due }
    });
    positions.collect()
}

/// Joins the pieces smoothly; `straight` has the duration and the slope of each.
fn set_smooth_slopes(pieces: &mut [Cubic], straight: &[(f64, f64)]) {
    let inner = straight.windows(2).map(|pair| match pair {
        &[before, after] => slope_between(before, after),
        _ => 0.0,
    });
    let slopes: Vec<f64> = core::iter::once(0.0).chain(inner).chain([0.0]).collect();
    for (piece, slopes) in pieces.iter_mut().zip(slopes.windows(2)) {
        if let &[from_speed, to_speed] = slopes {
            (piece.from_speed, piece.to_speed) = (from_speed, to_speed);
        }
    }
}

fn peak_speed(piece: &Cubic) -> f64 {
    let within = piece.inflection_s().map_or(0.0, |t| piece.speed(t));
    [piece.from_speed, piece.to_speed, within].into_iter().map(libm::fabs).fold(0.0, greater)
}

impl Curve for Points {
    fn duration_s(&self) -> f64 {
        self.pieces.last().map_or(0.0, |piece| piece.to_s)
    }

    fn steps(&self) -> i64 {
        self.end_positions.last().copied().unwrap_or(0)
    }

    fn position(&self, t: f64) -> f64 {
        if t <= 0.0 {
            return 0.0;
        }
        if t >= self.duration_s() {
            return self.steps() as f64;
        }
        self.piece_at(t).map_or(0.0, |piece| piece.position(t))
    }

    fn speed(&self, t: f64) -> f64 {
        let t = t.clamp(0.0, self.duration_s());
        self.piece_at(t).map_or(0.0, |piece| piece.speed(t))
    }

    fn acceleration(&self, t: f64) -> f64 {
        let t = t.clamp(0.0, self.duration_s());
        self.piece_at(t).map_or(0.0, |piece| piece.acceleration(t))
    }

    fn peaks(&self) -> Peaks {
        let within = self.pieces.iter().map(|piece| {
            let accelerations = [piece.from_s, piece.to_s].map(|t| libm::fabs(piece.acceleration(t)));
            Peaks {
                speed: peak_speed(piece),
                acceleration: greater(accelerations[0], accelerations[1]),
                jerk: libm::fabs(piece.jerk()),
                ..Peaks::default()
            }
        });
        let between = self.pieces.windows(2).filter_map(|pair| {
            let [before, after] = pair else { return None };
            let jump = after.acceleration(after.from_s) - before.acceleration(before.to_s);
            Some(Peaks {
                jump: libm::fabs(after.from_speed - before.to_speed),
                acceleration_jump: libm::fabs(jump),
                ..Peaks::default()
            })
        });
        within.chain(between).fold(Peaks::default(), Peaks::max)
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        let parts = match self.interpolation {
            Interpolation::Straight => 1,
            Interpolation::Smooth => (CURVE_PARTS / self.pieces.len() as u32).clamp(4, 64),
        };
        let pieces = self.pieces.iter().flat_map(|piece| {
            let at = move |part: u32| {
                piece.from_s + (piece.to_s - piece.from_s) * f64::from(part) / f64::from(parts)
            };
            let inflection_s = piece.inflection_s();
            (1..=parts).flat_map(move |part| {
                let end_s = if part == parts { piece.to_s } else { at(part) };
                let inside = inflection_s.filter(|t| *t > at(part - 1) && *t < end_s);
                inside.into_iter().chain([end_s])
            })
        });
        pieces.collect()
    }

    fn detail(&self, _: f64) -> String {
        let count = grouped(self.pieces.len() as f64 + 1.0);
        format!(
            "{count} points, {}; {}",
            match self.interpolation {
                Interpolation::Straight => "connected by lines",
                Interpolation::Smooth => "smooth, from rest to rest",
            },
            self.peaks().to_text()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Points {
        /// Piece, position and direction of each step.
        pub(super) fn all_due(&self) -> impl Iterator<Item = (usize, f64, bool)> + '_ {
            (1..=self.step_count()).filter_map(|k| {
                let (index, position) = self.piece_of_step(k)?;
                Some((index, position, self.pieces[index].to > self.pieces[index].from))
            })
        }
    }

    fn due(points: &[(f64, f64)], interpolation: Interpolation) -> Vec<(f64, bool)> {
        let curve = Points::new(points, interpolation).unwrap();
        let due: Vec<(f64, bool)> = curve
            .all_due()
            .map(|(index, position, right)| (curve.pieces[index].crossing(position).time_s, right))
            .collect();
        assert_eq!(due.len() as u64, curve.step_count());
        let travel: i64 = due.iter().map(|(_, right)| if *right { 1 } else { -1 }).sum();
        assert_eq!(travel, curve.steps(), "{points:?}");
        assert!(due.is_sorted_by(|a, b| a.0 <= b.0), "{due:?}");
        due
    }

    /// Points, and the times of their steps, right or left.
    type Row<'a> = (&'a [(f64, f64)], &'a [(f64, bool)]);

    #[test]
    fn steps_are_due_where_the_polyline_crosses_a_half_integer() {
        let (right, left) = (true, false);
        // Times and positions count from the first point.
        let rows: [Row; 11] = [
            (&[(10.0, -5.0), (11.0, -3.0)], &[(0.25, right), (0.75, right)]),
            (
                &[(0.0, 0.0), (1.0, 2.0), (2.0, 0.0)],
                &[(0.25, right), (0.75, right), (1.25, left), (1.75, left)],
            ),
            // The reversal only touches 1.5.
            (&[(0.0, 0.0), (1.5, 1.5), (3.0, 0.0)], &[(0.5, right), (2.5, left)]),
            // The same with a standstill there, of one piece or two.
            (&[(0.0, 0.0), (0.5, 0.5), (1.0, 0.5), (1.5, 0.0)], &[]),
            (
                &[(0.0, 0.0), (1.0, 1.5), (2.0, 1.5), (3.0, 1.5), (6.0, 0.0)],
                &[(1.0 / 3.0, right), (5.0, left)],
            ),
            // If the curve continues or ends there, the step is due when it arrives.
            (&[(0.0, 0.0), (1.0, 0.5), (2.0, 0.5), (3.0, 1.0)], &[(1.0, right)]),
            (&[(0.0, 0.0), (1.0, 0.5), (2.0, 0.5)], &[(1.0, right)]),
            // From above, a step to the left is due when it leaves to the left.
            (&[(0.0, 0.0), (1.0, -0.5), (2.0, -0.5), (3.0, 0.0)], &[]),
            (&[(0.0, 0.0), (1.0, -0.5), (2.0, -0.5), (3.0, -1.0)], &[(2.0, left)]),
            // An end at 0.5 has a step, an end at -0.5 none.
            (&[(0.0, 0.0), (1.0, 0.5)], &[(1.0, right)]),
            (&[(0.0, 0.0), (1.0, -0.5)], &[]),
        ];
        for (points, expected) in rows {
            assert_eq!(due(points, Interpolation::Straight), expected, "{points:?}");
        }
    }

    #[test]
    fn a_smooth_reversal_at_a_half_integer_has_no_step() {
        for points in [
            &[(0.0, 0.0), (1.0, 0.5), (2.0, 0.5), (3.0, 0.0)][..],
            &[(0.0, 0.0), (1.0, 0.5), (3.0, 0.0)],
            &[(0.0, 0.0), (1.0, -0.5), (2.0, -0.5), (3.0, 0.0)],
        ] {
            assert_eq!(due(points, Interpolation::Smooth), [], "{points:?}");
        }
        let goes_on = [(0.0, 0.0), (1.0, 0.5), (2.0, 0.5), (3.0, 1.0)];
        assert_eq!(due(&goes_on, Interpolation::Smooth), [(1.0, true)]);
    }

    #[test]
    fn rejects_points_without_rising_times() {
        for points in
            [&[][..], &[(0.0, 0.0)], &[(0.0, 0.0), (0.0, 1.0)], &[(1.0, 0.0), (0.5, 1.0), (2.0, 3.0)]]
        {
            assert_eq!(Points::new(points, Interpolation::Straight), None, "{points:?}");
        }
    }

    #[test]
    fn a_smooth_curve_passes_through_its_points_and_reverses_only_there() {
        let points =
            [(0.0, 0.0), (0.1, 3.0), (0.5, 40.0), (0.6, 40.0), (1.0, 90.0), (1.1, 20.0), (1.3, 19.0)];
        let curve = Points::new(&points, Interpolation::Smooth).unwrap();
        assert_eq!((curve.speed(0.0), curve.speed(1.3)), (0.0, 0.0));
        for pair in points.windows(2) {
            let ((from_s, from), (to_s, to)) = (pair[0], pair[1]);
            assert!((curve.position(from_s) - from).abs() < 1e-9, "{from_s}");
            let mut before = from;
            for part in 1..=1000 {
                let t = from_s + (to_s - from_s) * f64::from(part) / 1000.0;
                let now = curve.position(t);
                assert!((now - before) * (to - from) >= 0.0 && (from != to || now == from), "{t}");
                before = now;
            }
        }
        // The slope of a parabola through three points: that of y = x^2 at 2 is 4.
        let parabola = Points::new(
            &[(0.0, 0.0), (1.0, 1.0), (2.0, 4.0), (3.0, 9.0), (4.0, 16.0)],
            Interpolation::Smooth,
        );
        assert!((parabola.unwrap().speed(2.0) - 4.0).abs() < 1e-12);
        // Two points give an S-curve, 3*x^2 - 2*x^3.
        let curve = Points::new(&[(5.0, 0.0), (6.0, 100.0)], Interpolation::Smooth).unwrap();
        assert!((curve.position(0.25) - 15.625).abs() < 1e-12);
        let peaks = curve.peaks();
        let found = [peaks.speed, peaks.acceleration, peaks.jerk, peaks.jump, peaks.acceleration_jump];
        assert_eq!(found, [150.0, 600.0, 1200.0, 0.0, 0.0]);
    }

    #[test]
    fn speed_and_acceleration_are_derivatives() {
        let points = [(0.0, 0.0), (0.2, 30.0), (0.5, -40.0), (0.8, -90.0), (1.0, 20.0)];
        let curve = Points::new(&points, Interpolation::Smooth).unwrap();
        for i in 1..1000 {
            let t = f64::from(i) / 1000.0 + 0.0003;
            let slope = |f: &dyn Fn(f64) -> f64| (f(t + 1e-6) - f(t - 1e-6)) / 2e-6;
            if t < 0.999 {
                assert!((slope(&|t| curve.position(t)) - curve.speed(t)).abs() < 1e-4, "{t}");
                assert!((slope(&|t| curve.speed(t)) - curve.acceleration(t)).abs() < 1e-2, "{t}");
            }
        }
        assert_eq!(curve.fastest_piece().0, 3);
    }
}
