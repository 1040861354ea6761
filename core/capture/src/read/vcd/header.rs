//! Reads a dump's definitions: time scale, scopes, variables.
//!
//! ```text
//! $timescale 100 ps $end     $scope module top $end     $var wire 8 " speed [7:0] $end     $upscope $end
//! ```

use super::variables::Variables;
use crate::read::decimal::{power_of_ten, whole};
use crate::read::recorder::{Names, Recorder, quoted};
use crate::read::selection::Selection;
use crate::{capture::MAX_CHANNELS, timebase::Timebase};
use std::collections::BTreeSet;

const MAX_DEPTH: usize = 200;
const MAX_STRINGS: usize = 10_000;
const MAX_COMMAND: usize = 4096;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyword {
    Timescale,
    Scope,
    Upscope,
    Var,
    EndDefinitions,
    Skipped,
}

const KEYWORDS: [(Keyword, &str); 5] = [
    (Keyword::Timescale, "$timescale"),
    (Keyword::Scope, "$scope"),
    (Keyword::Upscope, "$upscope"),
    (Keyword::Var, "$var"),
    (Keyword::EndDefinitions, "$enddefinitions"),
];

impl Keyword {
    pub(super) fn parse(word: &[u8]) -> Self {
        let found = KEYWORDS.iter().find(|(_, text)| text.as_bytes() == word);
        found.map_or(Self::Skipped, |(keyword, _)| *keyword)
    }

    pub(super) fn name(self) -> &'static str {
        let found = KEYWORDS.iter().find(|(keyword, _)| *keyword == self);
        found.map_or("a command", |(_, text)| text)
    }
}

#[derive(Default)]
pub(super) struct Header {
    command: Vec<u8>,
    path: String,
    scopes: Vec<usize>,
    others: Names,
    selection: Selection<(Box<[u8]>, u32)>,
    /// Values of strings may contain blanks.
    strings: BTreeSet<Box<[u8]>>,
}

impl Header {
    pub(super) fn begin(&mut self) {
        self.command.clear();
    }

    pub(super) fn argument(&mut self, word: &[u8]) -> Result<(), String> {
        if self.command.len() + word.len() > MAX_COMMAND {
            return Err(format!("a command of more than {MAX_COMMAND} bytes; add its $end"));
        }
        self.command.extend_from_slice(word);
        self.command.push(b' ');
        Ok(())
    }

    fn words(&self) -> impl Iterator<Item = &[u8]> {
        self.command.split(|byte| *byte == b' ').filter(|word| !word.is_empty())
    }

    pub(super) fn timescale(&self) -> Result<Timebase, String> {
        let text: Vec<u8> = self.words().flatten().copied().collect();
        let digits = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let (number, unit) = text.split_at(digits);
        let power = match unit {
            b"s" => Some(0),
            b"ms" => Some(3),
            b"us" => Some(6),
            b"ns" => Some(9),
            b"ps" => Some(12),
            b"fs" => Some(15),
            _ => None,
        };
        let denominator = power.and_then(power_of_ten).and_then(|power| u64::try_from(power).ok());
        let base = whole(number).zip(denominator).and_then(|(number, unit)| Timebase::new(number, unit));
        base.ok_or_else(|| {
            format!(
                "$timescale {} is not a time scale; use a whole number and s, ms, us, ns, ps or fs",
                quoted(&text)
            )
        })
    }

    pub(super) fn enter(&mut self) -> Result<(), String> {
        if self.scopes.len() >= MAX_DEPTH {
            return Err(format!("more than {MAX_DEPTH} nested scopes; dump fewer"));
        }
        let name = self.words().nth(1).map(|name| String::from_utf8_lossy(name).into_owned());
        self.scopes.push(self.path.len());
        if let Some(name) = name {
            self.path.push_str(&name);
            self.path.push('.');
        }
        Ok(())
    }

    pub(super) fn leave(&mut self) {
        self.path.truncate(self.scopes.pop().unwrap_or(0));
    }

    pub(super) fn variable(&mut self, recorder: &mut Recorder) -> Result<(), String> {
        let text = || quoted(&self.command);
        let mut words = self.words();
        let (Some(kind), Some(size), Some(code), Some(name)) =
            (words.next(), words.next(), words.next(), words.next())
        else {
            return Err(format!("$var {} is incomplete; use a type, size, code and name", text()));
        };
        let size = whole(size)
            .and_then(|size| u32::try_from(size).ok())
            .ok_or_else(|| format!("$var {} has no size; use a number of bits as its second word", text()))?;
        let mut name = String::from_utf8_lossy(name).into_owned();
        words.for_each(|word| name.push_str(&String::from_utf8_lossy(word)));
        let name = format!("{}{name}", self.path);
        if !is_line(kind) || size == 0 {
            let code = (kind == b"string" && self.strings.len() < MAX_STRINGS).then(|| code.into());
            self.others.add(&format!("{name} ({})", String::from_utf8_lossy(kind)));
            self.strings.extend(code);
            return Ok(());
        }
        let code: Box<[u8]> = code.into();
        if size == 1 {
            self.selection.offer(name, (code, 0), recorder);
            return Ok(());
        }
        self.offer_bits(&name, size, &code, recorder);
        Ok(())
    }

    /// Offers the bits of a vector: as many as can be read, and requested ones beyond them.
    fn offer_bits(&mut self, name: &str, size: u32, code: &[u8], recorder: &mut Recorder) {
        let (base, first, step) = bits(name, size);
        let all = size.min(MAX_CHANNELS as u32);
        let last = base.rsplit('.').next().unwrap_or_default();
        let requested = |wanted: &String| {
            let (vector, index) = wanted.strip_suffix(']')?.rsplit_once('[')?;
            let bit = index.parse::<i64>().ok()?.checked_sub(first)?.checked_mul(step)?;
            let is_this = vector == base || vector.eq_ignore_ascii_case(last);
            u32::try_from(bit).ok().filter(|bit| is_this && (all..size).contains(bit))
        };
        let mut more: Vec<u32> = recorder.requested.iter().filter_map(requested).collect();
        more.sort_unstable();
        more.dedup();
        recorder.omit_more(u64::from(size - all) - more.len() as u64);
        for bit in (0..all).chain(more) {
            let name = format!("{base}[{}]", first + step * i64::from(bit));
            self.selection.offer(name, (code.into(), bit), recorder);
        }
    }

    pub(super) fn select(&mut self, variables: &mut Variables, recorder: &mut Recorder) {
        self.selection.finish(recorder, |(code, bit), channel| variables.add(&code, bit, channel));
    }

    /// The string's code; any word if no string was declared.
    pub(super) fn ends_string(&self, word: &[u8]) -> bool {
        self.strings.is_empty() || self.strings.contains(word)
    }

    pub(super) fn into_others(self) -> Names {
        self.others
    }
}

fn is_line(kind: &[u8]) -> bool {
    !matches!(
        kind,
        b"real"
            | b"realtime"
            | b"real_parameter"
            | b"shortreal"
            | b"string"
            | b"event"
            | b"parameter"
            | b"integer"
            | b"time"
            | b"int"
            | b"shortint"
            | b"longint"
            | b"sparray"
    )
}

/// The name of a vector without its range, its lowest index, and the increment.
fn bits(name: &str, size: u32) -> (&str, i64, i64) {
    let range = name.strip_suffix(']').and_then(|name| name.rsplit_once('['));
    if let Some((base, range)) = range
        && let Some((high, low)) = range.split_once(':')
        && let (Ok(high), Ok(low)) = (high.parse::<i64>(), low.parse::<i64>())
        && high.checked_sub(low).is_some_and(|last| last.unsigned_abs() == u64::from(size - 1))
    {
        return (base, low, if low <= high { 1 } else { -1 });
    }
    (name, 0, 1)
}
