//! Where the formula of a motion changes: between two breakpoints its position, speed and acceleration
//! are smooth, and each rises or falls or stays. So the values at both ends of such a stretch are
//! its least and its greatest, and three points of Gauss and Legendre integrate it and its square.
//!
//! ```text
//! |   .----.     | a trapezoid has a breakpoint at each end of its ramps and in its middle,
//! |  /|  | |\    | a table or a staircase at each change of its rate,
//! +-'-+--+-+-'-- | a cosine 64 in each ramp, another shape as many or more, a sine 128 a period:
//!                | these are no polynomials, so they are cut small
//! ```

use crate::{
    AxisPlan, Curve, Profile, jerk_limited::JerkLimited, polyline::POINTS, sine::Sine,
    sine_segments::SineSegments,
};
use alloc::vec::Vec;

/// Parts that a cosine's ramp is cut into; even, so that the middle of the ramp, where its
/// acceleration is greatest, is a breakpoint.
const RAMP_PARTS: u32 = 64;
/// Parts that a sine's period is cut into; its extremes and its middle are breakpoints.
const PERIOD_PARTS: u32 = 128;
/// Parts that a phase of constant jerk is cut into: the speed bends in it.
const JERK_PARTS: u32 = 16;
/// Parts that a smooth curve through points is cut into, about: its pieces in 4 to 64 each.
const CURVE_PARTS: u32 = 256;

/// An interval of time in which a motion is smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Its start in s on the axis' time.
    pub from_s: f64,
    /// Its end in s.
    pub to_s: f64,
    /// How many such stretches, one whole period of a sine apart, it stands for.
    pub times: f64,
}

/// The breakpoints of one move.
#[derive(Clone, Debug)]
struct MoveBreakpoints {
    start_s: f64,
    end_s: f64,
    /// Breakpoints of the first period, from the move's start, rising.
    breakpoints: Vec<f64>,
    /// The time after which the move repeats itself, where it does.
    period_s: Option<f64>,
}

/// The breakpoints of an axis' whole motion.
#[derive(Clone, Debug)]
pub struct Breakpoints {
    moves: Vec<MoveBreakpoints>,
}

impl Breakpoints {
    /// Of a plan.
    #[must_use]
    pub fn of(plan: &AxisPlan) -> Self {
        let moves = plan.moves().iter().map(|planned| {
            let period_s = planned.profile.repeats().map(|(period_s, _)| period_s);
            let end_s = planned.start_s + planned.profile.duration_s();
            let breakpoints = breakpoints(&planned.profile);
            debug_assert!(breakpoints.is_sorted(), "breakpoints go back in time: {breakpoints:?}");
            MoveBreakpoints { start_s: planned.start_s, end_s, breakpoints, period_s }
        });
        Self { moves: moves.collect() }
    }

    /// The first period of the move that the stretch lies in, as (start, end) in s, where it has one and
    /// the stretch is no shorter: then a curve's extremes in both are the same.
    #[must_use]
    pub fn period_within(&self, from_s: f64, to_s: f64) -> Option<(f64, f64)> {
        let planned_move = self.moves.get(self.moves.partition_point(|each| each.end_s <= from_s))?;
        let period_s = planned_move.period_s.filter(|period_s| to_s - from_s >= *period_s)?;
        let inside = from_s >= planned_move.start_s && to_s <= planned_move.end_s;
        inside.then_some((planned_move.start_s, planned_move.start_s + period_s))
    }

    /// The smooth intervals of a stretch of time, in order but for a sine's whole periods, of which only
    /// the first is cut and stands for all.
    pub fn intervals(&self, from_s: f64, to_s: f64, each: &mut dyn FnMut(Interval)) {
        let once = |from_s: f64, to_s: f64, each: &mut dyn FnMut(Interval)| {
            if to_s > from_s {
                each(Interval { from_s, to_s, times: 1.0 });
            }
        };
        let begin = self.moves.first().map_or(f64::INFINITY, |first| first.start_s);
        let end = self.moves.last().map_or(f64::INFINITY, |last| last.end_s);
        once(from_s, least(begin, to_s), each);
        let first = self.moves.partition_point(|each| each.end_s <= from_s);
        for planned_move in
            self.moves.iter().skip(first).take_while(|planned_move| planned_move.start_s < to_s)
        {
            planned_move.intervals(
                greatest(from_s, planned_move.start_s),
                least(to_s, planned_move.end_s),
                each,
            );
        }
        once(greatest(from_s, end), to_s, each);
    }
}

impl MoveBreakpoints {
    fn intervals(&self, from_s: f64, to_s: f64, each: &mut dyn FnMut(Interval)) {
        let Some(period_s) = self.period_s else { return self.cut(from_s, to_s, 0.0, 1.0, each) };
        // Whole periods from the end of the one that is begun to the start of the one not ended.
        let (first, last) =
            (libm::ceil((from_s - self.start_s) / period_s), libm::floor((to_s - self.start_s) / period_s));
        if last - first < 1.0 {
            let middle = least(to_s, greatest(from_s, self.start_s + first * period_s));
            self.cut(from_s, middle, (first - 1.0) * period_s, 1.0, each);
            return self.cut(middle, to_s, first * period_s, 1.0, each);
        }
        let (begin, end) = (first * period_s, last * period_s);
        self.cut(from_s, self.start_s + begin, begin - period_s, 1.0, each);
        self.cut(self.start_s + begin, self.start_s + begin + period_s, begin, last - first, each);
        self.cut(self.start_s + end, to_s, end, 1.0, each);
    }

    /// Cuts at the breakpoints, which begin anew `shift_s` after the start of the move.
    fn cut(&self, from_s: f64, to_s: f64, shift_s: f64, times: f64, each: &mut dyn FnMut(Interval)) {
        let zero_s = self.start_s + shift_s;
        let mut from = from_s;
        let first = self.breakpoints.partition_point(|breakpoint| zero_s + breakpoint <= from_s);
        for breakpoint in self.breakpoints.iter().skip(first).map(|breakpoint| zero_s + breakpoint) {
            if breakpoint >= to_s {
                break;
            }
            if breakpoint > from {
                each(Interval { from_s: from, to_s: breakpoint, times });
                from = breakpoint;
            }
        }
        if to_s > from {
            each(Interval { from_s: from, to_s, times });
        }
    }
}

fn least(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

fn greatest(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Breakpoints of a move between its ends, rising; of a sine those of its first period.
fn breakpoints(profile: &Profile) -> Vec<f64> {
    match profile {
        Profile::Trapezoid(curve) => mirrored([curve.ramp_s()].into_iter(), curve.duration_s()),
        Profile::Cosine(curve) => mirrored(ramp(curve.ramp_s, RAMP_PARTS), curve.duration_s()),
        Profile::Sliced(curve) => {
            let inside = 1..curve.starts_s.len().saturating_sub(1);
            curve.starts_s.get(inside).map_or_else(Vec::new, <[f64]>::to_vec)
        }
        Profile::Ramps(curve) => {
            // A shape that bends more than a cosine is cut into more pieces, and its middle stays a breakpoint.
            let times = 1 + (curve.ramp.sharpness() / 8.0) as u32;
            mirrored(ramp(curve.ramp_s, times * RAMP_PARTS), curve.duration_s())
        }
        Profile::TrapezoidTable(curve) => {
            // One interval more than the ramp: its slope to the next shows the ramp's end.
            let count = curve.steps().unsigned_abs();
            let near = curve.kept_rows().min(count);
            let far = count.saturating_sub(curve.kept_rows()).max(near + 1);
            (1..=near).chain(far..count).map(|k| curve.step_s(k)).collect()
        }
        Profile::Staircase(curve) => {
            // The first interval climbs half a step only.
            let rows = curve.starts_s.iter().skip(1).copied();
            mirrored([curve.step_s(1)].into_iter().chain(rows), curve.duration_s())
        }
        Profile::SineSegments(sine) => quarters(sine),
        Profile::Sine(sine) => period(sine),
        Profile::JerkLimited(curve) => mirrored(phases(curve).into_iter(), curve.duration_s()),
        Profile::Points(points) => points.joints_s(CURVE_PARTS).collect(),
        Profile::Constant(_) | Profile::Dwell(_) => Vec::new(),
    }
}

fn period(sine: &Sine) -> Vec<f64> {
    let part_s = sine.period_s() / f64::from(PERIOD_PARTS);
    (1..=PERIOD_PARTS).map(|part| f64::from(part) * part_s).collect()
}

/// The ends of the first three phases, and the parts of those of constant jerk.
fn phases(curve: &JerkLimited) -> Vec<f64> {
    let [rising_s, steady_s, ramp_s] = curve.joints_s();
    let parts = |from_s: f64, to_s: f64| {
        (1..=JERK_PARTS).map(move |part| from_s + (to_s - from_s) * f64::from(part) / f64::from(JERK_PARTS))
    };
    parts(0.0, rising_s).chain([steady_s]).chain(parts(steady_s, ramp_s)).collect()
}

fn ramp(ramp_s: f64, parts: u32) -> impl Iterator<Item = f64> {
    (1..=parts).map(move |part| ramp_s * f64::from(part) / f64::from(parts))
}

/// These of the first half, the middle, and their mirror images.
fn mirrored(first_half: impl Iterator<Item = f64>, duration_s: f64) -> Vec<f64> {
    let mut all: Vec<f64> = first_half.filter(|breakpoint| *breakpoint < duration_s / 2.0).collect();
    let second_half: Vec<f64> = all.iter().rev().map(|breakpoint| duration_s - breakpoint).collect();
    all.push(duration_s / 2.0);
    all.extend(second_half);
    all
}

/// The ends of a sine's segments in its first period, the last of them the period's.
fn quarters(sine: &SineSegments) -> Vec<f64> {
    let point_s = sine.period_s() / f64::from(POINTS);
    let quarter = POINTS / 4;
    (0..4_u16)
        .flat_map(|index| {
            let segments = sine.segments();
            let (base, count) = (index * quarter, segments.len());
            (0..count).filter_map(move |place| {
                // Every other quarter goes from the middle to the extreme.
                let point = if index % 2 == 0 {
                    segments.get(place)?.to
                } else {
                    quarter - segments.get(count - 1 - place)?.from
                };
                Some(f64::from(base + point) * point_s)
            })
        })
        .collect()
}
