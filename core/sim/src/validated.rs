//! A scenario that is read, validated and planned once per edit, for the run and the study.

use crate::Experiment;
use alloc::sync::Arc;
use stepscope_motion::{AxisPlan, moves::Axis};
use stepscope_peripheral::config::Bus;
use stepscope_scenario::{Problem, Problems, Scenario, Source};

/// A scenario with the result of its validation. Cheap to clone.
#[derive(Clone, Debug)]
pub struct ValidatedScenario {
    scenario: Arc<Scenario>,
    unreadable: Option<Arc<Problems>>,
    result: Result<Arc<Experiment>, Arc<Problems>>,
}

/// An axis with its plan and its bus.
#[derive(Clone, Copy, Debug)]
pub struct SelectedAxis<'a> {
    pub scenario: &'a Scenario,
    pub bus: &'a Bus,
    pub axis: &'a Axis,
    pub plan: &'a AxisPlan,
}

impl ValidatedScenario {
    /// Reads and validates a text. A field that cannot be read has its default.
    pub fn from_json(text: &str) -> Self {
        let (scenario, unreadable) = Scenario::from_json_lenient(text);
        Self::of(scenario, unreadable)
    }

    fn of(scenario: Scenario, unreadable: Option<Problems>) -> Self {
        let result = Experiment::from_partial(&scenario, unreadable.clone()).map(Arc::new).map_err(Arc::new);
        Self { scenario: Arc::new(scenario), unreadable: unreadable.map(Arc::new), result }
    }

    pub const fn scenario(&self) -> &Arc<Scenario> {
        &self.scenario
    }

    /// The problems of fields that could not be read.
    pub fn unreadable(&self) -> Option<&Problems> {
        self.unreadable.as_deref()
    }

    /// The experiment to run. Errors: every problem of the scenario, each with its path.
    pub fn experiment(&self) -> Result<&Arc<Experiment>, &Problems> {
        self.result.as_ref().map_err(|problems| &**problems)
    }

    /// All problems; empty if the scenario is valid.
    pub fn problems(&self) -> &[Problem] {
        self.result.as_ref().err().map_or(&[], |problems| problems)
    }

    /// An axis with its plan; `None` if it does not exist or the scenario has problems.
    pub fn axis(&self, controller: usize, axis: usize) -> Option<SelectedAxis<'_>> {
        let plan = self.experiment().ok()?.plans_of(controller).get(axis)?;
        let scenario = &*self.scenario;
        let bus = bus_of(scenario, controller)?;
        Some(SelectedAxis { scenario, bus, axis: axes_of(scenario, controller).get(axis)?, plan })
    }
}

impl From<Scenario> for ValidatedScenario {
    fn from(scenario: Scenario) -> Self {
        Self::of(scenario, None)
    }
}

/// The bus of a controller; `None` if it does not exist.
pub fn bus_of(scenario: &Scenario, controller: usize) -> Option<&Bus> {
    match controller.checked_sub(1) {
        None => Some(&scenario.bus),
        Some(index) => scenario.controllers.get(index).map(|controller| &controller.bus),
    }
}

/// The axes of a controller; empty if the source is not a motion.
pub fn axes_of(scenario: &Scenario, controller: usize) -> &[Axis] {
    match (&scenario.source, controller.checked_sub(1)) {
        (Source::Motion(motion), None) => &motion.axes,
        (Source::Motion(_), Some(index)) => {
            scenario.controllers.get(index).map_or(&[], |controller| &controller.axes)
        }
        _ => &[],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_peripheral::trace::Digest;

    #[test]
    fn a_scenario_is_read_and_planned_once() {
        let json = r#"{"bus":{"channels":2},"source":{"motion":{"axes":[{},{"moves":[{"dwell":{}}]}]}}}"#;
        let validated = ValidatedScenario::from_json(json);
        let experiment = validated.experiment().expect("no problems");
        let mut digest = Digest::default();
        experiment.run(&mut digest);
        for axis in 0..2 {
            let selected = validated.axis(0, axis).expect("it is there");
            assert!(core::ptr::eq(selected.plan, &experiment.plans()[axis]));
            assert_eq!(selected.axis.moves.len(), selected.plan.moves().len());
        }
        assert!(validated.axis(0, 2).is_none() && validated.axis(1, 0).is_none());
        assert!(digest.records() > 1);
    }

    #[test]
    fn a_scenario_with_problems_has_no_experiment_and_no_axis() {
        let validated = ValidatedScenario::from_json(r#"{"title":"kept","bus":{"slots":0}}"#);
        assert_eq!(validated.problems().len(), 1);
        assert_eq!(validated.scenario().title, "kept");
        assert!(validated.experiment().is_err() && validated.axis(0, 0).is_none());
    }
}
