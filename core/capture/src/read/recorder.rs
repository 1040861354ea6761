//! The sink of all readers: collects rows in order of time and drops those without a change.

use super::base::Base;
use core::mem;

use crate::capture::{Capture, Change, Channel, Format, MAX_CHANNELS, TimedByte, TimedPosition};
use crate::names::{Kind, Meaning};

const MAX_NOTES: usize = 20;
const MAX_NAME: usize = 400;
const MAX_NAMED: usize = 6;

pub(super) struct Recorder {
    pub(super) capture: Capture,
    max_rows: usize,
    latest: Option<Change>,
    /// Bits that changed at the latest row's time, and the number of lost pulses per channel.
    changed: u64,
    lost: [u64; MAX_CHANNELS],
    omitted: Names,
    pub(super) requested: Vec<String>,
    pub(super) base: Option<Base>,
}

impl Recorder {
    pub(super) const fn new(format: Format, max_rows: usize) -> Self {
        Self {
            capture: Capture::new(format),
            max_rows,
            latest: None,
            changed: 0,
            lost: [0; MAX_CHANNELS],
            omitted: Names::new(),
            requested: Vec::new(),
            base: None,
        }
    }

    pub(super) const fn max_rows(&self) -> usize {
        self.max_rows
    }

    /// `None` if all bits are used, which is reported as a note.
    pub(super) fn channel(&mut self, name: &str) -> Option<u8> {
        let bit = self.capture.channels.len();
        if bit >= MAX_CHANNELS {
            self.omit(name);
            return None;
        }
        self.capture.channels.push(Channel { name: cut(name).into() });
        u8::try_from(bit).ok()
    }

    pub(super) fn channel_named(&mut self, name: &str) -> Option<u8> {
        let known = self.capture.channels.iter().position(|channel| channel.name == cut(name));
        known.map_or_else(|| self.channel(name), |bit| u8::try_from(bit).ok())
    }

    pub(super) fn omit(&mut self, name: &str) {
        self.omitted.add(name);
    }

    pub(super) const fn omit_more(&mut self, count: u64) {
        self.omitted.count = self.omitted.count.saturating_add(count);
    }

    /// `tick` is at least the previous row's.
    pub(super) fn levels(&mut self, tick: u64, levels: u64) -> Result<(), String> {
        self.capture.end = tick;
        match &mut self.latest {
            Some(latest) if latest.levels == levels => Ok(()),
            Some(latest) if latest.tick == tick => {
                let changed = latest.levels ^ levels;
                latest.levels = levels;
                self.edges(changed);
                Ok(())
            }
            _ => {
                self.changed = self.latest.map_or(0, |before| before.levels ^ levels);
                self.push_latest();
                let changes = &mut self.capture.changes;
                check_count(changes.len(), self.max_rows, "changes")?;
                changes.reserve().map_err(|_| out_of_memory(changes.len(), "changes"))?;
                self.latest = Some(Change { tick, levels });
                Ok(())
            }
        }
    }

    /// A bit that changes twice at one time was a pulse, which is lost. A file's first levels are not changes.
    pub(super) fn edges(&mut self, changed: u64) {
        let mut pulses = self.changed & changed;
        self.changed ^= if self.latest.is_some() { changed } else { 0 };
        while pulses != 0 {
            if let Some(lost) = self.lost.get_mut(pulses.trailing_zeros() as usize) {
                *lost = lost.saturating_add(1);
            }
            pulses &= pulses - 1;
        }
    }

    pub(super) const fn next_time(&mut self) {
        self.changed = 0;
    }

    fn note_lost_pulses(&mut self) {
        let mut sentences = Vec::new();
        for (index, (channel, &lost)) in self.capture.channels.iter().zip(&self.lost).enumerate() {
            if lost == 0 || !self.reports_lost_pulses(index, &channel.name) {
                continue;
            }
            let pulses = if lost == 1 { "pulse starts and ends" } else { "pulses start and end" };
            let verb = if lost == 1 { "is" } else { "are" };
            sentences.push(format!(
                "{} {pulses} at the same time and {verb} lost ({}); record with a finer unit of time",
                grouped(lost),
                channel.name
            ));
        }
        sentences.into_iter().for_each(|sentence| self.note(sentence));
    }

    /// Whether a channel's lost pulses matter: with a map, only on its channels; otherwise on channels that may have
    /// pulses. In dumps only known names count, since simulators write many other signals.
    fn reports_lost_pulses(&self, index: usize, name: &str) -> bool {
        let is_dump = self.capture.format == Format::Vcd;
        let (is_level, may_have_pulses) = match Meaning::from_name(name, false) {
            Meaning::Signal(named) => match named.kind {
                Kind::Dir | Kind::En | Kind::De => (true, false),
                Kind::Clock => (false, !is_dump),
                Kind::Step | Kind::Cw | Kind::Ccw | Kind::A | Kind::B | Kind::Rx | Kind::Tx => (false, true),
            },
            Meaning::Unknown => (false, !is_dump),
            Meaning::Other => (false, false),
        };
        if self.requested.is_empty() {
            return may_have_pulses;
        }
        let (last, number) = (name.rsplit('.').next().unwrap_or(name), format!("#{index}"));
        let is_named = |requested: &String| {
            *requested == number
                || requested.eq_ignore_ascii_case(name)
                || requested.eq_ignore_ascii_case(last)
        };
        !is_level && self.requested.iter().any(is_named)
    }

    /// Space for it was reserved before.
    fn push_latest(&mut self) {
        if let Some(latest) = self.latest.take()
            && self.capture.changes.last().is_none_or(|before| before.levels != latest.levels)
        {
            self.capture.changes.push(latest);
        }
    }

    pub(super) fn byte(&mut self, byte: TimedByte) -> Result<(), String> {
        reserve(&mut self.capture.bytes, self.max_rows, "bytes")?;
        self.capture.end = byte.tick;
        self.capture.bytes.push(byte);
        Ok(())
    }

    pub(super) fn sort_bytes(&mut self) {
        let bytes = &mut self.capture.bytes;
        // A stable sort would allocate memory.
        bytes.sort_unstable_by_key(|byte| (byte.tick, byte.channel));
        self.capture.end = bytes.last().map_or(self.capture.end, |byte| byte.tick);
    }

    pub(super) fn position(&mut self, position: TimedPosition) -> Result<(), String> {
        reserve(&mut self.capture.positions, self.max_rows, "positions")?;
        self.capture.end = position.tick;
        self.capture.positions.push(position);
        Ok(())
    }

    /// Replaces every tick by `map(tick)`, which must rise; `None` and no change if one does not fit.
    pub(super) fn retime(&mut self, map: impl Fn(u64) -> Option<u64>) -> Option<()> {
        map(self.capture.end)?;
        let set = |tick: &mut u64| *tick = map(*tick).unwrap_or(*tick);
        let capture = &mut self.capture;
        let timed = |change: Change| Change { tick: map(change.tick).unwrap_or(change.tick), ..change };
        capture.changes = mem::take(&mut capture.changes).into_iter().map(timed).collect();
        self.latest = self.latest.map(timed);
        capture.bytes.iter_mut().for_each(|byte| set(&mut byte.tick));
        capture.positions.iter_mut().for_each(|position| set(&mut position.tick));
        set(&mut capture.end);
        Some(())
    }

    /// Scales ticks by a factor and rounds; `None` and no change if two changes would coincide.
    pub(super) fn coarsen(&mut self, factor: u64) -> Option<()> {
        let map = |tick: u64| tick / factor + u64::from(tick % factor >= factor.div_ceil(2));
        let mut before = None;
        for change in self.capture.changes.iter().chain(self.latest) {
            let tick = map(change.tick);
            if before.replace(tick) == Some(tick) {
                return None;
            }
        }
        self.retime(|tick| Some(map(tick)))
    }

    pub(super) fn note(&mut self, sentence: impl Into<String>) {
        if self.capture.notes.len() < MAX_NOTES {
            self.capture.notes.push(sentence.into());
        }
    }

    /// Notes skipped items, if any.
    pub(super) fn note_skipped(&mut self, noun: &str, names: &Names) {
        if !names.is_empty() {
            self.note(format!("skipped {noun}: {}", names.to_text()));
        }
    }

    pub(super) fn note_unknown_levels(&mut self, count: u64, which: &str) {
        if count > 0 {
            let levels = if count == 1 { "level is" } else { "levels are" };
            self.note(format!("{} {levels} neither high nor low ({which}), read as low", grouped(count)));
        }
    }

    pub(super) fn finish(mut self) -> Capture {
        self.push_latest();
        self.note_lost_pulses();
        self.capture.omitted_channels = self.omitted.count;
        if !self.omitted.is_empty() {
            let sentence = format!(
                "{} of {} channels left out ({}): at most {MAX_CHANNELS} are read, first those in the channel map, then those with a recognized name",
                grouped(self.omitted.count),
                grouped(self.omitted.count.saturating_add(self.capture.channels.len() as u64)),
                self.omitted.to_text()
            );
            self.note(sentence);
        }
        self.capture
    }
}

fn reserve<T>(rows: &mut Vec<T>, max_rows: usize, noun: &str) -> Result<(), String> {
    check_count(rows.len(), max_rows, noun)?;
    if rows.len() == rows.capacity() {
        // Growing by half: a doubled vector may not fit next to the old one.
        let more = (rows.len() / 2).max(1024);
        let count = rows.len();
        rows.try_reserve_exact(more).map_err(|_| out_of_memory(count, noun))?;
    }
    Ok(())
}

fn check_count(count: usize, max_rows: usize, noun: &str) -> Result<(), String> {
    if count < max_rows {
        return Ok(());
    }
    Err(format!("more than {} {noun}; record a shorter time, or fewer channels", grouped(max_rows as u64)))
}

fn out_of_memory(count: usize, noun: &str) -> String {
    format!("not enough memory for more than {} {noun}; record a shorter time", grouped(count as u64))
}

/// The first few omitted names, and the number of the others.
#[derive(Default)]
pub(super) struct Names {
    first: Vec<String>,
    count: u64,
}

impl Names {
    pub(super) const fn new() -> Self {
        Self { first: Vec::new(), count: 0 }
    }

    pub(super) fn add(&mut self, name: &str) {
        self.count += 1;
        if self.first.len() < MAX_NAMED {
            self.first.push(cut(name).into());
        }
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub(super) fn to_text(&self) -> String {
        let more = self.count - self.first.len() as u64;
        let names = self.first.join(", ");
        if more == 0 { names } else { format!("{names} and {} more", grouped(more)) }
    }
}

/// `100 000 000`, with thin spaces.
pub(super) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Text of a file for a message: shortened and quoted.
pub(super) fn quoted(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(text.get(..160).unwrap_or(text));
    let mut shown: String =
        text.chars().map(|letter| if letter.is_control() { '·' } else { letter }).take(40).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    format!("“{shown}”")
}

fn cut(name: &str) -> &str {
    let mut end = name.len().min(MAX_NAME);
    while !name.is_char_boundary(end) {
        end -= 1;
    }
    name.get(..end).unwrap_or_default()
}
