//! One row in full: its fields with their bytes, its check, and the times around it.

use super::{Row, words};
use crate::{
    convert::object,
    simulation::{Simulation, config},
};
use serde::Serialize;
use stepscope_core::{
    inspect::dissector::{Check, Meaning, Reading},
    peripheral::{trace::RowOutcome, units::Cycles},
};
use wasm_bindgen::prelude::*;

/// Bit times from the cycle in which a frame is taken to the reply's first start bit (DESIGN A6), and
/// from there back to the rise of DE.
const REPLY_BITS: u64 = 11;
const DE_BITS: u64 = 10;
/// Rows among which the frame of a reply is looked for: those that others sent at the same time.
const NEAR: usize = 64;
/// Bits of a byte on the line.
const BYTE_BITS: u64 = 10;

#[derive(Serialize)]
struct Detail {
    #[serde(flatten)]
    row: Row,
    layout: Vec<FieldRow>,
    /// `none`, `missing`, `holds` or `fails`.
    check: &'static str,
    check_found: Option<String>,
    check_expected: Option<String>,
    /// Where each byte starts on the line, and how long each is, in cycles.
    byte_cycles: Vec<u64>,
    byte_length: u64,
    gap_cycles: Option<u64>,
    /// From the end of the frame that is answered to the rise of DE, and to the first start bit.
    drive_cycles: Option<u64>,
    turnaround_cycles: Option<u64>,
    /// The row that is answered.
    answers: Option<usize>,
}

#[derive(Serialize)]
struct FieldRow {
    name: String,
    /// First byte, and the one after the last.
    from: usize,
    until: usize,
    value: String,
}

#[wasm_bindgen]
impl Simulation {
    /// Row `index` with its fields, its check and the times around it; null where there is none. A row as
    /// in `packets`, and `{layout: [{name, from, until, value}], check, check_found, check_expected,
    /// byte_cycles, byte_length, gap_cycles, drive_cycles, turnaround_cycles, answers}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packet(&self, index: u32) -> Result<JsValue, JsError> {
        let index = index as usize;
        let (Some(row), Some(logged)) = (self.row(index), self.log().rows().get(index)) else {
            return Ok(JsValue::NULL);
        };
        let line = self.line();
        let Some(meaning) = self.meaning(index) else { return Ok(JsValue::NULL) };
        let (check, sums) = match meaning.check {
            Check::None => ("none", None),
            Check::Missing => ("missing", None),
            Check::Compared { found, expected } => {
                (if found == expected { "holds" } else { "fails" }, Some((found, expected)))
            }
        };
        let bytes = self.placed(index);
        let byte_length = bytes.first().map_or(0, |byte| byte.end - byte.start);
        let byte_cycles = bytes.iter().map(|byte| byte.start).collect();
        let answers = self.answered(index);
        let turnaround = answers.map(|frame| logged.start.0.saturating_sub(self.line_end(frame)));
        let bit = line.own.bit().0;
        object(&Detail {
            row,
            layout: meaning
                .fields
                .into_iter()
                .map(|field| FieldRow {
                    name: field.name.into_owned(),
                    from: field.bytes.start,
                    until: field.bytes.end,
                    value: field.value,
                })
                .collect(),
            check,
            check_found: sums.map(|(found, _)| format!("{found:08x}")),
            check_expected: sums.map(|(_, expected)| format!("{expected:08x}")),
            byte_cycles,
            byte_length,
            gap_cycles: self.gap(index),
            drive_cycles: turnaround.map(|cycles| cycles.saturating_sub((REPLY_BITS - DE_BITS) * bit)),
            turnaround_cycles: turnaround,
            answers,
        })
    }

    /// What the bytes of a row mean.
    pub(crate) fn meaning(&self, index: usize) -> Option<Meaning> {
        let verdict = self.log().rows().get(index)?.verdict;
        let line = self.line();
        let reading = Reading {
            protocol: line.own.protocol(),
            addressed: line.own.packet_address().is_some(),
            channels: &|address| line.channels(address),
        };
        Some(reading.of(self.log().bytes(index), verdict))
    }

    /// First cycle after the last byte of a row on the line.
    pub(super) fn line_end(&self, index: usize) -> u64 {
        let Some(row) = self.log().rows().get(index) else { return 0 };
        match row.verdict {
            RowOutcome::Reply(_) | RowOutcome::Collision => row.end.0,
            // Complete with the look at a stop bit, half a bit and nine after the start bit was seen.
            RowOutcome::Packet(_) | RowOutcome::Frame(_) | RowOutcome::Framing => {
                let config = config(&self.experiment, self.looked_at);
                let Cycles(bit) = config.bit();
                let baud = u64::from(self.scenario.line.baud.max(1));
                let length = BYTE_BITS * u64::from(config.clock_hz()) / baud;
                (row.end.0 + length).saturating_sub(bit / 2 + 9 * bit)
            }
            RowOutcome::Short | RowOutcome::Ignored | RowOutcome::Open => {
                self.placed(index).last().map_or(row.end.0, |byte| byte.end)
            }
        }
    }

    /// Cycles between the end of what was on the line before a row and its start; none where they overlap.
    pub(super) fn gap(&self, index: usize) -> Option<u64> {
        let rows = self.log().rows();
        let row = rows.get(index).filter(|row| row.verdict != RowOutcome::Collision)?;
        let is_sent =
            |before: &usize| rows.get(*before).is_some_and(|row| row.verdict != RowOutcome::Collision);
        let before = (0..index).rev().find(is_sent)?;
        row.start.0.checked_sub(self.line_end(before))
    }

    /// The row that a reply answers.
    fn answered(&self, index: usize) -> Option<usize> {
        let rows = self.log().rows();
        let reply = rows.get(index).filter(|row| matches!(row.verdict, RowOutcome::Reply(_)))?;
        let wait = Cycles(REPLY_BITS * self.line().own.bit().0);
        let is_frame = |at: &usize| {
            rows.get(*at)
                .is_some_and(|row| row.end + wait == reply.start && words::mark(row.verdict) != "foreign")
        };
        (index.saturating_sub(NEAR)..index).rev().find(is_frame)
    }
}
