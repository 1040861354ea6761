//! One row in full: fields, CRC, and times.

use super::{Mark, PacketTable, Row};
use crate::packets::dissector::{BitGroup, CrcCheck, Field};
use alloc::{format, string::String, vec::Vec};
use serde::Serialize;
use stepscope_peripheral::units::Cycles;

/// Bit times from the end of a frame to the reply's start bit.
const REPLY_BITS: u64 = 11;
const DE_BITS: u64 = 10;
/// Maximum rows between a reply and its frame.
const NEAR: usize = 64;

/// A row with its fields, CRC and times, for the inspector.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Detail {
    #[serde(flatten)]
    pub row: Row,
    pub layout: Vec<FieldRow>,
    /// The CRC: `none`, `missing`, `holds` or `fails`.
    pub check: &'static str,
    pub check_found: Option<String>,
    pub check_expected: Option<String>,
    pub byte_cycles: Vec<u64>,
    pub byte_length: u64,
    pub gap_cycles: Option<u64>,
    /// From the end of the frame to the rise of DE; `None` for recorded replies.
    pub drive_cycles: Option<u64>,
    pub turnaround_cycles: Option<u64>,
    pub answers: Option<usize>,
}

/// A field; its bytes are `from..until`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FieldRow {
    pub name: String,
    pub from: usize,
    pub until: usize,
    pub value: String,
    pub bits: Vec<BitGroup>,
}

impl PacketTable<'_> {
    pub fn detail(&self, index: usize) -> Option<Detail> {
        let (row, dissection) = (self.row(index)?, self.dissect(index)?);
        let (check, sums) = match dissection.crc {
            CrcCheck::None => ("none", None),
            CrcCheck::Missing => ("missing", None),
            CrcCheck::Compared { found, expected } => {
                (if found == expected { "holds" } else { "fails" }, Some((found, expected)))
            }
        };
        let bytes = self.line_bytes(index);
        let answers = self.answered(index);
        let turnaround = answers.map(|frame| row.start_cycle.saturating_sub(self.line_end(frame)));
        let Cycles(bit) = self.config.bit();
        let field = |field: Field| FieldRow {
            name: field.name.into_owned(),
            from: field.bytes.start,
            until: field.bytes.end,
            value: field.value,
            bits: field.bits,
        };
        Some(Detail {
            layout: dissection.fields.into_iter().map(field).collect(),
            check,
            check_found: sums.map(|(found, _)| format!("{found:08x}")),
            check_expected: sums.map(|(_, expected)| format!("{expected:08x}")),
            byte_cycles: bytes.iter().map(|byte| byte.start).collect(),
            byte_length: bytes.first().map_or(0, |byte| byte.end - byte.start),
            gap_cycles: self.gap(index),
            drive_cycles: turnaround
                .filter(|_| !self.log.has_recorded_replies())
                .map(|cycles| cycles.saturating_sub((REPLY_BITS - DE_BITS) * bit)),
            turnaround_cycles: turnaround,
            answers,
            row,
        })
    }

    /// The frame of a reply. A recorded reply belongs to the last frame before it.
    pub(super) fn answered(&self, index: usize) -> Option<usize> {
        let reply = self.logged(index).filter(|_| self.is_own_reply(index))?;
        let wait = Cycles(REPLY_BITS * self.config.bit().0);
        let is_frame = |at: &usize| {
            self.logged(*at).is_some_and(|row| {
                let is_before = if self.log.has_recorded_replies() {
                    !self.is_own_reply(*at) && row.end <= reply.start
                } else {
                    row.end + wait == reply.start
                };
                is_before && Mark::of(row.outcome) != Mark::OtherAddress
            })
        };
        (index.saturating_sub(NEAR)..index).rev().find(is_frame)
    }
}
