//! Tests of the command, linked as one program. Tests that need other software are programs of their own:
//! `second_reader`, `avr_recordings`, `avr_live`, `live_judges`.
#![cfg(not(any(target_arch = "wasm32", target_os = "none")))]
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod action;
mod axis_data;
mod capture;
mod capture_maps;
mod check;
mod command;
mod compared;
mod controller;
#[cfg(unix)]
mod documents_commands;
mod exit_codes;
mod exports;
mod faults;
mod help;
mod inputs;
mod lines;
#[cfg(unix)]
mod live;
mod measures;
mod outputs;
#[cfg(unix)]
mod pipes;
mod plant;
mod program;
mod recordings;
mod scripts;
mod tables;
mod terminal;
mod torque;
mod uart;
mod written;
