//! What is saved of the panels of stand-alone controllers during a run.

use stepscope_core::{
    controller::StandAlone,
    peripheral::{signal::Event, units::Instant},
};

/// Maximum number of saved states, so that few questions have to begin at cycle 0.
const STOPS: usize = 64;

/// What is saved of the panels during a run.
pub(crate) struct PanelLog {
    /// What was switched at the panels.
    pub(crate) inputs: Vec<(Instant, Event)>,
    /// The controllers at some cycles of the run, at equal numbers of slices.
    stops: Vec<StandAlone>,
    /// Slices from one of them to the next, and those since the last one.
    apart: usize,
    since: usize,
}

impl Default for PanelLog {
    fn default() -> Self {
        Self { inputs: Vec::new(), stops: Vec::new(), apart: 1, since: 0 }
    }
}

impl PanelLog {
    /// The last saved state up to a cycle.
    pub(crate) fn last_stop(&self, cycle: Instant) -> Option<&StandAlone> {
        self.stops.iter().rfind(|stop| stop.now() <= cycle)
    }

    /// Saves the controllers' state if the run has come far enough since the last one.
    pub(crate) fn save_stop(&mut self, machine: Option<&StandAlone>) {
        let Some(machine) = machine else { return };
        self.since += 1;
        if !self.stops.is_empty() && self.since < self.apart {
            return;
        }
        self.since = 0;
        let mut stop = machine.clone();
        // The run itself has what its panel has shown.
        for index in 0..stop.controllers() {
            stop.take_panel(index);
        }
        self.stops.push(stop);
        if self.stops.len() > STOPS {
            // Every other one goes, and new ones are half as frequent.
            let mut index = 0;
            self.stops.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.apart *= 2;
        }
    }
}
