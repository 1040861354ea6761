//! A map in progress, with the names and measurements of its channels.

use super::behavior::{Behavior, behaviors};
use super::motor::Motor;
use crate::capture::{Capture, Change};
use crate::names::{Kind, Meaning, SignalName, are_indexed};
use crate::short_sort::ShortSort as _;
use crate::{changes::MAX_INSPECTED, channel_map::Entry};

pub(super) struct Draft<'a> {
    pub(super) capture: &'a Capture,
    pub(super) meanings: Vec<Meaning>,
    pub(super) changes: Vec<Change>,
    pub(super) behavior: Vec<Behavior>,
    pub(super) motors: Vec<Motor>,
    /// EN, RX, TX and DE.
    pub(super) bus_signals: Vec<Entry>,
}

impl<'a> Draft<'a> {
    pub(super) fn new(capture: &'a Capture) -> Self {
        let names = || capture.channels.iter().map(|channel| channel.name.as_str());
        let indexed = are_indexed(names());
        let changes: Vec<Change> = capture.changes.iter().take(MAX_INSPECTED).collect();
        let behavior = behaviors(&changes, capture.channels.len());
        let mut meanings: Vec<Meaning> = names().map(|name| Meaning::from_name(name, indexed)).collect();
        recognize_joined(&mut meanings, names());
        renumber_pins(&mut meanings);
        Self { capture, meanings, changes, behavior, motors: Vec::new(), bus_signals: Vec::new() }
    }

    pub(super) fn behavior(&self, channel: usize) -> Behavior {
        self.behavior.get(channel).copied().unwrap_or_default()
    }

    /// Channels whose name means this kind; the positive line of a pair comes first.
    pub(super) fn named(&self, kind: Kind) -> Vec<(usize, SignalName)> {
        let mut found: Vec<(usize, SignalName)> = Vec::new();
        for (channel, meaning) in self.meanings.iter().enumerate() {
            if let Meaning::Signal(named) = meaning
                && named.kind == kind
            {
                found.push((channel, named.clone()));
            }
        }
        found.sort_short_by_key(|(channel, named)| (named.is_negative, *channel));
        found
    }

    /// Whether two channels always have equal or always opposite levels.
    pub(super) fn is_copy(&self, channel: usize, other: usize) -> bool {
        let differ = |change: &Change| (change.levels >> channel ^ change.levels >> other) & 1 == 1;
        let first = self.changes.first().is_some_and(differ);
        self.changes.iter().all(|change| differ(change) == first)
    }

    /// Channels that change and have no signal yet.
    pub(super) fn unassigned(&self) -> Vec<usize> {
        let is_unassigned = |channel: &usize| {
            self.behavior(*channel).changes() > 0
                && self.motors.iter().all(|motor| !motor.has(*channel))
                && self.bus_signals.iter().all(|entry| entry.channel != *channel)
                && !matches!(self.meanings.get(*channel), Some(Meaning::Other))
        };
        // A duplicate of a named signal, such as a second EN, is not another signal.
        let may_be_any = |channel: &usize| match self.meanings.get(*channel) {
            Some(Meaning::Signal(named)) => match named.kind {
                Kind::Rx | Kind::Tx => self.behavior(*channel).has_uniform_pulses(),
                Kind::Clock | Kind::Cw | Kind::Ccw | Kind::A | Kind::B => true,
                Kind::Step | Kind::Dir | Kind::En | Kind::De => false,
            },
            _ => true,
        };
        (0..self.capture.channels.len()).filter(is_unassigned).filter(may_be_any).collect()
    }

    pub(super) fn is_line(&self, channel: usize) -> bool {
        self.behavior(channel).line.is_some()
    }

    pub(super) fn unassigned_without_lines(&self) -> Vec<usize> {
        self.unassigned().into_iter().filter(|channel| !self.is_line(*channel)).collect()
    }

    /// Times of a channel's edges.
    pub(super) fn edges(&self, channel: usize) -> Vec<u64> {
        let pairs = self.changes.iter().zip(self.changes.iter().skip(1));
        let changed = pairs.filter(|(before, now)| (before.levels ^ now.levels) >> channel & 1 == 1);
        changed.map(|(_, now)| now.tick).collect()
    }
}

/// Recognizes names of one word: `FLSTEP` and `FLDIR` are the signals of a motor, since their other letters are equal.
fn recognize_joined<'a>(meanings: &mut [Meaning], names: impl Iterator<Item = &'a str>) {
    let joined: Vec<Option<SignalName>> = names
        .zip(meanings.iter())
        .map(
            |(name, meaning)| {
                if *meaning == Meaning::Unknown { Meaning::from_single_word(name) } else { None }
            },
        )
        .collect();
    for (meaning, named) in meanings.iter_mut().zip(&joined) {
        let Some(named) = named else { continue };
        let is_partner = |other: &SignalName| other.axis == named.axis && other.kind != named.kind;
        if joined.iter().flatten().any(is_partner) {
            *meaning = Meaning::Signal(named.clone());
        }
    }
}

/// If all STEP and DIR numbers differ and there are as many DIR as STEP, the numbers are pin numbers: renumbers the signals
/// from 0.
fn renumber_pins(meanings: &mut [Meaning]) {
    let numbers = |kind: Kind| -> Vec<&str> {
        let signals = meanings.iter().filter_map(|meaning| match meaning {
            Meaning::Signal(named) if named.kind == kind => Some(named.axis.as_str()),
            _ => None,
        });
        signals.collect()
    };
    let (steps, dirs) = (numbers(Kind::Step), numbers(Kind::Dir));
    let mut all: Vec<&str> = steps.iter().chain(&dirs).copied().collect();
    all.sort_short_by_key(|axis| *axis);
    let is_number = |axis: &&str| !axis.is_empty() && axis.bytes().all(|byte| byte.is_ascii_digit());
    let are_pins = steps.len() == dirs.len()
        && all.iter().all(is_number)
        && all.windows(2).all(|pair| pair.first() != pair.last());
    let (mut steps, mut dirs) = (0_u32, 0_u32);
    for meaning in meanings.iter_mut().filter(|_| are_pins) {
        let Meaning::Signal(named) = meaning else { continue };
        let count = match named.kind {
            Kind::Step => &mut steps,
            Kind::Dir => &mut dirs,
            _ => continue,
        };
        named.axis = count.to_string();
        *count += 1;
    }
}
