//! Reads tables of times and bytes: `t_us,bytes`, `time_us,dir,data`, or rows `12.5,55 AA` without a head.

use super::base::{Base, Digits, Guess};
use super::{decimal::Decimal, fields::separator, positions, row, times::TimeUnit};
use crate::names::Meaning;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Table {
    pub(super) separator: u8,
    pub(super) unit: TimeUnit,
    pub(super) direction: Direction,
    pub(super) base: Base,
    /// Whether the bytes fit another base, too.
    pub(super) is_ambiguous: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    None,
    Before,
    After,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    Hexadecimal,
    Decimal,
    Bytes,
    Any,
}

struct Head {
    separator: u8,
    unit: TimeUnit,
    direction: Direction,
    column: Column,
    name: String,
}

impl Head {
    fn parse(line: &[u8]) -> Option<Self> {
        let separator = separator(line);
        let names: Vec<String> = line
            .split(|byte| *byte == separator)
            .map(|name| String::from_utf8_lossy(name.trim_ascii()).into_owned())
            .collect();
        let (first, others) = names.split_first()?;
        let unit = TimeUnit::of_column(first).filter(|unit| *unit != TimeUnit::Cycles)?;
        let is_direction = |name: &str| {
            ["dir", "direction", "port", "channel", "line", "rx/tx", "source"]
                .contains(&name.to_lowercase().as_str())
        };
        let (direction, name) = match others {
            [name] => (Direction::None, name),
            [direction, name] if is_direction(direction) => (Direction::Before, name),
            [name, direction] if is_direction(direction) => (Direction::After, name),
            _ => return None,
        };
        let column = match name.to_lowercase().as_str() {
            "hex" | "hexadecimal" => Column::Hexadecimal,
            "dec" | "decimal" => Column::Decimal,
            "bytes" | "byte" | "data" | "payload" | "raw" => Column::Bytes,
            _ => Column::Any,
        };
        Some(Self { separator, unit, direction, column, name: name.clone() })
    }

    /// Whether its name says bytes or `value`, or is neither a signal nor a position and its values have two digits.
    fn may_be_bytes(&self, digits: &Digits) -> bool {
        let is_value = ["value", "val"].contains(&self.name.to_lowercase().as_str());
        let is_known = self.column != Column::Any || is_value;
        let is_other =
            positions::is_position(&self.name) || Meaning::from_name(&self.name, false) != Meaning::Unknown;
        is_known || !is_other && digits.are_pairs()
    }

    fn base(&self, digits: &Digits) -> Result<(Base, bool), String> {
        match (self.column, digits.guess()) {
            (Column::Hexadecimal, _) => Ok((Base::Hexadecimal, false)),
            (Column::Any, _) if digits.are_single_bits() => Err(format!(
                "the values of the column “{}” may be levels or bytes; name the column hex, or after a signal such as STEP",
                self.name
            )),
            (Column::Decimal, _) | (_, Guess::Certain(Base::Decimal)) => Ok((Base::Decimal, false)),
            (_, Guess::Certain(Base::Hexadecimal)) => Ok((Base::Hexadecimal, false)),
            (Column::Bytes, Guess::Ambiguous(Base::Hexadecimal, _)) => Ok((Base::Hexadecimal, true)),
            (Column::Bytes, _) => Ok((Base::Hexadecimal, false)),
            (Column::Any, _) => Err(format!(
                "the values of the column “{}” may be hexadecimal bytes, decimal bytes or positions; name the column hex, dec or position, such as time_us,hex",
                self.name
            )),
        }
    }
}

/// Uses the first rows and the requested base; `None` if the line is no such head.
pub(super) fn by_head(line: &[u8], rows: &[&[u8]], base: Option<Base>) -> Result<Option<Table>, String> {
    let Some(head) = Head::parse(line) else { return Ok(None) };
    let mut table = Table {
        separator: head.separator,
        unit: head.unit,
        direction: head.direction,
        base: Base::Hexadecimal,
        is_ambiguous: false,
    };
    let mut digits = Digits::new();
    for row in rows {
        let (_, _, bytes) = table.split(row);
        words(bytes).for_each(|word| digits.take(word));
    }
    if !head.may_be_bytes(&digits) {
        return Ok(None);
    }
    (table.base, table.is_ambiguous) = match base {
        Some(base) => (base, false),
        None => head.base(&digits)?,
    };
    Ok(Some(table))
}

pub(super) fn is_head(line: &[u8]) -> bool {
    Head::parse(line).is_some()
}

fn words(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    bytes.split(|byte| b" ,;\t".contains(byte)).filter(|word| !word.is_empty())
}

fn split_first_field(line: &[u8], separator: u8) -> (&[u8], &[u8]) {
    let line = line.trim_ascii();
    let end = line.iter().position(|byte| *byte == separator).unwrap_or(line.len());
    let (field, rest) = line.split_at(end);
    (field.trim_ascii(), rest.get(1..).unwrap_or_default().trim_ascii())
}

impl Table {
    pub(super) fn split<'l>(&self, line: &'l [u8]) -> (&'l [u8], &'l [u8], &'l [u8]) {
        let (time, rest) = split_first_field(line, self.separator);
        match self.direction {
            Direction::None => (time, b"", rest),
            Direction::Before => {
                let (direction, bytes) = split_first_field(rest, self.separator);
                (time, direction, bytes)
            }
            Direction::After => match rest.iter().rposition(|byte| *byte == self.separator) {
                Some(at) => {
                    let (bytes, direction) = rest.split_at(at);
                    (time, direction.get(1..).unwrap_or_default().trim_ascii(), bytes.trim_ascii())
                }
                None => (time, b"", rest),
            },
        }
    }
}

/// A rising number and bytes of two digits. Without a head the times have no unit.
pub(super) fn by_rows(lines: &[&[u8]]) -> Option<Table> {
    let separator = separator(lines.first()?);
    let (mut before, mut is_number, mut is_whole) = (None::<Decimal>, false, true);
    // Blanks may also separate the bytes of one row.
    let mut are_pairs = separator != b' ';
    let mut digits = Digits::new();
    for line in lines {
        let (time, rest) = split_first_field(line, separator);
        let number = Decimal::parse(time).filter(|number| number.mantissa >= 0)?;
        let places = number.places.max(before.map_or(0, |before| before.places));
        let whole = |number: Decimal| number.with_places(places).map(|number| number.mantissa);
        if before.is_some_and(|before| whole(before) > whole(number)) {
            return None;
        }
        are_pairs &= rest.len() == 2 && before.is_none_or(|before| whole(before) < whole(number));
        before = Some(number);
        is_number |= time.len() != 2;
        is_whole &= number.places == 0 && time.iter().all(u8::is_ascii_digit);
        let mut bytes = Vec::new();
        let is_rest = row::parse(rest, &mut bytes).is_ok_and(|shape| shape.group == 1) && !bytes.is_empty();
        let is_pair = |word: &[u8]| word.len() == 2 || word.starts_with(b"0x");
        if !is_rest || !words(rest).all(is_pair) {
            return None;
        }
        words(rest).for_each(|word| digits.take(word));
    }
    let unit = if is_whole { TimeUnit::Cycles } else { TimeUnit::Seconds(0) };
    let is_ambiguous = digits.guess() != Guess::Certain(Base::Hexadecimal);
    ((is_number || are_pairs) && lines.len() > 1).then_some(Table {
        separator,
        unit,
        direction: Direction::None,
        base: Base::Hexadecimal,
        is_ambiguous,
    })
}

/// Evidence for hexadecimal: a letter, `0x`, a leading zero, or several bytes in a row.
pub(super) fn is_hexadecimal(lines: &[&[u8]], table: Table) -> bool {
    !table.is_ambiguous || lines.iter().any(|line| split_first_field(line, table.separator).1.len() > 2)
}
