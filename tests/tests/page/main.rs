//! The page in a real browser: Chromium without a window, driven by chromedriver, under the headers that a
//! host sends. What the page shows is held against what the core gives natively.
//!
//! `cargo xtask test --only page` builds the page and sets the environment:
//!
//! | variable | what it names |
//! | --- | --- |
//! | `STEPSCOPE_CHROMIUM`, `STEPSCOPE_CHROMEDRIVER` | the browser and its driver |
//! | `STEPSCOPE_XTASK` | the program whose `serve --port 0` serves the page |
//! | `STEPSCOPE_WEB` | the folder with the page as it is shipped |
//! | `STEPSCOPE_SHOTS` | a folder for pictures of the page, and of every page that failed; none without it |
//!
//! | file | what it holds |
//! | --- | --- |
//! | `bench` | server, driver and sessions of one test, ended with it however it ends |
//! | `session` | one browser with the page in it: what a visitor does and sees |
//! | `pixels` | what is drawn on a canvas |
//! | `native` | what the core says of the same scenario |
//! | the others | the tests |
#![cfg(not(target_arch = "wasm32"))]

mod bench;
mod controllers;
mod drawing;
mod editing;
mod engine;
mod framed;
mod hostile_links;
mod keeping;
mod links;
mod loading;
mod native;
mod offline;
mod pixels;
mod presets;
mod screens;
mod session;
mod time_axis;
mod timing;
