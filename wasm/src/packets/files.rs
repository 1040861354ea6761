//! Rows of packets as files: a table, or their bytes.

use super::words;
use crate::{convert::field, simulation::Simulation};
use js_sys::{Object, Uint8Array};
use std::fmt::Write as _;
use stepscope_core::inspect::tables::Quoted;
use wasm_bindgen::prelude::*;

const COLUMNS: &str = "number,kind,start_s,end_s,gap_s,bytes,meaning,outcome,tick_start_s,tick_end_s\r\n";

#[wasm_bindgen]
impl Simulation {
    /// A part of a file of packets: `{part, next}`. `format` is `csv`, `hex` (a line of text a row) or `bin`
    /// (the bytes alone); the part is a text, of `bin` bytes. It holds up to `count` rows from position
    /// `from` on, `next` is where to go on, undefined at the end. With `shown` only rows on show, with two
    /// cycles only rows whose time on the line touches what lies between.
    #[must_use]
    pub fn packet_file(
        &self,
        format: &str,
        shown: bool,
        from: u32,
        count: u32,
        start_cycle: Option<f64>,
        end_cycle: Option<f64>,
    ) -> Object {
        let rows = self.log().rows();
        let total = if shown { self.filter.shown(rows.len()) } else { rows.len() };
        let until = total.min((from as usize).saturating_add(count as usize));
        let (start, end) = (start_cycle.unwrap_or(0.0) as u64, end_cycle.map_or(u64::MAX, |end| end as u64));
        let (mut text, mut bytes) = (String::new(), Vec::new());
        if format == "csv" && from == 0 {
            text.push_str(COLUMNS);
        }
        for position in from as usize..until {
            let Some(index) = (if shown { self.filter.row(position) } else { Some(position) }) else { break };
            if rows.get(index).is_none_or(|row| row.start.0 > end || self.line_end(index) < start) {
                continue;
            }
            match format {
                "bin" => bytes.extend_from_slice(self.log().bytes(index)),
                "hex" => {
                    words::hex(self.log().bytes(index), &mut text);
                    text.push('\n');
                }
                _ => self.table_row(index, &mut text),
            }
        }
        let file = Object::new();
        let part = if format == "bin" { Uint8Array::from(bytes.as_slice()).into() } else { text.into() };
        field(&file, "part", &part);
        field(&file, "rows", &total.into());
        field(&file, "next", &if until < total { until.into() } else { JsValue::UNDEFINED });
        file
    }

    fn table_row(&self, index: usize, text: &mut String) {
        let (Some(row), Some(logged)) = (self.row(index), self.log().rows().get(index)) else { return };
        let clock_hz = f64::from(self.experiment.config().clock_hz());
        let seconds = |cycles: Option<u64>| {
            cycles.map_or_else(String::new, |cycles| (cycles as f64 / clock_hz).to_string())
        };
        let _ = write!(
            text,
            "{index},{},{},{},{},{},",
            row.kind,
            seconds(Some(row.start_cycle)),
            seconds(Some(row.line_end_cycle)),
            seconds(self.gap(index)),
            row.hex
        );
        let _ = write!(
            text,
            "{},{},{},{}\r\n",
            Quoted(&row.fields),
            Quoted(&row.outcome),
            seconds(logged.tick_start.map(|at| at.0)),
            seconds(row.tick_end_cycle)
        );
    }
}
