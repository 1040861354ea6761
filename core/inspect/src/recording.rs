//! Recordings analyzed like runs: figures, bytes, comparison with a plan, and a scenario that reproduces them.

pub mod alignment;
pub mod differences;
mod drift;
pub mod events;
pub mod figures;
pub mod loaded_capture;
mod matching;
#[cfg(test)]
mod noise;
pub mod open_options;
pub mod overview;
pub mod packets;
pub mod remedy;
pub mod replies;
pub mod report;
pub mod scenario;
pub mod serial;
mod side;
pub mod tolerance;

#[cfg(test)]
mod tests {
    #[test]
    fn a_recording_is_compared_with_a_plan() {
        use crate::recording::{
            alignment::{Alignment, Side},
            report::Report,
            tolerance::Tolerance,
        };
        use crate::trace::stored_run::Recording;
        use stepscope_peripheral::trace::steps;
        use stepscope_sim::Experiment;

        let recorded = |json: &str| {
            let mut recording = Recording::default();
            Experiment::from_json(json).expect("no problems").run(&mut recording);
            recording.trace
        };
        // The same move by a controller whose start-up takes longer.
        let (own, model) = (recorded(r#"{"bus":{"self_test_cycles":4000}}"#), recorded("{}"));
        assert_eq!(Report::of(&own, 16_000_000, 1, None).channels[0].figures.steps, 3200);
        let (own, model) = (steps(&own, 0), steps(&model, 0));
        let side = |steps| Side { steps, clock_hz: 16_000_000, values: &[] };
        let found = Alignment::of(side(&own), side(&model), None)
            .expect("both have steps")
            .comparison(Tolerance::ZERO);
        assert!(found.is_same(), "{found:?}");
    }
}
