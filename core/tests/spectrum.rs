//! Spectra of complete scenarios, computed from their pulses (DESIGN B5, Part D).

use stepscope_core::inspect::trace::stored_run::StoredRun;
use stepscope_core::{
    inspect::motion::{
        actual_motion::Pulses,
        spectrum::{AnalysisWindow, Spectrum},
    },
    motion::step_tables::TickClock,
    peripheral::trace::{Step, steps},
    sim::Experiment,
};

/// Distortion of position of the pulses of a scenario's first axis, in percent, and their final
/// position.
fn made_distortion(json: &str) -> (f64, i32) {
    let experiment = Experiment::from_json(json).unwrap();
    let mut recording = StoredRun::default();
    experiment.run(&mut recording);
    let steps = steps(&recording.trace, 0);
    let zero = recording.first_tick().unwrap().0;
    let pulses: Vec<(u64, i8)> = steps
        .iter()
        .enumerate()
        .map(|(i, step)| (step.cycle - zero, Step::direction(&steps, i) as i8))
        .collect();
    let plan = &experiment.plans()[0];
    let window = AnalysisWindow::of(plan).unwrap();
    let config = experiment.config();
    let own = window.pulses_of_moves(plan, TickClock::new(config.tick().0, config.clock_hz()), &pulses);
    let spectrum = Spectrum::of_pulses(&own, window, 40);
    (spectrum.position.distortion.unwrap() * 100.0, own.iter().map(|(_, way)| i32::from(*way)).sum())
}

#[test]
fn a_pause_of_part_of_a_tick_removes_no_pulse_from_the_period() {
    let sine =
        r#"{"sine_segments":{"amplitude":{"steps":1000},"period_s":0.5,"periods":1,"max_deviation":0.0054}}"#;
    for pause_s in ["0", "0.0011", "0.0013", "0.002"] {
        let json = format!(
            r#"{{"source":{{"motion":{{"axes":[{{"moves":[{{"dwell":{{"duration_s":{pause_s}}}}},{sine}]}}]}}}}}}"#
        );
        let (distortion, end) = made_distortion(&json);
        // Pulses are placed in ticks, so the alignment of the ticks changes the last digits.
        assert!((distortion - 0.262).abs() < 1e-3, "{pause_s} s: {distortion} %");
        assert_eq!(end, 0, "{pause_s} s: as many to the right as to the left");
    }
}

#[test]
fn the_spectrum_of_segments_has_every_step_at_any_tick() {
    let moves = |kind: &str, period_s: &str, periods: u32| {
        let sine = format!(
            r#"{{"{kind}":{{"amplitude":{{"steps":10}},"period_s":{period_s},"periods":{periods}}}}}"#
        );
        let one = r#"{"constant":{"distance":{"steps":-7},"speed":{"steps_s":9000}}}"#;
        format!(r#"{one},{sine},{one}"#)
    };
    // Ticks of 3.1 ms, of 500 us, and of 6 us, in which no steps cancel.
    for bus in [r#""bus":{}"#, r#""bus":{"slots":16}"#, r#""bus":{"slots":1,"step_period_cycles":100}"#] {
        for kind in ["sine", "sine_segments"] {
            for (period_s, periods) in [("0.0031", 1), ("0.001", 4)] {
                let moves = moves(kind, period_s, periods);
                let json = format!(
                    r#"{{{bus},"source":{{"motion":{{"engine":"segments","axes":[{{"moves":[{moves}]}}]}}}}}}"#
                );
                let experiment = Experiment::from_json(&json).unwrap();
                let mut recording = StoredRun::default();
                experiment.run(&mut recording);
                let steps = steps(&recording.trace, 0);
                let segments = experiment.segments().and_then(|lists| lists.lists().first());
                let (config, log) = (experiment.config(), &recording.packets);
                let run = Pulses::of_run(0, &steps, log, segments, config);
                let plan = &experiment.plans()[0];
                let window = AnalysisWindow::of(plan).unwrap();
                let own = window.pulses_of(plan, &run);
                let hz = f64::from(config.clock_hz());
                let due: Vec<(f64, i8)> = plan
                    .due_steps(config.clock_hz())
                    .skip(7)
                    .take(40 * periods as usize)
                    .map(|due| (due.cycle as f64 / hz, if due.right { 1 } else { -1 }))
                    .collect();
                assert_eq!(own, due, "{json}");
                let distortion = Spectrum::of_pulses(&own, window, 40).position.distortion.unwrap();
                assert!(distortion < 0.03, "{json}: {distortion}");
            }
        }
    }
}
