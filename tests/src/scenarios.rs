//! Random scenarios, as proptest strategies that shrink: such as run and are over soon, and such as are only of the
//! right types.

mod segments;
mod shared;
mod small;
mod typed;

pub use segments::segmented;
pub use shared::shared;
pub use small::small;
pub use typed::typed;
