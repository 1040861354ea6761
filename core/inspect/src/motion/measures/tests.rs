use super::*;
use crate::trace::stored_run::StoredRun;
use alloc::{format, string::String};
use stepscope_peripheral::trace::steps;
use stepscope_scenario::{Scenario, Source};
use stepscope_sim::Experiment;

struct Ran {
    experiment: Experiment,
    recording: StoredRun,
    steps: Vec<Step>,
    axis: Axis,
}

impl Ran {
    fn of(json: &str) -> Self {
        let experiment = Experiment::from_json(json).expect("no problems");
        let scenario = Scenario::from_json(json).expect("reads");
        let Source::Motion(motion) = scenario.source else { panic!("a motion") };
        let mut recording = StoredRun::default();
        experiment.run(&mut recording);
        let steps = steps(&recording.trace, 0);
        Self { experiment, recording, steps, axis: motion.axes[0].clone() }
    }

    fn plan(&self) -> &AxisPlan {
        &self.experiment.plans()[0]
    }

    fn pulses(&self) -> Pulses<'_> {
        Pulses::of_run(
            0,
            &self.steps,
            &self.recording.packets,
            self.experiment.segments().and_then(|lists| lists.lists().first()),
            self.experiment.config(),
        )
    }

    fn measures(&self) -> Measures {
        Measures::of(self.plan(), &self.pulses(), Some(&self.axis))
    }
}

fn scenario(moves: &str, engine: &str) -> String {
    format!(r#"{{"source":{{"motion":{{"axes":[{{"moves":[{moves}]}}],"engine":"{engine}"}}}}}}"#)
}

fn measured(moves: &str) -> Measures {
    Ran::of(&scenario(moves, "ticks")).measures()
}

#[track_caller]
fn close(found: f64, expected: f64, within: f64, what: &str) {
    assert!((found - expected).abs() <= within, "{what}: {found} is not {expected}");
}

/// Metrics of many samples, each in the middle of its interval.
fn brute(length_s: f64, first: impl Fn(f64) -> f64, second: impl Fn(f64) -> f64) -> CurveMetrics {
    // Not in step with the slots of a tick.
    let samples = 912_347_u32;
    let each = length_s / f64::from(samples);
    let at = |sample: u32| (f64::from(sample) + 0.5) * each;
    let pairs: Vec<(f64, f64)> = (0..samples).map(|sample| (first(at(sample)), second(at(sample)))).collect();
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / f64::from(samples);
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let cross = mean(&|p| (p.0 - x) * (p.1 - y));
    let (xx, yy) = (mean(&|p| (p.0 - x) * (p.0 - x)), mean(&|p| (p.1 - y) * (p.1 - y)));
    let largest = pairs.iter().map(|p| p.1 - p.0).fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
    let correlation = cross / (xx * yy).sqrt();
    let square = (0..POINTS)
        .map(|point| length_s * (f64::from(point) / f64::from(POINTS)))
        .map(|t| (second(t) - first(t)) * (second(t) - first(t)))
        .sum::<f64>();
    CurveMetrics {
        largest_steps: largest,
        largest_at_s: 0.0,
        rms_steps: mean(&|p| (p.1 - p.0) * (p.1 - p.0)).sqrt(),
        area_steps_s: mean(&|p| (p.1 - p.0).abs()) * length_s,
        area_difference_steps_s: mean(&|p| p.1 - p.0) * length_s,
        points: POINTS,
        sum_of_squares_steps2: square,
        euclidean_steps: square.sqrt(),
        correlation: Some(correlation),
        uncorrelated: Some(1.0 - correlation),
    }
}

#[track_caller]
fn same(found: &CurveMetrics, expected: &CurveMetrics, length_s: f64, what: &str) {
    let size = expected.rms_steps.max(0.01);
    close(found.largest_steps.abs(), expected.largest_steps.abs(), 0.02 * size.max(1.0), what);
    close(found.rms_steps, expected.rms_steps, 1e-3 * size, what);
    close(found.area_steps_s, expected.area_steps_s, 1e-3 * size * length_s, what);
    close(found.area_difference_steps_s, expected.area_difference_steps_s, 1e-3 * size * length_s, what);
    assert_eq!(
        (found.points, found.sum_of_squares_steps2),
        (POINTS, expected.sum_of_squares_steps2),
        "{what}"
    );
    assert_eq!(found.euclidean_steps, expected.euclidean_steps, "{what}");
    close(found.correlation.unwrap(), expected.correlation.unwrap(), 1e-9, what);
    close(found.uncorrelated.unwrap(), expected.uncorrelated.unwrap(), 1e-9, what);
}

const MOTIONS: &[&str] = &[
    r#"{"trapezoid":{"distance":{"steps":3000},"method":"exact"}},{"trapezoid":{"distance":{"steps":-500}}}"#,
    r#"{"staircase":{"distance":{"steps":1500}}}"#,
    r#"{"cosine":{"distance":{"steps":-3200},"duration_s":0.4,"ramp_s":0.1}}"#,
    r#"{"dwell":{"duration_s":0.1}},{"sine_segments":{"amplitude":{"steps":200},"period_s":0.2,"periods":3}}"#,
    r#"{"cosine":{"distance":{"steps":3100},"duration_s":0.4,"ramp_s":0.2,"method":"sliced"}}"#,
    r#"{"ramps":{"distance":{"steps":1500},"duration_s":0.4,"ramp_s":0.1,"shape":"exponential"}}"#,
];

#[test]
fn metrics_equal_those_of_many_samples() {
    for moves in MOTIONS {
        let ran = Ran::of(&scenario(moves, "ticks"));
        let (found, plan, pulses) = (ran.measures(), ran.plan(), ran.pulses());
        let hz = pulses.hz();
        let zero = ran.recording.first_tick().expect("ticks").0;
        let actual: Vec<Step> =
            ran.steps.iter().map(|step| Step { cycle: step.cycle - zero, ..*step }).collect();
        let (due, _) = due_steps(plan, 16_000_000);
        let at = |steps: &[Step], t: f64| {
            let after = steps.partition_point(|step| step.cycle as f64 / hz <= t);
            if after == 0 { 0.0 } else { f64::from(steps[after - 1].position) }
        };
        let length = found.length_s;
        same(&found.steps, &brute(length, |t| plan.position(t), |t| at(&due, t)), length, moves);
        same(&found.ticks, &brute(length, |t| at(&due, t), |t| at(&actual, t)), length, moves);
        same(&found.pulses, &brute(length, |t| plan.position(t), |t| at(&actual, t)), length, moves);
    }
}

#[test]
fn a_constant_rate_has_the_metrics_of_a_sawtooth() {
    let found = measured(r#"{"constant":{"distance":{"steps":100},"speed":{"steps_s":1000}}}"#);
    // Half a step to either side, each step in the middle of its ms and in a whole cycle.
    let steps = found.steps;
    close(steps.largest_steps.abs(), 0.5, 1e-8, "largest");
    close(steps.rms_steps, 1.0 / 12.0_f64.sqrt(), 1e-9, "rms");
    close(steps.area_steps_s, 0.025, 1e-9, "area");
    close(steps.area_difference_steps_s, 0.0, 1e-12, "areas");
    close(found.step_errors.largest_s, 0.0, 1e-12, "time");
    close(found.step_errors.largest_steps, 0.0, 1e-9, "position");
    // At 1000 steps/s 1 ms late is one step behind.
    let ticks = found.tick_errors;
    assert_eq!((ticks.pulses, found.counts), (100, Counts { due: 100, actual: 100, stray: 0 }));
    close(ticks.largest_steps, ticks.largest_s * 1000.0, 1e-9, "position of time");
    close(ticks.rms_steps, ticks.rms_s * 1000.0, 1e-9, "position of time");
    close(found.ticks.area_difference_steps_s, -100.0 * ticks.mean_s, 1e-9, "area of time");
    // One pulse after the other, by their own cycles.
    let ran =
        Ran::of(&scenario(r#"{"constant":{"distance":{"steps":100},"speed":{"steps_s":1000}}}"#, "ticks"));
    let zero = ran.recording.first_tick().expect("ticks").0;
    let late: Vec<f64> = (0..)
        .zip(&ran.steps)
        .map(|(k, step)| (step.cycle - zero) as f64 / 16e6 - (f64::from(k) + 0.5) / 1000.0)
        .collect();
    let largest = late.iter().copied().fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
    close(ticks.largest_s, largest, 1e-12, "largest");
    close(ticks.mean_s, late.iter().sum::<f64>() / 100.0, 1e-12, "mean");
    close(ticks.rms_s, (late.iter().map(|late| late * late).sum::<f64>() / 100.0).sqrt(), 1e-12, "rms");
    close(found.duration.end_error_s.unwrap(), late[99], 1e-12, "the end");
}

#[test]
fn segments_add_no_error_to_scheduled_steps() {
    for moves in MOTIONS {
        let found = Ran::of(&scenario(moves, "segments")).measures();
        let speed = found.peaks.speed_steps_s;
        // A table's times are the timer's own, so its steps need not be where its curve is halfway.
        let exact = !moves.contains(r#"-500"#);
        if exact {
            assert!(found.steps.largest_steps.abs() <= 0.5 + speed / 16e6, "{moves}: {:?}", found.steps);
            assert!(
                found.step_errors.largest_steps.abs() <= speed / 16e6,
                "{moves}: {:?}",
                found.step_errors
            );
        }
        assert!(found.step_errors.largest_s.abs() <= 0.5 / 16e6 + 1e-15, "{moves}: {:?}", found.step_errors);
        // Errors that are spread evenly over a cycle have an RMS of 0.29 of it.
        assert!(found.step_errors.rms_s < 0.33 / 16e6, "{moves}: {:?}", found.step_errors);
        let none = PulseErrors { pulses: found.counts.due, ..PulseErrors::default() };
        assert_eq!((found.tick_errors, found.counts.stray), (none, 0), "{moves}");
        assert_eq!(found.counts.due, found.counts.actual);
        assert_eq!((found.ticks.area_steps_s, found.ticks.uncorrelated), (0.0, Some(0.0)), "{moves}");
        assert_eq!(found.pulses, found.steps, "{moves}");
        assert_eq!(found.duration.end_error_s, Some(0.0));
    }
}

#[test]
fn ticks_delay_less_than_a_tick_and_canceled_steps_shift_no_others() {
    for moves in MOTIONS {
        let found = measured(moves);
        assert_eq!(found.counts.stray, 0, "{moves}");
        // Ticks of 2 ms.
        assert!(found.tick_errors.largest_s.abs() < 0.002, "{moves}: {:?}", found.tick_errors);
        assert!(found.tick_errors.rms_s > 1e-6, "{moves}: {:?}", found.tick_errors);
    }
    // Opposite steps within one tick cancel; the others are at their positions.
    let fine = r#"{"constant":{"distance":{"steps":25},"speed":{"steps_s":5000}}},
        {"constant":{"distance":{"steps":-26},"speed":{"steps_s":5000}}}"#;
    let found = measured(fine);
    assert_eq!((found.counts.due, found.counts.actual, found.counts.stray), (51, 41, 0));
    assert!(found.tick_errors.largest_s.abs() < 0.002, "{:?}", found.tick_errors);
}

#[test]
fn lost_pulses_do_not_shift_the_others() {
    // The second of the packets that arrive is broken.
    let json = r#"{"source":{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":100},"speed":{"steps_s":1000}}}]}]}},
        "line":{"glitches":[{"start_cycle":100000,"length_cycles":40000,"level":0}]}}"#;
    let found = Ran::of(json).measures();
    let Counts { due, actual, stray } = found.counts;
    assert!(due == 100 && actual < 100 && stray == 0, "{:?}", found.counts);
    // The other pulses reach the first positions later than planned.
    assert!(
        found.tick_errors.largest_s > 0.001 && found.tick_errors.pulses == actual,
        "{:?}",
        found.tick_errors
    );
    assert!(found.ticks.largest_steps < -1.5, "{:?}", found.ticks);
}

#[test]
fn the_start_stop_rate_is_the_jump_from_standstill() {
    let constant = |steps: i32, speed: u32| {
        format!(r#"{{"constant":{{"distance":{{"steps":{steps}}},"speed":{{"steps_s":{speed}}}}}}}"#)
    };
    let dwell = r#"{"dwell":{"duration_s":0.1}}"#;
    let trapezoid =
        r#"{"trapezoid":{"distance":{"steps":3000},"start_speed":{"steps_s":250},"method":"exact"}}"#;
    let rows = [
        (constant(100, 1000), 1000.0),
        // Jumps between speeds do not count.
        (format!("{},{},{}", constant(50, 500), constant(100, 2000), constant(50, 400)), 500.0),
        (format!("{},{},{}", constant(50, 500), dwell, constant(-100, 900)), 900.0),
        // A reversal is a stop and a start.
        (
            format!(
                "{},{},{},{}",
                constant(9, 100),
                constant(90, 700),
                constant(-90, 800),
                constant(-9, 100)
            ),
            800.0,
        ),
        (trapezoid.into(), 250.0),
        (r#"{"cosine":{"distance":{"steps":3200},"duration_s":0.4,"ramp_s":0.2}}"#.into(), 0.0),
        (dwell.into(), 0.0),
    ];
    for (moves, expected) in rows {
        close(measured(&moves).peaks.start_stop_steps_s, expected, 1e-6, &moves);
    }
    // A sine by segments reverses at the rate of its first segment.
    let ran = Ran::of(&scenario(MOTIONS[3], "ticks"));
    let Profile::SineSegments(sine) = &ran.plan().moves()[1].profile else { panic!("a sine") };
    close(ran.measures().peaks.start_stop_steps_s, sine.segments()[0].rate, 1e-6, "a sine");
}

#[test]
fn a_duration_is_compared_with_the_requested_one() {
    let cosine = r#"{"cosine":{"distance":{"steps":3200},"duration_s":0.4,"ramp_s":0.2}}"#;
    let found = measured(cosine).duration;
    assert_eq!((found.planned_s, found.requested_s, found.plan_error_s), (0.4, Some(0.4), Some(0.0)));
    // The last pulse comes before the end of the last tick, 0.4 s.
    assert!(found.last_pulse_s.unwrap() < 0.4 && found.last_due_s.unwrap() < 0.4);
    assert_eq!(found.end_error_s, Some(found.last_pulse_s.unwrap() - found.last_due_s.unwrap()));
    // The slices of the paper miss the time by up to 0.8 %.
    let sliced = r#"{"cosine":{"distance":{"steps":3111},"duration_s":0.4,"ramp_s":0.15,"method":"sliced"}}"#;
    let found = measured(sliced).duration;
    let error = found.plan_error_s.unwrap();
    assert!(error != 0.0 && error.abs() < 0.008 * 0.4, "{found:?}");
    assert_eq!((found.requested_s, error), (Some(0.4), found.planned_s - 0.4));
    let trapezoid = r#"{"trapezoid":{"distance":{"steps":3000}}}"#;
    assert_eq!(measured(trapezoid).duration.requested_s, None);
    let found = measured(&format!("{trapezoid},{cosine}")).duration;
    close(
        found.requested_s.unwrap(),
        found.planned_s,
        1e-12,
        "a move without a requested time counts as planned",
    );
    let found = measured(r#"{"dwell":{"duration_s":0.1}}"#);
    assert_eq!((found.duration.last_due_s, found.duration.end_error_s), (None, None));
    assert_eq!((found.pulses.correlation, found.pulses.rms_steps, found.length_s), (None, 0.0, 0.1));
}

#[test]
fn the_papers_distance_comes_from_its_512_points() {
    for d1 in [0.0054, 0.006, 0.02] {
        let moves = format!(
            r#"{{"sine_segments":{{"amplitude":{{"steps":1000}},"period_s":0.5,"periods":1,"max_deviation":{d1}}}}}"#
        );
        let found = measured(&moves).sine.expect("a sine");
        let row = super::super::sine_polyline::Row::of(d1, 9);
        close(found.euclidean, row.euclidean, 1e-12, "Ev");
        assert_eq!((found.segments, found.quarter.points), (row.segments, 512));
        close(found.quarter.euclidean_steps, row.euclidean * 1000.0, 1e-9, "in steps");
        assert!(
            found.quarter.largest_steps.abs() <= d1 * 1000.0 && found.quarter.largest_steps < -d1 * 900.0
        );
        // A chord lies below the cosine: the area between is the difference of the areas, 1 - the chords'.
        close(found.quarter.area_steps_s, -found.quarter.area_difference_steps_s, 1e-12, "areas");
        let points: Vec<u16> = stepscope_motion::curves::polyline::breakpoints(d1);
        let height = |point: u16| stepscope_motion::curves::polyline::cosine_at(point);
        let chords: f64 = points
            .windows(2)
            .map(|p| f64::from(p[1] - p[0]) * (height(p[0]) + height(p[1])) / 2.0)
            .sum::<f64>();
        let angle = core::f64::consts::TAU / 2048.0;
        let expected = (1.0 - chords * angle) * 1000.0 * 0.5 / core::f64::consts::TAU;
        close(found.quarter.area_steps_s, expected, 1e-3 * expected, "area");
        close(found.quarter.rms_steps, found.quarter.euclidean_steps / 512.0_f64.sqrt(), 1e-9, "rms");
        assert!(found.quarter.correlation.unwrap() > 0.999);
    }
    assert_eq!(measured(r#"{"dwell":{"duration_s":0.1}}"#).sine, None);
}
