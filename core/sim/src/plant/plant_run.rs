//! A run whose plants are observed at each point of their time grid.

use crate::{Experiment, Run, RunLimits};
use alloc::vec::Vec;
use core::ops::Deref;
use stepscope_peripheral::signal::Sink;
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_plant::Observer;

/// A run with a sink and an observer of the plant per controller; dereferences to [`Run`].
///
/// ```
/// use stepscope_sim::{Experiment, plant_run::PlantRun};
///
/// let experiment = Experiment::from_json(r#"{ "plant": {} }"#).expect("no problems");
/// let mut run = PlantRun::new(&experiment, vec![(Vec::new(), ())]).expect("the scenario has a plant");
/// run.finish();
/// assert_eq!(run.results()[0].motors[0].lost, 0); // no lost steps
/// ```
pub struct PlantRun<S, O> {
    run: Run,
    sinks: Vec<S>,
    observers: Vec<O>,
}

impl<S: Sink, O: Observer> PlantRun<S, O> {
    /// Starts a run with a sink and an observer per controller, in the order of the scenario; `None` without a plant.
    pub fn new(experiment: &Experiment, parts: Vec<(S, O)>) -> Option<Self> {
        experiment.plants()?;
        let (sinks, observers) = parts.into_iter().unzip();
        Some(Self { run: experiment.start(), sinks, observers })
    }

    /// Replaces the sink and the observer of a controller.
    pub fn attach(&mut self, controller: usize, sink: S, observer: O) {
        if let (Some(sinks), Some(observers)) =
            (self.sinks.get_mut(controller), self.observers.get_mut(controller))
        {
            (*sinks, *observers) = (sink, observer);
        }
    }

    /// The first cycle that has not been run.
    pub fn now(&self) -> Instant {
        Instant(self.run.cycles().0)
    }

    /// The sinks and observers in the order of the scenario.
    pub fn into_parts(self) -> Vec<(S, O)> {
        self.sinks.into_iter().zip(self.observers).collect()
    }

    pub fn finish(&mut self) {
        while !self.advance(Cycles(1 << 32)) {}
    }

    /// Runs to the end clock by clock.
    pub fn finish_clock_by_clock(&mut self) {
        while !self.run.is_done() {
            self.run.clock_observed(&mut self.sinks, &mut self.observers);
        }
    }

    /// Runs `cycles` more, at least one, or to the end; true at the end.
    pub fn advance(&mut self, cycles: Cycles) -> bool {
        let cycle = Instant(self.now().0.saturating_add(cycles.0.max(1)));
        self.run.advance_observed(
            RunLimits { cycle, ..RunLimits::default() },
            &mut self.sinks,
            &mut self.observers,
        )
    }
}

impl<S, O> Deref for PlantRun<S, O> {
    type Target = Run;

    fn deref(&self) -> &Run {
        &self.run
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_plant_is_observed_point_by_point() {
        use crate::{Experiment, plant_run::PlantRun};

        // One full turn by the default motion, with the default motor behind the bus.
        let experiment = Experiment::from_json(r#"{ "plant": {} }"#).expect("no problem");
        let mut run = PlantRun::new(&experiment, vec![(Vec::new(), ())]).expect("it has a plant");
        run.finish();
        let result = &run.results()[0];
        assert_eq!(result.motors[0].lost, 0);
        assert!((result.motors[0].state.x - 200.0).abs() < 0.1);
    }
}
