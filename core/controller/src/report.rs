//! What a machine tells of its controllers.

use crate::{
    checked::CheckedSetup,
    controller::Press,
    machine::StandAlone,
    panel::{self, PanelRecord},
    state::{Alarm, State},
};
use alloc::vec::Vec;
use stepscope_peripheral::{signal::MAX_CHANNELS, units::Instant};

/// What is asked of controller `i`; `None` or nothing where there is none.
impl StandAlone {
    /// What they were made of.
    #[must_use]
    pub const fn checked(&self) -> &CheckedSetup {
        &self.checked
    }

    /// Position counters of the bus: rising STEP edges since cycle 0, +1 where DIR is 1, -1 where it is 0. What a
    /// controller believes is [`Self::position`].
    #[must_use]
    pub fn positions(&self) -> [i32; MAX_CHANNELS] {
        let mut positions = [0; MAX_CHANNELS];
        for (position, controller) in positions.iter_mut().zip(&self.controllers) {
            *position = controller.steps;
        }
        positions
    }

    /// How many controllers there are.
    #[must_use]
    pub const fn controllers(&self) -> usize {
        self.controllers.len()
    }

    /// Groups that have begun, of all controllers: with more than [`crate::limits::MAX_GROUPS_BEGUN`] the run ends.
    #[must_use]
    pub const fn groups_begun(&self) -> u64 {
        self.begun
    }

    /// The panels' records that are kept, controller after controller.
    pub fn panels(&self) -> impl Iterator<Item = &[PanelRecord]> {
        self.controllers.iter().map(|controller| controller.panel.as_slice())
    }

    /// When the byte that its memory is writing was begun; `None` where it writes none.
    #[must_use]
    pub fn writing_since(&self, i: usize) -> Option<Instant> {
        self.controllers.get(i)?.eeprom.begun().map(Instant)
    }

    /// Whether a jog goes on for ever unless an input changes: its button stays pressed, and no limit is ahead.
    #[must_use]
    pub fn jogs_without_end(&self) -> bool {
        self.controllers.iter().any(crate::controller::Controller::jogs_without_end)
    }

    /// Its state.
    #[must_use]
    pub fn state(&self, i: usize) -> Option<State> {
        Some(self.controllers.get(i)?.state)
    }

    /// Its alarm.
    #[must_use]
    pub fn alarm(&self, i: usize) -> Option<Alarm> {
        Some(self.controllers.get(i)?.alarm)
    }

    /// Its trust: 0 LOST, 1 HELD, 2 SURE.
    #[must_use]
    pub fn trust(&self, i: usize) -> Option<u8> {
        Some(self.controllers.get(i)?.trust)
    }

    /// Its position in steps.
    #[must_use]
    pub fn position(&self, i: usize) -> Option<i32> {
        Some(self.controllers.get(i)?.position)
    }

    /// Its word for the panel, as it is now: state, alarm, trust, outputs, group and loop.
    #[must_use]
    pub fn word(&self, i: usize) -> Option<panel::Word> {
        Some(self.controllers.get(i)?.word())
    }

    /// What its display shows, as it is now.
    #[must_use]
    pub fn display(&self, i: usize) -> Option<i64> {
        Some(self.controllers.get(i)?.display())
    }

    /// The group that runs or is next, from 1; 0 without program.
    #[must_use]
    pub fn group(&self, i: usize) -> Option<u32> {
        Some(self.controllers.get(i)?.program.as_ref().map_or(0, |program| program.group))
    }

    /// The loop, from 1; 0 without program.
    #[must_use]
    pub fn loop_(&self, i: usize) -> Option<u32> {
        Some(self.controllers.get(i)?.program.as_ref().map_or(0, |program| program.loop_))
    }

    /// Its outputs 0 to 3, a bit each.
    #[must_use]
    pub fn outputs(&self, i: usize) -> Option<u8> {
        Some(self.controllers.get(i)?.outputs)
    }

    /// Its own EN; the bus shows the AND of all.
    #[must_use]
    pub fn enabled(&self, i: usize) -> Option<bool> {
        Some(self.controllers.get(i)?.pins.en)
    }

    /// The numbers that rule: the eight common ones, then five of each `move`.
    #[must_use]
    pub fn numbers(&self, i: usize) -> &[i32] {
        self.controllers.get(i).map_or(&[], |controller| controller.numbers.all())
    }

    /// Image of its EEPROM, from address 0.
    #[must_use]
    pub fn memory(&self, i: usize) -> &[u8] {
        self.controllers.get(i).map_or(&[], |controller| controller.eeprom.bytes())
    }

    /// Writes of each byte's cell: those that are complete, or were cut.
    #[must_use]
    pub fn writes(&self, i: usize) -> &[u32] {
        self.controllers.get(i).map_or(&[], |controller| controller.eeprom.writes())
    }

    /// Position and trust that it would read if its power came back now with this memory; `None` where no record is
    /// valid. With trust 0 the position is not known.
    #[must_use]
    pub fn believed_after_power_up(&self, i: usize) -> Option<(i32, u8)> {
        self.controllers.get(i)?.believed()
    }

    /// m: the place of its axis in steps.
    #[must_use]
    pub fn axis_place(&self, i: usize) -> Option<i64> {
        Some(self.controllers.get(i)?.axis.place())
    }

    /// m - position, less what it was when zero was set last, and before that less what it was when memory was first read.
    #[must_use]
    pub fn axis_error(&self, i: usize) -> Option<i64> {
        let controller = self.controllers.get(i)?;
        Some(controller.axis.error(controller.position))
    }

    /// Presses that did nothing, in order: at most one for each press.
    #[must_use]
    pub fn ignored(&self, i: usize) -> &[Press] {
        self.controllers.get(i).map_or(&[], |controller| &controller.ignored)
    }

    /// Records of its panel since cycle 0 or the last [`Self::take_panel`]. A run has at most a few for each group that
    /// begins ([`MAX_GROUPS_BEGUN`](crate::limits::MAX_GROUPS_BEGUN)) and each input.
    #[must_use]
    pub fn panel(&self, i: usize) -> &[PanelRecord] {
        self.controllers.get(i).map_or(&[], |controller| &controller.panel)
    }

    /// Takes the records of its panel; those that follow are kept anew.
    pub fn take_panel(&mut self, i: usize) -> Vec<PanelRecord> {
        self.controllers
            .get_mut(i)
            .map(|controller| core::mem::take(&mut controller.panel))
            .unwrap_or_default()
    }

    /// Digest of the panels that are kept, controller after controller: of the whole run if none was taken.
    #[must_use]
    pub fn panel_digest(&self) -> u64 {
        panel::digest(self.controllers.iter().map(|controller| controller.panel.as_slice()))
    }
}
