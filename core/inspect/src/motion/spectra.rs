//! The spectra of an axis: ideal motion and actual pulses.

use crate::motion::actual_motion::Pulses;
use crate::motion::spectrum::{AnalysisWindow, Spectrum};
use alloc::{borrow::ToOwned, format, string::String};
use stepscope_motion::AxisPlan;
use stepscope_scenario::{Scenario, Source};

/// Samples per harmonic for which the acceleration of a curve with corners is exact to about 1 %.
const MIN_SAMPLES_PER_HARMONIC: u32 = 16;

/// The spectra of the ideal curve and of the pulses.
#[derive(Clone, Debug, Default)]
pub struct Spectra {
    pub ideal: Option<Spectrum>,
    pub actual: Option<Spectrum>,
    /// Why a spectrum is missing or limited; may be empty.
    pub note: String,
}

impl Spectra {
    /// Both spectra of the selected axis. Without a plan only the pulses have one.
    pub fn of(scenario: &Scenario, plan: Option<&AxisPlan>, run: &Pulses<'_>) -> Self {
        let analysis = &scenario.analysis;
        let window = plan.and_then(AnalysisWindow::of);
        let (Some(plan), Some(window)) = (plan, window) else {
            if let Source::Motion(_) = &scenario.source {
                let note = format!("This controller has no axis {}; select another one.", analysis.axis);
                return Self { note, ..Self::default() };
            }
            return Self::of_steps(scenario, run);
        };
        let ideal = Spectrum::ideal(plan, analysis.max_harmonic, analysis.fft_length);
        let actual = Spectrum::of_pulses(&window.pulses_of(plan, run), window, analysis.max_harmonic);
        let note = if !window.periodic {
            "The motion is not periodic, so it has no harmonics and no THD.".to_owned()
        } else if u32::from(analysis.max_harmonic) * MIN_SAMPLES_PER_HARMONIC > analysis.fft_length {
            format!(
                "{} samples per period alias harmonics up to {}, mainly in the acceleration. Use more samples or a lower order.",
                analysis.fft_length, analysis.max_harmonic
            )
        } else {
            String::new()
        };
        Self {
            ideal: ideal.map(|ideal| ideal.filtered_by(analysis.sensor_hz)),
            actual: Some(actual.filtered_by(analysis.sensor_hz)),
            note,
        }
    }

    fn of_steps(scenario: &Scenario, run: &Pulses<'_>) -> Self {
        let analysis = &scenario.analysis;
        let Some(window) = AnalysisWindow::of_steps(run.steps, run.hz()) else {
            let note = format!("Channel {} makes fewer than two steps.", run.channel);
            return Self { note, ..Self::default() };
        };
        let actual =
            Spectrum::of_pulses(&window.steps_within(run.steps, run.hz()), window, analysis.max_harmonic);
        let note = if window.periodic {
            format!("Measured over {} periods between reversals, because there is no plan.", window.periods)
        } else {
            "The steps do not oscillate evenly, so there are no harmonics and no THD.".to_owned()
        };
        Self { ideal: None, actual: Some(actual.filtered_by(analysis.sensor_hz)), note }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::StoredRun;
    use stepscope_peripheral::trace::steps;
    use stepscope_sim::Experiment;

    #[test]
    fn a_recorded_sine_has_the_distortion_of_the_planned_one() {
        let json = r#"{"source":{"motion":{"engine":"segments","axes":[{"moves":[
            {"sine":{"amplitude":{"steps":800},"period_s":0.5,"periods":6}}]}]}}}"#;
        let scenario = Scenario::from_json(json).expect("reads");
        let experiment = Experiment::new(&scenario).expect("no problems");
        let mut recording = StoredRun::default();
        experiment.run(&mut recording);
        let actual_steps = steps(&recording.trace, 0);
        let list = experiment.segments().and_then(|all| all.lists().first());
        let planned = Pulses::of_run(0, &actual_steps, &recording.packets, list, experiment.config());
        let known = Spectra::of(&scenario, experiment.plans().first(), &planned).actual.expect("pulses");
        let recorded = Pulses::recorded(0, &actual_steps, 16_000_000);
        let other = Scenario { source: Source::Segments(Default::default()), ..scenario };
        let Spectra { ideal, actual, note } = Spectra::of(&other, None, &recorded);
        let found = actual.expect("pulses");
        assert!(ideal.is_none() && note.contains("5 periods"), "{note}");
        assert!((found.window.period_s - 0.5).abs() < 1e-6, "{:?}", found.window);
        let thd = |spectrum: &Spectrum| spectrum.speed.distortion.expect("a sine");
        assert!((thd(&found) / thd(&known) - 1.0).abs() < 0.01, "{} {}", thd(&found), thd(&known));
        let amplitude = found.position.amplitudes[0];
        assert!((amplitude / known.position.amplitudes[0] - 1.0).abs() < 1e-3, "{amplitude}");
        let single_step = Spectra::of(&other, None, &Pulses::recorded(0, &actual_steps[..1], 16_000_000));
        assert!(single_step.actual.is_none() && single_step.note.contains("fewer than two steps"));
    }
}
