//! Which kind of file it is, by its first bytes: by what only one kind begins with, then by the names of a table's columns,
//! and last by whether all of the first lines can be read as one kind.

use super::{
    decimal::Decimal,
    fields::{Fields, separator},
    hex, positions,
    recorder::quoted,
    saleae, sigrok, stepscope,
    times::TimeUnit,
};
use crate::capture::Format;

/// What can be read.
pub(super) const UNKNOWN: &str = "no kind of file that can be read here; give a value change dump (.vcd), a session or \
    a table of sigrok or PulseView (.sr, .csv), a table of levels or of bytes of Saleae Logic (.csv), a trace or a table \
    of edges of Stepscope, bytes in hexadecimal, or a table of times and positions";

/// Bytes from which on a file may go on behind its head, which may have lost a mark of three bytes.
const FULL: usize = (1 << 16) - 3;
/// Lines that are looked at.
const MAX_LINES: usize = 200;

/// The kind of the file that begins with `head`.
pub(super) fn detect(head: &[u8]) -> Result<Format, String> {
    if head.trim_ascii().is_empty() {
        return Err("the file is empty; record or export again".into());
    }
    if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
        return Ok(Format::SigrokSession);
    }
    if let Some(what) = binary(head) {
        return Err(what.into());
    }
    // The last line, or the last word of a line that is as long as this, may be cut off.
    let cut = head
        .iter()
        .rposition(|byte| *byte == b'\n')
        .or_else(|| head.iter().rposition(u8::is_ascii_whitespace));
    let text = cut.filter(|_| head.len() >= FULL).and_then(|end| head.get(..end)).unwrap_or(head);
    let lines: Vec<&[u8]> = text
        .split(|byte| *byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .filter(|line| !line.is_empty() && !line.starts_with(b"META "))
        .take(MAX_LINES)
        .collect();
    let Some(first) = lines.first() else { return Ok(Format::SigrokCsv) };
    if first.starts_with(b"$") {
        return Ok(Format::Vcd);
    }
    if lines.iter().take(5).any(|line| line.windows(9).any(|word| word == b"libsigrok"))
        || first.starts_with(b";") && sigrok::is_comment(first)
    {
        return Ok(Format::SigrokCsv);
    }
    by_head(first, lines.get(1..).unwrap_or_default())
        .or_else(|| by_rows(&lines))
        .ok_or_else(|| format!("{}: {UNKNOWN}", quoted(first)))
}

/// What is to be done with files that are no text.
fn binary(head: &[u8]) -> Option<&'static str> {
    if head.starts_with(b"\x1f\x8b") {
        return Some("the file is compressed (gzip); uncompress it: gunzip");
    }
    if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
        return Some("the text is UTF-16; save it as UTF-8");
    }
    if head.starts_with(b"<SALEAE>") {
        return Some("a binary export of Saleae Logic; export as CSV");
    }
    // A header block of 329 bytes, or all of it packed by gzip.
    if head.starts_with(b"\0\0\0\0\0\0\0\x01\x49") || head.first() == Some(&0xfe) {
        return Some(
            "a waveform of GTKWave (FST); make a value change dump of it: fst2vcd -f file.fst -o file.vcd",
        );
    }
    head.contains(&0).then_some(UNKNOWN)
}

/// The kind of a table by the names of its columns, and by its first rows where a name may stand for either: an encoder
/// has lines and a position.
fn by_head(line: &[u8], rows: &[&[u8]]) -> Option<Format> {
    let mut fields = Fields::new();
    let separator = separator(line);
    fields.split(line, separator).ok()?;
    let names = fields.names();
    if names.iter().any(|name| name == "logic") || names.first().is_some_and(|name| name == "samples") {
        return Some(Format::SigrokCsv);
    }
    if saleae::is_head(&names) {
        return Some(Format::SaleaeBytes);
    }
    let unit = TimeUnit::of_column(names.first()?)?;
    if hex::head(line).is_some() {
        return Some(Format::HexBytes);
    }
    names.get(1)?;
    let is_level = |field: &[u8]| matches!(field.trim_ascii(), b"0" | b"1" | b"X");
    let levels = rows.iter().all(|row| row.split(|byte| *byte == separator).skip(1).all(is_level));
    let named = names.iter().skip(1).any(|name| name.to_lowercase().starts_with("pos"));
    if named || !levels && names.get(1).is_some_and(|name| positions::is_position(name)) {
        return Some(Format::PositionsCsv);
    }
    Some(if unit == TimeUnit::Cycles { Format::EdgesCsv } else { Format::SaleaeCsv })
}

/// The kind of a file without a head, by its first lines.
fn by_rows(lines: &[&[u8]]) -> Option<Format> {
    if lines.iter().all(|line| is_sample(line)) {
        return Some(Format::SigrokCsv);
    }
    if is_trace(lines) {
        return Some(Format::Trace);
    }
    if is_positions(lines) {
        return Some(Format::PositionsCsv);
    }
    let mut said = lines.iter().map(|line| hex::without_comment(line)).filter(|line| !line.is_empty());
    let first = said.next()?;
    if hex::is_line(first) {
        return Some(Format::HexBytes);
    }
    // Labels of sigrok without comments: names, and then samples.
    let (_, rows) = lines.split_first()?;
    (!rows.is_empty() && rows.iter().all(|line| is_sample(line))).then_some(Format::SigrokCsv)
}

/// A row of levels only, each one digit: `0,1,1`.
fn is_sample(line: &[u8]) -> bool {
    let mut digits = line.iter().step_by(2);
    let mut marks = line.iter().skip(1).step_by(2);
    let first = line.get(1);
    !line.len().is_multiple_of(2)
        && digits.all(|digit| matches!(digit, b'0' | b'1'))
        && marks.all(|mark| Some(mark) == first && b",;\t|: ".contains(mark))
}

/// Cycles that rise and levels, without zeros before them, and of which one has more than two digits, as no byte has.
fn is_trace(lines: &[&[u8]]) -> bool {
    let records: Vec<(u64, u64)> = lines.iter().map_while(|line| stepscope::record(line)).collect();
    let plain =
        |line: &&[u8]| line.split(|byte| *byte == b' ').all(|word| word == b"0" || !word.starts_with(b"0"));
    let rise = match records.as_slice() {
        [] => false,
        [(first, _), (second, _), ..] => first < second,
        [_] => true,
    };
    rise && lines.first().is_some_and(plain) && records.iter().any(|(_, levels)| *levels > 0xff)
}

/// Two numbers a line of which the first rises, and that are not two bytes a line.
fn is_positions(lines: &[&[u8]]) -> bool {
    let lines: Vec<&[u8]> = lines.iter().filter(|line| !line.starts_with(b"#")).copied().collect();
    let rows: Option<Vec<(Decimal, Decimal)>> = lines.iter().map(|line| positions::row(line)).collect();
    let Some(rows) = rows else { return false };
    let places = rows.iter().map(|(time, _)| time.places).max().unwrap_or(0);
    let times: Option<Vec<i128>> =
        rows.iter().map(|(time, _)| time.with_places(places).map(|time| time.mantissa)).collect();
    let rise = times
        .is_some_and(|times| times.windows(2).all(|pair| matches!(pair, [before, after] if before < after)));
    let bytes = lines.iter().all(|line| hex::is_line(line));
    rise && rows.len() > 1 && (!bytes || lines.iter().any(|line| line.contains(&b'.')))
        || rise && rows.len() == 1 && !bytes
}
