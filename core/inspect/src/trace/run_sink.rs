//! A stored run together with the timing check of its pulses.

use crate::{trace::stored_run::StoredRun, trace::timing::TimingCheck};
use stepscope_peripheral::signal::{Event, Record, Sink};
use stepscope_peripheral::units::Instant;

/// Stores a run and checks its timing in one pass. Without a check, [`Option`] is a sink that ignores records.
#[derive(Clone, Default)]
pub struct RunSink {
    pub stored: StoredRun,
    pub timing: Option<TimingCheck>,
}

impl Sink for RunSink {
    fn record(&mut self, record: Record) {
        self.stored.record(record);
        self.timing.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        // The timing check needs only records.
        self.stored.event(at, event);
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn one_pass_stores_and_checks_a_run() {
        use crate::trace::{drivers::A4988, run_sink::RunSink, timing::TimingCheck};
        use stepscope_sim::Experiment;

        let experiment = Experiment::from_json("{}").expect("the default motion");
        let timing = TimingCheck::new(&A4988.rules, experiment.config().clock_hz(), 10);
        let mut sink = RunSink { timing: Some(timing), ..RunSink::default() };
        experiment.run(&mut sink);
        assert!(sink.stored.digest.records() > 6400);
    }
}
