//! The tables of `datasheet.md` equal the register table. `STEPSCOPE_BLESS=1 cargo test -p
//! stepscope-registers` writes them; the text around them is written by hand.
#![allow(clippy::expect_used, reason = "a missing file or program fails the test")]

use std::{env, fmt::Write as _, fs, path::Path};
use stepscope_registers::{
    MAP,
    table::{Access, Field, Register, Reset},
};

fn name(register: &Register) -> String {
    match register.count {
        1 => register.name.to_owned(),
        count => format!("{0}0 to {0}{1}", register.name, count - 1),
    }
}

fn offset(register: &Register) -> String {
    match register.count {
        1 => format!("0x{:03X}", register.offset),
        _ => format!("0x{:03X} to 0x{:03X}", register.offset, register.end() - 4),
    }
}

fn reset(register: &Register) -> String {
    match register.reset {
        Reset::Fixed(value) => format!("0x{value:08X}"),
        Reset::Configured => "as built".to_owned(),
    }
}

/// Doc comments start with the space after their slashes.
fn text(meaning: &str) -> &str {
    meaning.trim()
}

fn first_sentence(meaning: &str) -> &str {
    let end = meaning.find(". ").map_or(meaning.len(), |dot| dot + 1);
    text(meaning.get(..end).unwrap_or_default())
}

fn map() -> String {
    let mut out = String::from("| offset | name | access | reset | |\n| --- | --- | --- | --- | --- |\n");
    for register in MAP {
        let (offset, name, access) = (offset(register), name(register), register.access.name());
        let (reset, meaning) = (reset(register), first_sentence(register.meaning));
        let _ = writeln!(out, "| {offset} | {name} | {access} | {reset} | {meaning} |");
    }
    out
}

fn bits(low: u32, high: u32) -> String {
    if low == high { low.to_string() } else { format!("{high}..{low}") }
}

fn field(out: &mut String, field: &Field) {
    let bits = bits(field.low, field.high);
    let _ = writeln!(out, "| {bits} | {} | {} |", field.name, text(field.meaning));
    for value in field.values {
        let name = value.name.trim_start_matches(field.name).trim_start_matches('_');
        let number = if value.value > 9 { format!("{:#X}", value.value) } else { value.value.to_string() };
        let number = number.replace("0X", "0x");
        let _ = writeln!(out, "| | = {number} {name} | {} |", text(value.meaning));
    }
}

fn registers() -> String {
    let mut out = String::new();
    for register in MAP {
        let (name, offset, access) = (name(register), offset(register), register.access.name());
        let _ = writeln!(out, "### {name}\n\n{offset}, {access}, reset {}\n", reset(register));
        let _ = writeln!(out, "{}\n", text(register.meaning));
        let _ = writeln!(out, "| bits | field | |\n| --- | --- | --- |");
        let mut next = 32;
        for each in register.fields.iter().rev() {
            if each.high + 1 < next {
                let _ = writeln!(out, "| {} | | reserved |", bits(each.high + 1, next - 1));
            }
            field(&mut out, each);
            next = each.low;
        }
        if next > 0 {
            let _ = writeln!(out, "| {} | | reserved |", bits(0, next - 1));
        }
        out.push('\n');
    }
    out
}

/// The data sheet with `tables` between its markers.
fn with_tables(sheet: &str, tables: &[(&str, String)]) -> String {
    let mut out = sheet.to_owned();
    for (name, table) in tables {
        let begin = format!("<!-- {name}: from the register table -->\n");
        let end = format!("<!-- end of {name} -->");
        let (before, rest) = out.split_once(&begin).expect("the sheet has the begin marker");
        let (_, after) = rest.split_once(&end).expect("the sheet has the end marker");
        out = format!("{before}{begin}\n{}\n\n{end}{after}", table.trim_end());
    }
    out
}

#[test]
fn data_sheet_tables_match_the_register_table() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("datasheet.md");
    let found = fs::read_to_string(&path).expect("the data sheet is there").replace("\r\n", "\n");
    let expected = with_tables(&found, &[("map", map()), ("registers", registers())]);
    if env::var_os("STEPSCOPE_BLESS").is_some() {
        fs::write(&path, &expected).expect("the data sheet can be written");
    } else {
        let differs = found.lines().zip(expected.lines()).find(|(found, expected)| found != expected);
        assert_eq!(differs, None, "STEPSCOPE_BLESS=1 cargo test -p stepscope-registers writes the tables");
        assert_eq!(found, expected);
    }
}

#[test]
fn registers_and_fields_are_in_order_and_do_not_overlap() {
    let mut free = 0;
    for register in MAP {
        assert!(register.offset.is_multiple_of(4) && register.offset >= free, "{}", register.name);
        assert!(register.count > 0, "{}", register.name);
        free = register.end();
        let mut bit = 0;
        for field in register.fields {
            assert!(bit <= field.low && field.low <= field.high && field.high < 32, "{}", field.name);
            bit = field.high + 1;
            for value in field.values {
                assert!(value.name.starts_with(field.name), "{}", value.name);
                assert_eq!(field.extract(field.insert(value.value)), value.value, "{}", value.name);
            }
        }
        assert!(register.access != Access::W1c || register.reset == Reset::Fixed(0), "{}", register.name);
    }
}

#[test]
fn fields_extract_and_insert_their_bits() {
    let field = |low, high| Field { name: "F", low, high, meaning: "", values: &[] };
    let rows =
        [(0, 0, 1, 1), (0, 31, u32::MAX, 0xdead_beef), (8, 12, 0x1f00, 0x1e), (31, 31, 0x8000_0000, 1)];
    for (low, high, mask, value) in rows {
        let field = field(low, high);
        assert_eq!(field.mask(), mask);
        assert_eq!(field.extract(field.insert(value) | !mask), value);
        assert_eq!(field.insert(u32::MAX), mask);
        assert!(field.is_set(mask) && !field.is_set(!mask));
    }
}
