//! Stepscope for C and C++. The documentation is `include/stepscope.h`, which cbindgen writes from this crate.
//!
//! ```text
//! scenario, run, steps, device, frame     the functions
//! handle                                  the table of names: what a caller holds is looked up, never followed
//! pointer                                 the only places that read and write the caller's memory
//! status, error                           results and errors; the border that no panic crosses
//! ```
//!
//! Nothing is computed here: each function checks its arguments and calls `stepscope-core`.
#![allow(unsafe_code, reason = "exported names, and the caller's memory; each block states why it is sound")]
#![allow(unreachable_pub, reason = "C reaches functions by their names")]
#![allow(clippy::missing_safety_doc, reason = "the documentation is that of the header")]

mod device;
mod error;
mod frame;
mod handle;
mod pointer;
mod run;
mod scenario;
mod status;
mod steps;

use std::ffi::c_char;

/// The version of the library, such as "0.2.0".
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

/// The version of the binary interface. It must equal STEPSCOPE_ABI of the header that the program was compiled with.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_abi() -> u32 {
    1
}

/// Number of scenarios, runs, devices and errors that are not freed yet.
#[unsafe(no_mangle)]
pub extern "C" fn stepscope_live() -> usize {
    handle::live()
}
