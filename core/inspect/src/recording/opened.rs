//! ```
//! use stepscope_capture::read::{Limits, read};
//! use stepscope_inspect::recording::opened::{Ask, Opened};
//!
//! let dump = "$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 1! #12 0! #20 1! #22 0!";
//! let capture = read(std::io::Cursor::new(dump), &Limits::default(), &mut |_| true).capture;
//! let opened = Opened::new(capture, &Ask::default()).expect("a map is proposed");
//! assert_eq!((opened.map.as_str(), opened.clock_hz), ("STEP0=STEP", 1_000_000));
//! assert_eq!(opened.report.channels[0].figures.steps, 2);
//! assert_eq!(opened.report.channels[0].figures.greatest_rate_steps_s, Some(100_000.0));
//! ```

use super::{
    events::{Events, Kind},
    figures::StepFigures,
    overview::Overview,
    remedy::{Note, Remedy},
    report::{ChannelReport, LineReport, Report, Survey, steps},
    scenario::{self, Bytes, Made, Refused, Steps},
    serial::{Heard, HeardByte, LineOptions},
};
use crate::{
    motion::curves::{Actual, Window},
    trace::timing::{Rule, TimingCheck},
};
use alloc::{
    borrow::ToOwned,
    format,
    string::{String, ToString},
    vec::Vec,
};
use core::fmt;
use serde::Serialize;
use stepscope_capture::{
    Capture, ChannelMap, Recorded,
    capture::{Format, TimedByte},
    channel_map::{MapError, PulseSource, written},
    recorded::{Records, Rounding, TooLate},
    timebase::Timebase,
};
use stepscope_peripheral::{
    config::limits::CLOCK_HZ,
    signal::{Levels, Record, Sink},
    trace::{self, Step},
    units::Instant,
    wire::BitTimes,
};
use stepscope_scenario::{Scenario, SegmentLists, Source, TimingRules};

/// Clock for bytes without times and for rows of positions.
const USUAL_CLOCK_HZ: u32 = 16_000_000;
/// Bit rate of bytes with times.
const USUAL_BAUD: u32 = 115_200;
/// Maximum segments of a scenario in a form.
const MAX_SHOWN: usize = 20_000;
/// Maximum steps of position rows; two rows can demand any number.
const MAX_MADE_STEPS: u64 = 10_000_000;
/// Cycles per tick of the file that an edge needs to become a pulse.
const CYCLES_PER_EDGE: u64 = 4;
const MAX_TITLE: usize = 120;

/// How to open a capture. Missing values are proposed, measured or taken from the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ask {
    pub map: Option<String>,
    pub clock_hz: Option<u32>,
    /// Samples per second.
    pub sample_rate_hz: Option<u64>,
    /// Bit rate of RX and TX.
    pub baud: Option<u32>,
    /// Drivers step on both edges: STEP of the map becomes DEDGE.
    pub both_edges: bool,
    /// Data bits, parity and stop bits such as `8E1`; 8N1 by default.
    pub uart: Option<String>,
}

impl Ask {
    fn lines(&self) -> Result<LineOptions, OpenError> {
        let format = self
            .uart
            .as_deref()
            .map(|text| text.trim().parse().map_err(|allowed| OpenError::Uart(text.to_owned(), allowed)));
        Ok(LineOptions { baud: self.baud, format: format.transpose()?.unwrap_or_default() })
    }
}

/// Why a capture cannot be opened.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OpenError {
    Map(MapError),
    /// No map, and none can be proposed.
    NoMap {
        names: Vec<String>,
        example: String,
    },
    Clock(u32),
    SampleRate,
    /// Samples or ticks have no duration.
    NoSampleRate(Format),
    NoBaud,
    Baud,
    Uart(String, &'static str),
    /// No steps, and a line cannot be decoded: the reason and remedies.
    NoRate(String, Vec<Remedy>),
    TooLate(TooLate),
    TooManySteps(u64),
}

impl fmt::Display for OpenError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Map(error) => write!(f, "the channel map: {error}"),
            Self::NoMap { .. } => f.write_str("nothing says which channel is which signal"),
            Self::Clock(given) => {
                write!(f, "the clock: {given} Hz; give {} to {} Hz", CLOCK_HZ.start(), CLOCK_HZ.end())
            }
            Self::SampleRate => f.write_str("the sample rate is 0; give the samples a second, in Hz"),
            Self::NoSampleRate(format) => f.write_str(match format {
                Format::Klipper => {
                    "the log has no CLOCK_FREQ; give the clock of its controller as the sample rate, in Hz, such as 16000000"
                }
                Format::Annotations => {
                    "the annotations count samples and do not say how long one lasts; give the sample rate of the recording, in Hz"
                }
                Format::Vcd | Format::SigrokSession | Format::SigrokCsv => {
                    "the file does not say how long a sample lasts; give the sample rate, in Hz"
                }
                Format::Trace | Format::EdgesCsv => {
                    "the file does not say how long a cycle lasts; give the clock as the sample rate, in Hz"
                }
                _ => {
                    "the file does not say how long a sample, or a cycle, lasts; give the sample rate, in Hz: 1000000 for times in µs, or name their unit in the head of the table (time_us)"
                }
            }),
            Self::NoBaud => f.write_str(
                "the bytes have no times; give the bit rate, and they are taken for sent back to back",
            ),
            Self::Baud => f.write_str("the bit rate is 0; give the bits a second"),
            Self::Uart(given, allowed) => write!(f, "the UART format: \"{given}\" is not one; {allowed}"),
            Self::NoRate(why, _) => f.write_str(why),
            Self::TooLate(error) => error.fmt(f),
            Self::TooManySteps(most) => write!(
                f,
                "the positions stand for more than {most} steps, or lead further than 2^31 away; give a shorter table"
            ),
        }
    }
}

impl core::error::Error for OpenError {}

fn example(capture: &Capture) -> String {
    let pairs = ["STEP0", "DIR0"].into_iter().zip(0..capture.channels.len());
    let pairs = pairs.map(|(signal, index)| format!("{signal}={}", written(index, &capture.channels)));
    pairs.collect::<Vec<_>>().join(",")
}

/// Why a recording cannot be aligned with a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Misaligned {
    /// Only a part is loaded, without the recording's first step.
    Part,
    None {
        kind: Kind,
        aligned: usize,
        count: usize,
    },
    /// The first one would come before the model begins.
    Early {
        kind: Kind,
        aligned: usize,
        first_s: f64,
    },
}

impl fmt::Display for Misaligned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Part => f.write_str(
                "only a part of the recording is shown, and a part is not laid beside an experiment; record a shorter time",
            ),
            Self::None { kind, aligned, count } => write!(
                f,
                "there is no {} {aligned}: {count} {} were recorded, from 0; align by one that both have",
                kind.singular(),
                kind.plural()
            ),
            Self::Early { kind, aligned, first_s } => write!(
                f,
                "aligned by {0} {aligned} the first {0} would come at {first_s:.6} s, before the experiment begins; align by another one",
                kind.singular()
            ),
        }
    }
}

impl core::error::Error for Misaligned {}

/// Which records to load of a long recording; the report always covers all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Maximum records.
    pub most: usize,
    pub from_s: Option<f64>,
    pub to_s: Option<f64>,
}

/// The loaded part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Kept {
    pub from_s: f64,
    pub to_s: f64,
    pub end_s: f64,
    pub records: usize,
    pub of: usize,
}

/// A capture in cycles, with its report.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    pub format: String,
    pub what: &'static str,
    pub count: usize,
    pub names: Vec<String>,
    pub notes: Vec<Note>,
    pub map: String,
    pub clock_hz: u32,
    pub rounding: String,
    pub is_rounded: bool,
    pub channels: u8,
    /// Levels; only the reset for positions and bytes.
    pub records: Vec<Record>,
    /// Which part `records` is; `None` for all.
    pub kept: Option<Kept>,
    pub end_s: f64,
    pub report: Report,
    /// Steps of position rows.
    made_steps: Option<Vec<Step>>,
    /// Motors with generated pulses, and their source.
    made_pulses: Vec<(u8, PulseSource)>,
}

impl Opened {
    /// Loads a capture and frees its memory.
    pub fn new(capture: Capture, ask: &Ask) -> Result<Self, OpenError> {
        let (mut opened, map, base) = Self::before(&capture, ask)?;
        let Some(base) = base else { return opened.back_to_back(&capture, ask, &map).map(|()| opened) };
        let report = opened.without_levels(&capture, base, ask, &map)?;
        let (exact, lines) = (opened.exact_channels(&capture, &map, base, ask), ask.lines()?);
        let others = others_rounded(&capture, base, opened.clock_hz);
        let recorded = Recorded::new(capture, &map, base, opened.clock_hz).map_err(OpenError::TooLate)?;
        opened.rounded(recorded.rounding, others);
        opened.records = recorded.records;
        let (clock_hz, channels) = (opened.clock_hz, opened.channels);
        let mut report = report.unwrap_or_else(|| {
            let all = opened.records.iter().copied();
            let changing = Survey::of(all.clone()).changing;
            Report::of_all(all, changing, clock_hz, channels, lines)
        });
        if let Some(exact) = exact.filter(|_| recorded.rounding.lost == 0) {
            report.channels = exact;
        }
        opened.told(report, &map)?;
        Ok(opened)
    }

    /// Loads at most `part` of a capture's levels and leaves the capture usable.
    pub fn of_part(capture: &Capture, ask: &Ask, part: &Part) -> Result<Self, OpenError> {
        let (mut opened, map, base) = Self::before(capture, ask)?;
        let Some(base) = base else { return opened.back_to_back(capture, ask, &map).map(|()| opened) };
        let clock_hz = opened.clock_hz;
        let report = opened.without_levels(capture, base, ask, &map)?;
        // Without levels there is only the record of reset.
        if capture.changes.is_empty() {
            let none = Capture { end: capture.end, ..Capture::new(capture.format) };
            let recorded = Recorded::new(none, &map, base, clock_hz).map_err(OpenError::TooLate)?;
            opened.rounded(recorded.rounding, others_rounded(capture, base, clock_hz));
            opened.records = recorded.records;
            opened
                .told(report.unwrap_or_else(|| Report { channels: Vec::new(), lines: Vec::new() }), &map)?;
            return Ok(opened);
        }
        let all = Records::of(capture, &map, base, clock_hz).map_err(OpenError::TooLate)?;
        let mut passed = all.clone();
        let survey = Survey::of(passed.by_ref());
        opened.rounded(passed.rounding, 0);
        let mut report = Report::of_all(all, survey.changing, clock_hz, opened.channels, ask.lines()?);
        if let Some(exact) = opened.exact_channels(capture, &map, base, ask)
            && passed.rounding.lost == 0
        {
            report.channels = exact;
        }
        opened.take_part(capture, &map, base, part, survey.count)?;
        opened.told(report, &map)?;
        Ok(opened)
    }

    /// Loads another part without computing the report again. Options and alignment stay.
    pub fn with_part(mut self, capture: &Capture, ask: &Ask, part: &Part) -> Result<Self, OpenError> {
        let (Self { end_s, .. }, map, base) = Self::before(capture, ask)?;
        let Some(base) = base.filter(|_| !capture.changes.is_empty()) else { return Ok(self) };
        let count = self.kept.take().map_or(self.records.len(), |kept| kept.of);
        self.end_s = end_s;
        // Free the memory before the next part is loaded.
        self.records = Vec::new();
        self.take_part(capture, &map, base, part, count)?;
        Ok(self)
    }

    fn take_part(
        &mut self,
        capture: &Capture,
        map: &ChannelMap,
        base: Timebase,
        part: &Part,
        count: usize,
    ) -> Result<(), OpenError> {
        if count <= part.most && part.from_s.is_none() && part.to_s.is_none() {
            self.records.reserve_exact(count);
            self.records.extend(Records::of(capture, map, base, self.clock_hz).map_err(OpenError::TooLate)?);
        } else {
            let from_s = part.from_s.unwrap_or(0.0).clamp(0.0, self.end_s);
            let rest = Records::from(capture, map, base, self.clock_hz, (from_s / base.seconds()) as u64);
            self.keep(rest.map_err(OpenError::TooLate)?, count, from_s, part);
        }
        Ok(())
    }

    /// The timing check in the file's own ticks; `None` where the clock is exact or pulses are generated.
    pub fn timing_in_ticks(
        capture: &Capture,
        ask: &Ask,
        rules: &TimingRules,
        most_kept: usize,
    ) -> Result<Option<(TimingCheck, Timebase)>, OpenError> {
        let (opened, map, base) = Self::before(capture, ask)?;
        let are_made = opened.unchecked().any(|(_, rule)| rule == Rule::StepHigh);
        let is_rounded = |base: &Timebase| !capture.changes.is_empty() && !base.is_exact(opened.clock_hz);
        let Some(base) = base.filter(|base| is_rounded(base) && !are_made) else { return Ok(None) };
        let mut check = TimingCheck::in_ticks(rules, base.parts(), most_kept);
        opened.unchecked().for_each(|(channel, rule)| check.leave_out(channel, rule));
        Records::in_ticks(capture, &map).for_each(|record| check.record(record));
        Ok(Some((check, base)))
    }

    /// Minimum and maximum of a channel per column; `None` without levels.
    pub fn overview(
        capture: &Capture,
        ask: &Ask,
        channel: u8,
        columns: usize,
    ) -> Result<Option<Actual>, OpenError> {
        let (Self { end_s, clock_hz, .. }, map, base) = Self::before(capture, ask)?;
        let Some(base) = base.filter(|_| !capture.changes.is_empty() && columns > 0) else { return Ok(None) };
        let records = Records::of(capture, &map, base, clock_hz).map_err(OpenError::TooLate)?;
        let window = Window { start_s: 0.0, end_s, columns };
        Ok(Some(Overview::of(steps(records, channel), f64::from(clock_hz), window)))
    }

    fn keep(&mut self, mut rest: impl Iterator<Item = Record>, of: usize, from_s: f64, part: &Part) {
        let hz = f64::from(self.clock_hz);
        let to_s = part.to_s.unwrap_or(self.end_s).clamp(from_s, self.end_s);
        let to = (to_s * hz) as u64;
        self.records.reserve_exact(part.most.min(of));
        let mut next = None;
        for record in rest.by_ref() {
            if record.cycle.0 > to || self.records.len() >= part.most.max(1) {
                next = Some(record.cycle.0);
                break;
            }
            self.records.push(record);
        }
        // The part ends before the first record without room.
        let to_s = next.filter(|next| *next <= to).map_or(to_s, |next| next as f64 / hz);
        self.kept = Some(Kept { from_s, to_s, end_s: self.end_s, records: self.records.len(), of });
        self.end_s = to_s;
    }

    fn before(capture: &Capture, ask: &Ask) -> Result<(Self, ChannelMap, Option<Timebase>), OpenError> {
        if ask.baud == Some(0) {
            return Err(OpenError::Baud);
        }
        ask.lines()?;
        let map = match &ask.map {
            Some(text) => ChannelMap::parse(text, capture).map_err(OpenError::Map)?,
            None => ChannelMap::proposed(capture),
        };
        let map = if ask.both_edges { map.with_both_edges() } else { map };
        let names: Vec<String> = capture.channels.iter().map(|channel| channel.name.clone()).collect();
        if !capture.changes.is_empty() && map.entries().is_empty() {
            return Err(OpenError::NoMap { example: example(capture), names });
        }
        let what = match () {
            () if !capture.bytes.is_empty() => "bytes",
            () if !capture.positions.is_empty() => "positions",
            () => "changes",
        };
        let mut opened = Self {
            format: capture.format.to_string(),
            what,
            count: capture.len(),
            names,
            notes: capture.left_out.iter().cloned().map(Note::from).collect(),
            map: map.to_text(capture),
            clock_hz: USUAL_CLOCK_HZ,
            rounding: String::new(),
            is_rounded: false,
            channels: map.bus_channels(),
            records: Vec::new(),
            kept: None,
            end_s: 0.0,
            report: Report { channels: Vec::new(), lines: Vec::new() },
            made_steps: None,
            made_pulses: Vec::new(),
        };
        if !capture.changes.is_empty() {
            opened.hint(capture, &map);
        }
        let told =
            ask.sample_rate_hz.map(|rate| Timebase::new(1, rate).ok_or(OpenError::SampleRate)).transpose()?;
        // Positions among bytes are no samples.
        let base = capture.timebase.or(told.filter(|_| !has_untimed_bytes(capture)));
        if let Some(base) = base {
            opened.clock_hz = clock(ask, base, !capture.positions.is_empty(), map.makes_pulses())?;
            let (numerator, denominator) = base.parts();
            opened.end_s = capture.end as f64 * numerator as f64 / denominator as f64;
        }
        Ok((opened, map, base))
    }

    fn rounded(&mut self, mut rounding: Rounding, others: u64) {
        rounding.rounded += others;
        (self.rounding, self.is_rounded) = (rounding.to_string(), rounding.rounded > 0);
        if rounding.ambiguous > 0 {
            let (s, verb) = if rounding.ambiguous == 1 { ("", "counts") } else { ("s", "count") };
            self.notes.push(Note::from(format!(
                "{} change{s} of an encoder or of CW and CCW {verb} no step, since both lines changed or were high at once: use a higher sample rate, or check the map",
                rounding.ambiguous
            )));
        }
    }

    /// Figures in the file's own ticks where its clock would round: otherwise a constant rate would have an
    /// acceleration.
    fn exact_channels(
        &self,
        capture: &Capture,
        map: &ChannelMap,
        base: Timebase,
        ask: &Ask,
    ) -> Option<Vec<ChannelReport>> {
        // Generated pulses may not fit in ticks.
        let are_made = self.unchecked().any(|(_, rule)| rule == Rule::StepHigh);
        if capture.changes.is_empty() || ask.clock_hz.is_some() || base.is_exact(self.clock_hz) || are_made {
            return None;
        }
        let (numerator, denominator) = base.parts();
        let hz = denominator as f64 / numerator as f64;
        let of = |channel| {
            let steps = steps(Records::in_ticks(capture, map), channel);
            Some(ChannelReport { channel, figures: StepFigures::of_rate(steps, hz)? })
        };
        Some((0..self.channels).filter_map(of).collect())
    }

    fn without_levels(
        &mut self,
        capture: &Capture,
        base: Timebase,
        ask: &Ask,
        map: &ChannelMap,
    ) -> Result<Option<Report>, OpenError> {
        let clock_hz = self.clock_hz;
        let cycle = |tick: u64| base.cycle(tick, clock_hz).unwrap_or(u64::MAX);
        let mut report = None;
        if !capture.bytes.is_empty() {
            let all = heard(capture.bytes.iter(), cycle);
            let baud = ask.baud.unwrap_or_else(|| likely_baud(&all, clock_hz));
            if ask.baud.is_none() {
                self.notes.push(Note::from(format!(
                    "the file does not say the bit rate; by the times of its bytes {baud} baud is taken: give it"
                )));
            }
            let lines = self.lines_of(capture, map).into_iter();
            let lines = lines.map(|(line, bytes)| {
                LineReport::of_heard_on(line, heard(bytes.into_iter(), cycle), clock_hz, baud)
            });
            report = Some(Report { channels: Vec::new(), lines: lines.collect() });
        } else if !capture.positions.is_empty() {
            let steps =
                capture.steps(cycle, MAX_MADE_STEPS).ok_or(OpenError::TooManySteps(MAX_MADE_STEPS))?;
            report = Some(Report::of_steps(&steps, clock_hz));
            self.made_steps = Some(steps);
        }
        Ok(report)
    }

    /// Decoded bytes per line; a single channel is RX.
    fn lines_of<'c>(&mut self, capture: &'c Capture, map: &ChannelMap) -> Vec<(u64, Vec<&'c TimedByte>)> {
        let lines = [Levels::RX, Levels::TX];
        let of = |line: u64| {
            let entry = map.entries().iter().find(|entry| entry.bit == line.trailing_zeros());
            let bytes = entry.map(|entry| {
                capture.bytes.iter().filter(|byte| usize::from(byte.channel) == entry.channel).collect()
            });
            bytes.filter(|bytes: &Vec<&TimedByte>| !bytes.is_empty()).map(|bytes| (line, bytes))
        };
        let found: Vec<_> = lines.into_iter().filter_map(of).collect();
        if capture.channels.len() > 1 && found.is_empty() {
            self.notes.push(Note {
                text: format!("bytes of {} are taken together, as RX", self.names.join(", ")),
                remedy: Some(Remedy::ChooseLine),
            });
        }
        if capture.channels.len() <= 1 || found.is_empty() {
            return Vec::from([(Levels::RX, capture.bytes.iter().collect())]);
        }
        found
    }

    fn hint(&mut self, capture: &Capture, map: &ChannelMap) {
        let sources = (0..self.channels).map(|motor| (motor, map.pulses(motor)));
        self.made_pulses = sources.filter(|(_, source)| *source != PulseSource::Step).collect();
        for (motor, source) in &self.made_pulses {
            let note = match source {
                PulseSource::Step => continue,
                PulseSource::BothEdges => format!(
                    "channel {motor} steps on both edges of its STEP line: the timing check leaves out pulse width and low time"
                ),
                PulseSource::CwCcw => format!(
                    "channel {motor} has CW and CCW pulses: the timing check leaves out DIR set-up and hold time"
                ),
                PulseSource::Quadrature => format!(
                    "channel {motor} counts each edge of an encoder: the timing check leaves out its pulses"
                ),
            };
            self.notes.push(note.into());
        }
        for hint in map.edge_hints(capture) {
            let motor = hint.motor;
            let channel = written(hint.channel, &capture.channels);
            if hint.both_edges {
                let steps = hint.edges.map_or("twice as many".to_owned(), |edges| edges.to_string());
                self.notes.push(Note {
                    text: format!(
                        "both edges of STEP{motor} are evenly spaced: a driver that steps on both edges makes {steps} steps of it"
                    ),
                    remedy: Some(Remedy::BothEdges { motor, channel: channel.clone() }),
                });
            }
            if hint.idles_high {
                let entry = map.entries().iter().find(|entry| entry.bit == u32::from(motor));
                let inverted = !entry.is_some_and(|entry| entry.inverted);
                self.notes.push(Note {
                    text: format!(
                        "STEP{motor} idles high and has low pulses: steps are counted where a pulse ends"
                    ),
                    remedy: Some(Remedy::OtherEdge { motor, channel, inverted }),
                });
            }
        }
    }

    /// Timing rules that do not apply, because the edges were generated.
    pub fn unchecked(&self) -> impl Iterator<Item = (u8, Rule)> {
        self.made_pulses.iter().flat_map(|(channel, source)| {
            let rules: &[Rule] = match source {
                PulseSource::Step => &[],
                PulseSource::BothEdges => &[Rule::StepHigh, Rule::StepLow],
                PulseSource::CwCcw => &[Rule::DirSetup, Rule::DirHold],
                PulseSource::Quadrature => &Rule::ALL,
            };
            rules.iter().map(|rule| (*channel, *rule))
        })
    }

    fn told(&mut self, report: Report, map: &ChannelMap) -> Result<(), OpenError> {
        self.report = report;
        for remedy in self.report.lines.iter_mut().flat_map(|line| &mut line.remedies) {
            if let Remedy::InvertLine { line, inverted } = remedy {
                let bit = if *line == "RX" { Levels::RX } else { Levels::TX }.trailing_zeros();
                *inverted = !map.entries().iter().any(|entry| entry.bit == bit && entry.inverted);
            }
        }
        let is_something =
            !self.report.channels.is_empty() || self.report.lines.iter().any(|line| line.problem.is_none());
        if let Some(line) = self.report.lines.iter().find(|line| line.problem.is_some() && !is_something) {
            return Err(OpenError::NoRate(line.to_text(), line.remedies.clone()));
        }
        for channel in &self.report.channels {
            if self.has_levels() && !map.has_direction(channel.channel) {
                let number = channel.channel;
                self.notes.push(Note::from(format!(
                    "no channel is DIR{number}: all steps of channel {number} count to the right"
                )));
            }
        }
        Ok(())
    }

    /// Bytes without times count as sent back to back on each line.
    fn back_to_back(&mut self, capture: &Capture, ask: &Ask, map: &ChannelMap) -> Result<(), OpenError> {
        if !has_untimed_bytes(capture) {
            return Err(OpenError::NoSampleRate(capture.format));
        }
        let baud = ask.baud.ok_or(OpenError::NoBaud)?;
        self.clock_hz = judged(ask.clock_hz.unwrap_or(USUAL_CLOCK_HZ))?;
        let times = BitTimes::new(self.clock_hz, baud);
        let mut last = 0;
        for (line, bytes) in self.lines_of(capture, map) {
            let bytes = (0..).zip(bytes);
            let bytes = bytes.map(|(index, timed)| HeardByte {
                start: Instant(1 + times.byte(index).0),
                byte: timed.byte,
            });
            let heard = Heard { bytes: bytes.collect(), ..Heard::default() };
            last = last.max(heard.bytes.len() as u64);
            self.report.lines.push(LineReport::of_heard_on(line, heard, self.clock_hz, baud));
        }
        self.end_s = times.byte(last).0 as f64 / f64::from(self.clock_hz);
        self.rounding = "the bytes have no times: taken for sent back to back".to_owned();
        Ok(())
    }

    /// Shifts the recording so that step (or byte) `aligned` of a channel comes at `at_s`. Without steps and bytes
    /// nothing moves. Fails with [`Misaligned`] if the first would come before cycle 0.
    pub fn align(&mut self, channel: u8, aligned: usize, at_s: f64) -> Result<(), Misaligned> {
        if self.kept.is_some() {
            return Err(Misaligned::Part);
        }
        let hz = f64::from(self.clock_hz);
        let events = self.events(channel);
        let Some(first_s) = events.at_s(0) else { return Ok(()) };
        let (kind, count) = (events.kind, events.len());
        let now_s = events.at_s(aligned).ok_or(Misaligned::None { kind, aligned, count })?;
        let first_s = first_s + (at_s - now_s);
        // A rise in cycle 0 is no step.
        if libm::round(first_s * hz) < 1.0 {
            return Err(Misaligned::Early { kind, aligned, first_s });
        }
        let by = libm::round((at_s - now_s) * hz) as i64;
        let moved = |cycle: u64| cycle.saturating_add_signed(by);
        for record in &mut self.records {
            record.cycle = Instant(moved(record.cycle.0));
        }
        // Of records at cycle 0 only the last counts.
        let before = self.records.partition_point(|record| record.cycle.0 == 0).saturating_sub(1);
        self.records.drain(..before);
        if let Some(record) = self.records.first_mut() {
            record.cycle = Instant(0);
        }
        for step in self.made_steps.iter_mut().flatten() {
            step.cycle = moved(step.cycle);
        }
        for line in &mut self.report.lines {
            line.heard.bytes.iter_mut().for_each(|byte| byte.start = Instant(moved(byte.start.0)));
        }
        self.end_s += by as f64 / hz;
        let channels = self.report.channels.iter().map(|channel| channel.channel);
        let figures = |channel| {
            let figures = StepFigures::of(self.steps_of(channel), self.clock_hz)?;
            Some(ChannelReport { channel, figures })
        };
        self.report.channels = channels.filter_map(figures).collect();
        Ok(())
    }

    /// The scenario to show: [`Self::scenario`], or an idle one with its clock, channels and duration.
    #[must_use]
    pub fn shown_scenario(&self, file: &str, steps: bool) -> Scenario {
        let made = if self.kept.is_none() { self.scenario(file, steps, 0.0, None).ok() } else { None };
        let made = made.filter(|made| made.clock_hz == self.clock_hz && entries(made) <= MAX_SHOWN);
        let mut scenario = made.unwrap_or_else(|| {
            let mut scenario = Scenario { clock_hz: self.clock_hz, ..Scenario::default() };
            scenario.bus.channels = self.channels;
            scenario.source = Source::Segments(SegmentLists::default());
            scenario.title = title(file);
            scenario.note = format!(
                "Recorded in {file}. No scenario that could be edited here gives it again: it is too long, too fast for the bus, or of another clock. The command says which, and makes a long one (stepscope capture --scenario)."
            );
            scenario
        });
        let last = self.records.last().map_or(0, |record| record.cycle.0);
        let end = libm::ceil(self.end_s * f64::from(self.clock_hz)) as u64;
        // The last byte ends after the last edge.
        let heard = self.report.rx().filter(|line| self.kept.is_none() && line.baud > 0).and_then(|line| {
            let bit_cycles = BitTimes::new(self.clock_hz, line.baud).bit(1).0;
            Some(scenario::end_of(&line.heard, bit_cycles)?.0 + bit_cycles)
        });
        scenario.run_cycles = Some(end.max(last).max(heard.unwrap_or(0)) + 1);
        scenario
    }

    #[must_use]
    pub fn steps_of(&self, channel: u8) -> Vec<Step> {
        match &self.made_steps {
            Some(steps) if channel == 0 => steps.clone(),
            Some(_) => Vec::new(),
            None => trace::steps(&self.records, channel),
        }
    }

    /// The steps of a channel or, if none steps, the bytes of RX.
    #[must_use]
    pub fn events(&self, channel: u8) -> Events {
        match self.report.rx().filter(|_| self.report.channels.is_empty()) {
            Some(line) => Events::of_bytes(&line.heard, self.clock_hz),
            None => Events::of_steps(self.steps_of(channel), self.clock_hz),
        }
    }

    /// Without levels there are only steps or bytes.
    #[must_use]
    pub fn has_levels(&self) -> bool {
        self.what == "changes"
    }

    /// The scenario that reproduces it: its bytes, unless `steps` is set, otherwise its steps within `error_us`.
    /// Bytes go to the controllers of `base`.
    pub fn scenario(
        &self,
        file: &str,
        steps: bool,
        error_us: f64,
        base: Option<&Scenario>,
    ) -> Result<Scenario, Refused> {
        let (clock_hz, channels) = (self.clock_hz, self.channels);
        let within_cycles = (error_us * 1e-6 * f64::from(clock_hz)) as u64;
        let asked = Steps { clock_hz, channels, within_cycles };
        let rx = self.report.rx().filter(|line| !line.heard.bytes.is_empty() && !steps);
        let made: Made = match (rx, &self.made_steps) {
            (Some(line), _) => {
                let asked = Bytes { clock_hz, baud: line.baud, guess: line.guess, channels };
                scenario::of_bytes(&line.heard, &asked, base)
            }
            (None, Some(steps)) => scenario::of_step_times(core::slice::from_ref(steps), &asked),
            // Generated pulses have no width of their own.
            (None, None) if self.unchecked().any(|(_, rule)| rule == Rule::StepHigh) => {
                let all: Vec<Vec<Step>> = (0..channels).map(|channel| self.steps_of(channel)).collect();
                scenario::of_step_times(&all, &asked)
            }
            (None, None) => scenario::of_steps(&self.records, &asked),
        }?;
        let mut scenario = Scenario { note: scenario::note(file, &made), ..made.scenario };
        scenario.title = title(file);
        Ok(scenario)
    }
}

/// Bytes without times have their index as tick.
fn has_untimed_bytes(capture: &Capture) -> bool {
    let untimed = || (0..).zip(&capture.bytes).all(|(place, byte)| byte.tick == place);
    capture.timebase.is_none() && !capture.bytes.is_empty() && untimed()
}

fn entries(scenario: &Scenario) -> usize {
    match &scenario.source {
        Source::Segments(lists) => lists.channels.iter().map(|list| list.segments.len()).sum(),
        // A form has several fields per send.
        Source::Line(script) => script.sends.len() * 8,
        _ => 0,
    }
}

fn title(file: &str) -> String {
    format!("recorded: {file}").chars().take(MAX_TITLE).collect()
}

/// The requested clock, or the slowest in which each tick of the file is a whole number of cycles. Position rows and
/// single edges need a finer one.
fn clock(ask: &Ask, base: Timebase, positions: bool, makes_pulses: bool) -> Result<u32, OpenError> {
    let (least, most) = (*CLOCK_HZ.start(), *CLOCK_HZ.end());
    let own = || {
        if positions && base.is_exact(USUAL_CLOCK_HZ) {
            return USUAL_CLOCK_HZ;
        }
        let (_, denominator) = base.parts();
        let least = if makes_pulses { least.max(denominator.saturating_mul(CYCLES_PER_EDGE)) } else { least };
        let whole = least.div_ceil(denominator).checked_mul(denominator);
        whole.map_or(most, |hz| hz.min(most)) as u32
    };
    judged(ask.clock_hz.unwrap_or_else(own))
}

fn others_rounded(capture: &Capture, base: Timebase, clock_hz: u32) -> u64 {
    let bytes = capture.bytes.iter().map(|byte| byte.tick);
    let ticks = bytes.chain(capture.positions.iter().map(|row| row.tick));
    ticks.filter(|tick| !base.is_whole(*tick, clock_hz)).count() as u64
}

fn judged(clock_hz: u32) -> Result<u32, OpenError> {
    if CLOCK_HZ.contains(&clock_hz.into()) { Ok(clock_hz) } else { Err(OpenError::Clock(clock_hz)) }
}

fn heard<'c>(bytes: impl Iterator<Item = &'c TimedByte>, cycle: impl Fn(u64) -> u64) -> Heard {
    let mut heard = Heard::default();
    for byte in bytes {
        let start = Instant(cycle(byte.tick));
        if byte.framing_error {
            heard.framing_errors.push(start);
        } else {
            heard.bytes.push(HeardByte { start, byte: byte.byte });
        }
    }
    heard
}

/// The closest two bytes are back to back. Bytes of one line of text share a time; then the usual rate or more.
fn likely_baud(heard: &Heard, clock_hz: u32) -> u32 {
    let (mut needed, mut shared, mut count) = (0.0_f64, false, 1_u32);
    for (before, byte) in heard.bytes.iter().zip(heard.bytes.iter().skip(1)) {
        match byte.start.0.saturating_sub(before.start.0) {
            0 => (count, shared) = (count.saturating_add(1), true),
            cycles => {
                let bits = 10.0 * f64::from(count);
                needed = libm::fmax(needed, bits * f64::from(clock_hz) / cycles as f64);
                count = 1;
            }
        }
    }
    let needed = libm::round(needed) as u32;
    if shared || needed == 0 { needed.max(USUAL_BAUD) } else { needed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_capture::read::{Limits, read};

    fn capture() -> Capture {
        let text = "Time [s],STEP,DIR\n0.0,0,1\n0.001,1,1\n0.0011,0,1\n0.002,1,1\n0.0021,0,1\n0.003,1,1\n0.0031,0,1\n0.005,1,1\n0.0051,0,1\n";
        read(std::io::Cursor::new(text), &Limits::default(), &mut |_| true).capture
    }

    /// Steps at 1, 2, 3 and 5 ms, as Saleae Logic saves them.
    fn opened() -> Opened {
        Opened::new(capture(), &asked()).expect("it opens")
    }

    fn asked() -> Ask {
        Ask { clock_hz: Some(1_000_000), ..Ask::default() }
    }

    #[test]
    fn bytes_of_two_directions_are_two_lines_and_the_map_names_them() {
        let read = |text: &str| {
            read(std::io::Cursor::new(text.to_owned()), &Limits::default(), &mut |_| true).capture
        };
        let log = "12:00:00.5 TX 55 AA\n12:00:00.6 RX 01\n";
        let lines = |map: Option<&str>| {
            let ask = Ask { map: map.map(Into::into), baud: Some(9600), ..Ask::default() };
            let opened = Opened::new(read(log), &ask).expect("it opens");
            let bytes =
                |line: &LineReport| line.heard.bytes.iter().map(|heard| heard.byte).collect::<Vec<_>>();
            opened.report.lines.iter().map(|line| (line.name, bytes(line))).collect::<Vec<_>>()
        };
        assert_eq!(lines(None), [("RX", vec![1]), ("TX", vec![0x55, 0xaa])]);
        assert_eq!(lines(Some("RX=TX,TX=RX")), [("RX", vec![0x55, 0xaa]), ("TX", vec![1])]);
        // Without times each direction is back to back by itself.
        let annotations = "uart-1: rx-data: 41\nuart-1: tx-data: 42\nuart-1: tx-data: AA\n";
        let ask = Ask { baud: Some(9600), ..Ask::default() };
        let opened = Opened::new(read(annotations), &ask).expect("it opens");
        let found: Vec<_> =
            opened.report.lines.iter().map(|line| (line.name, line.heard.bytes.len())).collect();
        assert_eq!(found, [("RX", 1), ("TX", 2)]);
        assert_eq!(opened.report.lines[1].heard.bytes[0].start, opened.report.lines[0].heard.bytes[0].start);
        // Times without a unit are no places: their length is asked for.
        let table = "0,55\n1041,AA\n2083,01\n";
        let asked = |sample_rate_hz| Ask { sample_rate_hz, baud: Some(9600), ..Ask::default() };
        assert_eq!(
            Opened::new(read(table), &asked(None)).err(),
            Some(OpenError::NoSampleRate(Format::HexBytes))
        );
        let opened = Opened::new(read(table), &asked(Some(1_000_000))).expect("it opens");
        let starts = opened.report.lines[0].heard.bytes.iter().map(|heard| heard.start.0).collect::<Vec<_>>();
        assert_eq!(starts, [0, 1041, 2083]);
    }

    #[test]
    fn of_a_part_the_records_are_kept_and_the_figures_are_of_all() {
        let whole = opened();
        let part = |most, from_s, to_s| {
            Opened::of_part(&capture(), &asked(), &Part { most, from_s, to_s }).expect("it opens")
        };
        assert_eq!(part(9, None, None), whole);
        // From one part to another it is as if it were opened with that at once.
        let parts = [
            (4, None, None),
            (9, None, None),
            (9, Some(0.0015), Some(0.0025)),
            (1, None, None),
            (9, Some(9.0), None),
        ];
        for (most, from_s, to_s) in parts {
            for (after, from, to) in parts {
                let again = part(most, from_s, to_s).with_part(
                    &capture(),
                    &asked(),
                    &Part { most: after, from_s: from, to_s: to },
                );
                assert_eq!(
                    again,
                    Ok(part(after, from, to)),
                    "{most} {from_s:?} {to_s:?}, then {after} {from:?} {to:?}"
                );
            }
        }
        let records = |of: &Opened| -> Vec<(u64, u64)> {
            of.records.iter().map(|record| (record.cycle.0, record.levels.0 & 1)).collect()
        };
        for (most, from_s, to_s, expected, span) in [
            // Up to the one that has no room.
            (4, None, None, &[(0, 0), (1000, 1), (1100, 0), (2000, 1)][..], (0.0, 0.0021)),
            // What stands when it begins is at cycle 0.
            (
                9,
                Some(0.002_05),
                None,
                &[(0, 1), (2100, 0), (3000, 1), (3100, 0), (5000, 1), (5100, 0)],
                (0.002_05, 0.0051),
            ),
            (9, Some(0.0015), Some(0.003), &[(0, 0), (2000, 1), (2100, 0), (3000, 1)], (0.0015, 0.003)),
            (2, Some(0.0015), Some(0.003), &[(0, 0), (2000, 1)], (0.0015, 0.0021)),
            (9, Some(7.0), Some(1.0), &[(0, 0)], (0.0051, 0.0051)),
            (0, None, Some(0.5), &[(0, 0)], (0.0, 0.001)),
        ] {
            let found = part(most, from_s, to_s);
            assert_eq!(records(&found), expected, "{most} {from_s:?} {to_s:?}");
            let kept = found.kept.expect("a part");
            assert_eq!((kept.from_s, kept.to_s, kept.records, kept.of), (span.0, span.1, expected.len(), 9));
            assert_eq!((kept.end_s, found.end_s), (whole.end_s, kept.to_s));
            assert_eq!((&found.report, found.rounding.as_str()), (&whole.report, whole.rounding.as_str()));
            assert_eq!(found.clone().align(0, 0, 0.01), Err(Misaligned::Part));
            let run = found.shown_scenario("own.csv", true).run_cycles.expect("it ends");
            assert!(run > records(&found).last().expect("one").0 && run <= 5101, "{run}");
        }
    }

    #[test]
    fn the_overview_is_of_all_and_there_is_one_of_levels_alone() {
        let found = Opened::overview(&capture(), &asked(), 0, 5).expect("it opens").expect("levels");
        // 5.1 ms in five columns, a step in each of the first three and in the last.
        assert_eq!(found.position.max, [1.0, 2.0, 3.0, 3.0, 4.0]);
        assert_eq!((found.speed.max[1].round(), found.speed.max[4].round()), (1000.0, 500.0));
        let still = Opened::overview(&capture(), &asked(), 1, 2).expect("it opens").expect("levels");
        assert_eq!(still.position.max, [0.0, 0.0]);
        assert_eq!(Opened::overview(&capture(), &asked(), 0, 0), Ok(None));
        let bytes = "0.1: 55\n0.2: AA\n";
        let bytes = read(std::io::Cursor::new(bytes), &Limits::default(), &mut |_| true).capture;
        assert_eq!(Opened::overview(&bytes, &Ask::default(), 0, 5), Ok(None));
    }

    #[test]
    fn any_step_can_be_put_to_a_time_as_long_as_none_comes_before_cycle_0() {
        for (aligned, at_s, expected) in [
            (0, 0.01, Ok([10_000, 11_000, 12_000, 14_000])),
            (3, 0.01, Ok([6000, 7000, 8000, 10_000])),
            (2, 0.002_001, Ok([1, 1001, 2001, 4001])),
            (
                2,
                0.001,
                Err(
                    "aligned by step 2 the first step would come at -0.001000 s, before the experiment begins; align by another one",
                ),
            ),
            (4, 0.01, Err("there is no step 4: 4 steps were recorded, from 0; align by one that both have")),
        ] {
            let mut found = opened();
            let before = found.clone();
            let aligned = found.align(0, aligned, at_s);
            match expected {
                Ok(expected) => {
                    aligned.expect("it can be");
                    let cycles: Vec<u64> = found.steps_of(0).iter().map(|step| step.cycle).collect();
                    assert_eq!(cycles, expected);
                }
                Err(expected) => {
                    assert_eq!(aligned.expect_err("it cannot be").to_string(), expected);
                    assert_eq!(found, before);
                }
            }
        }
        // A channel on which nothing comes moves nothing.
        let mut found = opened();
        assert_eq!((found.align(1, 7, 0.01), &found), (Ok(()), &opened()));
    }
}
