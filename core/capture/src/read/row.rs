//! Reads a row of hexadecimal bytes, which may be followed by the same bytes as text.
//!
//! ```text
//! 44 45 41 44 42 45 45 46  43 41 46 45  |DEADBEEFCAFE|        55aa 0102 8361  U....a        44 45 >DE<
//! ```
//!
//! The text is never read as bytes. A row whose text does not match its bytes is refused.

use super::recorder::quoted;

/// Maximum row in which a text without marks is searched, in bytes: every gap is tried.
const MAX_TEXT_ROW: usize = 4096;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct RowFormat {
    pub(super) group: usize,
    /// Whether the text confirms the order of bytes within groups.
    pub(super) is_order_known: bool,
    pub(super) has_text: bool,
}

pub(super) fn parse(row: &[u8], bytes: &mut Vec<u8>) -> Result<RowFormat, String> {
    let row = row.trim_ascii();
    let start = bytes.len();
    for (end, text) in text_candidates(row) {
        bytes.truncate(start);
        let Some(group) = row.get(..end).and_then(|head| parse_groups(head, bytes).ok()) else { continue };
        let found = bytes.get(start..).unwrap_or_default();
        if found.is_empty() || !text.matches(found) {
            continue;
        }
        let is_order_known = text.confirms_order(found, group);
        return Ok(RowFormat { group, is_order_known, has_text: true });
    }
    bytes.truncate(start);
    let has_gap = row.windows(2).any(|pair| pair == b"  ");
    match parse_groups(row, bytes) {
        // After pairs, the text begins at a wide gap.
        Ok(group) if group > 1 && has_gap => {
            bytes.truncate(start);
            Err(format!(
                "the text of {} does not match its bytes; use a dump of single bytes in order (hexdump -C, xxd -g1)",
                quoted(row)
            ))
        }
        Ok(group) => Ok(RowFormat { group, ..RowFormat::default() }),
        Err(message) => {
            bytes.truncate(start);
            Err(message)
        }
    }
}

struct Text<'r> {
    text: &'r [u8],
    is_marked: bool,
}

/// Possible texts after the bytes of a row, each with the end of the bytes.
fn text_candidates(row: &[u8]) -> impl Iterator<Item = (usize, Text<'_>)> {
    let marked = |open: u8, close: u8, min_gap: usize| {
        let body = row.strip_suffix(&[close])?;
        let at = (min_gap..body.len()).find(|at| {
            body.get(*at) == Some(&open)
                && body.get(at - min_gap..*at).is_some_and(|gap| gap.iter().all(|byte| *byte == b' '))
        })?;
        Some((at - min_gap, Text { text: body.get(at + 1..)?, is_marked: true }))
    };
    let marked = [marked(b'|', b'|', 1), marked(b'>', b'<', 2)].into_iter().flatten();
    let is_blank = |at: usize| row.get(at).is_some_and(|byte| matches!(byte, b' ' | b'\t'));
    let gap = move |at: &usize| {
        is_blank(*at) && !is_blank(at.wrapping_sub(1)) && (is_blank(at + 1) || row.get(*at) == Some(&b'\t'))
    };
    let searched = if row.len() > MAX_TEXT_ROW { 0 } else { row.len() };
    let gaps = (1..searched).filter(gap);
    marked.chain(gaps.filter_map(|at| Some((at, Text { text: row.get(at..)?, is_marked: false }))))
}

impl Text<'_> {
    /// Blanks at its end may be missing.
    fn letters(&self, bytes: &[u8]) -> Option<Vec<char>> {
        let all: Vec<char> = String::from_utf8_lossy(self.text).chars().collect();
        let last_blanks = bytes.iter().rev().take_while(|byte| **byte == b' ').count();
        (0..=last_blanks).find_map(|missing| {
            let count = bytes.len() - missing;
            let (before, letters) = all.split_at_checked(all.len().checked_sub(count)?)?;
            let is_gap = if self.is_marked {
                before.is_empty()
            } else {
                !before.is_empty() && before.iter().all(|letter| letter.is_whitespace())
            };
            let fits = || letters.iter().zip(bytes).all(|(letter, byte)| is_letter(*letter, *byte));
            (is_gap && count > 0 && fits()).then(|| letters.to_vec())
        })
    }

    fn matches(&self, bytes: &[u8]) -> bool {
        self.letters(bytes).is_some()
    }

    /// Whether the reversed bytes of a group would not fit.
    fn confirms_order(&self, bytes: &[u8], group: usize) -> bool {
        let Some(letters) = self.letters(bytes).filter(|_| group > 1) else { return false };
        bytes.chunks(group).zip(letters.chunks(group)).any(|(bytes, letters)| {
            bytes.len() == letters.len()
                && bytes.iter().rev().zip(letters).any(|(byte, letter)| !is_letter(*letter, *byte))
        })
    }
}

fn is_letter(letter: char, byte: u8) -> bool {
    match byte {
        0x21..=0x7e => letter == char::from(byte),
        b' ' => matches!(letter, ' ' | '.' | '_'),
        // Most programs print a point; with another character set it may be any character.
        _ => !letter.is_ascii_alphanumeric(),
    }
}

/// Reads `55 AA`, `0x55,0xAA`, `44-45`, `55aa 0102`; returns the number of bytes per group.
fn parse_groups(text: &[u8], bytes: &mut Vec<u8>) -> Result<usize, String> {
    let words = text.split(|byte| byte.is_ascii_whitespace() || matches!(byte, b',' | b';' | b'-'));
    let (mut group, mut is_over) = (0, false);
    for word in words.filter(|word| !word.is_empty()) {
        let (digits, is_marked) = match [&b"0x"[..], b"0X"].iter().find_map(|mark| word.strip_prefix(*mark)) {
            Some(digits) => (digits, true),
            None => (word, false),
        };
        let is_single = is_marked && digits.len() == 1;
        if digits.is_empty()
            || !digits.len().is_multiple_of(2) && !is_single
            || !digits.iter().all(u8::is_ascii_hexdigit)
        {
            return Err(not_a_byte(word));
        }
        // All groups have one length; the last may be shorter.
        let count = digits.len().div_ceil(2);
        if is_over || group != 0 && count > group {
            return Err(format!(
                "{} and the numbers before it differ in length; use only bytes of equal length, without times, offsets or text",
                quoted(word)
            ));
        }
        is_over = group != 0 && count < group;
        group = group.max(count);
        push_digits(digits, bytes);
    }
    Ok(group)
}

pub(super) fn push_digits(digits: &[u8], bytes: &mut Vec<u8>) {
    let digit = |digit: &u8| char::from(*digit).to_digit(16).unwrap_or(0) as u8;
    bytes.extend(digits.chunks(2).map(|pair| pair.iter().fold(0, |value, next| value << 4 | digit(next))));
}

pub(super) fn not_a_byte(word: &[u8]) -> String {
    format!("{} is not a byte; use two hexadecimal digits per byte, such as 55 AA 0x01", quoted(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_read_and_their_text_is_not() {
        for (row, expected) in [
            ("44 45 41 44 42 45 45 46  43 41  |DEADBEEFCA|", "44454144424545464341 1 text"),
            ("44 45 0a  >DE.<", "44450a 1 text"),
            ("7c 20 7c  || ||", "7c207c 1 text"),
            ("6162 6364 6566 3031                      abcdef01", "6162636465663031 2 text proven"),
            ("62 65 65 66                  beef", "62656566 1 text"),
            ("62 65 20 20     be", "62652020 1 text"),
            ("20 41      A", "2041 1 text"),
            ("55aa 01\tU..", "55aa01 2 text proven"),
            ("0000 0000  ....", "00000000 2 text"),
            ("44 45 41 44-42 45", "444541444245 1"),
            ("0x55, 0xAA", "55aa 1"),
            ("FF FF  01", "ffff01 1"),
            ("55AA0102", "55aa0102 4"),
            ("62 65 65 66   bee0", "no"),
            ("1041,AA 55", "no"),
            ("1041 AA BB", "no"),
            ("55 AA hello", "no"),
            ("042504 042101", "042504042101 3"),
            ("4544 4441  DEAD", "no"),
            ("104 105", "no"),
        ] {
            let mut bytes = vec![0xee];
            let shape = parse(row.as_bytes(), &mut bytes);
            let text: String = bytes[1..].iter().map(|byte| format!("{byte:02x}")).collect();
            let found = shape.map_or_else(
                |_| "no".into(),
                |RowFormat { group, is_order_known, has_text }| {
                    let [proven, said] = [(is_order_known, " proven"), (has_text, " text")]
                        .map(|(is, word)| if is { word } else { "" });
                    format!("{text} {group}{said}{proven}")
                },
            );
            assert_eq!(found, expected, "{row}");
            assert!(bytes.len() > 1 || found == "no");
        }
    }
}
