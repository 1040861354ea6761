//! A stand-alone controller for a chip (CONTROLLER.md), and its parts.
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

/// Runs from power-up until `sleep` breaks, which on a chip is never. `sleep` waits for the given tick or an input change,
/// and may return early; on a chip it also refreshes the display from [`Runner::face`].
/// Errors: see [`Runner::power_up`].
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
