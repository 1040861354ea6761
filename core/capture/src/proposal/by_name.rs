//! Pairs STEP and DIR by their names.

use super::{
    draft::Draft,
    motor::{Motor, Source, stem},
};
use crate::{
    channel_map::Entry,
    names::{AXES, Kind, Named, is_of_several},
};
use stepscope_peripheral::signal::Levels;

const EN: u32 = Levels::EN.trailing_zeros();
const RX: u32 = Levels::RX.trailing_zeros();
const TX: u32 = Levels::TX.trailing_zeros();
const DE: u32 = Levels::DE.trailing_zeros();

impl Draft<'_> {
    pub(super) fn others_by_name(&mut self) {
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

    pub(super) fn steps_by_name(&mut self) {
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

    /// Skips a STEP of a known motor: in another scope, or the other line of a pair.
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

    /// A DIR without an axis goes to all motors without one.
    pub(super) fn dirs_by_name(&mut self) {
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
            // Equal numbers of STEP and DIR with one name are paired in order.
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
        // A single motor and a single DIR are paired, unless their axes differ.
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
        // The rest are motors whose STEP is unknown.
        for (channel, named) in left {
            if !taken.contains(&channel) && self.motors.iter().all(|motor| motor.axis != named.axis) {
                let mut motor = Motor::new(&named.axis, &named.scope, Source::None);
                motor.dir = Some(channel);
                self.motors.push(motor);
            }
        }
    }

    /// Numbers first, then letters, then words in the order of the file.
    pub(super) fn sort_motors(&mut self) {
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
}
