//! A curve through given points (DESIGN B6): positions at times, connected by lines or smoothly.
//!
//! ```text
//!  straight  |   /\        lines: the speed jumps at each point
//!            |  /  \____
//!  smooth    |   .-.       a cubic per pair of points (Steffen 1990): it turns only where the points turn, and starts and
//!            | .'   '-._   ends at rest
//! ```
//!
//! A turn that only touches a half-integer from below does not cross it, so no step is due, although the rounded position
//! is one more there. After the end the position is the last one rounded.

mod max_error;
mod passed;

use crate::{
    Curve, Peaks,
    curves::{
        cubic::{Crossing, Cubic, slope_between},
        curve::greater,
    },
    format::grouped,
    round_half_up,
    timing::{CycleTime, Double, Exact, Interpolated, IsDueBefore, MAX_ERROR, Run, Runs, Schedule},
};
use alloc::{boxed::Box, format, string::String, vec::Vec};
use max_error::{MaxError, max_errors};

const CURVE_PARTS: u32 = 256;

/// Time in s and position in steps of a point, relative to the first.
pub(crate) type Point = (Double, Double);

/// The connection of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Between {
    /// Lines.
    Straight,
    /// Monotone cubics, from rest to rest.
    Smooth,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// The points in 106 bits.
    /// Invariant: one more than pieces, the first at 0.
    exact: Vec<Point>,
    /// Maximum errors of the times in f64, one per piece.
    max_errors: Vec<MaxError>,
    /// Invariant: at least one; each starts at the end of the one before, the first at 0.
    pieces: Vec<Cubic>,
    /// Position in whole steps at the end of each piece.
    positions: Vec<i64>,
    /// Steps, in either direction, up to the end of each piece.
    ends: Vec<u64>,
    between: Between,
}

impl Points {
    /// Through at least two (time in s, position in steps) with rising times, else `None`.
    #[must_use]
    pub fn new(points: &[(f64, f64)], between: Between) -> Option<Self> {
        let &(zero_s, zero) = points.first()?;
        if !points.iter().all(|(t, y)| t.is_finite() && y.is_finite()) {
            return None;
        }
        let from_first = |a: f64, b: f64| Exact::difference(a, b).double();
        Self::through(
            points.iter().map(|(t, y)| (from_first(*t, zero_s), from_first(*y, zero))).collect(),
            between,
        )
    }

    pub(crate) fn through(exact: Vec<Point>, between: Between) -> Option<Self> {
        let points: Vec<(f64, f64)> = exact.iter().map(|(t, y)| (t.high, y.high)).collect();
        let mut pieces: Vec<Cubic> = points
            .windows(2)
            .filter_map(|pair| {
                let &[(from_s, from), (to_s, to)] = pair else { return None };
                let speed = (to - from) / (to_s - from_s);
                let piece = Cubic { from_s, to_s, from, to, from_speed: speed, to_speed: speed };
                (to_s > from_s).then_some(piece)
            })
            .collect();
        if pieces.is_empty() || pieces.len() + 1 != points.len() {
            return None;
        }
        if between == Between::Smooth {
            smoothen(&mut pieces);
        }
        let positions = positions(&pieces, &exact);
        debug_assert!(
            positions.len() == pieces.len() && pieces.first().is_some_and(|first| first.from_s == 0.0)
        );
        debug_assert!(pieces.is_sorted_by(|piece, next| piece.to_s == next.from_s && piece.to == next.from));
        let max_errors = max_errors(&pieces, between == Between::Smooth);
        let (mut from, mut steps) = (0_i64, 0_u64);
        let ends = positions.iter().map(|to| {
            steps = steps.saturating_add(from.abs_diff(*to));
            from = *to;
            steps
        });
        let ends = ends.collect();
        Some(Self { exact, max_errors, pieces, positions, ends, between })
    }

    #[must_use]
    pub fn step_count(&self) -> u64 {
        self.counted().map(|(_, from, to)| from.abs_diff(to)).sum()
    }

    /// The maximum distance from the start, in steps.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.pieces.iter().fold(0.0, |max, piece| greater(max, libm::fabs(piece.to)))
    }

    /// Maximum factor by which a piece multiplies the error of a time or position.
    pub(crate) fn max_error_factor(&self) -> f64 {
        let max_s = self.max_errors.iter().fold(0.0, |max, error| greater(max, error.time_s));
        max_s / (MAX_ERROR * self.duration_s())
    }

    /// The piece (from 0) with the maximum speed, and that speed in steps/s.
    #[must_use]
    pub fn quickest(&self) -> (usize, f64) {
        let speeds = self.pieces.iter().map(peak_speed).enumerate();
        speeds.fold((0, 0.0), |max, each| if each.1 > max.1 { each } else { max })
    }

    fn counted(&self) -> impl Iterator<Item = (&Cubic, i64, i64)> + '_ {
        let before = core::iter::once(&0).chain(&self.positions);
        self.pieces.iter().zip(before.zip(&self.positions)).map(|(piece, (from, to))| (piece, *from, *to))
    }

    /// The piece of step `k` (from 1), and the position at which it is due.
    fn step(&self, k: u64) -> Option<(usize, f64)> {
        let past = k.checked_sub(1)?;
        let index = self.ends.partition_point(|end| *end <= past);
        let to = *self.positions.get(index)?;
        let (from, before) = match index.checked_sub(1) {
            Some(last) => (*self.positions.get(last)?, *self.ends.get(last)?),
            None => (0, 0),
        };
        Some((index, due_position(from, to, (past - before) as f64)))
    }

    fn piece(&self, t: f64) -> Option<&Cubic> {
        self.pieces.get(self.pieces.partition_point(|piece| piece.to_s <= t)).or(self.pieces.last())
    }
}

impl Schedule for Points {
    fn length(&self, clock_hz: u32) -> CycleTime {
        let duration_s = self.exact.last().map_or_else(Double::default, |(end_s, _)| *end_s);
        CycleTime::of(duration_s * f64::from(clock_hz))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let clock = f64::from(clock_hz);
        let pieces = self.counted().zip(&self.max_errors).filter(|((_, from, to), _)| from != to);
        Box::new(pieces.map(move |((piece, from, to), error)| {
            let count = from.abs_diff(to);
            let times = Interpolated::new(count, Vec::new(), move |step| {
                let Crossing { time_s, s_per_step } = piece.crossing(due_position(from, to, step));
                // NaN at the end of a piece: no bound.
                let s_per_step = if s_per_step >= 0.0 { s_per_step } else { f64::INFINITY };
                (time_s * clock, (error.time_s + error.travel * s_per_step) * clock)
            });
            Run { count, right: to > from, times: Box::new(times) }
        }))
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        Box::new(move |k, since| {
            let since = since / f64::from(clock_hz);
            self.step(k).is_some_and(|(index, position)| self.is_past(index, position, since))
        })
    }
}

/// Position at which step `index` (from 0) between two whole positions is due.
fn due_position(from: i64, to: i64, index: f64) -> f64 {
    from as f64 + if to > from { index + 0.5 } else { -0.5 - index }
}

fn positions(pieces: &[Cubic], exact: &[Point]) -> Vec<i64> {
    // Whether the curve goes left after the end of each piece, at once or after a standstill.
    let mut falls_next = false;
    let mut falls: Vec<bool> = Vec::with_capacity(pieces.len());
    for piece in pieces.iter().rev() {
        falls.push(falls_next);
        falls_next = piece.to < piece.from || (piece.to == piece.from && falls_next);
    }
    let mut rose = false;
    let ends = pieces.iter().zip(exact.iter().skip(1)).zip(falls.into_iter().rev());
    let positions = ends.map(|((piece, (_, to)), falls)| {
        rose = piece.to > piece.from || (piece.to == piece.from && rose);
        let due = round_half_up(to.high);
        let half = Double::from(due as f64 - 0.5);
        // The f64 may be the half while the point is less. A half that is only touched from below is not crossed.
        if half > *to || (rose && falls && *to <= half) { due - 1 } else { due }
    });
    positions.collect()
}

fn smoothen(pieces: &mut [Cubic]) {
    let mean: Vec<(f64, f64)> =
        pieces.iter().map(|piece| (piece.to_s - piece.from_s, piece.to_speed)).collect();
    let inner = mean.windows(2).map(|pair| match pair {
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
    let within = piece.turn_s().map_or(0.0, |turn_s| piece.speed(turn_s));
    [piece.from_speed, piece.to_speed, within].into_iter().map(libm::fabs).fold(0.0, greater)
}

impl Curve for Points {
    fn duration_s(&self) -> f64 {
        self.pieces.last().map_or(0.0, |piece| piece.to_s)
    }

    fn steps(&self) -> i64 {
        self.positions.last().copied().unwrap_or(0)
    }

    fn position(&self, t: f64) -> f64 {
        if t <= 0.0 {
            return 0.0;
        }
        if t >= self.duration_s() {
            return self.steps() as f64;
        }
        self.piece(t).map_or(0.0, |piece| piece.position(t))
    }

    fn speed(&self, t: f64) -> f64 {
        let t = t.clamp(0.0, self.duration_s());
        self.piece(t).map_or(0.0, |piece| piece.speed(t))
    }

    fn acceleration(&self, t: f64) -> f64 {
        let t = t.clamp(0.0, self.duration_s());
        self.piece(t).map_or(0.0, |piece| piece.acceleration(t))
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
        within.chain(between).fold(Peaks::default(), Peaks::or)
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        let parts = match self.between {
            Between::Straight => 1,
            Between::Smooth => (CURVE_PARTS / self.pieces.len() as u32).clamp(4, 64),
        };
        let pieces = self.pieces.iter().flat_map(|piece| {
            let at = move |part: u32| {
                piece.from_s + (piece.to_s - piece.from_s) * f64::from(part) / f64::from(parts)
            };
            let turn_s = piece.turn_s();
            (1..=parts).flat_map(move |part| {
                let end_s = if part == parts { piece.to_s } else { at(part) };
                let turn_s = turn_s.filter(|turn_s| *turn_s > at(part - 1) && *turn_s < end_s);
                turn_s.into_iter().chain([end_s])
            })
        });
        pieces.collect()
    }

    fn detail(&self, _: f64) -> String {
        let count = grouped(self.pieces.len() as f64 + 1.0);
        format!(
            "{count} points, {}; {}",
            match self.between {
                Between::Straight => "straight between them",
                Between::Smooth => "smooth, from rest to rest",
            },
            self.peaks().to_text()
        )
    }
}

#[cfg(test)]
impl Points {
    fn all_due(&self) -> impl Iterator<Item = (usize, f64, bool)> + '_ {
        (1..=self.step_count()).filter_map(|k| {
            let (index, position) = self.step(k)?;
            Some((index, position, self.pieces[index].to > self.pieces[index].from))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due(points: &[(f64, f64)], between: Between) -> Vec<(f64, bool)> {
        let curve = Points::new(points, between).unwrap();
        let due: Vec<(f64, bool)> = curve
            .all_due()
            .map(|(index, place, right)| (curve.pieces[index].crossing(place).time_s, right))
            .collect();
        assert_eq!(due.len() as u64, curve.step_count());
        let made: i64 = due.iter().map(|(_, right)| if *right { 1 } else { -1 }).sum();
        assert_eq!(made, curve.steps(), "{points:?}");
        assert!(due.is_sorted_by(|a, b| a.0 <= b.0), "{due:?}");
        due
    }

    /// Points, and the times of their steps, right or left.
    type Row<'a> = (&'a [(f64, f64)], &'a [(f64, bool)]);

    #[test]
    fn steps_fall_due_where_the_polyline_crosses_a_half() {
        let (right, left) = (true, false);
        // Shifted in time and place: both count from the first point.
        let rows: [Row; 11] = [
            (&[(10.0, -5.0), (11.0, -3.0)], &[(0.25, right), (0.75, right)]),
            (
                &[(0.0, 0.0), (1.0, 2.0), (2.0, 0.0)],
                &[(0.25, right), (0.75, right), (1.25, left), (1.75, left)],
            ),
            // 1.5 is only touched by the turn; left at once after it is not a step either.
            (&[(0.0, 0.0), (1.5, 1.5), (3.0, 0.0)], &[(0.5, right), (2.5, left)]),
            // Nor if it stands there before it goes back, in one piece or in several.
            (&[(0.0, 0.0), (0.5, 0.5), (1.0, 0.5), (1.5, 0.0)], &[]),
            (
                &[(0.0, 0.0), (1.0, 1.5), (2.0, 1.5), (3.0, 1.5), (6.0, 0.0)],
                &[(1.0 / 3.0, right), (5.0, left)],
            ),
            // Where it goes on afterwards, or ends there, it is one as it arrives.
            (&[(0.0, 0.0), (1.0, 0.5), (2.0, 0.5), (3.0, 1.0)], &[(1.0, right)]),
            (&[(0.0, 0.0), (1.0, 0.5), (2.0, 0.5)], &[(1.0, right)]),
            // From above it is none, and one to the left as it leaves downwards.
            (&[(0.0, 0.0), (1.0, -0.5), (2.0, -0.5), (3.0, 0.0)], &[]),
            (&[(0.0, 0.0), (1.0, -0.5), (2.0, -0.5), (3.0, -1.0)], &[(2.0, left)]),
            // The end at 0.5 is one step, at -0.5 none.
            (&[(0.0, 0.0), (1.0, 0.5)], &[(1.0, right)]),
            (&[(0.0, 0.0), (1.0, -0.5)], &[]),
        ];
        for (points, expected) in rows {
            assert_eq!(due(points, Between::Straight), expected, "{points:?}");
        }
    }

    #[test]
    fn a_smooth_turn_that_rests_at_a_half_makes_no_step() {
        for points in [
            &[(0.0, 0.0), (1.0, 0.5), (2.0, 0.5), (3.0, 0.0)][..],
            &[(0.0, 0.0), (1.0, 0.5), (3.0, 0.0)],
            &[(0.0, 0.0), (1.0, -0.5), (2.0, -0.5), (3.0, 0.0)],
        ] {
            assert_eq!(due(points, Between::Smooth), [], "{points:?}");
        }
        let goes_on = [(0.0, 0.0), (1.0, 0.5), (2.0, 0.5), (3.0, 1.0)];
        assert_eq!(due(&goes_on, Between::Smooth), [(1.0, true)]);
    }

    #[test]
    fn what_is_no_curve_is_none() {
        for points in
            [&[][..], &[(0.0, 0.0)], &[(0.0, 0.0), (0.0, 1.0)], &[(1.0, 0.0), (0.5, 1.0), (2.0, 3.0)]]
        {
            assert_eq!(Points::new(points, Between::Straight), None, "{points:?}");
        }
    }

    #[test]
    fn the_smooth_curve_turns_only_where_the_points_turn_and_passes_through_them() {
        let points =
            [(0.0, 0.0), (0.1, 3.0), (0.5, 40.0), (0.6, 40.0), (1.0, 90.0), (1.1, 20.0), (1.3, 19.0)];
        let curve = Points::new(&points, Between::Smooth).unwrap();
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
        // Where three points lie on a parabola its slope is taken: y = x^2 at 2 is 4.
        let parabola =
            Points::new(&[(0.0, 0.0), (1.0, 1.0), (2.0, 4.0), (3.0, 9.0), (4.0, 16.0)], Between::Smooth);
        assert!((parabola.unwrap().speed(2.0) - 4.0).abs() < 1e-12);
        // Two points are one S-curve, 3*x^2 - 2*x^3.
        let curve = Points::new(&[(5.0, 0.0), (6.0, 100.0)], Between::Smooth).unwrap();
        assert!((curve.position(0.25) - 15.625).abs() < 1e-12);
        let peaks = curve.peaks();
        let found = [peaks.speed, peaks.acceleration, peaks.jerk, peaks.jump, peaks.acceleration_jump];
        assert_eq!(found, [150.0, 600.0, 1200.0, 0.0, 0.0]);
    }

    #[test]
    fn speed_is_the_slope_of_the_position_and_acceleration_that_of_the_speed() {
        let points = [(0.0, 0.0), (0.2, 30.0), (0.5, -40.0), (0.8, -90.0), (1.0, 20.0)];
        let curve = Points::new(&points, Between::Smooth).unwrap();
        for i in 1..1000 {
            let t = f64::from(i) / 1000.0 + 0.0003;
            let slope = |f: &dyn Fn(f64) -> f64| (f(t + 1e-6) - f(t - 1e-6)) / 2e-6;
            if t < 0.999 {
                assert!((slope(&|t| curve.position(t)) - curve.speed(t)).abs() < 1e-4, "{t}");
                assert!((slope(&|t| curve.speed(t)) - curve.acceleration(t)).abs() < 1e-2, "{t}");
            }
        }
        assert_eq!(curve.quickest().0, 3);
    }
}
