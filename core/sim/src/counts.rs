//! How often this thread's tests have read a scenario and planned its motions.

use core::cell::Cell;

std::thread_local! {
    pub(crate) static READ: Cell<u32> = const { Cell::new(0) };
    pub(crate) static PLANNED: Cell<u32> = const { Cell::new(0) };
}
