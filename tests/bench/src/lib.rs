//! The kernels of `cargo xtask bench`: the same functions as native code and in a
//! browser.
//!
//! | file | contents |
//! | --- | --- |
//! | `motions` | the experiments |
//! | `planners` | a move of each planner |
//! | `kernel` | each kernel: what it does, its reference kernel, and its target ratio |
//! | `kernels` | runs the kernels |
//! | `rounds` | times all kernels in rounds, and reports the times |
//! | `page` (wasm) | such rounds for the worker in `page/` |
//! | `benches/kernels` | as native code: such rounds, or criterion's figure of each kernel |
//!
//! The speed of a busy machine changes every second, so each ratio compares two times that were measured
//! one after the other in the same round.

pub mod kernel;
pub mod kernels;
pub mod motions;
pub mod planners;
pub mod rounds;

#[cfg(target_arch = "wasm32")]
mod page;
