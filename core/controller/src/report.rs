//! Queries to a machine and its controllers.

use crate::{
    checked::CheckedSetup,
    controller::Press,
    machine::StandAlone,
    panel::{self, PanelRecord},
    state::{Alarm, State},
};
use alloc::vec::Vec;
use stepscope_peripheral::{signal::MAX_CHANNELS, units::Instant};

/// Queries to controller `i` return `None` or nothing if it does not exist.
impl StandAlone {
    #[must_use]
    pub const fn checked(&self) -> &CheckedSetup {
        &self.checked
    }

    /// Position counters of the bus: +1 per rising STEP edge with DIR 1, -1 with DIR 0. [`Self::position`] is what a
    /// controller assumes.
    #[must_use]
    pub fn positions(&self) -> [i32; MAX_CHANNELS] {
        let mut positions = [0; MAX_CHANNELS];
        for (position, controller) in positions.iter_mut().zip(&self.controllers) {
            *position = controller.steps;
        }
        positions
    }

    #[must_use]
    pub const fn controllers(&self) -> usize {
        self.controllers.len()
    }

    /// Groups of all controllers that have begun; more than [`crate::limits::MAX_GROUPS_BEGUN`] end the run.
    #[must_use]
    pub const fn groups_begun(&self) -> u64 {
        self.begun
    }

    pub fn panels(&self) -> impl Iterator<Item = &[PanelRecord]> {
        self.controllers.iter().map(|controller| controller.panel.as_slice())
    }

    /// When its memory began to write the current byte.
    #[must_use]
    pub fn writing_since(&self, i: usize) -> Option<Instant> {
        self.controllers.get(i)?.eeprom.begun().map(Instant)
    }

    /// Whether a jog never ends: its button stays pressed, and no limit is ahead.
    #[must_use]
    pub fn jogs_without_end(&self) -> bool {
        self.controllers.iter().any(crate::controller::Controller::jogs_without_end)
    }

    #[must_use]
    pub fn state(&self, i: usize) -> Option<State> {
        Some(self.controllers.get(i)?.state)
    }

    #[must_use]
    pub fn alarm(&self, i: usize) -> Option<Alarm> {
        Some(self.controllers.get(i)?.alarm)
    }

    /// 0 LOST, 1 HELD, 2 SURE.
    #[must_use]
    pub fn trust(&self, i: usize) -> Option<u8> {
        Some(self.controllers.get(i)?.trust)
    }

    #[must_use]
    pub fn position(&self, i: usize) -> Option<i32> {
        Some(self.controllers.get(i)?.position)
    }

    /// The panel's current word: state, alarm, trust, outputs, group and loop.
    #[must_use]
    pub fn word(&self, i: usize) -> Option<panel::Word> {
        Some(self.controllers.get(i)?.word())
    }

    #[must_use]
    pub fn display(&self, i: usize) -> Option<i64> {
        Some(self.controllers.get(i)?.display())
    }

    /// The current or next group from 1; 0 without program.
    #[must_use]
    pub fn group(&self, i: usize) -> Option<u32> {
        Some(self.controllers.get(i)?.program.as_ref().map_or(0, |program| program.group))
    }

    /// The current loop from 1; 0 without program.
    #[must_use]
    pub fn loop_(&self, i: usize) -> Option<u32> {
        Some(self.controllers.get(i)?.program.as_ref().map_or(0, |program| program.loop_))
    }

    /// Outputs 0 to 3, one bit each.
    #[must_use]
    pub fn outputs(&self, i: usize) -> Option<u8> {
        Some(self.controllers.get(i)?.outputs)
    }

    /// Its EN; the bus has the AND of all.
    #[must_use]
    pub fn enabled(&self, i: usize) -> Option<bool> {
        Some(self.controllers.get(i)?.pins.en)
    }

    /// The current numbers: eight common ones, then five per `move`.
    #[must_use]
    pub fn numbers(&self, i: usize) -> &[i32] {
        self.controllers.get(i).map_or(&[], |controller| controller.numbers.all())
    }

    #[must_use]
    pub fn memory(&self, i: usize) -> &[u8] {
        self.controllers.get(i).map_or(&[], |controller| controller.eeprom.bytes())
    }

    /// Number of complete or cut writes per byte.
    #[must_use]
    pub fn writes(&self, i: usize) -> &[u32] {
        self.controllers.get(i).map_or(&[], |controller| controller.eeprom.writes())
    }

    /// Position and trust that it would read from this memory at a power-up now; `None` without a valid record. With
    /// trust 0 the position is unknown.
    #[must_use]
    pub fn believed_after_power_up(&self, i: usize) -> Option<(i32, u8)> {
        self.controllers.get(i)?.believed()
    }

    #[must_use]
    pub fn axis_position(&self, i: usize) -> Option<i64> {
        Some(self.controllers.get(i)?.axis.position())
    }

    /// Axis position minus controller position, relative to when zero was last set or memory was first read.
    #[must_use]
    pub fn axis_error(&self, i: usize) -> Option<i64> {
        let controller = self.controllers.get(i)?;
        Some(controller.axis.error(controller.position))
    }

    #[must_use]
    pub fn ignored(&self, i: usize) -> &[Press] {
        self.controllers.get(i).map_or(&[], |controller| &controller.ignored)
    }

    /// Its panel records since cycle 0 or the last [`Self::take_panel`]. Their number is bounded by the inputs and by
    /// [`MAX_GROUPS_BEGUN`](crate::limits::MAX_GROUPS_BEGUN).
    #[must_use]
    pub fn panel(&self, i: usize) -> &[PanelRecord] {
        self.controllers.get(i).map_or(&[], |controller| &controller.panel)
    }

    pub fn take_panel(&mut self, i: usize) -> Vec<PanelRecord> {
        self.controllers
            .get_mut(i)
            .map(|controller| core::mem::take(&mut controller.panel))
            .unwrap_or_default()
    }

    /// Digest of the panel records, controller after controller; of the whole run if none were removed.
    #[must_use]
    pub fn panel_digest(&self) -> u64 {
        panel::digest(self.controllers.iter().map(|controller| controller.panel.as_slice()))
    }
}
