#![doc = include_str!("../datasheet.md")]
#![no_std]

mod bus;
mod map;
pub mod table;

pub use bus::RegisterBus;
pub use map::*;
