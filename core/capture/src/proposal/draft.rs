//! A map under construction, with the names and measurements of its channels.

use super::{
    behavior::{Behavior, behaviors},
    motor::Motor,
};
use crate::{
    capture::{Capture, Change},
    changes::MAX_INSPECTED,
    channel_map::Entry,
    names::{Kind, Meaning, Named, are_indexed},
};

pub(super) struct Draft<'a> {
    pub(super) capture: &'a Capture,
    pub(super) meanings: Vec<Meaning>,
    pub(super) changes: Vec<Change>,
    pub(super) behavior: Vec<Behavior>,
    pub(super) motors: Vec<Motor>,
    pub(super) others: Vec<Entry>,
}

impl<'a> Draft<'a> {
    pub(super) fn new(capture: &'a Capture) -> Self {
        let names = || capture.channels.iter().map(|channel| channel.name.as_str());
        let indexed = are_indexed(names());
        let changes: Vec<Change> = capture.changes.iter().take(MAX_INSPECTED).collect();
        let behavior = behaviors(&changes, capture.channels.len());
        let mut meanings: Vec<Meaning> = names().map(|name| Meaning::of(name, indexed)).collect();
        join(&mut meanings, names());
        number_pins(&mut meanings);
        Self { capture, meanings, changes, behavior, motors: Vec::new(), others: Vec::new() }
    }

    pub(super) fn behavior(&self, channel: usize) -> Behavior {
        self.behavior.get(channel).copied().unwrap_or_default()
    }

    /// The positive line of a pair comes first.
    pub(super) fn named(&self, kind: Kind) -> Vec<(usize, Named)> {
        let mut found: Vec<(usize, Named)> = Vec::new();
        for (channel, meaning) in self.meanings.iter().enumerate() {
            if let Meaning::Signal(named) = meaning
                && named.kind == kind
            {
                found.push((channel, named.clone()));
            }
        }
        found.sort_by_key(|(channel, named)| (named.negative, *channel));
        found
    }

    /// Whether two channels always have equal or always opposite levels.
    pub(super) fn is_copy(&self, one: usize, other: usize) -> bool {
        let differ = |change: &Change| (change.levels >> one ^ change.levels >> other) & 1 == 1;
        let first = self.changes.first().is_some_and(differ);
        self.changes.iter().all(|change| differ(change) == first)
    }

    pub(super) fn free(&self) -> Vec<usize> {
        let is_free = |channel: &usize| {
            self.behavior(*channel).changes() > 0
                && self.motors.iter().all(|motor| !motor.has(*channel))
                && self.others.iter().all(|entry| entry.channel != *channel)
                && !matches!(self.meanings.get(*channel), Some(Meaning::Other))
        };
        // A duplicate of a named signal, such as a second EN, is not free either.
        let is_unnamed = |channel: &usize| match self.meanings.get(*channel) {
            Some(Meaning::Signal(named)) => match named.kind {
                Kind::Rx | Kind::Tx => self.behavior(*channel).is_pulses(),
                Kind::Clock | Kind::Cw | Kind::Ccw | Kind::A | Kind::B => true,
                Kind::Step | Kind::Dir | Kind::En | Kind::De => false,
            },
            _ => true,
        };
        (0..self.capture.channels.len()).filter(is_free).filter(is_unnamed).collect()
    }

    pub(super) fn is_line(&self, channel: usize) -> bool {
        self.behavior(channel).line.is_some()
    }

    pub(super) fn free_of_lines(&self) -> Vec<usize> {
        self.free().into_iter().filter(|channel| !self.is_line(*channel)).collect()
    }

    pub(super) fn edges(&self, channel: usize) -> Vec<u64> {
        let pairs = self.changes.iter().zip(self.changes.iter().skip(1));
        let changed = pairs.filter(|(before, now)| (before.levels ^ now.levels) >> channel & 1 == 1);
        changed.map(|(_, now)| now.tick).collect()
    }
}

/// `FLSTEP` and `FLDIR` are a motor's signals if the rest of both names is equal.
fn join<'a>(meanings: &mut [Meaning], names: impl Iterator<Item = &'a str>) {
    let joined: Vec<Option<Named>> = names
        .zip(meanings.iter())
        .map(|(name, meaning)| if *meaning == Meaning::Unknown { Meaning::joined(name) } else { None })
        .collect();
    for (meaning, named) in meanings.iter_mut().zip(&joined) {
        let Some(named) = named else { continue };
        let is_partner = |other: &Named| other.axis == named.axis && other.kind != named.kind;
        if joined.iter().flatten().any(is_partner) {
            *meaning = Meaning::Signal(named.clone());
        }
    }
}

/// Pin numbers do not identify motors. With one DIR per STEP and no repeated number, both are paired in order.
fn number_pins(meanings: &mut [Meaning]) {
    let numbers = |kind: Kind| -> Vec<&str> {
        let signals = meanings.iter().filter_map(|meaning| match meaning {
            Meaning::Signal(named) if named.kind == kind => Some(named.axis.as_str()),
            _ => None,
        });
        signals.collect()
    };
    let (steps, dirs) = (numbers(Kind::Step), numbers(Kind::Dir));
    let mut all: Vec<&str> = steps.iter().chain(&dirs).copied().collect();
    all.sort_unstable();
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
