//! Checks the rules that join several fields (DESIGN A4, A7, A9); `schema::judge` checks single fields.
//!
//! Motions are checked where they are planned (`motion`); `sim::Experiment` collects the problems of both.

use crate::{
    Cause, Controller, Hex, Host, LineScript, Noise, Problem, Scenario, Source, Validator, ValueError,
    limits::END_OF_TIME, schema::judge::judge,
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

/// A valid scenario; its motions are not checked yet.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedScenario {
    /// The controllers on the line, the scenario's own first.
    pub configs: Vec<Config>,
    /// The commands of the additional controllers.
    pub additional: Vec<Controller>,
    /// The host's bit rate.
    pub baud: u32,
    /// The host of a framed line.
    pub host: Host,
    /// Random faults of the line.
    pub noise: Noise,
    /// Levels forced on the line; of two that overlap, the later wins.
    pub forced: Vec<ForcedLevel>,
    /// What the host sends; motions are not checked yet.
    pub source: Source,
    /// The segments, if they are the source.
    pub segments: Option<CheckedSegments>,
    /// The stand-alone controllers, if they are the source.
    pub stand_alone: Option<stepscope_controller::CheckedSetup>,
    /// Length of the run, if given.
    pub run: Option<Cycles>,
    /// The plants, if any.
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
        judge(self, &mut validator);
        let runs_alone = self.source.runs_alone();
        let configure = if runs_alone { Config::of_segments } else { Config::new };
        let config = configure(self.clock_hz, &self.bus, &self.line.serial());
        let config = config.map_err(|broken| tell(broken, ToString::to_string, &mut validator)).ok();
        // By default the receiver has the host's rate, which is checked above.
        if self.line.receiver_baud.is_some() && !runs_alone {
            validator.whole("line.baud", self.line.baud, 1..=self.clock_hz.max(1).into(), "baud");
        }
        if runs_alone && !self.controllers.is_empty() {
            let detail = match self.source {
                Source::Standalone(_) => {
                    "stand-alone controllers are on no line; give all of them in source.standalone"
                }
                _ => "segments run one controller by itself; take the others out, or choose ticks",
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
                let most = usize::from(self.bus.channels).clamp(1, MAX_CHANNELS);
                validator.length("source.motion.axes", motion.axes.len(), 1..=most, "axes");
            }
            Source::Packets(packets) => {
                let address = usize::from(self.line.protocol == Protocol::Raw && self.line.address.is_some());
                let len = usize::from(self.bus.channels) + address;
                let additional = self.controllers.iter().map(|controller| &controller.packets);
                let total: usize =
                    additional.chain([&packets.packets]).flatten().map(|Hex(bytes)| bytes.len()).sum();
                validator.at("source.packets.packets", |here| judge_packets(&packets.packets, len, here));
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
            // If nothing is sent, it has not been checked.
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
        // A line script may address several controllers at once, for tests of such lines.
        let scripted = matches!(self.source, Source::Line(_));
        let nameless = self.line.protocol == Protocol::Raw && self.line.address.is_none();
        if !self.controllers.is_empty() && nameless && !scripted {
            let detail =
                "several controllers on a line need an address each; give the first one an address, 0 to 254";
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
                        // These belong to the whole line and are reported for the first controller.
                        Field::ClockHz | Field::Line("baud") => field.to_string(),
                        Field::Line(own) => format!("controllers[{index}].{own}"),
                        Field::Bus(_) => format!("controllers[{index}].{field}"),
                    };
                    tell_once(broken, path, validator);
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
                    self.orders(controller, here);
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

    fn orders(&self, controller: &Controller, here: &mut Validator) {
        let most = usize::from(controller.bus.channels).clamp(1, MAX_CHANNELS);
        here.length("axes", controller.axes.len(), 0..=most, "axes");
        if !controller.axes.is_empty() && !matches!(self.source, Source::Motion(_)) {
            let detail = "axes are for a source of kind motion; take them out, or choose that source";
            here.add("axes", ValueError::Conflict { detail });
        }
        if !controller.packets.is_empty() && !matches!(self.source, Source::Packets(_)) {
            let detail = "packets are for a source of kind packets; take them out, or choose that source";
            here.add("packets", ValueError::Conflict { detail });
        }
        let len = usize::from(controller.bus.channels) + usize::from(self.line.protocol == Protocol::Raw);
        here.at("packets", |here| judge_packets(&controller.packets, len, here));
    }

    fn host(&self, validator: &mut Validator) {
        let hears_replies = self.line.protocol == Protocol::Framed && self.source.is_ticks();
        if hears_replies && self.line.receiver_baud.is_some() {
            let host = SerialLine { receiver_baud: None, ..self.line.serial() };
            let mut broken = Config::new(self.clock_hz, &Bus::default(), &host).err().unwrap_or_default();
            broken.retain(|problem| problem.field == Field::Line("baud"));
            tell_once(broken, ToString::to_string, validator);
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
                    let detail = "a send has bytes or a frame, not both; take one out";
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

/// A range that the field's own row has reported is not reported again.
fn tell(broken: Vec<ConfigProblem>, path: impl Fn(&Field) -> String, validator: &mut Validator) {
    for ConfigProblem { field, error } in broken {
        let path = path(&field);
        if !(matches!(error, ConfigError::Range { .. }) && validator.has(&path)) {
            validator.add(&path, error);
        }
    }
}

/// Skips problems that another configuration has, too.
fn tell_once(broken: Vec<ConfigProblem>, path: impl Fn(&Field) -> String, validator: &mut Validator) {
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

fn judge_packets(packets: &[Hex], len: usize, here: &mut Validator) {
    for (index, Hex(bytes)) in packets.iter().enumerate() {
        here.at_entry(index, |here| here.length("", bytes.len(), len..=len, "bytes"));
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
                &["analysis.axis", "analysis.order", "analysis.fft_length", "analysis.sensor_hz"],
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
