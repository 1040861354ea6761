//! A case as the text of a scenario. Some fields with default values are omitted, by a seed computed from the case.

use std::fmt::Write;

use super::parameters::{
    Axis, Case, Controller, Entry, Group, Home, Initial, Input, Memory, Move, Policy, Release, ShortMove,
    Until, What,
};
use super::random::SplitMix64;
use crate::xxh64::xxh64;

/// The scenario's JSON.
pub fn to_json(case: &Case) -> String {
    let mut out = Text { bits: SplitMix64(xxh64(format!("{case:?}").as_bytes())) };
    let bus = out.map(&[
        ("channels", case.channels.to_string(), "1".into()),
        ("pulse_width_cycles", case.w.to_string(), "40".into()),
        ("dir_setup_cycles", case.d.to_string(), "40".into()),
        ("dir_hold_cycles", case.h.to_string(), "0".into()),
    ]);
    let controllers: Vec<String> =
        case.controllers.iter().map(|controller| out.controller(controller)).collect();
    let run = or_null(case.run_cycles);
    out.map(&[
        ("clock_hz", case.clock_hz.to_string(), "16000000".into()),
        ("bus", bus, String::new()),
        ("run_cycles", run, "null".into()),
        ("source", format!("{{ \"standalone\": [{}] }}", controllers.join(", ")), String::new()),
    ])
}

fn or_null(value: Option<impl ToString>) -> String {
    value.map_or("null".into(), |value| value.to_string())
}

fn quoted(word: &str) -> String {
    format!("\"{word}\"")
}

fn bit(level: bool) -> String {
    u8::from(level).to_string()
}

fn name(input: Input) -> String {
    quoted(&input.name())
}

fn until(until: Option<Until>) -> String {
    until.map_or("null".into(), |until| {
        format!("{{ \"input\": {}, \"level\": {} }}", name(until.input), u8::from(until.level))
    })
}

/// (name, value, default), the last two as text.
type Field = (&'static str, String, String);

struct Text {
    bits: SplitMix64,
}

impl Text {
    fn map(&mut self, fields: &[Field]) -> String {
        let mut text = String::new();
        for (name, value, default) in fields {
            if value == default && self.bits.bits().is_multiple_of(2) {
                continue;
            }
            let comma = if text.is_empty() { "" } else { "," };
            let _ = write!(text, "{comma} \"{name}\": {value}");
        }
        format!("{{{text} }}")
    }

    fn controller(&mut self, of: &Controller) -> String {
        let plain = Controller::default();
        let groups: Vec<String> = of.groups.iter().map(|group| self.group(group)).collect();
        let jog = self.map(&[
            ("speed_hz", of.jog.speed_hz.to_string(), "1000".into()),
            ("fine_hz", of.jog.fine_hz.to_string(), "10".into()),
            ("level", of.jog.level.to_string(), "3".into()),
            (
                "release",
                quoted(if of.jog.release == Release::Ramp { "ramp" } else { "at_once" }),
                quoted("at_once"),
            ),
        ]);
        let return_to_zero = self.map(&[
            ("speed_hz", of.return_to_zero.speed_hz.to_string(), "1000".into()),
            ("level", of.return_to_zero.level.to_string(), "3".into()),
        ]);
        let short_move =
            if of.short_move == ShortMove::Document { quoted("document") } else { quoted("turn_round") };
        let home = of.home.as_ref().map_or("null".into(), |home| self.home(home));
        let soft_limits = of.soft_limits.as_ref().map_or("null".into(), |limits| {
            format!("{{ \"min_steps\": {}, \"max_steps\": {} }}", limits.min_steps, limits.max_steps)
        });
        let axis = of.axis.as_ref().map_or("null".into(), |axis| self.axis(axis));
        let memory = self.memory(&of.memory);
        let inputs: Vec<String> = of.inputs.iter().map(entry).collect();
        let number = |name, value: &dyn ToString, default: &dyn ToString| {
            (name, value.to_string(), default.to_string())
        };
        self.map(&[
            number("self_test_cycles", &of.self_test_cycles, &plain.self_test_cycles),
            number("debounce_cycles", &of.debounce_cycles, &plain.debounce_cycles),
            number("sensor_debounce_cycles", &of.sensor_debounce_cycles, &plain.sensor_debounce_cycles),
            number("pulses_per_unit", &of.pulses_per_unit, &plain.pulses_per_unit),
            number("decimals", &of.decimals, &plain.decimals),
            number("start_speed_hz", &of.start_speed_hz, &plain.start_speed_hz),
            number("max_speed_hz", &of.max_speed_hz, &plain.max_speed_hz),
            number("level_hz_s", &of.level_hz_s, &plain.level_hz_s),
            ("short_move", short_move, quoted("document")),
            number("least_trust", &of.least_trust, &plain.least_trust),
            number("loops", &of.loops, &plain.loops),
            ("groups", format!("[{}]", groups.join(", ")), String::new()),
            ("jog", jog, "{ }".into()),
            ("return", return_to_zero, "{ }".into()),
            ("home", home, "null".into()),
            ("soft_limits", soft_limits, "null".into()),
            ("axis", axis, "null".into()),
            ("memory", memory, "{ }".into()),
            ("inputs", format!("[{}]", inputs.join(", ")), "[]".into()),
        ])
    }

    fn group(&mut self, group: &Group) -> String {
        let (kind, fields): (&str, Vec<Field>) = match group {
            Group::Move(order) => ("move", move_fields(order)),
            Group::MoveTo { length, speed_hz, level, delay_ms } => (
                "move_to",
                vec![
                    ("length", length.to_string(), "0".into()),
                    ("speed_hz", speed_hz.to_string(), "5000".into()),
                    ("level", level.to_string(), "3".into()),
                    ("delay_ms", delay_ms.to_string(), "0".into()),
                ],
            ),
            Group::Profile(profile) => (
                "profile",
                vec![
                    ("intervals_q16", format!("{:?}", profile.intervals_q16), String::new()),
                    ("direction", bit(profile.right), "1".into()),
                    ("delay_ms", profile.delay_ms.to_string(), "0".into()),
                ],
            ),
            Group::Home => ("home", Vec::new()),
            Group::Wait { input, level, timeout_ms, then } => (
                "wait",
                vec![
                    ("input", name(*input), quoted("in_0")),
                    ("level", bit(*level), "1".into()),
                    ("timeout_ms", timeout_ms.to_string(), "0".into()),
                    ("then", or_null(*then), "null".into()),
                ],
            ),
            Group::Set { output, level } => {
                ("set", vec![("output", output.to_string(), "0".into()), ("level", bit(*level), "1".into())])
            }
            Group::Repeat { first, times } => (
                "repeat",
                vec![("first", first.to_string(), "1".into()), ("times", times.to_string(), "2".into())],
            ),
            Group::Jump { to, input, level } => (
                "jump",
                vec![
                    ("to", to.to_string(), "1".into()),
                    ("input", input.map_or("null".into(), name), "null".into()),
                    ("level", bit(*level), "1".into()),
                ],
            ),
        };
        let fields = self.map(&fields);
        format!("{{ \"{kind}\": {fields} }}")
    }

    fn home(&mut self, of: &Home) -> String {
        self.map(&[
            ("switch", name(of.switch), quoted("home_switch")),
            ("direction", bit(of.right), "0".into()),
            ("coarse_hz", of.coarse_hz.to_string(), "1000".into()),
            ("fine_hz", of.fine_hz.to_string(), "10".into()),
            ("pull_off_steps", of.pull_off_steps.to_string(), "20".into()),
            ("max_travel_steps", of.max_travel_steps.to_string(), "100000".into()),
            ("position_steps", of.position_steps.to_string(), "0".into()),
        ])
    }

    fn axis(&mut self, of: &Axis) -> String {
        self.map(&[
            ("start_steps", of.start_steps.to_string(), "0".into()),
            ("min_switch_at_steps", or_null(of.min_switch_at_steps), "null".into()),
            ("max_switch_at_steps", or_null(of.max_switch_at_steps), "null".into()),
            ("home_from_steps", or_null(of.home_from_steps), "null".into()),
            ("home_to_steps", or_null(of.home_to_steps), "null".into()),
            ("hard_min_steps", or_null(of.hard_min_steps), "null".into()),
            ("hard_max_steps", or_null(of.hard_max_steps), "null".into()),
        ])
    }

    fn memory(&mut self, of: &Memory) -> String {
        let policy = match of.policy {
            Policy::PowerLoss => "power_loss",
            Policy::WriteAhead => "write_ahead",
        };
        let initial = match &of.initial {
            Initial::Blank => "blank".into(),
            Initial::Factory => "factory".into(),
            Initial::Bytes(bytes) => {
                bytes.iter().fold(String::new(), |hex, byte| hex + &format!("{byte:02x}"))
            }
        };
        self.map(&[
            ("policy", quoted(policy), quoted("power_loss")),
            ("byte_write_cycles", of.byte_write_cycles.to_string(), "136000".into()),
            ("hold_up_cycles", of.hold_up_cycles.to_string(), "3200000".into()),
            ("slots", of.slots.to_string(), "8".into()),
            ("initial", quoted(&initial), quoted("factory")),
        ])
    }
}

fn move_fields(order: &Move) -> Vec<Field> {
    vec![
        ("length", order.length.to_string(), "1000".into()),
        ("direction", bit(order.right), "1".into()),
        ("speed_hz", order.speed_hz.to_string(), "5000".into()),
        ("level", order.level.to_string(), "3".into()),
        ("delay_ms", order.delay_ms.to_string(), "0".into()),
        ("until", until(order.until), "null".into()),
    ]
}

fn entry(entry: &Entry) -> String {
    match entry.what {
        What::Level(input, level) => {
            format!(
                "{{ \"cycle\": {}, \"input\": {}, \"level\": {} }}",
                entry.cycle,
                name(input),
                u8::from(level)
            )
        }
        What::Push(steps) => format!("{{ \"cycle\": {}, \"push_steps\": {steps} }}", entry.cycle),
    }
}
