#![doc = include_str!("../datasheet.md")]
#![no_std]
#![allow(missing_docs, reason = "a name with its unit needs no comment that repeats it")]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod bus;
mod map;
pub mod table;

pub use bus::RegisterBus;
pub use map::*;
