//! Splits a table's line into fields, quoted as in RFC 4180, and trims them.

use super::{decimal::Decimal, recorder::quoted};
use csv_core::{ReadRecordResult, Reader, ReaderBuilder};

const MAX_FIELDS: usize = 1024;
pub(super) const SEPARATORS: [u8; 4] = *b",;\t|";

pub(super) struct Fields {
    /// Reused: building it takes longer than splitting a line.
    reader: Option<(u8, Box<Reader>)>,
    text: Vec<u8>,
    ends: Vec<usize>,
    count: usize,
}

impl Fields {
    pub(super) const fn new() -> Self {
        Self { reader: None, text: Vec::new(), ends: Vec::new(), count: 0 }
    }

    pub(super) fn split(&mut self, line: &[u8], separator: u8) -> Result<(), String> {
        self.count = 0;
        if separator == b' ' {
            return self.split_blanks(line);
        }
        self.text.resize(line.len() + 2, 0);
        self.ends.resize(MAX_FIELDS, 0);
        if self.reader.as_ref().is_none_or(|(built, _)| *built != separator) {
            self.reader = Some((separator, Box::new(ReaderBuilder::new().delimiter(separator).build())));
        }
        let Some((_, reader)) = &mut self.reader else { return Ok(()) };
        reader.reset();
        let (mut result, _, written, mut count) = reader.read_record(line, &mut self.text, &mut self.ends);
        // The line has no newline, which completes the record.
        if matches!(result, ReadRecordResult::InputEmpty) {
            let text = self.text.get_mut(written..).unwrap_or_default();
            let ends = self.ends.get_mut(count..).unwrap_or_default();
            let (last, _, _, more) = reader.read_record(b"\n", text, ends);
            (result, count) = (last, count + more);
        }
        match result {
            ReadRecordResult::Record => {
                self.count = count;
                Ok(())
            }
            ReadRecordResult::OutputEndsFull => {
                Err(format!("more than {MAX_FIELDS} columns; export fewer channels"))
            }
            ReadRecordResult::InputEmpty if !line.is_empty() => {
                Err("a quotation mark is not closed in this line; add the missing one".into())
            }
            // An empty line has no fields, and `text` holds the whole line.
            ReadRecordResult::InputEmpty | ReadRecordResult::End | ReadRecordResult::OutputFull => Ok(()),
        }
    }

    fn split_blanks(&mut self, line: &[u8]) -> Result<(), String> {
        self.text.clear();
        self.ends.clear();
        for field in fields(line, b' ') {
            self.text.extend_from_slice(field);
            self.ends.push(self.text.len());
        }
        self.count = self.ends.len();
        if self.count > MAX_FIELDS {
            Err(format!("more than {MAX_FIELDS} columns; export fewer channels"))
        } else {
            Ok(())
        }
    }

    pub(super) const fn len(&self) -> usize {
        self.count
    }

    /// Empty if there is no such field.
    pub(super) fn get(&self, at: usize) -> &[u8] {
        if at >= self.count {
            return &[];
        }
        let start = at.checked_sub(1).map_or(Some(&0), |before| self.ends.get(before));
        let range = start.zip(self.ends.get(at)).map(|(start, end)| *start..*end);
        range.and_then(|range| self.text.get(range)).unwrap_or_default().trim_ascii()
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &[u8]> {
        (0..self.count).map(|at| self.get(at))
    }

    pub(super) fn names(&self) -> Vec<String> {
        self.iter().map(|name| String::from_utf8_lossy(name).into_owned()).collect()
    }
}

/// The first separator of a line outside quotation marks. A comma that is only in numbers between other separators is a
/// decimal comma.
pub(super) fn separator(line: &[u8]) -> u8 {
    let first = first_unquoted(line, |byte| SEPARATORS.contains(&byte));
    let found = match first {
        Some(b',') => first_unquoted(line, |byte| byte != b',' && SEPARATORS.contains(&byte))
            .filter(|other| has_decimal_commas(line, *other))
            .or(first),
        _ => first,
    };
    found.unwrap_or(if line.trim_ascii().contains(&b' ') { b' ' } else { b',' })
}

fn first_unquoted(line: &[u8], is: impl Fn(u8) -> bool) -> Option<u8> {
    let mut is_quoted = false;
    line.iter().copied().find(|&byte| {
        is_quoted ^= byte == b'"';
        !is_quoted && is(byte)
    })
}

fn has_decimal_commas(line: &[u8], separator: u8) -> bool {
    fields(line, separator).all(|field| !field.contains(&b',') || Decimal::parse_with_comma(field).is_some())
}

/// Does not handle quotation marks; blanks separate in any number.
pub(super) fn fields(line: &[u8], separator: u8) -> impl Iterator<Item = &[u8]> {
    let is_field = move |field: &&[u8]| separator != b' ' || !field.is_empty();
    line.split(move |byte| *byte == separator).map(<[u8]>::trim_ascii).filter(is_field)
}

pub(super) fn not_a_level(name: &str, field: &[u8]) -> String {
    if matches!(field, b"right" | b"left") {
        return format!(
            "{name} is {}: a table of step times, not of levels; use it with stepscope tables --steps",
            quoted(field)
        );
    }
    let analog = Decimal::parse(field).is_some_and(|value| value.places > 0 || value.mantissa.abs() > 1);
    format!(
        "{} is {}, not 0 or 1; {}",
        if name.is_empty() { "a level" } else { name },
        quoted(field),
        if analog {
            "export digital channels only, or convert analog channels to 0 and 1 by a threshold"
        } else {
            "export digital channels only"
        }
    )
}
