//! Power cuts: the position of a stand-alone controller after a power failure in any cycle (CONTROLLER.md G7).
//!
//! ```text
//! run ────────────┬─────────────┬──────────┬───────── the scenario's run, uninterrupted
//!                 │ cut in c    │ cut in c'│
//!                 └─ POWER_LOSS ─ OFF ─ power back ─ memory read: known, known to be lost, or silently wrong
//! ```
//!
//! Each cut is a copy of the run, so only the cycles after it are computed.

use alloc::{collections::BTreeSet, vec::Vec};
use rand_xoshiro::{
    SplitMix64,
    rand_core::{Rng, SeedableRng},
};
use stepscope_controller::{
    CheckedSetup, StandAlone, State,
    input::{Change, Signal},
    parameters::{Initial, Policy},
};
use stepscope_peripheral::units::Instant;

/// The position after a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Known,
    /// Not trusted, but trusted before the cut.
    Lost,
    /// Not trusted, nor before the cut.
    NeverKnown,
    /// Trusted, and true by the previous zero: the new one had not been saved.
    OldZero,
    /// Trusted and wrong.
    Wrong,
}

/// Outcomes of all cuts and controllers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    pub cuts: u64,
    pub known: u64,
    pub lost: u64,
    pub never_known: u64,
    pub old_zero: u64,
    pub wrong: u64,
    pub first_lost: Option<Instant>,
    /// The first cut that left a wrong position.
    pub first_wrong: Option<Instant>,
}

impl Tally {
    fn count(&mut self, at: Instant, outcome: Outcome) {
        self.cuts += 1;
        match outcome {
            Outcome::Known => self.known += 1,
            Outcome::NeverKnown => self.never_known += 1,
            Outcome::OldZero => self.old_zero += 1,
            Outcome::Lost => {
                self.lost += 1;
                self.first_lost = self.first_lost.or(Some(at));
            }
            Outcome::Wrong => {
                self.wrong += 1;
                self.first_wrong = self.first_wrong.or(Some(at));
            }
        }
    }

    /// Adds the cuts of `other`, which come later.
    pub fn join(&mut self, other: &Self) {
        self.cuts += other.cuts;
        self.known += other.known;
        self.lost += other.lost;
        self.never_known += other.never_known;
        self.old_zero += other.old_zero;
        self.wrong += other.wrong;
        self.first_lost = self.first_lost.or(other.first_lost);
        self.first_wrong = self.first_wrong.or(other.first_wrong);
    }
}

/// The cycles in which the power of a scenario's run is cut.
#[derive(Clone, Debug)]
pub struct PowerCuts {
    checked: CheckedSetup,
    cycles: Vec<u64>,
    length: u64,
}

impl PowerCuts {
    /// Up to `count` cycles of a run that ends before `end`: all, or random ones, half of them anywhere, half while a record
    /// is written.
    #[must_use]
    pub fn of(checked: &CheckedSetup, end: Instant, count: usize, seed: u64) -> Self {
        let (length, writes) = writes(checked, end);
        let count = count as u64;
        let cycles = if length <= count {
            (1..length.max(2)).collect()
        } else {
            let mut chosen = BTreeSet::new();
            let mut random = SplitMix64::seed_from_u64(seed);
            let begins = writes.iter().flat_map(|&(begun, _)| [begun.saturating_sub(1), begun, begun + 1]);
            let begins: Vec<u64> = begins.filter(|&cycle| cycle > 0).collect();
            // At most a quarter of the cuts, spread over the run.
            let stride = begins.len().div_ceil((count as usize / 4).max(1)).max(1);
            chosen.extend(begins.into_iter().step_by(stride));
            let spans: u64 = writes.iter().map(|&(begun, end)| end - begun).sum();
            while (chosen.len() as u64) < count {
                let anywhere = 1 + random.next_u64() % (length - 1);
                let cycle = match random.next_u64() % 2 {
                    0 if spans > 0 => within(&writes, random.next_u64() % spans),
                    _ => anywhere,
                };
                chosen.insert(cycle.max(1));
            }
            chosen.into_iter().collect()
        };
        Self { checked: checked.clone(), cycles, length }
    }

    /// Rising.
    pub fn cycles(&self) -> &[u64] {
        &self.cycles
    }

    /// Cycles of the run.
    pub const fn length(&self) -> u64 {
        self.length
    }

    pub const fn checked(&self) -> &CheckedSetup {
        &self.checked
    }
}

/// The same controllers with another policy and hold-up of their memories.
#[must_use]
pub fn with_memory(checked: &CheckedSetup, policy: Policy, hold_up_cycles: u64) -> CheckedSetup {
    let mut setup = checked.setup();
    for one in &mut setup.controllers {
        (one.memory.policy, one.memory.hold_up_cycles) = (policy, hold_up_cycles);
    }
    setup.check().unwrap_or_else(|_| checked.clone())
}

/// The minimum hold-up that loses no more positions than `max` with the policy `power_loss`; `losses` counts the losses
/// of a setup.
pub fn min_hold_up(checked: &CheckedSetup, max: u64, mut losses: impl FnMut(&CheckedSetup) -> u64) -> u64 {
    let mut lost = |hold_up| losses(&with_memory(checked, Policy::PowerLoss, hold_up));
    // A jump beyond the start-stop range loses steps with any hold-up.
    let min = lost(max);
    let (mut low, mut enough) = (0, max);
    while low < enough {
        let middle = low + (enough - low) / 2;
        if lost(middle) > min { low = middle + 1 } else { enough = middle }
    }
    enough
}

/// Cuts the power in each of these cycles, which rise, and counts the outcomes.
#[must_use]
pub fn tally(checked: &CheckedSetup, cycles: &[u64]) -> Tally {
    let mut found = Tally::default();
    let mut run = Watched::new(checked);
    for &cycle in cycles {
        run.go(cycle);
        for outcome in run.clone().cut() {
            found.count(Instant(cycle), outcome);
        }
    }
    found
}

/// Byte times until a new zero is saved: a record that is being written, and its own.
const OLD_ZERO_BYTES: u64 = 34;

/// A controller's true position.
#[derive(Clone, Copy, Debug)]
struct Truth {
    /// The bus's position counter where the position is 0.
    zero: i32,
    /// The zero before the last one was set, and when.
    before: (i32, u64),
    /// Whether the controller trusted its last position.
    known: bool,
}

/// A run, and the true positions in it.
#[derive(Clone, Debug)]
struct Watched {
    run: StandAlone,
    truth: Vec<Truth>,
    /// Which controllers had no position in the cycle before.
    down: Vec<bool>,
}

impl Watched {
    fn new(checked: &CheckedSetup) -> Self {
        let run = StandAlone::new(checked);
        // Before memory is read, its content is the truth.
        let truth = (0..run.controllers()).map(|index| {
            let (position, trust) = run.position_after_power_up(index).unwrap_or((0, 0));
            Truth { zero: position.wrapping_neg(), before: (position.wrapping_neg(), 0), known: trust > 0 }
        });
        let truth: Vec<Truth> = truth.collect();
        let down = truth.iter().map(|_| true).collect();
        Self { run, truth, down }
    }

    fn go(&mut self, end: u64) {
        while self.run.now().0 < end {
            let next = self.run.cycles_until_event().map_or(end, |cycles| self.run.now().0 + cycles.0 + 1);
            self.run.run(Instant(next.min(end)), &mut ());
            drop_panels(&mut self.run);
            self.watch();
        }
    }

    /// Follows the true zero. A position read from memory counts as true only if it was: a wrong one stays wrong.
    fn watch(&mut self) {
        let (steps, now) = (self.run.positions(), self.run.now().0);
        for (index, (truth, was_down)) in self.truth.iter_mut().zip(&mut self.down).enumerate() {
            let is_down = is_down(self.run.state(index));
            let came_up = core::mem::replace(was_down, is_down) && !is_down;
            let (Some(position), Some(steps)) = (self.run.position(index), steps.get(index)) else {
                continue;
            };
            if is_down {
                continue;
            }
            let (zero, known) = (steps.wrapping_sub(position), self.run.trust(index) > Some(0));
            if !(came_up && known) && zero != truth.zero {
                (truth.before, truth.zero) = ((truth.zero, now), zero);
            }
            truth.known = known;
        }
    }

    /// Cuts the power in the next cycle, restores it when all is off, and compares the positions read from memory.
    fn cut(mut self) -> Vec<Outcome> {
        let Self { run, truth, .. } = &mut self;
        run.drop_inputs();
        let at = run.now();
        let power = |level| Change::Level(Signal::Power, level);
        // The power may be off already.
        let _ = run.enter(at, 0, power(false));
        run.run(Instant(at.0 + 1), &mut ());
        // A step of this cycle still counts.
        let steps = run.positions();
        run.run(Instant::NEVER, &mut ());
        let _ = run.enter(run.now(), 0, power(true));
        run.run(Instant(run.now().0 + 1), &mut ());
        while (0..truth.len()).any(|index| is_down(run.state(index))) {
            let Some(cycles) = run.cycles_until_event() else { break };
            run.run(Instant(run.now().0 + cycles.0 + 1), &mut ());
        }
        let outcome = |((index, truth), steps): ((usize, &Truth), i32)| {
            let is = |zero| run.position(index) == Some(steps.wrapping_sub(zero));
            let (before, set) = truth.before;
            let byte = run.checked().controllers().get(index).map_or(0, |one| one.memory.byte_write_cycles);
            let may_be_old = at.0 <= set.saturating_add(OLD_ZERO_BYTES * u64::from(byte));
            match run.trust(index) {
                None | Some(0) if truth.known => Outcome::Lost,
                None | Some(0) => Outcome::NeverKnown,
                _ if !truth.known => Outcome::Wrong,
                _ if is(truth.zero) => Outcome::Known,
                _ if is(before) && may_be_old => Outcome::OldZero,
                _ => Outcome::Wrong,
            }
        };
        truth.iter().enumerate().zip(steps).map(outcome).collect()
    }
}

const fn is_down(state: Option<State>) -> bool {
    matches!(state, Some(State::Off | State::SelfTest | State::PowerLoss))
}

/// Length of the run, and begin and end of each byte written.
fn writes(checked: &CheckedSetup, end: Instant) -> (u64, Vec<(u64, u64)>) {
    let mut run = StandAlone::new(checked);
    let mut found = BTreeSet::new();
    while let Some(cycles) = run.cycles_until_event().filter(|cycles| run.now() + *cycles < end) {
        run.run(Instant(run.now().0 + cycles.0 + 1), &mut ());
        drop_panels(&mut run);
        for (index, one) in checked.controllers().iter().enumerate() {
            if let Some(begun) = run.writing_since(index) {
                found.insert((begun.0, begun.0 + u64::from(one.memory.byte_write_cycles)));
            }
        }
    }
    (run.now().0, found.into_iter().collect())
}

fn within(spans: &[(u64, u64)], mut offset: u64) -> u64 {
    for &(begun, end) in spans {
        if offset < end - begun {
            return begun + offset;
        }
        offset -= end - begun;
    }
    1
}

fn drop_panels(run: &mut StandAlone) {
    for index in 0..run.controllers() {
        let _ = run.take_panel(index);
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wear {
    /// Writes of the most worn cell per power cycle.
    pub writes_a_cycle: f64,
    /// Power cycles until that cell has reached its endurance; `None` where nothing is written.
    pub life_power_cycles: Option<u64>,
}

/// The wear of controller `index`: its run up to `end` with a cut there, `cycles` times, each with the memory of the
/// run before.
#[must_use]
pub fn wear(checked: &CheckedSetup, end: Instant, index: usize, cycles: u32, endurance: u32) -> Wear {
    let mut setup = checked.setup();
    let mut totals: Vec<u64> = Vec::new();
    let mut done = 0_u32;
    for _ in 0..cycles {
        let Ok(checked) = setup.clone().check() else { break };
        done += 1;
        let mut run = StandAlone::new(&checked);
        run.run(end, &mut ());
        let at = run.now();
        // The power may be off already.
        let _ = run.enter(at, 0, Change::Level(Signal::Power, false));
        run.run(Instant::NEVER, &mut ());
        let writes = run.writes(index);
        totals.resize(writes.len(), 0);
        totals.iter_mut().zip(writes).for_each(|(total, &writes)| *total += u64::from(writes));
        for (one, parameters) in setup.controllers.iter_mut().enumerate() {
            parameters.memory.initial = Initial::Bytes(run.memory(one).to_vec());
        }
    }
    let max = totals.into_iter().max().unwrap_or(0);
    let writes_a_cycle = max as f64 / f64::from(done.max(1));
    let life = (max > 0).then(|| u64::from(endurance) * u64::from(done) / max);
    Wear { writes_a_cycle, life_power_cycles: life }
}

#[cfg(test)]
mod tests {
    #[test]
    fn each_cut_of_a_run_has_an_outcome() {
        use crate::{
            Experiment,
            power_cut::{PowerCuts, tally},
        };
        use stepscope_peripheral::units::Instant;

        let json = r#"{ "clock_hz": 1000000, "source": { "standalone": [ { "memory": { "byte_write_cycles": 100,
            "hold_up_cycles": 1699 }, "debounce_cycles": 0, "max_speed_hz": 5000, "groups": [ { "move": { "length": 100 } } ],
            "inputs": [ { "cycle": 5000, "input": "start" } ] } ] } }"#;
        let experiment = Experiment::from_json(json).expect("no problems");
        let end = Instant(experiment.cost().end_cycle);
        let cuts = PowerCuts::of(experiment.stand_alone().expect("a controller"), end, 2000, 1);
        let found = tally(cuts.checked(), cuts.cycles());
        assert_eq!((found.cuts, found.lost, found.wrong), (cuts.cycles().len() as u64, 0, 0));
    }
}
