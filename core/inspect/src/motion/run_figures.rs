//! Figures of an axis in two runs, before and after a change.

use crate::motion::measures::{ideal_to_actual, within_bounds};
use crate::motion::{actual_motion::Pulses, spectra::Spectra};
use alloc::vec::Vec;
use serde::Serialize;
use stepscope_motion::AxisPlan;
use stepscope_peripheral::trace::Step;
use stepscope_scenario::Scenario;

/// How a figure is printed. Lengths, speeds and accelerations are in the unit of the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    Seconds,
    Length,
    Speed,
    Acceleration,
    /// A part of 1.
    Ratio,
    FullSteps,
}

const FIGURES: [(&str, Unit); 10] = [
    ("duration", Unit::Seconds),
    ("peak speed", Unit::Speed),
    ("jump of speed", Unit::Speed),
    ("peak acceleration", Unit::Acceleration),
    ("RMS lag", Unit::Length),
    ("THD, position", Unit::Ratio),
    ("THD, speed", Unit::Ratio),
    ("THD, acceleration", Unit::Ratio),
    ("THD, filtered acceleration", Unit::Ratio),
    ("lost steps", Unit::FullSteps),
];

/// One axis of a run.
#[derive(Clone, Copy, Debug)]
pub struct AxisRun<'a> {
    pub scenario: &'a Scenario,
    pub plan: Option<&'a AxisPlan>,
    pub pulses: Pulses<'a>,
    /// `None` without a motor.
    pub lost_full_steps: Option<i64>,
    /// Length of a step in the unit of the axis.
    pub unit: f64,
}

/// A figure of both runs; `None` where it is undefined.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ComparedFigure {
    pub name: &'static str,
    pub unit: Unit,
    pub before: Option<f64>,
    pub after: Option<f64>,
    /// After minus before.
    pub change: Option<f64>,
}

impl AxisRun<'_> {
    /// In the order of [`FIGURES`], in the unit of the axis.
    fn figures(&self) -> [Option<f64>; FIGURES.len()] {
        let [duration, speed, jump, acceleration] = match self.plan {
            Some(plan) => {
                let peaks = plan.peaks();
                let jump = (peaks.jump > 0.0).then_some(peaks.jump);
                // A speed that only jumps has no acceleration.
                let is_defined = jump.is_none() || peaks.acceleration > 0.0;
                let acceleration = is_defined.then_some(peaks.acceleration);
                [Some(plan.duration_s()), Some(peaks.speed), jump, acceleration]
            }
            None => {
                let steps = self.pulses.steps;
                let between = |pair: &[Step]| match pair {
                    [before, after] => after.cycle - before.cycle,
                    _ => 0,
                };
                let shortest = steps.windows(2).map(between).min().filter(|cycles| *cycles > 0);
                let length = steps.first().zip(steps.last()).map(|(first, last)| last.cycle - first.cycle);
                let hz = self.pulses.hz();
                [
                    length.map(|cycles| cycles as f64 / hz),
                    shortest.map(|cycles| hz / cycles as f64),
                    None,
                    None,
                ]
            }
        };
        let lag = self.plan.filter(|&plan| within_bounds([plan]).is_ok());
        let lag = lag.map(|plan| ideal_to_actual(plan, &self.pulses).rms_steps);
        let spectrum = Spectra::of(self.scenario, self.plan, &self.pulses).actual;
        let thd = spectrum.as_ref().map(|found| {
            let filtered = found.acceleration_filtered.as_ref();
            [Some(&found.position), Some(&found.speed), Some(&found.acceleration), filtered]
                .map(|harmonics| harmonics.and_then(|harmonics| harmonics.distortion))
        });
        let [position, rate, change, filtered] = thd.unwrap_or_default();
        let [speed, jump, acceleration, lag] =
            [speed, jump, acceleration, lag].map(|steps| steps.map(|steps| steps * self.unit));
        let lost = self.lost_full_steps.map(|lost| lost as f64);
        [duration, speed, jump, acceleration, lag, position, rate, change, filtered, lost]
    }
}

/// The figures that at least one run has.
pub fn compare(before: &AxisRun<'_>, after: &AxisRun<'_>) -> Vec<ComparedFigure> {
    let both = before.figures().into_iter().zip(after.figures());
    FIGURES
        .into_iter()
        .zip(both)
        .filter(|(_, (before, after))| before.is_some() || after.is_some())
        .map(|((name, unit), (before, after))| {
            let change = before.zip(after).map(|(before, after)| after - before);
            ComparedFigure { name, unit, before, after, change }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::record_run;
    use stepscope_peripheral::trace::steps;
    use stepscope_sim::Experiment;

    /// The figures of axis 0 of two motions.
    fn compared(moves: [&str; 2]) -> Vec<ComparedFigure> {
        let runs = moves.map(|moves| {
            let json = alloc::format!(
                r#"{{"analysis":{{"sensor_hz":50}},"source":{{"motion":{{"engine":"segments","axes":[{{"moves":[{moves}]}}]}}}}}}"#
            );
            let scenario = Scenario::from_json(&json).expect("reads");
            let experiment = Experiment::new(&scenario).expect("no problems");
            let (_, mut stored) = record_run(&experiment, 1).expect("it is short");
            let stored = stored.remove(0);
            let actual = steps(&stored.trace, 0);
            (scenario, experiment, stored, actual)
        });
        let [before, after] = runs.each_ref().map(|(scenario, experiment, stored, actual)| AxisRun {
            scenario,
            plan: experiment.plans().first(),
            pulses: Pulses::of_run(
                0,
                actual,
                &stored.packets,
                experiment.segments().and_then(|all| all.lists().first()),
                experiment.config(),
            ),
            lost_full_steps: None,
            unit: 0.5,
        });
        compare(&before, &after)
    }

    fn figure<'a>(figures: &'a [ComparedFigure], name: &str) -> Option<&'a ComparedFigure> {
        figures.iter().find(|figure| figure.name == name)
    }

    #[test]
    fn a_sine_in_segments_has_more_distortion_than_the_sine() {
        let found = compared([
            r#"{"sine":{"amplitude":{"steps":800},"period_s":0.5,"periods":4}}"#,
            r#"{"sine_segments":{"amplitude":{"steps":800},"period_s":0.5,"periods":4}}"#,
        ]);
        for name in ["THD, speed", "THD, acceleration"] {
            let change = figure(&found, name).and_then(|figure| figure.change);
            assert!(change.is_some_and(|change| change > 1e-3), "{name}: {found:?}");
        }
        assert!(figure(&found, "THD, filtered acceleration").is_some_and(|figure| figure.change.is_some()));
        let duration = figure(&found, "duration").expect("both have one");
        assert_eq!((duration.before, duration.after, duration.change), (Some(2.0), Some(2.0), Some(0.0)));
        // Rounding to steps of half a unit: 1/sqrt(12) of a step at an even rate.
        let lag = figure(&found, "RMS lag").and_then(|figure| figure.before).expect("there is a plan");
        assert!((lag - 0.5 * 0.288_7).abs() < 0.02, "{lag}");
        assert_eq!(figure(&found, "lost steps"), None);
    }

    #[test]
    fn a_stepwise_speed_has_a_jump_and_no_acceleration() {
        let found = compared([
            r#"{"cosine":{"distance":{"steps":3200},"duration_s":0.4,"ramp_s":0.1}}"#,
            r#"{"constant":{"distance":{"steps":3200},"speed":{"steps_s":8000}}}"#,
        ]);
        let acceleration = figure(&found, "peak acceleration").expect("the cosine has one");
        assert!(acceleration.before.is_some_and(|value| value > 0.0));
        assert_eq!((acceleration.after, acceleration.change), (None, None));
        let jump = figure(&found, "jump of speed").expect("the constant speed has one");
        assert_eq!((jump.before, jump.after, jump.change), (None, Some(4000.0), None));
        // Neither motion is periodic.
        assert_eq!(figure(&found, "THD, speed"), None);
    }
}
