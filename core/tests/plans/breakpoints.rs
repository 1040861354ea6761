//! The breakpoints of a plan.

use super::{axis, plan_axis};
use stepscope_core::{
    motion::{AxisPlan, Breakpoints},
    scenario::{Source, presets::PRESETS},
};

/// Plans an axis from the JSON of its moves.
fn plan(moves: &str) -> AxisPlan {
    plan_axis(&axis(&format!(r#"{{"moves":[{moves}]}}"#)), "axis").expect("plans")
}

const MOVES: &[&str] = &[
    r#"{"trapezoid":{"distance":{"steps":3000}}}"#,
    r#"{"trapezoid":{"distance":{"steps":-41},"method":"table"}}"#,
    r#"{"trapezoid":{"distance":{"steps":2000},"method":"table"}}"#,
    r#"{"staircase":{"distance":{"steps":3000}}}"#,
    r#"{"cosine":{"distance":{"steps":3200},"duration_s":0.4,"ramp_s":0.1}}"#,
    r#"{"cosine":{"distance":{"steps":3201},"ramp_s":0.1,"method":"sliced"}}"#,
    r#"{"ramps":{"shape":"sigmoid","ramp_s":0.1}}"#,
    r#"{"ramps":{"shape":"bezier"}}"#,
    r#"{"ramps":{"shape":"straight","ramp_s":0.1}}"#,
    r#"{"ramps":{"shape":"exponential","ramp_s":0.1}}"#,
    r#"{"jerk_limited":{"distance":{"steps":-3000}}}"#,
    r#"{"jerk_limited":{"distance":{"steps":40}}}"#,
    r#"{"points":{"points":[[0,0],[0.1,50],[0.2,50],[0.5,-300]],"interpolation":"straight"}}"#,
    r#"{"points":{"points":[[0,0],[0.1,50],[0.2,60],[0.5,-300]],"interpolation":"smooth"}}"#,
    r#"{"constant":{"distance":{"steps":100},"speed":{"steps_s":1000}}}"#,
    r#"{"dwell":{"duration_s":0.1}},{"sine":{"amplitude":{"steps":500},"period_s":0.2,"periods":3}},{"dwell":{"duration_s":0.05}}"#,
    r#"{"dwell":{"duration_s":0.1}},{"sine_segments":{"amplitude":{"steps":500},"period_s":0.2,"periods":3}},{"dwell":{"duration_s":0.05}}"#,
];

/// These moves and all axes of the presets, which include every kind of move.
fn plans() -> impl Iterator<Item = (&'static str, AxisPlan)> {
    let presets = PRESETS.iter().flat_map(|preset| {
        let axes = match preset.scenario().source {
            Source::Motion(motion) => motion.axes,
            _ => Vec::new(),
        };
        axes.into_iter().map(|axis| (preset.id, plan_axis(&axis, preset.id).expect("plans")))
    });
    MOVES.iter().map(|moves| (*moves, plan(moves))).chain(presets)
}

#[test]
fn every_curve_is_smooth_between_two_breakpoints() {
    for (moves, plan) in plans() {
        let (from, to) = (-0.01, plan.duration_s() + 0.01);
        let mut covered = 0.0;
        Breakpoints::of(&plan).intervals(from, to, &mut |interval| {
            let length = interval.to_s - interval.from_s;
            covered += length * interval.times;
            let at = |part: f64| interval.from_s + length * part;
            // The speed is straight, or bends at most as much as a 64th of a cosine ramp.
            let [a, b, c] = [0.001, 0.5, 0.999].map(|part| plan.speed(at(part)));
            let bend = (b - (a + c) / 2.0).abs();
            assert!(bend <= 1e-3 * plan.peaks().speed, "{moves}: {interval:?} bends by {bend}");
            let [a, b, c] = [0.001, 0.5, 0.999].map(|part| plan.acceleration(at(part)));
            let within = (a.min(c)..=a.max(c)).contains(&b);
            assert!(within || (b - a).abs() <= 1e-6 * plan.peaks().acceleration, "{moves}: {interval:?}");
        });
        assert!((covered - (to - from)).abs() < 1e-9, "{moves}: {covered} of {}", to - from);
    }
}

#[test]
fn identical_periods_are_divided_once_and_counted() {
    for moves in MOVES.iter().filter(|moves| moves.contains(r#""sine"#)) {
        let plan = plan(moves);
        let breakpoints = Breakpoints::of(&plan);
        for (from, to, wholes) in [(0.09, 0.71, 3.0), (0.15, 0.71, 2.0), (0.15, 0.6, 1.0), (0.15, 0.4, 1.0)] {
            let (mut most, mut covered) = (0.0_f64, 0.0);
            breakpoints.intervals(from, to, &mut |interval| {
                most = most.max(interval.times);
                covered += interval.times * (interval.to_s - interval.from_s);
            });
            assert_eq!(most, wholes, "{from} to {to}");
            assert!((covered - (to - from)).abs() < 1e-12, "{from} to {to}: {covered}");
        }
    }
}
