//! Tests of the model with numbers computed by hand, one table per rule of A4, A5, A7 and A9.
//!
//! The basic configuration has simple numbers: B = 16, a byte is 160 cycles
//! and is delivered 8 + 9*16 = 152 cycles after its start; the gap is 45*16 = 720. A tick is 4 slots of 10
//! cycles.

mod frames;
mod line;
mod orders;
mod packets;
mod pulses;
mod replies;
mod segments;
mod stops;
mod ticks;

use super::*;

fn base() -> Config {
    Config {
        clock_hz: 16_000,
        baud: 1_000,
        receiver_baud: 1_000,
        channels: 1,
        slots: 4,
        step_period: 10,
        pulse_width: 2,
        dir_setup: 1,
        dir_hold: 1,
        settle: 0,
        queue_depth: 2,
        boot: 0,
        spread: false,
        common_dir: false,
        staggered: false,
        address: None,
        framed: false,
    }
}

/// Sends only, without forced levels.
fn sent(sends: &[(u64, &[u8])], cycles: u64) -> Input {
    Input {
        sends: sends.iter().map(|(start, bytes)| (*start, bytes.to_vec())).collect(),
        forced: Vec::new(),
        cycles,
    }
}

/// The changes of one signal: (cycle, new level). The level at cycle 0 is not a change.
fn edges(run: &Run, bit: u32) -> Vec<(u64, bool)> {
    let level = |levels: u64| levels >> bit & 1 == 1;
    let pairs = run.trace.iter().zip(run.trace.iter().skip(1));
    pairs
        .filter(|(before, after)| level(before.1) != level(after.1))
        .map(|(_, after)| (after.0, level(after.1)))
        .collect()
}

/// The cycles in which a signal rises.
fn rises(run: &Run, bit: u32) -> Vec<u64> {
    edges(run, bit).into_iter().filter(|(_, level)| *level).map(|(cycle, _)| cycle).collect()
}

/// STEP rises of channel `channel`.
fn steps(run: &Run, channel: u32) -> Vec<u64> {
    rises(run, bits::STEP + channel)
}

/// The levels of one signal, one per cycle.
fn levels(run: &Run, bit: u32, cycles: u64) -> Vec<bool> {
    let mut levels = Vec::new();
    for (index, (from, record)) in run.trace.iter().enumerate() {
        let to = run.trace.get(index + 1).map_or(cycles, |next| next.0);
        levels.extend(vec![record >> bit & 1 == 1; (to - from) as usize]);
    }
    levels
}

/// The bytes on a controller's TX.
fn said(config: &Config, run: &Run, cycles: u64) -> Vec<u8> {
    hear(config, &levels(run, bits::TX, cycles))
        .into_iter()
        .map(|(_, heard)| match heard {
            RxEvent::Byte(byte) => byte,
            RxEvent::FramingError => panic!("TX breaks off"),
        })
        .collect()
}
