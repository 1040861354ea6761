//! Panels of controllers without a serial line, as CSV rows and as signals of a dump (CONTROLLER.md G8).

use alloc::{format, string::String, vec::Vec};
use core::fmt::{self, Write};
use stepscope_controller::panel::{PanelRecord, Word};
use stepscope_controller::{CheckedSetup, State, input::Signal, trust_name};
use stepscope_peripheral::signal::Event;

/// The CSV header of [`write_panel_row`].
pub const PANEL_HEAD: &str =
    "controller,cycle,time_s,word,position,display,state,alarm,trust,outputs,group,loop\n";

/// Writes a panel of controller `index` as a CSV row, with the time in s.
pub fn write_panel_row(
    out: &mut impl Write,
    index: usize,
    record: PanelRecord,
    clock_hz: u32,
) -> fmt::Result {
    let PanelRecord { cycle, word, position, display } = record;
    write!(out, "{index},{},{},{},{position},{display},", cycle.0, cycle.seconds(clock_hz), word.0)?;
    let trust = trust_name(word.trust());
    write!(out, "{},{},{trust},{},", word.state().name(), word.alarm().name(), word.outputs())?;
    writeln!(out, "{},{}", word.group(), word.loop_())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PanelValue {
    State,
    Alarm,
    Trust,
    Outputs,
    Group,
    Loop,
    Input(Signal),
}

/// Values of a panel, with their names and widths in bits.
const SHOWN: [(PanelValue, &str, u32); 6] = [
    (PanelValue::State, "state", 4),
    (PanelValue::Alarm, "alarm", 4),
    (PanelValue::Trust, "trust", 2),
    (PanelValue::Outputs, "outputs", 4),
    (PanelValue::Group, "group", 9),
    (PanelValue::Loop, "loop", 16),
];

/// The signals of all panels, and the raw levels of the inputs in use.
#[derive(Clone, Debug)]
pub struct PanelSignals {
    signals: Vec<PanelSignal>,
}

/// One signal of a dump with its current value.
#[derive(Clone, Debug)]
pub struct PanelSignal {
    controller: u8,
    source: PanelValue,
    pub name: String,
    pub bits: u32,
    pub value: u64,
}

impl PanelSignals {
    /// The signals of every controller, with their values after reset.
    pub fn new(checked: &CheckedSetup) -> Self {
        let mut signals = Vec::new();
        for (index, parameters) in checked.controllers().iter().enumerate() {
            let controller = index as u8;
            for (source, name, bits) in SHOWN {
                let value = if source == PanelValue::State { State::SelfTest as u64 } else { 0 };
                signals.push(PanelSignal { controller, source, name: format!("{name}{index}"), bits, value });
            }
            for signal in parameters.inputs_used() {
                let name = format!("{}_{index}", signal.name());
                let value = u64::from(signal == Signal::Power);
                signals.push(PanelSignal {
                    controller,
                    source: PanelValue::Input(signal),
                    name,
                    bits: 1,
                    value,
                });
            }
        }
        Self { signals }
    }

    /// In the order of controllers.
    pub fn signals(&self) -> &[PanelSignal] {
        &self.signals
    }

    /// Applies an event; returns whether it was a panel or an input.
    pub fn take(&mut self, event: Event) -> bool {
        match event {
            Event::Panel { controller, word, .. } => {
                let word = Word(word);
                for signal in self.signals.iter_mut().filter(|signal| signal.controller == controller) {
                    signal.value = match signal.source {
                        PanelValue::State => word.state() as u64,
                        PanelValue::Alarm => word.alarm() as u64,
                        PanelValue::Trust => word.trust().into(),
                        PanelValue::Outputs => word.outputs().into(),
                        PanelValue::Group => word.group().into(),
                        PanelValue::Loop => word.loop_().into(),
                        PanelValue::Input(_) => continue,
                    };
                }
                true
            }
            Event::Input { controller, input, level } => {
                let mut signals = self.signals.iter_mut();
                let is_input = |signal: &&mut PanelSignal| {
                    signal.controller == controller
                        && matches!(signal.source, PanelValue::Input(own) if own as u8 == input)
                };
                if let Some(signal) = signals.find(is_input) {
                    signal.value = level.into();
                }
                true
            }
            _ => false,
        }
    }
}

impl PanelSignal {
    /// The level as text: states, alarms and trust by name.
    pub fn text(&self) -> String {
        let word = |shift: u32| Word(self.value << shift);
        match self.source {
            PanelValue::State => word(0).state().name().into(),
            PanelValue::Alarm => word(4).alarm().name().into(),
            PanelValue::Trust => trust_name(word(8).trust()).into(),
            _ => format!("{}", self.value),
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_panel_record_is_one_csv_row() {
        use crate::export::panel::write_panel_row;
        use stepscope_controller::panel::{PanelRecord, Word};
        use stepscope_peripheral::units::Instant;

        let record = PanelRecord { cycle: Instant(1600), word: Word(2 | 2 << 8), position: 565, display: 10 };
        let mut row = String::new();
        write_panel_row(&mut row, 0, record, 16_000_000).expect("a string takes it");
        assert_eq!(row, "0,1600,0.0001,514,565,10,READY,,SURE,0,0,0\n");
    }
}
