//! The program: runs every case and ends with success or failure, all through semihosting.

extern crate alloc;

use cortex_m_rt::{ExceptionFrame, entry, exception};
use cortex_m_semihosting::{
    debug::{self, EXIT_FAILURE, EXIT_SUCCESS, ExitStatus},
    hprintln,
};
use embedded_alloc::TlsfHeap;
// A panic, also that of an allocation for which there is no room, is printed and ends with failure.
use panic_semihosting as _;
use stepscope_tests::golden::CASES;

/// Bytes; what the heap and the constants leave of memory.x's RAM is the stack's.
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
    hprintln!("{} cases, {failed} failed", CASES.len());
    end(if failed == 0 { EXIT_SUCCESS } else { EXIT_FAILURE })
}

/// A crash would otherwise be silence until the time is up.
#[exception]
#[allow(unsafe_code, reason = "a fault's handler may be called by nobody but the processor")]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    hprintln!("hard fault: {frame:#?}");
    end(EXIT_FAILURE)
}

/// Ends the emulator; a debugger on real hardware may come back from there.
fn end(status: ExitStatus) -> ! {
    debug::exit(status);
    loop {
        cortex_m::asm::wfi();
    }
}
