//! Checks rules between fields (DESIGN A4, A7, A9); `schema::ranges` checks single fields.

use crate::{
    Cause, Controller, Hex, Host, LineScript, Noise, Packets, Problems, Scenario, Source, VERSION, Validator,
    ValueError, limits::END_OF_TIME, schema::ranges::check_ranges,
};
use alloc::string::{String, ToString};
use alloc::{format, vec::Vec};
use stepscope_peripheral::config::{Bus, Config, ConfigError, ConfigProblem, Field, Protocol, SerialLine};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_peripheral::wire::{ForcedLevel, schedule::line_time};
use stepscope_peripheral::{segment::CheckedSegments, signal::MAX_CHANNELS};

/// Maximum bytes of a line script, or of all packets.
const MAX_BYTES: usize = 4 << 20;

/// A valid scenario. Its motions are checked when they are planned.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedScenario {
    /// One per controller; the first is for `bus` and `line`.
    pub configs: Vec<Config>,
    /// The controllers after the first.
    pub additional: Vec<Controller>,
    /// Bit rate of the host.
    pub baud: u32,
    /// The host of a framed line.
    pub host: Host,
    /// Random faults of the line and the host.
    pub noise: Noise,
    /// Levels forced on the line. If two overlap, the later wins.
    pub forced: Vec<ForcedLevel>,
    /// What the host sends, or what the controllers run without a host.
    pub source: Source,
    /// The lists, if the source is segments.
    pub segments: Option<CheckedSegments>,
    /// The controllers, if they are stand-alone.
    pub stand_alone: Option<stepscope_controller::CheckedSetup>,
    /// Given length of the run.
    pub run: Option<Cycles>,
    /// Motors and supply behind each controller.
    pub plants: Option<crate::plant::Plants>,
}

impl CheckedScenario {
    /// Whether the host waits for a reply before it sends the next frame.
    pub fn waits_for_replies(&self) -> bool {
        let is_framed = self.configs.first().is_some_and(|config| config.protocol() == Protocol::Framed);
        is_framed && self.source.sends_ticks()
    }
}

impl Scenario {
    /// Checks everything but motions.
    /// Errors: every problem, each with its path.
    pub fn check(&self) -> Result<CheckedScenario, Problems> {
        let mut validator = Validator::default();
        self.check_version(&mut validator);
        check_ranges(self, &mut validator);
        let first = self.check_first_controller(&mut validator);
        let additional_configs = self.check_additional_controllers(first.as_ref(), &mut validator);
        self.check_host_rate(&mut validator);
        let forced = self.check_glitches(&mut validator);
        let (mut segments, mut stand_alone) = (None, None);
        match &self.source {
            Source::Motion(motion) => validator.at("source.motion.axes", |axes| {
                self.channels().check_count(motion.axes.len(), 1, "axes", axes);
            }),
            Source::Packets(packets) => self.check_packets(packets, &mut validator),
            Source::Line(script) => self.check_script(script, &mut validator),
            Source::Segments(lists) => {
                let check = |here: &mut Validator| lists.check(&self.bus, here);
                segments = validator.at("source.segments.channels", check);
            }
            Source::StandAlone(controllers) => {
                stand_alone = self.check_stand_alone(controllers, &mut validator);
            }
        }
        self.check_analysis_axis(&mut validator);
        let configs: Vec<Config> = first.into_iter().chain(additional_configs).collect();
        let plants = self.check_plants(&configs, &mut validator);
        validator.end(()).map(|()| CheckedScenario {
            configs,
            additional: self.controllers.clone(),
            // Not checked if nothing is sent.
            baud: self.line.baud.max(1),
            host: self.line.host.clone(),
            noise: self.line.noise.clone(),
            forced,
            source: self.source.clone(),
            segments,
            stand_alone,
            run: self.run_cycles.map(Cycles),
            plants,
        })
    }

    pub(crate) const fn channels(&self) -> Channels<'static> {
        Channels { count: self.bus.channels, path: "bus.channels" }
    }

    fn check_version(&self, validator: &mut Validator) {
        if self.version > VERSION {
            validator.add("version", Cause::NewerVersion { given: self.version.into(), newest: VERSION });
        } else {
            validator.whole("version", self.version, 1..=VERSION.into(), "");
        }
    }

    fn check_first_controller(&self, validator: &mut Validator) -> Option<Config> {
        let has_no_line = self.source.sends_nothing();
        let configure = if has_no_line { Config::of_segments } else { Config::new };
        let config = configure(self.clock_hz, &self.bus, &self.line.serial());
        let is_range = |error: &ConfigError| matches!(error, ConfigError::Range { .. });
        let config =
            config.map_err(|problems| add_new(problems, ToString::to_string, is_range, validator)).ok();
        // By default the receiver has the host's rate, which is checked above.
        if self.line.receiver_baud.is_some() && !has_no_line {
            validator.whole("line.baud", self.line.baud, 1..=self.clock_hz.max(1).into(), "baud");
        }
        config
    }

    fn check_analysis_axis(&self, validator: &mut Validator) {
        let axes = match &self.source {
            Source::Motion(motion) => motion.axes.len(),
            _ => usize::from(self.bus.channels),
        };
        let last = axes.clamp(1, MAX_CHANNELS) as u64 - 1;
        validator.whole("analysis.axis", self.analysis.axis, 0..=last, "");
    }

    fn check_glitches(&self, validator: &mut Validator) -> Vec<ForcedLevel> {
        let mut forced = Vec::new();
        let outside = validator.enter("line.glitches");
        for (index, glitch) in self.line.glitches.iter().enumerate() {
            let start = glitch.start_cycle;
            let max_length = END_OF_TIME.saturating_sub(start).max(1);
            validator.at_entry(index, |here| {
                here.whole("length_cycles", glitch.length_cycles, 1..=max_length, "cycles");
            });
            forced.push(ForcedLevel {
                start: Instant(start),
                end: Instant(start.saturating_add(glitch.length_cycles)),
                level: glitch.level != 0,
            });
        }
        validator.leave(outside);
        forced
    }

    fn check_additional_controllers(&self, first: Option<&Config>, validator: &mut Validator) -> Vec<Config> {
        if self.controllers.is_empty() {
            return Vec::new();
        }
        if self.source.sends_nothing() {
            let detail = match self.source {
                Source::StandAlone(_) => {
                    "stand-alone controllers share no line; add each one to `source.standalone` instead"
                }
                _ => "segments run only one controller; remove the others, or choose ticks",
            };
            validator.add("controllers", ValueError::Conflict { detail });
            return Vec::new();
        }
        // A line script may use one address for several controllers.
        let is_script = matches!(self.source, Source::Line(_));
        let is_raw = self.line.protocol == Protocol::Raw;
        if is_raw && self.line.address.is_none() && !is_script {
            let detail = "several controllers on a line need addresses; use an address from 0 to 254 for the first one";
            validator.add("line.address", ValueError::Conflict { detail });
        }
        let mut configs = Vec::new();
        for (index, controller) in self.controllers.iter().enumerate() {
            configs.extend(self.check_config(controller, index, validator));
        }
        let outside = validator.enter("controllers");
        for (index, controller) in self.controllers.iter().enumerate() {
            let mut before = self.controllers.iter().take(index).map(|controller| controller.address);
            let is_used = first.and_then(Config::address) == Some(controller.address)
                || before.any(|other| other == controller.address);
            validator.at_entry(index, |here| {
                if is_used && !is_script {
                    here.add("address", Cause::SameAddress { address: controller.address });
                }
                self.check_commands(controller, index, here);
            });
        }
        if let Some(first) = first.filter(|_| is_raw && !is_script && configs.len() == self.controllers.len())
        {
            for (index, config) in configs.iter().enumerate() {
                validator.at_entry(index, |here| check_common_ticks(config, first, here));
            }
        }
        validator.leave(outside);
        configs
    }

    fn check_config(
        &self,
        controller: &Controller,
        index: usize,
        validator: &mut Validator,
    ) -> Option<Config> {
        let line = SerialLine {
            baud: self.line.baud,
            receiver_baud: controller.receiver_baud,
            address: Some(controller.address),
            protocol: self.line.protocol,
        };
        let path_of = |field: &Field| match field {
            // All controllers share these.
            Field::ClockHz | Field::Line("baud") => field.to_string(),
            Field::Line(own) => format!("controllers[{index}].{own}"),
            Field::Bus(_) => format!("controllers[{index}].{field}"),
        };
        Config::new(self.clock_hz, &controller.bus, &line)
            .map_err(|problems| add_new(problems, path_of, |_| true, validator))
            .ok()
    }

    /// What the host sends to an additional controller. `here` is at its entry.
    fn check_commands(&self, controller: &Controller, index: usize, here: &mut Validator) {
        let path = format!("controllers[{index}].bus.channels");
        let channels = Channels { count: controller.bus.channels, path: &path };
        here.at("axes", |axes| channels.check_count(controller.axes.len(), 0, "axes", axes));
        if !controller.axes.is_empty() && !matches!(self.source, Source::Motion(_)) {
            let detail = "`axes` is used only with the source `motion`; remove it, or change the source";
            here.add("axes", ValueError::Conflict { detail });
        }
        if !controller.packets.is_empty() && !matches!(self.source, Source::Packets(_)) {
            let detail = "`packets` is used only with the source `packets`; remove it, or change the source";
            here.add("packets", ValueError::Conflict { detail });
        }
        let is_addressed = self.line.protocol == Protocol::Raw;
        here.at("packets", |list| channels.check_packets(&controller.packets, is_addressed, list));
    }

    /// Replies arrive at the host's own bit rate.
    fn check_host_rate(&self, validator: &mut Validator) {
        let receives_replies = self.line.protocol == Protocol::Framed && self.source.sends_ticks();
        if receives_replies && self.line.receiver_baud.is_some() {
            let host = SerialLine { receiver_baud: None, ..self.line.serial() };
            let problems = Config::new(self.clock_hz, &Bus::default(), &host).err().unwrap_or_default();
            let is_rate = |problem: &ConfigProblem| problem.field == Field::Line("baud");
            add_new(problems.into_iter().filter(is_rate), ToString::to_string, |_| true, validator);
        }
    }

    fn check_packets(&self, packets: &Packets, validator: &mut Validator) {
        let is_addressed = self.line.protocol == Protocol::Raw && self.line.address.is_some();
        let additional_packets = self.controllers.iter().map(|controller| &controller.packets);
        let all = additional_packets.chain([&packets.packets]).flatten();
        let bytes: usize = all.map(|Hex(bytes)| bytes.len()).sum();
        validator.at("source.packets.packets", |list| {
            self.channels().check_packets(&packets.packets, is_addressed, list);
        });
        validator.length("source.packets.packets", bytes, 0..=MAX_BYTES, "bytes");
    }

    fn check_script(&self, script: &LineScript, validator: &mut Validator) {
        let total = script.sends.iter().map(|send| send.line_bytes().len()).sum();
        validator.length("source.line.sends", total, 0..=MAX_BYTES, "bytes");
        let mut free_from = 1;
        let outside = validator.enter("source.line.sends");
        for (index, send) in script.sends.iter().enumerate() {
            let start = send.start_cycle;
            validator.at_entry(index, |here| {
                if start < free_from && start >= 1 {
                    here.add("start_cycle", Cause::Overlap { start, free_from });
                }
                if send.frame.is_some() && !send.bytes.0.is_empty() {
                    let detail = "a send has bytes or a frame, not both; remove one";
                    here.add("bytes", ValueError::Conflict { detail });
                }
            });
            let bytes = send.line_bytes().len() as u64;
            let end = start.min(END_OF_TIME) + line_time(bytes, self.clock_hz, self.line.baud);
            free_from = free_from.max(end);
        }
        validator.leave(outside);
    }
}

/// Adds problems, without those of the kind `is_repeated` at paths that already have one: another configuration or
/// `check_ranges` has reported them.
fn add_new(
    problems: impl IntoIterator<Item = ConfigProblem>,
    path_of: impl Fn(&Field) -> String,
    is_repeated: impl Fn(&ConfigError) -> bool,
    validator: &mut Validator,
) {
    for ConfigProblem { field, error } in problems {
        let path = path_of(&field);
        if !(is_repeated(&error) && validator.has_problem(&path)) {
            validator.add(&path, error);
        }
    }
}

/// Controllers with common ticks need equal tick and packet lengths.
fn check_common_ticks(config: &Config, first: &Config, here: &mut Validator) {
    let (tick_cycles, first_cycles) = (config.tick().0, first.tick().0);
    if tick_cycles != first_cycles {
        here.add("bus.step_period_cycles", Cause::OtherTick { tick_cycles, first_cycles });
    }
    let (channels, first_channels) = (config.channels(), first.channels());
    if channels != first_channels {
        here.add("bus.channels", Cause::OtherPackets { channels, first_channels });
    }
}

/// The number of a controller's channels, and the path of the field that sets it.
#[derive(Clone, Copy)]
pub(crate) struct Channels<'a> {
    pub(crate) count: u8,
    pub(crate) path: &'a str,
}

impl Channels<'_> {
    /// Reports less than `min` or more axes, lists or controllers (`of`) than channels.
    pub(crate) fn check_count(self, given: usize, min: usize, of: &'static str, here: &mut Validator) {
        if !(min..=usize::from(self.count).clamp(1, MAX_CHANNELS)).contains(&given) {
            here.add("", Cause::Channels { given, of, channels: self.count, path: self.path.into() });
        }
    }

    /// Reports packets that do not have one byte per channel, and the address if `is_addressed`.
    fn check_packets(self, packets: &[Hex], is_addressed: bool, here: &mut Validator) {
        for (index, Hex(bytes)) in packets.iter().enumerate() {
            let given = bytes.len();
            if given != usize::from(self.count) + usize::from(is_addressed) {
                let (channels, path) = (self.count, self.path.into());
                here.at_entry(index, |here| {
                    here.add("", Cause::PacketLength { given, channels, is_addressed, path });
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::String;

    fn paths(json: &str) -> Vec<String> {
        let scenario = Scenario::from_json(json).expect("reads");
        scenario.check().err().into_iter().flatten().map(|p| p.path).collect()
    }

    #[test]
    fn errors_state_the_number_of_channels() {
        let rows = [
            (
                r#"{"source":{"motion":{"axes":[{},{}]}}}"#,
                "source.motion.axes: 2 axes, but `bus.channels` is 1; remove 1, or set `bus.channels` to 2",
            ),
            (r#"{"source":{"motion":{"axes":[]}}}"#, "source.motion.axes: 0 axes; use at least 1"),
            (
                r#"{"controllers":[{"axes":[{},{},{}]}],"line":{"address":0}}"#,
                "controllers[0].axes: 3 axes, but `controllers[0].bus.channels` is 1; remove 2, or set `controllers[0].bus.channels` to 3",
            ),
            (
                r#"{"source":{"packets":{"packets":["8001"]}}}"#,
                "source.packets.packets[0]: 2 bytes; use 1: one per channel (`bus.channels` is 1)",
            ),
            (
                r#"{"line":{"address":7},"source":{"packets":{"packets":["80"]}}}"#,
                "source.packets.packets[0]: 1 bytes; use 2: the address and one per channel (`bus.channels` is 1)",
            ),
            (r#"{"line":{"baud":0}}"#, "line.baud: 0 baud is out of range; use 1 to 1523809 baud"),
        ];
        for (json, expected) in rows {
            let problems = Scenario::from_json(json).expect("reads").check().expect_err(json);
            assert_eq!(problems[0].to_string(), expected);
        }
    }

    #[test]
    fn every_number_out_of_range_is_listed_with_its_path() {
        let rows: &[(&str, &[&str])] = &[
            ("{}", &[]),
            (
                r#"{"bus":{"channels":0,"slots":128,"queue_depth":0}}"#,
                &["bus.channels", "bus.slots", "bus.queue_depth"],
            ),
            (r#"{"bus":{"channels":17}}"#, &["bus.channels"]),
            (r#"{"clock_hz":10}"#, &["clock_hz"]),
            (r#"{"clock_hz":11,"line":{"baud":1}}"#, &[]),
            (r#"{"line":{"baud":200000000}}"#, &["line.baud"]),
            (r#"{"run_cycles":9007199254740993}"#, &["run_cycles"]),
            (
                r#"{"line":{"glitches":[{"start_cycle":8999999999999999,"length_cycles":2}]}}"#,
                &["line.glitches[0].length_cycles"],
            ),
            (r#"{"line":{"baud":0}}"#, &["line.baud"]),
            (r#"{"line":{"baud":0,"receiver_baud":9600}}"#, &["line.baud"]),
            (r#"{"clock_hz":1000000,"line":{"baud":100000}}"#, &["line.baud"]),
            (r#"{"clock_hz":1000000,"line":{"baud":95238}}"#, &[]),
            (r#"{"clock_hz":1000000,"line":{"baud":95239}}"#, &["line.baud"]),
            (r#"{"line":{"receiver_baud":9000000}}"#, &["line.receiver_baud"]),
            (r#"{"bus":{"pulse_width_cycles":0}}"#, &["bus.pulse_width_cycles"]),
            (r#"{"bus":{"pulse_width_cycles":280,"dir_setup_cycles":40}}"#, &[]),
            (r#"{"bus":{"pulse_width_cycles":281,"dir_setup_cycles":40}}"#, &["bus.step_period_cycles"]),
            (r#"{"bus":{"pulse_width_cycles":320,"dir_setup_cycles":0}}"#, &["bus.step_period_cycles"]),
            (
                r#"{"analysis":{"axis":1,"order":1,"fft_length":15,"sensor_hz":0}}"#,
                &["analysis.axis", "analysis.max_harmonic", "analysis.fft_length", "analysis.sensor_hz"],
            ),
            (
                r#"{"analysis":{"fft_length":65537,"sensor_hz":1e10}}"#,
                &["analysis.fft_length", "analysis.sensor_hz"],
            ),
            (r#"{"analysis":{"fft_length":1000,"sensor_hz":0.001}}"#, &[]),
            (r#"{"analysis":{"fft_length":16,"sensor_hz":null}}"#, &[]),
            (r#"{"source":{"packets":{"packets":["80","8001"]}}}"#, &["source.packets.packets[1]"]),
            (
                r#"{"source":{"line":{"sends":[{"start_cycle":0,"bytes":"00"}]}}}"#,
                &["source.line.sends[0].start_cycle"],
            ),
            (
                r#"{"clock_hz":1000,"line":{"baud":50},"source":{"line":{"sends":[{"start_cycle":1,"bytes":"0000"},{"start_cycle":400,"bytes":"00"},{"start_cycle":601,"bytes":"00"}]}}}"#,
                &["source.line.sends[1].start_cycle"],
            ),
            (
                r#"{"line":{"glitches":[{"start_cycle":0,"length_cycles":0,"level":2}]}}"#,
                &["line.glitches[0].start_cycle", "line.glitches[0].length_cycles", "line.glitches[0].level"],
            ),
        ];
        for (given, expected) in rows {
            let (mut found, mut expected) = (paths(given), expected.to_vec());
            found.sort();
            expected.sort_unstable();
            assert_eq!(found, expected, "{given}");
        }
    }
}
