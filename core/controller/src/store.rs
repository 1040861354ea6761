//! Reading and writing memory (CONTROLLER G7).

use crate::{
    controller::Controller,
    journal::{self, Entry, Valid},
    numbers::Numbers,
    parameters::Policy,
    state::State,
};

impl Controller {
    fn slots(&self) -> usize {
        self.parameters.memory.slots as usize
    }

    pub(crate) fn find_newest(&self) -> Option<Valid> {
        journal::newest(self.eeprom.bytes(), self.slots())
    }

    pub(crate) fn is_memory_open(&self) -> bool {
        !self.writes_journal && self.newest.is_some_and(|newest| newest.entry.is_open)
    }

    /// Completes a byte that is due, and with its last byte the record.
    pub(crate) fn complete_byte(&mut self, now: u64) {
        if !self.eeprom.complete(now) {
            return;
        }
        let before = self.newest;
        self.newest = self.find_newest();
        if core::mem::take(&mut self.writes_journal) {
            self.is_opened |= self.state == State::SelfTest;
            self.is_stuck = self.state != State::SelfTest && before.is_some() && before == self.newest;
        }
    }

    /// Position and trust in memory; `None` without a valid record.
    pub(crate) fn believed(&self) -> Option<(i32, u8)> {
        let entry = self.find_newest()?.entry;
        Some((entry.position, if entry.is_open { 0 } else { entry.trust.min(1) }))
    }

    pub(crate) fn read(&mut self) {
        self.newest = self.find_newest();
        let believed = self.believed();
        self.is_unknown = believed.is_none();
        (self.position, self.trust) = believed.unwrap_or((0, 0));
        self.axis.memory_is_read(self.position);
        let saved = journal::saved(self.eeprom.bytes(), self.slots(), self.parameters.numbers());
        self.numbers = saved
            .and_then(|numbers| Numbers::in_range(&self.parameters, numbers))
            .unwrap_or_else(|| Numbers::new(&self.parameters));
        self.is_changed = false;
    }

    pub(crate) fn wants_closing(&self) -> bool {
        let differs = |newest: Valid| {
            let entry = newest.entry;
            entry.is_open || entry.position != self.position || entry.trust.min(1) != self.trust.min(1)
        };
        self.is_read && self.newest.is_none_or(differs)
    }

    /// Whether a journal record is needed, and whether it is an open one.
    fn wanted(&self) -> Option<bool> {
        match (self.state, self.parameters.memory.policy) {
            (State::Off, _) => None,
            (State::PowerLoss, _) => self.wants_closing().then_some(false),
            (_, Policy::PowerLoss) => self.wants_opening.then_some(true),
            _ if self.motion.as_ref().is_some_and(|motion| motion.waits) => Some(true),
            (state, Policy::WriteAhead) => {
                let differs = |newest: Valid| {
                    let entry = newest.entry;
                    entry.is_open || entry.position != self.position || entry.trust != self.trust
                };
                let rests = state.rests() && self.motion.is_none();
                (rests && self.newest.is_none_or(differs)).then_some(false)
            }
        }
    }

    /// Begins to write if memory is idle and a record is needed.
    pub(crate) fn begin_record(&mut self, now: u64) {
        if !self.eeprom.is_idle() {
            return;
        }
        if let Some(is_open) = self.wanted() {
            let (group, loop_) =
                self.program.as_ref().map_or((0, 0), |program| (program.group, program.loop_));
            let entry = Entry {
                position: self.position,
                trust: self.trust,
                is_open,
                group: group as u8,
                loop_: loop_ as u16,
            };
            let (address, record) = journal::next(self.newest, self.slots(), entry);
            self.eeprom.begin(now, address, record, self.is_stuck);
            self.writes_journal = true;
            self.wants_opening = false;
        } else if self.wants_save && !matches!(self.state, State::Off | State::SelfTest | State::PowerLoss) {
            let (address, bank) = journal::save(self.eeprom.bytes(), self.slots(), self.numbers.all());
            self.eeprom.begin(now, address, bank, false);
            (self.wants_save, self.is_stuck) = (false, false);
        }
        if self.eeprom.is_idle() {
            self.is_stuck = false;
        }
    }
}
