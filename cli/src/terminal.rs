//! Text for standard output and standard error. Escapes control characters as `\u{1b}`: names and values come from
//! files, links and other machines, and must not control the terminal or reorder its text.
//!
//! Data written to standard output in place of a file (`output.rs`) is not escaped.

use std::{
    fmt::{self, Write as _},
    io::{self, StderrLock, StdoutLock, Write},
    path::Path,
};
use stepscope_core::inspect::export::plain_text::needs_escape;

pub(crate) fn out() -> EscapingWriter<StdoutLock<'static>> {
    EscapingWriter { to: io::stdout().lock(), incomplete: Vec::new() }
}

pub(crate) fn err() -> EscapingWriter<StderrLock<'static>> {
    EscapingWriter { to: io::stderr().lock(), incomplete: Vec::new() }
}

/// Escapes unsafe characters, but not line feeds and tabs.
pub(crate) struct EscapingWriter<W> {
    to: W,
    /// The first bytes of a character that continues in the next write.
    incomplete: Vec<u8>,
}

impl<W: Write> EscapingWriter<W> {
    fn write_escaped(&mut self, text: &str) -> io::Result<()> {
        let mut rest = text;
        while let Some(at) = rest.find(|c| needs_escape(c) && !matches!(c, '\n' | '\t')) {
            let (plain, from) = rest.split_at(at);
            self.to.write_all(plain.as_bytes())?;
            let mut chars = from.chars();
            if let Some(c) = chars.next() {
                write!(self.to, "{}", c.escape_unicode())?;
            }
            rest = chars.as_str();
        }
        self.to.write_all(rest.as_bytes())
    }
}

impl<W: Write> Write for EscapingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut joined = std::mem::take(&mut self.incomplete);
        joined.extend_from_slice(bytes);
        for chunk in joined.utf8_chunks() {
            self.write_escaped(chunk.valid())?;
            let invalid = chunk.invalid();
            let is_last = invalid.as_ptr_range().end == joined.as_ptr_range().end;
            // Up to three bytes at the end may be the start of a character.
            if is_last && std::str::from_utf8(invalid).is_err_and(|error| error.error_len().is_none()) {
                self.incomplete = invalid.to_vec();
            } else {
                invalid.iter().try_for_each(|byte| write!(self.to, "\\x{byte:02x}"))?;
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

/// A name or message within a line; line feeds and tabs are escaped, too.
pub(crate) struct Escaped<T>(pub(crate) T);

impl Escaped<std::path::Display<'_>> {
    pub(crate) fn path(path: &Path) -> Escaped<std::path::Display<'_>> {
        Escaped(path.display())
    }
}

impl<T: fmt::Display> fmt::Display for Escaped<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        struct Escape<'a, 'b>(&'a mut fmt::Formatter<'b>);

        impl fmt::Write for Escape<'_, '_> {
            fn write_str(&mut self, text: &str) -> fmt::Result {
                text.chars().try_for_each(|c| {
                    if needs_escape(c) {
                        write!(self.0, "{}", c.escape_unicode())
                    } else {
                        self.0.write_char(c)
                    }
                })
            }
        }

        write!(Escape(f), "{}", self.0)
    }
}

/// Escapes the same characters in the text of a JSON document, whose value does not change. Outside of strings, the
/// only such characters are line feeds.
pub(crate) fn json(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        if needs_escape(c) && c != '\n' {
            // All of them are below U+10000. Writing to a String cannot fail.
            let _ = write!(safe, "\\u{:04x}", u32::from(c));
        } else {
            safe.push(c);
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(pieces: &[&[u8]]) -> String {
        let mut text = EscapingWriter { to: Vec::new(), incomplete: Vec::new() };
        pieces.iter().for_each(|piece| text.write_all(piece).expect("memory takes it"));
        String::from_utf8(text.to).expect("it is text")
    }

    #[test]
    fn prints_control_characters_as_numbers() {
        let rows: [(&str, &str); 6] = [
            ("a\tb\n", "a\tb\n"),
            ("\u{1b}]0;x\u{7}", "\\u{1b}]0;x\\u{7}"),
            ("\u{7f}\u{9b}2J\r", "\\u{7f}\\u{9b}2J\\u{d}"),
            ("\u{202e}txt\u{2066}", "\\u{202e}txt\\u{2066}"),
            ("µs, Zähler, 電", "µs, Zähler, 電"),
            ("", ""),
        ];
        for (given, expected) in rows {
            assert_eq!(written(&[given.as_bytes()]), expected);
            let bytes: Vec<&[u8]> = given.as_bytes().chunks(1).collect();
            assert_eq!(written(&bytes), expected);
        }
        assert_eq!(written(&[b"a\xffb"]), "a\\xffb");
        assert_eq!(Escaped("a\nb\u{1b}").to_string(), "a\\u{a}b\\u{1b}");
    }

    #[test]
    fn escaped_json_has_the_same_value() {
        let given = serde_json::json!({ "title": "\u{9b}2J\u{202e}\u{7f} ü \u{1b}\n" });
        let text = json(&format!("{given:#}"));
        assert!(!text.chars().any(|c| needs_escape(c) && c != '\n'), "{text}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).expect("JSON"), given);
    }
}
