//! Reads value change dumps (IEEE 1364-2005, 18.2).
//!
//! ```text
//! $timescale 1 us $end
//! $scope module top $end $var wire 1 ! STEP $end $var wire 8 " speed [7:0] $end $upscope $end
//! $enddefinitions $end
//! #0 0! b1010 "
//! #10 1!
//! ```
//!
//! Words are read one by one, so endless comments and nested scopes; dump fewer need no memory.

mod header;
mod variables;

use super::recorder::{Names, Recorder, grouped, quoted};
use super::{decimal::whole, reading::Reader};
use crate::capture::Capture;
use header::{Header, Keyword};
use variables::{Value, Variables};

pub(super) struct Vcd {
    recorder: Recorder,
    header: Header,
    variables: Variables,
    expected: Expected,
    is_in_body: bool,
    now: u64,
    levels: u64,
    has_pending_levels: bool,
    /// Between `$dumpoff` and its end all values are x, whatever the levels are.
    is_off: bool,
    off_count: u64,
    unknown: u64,
}

const MAX_TEXT: usize = 1 << 16;

enum Expected {
    /// The first keyword; some programs print text before it.
    Start,
    Token,
    Command(Keyword),
    Scalar(Value),
    Vector,
    Other,
    Text(usize),
}

impl Vcd {
    pub(super) fn new(recorder: Recorder) -> Self {
        Self {
            recorder,
            header: Header::default(),
            variables: Variables::new(),
            expected: Expected::Start,
            is_in_body: false,
            now: 0,
            levels: 0,
            has_pending_levels: false,
            is_off: false,
            off_count: 0,
            unknown: 0,
        }
    }

    fn begin_body(&mut self) {
        if !self.is_in_body {
            self.is_in_body = true;
            self.header.select(&mut self.variables, &mut self.recorder);
        }
    }

    fn token(&mut self, word: &[u8]) -> Result<(), String> {
        let (&first, rest) = word.split_first().unwrap_or((&b' ', &[]));
        if first == b'$' {
            return self.keyword(word);
        }
        self.begin_body();
        if let Some(value) = Value::parse(first) {
            if rest.is_empty() {
                self.expected = Expected::Scalar(value);
            } else {
                self.scalar(value, rest);
            }
            return Ok(());
        }
        match first {
            b'#' => self.time(rest),
            b'b' | b'B' => {
                self.variables.set_value(rest).map_err(|letter| {
                    format!(
                        "{} is not a vector value because of “{letter}”; use only 0, 1, x and z",
                        quoted(word)
                    )
                })?;
                self.expected = Expected::Vector;
                Ok(())
            }
            b's' | b'S' => {
                self.expected = Expected::Text(rest.len());
                Ok(())
            }
            b'r' | b'R' => {
                self.expected = Expected::Other;
                Ok(())
            }
            b'p' => Err(format!(
                "{} is part of an extended dump ($dumpports); use a plain one ($dumpvars)",
                quoted(word)
            )),
            _ => Err(format!(
                "{} is neither a time (#), a value (0, 1, x, z, b, r, s) nor a keyword ($); record or copy the dump again",
                quoted(word)
            )),
        }
    }

    fn keyword(&mut self, word: &[u8]) -> Result<(), String> {
        self.expected = Expected::Token;
        match word {
            b"$dumpvars" | b"$dumpall" | b"$dumpon" => self.begin_body(),
            b"$dumpoff" => {
                self.begin_body();
                self.is_off = true;
                self.off_count += 1;
            }
            b"$end" => self.is_off = false,
            _ => {
                self.header.begin();
                self.expected = Expected::Command(Keyword::parse(word));
            }
        }
        Ok(())
    }

    fn argument(&mut self, keyword: Keyword, word: &[u8]) -> Result<(), String> {
        // Some programs write `$comment like this$end`.
        let (argument, last) = match word.strip_suffix(b"$end") {
            Some(argument) => (argument, true),
            None => (word, false),
        };
        if keyword != Keyword::Skipped && !argument.is_empty() {
            self.header.argument(argument)?;
        }
        if !last {
            return Ok(());
        }
        self.expected = Expected::Token;
        match keyword {
            Keyword::EndDefinitions => self.begin_body(),
            Keyword::Timescale => {
                let timescale = self.header.timescale()?;
                if let Some(first) = self.recorder.capture.timebase.replace(timescale)
                    && first != timescale
                {
                    return Err(format!(
                        "the time scale changes from {:e} s to {:e} s; use one per dump: record again",
                        first.seconds(),
                        timescale.seconds()
                    ));
                }
            }
            Keyword::Scope => self.header.enter()?,
            Keyword::Upscope => self.header.leave(),
            Keyword::Var => {
                self.header.variable(&mut self.recorder)?;
                if self.is_in_body {
                    self.header.select(&mut self.variables, &mut self.recorder);
                }
            }
            Keyword::Skipped => {}
        }
        Ok(())
    }

    fn time(&mut self, digits: &[u8]) -> Result<(), String> {
        let time = whole(digits).ok_or_else(|| {
            format!("#{} is not a time; use a whole number of less than 2^64", quoted(digits))
        })?;
        if time < self.now {
            return Err(format!(
                "time {time} follows time {}; dump again or delete the repeated part",
                self.now
            ));
        }
        // Values before the first time belong to it.
        if time > self.now {
            if self.has_pending_levels {
                self.recorder.levels(self.now, self.levels)?;
            }
            self.recorder.next_time();
        }
        (self.now, self.has_pending_levels) = (time, true);
        Ok(())
    }

    fn text(&mut self, length: usize, word: &[u8]) -> Result<(), String> {
        let length = length + word.len();
        if length > MAX_TEXT {
            return Err(format!(
                "a string value of more than {MAX_TEXT} bytes without a variable code; record or copy the dump again"
            ));
        }
        let is_over = self.header.ends_string(word);
        self.expected = if is_over { Expected::Token } else { Expected::Text(length) };
        Ok(())
    }

    fn scalar(&mut self, value: Value, code: &[u8]) {
        if self.is_off {
            return;
        }
        if let Some(variable) = self.variables.find(code) {
            let high = if value == Value::High { variable.first_bit } else { 0 };
            let levels = self.levels & !variable.all_bits | high;
            self.recorder.edges(self.levels ^ levels);
            self.levels = levels;
            self.unknown += u64::from(value == Value::Unknown);
            self.has_pending_levels = true;
        }
    }

    fn vector(&mut self, code: &[u8]) {
        if self.is_off {
            return;
        }
        if let Some((levels, changed, unknown)) = self.variables.vector(code) {
            let levels = self.levels & !changed | levels;
            self.recorder.edges(self.levels ^ levels);
            self.levels = levels;
            self.unknown += unknown;
            self.has_pending_levels = true;
        }
    }
}

impl Reader for Vcd {
    fn take(&mut self, word: &[u8]) -> Result<(), String> {
        match self.expected {
            Expected::Token => return self.token(word),
            Expected::Command(keyword) => return self.argument(keyword, word),
            Expected::Start if word.starts_with(b"$") => return self.keyword(word),
            Expected::Start => return Ok(()),
            Expected::Scalar(value) => self.scalar(value, word),
            Expected::Vector => self.vector(word),
            Expected::Other => {}
            Expected::Text(length) => return self.text(length, word),
        }
        self.expected = Expected::Token;
        Ok(())
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        let has_body = self.is_in_body;
        self.begin_body();
        let mut missing = match self.expected {
            Expected::Command(keyword) => Err(format!(
                "the file ends within {}; it is truncated: record or copy it again",
                keyword.name()
            )),
            Expected::Scalar(_) | Expected::Vector | Expected::Other | Expected::Text(_) => {
                Err("the file ends within a value change; it is truncated: record or copy it again".into())
            }
            _ if !has_body => {
                Err("the file ends before $enddefinitions; it is truncated: record or copy it again".into())
            }
            _ if self.recorder.capture.channels.is_empty() => {
                Err("the dump has no wire or register; dump signals such as STEP and DIR".into())
            }
            _ => Ok(()),
        };
        if self.has_pending_levels && !self.recorder.capture.channels.is_empty() {
            missing = missing.and(self.recorder.levels(self.now, self.levels));
        }
        let others: Names = self.header.into_others();
        self.recorder.note_skipped("variables that are neither wires nor registers", &others);
        self.recorder.note_unknown_levels(self.unknown, "x or z");
        if self.off_count > 0 {
            let times = if self.off_count == 1 {
                "once".into()
            } else {
                format!("{} times", grouped(self.off_count))
            };
            self.recorder.note(format!(
                "the dump was switched off {times} ($dumpoff); the levels are read as unchanged"
            ));
        }
        (self.recorder.finish(), missing)
    }
}
