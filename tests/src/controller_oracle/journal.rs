//! G7: reading, and when a record or the numbers must be written.

use super::eeprom::Content;
use super::numbers::Numbers;
use super::parameters::Policy;
use super::room::{Room, State};

impl Room {
    /// Step 2 of G1.
    pub(super) fn byte_complete(&mut self) {
        if self.s.eeprom.byte_ends(&self.plan.controller) == Some(self.now) {
            let record = self.s.eeprom.byte_complete(self.now);
            self.s.self_test.opened |= record && self.s.state == State::SelfTest;
        }
    }

    /// The newest complete record is open and none is being written.
    pub(super) fn memory_is_open(&self) -> bool {
        !self.s.eeprom.is_writing_record() && self.s.eeprom.newest().is_some_and(|newest| newest.content.open)
    }

    /// None valid: position, trust 0; open: its position, trust 0; closed: its position, at most trust 1.
    pub(super) fn read_memory(&mut self) {
        self.s.memory_read = true;
        match self.s.eeprom.newest() {
            None => {
                self.s.self_test.none_valid = true;
                self.s.position = 0;
                self.s.trust = 0;
            }
            Some(newest) => {
                self.s.position = newest.content.position;
                self.s.trust = if newest.content.open { 0 } else { newest.content.trust.min(1) };
            }
        }
        let error = self.s.place - i64::from(self.s.position);
        self.s.place_of_zero.get_or_insert(error);
        let controller = &self.plan.controller;
        // Reading: if a number of the newest valid bank is out of range, the scenario's numbers apply, not the other bank.
        self.s.numbers = self
            .s
            .eeprom
            .newest_bank()
            .and_then(|(_, _, values)| Numbers::of_bank(controller, values))
            .unwrap_or_else(|| Numbers::of_scenario(controller));
        self.s.eeprom.opening_is_wanted = controller.memory.policy == Policy::PowerLoss;
    }

    /// In POWER_LOSS: read since power-up, and the newest is open or has another position or another min(trust, 1).
    pub(super) fn closing_record_is_wanted(&self) -> bool {
        self.s.state == State::PowerLoss
            && self.s.memory_read
            // Reading: a missing record counts as a different one.
            && self.s.eeprom.newest().is_none_or(|newest| {
                newest.content.open
                    || newest.content.position != self.s.position
                    || newest.content.trust.min(1) != self.s.trust.min(1)
            })
    }

    /// `write_ahead`: idle, and the newest record is open or has another position or trust.
    fn closed_record_is_wanted(&self) -> bool {
        let rests =
            matches!(self.s.state, State::Ready | State::Debug | State::Edit | State::Paused | State::Alarm);
        rests
            && self.s.motion.is_none()
            && !self.s.step
            // Reading: a missing record counts as a different one.
            && self.s.eeprom.newest().is_none_or(|newest| {
                newest.content.open
                    || newest.content.position != self.s.position
                    || newest.content.trust != self.s.trust
            })
    }

    /// The next record of the journal: `Some(open)`.
    fn record_wanted(&self) -> Option<bool> {
        if self.s.state == State::PowerLoss {
            return self.closing_record_is_wanted().then_some(false);
        }
        match self.plan.controller.memory.policy {
            Policy::PowerLoss => self.s.eeprom.opening_is_wanted.then_some(true),
            Policy::WriteAhead => {
                let waits = self.s.motion.as_ref().is_some_and(|motion| motion.waiting);
                if waits { Some(true) } else { self.closed_record_is_wanted().then_some(false) }
            }
        }
    }

    /// Step 5 of G1: an idle memory begins to write what is pending.
    pub(super) fn memory_begins(&mut self) {
        if !self.s.eeprom.is_idle() || self.s.state == State::Off {
            return;
        }
        if let Some(open) = self.record_wanted() {
            let (group, of_loop) =
                self.s.program.as_ref().map_or((0, 0), |program| (program.group, program.of_loop));
            let content = Content {
                position: self.s.position,
                trust: self.s.trust,
                open,
                group: group as u8,
                of_loop: of_loop as u16,
            };
            self.s.eeprom.opening_is_wanted = false;
            self.s.eeprom.begin_record(content, self.now);
        } else if self.s.eeprom.save_is_wanted && self.s.state != State::SelfTest {
            self.s.eeprom.save_is_wanted = false;
            self.s.eeprom.begin_bank(self.s.numbers.values(), self.now);
        }
    }

    /// POWER_LOSS begins in c.
    pub(super) fn drop_writes(&mut self) {
        self.s.eeprom.drop_rest(self.now);
    }

    /// OFF in c.
    pub(super) fn byte_dies(&mut self) {
        self.s.eeprom.byte_dies(self.now, self.plan.controller.memory.byte_write_cycles);
    }
}
