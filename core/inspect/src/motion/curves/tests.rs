//! Columns compared with many samples of each.

use super::*;
use crate::trace::stored_run::StoredRun;
use alloc::{format, vec::Vec};
use stepscope_peripheral::trace::steps;
use stepscope_sim::Experiment;

/// A quantity of a plan over time.
type Value<'a> = &'a dyn Fn(f64) -> f64;

struct Ran {
    experiment: Experiment,
    recording: StoredRun,
    steps: Vec<Step>,
}

impl Ran {
    fn of(source: &str) -> Self {
        let experiment = Experiment::from_json(&format!(r#"{{"source":{source}}}"#)).expect("no problems");
        let mut recording = StoredRun::default();
        experiment.run(&mut recording);
        let steps = steps(&recording.trace, 0);
        Self { experiment, recording, steps }
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
}

fn motion(moves: &str) -> Ran {
    Ran::of(&format!(r#"{{"motion":{{"axes":[{{"moves":[{moves}]}}]}}}}"#))
}

const MOTIONS: &[&str] = &[
    r#"{"trapezoid":{"distance":{"steps":3000}}},{"trapezoid":{"distance":{"steps":-500}}}"#,
    r#"{"trapezoid":{"distance":{"steps":2000},"method":"table"}}"#,
    r#"{"staircase":{"distance":{"steps":3000}}}"#,
    r#"{"cosine":{"distance":{"steps":3200},"duration_s":0.4,"ramp_s":0.1}}"#,
    r#"{"sine_segments":{"amplitude":{"steps":50},"period_s":0.02,"periods":30}}"#,
];
/// Lists of segments with a dwell and a ramp.
const SEGMENTS: &str = r#"{"segments":{"channels":[{"segments":[{"steps":{"count":10}},{"dwell":{"length_q16":5242880000}},
    {"steps":{"count":40,"interval_q16":524288000,"add_q16":-8000000,"dir":0}},{"dwell":{"length_q16":9000000000}}]}]}}"#;

/// From the whole motion down to a part of a tick, in parts of its length.
const WINDOWS: &[(f64, f64, usize)] =
    &[(-0.05, 1.1, 37), (0.2, 0.45, 64), (0.5, 0.5003, 9), (-0.1, -0.05, 3)];

fn extremes_of(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

#[test]
fn extremes_equal_those_of_a_thousand_samples_per_column() {
    for moves in MOTIONS {
        let ran = motion(moves);
        let plan = &ran.experiment.plans()[0];
        let (zero_s, length, peaks) = (0.003, plan.duration_s(), plan.peaks());
        for &(from, to, columns) in WINDOWS {
            let window = Window { start_s: zero_s + from * length, end_s: zero_s + to * length, columns };
            let bands = ideal(plan, zero_s, window);
            let samples: [(&Band, Value<'_>, f64); 3] = [
                (&bands.position, &|t| plan.position(t), 3000.0),
                (&bands.speed, &|t| plan.speed(t), peaks.speed),
                (&bands.acceleration, &|t| plan.acceleration(t), peaks.acceleration.max(1.0)),
            ];
            for (band, value, scale) in samples {
                for column in 0..columns {
                    let samples = (0..1000)
                        .map(|k| window.edge_s(column) + (f64::from(k) + 0.5) / 1000.0 * window.width_s());
                    let (low, high) = extremes_of(samples.map(|t| value(t - zero_s)));
                    let (found_low, found_high) = (band.min[column], band.max[column]);
                    // Samples are inside the extremes and close to them.
                    let (slack, near) = (1e-6 * scale, 0.006 * scale);
                    let what = format!(
                        "{moves} {from}..{to}, column {column}: {low} {high}, found {found_low} {found_high}"
                    );
                    assert!(found_low <= low + slack && found_high >= high - slack, "{what}");
                    assert!(low - found_low <= near && found_high - high <= near, "{what}");
                }
            }
        }
    }
}

#[test]
fn actual_columns_include_every_step_and_tick() {
    let runs = MOTIONS.iter().map(|moves| motion(moves)).chain([Ran::of(SEGMENTS)]);
    for ran in runs {
        let pulses = ran.pulses();
        let length = pulses.steps.last().map_or(0.0, |step| step.cycle as f64 / pulses.hz());
        let mut rates = Vec::new();
        pulses.rates(0.0, 1e9, &mut |rate| rates.push(rate));
        for &(from, to, columns) in WINDOWS {
            let window = Window { start_s: from * length, end_s: to * length, columns };
            let Actual { position, speed } = actual(&pulses, window);
            for column in 0..columns {
                let (start, end) = (window.edge_s(column), window.edge_s(column + 1));
                let before = pulses.steps.iter().rev().find(|step| (step.cycle as f64 / pulses.hz()) < start);
                let inside = pulses
                    .steps
                    .iter()
                    .filter(|step| (start..end).contains(&(step.cycle as f64 / pulses.hz())));
                let first = before.map_or(0, |step| step.position);
                let expected =
                    extremes_of([first].into_iter().chain(inside.map(|step| step.position)).map(f64::from));
                assert_eq!((position.min[column], position.max[column]), expected, "{from}..{to}, {column}");

                let touching = || rates.iter().filter(|rate| rate.from_s < end && rate.to_s > start);
                let covered: f64 = touching().map(|rate| rate.to_s.min(end) - rate.from_s.max(start)).sum();
                let standstill = (covered < (end - start) * (1.0 - 1e-9)).then_some(0.0);
                let expected = extremes_of(touching().map(|rate| rate.speed).chain(standstill));
                assert_eq!((speed.min[column], speed.max[column]), expected, "{from}..{to}, {column}");
            }
        }
    }
}

#[test]
fn the_speed_is_zero_in_a_dwell() {
    // 10 steps right, 1 ms apart, a pause of 5 ms, and 10 back, 0.5 ms apart.
    let ran = Ran::of(
        r#"{"segments":{"channels":[{"segments":[{"steps":{"count":10}},{"dwell":{"length_q16":5242880000}},
            {"steps":{"count":10,"interval_q16":524288000,"dir":0}}]}]}}"#,
    );
    let window = Window { start_s: 0.0, end_s: 0.022, columns: 22 };
    let Actual { speed, .. } = actual(&ran.pulses(), window);
    for (column, expected) in [(1, 1000.0), (5, 1000.0), (12, 0.0), (17, -2000.0), (21, 0.0)] {
        assert!((speed.min[column] - expected).abs() < 0.01, "{column}: {speed:?}");
        assert!((speed.max[column] - expected).abs() < 0.01, "{column}: {speed:?}");
    }
}

/// Maximum distance of the drawn line from the true curve, in pixels of a chart of `columns` by `height`, measured
/// between its points.
fn max_deviation(plan: &AxisPlan, window: Window, height: f64) -> f64 {
    let line = ideal_line(plan, 0.0, window);
    // Points closer than 1/1000 column make a vertical line, which is left out.
    let column_s = (window.end_s - window.start_s) / window.columns as f64;
    let mut worst: f64 = 0.0;
    for (values, curve) in [
        (&line.position, (|plan, t| plan.position(t)) as fn(&AxisPlan, f64) -> f64),
        (&line.speed, |plan, t| plan.speed(t)),
        (&line.acceleration, |plan, t| plan.acceleration(t)),
    ] {
        let min = values.iter().copied().fold(f64::INFINITY, f64::min);
        let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (at, pair) in
            line.time_s.windows(2).enumerate().filter(|(_, pair)| pair[1] - pair[0] > 1e-3 * column_s)
        {
            for part in [0.25, 0.5, 0.75] {
                let t = pair[0] + (pair[1] - pair[0]) * part;
                let drawn = values[at] + (values[at + 1] - values[at]) * part;
                worst = worst.max((drawn - curve(plan, t)).abs() / (max - min).max(1e-9) * height);
            }
        }
    }
    worst
}

#[test]
fn lines_deviate_less_than_a_tenth_of_a_pixel_from_their_curve() {
    let others = [
        r#"{"jerk_limited":{"distance":{"steps":3000}}}"#,
        r#"{"ramps":{"distance":{"steps":3200}}}"#,
        r#"{"sine":{"amplitude":{"steps":400},"period_s":1,"periods":3}}"#,
        // Seven columns per period; with fewer than four a line connects only the extremes.
        r#"{"sine":{"amplitude":{"steps":50},"period_s":0.01,"periods":28}}"#,
    ];
    for moves in MOTIONS.iter().chain(&others) {
        let ran = motion(moves);
        let plan = &ran.experiment.plans()[0];
        for columns in [200, 700, 1500] {
            let window = Window { start_s: 0.0, end_s: plan.duration_s(), columns };
            // Device pixels: a chart 200 of them high.
            let worst = max_deviation(plan, window, 200.0);
            assert!(worst <= 0.1, "{moves}: {worst} px in {columns} columns");
        }
    }
}

#[test]
fn a_line_through_more_periods_than_columns_visits_its_extremes() {
    let ran = motion(r#"{"sine":{"amplitude":{"steps":10},"period_s":0.001,"periods":1000}}"#);
    let line = ideal_line(&ran.experiment.plans()[0], 0.0, Window { start_s: 0.0, end_s: 1.0, columns: 10 });
    assert_eq!(line.time_s.len(), 20);
    for pair in line.position.chunks(2) {
        assert!((pair[0] + 20.0).abs() < 1e-6 && pair[1].abs() < 1e-6, "{pair:?}");
    }
}

#[test]
fn acceleration_of_steps_equals_their_figures_and_is_near_their_plan() {
    use crate::recording::figures::StepFigures;
    let json = r#"{"source":{"motion":{"engine":"segments","axes":[{"moves":[{"cosine":{}},
        {"cosine":{"distance":{"steps":-3200}}}]}]}}}"#;
    let experiment = stepscope_sim::Experiment::from_json(json).expect("no problems");
    let mut recording = crate::trace::stored_run::StoredRun::default();
    experiment.run(&mut recording);
    let actual_steps = stepscope_peripheral::trace::steps(&recording.trace, 0);
    let pulses = Pulses::recorded(0, &actual_steps, 16_000_000);
    let end_s = actual_steps.last().expect("steps").cycle as f64 / 16e6;
    let band = actual_acceleration(&pulses, Window { start_s: 0.0, end_s, columns: 97 });
    let magnitude = |values: &[f64]| values.iter().fold(0.0_f64, |max, value| max.max(value.abs()));
    let figures = StepFigures::of(actual_steps.iter().copied(), 16_000_000).expect("steps");
    let max = magnitude(&band.max).max(magnitude(&band.min));
    assert_eq!(Some(max), figures.greatest_acceleration_steps_s2);
    // 2 pi n/T^2 of a cosine, up to the right, down to the left; it is unknown around the reversal.
    let peak = 2.0 * std::f64::consts::PI * 3200.0 / 0.16;
    assert!((max / peak - 1.0).abs() < 0.01, "{max} {peak}");
    assert!(band.max[12] > 0.9 * peak && band.min[36] < -0.9 * peak && band.min[60] < -0.9 * peak);
    assert!(band.max.iter().any(|value| value.is_nan()));
    // A narrower window shows a part of it.
    let part = actual_acceleration(&pulses, Window { start_s: 0.2, end_s: 0.2001, columns: 3 });
    assert!(part.max.iter().all(|value| value.abs() < 0.1 * peak), "{part:?}");
    let few = Pulses::recorded(0, &actual_steps[..16], 16_000_000);
    let none = actual_acceleration(&few, Window { start_s: 0.0, end_s, columns: 97 });
    assert!(none.max.iter().all(|value| value.is_nan()));
}
