//! The packet table, the ticks and the line's decoder of the controller that is selected, as JavaScript values.

use crate::{
    convert::{field, object},
    view::simulation::Simulation,
};
use js_sys::{Object, Uint8Array};
use serde::Serialize;
use std::mem::take;
use stepscope_core::{
    inspect::packets::{
        line_decoder::LineDecoder,
        packet_table::{Filter, PacketTable, Request, Row},
    },
    peripheral::units::Instant,
};
use wasm_bindgen::prelude::*;

#[derive(Serialize)]
struct Rows<T> {
    rows: Vec<T>,
    more: bool,
}

impl<T> Rows<T> {
    /// None of them where there are more than `limit`.
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
    /// What the table shows from now on ([`Request::new`]); nothing is judged before `filter_on`. What has to be said of
    /// the text comes back, empty for nothing.
    pub fn filter(&mut self, text: &str, kind: &str, address: Option<u8>, mark: &str, only: bool) -> String {
        let (request, note) = Request::new(text, kind, address, mark, only);
        self.filter = Filter::new(request);
        note
    }

    /// Judges up to `count` more rows: `{done, total, shown, matches}`, the numbers of all rows, of those on
    /// show and of those that the text finds, so far.
    ///
    /// # Errors
    /// Never in practice.
    pub fn filter_on(&mut self, count: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Judged {
            done: bool,
            total: usize,
            shown: usize,
            matches: usize,
        }
        let mut filter = take(&mut self.filter);
        let done = filter.advance(&self.table(), count as usize);
        let total = self.table().len();
        let judged = Judged { done, total, shown: filter.shown(total), matches: filter.matches() };
        self.filter = filter;
        object(&judged)
    }

    /// The rows on show at positions `from..from + count`: `{total, shown, matches, unit, rows}`, a row
    /// with its `position` and, where the text finds it, its `rank` among the matches. Times are in `unit`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packets(&self, from: u32, count: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Placed {
            position: usize,
            rank: Option<usize>,
            #[serde(flatten)]
            row: Row,
        }
        #[derive(Serialize)]
        struct Page {
            total: usize,
            shown: usize,
            matches: usize,
            unit: &'static str,
            rows: Vec<Placed>,
        }
        let table = self.table();
        let placed = |position| {
            let row = table.row(self.filter.row(position)?)?;
            Some(Placed { position, rank: self.filter.rank(position), row })
        };
        object(&Page {
            total: table.len(),
            shown: self.filter.shown(table.len()),
            matches: self.filter.matches(),
            unit: table.scale().unit,
            rows: (from as usize..).take(count as usize).map_while(placed).collect(),
        })
    }

    /// Where row `index` stands among those on show, if it is one of them.
    #[must_use]
    pub fn packet_position(&self, index: u32) -> Option<u32> {
        self.filter.position(index as usize).map(|position| position as u32)
    }

    /// Position of the next row after a position, or of the last before it, that the text finds; past the
    /// end it goes on at the beginning.
    #[must_use]
    pub fn next_match(&self, position: Option<u32>, forward: bool) -> Option<u32> {
        self.filter.next_match(position.map(|at| at as usize), forward).map(|at| at as u32)
    }

    /// What there is to choose from: `{addresses, kinds}`, rising, each of them on some row.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packet_choices(&self) -> Result<JsValue, JsError> {
        object(&self.table().choices())
    }

    /// Row `index` with its fields, its check and the times around it; null where there is none. A row as
    /// in `packets`, and `{layout: [{name, from, until, value}], check, check_found, check_expected,
    /// byte_cycles, byte_length, gap_cycles, drive_cycles, turnaround_cycles, answers}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packet(&self, index: u32) -> Result<JsValue, JsError> {
        object(&self.table().detail(index as usize))
    }

    /// The fault flags that were raised, in the order of their bits: `[{name, times, cycle, row}]`, with the cycle and the
    /// row (null where none did) that raised it first.
    ///
    /// # Errors
    /// Never in practice.
    pub fn fault_places(&self) -> Result<JsValue, JsError> {
        object(&self.table().fault_places())
    }

    /// The rows whose time on the line touches a stretch of cycles, none of them where there are more than `limit`:
    /// `{rows, more}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packets_in(&self, start_cycle: f64, end_cycle: f64, limit: u32) -> Result<JsValue, JsError> {
        let table = self.table();
        let touching = table.touching(cycle(start_cycle), cycle(end_cycle));
        let Rows { rows, more } = Rows::within(limit, touching);
        object(&Rows { rows: rows.into_iter().filter_map(|index| table.row(index)).collect(), more })
    }

    /// The ticks that touch a stretch of cycles, none of them where there are more than `limit`, each with the row that brought it:
    /// `{rows: [{start_cycle, end_cycle, row, fields}], more}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn ticks_in(&self, start_cycle: f64, end_cycle: f64, limit: u32) -> Result<JsValue, JsError> {
        object(&Rows::within(limit, self.table().ticks_touching(cycle(start_cycle), cycle(end_cycle))))
    }

    /// What is on the line in a stretch of cycles, unless that is more than `most_bytes` bytes; their bits only
    /// where there are at most `most_bits` bytes: `{rx: {bits, bytes, fields}, tx: {…}, more}`, each of spans
    /// `{start, end, texts, bad, packet, sample}` in cycles.
    ///
    /// # Errors
    /// Never in practice.
    pub fn decoded(
        &self,
        start_cycle: f64,
        end_cycle: f64,
        most_bytes: u32,
        most_bits: u32,
    ) -> Result<JsValue, JsError> {
        let decoder = LineDecoder::new(self.table(), &self.selected().recording.trace);
        let (start, end) = (cycle(start_cycle), cycle(end_cycle));
        object(&decoder.decode(start.0, end.0, most_bytes as usize, most_bits as usize))
    }

    /// A part of a file of packets: `{part, rows, next}`. `format` is `csv` (the table that the command writes), `hex` (a
    /// line of text a row) or `bin` (the bytes alone); the part is a text, of `bin` bytes. It holds up to `count` rows
    /// from position `from` on, `next` is where to go on, undefined at the end. With `shown` only rows on show, with two
    /// cycles only rows whose time on the line touches what lies between.
    ///
    /// # Errors
    /// Never in practice.
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
        PacketTable::new(&self.experiment, &self.run, self.selected, &self.selected().recording.packets)
    }
}
