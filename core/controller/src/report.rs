//! Queries about a machine and its controllers.

use crate::panel::{self, PanelRecord};
use crate::state::{Alarm, State};
use crate::{checked::CheckedSetup, controller::Press, machine::StandAlone};
use alloc::vec::Vec;
use stepscope_peripheral::{signal::MAX_CHANNELS, units::Instant};

/// Queries about a controller that does not exist return `None` or an empty list.
impl StandAlone {
    pub const fn checked(&self) -> &CheckedSetup {
        &self.checked
    }

    /// Position counters of the bus: +1 per rise of STEP with DIR 1, -1 with DIR 0; see also [`Self::position`].
    pub fn positions(&self) -> [i32; MAX_CHANNELS] {
        let mut positions = [0; MAX_CHANNELS];
        for (position, controller) in positions.iter_mut().zip(&self.controllers) {
            *position = controller.step_count;
        }
        positions
    }

    pub const fn controllers(&self) -> usize {
        self.controllers.len()
    }

    /// Number of groups that all controllers have begun; more than [`crate::limits::MAX_GROUPS_BEGUN`] end the run.
    pub const fn groups_begun(&self) -> u64 {
        self.groups_begun
    }

    /// The panel records of each controller, as [`Self::panel`].
    pub fn panels(&self) -> impl Iterator<Item = &[PanelRecord]> {
        self.controllers.iter().map(|controller| controller.panel.as_slice())
    }

    /// When the EEPROM began to write the byte in progress.
    pub fn writing_since(&self, i: usize) -> Option<Instant> {
        self.controllers.get(i)?.eeprom.begun().map(Instant)
    }

    /// Whether a jog never ends, because its button stays pressed and no limit is ahead.
    pub fn jogs_without_end(&self) -> bool {
        self.controllers.iter().any(crate::controller::Controller::jogs_without_end)
    }

    pub fn state(&self, i: usize) -> Option<State> {
        Some(self.controllers.get(i)?.state)
    }

    pub fn alarm(&self, i: usize) -> Option<Alarm> {
        Some(self.controllers.get(i)?.alarm)
    }

    /// Trust in the position: 0 LOST, 1 HELD, 2 SURE.
    pub fn trust(&self, i: usize) -> Option<u8> {
        Some(self.controllers.get(i)?.trust)
    }

    /// The controller's position in steps.
    pub fn position(&self, i: usize) -> Option<i32> {
        Some(self.controllers.get(i)?.position)
    }

    /// The panel's current word: state, alarm, trust, outputs, group and loop.
    pub fn word(&self, i: usize) -> Option<panel::Word> {
        Some(self.controllers.get(i)?.word())
    }

    /// The number on the panel, without its decimal point.
    pub fn display(&self, i: usize) -> Option<i64> {
        Some(self.controllers.get(i)?.display())
    }

    /// The current or next group from 1; 0 without program.
    pub fn group(&self, i: usize) -> Option<u32> {
        Some(self.controllers.get(i)?.program.as_ref().map_or(0, |program| program.group))
    }

    /// The current loop from 1; 0 without program.
    pub fn loop_(&self, i: usize) -> Option<u32> {
        Some(self.controllers.get(i)?.program.as_ref().map_or(0, |program| program.loop_))
    }

    /// Outputs 0 to 3, one bit each.
    pub fn outputs(&self, i: usize) -> Option<u8> {
        Some(self.controllers.get(i)?.outputs)
    }

    /// EN of this controller; the bus has the AND of all.
    pub fn enabled(&self, i: usize) -> Option<bool> {
        Some(self.controllers.get(i)?.pins.en)
    }

    /// The numbers that the panel can change: eight common ones, then five per `move`.
    pub fn numbers(&self, i: usize) -> &[i32] {
        self.controllers.get(i).map_or(&[], |controller| controller.numbers.all())
    }

    /// Contents of the EEPROM.
    pub fn memory(&self, i: usize) -> &[u8] {
        self.controllers.get(i).map_or(&[], |controller| controller.eeprom.bytes())
    }

    /// Number of writes per byte of the EEPROM, complete or cut.
    pub fn writes(&self, i: usize) -> &[u32] {
        self.controllers.get(i).map_or(&[], |controller| controller.eeprom.writes())
    }

    /// Position and trust that a power-up now would read; `None` without a valid record; trust 0 is an unknown position.
    pub fn position_after_power_up(&self, i: usize) -> Option<(i32, u8)> {
        self.controllers.get(i)?.stored_position()
    }

    /// Position of the virtual axis in steps.
    pub fn axis_position(&self, i: usize) -> Option<i64> {
        Some(self.controllers.get(i)?.axis.position())
    }

    /// Axis position minus controller position, relative to when zero was last set or memory was first read.
    pub fn axis_error(&self, i: usize) -> Option<i64> {
        let controller = self.controllers.get(i)?;
        Some(controller.axis.position_error(controller.position))
    }

    pub fn ignored(&self, i: usize) -> &[Press] {
        self.controllers.get(i).map_or(&[], |controller| &controller.ignored)
    }

    /// Panel records since cycle 0 or the last [`Self::take_panel`]. Their number is limited by the inputs and by
    /// [`MAX_GROUPS_BEGUN`](crate::limits::MAX_GROUPS_BEGUN).
    pub fn panel(&self, i: usize) -> &[PanelRecord] {
        self.controllers.get(i).map_or(&[], |controller| &controller.panel)
    }

    pub fn take_panel(&mut self, i: usize) -> Vec<PanelRecord> {
        self.controllers
            .get_mut(i)
            .map(|controller| core::mem::take(&mut controller.panel))
            .unwrap_or_default()
    }

    /// Digest of the panel records of all controllers; of the whole run if none were removed.
    pub fn panel_digest(&self) -> u64 {
        panel::digest(self.controllers.iter().map(|controller| controller.panel.as_slice()))
    }
}
