//! Parameters of a random controller.

use super::super::arithmetic::ten_to;
use super::super::eeprom::{Content, RECORD, journal_record, numbers_bank, size};
use super::super::numbers::Numbers;
use super::super::parameters::{
    Axis, Case, Controller, Group, Home, Input, Jog, Memory, Policy, Release, Return, ShortMove, SoftLimits,
};
use super::{Dice, homes};

impl Dice {
    pub(super) fn controller(&mut self, case: &Case) -> Controller {
        let least = case.w + (case.h + case.d).max(1);
        let fastest = (case.clock_hz / least).max(10) as i64;
        let max = if self.chance(70) { fastest } else { self.whole(fastest.min(20), fastest) };
        let start = match self.below(4) {
            0 => self.whole(10, max),
            1 => max,
            _ => self.whole((max / 12).max(10), (max / 3).max(10)),
        };
        // About this number of steps to the maximum speed at level 3.
        let ramp = self.between(10, 500) as i64;
        let level_hz_s = ((max * max - start * start) / (2 * ramp) / 3).clamp(1, 1_000_000);
        let speed = |dice: &mut Self| dice.whole((max / 6).max(10), max);
        let mut controller = Controller {
            self_test_cycles: self.between(1, 300),
            debounce_cycles: match self.below(5) {
                0 => 0,
                1 => self.between(1, 3),
                2 | 3 => self.between(1, 60),
                _ => self.between(1, case.clock_hz / 50 + 1),
            },
            sensor_debounce_cycles: match self.below(4) {
                0 => self.between(1, 4),
                1 => self.between(1, 100),
                _ => 0,
            },
            pulses_per_unit: self.pick(&[1, 3, 7, 10, 37, 100, 565, 1234]),
            decimals: self.whole(0, 3),
            start_speed_hz: start,
            max_speed_hz: max,
            level_hz_s,
            short_move: self.pick(&[ShortMove::Document, ShortMove::TurnRound]),
            least_trust: self.pick(&[0, 0, 1, 1, 1, 2]),
            loops: self.pick(&[1, 1, 1, 2, 3, 4]),
            groups: Vec::new(),
            jog: Jog {
                speed_hz: speed(self),
                fine_hz: if self.chance(80) { self.whole((start / 4).max(10), start) } else { speed(self) },
                level: self.whole(1, 5),
                release: self.pick(&[Release::AtOnce, Release::Ramp]),
            },
            return_to_zero: Return { speed_hz: speed(self), level: self.whole(1, 5) },
            home: None,
            soft_limits: None,
            axis: self.chance(50).then(|| self.axis()),
            memory: Memory::default(),
            inputs: Vec::new(),
        };
        controller.home = self.chance(60).then(|| self.home(&controller));
        if self.chance(40) {
            // A digit is a step.
            controller.pulses_per_unit = ten_to(controller.decimals) as i64;
        }
        controller.groups = self.program(case, &controller);
        if controller.home.is_some() && self.chance(25) && !homes(&controller.groups) {
            controller.groups[0] = Group::Home;
        }
        if self.chance(35) {
            self.tame(&mut controller);
        }
        if self.chance(20) {
            let (min_steps, max_steps) = (self.whole(-400, 20), self.whole(20, 400));
            controller.soft_limits = Some(SoftLimits { min_steps, max_steps });
        }
        let byte = if self.chance(30) { self.pick(&[1, 2, 4, 6]) } else { self.between(1, 60) };
        controller.memory.byte_write_cycles = byte;
        controller.memory.policy = self.pick(&[Policy::PowerLoss, Policy::WriteAhead]);
        controller.memory.slots = self.between(2, 6) as usize;
        controller.memory.hold_up_cycles = match self.below(6) {
            0 => 0,
            1 | 2 => self.between(0, 17 * byte),
            3 if self.chance(50) => 17 * byte - 1,
            // The supply fails during a byte of the closing record.
            3 => self.between(0, 16) * byte + byte / 2,
            _ => self.between(17 * byte - 1, 40 * byte),
        };
        controller.memory.initial = self.initial(&controller);
        controller
    }

    /// Short debouncing, and a ramp within the reach of moves.
    fn tame(&mut self, controller: &mut Controller) {
        let max = controller.max_speed_hz;
        controller.start_speed_hz = (max / 5).max(10);
        let start = controller.start_speed_hz;
        let ramp = self.whole(30, 150);
        controller.level_hz_s = ((max * max - start * start) / (2 * ramp) / 3).clamp(1, 1_000_000);
        controller.debounce_cycles = self.between(0, 3);
        controller.least_trust = controller.least_trust.min(1);
        if let Some(home) = &mut controller.home {
            home.coarse_hz = self.whole((start / 2).max(10), start);
            home.fine_hz = self.whole((start / 4).max(10), start);
        }
        controller.groups[0] = self.long_move(controller);
    }

    fn axis(&mut self) -> Axis {
        let mut axis = Axis { start_steps: self.whole(-150, 150), ..Axis::default() };
        if self.chance(60) {
            axis.min_switch_at_steps = Some(self.whole(-400, -120));
        }
        if self.chance(60) {
            axis.max_switch_at_steps = Some(self.whole(120, 400));
        }
        if self.chance(70) {
            let from = self.whole(-250, 200);
            axis.home_from_steps = Some(from);
            axis.home_to_steps = Some(from + self.whole(0, 60));
        }
        if self.chance(40) {
            axis.hard_min_steps = Some(axis.min_switch_at_steps.unwrap_or(-300) - self.whole(-3, 10));
        }
        if self.chance(40) {
            axis.hard_max_steps = Some(axis.max_switch_at_steps.unwrap_or(300) + self.whole(-3, 10));
        }
        let (least, most) = (axis.hard_min_steps.unwrap_or(-1000), axis.hard_max_steps.unwrap_or(1000));
        axis.start_steps = axis.start_steps.clamp(least, most);
        axis
    }

    fn home(&mut self, controller: &Controller) -> Home {
        let start = controller.start_speed_hz;
        let axis = controller.axis.clone().unwrap_or_default();
        let mut switches = vec![Input::HomeSwitch, Input::LimitMin, Input::LimitMax];
        if axis.home_from_steps.is_some() {
            switches.extend([Input::HomeSwitch; 4]);
        }
        if axis.min_switch_at_steps.is_some() {
            switches.extend([Input::LimitMin; 2]);
        }
        let switch = self.pick(&switches);
        let mut right = match switch {
            Input::LimitMin => false,
            Input::LimitMax => true,
            _ => axis.home_from_steps.map_or_else(|| self.chance(50), |from| from > axis.start_steps),
        };
        if self.chance(10) {
            right = !right;
        }
        Home {
            switch,
            right,
            coarse_hz: self.whole((start / 3).max(10), start),
            fine_hz: self.whole((start / 8).max(10), start),
            pull_off_steps: self.pick(&[0, 1, 2, 5, 20, 30]),
            max_travel_steps: self.pick(&[5, 100, 600, 1000, 2000]),
            position_steps: if self.chance(50) { 0 } else { self.whole(-150, 150) },
        }
    }

    /// A journal that has wrapped, banks of numbers, damage.
    pub(super) fn memory_bytes(&mut self, controller: &Controller) -> Vec<u8> {
        let mut bytes = vec![0xFF; size(controller)];
        let slots = controller.memory.slots;
        let mut seq = self.pick(&[1, 1, 2, 77, 0xFFFF_0000]);
        let mut slot = self.below(slots as u64) as usize;
        for _ in 0..self.between(0, slots as u64 + 1) {
            let content = Content {
                position: self.whole(-200, 200) as i32,
                trust: self.below(3) as u8,
                open: self.chance(30),
                group: self.below(3) as u8,
                of_loop: self.below(3) as u16,
            };
            bytes[RECORD * slot..RECORD * (slot + 1)].copy_from_slice(&journal_record(seq, content));
            seq += u32::from(!self.chance(5));
            slot = (slot + 1) % slots;
        }
        let bank = (bytes.len() - RECORD * slots) / 2;
        for at in 0..2 {
            if self.chance(40) {
                let numbers = self.numbers(controller);
                let seq = self.between(1, 3) as u32;
                bytes[RECORD * slots + bank * at..][..bank].copy_from_slice(&numbers_bank(seq, &numbers));
            }
        }
        for _ in 0..self.pick(&[0, 0, 0, 1, 3]) {
            let at = self.below(bytes.len() as u64) as usize;
            bytes[at] = self.below(256) as u8;
        }
        if self.chance(20) {
            let length = self.between(1, bytes.len() as u64) as usize;
            bytes.truncate(length);
        }
        bytes
    }

    /// The scenario's numbers, some of them changed, sometimes out of range.
    fn numbers(&mut self, controller: &Controller) -> Vec<i64> {
        let of_scenario = Numbers::of_scenario(controller);
        let mut values = of_scenario.values().to_vec();
        if self.chance(40) {
            values[7] = self.whole(1, values[7]);
        }
        for _ in 0..self.below(4) {
            let at = self.below(values.len() as u64) as usize;
            let value = self.pick(&[0, 1, 2, 3, 15, 40, 100, controller.max_speed_hz]);
            if self.chance(8) || of_scenario.is_in_range(controller, at, value) {
                values[at] = value;
            }
        }
        values
    }
}
