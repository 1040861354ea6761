//! The page's longest loops, built for speed where all around them is built small.
//!
//! A function is built as the crate is in which it comes into being: a generic one, and one that is `#[inline]`, in the
//! crate that calls it. So what stands here is at this crate's level with all that it calls of the core in these two
//! ways, while the core's own functions are at the core's: in the profile `page` small, and a third as fast. Whoever adds
//! a function to the core that a run calls for every record, window or byte gives it `#[inline]`.

use stepscope_core::run::{Run, Watched};

/// [`Run::advance_each`] with every controller watched: goes on until one of them has made `records` more, true at the
/// end.
#[inline(never)]
pub fn advance(run: &mut Run, records: u64, sinks: &mut [Watched]) -> bool {
    run.advance_each(records, sinks)
}
