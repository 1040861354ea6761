//! A simulated chip for tests: button presses, recorded pins, an EEPROM with write times, a limit switch, and late
//! interrupts. Time passes only in [`Bench::sleep`]. Without late interrupts its edges equal those of the simulation.
//!
//! ```
//! use stepscope_controller::{chip::Chip, parameters::Setup};
//! use stepscope_controller_firmware::bench::Bench;
//! use stepscope_peripheral::{signal::Record, units::Instant};
//!
//! let checked = Setup::default().check().expect("valid defaults");
//! let mut bench = Bench::new(&checked, [], Vec::<Record>::new());
//! bench.begin_byte(3, 0x20);
//! // The chip requested tick 7 and wakes two ticks late.
//! let _ = bench.sleep(Some(Instant(7)), 2);
//! assert!(bench.now() == Instant(9) && bench.is_writing());
//! // The power fails early in the byte, so its cell is erased.
//! bench.power_off();
//! assert_eq!(bench.read_byte(3), 0xff);
//! ```

use alloc::vec::Vec;
use core::ops::ControlFlow;
use stepscope_controller::chip::{Chip, Face, RawLevels};
use stepscope_controller::input::{Change, Input, Signal};
use stepscope_controller::{CheckedSetup, Runner, panel::PanelRecord};
use stepscope_peripheral::signal::{Levels, Record, Sink};
use stepscope_peripheral::units::Instant;

/// Bits that stay erased in a byte whose write is cut late (CONTROLLER G7).
const CUT_LATE: u8 = 0x0f;
const ERASED: u8 = 0xff;

#[derive(Clone, Copy, Debug)]
struct Byte {
    address: usize,
    byte: u8,
    begun: u64,
}

/// The simulated chip; `S` receives the edges of its pins.
#[derive(Clone, Debug)]
pub struct Bench<S> {
    now: u64,
    levels: RawLevels,
    /// The next one last.
    presses: Vec<Input>,
    pins: Option<Levels>,
    /// Receives the edges of the pins.
    pub sink: S,
    /// Changes of the panel so far.
    pub shown: Vec<PanelRecord>,
    memory: Vec<u8>,
    writing: Option<Byte>,
    /// Write time of the EEPROM per byte, in ticks.
    pub byte_write_ticks: u64,
    /// Position of the axis in steps.
    pub position: i64,
    /// Positions at which the home switch is closed.
    pub home_switch: Option<(i64, i64)>,
}

impl<S: Sink> Bench<S> {
    /// A new chip with factory memory and these presses.
    pub fn new(checked: &CheckedSetup, presses: impl IntoIterator<Item = Input>, sink: S) -> Self {
        let mut presses: Vec<Input> = presses.into_iter().collect();
        presses.sort_by_key(|input| core::cmp::Reverse(input.cycle));
        let write = checked.controllers().first().map_or(1, |one| one.memory.byte_write_cycles);
        Self {
            now: 0,
            levels: RawLevels::default(),
            presses,
            pins: None,
            sink,
            shown: Vec::new(),
            memory: Runner::factory_memory(checked),
            writing: None,
            byte_write_ticks: write.into(),
            position: 0,
            home_switch: None,
        }
    }

    /// Sleeps until tick `wake` or an input change, and `late` ticks more. Breaks if neither comes.
    pub fn sleep(&mut self, wake: Option<Instant>, late: u64) -> ControlFlow<()> {
        let press = self.presses.last().map(|input| input.cycle);
        let switch = (self.levels != self.with_switch()).then_some(Instant(self.now + 1));
        match [wake, press, switch].into_iter().flatten().min() {
            Some(at) => {
                self.now = self.now.max(at.0.saturating_add(late));
                ControlFlow::Continue(())
            }
            None => ControlFlow::Break(()),
        }
    }

    /// Cuts the power in this tick: a byte being written is cut, and all pins fall in the next tick.
    pub fn power_off(&mut self) {
        self.complete_write();
        if let Some(Byte { address, byte, begun }) = self.writing.take()
            && let Some(cell) = self.memory.get_mut(address)
            && self.now > begun
        {
            let is_early = (self.now - begun) * 2 < self.byte_write_ticks;
            *cell = if is_early { ERASED } else { byte | CUT_LATE };
        }
        self.now += 1;
        self.write_pins(Levels(Levels::RX | Levels::TX));
    }

    /// Levels of the inputs, with the home switch at the present position.
    fn with_switch(&self) -> RawLevels {
        self.home_switch.map_or(self.levels, |(from, to)| {
            self.levels.with(Signal::HomeSwitch, (from..=to).contains(&self.position))
        })
    }

    /// Completes a write whose time has passed.
    fn complete_write(&mut self) {
        let done = self.writing.take_if(|writing| writing.begun + self.byte_write_ticks <= self.now);
        if let Some(Byte { address, byte, .. }) = done
            && let Some(cell) = self.memory.get_mut(address)
        {
            *cell = byte;
        }
    }
}

impl<S: Sink> Chip for Bench<S> {
    fn now(&mut self) -> Instant {
        Instant(self.now)
    }

    fn inputs(&mut self) -> RawLevels {
        while let Some(press) = self.presses.pop_if(|press| press.cycle.0 <= self.now) {
            if let Change::Level(signal, level) = press.change {
                self.levels = self.levels.with(signal, level);
            }
        }
        self.levels = self.with_switch();
        self.levels
    }

    fn write_pins(&mut self, levels: Levels) {
        let before = self.pins.replace(levels).unwrap_or(Levels(0));
        if levels != before {
            self.sink.record(Record { cycle: Instant(self.now), levels });
        }
        if levels.step() & !before.step() & 1 != 0 && levels.has(Levels::EN) {
            self.position += if levels.dir() & 1 != 0 { 1 } else { -1 };
        }
    }

    fn show(&mut self, face: Face) {
        let Face { at, word, position, display, .. } = face;
        self.shown.push(PanelRecord { cycle: at, word, position, display });
    }

    fn read_byte(&mut self, address: usize) -> u8 {
        self.complete_write();
        self.memory.get(address).copied().unwrap_or(ERASED)
    }

    fn begin_byte(&mut self, address: usize, byte: u8) {
        self.complete_write();
        debug_assert!(self.writing.is_none(), "a byte is being written");
        self.writing = Some(Byte { address, byte, begun: self.now });
    }

    fn is_writing(&mut self) -> bool {
        self.complete_write();
        self.writing.is_some()
    }
}
