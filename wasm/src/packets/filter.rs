//! Which rows of packets the table shows, and which of them a search finds. Judged in slices, so that
//! a million rows freeze nothing; the rows' indices stay here.

use super::words::{self, Line, Scale};
use stepscope_core::peripheral::trace::{PacketLog, RowOutcome};

/// Rows on show, and matches of the search among them.
#[derive(Default)]
pub(crate) struct Filter {
    /// What is asked for; without it all rows are shown.
    asked: Option<Asked>,
    /// Rows on show, rising.
    shown: Vec<u32>,
    /// Positions among the rows on show that the search finds, rising.
    matches: Vec<u32>,
    /// The row that is judged next.
    next: usize,
}

/// What is asked for.
pub(super) struct Asked {
    pub(super) needle: Option<Needle>,
    /// `packet`, `frame`, `reply`, `collision`, a kind of DESIGN A6 or `NAK`; empty for any.
    pub(super) kind: String,
    pub(super) address: Option<u8>,
    /// As [`words::mark`]; empty for any.
    pub(super) mark: String,
    /// Whether rows that the search does not find are left out.
    pub(super) only: bool,
}

/// What is searched for.
pub(super) struct Needle {
    /// In small letters; with a hyphen also with a minus sign.
    words: Vec<String>,
    /// Bytes that it spells in hex.
    bytes: Vec<u8>,
    number: Option<usize>,
    /// `#12`: nothing but the number.
    only_number: bool,
}

impl Needle {
    /// Reads what was typed; none for nothing. Beside it what has to be said of it, if anything.
    pub(super) fn parse(typed: &str) -> (Option<Self>, String) {
        let text = typed.trim().to_ascii_lowercase();
        if text.is_empty() {
            return (None, String::new());
        }
        let (number, only_number) = match text.strip_prefix('#') {
            Some(rest) => (rest.trim().parse().ok(), true),
            None => (text.parse().ok(), false),
        };
        let (bytes, note) = if only_number { Default::default() } else { spelled(&text) };
        let mut words = vec![text.clone()];
        if text.contains('-') {
            words.push(text.replace('-', "\u{2212}"));
        }
        let note = match (only_number, number) {
            (true, None) => {
                format!("\u{201c}{}\u{201d} is no number of a row; give one, such as #12.", typed.trim())
            }
            _ => note,
        };
        (Some(Self { words, bytes, number, only_number }), note)
    }

    fn finds(&self, line: Line<'_>, scale: Scale, log: &PacketLog, index: usize, text: &mut String) -> bool {
        if self.number == Some(index) || self.only_number {
            return self.number == Some(index);
        }
        let Some(row) = log.rows().get(index) else { return false };
        let bytes = log.bytes(index);
        if !self.bytes.is_empty() && bytes.windows(self.bytes.len()).any(|part| part == self.bytes) {
            return true;
        }
        text.clear();
        text.push_str(line.kind(bytes, row.verdict));
        text.push('\n');
        line.fields(bytes, row.verdict, text);
        text.push('\n');
        text.push_str(&words::outcome(row.verdict));
        text.push('\n');
        scale.print(row.start.0, text);
        text.make_ascii_lowercase();
        self.words.iter().any(|word| text.contains(word))
    }
}

/// Bytes that a text spells in hex: `81 05`, `8105`, `0x81 0x05`. What is meant as hex and is none is said.
fn spelled(text: &str) -> (Vec<u8>, String) {
    let meant = text.starts_with("0x");
    let parts = text.split([' ', ',']).filter(|part| !part.is_empty());
    let parts: Vec<&str> = parts.map(|part| part.strip_prefix("0x").unwrap_or(part)).collect();
    let digits = |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_hexdigit());
    if !parts.iter().all(digits) {
        let note = format!("\u{201c}{text}\u{201d} is no hex: give two digits a byte, such as 81 05.");
        return (Vec::new(), if meant { note } else { String::new() });
    }
    if parts.iter().any(|part| part.len() % 2 != 0) {
        // A plain number is looked for among the numbers.
        let plain = parts.len() == 1 && !meant && text.bytes().all(|byte| byte.is_ascii_digit());
        let word = parts.len() == 1 && !meant && text.bytes().all(|byte| byte.is_ascii_alphabetic());
        let note =
            format!("\u{201c}{text}\u{201d} ends within a byte: give two hex digits a byte, such as 81 05.");
        return (Vec::new(), if plain || word { String::new() } else { note });
    }
    let pair = |pair: &[u8]| std::str::from_utf8(pair).ok().and_then(|two| u8::from_str_radix(two, 16).ok());
    (parts.iter().flat_map(|part| part.as_bytes().chunks(2).filter_map(pair)).collect(), String::new())
}

impl Asked {
    fn keeps(&self, line: Line<'_>, bytes: &[u8], verdict: RowOutcome) -> bool {
        let kind = match self.kind.as_str() {
            "" => true,
            "packet" | "frame" | "reply" | "collision" => self.kind == line.kind(bytes, verdict),
            name => words::head(bytes, verdict).is_some_and(|(_, kind)| words::name_of(kind) == Some(name)),
        };
        kind && (self.mark.is_empty() || self.mark == words::mark(verdict))
            && (self.address.is_none() || self.address == line.address(bytes, verdict))
    }
}

impl Filter {
    /// Asks for other rows; nothing is judged yet.
    pub(super) fn ask(&mut self, asked: Option<Asked>) {
        *self = Self { asked, ..Self::default() };
    }

    /// Judges up to `count` more rows; true if that was all of them.
    pub(super) fn go_on(&mut self, line: Line<'_>, scale: Scale, log: &PacketLog, count: usize) -> bool {
        let total = log.rows().len();
        let Some(asked) = &self.asked else {
            self.next = total;
            return true;
        };
        let mut text = String::new();
        let until = total.min(self.next.saturating_add(count));
        for index in self.next..until {
            let Some(row) = log.rows().get(index) else { break };
            if !asked.keeps(line, log.bytes(index), row.verdict) {
                continue;
            }
            let found =
                asked.needle.as_ref().is_some_and(|needle| needle.finds(line, scale, log, index, &mut text));
            if found {
                self.matches.push(self.shown.len() as u32);
            }
            if found || !asked.only || asked.needle.is_none() {
                self.shown.push(index as u32);
            }
        }
        self.next = until;
        until == total
    }

    /// How many of `total` rows are on show.
    pub(super) fn shown(&self, total: usize) -> usize {
        if self.asked.is_some() { self.shown.len() } else { total }
    }

    pub(super) fn matches(&self) -> usize {
        self.matches.len()
    }

    /// The row at a position among those on show.
    pub(super) fn row(&self, position: usize) -> Option<usize> {
        if self.asked.is_none() {
            return Some(position);
        }
        self.shown.get(position).map(|&row| row as usize)
    }

    /// Where a row stands among those on show, if it is one of them.
    pub(super) fn position(&self, row: usize) -> Option<usize> {
        if self.asked.is_none() {
            return Some(row);
        }
        self.shown.binary_search(&(row as u32)).ok()
    }

    /// Which of the matches the row at a position is, 0 the first.
    pub(super) fn rank(&self, position: usize) -> Option<usize> {
        self.matches.binary_search(&(position as u32)).ok()
    }

    /// Position of the next match after a position, or of the one before it; past the last comes the first.
    pub(super) fn next_match(&self, position: Option<usize>, forward: bool) -> Option<usize> {
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
    fn hex_is_read_with_and_without_spaces_and_what_is_none_is_said() {
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
        for (typed, bytes, said) in rows {
            let (needle, note) = Needle::parse(typed);
            let needle = needle.map(|needle| needle.bytes);
            assert_eq!((needle.as_deref(), !note.is_empty()), (Some(bytes), said), "{typed}: {note}");
        }
        assert!(Needle::parse("  ").0.is_none());
        assert!(!Needle::parse("#x").1.is_empty());
    }

    #[test]
    fn matches_go_round_in_both_directions() {
        let asked =
            Asked { needle: None, kind: String::new(), address: None, mark: String::new(), only: false };
        let filter = Filter { asked: Some(asked), shown: vec![2, 4, 6, 8], matches: vec![1, 3], next: 9 };
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
