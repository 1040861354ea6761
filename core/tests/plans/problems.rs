//! Problems of every kind of move, and limits that axes share.

use super::{axis, check};
use stepscope_core::motion::{AxisList, AxisPlan, Problems, Profile, plan_axis, plan_lists};

fn plan(json: &str) -> Result<AxisPlan, Problems> {
    plan_axis(&axis(json), "axis")
}

#[test]
fn every_problem_is_reported_with_its_path() {
    check("{}", &[]);
    check(r#"{"moves":[]}"#, &["axis.moves: 0 moves; use 1 to 64"]);
    check(
        r#"{"moves":[{"cosine":{"distance":{"mm":3},"duration_s":0,"ramp_s":-1}},{"dwell":{"duration_s":1e300}}]}"#,
        &[
            "axis.moves[0].cosine.distance: 3 mm is not available with rotary mechanics; use steps or other mechanics",
            "axis.moves[0].cosine.duration_s: 0 s is out of range; use 1e-6 to 86400 s",
            "axis.moves[0].cosine.ramp_s: -1 s is out of range; use 0 to 86400 s",
            "axis.moves[1].dwell.duration_s: 1e300 s is out of range; use 0 to 86400 s",
        ],
    );
    check(
        r#"{"moves":[{"cosine":{"duration_s":0.3,"ramp_s":0.2}},{"cosine":{"distance":{"steps":0.4}}},{"cosine":{"distance":{"steps":1e9}}}]}"#,
        &[
            "axis.moves[0].cosine.ramp_s: two ramps of 0.2 s do not fit in 0.3 s; use a ramp of at most 0.15 s",
            "axis.moves[1].cosine.distance: 0.4 steps is less than one step; use at least one step, or a dwell",
            "axis.moves[2].cosine.duration_s: the motion needs 5000000000 steps/s, above the maximum of 10000000; use more time or less distance",
        ],
    );
    check(
        r#"{"moves":[{"trapezoid":{"start_speed":{"steps_s":5000},"timer_hz":0}},{"trapezoid":{"timer_hz":3999}},{"trapezoid":{"start_speed":{"steps_s":0}}},{"trapezoid":{"start_speed":{"steps_s":0},"method":"exact"}}]}"#,
        &[
            "axis.moves[0].trapezoid.timer_hz: 0 Hz is out of range; use 1 to 4294967295 Hz",
            "axis.moves[0].trapezoid.max_speed: a top speed of 4000 steps/s is below the start speed of 5000 steps/s; use a higher top speed or a lower start speed",
            "axis.moves[1].trapezoid.timer_hz: a timer of 3999 Hz is too slow for 4000 steps/s; use at least 4000 Hz",
            "axis.moves[2].trapezoid.start_speed: 0 steps/s is out of range; use 0.5 to 10000000 steps/s",
        ],
    );
    check(
        r#"{"mechanics":{"wheel":{"microsteps":0,"radius_mm":-1}},"moves":[{"constant":{"distance":{"mm":1},"speed":{"steps_s":-2}}}]}"#,
        &[
            "axis.mechanics.wheel.microsteps: 0 is out of range; use 1 to 512",
            "axis.mechanics.wheel.radius_mm: -1 mm is out of range; use 1e-6 to 1000000 mm",
            "axis.moves[0].constant.speed: -2 steps/s is out of range; use 1e-6 to 10000000 steps/s",
        ],
    );
    check(
        r#"{"mechanics":{"direct":{"step_mm":0.5}},"moves":[{"sine_segments":{"amplitude":{"mm":1e9},"periods":0,"max_deviation":2}},{"sine_segments":{"amplitude":{"mm":50000},"period_s":0.01}}]}"#,
        &[
            "axis.moves[0].sine_segments.amplitude: 1000000000 mm is out of range; use -500000000 to 500000000 mm",
            "axis.moves[0].sine_segments.periods: 0 is out of range; use 1 to 1000000",
            "axis.moves[0].sine_segments.max_deviation: 2 is out of range; use 0 to 1",
            "axis.moves[1].sine_segments.period_s: the motion needs 61870287 steps/s, above the maximum of 10000000; use more time or less distance",
        ],
    );
}

#[test]
fn an_axis_has_bounds_on_time_and_tables() {
    check(
        r#"{"moves":[{"sine_segments":{"period_s":10,"periods":99999}},{"constant":{"speed":{"steps_s":0.01}}}]}"#,
        &["axis.moves: 1099990 seconds exceed the maximum of 1000000; use a shorter motion"],
    );
    let table = r#"{"trapezoid":{"distance":{"steps":1400000},"top_speed":{"steps_s":1e6},"acceleration":{"steps_s2":1}}}"#;
    let text = format!(r#"{{"moves":[{table},{table}]}}"#);
    check(
        &text,
        &[
            "axis.moves[1].trapezoid: 1400000 table rows exceed the maximum of 1000000; use a higher acceleration or a lower top speed",
        ],
    );
    let moves = format!(r#"{{"moves":[{}{{"dwell":{{}}}}]}}"#, r#"{"dwell":{}},"#.repeat(64));
    check(&moves, &["axis.moves: 65 moves; use 1 to 64"]);
}

#[test]
fn axes_share_the_bounds_on_tables_and_segments() {
    let problems = |each: &str, axes: usize| {
        let axes = vec![axis(each); axes];
        let list = AxisList { path: "source.motion.axes".into(), axes: &axes, groups: &[] };
        let found: Vec<_> = plan_lists([list]).err().into_iter().flatten().collect();
        found.iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    let table = r#"{"moves":[{"trapezoid":{"distance":{"steps":800000},"top_speed":{"steps_s":1e6},"acceleration":{"steps_s2":1}}}]}"#;
    assert_eq!(problems(table, 2), [""; 0]);
    assert_eq!(
        problems(table, 3),
        [
            "source.motion.axes[2].moves[0].trapezoid: 1200000 table rows exceed the maximum of 1000000; use a higher acceleration or a lower top speed",
        ]
    );
    let sine = r#"{"sine_segments":{"max_deviation":0}}"#;
    let sines = format!(r#"{{"moves":[{sine}{}]}}"#, format!(",{sine}").repeat(63));
    assert_eq!(problems(&sines, 2), [""; 0]);
    assert_eq!(problems(&sines, 3).len(), 64);
    assert_eq!(
        problems(&sines, 3)[0],
        "source.motion.axes[2].moves[0].sine_segments: 66048 sine segments exceed the maximum of 65536; use a larger maximum deviation or fewer sines"
    );
    // The paper's preset has six segments: a sweep of ten on each of 16 axes is within the limits.
    let sweep = sines.replace(r#""max_deviation":0"#, r#""max_deviation":0.0054"#);
    assert_eq!(problems(&sweep, 16), [""; 0]);
}

#[test]
fn the_table_of_sonobe_2011_is_reproduced_in_its_units() {
    let plan = plan(
        r#"{"mechanics":{"direct":{"step_mm":0.393}},"moves":[{"trapezoid":{"distance":{"mm":100},
        "start_speed":{"mm_s":100},"top_speed":{"mm_s":500},"acceleration":{"mm_s2":3500}}}]}"#,
    )
    .unwrap();
    let Profile::TrapezoidTable(table) = &plan.moves()[0].profile else { panic!("{plan:?}") };
    let rates: Vec<u64> = (0..8).map(|row| table.table().rate(row)).collect();
    assert_eq!(rates, [254, 287, 317, 344, 369, 392, 414, 435]);
    assert_eq!(plan.steps(), 254);
}

#[test]
fn moves_continue_in_time_and_position() {
    let plan = plan(
        r#"{"moves":[{"dwell":{"duration_s":0.5}},{"cosine":{"distance":{"steps":600},"duration_s":1,"ramp_s":0.5}},
        {"dwell":{"duration_s":0}},{"constant":{"distance":{"steps":-1000},"speed":{"steps_s":500}}}]}"#,
    )
    .unwrap();
    let starts: Vec<(f64, i64)> = plan.moves().iter().map(|m| (m.start_s, m.start_steps)).collect();
    assert_eq!(starts, [(0.0, 0), (0.5, 0), (1.5, 600), (1.5, 600)]);
    assert_eq!((plan.duration_s(), plan.steps()), (3.5, -400));
    // (t, position, speed)
    let rows = [
        (-1.0, 0.0, 0.0),
        (0.25, 0.0, 0.0),
        (1.0, 300.0, 1200.0),
        (1.5, 600.0, -500.0),
        (2.5, 100.0, -500.0),
        (3.5, -400.0, 0.0),
        (1e9, -400.0, 0.0),
    ];
    for (t, position, speed) in rows {
        assert!((plan.position(t) - position).abs() < 1e-9, "position at {t}");
        assert!((plan.speed(t) - speed).abs() < 1e-9, "speed at {t}");
        assert_eq!(plan.steps_due(t), position as i64, "steps due at {t}");
    }
    let peaks = plan.peaks();
    assert!((peaks.speed - 1200.0).abs() < 1e-9 && (peaks.jump - 500.0).abs() < 1e-9, "{peaks:?}");
    assert!((peaks.acceleration - 1200.0 * std::f64::consts::PI).abs() < 1e-9, "{peaks:?}");
}
