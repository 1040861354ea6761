//! Power cuts: the position of a stand-alone controller after a power failure in a cycle (CONTROLLER.md G7).
//!
//! ```text
//! run ────────────┬─────────────┬──────────┬───────── the scenario's run, uninterrupted
//!                 │ cut in c    │ cut in c'│
//!                 └─ POWER_LOSS ─ OFF ─ power back ─ memory read: position known, lost, or silently wrong
//! ```
//!
//! Each cut continues a copy of the run, so only the cycles after it are computed.
//!
//! ```
//! use stepscope_peripheral::units::Instant;
//! use stepscope_sim::{Experiment, power_cut::{PowerCuts, tally}};
//!
//! let json = r#"{ "clock_hz": 1000000, "source": { "standalone": [ { "max_speed_hz": 5000, "debounce_cycles": 0,
//!     "memory": { "byte_write_cycles": 100, "hold_up_cycles": 1699 },
//!     "inputs": [ { "cycle": 5000, "input": "start" } ] } ] } }"#;
//! let experiment = Experiment::from_json(json).expect("no problems");
//! let controllers = experiment.stand_alone().expect("a stand-alone controller");
//! let cuts = PowerCuts::of(controllers, Instant(experiment.cost().end_cycle), 200, 1);
//! assert_eq!(tally(controllers, cuts.cycles()).wrong, 0);
//! ```

use alloc::{collections::BTreeSet, vec::Vec};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use stepscope_controller::input::{Change, Signal};
use stepscope_controller::parameters::{Initial, Policy};
use stepscope_controller::{CheckedSetup, StandAlone, State};
use stepscope_peripheral::units::Instant;

/// The position after a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Trusted and correct.
    Known,
    /// Not trusted, but trusted before the cut.
    Lost,
    /// Trusted neither before nor after the cut.
    NeverKnown,
    /// Trusted, and correct relative to the previous zero, because the new zero had not been saved.
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

    /// Adds the counts of `other`, whose cuts are later.
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
    /// All cycles before `end`, or `count` random ones, of which about half are during writes of the memory.
    pub fn of(checked: &CheckedSetup, end: Instant, count: usize, seed: u64) -> Self {
        let (length, writes) = byte_writes(checked, end);
        let cycles = if length <= count as u64 {
            (1..length.max(2)).collect()
        } else {
            random_cuts(length, &writes, count, seed)
        };
        Self { checked: checked.clone(), cycles, length }
    }

    /// In rising order.
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

/// At most a quarter of the cuts are at the begin of a write, spread over the run.
const MAX_SHARE_OF_BEGINS: usize = 4;

fn random_cuts(length: u64, writes: &[ByteWrite], count: usize, seed: u64) -> Vec<u64> {
    let mut chosen = BTreeSet::new();
    let begins =
        writes.iter().flat_map(|&ByteWrite { begin, .. }| [begin.saturating_sub(1), begin, begin + 1]);
    let begins: Vec<u64> = begins.filter(|&cycle| cycle > 0).collect();
    let stride = begins.len().div_ceil((count / MAX_SHARE_OF_BEGINS).max(1)).max(1);
    chosen.extend(begins.into_iter().step_by(stride));
    let write_cycles: u64 = writes.iter().map(ByteWrite::cycles).sum();
    let mut random = SplitMix64::seed_from_u64(seed);
    while chosen.len() < count {
        let anywhere = 1 + random.next_u64() % (length - 1);
        let cycle = match random.next_u64() % 2 {
            0 if write_cycles > 0 => cycle_within(writes, random.next_u64() % write_cycles),
            _ => anywhere,
        };
        chosen.insert(cycle.max(1));
    }
    chosen.into_iter().collect()
}

/// The same controllers with another memory policy and hold-up time.
pub fn with_memory(checked: &CheckedSetup, policy: Policy, hold_up_cycles: u64) -> CheckedSetup {
    let mut setup = checked.setup();
    for one in &mut setup.controllers {
        (one.memory.policy, one.memory.hold_up_cycles) = (policy, hold_up_cycles);
    }
    setup.check().unwrap_or_else(|_| checked.clone())
}

/// The minimum hold-up time with the policy `power_loss` that loses no more positions than `max_hold_up`, in cycles.
/// `losses` counts the lost positions of a setup.
pub fn min_hold_up(
    checked: &CheckedSetup,
    max_hold_up: u64,
    mut losses: impl FnMut(&CheckedSetup) -> u64,
) -> u64 {
    let mut lost = |hold_up| losses(&with_memory(checked, Policy::PowerLoss, hold_up));
    // A stop above the start-stop rate loses the position with any hold-up time.
    let min_lost = lost(max_hold_up);
    let (mut low, mut high) = (0, max_hold_up);
    while low < high {
        let middle = low + (high - low) / 2;
        if lost(middle) > min_lost { low = middle + 1 } else { high = middle }
    }
    high
}

/// Cuts the power in each of these cycles, which are in rising order, and counts the outcomes.
pub fn tally(checked: &CheckedSetup, cycles: &[u64]) -> Tally {
    let mut found = Tally::default();
    let mut run = TrackedRun::new(checked);
    for &cycle in cycles {
        run.run_to(cycle);
        for outcome in run.clone().cut() {
            found.count(Instant(cycle), outcome);
        }
    }
    found
}

/// Byte times until a new zero is saved: the record in progress, its own record, and a margin.
const OLD_ZERO_BYTES: u64 = 34;

#[derive(Clone, Copy, Debug)]
struct TrueZero {
    /// The step counter of the bus at position 0.
    zero: i32,
    old_zero: i32,
    /// Cycle in which `zero` replaced `old_zero`.
    set_at: u64,
    /// Whether the controller trusted its last position.
    is_trusted: bool,
}

/// A run that tracks the true zero of each controller.
#[derive(Clone, Debug)]
struct TrackedRun {
    run: StandAlone,
    zeros: Vec<TrueZero>,
    /// Which controllers had no position in the previous cycle.
    were_down: Vec<bool>,
}

impl TrackedRun {
    fn new(checked: &CheckedSetup) -> Self {
        let run = StandAlone::new(checked);
        // The initial contents of the memory count as correct.
        let zeros = (0..run.controllers()).map(|index| {
            let (position, trust) = run.position_after_power_up(index).unwrap_or((0, 0));
            let zero = position.wrapping_neg();
            TrueZero { zero, old_zero: zero, set_at: 0, is_trusted: trust > 0 }
        });
        let zeros: Vec<TrueZero> = zeros.collect();
        let were_down = zeros.iter().map(|_| true).collect();
        Self { run, zeros, were_down }
    }

    fn run_to(&mut self, end: u64) {
        while self.run.now().0 < end {
            let next = self.run.cycles_until_event().map_or(end, |cycles| self.run.now().0 + cycles.0 + 1);
            self.run.run(Instant(next.min(end)), &mut ());
            drop_panels(&mut self.run);
            self.track_zeros();
        }
    }

    /// Follows changes of zero. A position that was restored from memory changes no zero, so a wrong one stays wrong.
    fn track_zeros(&mut self) {
        let (steps, now) = (self.run.positions(), self.run.now().0);
        for (index, (zero, was_down)) in self.zeros.iter_mut().zip(&mut self.were_down).enumerate() {
            let is_down = is_down(self.run.state(index));
            let came_up = core::mem::replace(was_down, is_down) && !is_down;
            let (Some(position), Some(steps)) = (self.run.position(index), steps.get(index)) else {
                continue;
            };
            if is_down {
                continue;
            }
            let (new_zero, is_trusted) = (steps.wrapping_sub(position), self.run.trust(index) > Some(0));
            let is_restored_from_memory = came_up && is_trusted;
            if !is_restored_from_memory && new_zero != zero.zero {
                (zero.old_zero, zero.zero, zero.set_at) = (zero.zero, new_zero, now);
            }
            zero.is_trusted = is_trusted;
        }
    }

    /// Cuts the power in the next cycle, restores it when no event follows, and checks the positions read from memory.
    fn cut(mut self) -> Vec<Outcome> {
        let Self { run, zeros, .. } = &mut self;
        run.drop_inputs();
        let at = run.now();
        let power = |level| Change::Level(Signal::Power, level);
        // The power may be off already, so an error does not matter.
        let _ = run.enter(at, 0, power(false));
        run.run(Instant(at.0 + 1), &mut ());
        // A step in the cycle of the cut still counts.
        let steps = run.positions();
        run.run(Instant::NEVER, &mut ());
        let _ = run.enter(run.now(), 0, power(true));
        run.run(Instant(run.now().0 + 1), &mut ());
        while (0..zeros.len()).any(|index| is_down(run.state(index))) {
            let Some(cycles) = run.cycles_until_event() else { break };
            run.run(Instant(run.now().0 + cycles.0 + 1), &mut ());
        }
        zeros
            .iter()
            .zip(steps)
            .enumerate()
            .map(|(index, (zero, steps))| outcome(run, index, zero, steps, at))
            .collect()
    }
}

/// The outcome of a cut in cycle `at` at step counter `steps`.
fn outcome(run: &StandAlone, index: usize, zero: &TrueZero, steps: i32, at: Instant) -> Outcome {
    if run.trust(index).is_none_or(|trust| trust == 0) {
        return if zero.is_trusted { Outcome::Lost } else { Outcome::NeverKnown };
    }
    let matches_zero = |zero| run.position(index) == Some(steps.wrapping_sub(zero));
    let byte = run.checked().controllers().get(index).map_or(0, |one| one.memory.byte_write_cycles);
    let saved_at = zero.set_at.saturating_add(OLD_ZERO_BYTES * u64::from(byte));
    match zero.is_trusted {
        true if matches_zero(zero.zero) => Outcome::Known,
        true if matches_zero(zero.old_zero) && at.0 <= saved_at => Outcome::OldZero,
        _ => Outcome::Wrong,
    }
}

const fn is_down(state: Option<State>) -> bool {
    matches!(state, Some(State::Off | State::SelfTest | State::PowerLoss))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ByteWrite {
    begin: u64,
    end: u64,
}

impl ByteWrite {
    const fn cycles(&self) -> u64 {
        self.end - self.begin
    }
}

/// The length of a run, and its writes in rising order.
fn byte_writes(checked: &CheckedSetup, end: Instant) -> (u64, Vec<ByteWrite>) {
    let mut run = StandAlone::new(checked);
    let mut found = BTreeSet::new();
    while let Some(cycles) = run.cycles_until_event().filter(|cycles| run.now() + *cycles < end) {
        run.run(Instant(run.now().0 + cycles.0 + 1), &mut ());
        drop_panels(&mut run);
        for (index, one) in checked.controllers().iter().enumerate() {
            if let Some(Instant(begin)) = run.writing_since(index) {
                found.insert(ByteWrite { begin, end: begin + u64::from(one.memory.byte_write_cycles) });
            }
        }
    }
    (run.now().0, found.into_iter().collect())
}

/// The cycle with this offset, counted over all writes.
fn cycle_within(writes: &[ByteWrite], mut offset: u64) -> u64 {
    for write in writes {
        if offset < write.cycles() {
            return write.begin + offset;
        }
        offset -= write.cycles();
    }
    1
}

fn drop_panels(run: &mut StandAlone) {
    for index in 0..run.controllers() {
        let _ = run.take_panel(index);
    }
}

/// Wear of a memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wear {
    /// Writes of the most worn cell per power cycle.
    pub writes_per_cycle: f64,
    /// Power cycles until that cell has reached its endurance; `None` where nothing is written.
    pub life_power_cycles: Option<u64>,
}

/// The wear of controller `index` in `cycles` power cycles, each with the memory of the previous one: a run up to `end`,
/// then a power cut. `endurance` is the number of writes that a cell survives.
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
        // The power may be off already, so an error does not matter.
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
    let writes_per_cycle = max as f64 / f64::from(done.max(1));
    let life = (max > 0).then(|| u64::from(endurance) * u64::from(done) / max);
    Wear { writes_per_cycle, life_power_cycles: life }
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
