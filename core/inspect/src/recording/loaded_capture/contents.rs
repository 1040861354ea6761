//! The contents of a loaded capture: steps and bytes, with or without times, and their report.

use super::LoadedCapture;
use crate::recording::open_options::{DEFAULT_CLOCK_HZ, OpenError, OpenOptions, valid_clock};
use crate::recording::remedy::{Note, Remedy};
use crate::recording::report::{ChannelReport, LineReport, Report, steps};
use crate::recording::serial::{DecodedByte, DecodedLine};
use crate::recording::{alignment::ExactTimes, figures::StepFigures};
use crate::trace::timing::Rule;
use alloc::{borrow::ToOwned, format, vec::Vec};
use stepscope_capture::capture::{Format, TimedByte};
use stepscope_capture::{Capture, ChannelMap, recorded::Records, timebase::Timebase};
use stepscope_peripheral::{signal::Levels, units::Instant, wire::BitTimes};

const DEFAULT_BAUD: u32 = 115_200;
/// Maximum steps of position rows, because two rows can request any number.
const MAX_STEPS: u64 = 10_000_000;

impl LoadedCapture {
    /// Figures in ticks of the file if cycles would round them: otherwise a constant rate would have an acceleration.
    pub(super) fn exact_channels(
        &self,
        capture: &Capture,
        map: &ChannelMap,
        base: Timebase,
        options: &OpenOptions,
    ) -> Option<Vec<ChannelReport>> {
        if options.clock_hz.is_some() || !self.is_rounded(capture, base) {
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

    /// Whether cycles round the file's ticks. Generated pulses may not fit in ticks.
    fn is_rounded(&self, capture: &Capture, base: Timebase) -> bool {
        let are_generated = self.unchecked().any(|(_, rule)| rule == Rule::StepHigh);
        !capture.changes.is_empty() && !base.is_exact(self.clock_hz) && !are_generated
    }

    /// Whether ticks are more exact than cycles. Decimal times below 1 ps have rounding noise of a float.
    pub(super) fn has_better_ticks(&self, capture: &Capture, base: Timebase) -> bool {
        let is_noisy = capture.format != Format::Vcd && base.seconds() < 1e-12;
        self.is_rounded(capture, base) && !is_noisy
    }

    /// Stores the ticks of files finer than every clock, whose cycles would round by up to 0.5 ns.
    pub(super) fn note_exact_steps(&mut self, capture: &Capture, map: &ChannelMap, base: Timebase) {
        if base.seconds() >= 1e-9 || !self.has_better_ticks(capture, base) {
            return;
        }
        let ticks = |channel| steps(Records::in_ticks(capture, map), channel).map(|step| step.cycle);
        let of = |channel| (channel, ExactTimes { ticks: ticks(channel).collect(), base });
        self.exact_steps = (0..self.channels).map(of).collect();
    }

    /// The report of bytes or positions; `None` for levels.
    pub(super) fn report_without_levels(
        &mut self,
        capture: &Capture,
        base: Timebase,
        options: &OpenOptions,
        map: &ChannelMap,
    ) -> Result<Option<Report>, OpenError> {
        let clock_hz = self.clock_hz;
        let cycle = |tick: u64| base.cycle(tick, clock_hz).unwrap_or(u64::MAX);
        let mut report = None;
        if !capture.bytes.is_empty() {
            let all = decode(capture.bytes.iter(), cycle);
            let baud = options.baud.unwrap_or_else(|| estimated_baud(&all, clock_hz));
            if options.baud.is_none() {
                self.notes.push(Note::from(format!(
                    "the file has no bit rate; {baud} baud is estimated from the times of its bytes; set the actual rate"
                )));
            }
            let lines = self.lines_of(capture, map).into_iter();
            let lines = lines.map(|(line, bytes)| {
                LineReport::of_decoded(line, decode(bytes.into_iter(), cycle), clock_hz, baud)
            });
            report = Some(Report { channels: Vec::new(), lines: lines.collect() });
        } else if !capture.positions.is_empty() {
            let steps = capture.steps(cycle, MAX_STEPS).ok_or(OpenError::TooManySteps(MAX_STEPS))?;
            report = Some(Report::of_steps(&steps, clock_hz));
            self.position_steps = Some(steps);
        }
        Ok(report)
    }

    pub(super) fn lines_of<'c>(
        &mut self,
        capture: &'c Capture,
        map: &ChannelMap,
    ) -> Vec<(u64, Vec<&'c TimedByte>)> {
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
                text: format!("bytes of {} are combined as RX", self.names.join(", ")),
                remedy: Some(Remedy::ChooseLine),
            });
        }
        if capture.channels.len() <= 1 || found.is_empty() {
            return Vec::from([(Levels::RX, capture.bytes.iter().collect())]);
        }
        found
    }

    /// Stores the report; fails if it has neither steps nor a decoded line.
    pub(super) fn set_report(&mut self, report: Report, map: &ChannelMap) -> Result<(), OpenError> {
        self.report = report;
        for remedy in self.report.lines.iter_mut().flat_map(|line| &mut line.remedies) {
            if let Remedy::InvertLine { line, inverted } = remedy {
                let bit = if *line == "RX" { Levels::RX } else { Levels::TX }.trailing_zeros();
                *inverted = !map.entries().iter().any(|entry| entry.bit == bit && entry.inverted);
            }
        }
        let is_decoded =
            !self.report.channels.is_empty() || self.report.lines.iter().any(|line| line.problem.is_none());
        if let Some(line) = self.report.lines.iter().find(|line| line.problem.is_some() && !is_decoded) {
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
    pub(super) fn back_to_back(
        &mut self,
        capture: &Capture,
        options: &OpenOptions,
        map: &ChannelMap,
    ) -> Result<(), OpenError> {
        if !Self::has_untimed_bytes(capture) {
            return Err(OpenError::NoSampleRate(capture.format));
        }
        let baud = options.baud.ok_or(OpenError::NoBaud)?;
        self.clock_hz = valid_clock(options.clock_hz.unwrap_or(DEFAULT_CLOCK_HZ))?;
        let times = BitTimes::new(self.clock_hz, baud);
        let mut last = 0;
        for (line, bytes) in self.lines_of(capture, map) {
            let bytes = (0..).zip(bytes);
            let bytes = bytes.map(|(index, timed)| DecodedByte {
                start: Instant(1 + times.byte(index).0),
                byte: timed.byte,
            });
            let decoded = DecodedLine { bytes: bytes.collect(), ..DecodedLine::default() };
            last = last.max(decoded.bytes.len() as u64);
            self.report.lines.push(LineReport::of_decoded(line, decoded, self.clock_hz, baud));
        }
        self.end_s = times.byte(last).0 as f64 / f64::from(self.clock_hz);
        self.rounding = "the bytes have no times; they count as sent back to back".to_owned();
        Ok(())
    }

    /// Bytes without times have their index as tick.
    pub(super) fn has_untimed_bytes(capture: &Capture) -> bool {
        let untimed = || (0..).zip(&capture.bytes).all(|(index, byte)| byte.tick == index);
        capture.timebase.is_none() && !capture.bytes.is_empty() && untimed()
    }
}

fn decode<'c>(bytes: impl Iterator<Item = &'c TimedByte>, cycle: impl Fn(u64) -> u64) -> DecodedLine {
    let mut decoded = DecodedLine::default();
    for byte in bytes {
        let start = Instant(cycle(byte.tick));
        if byte.framing_error {
            decoded.framing_errors.push(start);
        } else {
            decoded.bytes.push(DecodedByte { start, byte: byte.byte });
        }
    }
    decoded
}

/// Assumes that the two closest bytes are back to back. If bytes of a text share a time, at least the usual rate.
fn estimated_baud(decoded: &DecodedLine, clock_hz: u32) -> u32 {
    let (mut needed, mut shared, mut count) = (0.0_f64, false, 1_u32);
    for (before, byte) in decoded.bytes.iter().zip(decoded.bytes.iter().skip(1)) {
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
    if shared || needed == 0 { needed.max(DEFAULT_BAUD) } else { needed }
}
