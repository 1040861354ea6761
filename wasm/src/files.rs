//! A run as files, in pieces: so ten million edges neither stop the worker nor fill its memory.
//!
//! A piece is asked for by where it begins. Nothing is kept between two pieces, so leaving off is nothing
//! but not asking for the next one.

use crate::{
    convert::field,
    simulation::{Simulation, config},
};
use js_sys::{Object, Uint8Array};
use std::{fmt::Write, io};
use stepscope_core::{
    inspect::{
        tables::{write_edges_head, write_edges_row},
        vcd::VcdWriter,
    },
    peripheral::{
        config::Config,
        segment::Segment,
        signal::{Levels, Record, Sink},
        trace::write_record,
        units::Instant,
        wire::packet::ChannelCommand,
    },
    scenario::Scenario,
    sim::scripted,
};
use wasm_bindgen::prelude::*;

/// Rows of a piece: about a megabyte.
const ROWS: usize = 1 << 14;

/// A stretch of a run as its records: the first is the one at the stretch's own start.
struct AnalysisWindow<'a> {
    first: Record,
    rest: &'a [Record],
}

impl<'a> AnalysisWindow<'a> {
    /// Both ends belong to it.
    fn of(trace: &'a [Record], start: u64, end: u64) -> Self {
        let after = trace.partition_point(|record| record.cycle.0 <= start);
        let until = trace.partition_point(|record| record.cycle.0 <= end).max(after);
        let levels = after.checked_sub(1).and_then(|at| trace.get(at)).map_or(Levels::RESET, |r| r.levels);
        let first = Record { cycle: Instant(start), levels };
        Self { first, rest: trace.get(after..until).unwrap_or_default() }
    }

    const fn rows(&self) -> usize {
        1 + self.rest.len()
    }

    fn row(&self, index: usize) -> Option<Record> {
        match index.checked_sub(1) {
            None => Some(self.first),
            Some(index) => self.rest.get(index).copied(),
        }
    }

    fn piece(&self, from: usize) -> impl Iterator<Item = Record> {
        (from..).map_while(|index| self.row(index)).take(ROWS)
    }
}

#[wasm_bindgen]
impl Simulation {
    /// A piece of a file of controller `controller`, from cycle `start` to cycle `end`, both in it: `{bytes,
    /// next, rows}`, `next` what to give for `from` (first 0) to get the piece after it, null at the end;
    /// `rows` are those of the whole file. Kinds are `vcd`, `edges`, `trace`, `ticks` and
    /// `segments` (the lists of the whole run).
    ///
    /// # Errors
    /// If there is no such controller or kind.
    pub fn file_piece(
        &self,
        kind: &str,
        controller: u32,
        start: f64,
        end: f64,
        from: u32,
    ) -> Result<Object, JsError> {
        // Nothing of a file lies behind the run.
        let last = self.run.cycles().0.saturating_sub(1);
        let (start, end) = ((start.max(0.0) as u64).min(last), (end.max(0.0) as u64).min(last));
        let index = controller as usize;
        let none = || JsError::new("there is no such controller");
        let recording = &self.recordings.get(index).ok_or_else(none)?.recording;
        let config = config(&self.experiment, index);
        let from = from as usize;
        let mut text = String::new();
        let (bytes, rows) = match kind {
            "vcd" => {
                let stretch = AnalysisWindow::of(&recording.trace, start, end);
                (self.vcd(&stretch, config, end, from)?, stretch.rows())
            }
            "edges" | "trace" => {
                let stretch = AnalysisWindow::of(&recording.trace, start, end);
                if kind == "edges" && from == 0 {
                    write_edges_head(&mut text, config.channels())?;
                }
                for record in stretch.piece(from) {
                    if kind == "edges" {
                        write_edges_row(&mut text, record, config.clock_hz(), config.channels())?;
                    } else {
                        write_record(&mut text, record)?;
                    }
                }
                (text.into_bytes(), stretch.rows())
            }
            "ticks" => (self.ticks(&mut text, index, (start, end), from)?, recording.packets.ticks().len()),
            "segments" => {
                let rows = self.segments(&mut text, from)?;
                (text.into_bytes(), rows)
            }
            _ => return Err(JsError::new("there is no such kind of file")),
        };
        let result = Object::new();
        field(&result, "bytes", &Uint8Array::from(bytes.as_slice()).into());
        let next = from + ROWS;
        field(&result, "next", &if next < rows { (next as u32).into() } else { JsValue::NULL });
        field(&result, "rows", &(rows as u32).into());
        Ok(result)
    }

    /// What was done to the line, or the lists of segments, as a scenario of its own.
    ///
    /// # Errors
    /// If there is more of it than a scenario may hold.
    pub fn line_script(&self) -> Result<String, JsError> {
        let scripted = scripted(Scenario::clone(&self.scenario), &self.experiment, &self.run);
        if let Err(problems) = scripted.check() {
            let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
            return Err(JsError::new(&lines.join("; ")));
        }
        Ok(scripted.to_json())
    }
}

impl Simulation {
    fn vcd(
        &self,
        stretch: &AnalysisWindow<'_>,
        config: &Config,
        end: u64,
        from: usize,
    ) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let (clock_hz, channels) = (config.clock_hz(), config.channels());
        let before = from.checked_sub(1).and_then(|index| stretch.row(index));
        let mut writer = match before {
            None => VcdWriter::new(&mut bytes, clock_hz, channels),
            Some(before) => VcdWriter::resume(&mut bytes, clock_hz, channels, before.levels),
        }?;
        stretch.piece(from).for_each(|record| writer.record(record));
        if from + ROWS < stretch.rows() {
            writer.pause()?;
        } else {
            writer.finish((end + 1).min(self.run.cycles().0))?;
        }
        Ok(bytes)
    }

    /// The ticks that began in a stretch: when, the packet's row, and the steps of each channel.
    fn ticks(
        &self,
        text: &mut String,
        controller: usize,
        (start, end): (u64, u64),
        from: usize,
    ) -> Result<Vec<u8>, std::fmt::Error> {
        let channels = usize::from(config(&self.experiment, controller).channels());
        if from == 0 {
            text.push_str("start_cycle,packet");
            (0..channels).try_for_each(|channel| write!(text, ",steps{channel}"))?;
            text.push('\n');
        }
        let ticks = self
            .recordings
            .get(controller)
            .map(|recorded| recorded.recording.packets.ticks())
            .unwrap_or_default();
        for tick in ticks.iter().skip(from).take(ROWS).filter(|tick| (start..=end).contains(&tick.start.0)) {
            write!(text, "{},", tick.start.0)?;
            if let Some(row) = tick.row {
                write!(text, "{row}")?;
            }
            for &byte in tick.orders.iter().take(channels) {
                let ChannelCommand { right, steps } = ChannelCommand::parse(byte);
                write!(text, ",{}{steps}", if right || steps == 0 { "" } else { "-" })?;
            }
            text.push('\n');
        }
        Ok(core::mem::take(text).into_bytes())
    }

    /// The segments that run the scenario; gives how many there are.
    fn segments(&self, text: &mut String, from: usize) -> Result<usize, std::fmt::Error> {
        if from == 0 {
            text.push_str("channel,start_cycle,kind,count,interval_q16,add_q16,dir,length_q16\n");
        }
        let lists = self.experiment.segments().map(|segments| segments.lists()).unwrap_or_default();
        let all = || {
            lists.iter().enumerate().flat_map(|(channel, list)| {
                list.segments.iter().map(move |segment| (channel, list.start, segment))
            })
        };
        for (channel, start, segment) in all().skip(from).take(ROWS) {
            write!(text, "{channel},{},", start.0)?;
            match segment {
                Segment::Steps { count, interval, add, right } => {
                    writeln!(text, "steps,{count},{interval},{add},{},", u8::from(*right))?;
                }
                Segment::Dwell(length) => writeln!(text, "dwell,,,,,{length}")?,
            }
        }
        Ok(all().count())
    }
}
