//! Checks rules between fields (DESIGN A4, A7, A9); `schema::ranges` checks single fields.
//!
//! Motions are checked when they are planned (`motion`).

use crate::{
    Cause, Controller, Hex, Host, LineScript, Noise, Problem, Scenario, Source, Validator, ValueError,
    limits::END_OF_TIME, schema::ranges::check_ranges,
};
use alloc::{
    format,
    string::{String, ToString},
    vec::Vec,
};
use stepscope_peripheral::{
    config::{Bus, Config, ConfigError, ConfigProblem, Field, Protocol, SerialLine},
    segment::CheckedSegments,
    signal::MAX_CHANNELS,
    units::{Cycles, Instant},
    wire::{ForcedLevel, schedule::line_time},
};

/// Maximum bytes of a line script, and maximum packets of a packet list.
const MAX_BYTES: usize = 4 << 20;

/// A valid scenario. Its motions are checked later.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "fields are named as in the scenario")]
pub struct CheckedScenario {
    pub configs: Vec<Config>,
    pub additional: Vec<Controller>,
    pub baud: u32,
    pub host: Host,
    pub noise: Noise,
    /// Levels forced on the line. If two overlap, the later wins.
    pub forced: Vec<ForcedLevel>,
    pub source: Source,
    pub segments: Option<CheckedSegments>,
    pub stand_alone: Option<stepscope_controller::CheckedSetup>,
    pub run: Option<Cycles>,
    pub plants: Option<crate::plant::Plants>,
}

impl CheckedScenario {
    /// Whether the host waits for a reply before it sends the next frame.
    #[must_use]
    pub fn waits_for_replies(&self) -> bool {
        let framed = self.configs.first().is_some_and(|config| config.protocol() == Protocol::Framed);
        framed && self.source.is_ticks()
    }
}

impl Scenario {
    /// Checks everything but motions.
    ///
    /// # Errors
    /// Every problem, each with its path.
    pub fn check(&self) -> Result<CheckedScenario, Vec<Problem>> {
        let mut validator = Validator::default();
        if self.version > crate::VERSION {
            let given = u64::from(self.version);
            validator.add("version", Cause::NewerVersion { given, newest: crate::VERSION });
        } else {
            validator.whole("version", self.version, 1..=crate::VERSION.into(), "");
        }
        check_ranges(self, &mut validator);
        let runs_alone = self.source.runs_alone();
        let configure = if runs_alone { Config::of_segments } else { Config::new };
        let config = configure(self.clock_hz, &self.bus, &self.line.serial());
        let config = config.map_err(|broken| report(broken, ToString::to_string, &mut validator)).ok();
        // By default the receiver has the host's rate, which is checked above.
        if self.line.receiver_baud.is_some() && !runs_alone {
            validator.whole("line.baud", self.line.baud, 1..=self.clock_hz.max(1).into(), "baud");
        }
        if runs_alone && !self.controllers.is_empty() {
            let detail = match self.source {
                Source::Standalone(_) => "stand-alone controllers have no line; move them to the source",
                _ => "segments run only one controller; remove the others, or choose ticks",
            };
            validator.add("controllers", ValueError::Conflict { detail });
        }
        let additional = self.additional(config.as_ref(), &mut validator);
        self.host(&mut validator);
        let forced = self.glitches(&mut validator);
        let mut segments = None;
        let mut stand_alone = None;
        match &self.source {
            Source::Motion(motion) => {
                let axes = motion.axes.len();
                validator.at("source.motion.axes", |here| {
                    fit_channels(here, axes, (1, "axes"), (self.bus.channels, "bus.channels"));
                });
            }
            Source::Packets(packets) => {
                let is_addressed = self.line.protocol == Protocol::Raw && self.line.address.is_some();
                let additional = self.controllers.iter().map(|controller| &controller.packets);
                let total: usize =
                    additional.chain([&packets.packets]).flatten().map(|Hex(bytes)| bytes.len()).sum();
                let channels = (self.bus.channels, "bus.channels");
                validator.at("source.packets.packets", |here| {
                    check_packets(&packets.packets, is_addressed, channels, here);
                });
                validator.length("source.packets.packets", total, 0..=MAX_BYTES, "bytes");
            }
            Source::Line(script) => self.script(script, &mut validator),
            Source::Segments(lists) => segments = validator.take(lists.check(&self.bus)),
            Source::Standalone(controllers) => stand_alone = self.stand_alone(controllers, &mut validator),
        }
        let axes = match &self.source {
            Source::Motion(motion) => motion.axes.len(),
            _ => usize::from(self.bus.channels),
        };
        let last = axes.clamp(1, MAX_CHANNELS) as u64 - 1;
        validator.whole("analysis.axis", self.analysis.axis, 0..=last, "");
        let configs: Vec<Config> = config.into_iter().chain(additional).collect();
        let plants = self.plants(&configs, &mut validator);
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

    fn glitches(&self, validator: &mut Validator) -> Vec<ForcedLevel> {
        let mut forced = Vec::new();
        let outside = validator.enter("line.glitches");
        for (index, glitch) in self.line.glitches.iter().enumerate() {
            let start = glitch.start_cycle;
            let room = END_OF_TIME.saturating_sub(start).max(1);
            validator.at_entry(index, |here| {
                here.whole("length_cycles", glitch.length_cycles, 1..=room, "cycles");
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

    fn additional(&self, first: Option<&Config>, validator: &mut Validator) -> Vec<Config> {
        // A line script may use one address for several controllers.
        let scripted = matches!(self.source, Source::Line(_));
        let has_no_address = self.line.protocol == Protocol::Raw && self.line.address.is_none();
        if !self.controllers.is_empty() && has_no_address && !scripted {
            let detail =
                "several controllers on a line need addresses; give the first one an address, 0 to 254";
            validator.add("line.address", ValueError::Conflict { detail });
        }
        let mut configs = Vec::new();
        for (index, controller) in self.controllers.iter().enumerate() {
            let line = SerialLine {
                baud: self.line.baud,
                receiver_baud: controller.receiver_baud,
                address: Some(controller.address),
                protocol: self.line.protocol,
            };
            match Config::new(self.clock_hz, &controller.bus, &line) {
                Ok(config) => configs.push(config),
                Err(broken) => {
                    let path = |field: &Field| match field {
                        // Already reported for the first controller.
                        Field::ClockHz | Field::Line("baud") => field.to_string(),
                        Field::Line(own) => format!("controllers[{index}].{own}"),
                        Field::Bus(_) => format!("controllers[{index}].{field}"),
                    };
                    report_new(broken, path, validator);
                }
            }
            let mut before = self.controllers.iter().take(index).map(|controller| controller.address);
            let first_address = first.and_then(Config::address);
            let same =
                first_address == Some(controller.address) || before.any(|other| other == controller.address);
            validator.at("controllers", |controllers| {
                controllers.at_entry(index, |here| {
                    if same && !scripted {
                        here.add("address", Cause::SameAddress { address: controller.address });
                    }
                    self.commands(controller, index, here);
                });
            });
        }
        let paced = self.line.protocol == Protocol::Raw && !matches!(self.source, Source::Line(_));
        if let Some(first) = first.filter(|_| paced && configs.len() == self.controllers.len()) {
            let outside = validator.enter("controllers");
            for (index, config) in configs.iter().enumerate() {
                validator.at_entry(index, |here| paced_together(config, first, here));
            }
            validator.leave(outside);
        }
        configs
    }

    fn commands(&self, controller: &Controller, index: usize, here: &mut Validator) {
        let path = format!("controllers[{index}].bus.channels");
        let channels = (controller.bus.channels, path.as_str());
        here.at("axes", |here| fit_channels(here, controller.axes.len(), (0, "axes"), channels));
        if !controller.axes.is_empty() && !matches!(self.source, Source::Motion(_)) {
            let detail = "axes need a motion as the source; remove them, or choose a motion";
            here.add("axes", ValueError::Conflict { detail });
        }
        if !controller.packets.is_empty() && !matches!(self.source, Source::Packets(_)) {
            let detail = "packets need packets as the source; remove them, or choose packets";
            here.add("packets", ValueError::Conflict { detail });
        }
        let is_addressed = self.line.protocol == Protocol::Raw;
        here.at("packets", |here| check_packets(&controller.packets, is_addressed, channels, here));
    }

    fn host(&self, validator: &mut Validator) {
        let receives_replies = self.line.protocol == Protocol::Framed && self.source.is_ticks();
        if receives_replies && self.line.receiver_baud.is_some() {
            let host = SerialLine { receiver_baud: None, ..self.line.serial() };
            let mut broken = Config::new(self.clock_hz, &Bus::default(), &host).err().unwrap_or_default();
            broken.retain(|problem| problem.field == Field::Line("baud"));
            report_new(broken, ToString::to_string, validator);
        }
    }

    fn script(&self, script: &LineScript, validator: &mut Validator) {
        let total = script.sends.iter().map(|send| send.wire().len()).sum();
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
            let bytes = send.wire().len() as u64;
            let end = start.min(END_OF_TIME) + line_time(bytes, self.clock_hz, self.line.baud);
            free_from = free_from.max(end);
        }
        validator.leave(outside);
    }
}

/// Skips ranges that `check_ranges` has reported.
fn report(broken: Vec<ConfigProblem>, path: impl Fn(&Field) -> String, validator: &mut Validator) {
    for ConfigProblem { field, error } in broken {
        let path = path(&field);
        if !(matches!(error, ConfigError::Range { .. }) && validator.has(&path)) {
            validator.add(&path, error);
        }
    }
}

/// Skips problems that another configuration has as well.
fn report_new(broken: Vec<ConfigProblem>, path: impl Fn(&Field) -> String, validator: &mut Validator) {
    for ConfigProblem { field, error } in broken {
        let path = path(&field);
        if !validator.has(&path) {
            validator.add(&path, error);
        }
    }
}

/// Controllers with common ticks need equal tick and packet lengths.
fn paced_together(config: &Config, first: &Config, here: &mut Validator) {
    let (tick_cycles, first_cycles) = (config.tick().0, first.tick().0);
    if tick_cycles != first_cycles {
        here.add("bus.step_period_cycles", Cause::OtherTick { tick_cycles, first_cycles });
    }
    let (channels, first_channels) = (config.channels(), first.channels());
    if channels != first_channels {
        here.add("bus.channels", Cause::OtherPackets { channels, first_channels });
    }
}

/// `least` is the minimum and what is counted, `channels` the number of channels and its path.
pub(crate) fn fit_channels(
    here: &mut Validator,
    given: usize,
    least: (usize, &'static str),
    channels: (u8, &str),
) {
    let ((least, of), (channels, path)) = (least, channels);
    if !(least..=usize::from(channels).clamp(1, MAX_CHANNELS)).contains(&given) {
        here.add("", Cause::Channels { given, of, channels, path: path.into() });
    }
}

/// `channels` is their number and its path.
fn check_packets(packets: &[Hex], is_addressed: bool, channels: (u8, &str), here: &mut Validator) {
    let (channels, path) = channels;
    for (index, Hex(bytes)) in packets.iter().enumerate() {
        let given = bytes.len();
        if given != usize::from(channels) + usize::from(is_addressed) {
            here.at_entry(index, |here| {
                here.add("", Cause::PacketLength { given, channels, is_addressed, path: path.into() });
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::String;

    fn paths(json: &str) -> Vec<String> {
        let scenario = Scenario::from_json(json).expect("reads");
        scenario.check().err().unwrap_or_default().into_iter().map(|p| p.path).collect()
    }

    #[test]
    fn errors_state_the_number_of_channels() {
        let rows = [
            (
                r#"{"source":{"motion":{"axes":[{},{}]}}}"#,
                "source.motion.axes: 2 axes, but `bus.channels` is 1; remove 1, or set `bus.channels` to 2",
            ),
            (r#"{"source":{"motion":{"axes":[]}}}"#, "source.motion.axes: 0 axes; give at least 1"),
            (
                r#"{"controllers":[{"axes":[{},{},{}]}],"line":{"address":0}}"#,
                "controllers[0].axes: 3 axes, but `controllers[0].bus.channels` is 1; remove 2, or set `controllers[0].bus.channels` to 3",
            ),
            (
                r#"{"source":{"packets":{"packets":["8001"]}}}"#,
                "source.packets.packets[0]: 2 bytes; give 1: one per channel (`bus.channels` is 1)",
            ),
            (
                r#"{"line":{"address":7},"source":{"packets":{"packets":["80"]}}}"#,
                "source.packets.packets[0]: 1 bytes; give 2: the address and one per channel (`bus.channels` is 1)",
            ),
            (r#"{"line":{"baud":0}}"#, "line.baud: 0 baud is out of range; give 1 to 1523809 baud"),
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
