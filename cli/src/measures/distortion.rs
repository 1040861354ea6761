//! Distortion of periodic motions, for the table of measures.

use stepscope_core::inspect::motion::actual_motion::Pulses;
use stepscope_core::inspect::motion::spectrum::{AnalysisWindow, Harmonics, Spectrum};
use stepscope_core::{motion::AxisPlan, scenario::Analysis};

pub(super) struct Distortion {
    pub(super) ideal: Spectrum,
    pub(super) pulses: Spectrum,
}

impl Distortion {
    pub(super) fn of(plan: &AxisPlan, run: &Pulses<'_>, analysis: &Analysis) -> Option<Self> {
        let window = AnalysisWindow::of(plan).filter(|window| window.periodic)?;
        let ideal = Spectrum::ideal(plan, analysis.max_harmonic, analysis.fft_length)?;
        // Use the same order, which the number of samples may have limited.
        let pulses = Spectrum::of_pulses(&window.pulses_of(plan, run), window, ideal.order);
        Some(Self {
            ideal: ideal.filtered_by(analysis.sensor_hz),
            pulses: pulses.filtered_by(analysis.sensor_hz),
        })
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = (&'static str, [Option<f64>; 2])> + '_ {
        type Of = fn(&Spectrum) -> Option<&Harmonics>;
        let of: [(_, Of); 4] = [
            ("position", |spectrum| Some(&spectrum.position)),
            ("speed", |spectrum| Some(&spectrum.speed)),
            ("acceleration", |spectrum| Some(&spectrum.acceleration)),
            ("acceleration_filtered", |spectrum| spectrum.acceleration_filtered.as_ref()),
        ];
        of.into_iter().filter_map(|(name, of)| {
            let ratio = |spectrum| of(spectrum).map(|harmonics| harmonics.distortion);
            Some((name, [ratio(&self.ideal)?, ratio(&self.pulses)?]))
        })
    }
}
