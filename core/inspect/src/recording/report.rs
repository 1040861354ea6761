//! The report of a recording: figures of each channel, and its lines.

use super::serial::{
    DecodedByte, LineOptions, MEASURED_EDGES, decode_records, edges, is_text_of_seven, parity_of_seven,
};
use super::serial::{DecodedLine, Guess, Measured, guess, line_name};
use super::{figures::StepFigures, remedy::Remedy};
use alloc::{format, string::String, string::ToString, vec::Vec};
use serde::Serialize;
use stepscope_capture::uart::{Edge, Format, NoRate, estimate};
use stepscope_peripheral::signal::{Levels, Record};
use stepscope_peripheral::trace::Step;

/// Figures of each channel, and the contents of the lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    pub channels: Vec<ChannelReport>,
    pub lines: Vec<LineReport>,
}

/// The figures of one channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelReport {
    pub channel: u8,
    pub figures: StepFigures,
}

/// A decoded line.
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

/// Number of records, and the signals that change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Survey {
    pub count: usize,
    pub changing: u64,
}

impl Survey {
    /// Counts records.
    pub fn of(records: impl IntoIterator<Item = Record>) -> Self {
        let mut records = records.into_iter();
        let Some(first) = records.next() else { return Self::default() };
        let found = Self { count: 1, changing: 0 };
        records.fold(found, |Self { count, changing }, record| Self {
            count: count + 1,
            changing: changing | (record.levels.0 ^ first.levels.0),
        })
    }
}

impl Report {
    /// Decodes lines as 8N1 at `baud`, or at the measured rate.
    pub fn of(records: &[Record], clock_hz: u32, channels: u8, baud: Option<u32>) -> Self {
        let all = records.iter().copied();
        let options = LineOptions { baud, ..LineOptions::default() };
        Self::of_all(all.clone(), Survey::of(all).changing, clock_hz, channels, options)
    }

    /// As [`Self::of`], for records that are iterated several times and not stored; `changing` comes from [`Survey`].
    pub fn of_all(
        records: impl Iterator<Item = Record> + Clone,
        changing: u64,
        clock_hz: u32,
        channels: u8,
        options: LineOptions,
    ) -> Self {
        let of = |channel| {
            let figures = StepFigures::of(steps(records.clone(), channel), clock_hz)?;
            Some(ChannelReport { channel, figures })
        };
        let line = |mask| LineReport::of(records.clone(), mask, clock_hz, options);
        let lines = [Levels::RX, Levels::TX].into_iter().filter(|mask| changing & mask != 0);
        Self {
            channels: (0..channels).filter(|channel| changing >> channel & 1 != 0).filter_map(of).collect(),
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

    /// The report of RX.
    pub fn rx(&self) -> Option<&LineReport> {
        self.lines.iter().find(|line| line.name == line_name(Levels::RX))
    }
}

/// As [`stepscope_peripheral::trace::steps_in`], for iterated records.
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
        let text = "its bits last fewer than 3 cycles of the recording, so its bit rate cannot be measured; use at least 4 samples per \
                    bit, or export times with more decimal places";
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
fn seven_bits(bytes: &[DecodedByte]) -> Option<(String, Option<Remedy>)> {
    if is_text_of_seven(bytes) {
        let text = "all bytes look like text of 7 data bits with 2 stop bits, or 1 and pauses";
        return Some((text.into(), Some(Remedy::Format("7N2".into()))));
    }
    parity_of_seven(bytes).map(|parity| {
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
        LineOptions { baud, format }: LineOptions,
    ) -> Option<Self> {
        let hz = f64::from(clock_hz);
        let first: Vec<Edge> = edges(records.clone(), mask).take(MEASURED_EDGES).collect();
        let found = estimate(&first, format, Some(hz));
        let measured = found.as_ref().ok().map(|found| Measured::of(*found, clock_hz));
        let mut line =
            Self { name: line_name(mask), measured, format: format.to_string(), ..Self::default() };
        let bit = match (baud, &found) {
            (Some(baud), _) => hz / f64::from(baud.max(1)),
            (None, Ok(found)) => found.bit,
            (None, Err(NoRate::NoEdges)) => return None,
            (None, Err(why)) => {
                let (problem, remedies) = no_rate(why, line.name);
                (line.problem, line.remedies) = (Some(problem), remedies);
                return Some(line);
            }
        };
        line.baud = baud.or(measured.map(Measured::rounded)).unwrap_or_default();
        line.decoded = decode_records(records, mask, bit, format);
        line.guess = guess(&line.decoded.bytes, bit as u64);
        let DecodedLine { bytes, framing_errors, parity_errors } = &line.decoded;
        let wrong = framing_errors.len() + parity_errors.len();
        let hint = match found {
            Err(why) if wrong * 8 > bytes.len() || why == NoRate::Inverted => {
                likely_reason(&why, line.name).map(|(text, remedy)| (text, Some(remedy)))
            }
            Ok(found) if wrong * 8 > bytes.len() && found.usual != baud => {
                Some((format!("its pulses look like {} baud", libm::round(hz / found.measured)), None))
            }
            _ if format == Format::default() => seven_bits(bytes),
            _ => None,
        };
        if let Some((text, remedy)) = hint {
            (line.hint, line.remedies) = (Some(text), remedy.into_iter().collect());
        }
        Some(line)
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
            1 => format!(", 1 {kind} error"),
            more => format!(", {more} {kind} errors"),
        };
        let format = if self.format == EIGHT_N_ONE { String::new() } else { format!(" {}", self.format) };
        let hint = self.hint.as_ref().map_or_else(String::new, |hint| format!("; {hint}"));
        format!(
            "{}: {} baud{format}{measured}, {} bytes{}{}, {}{hint}",
            self.name,
            self.baud,
            self.decoded.bytes.len(),
            errors("framing", self.decoded.framing_errors.len()),
            errors("parity", self.decoded.parity_errors.len()),
            self.guess_text()
        )
    }

    /// The detected protocol as text.
    pub fn guess_text(&self) -> String {
        match self.guess {
            Guess::Framed { address, channels, good, bad } => {
                let channels =
                    channels.map_or_else(String::new, |channels| format!(" of {channels} channels"));
                format!("{good} frames for address {address}{channels}, {bad} broken")
            }
            Guess::Raw { length, bad, .. } => {
                let s = if length == 1 { "" } else { "s" };
                let others = if bad == 0 { String::new() } else { format!(", {bad} of another length") };
                format!("raw packets of {length} byte{s}{others}")
            }
            Guess::Other => "no known packets".into(),
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_report_of_a_run() {
        use crate::recording::report::Report;
        use crate::trace::stored_run::Recording;
        use stepscope_sim::Experiment;

        let mut recording = Recording::default();
        Experiment::from_json("{}").expect("the default motion").run(&mut recording);
        let report = Report::of(&recording.trace, 16_000_000, 1, None);
        assert_eq!(report.channels.len(), 1);
        assert_eq!(
            report.lines[0].to_text(),
            "RX: 115200 baud (115187 measured), 200 bytes, raw packets of 1 byte"
        );
    }
}
