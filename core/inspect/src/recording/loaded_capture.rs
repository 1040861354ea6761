//! A capture loaded as a recording: times in cycles, levels, and a report.

mod align;
mod contents;
mod notes;
mod scenario;
#[cfg(test)]
mod tests;

pub use align::Misaligned;

use super::open_options::{DEFAULT_CLOCK_HZ, OpenError, OpenOptions};
use super::report::{ChangedSignals, ChannelReport, Report, steps};
use super::{alignment::ExactTimes, events::Events, overview::Overview, remedy::Note};
use crate::motion::curves::{Actual, Window};
use crate::trace::timing::TimingCheck;
use alloc::string::{String, ToString};
use alloc::{format, vec::Vec};
use serde::Serialize;
use stepscope_capture::channel_map::{PulseSource, channel_text};
use stepscope_capture::{Capture, ChannelMap, RecordedSignals, recorded::Records, timebase::Timebase};
use stepscope_peripheral::signal::{Record, Sink};
use stepscope_peripheral::trace::{self, Step};
use stepscope_scenario::TimingRules;

/// The part of a long recording to load; the report always covers all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    pub max_records: usize,
    pub from_s: Option<f64>,
    pub to_s: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadedPart {
    pub from_s: f64,
    pub to_s: f64,
    pub end_s: f64,
    pub records: usize,
    pub of: usize,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadedCapture {
    pub format: String,
    /// `changes`, `bytes` or `positions`, and their number.
    pub contents: &'static str,
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
    pub part: Option<LoadedPart>,
    pub end_s: f64,
    pub report: Report,
    position_steps: Option<Vec<Step>>,
    /// Per channel, where cycles round the times of its steps.
    exact_steps: Vec<(u8, ExactTimes)>,
    generated_pulses: Vec<(u8, PulseSource)>,
}

/// Whether rounding to cycles has lost no step: figures in ticks then describe the records.
fn have_same_steps(exact: &[ChannelReport], rounded: &[ChannelReport]) -> bool {
    let steps = |channel: &ChannelReport| (channel.channel, channel.figures.steps);
    exact.iter().map(steps).eq(rounded.iter().map(steps))
}

impl LoadedCapture {
    /// Loads a capture and frees its memory.
    pub fn new(capture: Capture, options: &OpenOptions) -> Result<Self, OpenError> {
        let (mut loaded, map, base) = Self::prepare(&capture, options)?;
        let Some(base) = base else { return loaded.back_to_back(&capture, options, &map).map(|()| loaded) };
        let report = loaded.report_without_levels(&capture, base, options, &map)?;
        let (exact, lines) = (loaded.exact_channels(&capture, &map, base, options), options.lines()?);
        let others = others_rounded(&capture, base, loaded.clock_hz);
        loaded.note_exact_steps(&capture, &map, base);
        let recorded =
            RecordedSignals::new(capture, &map, base, loaded.clock_hz).map_err(OpenError::TooLate)?;
        loaded.note_rounding(recorded.rounding, others);
        loaded.records = recorded.records;
        let (clock_hz, channels) = (loaded.clock_hz, loaded.channels);
        let mut report = report.unwrap_or_else(|| {
            let all = loaded.records.iter().copied();
            let changed_mask = ChangedSignals::of(all.clone()).changed_mask;
            Report::from_iterator(all, changed_mask, clock_hz, channels, lines)
        });
        if let Some(exact) = exact.filter(|exact| have_same_steps(exact, &report.channels)) {
            report.channels = exact;
        }
        loaded.set_report(report, &map)?;
        Ok(loaded)
    }

    /// Loads at most `part` of a capture's levels and leaves the capture usable.
    pub fn of_part(capture: &Capture, options: &OpenOptions, part: &Part) -> Result<Self, OpenError> {
        let (mut loaded, map, base) = Self::prepare(capture, options)?;
        let Some(base) = base else { return loaded.back_to_back(capture, options, &map).map(|()| loaded) };
        let clock_hz = loaded.clock_hz;
        let report = loaded.report_without_levels(capture, base, options, &map)?;
        // Without levels there is only the record of reset.
        if capture.changes.is_empty() {
            let none = Capture { end: capture.end, ..Capture::new(capture.format) };
            let recorded = RecordedSignals::new(none, &map, base, clock_hz).map_err(OpenError::TooLate)?;
            loaded.note_rounding(recorded.rounding, others_rounded(capture, base, clock_hz));
            loaded.records = recorded.records;
            loaded.set_report(report.unwrap_or_default(), &map)?;
            return Ok(loaded);
        }
        let all = Records::new(capture, &map, base, clock_hz).map_err(OpenError::TooLate)?;
        let mut passed = all.clone();
        let signals = ChangedSignals::of(passed.by_ref());
        loaded.note_rounding(passed.rounding, 0);
        let mut report =
            Report::from_iterator(all, signals.changed_mask, clock_hz, loaded.channels, options.lines()?);
        if let Some(exact) = loaded.exact_channels(capture, &map, base, options)
            && have_same_steps(&exact, &report.channels)
        {
            report.channels = exact;
        }
        loaded.take_part(capture, &map, base, part, signals.records)?;
        loaded.set_report(report, &map)?;
        Ok(loaded)
    }

    /// Loads another part without computing the report again. Options and alignment stay.
    pub fn with_part(
        mut self,
        capture: &Capture,
        options: &OpenOptions,
        part: &Part,
    ) -> Result<Self, OpenError> {
        let (Self { end_s, .. }, map, base) = Self::prepare(capture, options)?;
        let Some(base) = base.filter(|_| !capture.changes.is_empty()) else { return Ok(self) };
        let count = self.part.take().map_or(self.records.len(), |part| part.of);
        self.end_s = end_s;
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
        if count <= part.max_records && part.from_s.is_none() && part.to_s.is_none() {
            self.records.reserve_exact(count);
            self.records.extend(Records::new(capture, map, base, self.clock_hz).map_err(OpenError::TooLate)?);
            self.note_exact_steps(capture, map, base);
        } else {
            let from_s = part.from_s.unwrap_or(0.0).clamp(0.0, self.end_s);
            let rest =
                Records::starting_at(capture, map, base, self.clock_hz, (from_s / base.seconds()) as u64);
            self.exact_steps.clear();
            self.load_part(rest.map_err(OpenError::TooLate)?, count, from_s, part);
        }
        Ok(())
    }

    /// The timing check in the file's own ticks; `None` where the clock is exact or pulses are generated.
    pub fn timing_in_ticks(
        capture: &Capture,
        options: &OpenOptions,
        rules: &TimingRules,
        max_listed: usize,
    ) -> Result<Option<(TimingCheck, Timebase)>, OpenError> {
        let (loaded, map, base) = Self::prepare(capture, options)?;
        let Some(base) = base.filter(|base| loaded.has_better_ticks(capture, *base)) else { return Ok(None) };
        let mut check = TimingCheck::in_ticks(rules, base.parts(), max_listed);
        loaded.unchecked().for_each(|(channel, rule)| check.exclude(channel, rule));
        Records::in_ticks(capture, &map).for_each(|record| check.record(record));
        Ok(Some((check, base)))
    }

    /// Minimum and maximum of a channel per column; `None` without levels.
    pub fn overview(
        capture: &Capture,
        options: &OpenOptions,
        channel: u8,
        columns: usize,
    ) -> Result<Option<Actual>, OpenError> {
        let (Self { end_s, clock_hz, .. }, map, base) = Self::prepare(capture, options)?;
        let Some(base) = base.filter(|_| !capture.changes.is_empty() && columns > 0) else { return Ok(None) };
        let records = Records::new(capture, &map, base, clock_hz).map_err(OpenError::TooLate)?;
        let window = Window { start_s: 0.0, end_s, columns };
        Ok(Some(Overview::of(steps(records, channel), f64::from(clock_hz), window)))
    }

    fn load_part(&mut self, mut rest: impl Iterator<Item = Record>, of: usize, from_s: f64, part: &Part) {
        let hz = f64::from(self.clock_hz);
        let to_s = part.to_s.unwrap_or(self.end_s).clamp(from_s, self.end_s);
        let to = (to_s * hz) as u64;
        self.records.reserve_exact(part.max_records.min(of));
        let mut next = None;
        for record in rest.by_ref() {
            if record.cycle.0 > to || self.records.len() >= part.max_records.max(1) {
                next = Some(record.cycle.0);
                break;
            }
            self.records.push(record);
        }
        // The part ends before the first record that does not fit.
        let to_s = next.filter(|next| *next <= to).map_or(to_s, |next| next as f64 / hz);
        self.part = Some(LoadedPart { from_s, to_s, end_s: self.end_s, records: self.records.len(), of });
        self.end_s = to_s;
    }

    fn prepare(
        capture: &Capture,
        options: &OpenOptions,
    ) -> Result<(Self, ChannelMap, Option<Timebase>), OpenError> {
        if options.baud == Some(0) {
            return Err(OpenError::Baud);
        }
        options.lines()?;
        let map = match &options.map {
            Some(text) => ChannelMap::parse(text, capture).map_err(OpenError::Map)?,
            None => ChannelMap::proposed(capture),
        };
        let map = if options.both_edges { map.with_both_edges() } else { map };
        let names: Vec<String> = capture.channels.iter().map(|channel| channel.name.clone()).collect();
        if !capture.changes.is_empty() && map.entries().is_empty() {
            return Err(OpenError::NoMap { example: example(capture), names });
        }
        let kind = match () {
            () if !capture.bytes.is_empty() => "bytes",
            () if !capture.positions.is_empty() => "positions",
            () => "changes",
        };
        let mut loaded = Self {
            format: capture.format.to_string(),
            contents: kind,
            count: capture.len(),
            names,
            notes: capture.notes.iter().cloned().map(Note::from).collect(),
            map: map.to_text(capture),
            clock_hz: DEFAULT_CLOCK_HZ,
            channels: map.bus_channels(),
            ..Self::default()
        };
        if !capture.changes.is_empty() {
            loaded.note_edges(capture, &map);
        }
        let requested = options
            .sample_rate_hz
            .map(|rate| Timebase::new(1, rate).ok_or(OpenError::SampleRate))
            .transpose()?;
        // Positions among bytes are no samples.
        let base = capture.timebase.or(requested.filter(|_| !Self::has_untimed_bytes(capture)));
        if let Some(base) = base {
            loaded.clock_hz = options.clock(base, !capture.positions.is_empty(), map.generates_pulses())?;
            let (numerator, denominator) = base.parts();
            loaded.end_s = capture.end as f64 * numerator as f64 / denominator as f64;
        }
        Ok((loaded, map, base))
    }

    pub fn steps_of(&self, channel: u8) -> Vec<Step> {
        match &self.position_steps {
            Some(steps) if channel == 0 => steps.clone(),
            Some(_) => Vec::new(),
            None => trace::steps(&self.records, channel),
        }
    }

    /// The events to compare: steps of a channel or, without any steps, the bytes of RX.
    pub fn events(&self, channel: u8) -> Events {
        match self.report.rx().filter(|_| self.report.channels.is_empty()) {
            Some(line) => Events::of_bytes(&line.decoded, self.clock_hz),
            None => {
                let exact = self.exact_steps.iter().find(|(of, _)| *of == channel);
                Events::of_steps(self.steps_of(channel), self.clock_hz)
                    .with_exact(exact.map(|(_, exact)| exact.clone()))
            }
        }
    }

    /// Whether it has levels; otherwise bytes or positions.
    pub fn has_levels(&self) -> bool {
        self.contents == "changes"
    }
}

fn example(capture: &Capture) -> String {
    let pairs = ["STEP0", "DIR0"].into_iter().zip(0..capture.channels.len());
    let pairs = pairs.map(|(signal, index)| format!("{signal}={}", channel_text(index, &capture.channels)));
    pairs.collect::<Vec<_>>().join(",")
}

fn others_rounded(capture: &Capture, base: Timebase, clock_hz: u32) -> u64 {
    let bytes = capture.bytes.iter().map(|byte| byte.tick);
    let ticks = bytes.chain(capture.positions.iter().map(|row| row.tick));
    ticks.filter(|tick| !base.is_on_cycle(*tick, clock_hz)).count() as u64
}
