//! The program: runs every case, the example driver and the example controller, and reports success or failure by semihosting.

extern crate alloc;

use crate::chip;
use alloc::{string::String, vec::Vec};
use cortex_m_rt::{ExceptionFrame, entry, exception};
use cortex_m_semihosting::{
    debug::{self, EXIT_FAILURE, EXIT_SUCCESS, ExitStatus},
    hprintln,
};
use embedded_alloc::TlsfHeap;
// A panic, also of a failed allocation, is printed and ends the program with failure.
use panic_semihosting as _;
use stepscope_core::peripheral::{
    config::{Bus, Config, SerialLine},
    device::ModelBus,
    signal::Record,
    units::Cycles,
};
use stepscope_firmware::{ChannelCommand, Driver, Error};
use stepscope_tests::{golden::CASES, plant_digests::plant_cases};

/// In bytes; the stack has the rest of memory.x's RAM after the heap and the constants.
const HEAP_BYTES: usize = 3 << 20;

#[global_allocator]
static HEAP: TlsfHeap = TlsfHeap::empty();

#[entry]
fn main() -> ! {
    #[allow(unsafe_code, reason = "the heap gets its memory once, before its first use")]
    unsafe {
        embedded_alloc::init!(HEAP, HEAP_BYTES);
    }
    let mut failed = 0;
    for case in CASES {
        match case.check() {
            Ok(()) => hprintln!("{}: as everywhere", case.name),
            Err(message) => {
                failed += 1;
                hprintln!("failed: {}", message.trim_end());
            }
        }
    }
    for case in plant_cases() {
        match case.check(false) {
            Ok(()) => hprintln!("plant {}: as everywhere", case.name),
            Err(message) => {
                failed += 1;
                hprintln!("failed: {message}");
            }
        }
    }
    match drive() {
        Ok([150, -75]) => hprintln!("the driver on the model: as everywhere"),
        ended => {
            failed += 1;
            hprintln!("failed: the driver on the model gave {ended:?}, not the positions [150, -75]");
        }
    }
    match chip::on_the_bench() {
        Ok(()) => hprintln!("the controller on the bench: as everywhere"),
        Err(message) => {
            failed += 1;
            hprintln!("failed: the controller on the bench: {message}");
        }
    }
    match on_the_board() {
        Ok(message) => hprintln!("the controller on this board: {message}"),
        Err(message) => {
            failed += 1;
            hprintln!("failed: the controller on this board: {message}");
        }
    }
    hprintln!("{} cases, the driver and the controller, {failed} failed", CASES.len());
    end(if failed == 0 { EXIT_SUCCESS } else { EXIT_FAILURE })
}

/// The example driver, built for this processor, moves two axes of the model; returns their positions.
fn drive() -> Result<[i32; 2], Error> {
    let bus = Bus { channels: 2, ..Bus::default() };
    let Ok(config) = Config::new(16_000_000, &bus, &SerialLine::default()) else {
        return Err(Error::NotFound(0));
    };
    let mut driver = Driver::new(ModelBus::new(&config, Cycles(8), Vec::<Record>::new()))?;
    driver.wait_for_self_test();
    let mut ticks = (1..=5).map(|tick| [ChannelCommand::right(10 * tick), ChannelCommand::left(5 * tick)]);
    while driver.ticks_done() < 5 {
        driver.fill(&mut ticks)?;
    }
    Ok([driver.position(0), driver.position(1)])
}

/// The example controller, with the board's own timer.
fn on_the_board() -> Result<String, String> {
    let peripherals = cortex_m::Peripherals::take().ok_or("the peripherals are taken")?;
    chip::on_the_board(peripherals.SYST)
}

/// Without this handler a crash would be silent until the timeout.
#[exception]
#[allow(unsafe_code, reason = "a fault's handler may be called by nobody but the processor")]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    hprintln!("hard fault: {frame:#?}");
    end(EXIT_FAILURE)
}

/// Ends the emulator; on real hardware a debugger may return from here.
fn end(status: ExitStatus) -> ! {
    debug::exit(status);
    loop {
        cortex_m::asm::wfi();
    }
}
