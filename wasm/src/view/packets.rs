//! The packet table, the ticks and the line decoder of the selected controller.

use crate::convert::{field, object};
use crate::view::simulation::Simulation;
use js_sys::{Object, Uint8Array};
use serde::Serialize;
use std::mem::take;
use stepscope_core::inspect::packets::line_decoder::LineDecoder;
use stepscope_core::inspect::packets::packet_table::{Filter, PacketTable, Request, Row};
use stepscope_core::peripheral::units::Instant;
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct Rows<T> {
    rows: Vec<T>,
    more: bool,
}

impl<T> Rows<T> {
    /// Empty if there are more than `limit`.
    fn within(limit: u32, rows: impl Iterator<Item = T>) -> Self {
        let limit = limit as usize;
        let mut rows: Vec<T> = rows.take(limit + 1).collect();
        let more = rows.len() > limit;
        if more {
            rows.clear();
        }
        Self { rows, more }
    }
}

fn cycle(at: f64) -> Instant {
    Instant(at.max(0.0) as u64)
}

#[wasm_bindgen]
impl Simulation {
    /// Sets the filter ([`Request::new`]) for `advance_filter`; returns a note about the text, or an empty one.
    pub fn filter(&mut self, text: &str, kind: &str, address: Option<u8>, mark: &str, only: bool) -> String {
        let (request, note) = Request::new(text, kind, address, mark, only);
        self.filter = Filter::new(request);
        note
    }

    /// Filters up to `count` more rows: `{done, total, shown, matches}`.
    pub fn advance_filter(&mut self, count: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct FilterProgress {
            done: bool,
            total: usize,
            shown: usize,
            matches: usize,
        }
        let mut filter = take(&mut self.filter);
        let done = filter.advance(&self.table(), count as usize);
        let total = self.table().len();
        let progress = FilterProgress { done, total, shown: filter.shown(total), matches: filter.matches() };
        self.filter = filter;
        object(&progress)
    }

    /// The visible rows at positions `from..from + count` (`PacketRows`), with the `rank` of matches; times in `unit`.
    pub fn packets(&self, from: u32, count: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct FilteredRow {
            position: usize,
            rank: Option<usize>,
            #[serde(flatten)]
            row: Row,
        }
        #[derive(Serialize)]
        struct PacketRows {
            total: usize,
            shown: usize,
            matches: usize,
            unit: &'static str,
            rows: Vec<FilteredRow>,
        }
        let table = self.table();
        let filtered_row = |position| {
            let row = table.row(self.filter.row(position)?)?;
            Some(FilteredRow { position, rank: self.filter.rank(position), row })
        };
        object(&PacketRows {
            total: table.len(),
            shown: self.filter.shown(table.len()),
            matches: self.filter.matches(),
            unit: table.scale().unit,
            rows: (from as usize..).take(count as usize).map_while(filtered_row).collect(),
        })
    }

    /// Position of row `index` among the visible rows.
    pub fn packet_position(&self, index: u32) -> Option<u32> {
        self.filter.position(index as usize).map(|position| position as u32)
    }

    /// Position of the next or previous match, with wraparound.
    pub fn next_match(&self, position: Option<u32>, forward: bool) -> Option<u32> {
        self.filter.next_match(position.map(|at| at as usize), forward).map(|at| at as u32)
    }

    /// All addresses and kinds: `{addresses, kinds}`.
    pub fn packet_choices(&self) -> Result<JsValue, JsError> {
        object(&self.table().choices())
    }

    /// Row `index` with its fields, CRC and times; null without one.
    pub fn packet(&self, index: u32) -> Result<JsValue, JsError> {
        object(&self.table().detail(index as usize))
    }

    /// Raised fault flags in the order of their bits: `[{name, times, cycle, row}]`, with their first cycle and row.
    pub fn first_faults(&self) -> Result<JsValue, JsError> {
        object(&self.table().first_faults())
    }

    /// Rows on the line in a range of cycles: `{rows, more}`; empty if there are more than `limit` rows.
    pub fn packets_in(&self, start_cycle: f64, end_cycle: f64, limit: u32) -> Result<JsValue, JsError> {
        let table = self.table();
        let touching = table.touching(cycle(start_cycle), cycle(end_cycle));
        let Rows { rows, more } = Rows::within(limit, touching);
        object(&Rows { rows: rows.into_iter().filter_map(|index| table.row(index)).collect(), more })
    }

    /// Ticks in a range of cycles: `{rows: [{start_cycle, end_cycle, row, fields}], more}`; empty if there are more than `limit` rows.
    pub fn ticks_in(&self, start_cycle: f64, end_cycle: f64, limit: u32) -> Result<JsValue, JsError> {
        object(&Rows::within(limit, self.table().ticks_touching(cycle(start_cycle), cycle(end_cycle))))
    }

    /// Decoded bytes in a range of cycles, for at most `max_bytes` bytes, with bits for at most `max_bits` bytes.
    pub fn decoded(
        &self,
        start_cycle: f64,
        end_cycle: f64,
        max_bytes: u32,
        max_bits: u32,
    ) -> Result<JsValue, JsError> {
        let decoder = LineDecoder::new(self.table(), &self.selected().stored.trace);
        let (start, end) = (cycle(start_cycle), cycle(end_cycle));
        object(&decoder.decode(start.0, end.0, max_bytes as usize, max_bits as usize))
    }

    /// A part of a packet file: `{part, rows, next}`. `format` is `csv`, `hex` (one row per line) or `bin`. It has up to
    /// `count` rows from position `from`; `next` is undefined at the end. `shown`: only visible rows; with cycles, only rows
    /// on the line between them.
    pub fn packet_file(
        &self,
        format: &str,
        shown: bool,
        from: u32,
        count: u32,
        start_cycle: Option<f64>,
        end_cycle: Option<f64>,
    ) -> Result<Object, JsError> {
        let table = self.table();
        let total = if shown { self.filter.shown(table.len()) } else { table.len() };
        let until = total.min((from as usize).saturating_add(count as usize));
        let (start, end) = (cycle(start_cycle.unwrap_or(0.0)), end_cycle.map_or(Instant::NEVER, cycle));
        let (mut text, mut bytes) = (String::new(), Vec::new());
        if format == "csv" && from == 0 {
            PacketTable::write_head(&mut text)?;
        }
        for position in from as usize..until {
            let Some(index) = (if shown { self.filter.row(position) } else { Some(position) }) else { break };
            if !table.is_on_line(index, start, end) {
                continue;
            }
            match format {
                "bin" => bytes.extend_from_slice(table.bytes(index)),
                "hex" => {
                    table.write_hex(index, &mut text);
                    text.push('\n');
                }
                _ => table.write_row(&mut text, index)?,
            }
        }
        let file = Object::new();
        let part = if format == "bin" { Uint8Array::from(bytes.as_slice()).into() } else { text.into() };
        field(&file, "part", &part);
        field(&file, "rows", &total.into());
        field(&file, "next", &if until < total { until.into() } else { JsValue::UNDEFINED });
        Ok(file)
    }
}

impl Simulation {
    fn table(&self) -> PacketTable<'_> {
        PacketTable::new(&self.experiment, &self.run, self.selected, &self.selected().stored.packets)
    }
}
