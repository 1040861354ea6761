//! Every curve agrees with its derivatives, its maxima and its steps (DESIGN B1): moves between speeds, cut, stretched by a
//! group, or shaped.

use stepscope_motion::{
    AxisList, AxisPlan, Curve, Profile,
    groups::{Group, GroupMove, TimeGroup},
    mechanics::{Acceleration, Distance, Speed},
    moves::{
        Axis, Constant, Cosine, Dwell, JerkLimited, Move, Point, Points, RampShape, Ramps, Retarget, Sine,
        Target, Trapezoid, TrapezoidMethod,
    },
    plan_axis, plan_lists,
    shaper::{InputShaper, ShaperSettings},
};

const CLOCK_HZ: u32 = 16_000_000;

fn steps(count: f64) -> Distance {
    Distance::Steps(count)
}

fn speed(steps_s: f64) -> Option<Speed> {
    Some(Speed::StepsPerSecond(steps_s))
}

fn moves() -> Vec<Move> {
    let ramps = |shape, start_speed, end_speed| {
        let (distance, duration_s, ramp_s) = (steps(-1500.0), 0.4, 0.15);
        let shaped = Ramps::shaped(shape, 5.0);
        Move::Ramps(Ramps { distance, duration_s, ramp_s, start_speed, end_speed, ..shaped })
    };
    let points = [(0.0, 0.0), (0.1, 300.0), (0.25, 150.0), (0.3, 160.0), (0.5, -250.0)];
    let points = points.map(|(time_s, position)| Point { time_s, position });
    vec![
        Move::Trapezoid(Trapezoid {
            distance: steps(1200.0),
            end_speed: speed(900.0),
            deceleration: Some(Acceleration::StepsPerSecond2(6000.0)),
            method: TrapezoidMethod::Exact,
            ..Trapezoid::default()
        }),
        Move::JerkLimited(JerkLimited {
            distance: steps(-1600.0),
            start_speed: speed(1000.0),
            end_speed: speed(300.0),
            ..JerkLimited::default()
        }),
        Move::Trapezoid(Trapezoid { method: TrapezoidMethod::Exact, ..Trapezoid::default() }),
        Move::JerkLimited(JerkLimited { distance: steps(800.0), ..JerkLimited::default() }),
        Move::Cosine(Cosine { start_speed: speed(1500.0), end_speed: speed(400.0), ..Cosine::default() }),
        Move::Cosine(Cosine { distance: steps(-900.0), ramp_s: 0.1, ..Cosine::default() }),
        ramps(RampShape::Sigmoid, None, None),
        ramps(RampShape::Bezier, speed(700.0), None),
        ramps(RampShape::Exponential, speed(100.0), speed(2000.0)),
        ramps(RampShape::Straight, None, speed(500.0)),
        Move::Sine(Sine { amplitude: steps(150.0), period_s: 0.2, periods: 3 }),
        Move::Points(Points { points: points.into(), ..Points::default() }),
        Move::Constant(Constant { distance: steps(300.0), ..Constant::default() }),
    ]
}

fn axis(moves: Vec<Move>) -> Axis {
    Axis { moves, ..Axis::default() }
}

/// Each move by itself, cut and retargeted, in a slower group, and shaped.
fn plans() -> Vec<(String, AxisPlan)> {
    let mut plans = Vec::new();
    for given in moves() {
        let alone = plan_axis(&axis(vec![given.clone()]), "x").expect("a valid move");
        let duration_s = alone.duration_s();
        for at_s in [0.23, 0.61].map(|part| part * duration_s) {
            let target = Target::Position(steps(-40.0));
            let retarget = Move::Retarget(Retarget { at_s, target, ..Retarget::default() });
            let plan = plan_axis(&axis(vec![given.clone(), retarget]), "x").expect("a valid target");
            plans.push((format!("cut at {at_s}: {given:?}"), plan));
        }
        let groups = [Group::Time(TimeGroup {
            duration_s: Some(1.7 * duration_s),
            moves: vec![GroupMove { axis: 0, r#move: given.clone() }],
        })];
        let axes = [axis(Vec::new())];
        let list = AxisList { path: "axes".into(), axes: &axes, groups: &groups };
        let plan = plan_lists([list]).expect("a valid group").remove(0).remove(0);
        plans.push((format!("stretched: {given:?}"), plan));
        let input_shaper = Some(InputShaper::Zvd(ShaperSettings { frequency_hz: 30.0, damping_ratio: 0.1 }));
        let twice = vec![given.clone(), Move::Dwell(Dwell { duration_s: 0.03 }), given.clone()];
        let shaped = Axis { input_shaper, ..axis(twice) };
        plans.push((format!("shaped: {given:?}"), plan_axis(&shaped, "x").expect("a valid shaper")));
        plans.push((format!("alone: {given:?}"), alone));
    }
    plans
}

fn profiles() -> impl Iterator<Item = (String, Profile)> {
    plans().into_iter().flat_map(|(name, plan)| {
        let profiles: Vec<Profile> = plan.moves().iter().map(|planned| planned.profile.clone()).collect();
        profiles.into_iter().map(move |profile| (name.clone(), profile))
    })
}

/// Breakpoints of all periods.
fn breakpoints_s(curve: &Profile) -> Vec<f64> {
    let first = curve.breakpoints_s();
    let (period_s, periods) = curve.repeats().unwrap_or((0.0, 0));
    let shifts = (0..=periods).map(|period| f64::from(period) * period_s);
    shifts.flat_map(|shift_s| first.iter().map(move |time_s| shift_s + time_s)).collect()
}

#[test]
fn speed_and_acceleration_are_derivatives_within_the_peaks() {
    for (name, curve) in profiles() {
        let (duration_s, peaks) = (curve.duration_s(), curve.peaks());
        let (dt, breaks) = (duration_s * 1e-6, breakpoints_s(&curve));
        let mut max = [0.0_f64; 2];
        let random = (0..1000).map(|part| (f64::from(part) + 0.37) / 1000.0 * duration_s);
        let beside = breaks.iter().flat_map(|at| [at - 3.0 * dt, at + 3.0 * dt]);
        let ends = [3.0 * dt, duration_s - 3.0 * dt];
        for t in random.chain(beside).chain(ends).filter(|t| *t > 2.0 * dt && *t < duration_s - 2.0 * dt) {
            if breaks.iter().any(|at| (at - t).abs() <= 2.0 * dt) {
                continue;
            }
            let slope = |of: &dyn Fn(f64) -> f64| (of(t + dt) - of(t - dt)) / (2.0 * dt);
            let (speed, acceleration) = (curve.speed(t), curve.acceleration(t));
            let off = slope(&|t| curve.position(t)) - speed;
            assert!(off.abs() <= 2e-5 * peaks.speed, "{name}: speed off by {off} at {t}");
            let off = slope(&|t| curve.speed(t)) - acceleration;
            assert!(
                off.abs() <= 1e-4 * peaks.acceleration + 1e-4,
                "{name}: acceleration off by {off} at {t}"
            );
            max = [max[0].max(speed.abs()), max[1].max(acceleration.abs())];
        }
        // The peaks of a shaped curve are read at three times per interval.
        let error = if matches!(curve, Profile::Shaped(_)) { 2e-3 } else { 1e-6 };
        for (max, peak) in max.into_iter().zip([peaks.speed, peaks.acceleration]) {
            assert!(max <= peak * (1.0 + error) + 1e-6, "{name}: {max} exceeds {peak}");
            assert!(max >= peak * 0.998, "{name}: {max} is below {peak}");
        }
    }
}

#[test]
fn peaks_have_the_jumps_at_breakpoints() {
    // A cut move has the jumps of the whole move, and a sine none.
    let without = |curve: &Profile| curve.repeats().is_some() || matches!(curve, Profile::Cut(_));
    for (name, curve) in profiles().filter(|(_, curve)| !without(curve)) {
        let (duration_s, peaks) = (curve.duration_s(), curve.peaks());
        let near_s = duration_s * 1e-9;
        let inside = 2.0 * near_s..duration_s - 2.0 * near_s;
        let (mut of_speed, mut of_acceleration) = (0.0_f64, 0.0_f64);
        for at in breakpoints_s(&curve).into_iter().filter(|at| inside.contains(at)) {
            let jump = |of: &dyn Fn(f64) -> f64| (of(at + near_s) - of(at - near_s)).abs();
            of_speed = of_speed.max(jump(&|t| curve.speed(t)));
            of_acceleration = of_acceleration.max(jump(&|t| curve.acceleration(t)));
        }
        assert!((of_speed - peaks.jump).abs() <= 1e-5 * peaks.speed, "{name}: {of_speed}, {peaks:?}");
        // Next to a jump the acceleration changes by the jerk.
        let off = (of_acceleration - peaks.acceleration_jump).abs();
        assert!(off <= 1e-3 * peaks.acceleration, "{name}: {of_acceleration}, {peaks:?}");
    }
}

#[test]
fn a_step_is_due_where_the_curve_crosses_its_half_integer() {
    for (name, plan) in plans() {
        let (mut position, mut count, mut due_by) = (0_i64, 0, plan.due_by(CLOCK_HZ));
        let clock = f64::from(CLOCK_HZ);
        for step in plan.due_steps(CLOCK_HZ) {
            let sign = if step.right { 1.0 } else { -1.0 };
            let half = position as f64 + sign / 2.0;
            let cycle = step.cycle as f64;
            let [before, after] =
                [cycle - 1.5, cycle + 1.5].map(|cycle| sign * (plan.position(cycle / clock) - half));
            assert!(
                before <= 1e-9 && after >= -1e-9,
                "{name}: step {count} from {position}: {before} {after}"
            );
            position += if step.right { 1 } else { -1 };
            count += 1;
            assert_eq!(due_by.steps(step.cycle + 1), position, "{name}: by cycle {}", step.cycle + 1);
        }
        assert_eq!((position, count), (plan.steps(), plan.step_count()), "{name}");
    }
}

#[test]
fn a_move_starts_and_ends_where_its_neighbors_do() {
    for (name, plan) in plans() {
        let mut end_s = 0.0;
        let mut end = (0.0, 0.0);
        for planned in plan.moves() {
            let (start, curve) = (planned.start_steps as f64, &planned.profile);
            assert!((planned.start_s - end_s).abs() < 1e-12, "{name}");
            let at = (start + curve.position(0.0), curve.speed(0.0));
            let off = (at.0 - end.0, at.1 - end.1);
            // Only the first move may jump to its start speed.
            assert!(off.0.abs() < 1e-9 && (off.1.abs() < 1e-3 || end_s == 0.0), "{name}: {off:?}");
            end_s += curve.duration_s();
            end = (start + curve.position(curve.duration_s()), curve.speed(curve.duration_s()));
        }
        assert!((plan.duration_s() - end_s).abs() < 1e-12, "{name}");
    }
}

#[test]
fn a_description_has_the_peaks_of_the_curve() {
    for (name, plan) in plans() {
        let [first, ..] = plan.moves() else { panic!("{name} has no moves") };
        let (detail, peaks) = (first.profile.detail(1e6), first.profile.peaks());
        let expected = match &first.profile {
            // That of the whole move, and none.
            Profile::Cut(_) | Profile::Constant(_) => continue,
            Profile::Stretched(_) => {
                format!("{}; 41\u{202f}% slower, to end with its group", peaks.to_text())
            }
            _ => peaks.to_text(),
        };
        assert!(
            detail.contains(&expected) || first.profile.repeats().is_some(),
            "{name}: {detail}, {expected}"
        );
    }
}
