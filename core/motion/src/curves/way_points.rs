//! Waypoints that several axes pass together without stopping.
//!
//! ```text
//! position |        .-o        each section between two points takes the time T_k of its slowest axis; the others
//!          |    _o-'           run it with limits reduced by f < 1, so that they pass each point in the same instant
//!          | o-'
//!          +---T_1-T_2--
//! ```

use crate::bisection::border;
use crate::curves::between_speeds::MoveLimits;
use crate::curves::curve::{greater, lesser};
use crate::curves::phases::{Phase, Phases};
use alloc::vec::Vec;

/// Rounds of mean speeds.
const ROUNDS: u32 = 3;
/// Relative error of a section's time that roundings may cause.
const TIME_TOLERANCE: f64 = 1e-7;

/// One axis: its positions in steps (the first is the start), given speeds and limits.
#[derive(Clone, Debug)]
pub(crate) struct Joint {
    pub(crate) positions: Vec<f64>,
    /// Along the axis, one per position.
    pub(crate) given: Vec<Option<f64>>,
    pub(crate) limits: MoveLimits,
}

/// Sections of all axes.
#[derive(Clone, Debug)]
pub(crate) struct Course {
    /// Duration of each section in s.
    #[cfg_attr(not(test), allow(dead_code, reason = "only tests read it"))]
    pub(crate) durations_s: Vec<f64>,
    /// Speeds of each axis at its positions, along the axis; the first and the last are 0.
    #[cfg_attr(not(test), allow(dead_code, reason = "only tests read it"))]
    pub(crate) speeds: Vec<Vec<f64>>,
    /// The curve of each axis from its first position on.
    pub(crate) curves: Vec<Phases>,
}

/// A given speed that does not fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Misfit {
    pub(crate) axis: usize,
    /// Section from 1 on, which ends at the point of this number.
    pub(crate) section: usize,
    pub(crate) kind: MisfitKind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum MisfitKind {
    /// The section is shorter than the ramp between the speeds at its ends: steps available, and needed.
    TooShort { steps: f64, needed: f64, from: f64, to: f64 },
    /// The section takes so long that the axis would have to slow down in between: time, and the maximum.
    TooSlow { duration_s: f64, max_s: f64, from: f64, to: f64 },
}

/// A section of one axis: its distance, and the magnitudes of the speeds at its ends.
#[derive(Clone, Copy)]
struct Section {
    distance: f64,
    from: f64,
    to: f64,
}

impl Joint {
    fn distances(&self) -> impl Iterator<Item = f64> + '_ {
        self.positions.iter().zip(self.positions.iter().skip(1)).map(|(from, to)| to - from)
    }

    /// Whether the axis stands at each point where it starts, ends, reverses or rests.
    pub(crate) fn stands(&self) -> Vec<bool> {
        let distances: Vec<f64> = self.distances().collect();
        let between =
            distances.iter().zip(distances.iter().skip(1)).map(|(before, after)| before * after <= 0.0);
        core::iter::once(true).chain(between).chain([true]).collect()
    }

    fn sections(&self, speeds: &[f64]) -> Vec<Section> {
        let ends = speeds.iter().zip(speeds.iter().skip(1));
        let section = |(distance, (from, to)): (f64, (&f64, &f64))| Section {
            distance,
            from: libm::fabs(*from),
            to: libm::fabs(*to),
        };
        self.distances().zip(ends).map(section).collect()
    }

    fn min_s(&self, section: Section) -> Result<f64, MisfitKind> {
        let Section { distance, from, to } = section;
        let steps = libm::fabs(distance);
        if steps <= 0.0 {
            return Ok(0.0);
        }
        let needed = || MisfitKind::TooShort { steps, needed: self.limits.ramp_steps(from, to), from, to };
        self.limits.duration_s(steps, from, to).ok_or_else(needed)
    }

    /// The limits reduced by `factor`.
    fn reduced(&self, factor: f64, Section { from, to, .. }: Section) -> MoveLimits {
        let square = factor * factor;
        MoveLimits {
            speed: greater(factor * self.limits.speed, greater(from, to)),
            acceleration: square * self.limits.acceleration,
            deceleration: square * self.limits.deceleration,
            jerk: square * factor * self.limits.jerk,
        }
    }

    /// The largest factor that makes a section last `duration_s`.
    fn factor(&self, section: Section, duration_s: f64) -> f64 {
        let Section { distance, from, to } = section;
        let steps = libm::fabs(distance);
        let reduced_s = |factor: f64| self.reduced(factor, section).duration_s(steps, from, to);
        if reduced_s(1.0).is_none_or(|min_s| min_s >= duration_s) {
            return 1.0;
        }
        border(1.0, 0.0, |factor| reduced_s(factor).is_some_and(|reduced_s| reduced_s <= duration_s)).0
    }

    fn curve(&self, section: Section, duration_s: f64) -> Result<Phases, MisfitKind> {
        let Section { distance, from, to } = section;
        if distance == 0.0 {
            return Ok(Phases::new(0.0, 0.0, [Phase::cruise(duration_s)]));
        }
        if from + to > 0.0 {
            let max_s = 2.0 * libm::fabs(distance) / (from + to);
            if duration_s > max_s * (1.0 + TIME_TOLERANCE) {
                return Err(MisfitKind::TooSlow { duration_s, max_s, from, to });
            }
        }
        let limits = self.reduced(self.factor(section, duration_s), section);
        Ok(limits.plan(0.0, distance, from, to).unwrap_or_else(|| {
            // Only roundings separate the section from its limit: one straight ramp.
            let sign = if distance < 0.0 { -1.0 } else { 1.0 };
            let acceleration = sign * (to - from) / duration_s;
            Phases::new(0.0, sign * from, [Phase { time_s: duration_s, acceleration, jerk: 0.0 }])
        }))
    }
}

/// The times of all sections: those of the slowest axis in each.
fn durations(joints: &[Joint], speeds: &[Vec<f64>]) -> Result<Vec<f64>, Misfit> {
    let mut all: Vec<f64> = Vec::new();
    for (axis, (joint, speeds)) in joints.iter().zip(speeds).enumerate() {
        for (index, section) in joint.sections(speeds).into_iter().enumerate() {
            let min_s = joint.min_s(section).map_err(|kind| Misfit { axis, section: index + 1, kind })?;
            match all.get_mut(index) {
                Some(duration_s) => *duration_s = greater(*duration_s, min_s),
                None => all.push(min_s),
            }
        }
    }
    Ok(all)
}

/// The speeds at the points from the mean speeds in the sections next to them.
fn mean_speeds(joint: &Joint, stands: &[bool], durations_s: &[f64]) -> Vec<f64> {
    let means: Vec<f64> = joint.distances().zip(durations_s).map(|(distance, s)| distance / s).collect();
    let at = |point: usize| {
        if stands.get(point).is_none_or(|stands| *stands) {
            return 0.0;
        }
        if let Some(given) = joint.given.get(point).copied().flatten() {
            return given;
        }
        let (Some(before), Some(after)) = (means.get(point.wrapping_sub(1)), means.get(point)) else {
            return 0.0;
        };
        let factor = |other: usize| if stands.get(other).is_none_or(|stands| *stands) { 2.0 } else { 1.0 };
        let (before, after) = (factor(point - 1) * before, factor(point + 1) * after);
        let magnitude = lesser(joint.limits.speed, lesser(libm::fabs(before), libm::fabs(after)));
        if after < 0.0 { -magnitude } else { magnitude }
    };
    (0..stands.len()).map(at).collect()
}

/// Plans the sections of axes with equally many positions, at least two.
pub(crate) fn course(joints: &[Joint]) -> Result<Course, Misfit> {
    let stands: Vec<Vec<bool>> = joints
        .iter()
        .map(|joint| {
            let given = joint.given.iter().map(|given| *given == Some(0.0));
            joint.stands().into_iter().zip(given).map(|(stands, given)| stands || given).collect()
        })
        .collect();
    let mut speeds: Vec<Vec<f64>> = joints
        .iter()
        .zip(&stands)
        .map(|(joint, stands)| {
            let given = joint.given.iter().zip(stands);
            given.map(|(given, stands)| given.filter(|_| !stands).unwrap_or(0.0)).collect()
        })
        .collect();
    let mut durations_s = durations(joints, &speeds)?;
    for _ in 0..ROUNDS {
        for ((joint, stands), speeds) in joints.iter().zip(&stands).zip(&mut speeds) {
            *speeds = mean_speeds(joint, stands, &durations_s);
        }
        durations_s = durations(joints, &speeds)?;
    }
    let mut curves = Vec::new();
    for (axis, (joint, speeds)) in joints.iter().zip(&speeds).enumerate() {
        let mut curve = Phases::new(joint.positions.first().copied().unwrap_or(0.0), 0.0, []);
        for (index, (section, duration_s)) in joint.sections(speeds).into_iter().zip(&durations_s).enumerate()
        {
            let section_curve = joint.curve(section, *duration_s);
            let section_curve = section_curve.map_err(|kind| Misfit { axis, section: index + 1, kind })?;
            curve.append(&section_curve, *duration_s);
        }
        let end = joint.positions.last().copied().unwrap_or(0.0);
        curves.push(curve.with_end(end));
    }
    Ok(Course { durations_s, speeds, curves })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::phases::State;

    #[test]
    fn two_axes_pass_three_points_together() {
        let joint = |positions: [f64; 3], [speed, acceleration, deceleration, jerk]: [f64; 4]| Joint {
            positions: core::iter::once(0.0).chain(positions).collect(),
            given: [None; 4].into(),
            limits: MoveLimits { speed, acceleration, deceleration, jerk },
        };
        let joints = [
            joint([1000.0, 1500.0, 1200.0], [4000.0, 20_000.0, 30_000.0, 400_000.0]),
            joint([-50.0, -400.0, -900.0], [1000.0, 8000.0, 5000.0, 60_000.0]),
        ];
        let course = course(&joints).expect("it fits");
        let near = |found: &[f64], expected: &[f64], error: f64| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < error), "{found:?} {expected:?}");
        };
        near(&course.durations_s, &[0.405_105, 0.448_805, 0.655_801], 1e-6);
        near(&course.speeds[0], &[0.0, 2203.2718, 0.0, 0.0], 1e-4);
        near(&course.speeds[1], &[0.0, -245.1274, -771.1451, 0.0], 1e-4);
        let section = joints[1].sections(&course.speeds[1])[0];
        near(&[joints[1].factor(section, course.durations_s[0])], &[0.465_682], 1e-6);
        for (joint, curve) in joints.iter().zip(&course.curves) {
            let mut at_s = 0.0;
            for (position, duration_s) in joint.positions[1..].iter().zip(&course.durations_s) {
                at_s += duration_s;
                near(&[curve.state(at_s).position], &[*position], 1e-7);
            }
        }
    }

    fn joint(positions: &[f64], given: &[Option<f64>]) -> Joint {
        let limits = MoveLimits { speed: 1000.0, acceleration: 10_000.0, deceleration: 8000.0, jerk: 2e5 };
        Joint { positions: positions.into(), given: given.into(), limits }
    }

    #[test]
    fn given_speeds_are_kept_or_refused_with_their_numbers() {
        let lead = joint(&[0.0, 300.0, 600.0], &[None, Some(700.0), None]);
        let both = course(&[lead.clone(), joint(&[0.0, -150.0, -300.0], &[None; 3])]).expect("it fits");
        assert_eq!(both.speeds[0], [0.0, 700.0, 0.0]);
        // Twice the mean speed, because the axis stands at the other ends of both sections.
        let mean = [0, 1].map(|section| 2.0 * 150.0 / both.durations_s[section]);
        assert!((both.speeds[1][1] + mean[0].min(mean[1])).abs() < 1.0, "{:?} {mean:?}", both.speeds);
        let stop = course(&[joint(&[0.0, 300.0, 600.0], &[None, Some(0.0), None])]).expect("it fits");
        let limits = lead.limits;
        let alone_s = limits.duration_s(300.0, 0.0, 0.0).expect("it fits");
        assert_eq!(stop.durations_s, [alone_s; 2]);

        // 10 steps are too short to reach 700 steps/s.
        let short = course(&[joint(&[0.0, 10.0, 600.0], &[None, Some(700.0), None])]).map(|_| ());
        let needed = limits.ramp_steps(0.0, 700.0);
        let kind = MisfitKind::TooShort { steps: 10.0, needed, from: 0.0, to: 700.0 };
        assert_eq!(short, Err(Misfit { axis: 0, section: 1, kind }));
        // The first axis takes so long that the second one could not keep its speeds.
        let slow = joint(&[0.0, 1.0, 2000.0, 2001.0], &[None; 4]);
        let fast = joint(&[0.0, 300.0, 400.0, 700.0], &[None, Some(800.0), Some(800.0), None]);
        let Err(Misfit { axis: 1, section: 2, kind: MisfitKind::TooSlow { duration_s, max_s, from, to } }) =
            course(&[slow, fast]).map(|_| ())
        else {
            panic!("the section is too slow");
        };
        assert_eq!((max_s, from, to), (0.125, 800.0, 800.0));
        assert!(duration_s > 1.9, "{duration_s}");
    }

    #[test]
    fn an_axis_that_rests_has_no_distance_in_the_section() {
        let axes =
            [joint(&[5.0, 305.0, 305.0, 100.0], &[None; 4]), joint(&[0.0, 10.0, 200.0, 400.0], &[None; 4])];
        let course = course(&axes).expect("it fits");
        assert_eq!(course.speeds[0], [0.0; 4]);
        let [first_s, second_s, _] = course.durations_s[..] else { panic!("three sections") };
        for part in 0..=10 {
            let state = course.curves[0].state(first_s + second_s * f64::from(part) / 10.0);
            assert!((state.position - 305.0).abs() < 1e-9 && state.speed.abs() < 1e-6, "{state:?}");
        }
        let total_s: f64 = course.durations_s.iter().sum();
        for (curve, end) in course.curves.iter().zip([100.0, 400.0]) {
            assert!((curve.duration_s() - total_s).abs() < 1e-12 && curve.end().position == end);
        }
        // No axis exceeds its limits, and the second one passes its points without stopping.
        for curve in &course.curves {
            for part in 0..=2000 {
                let State { speed, acceleration, .. } = curve.state(total_s * f64::from(part) / 2000.0);
                assert!(speed.abs() <= 1000.0 + 1e-6 && acceleration.abs() <= 10_000.0 + 1e-3);
            }
        }
        assert!(course.speeds[1][1] > 0.0 && course.speeds[1][2] > 0.0, "{:?}", course.speeds);
    }
}
