//! The inputs of a controller that are still to come, in the order of their cycles (CONTROLLER G1.3).

use crate::input::{Change, Input, Signal};
use alloc::{collections::VecDeque, sync::Arc, vec::Vec};

/// Entries in the order of their cycles, and how many have been applied.
#[derive(Clone, Debug, Default)]
struct Queue {
    entries: Arc<[Input]>,
    taken: usize,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Script {
    /// The controller's own entries, and those shared by all: power, emergency stop and clear of the first controller.
    queues: [Queue; 2],
    entered: VecDeque<Input>,
}

/// Whether an entry of the first controller applies to all.
pub(crate) const fn is_shared(change: Change) -> bool {
    matches!(change, Change::Level(Signal::Power | Signal::Estop | Signal::Clear, _))
}

fn is_same_input(one: Change, other: Change) -> bool {
    one.name() == other.name()
}

pub(crate) fn sorted(entries: impl Iterator<Item = Input>) -> Arc<[Input]> {
    let mut entries: Vec<Input> = entries.collect();
    entries.sort_by_key(|input| input.cycle);
    entries.into()
}

impl Queue {
    fn first(&self) -> Option<Input> {
        self.entries.get(self.taken).copied()
    }

    fn has(&self, wanted: Input) -> bool {
        let start = self.entries.partition_point(|input| input.cycle < wanted.cycle);
        let mut at_cycle = self.entries.iter().skip(start).take_while(|input| input.cycle == wanted.cycle);
        at_cycle.any(|input| is_same_input(input.change, wanted.change))
    }
}

impl Script {
    pub(crate) fn new(own: Arc<[Input]>, shared: Arc<[Input]>) -> Self {
        let queue = |entries| Queue { entries, taken: 0 };
        Self { queues: [queue(own), queue(shared)], entered: VecDeque::new() }
    }

    pub(crate) fn due(&self) -> u64 {
        let queued = self.queues.iter().filter_map(Queue::first).map(|input| input.cycle.0);
        queued.chain(self.entered.front().map(|input| input.cycle.0)).min().unwrap_or(u64::MAX)
    }

    /// Removes and returns the next change up to cycle `now`.
    pub(crate) fn take(&mut self, now: u64) -> Option<Change> {
        for queue in &mut self.queues {
            if let Some(input) = queue.first().filter(|input| input.cycle.0 <= now) {
                queue.taken += 1;
                return Some(input.change);
            }
        }
        self.entered.pop_front_if(|input| input.cycle.0 <= now).map(|input| input.change)
    }

    /// Whether this input has an entry in the same cycle.
    pub(crate) fn has(&self, input: Input) -> bool {
        let is_same = |other: &Input| other.cycle == input.cycle && is_same_input(other.change, input.change);
        self.queues.iter().any(|queue| queue.has(input)) || self.entered.iter().any(is_same)
    }

    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    pub(crate) fn enter(&mut self, input: Input) {
        let index = self.entered.partition_point(|other| other.cycle <= input.cycle);
        self.entered.insert(index, input);
    }
}
