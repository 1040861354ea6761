//! Moves of a given number of steps in a given time (DESIGN B4).

use super::{axis, check, plan_axis};

#[test]
fn a_ramp_shorter_than_any_cycle_is_no_ramp() {
    let plan = |kind: &str, rest: &str, ramp_s: &str| {
        let json = format!(r#"{{"moves":[{{"{kind}":{{"ramp_s":{ramp_s}{rest}}}}}]}}"#);
        plan_axis(&axis(&json), "axis").unwrap()
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
fn slices_may_reach_but_not_exceed_the_maximum_speed() {
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
    // 105.5 steps per slice become 105, so each slice of the plateau must have 106.
    check(
        r#"{"moves":[{"cosine":{"distance":{"steps":10550},"duration_s":0.001055,"ramp_s":0,"method":"sliced","slice_s":1.055e-5}}]}"#,
        &[
            "axis.moves[0].cosine.duration_s: the motion needs 10047394 steps/s, above the maximum of 10000000; use more time or less distance",
        ],
    );
}

#[test]
fn every_problem_of_slices_and_shapes_has_its_path() {
    check(
        r#"{"moves":[{"cosine":{"distance":{"steps":0},"method":"sliced","slice_s":0}},{"cosine":{"slice_s":0}},{"cosine":{"distance":{"steps":100},"method":"sliced"}}]}"#,
        &[
            "axis.moves[0].cosine.distance: 0 steps is less than one step; use at least one step, or a dwell",
            "axis.moves[0].cosine.slice_s: 0 s is out of range; use 1e-5 to 0.1 s",
            "axis.moves[2].cosine.slice_s: a slice of 0.001 s has only 0.5 steps at the top speed of 500 steps/s; use slices of at least 0.002 s, more distance, less time or the exact method",
        ],
    );
    check(
        r#"{"moves":[{"cosine":{"distance":{"steps":100},"duration_s":0.1,"ramp_s":0.05,"method":"sliced","slice_s":0.1}},{"cosine":{"distance":{"steps":990000},"duration_s":99,"ramp_s":0,"method":"sliced"}},{"cosine":{"distance":{"steps":1e6},"duration_s":2,"method":"sliced"}}]}"#,
        &[
            "axis.moves[0].cosine.slice_s: 1 slice of 0.1 s cannot contain 100 steps, even at 10000000 steps/s, because a slice has the rate at its start; use shorter slices or the exact method",
            "axis.moves[2].cosine.slice_s: 101000 slices exceed the maximum of 100000; use longer slices, a shorter duration or the exact method",
        ],
    );
    check(
        r#"{"moves":[{"ramps":{"ramp_s":0.3,"sigmoid_range":21}},{"ramps":{"shape":"bezier","sigmoid_range":0,"time_constants":0}},{"ramps":{"shape":"exponential","sigmoid_range":0,"time_constants":0}},{"ramps":{"distance":{"steps":1e9}}}]}"#,
        &[
            "axis.moves[0].ramps.ramp_s: two ramps of 0.3 s do not fit in 0.4 s; use a ramp of at most 0.2 s",
            "axis.moves[0].ramps.sigmoid_range: 21 is out of range; use 0.1 to 20",
            "axis.moves[2].ramps.time_constants: 0 is out of range; use 0.1 to 20",
            "axis.moves[3].ramps.duration_s: the motion needs 5000000000 steps/s, above the maximum of 10000000; use more time or less distance",
        ],
    );
}
