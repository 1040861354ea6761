//! Files of logic analysers, for a worker of their own: read as a stream, mapped, looked at, and handed on as records.

use crate::convert::{field, object, records};
use js_sys::{Error, Function, Object, Uint8Array};
use serde::{Deserialize, Serialize};
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use stepscope_core::{
    capture::{
        Capture, ChannelMap,
        read::{Limits, Reading, Wanted, read, read_wanted},
        samples,
    },
    inspect::{
        motion::curves::Actual,
        recording::{
            differences::Difference,
            events::{Beside, Events},
            loaded_capture::{LoadedCapture, LoadedPart, Part},
            open_options::{OpenError, OpenOptions},
            packets::{LinePacket, Packets},
            remedy::{Note, Remedy},
            replies::{self, Dealt},
            report::{ChannelReport, LineReport},
            tolerance::Tolerance,
        },
    },
    peripheral::signal::Levels,
};
use wasm_bindgen::prelude::*;

/// Most columns of an overview.
const MAX_COLUMNS: u32 = 10_000;
/// Differences from a plan that are listed in words.
const MAX_DIFFERENCES: usize = 10;
/// Bytes that are asked for at a time.
const PIECE: usize = 1 << 20;

/// A file that is read by a function of where and how much, as a worker can read it at once.
struct Pieces {
    read: Function,
    at: u64,
    size: u64,
}

impl Read for Pieces {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let length = (self.size.saturating_sub(self.at)).min(buffer.len() as u64);
        if length == 0 {
            return Ok(0);
        }
        let piece = self.read.call2(&JsValue::NULL, &(self.at as f64).into(), &(length as f64).into());
        let piece = piece.map_err(|_| io::Error::other("the file can no longer be read; open it again"))?;
        let piece = Uint8Array::new(&piece).to_vec();
        let taken = piece.len().min(buffer.len());
        buffer[..taken].copy_from_slice(&piece[..taken]);
        self.at += taken as u64;
        Ok(taken)
    }
}

impl Seek for Pieces {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let (base, by) = match to {
            SeekFrom::Start(at) => (at, 0),
            SeekFrom::Current(by) => (self.at, by),
            SeekFrom::End(by) => (self.size, by),
        };
        let at = base.checked_add_signed(by);
        self.at = at.ok_or_else(|| io::Error::other("before the file's beginning"))?;
        Ok(self.at)
    }
}

/// A recording that was read.
#[wasm_bindgen]
pub struct CaptureFile {
    capture: Capture,
    error: Option<String>,
    /// The map that it was read for, where one was given.
    map: Option<String>,
    opened: Option<LoadedCapture>,
    /// What was said of it, where it stands where it was recorded.
    asked: Option<OpenOptions>,
}

/// The file's name of a sample, and the scenario that it was to follow: `{file, scenario}`.
///
/// # Errors
/// If there is no such sample.
#[wasm_bindgen]
pub fn sample_facts(id: &str) -> Result<JsValue, JsError> {
    #[derive(Serialize)]
    struct SampleFacts {
        file: &'static str,
        scenario: &'static str,
    }
    let found = samples::sample(id).ok_or_else(|| JsError::new("there is no such recording"))?;
    object(&SampleFacts { file: found.file, scenario: found.scenario })
}

/// What a file holds.
#[derive(Serialize)]
struct Facts<'a> {
    format: String,
    channels: Vec<&'a str>,
    count: usize,
    /// The map that it was read for, or a proposed one; empty where there are no levels, or nothing says what a channel is.
    map: String,
    /// Why it could not be read for that map.
    map_error: Option<String>,
    /// Channels beyond the first 64.
    left_out: u64,
    has_levels: bool,
    has_bytes: bool,
    has_times: bool,
    notes: &'a [String],
    /// Why that is not all of it.
    error: Option<&'a str>,
}

/// What is said of it.
#[derive(Deserialize)]
struct Asked {
    map: Option<String>,
    clock_hz: Option<u32>,
    sample_rate_hz: Option<u64>,
    baud: Option<u32>,
    uart: Option<String>,
    /// Whether drivers step on both edges.
    both_edges: Option<bool>,
    /// When one of its steps, or bytes, is to come, in s.
    at_s: Option<f64>,
    /// Of this channel.
    channel: Option<u8>,
    /// Which of them, from 0.
    aligned: Option<usize>,
    /// Most records that the views take.
    most: Option<usize>,
    /// The part of it that they show, in s.
    from_s: Option<f64>,
    to_s: Option<f64>,
}

/// A map as text: the given one, or, without it or where it is wrong, the proposed one; and what is wrong.
fn map_of(capture: &Capture, given: Option<&str>) -> (String, Option<String>) {
    let found = given.map(|map| ChannelMap::parse(map, capture)).transpose();
    let error = found.as_ref().err().map(ToString::to_string);
    let map = found.ok().flatten().unwrap_or_else(|| ChannelMap::proposed(capture));
    (map.to_text(capture), error)
}

/// The option of `look` that has to be changed.
const fn field_of(error: &OpenError) -> &'static str {
    match error {
        OpenError::Map(_) | OpenError::NoMap { .. } => "map",
        OpenError::Clock(_) => "clock_hz",
        OpenError::SampleRate | OpenError::NoSampleRate(_) => "sample_rate_hz",
        OpenError::NoBaud | OpenError::Baud | OpenError::NoRate(..) => "baud",
        OpenError::Uart(..) => "uart",
        _ => "",
    }
}

/// The end of a sentence that says what would help, by the fields of the page's dialog.
fn in_fields(remedy: &Remedy) -> String {
    match remedy {
        Remedy::BothEdges { .. } => "; for such a driver choose the signal “STEP, both edges”".to_owned(),
        Remedy::OtherEdge { motor, inverted, .. } => {
            let check = if *inverted { "check" } else { "clear" };
            format!("; if the driver steps where it begins, {check} “Inverted” of STEP{motor}")
        }
        Remedy::InvertLine { line, .. } => format!(": change “Inverted” of {line}"),
        Remedy::ChooseLine => "; choose the channel of RX".to_owned(),
        Remedy::Format(format) => format!(": try the serial format {format}"),
        Remedy::Baud => "; enter one as the bit rate".to_owned(),
        Remedy::BaudOrFormat => "; enter the bit rate, or choose another serial format".to_owned(),
    }
}

/// A note with what would help.
fn note(Note { text, remedy }: &Note) -> String {
    text.clone() + &remedy.as_ref().map(in_fields).unwrap_or_default()
}

/// A line with what would help.
fn line(line: &LineReport) -> String {
    line.to_text() + &line.remedies.iter().map(in_fields).collect::<String>()
}

/// An `Error` with the option that has to be changed as its `field`.
fn refused(error: &OpenError) -> JsValue {
    let by = match error {
        OpenError::NoMap { .. } => "; choose the signals of the channels".to_owned(),
        OpenError::NoRate(_, remedies) => remedies.iter().map(in_fields).collect(),
        _ => String::new(),
    };
    let thrown = Error::new(&format!("{error}{by}"));
    field(&thrown, "field", &field_of(error).into());
    thrown.into()
}

/// What it comes to.
#[derive(Serialize)]
struct Looked<'a> {
    map: &'a str,
    clock_hz: u32,
    rounding: &'a str,
    end_s: f64,
    records: usize,
    /// The part that is shown; null where it is all.
    kept: Option<LoadedPart>,
    notes: Vec<String>,
    steps: &'a [ChannelReport],
    lines: Vec<String>,
}

#[wasm_bindgen]
impl CaptureFile {
    /// Reads a file of `size` bytes. `read(at, length)` gives its bytes; `watch(bytes)` hears how far it is. At most `most`
    /// changes, bytes or positions are kept. Of more than 64 channels those that a map names are read before all others.
    #[wasm_bindgen(constructor)]
    #[must_use]
    pub fn new(read_piece: Function, size: f64, watch: &Function, most: u32, map: Option<String>) -> Self {
        let pieces = Pieces { read: read_piece, at: 0, size: size.max(0.0) as u64 };
        let mut tell = |bytes: u64| watch.call1(&JsValue::NULL, &(bytes as f64).into()).is_ok();
        let limits = Limits { most: most as usize };
        let channels = map.as_deref().map(ChannelMap::channel_names).unwrap_or_default();
        let wanted = Wanted { channels, ..Wanted::default() };
        let input = BufReader::with_capacity(PIECE, pieces);
        let Reading { capture, error } = read_wanted(input, &limits, &wanted, &mut tell);
        Self { capture, error: error.map(|error| error.to_string()), map, opened: None, asked: None }
    }

    /// One of the samples; none of another name.
    #[must_use]
    pub fn sample(id: &str) -> Option<Self> {
        let bytes = samples::sample(id)?.bytes;
        let Reading { capture, error } = read(io::Cursor::new(bytes), &Limits::default(), &mut |_| true);
        Some(Self {
            capture,
            error: error.map(|error| error.to_string()),
            map: None,
            opened: None,
            asked: None,
        })
    }

    /// What it holds: `{format, channels, count, map, map_error, left_out, has_levels, has_bytes, has_times, notes, error}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn facts(&self) -> Result<JsValue, JsError> {
        let capture = &self.capture;
        let (map, map_error) = map_of(capture, self.map.as_deref());
        object(&Facts {
            format: capture.format.to_string(),
            channels: capture.channels.iter().map(|channel| channel.name.as_str()).collect(),
            count: capture.len(),
            map,
            map_error,
            left_out: capture.channels_left_out,
            has_levels: !capture.changes.is_empty(),
            has_bytes: !capture.bytes.is_empty(),
            has_times: capture.timebase.is_some(),
            notes: &capture.left_out,
            error: self.error.as_deref(),
        })
    }

    /// Looks at it by what is said of it, `{map, clock_hz, sample_rate_hz, baud, uart, both_edges, at_s, channel, aligned, most, from_s, to_s}`,
    /// each of which may be left out: `{map, clock_hz, rounding, end_s, records, kept, notes, steps, lines}`.
    ///
    /// # Errors
    /// With what is missing, or wrong; its `field` is the option that has to be changed.
    pub fn look(&mut self, asked: JsValue) -> Result<JsValue, JsValue> {
        let Asked {
            map,
            clock_hz,
            sample_rate_hz,
            baud,
            uart,
            both_edges,
            at_s,
            channel,
            aligned,
            most,
            from_s,
            to_s,
        } = serde_wasm_bindgen::from_value(asked).map_err(JsError::from)?;
        let options = OpenOptions {
            map,
            clock_hz,
            sample_rate_hz,
            baud,
            uart,
            both_edges: both_edges.unwrap_or(false),
        };
        let part = Part { max_records: most.unwrap_or(usize::MAX), from_s, to_s };
        let known = self.opened.take().filter(|_| self.asked.take().as_ref() == Some(&options));
        let mut opened = match known {
            Some(known) => known.with_part(&self.capture, &options, &part),
            None => LoadedCapture::of_part(&self.capture, &options, &part),
        }
        .map_err(|error| refused(&error))?;
        match at_s {
            Some(at_s) => {
                opened.align(channel.unwrap_or(0), aligned.unwrap_or(0), at_s).map_err(JsError::from)?
            }
            None => self.asked = Some(options),
        }
        let opened = self.opened.insert(opened);
        object(&Looked {
            map: &opened.map,
            clock_hz: opened.clock_hz,
            rounding: &opened.rounding,
            end_s: opened.end_s,
            records: opened.records.len(),
            kept: opened.part,
            notes: opened.notes.iter().map(note).collect(),
            steps: &opened.report.channels,
            lines: opened.report.lines.iter().map(line).collect(),
        })
        .map_err(JsValue::from)
    }

    /// All of a channel at a glance: `{position_min, position_max, speed_min, speed_max}` of each column, in steps and steps/s; null
    /// before it was looked at where it was recorded, and where no levels were.
    ///
    /// # Errors
    /// As of `look`.
    pub fn overview(&self, channel: u8, columns: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Columns {
            position_min: Vec<f64>,
            position_max: Vec<f64>,
            speed_min: Vec<f64>,
            speed_max: Vec<f64>,
        }
        let Some(options) = &self.asked else { return Ok(JsValue::NULL) };
        let found =
            LoadedCapture::overview(&self.capture, options, channel, columns.min(MAX_COLUMNS) as usize)?;
        object(&found.map(|Actual { position, speed }| Columns {
            position_min: position.min,
            position_max: position.max,
            speed_min: speed.min,
            speed_max: speed.max,
        }))
    }

    /// The scenario that it is shown with, as JSON: the one that gives it again, or, where that is too long, one that has
    /// only its clock and its channels.
    #[must_use]
    pub fn scenario(&self, file: &str, steps: bool) -> Option<String> {
        Some(self.opened.as_ref()?.shown_scenario(file, steps).to_json())
    }

    /// What its lines say, packet by packet: `{total, replies, rows, csv}`, the first `most` rows, and all of them as a table.
    /// `addressed` says whether raw packets begin with an address.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packets(&self, addressed: bool, most: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Told<'a> {
            total: usize,
            replies: usize,
            rows: &'a [LinePacket],
            csv: String,
        }
        let told = self
            .opened
            .as_ref()
            .map(|opened| Packets::of(&opened.report, opened.clock_hz, opened.channels, addressed));
        let Some(packets) = told else { return Ok(JsValue::NULL) };
        let mut csv = String::new();
        packets.write_csv(&mut csv)?;
        let rows = packets.rows.get(..packets.rows.len().min(most as usize)).unwrap_or_default();
        object(&Told { total: packets.rows.len(), replies: packets.replies(), rows, csv })
    }

    /// What TX says in the part that is shown, dealt to controllers of these addresses, for the page's table of packets:
    /// [`replies::Dealt`], `{bytes, unknown}`. None where TX was not recorded.
    #[must_use]
    pub fn replies(&self, addresses: &[u8]) -> Option<Object> {
        let opened = self.opened.as_ref()?;
        let map = ChannelMap::parse(&opened.map, &self.capture).ok()?;
        if !map.has(Levels::TX.trailing_zeros()) {
            return None;
        }
        let cycle = |at_s: f64| (at_s * f64::from(opened.clock_hz)) as u64;
        let shown = opened.part.map_or(0..u64::MAX, |part| cycle(part.from_s)..cycle(part.to_s));
        let Dealt { bytes, unknown } = replies::to_bytes(&opened.report, opened.clock_hz, shown, addresses);
        let dealt = Object::new();
        field(&dealt, "bytes", &Uint8Array::from(bytes.as_slice()).into());
        field(&dealt, "unknown", &unknown.into());
        Some(dealt)
    }

    /// When step `aligned` of a channel, from 0, or, where this steps nowhere, that byte of RX comes in a run, in s: its
    /// records, as the run gives them, in cycles of `clock_hz`. None where there is no such step or byte.
    #[must_use]
    pub fn time_of(&self, run: &[u8], clock_hz: u32, channel: u8, baud: u32, aligned: usize) -> Option<f64> {
        let kind = self.opened.as_ref()?.events(channel).kind;
        Events::of_records(&records(run).collect::<Vec<_>>(), clock_hz, kind, channel, baud).at_s(aligned)
    }

    /// How it compares with such a run, the run's step, or byte, `aligned` and the recorded one that it is taken for the same
    /// instant: the core's `Beside`, and in `rows` the first 10 differences in words, with their times; null where one of
    /// both has none.
    ///
    /// # Errors
    /// Never in practice.
    pub fn beside(
        &self,
        run: &[u8],
        clock_hz: u32,
        channel: u8,
        baud: u32,
        aligned: usize,
    ) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Row {
            text: String,
            recorded_s: f64,
        }
        #[derive(Serialize)]
        struct Told {
            rows: Vec<Row>,
            #[serde(flatten)]
            beside: Beside,
        }
        let rows = |found: &Beside| {
            let listed = found.differences.listed.iter();
            let row = |difference: &Difference| Row {
                text: difference.to_text(found.kind),
                recorded_s: difference.recorded_s,
            };
            listed.map(row).collect()
        };
        let found = self.opened.as_ref().and_then(|opened| {
            let own = opened.events(channel);
            let model =
                Events::of_records(&records(run).collect::<Vec<_>>(), clock_hz, own.kind, channel, baud);
            let within = Tolerance::cycle(own.clock_hz, model.clock_hz);
            // A step that is missing in the recording cannot be aligned: then the first that both have is.
            let aligned = own.beside(&model, Some(aligned), within);
            let mut found = aligned.or_else(|| own.beside(&model, None, within))?;
            found.differences.listed.truncate(MAX_DIFFERENCES);
            Some(Told { rows: rows(&found), beside: found })
        });
        object(&found)
    }

    /// Its records from one on, at most so many: 16 bytes each, cycle and levels, little-endian. None where no levels were
    /// recorded.
    #[must_use]
    pub fn records(&self, from: u32, most: u32) -> Vec<u8> {
        let Some(opened) = self.opened.as_ref().filter(|opened| opened.has_levels()) else {
            return Vec::new();
        };
        let rest = opened.records.get(from as usize..).unwrap_or_default();
        let taken = rest.get(..rest.len().min(most as usize)).unwrap_or_default();
        let mut bytes = Vec::with_capacity(16 * taken.len());
        for record in taken {
            bytes.extend_from_slice(&record.cycle.0.to_le_bytes());
            bytes.extend_from_slice(&record.levels.0.to_le_bytes());
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_core::capture::{
        capture::{Change, Channel, Format},
        timebase::Timebase,
    };

    #[test]
    fn of_many_channels_those_of_the_typed_map_are_read() {
        let names: Vec<String> = (0..100).map(|at| format!("top.W{at}")).collect();
        let table = format!("Time [s],{}\n0{}\n", names.join(","), ",1".repeat(100));
        let typed = "STEP0=W98,DIR0=!top.W99";
        let wanted = Wanted { channels: ChannelMap::channel_names(typed), ..Wanted::default() };
        let capture = read_wanted(io::Cursor::new(table), &Limits::default(), &wanted, &mut |_| true).capture;
        assert_eq!((capture.channels.len(), capture.channels_left_out), (64, 36));
        assert_eq!(map_of(&capture, Some(typed)), ("STEP0=top.W98,DIR0=!top.W99".into(), None));
        let (map, error) = map_of(&capture, Some("STEP0=W97"));
        assert!(
            map.is_empty() && error.is_some_and(|error| error.contains("there is no channel W97")),
            "{map}"
        );
    }

    #[test]
    fn notes_name_the_fields_of_the_dialog_whatever_the_names_of_the_channels() {
        let mut capture = Capture::new(Format::LevelsCsv);
        capture.channels.push(Channel { name: "Channel 0".into() });
        capture.timebase = Timebase::new(1, 1_000_000);
        capture.changes = (0..40).map(|k| Change { tick: 10 * k, levels: k % 2 }).collect();
        let options = OpenOptions { map: Some("STEP0=Channel 0".into()), ..OpenOptions::default() };
        let opened = LoadedCapture::new(capture, &options).expect("steps");
        let notes: Vec<String> = opened.notes.iter().map(note).collect();
        let expected = "makes 39 steps of it; for such a driver choose the signal “STEP, both edges”";
        assert!(notes.iter().any(|note| note.ends_with(expected)), "{notes:?}");
        assert_eq!(
            in_fields(&Remedy::OtherEdge { motor: 1, channel: "#0".into(), inverted: true }),
            "; if the driver steps where it begins, check “Inverted” of STEP1"
        );
    }
}
