//! Detects a file's format by signatures, then by a table's column names, then by trying to read the first lines.

use super::fields::{Fields, fields, separator};
use super::levels::{Layout, column_names, is_comment};
use super::{
    annotations, base::Base, decimal::Decimal, dump, hex, hex_table, klipper, log_line, nearest, positions,
    recorder::quoted, saleae, sigrok, stepscope, times::TimeUnit,
};
use crate::capture::Format;
use crate::names::{Kind, Meaning};

macro_rules! formats {
    () => {
        "use a value change dump (.vcd), a session or a table of sigrok (.sr, .csv), another table of levels, positions or \
         bytes (.csv), a hex dump, a serial log, or step commands of Klipper"
    };
}

const USE_FORMATS: &str = formats!();
pub(super) const UNKNOWN: &str = concat!("unknown format; ", formats!());

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Detected {
    pub(super) format: Format,
    /// All times are whole numbers; without a unit they are not read as seconds.
    pub(super) whole_times: bool,
    pub(super) table: Option<hex_table::Table>,
    /// Bit mask of columns that are not levels, such as a step count.
    pub(super) skipped_columns: u64,
}

impl Detected {
    const fn of(format: Format) -> Self {
        Self { format, whole_times: false, table: None, skipped_columns: 0 }
    }
}

/// A shorter head is the entire file; three bytes may have been a byte order mark.
const FULL_HEAD: usize = (1 << 16) - 3;
const MAX_LINES: usize = 200;

pub(super) fn detect(head: &[u8], base: Option<Base>) -> Result<Detected, String> {
    if head.trim_ascii().is_empty() {
        return Err("the file is empty; record or export again".into());
    }
    if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
        return Ok(Detected::of(Format::SigrokSession));
    }
    if let Some(message) = binary(head) {
        return Err(message.into());
    }
    let lines = first_lines(head);
    let Some(first) = lines.first() else { return Ok(Detected::of(Format::SigrokCsv)) };
    if first.starts_with(b"$") {
        return Ok(Detected::of(Format::Vcd));
    }
    if klipper::is_klipper(head) || head.starts_with(b"Start printer at") {
        return Ok(Detected::of(Format::Klipper));
    }
    let comments = lines.iter().take_while(|line| is_comment(line) && !is_sample(line)).count();
    let (before, table) = lines.split_at(comments);
    let of_table = match table.split_first() {
        Some((head, rows)) => by_head(head, rows, base)?,
        None => None,
    };
    let has_word =
        |word: &[u8]| lines.iter().take(5).any(|line| line.windows(word.len()).any(|text| text == word));
    let is_of_sigrok = has_word(b"libsigrok") && !has_word(b"libsigrok4DSL")
        || before.first().is_some_and(|line| line.starts_with(b";") && sigrok::is_comment(line))
            && !of_table.is_some_and(|found| matches!(found.format, Format::LevelsCsv | Format::SaleaeCsv));
    if is_of_sigrok {
        return Ok(Detected::of(Format::SigrokCsv));
    }
    if lines.iter().take(20).any(|line| is_of_scope(line)) {
        return Err(SCOPE.into());
    }
    of_table.or_else(|| by_rows(if table.is_empty() { &lines } else { table })).ok_or_else(|| {
        let formats = nearest::nearest(&lines).unwrap_or_else(|| USE_FORMATS.into());
        format!("unknown format, beginning with {}; {formats}", quoted(first))
    })
}

/// The complete lines of the head that are not empty.
fn first_lines(head: &[u8]) -> Vec<&[u8]> {
    let last_newline = head.iter().rposition(|byte| *byte == b'\n');
    let end = last_newline.or_else(|| head.iter().rposition(u8::is_ascii_whitespace));
    let text = end.filter(|_| head.len() >= FULL_HEAD).and_then(|end| head.get(..end)).unwrap_or(head);
    text.split(|byte| *byte == b'\n')
        .map(<[u8]>::trim_ascii)
        .filter(|line| !line.is_empty() && !line.starts_with(b"META "))
        .take(MAX_LINES)
        .collect()
}

const SCOPE: &str = "voltages of an oscilloscope cannot be read; export digital channels, or use a table such as \
    time_us,STEP,DIR with 0 below the threshold of the input and 1 above it";

fn is_of_scope(line: &[u8]) -> bool {
    let mut names = fields(line, separator(line));
    names.any(|name| [&b"volt"[..], b"volts", b"ampere"].contains(&&name.to_ascii_lowercase()[..]))
}

fn binary(head: &[u8]) -> Option<&'static str> {
    if head.starts_with(b"\x1f\x8b") {
        return Some("the file is compressed (gzip); use gunzip");
    }
    if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
        return Some("the text is UTF-16; save it as UTF-8");
    }
    if head.starts_with(b"<SALEAE>") {
        return Some("binary exports of Saleae Logic cannot be read; export as CSV");
    }
    // A header block of 329 bytes, or the whole file packed by gzip.
    if head.starts_with(b"\0\0\0\0\0\0\0\x01\x49") || head.first() == Some(&0xfe) {
        return Some(
            "waveforms of GTKWave (FST) cannot be read; convert with fst2vcd -f file.fst -o file.vcd",
        );
    }
    head.contains(&0).then_some(UNKNOWN)
}

/// If a column name is ambiguous, the first rows decide: `encoder` can be a line or a position.
fn by_head(line: &[u8], rows: &[&[u8]], base: Option<Base>) -> Result<Option<Detected>, String> {
    let mut columns = Fields::new();
    let separator = separator(line);
    if columns.split(line, separator).is_err() {
        return Ok(None);
    }
    let names = column_names(&columns, separator);
    if names.iter().any(|name| name == "logic") {
        return Ok(Some(Detected::of(Format::SigrokCsv)));
    }
    if saleae::is_header(&names, separator) {
        return Ok(Some(Detected::of(Format::SaleaeBytes)));
    }
    if let Some(table) = hex_table::by_head(line, rows, base)? {
        return Ok(Some(Detected { table: Some(table), ..Detected::of(Format::HexBytes) }));
    }
    Ok(by_names(&names, separator, rows))
}

fn by_names(names: &[String], separator: u8, rows: &[&[u8]]) -> Option<Detected> {
    let Layout { time, unit, .. } = Layout::of(names)?;
    names.get(1)?;
    let times = || {
        rows.iter()
            .filter_map(|row| fields(row, separator).nth(time).map(without_quotes))
            .filter(|time| !time.is_empty())
    };
    // sigrok writes this if it does not know the rate; all numbers are then 0.
    if names.first().is_some_and(|name| name == "samples") && times().all(|time| time == b"0") {
        return Some(Detected::of(Format::SigrokCsv));
    }
    let whole_times = times().all(|time| Decimal::parse(time).is_none_or(|time| time.places == 0))
        && times().any(|time| Decimal::parse(time).is_some());
    let is_level = |field: &[u8]| matches!(field, b"0" | b"1" | b"X" | b"\"0\"" | b"\"1\"");
    let levels = rows.iter().all(|row| {
        let mut all = fields(row, separator).enumerate();
        all.all(|(at, field)| at == time || is_level(field))
    });
    let found = |format| Some(Detected { whole_times, ..Detected::of(format) });
    let lower = |name: &String| name.trim().to_lowercase();
    let named = names.iter().enumerate().any(|(at, name)| at != time && lower(name).starts_with("pos"));
    let skipped = columns_without_levels(names, time, &|at| {
        rows.iter().all(|row| fields(row, separator).nth(at).is_some_and(is_level))
    });
    if skipped.is_none() && named
        || skipped.is_none() && !levels && positions::position_column(names, time).is_some()
    {
        return found(Format::PositionsCsv);
    }
    let first = names.first().map(lower).unwrap_or_default();
    match unit {
        TimeUnit::Cycles if first.starts_with("cycle") => found(Format::EdgesCsv),
        _ if first == "time [s]" || first == "time[s]" => found(Format::SaleaeCsv),
        _ => found(Format::LevelsCsv),
    }
    .map(|found| Detected { skipped_columns: skipped.unwrap_or(0), ..found })
}

/// With levels of STEP and DIR, other columns such as a count are skipped.
fn columns_without_levels(names: &[String], time: usize, is_level: &dyn Fn(usize) -> bool) -> Option<u64> {
    let meanings: Vec<Meaning> = names.iter().map(|name| Meaning::from_name(name, false)).collect();
    let has = |kind: Kind| {
        let is_kind = |meaning: &Meaning| matches!(meaning, Meaning::Signal(named) if named.kind == kind);
        meanings.iter().enumerate().any(|(at, meaning)| at != time && is_kind(meaning) && is_level(at))
    };
    if !has(Kind::Step) || !has(Kind::Dir) {
        return None;
    }
    let mut skipped = 0;
    for (at, (name, meaning)) in names.iter().zip(&meanings).enumerate().take(64) {
        let is_signal = matches!(meaning, Meaning::Signal(_));
        let is_other = match (is_level(at), positions::is_position(name)) {
            (true, is_position) => is_position && !is_signal,
            (false, is_position) => is_position || !is_signal,
        };
        if at != time && is_other && TimeUnit::named(name).is_none() {
            skipped |= 1 << at;
        }
    }
    Some(skipped)
}

fn without_quotes(field: &[u8]) -> &[u8] {
    field.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\"")).unwrap_or(field)
}

fn by_rows(lines: &[&[u8]]) -> Option<Detected> {
    if lines.iter().all(|line| is_sample(line)) {
        return Some(Detected::of(Format::SigrokCsv));
    }
    if is_trace(lines) {
        return Some(Detected::of(Format::Trace));
    }
    let texts: Vec<&[u8]> =
        lines.iter().filter(|line| !log_line::without_comment(line).is_empty()).copied().collect();
    let first = *texts.first()?;
    if dump::is_dump(&texts) {
        return Some(Detected::of(Format::HexDump));
    }
    if annotations::is_annotation(first) {
        return Some(Detected::of(Format::Annotations));
    }
    if hex::is_log(first) {
        return Some(Detected::of(Format::SerialLog));
    }
    if let Some(found) = by_numbers(&texts) {
        return found;
    }
    if hex::is_line(first) {
        return Some(Detected::of(Format::HexBytes));
    }
    // Labels of sigrok without comments: names, then samples.
    let (_, rows) = lines.split_first()?;
    (!rows.is_empty() && rows.iter().all(|line| is_sample(line))).then_some(Detected::of(Format::SigrokCsv))
}

/// Rows that begin with a rising number: levels, positions or bytes. `Some(None)` if ambiguous.
#[allow(clippy::option_option, reason = "ambiguous rows must not be tried as another format")]
fn by_numbers(lines: &[&[u8]]) -> Option<Option<Detected>> {
    let separator = separator(lines.first()?);
    let rows: Vec<Vec<&[u8]>> = lines.iter().map(|line| fields(line, separator).collect()).collect();
    let columns = rows.first().map_or(0, Vec::len);
    if let Some(table) = hex_table::by_rows(lines) {
        let may_be_positions = columns == 2 && rows.iter().all(|row| row.len() == 2);
        let found = Detected { table: Some(table), ..Detected::of(Format::HexBytes) };
        return Some((!may_be_positions || hex_table::is_hexadecimal(lines, table)).then_some(found));
    }
    let time = |row: &Vec<&[u8]>| Decimal::parse_with_comma(row.first()?);
    let times: Vec<Decimal> = rows.iter().map(time).collect::<Option<_>>()?;
    let places = times.iter().map(|time| time.places).max()?;
    let ticks: Vec<i128> = times.iter().filter_map(|time| Some(time.with_places(places)?.mantissa)).collect();
    let rise = ticks.len() == rows.len() && ticks.windows(2).all(|pair| pair.first() < pair.last());
    if columns < 2 || !rise || rows.iter().any(|row| row.len() != columns) {
        return None;
    }
    let found = |format| Some(Some(Detected { whole_times: places == 0, ..Detected::of(format) }));
    let rest = || rows.iter().flat_map(|row| row.iter().skip(1));
    if rows.len() > 1 && rest().all(|field| matches!(*field, b"0" | b"1")) {
        return found(Format::LevelsCsv);
    }
    // Lines of two bytes look like times and positions.
    let bytes = lines.iter().all(|line| hex::is_line(line)) && !lines.iter().any(|line| line.contains(&b'.'));
    if columns == 2 && !bytes && rest().all(|field| Decimal::parse(field).is_some()) {
        return found(Format::PositionsCsv);
    }
    None
}

fn is_sample(line: &[u8]) -> bool {
    let mut digits = line.iter().step_by(2);
    let mut marks = line.iter().skip(1).step_by(2);
    let first = line.get(1);
    !line.len().is_multiple_of(2)
        && digits.all(|digit| matches!(digit, b'0' | b'1'))
        && marks.all(|mark| Some(mark) == first && b",;\t|: ".contains(mark))
}

/// Rising cycles and levels without leading zeros, at least one level above 0xff, so the words are not bytes.
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
