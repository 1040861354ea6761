//! Random scenarios, as proptest strategies that shrink: such as run and are over soon, and such as are only of the
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
