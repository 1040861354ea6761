//! Validation of controllers (CONTROLLER.md, "The format" and "Refused").

use crate::input::{Change, Input, Signal};
use crate::parameters::{
    Axis, Group, Home, Initial, Move, MoveTo, Parameters, Policy, Profile, Release, Setup, ShortMove, Until,
};
use crate::refusal::{Refusal, Refused, Warned, Warning};
use crate::{checked::CheckedSetup, journal::RECORD, limits, numbers::Numbers, table::Table};
use alloc::string::{String, ToString};
use alloc::{collections::BTreeSet, format, vec::Vec};
use core::ops::RangeInclusive;
use stepscope_peripheral::{segment::FRACTION_BITS, units::Cycles};

/// Bytes that a power failure may have to wait for: one in progress, and a record.
const HOLD_UP_BYTES: u64 = 1 + RECORD as u64;

impl Setup {
    /// Validates all parameters of the bus and its controllers.
    /// Errors: every value that is refused, in the order of the fields.
    pub fn check(self) -> Result<CheckedSetup, Vec<Refused>> {
        let mut check = Validator { refused: Vec::new(), controller: None };
        check.bus(&self);
        for (index, parameters) in self.controllers.iter().enumerate() {
            check.controller = Some(index);
            check.parameters(&self, parameters);
        }
        if !check.refused.is_empty() {
            return Err(check.refused);
        }
        let warned = self.warnings();
        Ok(CheckedSetup::new(self, warned))
    }

    /// Warnings about valid parameters.
    fn warnings(&self) -> Vec<Warned> {
        let mut warned = Vec::new();
        for (controller, parameters) in self.controllers.iter().enumerate() {
            let mut warn = |path: &str, warning| {
                warned.push(Warned { controller, path: path.to_string(), warning });
            };
            if parameters.debounce_cycles == 0 {
                warn("debounce_cycles", Warning::NoDebounce);
            }
            let (given_hz, start_speed_hz) = (parameters.jog.speed_hz, parameters.start_speed_hz);
            if parameters.jog.release == Release::AtOnce && given_hz > start_speed_hz {
                warn("jog.speed_hz", Warning::JogCostsTrust { given_hz, start_speed_hz });
            }
            let memory = &parameters.memory;
            let needed = (HOLD_UP_BYTES * u64::from(memory.byte_write_cycles)).saturating_sub(1);
            if memory.policy == Policy::PowerLoss && memory.hold_up_cycles < needed {
                let given = memory.hold_up_cycles;
                warn("memory.hold_up_cycles", Warning::ShortHoldUp { given, needed });
            }
            for (index, group) in parameters.groups.iter().enumerate() {
                if let Group::Move(own) = group
                    && let Some(warning) = parameters.short_move_warning(own)
                {
                    warn(&format!("groups[{index}].move.speed_hz"), warning);
                }
            }
        }
        warned
    }
}

impl Parameters {
    /// A warning if a move never reaches its speed, so that all of it runs at the start-stop rate.
    fn short_move_warning(&self, group: &Move) -> Option<Warning> {
        let (given_hz, start_speed_hz) = (group.speed_hz, self.start_speed_hz);
        let steps = Numbers::new(self).steps(group.length.into());
        let acceleration_hz_s = self.level_hz_s.saturating_mul(group.level.into());
        let needed = Table { start_speed_hz, acceleration_hz_s }.steps_to(given_hz).saturating_mul(2);
        let is_short = self.short_move == ShortMove::Document && i128::from(needed) > steps;
        is_short.then_some(Warning::ShortMove { steps, needed, given_hz, start_speed_hz })
    }
}

/// Collects refused values; `controller` is the one being validated.
struct Validator {
    refused: Vec<Refused>,
    controller: Option<usize>,
}

impl Validator {
    fn refuse(&mut self, path: impl Into<String>, refusal: Refusal) {
        self.refused.push(Refused { controller: self.controller, path: path.into(), refusal });
    }

    fn range(&mut self, path: impl Into<String>, given: impl Into<i128>, range: &RangeInclusive<i128>) {
        if let Some(refusal) = out_of_range(given.into(), range) {
            self.refuse(path, refusal);
        }
    }

    fn speed(&mut self, path: impl Into<String>, given_hz: u32, parameters: &Parameters) {
        let max_speed_hz = parameters.max_speed_hz;
        if i128::from(given_hz) < *limits::SPEED_HZ.start() || given_hz > max_speed_hz {
            self.refuse(path, Refusal::Speed { given_hz, max_speed_hz });
        }
    }

    fn bus(&mut self, setup: &Setup) {
        self.range("clock_hz", setup.clock_hz, &limits::CLOCK_HZ);
        self.range("bus.channels", setup.channels, &limits::CHANNELS);
        self.range("bus.pulse_width_cycles", setup.pulse.width.0, &limits::PULSE_WIDTH_CYCLES);
        self.range("bus.dir_setup_cycles", setup.pulse.setup.0, &limits::DIR_CYCLES);
        self.range("bus.dir_hold_cycles", setup.pulse.hold.0, &limits::DIR_CYCLES);
        let max = i128::from(setup.channels).clamp(1, *limits::CHANNELS.end());
        self.range("source.standalone", setup.controllers.len() as i128, &(1..=max));
    }

    fn parameters(&mut self, setup: &Setup, parameters: &Parameters) {
        self.range("self_test_cycles", parameters.self_test_cycles, &limits::SELF_TEST_CYCLES);
        self.range("debounce_cycles", parameters.debounce_cycles, &limits::DEBOUNCE_CYCLES);
        self.range("sensor_debounce_cycles", parameters.sensor_debounce_cycles, &limits::DEBOUNCE_CYCLES);
        self.range("pulses_per_unit", parameters.pulses_per_unit, &limits::PULSES_PER_UNIT);
        self.range("decimals", parameters.decimals, &limits::DECIMALS);
        self.speed("start_speed_hz", parameters.start_speed_hz, parameters);
        self.max_speed(setup, parameters.max_speed_hz);
        self.range("level_hz_s", parameters.level_hz_s, &limits::LEVEL_HZ_S);
        self.range("required_position", parameters.least_trust, &limits::TRUST);
        self.range("loops", parameters.loops, &limits::LOOPS);
        self.range("groups", parameters.groups.len() as i128, &limits::GROUPS);
        for (index, group) in parameters.groups.iter().enumerate() {
            self.group(setup, parameters, index, group);
        }
        self.speed("jog.speed_hz", parameters.jog.speed_hz, parameters);
        self.speed("jog.fine_hz", parameters.jog.fine_hz, parameters);
        self.range("jog.acceleration_level", parameters.jog.level, &limits::LEVEL);
        self.speed("return.speed_hz", parameters.return_.speed_hz, parameters);
        self.range("return.acceleration_level", parameters.return_.level, &limits::LEVEL);
        if let Some(home) = &parameters.home {
            self.home(parameters, home);
        }
        if let Some(soft) = &parameters.soft_limits {
            self.range("soft_limits.min_steps", soft.min_steps, &limits::STEPS);
            let min = i128::from(soft.min_steps).clamp(*limits::STEPS.start(), *limits::STEPS.end());
            self.range("soft_limits.max_steps", soft.max_steps, &(min..=*limits::STEPS.end()));
        }
        if let Some(axis) = &parameters.axis {
            self.axis(axis);
        }
        self.memory(parameters);
        self.inputs(parameters);
    }

    fn max_speed(&mut self, setup: &Setup, given_hz: u32) {
        self.range("max_speed_hz", given_hz, &limits::SPEED_HZ);
        let (clock_hz, pulse) = (u64::from(setup.clock_hz), setup.pulse.min_interval());
        if limits::SPEED_HZ.contains(&given_hz.into())
            && u128::from(clock_hz << FRACTION_BITS) / u128::from(given_hz)
                < u128::from(pulse.0) << FRACTION_BITS
        {
            let step = Cycles(clock_hz / u64::from(given_hz));
            let max_hz = clock_hz.checked_div(pulse.0).unwrap_or(0);
            self.refuse("max_speed_hz", Refusal::TooFast { given_hz, step, pulse, max_hz });
        }
    }

    fn group(&mut self, setup: &Setup, parameters: &Parameters, index: usize, group: &Group) {
        let path = |field: &str| format!("groups[{index}].{field}");
        match group {
            Group::Move(group) => self.move_group(&path("move"), group, parameters),
            Group::MoveTo(group) => self.move_to(&path("move_to"), group, parameters),
            Group::Profile(group) => self.profile(&path("profile"), group, setup),
            Group::Home if parameters.home.is_none() => self.refuse(path("home"), Refusal::NoHome),
            Group::Home => {}
            Group::Wait(group) => {
                self.sensor(path("wait.input"), group.input);
                self.range(path("wait.timeout_ms"), group.timeout_ms, &limits::TIMEOUT_MS);
                if let Some(then) = group.then {
                    self.number(path("wait.then"), then, parameters);
                }
            }
            Group::Set(group) => self.range(path("set.output"), group.output, &limits::OUTPUT),
            Group::Repeat(group) => {
                let number = index as u32 + 1;
                if !(1..number).contains(&group.first) {
                    let refusal = Refusal::NotBefore { given: group.first, group: number };
                    self.refuse(path("repeat.first"), refusal);
                }
                self.range(path("repeat.times"), group.times, &limits::LOOPS);
            }
            Group::Jump(group) => {
                self.number(path("jump.to"), group.to, parameters);
                if let Some(input) = group.input {
                    self.sensor(path("jump.input"), input);
                }
            }
        }
    }

    fn move_group(&mut self, path: &str, group: &Move, parameters: &Parameters) {
        self.range(format!("{path}.length"), group.length, &limits::LENGTH);
        self.range(format!("{path}.direction"), group.direction, &limits::DIRECTION);
        self.speed(format!("{path}.speed_hz"), group.speed_hz, parameters);
        self.range(format!("{path}.acceleration_level"), group.level, &limits::LEVEL);
        self.range(format!("{path}.delay_ms"), group.delay_ms, &limits::DELAY_MS);
        if let Some(until) = &group.until {
            self.until(format!("{path}.until.input"), until);
        }
    }

    fn move_to(&mut self, path: &str, group: &MoveTo, parameters: &Parameters) {
        self.range(format!("{path}.length"), group.length, &limits::TARGET);
        self.speed(format!("{path}.speed_hz"), group.speed_hz, parameters);
        self.range(format!("{path}.acceleration_level"), group.level, &limits::LEVEL);
        self.range(format!("{path}.delay_ms"), group.delay_ms, &limits::DELAY_MS);
    }

    fn profile(&mut self, path: &str, group: &Profile, setup: &Setup) {
        let intervals = format!("{path}.intervals_q16");
        self.range(intervals.as_str(), group.intervals.len() as i128, &limits::INTERVALS);
        let min = setup.pulse.min_interval().0.saturating_mul(1 << FRACTION_BITS);
        for (index, &given) in group.intervals.iter().enumerate() {
            if given < min {
                self.refuse(format!("{intervals}[{index}]"), Refusal::ShortInterval { given, min });
            }
        }
        self.range(format!("{path}.direction"), group.direction, &limits::DIRECTION);
        self.range(format!("{path}.delay_ms"), group.delay_ms, &limits::DELAY_MS);
    }

    fn until(&mut self, path: String, until: &Until) {
        if !until.input.is_sensor() || matches!(until.input, Signal::LimitMin | Signal::LimitMax) {
            let allowed = "in_0 to in_3 or home_switch";
            self.refuse(path, Refusal::WrongSignal { given: until.input, allowed });
        }
    }

    fn sensor(&mut self, path: String, given: Signal) {
        if !given.is_sensor() {
            let allowed = "in_0 to in_3, limit_min, limit_max or home_switch";
            self.refuse(path, Refusal::WrongSignal { given, allowed });
        }
    }

    fn number(&mut self, path: String, given: u32, parameters: &Parameters) {
        let groups = parameters.groups.len() as u32;
        if !(1..=groups).contains(&given) {
            self.refuse(path, Refusal::NoSuchGroup { given, groups });
        }
    }

    fn home(&mut self, parameters: &Parameters, home: &Home) {
        if !home.switch.is_switch() {
            let allowed = "home_switch, limit_min or limit_max";
            self.refuse("home.switch", Refusal::WrongSignal { given: home.switch, allowed });
        }
        self.range("home.direction", home.direction, &limits::DIRECTION);
        let start_speed_hz = parameters.start_speed_hz;
        for (path, given_hz) in [("home.coarse_hz", home.coarse_hz), ("home.fine_hz", home.fine_hz)] {
            if given_hz > start_speed_hz {
                self.refuse(path, Refusal::AboveStartSpeed { given_hz, start_speed_hz });
            } else {
                self.range(path, given_hz, &(*limits::SPEED_HZ.start()..=i128::from(start_speed_hz)));
            }
        }
        self.range("home.pull_off_steps", home.pull_off_steps, &limits::PULL_OFF_STEPS);
        self.range("home.max_travel_steps", home.max_travel_steps, &limits::TRAVEL_STEPS);
        self.range("home.position_steps", home.position_steps, &limits::STEPS);
    }

    fn axis(&mut self, axis: &Axis) {
        let positions = [
            ("axis.start_steps", Some(axis.start_steps)),
            ("axis.min_switch_at_steps", axis.min_switch_at_steps),
            ("axis.max_switch_at_steps", axis.max_switch_at_steps),
            ("axis.home_from_steps", axis.home_from_steps),
            ("axis.home_to_steps", axis.home_to_steps),
            ("axis.hard_min_steps", axis.hard_min_steps),
            ("axis.hard_max_steps", axis.hard_max_steps),
        ];
        for (path, position) in positions {
            self.range(path, position.unwrap_or(0), &limits::STEPS);
        }
        match (axis.home_from_steps, axis.home_to_steps) {
            (Some(_), None) => {
                self.refuse("axis.home_to_steps", Refusal::HalfSwitch { missing: "home_to_steps" })
            }
            (None, Some(_)) => {
                self.refuse("axis.home_from_steps", Refusal::HalfSwitch { missing: "home_from_steps" })
            }
            _ => {}
        }
    }

    fn memory(&mut self, parameters: &Parameters) {
        let memory = &parameters.memory;
        self.range("memory.byte_write_cycles", memory.byte_write_cycles, &limits::BYTE_WRITE_CYCLES);
        self.range("memory.hold_up_cycles", memory.hold_up_cycles, &limits::HOLD_UP_CYCLES);
        self.range("memory.slots", memory.slots, &limits::SLOTS);
        let bytes = parameters.memory_len();
        if let Initial::Bytes(given) = &memory.initial
            && given.len() > bytes
        {
            self.refuse("memory.initial", Refusal::LongMemory { given: given.len(), bytes });
        }
    }

    fn inputs(&mut self, parameters: &Parameters) {
        let inputs = &parameters.inputs;
        self.range("inputs", inputs.len() as i128, &limits::INPUTS);
        for (index, input) in inputs.iter().enumerate() {
            let path = |field: &str| format!("inputs[{index}]{field}");
            self.range(path(".cycle"), input.cycle.0, &limits::INPUT_CYCLE);
            let field = if matches!(input.change, Change::Push(_)) { ".push_steps" } else { "" };
            if let Some(refusal) = forbidden_change(parameters, self.controller.unwrap_or(0), input.change) {
                self.refuse(path(field), refusal);
            }
        }
        for (index, input) in duplicate_inputs(inputs) {
            let refusal = Refusal::DuplicateInput { name: input.change.name(), cycle: input.cycle };
            self.refuse(format!("inputs[{index}]"), refusal);
        }
    }
}

/// Why an input of this controller must not have this change.
pub(crate) fn forbidden_change(
    parameters: &Parameters,
    controller: usize,
    change: Change,
) -> Option<Refusal> {
    match change {
        Change::Push(steps) => out_of_range(steps.into(), &limits::PUSH_STEPS),
        Change::Level(signal, _) => forbidden_signal(parameters, controller, signal),
    }
}

fn out_of_range(given: i128, range: &RangeInclusive<i128>) -> Option<Refusal> {
    let (min, max) = (*range.start(), *range.end());
    (!range.contains(&given)).then_some(Refusal::Range { given, min, max })
}

fn forbidden_signal(parameters: &Parameters, controller: usize, signal: Signal) -> Option<Refusal> {
    let axis = parameters.axis.as_ref();
    let driven_by = match signal {
        Signal::Power | Signal::Estop | Signal::Clear if controller != 0 => {
            return Some(Refusal::OnlyFirstController { signal });
        }
        Signal::LimitMin => axis?.min_switch_at_steps.map(|_| "min_switch_at_steps"),
        Signal::LimitMax => axis?.max_switch_at_steps.map(|_| "max_switch_at_steps"),
        Signal::HomeSwitch => axis?.home_from_steps.or(axis?.home_to_steps).map(|_| "home_from_steps"),
        _ => None,
    };
    driven_by.map(|axis_field| Refusal::Driven { signal, axis_field })
}

/// Inputs that repeat the signal and cycle of an earlier entry, with their indices, in the order of the script.
fn duplicate_inputs(inputs: &[Input]) -> Vec<(usize, Input)> {
    let mut seen = BTreeSet::new();
    let is_duplicate = |&(_, input): &(usize, Input)| !seen.insert((input.cycle, input.change.name()));
    inputs.iter().copied().enumerate().filter(is_duplicate).collect()
}
