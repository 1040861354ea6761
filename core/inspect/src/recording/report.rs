//! The report of a recording: figures of each channel, and its lines.

use super::serial::{
    DecodedByte, LineOptions, MEASURED_EDGES, decode_records, edges, looks_like_seven_bit_text,
    seven_bit_parity,
};
use super::serial::{DecodedLine, Guess, Measured, guess, line_name};
use super::{figures::StepFigures, remedy::Remedy};
use alloc::{format, string::String, string::ToString, vec::Vec};
use serde::Serialize;
use stepscope_capture::uart::{Edge, Estimate, Format, NoRate, estimate};
use stepscope_peripheral::signal::{Levels, Record};
use stepscope_peripheral::trace::Step;

/// Figures of the channels and lines of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    pub channels: Vec<ChannelReport>,
    pub lines: Vec<LineReport>,
}

/// Figures of a channel with steps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelReport {
    pub channel: u8,
    pub figures: StepFigures,
}

/// Rate, format and bytes of a serial line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineReport {
    pub name: &'static str,
    pub measured: Option<Measured>,
    pub baud: u32,
    pub format: String,
    pub problem: Option<String>,
    /// Why the result may be wrong.
    pub hint: Option<String>,
    pub remedies: Vec<Remedy>,
    pub decoded: DecodedLine,
    pub guess: Guess,
}

/// The signals that change in some records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ChangedSignals {
    pub records: usize,
    /// A bit for each signal that differs from the first record.
    pub changed_mask: u64,
}

impl ChangedSignals {
    /// Compares all records with the first one.
    pub fn of(records: impl IntoIterator<Item = Record>) -> Self {
        let mut records = records.into_iter();
        let Some(first) = records.next() else { return Self::default() };
        let found = Self { records: 1, changed_mask: 0 };
        records.fold(found, |found, record| Self {
            records: found.records + 1,
            changed_mask: found.changed_mask | (record.levels.0 ^ first.levels.0),
        })
    }
}

impl Report {
    /// Reports channels, and decodes lines as 8N1 at `baud`, or at the measured rate.
    pub fn from_records(records: &[Record], clock_hz: u32, channels: u8, baud: Option<u32>) -> Self {
        let all = records.iter().copied();
        let options = LineOptions { baud, ..LineOptions::default() };
        let changed_mask = ChangedSignals::of(all.clone()).changed_mask;
        Self::from_iterator(all, changed_mask, clock_hz, channels, options)
    }

    /// Does not store the records, but iterates over them once per signal of `changed_mask` ([`ChangedSignals`]).
    pub fn from_iterator(
        records: impl Iterator<Item = Record> + Clone,
        changed_mask: u64,
        clock_hz: u32,
        channels: u8,
        options: LineOptions,
    ) -> Self {
        let channel_report = |channel| {
            let figures = StepFigures::of(steps(records.clone(), channel), clock_hz)?;
            Some(ChannelReport { channel, figures })
        };
        let line = |mask| LineReport::of(records.clone(), mask, clock_hz, options);
        let lines = [Levels::RX, Levels::TX].into_iter().filter(|mask| changed_mask & mask != 0);
        let channels = (0..channels).filter(|channel| (changed_mask >> channel) & 1 != 0);
        Self {
            channels: channels.filter_map(channel_report).collect(),
            lines: lines.filter_map(line).collect(),
        }
    }

    /// The report of channel 0 with these steps, and no lines.
    pub fn of_steps(steps: &[Step], clock_hz: u32) -> Self {
        let figures = StepFigures::of(steps.iter().copied(), clock_hz);
        Self {
            channels: figures.map(|figures| ChannelReport { channel: 0, figures }).into_iter().collect(),
            lines: Vec::new(),
        }
    }

    pub fn rx(&self) -> Option<&LineReport> {
        self.lines.iter().find(|line| line.name == line_name(Levels::RX))
    }
}

/// Like [`stepscope_peripheral::trace::steps_in`], but streams the records.
pub(super) fn steps(records: impl Iterator<Item = Record>, channel: u8) -> impl Iterator<Item = Step> {
    let mask = 1_u16 << (channel & 15);
    // A level that is high from the first record on has not risen.
    let (mut before, mut position) = (u16::MAX, 0_i32);
    records.filter_map(move |record| {
        let rises = record.levels.step() & !before & mask != 0;
        before = record.levels.step();
        if !rises {
            return None;
        }
        position = position.wrapping_add(if record.levels.dir() & mask != 0 { 1 } else { -1 });
        Some(Step { cycle: record.cycle.0, position })
    })
}

const EIGHT_N_ONE: &str = "8N1";

/// Why no rate was found, and what helps.
fn no_rate(why: &NoRate, line: &'static str) -> (String, Vec<Remedy>) {
    if let NoRate::Ambiguous(rates) = why {
        let rates: Vec<String> = rates.iter().map(ToString::to_string).collect();
        return (format!("its pulses fit several bit rates ({})", rates.join(", ")), [Remedy::Baud].into());
    }
    if *why == NoRate::TooCoarse {
        let text = "its bits last fewer than 3 cycles of the recording, so its bit rate cannot be measured; use at least 4 \
                    samples per bit (3 is the minimum), or export times with more decimal places";
        return (text.into(), [Remedy::Baud].into());
    }
    let reason = likely_reason(why, line);
    let found = reason.as_ref().map_or_else(String::new, |(text, _)| format!(": {text}"));
    let remedies = reason.into_iter().map(|(_, remedy)| remedy).chain([Remedy::BaudOrFormat]);
    (format!("no bit rate fits its pulses{found}"), remedies.collect())
}

/// A likely reason for `why`, and its remedy.
fn likely_reason(why: &NoRate, line: &'static str) -> Option<(String, Remedy)> {
    match why {
        NoRate::Format(format) => {
            let text = format.to_string();
            let what = match text.get(1..2) {
                Some("E") => "the errors look like even parity",
                Some("O") => "the errors look like odd parity",
                _ => "the words have another format",
            };
            Some((what.into(), Remedy::Format(text)))
        }
        NoRate::Inverted => {
            Some(("the line looks inverted".into(), Remedy::InvertLine { line, inverted: true }))
        }
        _ => None,
    }
}

/// Detects 7-bit bytes that were decoded with eight.
fn seven_bit_hint(bytes: &[DecodedByte]) -> Option<(String, Option<Remedy>)> {
    if looks_like_seven_bit_text(bytes) {
        let text =
            "all bytes look like 7-bit text with 2 stop bits, or with 1 stop bit and a pause after each byte";
        return Some((text.into(), Some(Remedy::Format("7N2".into()))));
    }
    seven_bit_parity(bytes).map(|parity| {
        let name = if parity == 'E' { "even" } else { "odd" };
        let text = format!("all bytes look like 7 data bits with {name} parity");
        (text, Some(Remedy::Format(format!("7{parity}1"))))
    })
}

impl LineReport {
    fn of(
        records: impl Iterator<Item = Record> + Clone,
        mask: u64,
        clock_hz: u32,
        options: LineOptions,
    ) -> Option<Self> {
        let (hz, name) = (f64::from(clock_hz), line_name(mask));
        let first: Vec<Edge> = edges(records.clone(), mask).take(MEASURED_EDGES).collect();
        let found = estimate(&first, options.format, Some(hz));
        let measured = found.as_ref().ok().map(|found| Measured::of(*found, clock_hz));
        let mut line = Self { name, measured, format: options.format.to_string(), ..Self::default() };
        let cycles_per_bit = match (options.baud, &found) {
            (Some(baud), _) => hz / f64::from(baud.max(1)),
            (None, Ok(found)) => found.bit,
            (None, Err(NoRate::NoEdges)) => return None,
            (None, Err(why)) => {
                let (problem, remedies) = no_rate(why, name);
                return Some(Self { problem: Some(problem), remedies, ..line });
            }
        };
        line.baud = options.baud.or(measured.map(Measured::rounded)).unwrap_or_default();
        line.decoded = decode_records(records, mask, cycles_per_bit, options.format);
        line.guess = guess(&line.decoded.bytes, cycles_per_bit as u64);
        if let Some((text, remedy)) = line.hint(found, options) {
            (line.hint, line.remedies) = (Some(text), remedy.into_iter().collect());
        }
        Some(line)
    }

    /// Why the decoded bytes may be wrong, and what helps. `found` is the measured rate.
    fn hint(
        &self,
        found: Result<Estimate, NoRate>,
        LineOptions { baud, format }: LineOptions,
    ) -> Option<(String, Option<Remedy>)> {
        let DecodedLine { bytes, framing_errors, parity_errors } = &self.decoded;
        let has_many_errors = (framing_errors.len() + parity_errors.len()) * 8 > bytes.len();
        match found {
            Err(why) if has_many_errors || why == NoRate::Inverted => {
                likely_reason(&why, self.name).map(|(text, remedy)| (text, Some(remedy)))
            }
            // Without `baud`, the line is decoded at the rate that was found.
            Ok(found) if has_many_errors && baud.is_some() && found.usual != baud => {
                let measured_baud = self.measured.map_or(0.0, |measured| libm::round(measured.baud));
                Some((format!("its pulses look like {measured_baud} baud"), None))
            }
            _ if format == Format::default() => seven_bit_hint(bytes),
            _ => None,
        }
    }

    /// Decoded bytes on a line: [`Levels::RX`] or [`Levels::TX`].
    pub fn of_decoded(line: u64, decoded: DecodedLine, clock_hz: u32, baud: u32) -> Self {
        let guess = guess(&decoded.bytes, u64::from(clock_hz / baud.max(1)));
        Self { name: line_name(line), baud, format: EIGHT_N_ONE.into(), decoded, guess, ..Self::default() }
    }

    /// One line of text.
    pub fn to_text(&self) -> String {
        let measured = self
            .measured
            .map_or_else(String::new, |measured| format!(" ({} measured)", libm::round(measured.baud)));
        if let Some(problem) = &self.problem {
            return format!("{}: {problem}", self.name);
        }
        let errors = |kind: &str, count: usize| match count {
            0 => String::new(),
            _ => format!(", {}", counted(count as u64, kind)),
        };
        let format = if self.format == EIGHT_N_ONE { String::new() } else { format!(" {}", self.format) };
        let hint = self.hint.as_ref().map_or_else(String::new, |hint| format!("; {hint}"));
        format!(
            "{}: {} baud{format}{measured}, {}{}{}, {}{hint}",
            self.name,
            self.baud,
            counted(self.decoded.bytes.len() as u64, "byte"),
            errors("framing error", self.decoded.framing_errors.len()),
            errors("parity error", self.decoded.parity_errors.len()),
            self.guess_text()
        )
    }

    /// The detected protocol as text.
    pub fn guess_text(&self) -> String {
        match self.guess {
            Guess::Framed { address, channels, good, bad } => {
                let channels = channels.map_or_else(String::new, |channels| {
                    format!(" of {}", counted(channels.into(), "channel"))
                });
                format!("{} for address {address}{channels}, {bad} broken", counted(good.into(), "frame"))
            }
            Guess::Raw { length, bad, .. } => {
                let others = if bad == 0 { String::new() } else { format!(", {bad} of another length") };
                format!("raw packets of {}{others}", counted(length.into(), "byte"))
            }
            Guess::Other => "no known packets".into(),
        }
    }
}

/// Such as `1 byte`, `2 bytes`.
fn counted(count: u64, singular: &str) -> String {
    format!("{count} {singular}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::StoredRun;
    use stepscope_peripheral::units::Instant;
    use stepscope_sim::Experiment;

    #[test]
    fn reports_the_line_and_the_channel_of_a_run() {
        let mut recording = StoredRun::default();
        Experiment::from_json("{}").expect("the default motion").run(&mut recording);
        let report = Report::from_records(&recording.trace, 16_000_000, 1, None);
        assert_eq!(report.channels.len(), 1);
        assert_eq!(
            report.lines[0].to_text(),
            "RX: 115200 baud (115187 measured), 200 bytes, raw packets of 1 byte"
        );
    }

    #[test]
    fn suggests_a_rate_only_if_another_was_used() {
        let decoded = DecodedLine { framing_errors: Vec::from([Instant(0)]), ..DecodedLine::default() };
        let found = Estimate { bit: 100.0, measured: 100.0, usual: Some(9600) };
        let measured = Some(Measured::of(found, 960_000));
        let line = LineReport { decoded, measured, ..LineReport::default() };
        let hint = |baud| line.hint(Ok(found), LineOptions { baud, ..LineOptions::default() });
        assert_eq!([None, Some(9600)].map(hint), [None, None]);
        assert_eq!(hint(Some(4800)), Some(("its pulses look like 9600 baud".into(), None)));
    }

    #[test]
    fn counts_one_byte_frame_and_error_in_the_singular() {
        let bytes = Vec::from([DecodedByte { start: Instant(0), byte: 5 }]);
        let decoded =
            DecodedLine { bytes, framing_errors: Vec::from([Instant(0)]), ..DecodedLine::default() };
        let guess = Guess::Framed { address: 3, channels: Some(1), good: 1, bad: 0 };
        let line = LineReport { guess, ..LineReport::of_decoded(Levels::RX, decoded, 1000, 100) };
        let expected = "RX: 100 baud, 1 byte, 1 framing error, 1 frame for address 3 of 1 channel, 0 broken";
        assert_eq!(line.to_text(), expected);
    }
}
