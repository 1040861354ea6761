//! The machine on a chip: brought up to the tick that it is, with the inputs as they are, and asked when to wake next.
//!
//! ```text
//! tick     ──┬───────────────┬──────╎────┬─────────┬──>   the chip wakes at `wake`, late by L, or for an input
//!         poll(now)       input    wake  poll     poll
//! cycle    ──┬───────────────┬──────┬ ─ ─ ┬────────┬──>   the machine's time stands still while the chip is late:
//!            run        enter, run  c     c       c + n   cycle = tick - origin, and origin grows by L
//! ```
//!
//! So a late chip makes edges late, by what all its lateness adds up to ([`Runner::lateness`]), and never closer to each
//! other than the machine has them: no pulse is too short, no rate too high, none is lost. What the chip hears now it acts
//! on now. Edges are exact to the tick only as far as the chip wakes in time: one that knows how long that takes lets its
//! timer wake it so much earlier, and waits for the tick. What a poll itself takes until the pin changes is not told.
//!
//! A byte of the memory is written when the chip says so, at the earliest `byte_write_cycles` after its begin. So no step
//! rises before the opening record is in the EEPROM itself, however slow that is (G7).

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

/// Part of `byte_write_cycles` after which a chip that is still writing is asked again.
const ASK_AGAIN: u64 = 64;

/// Why controllers cannot run on a chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotRunnable {
    /// A chip has one controller; these are so many.
    Controllers(usize),
    /// It has a virtual axis, which would drive its switches.
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

/// How late the chip woke for cycles in which something was to happen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct Lateness {
    pub last: Cycles,
    /// The worst time since power-up.
    pub worst: Cycles,
    /// All of it since power-up: so much later than without it an edge is now.
    pub total: Cycles,
}

/// One controller on a chip, from a power-up on.
#[derive(Clone, Debug)]
pub struct Runner {
    machine: StandAlone,
    checked: CheckedSetup,
    /// The tick of the machine's cycle 0, later by all lateness since.
    origin: u64,
    lateness: Lateness,
    heard: RawLevels,
    /// The cycle in which the byte was begun that the chip got last.
    begun: Option<Instant>,
}

impl Runner {
    /// Power comes up: cycle 0 of the machine, which is s of G2, is tick `now`. Memory is what the chip's EEPROM holds, an
    /// input that is held is no press, and neither the script nor `memory.initial` counts. Nothing is written yet.
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
        let heard = chip.inputs();
        let len = checked.controllers().first().map_or(0, |parameters| parameters.memory_len());
        let memory: Vec<u8> = (0..len).map(|address| chip.read_byte(address)).collect();
        Self {
            machine: StandAlone::power_up(checked, heard, &memory),
            checked: checked.clone(),
            origin: now.0,
            lateness: Lateness::default(),
            heard,
            begun: None,
        }
    }

    /// What the EEPROM of a new chip has to hold, from address 0: `memory.initial`.
    #[must_use]
    pub fn factory_memory(checked: &CheckedSetup) -> Vec<u8> {
        StandAlone::new(checked).memory(0).to_vec()
    }

    /// Brings the machine up to tick `now`: hears the inputs, writes pins that change, shows what is shown, begins a byte
    /// of memory. The tick at which to call it again; `None` where only an input can bring something. Where the tick has
    /// passed already, at once.
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
            self.hear(cycle, levels);
        }
        self.run(cycle, chip);
        if is_off && levels.level(Signal::Power) {
            return Some(self.power_up_again(now, chip));
        }
        self.wake()
    }

    /// A byte that would be complete by `now` is not: the chip still writes it.
    fn wait_for_byte(&mut self, now: Instant) {
        let cycle = now.0 - self.origin;
        if self.machine.byte_due() <= cycle {
            let write = self.checked.controllers().first().map_or(0, |one| one.memory.byte_write_cycles);
            let again = (u64::from(write) / ASK_AGAIN).max(1);
            self.machine.postpone_byte(cycle.saturating_add(again));
        }
    }

    /// The cycle that `now` is. Where one was due before, it is that one, and the machine's time has stood still since.
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

    /// Inputs that have changed, from `cycle` on or, where that has been run, from the next one.
    fn hear(&mut self, cycle: u64, levels: RawLevels) {
        let at = Instant(cycle.max(self.machine.now().0).max(1));
        for signal in levels.changed(self.heard) {
            let level = levels.level(signal);
            // An input that has changed in this very cycle already is heard in the next.
            if self.machine.enter_level(at, signal, level) {
                self.heard = self.heard.with(signal, level);
            }
        }
    }

    fn run(&mut self, cycle: u64, chip: &mut impl Chip) {
        let decimals = self.decimals();
        let origin = self.origin;
        self.machine.run(Instant(cycle.saturating_add(1)), &mut Outlet { chip, origin, decimals });
        // What a run keeps of all its past has no end on a chip.
        self.machine.forget();
        if let Some((begun, address, byte)) = self.machine.byte_under_way()
            && self.begun != Some(begun)
        {
            self.begun = Some(begun);
            chip.begin_byte(address, byte);
        }
    }

    /// The power is back, and the chip has outlived the machine's hold-up: the restart of G2, from what the EEPROM holds.
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

    /// The machine, to be looked at.
    #[must_use]
    pub const fn machine(&self) -> &StandAlone {
        &self.machine
    }

    /// How late the chip woke since power-up.
    #[must_use]
    pub const fn lateness(&self) -> Lateness {
        self.lateness
    }

    /// What stands on the panel at the cycle that was run last.
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

/// Where what changes in a cycle goes: to pins and panel.
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
