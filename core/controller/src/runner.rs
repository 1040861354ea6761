//! The machine on a chip (CONTROLLER G7): runs it up to the current tick with the current inputs, and returns the next
//! wake-up time.
//!
//! ```text
//! tick     ──┬───────────────┬──────╎────┬─────────┬──>   the chip wakes at `wake`, late by L, or for an input
//!         poll(now)       input    wake  poll     poll
//! cycle    ──┬───────────────┬──────┬ ─ ─ ┬────────┬──>   the machine's time stops while the chip is late:
//!            run        enter, run  c     c       c + n   cycle = tick - origin, and origin grows by L
//! ```
//!
//! So a late chip makes edges late by the total lateness ([`Runner::lateness`]), but never closer to each other: no pulse
//! is too short, no rate too high, no edge lost. The time from a poll to the change of a pin is not counted.
//!
//! A byte of memory is complete when the chip reports it, at least `byte_write_cycles` after its begin, so no step rises
//! before the opening record is in a slow EEPROM.

use crate::{
    checked::CheckedSetup,
    chip::{Chip, Face, RawLevels},
    controller::NEVER,
    input::Signal,
    machine::StandAlone,
    panel::Word,
    state::State,
};
use alloc::vec::Vec;
use core::fmt;
use stepscope_peripheral::{
    signal::{Event, Record, Sink},
    units::{Cycles, Instant},
};

/// A chip that is still writing is polled again after this part of `byte_write_cycles`.
const WRITE_POLLS: u64 = 64;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotRunnable {
    /// A chip has one controller.
    Controllers(usize),
    /// A virtual axis would drive the switches.
    Axis,
}

impl fmt::Display for NotRunnable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Controllers(given) => write!(f, "{given} controllers; a chip runs one: give it its own"),
            Self::Axis => f.write_str("axis: on a chip the switches are real; leave the axis out"),
        }
    }
}

impl core::error::Error for NotRunnable {}

/// How late the chip woke for cycles with events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lateness {
    pub last: Cycles,
    pub worst: Cycles,
    /// Sum since power-up: the present delay of an edge.
    pub total: Cycles,
}

#[derive(Clone, Debug)]
pub struct Runner {
    machine: StandAlone,
    checked: CheckedSetup,
    /// The tick of cycle 0, plus all lateness since.
    origin: u64,
    lateness: Lateness,
    levels: RawLevels,
    /// When the byte last passed to the chip was begun.
    begun: Option<Instant>,
}

impl Runner {
    /// Power-up: cycle 0 of the machine is tick `now`. Memory is the chip's EEPROM; held inputs are no presses; the script
    /// and `memory.initial` have no effect. Nothing is written yet.
    /// Errors: more than one controller, or a virtual axis.
    pub fn power_up(now: Instant, checked: &CheckedSetup, chip: &mut impl Chip) -> Result<Self, NotRunnable> {
        let [parameters] = checked.controllers() else {
            return Err(NotRunnable::Controllers(checked.controllers().len()));
        };
        if parameters.axis.is_some() {
            return Err(NotRunnable::Axis);
        }
        Ok(Self::new(now, checked, chip))
    }

    fn new(now: Instant, checked: &CheckedSetup, chip: &mut impl Chip) -> Self {
        let levels = chip.inputs();
        let len = checked.controllers().first().map_or(0, |parameters| parameters.memory_len());
        let memory: Vec<u8> = (0..len).map(|address| chip.read_byte(address)).collect();
        Self {
            machine: StandAlone::power_up(checked, levels, &memory),
            checked: checked.clone(),
            origin: now.0,
            lateness: Lateness::default(),
            levels,
            begun: None,
        }
    }

    /// Initial EEPROM contents of a new chip, from address 0: `memory.initial`.
    #[must_use]
    pub fn factory_memory(checked: &CheckedSetup) -> Vec<u8> {
        StandAlone::new(checked).memory(0).to_vec()
    }

    /// Runs the machine up to tick `now`: reads inputs, writes pins and panel, begins a byte of memory. Returns the tick
    /// of the next call, which may have passed; `None` until an input changes.
    pub fn poll(&mut self, now: Instant, chip: &mut impl Chip) -> Option<Instant> {
        if now.0 < self.origin {
            return Some(Instant(self.origin));
        }
        let levels = chip.inputs();
        if chip.is_writing() {
            self.wait_for_byte(now);
        }
        let cycle = self.stand_still(now);
        let is_off = self.machine.state(0) == Some(State::Off);
        if !is_off {
            self.read_inputs(cycle, levels);
        }
        self.run(cycle, chip);
        if is_off && levels.level(Signal::Power) {
            return Some(self.power_up_again(now, chip));
        }
        self.wake()
    }

    /// Delays a byte that would be complete by `now` but that the chip is still writing.
    fn wait_for_byte(&mut self, now: Instant) {
        let cycle = now.0 - self.origin;
        if self.machine.byte_due() <= cycle {
            let write = self.checked.controllers().first().map_or(0, |one| one.memory.byte_write_cycles);
            let again = (u64::from(write) / WRITE_POLLS).max(1);
            self.machine.postpone_byte(cycle.saturating_add(again));
        }
    }

    /// The cycle of tick `now`. If an earlier one was due, it is that one: the machine's time has stopped since.
    fn stand_still(&mut self, now: Instant) -> u64 {
        let (cycle, deadline) = (now.0 - self.origin, self.deadline());
        if deadline == NEVER || cycle < deadline {
            return cycle;
        }
        let late = Cycles(cycle - deadline);
        self.origin += late.0;
        let Lateness { worst, total, .. } = self.lateness;
        self.lateness = Lateness {
            last: late,
            worst: Cycles(worst.0.max(late.0)),
            total: Cycles(total.0.saturating_add(late.0)),
        };
        deadline
    }

    /// Enters changed inputs from `cycle` on or, if that has been run, from the next cycle.
    fn read_inputs(&mut self, cycle: u64, levels: RawLevels) {
        let at = Instant(cycle.max(self.machine.now().0).max(1));
        for signal in levels.changed(self.levels) {
            let level = levels.level(signal);
            // A second change in one cycle is entered in the next.
            if self.machine.enter_level(at, signal, level) {
                self.levels = self.levels.with(signal, level);
            }
        }
    }

    fn run(&mut self, cycle: u64, chip: &mut impl Chip) {
        let decimals = self.decimals();
        let origin = self.origin;
        self.machine.run(Instant(cycle.saturating_add(1)), &mut Outlet { chip, origin, decimals });
        // A chip runs without end, so the history must not grow.
        self.machine.forget();
        if let Some((begun, address, byte)) = self.machine.byte_under_way()
            && self.begun != Some(begun)
        {
            self.begun = Some(begun);
            chip.begin_byte(address, byte);
        }
    }

    /// The power is back before the chip stopped: restarts from the contents of the EEPROM.
    fn power_up_again(&mut self, now: Instant, chip: &mut impl Chip) -> Instant {
        let next = Instant(now.0.saturating_add(1));
        if !chip.is_writing() {
            let lateness = self.lateness;
            *self = Self { lateness, ..Self::new(next, &self.checked, chip) };
        }
        next
    }

    fn deadline(&self) -> u64 {
        let now = self.machine.now().0;
        self.machine.cycles_until_event().map_or(NEVER, |cycles| now.saturating_add(cycles.0))
    }

    fn wake(&self) -> Option<Instant> {
        let deadline = self.deadline();
        (deadline != NEVER).then(|| Instant(self.origin.saturating_add(deadline)))
    }

    fn decimals(&self) -> u8 {
        let decimals = self.machine.numbers(0).get(1);
        decimals.and_then(|&decimals| u8::try_from(decimals).ok()).unwrap_or(0)
    }

    #[must_use]
    pub const fn machine(&self) -> &StandAlone {
        &self.machine
    }

    #[must_use]
    pub const fn lateness(&self) -> Lateness {
        self.lateness
    }

    /// The panel in the last cycle.
    #[must_use]
    pub fn face(&self) -> Face {
        Face {
            at: Instant(self.origin.saturating_add(self.machine.now().0.saturating_sub(1))),
            word: self.machine.word(0).unwrap_or_default(),
            position: self.machine.position(0).unwrap_or(0).into(),
            display: self.machine.display(0).unwrap_or(0),
            decimals: self.decimals(),
        }
    }
}

/// Passes the changes of a cycle to pins and panel.
struct Outlet<'c, C> {
    chip: &'c mut C,
    origin: u64,
    decimals: u8,
}

impl<C: Chip> Sink for Outlet<'_, C> {
    fn record(&mut self, record: Record) {
        self.chip.write_pins(record.levels);
    }

    fn event(&mut self, at: Instant, event: Event) {
        if let Event::Panel { word, position, display, .. } = event {
            let (at, decimals) = (Instant(self.origin.saturating_add(at.0)), self.decimals);
            self.chip.show(Face { at, word: Word(word), position, display, decimals });
        }
    }
}
