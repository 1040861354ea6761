//! Exports a run as files in pieces, so that long runs neither block the worker nor fill its memory.

use crate::{convert::field, scenario::config, view::simulation::Simulation};
use js_sys::{Object, Uint8Array};
use std::{fmt, io};
use stepscope_core::inspect::export::tables::{
    SEGMENTS_HEAD, write_edges_head, write_edges_row, write_segment_row, write_tick_row, write_ticks_head,
};
use stepscope_core::inspect::export::vcd::VcdWriter;
use stepscope_core::inspect::trace::window::TraceWindow;
use stepscope_core::peripheral::{config::Config, signal::Sink, trace::write_record, units::Instant};
use stepscope_core::{scenario::Scenario, sim::scripted};
use wasm_bindgen::prelude::*;

/// Rows per piece: about 1 MB.
const ROWS: usize = 1 << 14;

#[wasm_bindgen]
impl Simulation {
    /// A piece of a file for cycles `start..=end`: `{bytes, next, rows}`. `next` is the value of `from` for the next piece,
    /// null at the end; `rows` counts the whole file. Kinds are `vcd`, `edges`, `trace`, `ticks` and `segments`.
    ///
    /// # Errors
    /// For an unknown controller or kind.
    pub fn file_piece(
        &self,
        kind: &str,
        controller: u32,
        start: f64,
        end: f64,
        from: u32,
    ) -> Result<Object, JsError> {
        let last = self.run.cycles().0.saturating_sub(1);
        let (start, end) = ((start.max(0.0) as u64).min(last), (end.max(0.0) as u64).min(last));
        let index = controller as usize;
        let none = || JsError::new("the run does not have this controller");
        let recording = &self.recordings.get(index).ok_or_else(none)?.recording;
        let config = config(&self.experiment, index);
        let from = from as usize;
        let mut text = String::new();
        let (bytes, rows) = match kind {
            "vcd" => {
                let window = TraceWindow::of(&recording.trace, Instant(start), Instant(end));
                (self.vcd(&window, config, end, from)?, window.records())
            }
            "edges" | "trace" => {
                let window = TraceWindow::of(&recording.trace, Instant(start), Instant(end));
                if kind == "edges" && from == 0 {
                    write_edges_head(&mut text, config.channels())?;
                }
                for record in window.iter_from(from).take(ROWS) {
                    if kind == "edges" {
                        write_edges_row(&mut text, record, config.clock_hz(), config.channels())?;
                    } else {
                        write_record(&mut text, record)?;
                    }
                }
                (text.into_bytes(), window.records())
            }
            "ticks" => {
                let ticks = recording.packets.ticks();
                if from == 0 {
                    write_ticks_head(&mut text, config.channels())?;
                }
                let piece = ticks.iter().skip(from).take(ROWS);
                for tick in piece.filter(|tick| (start..=end).contains(&tick.start.0)) {
                    write_tick_row(&mut text, tick, config.channels())?;
                }
                (text.into_bytes(), ticks.len())
            }
            "segments" => {
                let rows = self.segments(&mut text, from)?;
                (text.into_bytes(), rows)
            }
            _ => return Err(JsError::new("unknown kind of file")),
        };
        let result = Object::new();
        field(&result, "bytes", &Uint8Array::from(bytes.as_slice()).into());
        let next = from + ROWS;
        field(&result, "next", &if next < rows { (next as u32).into() } else { JsValue::NULL });
        field(&result, "rows", &(rows as u32).into());
        Ok(result)
    }

    /// The sent bytes, or the segments, as a scenario.
    ///
    /// # Errors
    /// If that exceeds a scenario.
    pub fn line_script(&self) -> Result<String, JsError> {
        let scripted = scripted(Scenario::clone(&self.scenario), &self.experiment, &self.run);
        if let Err(problems) = scripted.check() {
            let lines: Vec<String> = problems.iter().map(ToString::to_string).collect();
            return Err(JsError::new(&lines.join("; ")));
        }
        scripted.to_file_json().ok_or_else(|| {
            JsError::new("the scenario would be too long to open; shorten the run length or the motion")
        })
    }
}

impl Simulation {
    fn vcd(&self, window: &TraceWindow<'_>, config: &Config, end: u64, from: usize) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let (clock_hz, channels) = (config.clock_hz(), config.channels());
        let before = from.checked_sub(1).and_then(|index| window.get(index));
        let mut writer = match before {
            None => VcdWriter::new(&mut bytes, clock_hz, channels),
            Some(before) => VcdWriter::resume(&mut bytes, clock_hz, channels, before.levels),
        }?;
        window.iter_from(from).take(ROWS).for_each(|record| writer.record(record));
        if from + ROWS < window.records() {
            writer.pause()?;
        } else {
            writer.finish((end + 1).min(self.run.cycles().0))?;
        }
        Ok(bytes)
    }

    /// Writes the segments; returns their number.
    fn segments(&self, text: &mut String, from: usize) -> Result<usize, fmt::Error> {
        if from == 0 {
            text.push_str(SEGMENTS_HEAD);
        }
        let lists = self.experiment.segments().map(|segments| segments.lists()).unwrap_or_default();
        let all = || {
            lists.iter().enumerate().flat_map(|(channel, list)| {
                list.segments.iter().map(move |segment| (channel, list.start, segment))
            })
        };
        for (channel, start, segment) in all().skip(from).take(ROWS) {
            write_segment_row(text, channel, start, segment)?;
        }
        Ok(all().count())
    }
}
