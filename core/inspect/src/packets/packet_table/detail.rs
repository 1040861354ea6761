//! One row in full: its fields with their bytes, its check, and the times around it.

use super::{Mark, PacketTable, Row};
use crate::packets::dissector::Check;
use alloc::{format, string::String, vec::Vec};
use serde::Serialize;
use stepscope_peripheral::units::Cycles;

/// Bit times from the cycle in which a frame is taken to the reply's first start bit (DESIGN A6), and
/// from there back to the rise of DE.
const REPLY_BITS: u64 = 11;
const DE_BITS: u64 = 10;
/// Rows among which the frame of a reply is looked for: those that others sent at the same time.
const NEAR: usize = 64;

/// A row in full.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Detail {
    /// As the table has it.
    #[serde(flatten)]
    pub row: Row,
    /// Its fields.
    pub layout: Vec<FieldRow>,
    /// `none`, `missing`, `holds` or `fails`.
    pub check: &'static str,
    /// The check that came, in hex.
    pub check_found: Option<String>,
    /// The check of what came before it.
    pub check_expected: Option<String>,
    /// Where each byte starts on the line.
    pub byte_cycles: Vec<u64>,
    /// How long each is, in cycles.
    pub byte_length: u64,
    /// Cycles since the end of what was on the line before.
    pub gap_cycles: Option<u64>,
    /// From the end of the frame that is answered to the rise of DE; not of a recorded reply.
    pub drive_cycles: Option<u64>,
    /// From there to the first start bit.
    pub turnaround_cycles: Option<u64>,
    /// The row that is answered.
    pub answers: Option<usize>,
}

/// A field and its bytes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FieldRow {
    /// What it is called.
    pub name: String,
    /// First byte.
    pub from: usize,
    /// The byte after the last.
    pub until: usize,
    /// What stands there.
    pub value: String,
}

impl PacketTable<'_> {
    /// Row `index` in full; `None` past the last.
    #[must_use]
    pub fn detail(&self, index: usize) -> Option<Detail> {
        let (row, meaning) = (self.row(index)?, self.meaning(index)?);
        let (check, sums) = match meaning.check {
            Check::None => ("none", None),
            Check::Missing => ("missing", None),
            Check::Compared { found, expected } => {
                (if found == expected { "holds" } else { "fails" }, Some((found, expected)))
            }
        };
        let bytes = self.placed(index);
        let answers = self.answered(index);
        let turnaround = answers.map(|frame| row.start_cycle.saturating_sub(self.line_end(frame)));
        let Cycles(bit) = self.own.bit();
        let field = |field: crate::packets::dissector::Field| FieldRow {
            name: field.name.into_owned(),
            from: field.bytes.start,
            until: field.bytes.end,
            value: field.value,
        };
        Some(Detail {
            layout: meaning.fields.into_iter().map(field).collect(),
            check,
            check_found: sums.map(|(found, _)| format!("{found:08x}")),
            check_expected: sums.map(|(_, expected)| format!("{expected:08x}")),
            byte_cycles: bytes.iter().map(|byte| byte.start).collect(),
            byte_length: bytes.first().map_or(0, |byte| byte.end - byte.start),
            gap_cycles: self.gap(index),
            drive_cycles: turnaround
                .filter(|_| !self.log.is_answered())
                .map(|cycles| cycles.saturating_sub((REPLY_BITS - DE_BITS) * bit)),
            turnaround_cycles: turnaround,
            answers,
            row,
        })
    }

    /// The row that a reply of this controller answers: the frame whose end it waited for; of a recorded one, which comes when
    /// the device was ready, the last frame before it.
    pub(super) fn answered(&self, index: usize) -> Option<usize> {
        let reply = self.logged(index).filter(|_| self.is_own_reply(index))?;
        let wait = Cycles(REPLY_BITS * self.own.bit().0);
        let is_frame = |at: &usize| {
            self.logged(*at).is_some_and(|row| {
                let is_before = if self.log.is_answered() {
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
