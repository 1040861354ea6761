//! The fields of a packet or frame as spans of the line, each over the bytes that carry it.

use super::{LineDecoder, Span};
use crate::{
    dissector::{Check, Field},
    packet_table::PlacedByte,
};
use alloc::{borrow::ToOwned, format, string::String, vec, vec::Vec};
use stepscope_peripheral::trace::RowOutcome;

/// Bytes of the longest row whose fields are told; a frame has at most 600 before COBS.
const MAX_BYTES: usize = 1024;

impl LineDecoder<'_> {
    /// The fields of a row of the packets.
    pub(super) fn fields_of(&self, packet: usize) -> Vec<Span> {
        let Some(row) = self.packets().rows().get(packet) else { return Vec::new() };
        // No packet and no frame is longer: what is, was ignored or is none.
        if self.packets().bytes(packet).len() > MAX_BYTES {
            return Vec::new();
        }
        let bytes = self.table.placed(packet);
        let Some(meaning) = self.table.meaning(packet) else { return Vec::new() };
        let broken = matches!(meaning.check, Check::Compared { found, expected } if found != expected);
        let span =
            |start, end, texts, bad| Span { start, end, texts, bad, packet: Some(packet), sample: None };
        let mut spans: Vec<Span> = meaning
            .fields
            .iter()
            .filter_map(|field| {
                let carriers: &[PlacedByte] = bytes.get(field.bytes.clone())?;
                let bad = row.outcome == RowOutcome::Ignored
                    || field.name == "reason"
                    || (broken && field.name == "check");
                Some(span(carriers.first()?.start, carriers.last()?.end, texts(field, bad), bad))
            })
            .collect();
        if let (RowOutcome::Short, Some(last)) = (row.outcome, bytes.last()) {
            let texts = vec!["SHORT_PACKET: cut by a gap".into(), "SHORT_PACKET".into(), "!".into()];
            spans.push(span(last.end, row.end.0.max(last.end), texts, true));
        }
        spans
    }
}

/// A field from its longest text to its shortest.
fn texts(Field { name, value, .. }: &Field, bad: bool) -> Vec<String> {
    let mut texts = vec![format!("{name}: {value}"), value.clone()];
    texts.extend(value.split([' ', ',']).next().filter(|first| first.len() < value.len()).map(str::to_owned));
    if bad {
        texts.push("!".into());
    }
    texts
}
