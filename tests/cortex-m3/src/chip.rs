//! The stand-alone controller as a program on this processor: the example of `firmware/controller` with `SysTick` as its
//! timer, two ports and an EEPROM in RAM. A simulated user presses start and cuts the power.
//!
//! The emulator runs in real time, so interrupts are late on a busy host: positions and memory are checked, but no ticks.
//! Ticks are checked on the bench with simulated time: exactly the edges of a golden case.

extern crate alloc;

use alloc::{format, string::String, vec::Vec};
use core::ops::ControlFlow;
use cortex_m::peripheral::{SYST, syst::SystClkSource};
use stepscope_controller_firmware::{
    bench::Bench,
    clock::Clock,
    run,
    wiring::{self, Contact},
};
use stepscope_core::{
    controller::{
        CheckedSetup, Runner, State,
        chip::{Chip, Face, RawLevels},
        input::Signal,
        panel,
        parameters::{Group, Memory, Move, Parameters, Setup},
    },
    peripheral::{
        signal::Levels,
        trace::Digest,
        units::{Cycles, Instant},
    },
};
use stepscope_tests::golden::{CASES, Case};

/// The golden case for the bench: a program, a power cut with hold-up, and the return of the power.
const ON_THE_BENCH: &str = "preset-controller-power-cut";
/// Properties of the board: `SysTick` counts the processor's clock down.
const CLOCK_HZ: u32 = 25_000_000;
const SYSTICK_BITS: u32 = 24;
const RELOAD: u32 = (1 << SYSTICK_BITS) - 1;
/// Bits of the panel's port, which pull-ups hold high.
const START: u32 = 1 << 0;
const ESTOP: u32 = 1 << 1;
const POWER: u32 = 1 << 2;
/// No button is pressed, and the contact of the emergency stop is closed.
const AT_REST: u32 = START | POWER;
const CONTACTS: &[Contact] =
    &[Contact::closes(Signal::Start, 0), Contact::opens(Signal::Estop, 1), Contact::opens(Signal::Power, 2)];
const _: () = assert!(AT_REST & ESTOP == 0);

/// The chip. Its ports are variables here.
struct Board {
    clock: Clock,
    panel: u32,
    motor: u32,
    eeprom: Vec<u8>,
    /// Address and value of the byte in progress, and the time of its completion.
    writing: Option<(usize, u8, Instant)>,
    byte_write: Cycles,
    /// Position of the motor by the edges of STEP.
    place: i64,
    face: Option<Face>,
}

impl Board {
    fn new(mut timer: SYST, checked: &CheckedSetup) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(RELOAD);
        timer.clear_current();
        timer.enable_counter();
        let write = checked.controllers().first().map_or(0, |one| one.memory.byte_write_cycles);
        Self {
            clock: Clock::new(SYSTICK_BITS),
            panel: AT_REST,
            motor: wiring::NOT_EN,
            eeprom: Runner::factory_memory(checked),
            writing: None,
            byte_write: Cycles(write.into()),
            place: 0,
            face: None,
        }
    }

    /// Waits for the tick, or for a change of an input; a chip with a compare timer would sleep.
    fn sleep(&mut self, wake: Option<Instant>) {
        let panel = self.panel;
        let now = self.now();
        let until = now + self.clock.sleep_time(wake);
        while self.now() < until && self.panel == panel {}
    }

    fn settle(&mut self) {
        let now = self.now();
        if let Some((address, byte, _)) = self.writing.take_if(|(_, _, there)| *there <= now)
            && let Some(cell) = self.eeprom.get_mut(address)
        {
            *cell = byte;
        }
    }
}

impl Chip for Board {
    fn now(&mut self) -> Instant {
        self.clock.extend(RELOAD - SYST::get_current())
    }

    fn inputs(&mut self) -> RawLevels {
        wiring::levels(CONTACTS, self.panel)
    }

    fn write_pins(&mut self, levels: Levels) {
        let before = core::mem::replace(&mut self.motor, wiring::port(levels));
        if self.motor & !before & wiring::STEP != 0 {
            self.place += if self.motor & wiring::DIR != 0 { 1 } else { -1 };
        }
    }

    fn show(&mut self, face: Face) {
        self.face = Some(face);
    }

    fn read_byte(&mut self, address: usize) -> u8 {
        self.settle();
        self.eeprom.get(address).copied().unwrap_or(0xff)
    }

    fn begin_byte(&mut self, address: usize, byte: u8) {
        let there = self.now() + self.byte_write;
        self.writing = Some((address, byte, there));
    }

    fn is_writing(&mut self) -> bool {
        self.settle();
        self.writing.is_some()
    }
}

/// One move of 60 steps at 1000 Hz; a byte is written in 0.4 ms.
fn checked() -> Result<CheckedSetup, String> {
    let group = Group::Move(Move { length: 6, speed_hz: 1000, level: 1, ..Move::default() });
    let memory = Memory { byte_write_cycles: 10_000, hold_up_cycles: 1_000_000, ..Memory::default() };
    let controller =
        Parameters { groups: [group].into(), memory, debounce_cycles: 1000, ..Parameters::default() };
    let setup = Setup { clock_hz: CLOCK_HZ, controllers: [controller].into(), ..Setup::default() };
    setup.check().map_err(|refused| format!("{refused:?}"))
}

/// Runs the program in real time: a move, a power cut during the next one, and another move after the
/// power returns. Returns the position and the maximum lateness as text.
///
/// # Errors
/// The first deviation.
pub(crate) fn on_the_board(timer: SYST) -> Result<String, String> {
    let checked = checked()?;
    let mut board = Board::new(timer, &checked);
    let mut starts = 0;
    // From READY to READY by a press; during the second move the power fails, and the chip stops.
    run(&mut board, &checked, |board, runner, wake| {
        let state = runner.machine().state(0);
        match state {
            Some(State::Ready) if board.panel & START != 0 && starts < 2 => {
                board.panel &= !START;
                starts += 1;
            }
            Some(State::Running) => board.panel |= START,
            Some(State::Off) => return ControlFlow::Break(()),
            _ => {}
        }
        if starts == 2 && board.place == 90 {
            board.panel &= !POWER;
        }
        board.sleep(wake);
        ControlFlow::Continue(())
    })
    .map_err(|refused| format!("{refused}"))?;
    let cut_at = board.place;

    // The power returns; the position comes from the EEPROM.
    (board.panel, starts) = (AT_REST, 0);
    let runner = run(&mut board, &checked, |board, runner, wake| {
        match runner.machine().state(0) {
            Some(State::Ready) if starts == 0 => {
                board.panel &= !START;
                starts = 1;
            }
            Some(State::Ready) if board.panel & START != 0 => return ControlFlow::Break(()),
            Some(State::Running) => board.panel |= START,
            Some(State::Alarm) => return ControlFlow::Break(()),
            _ => {}
        }
        board.sleep(wake);
        ControlFlow::Continue(())
    })
    .map_err(|refused| format!("{refused}"))?;
    let position = runner.machine().position(0).map(i64::from);
    let lcd = board.face.map(|_| runner.face().lcd()).unwrap_or_default();
    if !(90..=91).contains(&cut_at) || position != Some(cut_at + 60) || position != Some(board.place) {
        return Err(format!("cut at {cut_at}, it ends at {}, and reports {position:?} ({lcd})", board.place));
    }
    Ok(format!("cut at {cut_at}, LCD {lcd}, at worst {} cycles late", runner.lateness().worst.0))
}

/// Runs the same program on the bench, and compares the edges and the panel of a golden case.
///
/// # Errors
/// The first deviation.
pub(crate) fn on_the_bench() -> Result<(), String> {
    let case = CASES.iter().find(|case| case.name == ON_THE_BENCH).ok_or("there is no such case")?;
    let experiment = case.experiment()?;
    let mut setup = experiment.stand_alone().ok_or("it has no controllers")?.setup();
    let presses = setup.controllers.first_mut().map(|one| core::mem::take(&mut one.inputs));
    let checked = setup.check().map_err(|refused| format!("{refused:?}"))?;
    let mut bench = Bench::new(&checked, presses.unwrap_or_default(), Digest::default());
    run(&mut bench, &checked, |bench, _, wake| bench.sleep(wake, 0))
        .map_err(|refused| format!("{refused}"))?;
    let digest = format!("{:016x}", bench.sink.value());
    let panels = format!("panels {:016x}", panel::digest([bench.shown.as_slice()]));
    let text = |name| Case::file(case, name).unwrap_or_default();
    if text("digest").trim() != digest || !text("status").lines().any(|line| line == panels) {
        return Err(format!("digest {digest}, {panels}: not those of {ON_THE_BENCH}"));
    }
    Ok(())
}
