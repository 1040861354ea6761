//! Moves between speeds, new targets, groups and input shapers: from the JSON of a scenario to the cycles of steps.

use stepscope_core::{
    motion::{AxisPlan, ScheduledStep, shaper::train_residual},
    sim::Experiment,
};

const CLOCK_HZ: u32 = 16_000_000;

/// The plans of the axes of a motion.
fn plans(motion: &str) -> Result<Vec<AxisPlan>, Vec<String>> {
    let json =
        format!(r#"{{"bus":{{"channels":2}},"source":{{"motion":{{"engine":"segments",{motion}}}}}}}"#);
    match Experiment::from_json(&json) {
        Ok(experiment) => Ok(experiment.plans().to_vec()),
        Err(problems) => Err(problems.iter().map(ToString::to_string).collect()),
    }
}

fn plan(axis: &str) -> AxisPlan {
    plans(&format!(r#""axes":[{axis}]"#)).expect(axis).remove(0)
}

fn steps(plan: &AxisPlan) -> Vec<ScheduledStep> {
    plan.due_steps(CLOCK_HZ).collect()
}

fn limits(speed: f64, acceleration: f64, jerk: f64) -> String {
    format!(
        r#""limits":{{"max_speed":{{"steps_s":{speed}}},"max_acceleration":{{"steps_s2":{acceleration}}},"max_jerk":{{"steps_s3":{jerk}}}}}"#
    )
}

fn jerk_limited(steps: i64, more: &str) -> String {
    format!(
        r#"{{"jerk_limited":{{"distance":{{"steps":{steps}}},"max_speed":{{"steps_s":4000}},"max_acceleration":{{"steps_s2":20000}},"max_jerk":{{"steps_s3":400000}}{more}}}}}"#
    )
}

#[track_caller]
fn near(found: f64, expected: f64, error: f64) {
    assert!((found - expected).abs() <= error, "{found}, expected {expected}");
}

/// Step `k` (from 1) and its cycle, to within one cycle.
#[track_caller]
fn step_at(plan: &AxisPlan, k: usize, cycle: u64) {
    let found = steps(plan)[k - 1].cycle;
    assert!(found.abs_diff(cycle) <= 1, "step {k} in cycle {found}, expected {cycle}");
}

const TRAPEZOID: &str = r#"{"moves":[{"trapezoid":{"distance":{"steps":2000},"start_speed":{"steps_s":250},"end_speed":{"steps_s":1000},"max_speed":{"steps_s":4000},"max_acceleration":{"steps_s2":9000},"deceleration":{"steps_s2":6000},"method":"exact"}}]}"#;
const COSINE: &str = r#"{"moves":[{"cosine":{"distance":{"steps":3200},"duration_s":0.4,"ramp_s":0.2,"start_speed":{"steps_s":1089},"end_speed":{"steps_s":1042}}}]}"#;
const BETWEEN: &str = r#"{"moves":[{"jerk_limited":{"distance":{"steps":3200},"max_speed":{"steps_s":10000},"max_acceleration":{"steps_s2":100000},"max_deceleration":{"steps_s2":50000},"max_jerk":{"steps_s3":2e6},"start_speed":{"steps_s":2000},"end_speed":{"steps_s":1000}}}]}"#;

#[test]
fn moves_between_two_speeds_have_the_times_of_their_ramps() {
    let trapezoid = plan(TRAPEZOID);
    near(trapezoid.peaks().speed, 3876.2095, 1e-4);
    near(trapezoid.duration_s(), 0.882_280_414, 1e-9);
    step_at(&trapezoid, 1001, 7_170_569);
    let jerk_limited = plan(BETWEEN);
    near(jerk_limited.duration_s(), 0.464_25, 1e-12);
    step_at(&jerk_limited, 1601, 3_392_800);
    let cosine = plan(COSINE);
    near(cosine.peaks().speed, 14_934.5, 1e-6);
    step_at(&cosine, 1067, 2_610_953);
    for (plan, count) in [(trapezoid, 2000), (jerk_limited, 3200), (cosine, 3200)] {
        assert_eq!((steps(&plan).len(), plan.steps()), (count, count as i64));
    }
}

#[test]
fn a_mirrored_move_has_the_same_cycles_to_the_left() {
    for axis in [TRAPEZOID, COSINE, BETWEEN] {
        let left = axis.replace(r#""steps":"#, r#""steps":-"#);
        let (right, left) = (steps(&plan(axis)), steps(&plan(&left)));
        let mirrored: Vec<_> = left.iter().map(|step| (step.cycle, !step.right)).collect();
        assert_eq!(right.iter().map(|step| (step.cycle, step.right)).collect::<Vec<_>>(), mirrored);
    }
}

#[test]
fn a_move_reversed_in_time_swaps_its_speeds_and_limits() {
    let forth = plan(BETWEEN);
    let swapped = BETWEEN
        .replace("max_acceleration", "max_x")
        .replace("max_deceleration", "max_acceleration")
        .replace("max_x", "max_deceleration")
        .replace("start_speed", "first")
        .replace("end_speed", "start_speed")
        .replace("first", "end_speed");
    let back = plan(&swapped);
    let end = forth.duration_s() * f64::from(CLOCK_HZ);
    for (forth, back) in steps(&forth).iter().zip(steps(&back).iter().rev()) {
        near(forth.cycle as f64, end - back.cycle as f64, 1.0);
    }
}

#[test]
fn a_move_starts_at_the_end_speed_of_the_previous_one() {
    let end = r#","end_speed":{"steps_s":2000}"#;
    let stop = r#","start_speed":{"steps_s":0}"#;
    let check = |moves: &[String], jump: f64| {
        let axis = format!(r#"{{"moves":[{}]}}"#, moves.join(","));
        near(plan(&axis).peaks().jump, jump, 1e-6);
    };
    check(&[jerk_limited(1000, end), jerk_limited(1000, "")], 0.0);
    check(&[jerk_limited(1000, end), jerk_limited(1000, stop)], 2000.0);
    check(&[jerk_limited(-1000, end), jerk_limited(-1000, "")], 0.0);
    let trapezoid = r#"{"trapezoid":{"distance":{"steps":500},"start_speed":null,"method":"exact"}}"#;
    check(&[jerk_limited(1000, end), trapezoid.into()], 0.0);
}

#[test]
fn a_new_target_continues_from_any_state() {
    let cut = |at_s: f64, target: &str| format!(r#"{{"retarget":{{"at_s":{at_s},"target":{target}}}}}"#);
    let axis = |moves: &[String]| {
        plan(&format!(r#"{{{},"moves":[{}]}}"#, limits(4000.0, 20_000.0, 400_000.0), moves.join(",")))
    };
    let overshoot = axis(&[jerk_limited(3000, ""), cut(0.4, r#"{"position":{"steps":1000}}"#)]);
    near(overshoot.duration_s(), 1.0, 1e-9);
    assert_eq!((overshoot.steps(), overshoot.step_count()), (1000, 1598 + 598));
    step_at(&overshoot, 2196, 15_686_811);
    near(overshoot.position(0.4 + 1e-9), 900.0, 1e4);

    let more = r#","max_acceleration":{"steps_s2":10000},"max_deceleration":{"steps_s2":40000}"#;
    let other = cut(0.4, r#"{"position":{"steps":0}}"#).replace("}}}}", &format!("}}}}{more}}}}}"));
    let back = axis(&[jerk_limited(3000, ""), other]);
    near(back.duration_s(), 0.4 + 0.852_099_609, 1e-9);
    step_at(&back, 2992, 19_720_404);

    let speed = cut(0.3, r#"{"speed":{"speed":{"steps_s":-2500},"hold_s":0.3}}"#);
    let twice = axis(&[jerk_limited(2000, ""), speed, cut(0.6, r#"{"position":{"steps":0}}"#)]);
    near(twice.duration_s(), 1.147_235_654, 1e-9);
    assert_eq!(twice.steps(), 0);
    assert_eq!(twice.step_count(), 2 * 1198);
}

#[test]
fn a_move_after_a_stop_between_two_steps_ends_on_a_whole_step() {
    let moves = [
        jerk_limited(3000, ""),
        r#"{"retarget":{"at_s":0.3,"target":{"stop":{}}}}"#.into(),
        jerk_limited(100, ""),
        r#"{"cosine":{"distance":{"steps":-100}}}"#.into(),
    ];
    let stopped = plan(&format!(r#"{{"moves":[{}]}}"#, moves[..2].join(",")));
    let rest = stopped.position(stopped.duration_s());
    assert!(rest != rest.round() && stopped.steps() == (rest + 0.5).floor() as i64, "{rest}");
    let all = plan(&format!(r#"{{"moves":[{}]}}"#, moves.join(",")));
    assert_eq!(all.steps(), stopped.steps());
    let turn = &all.moves()[3];
    near(all.position(turn.start_s), (stopped.steps() + 100) as f64, 1e-9);
    assert_eq!(steps(&all).len() as u64, all.step_count());
}

#[test]
fn moves_of_a_group_end_together() {
    let cosine = r#"{"cosine":{"distance":{"steps":-2000},"duration_s":0.5,"ramp_s":0.2}}"#;
    let group = format!(
        r#""axes":[{{"moves":[]}},{{"moves":[]}}],"groups":[{{"time":{{"moves":[{{"axis":0,"move":{}}},{{"axis":1,"move":{cosine}}}]}}}}]"#,
        jerk_limited(3200, "")
    );
    let axes = plans(&group).expect("plans");
    assert_eq!((axes[0].duration_s(), axes[1].duration_s()), (1.05, 1.05));
    step_at(&axes[1], 1, 517_723);
    assert_eq!((axes[0].steps(), axes[1].steps()), (3200, -2000));
}

#[test]
fn axes_of_a_line_stay_on_it() {
    let axes = format!(
        r#""axes":[{{{},"moves":[]}},{{{},"moves":[]}}],"groups":[{{"line":{{"distances":[{{"steps":3000}},{{"steps":-1200}}]}}}}]"#,
        limits(4000.0, 20_000.0, 400_000.0),
        limits(1000.0, 30_000.0, 900_000.0)
    );
    let axes = plans(&axes).expect("plans");
    for (axis, speed) in axes.iter().zip([2500.0, 1000.0]) {
        near(axis.duration_s(), 1.375, 1e-12);
        near(axis.peaks().speed, speed, 1e-6);
    }
    step_at(&axes[1], 401, 7_808_000);
    for part in 0..100 {
        let t = 1.375 * f64::from(part) / 100.0;
        near(axes[0].position(t) / 3000.0, axes[1].position(t) / -1200.0, 1e-12);
    }
}

#[test]
fn axes_pass_way_points_together() {
    let limits = |speed: u32, up: u32, down: u32, jerk: u32| {
        format!(
            r#"{{"limits":{{"max_speed":{{"steps_s":{speed}}},"max_acceleration":{{"steps_s2":{up}}},"max_deceleration":{{"steps_s2":{down}}},"max_jerk":{{"steps_s3":{jerk}}}}},"moves":[]}}"#
        )
    };
    let points = [(1000, -50), (1500, -400), (1200, -900)];
    let json: Vec<String> =
        points.iter().map(|(x, y)| format!(r#"{{"positions":[{{"steps":{x}}},{{"steps":{y}}}]}}"#)).collect();
    let motion = format!(
        r#""axes":[{},{}],"groups":[{{"way_points":{{"points":[{}]}}}}]"#,
        limits(4000, 20_000, 30_000, 400_000),
        limits(1000, 8000, 5000, 60_000),
        json.join(",")
    );
    let axes = plans(&motion).expect("plans");
    let (mut at_s, speeds) = (0.0, [(2203.2718, -245.1274), (0.0, -771.1451), (0.0, 0.0)]);
    for (((x, y), (vx, vy)), duration_s) in points.iter().zip(speeds).zip([0.405_105, 0.448_805, 0.655_801]) {
        at_s += duration_s;
        for (axis, position, speed) in [(&axes[0], *x, vx), (&axes[1], *y, vy)] {
            near(axis.position(at_s), f64::from(position), 0.01);
            near(axis.speed(at_s - 1e-6), speed, 0.5);
        }
    }
    near(axes[0].duration_s(), axes[1].duration_s(), 1e-12);
}

#[test]
fn an_input_shaper_lengthens_the_move_and_reduces_vibration() {
    let moves = r#""moves":[{"jerk_limited":{"distance":{"steps":400},"max_speed":{"steps_s":8000},"max_acceleration":{"steps_s2":200000},"max_jerk":{"steps_s3":2e7}}}]"#;
    let shaper = r#""input_shaper":{"mzv":{"frequency_hz":45,"damping_ratio":0.1}}"#;
    let (plain, shaped) = (plan(&format!("{{{moves}}}")), plan(&format!("{{{shaper},{moves}}}")));
    near(shaped.duration_s(), 0.116_750_630, 1e-9);
    assert_eq!(steps(&shaped).len(), 400);
    step_at(&shaped, 400, 1_728_732);
    let residual = |plan: &AxisPlan| {
        let times = steps(plan).into_iter().map(|step| (step.cycle as f64 / f64::from(CLOCK_HZ), step.right));
        train_residual(times, plan.duration_s(), 36.0, 0.1)
    };
    near(residual(&shaped), 0.5944, 1e-4);
    near(residual(&plain), 3.7457, 1e-4);
}

/// Ticks and segments of one plan have the same steps.
#[test]
fn steps_due_by_a_cycle_are_those_of_earlier_cycles() {
    let shaper = r#""input_shaper":{"zvd":{"frequency_hz":20,"damping_ratio":0.05}}"#;
    let retarget = r#"{"retarget":{"at_s":0.2,"target":{"position":{"steps":-50}},"profile":"trapezoid"}}"#;
    let sine = r#"{"sine":{"amplitude":{"steps":100},"period_s":0.2,"periods":2}}"#;
    let cut_sine = r#"{"retarget":{"at_s":0.33,"target":{"stop":{}}}}"#;
    let axes = [
        TRAPEZOID.to_string(),
        COSINE.to_string(),
        BETWEEN.to_string(),
        format!(r#"{{"moves":[{},{retarget}]}}"#, jerk_limited(900, "")),
        format!(r#"{{"moves":[{sine},{cut_sine}]}}"#),
        format!(r#"{{{shaper},"moves":[{},{sine},{}]}}"#, jerk_limited(900, ""), jerk_limited(-900, "")),
    ];
    for axis in axes {
        let plan = plan(&axis);
        let steps = steps(&plan);
        assert!(steps.is_sorted_by_key(|step| step.cycle), "{axis}");
        let (mut due_by, mut position, mut next) = (plan.due_by(CLOCK_HZ), 0_i64, 0);
        let end = (plan.duration_s() * f64::from(CLOCK_HZ)) as u64;
        for cycle in (0..end + 4000).step_by(3001) {
            while let Some(step) = steps.get(next).filter(|step| step.cycle < cycle) {
                position += if step.right { 1 } else { -1 };
                next += 1;
            }
            let soon = steps[next..].iter().take_while(|step| step.cycle <= cycle).count() as u64;
            let due = due_by.steps(cycle);
            assert!(due.abs_diff(position) <= soon, "{axis}: {due} by {cycle}, {position}");
            let ideal = plan.position(cycle as f64 / f64::from(CLOCK_HZ));
            near(due as f64, ideal, 0.51);
        }
        assert_eq!(due_by.steps(u64::MAX), plan.steps());
    }
}

/// Axes or motions, and their problems.
#[test]
fn errors_state_the_value_and_the_allowed_range() {
    let end = r#","end_speed":{"steps_s":2000}"#;
    let axis = |text: String| format!(r#""axes":[{text}]"#);
    let moves = |moves: &[String]| axis(format!(r#"{{"moves":[{}]}}"#, moves.join(",")));
    let stop = |at_s: f64| format!(r#"{{"retarget":{{"at_s":{at_s},"target":{{"stop":{{}}}}}}}}"#);
    let short = r#"{"trapezoid":{"distance":{"steps":100},"start_speed":{"steps_s":5000},"end_speed":{"steps_s":1000},"max_speed":{"steps_s":5000},"max_acceleration":{"steps_s2":100000},"method":"exact"}}"#;
    let rows = [
        (
            moves(&[short.into()]),
            "source.motion.axes[0].moves[0].trapezoid.distance: 100 steps are too short to slow down from 5000 to 1000 steps/s: that takes 120 steps at 100000 steps/s^2; use at least 120 steps",
        ),
        (
            moves(&[jerk_limited(1000, end), jerk_limited(-1000, "")]),
            "source.motion.axes[0].moves[1].jerk_limited.start_speed: a speed of 2000 steps/s points against the travel of -1000 steps; use a speed of 0, or retarget",
        ),
        (
            moves(&[jerk_limited(1000, r#","end_speed":{"steps_s":5000}"#)]),
            "source.motion.axes[0].moves[0].jerk_limited.end_speed: 5000 steps/s is above the maximum speed of 4000 steps/s; use at most 4000 steps/s",
        ),
        (
            moves(&[jerk_limited(1000, r#","start_speed":{"steps_s":-1}"#)]),
            "source.motion.axes[0].moves[0].jerk_limited.start_speed: -1 steps/s is out of range; use 0 to 10000000 steps/s",
        ),
        (
            moves(&[COSINE.replace("3200", "200").replace(r#"{"moves":["#, "").replace("]}", "")]),
            "source.motion.axes[0].moves[0].cosine.distance: 200 steps from 1089 to 1042 steps/s need a plateau of -65.5 steps/s, which is not above 0; use more than 214 steps, or shorter ramps",
        ),
        (
            axis(format!(
                r#"{{"limits":{{"start_stop_speed":{{"steps_s":1000}}}},"moves":[{}]}}"#,
                jerk_limited(1000, end)
            )),
            "source.motion.axes[0].moves[0]: the speed jumps from 2000 to 0 steps/s at the end of the move, and 2000 steps/s is above the start-stop speed of 1000 steps/s; use a jump of at most 1000 steps/s, or a higher start-stop speed",
        ),
        (
            moves(&[stop(0.1)]),
            "source.motion.axes[0].moves[0].retarget: there is no previous move to retarget; use a move before it",
        ),
        (
            moves(&[jerk_limited(3200, ""), stop(2.0)]),
            "source.motion.axes[0].moves[1].retarget.at_s: a cut at 2 s is after the end of the previous move, which takes 1.05 s; use at most 1.05 s",
        ),
        (
            moves(&[jerk_limited(3200, ""), stop(0.0)]),
            "source.motion.axes[0].moves[1].retarget.at_s: 0 s is out of range; use 1e-9 to 86400 s",
        ),
        (
            moves(&[r#"{"staircase":{}}"#.into(), stop(0.1)]),
            "source.motion.axes[0].moves[1].retarget: a move that follows a table cannot be cut; use the exact method before it",
        ),
        (
            axis(r#"{"input_shaper":{"ei":{}},"moves":[{"trapezoid":{}}]}"#.into()),
            "source.motion.axes[0].moves[0]: a move that follows a table cannot be shaped; use the exact method, or no input shaper",
        ),
        (
            axis(r#"{"input_shaper":{"ei":{"damping_ratio":0.5}}}"#.into()),
            "source.motion.axes[0].input_shaper.ei.damping_ratio: 0.5 is out of range; use 0 to 0.4",
        ),
        (
            format!(
                r#""axes":[{{"moves":[]}}],"groups":[{{"time":{{"duration_s":0.5,"moves":[{{"axis":0,"move":{}}}]}}}}]"#,
                jerk_limited(3200, "")
            ),
            "source.motion.groups[0].time.duration_s: 0.5 s are too short for the slowest move, which takes 1.05 s; use at least 1.05 s, or null",
        ),
        (
            r#""axes":[{"moves":[]}],"groups":[{"line":{"distances":[{"steps":10},{"steps":20}]}}]"#.into(),
            "source.motion.groups[0].line.distances: 2 entries; use 1",
        ),
        (
            r#""axes":[{"moves":[]}],"groups":[{"line":{"distances":[{"steps":0}]}}]"#.into(),
            "source.motion.groups[0].line.distances: 0 steps is less than one step; use at least one step, or a dwell",
        ),
        (
            r#""axes":[{"moves":[]}],"groups":[{"way_points":{"points":[{"positions":[{"steps":100}],"speeds":[{"steps_s":100}]}]}}]"#.into(),
            "source.motion.groups[0].way_points.points[0].speeds[0]: 100 steps/s is given at a point where the axis starts, ends, reverses or rests; use 0 or null",
        ),
    ];
    for (motion, expected) in rows {
        assert_eq!(plans(&motion).expect_err(&motion), [expected], "{motion}");
    }
}
