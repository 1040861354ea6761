//! Native tests of the whole project: golden cases, comparison with the independent models, the papers' figures, properties,
//! links, and the architecture. One program, so that it is linked once; `page` is another one.
#![cfg(not(any(target_arch = "wasm32", target_os = "none")))]
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

mod architecture;
mod contract;
mod contract_line;
mod controller_model;
mod documents;
mod exactness;
mod findings;
mod golden;
mod hostile;
mod links;
mod packaging;
mod plant;
mod plant_model;
mod properties;
mod registers;
mod shared_line;
mod theme;
mod thumbnails;
mod web_layers;
