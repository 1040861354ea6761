//! Reading and writing memory (CONTROLLER G7).

use crate::journal::{self, Entry, ValidRecord};
use crate::state::{State, trust};
use crate::{controller::Controller, numbers::Numbers, parameters::Policy};

impl Controller {
    fn slots(&self) -> usize {
        self.parameters.memory.slots as usize
    }

    pub(crate) fn find_newest(&self) -> Option<ValidRecord> {
        journal::newest(self.eeprom.bytes(), self.slots())
    }

    /// Whether, by the memory, the axis may move.
    pub(crate) fn is_memory_open(&self) -> bool {
        !self.writes_journal && self.newest.is_some_and(|newest| newest.entry.is_open)
    }

    /// Completes the byte that is due, and with the last byte the record.
    pub(crate) fn complete_byte(&mut self, now: u64) {
        if !self.eeprom.complete(now) {
            return;
        }
        let before = self.newest;
        self.newest = self.find_newest();
        if core::mem::take(&mut self.writes_journal) {
            self.has_opening_record |= self.state == State::SelfTest;
            self.is_sequence_exhausted =
                self.state != State::SelfTest && before.is_some() && before == self.newest;
        }
    }

    /// Position and trust that a power-up would read; `None` without a valid record.
    pub(crate) fn stored_position(&self) -> Option<(i32, u8)> {
        let entry = self.find_newest()?.entry;
        Some((entry.position, if entry.is_open { trust::LOST } else { entry.trust.min(trust::HELD) }))
    }

    /// Reads position and numbers at the end of the self-test.
    pub(crate) fn read(&mut self) {
        self.newest = self.find_newest();
        let stored = self.stored_position();
        self.is_memory_invalid = stored.is_none();
        (self.position, self.trust) = stored.unwrap_or((0, trust::LOST));
        self.axis.set_initial_zero(self.position);
        let saved = journal::saved_numbers(self.eeprom.bytes(), self.slots(), self.parameters.number_count());
        self.numbers = saved
            .and_then(|numbers| Numbers::in_range(&self.parameters, numbers))
            .unwrap_or_else(|| Numbers::new(&self.parameters));
        self.has_unsaved_numbers = false;
    }

    /// Whether memory does not hold the position at a power failure.
    pub(crate) fn needs_closing_record(&self) -> bool {
        let differs = |newest: ValidRecord| {
            let entry = newest.entry;
            entry.is_open
                || entry.position != self.position
                || entry.trust.min(trust::HELD) != self.trust.min(trust::HELD)
        };
        self.is_memory_read && self.newest.is_none_or(differs)
    }

    /// Whether the journal record that is needed is an open one; `None` if none is needed.
    fn needed_record(&self) -> Option<bool> {
        match (self.state, self.parameters.memory.policy) {
            (State::Off, _) => None,
            (State::PowerLoss, _) => self.needs_closing_record().then_some(false),
            (_, Policy::PowerLoss) => self.needs_opening_record.then_some(true),
            _ if self.motion.as_ref().is_some_and(|motion| motion.waits_for_memory) => Some(true),
            (state, Policy::WriteAhead) => {
                let differs = |newest: ValidRecord| {
                    let entry = newest.entry;
                    entry.is_open || entry.position != self.position || entry.trust != self.trust
                };
                let is_idle = state.is_idle() && self.motion.is_none();
                (is_idle && self.newest.is_none_or(differs)).then_some(false)
            }
        }
    }

    /// Begins to write if memory is idle and a record is needed.
    pub(crate) fn begin_record(&mut self, now: u64) {
        if !self.eeprom.is_idle() {
            return;
        }
        if let Some(is_open) = self.needed_record() {
            let (group, loop_) =
                self.program.as_ref().map_or((0, 0), |program| (program.group, program.loop_));
            let entry = Entry {
                position: self.position,
                trust: self.trust,
                is_open,
                group: group as u8,
                loop_: loop_ as u16,
            };
            let (address, record) = journal::next_record(self.newest, self.slots(), entry);
            self.eeprom.begin(now, address, record, self.is_sequence_exhausted);
            self.writes_journal = true;
            self.needs_opening_record = false;
        } else if self.needs_number_save
            && !matches!(self.state, State::Off | State::SelfTest | State::PowerLoss)
        {
            let (address, bank) =
                journal::numbers_record(self.eeprom.bytes(), self.slots(), self.numbers.all());
            self.eeprom.begin(now, address, bank, false);
            (self.needs_number_save, self.is_sequence_exhausted) = (false, false);
        }
        if self.eeprom.is_idle() {
            self.is_sequence_exhausted = false;
        }
    }
}
