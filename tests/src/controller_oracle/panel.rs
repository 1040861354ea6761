//! G8: the contents of the panel, and when it is recorded.

use super::arithmetic::display_of_position;
use super::room::{Room, State};

/// A panel record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "G8's words")]
pub struct PanelRecord {
    pub cycle: u64,
    pub word: u64,
    pub position: i32,
    pub display: i64,
}

impl Room {
    /// bits 0..3 state, 4..7 alarm, 8..9 trust, 12..15 outputs, 16..24 group (in EDIT the number), 32..47 loop.
    fn word(&self) -> u64 {
        let (group, of_loop) = match &self.s.program {
            _ if self.s.state == State::Edit => (self.s.edit.number as u64, 0),
            Some(program) => (program.group as u64, u64::from(program.of_loop)),
            None => (0, 0),
        };
        self.s.state as u64
            | (self.s.alarm as u64) << 4
            | u64::from(self.s.trust) << 8
            | u64::from(self.s.outputs) << 12
            | group << 16
            | of_loop << 32
    }

    fn display(&self) -> i64 {
        if self.s.state == State::Edit {
            return self.s.edit.entry.unwrap_or(self.s.numbers.value(self.s.edit.number));
        }
        let numbers = &self.s.numbers;
        display_of_position(self.s.position, numbers.pulses_per_unit(), numbers.decimals())
    }

    /// A record of the state at the end of the previous cycle: at 0, then if the word, or in EDIT the display, changed.
    pub(super) fn show(&mut self) {
        let record = PanelRecord {
            cycle: self.now,
            word: self.word(),
            position: self.s.position,
            display: self.display(),
        };
        // In EDIT each change of the display has its record, so the last record has the display of the previous cycle.
        let is_new = self.panel.last().is_none_or(|last| {
            last.word != record.word || (self.s.state == State::Edit && last.display != record.display)
        });
        if is_new {
            self.panel.push(record);
        }
    }
}
