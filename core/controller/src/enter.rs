//! Inputs that are entered during a run, for example by the buttons of a page.

use crate::input::{Change, Input};
use crate::{check, limits, machine::StandAlone, refusal::Refusal, script};
use core::fmt;
use stepscope_peripheral::units::Instant;

/// Why an input was not entered into a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotEntered {
    NoController,
    /// The cycle has passed or is out of range.
    Past {
        cycle: Instant,
        earliest: Instant,
    },
    Refused(Refusal),
}

impl fmt::Display for NotEntered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoController => f.write_str("there is no such controller"),
            Self::Past { cycle, earliest } => {
                let max = limits::INPUT_CYCLE.end();
                write!(f, "cycle {} is out of range; use {} to {max}", cycle.0, earliest.0)
            }
            Self::Refused(refusal) => refusal.fmt(f),
        }
    }
}

impl core::error::Error for NotEntered {}

impl StandAlone {
    /// Drops all inputs that have not been applied, so that only [entered](Self::enter) ones follow.
    pub fn drop_inputs(&mut self) {
        for (controller, due) in self.controllers.iter_mut().zip(&mut self.due) {
            controller.script.clear();
            *due = controller.due().max(self.now);
        }
    }

    /// Enters an input of a controller at cycle `at`. Power, emergency stop and clear of controller 0 apply to all.
    /// Errors: a cycle that has been run, and what a script must not contain.
    pub fn enter(&mut self, at: Instant, controller: usize, change: Change) -> Result<(), NotEntered> {
        let input = Input { cycle: at, change };
        let parameters = self.checked.controllers().get(controller).ok_or(NotEntered::NoController)?;
        if at.0 < self.now || !limits::INPUT_CYCLE.contains(&at.0.into()) {
            return Err(NotEntered::Past { cycle: at, earliest: Instant(self.now.max(1)) });
        }
        if let Some(refusal) = check::forbidden_change(parameters, controller, change) {
            return Err(NotEntered::Refused(refusal));
        }
        let own = self.controllers.get(controller).ok_or(NotEntered::NoController)?;
        if own.script.has(input) {
            return Err(NotEntered::Refused(Refusal::DuplicateInput { name: change.name(), cycle: at }));
        }
        self.insert(controller, input);
        Ok(())
    }

    /// Adds a valid input to the scripts of all controllers to which it applies.
    pub(crate) fn insert(&mut self, controller: usize, input: Input) {
        for (index, (other, due)) in self.controllers.iter_mut().zip(&mut self.due).enumerate() {
            if index == controller || script::is_shared(input.change) {
                other.script.enter(input);
                *due = (*due).min(input.cycle.0);
            }
        }
    }
}
