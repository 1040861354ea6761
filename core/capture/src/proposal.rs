//! Which signal each channel seems to be: first by its name, then, of those whose names say nothing, by what it does.
//!
//! ```text
//! name       STEP and DIR of one motor belong together (names.rs); one DIR without an axis is that of all motors without
//! behavior   A, B   edges of two channels alternate, evenly
//!            RX     pulses are whole bits of words with a stop bit; inverted where the line is low when idle
//!            STEP   the most pulses; more motors have pulses of about this width
//!            DIR    changes seldom: at both levels there are steps, and not while STEP is high, where one does so
//! ```

use crate::{
    capture::{Capture, Change},
    channel_map::{ChannelMap, Entry, Input},
    names::{AXES, Kind, Meaning, Named, are_indexed, is_of_several, shared_words},
    uart::{self, Edge},
};
use std::collections::BTreeSet;
use stepscope_peripheral::signal::{Levels, MAX_CHANNELS};

/// Changes that are looked at; what a channel is shows in its beginning.
const MAX_LOOKED_AT: usize = 1_000_000;
/// Edges by which a line is known.
const LINE_EDGES: usize = 600;
/// Pulses that a channel has to have, so that it is taken for STEP.
const MIN_STEPS: u64 = 4;
/// Edges that an encoder has to have.
const MIN_ENCODER_EDGES: usize = 16;
/// Edges by which an encoder is known.
const MAX_ENCODER_EDGES: usize = 4096;
/// Pulses of another motor are at most so many times as wide as those of the first.
const MAX_WIDTH_RATIO: u64 = 4;

const EN: u32 = Levels::EN.trailing_zeros();
const RX: u32 = Levels::RX.trailing_zeros();
const TX: u32 = Levels::TX.trailing_zeros();
const DE: u32 = Levels::DE.trailing_zeros();

impl ChannelMap {
    /// What names and behavior of the channels say; signals that nothing speaks for have no channel.
    #[must_use]
    pub fn proposed(capture: &Capture) -> Self {
        Proposal::new(capture).map()
    }
}

/// Where the steps of a motor come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    None,
    Step(usize),
    CwCcw(usize, usize),
    Encoder(usize, usize),
}

/// A motor that is being put together.
#[derive(Clone, Debug)]
struct Motor {
    axis: String,
    scope: String,
    source: Source,
    dir: Option<usize>,
    /// STEP is low where it is active.
    inverted: bool,
}

impl Motor {
    fn new(axis: &str, scope: &str, source: Source) -> Self {
        Self { axis: axis.to_owned(), scope: scope.to_owned(), source, dir: None, inverted: false }
    }

    const fn step(&self) -> Option<usize> {
        match self.source {
            Source::Step(channel) => Some(channel),
            _ => None,
        }
    }

    fn has(&self, channel: usize) -> bool {
        self.dir == Some(channel)
            || match self.source {
                Source::None => false,
                Source::Step(step) => step == channel,
                Source::CwCcw(one, other) | Source::Encoder(one, other) => one == channel || other == channel,
            }
    }

    /// Whether it steps, and nothing tells its direction.
    const fn lacks_dir(&self) -> bool {
        matches!(self.source, Source::Step(_)) && self.dir.is_none()
    }
}

/// A map that is being put together.
struct Proposal<'a> {
    capture: &'a Capture,
    meanings: Vec<Meaning>,
    changes: Vec<Change>,
    behavior: Vec<Behaviour>,
    motors: Vec<Motor>,
    /// Signals that are no motor's.
    others: Vec<Entry>,
}

impl<'a> Proposal<'a> {
    fn new(capture: &'a Capture) -> Self {
        let names = || capture.channels.iter().map(|channel| channel.name.as_str());
        let indexed = are_indexed(names());
        let changes: Vec<Change> = capture.changes.iter().take(MAX_LOOKED_AT).collect();
        let behavior = behaviours(&changes, capture.channels.len());
        let mut meanings: Vec<Meaning> = names().map(|name| Meaning::of(name, indexed)).collect();
        join(&mut meanings, names());
        number_pins(&mut meanings);
        Self { capture, meanings, changes, behavior, motors: Vec::new(), others: Vec::new() }
    }

    fn map(mut self) -> ChannelMap {
        self.others_by_name();
        self.steps_by_name();
        self.dirs_by_name();
        let named = self.motors.len();
        self.sort_motors();
        // A bit rate may fit an encoder at constant speed.
        self.encoders_by_behavior();
        self.lines_by_behavior();
        self.steps_by_behavior();
        self.dirs_by_behavior();
        self.polarity();
        self.entries(named)
    }

    fn behavior(&self, channel: usize) -> Behaviour {
        self.behavior.get(channel).copied().unwrap_or_default()
    }

    /// Channels whose names say a kind, with their names; the positive line of a pair first.
    fn named(&self, kind: Kind) -> Vec<(usize, Named)> {
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

    /// Whether two channels have the same levels throughout, or opposite ones.
    fn is_copy(&self, one: usize, other: usize) -> bool {
        let differ = |change: &Change| (change.levels >> one ^ change.levels >> other) & 1 == 1;
        let first = self.changes.first().is_some_and(differ);
        self.changes.iter().all(|change| differ(change) == first)
    }

    fn others_by_name(&mut self) {
        for (kind, bit) in [(Kind::En, EN), (Kind::Rx, RX), (Kind::Tx, TX), (Kind::De, DE)] {
            let named = self.named(kind);
            let is_line = matches!(kind, Kind::Rx | Kind::Tx);
            if let Some((channel, named)) =
                named.into_iter().find(|(channel, _)| !is_line || !self.behavior(*channel).is_pulses())
            {
                let inverts = is_line && self.behavior(channel).line == Some(true);
                self.others.push(Entry { bit, channel, inverted: named.inverted || inverts });
            }
        }
    }

    fn steps_by_name(&mut self) {
        let (steps, dirs) = (self.named(Kind::Step), self.named(Kind::Dir));
        let (cw, ccw) = (self.named(Kind::Cw), self.named(Kind::Ccw));
        for (channel, named) in &steps {
            self.add_step(*channel, named);
        }
        let mut used = Vec::new();
        for (one, named) in &cw {
            let partner = ccw.iter().filter(|(other, of)| of.axis == named.axis && !used.contains(other));
            let partner = partner.max_by_key(|(other, of)| (of.scope == named.scope, usize::MAX - other));
            let has_step = self.motors.iter().any(|motor| motor.axis == named.axis);
            match partner {
                Some((other, _)) if !has_step => {
                    used.push(*other);
                    let source = Source::CwCcw(*one, *other);
                    self.motors.push(Motor::new(&named.axis, &named.scope, source));
                }
                None if named.pulse => self.add_step(*one, named),
                _ => {}
            }
        }
        let phases = (self.named(Kind::A), self.named(Kind::B));
        for (one, named) in &phases.0 {
            let partner = phases.1.iter().filter(|(_, of)| of.axis == named.axis);
            let partner = partner.max_by_key(|(other, of)| (of.scope == named.scope, usize::MAX - other));
            let is_free = self
                .motors
                .iter()
                .all(|motor| !matches!(motor.source, Source::Encoder(..)) || motor.axis != named.axis);
            if let Some((other, _)) = partner.filter(|_| is_free) {
                self.motors.push(Motor::new(&named.axis, &named.scope, Source::Encoder(*one, *other)));
            }
        }
        if steps.is_empty() && self.motors.is_empty() {
            let has_dir = |named: &Named| {
                dirs.iter().chain(&cw).any(|(_, dir)| dir.axis == named.axis || dir.axis.is_empty())
            };
            for (channel, named) in self.named(Kind::Clock).iter().filter(|(_, named)| has_dir(named)) {
                self.add_step(*channel, named);
            }
        }
    }

    /// A motor of this STEP, unless it is that of a motor which is known: in another scope, or the other line of a pair.
    fn add_step(&mut self, channel: usize, named: &Named) {
        let is_same = |motor: &Motor| {
            motor.axis == named.axis && motor.step().is_some_and(|step| self.is_copy(step, channel))
        };
        if !self.motors.iter().any(is_same) {
            let mut motor = Motor::new(&named.axis, &named.scope, Source::Step(channel));
            motor.inverted = named.inverted;
            self.motors.push(motor);
        }
    }

    /// Each DIR goes to the motor of its name; one without an axis to all that have none.
    fn dirs_by_name(&mut self) {
        let mut dirs = self.named(Kind::Dir);
        dirs.extend(
            self.named(Kind::Cw).into_iter().filter(|(channel, named)| {
                !named.pulse && self.motors.iter().all(|motor| !motor.has(*channel))
            }),
        );
        let mut pairs: Vec<(bool, usize, usize, usize)> = Vec::new();
        let lacking: Vec<(usize, &Motor)> =
            self.motors.iter().enumerate().filter(|(_, motor)| motor.lacks_dir()).collect();
        for (at, motor) in lacking.iter().copied() {
            // As many DIR as STEP of one name: the first goes with the first.
            let is_like = |axis: &str| axis == motor.axis;
            let steps: Vec<usize> =
                lacking.iter().filter(|(_, other)| is_like(&other.axis)).map(|(at, _)| *at).collect();
            let like: Vec<usize> = (0..dirs.len())
                .filter(|place| dirs.get(*place).is_some_and(|(_, dir)| is_like(&dir.axis)))
                .collect();
            for (place, (channel, named)) in dirs.iter().enumerate() {
                if named.axis == motor.axis {
                    let order = |all: &[usize], one: usize| all.iter().position(|other| *other == one);
                    let distance = match (order(&steps, at), order(&like, place)) {
                        (Some(step), Some(dir)) if steps.len() == like.len() => step.abs_diff(dir),
                        _ => motor.step().map_or(0, |step| step.abs_diff(*channel)),
                    };
                    pairs.push((named.scope != motor.scope, distance, at, place));
                }
            }
        }
        pairs.sort_unstable();
        let mut used = vec![false; dirs.len()];
        for (_, _, at, place) in pairs {
            let Some((motor, used)) = self.motors.get_mut(at).zip(used.get_mut(place)) else { continue };
            if motor.lacks_dir() && !*used {
                motor.dir = dirs.get(place).map(|(channel, _)| *channel);
                *used = true;
            }
        }
        let free = |used: &[bool]| {
            let free = dirs.iter().zip(used).filter(|(_, used)| !**used);
            free.map(|((channel, named), _)| (*channel, named.clone())).collect::<Vec<_>>()
        };
        let left = free(&used);
        let mut nobodys = dirs.iter().filter(|(_, named)| named.axis.is_empty());
        let sole_common = nobodys.next().filter(|_| nobodys.next().is_none());
        let common = left.iter().find(|(_, named)| named.axis.is_empty()).or(sole_common);
        let common = common.map(|(channel, _)| *channel);
        // One motor and one DIR belong together, unless both say that they are of another axis.
        let sole = match (self.motors.as_slice(), left.as_slice()) {
            ([motor], [(channel, _)]) if motor.axis.is_empty() => Some(*channel),
            _ => None,
        };
        // X1 and X2 share the DIR of X; X and Y that of XY.
        let of_stem = |axis: &str| {
            let found = left.iter().find(|(_, named)| {
                !named.axis.is_empty() && stem(axis) == named.axis || is_of_several(&named.axis, axis)
            });
            found.map(|(channel, _)| *channel)
        };
        let mut taken = Vec::new();
        for motor in self.motors.iter_mut().filter(|motor| motor.lacks_dir()) {
            motor.dir = of_stem(&motor.axis).or(common).or(sole);
            taken.extend(motor.dir);
        }
        // What is left are motors of their own, whose STEP is not known.
        for (channel, named) in left {
            if !taken.contains(&channel) && self.motors.iter().all(|motor| motor.axis != named.axis) {
                let mut motor = Motor::new(&named.axis, &named.scope, Source::None);
                motor.dir = Some(channel);
                self.motors.push(motor);
            }
        }
    }

    /// Numbers first, then letters, then words in the order of the file.
    fn sort_motors(&mut self) {
        let mut stems: Vec<String> = Vec::new();
        let mut channels: Vec<(usize, usize)> = self
            .motors
            .iter()
            .enumerate()
            .filter_map(|(at, motor)| {
                Some(((0..self.meanings.len()).find(|channel| motor.has(*channel))?, at))
            })
            .collect();
        channels.sort_unstable();
        for (_, at) in &channels {
            stems.extend(self.motors.get(*at).map(|motor| stem(&motor.axis).to_owned()));
        }
        let key = |motor: &Motor| {
            let stem = stem(&motor.axis);
            let number: u64 =
                motor.axis.get(stem.len()..).and_then(|digits| digits.parse().ok()).unwrap_or(0);
            let letter = AXES.find(stem).filter(|_| stem.len() == 1);
            let place = stems.iter().position(|other| *other == stem);
            let class = if stem.is_empty() { 0 } else { letter.map_or(2, |_| 1) };
            (class, if class == 2 { place } else { letter }, number)
        };
        self.motors.sort_by_cached_key(key);
    }

    /// Channels that no name says anything of, and that change.
    fn free(&self) -> Vec<usize> {
        let is_free = |channel: &usize| {
            self.behavior(*channel).changes() > 0
                && self.motors.iter().all(|motor| !motor.has(*channel))
                && self.others.iter().all(|entry| entry.channel != *channel)
                && !matches!(self.meanings.get(*channel), Some(Meaning::Other))
        };
        // The lines of a name that stands for another signal already, as a second EN, are none of these, either.
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

    fn is_line(&self, channel: usize) -> bool {
        self.behavior(channel).line.is_some()
    }

    fn lines_by_behavior(&mut self) {
        let lines = self.free().into_iter().filter(|channel| self.is_line(*channel));
        for (bit, channel) in [RX, TX].into_iter().zip(lines.collect::<Vec<_>>()) {
            if self.others.iter().all(|entry| entry.bit != bit) {
                let inverted = self.behavior(channel).line == Some(true);
                self.others.push(Entry { bit, channel, inverted });
            }
        }
    }

    /// Channels that may be of a motor: none of them is a line.
    fn free_of_lines(&self) -> Vec<usize> {
        self.free().into_iter().filter(|channel| !self.is_line(*channel)).collect()
    }

    /// When a channel changes.
    fn edges(&self, channel: usize) -> Vec<u64> {
        let pairs = self.changes.iter().zip(self.changes.iter().skip(1));
        let changed = pairs.filter(|(before, now)| (before.levels ^ now.levels) >> channel & 1 == 1);
        changed.map(|(_, now)| now.tick).collect()
    }

    fn encoders_by_behavior(&mut self) {
        let busy = |channel: &usize| self.behavior(*channel).changes() >= MIN_ENCODER_EDGES as u64 / 2;
        let free: Vec<usize> = self.free().into_iter().filter(busy).collect();
        let edges: Vec<Vec<u64>> = free
            .iter()
            .map(|channel| {
                let mut edges = self.edges(*channel);
                edges.truncate(MAX_ENCODER_EDGES);
                edges
            })
            .collect();
        let mut used: Vec<usize> = Vec::new();
        for (at, (one, one_edges)) in free.iter().zip(&edges).enumerate() {
            for (other, other_edges) in free.iter().zip(&edges).skip(at + 1) {
                let (a, b) = (self.behavior(*one).changes(), self.behavior(*other).changes());
                let is_free = !used.contains(one) && !used.contains(other);
                if is_free && a.abs_diff(b) * 20 <= a + b && alternate(one_edges, other_edges) {
                    used.extend([*one, *other]);
                    self.motors.push(Motor::new("", "", Source::Encoder(*one, *other)));
                }
            }
        }
    }

    fn steps_by_behavior(&mut self) {
        if self.motors.iter().any(|motor| matches!(motor.source, Source::Step(_) | Source::CwCcw(..))) {
            return;
        }
        let busy = |channel: &usize| self.behavior(*channel).changes() >= 2 * MIN_STEPS;
        let free: Vec<usize> = self.free_of_lines().into_iter().filter(busy).collect();
        let busiest = free
            .iter()
            .copied()
            .max_by_key(|channel| (self.behavior(*channel).changes(), usize::MAX - channel));
        let Some(first) = busiest else { return };
        let first_edges = self.edges(first);
        let widest = self.behavior(first).longest_pulse().saturating_mul(MAX_WIDTH_RATIO);
        for channel in free {
            let own = self.behavior(channel);
            let is_slow = || has_steps_between(&self.edges(channel), &first_edges, 80);
            if channel != first && (own.longest_pulse() > widest || is_slow()) {
                continue;
            }
            let source = Source::Step(channel);
            // A DIR that is named may be that of the only motor.
            match self.motors.iter_mut().find(|motor| motor.source == Source::None) {
                Some(motor) => motor.source = source,
                None => self.motors.push(Motor::new("", "", source)),
            }
        }
    }

    fn dirs_by_behavior(&mut self) {
        let steps: Vec<(usize, usize, Vec<u64>)> = self
            .motors
            .iter()
            .enumerate()
            .filter(|(_, motor)| motor.lacks_dir())
            .filter_map(|(at, motor)| Some((at, motor.step()?, self.edges(motor.step()?))))
            .filter(|(.., edges)| edges.len() as u64 >= MIN_STEPS)
            .collect();
        if steps.is_empty() {
            return;
        }
        let free = self.free_of_lines();
        let name =
            |channel: usize| self.capture.channels.get(channel).map_or("", |channel| channel.name.as_str());
        let mut pairs: Vec<(Fit, usize, usize)> = Vec::new();
        for channel in &free {
            let changes = self.edges(*channel);
            let near: Vec<u64> = steps.iter().map(|(.., edges)| nearness(&changes, edges)).collect();
            for (place, (at, step, edges)) in steps.iter().enumerate() {
                if changes.len() * 2 > edges.len() {
                    continue;
                }
                let own = near.get(place).copied().unwrap_or(u64::MAX);
                let others = || near.iter().zip(&steps).enumerate().filter(|(other, _)| *other != place);
                // Names decide before behavior: X-Foo and X-Bar are of one motor.
                let shared = |step: usize| shared_words(name(step), name(*channel));
                let by_name = steps.iter().map(|(_, step, _)| shared(*step));
                let (most, least) = (by_name.clone().max(), by_name.min());
                let is_others = if most > least {
                    Some(shared(*step)) < most
                } else {
                    others().any(|(_, (near, (.., edges)))| {
                        near.saturating_mul(2) < own && is_next_to(*near, changes.len(), edges)
                    })
                };
                let others = others().map(|(_, (near, _))| *near).min().unwrap_or(u64::MAX);
                let fit = Fit {
                    is_others,
                    is_shared: steps.len() > 1 && own.saturating_mul(2) >= others,
                    one_level: !self.steps_at_both_levels(*channel, *step),
                    while_high: !self.changes_between_pulses(*channel, *step),
                    is_out_of_order: false,
                    distance: step.abs_diff(*channel),
                };
                if !fit.while_high || has_steps_between(&changes, edges, 50) {
                    pairs.push((fit, *channel, *at));
                }
            }
        }
        // As many as there are motors: the first goes with the first, whether DIR comes before STEP or after it.
        let fitting = pairs.iter().filter(|(fit, ..)| !fit.one_level).map(|(_, channel, _)| *channel);
        let fitting: BTreeSet<usize> = fitting.collect();
        let is_one_each = fitting.len() == steps.len();
        if is_one_each {
            let mut by_channel: Vec<usize> = steps.iter().map(|(_, step, _)| *step).collect();
            by_channel.sort_unstable();
            for (fit, channel, at) in &mut pairs {
                let step = steps.iter().find(|(motor, ..)| motor == at).map(|(_, step, _)| *step);
                let own = by_channel.iter().position(|other| Some(*other) == step);
                fit.is_out_of_order = fitting.iter().position(|other| other == channel) != own;
            }
        }
        pairs.sort_unstable();
        let dirs: Vec<usize> = pairs.iter().map(|(_, channel, _)| *channel).collect();
        let is_sole = dirs.iter().all(|channel| dirs.first() == Some(channel));
        let mut used = Vec::new();
        for (fit, channel, at) in pairs {
            let is_common = is_sole && fit.is_shared && !fit.is_others;
            if fit.is_others && !is_one_each || used.contains(&channel) && !is_common {
                continue;
            }
            if let Some(motor) = self.motors.get_mut(at).filter(|motor| motor.lacks_dir()) {
                motor.dir = Some(channel);
                used.push(channel);
            }
        }
    }

    /// Whether STEP is active at each level of a channel now and then.
    fn steps_at_both_levels(&self, channel: usize, step: usize) -> bool {
        let mut levels = [false; 2];
        for (before, now) in self.changes.iter().zip(self.changes.iter().skip(1)) {
            if (before.levels ^ now.levels) >> step & 1 == 1
                && let Some(level) = levels.get_mut((now.levels >> channel & 1) as usize)
            {
                *level = true;
            }
        }
        levels == [true; 2]
    }

    /// Whether a channel only changes while STEP is idle.
    fn changes_between_pulses(&self, channel: usize, step: usize) -> bool {
        let idle = u64::from(self.behavior(step).idles_high());
        let mut pairs = self.changes.iter().zip(self.changes.iter().skip(1));
        pairs.all(|(before, now)| {
            (before.levels ^ now.levels) >> channel & 1 == 0 || before.levels >> step & 1 == idle
        })
    }

    /// Whether STEP is active low: where its name says so, or says nothing, and it idles high.
    fn polarity(&mut self) {
        let low = |motor: &Motor| {
            let channel = motor.step()?;
            let is_said = match self.meanings.get(channel) {
                Some(Meaning::Signal(named)) if named.kind == Kind::Step => !named.negative,
                _ => false,
            };
            (!is_said).then(|| self.behavior(channel).idles_high())
        };
        let low: Vec<Option<bool>> = self.motors.iter().map(low).collect();
        for (motor, low) in self.motors.iter_mut().zip(low) {
            motor.inverted = low.unwrap_or(motor.inverted);
        }
    }

    /// The map: motors that are numbered in the file keep their numbers, the others are counted.
    fn entries(self, named: usize) -> ChannelMap {
        let number = |motor: &Motor| if motor.axis.is_empty() { Ok(0) } else { motor.axis.parse::<u32>() };
        let numbers: Vec<u32> =
            self.motors.iter().take(named).filter_map(|motor| number(motor).ok()).collect();
        let is_distinct = numbers.windows(2).all(|pair| matches!(pair, [one, next] if one < next));
        let keep = numbers.len() == named
            && is_distinct
            && numbers.iter().all(|number| *number < MAX_CHANNELS as u32);
        let mut taken = BTreeSet::new();
        let mut entries = self.others.clone();
        for (at, motor) in self.motors.iter().enumerate() {
            let own = numbers.get(at).copied().filter(|_| keep && at < named);
            let Some(place) = own.or_else(|| (0..MAX_CHANNELS as u32).find(|place| !taken.contains(place)))
            else {
                break;
            };
            taken.insert(place);
            let mut add = |input: Input, channel: usize, inverted: bool| {
                entries.push(Entry { bit: input.bit(place), channel, inverted });
            };
            let is_low = |channel: usize| {
                self.behavior(channel).idles_high()
                    || matches!(self.meanings.get(channel), Some(Meaning::Signal(named)) if named.inverted)
            };
            match motor.source {
                Source::None => {}
                Source::Step(channel) => add(Input::Step, channel, motor.inverted),
                Source::CwCcw(one, other) => {
                    add(Input::Cw, one, is_low(one));
                    add(Input::Ccw, other, is_low(other));
                }
                Source::Encoder(one, other) => {
                    add(Input::A, one, false);
                    add(Input::B, other, false);
                }
            }
            if let Some(channel) = motor.dir {
                add(Input::Dir, channel, false);
            }
        }
        ChannelMap::of(entries)
    }
}

/// Names of one word, `FLSTEP` and `FLDIR`, mean something where STEP and DIR have the same rest.
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

/// Numbers of pins are not those of motors: as many STEP as DIR, and no number twice. They are paired in order.
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

/// An axis without its number.
fn stem(axis: &str) -> &str {
    axis.trim_end_matches(|c: char| c.is_ascii_digit())
}

/// How well a channel fits as DIR of a motor: the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Fit {
    /// It changes next to the pulses of another motor.
    is_others: bool,
    one_level: bool,
    while_high: bool,
    /// Its place among such channels is not that of the motor's STEP among those of all motors.
    is_out_of_order: bool,
    distance: usize,
    /// It changes as close to the pulses of another motor.
    is_shared: bool,
}

/// How close the changes of a channel are to a motor's edges: the sum of the times to the next one, before or after.
fn nearness(changes: &[u64], edges: &[u64]) -> u64 {
    let near = |at: &u64| {
        let next = edges.partition_point(|edge| edge < at);
        let after = edges.get(next).map_or(u64::MAX, |edge| edge - at);
        let before = next.checked_sub(1).and_then(|last| edges.get(last)).map_or(u64::MAX, |edge| at - edge);
        after.min(before)
    };
    changes.iter().map(near).fold(0, u64::saturating_add)
}

/// Whether changes with this sum of distances come right before or after pulses: far within the shortest interval from
/// pulse to pulse. A change in the middle of an interval says nothing of whose it is.
fn is_next_to(nearness: u64, changes: usize, edges: &[u64]) -> bool {
    let intervals = edges.iter().zip(edges.iter().skip(2)).map(|(from, to)| to - from);
    let shortest = intervals.min().unwrap_or(0);
    nearness.saturating_mul(20) <= shortest.saturating_mul(changes as u64)
}

/// Whether there are steps between so many percent of the changes of a channel.
fn has_steps_between(changes: &[u64], edges: &[u64], percent: usize) -> bool {
    let place = |at: &u64| edges.partition_point(|edge| edge <= at);
    let between = changes.iter().zip(changes.iter().skip(1));
    let with_steps = between.filter(|(from, to)| place(to) > place(from) + 1).count();
    with_steps * 100 >= changes.len().saturating_sub(1) * percent
}

/// Whether the edges of two channels alternate, as evenly as those of an encoder do.
fn alternate(one: &[u64], other: &[u64]) -> bool {
    // As far as both are given.
    let end = one.last().min(other.last()).copied().unwrap_or(0);
    let until = |edges: &&u64| **edges <= end;
    let first = one.iter().take_while(until).map(|at| (*at, false));
    let mut all: Vec<(u64, bool)> =
        first.chain(other.iter().take_while(until).map(|at| (*at, true))).collect();
    all.sort_unstable();
    let pairs = || all.iter().zip(all.iter().skip(1));
    let (count, same) = (all.len(), pairs().filter(|(edge, next)| edge.1 == next.1).count());
    let at_once = pairs().filter(|(edge, next)| edge.0 == next.0).count();
    let intervals: Vec<u64> = pairs().map(|(edge, next)| next.0 - edge.0).collect();
    let is_even = |pair: &&[u64]| matches!(pair, [one, next] if one.saturating_mul(4) >= *next && next.saturating_mul(4) >= *one);
    let even = intervals.windows(2).filter(is_even).count();
    count >= MIN_ENCODER_EDGES
        && same * 20 <= count
        && at_once * 50 <= count
        && even * 10 >= intervals.len().saturating_sub(1) * 7
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
    /// Longest time at a level between two changes, and the shortest.
    longest_high: u64,
    longest_low: u64,
    shortest_high: u64,
    shortest_low: u64,
    /// When it changed last.
    since: Option<u64>,
    /// Whether it is a serial line, and inverted.
    line: Option<bool>,
}

impl Behaviour {
    fn changes(&self) -> u64 {
        self.rises + self.falls
    }

    /// Whether its pulses are low.
    const fn idles_high(&self) -> bool {
        self.first && self.high > self.low
    }

    /// The widest of its pulses.
    const fn longest_pulse(&self) -> u64 {
        if self.idles_high() { self.longest_low } else { self.longest_high }
    }

    /// Pulses of one width, low at rest, as no line has them.
    const fn is_pulses(&self) -> bool {
        !self.first
            && !self.last
            && self.rises >= 2 * MIN_STEPS
            && self.longest_high <= self.shortest_high.saturating_mul(2)
    }
}

/// What each channel does.
fn behaviours(changes: &[Change], channels: usize) -> Vec<Behaviour> {
    let never = u64::MAX;
    let none = Behaviour { shortest_high: never, shortest_low: never, ..Behaviour::default() };
    let mut all = vec![none; channels];
    let (Some(first), Some(last)) = (changes.first(), changes.last()) else { return all };
    for (channel, each) in all.iter_mut().enumerate() {
        (each.first, each.last) = (first.levels >> channel & 1 == 1, last.levels >> channel & 1 == 1);
    }
    each_pulse(changes, &mut all, &mut |each, length, high| {
        *(if high { &mut each.high } else { &mut each.low }) += length;
        let longest = if high { &mut each.longest_high } else { &mut each.longest_low };
        *longest = length.max(*longest);
        let shortest = if high { &mut each.shortest_high } else { &mut each.shortest_low };
        *shortest = length.min(*shortest);
    });
    let mut edges: Vec<Vec<Edge>> = vec![Vec::new(); channels];
    for pair in changes.windows(2) {
        let [before, now] = pair else { continue };
        let mut changed = before.levels ^ now.levels;
        while changed != 0 {
            let channel = changed.trailing_zeros();
            changed &= changed - 1;
            if let Some(edges) = edges.get_mut(channel as usize).filter(|edges| edges.len() < LINE_EDGES) {
                edges.push(Edge { at: now.tick, high: now.levels >> channel & 1 == 1 });
            }
        }
    }
    for (each, edges) in all.iter_mut().zip(&edges) {
        each.line = uart::looks_like_a_line(edges);
    }
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
            // An axis before, behind, in brackets, as a word, in the scope, and one DIR.
            (&["STEP (Y axis)", "DIR (Y axis)"], "STEP0=STEP (Y axis),DIR0=DIR (Y axis)"),
            (&["STEP (Y axis)", "DIR"], "STEP0=STEP (Y axis),DIR0=DIR"),
            (
                &["RA_STEP", "RA_DIR", "DEC_STEP", "DEC_DIR"],
                "STEP0=RA_STEP,STEP1=DEC_STEP,DIR0=RA_DIR,DIR1=DEC_DIR",
            ),
            (
                &["dec_dir", "ra_dir", "ra_step", "dec_step"],
                "STEP0=dec_step,STEP1=ra_step,DIR0=dec_dir,DIR1=ra_dir",
            ),
            (&["2: STEP", "3: DIR"], "STEP0=2: STEP,DIR0=3: DIR"),
            (&["0 STEP", "1 DIR"], "STEP0=0 STEP,DIR0=1 DIR"),
            (&["D2: X_STEP", "D3: Y_STEP"], "STEP0=D2: X_STEP,STEP1=D3: Y_STEP"),
            (
                &["motor10_step", "motor2_step", "motor2_dir"],
                "STEP2=motor2_step,STEP10=motor10_step,DIR2=motor2_dir",
            ),
            (
                &["motor20_step", "motor3_step", "motor3_dir"],
                "STEP0=motor3_step,STEP1=motor20_step,DIR0=motor3_dir",
            ),
            (&["feed12_step", "feed3_step"], "STEP0=feed3_step,STEP1=feed12_step"),
            (&["step_en", "step", "dir"], "STEP0=step,DIR0=dir,EN=step_en"),
            (
                &["motorStep", "motorDir", "StepX", "DirX"],
                "STEP0=motorStep,STEP1=StepX,DIR0=motorDir,DIR1=DirX",
            ),
            (&["X_STEP_PIN", "X_DIR_PIN", "X_ENABLE_PIN"], "STEP0=X_STEP_PIN,DIR0=X_DIR_PIN,EN=X_ENABLE_PIN"),
            (
                &["stepper_x_step", "stepper_x_dir", "stepper_z1_step"],
                "STEP0=stepper_x_step,STEP1=stepper_z1_step,DIR0=stepper_x_dir",
            ),
            (
                &["stepgen.0.step", "stepgen.0.dir", "stepgen.1.step"],
                "STEP0=stepgen.0.step,STEP1=stepgen.1.step,DIR0=stepgen.0.dir",
            ),
            (&["PUL-", "DIR-", "ENA-"], "STEP0=PUL-,DIR0=DIR-,EN=ENA-"),
            (&["PUL-", "PUL+", "DIR+"], "STEP0=PUL+,DIR0=DIR+"),
            (&["CLK", "DIR"], "STEP0=CLK,DIR0=DIR"),
            (&["CLK", "CW"], "STEP0=CLK,DIR0=CW"),
            (&["clk", "STEP", "DIR"], "STEP0=STEP,DIR0=DIR"),
            (&["Step Pulse", "Direction"], "STEP0=Step Pulse,DIR0=Direction"),
            (&["PUL/CW", "DIR/CCW"], "STEP0=PUL/CW,DIR0=DIR/CCW"),
            (&["nSTEP", "DIR"], "STEP0=!nSTEP,DIR0=DIR"),
            // A motor without DIR takes none of another's, but one that is of no motor.
            (&["X_STEP", "Y_STEP", "Y_DIR"], "STEP0=X_STEP,STEP1=Y_STEP,DIR1=Y_DIR"),
            (&["X_STEP", "Y_DIR"], "STEP0=X_STEP,DIR1=Y_DIR"),
            (&["X_STEP", "Y_STEP", "DIR"], "STEP0=X_STEP,STEP1=Y_STEP,DIR0=DIR,DIR1=DIR"),
            (&["X_STEP", "Y_STEP", "Y_DIR", "DIR"], "STEP0=X_STEP,STEP1=Y_STEP,DIR0=DIR,DIR1=Y_DIR"),
            (&["X1_STEP", "X2_STEP", "X_DIR"], "STEP0=X1_STEP,STEP1=X2_STEP,DIR0=X_DIR,DIR1=X_DIR"),
            (&["motion.STEP", "ctrl.DIR"], "STEP0=motion.STEP,DIR0=ctrl.DIR"),
            // The same signal in two scopes.
            (&["tb.STEP", "tb.DIR", "tb.dut.STEP", "tb.dut.DIR"], "STEP0=tb.STEP,DIR0=tb.DIR"),
            (&["CW", "CCW"], "CW0=CW,CCW0=CCW"),
            (&["X CW+", "X CCW+", "EN"], "CW0=X CW+,CCW0=X CCW+,EN=EN"),
            (&["PUL_CW", "PUL_CCW"], "CW0=PUL_CW,CCW0=PUL_CCW"),
            (&["UP", "DOWN"], "CW0=UP,CCW0=DOWN"),
            (&["power_up", "power_down"], ""),
            (&["ENC_A", "ENC_B", "ENC_Z"], "A0=ENC_A,B0=ENC_B"),
            (&["PHA", "PHB", "STEP"], "STEP0=STEP,A1=PHA,B1=PHB"),
            (
                &["X_STEP", "X_DIR", "SPINDLE_ENC_A", "SPINDLE_ENC_B"],
                "STEP0=X_STEP,A1=SPINDLE_ENC_A,B1=SPINDLE_ENC_B,DIR0=X_DIR",
            ),
            (&["step_count[0]", "step_count[1]", "microstep", "step_led", "next_step"], ""),
            // Left and right, pins, one word, German.
            (&["LSTEP", "LDIR", "RSTEP", "RDIR"], "STEP0=LSTEP,STEP1=RSTEP,DIR0=LDIR,DIR1=RDIR"),
            (&["STEPL", "STEPR", "DIRR", "DIRL"], "STEP0=STEPL,STEP1=STEPR,DIR0=DIRL,DIR1=DIRR"),
            (&["FLSTEP", "FRSTEP", "FLDIR", "FRDIR"], "STEP0=FLSTEP,STEP1=FRSTEP,DIR0=FLDIR,DIR1=FRDIR"),
            (&["TIMESTEP", "REDIR"], ""),
            (
                &["STEPPIN_X", "DIRPIN_X", "STEPPIN_Y", "DIRPIN_Y"],
                "STEP0=STEPPIN_X,STEP1=STEPPIN_Y,DIR0=DIRPIN_X,DIR1=DIRPIN_Y",
            ),
            (&["stepPin1", "dirPin1"], "STEP1=stepPin1,DIR1=dirPin1"),
            (
                &["X-Takt", "Y-Takt", "X-Richtung", "Y-Richtung"],
                "STEP0=X-Takt,STEP1=Y-Takt,DIR0=X-Richtung,DIR1=Y-Richtung",
            ),
            (&["DIRECTION_CHANGED", "STEPS_LEFT", "STEP", "DIR"], "STEP0=STEP,DIR0=DIR"),
            // One DIR for several motors, by its name.
            (&["STEP", "STEP2", "DIR"], "STEP0=STEP,STEP2=STEP2,DIR0=DIR,DIR2=DIR"),
            (&["X_STEP", "Y_STEP", "DIR_BOTH"], "STEP0=X_STEP,STEP1=Y_STEP,DIR0=DIR_BOTH,DIR1=DIR_BOTH"),
            (&["STEP0", "STEP1", "COMMON_DIR"], "STEP0=STEP0,STEP1=STEP1,DIR0=COMMON_DIR,DIR1=COMMON_DIR"),
            (&["STEP0", "STEP1", "DIR_ALL"], "STEP0=STEP0,STEP1=STEP1,DIR0=DIR_ALL,DIR1=DIR_ALL"),
            (&["STEP0", "STEP1", "DIR_SHARED"], "STEP0=STEP0,STEP1=STEP1,DIR0=DIR_SHARED,DIR1=DIR_SHARED"),
            (&["X_STEP", "Y_STEP", "XY_DIR"], "STEP0=X_STEP,STEP1=Y_STEP,DIR0=XY_DIR,DIR1=XY_DIR"),
            (&["X_STEP", "Y_STEP", "XYDIR"], "STEP0=X_STEP,STEP1=Y_STEP,DIR0=XYDIR,DIR1=XYDIR"),
            (
                &["X_STEP", "Y_STEP", "Z_STEP", "DIR X/Y", "Z_DIR"],
                "STEP0=X_STEP,STEP1=Y_STEP,STEP2=Z_STEP,DIR0=DIR X/Y,DIR1=DIR X/Y,DIR2=Z_DIR",
            ),
            // Numbers of pins.
            (
                &["pin3_step", "pin4_dir", "pin5_step", "pin6_dir"],
                "STEP0=pin3_step,STEP1=pin5_step,DIR0=pin4_dir,DIR1=pin6_dir",
            ),
            (&["step2", "step3", "dir5", "dir6"], "STEP0=step2,STEP1=step3,DIR0=dir5,DIR1=dir6"),
            (&["DE/RE", "RS485_TX", "RS485_RX"], "RX=RS485_RX,TX=RS485_TX,DE=DE/RE"),
        ] {
            assert_eq!(proposed(names, &[]), expected, "{names:?}");
        }
    }

    /// Levels of channels by the times of their edges; all are low at first, those of `high` high.
    fn levels(high: u64, edges: &[&[u64]]) -> Vec<(u64, u64)> {
        let mut all: Vec<(u64, u64)> = Vec::new();
        for (channel, edges) in edges.iter().enumerate() {
            all.extend(edges.iter().map(|at| (*at, 1 << channel)));
        }
        all.sort_unstable();
        let (mut now, mut rows) = (high, vec![(0, high)]);
        for (at, mask) in all {
            now ^= mask;
            match rows.last_mut() {
                Some(row) if row.0 == at => row.1 = now,
                _ => rows.push((at, now)),
            }
        }
        rows
    }

    /// Edges of so many pulses.
    fn pulses(from: u64, count: u64, interval: u64, width: u64) -> Vec<u64> {
        (0..count).flat_map(|k| [from + k * interval, from + k * interval + width]).collect()
    }

    #[test]
    fn a_dir_is_found_by_when_it_changes() {
        let step = pulses(100, 40, 100, 10);
        // Right after a rise; a lamp that blinks without regard to it is further off; one that is no DIR by its name.
        let late = [2101, 3101];
        for (names, high, edges, expected) in [
            (&["D0", "D1"][..], 0b10, &[&step[..], &late][..], "STEP0=D0,DIR0=D1"),
            (&["D0", "D1"], 0b01, &[&late, &step], "STEP0=D1,DIR0=D0"),
            (&["STEP", "D1", "LED"], 0, &[&step, &late, &[2050, 3050]], "STEP0=STEP,DIR0=D1"),
            (&["STEP", "LED"], 0, &[&step, &[2050, 3050]], "STEP0=STEP"),
            // An enable is high throughout the steps, before DIR.
            (&["D0", "D1", "D2"], 0, &[&step, &[50, 4200], &[2050]], "STEP0=D0,DIR0=D2"),
            (&["RX", "D1"], 0, &[&step, &late], "STEP0=RX,DIR0=D1"),
            (&["D0", "DIR"], 0, &[&step, &late], "STEP0=D0,DIR0=DIR"),
            // A DIR that turns every two steps of a square wave, and a busier channel that is no DIR.
            (&["D0", "D1"], 0, &[&pulses(100, 60, 20, 10), &pulses(95, 15, 80, 40)], "STEP0=D0,DIR0=D1"),
            (&["D0", "D1"], 0, &[&step, &pulses(130, 39, 100, 7)], "STEP0=D0,STEP1=D1"),
        ] {
            assert_eq!(proposed(names, &levels(high, edges)), expected, "{names:?}");
        }
    }

    #[test]
    fn each_motor_gets_the_dir_that_changes_next_to_its_pulses() {
        let (x, y, z) = (pulses(100, 60, 100, 10), pulses(137, 50, 117, 10), pulses(151, 40, 131, 12));
        let (dx, dy, dz) = ([2095, 4095], [137 + 117 * 20 - 5], [151 + 131 * 11 - 5, 151 + 131 * 31 - 5]);
        let found = proposed(&["D0", "D1", "D2", "D3", "D4", "D5"], &levels(0, &[&x, &dx, &y, &dy, &z, &dz]));
        assert_eq!(found, "STEP0=D0,STEP1=D2,STEP2=D4,DIR0=D1,DIR1=D3,DIR2=D5");
        let found = proposed(&["D0", "D1", "D2", "D3", "D4", "D5"], &levels(0, &[&x, &y, &z, &dz, &dx, &dy]));
        assert_eq!(found, "STEP0=D0,STEP1=D1,STEP2=D2,DIR0=D4,DIR1=D5,DIR2=D3");
        // Changes in the middle of an interval are nobody's: each motor has the DIR next to its STEP.
        let (x, y) = (pulses(1000, 18, 500, 5), pulses(1137, 16, 571, 5));
        let found = proposed(&["D0", "D1", "D2", "D3"], &levels(0, &[&x, &[6750], &y, &[4849]]));
        assert_eq!(found, "STEP0=D0,STEP1=D2,DIR0=D1,DIR1=D3");
        let found = proposed(&["D0", "D1", "D2", "D3"], &levels(0, &[&[6750], &x, &[4849], &y]));
        assert_eq!(found, "STEP0=D1,STEP1=D3,DIR0=D0,DIR1=D2");
        // Names decide before behavior.
        let names = ["X-Foo", "Y-Foo", "Y-Bar", "X-Bar"];
        let (near_x, near_y) = ([2095], [137 + 117 * 20 - 5]);
        let (x, y) = (pulses(100, 60, 100, 10), pulses(137, 50, 117, 10));
        let found = proposed(&names, &levels(0, &[&x, &y, &near_x, &near_y]));
        assert_eq!(found, "STEP0=X-Foo,STEP1=Y-Foo,DIR0=X-Bar,DIR1=Y-Bar");
        // Both turn where the one channel changes.
        let (x, y) = (pulses(100, 40, 100, 10), pulses(140, 40, 100, 10));
        let found = proposed(&["X_STEP", "Y_STEP", "D2"], &levels(0, &[&x, &y, &[2130, 3120]]));
        assert_eq!(found, "STEP0=X_STEP,STEP1=Y_STEP,DIR0=D2,DIR1=D2");
        let found = proposed(&["X_STEP", "Y_STEP", "D2"], &levels(0, &[&x, &y, &[2137, 3138]]));
        assert_eq!(found, "STEP0=X_STEP,STEP1=Y_STEP,DIR1=D2");
    }

    #[test]
    fn an_idle_level_that_is_high_inverts_what_no_name_says() {
        let step = pulses(100, 40, 100, 10);
        for (name, expected) in [
            ("D0", "STEP0=!D0"),
            ("PUL-", "STEP0=!PUL-"),
            ("STEP", "STEP0=STEP"),
            ("STEP_N", "STEP0=!STEP_N"),
        ] {
            assert_eq!(proposed(&[name], &levels(1, &[&step])), expected);
        }
        let both = levels(3, &[&step, &pulses(9000, 20, 100, 10)]);
        assert_eq!(proposed(&["CW-", "CCW-"], &both), "CW0=!CW-,CCW0=!CCW-");
    }

    #[test]
    fn edges_that_alternate_are_an_encoder() {
        let a: Vec<u64> = (0..40).map(|k| 100 + 40 * k + k % 3).collect();
        let b: Vec<u64> = (0..40).map(|k| 120 + 40 * k + k % 5).collect();
        assert_eq!(proposed(&["D0", "D1"], &levels(0, &[&a, &b])), "A0=D0,B0=D1");
        // At constant speed, with turns, a bit rate fits each channel.
        let (mut a, mut b, mut at) = (Vec::new(), Vec::new(), 1000);
        for edges in [41, 33, 27, 60, 39] {
            for _ in 0..edges {
                let is_a = a.len() == b.len();
                if is_a {
                    a.push(at)
                } else {
                    b.push(at)
                }
                at += 100;
            }
        }
        assert_eq!(proposed(&["D0", "D1"], &levels(0, &[&a, &b])), "A0=D0,B0=D1");
        // Pulses that overlap are not spaced like its edges, and STEP with DIR does not alternate.
        let overlapping = [&pulses(100, 40, 400, 10)[..], &pulses(105, 40, 400, 10)];
        assert_eq!(proposed(&["D0", "D1"], &levels(0, &overlapping)), "STEP0=D0,STEP1=D1");
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
