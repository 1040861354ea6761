//! Sine as segments of constant rate (DESIGN B5, SWorldJournal issue 11): the breakpoints (`polyline`) are as far apart as
//! the maximum deviation d1 allows; the other quarters follow by symmetry.
//!
//! ```text
//!   +A |\_                _/      vertex    round_half_up(A*y), whole steps
//!      |  \              /        time      i*T/2048
//!    0 |---\------------/---      segment   (difference of vertices)/(difference of times),
//!      |    \_        _/                    one rate, so one interval per segment
//!   -A |      \______/            position  from the start: 0, down to -2*A, up to 0
//!      0     512 1024 1536 2048 i
//! ```

use crate::curves::oscillation::Oscillation;
use crate::curves::polyline::{Folded, POINTS, QUARTER, breakpoints, cosine_at, fold};
use crate::timing::{CycleTime, F106, IsDueBefore, Run, Runs, Schedule};
use crate::{Curve, Peaks, format::grouped, round_half_up};
use alloc::{boxed::Box, format, string::String, vec::Vec};

const MAX_LISTED: usize = 12;

/// A segment of the first quarter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// First and last point of the angle, of 2048 per period.
    pub from: u16,
    pub to: u16,
    pub from_deg: f64,
    pub to_deg: f64,
    pub steps: u64,
    /// In steps/s.
    pub rate: f64,
    pub duration_s: f64,
    /// Distance of its start from the middle, in steps.
    from_steps: u64,
}

/// A segment in any quarter of the motion. It has one equal part per step, in whose middle the step is due.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionSegment {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) steps: u64,
    pub(crate) right: bool,
}

/// Memory of a controller for a quarter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Bytes of the segments: a 4-byte interval and a step count each, which takes 2 bytes, or 4 if a segment has more
    /// than 65535 steps.
    pub segments: u64,
    /// Bytes of a 4-byte interval per step.
    pub intervals: u64,
}

/// A sine by segments.
#[derive(Clone, Debug, PartialEq)]
pub struct SineSegments {
    pub(crate) oscillation: Oscillation,
    /// The first quarter.
    /// Invariant: from point 0 to [`QUARTER`] without gaps.
    segments: Vec<Segment>,
}

impl SineSegments {
    /// `periods` whole periods of `period_s` > 0 between `amplitude` steps on both sides of the middle; a negative
    /// amplitude starts at the left extreme. `d1` is the maximum deviation in units of the amplitude.
    pub fn new(amplitude: i64, period_s: f64, periods: u32, d1: f64) -> Self {
        let amplitude_steps = amplitude.unsigned_abs() as f64;
        let vertex = |point| round_half_up(amplitude_steps * cosine_at(point)).unsigned_abs();
        let segments = breakpoints(d1)
            .windows(2)
            .filter_map(|pair| {
                let &[from, to] = pair else { return None };
                let duration_s = f64::from(to - from) * period_s / f64::from(POINTS);
                let steps = vertex(from) - vertex(to);
                Some(Segment {
                    from,
                    to,
                    from_deg: f64::from(from) * 360.0 / f64::from(POINTS),
                    to_deg: f64::from(to) * 360.0 / f64::from(POINTS),
                    steps,
                    rate: steps as f64 / duration_s,
                    duration_s,
                    from_steps: vertex(from),
                })
            })
            .collect::<Vec<_>>();
        debug_assert!(
            segments.first().is_some_and(|first| first.from == 0)
                && segments.last().is_some_and(|last| last.to == QUARTER)
                && segments
                    .is_sorted_by(|segment, next| segment.from < segment.to && segment.to == next.from),
            "the segments do not cover the quarter"
        );
        Self { oscillation: Oscillation::new(amplitude, period_s, periods), segments }
    }

    /// The segments of the first quarter, from the extreme to the middle.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Memory of the segments of a quarter, and of a table of intervals.
    pub fn memory(&self) -> Memory {
        let has_long_segments = self.segments.iter().any(|segment| segment.steps > u16::MAX.into());
        let each = if has_long_segments { 8 } else { 6 };
        Memory { segments: self.segments.len() as u64 * each, intervals: self.oscillation.amplitude * 4 }
    }

    pub(crate) fn motion_segments(&self) -> impl Iterator<Item = MotionSegment> + '_ {
        let quarters =
            (0..self.oscillation.periods).flat_map(|period| (0..4_u16).map(move |quarter| (period, quarter)));
        quarters.flat_map(move |(period, quarter)| {
            let last = self.segments.len().saturating_sub(1);
            (0..self.segments.len()).filter_map(move |index| {
                // Odd quarters mirror the first one.
                let segment = self.segments.get(if quarter % 2 == 1 { last - index } else { index })?;
                Some(self.in_quarter(segment, period, quarter))
            })
        })
    }

    fn in_quarter(&self, segment: &Segment, period: u32, quarter: u16) -> MotionSegment {
        let (near, far) = (segment.from, segment.to);
        let (from, to) = if quarter % 2 == 1 { (2 * QUARTER - far, 2 * QUARTER - near) } else { (near, far) };
        let base = if quarter >= 2 { 2 * QUARTER } else { 0 };
        let origin = f64::from(period) * f64::from(POINTS);
        MotionSegment {
            from: origin + f64::from(base + from),
            to: origin + f64::from(base + to),
            steps: segment.steps,
            right: self.oscillation.starts_right == (quarter >= 2),
        }
    }

    fn first_period(&self) -> impl Iterator<Item = MotionSegment> + '_ {
        self.motion_segments().take(4 * self.segments.len())
    }

    pub fn point_s(&self) -> f64 {
        self.oscillation.period_s / f64::from(POINTS)
    }

    fn locate(&self, t: f64) -> (Folded, Option<&Segment>) {
        let folded = fold(self.oscillation.part(t) * f64::from(POINTS));
        let found = self.segments.partition_point(|segment| {
            // A boundary belongs to the segment after it in time.
            let end = f64::from(segment.to);
            if folded.goes_left == folded.is_right { end <= folded.point } else { end < folded.point }
        });
        let segment = self.segments.get(found).or(self.segments.last());
        (folded, segment)
    }

    /// Speed in the segment at `t`, right positive if the start is the right extreme.
    fn rate_at(&self, t: f64) -> f64 {
        let (folded, segment) = self.locate(t);
        let rate = segment.map_or(0.0, |segment| segment.rate);
        if folded.goes_left { -rate } else { rate }
    }
}

impl Schedule for SineSegments {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        self.oscillation.duration(clock_hz)
    }

    /// One run per segment, because each has its own rate.
    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let (clock, max_error) = (f64::from(clock_hz), self.max_error_s() * f64::from(clock_hz));
        let per_point = self.point_s() * clock;
        let segments = self.motion_segments().filter(|segment| segment.steps > 0);
        Box::new(segments.map(move |MotionSegment { from, to, steps, right }| {
            let points_per_step = (to - from) / steps as f64;
            Run::new(steps, right, max_error, move |step| (from + (step + 0.5) * points_per_step) * per_point)
        }))
    }

    /// The time of a step is a fraction of the period. In f64 its error is at most 6 u.
    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let period = self.oscillation.period_cycles(clock_hz);
        let steps_per_period = 4 * self.oscillation.amplitude;
        // Each segment of a period with the number of steps up to its end.
        let (mut segments, mut count) = (Vec::with_capacity(4 * self.segments.len()), 0);
        for segment in self.first_period() {
            count += segment.steps;
            segments.push((count, segment));
        }
        Box::new(move |k, since| {
            let (periods, step) = ((k - 1) / steps_per_period, (k - 1) % steps_per_period);
            let index = segments.partition_point(|(end, _)| *end <= step);
            let Some((end, MotionSegment { from, to, steps, .. })) = segments.get(index) else {
                debug_assert!(false, "step {k} is in no segment");
                return false;
            };
            let halves = 2 * (step - (end - steps)) + 1;
            let along = F106::from(halves) * (to - from) / F106::from(2 * steps);
            since > period * (F106::from(periods) + (along + *from) / f64::from(POINTS))
        })
    }
}

impl Curve for SineSegments {
    fn duration_s(&self) -> f64 {
        self.oscillation.duration_s()
    }

    fn steps(&self) -> i64 {
        0
    }

    fn position(&self, t: f64) -> f64 {
        if t <= 0.0 || t >= self.duration_s() {
            return 0.0;
        }
        let (folded, segment) = self.locate(t);
        let Some(segment) = segment else { return 0.0 };
        let along = (folded.point - f64::from(segment.from)) / f64::from(segment.to - segment.from);
        let from_middle = segment.from_steps as f64 - segment.steps as f64 * along;
        let position = if folded.is_right { from_middle } else { -from_middle };
        self.oscillation.signed(position - self.oscillation.amplitude as f64)
    }

    fn speed(&self, t: f64) -> f64 {
        let last = self.segments.first().map_or(0.0, |segment| segment.rate);
        self.oscillation.signed(if t >= self.duration_s() { last } else { self.rate_at(t) })
    }

    /// The speed jumps between segments; acceleration and jerk are 0.
    fn peaks(&self) -> Peaks {
        // At the extreme the first segment follows its mirror image.
        let before = self.segments.first().map(|first| -first.rate);
        Peaks::of_rates(before, self.segments.iter().map(|segment| segment.rate))
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        self.first_period().map(|segment| segment.to * self.point_s()).collect()
    }

    fn detail(&self, _: f64) -> String {
        let points: Vec<String> = self
            .segments
            .iter()
            .take(MAX_LISTED)
            .map(|segment| format!("{:.2}\u{b0} {}/s", segment.from_deg, grouped(segment.rate)))
            .collect();
        let memory = self.memory();
        format!(
            "{} segments per quarter: {}{}; {} bytes, compared with {} for an interval per step",
            self.segments.len(),
            points.join(", "),
            if self.segments.len() > MAX_LISTED { ", \u{2026}" } else { "" },
            grouped(memory.segments as f64),
            grouped(memory.intervals as f64)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_are_whole_steps_at_their_times() {
        for amplitude in [1000, -1000, 1, 70_001] {
            let sine = SineSegments::new(amplitude, 0.5, 3, 0.006);
            let steps = amplitude.unsigned_abs() as f64;
            for point in [0, 71, 144, 221, 307, 413, 512_u16] {
                let height = round_half_up(steps * cosine_at(point)) as f64;
                for (at, y) in [
                    (point, height),
                    (1024 - point, -height),
                    (1024 + point, -height),
                    (2048 - point, height),
                ] {
                    let t = 0.5 * (1.0 + f64::from(at) / 2048.0);
                    let expected = (y - steps) * f64::from(amplitude.signum() as i32);
                    let found = sine.position(t);
                    assert!((found - expected).abs() < 1e-7, "{amplitude} at {at}: {found} {expected}");
                }
            }
            assert_eq!(sine.position(1.5), 0.0);
        }
    }

    #[test]
    fn every_period_has_the_same_number_of_steps() {
        for (amplitude, periods) in [(500, 3), (-7, 1), (1, 2), (64, 5)] {
            let sine = SineSegments::new(amplitude, 0.5, periods, 0.006);
            let (mut made, mut last, mut times) = (0, 0.0, [0.0; 512]);
            for mut run in sine.runs(2048) {
                // 2048 points in half a second: twice as many points as cycles.
                run.times.fill(0.0, &mut times[..run.count as usize]);
                let half = (times[0] / 512.0) as u64;
                assert_eq!(run.right, sine.oscillation.goes_right(half), "{amplitude}: {}", times[0]);
                assert!(
                    times[..run.count as usize].iter().all(|at| core::mem::replace(&mut last, *at) < *at),
                    "{amplitude}"
                );
                made += run.count;
            }
            assert_eq!(made, sine.oscillation.step_count(), "{amplitude}");
        }
    }

    #[test]
    fn segments_add_up_to_the_quarter() {
        let sine = SineSegments::new(1000, 0.5, 1, 0.006);
        assert_eq!(sine.segments().iter().map(|s| s.steps).sum::<u64>(), 1000);
        let whole: f64 = sine.segments().iter().map(|s| s.duration_s).sum();
        assert!((whole - 0.125).abs() < 1e-15);
        let first = sine.segments()[0];
        assert_eq!((first.from, first.to, first.steps), (0, 71, 24));
        assert!((first.to_deg - 12.480_468_75).abs() < 1e-12);
        assert!((first.rate - 24.0 / (71.0 * 0.5 / 2048.0)).abs() < 1e-9);
        assert_eq!(sine.memory(), Memory { segments: 36, intervals: 4000 });
        let long = SineSegments::new(1_000_000, 10.0, 1, 0.006).memory();
        assert_eq!(long, Memory { segments: 48, intervals: 4_000_000 });
    }

    #[test]
    fn the_speed_is_the_slope_of_the_position() {
        let sine = SineSegments::new(-1000, 0.5, 2, 0.006);
        for i in 0..2048 {
            let t = (f64::from(i) + 0.5) / 2048.0 * sine.oscillation.period_s;
            let slope = (sine.position(t + 1e-7) - sine.position(t - 1e-7)) / 2e-7;
            assert!((slope - sine.speed(t)).abs() < 1e-2, "{i}: {slope} {}", sine.speed(t));
        }
        let peaks = sine.peaks();
        assert!((peaks.speed - 1000.0 * core::f64::consts::TAU / 0.5).abs() < 200.0, "{peaks:?}");
        // At the extremes the first segment's rate is reversed.
        assert_eq!(peaks.jump.max(2.0 * sine.segments()[0].rate), peaks.jump);
    }
}
