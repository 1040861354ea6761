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
//! Words are read one by one, so endless comments and nested scopes need no memory.

mod header;
mod variables;

use super::{
    decimal::whole,
    reading::Reader,
    recorder::{Names, Recorder, grouped, quoted},
};
use crate::capture::Capture;
use header::{Header, Keyword};
use variables::{Value, Variables};

pub(super) struct Vcd {
    recorder: Recorder,
    header: Header,
    variables: Variables,
    expected: Expected,
    body: bool,
    now: u64,
    levels: u64,
    touched: bool,
    /// Between `$dumpoff` and its end all values are x, whatever the levels are.
    off: bool,
    offs: u64,
    unknown: u64,
}

const MAX_TEXT: usize = 1 << 16;

enum Expected {
    /// The first keyword; some programs print text before it.
    Start,
    Any,
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
            body: false,
            now: 0,
            levels: 0,
            touched: false,
            off: false,
            offs: 0,
            unknown: 0,
        }
    }

    fn begin(&mut self) {
        if !self.body {
            self.body = true;
            self.header.select(&mut self.variables, &mut self.recorder);
        }
    }

    fn any(&mut self, word: &[u8]) -> Result<(), String> {
        let (&kind, rest) = word.split_first().unwrap_or((&b' ', &[]));
        if kind == b'$' {
            return self.keyword(word);
        }
        self.begin();
        if let Some(value) = Value::parse(kind) {
            if rest.is_empty() {
                self.expected = Expected::Scalar(value);
            } else {
                self.scalar(value, rest);
            }
            return Ok(());
        }
        match kind {
            b'#' => self.time(rest),
            b'b' | b'B' => {
                self.variables.set_value(rest).map_err(|letter| {
                    format!("{} is no value of a vector: “{letter}” is neither 0, 1, x nor z", quoted(word))
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
                "{} is of an extended dump ($dumpports); write a plain one ($dumpvars)",
                quoted(word)
            )),
            _ => Err(format!(
                "{} is neither a time (#), a value (0, 1, x, z, b, r, s) nor a keyword ($)",
                quoted(word)
            )),
        }
    }

    fn keyword(&mut self, word: &[u8]) -> Result<(), String> {
        self.expected = Expected::Any;
        match word {
            b"$dumpvars" | b"$dumpall" | b"$dumpon" => self.begin(),
            b"$dumpoff" => {
                self.begin();
                self.off = true;
                self.offs += 1;
            }
            b"$end" => self.off = false,
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
        self.expected = Expected::Any;
        match keyword {
            Keyword::EndDefinitions => self.begin(),
            Keyword::Timescale => {
                let timescale = self.header.timescale()?;
                if let Some(first) = self.recorder.capture.timebase.replace(timescale)
                    && first != timescale
                {
                    return Err(format!(
                        "the time scale is {:e} s here and {:e} s before; a dump has one: record again",
                        timescale.seconds(),
                        first.seconds()
                    ));
                }
            }
            Keyword::Scope => self.header.enter()?,
            Keyword::Upscope => self.header.leave(),
            Keyword::Var => {
                self.header.variable(&mut self.recorder)?;
                if self.body {
                    self.header.select(&mut self.variables, &mut self.recorder);
                }
            }
            Keyword::Skipped => {}
        }
        Ok(())
    }

    fn time(&mut self, digits: &[u8]) -> Result<(), String> {
        let time = whole(digits).ok_or_else(|| {
            format!("#{} is not a time; it is a whole number of less than 2^64", quoted(digits))
        })?;
        if time < self.now {
            return Err(format!(
                "time {time} comes after time {}; times must rise: dump again, or delete what comes twice",
                self.now
            ));
        }
        // Values before the first time belong to it.
        if time > self.now {
            if self.touched {
                self.recorder.levels(self.now, self.levels)?;
            }
            self.recorder.next_time();
        }
        (self.now, self.touched) = (time, true);
        Ok(())
    }

    fn text(&mut self, length: usize, word: &[u8]) -> Result<(), String> {
        let length = length + word.len();
        if length > MAX_TEXT {
            return Err(format!(
                "a string of more than {MAX_TEXT} bytes; is the code of its variable missing?"
            ));
        }
        let is_over = self.header.ends_string(word);
        self.expected = if is_over { Expected::Any } else { Expected::Text(length) };
        Ok(())
    }

    fn scalar(&mut self, value: Value, code: &[u8]) {
        if self.off {
            return;
        }
        if let Some(variable) = self.variables.find(code) {
            let high = if value == Value::High { variable.first_bit } else { 0 };
            let levels = self.levels & !variable.all_bits | high;
            self.recorder.edges(self.levels ^ levels);
            self.levels = levels;
            self.unknown += u64::from(value == Value::Unknown);
            self.touched = true;
        }
    }

    fn vector(&mut self, code: &[u8]) {
        if self.off {
            return;
        }
        if let Some((levels, changed, unknown)) = self.variables.vector(code) {
            let levels = self.levels & !changed | levels;
            self.recorder.edges(self.levels ^ levels);
            self.levels = levels;
            self.unknown += unknown;
            self.touched = true;
        }
    }
}

impl Reader for Vcd {
    fn take(&mut self, word: &[u8]) -> Result<(), String> {
        match self.expected {
            Expected::Any => return self.any(word),
            Expected::Command(keyword) => return self.argument(keyword, word),
            Expected::Start if word.starts_with(b"$") => return self.keyword(word),
            Expected::Start => return Ok(()),
            Expected::Scalar(value) => self.scalar(value, word),
            Expected::Vector => self.vector(word),
            Expected::Other => {}
            Expected::Text(length) => return self.text(length, word),
        }
        self.expected = Expected::Any;
        Ok(())
    }

    fn finish(mut self) -> (Capture, Result<(), String>) {
        let is_whole = self.body;
        self.begin();
        let mut missing = match self.expected {
            Expected::Command(keyword) => Err(format!("the file ends within {keyword}; it is truncated")),
            Expected::Scalar(_) | Expected::Vector | Expected::Other | Expected::Text(_) => {
                Err("the file ends within a value change; it is truncated".into())
            }
            _ if !is_whole => Err("the file ends before $enddefinitions; it is truncated".into()),
            _ if self.recorder.capture.channels.is_empty() => {
                Err("the dump has no wire and no register; dump the lines of the motor, such as STEP and DIR"
                    .into())
            }
            _ => Ok(()),
        };
        if self.touched && !self.recorder.capture.channels.is_empty() {
            missing = missing.and(self.recorder.levels(self.now, self.levels));
        }
        let others: Names = self.header.into_others();
        if !others.is_empty() {
            self.recorder.leave_out(format!("variables that are no lines: {}", others.to_text()));
        }
        self.recorder.leave_out_unknown(self.unknown, "x or z");
        if self.offs > 0 {
            let times = if self.offs == 1 { "once".into() } else { format!("{} times", grouped(self.offs)) };
            self.recorder.leave_out(format!(
                "the dump was switched off {times} ($dumpoff); the levels are taken to stay"
            ));
        }
        (self.recorder.finish(), missing)
    }
}
