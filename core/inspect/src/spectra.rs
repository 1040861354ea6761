//! The spectra of an axis side by side: of the ideal motion, and of the pulses as they come.
//!
//! ```
//! use stepscope_inspect::{actual_motion::Pulses, spectra::Spectra};
//! use stepscope_scenario::Scenario;
//!
//! # use stepscope_peripheral::trace::{Recording, steps};
//! # use stepscope_sim::Experiment;
//! # let experiment = Experiment::from_json("{}").expect("the default motion");
//! # let mut recording = Recording::default();
//! # experiment.run(&mut recording);
//! # let made = steps(&recording.trace, 0);
//! let pulses = Pulses {
//!     channel: 0,
//!     steps: &made,
//!     log: &recording.packets,
//!     segments: None,
//!     config: experiment.config(),
//! };
//! let spectra = Spectra::of(&Scenario::default(), experiment.plans().first(), &pulses);
//! let lines = |spectrum: Option<stepscope_inspect::spectrum::Spectrum>| spectrum.map(|spectrum| spectrum.order);
//! assert_eq!((lines(spectra.ideal), lines(spectra.actual)), (Some(40), Some(40)));
//! ```

use crate::{
    actual_motion::Pulses,
    spectrum::{AnalysisWindow, Spectrum},
};
use alloc::{borrow::ToOwned, format, string::String};
use stepscope_motion::AxisPlan;
use stepscope_scenario::{Scenario, Source};

/// So many samples a harmonic bring the acceleration of a curve with corners to a part in a hundred or so.
const FOLDING: u32 = 16;

/// Both spectra, and what has to be said of them.
#[derive(Clone, Debug, Default)]
pub struct Spectra {
    /// Of the ideal curve.
    pub ideal: Option<Spectrum>,
    /// Of the pulses.
    pub actual: Option<Spectrum>,
    /// Why there is none, or what it is not; empty for nothing.
    pub note: String,
}

impl Spectra {
    /// Of the axis that a scenario's analysis names, with its plan, if it has one, and its pulses.
    #[must_use]
    pub fn of(scenario: &Scenario, plan: Option<&AxisPlan>, run: &Pulses<'_>) -> Self {
        let analysis = &scenario.analysis;
        let window = plan.and_then(AnalysisWindow::of);
        let (Some(plan), Some(window)) = (plan, window) else {
            let note = match &scenario.source {
                Source::Motion(_) => format!("This controller has no axis {}.", analysis.axis),
                _ => "A spectrum needs a motion; packets, line scripts and lists of segments have none."
                    .to_owned(),
            };
            return Self { note, ..Self::default() };
        };
        let ideal = Spectrum::ideal(plan, analysis.order, analysis.fft_length);
        let actual = Spectrum::of_pulses(&window.pulses_of(plan, run), window, analysis.order);
        let note = if !window.periodic {
            "The motion is not periodic: no harmonics, no THD.".to_owned()
        } else if u32::from(analysis.order) * FOLDING > analysis.fft_length {
            format!(
                "Of {} samples a period the ideal curve's harmonics up to {} fold back, in the acceleration most: more samples, or a lower order, come nearer to the truth.",
                analysis.fft_length, analysis.order
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
}
