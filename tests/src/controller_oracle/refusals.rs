//! "Refused": the paths of refused values and relations, and simple ranges.

use super::arithmetic::interval;
use super::eeprom;
use super::parameters::{Axis, Case, Controller, Group, Initial, Input, Memory, What};

/// Paths of all problems.
pub fn refused(case: &Case) -> Vec<String> {
    let mut list = List { case, path: "source.standalone".into(), paths: Vec::new() };
    let controllers = case.controllers.len();
    if controllers == 0 || controllers > 16 || controllers > case.channels {
        list.add("");
    }
    for (index, controller) in case.controllers.iter().enumerate() {
        list.path = format!("source.standalone[{index}].");
        list.controller(controller, index);
    }
    list.paths
}

struct List<'a> {
    case: &'a Case,
    path: String,
    paths: Vec<String>,
}

impl List<'_> {
    fn add(&mut self, field: &str) {
        self.paths.push(format!("{}{field}", self.path));
    }

    fn range(&mut self, field: &str, value: i64, least: i64, most: i64) {
        if value < least || value > most {
            self.add(field);
        }
    }

    /// Lm.
    fn least_interval(&self) -> u128 {
        u128::from(self.case.w + (self.case.h + self.case.d).max(1)) << 16
    }

    fn controller(&mut self, of: &Controller, index: usize) {
        let max = of.max_speed_hz;
        if of.self_test_cycles == 0 || of.self_test_cycles > u64::from(u32::MAX) {
            self.add("self_test_cycles");
        }
        self.range("debounce_cycles", of.debounce_cycles as i64, 0, 1_000_000_000);
        self.range("sensor_debounce_cycles", of.sensor_debounce_cycles as i64, 0, 1_000_000_000);
        self.range("pulses_per_unit", of.pulses_per_unit, 1, 999_999);
        self.range("decimals", of.decimals, 0, 3);
        // Reading: a start speed above the maximum is a problem of the start speed.
        self.range("start_speed_hz", of.start_speed_hz, 10, max);
        let fits =
            (10..=10_000_000).contains(&max) && interval(self.case.clock_hz, max) >= self.least_interval();
        if !fits {
            self.add("max_speed_hz");
        }
        self.range("level_hz_s", of.level_hz_s, 1, 1_000_000);
        self.range("required_position", i64::from(of.least_trust), 0, 2);
        self.range("loops", of.loops, 1, 9999);
        self.range("groups", of.groups.len() as i64, 1, 50);
        for (at, group) in of.groups.iter().enumerate() {
            self.group(of, at, group);
        }
        self.range("jog.speed_hz", of.jog.speed_hz, 10, max);
        self.range("jog.fine_hz", of.jog.fine_hz, 10, max);
        self.range("jog.acceleration_level", of.jog.level, 1, 5);
        self.range("return.speed_hz", of.return_to_zero.speed_hz, 10, max);
        self.range("return.acceleration_level", of.return_to_zero.level, 1, 5);
        if let Some(home) = &of.home {
            self.range("home.coarse_hz", home.coarse_hz, 10, of.start_speed_hz);
            self.range("home.fine_hz", home.fine_hz, 10, of.start_speed_hz);
            self.range("home.pull_off_steps", home.pull_off_steps, 0, 1_000_000);
            self.range("home.max_travel_steps", home.max_travel_steps, 1, 1_000_000_000);
        }
        if let Some(limits) = &of.soft_limits
            && limits.min_steps > limits.max_steps
        {
            self.add("soft_limits");
        }
        self.memory(of, &of.memory);
        self.inputs(of, index);
    }

    fn group(&mut self, of: &Controller, at: usize, group: &Group) {
        let max = of.max_speed_hz;
        let groups = of.groups.len();
        let number = at + 1;
        match group {
            Group::Move(order) => {
                let path = format!("groups[{at}].move");
                self.range(&format!("{path}.length"), order.length, 0, 999_999);
                self.range(&format!("{path}.speed_hz"), order.speed_hz, 10, max);
                self.range(&format!("{path}.acceleration_level"), order.level, 1, 5);
                self.range(&format!("{path}.delay_ms"), order.delay_ms, 0, 999_999);
            }
            Group::MoveTo { length, speed_hz, level, delay_ms } => {
                let path = format!("groups[{at}].move_to");
                self.range(&format!("{path}.length"), *length, -999_999, 999_999);
                self.range(&format!("{path}.speed_hz"), *speed_hz, 10, max);
                self.range(&format!("{path}.acceleration_level"), *level, 1, 5);
                self.range(&format!("{path}.delay_ms"), *delay_ms, 0, 999_999);
            }
            Group::Profile(profile) => {
                for (step, interval) in profile.intervals_q16.iter().enumerate() {
                    if u128::from(*interval) < self.least_interval() {
                        self.add(&format!("groups[{at}].profile.intervals_q16[{step}]"));
                    }
                }
            }
            Group::Home if of.home.is_none() => self.add(&format!("groups[{at}].home")),
            Group::Home => {}
            Group::Wait { then: Some(then), .. } if *then == 0 || *then > groups => {
                self.add(&format!("groups[{at}].wait.then"));
            }
            Group::Wait { timeout_ms, .. } => {
                self.range(&format!("groups[{at}].wait.timeout_ms"), *timeout_ms, 0, 1_000_000_000);
            }
            Group::Set { output, .. } => {
                self.range(&format!("groups[{at}].set.output"), i64::from(*output), 0, 3);
            }
            Group::Repeat { first, times } => {
                if *first == 0 || *first >= number {
                    self.add(&format!("groups[{at}].repeat.first"));
                }
                self.range(&format!("groups[{at}].repeat.times"), i64::from(*times), 1, 9999);
            }
            Group::Jump { to, .. } => {
                if *to == 0 || *to > groups {
                    self.add(&format!("groups[{at}].jump.to"));
                }
            }
        }
    }

    fn memory(&mut self, of: &Controller, memory: &Memory) {
        self.range("memory.byte_write_cycles", memory.byte_write_cycles as i64, 1, 1_000_000_000);
        self.range("memory.hold_up_cycles", memory.hold_up_cycles as i64, 0, 1_000_000_000_000);
        self.range("memory.slots", memory.slots as i64, 2, 200);
        if let Initial::Bytes(bytes) = &memory.initial
            && bytes.len() > eeprom::size(of)
        {
            self.add("memory.initial");
        }
    }

    fn inputs(&mut self, of: &Controller, index: usize) {
        let driven = |input: Input| {
            let axis = of.axis.clone().unwrap_or_default();
            let Axis { min_switch_at_steps, max_switch_at_steps, home_from_steps, home_to_steps, .. } = axis;
            match input {
                Input::LimitMin => min_switch_at_steps.is_some(),
                Input::LimitMax => max_switch_at_steps.is_some(),
                Input::HomeSwitch => home_from_steps.is_some() && home_to_steps.is_some(),
                _ => false,
            }
        };
        let mut seen = std::collections::HashSet::new();
        for (at, entry) in of.inputs.iter().enumerate() {
            let (input, is_refused) = match entry.what {
                What::Level(input, _) => {
                    (Some(input.index()), driven(input) || (index > 0 && input.is_common()))
                }
                // Reading: a push is an input, too: at most one per cycle.
                What::Push(steps) => (None, steps.abs() > 1_000_000),
            };
            let twice = !seen.insert((entry.cycle, input));
            let in_time = (1..=9_000_000_000_000_000).contains(&entry.cycle);
            if is_refused || twice || !in_time {
                // Reading: the path is that of the entry, of two that of the later one.
                self.add(&format!("inputs[{at}]"));
            }
        }
    }
}
