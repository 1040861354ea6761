//! Which signal each channel seems to be: first by its name, then, of those whose names say nothing, by what it does.
//!
//! ```text
//! name        STEP STP PUL PULSE, DIR DIRECTION CW, EN ENA ENABLE (nEN, EN_N, /EN: inverted), RX RXD, TX TXD, DE
//!             with an axis: STEP1, X_STEP, stepY, axis2.step
//! behaviour   RX     high at rest, and every pulse is whole bits long, the shortest being one bit
//!             STEP   the most pulses, short beside their pauses
//!             DIR    of two or more channels left, the one that changes seldom, never while STEP is high
//! ```

use crate::{
    capture::{Capture, Change},
    channel_map::{ChannelMap, Entry},
};
use stepscope_peripheral::signal::{Levels, MAX_CHANNELS};

/// Changes that are looked at; what a channel is shows in its beginning.
const MAX_LOOKED_AT: usize = 1_000_000;
/// Pulses of a line that have to fit, so that it is taken for one.
const MIN_LINE_PULSES: u64 = 20;
/// Pulses that a channel has to have, so that it is taken for STEP.
const MIN_STEPS: u64 = 4;
/// Longest run of equal bits within a byte: start bit and eight zeros.
const MAX_BITS: u64 = 9;

const EN: u32 = Levels::EN.trailing_zeros();
const RX: u32 = Levels::RX.trailing_zeros();
const TX: u32 = Levels::TX.trailing_zeros();
const DE: u32 = Levels::DE.trailing_zeros();

impl ChannelMap {
    /// What names and behaviour of the channels say; signals that nothing speaks for have no channel.
    #[must_use]
    pub fn proposed(capture: &Capture) -> Self {
        let mut entries = by_name(capture);
        by_behaviour(capture, &mut entries);
        Self::of(entries)
    }
}

/// What a name says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Step,
    Dir,
    Other(u32),
}

const WORDS: [(&str, Kind); 19] = [
    ("STEP", Kind::Step),
    ("STP", Kind::Step),
    ("PUL", Kind::Step),
    ("PULSE", Kind::Step),
    ("DIR", Kind::Dir),
    ("DIRECTION", Kind::Dir),
    ("CW", Kind::Dir),
    ("EN", Kind::Other(EN)),
    ("ENA", Kind::Other(EN)),
    ("ENABLE", Kind::Other(EN)),
    ("ENN", Kind::Other(EN)),
    ("NEN", Kind::Other(EN)),
    ("NENABLE", Kind::Other(EN)),
    ("RX", Kind::Other(RX)),
    ("RXD", Kind::Other(RX)),
    ("TX", Kind::Other(TX)),
    ("TXD", Kind::Other(TX)),
    ("DE", Kind::Other(DE)),
    ("TXEN", Kind::Other(DE)),
];
/// Words of an enable that is active low.
const ACTIVE_LOW: [&str; 3] = ["ENN", "NEN", "NENABLE"];
/// Letters of axes, in the order of their channels.
const AXES: &str = "XYZABCUVWE";

/// A name that says something.
struct Named {
    channel: usize,
    kind: Kind,
    inverted: bool,
    /// What tells its axis from others: a number or a letter, else empty.
    axis: String,
}

fn by_name(capture: &Capture) -> Vec<Entry> {
    let named: Vec<Named> = capture
        .channels
        .iter()
        .enumerate()
        .filter_map(|(channel, each)| named(channel, &each.name))
        .collect();
    let mut axes: Vec<&str> = named
        .iter()
        .filter(|each| !matches!(each.kind, Kind::Other(_)))
        .map(|each| each.axis.as_str())
        .collect();
    axes.sort_unstable_by_key(|axis| {
        (axis.parse::<u32>().ok(), axis.chars().next().and_then(|c| AXES.find(c)), *axis)
    });
    axes.dedup();
    // Numbers stay as they are where they can; all else is numbered through.
    let as_they_are = axes.iter().all(|axis| axis.parse::<usize>().is_ok_and(|number| number < MAX_CHANNELS));
    let place = |axis: &str| {
        let number =
            if as_they_are { axis.parse().ok() } else { axes.iter().position(|other| *other == axis) };
        number
            .and_then(|number: usize| u32::try_from(number).ok())
            .filter(|number| *number < MAX_CHANNELS as u32)
    };
    let mut entries: Vec<Entry> = Vec::new();
    for Named { channel, kind, inverted, axis } in &named {
        let bit = match kind {
            Kind::Step => place(axis),
            Kind::Dir => place(axis).map(|place| place + Levels::DIR_SHIFT),
            Kind::Other(bit) => Some(*bit),
        };
        if let Some(bit) = bit.filter(|bit| entries.iter().all(|entry| entry.bit != *bit)) {
            entries.push(Entry { bit, channel: *channel, inverted: *inverted });
        }
    }
    entries
}

/// The word of a name, and its axis.
fn named(channel: usize, name: &str) -> Option<Named> {
    // A scope may name the axis, as in `x.step`.
    let mut parts = name.rsplit('.');
    let (last, scope) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    let marked =
        last.starts_with(['/', '~', '!']) || last.to_ascii_uppercase().ends_with("_N") || last.ends_with('#');
    let upper = last.to_ascii_uppercase();
    let tokens: Vec<&str> =
        upper.split(|c: char| !c.is_ascii_alphanumeric()).filter(|token| !token.is_empty()).collect();
    let mut found: Option<(Kind, &str, String)> = None;
    for token in &tokens {
        let letters = token.trim_end_matches(|c: char| c.is_ascii_digit());
        let digits = &token[letters.len()..];
        // STEP1, STEPX and XSTEP: the word with an axis at one of its ends.
        let word = |text: &str| WORDS.iter().find(|(word, _)| *word == text).copied();
        let one =
            |text: &str| if text.len() == 1 && AXES.contains(text) { Some(text.to_owned()) } else { None };
        let with_letter = || {
            let (first, rest) = letters.split_at_checked(1)?;
            let (start, end) = letters.split_at_checked(letters.len().checked_sub(1)?)?;
            let split = one(first).zip(word(rest)).or_else(|| one(end).zip(word(start)))?;
            Some((split.1, split.0))
        };
        let axis = |letter: String| format!("{letter}{digits}");
        let this = word(letters).map(|(word, kind)| (kind, word, axis(String::new())));
        let this = this.or_else(|| with_letter().map(|((word, kind), letter)| (kind, word, axis(letter))));
        found = found.or(this);
    }
    let (kind, word, own) = found?;
    let other = tokens.iter().map(|token| (*token).to_owned()).find(|token| is_axis(token));
    let own = if own.is_empty() { other.unwrap_or_default() } else { own };
    let own = if own.is_empty() { axis_of_scope(scope) } else { own };
    let low = kind == Kind::Other(EN) && (marked || ACTIVE_LOW.contains(&word));
    let axis = if own.is_empty() { "0".into() } else { own };
    Some(Named { channel, kind, inverted: low, axis })
}

/// Whether a part of a name is an axis by itself: `X`, `2`, `E1`.
fn is_axis(token: &str) -> bool {
    let letters = token.trim_end_matches(|c: char| c.is_ascii_digit());
    letters.is_empty() || letters.len() == 1 && AXES.contains(letters)
}

/// The axis that a scope's name ends with: `axis2`, `motor_x`.
fn axis_of_scope(scope: &str) -> String {
    let upper = scope.to_ascii_uppercase();
    let last = upper.rsplit(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or_default().to_owned();
    if is_axis(&last) {
        return last;
    }
    let letters = last.trim_end_matches(|c: char| c.is_ascii_digit());
    last[letters.len()..].to_owned()
}

/// What a channel does.
#[derive(Clone, Copy, Debug, Default)]
struct Behaviour {
    first: bool,
    last: bool,
    rises: u64,
    falls: u64,
    /// Ticks that it was high between its first and last change, and low.
    high: u64,
    low: u64,
    /// Shortest time between two changes.
    shortest: u64,
    /// When it changed last.
    since: Option<u64>,
    /// Pulses no longer than a byte's bits may be, and those of them that are whole bits long.
    short: u64,
    whole: u64,
}

impl Behaviour {
    fn changes(&self) -> u64 {
        self.rises + self.falls
    }

    /// A serial line, high at rest.
    fn is_line(&self) -> bool {
        self.first && self.last && self.short >= MIN_LINE_PULSES && self.whole * 20 >= self.short * 19
    }
}

fn by_behaviour(capture: &Capture, entries: &mut Vec<Entry>) {
    let free: Vec<usize> = (0..capture.channels.len())
        .filter(|channel| entries.iter().all(|entry| entry.channel != *channel))
        .collect();
    let looked_at: Vec<Change> = capture.changes.iter().take(MAX_LOOKED_AT).collect();
    if free.is_empty() || looked_at.is_empty() {
        return;
    }
    let behaviour = behaviours(&looked_at, capture.channels.len());
    let mut free: Vec<(usize, Behaviour)> = free
        .into_iter()
        .filter_map(|channel| Some((channel, *behaviour.get(channel)?)))
        .filter(|(_, each)| each.changes() > 0)
        .collect();
    let lines: Vec<usize> =
        free.iter().filter(|(_, each)| each.is_line()).map(|(channel, _)| *channel).collect();
    for (bit, channel) in [RX, TX].into_iter().zip(&lines) {
        if entries.iter().all(|entry| entry.bit != bit) {
            entries.push(Entry { bit, channel: *channel, inverted: false });
        }
    }
    free.retain(|(channel, _)| !lines.contains(channel));
    if entries.iter().any(|entry| entry.bit < 2 * MAX_CHANNELS as u32) {
        return;
    }
    // The busiest is STEP; inverted where its pulses are low.
    let Some(&(step, pulses)) =
        free.iter().max_by_key(|(channel, each)| (each.changes(), usize::MAX - channel))
    else {
        return;
    };
    if pulses.changes() < 2 * MIN_STEPS {
        return;
    }
    entries.push(Entry { bit: 0, channel: step, inverted: pulses.high > pulses.low && pulses.first });
    let level = u64::from(pulses.high > pulses.low && pulses.first);
    free.retain(|(channel, each)| *channel != step && each.changes() * 2 <= pulses.changes());
    let quiet = |channel: usize| {
        looked_at.windows(2).all(|pair| {
            let [before, now] = pair else { return true };
            let changed = (before.levels ^ now.levels) >> channel & 1 == 1;
            !changed || before.levels >> step & 1 == level
        })
    };
    if let Some((channel, _)) = free.into_iter().find(|(channel, _)| quiet(*channel)) {
        entries.push(Entry { bit: Levels::DIR_SHIFT, channel, inverted: false });
    }
}

/// What each channel does, in two passes: the shortest pulse first, then how many are whole multiples of it.
fn behaviours(changes: &[Change], channels: usize) -> Vec<Behaviour> {
    let mut all = vec![Behaviour { shortest: u64::MAX, ..Behaviour::default() }; channels];
    let (Some(first), Some(last)) = (changes.first(), changes.last()) else { return all };
    for (channel, each) in all.iter_mut().enumerate() {
        (each.first, each.last) = (first.levels >> channel & 1 == 1, last.levels >> channel & 1 == 1);
    }
    each_pulse(changes, &mut all, &mut |each, length, high| {
        *(if high { &mut each.high } else { &mut each.low }) += length;
        each.shortest = each.shortest.min(length);
    });
    for each in &mut all {
        each.since = None;
        (each.rises, each.falls) = (0, 0);
    }
    each_pulse(changes, &mut all, &mut |each, length, _| {
        let bit = each.shortest.max(1);
        if length > bit * MAX_BITS + bit / 2 {
            return;
        }
        each.short += 1;
        let off = (length + bit / 2) % bit;
        each.whole += u64::from(off.abs_diff(bit / 2) * 5 <= bit);
    });
    all
}

/// Calls for each time between two changes of one channel: how long, and its level.
fn each_pulse(changes: &[Change], all: &mut [Behaviour], pulse: &mut dyn FnMut(&mut Behaviour, u64, bool)) {
    for pair in changes.windows(2) {
        let [before, now] = pair else { continue };
        let mut changed = before.levels ^ now.levels;
        while changed != 0 {
            let channel = changed.trailing_zeros();
            changed &= changed - 1;
            let Some(each) = all.get_mut(channel as usize) else { continue };
            let was_high = before.levels >> channel & 1 == 1;
            *(if was_high { &mut each.falls } else { &mut each.rises }) += 1;
            if let Some(since) = each.since.replace(now.tick) {
                pulse(each, now.tick - since, was_high);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::{Channel, Format};

    fn proposed(names: &[&str], changes: &[(u64, u64)]) -> String {
        let channels = names.iter().map(|name| Channel { name: (*name).into() }).collect();
        let changes = changes.iter().map(|&(tick, levels)| Change { tick, levels }).collect();
        let capture = Capture { channels, changes, ..Capture::new(Format::Vcd) };
        ChannelMap::proposed(&capture).to_text(&capture)
    }

    #[test]
    fn names_say_what_a_channel_is() {
        for (names, expected) in [
            (&["STEP", "DIR", "EN"][..], "STEP0=STEP,DIR0=DIR,EN=EN"),
            (&["x_step", "x_dir", "y_step", "y_dir"], "STEP0=x_step,STEP1=y_step,DIR0=x_dir,DIR1=y_dir"),
            (&["stepZ", "stepX", "nEN"], "STEP0=stepX,STEP1=stepZ,EN=!nEN"),
            (&["STEP3", "DIR3", "RX", "TX", "DE"], "STEP3=STEP3,DIR3=DIR3,RX=RX,TX=TX,DE=DE"),
            (&["top.axis1.STP", "top.axis1.DIRECTION"], "STEP1=top.axis1.STP,DIR1=top.axis1.DIRECTION"),
            (&["PUL+", "CW", "ENABLE_N"], "STEP0=PUL+,DIR0=CW,EN=!ENABLE_N"),
            (&["E0_STEP", "X_STEP"], "STEP0=X_STEP,STEP1=E0_STEP"),
            (&["D0", "D1"], ""),
            (&["BUSY", "RX"], "RX=RX"),
        ] {
            assert_eq!(proposed(names, &[]), expected, "{names:?}");
        }
    }

    #[test]
    fn where_names_say_nothing_what_the_channels_do_is_looked_at() {
        // D0 turns seldom, D1 pulses, D2 is a line of 104 ticks a bit, D3 does nothing.
        let mut edges = vec![(0, 0b100)];
        for step in 0..40_u64 {
            let dir = u64::from(step >= 20);
            edges.push((1000 * step + 500, 0b110 | dir));
            edges.push((1000 * step + 520, 0b100 | dir));
            if step == 19 {
                edges.push((1000 * step + 700, 0b101));
            }
        }
        let mut at = 50_000;
        for byte in [0x55_u64, 0x0f, 0xa3, 0x00, 0x81, 0x55] {
            let bits = byte << 1 | 1 << 9;
            for bit in 0..10 {
                let levels = 0b001 | (bits >> bit & 1) << 2;
                if edges.last().is_some_and(|(_, before)| *before != levels) {
                    edges.push((at, levels));
                }
                at += 104;
            }
        }
        edges.push((at, 0b101));
        edges.dedup_by_key(|(_, levels)| *levels);
        assert_eq!(proposed(&["D0", "D1", "D2", "D3"], &edges), "STEP0=D1,DIR0=D0,RX=D2");
        // A name that speaks rules over behaviour.
        assert_eq!(proposed(&["A", "B", "TX", "C"], &edges), "STEP0=B,DIR0=A,TX=TX");
        assert_eq!(proposed(&["STEP", "B"], &[(0, 0), (5, 2), (6, 0)]), "STEP0=STEP");
        // A lamp is no motor.
        let pulses = |count: u64| (0..2 * count).map(|at| (10 * at, at % 2)).collect::<Vec<_>>();
        assert_eq!(proposed(&["A", "B"], &pulses(3)), "");
        assert_eq!(proposed(&["A", "B"], &pulses(5)), "STEP0=A");
        // A single pulse is no step.
        assert_eq!(proposed(&["RX", "BUSY"], &[(0, 1), (5, 3), (6, 1)]), "RX=RX");
    }
}
