//! The kernels that `cargo xtask bench` measures: the same functions as native code and in a
//! browser.
//!
//! | file | what it holds |
//! | --- | --- |
//! | `motions` | the experiments that are run |
//! | `planners` | a move of each planner |
//! | `kernel` | each kernel: what it does, what it is compared with, and the aim |
//! | `kernels` | the kernels at work |
//! | `rounds` | all kernels in turn, over and over, each timed; the report of it |
//! | `page` (wasm) | such rounds for the worker in `page/` |
//! | `benches/kernels` | as native code: such rounds, or criterion's figure of each kernel |
//!
//! A busy machine changes its speed from second to second, so a ratio is always one of two times
//! that were taken right after one another, in the same round.

pub mod kernel;
pub mod kernels;
pub mod motions;
pub mod planners;
pub mod rounds;

#[cfg(target_arch = "wasm32")]
mod page;
