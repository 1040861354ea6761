//! Panels of controllers without a serial line, as CSV rows and as signals of a dump (CONTROLLER.md G8).

use alloc::{format, string::String, vec::Vec};
use core::fmt::{self, Write};
use stepscope_controller::{
    CheckedSetup, State,
    input::Signal,
    panel::{PanelRecord, Word},
    trust_name,
};
use stepscope_peripheral::signal::Event;

pub const PANEL_HEAD: &str =
    "controller,cycle,time_s,word,position,display,state,alarm,trust,outputs,group,loop\n";

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
enum What {
    State,
    Alarm,
    Trust,
    Outputs,
    Group,
    Loop,
    Input(Signal),
}

const SHOWN: [(What, &str, u32); 6] = [
    (What::State, "state", 4),
    (What::Alarm, "alarm", 4),
    (What::Trust, "trust", 2),
    (What::Outputs, "outputs", 4),
    (What::Group, "group", 9),
    (What::Loop, "loop", 16),
];

/// The signals of all panels, and the raw levels of the inputs in use.
#[derive(Clone, Debug)]
pub struct PanelSignals {
    signals: Vec<PanelSignal>,
}

#[derive(Clone, Debug)]
pub struct PanelSignal {
    controller: u8,
    what: What,
    pub name: String,
    pub bits: u32,
    pub value: u64,
}

impl PanelSignals {
    pub fn new(checked: &CheckedSetup) -> Self {
        let mut signals = Vec::new();
        for (index, parameters) in checked.controllers().iter().enumerate() {
            let controller = index as u8;
            for (what, name, bits) in SHOWN {
                let value = if what == What::State { State::SelfTest as u64 } else { 0 };
                signals.push(PanelSignal { controller, what, name: format!("{name}{index}"), bits, value });
            }
            for signal in parameters.inputs_used() {
                let name = format!("{}_{index}", signal.name());
                let value = u64::from(signal == Signal::Power);
                signals.push(PanelSignal { controller, what: What::Input(signal), name, bits: 1, value });
            }
        }
        Self { signals }
    }

    pub fn signals(&self) -> &[PanelSignal] {
        &self.signals
    }

    pub fn take(&mut self, event: Event) -> bool {
        match event {
            Event::Panel { controller, word, .. } => {
                let word = Word(word);
                for signal in self.signals.iter_mut().filter(|signal| signal.controller == controller) {
                    signal.value = match signal.what {
                        What::State => word.state() as u64,
                        What::Alarm => word.alarm() as u64,
                        What::Trust => word.trust().into(),
                        What::Outputs => word.outputs().into(),
                        What::Group => word.group().into(),
                        What::Loop => word.loop_().into(),
                        What::Input(_) => continue,
                    };
                }
                true
            }
            Event::Input { controller, input, level } => {
                let mut signals = self.signals.iter_mut();
                let is_it = |signal: &&mut PanelSignal| {
                    signal.controller == controller
                        && matches!(signal.what, What::Input(own) if own as u8 == input)
                };
                if let Some(signal) = signals.find(is_it) {
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
        match self.what {
            What::State => word(0).state().name().into(),
            What::Alarm => word(4).alarm().name().into(),
            What::Trust => trust_name(word(8).trust()).into(),
            _ => format!("{}", self.value),
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_panel_is_a_row_of_each_record() {
        use crate::export::panel::write_panel_row;
        use stepscope_controller::panel::{PanelRecord, Word};
        use stepscope_peripheral::units::Instant;

        let record = PanelRecord { cycle: Instant(1600), word: Word(2 | 2 << 8), position: 565, display: 10 };
        let mut row = String::new();
        write_panel_row(&mut row, 0, record, 16_000_000).expect("a string takes it");
        assert_eq!(row, "0,1600,0.0001,514,565,10,READY,,SURE,0,0,0\n");
    }
}
