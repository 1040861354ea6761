//! Random scenarios, as proptest strategies that shrink: such as run and are over soon, and such as are only of the
//! right types.

mod small;
mod typed;

pub use small::small;
pub use typed::typed;
