//! History of the panels of stand-alone controllers during a run.

use stepscope_core::controller::StandAlone;
use stepscope_core::peripheral::{signal::Event, units::Instant};

/// Maximum saved states.
const STOPS: usize = 64;

pub(crate) struct PanelLog {
    pub(crate) inputs: Vec<(Instant, Event)>,
    /// States of the controllers at regular intervals.
    stops: Vec<StandAlone>,
    /// Slices between states, and since the last one.
    apart: usize,
    since: usize,
}

impl Default for PanelLog {
    fn default() -> Self {
        Self { inputs: Vec::new(), stops: Vec::new(), apart: 1, since: 0 }
    }
}

impl PanelLog {
    pub(crate) fn last_stop(&self, cycle: Instant) -> Option<&StandAlone> {
        self.stops.iter().rfind(|stop| stop.now() <= cycle)
    }

    /// Saves the state if it is due.
    pub(crate) fn save_stop(&mut self, machine: Option<&StandAlone>) {
        let Some(machine) = machine else { return };
        self.since += 1;
        if !self.stops.is_empty() && self.since < self.apart {
            return;
        }
        self.since = 0;
        let mut stop = machine.clone();
        // The run has the panel history.
        for index in 0..stop.controllers() {
            stop.take_panel(index);
        }
        self.stops.push(stop);
        if self.stops.len() > STOPS {
            // Keep every second one.
            let mut index = 0;
            self.stops.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.apart *= 2;
        }
    }
}
