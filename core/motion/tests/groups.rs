//! Groups and limits of an axis at their edges: from between two steps, with axes that stand still, and with jumps that are
//! just allowed.

use stepscope_motion::{
    AxisList, AxisPlan, Problems,
    groups::{Group, GroupMove, LineGroup, TimeGroup, WayPoint, WayPointGroup},
    mechanics::{Acceleration, Distance, Jerk, Speed},
    moves::{Axis, AxisLimits, Constant, JerkLimited, LimitedProfile, Move, Retarget},
    plan_axis, plan_lists,
};

fn steps(count: f64) -> Distance {
    Distance::Steps(count)
}

fn limits() -> AxisLimits {
    AxisLimits {
        max_speed: Speed::StepsPerSecond(4000.0),
        max_acceleration: Acceleration::StepsPerSecond2(20_000.0),
        max_jerk: Jerk::StepsPerSecond3(400_000.0),
        ..AxisLimits::default()
    }
}

/// An axis that stops between two steps.
fn between_steps() -> Axis {
    let first = JerkLimited {
        distance: steps(3000.0),
        max_speed: Speed::StepsPerSecond(4000.0),
        max_acceleration: Acceleration::StepsPerSecond2(20_000.0),
        max_jerk: Jerk::StepsPerSecond3(400_000.0),
        ..JerkLimited::default()
    };
    let stop = Retarget { at_s: 0.137, ..Retarget::default() };
    Axis { moves: vec![Move::JerkLimited(first), Move::Retarget(stop)], limits: limits(), ..Axis::default() }
}

fn standing() -> Axis {
    Axis { moves: Vec::new(), limits: limits(), ..Axis::default() }
}

fn plan(axes: &[Axis], groups: &[Group]) -> Result<Vec<AxisPlan>, Problems> {
    let mut plans = plan_lists([AxisList { path: "axes".into(), axes, groups }])?;
    Ok(plans.remove(0))
}

fn problems(axes: &[Axis], groups: &[Group]) -> Vec<String> {
    plan(axes, groups).expect_err("a problem").iter().map(ToString::to_string).collect()
}

fn line(distances: &[f64]) -> Group {
    let distances = distances.iter().map(|distance| steps(*distance)).collect();
    Group::Line(LineGroup { distances, ..LineGroup::default() })
}

#[test]
fn a_line_from_between_two_steps_ends_on_a_whole_step() {
    let start = plan(&[between_steps()], &[]).expect("a plan").remove(0);
    let rest = start.position(start.duration_s());
    assert!((rest - rest.round()).abs() > 0.05, "{rest}");
    for distance in [150.0, -70.0] {
        let groups = [line(&[distance, 400.0, 0.0])];
        let plans = plan(&[between_steps(), standing(), standing()], &groups).expect("a plan");
        let end_s = plans[0].duration_s();
        assert_eq!(plans[0].position(end_s), start.steps() as f64 + distance, "{distance}");
        assert_eq!((plans[0].steps(), plans[1].steps()), (start.steps() + distance as i64, 400));
        assert!(
            (plans[1].duration_s() - end_s).abs() < 1e-12 && plans[1].position(start.duration_s()) == 0.0
        );
        // The third axis has no part in it.
        assert_eq!((plans[2].steps(), plans[2].step_count()), (0, 0));
        // Both are as far on the line at any time.
        for part in 0..=20 {
            let t = start.duration_s() + (end_s - start.duration_s()) * f64::from(part) / 20.0;
            let travel = (plans[0].position(t) - rest) / (start.steps() as f64 + distance - rest);
            assert!((travel - plans[1].position(t) / 400.0).abs() < 1e-9, "{part}: {travel}");
        }
    }
}

#[test]
fn the_slowest_axis_limits_a_line() {
    // A line is as fast as its slowest axis allows: 1000 steps at 4000 steps/s, 20000 steps/s^2 and 400000 steps/s^3.
    let duration_s = |profile| {
        let distances = vec![steps(1000.0), steps(-10.0)];
        let groups = [Group::Line(LineGroup { distances, profile })];
        plan(&[standing(), standing()], &groups).expect("a plan")[0].duration_s()
    };
    assert!((duration_s(LimitedProfile::JerkLimited) - 0.5).abs() < 1e-9);
    assert!((duration_s(LimitedProfile::Trapezoid) - 0.45).abs() < 1e-9);
}

#[test]
fn groups_follow_one_another() {
    let plans = plan(&[standing(), standing()], &[line(&[100.0, 0.0]), line(&[0.0, 200.0])]).expect("a plan");
    let first_s = plan(&[standing(), standing()], &[line(&[100.0, 0.0])]).expect("a plan")[0].duration_s();
    assert_eq!(plans[1].position(first_s), 0.0);
    assert_eq!((plans[0].duration_s(), plans[0].steps(), plans[1].steps()), (first_s, 100, 200));
    assert!(plans[1].position(first_s + 0.05) > 1.0);
}

#[test]
fn way_points_are_absolute_and_keep_given_speeds() {
    let point = |position: f64, speed: Option<f64>| WayPoint {
        positions: vec![steps(position)],
        speeds: Some(vec![speed.map(Speed::StepsPerSecond)]),
    };
    let points = vec![point(1000.0, Some(900.0)), point(1300.0, None)];
    let plans = plan(&[between_steps()], &[Group::WayPoints(WayPointGroup { points })]).expect("a plan");
    let end_s = plans[0].duration_s();
    assert_eq!((plans[0].steps(), plans[0].position(end_s)), (1300, 1300.0));
    let at_s =
        (1..10_000).map(|part| end_s * f64::from(part) / 10_000.0).find(|t| plans[0].position(*t) >= 1000.0);
    let speed = plans[0].speed(at_s.expect("it passes the point"));
    assert!((speed - 900.0).abs() < 10.0, "{speed}");
}

#[test]
fn a_group_may_take_longer_but_not_shorter_than_its_moves() {
    let group = |duration_s: f64| {
        let moves = vec![GroupMove { axis: 0, r#move: Move::Constant(Constant::default()) }];
        [Group::Time(TimeGroup { duration_s: Some(duration_s), moves })]
    };
    // 1000 steps at 1000 steps/s.
    for duration_s in [1.0, 1.0 - 1e-13, 2.5] {
        let plans = plan(&[standing()], &group(duration_s)).expect("a plan");
        let made_s = duration_s.max(1.0);
        assert_eq!((plans[0].duration_s(), plans[0].peaks().speed), (made_s, 1000.0 / made_s));
    }
    let found = problems(&[standing()], &group(1.0 - 1e-9));
    assert!(found.len() == 1 && found[0].starts_with("groups[0].time.duration_s: "), "{found:?}");
}

#[test]
fn a_jump_may_be_as_high_as_the_start_stop_speed() {
    let jumps = |start_stop: f64, speeds: &[f64]| {
        let constant = |speed: &f64| {
            let distance = steps(if *speed < 0.0 { -500.0 } else { 500.0 });
            Move::Constant(Constant { distance, speed: Speed::StepsPerSecond(speed.abs()) })
        };
        let start_stop_speed = Some(Speed::StepsPerSecond(start_stop));
        let moves = speeds.iter().map(constant).collect();
        let axis = Axis { moves, limits: AxisLimits { start_stop_speed, ..limits() }, ..Axis::default() };
        plan_axis(&axis, "x").map_or_else(|problems| problems.len(), |_| 0)
    };
    // Start-stop speed, speeds of moves, and refused jumps: start, between moves, end.
    let rows: [(f64, &[f64], usize); 7] = [
        (1000.0, &[1000.0], 0),
        (999.5, &[1000.0], 2),
        (1000.0, &[1000.0, 1900.0, 950.0], 0),
        (899.0, &[800.0, 1700.0, 800.0], 2),
        // A reversal is a stop and a start.
        (1000.0, &[1000.0, -1000.0], 0),
        (999.0, &[900.0, -999.5], 2),
        (999.0, &[-999.5, 900.0], 2),
    ];
    for (start_stop, speeds, refused) in rows {
        assert_eq!(jumps(start_stop, speeds), refused, "{start_stop}: {speeds:?}");
    }
}

#[test]
fn what_a_group_cannot_do_is_refused_with_its_numbers() {
    let group_move = |axis, r#move| GroupMove { axis, r#move };
    let constant = || Move::Constant(Constant::default());
    let time = |moves| Group::Time(TimeGroup { duration_s: None, moves });
    let way_points = |points: &[(f64, Option<f64>)]| {
        let points = points.iter().map(|(position, speed)| WayPoint {
            positions: vec![steps(*position)],
            speeds: Some(vec![speed.map(Speed::StepsPerSecond)]),
        });
        Group::WayPoints(WayPointGroup { points: points.collect() })
    };
    let rows = [
        (time(vec![group_move(1, constant())]), "groups[0].time.moves[0].axis: 1 "),
        (
            time(vec![group_move(0, Move::Retarget(Retarget::default()))]),
            "groups[0].time.moves[0].move.retarget: ",
        ),
        (line(&[1.0, 2.0]), "groups[0].line.distances: "),
        (line(&[0.0]), "groups[0].line.distances: "),
        (way_points(&[]), "groups[0].way_points.points: "),
        (way_points(&[(0.0, None)]), "groups[0].way_points.points: "),
        (way_points(&[(100.0, None), (300.0, Some(50.0))]), "groups[0].way_points.points[1].speeds[0]: 50 "),
        (way_points(&[(100.0, Some(50.0)), (50.0, None)]), "groups[0].way_points.points[0].speeds[0]: 50 "),
        (
            way_points(&[(100.0, Some(-50.0)), (300.0, None)]),
            "groups[0].way_points.points[0].speeds[0]: a speed of -50 ",
        ),
        (
            way_points(&[(100.0, Some(4001.0)), (300.0, None)]),
            "groups[0].way_points.points[0].speeds[0]: 4001 ",
        ),
        (way_points(&[(1.0, Some(4000.0)), (3000.0, None)]), "groups[0].way_points.points[0].speeds[0]: "),
    ];
    for (group, expected) in rows {
        let found = problems(&[standing()], &[group]);
        assert!(found.len() == 1 && found[0].starts_with(expected), "{found:?}, expected {expected}");
    }
    let twice = time(vec![group_move(0, constant()), group_move(0, constant())]);
    let found = problems(&[standing(), standing()], &[twice]);
    assert!(found.len() == 1 && found[0].starts_with("groups[0].time.moves[1].axis: "), "{found:?}");
    // A given speed of 0 is a stop, also where the axis stands anyway.
    plan(&[standing()], &[way_points(&[(100.0, Some(0.0)), (300.0, Some(0.0))])]).expect("a plan");
}
