//! The entries that a controller still has to hear, in the order of their cycles.

use crate::input::{Change, Input, Signal};
use alloc::{collections::VecDeque, rc::Rc, vec::Vec};

/// Entries in the order of their cycles, and how many of them have been taken.
#[derive(Clone, Debug, Default)]
struct Queue {
    entries: Rc<[Input]>,
    taken: usize,
}

/// The script of a controller.
#[derive(Clone, Debug, Default)]
pub(crate) struct Script {
    /// Its own, and what it shares with all others: power, E-stop and clear of the first one.
    queues: [Queue; 2],
    /// Entered while it ran.
    live: VecDeque<Input>,
}

/// Whether an entry of the first controller is for all of them.
pub(crate) const fn is_shared(change: Change) -> bool {
    matches!(change, Change::Level(Signal::Power | Signal::Estop | Signal::Clear, _))
}

/// Whether two entries are of the same input.
fn is_same(one: Change, other: Change) -> bool {
    one.name() == other.name()
}

/// `entries` in the order of their cycles.
pub(crate) fn sorted(entries: impl Iterator<Item = Input>) -> Rc<[Input]> {
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
        let at_cycle = self.entries.iter().skip(start).take_while(|input| input.cycle == wanted.cycle);
        at_cycle.into_iter().any(|input| is_same(input.change, wanted.change))
    }
}

impl Script {
    pub(crate) fn new(own: Rc<[Input]>, shared: Rc<[Input]>) -> Self {
        let queue = |entries| Queue { entries, taken: 0 };
        Self { queues: [queue(own), queue(shared)], live: VecDeque::new() }
    }

    /// The next entry's cycle; `u64::MAX` without one.
    pub(crate) fn due(&self) -> u64 {
        let queued = self.queues.iter().filter_map(Queue::first).map(|input| input.cycle.0);
        queued.chain(self.live.front().map(|input| input.cycle.0)).min().unwrap_or(u64::MAX)
    }

    /// Takes an entry of cycle `now`.
    pub(crate) fn take(&mut self, now: u64) -> Option<Change> {
        for queue in &mut self.queues {
            if let Some(input) = queue.first().filter(|input| input.cycle.0 <= now) {
                queue.taken += 1;
                return Some(input.change);
            }
        }
        self.live.pop_front_if(|input| input.cycle.0 <= now).map(|input| input.change)
    }

    /// Whether the input has an entry in its cycle.
    pub(crate) fn has(&self, input: Input) -> bool {
        let is_twin = |other: &Input| other.cycle == input.cycle && is_same(other.change, input.change);
        self.queues.iter().any(|queue| queue.has(input)) || self.live.iter().any(is_twin)
    }

    /// Leaves out all that is still to come.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Adds an entry of a cycle that has not been run.
    pub(crate) fn enter(&mut self, input: Input) {
        let index = self.live.partition_point(|other| other.cycle <= input.cycle);
        self.live.insert(index, input);
    }
}
