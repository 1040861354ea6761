use super::*;
use alloc::{string::String, vec, vec::Vec};
use stepscope_motion::ScheduledStep;
use stepscope_motion::step_tables::{Entry, EntryFormat, Stored, TimingError};
use stepscope_peripheral::{segment::SegmentList, units::Instant};
use stepscope_scenario::Scenario;

fn table(entries: Vec<Entry>, format: EntryFormat) -> Stored {
    let list = SegmentList { start: Instant(1), segments: Vec::new() };
    Stored { list, format, entries, document_bytes: None, error: TimingError::default(), surplus: None }
}

fn request<'r>(path: &'r [u8], language: Language) -> Request<'r> {
    Request {
        scenario: Some(path),
        steps: None,
        axis: None,
        form: "compressed",
        error_us: 25.0,
        interval_part: None,
        is_early: false,
        is_quick: false,
        entries: "ticks",
        language: language.name(),
        name: "turn",
    }
}

fn written(entries: Vec<Entry>, format: EntryFormat, path: &[u8], language: Language) -> String {
    let table = table(entries, format);
    let tables = [NamedTable { name: "turn".into(), table: &table }];
    let origin = Origin::new(&request(path, language), &Scenario::default(), None);
    let source = Source { name: "turn", tables: &tables, clock_hz: 16_000_000, origin: &origin };
    let mut out = String::new();
    source.write(language, &mut out).unwrap();
    out
}

fn entry(interval: u64, count: u32, add: i64) -> Entry {
    Entry { interval, count, add }
}

#[test]
fn a_table_in_c_has_this_form() {
    let entries = vec![entry(0, 0, 1), entry(40_000, 1, 0), entry(20_000, 4, -1290)];
    let expected = r#"/* turn: 0 steps in 3 entries of 8 bytes, 24 bytes; largest timing error 0 cycles (0 us), r.m.s. 0.
 * The largest error is 0 % of the shortest step interval, 16130 cycles (1008 us).
 * Clock: 16000000 Hz. Unit of interval and add: cycles. Do not edit.
 * Made by stepscope 0.2.0: stepscope tables turn.json --form compressed --error-us 25 --entries ticks --format avr --name turn
 * Scenario turn.json, CRC-32 CRC (that of its link). Walk it with turn_begin() and turn_next(). */
#ifndef TURN_TABLE_H
#define TURN_TABLE_H

#include "stepscope_walk.h"

#define TURN_ENTRIES 3U
#define TURN_STEPS 0UL
#define TURN_CLOCK_HZ 16000000UL
#define TURN_FRACTION_BITS 0U
#define TURN_MAX_ERROR_CYCLES 0UL
#define TURN_MIN_CYCLES 16130UL /* shortest event of turn_next(), without waits of 0 */
#define TURN_MAX_CYCLES 40000UL

static const stepscope_ticks_entry turn_entries[TURN_ENTRIES] PROGMEM = {
    {0UL, 0U, 1}, {40000UL, 1U, 0}, {20000UL, 4U, -1290},
};

STEPSCOPE_TICKS_TABLE_P(turn)

#endif
"#;
    let link = stepscope_scenario::link::encode(&Scenario::default()).unwrap();
    let expected = expected.replace("CRC (", &format!("{} (", link.rsplit('.').next().unwrap()));
    assert_eq!(written(entries, EntryFormat::TICKS, b"turn.json", Language::Avr), expected);
}

#[test]
fn literals_are_as_wide_as_their_type() {
    let c = written(vec![entry(887_218, 3, i16::MIN.into())], EntryFormat::Q8, b"x", Language::C);
    assert!(c.contains(" {887218UL, 3U, (-32767 - 1)},"), "{c}");
    let c = written(vec![entry(u64::MAX, 70_000, i64::MIN)], EntryFormat::Q16, b"x", Language::C);
    assert!(c.contains("{18446744073709551615ULL, 70000UL, (-9223372036854775807LL - 1LL)}"), "{c}");
    assert!(c.contains("1 entry of 20 bytes (24 with padding), 20 bytes (24 with padding);"), "{c}");
    let csv = written(vec![entry(u64::MAX, 70_000, i64::MIN)], EntryFormat::Q16, b"x", Language::Csv);
    let row = "18446744073709551615,70000,-9223372036854775808";
    assert_eq!(csv, format!("interval_q16,count,add_q16\n{row}\n"));
}

#[test]
fn too_long_an_array_is_a_warning() {
    let warnings = |entries: usize, format, language| {
        let table = table(vec![entry(1, 1, 0); entries], format);
        let tables = [NamedTable { name: "turn".into(), table: &table }];
        let source = Source { name: "turn", tables: &tables, clock_hz: 1, origin: &Origin::default() };
        source.warnings(language).len()
    };
    let (ticks, q16) = (EntryFormat::TICKS, EntryFormat::Q16);
    assert_eq!((warnings(4095, ticks, Language::Avr), warnings(4096, ticks, Language::Avr)), (0, 1));
    assert_eq!((warnings(8191, ticks, Language::C), warnings(8192, ticks, Language::C)), (0, 1));
    assert_eq!((warnings(2730, q16, Language::C), warnings(2731, q16, Language::C)), (0, 1));
    // More than near pointers reach, too.
    assert_eq!(warnings(8193, ticks, Language::Avr), 2);
    assert_eq!(warnings(100_000, ticks, Language::Rust), 0);
    let c = written(vec![entry(1, 1, 0); 8192], ticks, b"x", Language::C);
    assert!(
        c.contains(" * WARNING: turn_entries has 65536 bytes; C99 compilers may allow only 65535"),
        "{c}"
    );
}

#[test]
fn no_path_ends_the_comment_or_the_line() {
    for (path, expected) in [
        ("turn.json", "tables turn.json --form"),
        ("a turn's.json", r"tables 'a turn'\''s.json' --form"),
        ("", "tables '' --form"),
        ("*/ int main", r"tables $'*\057 int main' --form"),
        ("/*", r"tables $'\057*' --form"),
        ("two\nlines\\", r"tables $'two\012lines\\' --form"),
        ("\u{2028}", r"tables $'\342\200\250' --form"),
        ("Zähler µ", "tables 'Zähler µ' --form"),
    ] {
        let c = written(Vec::new(), EntryFormat::TICKS, path.as_bytes(), Language::C);
        assert!(c.contains(expected), "{c}");
        assert_eq!((c.matches("*/").count(), c.matches("/*").count()), (2, 2), "{c}");
        let rust = written(Vec::new(), EntryFormat::TICKS, path.as_bytes(), Language::Rust);
        assert!(!rust.contains("\nlines") && rust.contains(expected), "{rust}");
    }
    assert_eq!(quoted(b"\xff"), r"$'\377'");
}

#[test]
fn quoted_words_are_read_back() {
    let mut words: Vec<Vec<u8>> = [
        "turn.json",
        "a turn's.json",
        "",
        "*/ int main",
        "/*",
        "two\nlines\\",
        "\u{2028}",
        "Zähler µ",
        "$'",
        "''",
        "-o",
    ]
    .map(|word| word.as_bytes().to_vec())
    .into();
    words
        .extend((0..=u8::MAX).flat_map(|byte| [vec![byte], vec![b'*', byte, b'/'], vec![byte, b'7', b'\'']]));
    for word in &words {
        assert_eq!(unquoted(&quoted(word)).as_ref(), Some(&vec![word.clone()]), "{}", quoted(word));
    }
    let line: Vec<String> = words.iter().map(|word| quoted(word)).collect();
    assert_eq!(unquoted(&line.join(" ")), Some(words));
    assert_eq!(unquoted(" turn.json  turn.h "), Some(vec![b"turn.json".to_vec(), b"turn.h".to_vec()]));
    for other in
        ["'open", "$'open", "$'\\", "$'\\400'", "$'\\08'", "$HOME", "a;b", "a*", "\\a", "\"a\"", "ä", "a\tb"]
    {
        assert_eq!(unquoted(other), None, "{other}");
    }
}

#[test]
fn a_written_table_is_read_back() {
    for format in EntryFormat::ALL {
        let entries = vec![
            entry(0, 0, 1),
            entry(format.max_interval(), format.max_count().min(70_000), format.min_add()),
            entry(7, 1, 0),
        ];
        for language in [Language::C, Language::Avr] {
            let found = read_c(&written(entries.clone(), format, b"x", language)).unwrap();
            assert_eq!(found.len(), 1);
            assert_eq!((&found[0].entries, found[0].format), (&entries, format));
            assert_eq!((found[0].name.as_str(), found[0].clock_hz), ("turn", 16_000_000));
        }
    }
    let c = written(vec![entry(7, 1, 0)], EntryFormat::TICKS, b"x", Language::C);
    for (from, to, why) in [
        ("{7UL, 1U, 0}", "{7UL, 1U}", "table turn: entry 0: {7UL, 1U} is no entry of format ticks"),
        ("{7UL, 1U, 0}", "{7UL, 65536U, 0}", "table turn: entry 0: {7UL, 65536U, 0} is no entry"),
        ("ENTRIES 1U", "ENTRIES 2U", "1 entry, and 2 by its macro"),
        ("TURN_CLOCK_HZ", "CLOCK", "no #define TURN_CLOCK_HZ with a number"),
        ("TURN_MIN_CYCLES", "MIN", "no #define TURN_MIN_CYCLES with a number"),
        ("turn_entries[", "entries[", "no array turn_entries"),
        ("STEPSCOPE_TICKS_TABLE(turn)", "", "no table; use a file of stepscope tables"),
    ] {
        let refused = read_c(&c.replace(from, to)).unwrap_err();
        assert!(refused.contains(why), "{refused}");
    }
}

#[test]
fn the_first_axis_is_that_of_the_command_in_the_header() {
    for (path, axis, expected) in [
        ("turn.json", None, 0),
        ("turn.json", Some("3"), 3),
        ("turn.json", Some("all"), 0),
        // Paths that contain options.
        ("x --axis 7", None, 0),
        ("x --axis 7 --form y", Some("2"), 2),
        ("*/ --axis 7", None, 0),
    ] {
        let table = table(vec![entry(7, 1, 0)], EntryFormat::TICKS);
        let request = Request { axis, ..request(path.as_bytes(), Language::C) };
        let origin = Origin::new(&request, &Scenario::default(), None);
        let tables = [NamedTable { name: "turn".into(), table: &table }];
        let source = Source { name: "turn", tables: &tables, clock_hz: 1, origin: &origin };
        let mut out = String::new();
        source.write(Language::C, &mut out).unwrap();
        assert_eq!(first_axis(&out), expected, "{out}");
    }
    assert_eq!(first_axis("static int x;"), 0);
}

#[test]
fn a_table_without_steps_has_no_entry_but_in_c() {
    let head = |language| written(Vec::new(), EntryFormat::TICKS, b"x", language);
    assert!(head(Language::C).contains("turn: 0 steps in 1 entry of 8 bytes, 8 bytes; "));
    let rust = head(Language::Rust);
    assert!(rust.contains("turn: 0 steps in 0 entries of 8 bytes, 0 bytes; "), "{rust}");
    assert!(rust.contains("TURN_COUNT: [u16; 0]"), "{rust}");
}

#[test]
fn a_check_names_the_first_difference() {
    let entries = vec![entry(0, 0, 1), entry(100, 3, 0)];
    let table = WrittenTable {
        name: "turn".into(),
        format: EntryFormat::TICKS,
        entries,
        steps: 3,
        clock_hz: 1000,
        max_error_cycles: 4,
        min_cycles: 100,
        max_cycles: 100,
    };
    let due = |cycles: &[u64]| -> Vec<_> {
        cycles.iter().map(|&cycle| ScheduledStep { cycle, right: cycle != 301 }).collect()
    };
    assert_eq!(table.check(due(&[100, 203, 300]), 1000), Ok(3));
    for (min_cycles, max_cycles, why) in [
        (99, 100, "MIN_CYCLES is 99, and 100 by the table's walk"),
        (100, 4_294_967_295, "MAX_CYCLES is 4294967295, and 100 by the table's walk"),
    ] {
        let stated = WrittenTable { min_cycles, max_cycles, ..table.clone() };
        let refused = stated.check(due(&[100, 200, 300]), 1000).unwrap_err();
        assert!(refused.starts_with(why), "{refused}");
    }
    for (cycles, clock_hz, why) in [
        (&[100][..], 1000, "the plan ends after 1 step, the table does not"),
        (&[100, 200, 300], 999, "the table counts cycles of 1000 Hz, the plan of 999 Hz"),
        (&[100, 205, 300], 1000, "step 1 is in cycle 200 of the table and cycle 205 of the plan: 5 cycles"),
        (&[100, 200], 1000, "the plan ends after 2 steps"),
        (&[100, 200, 300, 400], 1000, "the table ends after 3 steps"),
        (&[100, 200, 301], 1000, "step 2 is to the right in the table, to the left in the plan"),
    ] {
        let refused = table.check(due(cycles), clock_hz).unwrap_err();
        assert!(refused.starts_with(why), "{refused}");
    }
}
