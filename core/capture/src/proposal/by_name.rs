//! Pairs STEP and DIR by their names.

use super::draft::Draft;
use super::motor::{Motor, Source, stem};
use crate::names::{AXES, Kind, SignalName, includes_axis};
use crate::{channel_map::Entry, uart::IdleLevel};
use stepscope_peripheral::signal::Levels;

const EN: u32 = Levels::EN.trailing_zeros();
const RX: u32 = Levels::RX.trailing_zeros();
const TX: u32 = Levels::TX.trailing_zeros();
const DE: u32 = Levels::DE.trailing_zeros();

impl Draft<'_> {
    /// Assigns EN, RX, TX and DE.
    pub(super) fn bus_signals_by_name(&mut self) {
        for (kind, bit) in [(Kind::En, EN), (Kind::Rx, RX), (Kind::Tx, TX), (Kind::De, DE)] {
            let named = self.named(kind);
            let is_line = matches!(kind, Kind::Rx | Kind::Tx);
            let may_be = |channel: usize| !is_line || !self.behavior(channel).has_uniform_pulses();
            if let Some((channel, named)) = named.into_iter().find(|(channel, _)| may_be(*channel)) {
                let idles_low = is_line && self.behavior(channel).line == Some(IdleLevel::Low);
                self.bus_signals.push(Entry { bit, channel, inverted: named.inverted || idles_low });
            }
        }
    }

    pub(super) fn steps_by_name(&mut self) {
        let steps = self.named(Kind::Step);
        for (channel, named) in &steps {
            self.add_step(*channel, named);
        }
        self.cw_ccw_by_name();
        self.encoders_by_name();
        if steps.is_empty() && self.motors.is_empty() {
            let dirs = [self.named(Kind::Dir), self.named(Kind::Cw)].concat();
            let has_dir = |named: &SignalName| {
                dirs.iter().any(|(_, dir)| dir.axis == named.axis || dir.axis.is_empty())
            };
            for (channel, named) in self.named(Kind::Clock).iter().filter(|(_, named)| has_dir(named)) {
                self.add_step(*channel, named);
            }
        }
    }

    fn cw_ccw_by_name(&mut self) {
        let mut ccw = self.named(Kind::Ccw);
        for (channel, named) in &self.named(Kind::Cw) {
            let has_step = self.motors.iter().any(|motor| motor.axis == named.axis);
            match partner(named, &ccw) {
                Some(other) if !has_step => {
                    ccw.retain(|(channel, _)| *channel != other);
                    self.motors.push(Motor::new(&named.axis, &named.scope, Source::CwCcw(*channel, other)));
                }
                None if named.is_pulse => self.add_step(*channel, named),
                _ => {}
            }
        }
    }

    fn encoders_by_name(&mut self) {
        let b = self.named(Kind::B);
        for (channel, named) in &self.named(Kind::A) {
            let is_of_axis =
                |motor: &Motor| matches!(motor.source, Source::Encoder(..)) && motor.axis == named.axis;
            if let Some(other) = partner(named, &b)
                && !self.motors.iter().any(is_of_axis)
            {
                self.motors.push(Motor::new(&named.axis, &named.scope, Source::Encoder(*channel, other)));
            }
        }
    }

    /// Adds a motor, unless the channel is a copy of a known STEP: in another scope, or the other line of a pair.
    fn add_step(&mut self, channel: usize, named: &SignalName) {
        let is_same = |motor: &Motor| {
            motor.axis == named.axis && motor.step().is_some_and(|step| self.is_copy(step, channel))
        };
        if !self.motors.iter().any(is_same) {
            let mut motor = Motor::new(&named.axis, &named.scope, Source::Step(channel));
            motor.inverted = named.inverted;
            self.motors.push(motor);
        }
    }

    /// Pairs motors with the DIR of their axis, then shares the others.
    pub(super) fn dirs_by_name(&mut self) {
        let dirs = self.named_dirs();
        let mut used = vec![false; dirs.len()];
        for Pair { motor, dir, .. } in self.pairs_of_one_axis(&dirs) {
            let Some((motor, used)) = self.motors.get_mut(motor).zip(used.get_mut(dir)) else { continue };
            if motor.lacks_dir() && !*used {
                motor.dir = dirs.get(dir).map(|(channel, _)| *channel);
                *used = true;
            }
        }
        let unused = dirs.iter().zip(used).filter(|(_, used)| !used).map(|(dir, _)| dir.clone()).collect();
        self.share_dirs(&dirs, unused);
    }

    /// Channels named DIR, and those named CW that are not the pulses of a motor.
    fn named_dirs(&self) -> Vec<(usize, SignalName)> {
        let is_dir = |(channel, named): &(usize, SignalName)| {
            !named.is_pulse && self.motors.iter().all(|motor| !motor.has(*channel))
        };
        let mut dirs = self.named(Kind::Dir);
        dirs.extend(self.named(Kind::Cw).into_iter().filter(is_dir));
        dirs
    }

    /// Motors without a DIR, and DIR channels of the same axis, best first.
    fn pairs_of_one_axis(&self, dirs: &[(usize, SignalName)]) -> Vec<Pair> {
        let mut pairs: Vec<Pair> = Vec::new();
        for (at, motor) in self.motors.iter().enumerate().filter(|(_, motor)| motor.lacks_dir()) {
            let is_like = |other: &Motor| other.lacks_dir() && other.axis == motor.axis;
            let motors = self.motors.iter().filter(|other| is_like(other)).count();
            let order = self.motors.iter().take(at).filter(|other| is_like(other)).count();
            let of_axis: Vec<(usize, &(usize, SignalName))> =
                dirs.iter().enumerate().filter(|(_, (_, named))| named.axis == motor.axis).collect();
            for (dir_order, (dir, (channel, named))) in of_axis.iter().enumerate() {
                // Equal numbers of STEP and DIR are paired in order.
                let distance = if of_axis.len() == motors {
                    order.abs_diff(dir_order)
                } else {
                    motor.step().map_or(0, |step| step.abs_diff(*channel))
                };
                let is_other_scope = named.scope != motor.scope;
                pairs.push(Pair { is_other_scope, distance, motor: at, dir: *dir });
            }
        }
        pairs.sort_unstable();
        pairs
    }

    /// Assigns a DIR of several axes to all of them, and a DIR without an axis to all motors without a DIR. The others
    /// belong to motors whose STEP is unknown.
    fn share_dirs(&mut self, dirs: &[(usize, SignalName)], unused: Vec<(usize, SignalName)>) {
        let mut without_axis = dirs.iter().filter(|(_, named)| named.axis.is_empty());
        let only_without_axis = without_axis.next().filter(|_| without_axis.next().is_none());
        let common = unused.iter().find(|(_, named)| named.axis.is_empty()).or(only_without_axis);
        let common = common.map(|(channel, _)| *channel);
        // A single motor and a single DIR are paired, unless their axes differ.
        let single = match (self.motors.as_slice(), unused.as_slice()) {
            ([motor], [(channel, _)]) if motor.axis.is_empty() => Some(*channel),
            _ => None,
        };
        // X1 and X2 share the DIR of X; X and Y that of XY.
        let of_group = |axis: &str| {
            let found = unused.iter().find(|(_, named)| {
                !named.axis.is_empty() && stem(axis) == named.axis || includes_axis(&named.axis, axis)
            });
            found.map(|(channel, _)| *channel)
        };
        let mut shared = Vec::new();
        for motor in self.motors.iter_mut().filter(|motor| motor.lacks_dir()) {
            motor.dir = of_group(&motor.axis).or(common).or(single);
            shared.extend(motor.dir);
        }
        for (channel, named) in unused {
            if !shared.contains(&channel) && self.motors.iter().all(|motor| motor.axis != named.axis) {
                let mut motor = Motor::new(&named.axis, &named.scope, Source::None);
                motor.dir = Some(channel);
                self.motors.push(motor);
            }
        }
    }

    /// Sorts motors: first by number, then by axis letter, then words in the order of their channels.
    pub(super) fn sort_motors(&mut self) {
        let channels = 0..self.meanings.len();
        let first_channel = |motor: &Motor| channels.clone().find(|channel| motor.has(*channel));
        let stems = self.motors.iter().enumerate();
        let stems =
            stems.filter_map(|(at, motor)| Some((first_channel(motor)?, at, stem(&motor.axis).to_owned())));
        let mut stems: Vec<(usize, usize, String)> = stems.collect();
        stems.sort_unstable();
        self.motors.sort_by_cached_key(|motor| {
            let stem = stem(&motor.axis);
            let number: u64 =
                motor.axis.get(stem.len()..).and_then(|digits| digits.parse().ok()).unwrap_or(0);
            let (class, order) = match AXES.find(stem) {
                _ if stem.is_empty() => (0, None),
                letter @ Some(_) if stem.len() == 1 => (1, letter),
                _ => (2, stems.iter().position(|(.., other)| other == stem)),
            };
            (class, order, number)
        });
    }
}

/// The channel of the same axis, preferably in the same scope.
fn partner(named: &SignalName, others: &[(usize, SignalName)]) -> Option<usize> {
    let of_axis = others.iter().filter(|(_, other)| other.axis == named.axis);
    let best = of_axis.max_by_key(|(channel, other)| (other.scope == named.scope, usize::MAX - channel));
    best.map(|(channel, _)| *channel)
}

/// A motor and a DIR of its axis, by their indices; the best pair is the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Pair {
    is_other_scope: bool,
    distance: usize,
    motor: usize,
    dir: usize,
}
