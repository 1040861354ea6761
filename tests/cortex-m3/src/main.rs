//! The golden cases of `tests/golden/` on a Cortex-M3 without an operating system, in QEMU: the same files and checks as in
//! the native test and in the browser. Also the example driver of `firmware/` on the model, and the stand-alone controller
//! as a program of this processor, the example of `firmware/controller/`.
//! `cargo xtask test --only bare-metal` builds and runs it.
//!
//! Differences to other targets: floating point is software, `usize` has 32 bits, and the core has no feature `std`, so
//! square roots come from libm, too.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod firmware;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this program is for a microcontroller: cargo xtask test --only bare-metal");
}
