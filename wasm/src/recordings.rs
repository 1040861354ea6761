//! Recordings: read as a stream, mapped, previewed, and returned as records.

use crate::convert::{field, object, records};
use js_sys::{Error, Function, Object, Uint8Array};
use serde::{Deserialize, Serialize};
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use stepscope_core::{
    capture::{
        Capture, ChannelMap,
        capture::Format,
        read::{Limits, ReadOptions, Reading, read, read_with_options},
        samples,
    },
    inspect::{
        motion::curves::Actual,
        recording::{
            differences::Difference,
            events::{EventComparison, Events},
            loaded_capture::{LoadedCapture, LoadedPart, Part},
            open_options::{OpenError, OpenOptions},
            packets::{LinePacket, Packets},
            remedy::{Note, Remedy},
            replies::{self, EncodedReplies},
            report::{ChannelReport, LineReport},
            tolerance::Tolerance,
        },
    },
    peripheral::signal::Levels,
    scenario::Scenario,
};
use wasm_bindgen::prelude::*;

const MAX_COLUMNS: u32 = 10_000;
/// Maximum listed differences from a plan.
const MAX_DIFFERENCES: usize = 10;
const PIECE: usize = 1 << 20;

/// A file that is read with a function of position and length.
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
        self.at = at.ok_or_else(|| io::Error::other("before the start of the file"))?;
        Ok(self.at)
    }
}

/// A recording.
#[wasm_bindgen]
pub struct CaptureFile {
    capture: Capture,
    error: Option<String>,
    map: Option<String>,
    loaded: Option<LoadedCapture>,
    /// Options of `loaded`, unless it is aligned with a run.
    options: Option<OpenOptions>,
}

/// File name and scenario of a sample: `{file, scenario}`. Errors: for an unknown sample.
#[wasm_bindgen]
pub fn sample_facts(id: &str) -> Result<JsValue, JsError> {
    #[derive(Serialize)]
    struct SampleFacts {
        file: &'static str,
        scenario: &'static str,
    }
    let sample = samples::sample(id).ok_or_else(|| JsError::new("this sample recording does not exist"))?;
    object(&SampleFacts { file: sample.file, scenario: sample.scenario })
}

#[derive(Serialize)]
struct Facts<'a> {
    format: String,
    channels: Vec<&'a str>,
    count: usize,
    /// The given or proposed map; empty if there is none.
    map: String,
    map_error: Option<String>,
    /// Channels beyond the first 64.
    left_out: u64,
    has_levels: bool,
    has_bytes: bool,
    has_times: bool,
    /// Whether bytes are written as numbers in some base.
    has_base: bool,
    notes: &'a [String],
    error: Option<&'a str>,
}

#[derive(Deserialize)]
struct PreviewOptions {
    map: Option<String>,
    clock_hz: Option<u32>,
    sample_rate_hz: Option<u64>,
    baud: Option<u32>,
    uart: Option<String>,
    /// Whether drivers step on both edges.
    both_edges: Option<bool>,
    /// Time of the aligned step or byte, in s.
    at_s: Option<f64>,
    channel: Option<u8>,
    aligned: Option<usize>,
    /// Maximum records in the views.
    most: Option<usize>,
    /// Visible part, in s.
    from_s: Option<f64>,
    to_s: Option<f64>,
}

/// The user's map, or the proposed one without a valid map; and the error.
fn map_of(capture: &Capture, user_map: Option<&str>) -> (String, Option<String>) {
    let parsed = user_map.map(|map| ChannelMap::parse(map, capture)).transpose();
    let error = parsed.as_ref().err().map(ToString::to_string);
    let map = parsed.ok().flatten().unwrap_or_else(|| ChannelMap::proposed(capture));
    (map.to_text(capture), error)
}

/// The option of `preview` that has to change.
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

fn in_fields(remedy: &Remedy) -> String {
    match remedy {
        Remedy::BothEdges { .. } => "; for such a driver select the signal “STEP, both edges”".to_owned(),
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

fn note(Note { text, remedy }: &Note) -> String {
    text.clone() + &remedy.as_ref().map(in_fields).unwrap_or_default()
}

fn line(line: &LineReport) -> String {
    line.to_text() + &line.remedies.iter().map(in_fields).collect::<String>()
}

/// An `Error` with the option that has to change as its `field`.
fn refused(error: &OpenError) -> JsValue {
    let by = match error {
        OpenError::NoMap { .. } => "; choose the signals of the channels".to_owned(),
        OpenError::NoRate(_, remedies) => remedies.iter().map(in_fields).collect(),
        _ => String::new(),
    };
    let js_error = Error::new(&format!("{error}{by}"));
    field(&js_error, "field", &field_of(error).into());
    js_error.into()
}

#[derive(Serialize)]
struct Preview<'a> {
    map: &'a str,
    clock_hz: u32,
    rounding: &'a str,
    end_s: f64,
    records: usize,
    /// The visible part; null if it is all.
    part: Option<LoadedPart>,
    notes: Vec<String>,
    steps: &'a [ChannelReport],
    lines: Vec<String>,
}

#[wasm_bindgen]
impl CaptureFile {
    /// Reads a file of `size` bytes with `read(at, length)` and reports progress to `watch(bytes)`. Saves at most `most`
    /// changes, bytes or positions. Of more than 64 channels, the channels of `map` are read first. `base` is the base of written bytes.
    #[wasm_bindgen(constructor)]
    pub fn new(
        read_piece: Function,
        size: f64,
        watch: &Function,
        most: u32,
        map: Option<String>,
        base: Option<String>,
    ) -> Self {
        let pieces = Pieces { read: read_piece, at: 0, size: size.max(0.0) as u64 };
        let mut report = |bytes: u64| watch.call1(&JsValue::NULL, &(bytes as f64).into()).is_ok();
        let limits = Limits { max_rows: most as usize };
        let channels = map.as_deref().map(ChannelMap::channel_names).unwrap_or_default();
        let options = ReadOptions { channels, base: base.and_then(|name| name.parse().ok()) };
        let input = BufReader::with_capacity(PIECE, pieces);
        let Reading { capture, error } = read_with_options(input, &limits, &options, &mut report);
        Self { capture, error: error.map(|error| error.to_string()), map, loaded: None, options: None }
    }

    /// A sample, by its name.
    pub fn sample(id: &str) -> Option<Self> {
        let bytes = samples::sample(id)?.bytes;
        let Reading { capture, error } = read(io::Cursor::new(bytes), &Limits::default(), &mut |_| true);
        Some(Self {
            capture,
            error: error.map(|error| error.to_string()),
            map: None,
            loaded: None,
            options: None,
        })
    }

    /// Its contents (`Facts`).
    pub fn facts(&self) -> Result<JsValue, JsError> {
        let capture = &self.capture;
        let (map, map_error) = map_of(capture, self.map.as_deref());
        object(&Facts {
            format: capture.format.to_string(),
            channels: capture.channels.iter().map(|channel| channel.name.as_str()).collect(),
            count: capture.len(),
            map,
            map_error,
            left_out: capture.omitted_channels,
            has_levels: !capture.changes.is_empty(),
            has_bytes: !capture.bytes.is_empty(),
            has_times: capture.timebase.is_some(),
            has_base: matches!(capture.format, Format::Annotations | Format::HexBytes | Format::SerialLog),
            notes: &capture.notes,
            error: self.error.as_deref(),
        })
    }

    /// A preview with some of `PreviewOptions`. Errors: its `field` is the option that has to change.
    pub fn preview(&mut self, options: JsValue) -> Result<JsValue, JsValue> {
        let PreviewOptions {
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
        } = serde_wasm_bindgen::from_value(options).map_err(JsError::from)?;
        let options = OpenOptions {
            map,
            clock_hz,
            sample_rate_hz,
            baud,
            uart,
            both_edges: both_edges.unwrap_or(false),
        };
        let part = Part { max_records: most.unwrap_or(usize::MAX), from_s, to_s };
        let known = self.loaded.take().filter(|_| self.options.take().as_ref() == Some(&options));
        let mut loaded = match known {
            Some(known) => known.with_part(&self.capture, &options, &part),
            None => LoadedCapture::of_part(&self.capture, &options, &part),
        }
        .map_err(|error| refused(&error))?;
        match at_s {
            Some(at_s) => {
                loaded.align(channel.unwrap_or(0), aligned.unwrap_or(0), at_s).map_err(JsError::from)?
            }
            None => self.options = Some(options),
        }
        let loaded = self.loaded.insert(loaded);
        object(&Preview {
            map: &loaded.map,
            clock_hz: loaded.clock_hz,
            rounding: &loaded.rounding,
            end_s: loaded.end_s,
            records: loaded.records.len(),
            part: loaded.part,
            notes: loaded.notes.iter().map(note).collect(),
            steps: &loaded.report.channels,
            lines: loaded.report.lines.iter().map(line).collect(),
        })
        .map_err(JsValue::from)
    }

    /// A channel in columns: `{position_min, position_max, speed_min, speed_max}`, in steps and steps/s; null before a
    /// preview and without levels. Errors: as `preview`.
    pub fn overview(&self, channel: u8, columns: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Columns {
            position_min: Vec<f64>,
            position_max: Vec<f64>,
            speed_min: Vec<f64>,
            speed_max: Vec<f64>,
        }
        let Some(options) = &self.options else { return Ok(JsValue::NULL) };
        let overview =
            LoadedCapture::overview(&self.capture, options, channel, columns.min(MAX_COLUMNS) as usize)?;
        object(&overview.map(|Actual { position, speed }| Columns {
            position_min: position.min,
            position_max: position.max,
            speed_min: speed.min,
            speed_max: speed.max,
        }))
    }

    /// Scenarios as JSON, of which the first one without problems is to be shown: one that reproduces it, if that is
    /// short enough to edit, and an idle one with its clock and channels. None before a preview.
    pub fn scenarios(&self, file: &str, steps: bool) -> Vec<String> {
        let Some(loaded) = &self.loaded else { return Vec::new() };
        let (reproduced, idle) = loaded.candidates(file, steps);
        reproduced.iter().chain([&idle]).map(Scenario::to_json).collect()
    }

    /// Its packets: `{total, replies, rows, csv}`, with the first `most` rows. `addressed`: raw packets begin with an address.
    pub fn packets(&self, addressed: bool, most: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct PacketPage<'a> {
            total: usize,
            replies: usize,
            rows: &'a [LinePacket],
            csv: String,
        }
        let packets = self
            .loaded
            .as_ref()
            .map(|loaded| Packets::of(&loaded.report, loaded.clock_hz, loaded.channels, addressed));
        let Some(packets) = packets else { return Ok(JsValue::NULL) };
        let mut csv = String::new();
        packets.write_csv(&mut csv)?;
        let rows = packets.rows.get(..packets.rows.len().min(most as usize)).unwrap_or_default();
        object(&PacketPage { total: packets.rows.len(), replies: packets.replies(), rows, csv })
    }

    /// Replies on TX in the visible part, by the addresses of controllers ([`replies::EncodedReplies`]): `{bytes, unknown}`. `None`
    /// without TX.
    pub fn replies(&self, addresses: &[u8]) -> Option<Object> {
        let loaded = self.loaded.as_ref()?;
        let map = ChannelMap::parse(&loaded.map, &self.capture).ok()?;
        if !map.has(Levels::TX.trailing_zeros()) {
            return None;
        }
        let cycle = |at_s: f64| (at_s * f64::from(loaded.clock_hz)) as u64;
        let shown = loaded.part.map_or(0..u64::MAX, |part| cycle(part.from_s)..cycle(part.to_s));
        let EncodedReplies { bytes, unknown } =
            replies::encode(&loaded.report, loaded.clock_hz, shown, addresses);
        let dealt = Object::new();
        field(&dealt, "bytes", &Uint8Array::from(bytes.as_slice()).into());
        field(&dealt, "unknown", &unknown.into());
        Some(dealt)
    }

    /// Time of step `aligned` of a channel in a run, or of that byte of RX if the recording has no steps, in s.
    pub fn time_of(&self, run: &[u8], clock_hz: u32, channel: u8, baud: u32, aligned: usize) -> Option<f64> {
        let kind = self.loaded.as_ref()?.events(channel).kind;
        Events::of_records(&records(run).collect::<Vec<_>>(), clock_hz, kind, channel, baud).at_s(aligned)
    }

    /// Comparison with a run, aligned by that step or byte: the core's [`EventComparison`], and in `rows` the first differences as
    /// text with their times.
    pub fn comparison(
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
        struct Comparison {
            rows: Vec<Row>,
            #[serde(flatten)]
            beside: EventComparison,
        }
        let rows = |comparison: &EventComparison| {
            let listed = comparison.differences.listed.iter();
            let row = |difference: &Difference| Row {
                text: difference.to_text(comparison.kind),
                recorded_s: difference.recorded_s,
            };
            listed.map(row).collect()
        };
        let comparison = self.loaded.as_ref().and_then(|loaded| {
            let own = loaded.events(channel);
            let model =
                Events::of_records(&records(run).collect::<Vec<_>>(), clock_hz, own.kind, channel, baud);
            let within = Tolerance::cycle(own.clock_hz, model.clock_hz);
            // If the recording lacks that step, the first common one is aligned.
            let aligned = own.compare(&model, Some(aligned), within);
            let mut comparison = aligned.or_else(|| own.compare(&model, None, within))?;
            comparison.differences.listed.truncate(MAX_DIFFERENCES);
            Some(Comparison { rows: rows(&comparison), beside: comparison })
        });
        object(&comparison)
    }

    /// At most `most` records of 16 bytes: cycle and levels, little-endian. Empty without levels.
    pub fn records(&self, from: u32, most: u32) -> Vec<u8> {
        let Some(loaded) = self.loaded.as_ref().filter(|loaded| loaded.has_levels()) else {
            return Vec::new();
        };
        let rest = loaded.records.get(from as usize..).unwrap_or_default();
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
    fn the_channels_of_a_map_are_read_first() {
        let names: Vec<String> = (0..100).map(|at| format!("top.W{at}")).collect();
        let table = format!("Time [s],{}\n0{}\n", names.join(","), ",1".repeat(100));
        let typed = "STEP0=W98,DIR0=!top.W99";
        let options = ReadOptions { channels: ChannelMap::channel_names(typed), ..ReadOptions::default() };
        let capture =
            read_with_options(io::Cursor::new(table), &Limits::default(), &options, &mut |_| true).capture;
        assert_eq!((capture.channels.len(), capture.omitted_channels), (64, 36));
        assert_eq!(map_of(&capture, Some(typed)), ("STEP0=top.W98,DIR0=!top.W99".into(), None));
        let (map, error) = map_of(&capture, Some("STEP0=W97"));
        assert!(
            map.is_empty() && error.is_some_and(|error| error.contains("there is no channel W97")),
            "{map}"
        );
    }

    #[test]
    fn notes_name_the_fields_of_the_dialog() {
        let mut capture = Capture::new(Format::LevelsCsv);
        capture.channels.push(Channel { name: "Channel 0".into() });
        capture.timebase = Timebase::new(1, 1_000_000);
        capture.changes = (0..40).map(|k| Change { tick: 10 * k, levels: k % 2 }).collect();
        let options = OpenOptions { map: Some("STEP0=Channel 0".into()), ..OpenOptions::default() };
        let loaded = LoadedCapture::new(capture, &options).expect("steps");
        let notes: Vec<String> = loaded.notes.iter().map(note).collect();
        let expected = "makes 39 steps of it; for such a driver select the signal “STEP, both edges”";
        assert!(notes.iter().any(|note| note.ends_with(expected)), "{notes:?}");
        assert_eq!(
            in_fields(&Remedy::OtherEdge { motor: 1, channel: "#0".into(), inverted: true }),
            "; if the driver steps where it begins, check “Inverted” of STEP1"
        );
    }
}
