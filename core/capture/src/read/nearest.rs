//! Names the closest formats of an unknown file, and what each one needs.

use super::fields::{fields, separator};
use super::{clock::Stamp, decimal::Decimal, hex, levels::Layout, recorder::quoted, row};
use crate::short_sort::ShortSort as _;

const MAX_NAMED: usize = 3;

/// `None` if no line fits any format.
pub(super) fn nearest(lines: &[&[u8]]) -> Option<String> {
    let formats: [(usize, String); 7] = [
        (share(lines, is_levels), levels(lines)),
        (
            share(lines, is_numbers),
            "a table of positions (needs column names such as time_us,position)".into(),
        ),
        (share(lines, hex::is_line), format!("bytes in hexadecimal ({})", not_bytes(lines))),
        (share(lines, is_timed), format!("a serial log with hexadecimal bytes ({})", not_bytes(lines))),
        (share(lines, is_timed_byte), "a table of bytes (needs column names such as t_us,bytes)".into()),
        (
            share(lines, |line| line.starts_with(b"#") || line.contains(&b'$')),
            "a value change dump (needs $var and $enddefinitions at its beginning)".into(),
        ),
        (
            share(lines, |line| line.iter().filter(|byte| **byte == b'=').count() > 1),
            "step commands of Klipper (needs lines such as queue_step oid=0 interval=1000 count=4 add=0)"
                .into(),
        ),
    ];
    let mut formats: Vec<(usize, String)> = formats.into_iter().filter(|(share, _)| *share > 0).collect();
    formats.sort_short_by_key(|(share, _)| core::cmp::Reverse(*share));
    let named: Vec<String> = formats.into_iter().take(MAX_NAMED).map(|(_, format)| format).collect();
    match named.as_slice() {
        [] => None,
        [only] => Some(format!("the closest format is {only}")),
        _ => Some(format!("the closest formats are {}", named.join("; "))),
    }
}

/// Share of the lines for which `is` returns true, in percent.
fn share(lines: &[&[u8]], is: impl Fn(&[u8]) -> bool) -> usize {
    100 * lines.iter().filter(|line| is(line)).count() / lines.len().max(1)
}

fn split(line: &[u8]) -> Vec<&[u8]> {
    fields(line, separator(line)).collect()
}

fn is_levels(line: &[u8]) -> bool {
    let all = split(line);
    let levels = all.iter().filter(|field| matches!(**field, b"0" | b"1")).count();
    levels > 0 && all.len() > 1 && levels + 1 >= all.len()
}

fn is_numbers(line: &[u8]) -> bool {
    let all = split(line);
    all.len() > 1 && all.iter().all(|field| Decimal::parse(field).is_some())
}

fn is_timed(line: &[u8]) -> bool {
    let line = line.strip_prefix(b"[").unwrap_or(line).trim_ascii_start();
    Stamp::parse(line).is_some()
}

fn is_timed_byte(line: &[u8]) -> bool {
    let all = split(line);
    let is_byte = |field: &&[u8]| field.len() == 2 && field.iter().all(u8::is_ascii_hexdigit);
    all.len() > 1
        && all.first().is_some_and(|time| Decimal::parse(time).is_some())
        && all.iter().skip(1).all(is_byte)
}

fn levels(lines: &[&[u8]]) -> String {
    let first = lines.first().copied().unwrap_or_default();
    let names: Vec<String> =
        split(first).into_iter().map(|name| String::from_utf8_lossy(name).into()).collect();
    let has_time = Layout::of(&names).is_some();
    let missing = if has_time {
        "needs 0 or 1 in all other columns"
    } else {
        "needs a time column, such as time_us or sample"
    };
    format!("a table of levels ({missing})")
}

fn not_bytes(lines: &[&[u8]]) -> String {
    let wrong = lines.iter().find(|line| !hex::is_line(line)).copied().unwrap_or_default();
    let word = wrong.split(|byte| byte.is_ascii_whitespace() || *byte == b',').find(|word| {
        let mut bytes = Vec::new();
        !word.is_empty() && row::parse(word, &mut bytes).is_err()
    });
    word.map_or_else(|| "needs two digits per byte".into(), |word| format!("{} is not a byte", quoted(word)))
}
