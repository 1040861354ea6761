//! Helpers of the tests of files.
#![allow(dead_code, reason = "each test uses its part of it")]

use std::fmt::Write as _;
use std::io::Cursor;
use stepscope_capture::read::{Limits, Reading, read};

/// Reads a file that is in memory.
pub(crate) fn read_bytes(bytes: impl AsRef<[u8]>) -> Reading {
    read(Cursor::new(bytes), &Limits::default(), &mut |_| true)
}

/// A reading as text: the capture in one line, then a line per note and the error, such as
/// `Vcd 1/1000 [STEP DIR] 0:0 10:1 end 12`, changes as tick:levels, bytes as tick:channel:byte, positions as tick@position.
pub(crate) fn summary(reading: &Reading) -> String {
    let capture = &reading.capture;
    let names: Vec<&str> = capture.channels.iter().map(|channel| channel.name.as_str()).collect();
    let mut text = format!("{:?}", capture.format);
    if let Some((numerator, denominator)) = capture.timebase.map(|base| base.parts()) {
        let _ = write!(text, " {numerator}/{denominator}");
    }
    let _ = write!(text, " [{}]", names.join(" "));
    for change in &capture.changes {
        let _ = write!(text, " {}:{:x}", change.tick, change.levels);
    }
    for byte in &capture.bytes {
        let mark = if byte.framing_error { "!" } else { "" };
        let _ = write!(text, " {}:{}:{:02x}{mark}", byte.tick, byte.channel, byte.byte);
    }
    for position in &capture.positions {
        let _ = write!(text, " {}@{}", position.tick, position.position);
    }
    let _ = write!(text, " end {}", capture.end);
    for sentence in &capture.notes {
        let _ = write!(text, "\n- {sentence}");
    }
    if let Some(error) = &reading.error {
        let _ = write!(text, "\n! {error}");
    }
    text
}

/// Reads each text and compares its summary.
pub(crate) fn check(rows: &[(&str, &str)]) {
    let mut wrong = String::new();
    for (text, expected) in rows {
        let found = summary(&read_bytes(text));
        if found != *expected {
            let _ = write!(wrong, "\n--- {text:?}\nexpected {expected}\n   found {found}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}
