//! Filters and searches the packet table in slices, so that a million rows do not block the caller.

use super::{Mark, PacketTable, RowKind, format};
use crate::packets::dissector::FrameHead;
use alloc::{borrow::ToOwned, format, string::String, vec, vec::Vec};

/// The result of a filter and search so far.
#[derive(Debug, Default)]
pub struct Filter {
    request: Option<Request>,
    shown: Vec<u32>,
    /// Positions in `shown` of rows that the search found.
    matches: Vec<u32>,
    next: usize,
}

/// Search text and filters of the packet table.
#[derive(Debug, Default)]
pub struct Request {
    needle: Option<Needle>,
    /// A [`RowKind::name`], a kind of frame or `NAK`; empty for any.
    kind: String,
    address: Option<u8>,
    mark: String,
    /// Whether rows without a match are hidden.
    only: bool,
}

impl Request {
    /// An empty text, kind or mark matches every row. The text is searched in bytes, words and row numbers; `only` hides
    /// rows without a match. Also returns what is wrong with the text, or an empty note.
    pub fn new(text: &str, kind: &str, address: Option<u8>, mark: &str, only: bool) -> (Self, String) {
        let (needle, note) = Needle::parse(text);
        (Self { needle, kind: kind.to_owned(), address, mark: mark.to_owned(), only }, note)
    }

    fn is_any(&self) -> bool {
        self.needle.is_none() && self.kind.is_empty() && self.address.is_none() && self.mark.is_empty()
    }

    fn accepts(&self, table: &PacketTable<'_>, index: usize) -> bool {
        let Some(row) = table.logged(index) else { return false };
        let kind = match self.kind.as_str() {
            "" => true,
            "packet" | "frame" | "reply" | "collision" => {
                table.kind(index).map(RowKind::name) == Some(self.kind.as_str())
            }
            name => table.head(index).and_then(FrameHead::name) == Some(name),
        };
        kind && (self.mark.is_empty() || self.mark == Mark::of(row.outcome).name())
            && (self.address.is_none() || self.address == table.address(index))
    }
}

#[derive(Debug)]
struct Needle {
    /// In lowercase; with a hyphen also with a minus sign.
    words: Vec<String>,
    bytes: Vec<u8>,
    number: Option<usize>,
    /// `#12`: only the number.
    only_number: bool,
}

impl Needle {
    fn parse(typed: &str) -> (Option<Self>, String) {
        let text = typed.trim().to_ascii_lowercase();
        if text.is_empty() {
            return (None, String::new());
        }
        let (number, only_number) = match text.strip_prefix('#') {
            Some(rest) => (rest.trim().parse().ok(), true),
            None => (text.parse().ok(), false),
        };
        let (bytes, note) = if only_number { Default::default() } else { parse_hex(&text) };
        let mut words = vec![text.clone()];
        if text.contains('-') {
            words.push(text.replace('-', "\u{2212}"));
        }
        let note = match (only_number, number) {
            (true, None) => {
                format!("\u{201c}{}\u{201d} is not a row number; use one such as #12.", typed.trim())
            }
            _ => note,
        };
        (Some(Self { words, bytes, number, only_number }), note)
    }

    fn matches(&self, table: &PacketTable<'_>, index: usize, text: &mut String) -> bool {
        if self.number == Some(index) || self.only_number {
            return self.number == Some(index);
        }
        let Some(row) = table.logged(index) else { return false };
        let bytes = table.bytes(index);
        if !self.bytes.is_empty() && bytes.windows(self.bytes.len()).any(|part| part == self.bytes) {
            return true;
        }
        text.clear();
        text.push_str(table.kind(index).map_or("", RowKind::name));
        text.push('\n');
        table.write_summary(index, text);
        text.push('\n');
        text.push_str(&format::outcome(row.outcome));
        text.push('\n');
        table.scale().write(row.start.0, text);
        text.make_ascii_lowercase();
        self.words.iter().any(|word| text.contains(word))
    }
}

/// The bytes of a text in hexadecimal: `81 05`, `8105`, `0x81 0x05`; reports invalid hex.
fn parse_hex(text: &str) -> (Vec<u8>, String) {
    let is_marked = text.starts_with("0x");
    let parts = text.split([' ', ',']).filter(|part| !part.is_empty());
    let parts: Vec<&str> = parts.map(|part| part.strip_prefix("0x").unwrap_or(part)).collect();
    let digits = |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_hexdigit());
    if !parts.iter().all(digits) {
        let note =
            format!("\u{201c}{text}\u{201d} is not hexadecimal; use two digits per byte, such as 81 05.");
        return (Vec::new(), if is_marked { note } else { String::new() });
    }
    if parts.iter().any(|part| part.len() % 2 != 0) {
        // A plain number is a row number, a plain word is a text.
        let plain = parts.len() == 1 && !is_marked && text.bytes().all(|byte| byte.is_ascii_digit());
        let word = parts.len() == 1 && !is_marked && text.bytes().all(|byte| byte.is_ascii_alphabetic());
        let note = format!(
            "\u{201c}{text}\u{201d} ends within a byte; use two hexadecimal digits per byte, such as 81 05."
        );
        return (Vec::new(), if plain || word { String::new() } else { note });
    }
    let pair = |pair: &[u8]| core::str::from_utf8(pair).ok().and_then(|two| u8::from_str_radix(two, 16).ok());
    (parts.iter().flat_map(|part| part.as_bytes().chunks(2).filter_map(pair)).collect(), String::new())
}

impl Filter {
    pub fn new(request: Request) -> Self {
        Self { request: Some(request).filter(|request| !request.is_any()), ..Self::default() }
    }

    /// Filters up to `count` more rows; true when done.
    pub fn advance(&mut self, table: &PacketTable<'_>, count: usize) -> bool {
        let total = table.len();
        let Some(request) = &self.request else {
            self.next = total;
            return true;
        };
        let mut text = String::new();
        let until = total.min(self.next.saturating_add(count));
        for index in self.next..until {
            if !request.accepts(table, index) {
                continue;
            }
            let found = request.needle.as_ref().is_some_and(|needle| needle.matches(table, index, &mut text));
            if found {
                self.matches.push(self.shown.len() as u32);
            }
            if found || !request.only || request.needle.is_none() {
                self.shown.push(index as u32);
            }
        }
        self.next = until;
        until == total
    }

    /// Number of rows shown, of `total`.
    pub fn shown(&self, total: usize) -> usize {
        if self.request.is_some() { self.shown.len() } else { total }
    }

    /// Number of rows that the search found.
    pub fn matches(&self) -> usize {
        self.matches.len()
    }

    /// The row at a position of the filtered table.
    pub fn row(&self, position: usize) -> Option<usize> {
        if self.request.is_none() {
            return Some(position);
        }
        self.shown.get(position).map(|&row| row as usize)
    }

    /// The position of a row, if it is shown.
    pub fn position(&self, row: usize) -> Option<usize> {
        if self.request.is_none() {
            return Some(row);
        }
        self.shown.binary_search(&(row as u32)).ok()
    }

    /// The number of the match at a position, from 0.
    pub fn rank(&self, position: usize) -> Option<usize> {
        self.matches.binary_search(&(position as u32)).ok()
    }

    /// Position of the next or previous match, wrapping around.
    pub fn next_match(&self, position: Option<usize>, forward: bool) -> Option<usize> {
        let found = match (position, forward) {
            (Some(at), true) => {
                let after = self.matches.partition_point(|&found| found as usize <= at);
                self.matches.get(after).or(self.matches.first())
            }
            (Some(at), false) => {
                let before = self.matches.partition_point(|&found| (found as usize) < at).checked_sub(1);
                before.and_then(|last| self.matches.get(last)).or(self.matches.last())
            }
            (None, true) => self.matches.first(),
            (None, false) => self.matches.last(),
        };
        found.map(|&position| position as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_is_read_with_and_without_spaces_and_invalid_text_is_reported() {
        let rows: [(&str, &[u8], bool); 11] = [
            ("81 05", &[0x81, 5], false),
            ("8105", &[0x81, 5], false),
            ("0x81 0x05", &[0x81, 5], false),
            ("81,05", &[0x81, 5], false),
            ("17", &[0x17], false),
            ("128", &[], false),
            ("8 1", &[], true),
            ("81a", &[], true),
            ("0x1g", &[], true),
            ("dec", &[], false),
            ("ticks seq", &[], false),
        ];
        for (typed, bytes, has_note) in rows {
            let (needle, note) = Needle::parse(typed);
            let needle = needle.map(|needle| needle.bytes);
            assert_eq!((needle.as_deref(), !note.is_empty()), (Some(bytes), has_note), "{typed}: {note}");
        }
        assert!(Needle::parse("  ").0.is_none());
        assert!(!Needle::parse("#x").1.is_empty());
    }

    #[test]
    fn matches_wrap_around_in_both_directions() {
        let request = Request { mark: "bad".to_owned(), ..Request::default() };
        let filter =
            Filter { request: Some(request), shown: [2, 4, 6, 8].into(), matches: [1, 3].into(), next: 9 };
        let rows = [
            (None, true, 1),
            (None, false, 3),
            (Some(0), true, 1),
            (Some(1), true, 3),
            (Some(3), true, 1),
            (Some(3), false, 1),
            (Some(1), false, 3),
        ];
        for (from, forward, expected) in rows {
            assert_eq!(filter.next_match(from, forward), Some(expected), "{from:?} {forward}");
        }
        assert_eq!((filter.row(1), filter.position(4), filter.position(5)), (Some(4), Some(1), None));
        assert_eq!((filter.rank(3), filter.rank(2)), (Some(1), None));
    }
}
