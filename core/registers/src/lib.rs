#![doc = include_str!("../datasheet.md")]
#![no_std]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod bus;
mod map;
pub mod table;

pub use bus::RegisterBus;
pub use map::*;
