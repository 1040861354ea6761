//! Walks the entries of a table as firmware does: event by event, in whole cycles, with the fraction carried.
//!
//! The firmware's own walk is `core/inspect/include/stepscope_walk.h`.

use crate::ScheduledStep;
use crate::step_tables::entry_format::{Entry, EntryFormat};
use core::slice::Iter;

/// An event of a walk, `cycles` after the event before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableEvent {
    Step {
        cycles: u64,
        right: bool,
    },
    /// No step; afterwards `right` is the direction.
    Wait {
        cycles: u64,
        right: bool,
    },
}

/// Iterates over the events of a table.
#[derive(Clone, Debug)]
pub struct TableWalk<'t> {
    entries: Iter<'t, Entry>,
    fraction_bits: u32,
    /// The rest of the current entry.
    rest: Entry,
    /// Carried, in units of the table: less than a cycle.
    fraction: u64,
    right: bool,
}

impl<'t> TableWalk<'t> {
    /// Begins at time 0, to the left.
    pub fn new(entries: &'t [Entry], format: EntryFormat) -> Self {
        let rest = Entry { interval: 0, count: 0, add: 0 };
        Self {
            entries: entries.iter(),
            fraction_bits: format.fraction_bits(),
            rest,
            fraction: 0,
            right: false,
        }
    }

    /// The steps, in cycles from the start.
    pub fn steps(self) -> impl Iterator<Item = ScheduledStep> + use<'t> {
        let mut cycle = 0_u64;
        self.filter_map(move |event| match event {
            TableEvent::Wait { cycles, .. } => {
                cycle = cycle.wrapping_add(cycles);
                None
            }
            TableEvent::Step { cycles, right } => {
                cycle = cycle.wrapping_add(cycles);
                Some(ScheduledStep { cycle, right })
            }
        })
    }

    fn cycles(&mut self, units: u64) -> u64 {
        let mask = (1 << self.fraction_bits) - 1;
        let part = (units & mask) + self.fraction;
        self.fraction = part & mask;
        (units >> self.fraction_bits) + (part >> self.fraction_bits)
    }
}

impl Iterator for TableWalk<'_> {
    type Item = TableEvent;

    fn next(&mut self) -> Option<TableEvent> {
        if self.rest.count == 0 {
            self.rest = *self.entries.next()?;
            if self.rest.count == 0 {
                self.right = self.rest.add != 0;
                return Some(TableEvent::Wait { cycles: self.cycles(self.rest.interval), right: self.right });
            }
        }
        let units = self.rest.interval;
        self.rest.count -= 1;
        // Wraps only after an entry's last step.
        self.rest.interval = units.wrapping_add_signed(self.rest.add);
        Some(TableEvent::Step { cycles: self.cycles(units), right: self.right })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn carries_fractions_and_turns_after_waits() {
        let format = EntryFormat::Q8;
        let entries = [
            Entry { interval: 0, count: 0, add: 1 },
            Entry { interval: 384, count: 3, add: -64 },
            Entry { interval: 255, count: 0, add: 0 },
            Entry { interval: 1, count: 1, add: 0 },
        ];
        let walk = TableWalk::new(&entries, format);
        let step = |cycles, right| TableEvent::Step { cycles, right };
        // At 1.5, 2.75, 3.75, 4.746 and 4.75 cycles.
        let expected = [
            TableEvent::Wait { cycles: 0, right: true },
            step(1, true),
            step(1, true),
            step(1, true),
            TableEvent::Wait { cycles: 1, right: false },
            step(0, false),
        ];
        assert_eq!(walk.clone().collect::<Vec<_>>(), expected);
        let steps: Vec<_> = walk.steps().map(|step| (step.cycle, step.right)).collect();
        assert_eq!(steps, [(1, true), (2, true), (3, true), (4, false)]);
    }
}
