//! Inputs entered during a run, for example on a page.

use crate::{
    check,
    input::{Change, Input},
    limits,
    machine::StandAlone,
    refusal::Refusal,
    script,
};
use core::fmt;
use stepscope_peripheral::units::Instant;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotEntered {
    NoController,
    /// Its cycle has passed, or is out of range.
    Past {
        cycle: Instant,
        least: Instant,
    },
    Refused(Refusal),
}

impl fmt::Display for NotEntered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoController => f.write_str("there is no such controller"),
            Self::Past { cycle, least } => {
                let greatest = limits::INPUT_CYCLE.end();
                write!(f, "cycle {} is out of range; give {} to {greatest}", cycle.0, least.0)
            }
            Self::Refused(refusal) => refusal.fmt(f),
        }
    }
}

impl core::error::Error for NotEntered {}

impl StandAlone {
    /// Drops the rest of the scripts: from now on only entered inputs count.
    pub fn drop_inputs(&mut self) {
        for (controller, due) in self.controllers.iter_mut().zip(&mut self.due) {
            controller.script.clear();
            *due = controller.due().max(self.now);
        }
    }

    /// Enters an input in a cycle that has not been run.
    /// Errors: as for an entry of a script.
    pub fn enter(&mut self, at: Instant, controller: usize, change: Change) -> Result<(), NotEntered> {
        let input = Input { cycle: at, change };
        let parameters = self.checked.controllers().get(controller).ok_or(NotEntered::NoController)?;
        if at.0 < self.now || !limits::INPUT_CYCLE.contains(&at.0.into()) {
            return Err(NotEntered::Past { cycle: at, least: Instant(self.now.max(1)) });
        }
        if let Some(refusal) = check::forbidden_change(parameters, controller, change) {
            return Err(NotEntered::Refused(refusal));
        }
        let own = self.controllers.get(controller).ok_or(NotEntered::NoController)?;
        if own.script.has(input) {
            return Err(NotEntered::Refused(Refusal::Twice { name: change.name(), cycle: at }));
        }
        self.insert(controller, input);
        Ok(())
    }

    /// Adds a valid entry to the scripts of all controllers that it is for.
    pub(crate) fn insert(&mut self, controller: usize, input: Input) {
        let is_for = |index| index == controller || script::is_shared(input.change);
        for (index, (other, due)) in self.controllers.iter_mut().zip(&mut self.due).enumerate() {
            if is_for(index) {
                other.script.enter(input);
                *due = (*due).min(input.cycle.0);
            }
        }
    }
}
