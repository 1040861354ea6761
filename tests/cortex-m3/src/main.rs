//! The golden cases of `tests/golden/` on a Cortex-M3 without an operating system, in QEMU: the very files, and the very
//! judgement, of the native test and the one in a browser; the example driver of `firmware/`, on the model; and the
//! stand-alone controller as this processor's own program, the example of `firmware/controller/`.
//! `cargo xtask test --only bare-metal` builds and runs it.
//!
//! What may differ here: floating point is software, `usize` has 32 bits, and the core is without its feature `std`, so
//! that also square roots come from libm.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod chip;
#[cfg(target_os = "none")]
mod firmware;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this program is for a microcontroller: cargo xtask test --only bare-metal");
}
