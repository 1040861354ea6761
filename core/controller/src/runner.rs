//! The machine on a chip (CONTROLLER G7): runs it up to the current tick with the current inputs, and returns the next
//! wake-up time.
//!
//! ```text
//! tick     ──┬───────────────┬──────╎────┬─────────┬──>   the chip wakes at `wake`, late by L, or for an input
//!         poll(now)       input    wake  poll     poll
//! cycle    ──┬───────────────┬──────┬ ─ ─ ┬────────┬──>   the machine's time stops while the chip is late:
//!            run        enter, run  c     c       c + n   cycle = tick - origin, and origin increases by L
//! ```
//!
//! A late chip delays edges by the total lateness ([`Runner::lateness`]), but never brings them closer to each other: no
//! pulse becomes too short, no rate too high, and no edge is lost. The time from a poll to the change of a pin is not counted.
//!
//! A byte of memory is complete when the chip reports it, and not before `byte_write_cycles`. So a slow EEPROM delays the
//! first step until the opening record is complete.

use crate::chip::{Chip, Face, RawLevels};
use crate::{
    checked::CheckedSetup, controller::NEVER, input::Signal, machine::StandAlone, panel::Word, state::State,
};
use alloc::vec::Vec;
use core::fmt;
use stepscope_peripheral::signal::{Event, Record, Sink};
use stepscope_peripheral::units::{Cycles, Instant};

/// Polls per `byte_write_cycles` while a slow chip is still writing.
const WRITE_POLLS: u64 = 64;

/// Why a setup cannot run on a chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotRunnable {
    /// The setup has this number of controllers instead of one.
    Controllers(usize),
    /// A virtual axis would drive the switches.
    Axis,
}

impl fmt::Display for NotRunnable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Controllers(given) => {
                write!(f, "{given} controllers do not fit on a chip; use one per chip")
            }
            Self::Axis => {
                f.write_str("axis: a virtual axis cannot drive the real switches of a chip; remove it")
            }
        }
    }
}

impl core::error::Error for NotRunnable {}

/// How late the chip woke for cycles with events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lateness {
    /// Of the last event.
    pub last: Cycles,
    /// The maximum since power-up.
    pub worst: Cycles,
    /// The sum since power-up, which is the current delay of an edge.
    pub total: Cycles,
}

/// A controller that runs on a [`Chip`]; see the example there.
#[derive(Clone, Debug)]
pub struct Runner {
    machine: StandAlone,
    checked: CheckedSetup,
    /// The tick of cycle 0, plus the total lateness.
    origin: u64,
    lateness: Lateness,
    levels: RawLevels,
    /// Begin of the byte that was passed to the chip last.
    byte_begun: Option<Instant>,
}

impl Runner {
    /// Powers up: cycle 0 of the machine is tick `now`. Reads the inputs and the EEPROM of the chip, and writes nothing.
    /// Buttons that are held are not pressed. The script and `memory.initial` have no effect.
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
            byte_begun: None,
        }
    }

    /// The EEPROM contents of a new chip, from address 0: `memory.initial`.
    pub fn factory_memory(checked: &CheckedSetup) -> Vec<u8> {
        StandAlone::new(checked).memory(0).to_vec()
    }

    /// Runs the machine up to tick `now`: reads inputs, writes pins and panel, and begins a byte of memory. Returns the tick
    /// of the next call, which may have passed already; `None` if only an input can cause an event.
    pub fn poll(&mut self, now: Instant, chip: &mut impl Chip) -> Option<Instant> {
        if now.0 < self.origin {
            return Some(Instant(self.origin));
        }
        let levels = chip.inputs();
        if chip.is_writing() {
            self.delay_byte(now);
        }
        let cycle = self.cycle_of(now);
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
    fn delay_byte(&mut self, now: Instant) {
        let cycle = now.0 - self.origin;
        if self.machine.byte_due() <= cycle {
            let write = self.checked.controllers().first().map_or(0, |one| one.memory.byte_write_cycles);
            let again = (u64::from(write) / WRITE_POLLS).max(1);
            self.machine.postpone_byte(cycle.saturating_add(again));
        }
    }

    /// The cycle of tick `now`, but at most the next one with an event: the machine's time stops while the chip is late.
    fn cycle_of(&mut self, now: Instant) -> u64 {
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

    /// Enters changed inputs in `cycle` or, if that has been run, in the next cycle.
    fn read_inputs(&mut self, cycle: u64, levels: RawLevels) {
        let at = Instant(cycle.max(self.machine.now().0).max(1));
        for signal in levels.changed(self.levels) {
            let level = levels.level(signal);
            // A second change in the same cycle is entered at the next poll.
            if self.machine.enter_level(at, signal, level) {
                self.levels = self.levels.with(signal, level);
            }
        }
    }

    fn run(&mut self, cycle: u64, chip: &mut impl Chip) {
        let decimals = self.decimals();
        let origin = self.origin;
        self.machine.run(Instant(cycle.saturating_add(1)), &mut ChipSink { chip, origin, decimals });
        // A chip runs without end, so the history must not grow.
        self.machine.clear_history();
        if let Some((begun, address, byte)) = self.machine.byte_in_progress()
            && self.byte_begun != Some(begun)
        {
            self.byte_begun = Some(begun);
            chip.begin_byte(address, byte);
        }
    }

    /// Restarts from the contents of the EEPROM, because the power came back before the chip stopped.
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

    pub const fn machine(&self) -> &StandAlone {
        &self.machine
    }

    /// How late the chip was so far.
    pub const fn lateness(&self) -> Lateness {
        self.lateness
    }

    /// The contents of the panel now.
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
struct ChipSink<'c, C> {
    chip: &'c mut C,
    origin: u64,
    decimals: u8,
}

impl<C: Chip> Sink for ChipSink<'_, C> {
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
