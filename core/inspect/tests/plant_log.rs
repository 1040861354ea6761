//! The log of a plant compared with all of its points: minimum and maximum of a window, and values at a cycle.
#![allow(clippy::expect_used, reason = "a missing file or program fails the test")]

use stepscope_inspect::plant::log::{CycleWindow, MOTOR, PlantLog, SUPPLY};
use stepscope_inspect::trace::stored_run::StoredRun;
use stepscope_peripheral::units::Instant;
use stepscope_plant::{Observer, Plant};
use stepscope_sim::{Experiment, RunLimits};

/// Every point of a plant: its cycle and all values.
#[derive(Default)]
struct Points(Vec<(u64, Vec<f64>)>);

impl Observer for Points {
    fn point(&mut self, plant: &Plant) {
        let mut values = vec![plant.supply_v(), plant.supply_a(), plant.current_sensor().filtered()];
        for channel in 0..plant.motors() {
            let state = plant.state(channel).expect("a motor");
            let command = plant.command(channel);
            let code = f64::from(plant.encoder(channel));
            values.extend([command, state.x, command - state.x, state.w, state.i_a, state.i_b, code]);
        }
        self.0.push((plant.cycle(), values));
    }
}

/// A run in slices of `slice` cycles: its log, records, points and length.
fn logged(json: &str, slice: u64) -> (PlantLog, StoredRun, Vec<(u64, Vec<f64>)>, u64) {
    let experiment = Experiment::from_json(json).expect("no problem");
    let mut run = experiment.start();
    let (mut recording, mut points) = (StoredRun::default(), Points::default());
    let mut log = PlantLog::new(run.plant(0).expect("a plant"));
    loop {
        let target = Instant(run.cycles().0.saturating_add(slice));
        let done = run.advance_observed(
            RunLimits { cycle: target, ..RunLimits::default() },
            std::slice::from_mut(&mut recording),
            &mut [(&mut log, &mut points)],
        );
        log.snapshot(run.plant(0).expect("a plant"), recording.trace.len());
        if done {
            return (log, recording, points.0, run.cycles().0);
        }
    }
}

/// Two motors, one on a driver that chops: points every 16 cycles, more than there are bins.
const CHOPPING: &str = r#"{"bus":{"channels":2},"plant":{"tail_s":0.02,"buffer_uf":200},"source":{"motion":{"engine":"segments","axes":[
    {"moves":[{"cosine":{"distance":{"steps":200},"duration_s":0.02,"ramp_s":0.005}}],"motor":{"drive":{"regulator":"chopper","decay":"mixed"}}},{}]}}}"#;

/// Minimum and maximum.
fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

#[test]
fn windows_have_the_minimum_and_maximum_of_their_points() {
    let mut has_bins = false;
    for (json, slice) in [(CHOPPING, 7_001), (CHOPPING, 1 << 40), (r#"{"plant":{}}"#, 50_000)] {
        let (log, recording, points, end) = logged(json, slice);
        let step = points[0].0;
        let wanted = [2, PlantLog::motor_index(0) + 1, PlantLog::motor_index(0) + 4];
        for (from, to) in
            [(0, end), (end / 3, end / 2), (end / 2, end / 2 + 3000), (end - 500, end), (40, 41)]
        {
            let bands = log.curves(&recording.trace, CycleWindow { from, to, columns: 300 }, &wanted);
            for (band, &value) in bands.iter().zip(&wanted) {
                assert!(!band.cycle.is_empty() && band.cycle.len() <= 604, "{} points", band.cycle.len());
                assert!(band.cycle.windows(2).all(|pair| pair[0] < pair[1]));
                // The result covers the window, and at most some points more at each end.
                let around = |extra: u64| {
                    let range = from.saturating_sub(extra)..=to + extra;
                    let some = points.iter().filter(move |(cycle, _)| range.contains(cycle));
                    extremes(some.map(|(_, values)| values[value]))
                };
                let found_range =
                    (extremes(band.min.iter().copied()).0, extremes(band.max.iter().copied()).1);
                let (inner, outer) = (around(0), around(64 * step));
                assert!(
                    found_range.0 <= inner.0 && found_range.1 >= inner.1,
                    "{found_range:?} misses some of {inner:?}"
                );
                assert!(
                    found_range.0 >= outer.0 && found_range.1 <= outer.1,
                    "{found_range:?} exceeds {outer:?}"
                );
                has_bins |= band.min != band.max;
            }
        }
    }
    assert!(has_bins, "no window used bins");
}

#[test]
fn values_at_a_cycle_equal_the_last_point_bit_for_bit() {
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    for slice in [3_333, 1 << 40] {
        let (log, recording, points, end) = logged(CHOPPING, slice);
        for part in 1..200 {
            let cycle = end * part / 199;
            let (_, expected) = points.iter().rev().find(|(point, _)| *point <= cycle).expect("a point");
            let found = log.at(&recording.trace, cycle);
            assert_eq!(found.len(), SUPPLY.len() + 2 * MOTOR.len());
            assert_eq!(bits(&found), bits(expected), "cycle {cycle}, slices of {slice}");
        }
    }
}

#[test]
fn short_windows_list_single_points() {
    let (log, recording, points, _) = logged(r#"{"plant":{}}"#, 20_000);
    let step = points[0].0;
    let (from, to) = (100 * step + 3, 120 * step + 3);
    let rotor = PlantLog::motor_index(0) + 1;
    let bands = log.curves(&recording.trace, CycleWindow { from, to, columns: 100 }, &[rotor]);
    // One more at each end.
    let expected: Vec<f64> = (100..=121).map(|point| (point * step) as f64).collect();
    assert_eq!(bands[0].cycle, expected);
    assert_eq!(bands[0].min, bands[0].max);
    assert_eq!(bands[0].min[0].to_bits(), points[99].1[rotor].to_bits());
}
