//! The program of a chip with a stand-alone controller on it (CONTROLLER.md), and what it is put together from.
#![doc = ""]
#![doc = include_str!("../README.md")]
#![no_std]

extern crate alloc;

pub mod bench;
pub mod clock;
pub mod wiring;

use core::ops::ControlFlow;
use stepscope_controller::{CheckedSetup, NotRunnable, Runner, chip::Chip};
use stepscope_peripheral::units::Instant;

/// The program, from power-up on. `sleep` waits until the tick that it is given, or until an input changes, which may be as
/// well too early; on a chip it also refreshes the display from [`Runner::face`]. It goes on until `sleep` breaks off: on a
/// chip never.
///
/// # Errors
/// See [`Runner::power_up`].
pub fn run<C: Chip>(
    chip: &mut C,
    checked: &CheckedSetup,
    mut sleep: impl FnMut(&mut C, &Runner, Option<Instant>) -> ControlFlow<()>,
) -> Result<Runner, NotRunnable> {
    let mut runner = Runner::power_up(chip.now(), checked, chip)?;
    loop {
        let now = chip.now();
        let wake = runner.poll(now, chip);
        if sleep(chip, &runner, wake).is_break() {
            return Ok(runner);
        }
    }
}
