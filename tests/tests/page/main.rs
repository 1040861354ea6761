//! The page in real browsers, driven by WebDriver, with the headers of a host: its main task in three engines, all
//! else in headless Chromium. The page's values are compared with native runs of the core.
//!
//! `cargo xtask test --only page --only engines` builds the page and sets the environment:
//!
//! | variable | meaning |
//! | --- | --- |
//! | `STEPSCOPE_CHROMIUM`, `STEPSCOPE_CHROMEDRIVER` | the browser and its driver |
//! | `STEPSCOPE_FIREFOX`, `STEPSCOPE_GECKODRIVER` | the same of Firefox |
//! | `STEPSCOPE_WEBKITDRIVER`, `DISPLAY` | the driver of WebKit, which finds its browser, and a display for it |
//! | `STEPSCOPE_COMMAND` | the command `stepscope`, for a system port; only for the tests of `live_port` |
//! | `STEPSCOPE_XTASK` | the program whose `serve --port 0` serves the page |
//! | `STEPSCOPE_WEB` | the folder with the page's sources and its wasm: single modules can be tested there |
//! | `STEPSCOPE_DIST` | the folder with the shipped page |
//! | `STEPSCOPE_SHOTS` | a folder for pictures of the page after failures; optional |
//!
//! | file | contents |
//! | --- | --- |
//! | `programs` | servers and drivers, which always end with this process |
//! | `pool` | browsers that the tests share; reset between tests |
//! | `bench` | the setup of one test, always released at its end |
//! | `browser` | the three engines: drivers, sessions, consoles |
//! | `session` | one browser with the page: actions of a user, and what is visible |
//! | `devtools` | requests to a browser beyond WebDriver |
//! | `pixels` | the contents of a canvas |
//! | `device` | the dialog Device, and a mock of `navigator.serial` |
//! | `native` | the results of the core for the same scenario |
//! | the others | the tests |
#![cfg(not(target_arch = "wasm32"))]

mod axe;
mod bench;
mod browser;
mod charts;
mod controllers;
mod cursors;
mod device;
mod devtools;
mod drawing;
mod editing;
mod engine;
mod engines;
mod exchange;
mod exports;
mod framed;
mod frames;
mod golden_pictures;
mod hostile_links;
mod isolation;
mod keeping;
mod keyboard;
mod links;
mod live;
mod live_aside;
mod live_engines;
mod live_port;
mod live_raw;
mod live_stop;
mod loading;
mod logic;
mod measures;
mod motor;
mod native;
mod offline;
mod packets;
mod panel;
mod pixels;
mod pool;
mod presets;
mod programs;
mod recording;
mod recording_files;
mod recording_kept;
mod recording_parts;
mod recording_replies;
mod recording_views;
mod reflow;
mod rows;
mod screens;
mod session;
mod small_screens;
mod spectrum;
mod start;
mod stepping;
mod study;
mod time_axis;
mod timing;
mod torque;
mod usability;
