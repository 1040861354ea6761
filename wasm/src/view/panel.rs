//! Panels of stand-alone controllers (CONTROLLER.md G8).

use crate::{convert::numbers, view::simulation::Simulation};
use js_sys::Object;
use stepscope_core::controller::panel::PanelRecord;
use stepscope_core::peripheral::signal::{Event, Record, Sink};
use stepscope_core::peripheral::units::Instant;
use wasm_bindgen::prelude::*;

struct NullSink;

impl Sink for NullSink {
    fn record(&mut self, _: Record) {}
}

#[wasm_bindgen]
impl Simulation {
    /// History of a panel: `records` (cycle, word, position, display), `inputs` (cycle, number, raw level), `ignored` presses
    /// (cycle, number, state), `writes` per memory cell; undefined for an unknown controller.
    pub fn panel(&self, controller: usize) -> Option<Object> {
        let machine = self.run.stand_alone().filter(|machine| controller < machine.controllers())?;
        let record = |&PanelRecord { cycle, word, position, display }: &PanelRecord| {
            [cycle.0 as f64, word.0 as f64, position as f64, display as f64]
        };
        let result = Object::new();
        numbers(&result, "records", &machine.panel(controller).iter().flat_map(record).collect::<Vec<_>>());
        let ignored = machine.ignored(controller).iter();
        let ignored = ignored
            .flat_map(|press| [press.cycle.0, press.button as u64, press.state as u64].map(|x| x as f64));
        numbers(&result, "ignored", &ignored.collect::<Vec<_>>());
        let writes = machine.writes(controller).iter().copied().map(f64::from);
        numbers(&result, "writes", &writes.collect::<Vec<_>>());
        let mut inputs = Vec::new();
        for &(at, event) in &self.panels.inputs {
            if let Event::Input { controller: owner, input, level } = event
                && usize::from(owner) == controller
            {
                inputs.extend([at.0 as f64, f64::from(input), f64::from(u8::from(level))]);
            }
        }
        numbers(&result, "inputs", &inputs);
        Some(result)
    }

    /// State of a controller at the start of a cycle: word, position, display, position and error of its axis, pulses per
    /// unit, decimals, power of the windings, loops and groups.
    pub fn panel_at(&self, controller: usize, cycle: f64) -> Option<Vec<f64>> {
        let cycle = Instant(cycle.max(0.0) as u64);
        let mut machine = self.panels.last_stop(cycle)?.clone();
        machine.run(cycle, &mut NullSink);
        let numbers = machine.numbers(controller);
        Some(vec![
            machine.word(controller)?.0 as f64,
            f64::from(machine.position(controller)?),
            machine.display(controller)? as f64,
            machine.axis_position(controller)? as f64,
            machine.axis_error(controller)? as f64,
            f64::from(*numbers.first()?),
            f64::from(*numbers.get(1)?),
            f64::from(u8::from(machine.enabled(controller)?)),
            f64::from(*numbers.get(6)?),
            f64::from(*numbers.get(7)?),
        ])
    }
}
