//! Exports a run as files in pieces, so that long runs neither block the worker nor fill its memory.

use crate::{convert::field, scenario::config, view::simulation::Simulation};
use js_sys::{Object, Uint8Array};
use std::{fmt, io, ops::RangeInclusive};
use stepscope_core::inspect::export::tables::{
    SEGMENTS_HEAD, write_edges_head, write_edges_row, write_segment_row, write_tick_row, write_ticks_head,
};
use stepscope_core::inspect::export::vcd::VcdWriter;
use stepscope_core::inspect::{packets::log::LoggedTick, trace::window::TraceWindow};
use stepscope_core::peripheral::{config::Config, signal::Sink, trace::write_record, units::Instant};
use stepscope_core::{scenario::Scenario, sim::scripted};
use wasm_bindgen::prelude::*;

/// Rows per piece: about 1 MB.
const ROWS: usize = 1 << 14;

#[wasm_bindgen]
impl Simulation {
    /// A piece of a file: `{bytes, next, rows}`. `next` is the value of `first_row` for the next piece, null at the end.
    /// `rows` is the number of source rows, for progress. Kinds are `vcd`, `edges`, `trace`, `ticks` and `segments`;
    /// `first_cycle..=last_cycle` limits all but `segments`. Errors: for an unknown controller or kind.
    pub fn file_piece(
        &self,
        kind: &str,
        controller: u32,
        first_cycle: f64,
        last_cycle: f64,
        first_row: u32,
    ) -> Result<Object, JsError> {
        let last = self.run.cycles().0.saturating_sub(1);
        let [first_cycle, last_cycle] =
            [first_cycle, last_cycle].map(|cycle| (cycle.max(0.0) as u64).min(last));
        let (index, first_row) = (controller as usize, first_row as usize);
        let unknown_controller = || JsError::new("the run does not have this controller");
        let stored = &self.recordings.get(index).ok_or_else(unknown_controller)?.stored;
        let config = config(&self.experiment, index);
        let window = TraceWindow::of(&stored.trace, Instant(first_cycle), Instant(last_cycle));
        let (bytes, rows) = match kind {
            "vcd" => (self.vcd(&window, config, last_cycle, first_row)?, window.records()),
            "edges" => (edges(&window, config, first_row)?.into_bytes(), window.records()),
            "trace" => (trace(&window, first_row)?.into_bytes(), window.records()),
            "ticks" => {
                let ticks = stored.packets.ticks();
                (tick_rows(ticks, first_cycle..=last_cycle, config, first_row)?.into_bytes(), ticks.len())
            }
            "segments" => {
                let mut text = String::new();
                let rows = self.segments(&mut text, first_row)?;
                (text.into_bytes(), rows)
            }
            _ => return Err(JsError::new("unknown kind of file")),
        };
        let result = Object::new();
        field(&result, "bytes", &Uint8Array::from(bytes.as_slice()).into());
        let next = first_row + ROWS;
        field(&result, "next", &if next < rows { (next as u32).into() } else { JsValue::NULL });
        field(&result, "rows", &(rows as u32).into());
        Ok(result)
    }

    /// A scenario that replays the sent bytes or the segments. Errors: if they exceed the limits of a scenario.
    pub fn replay_scenario(&self) -> Result<String, JsError> {
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

fn edges(window: &TraceWindow<'_>, config: &Config, first_row: usize) -> Result<String, fmt::Error> {
    let mut text = String::new();
    if first_row == 0 {
        write_edges_head(&mut text, config.channels())?;
    }
    for record in window.iter_from(first_row).take(ROWS) {
        write_edges_row(&mut text, record, config.clock_hz(), config.channels())?;
    }
    Ok(text)
}

fn trace(window: &TraceWindow<'_>, first_row: usize) -> Result<String, fmt::Error> {
    let mut text = String::new();
    window.iter_from(first_row).take(ROWS).try_for_each(|record| write_record(&mut text, record))?;
    Ok(text)
}

/// The ticks that start within `cycles`.
fn tick_rows(
    ticks: &[LoggedTick],
    cycles: RangeInclusive<u64>,
    config: &Config,
    first_row: usize,
) -> Result<String, fmt::Error> {
    let mut text = String::new();
    if first_row == 0 {
        write_ticks_head(&mut text, config.channels())?;
    }
    let piece = ticks.iter().skip(first_row).take(ROWS);
    for tick in piece.filter(|tick| cycles.contains(&tick.start.0)) {
        write_tick_row(&mut text, tick, config.channels())?;
    }
    Ok(text)
}

impl Simulation {
    fn vcd(
        &self,
        window: &TraceWindow<'_>,
        config: &Config,
        last_cycle: u64,
        first_row: usize,
    ) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let (clock_hz, channels) = (config.clock_hz(), config.channels());
        let before = first_row.checked_sub(1).and_then(|index| window.get(index));
        let mut writer = match before {
            None => VcdWriter::new(&mut bytes, clock_hz, channels),
            Some(before) => VcdWriter::resume(&mut bytes, clock_hz, channels, before.levels),
        }?;
        window.iter_from(first_row).take(ROWS).for_each(|record| writer.record(record));
        if first_row + ROWS < window.records() {
            writer.pause()?;
        } else {
            writer.finish((last_cycle + 1).min(self.run.cycles().0))?;
        }
        Ok(bytes)
    }

    /// Writes the segments; returns their number.
    fn segments(&self, text: &mut String, first_row: usize) -> Result<usize, fmt::Error> {
        if first_row == 0 {
            text.push_str(SEGMENTS_HEAD);
        }
        let lists = self.experiment.segments().map(|segments| segments.lists()).unwrap_or_default();
        let all = || {
            lists.iter().enumerate().flat_map(|(channel, list)| {
                list.segments.iter().map(move |segment| (channel, list.start, segment))
            })
        };
        for (channel, start, segment) in all().skip(first_row).take(ROWS) {
            write_segment_row(text, channel, start, segment)?;
        }
        Ok(all().count())
    }
}
