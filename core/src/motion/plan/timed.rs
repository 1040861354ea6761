//! Plans the moves of so many steps in so much time: the cosine S-curve and ramps of other shapes (DESIGN B4).

use super::{Left, MOST_SLICES, hold_speed};
use crate::{
    motion::{
        MOST_SPEED, Profile,
        asked::Asked,
        cosine::Cosine,
        ramp::Ramp,
        ramps::Ramps,
        sliced::{NotSliced, Sliced},
    },
    scenario::{self, Cause, CosineMethod, Distance, RampShape},
};
use alloc::format;

/// Lengths of a slice in s.
const LEAST_SLICE_S: f64 = 1e-5;
const MOST_SLICE_S: f64 = 0.1;
/// A slice's length is a decimal number and seldom whole in binary digits, so a rate that is exactly the highest may
/// come out higher by its last digits, in parts of it.
const DIGITS: f64 = 1e-12;
/// Ramps in s under this are none: it is the shortest cycle that a clock may have.
const LEAST_RAMP_S: f64 = 1e-9;
/// How much of its curve a ramp of a sigmoid or an exponential may be: below this it is straight to a part in a
/// thousand, above it stands still but for a small part of its time.
const LEAST_PARAMETER: f64 = 0.1;
const MOST_PARAMETER: f64 = 20.0;

pub(super) fn plan_cosine(
    asked: &mut Asked<'_>,
    given: &scenario::Cosine,
    path: &str,
    left: &mut Left,
) -> Option<Profile> {
    let front = front(asked, path, &given.distance, given.duration_s, given.ramp_s);
    let slice_s = match given.method {
        CosineMethod::Sliced => {
            let range = (LEAST_SLICE_S, MOST_SLICE_S);
            asked.range(format!("{path}.slice_s"), given.slice_s, range.0, range.1, "s")
        }
        CosineMethod::Exact => Some(0.0),
    };
    let (steps, duration_s, ramp_s) = front?;
    let slice_s = slice_s?;
    let curve = Cosine::new(steps, duration_s, ramp_s);
    hold_speed(asked, format!("{path}.duration_s"), curve.top_speed())?;
    if given.method == CosineMethod::Exact {
        return Some(Profile::Cosine(curve));
    }
    let cause = match Sliced::new(steps, duration_s, ramp_s, slice_s, left.slices) {
        Ok(curve) => {
            left.slices -= curve.slice_count();
            let rate = curve.top_rate();
            let rate = if rate <= MOST_SPEED * (1.0 + DIGITS) { libm::fmin(rate, MOST_SPEED) } else { rate };
            hold_speed(asked, format!("{path}.duration_s"), rate)?;
            return Some(Profile::Sliced(curve));
        }
        Err(NotSliced::Slices { needed }) => {
            let given = (MOST_SLICES - left.slices).saturating_add(needed);
            Cause::TooMuch { given: given as f64, most: MOST_SLICES as f64, of: "slices" }
        }
        Err(NotSliced::TooShort { rate }) => Cause::SliceTooShort { rate, slice_s },
        Err(NotSliced::TooFew { slices }) => {
            Cause::SlicesTooFew { slices, slice_s, steps: steps.unsigned_abs(), rate: MOST_SPEED }
        }
    };
    asked.refuse(format!("{path}.slice_s"), cause);
    None
}

pub(super) fn plan_ramps(asked: &mut Asked<'_>, given: &scenario::Ramps, path: &str) -> Option<Profile> {
    let front = front(asked, path, &given.distance, given.duration_s, given.ramp_s);
    let mut parameter = |key: &str, value: f64| {
        asked.range(format!("{path}.{key}"), value, LEAST_PARAMETER, MOST_PARAMETER, "")
    };
    let ramp = match given.shape {
        RampShape::Sigmoid => Ramp::sigmoid(parameter("sigmoid_range", given.sigmoid_range)?),
        RampShape::Bezier => Ramp::Bezier,
        RampShape::Straight => Ramp::Straight,
        RampShape::Exponential => Ramp::exponential(parameter("time_constants", given.time_constants)?),
    };
    let (steps, duration_s, ramp_s) = front?;
    let curve = Ramps::new(steps, duration_s, ramp_s, ramp);
    hold_speed(asked, format!("{path}.duration_s"), curve.top_speed())?;
    Some(Profile::Ramps(curve))
}

/// B4's front: so many steps in so much time with two ramps, none where they are too short for any clock.
fn front(
    asked: &mut Asked<'_>,
    path: &str,
    distance: &Distance,
    duration_s: f64,
    ramp_s: f64,
) -> Option<(i64, f64, f64)> {
    let steps = asked.distance(format!("{path}.distance"), distance);
    let duration_s = asked.duration(format!("{path}.duration_s"), duration_s);
    let ramp_s = asked.pause(format!("{path}.ramp_s"), ramp_s);
    let (steps, duration_s, ramp_s) = (steps, duration_s?, ramp_s?);
    if ramp_s > duration_s / 2.0 {
        asked.refuse(format!("{path}.ramp_s"), Cause::RampTooLong { ramp_s, duration_s });
        return None;
    }
    Some((steps?, duration_s, if ramp_s < LEAST_RAMP_S { 0.0 } else { ramp_s }))
}

#[cfg(test)]
mod tests {
    use crate::{
        motion::{Curve, plan_axis},
        scenario::{Scenario, Source},
    };
    use alloc::{format, string::ToString, vec::Vec};

    fn check(json: &str, expected: &[&str]) {
        let text = format!(r#"{{"source":{{"motion":{{"axes":[{json}]}}}}}}"#);
        let Ok(Source::Motion(motion)) = Scenario::from_json(&text).map(|s| s.source) else {
            panic!("{json} does not read");
        };
        let plan = plan_axis(motion.axes.first().unwrap(), "axis");
        let found: Vec<_> = plan.err().unwrap_or_default().iter().map(ToString::to_string).collect();
        assert_eq!(found, expected, "{json}");
    }

    /// Else its acceleration and jerk would have no end.
    #[test]
    fn a_ramp_shorter_than_any_clocks_cycle_is_none() {
        let plan = |kind: &str, rest: &str, ramp_s: &str| {
            let json = format!(r#"{{"moves":[{{"{kind}":{{"ramp_s":{ramp_s}{rest}}}}}]}}"#);
            plan_axis(&serde_json::from_str(&json).unwrap(), "axis").unwrap()
        };
        for (kind, rest) in [
            ("cosine", ""),
            ("cosine", r#","method":"sliced""#),
            ("ramps", r#","shape":"sigmoid""#),
            ("ramps", r#","shape":"bezier""#),
            ("ramps", r#","shape":"straight""#),
            ("ramps", r#","shape":"exponential""#),
        ] {
            let none = plan(kind, rest, "0");
            for ramp_s in ["1e-300", "1e-200", "5e-324", "9.99e-10"] {
                assert_eq!(plan(kind, rest, ramp_s), none, "{kind}{rest} {ramp_s}");
            }
            let peaks = none.peaks();
            assert!(
                (peaks.jump, peaks.acceleration, peaks.jerk) == (8000.0, 0.0, 0.0) || rest.contains("sliced")
            );
            let least = plan(kind, rest, "1e-9");
            let peaks = least.moves()[0].profile.peaks();
            assert!(least != none && peaks.jerk.is_finite() && peaks.acceleration.is_finite(), "{peaks:?}");
        }
    }

    #[test]
    fn slices_may_have_the_highest_speed_exactly_and_no_more() {
        // In slices of 10 us, 30 us (the last is of 10 us), 10 ms and 70 ms.
        for (steps, duration_s, slice_s) in [
            (100_000, "0.01", "1e-5"),
            (100_000, "0.01", "3e-5"),
            (990_000_000, "99", "0.01"),
            (4_900_000, "0.49", "0.07"),
        ] {
            let cosine = |method: &str| {
                format!(
                    r#"{{"moves":[{{"cosine":{{"distance":{{"steps":{steps}}},"duration_s":{duration_s},"ramp_s":0,"method":"{method}","slice_s":{slice_s}}}}}]}}"#
                )
            };
            check(&cosine("exact"), &[]);
            check(&cosine("sliced"), &[]);
        }
        // 105.5 steps a slice are 105, so in the plateau each has to have 106.
        check(
            r#"{"moves":[{"cosine":{"distance":{"steps":10550},"duration_s":0.001055,"ramp_s":0,"method":"sliced","slice_s":1.055e-5}}]}"#,
            &[
                "axis.moves[0].cosine.duration_s: this needs 10047394 steps/s, at most 10000000 are allowed; give more time or less distance",
            ],
        );
    }

    #[test]
    fn every_problem_of_slices_and_shapes_is_told_with_its_path() {
        check(
            r#"{"moves":[{"cosine":{"distance":{"steps":0},"method":"sliced","slice_s":0}},{"cosine":{"slice_s":0}},{"cosine":{"distance":{"steps":100},"method":"sliced"}}]}"#,
            &[
                "axis.moves[0].cosine.distance: 0 steps is less than one step; give at least one step, or a dwell",
                "axis.moves[0].cosine.slice_s: 0 s is out of range; give 1e-5 to 0.1 s",
                "axis.moves[2].cosine.slice_s: at the top speed of 500 steps/s a slice of 0.001 s has 0.5 steps, so none would have one; give slices of at least 0.002 s, more distance or less time, or choose the exact method",
            ],
        );
        check(
            r#"{"moves":[{"cosine":{"distance":{"steps":100},"duration_s":0.1,"ramp_s":0.05,"method":"sliced","slice_s":0.1}},{"cosine":{"distance":{"steps":990000},"duration_s":99,"ramp_s":0,"method":"sliced"}},{"cosine":{"distance":{"steps":1e6},"duration_s":2,"method":"sliced"}}]}"#,
            &[
                "axis.moves[0].cosine.slice_s: slices of 0.1 s, of which there are 1, never have 100 steps together, not even at 10000000 steps/s: a slice has the rate of its start; give shorter slices, or choose the exact method",
                "axis.moves[2].cosine.slice_s: 101000 slices are more than one run may have; at most 100000 are allowed: give longer slices or less time, or choose the exact method",
            ],
        );
        check(
            r#"{"moves":[{"ramps":{"ramp_s":0.3,"sigmoid_range":21}},{"ramps":{"shape":"bezier","sigmoid_range":0,"time_constants":0}},{"ramps":{"shape":"exponential","sigmoid_range":0,"time_constants":0}},{"ramps":{"distance":{"steps":1e9}}}]}"#,
            &[
                "axis.moves[0].ramps.ramp_s: two ramps of 0.3 s do not fit in 0.4 s; give a ramp of at most 0.2 s",
                "axis.moves[0].ramps.sigmoid_range: 21 is out of range; give 0.1 to 20",
                "axis.moves[2].ramps.time_constants: 0 is out of range; give 0.1 to 20",
                "axis.moves[3].ramps.duration_s: this needs 5000000000 steps/s, at most 10000000 are allowed; give more time or less distance",
            ],
        );
    }
}
