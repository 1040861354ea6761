//! A stored run for the page's views, with the timing check of its pulses.

use crate::trace::stored_run::Recording;
use crate::trace::timing::TimingCheck;
use stepscope_peripheral::{
    signal::{Event, Record, Sink},
    units::Instant,
};

#[derive(Clone, Default)]
pub struct RunSink {
    pub recording: Recording,
    pub timing: Option<TimingCheck>,
}

impl Sink for RunSink {
    fn record(&mut self, record: Record) {
        self.recording.record(record);
        self.timing.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        self.recording.event(at, event);
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_run_is_stored_and_checked_at_once() {
        use crate::trace::{drivers::A4988, run_sink::RunSink, timing::TimingCheck};
        use stepscope_sim::Experiment;

        let experiment = Experiment::from_json("{}").expect("the default motion");
        let timing = TimingCheck::new(&A4988.rules, experiment.config().clock_hz(), 10);
        let mut watched = RunSink { timing: Some(timing), ..RunSink::default() };
        experiment.run(&mut watched);
        assert!(watched.recording.digest.records() > 6400);
    }
}
