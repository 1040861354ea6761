//! Converts stand-alone controllers for `stepscope_controller`, and its refusals to paths of the scenario
//! (CONTROLLER.md).

use crate::{
    Cause, Hex, Json, JsonReader, Parts, ReadJson, Scenario, StandAlone, ToParts, Validator, ValueError,
    of_motion,
    schema::{
        Homing, PanelInput, ProfileGroup, ProgramGroup, Sensor, SoftLimits, Switch, Type, Typed, Until,
        VirtualAxis,
    },
};
use alloc::{format, vec::Vec};
use serde_json::Value;
use stepscope_controller::input::{Change, Input, Signal};
use stepscope_controller::limits;
use stepscope_controller::parameters::{self, Group, Initial, Parameters, Setup};
use stepscope_motion::plan_move;
use stepscope_peripheral::{segment::PulseTimes, signal::MAX_CHANNELS, units::Instant};

/// Maximum steps of a scenario's profiles from motions.
const MAX_PROFILE_STEPS: u64 = 4_000_000;

impl Scenario {
    pub(crate) fn check_stand_alone(
        &self,
        controllers: &[StandAlone],
        validator: &mut Validator,
    ) -> Option<stepscope_controller::CheckedSetup> {
        let outside = validator.enter("source.standalone");
        self.channels().check_count(controllers.len(), 1, "controllers", validator);
        let before = validator.count();
        let pulse = PulseTimes::from(&self.bus);
        let mut steps_left = MAX_PROFILE_STEPS;
        let parameters = controllers.iter().take(MAX_CHANNELS).enumerate().map(|(index, one)| {
            validator.at_entry(index, |here| one.to_parameters(self.clock_hz, &mut steps_left, here))
        });
        let controllers = parameters.collect();
        let is_read = validator.count() == before;
        let setup = Setup { clock_hz: self.clock_hz, channels: self.bus.channels, pulse, controllers };
        let checked = match setup.check() {
            Ok(checked) => is_read.then_some(checked),
            Err(refused) => {
                for one in refused {
                    let Some(controller) = one.controller else { continue };
                    validator.at_entry(controller, |here| {
                        if !here.has_problem(&one.path) {
                            here.add(&one.path, Cause::StandAlone(one.refusal));
                        }
                    });
                }
                None
            }
        };
        validator.leave(outside);
        checked
    }
}

impl StandAlone {
    fn to_parameters(&self, clock_hz: u32, steps_left: &mut u64, here: &mut Validator) -> Parameters {
        let groups = here.at("groups", |groups| {
            let mut to_group = |(index, group): (usize, &ProgramGroup)| {
                groups.at_entry(index, |here| group.to_group(clock_hz, steps_left, here))
            };
            // The number of groups is checked elsewhere.
            self.groups
                .iter()
                .take(*limits::GROUPS.end() as usize + 1)
                .enumerate()
                .map(&mut to_group)
                .collect()
        });
        let inputs = here.at("inputs", |inputs| {
            let to_input =
                |(index, input): (usize, &PanelInput)| inputs.at_entry(index, |here| input.to_input(here));
            self.inputs.iter().enumerate().map(to_input).collect()
        });
        Parameters {
            self_test_cycles: self.self_test_cycles,
            debounce_cycles: self.debounce_cycles,
            sensor_debounce_cycles: self.sensor_debounce_cycles,
            pulses_per_unit: self.pulses_per_unit,
            decimals: self.decimals,
            start_speed_hz: self.start_speed_hz,
            max_speed_hz: self.max_speed_hz,
            level_hz_s: self.level_hz_s,
            short_move: self.short_move,
            least_trust: self.required_position as u8,
            loops: self.loops.into(),
            groups,
            jog: parameters::Jog {
                speed_hz: self.jog.speed_hz,
                fine_hz: self.jog.fine_hz,
                level: self.jog.acceleration_level,
                release: self.jog.release,
            },
            return_: parameters::Return {
                speed_hz: self.r#return.speed_hz,
                level: self.r#return.acceleration_level,
            },
            home: self.home.as_ref().map(Homing::to_home),
            soft_limits: self.soft_limits.as_ref().map(SoftLimits::to_limits),
            axis: self.axis.as_ref().map(VirtualAxis::to_axis),
            memory: parameters::Memory {
                policy: self.memory.policy,
                byte_write_cycles: self.memory.byte_write_cycles,
                hold_up_cycles: self.memory.hold_up_cycles,
                slots: self.memory.slots.into(),
                initial: self.memory.initial.clone(),
            },
            inputs,
        }
    }
}

impl ProgramGroup {
    fn to_group(&self, clock_hz: u32, steps_left: &mut u64, here: &mut Validator) -> Group {
        match self {
            Self::Move(group) => Group::Move(parameters::Move {
                length: group.length,
                direction: group.direction.is_positive().into(),
                speed_hz: group.speed_hz,
                level: group.acceleration_level,
                delay_ms: group.delay_ms,
                until: group.until.as_ref().map(Until::to_until),
            }),
            Self::MoveTo(group) => Group::MoveTo(parameters::MoveTo {
                length: group.length.clamp(i32::MIN.into(), i32::MAX.into()) as i32,
                speed_hz: group.speed_hz,
                level: group.acceleration_level,
                delay_ms: group.delay_ms,
            }),
            Self::Profile(group) => {
                here.at("profile", |here| Group::Profile(group.to_profile(clock_hz, steps_left, here)))
            }
            Self::Home(_) => Group::Home,
            Self::Wait(group) => Group::Wait(parameters::Wait {
                input: group.input.signal(),
                level: group.level != 0,
                timeout_ms: group.timeout_ms,
                then: group.then.map(Into::into),
            }),
            Self::Set(group) => Group::Set(parameters::Set { output: group.output, level: group.level != 0 }),
            Self::Repeat(group) => {
                Group::Repeat(parameters::Repeat { first: group.first.into(), times: group.times.into() })
            }
            Self::Jump(group) => Group::Jump(parameters::Jump {
                to: group.to.into(),
                input: group.input.map(Sensor::signal),
                level: group.level != 0,
            }),
        }
    }
}

impl ProfileGroup {
    fn to_profile(&self, clock_hz: u32, steps_left: &mut u64, here: &mut Validator) -> parameters::Profile {
        let mut profile = parameters::Profile {
            intervals: self.intervals_q16.clone(),
            direction: self.direction.is_positive().into(),
            delay_ms: self.delay_ms,
        };
        if let Some(motion) = &self.motion {
            if !self.intervals_q16.is_empty() {
                let detail = "a profile has a motion or intervals, not both; remove one";
                here.add("intervals_q16", ValueError::Conflict { detail });
            }
            if let Some((intervals, right)) =
                here.at("motion", |here| intervals(motion, clock_hz, steps_left, here))
            {
                (profile.intervals, profile.direction) = (intervals, right.into());
            }
        }
        profile
    }
}

/// The times between the steps of a motion in one direction, and whether that is right.
fn intervals(
    motion: &stepscope_motion::moves::Move,
    clock_hz: u32,
    steps_left: &mut u64,
    here: &mut Validator,
) -> Option<(Vec<u64>, bool)> {
    let plan = here.take(plan_move(motion, here.path()).map_err(of_motion))?;
    let count = plan.step_count();
    let Some(left) = steps_left.checked_sub(count) else {
        let cause =
            ValueError::TooMuch { given: count as f64, max: *steps_left as f64, of: "steps of profiles" };
        here.add("", cause);
        return None;
    };
    *steps_left = left;
    let (mut intervals, mut before, mut direction) = (Vec::with_capacity(count as usize), 0, None);
    for step in plan.due_steps(clock_hz) {
        if *direction.get_or_insert(step.right) != step.right {
            let detail = "moves in both directions, but a profile moves in one; use one group per direction";
            here.add("", ValueError::Conflict { detail });
            return None;
        }
        let interval = step.cycle.saturating_sub(before);
        let Some(interval) = interval.checked_mul(1 << 16) else {
            let most = (u64::MAX >> 16) as f64;
            here.add(
                "",
                ValueError::TooMuch { given: interval as f64, max: most, of: "cycles between two steps" },
            );
            return None;
        };
        intervals.push(interval);
        before = step.cycle;
    }
    Some((intervals, direction.unwrap_or(true)))
}

impl Until {
    fn to_until(&self) -> parameters::Until {
        parameters::Until { input: self.input.signal(), level: self.level != 0 }
    }
}

impl Homing {
    fn to_home(&self) -> parameters::Home {
        parameters::Home {
            switch: self.switch.signal(),
            direction: self.direction.is_positive().into(),
            coarse_hz: self.coarse_hz,
            fine_hz: self.fine_hz,
            pull_off_steps: self.pull_off_steps,
            max_travel_steps: self.max_travel_steps,
            position_steps: self.position_steps,
        }
    }
}

impl SoftLimits {
    fn to_limits(&self) -> parameters::SoftLimits {
        parameters::SoftLimits { min_steps: self.min_steps, max_steps: self.max_steps }
    }
}

impl VirtualAxis {
    fn to_axis(&self) -> parameters::Axis {
        parameters::Axis {
            start_steps: self.start_steps,
            min_switch_at_steps: self.min_switch_at_steps,
            max_switch_at_steps: self.max_switch_at_steps,
            home_from_steps: self.home_from_steps,
            home_to_steps: self.home_to_steps,
            hard_min_steps: self.hard_min_steps,
            hard_max_steps: self.hard_max_steps,
        }
    }
}

impl Switch {
    const fn signal(self) -> Signal {
        match self {
            Self::LimitMin => Signal::LimitMin,
            Self::LimitMax => Signal::LimitMax,
            Self::HomeSwitch => Signal::HomeSwitch,
        }
    }
}

impl Sensor {
    /// The controller's input signal.
    pub const fn signal(self) -> Signal {
        match self {
            Self::LimitMin => Signal::LimitMin,
            Self::LimitMax => Signal::LimitMax,
            Self::HomeSwitch => Signal::HomeSwitch,
            Self::In0 => Signal::In0,
            Self::In1 => Signal::In1,
            Self::In2 => Signal::In2,
            Self::In3 => Signal::In3,
        }
    }
}

impl PanelInput {
    fn to_input(&self, here: &mut Validator) -> Input {
        let change = match (self.input, self.push_steps) {
            (Some(signal), None) => Change::Level(signal, self.level != 0),
            (None, Some(steps)) => Change::Push(steps.clamp(i32::MIN.into(), i32::MAX.into()) as i32),
            (given, _) => {
                let detail = match given {
                    Some(_) => "an entry is an input or a push, not both; make two entries",
                    None => "the entry is empty; use an input, or `push_steps`",
                };
                here.add("", ValueError::Conflict { detail });
                Change::Push(0)
            }
        };
        Input { cycle: Instant(self.cycle), change }
    }
}

impl ReadJson for Initial {
    fn read(&mut self, value: Json<'_>, reader: &mut JsonReader) -> bool {
        let Some(text) = value.text() else {
            return reader.reject_type(value, "\"blank\", \"factory\" or bytes in hex, such as \"01 00 ff\"");
        };
        *self = match (&*text, Hex::of_text(&text)) {
            ("blank", _) => Self::Blank,
            ("factory", _) => Self::Factory,
            (_, Ok(Hex(bytes))) => Self::Bytes(bytes),
            (_, Err(wrong)) => return reader.reject(format!("{wrong}; or use blank or factory")),
        };
        true
    }

    fn blank() -> Self {
        Self::default()
    }
}

impl ToParts for Initial {
    fn parts(&self) -> Parts<'_> {
        match self {
            Self::Blank => Parts::Value(Value::from("blank")),
            Self::Factory => Parts::Value(Value::from("factory")),
            Self::Bytes(bytes) => Parts::Value(Value::from(base16ct::lower::encode_string(bytes))),
        }
    }
}

impl Typed for Initial {
    const TYPE: Type = Type::Text;
}
