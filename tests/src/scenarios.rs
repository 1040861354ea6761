//! Random scenarios, as proptest strategies that shrink: short ones that run, and ones that only have the
//! right types.

mod arbitrary;
mod grouped;
mod segments;
mod shared;
mod small;

pub use arbitrary::{driven, typed};
pub use segments::segmented;
pub use shared::shared;
pub use small::small;
