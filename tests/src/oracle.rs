//! An independent model of the peripheral: slow, and written only from the text of DESIGN Part A. Property tests compare
//! each edge of the core with it.
//!
//! It is simple: it visits each cycle of `0..cycles`, and takes levels directly from the contract's
//! formulas. It skips and predicts nothing, and shares nothing with the core, not even COBS and CRC-32C.
//!
//! ```text
//! sends, replies, forced --A4 sender--> line (RX, one level per cycle) --A4 receiver--> bytes, framing errors
//!    --A5 packets | A6 frames--> commands, faults, replies --A7--> queue, ticks, slots, pulses
//!    --A3--> records, positions
//! segments --A8--> pulses, DIR changes --A3--> records, positions
//! ```
//!
//! Where the contract is ambiguous, a comment "Reading:" states the interpretation.

mod controller;
mod frames;
mod line;
mod orders;
mod packets;
mod sequencer;

/// Lists of segments, and the results of their run.
pub mod segments;

#[cfg(test)]
mod tests;

use controller::{Controller, Driven};
use line::{forced_levels, host_levels};

pub use frames::{LONGEST_FRAME, cobs, crc32c, frame};
pub use line::{RxEvent, bit_start, byte_start, hear, line_levels, stop_sample};
pub use orders::kinds;
pub use packets::packets_schedule;
pub use segments::run_segments;
pub use sequencer::fires;

/// Fault bit 0 (A6's list): a stop bit was low.
pub const FRAMING: u16 = 1 << 0;
/// Fault bit 1: a gap ended an incomplete packet, or a run of bytes was no frame.
pub const SHORT_PACKET: u16 = 1 << 1;
/// Fault bit 2: the CRC of a frame was wrong.
pub const CRC: u16 = 1 << 2;
/// Fault bit 3: a run of bytes decoded to more than [`LONGEST_FRAME`].
pub const OVERLONG: u16 = 1 << 3;
/// Fault bit 4: the queue was full for a packet or frame.
pub const QUEUE_OVERFLOW: u16 = 1 << 4;
/// Fault bit 5: a packet or frame had more steps than a tick has slots.
pub const TOO_MANY_STEPS: u16 = 1 << 5;
/// Fault bit 6: a frame's seq was neither the expected one nor that of a repeat.
pub const BAD_SEQ: u16 = 1 << 6;
/// Fault bit 7 (A7): a tick with counts ended without a successor.
pub const UNDERRUN: u16 = 1 << 7;

/// The bits of a record's levels (A3): channel 0's STEP and DIR, and the lines that all channels share.
pub mod bits {
    /// STEP of channel 0; channel `i` is `i` bits higher.
    pub const STEP: u32 = 0;
    /// DIR of channel 0; channel `i` is `i` bits higher.
    pub const DIR: u32 = 16;
    /// EN, high = windings powered.
    pub const EN: u32 = 32;
    /// RX, idle high.
    pub const RX: u32 = 33;
    /// TX, idle high.
    pub const TX: u32 = 34;
    /// DE, high while the controller drives the line.
    pub const DE: u32 = 35;
}

/// All parameters of the contract, in its own units: rates in hertz and baud,
/// times in cycles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Config {
    /// Peripheral clock, hertz.
    pub clock_hz: u64,
    /// The sender's baud rate.
    pub baud: u64,
    /// The receiver's baud rate; it differs from `baud` if a clock error is modeled.
    pub receiver_baud: u64,
    /// Used channels, 1..=16.
    pub channels: usize,
    /// M, slots in a tick, 1..=127.
    pub slots: u64,
    /// Ts, cycles in a slot.
    pub step_period: u64,
    /// W, cycles.
    pub pulse_width: u64,
    /// D, cycles.
    pub dir_setup: u64,
    /// H, cycles.
    pub dir_hold: u64,
    /// dp, the settling time of the supply current, cycles; used by `staggered` only.
    pub settle: u64,
    /// Capacity of the queue, in ticks, 1..=255.
    pub queue_depth: usize,
    /// The cycles 0..=boot-1 are self-test.
    pub boot: u64,
    /// Distribution of a tick's steps: `true` spread, `false` burst.
    pub spread: bool,
    /// `true`: one DIR line for all; `false`: one per channel.
    pub common_dir: bool,
    /// `true`: staggered; `false`: simultaneous.
    pub staggered: bool,
    /// The controller's own address, 0..=254; `None`: raw packets have no address, and in framed mode it is 0.
    pub address: Option<u8>,
    /// `true`: the framed protocol (A6); `false`: raw packets (A5).
    pub framed: bool,
}

/// Activity of host and scenario on the line, and the length of the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// (start cycle, bytes sent back to back from there), not overlapping, none before cycle 1.
    pub sends: Vec<(u64, Vec<u8>)>,
    /// (cycle, length, level), none before cycle 1; if two overlap, the later entry wins.
    pub forced: Vec<(u64, u64, bool)>,
    /// The run is the cycles `0..cycles`.
    pub cycles: u64,
}

/// A6's state; the number is that in the status.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum State {
    /// Self-test.
    #[default]
    Busy = 0,
    /// Nothing runs or is queued.
    Ready = 1,
    /// A tick runs or is queued.
    Moving = 2,
    /// Stopped by STOP or DISABLE, until ENABLE.
    Stopped = 3,
}

/// Results of a run.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Run {
    /// A3's records (cycle, levels).
    pub trace: Vec<(u64, u64)>,
    /// Position counters; those of unused channels stay 0.
    pub positions: [i32; 16],
    /// Fault flags, bits as in A6's list.
    pub faults: u16,
    /// Ticks that ended.
    pub ticks_done: u32,
    /// The seq of the next TICKS (A6); 0 with raw packets.
    pub expected_seq: u8,
    /// The state in the last cycle of the run, after its byte; [`State::Busy`] for a run of no cycles.
    pub state: State,
    /// Free places of the queue.
    pub free: usize,
}

/// B, the receiver's bit time in cycles: "floor((2*clock_hz + receiver_baud) / (2*receiver_baud))" (A4).
pub fn bit_time(config: &Config) -> u64 {
    (2 * config.clock_hz + config.receiver_baud) / (2 * config.receiver_baud)
}

/// L = W + max(D + H, 1) (A7), cycles.
pub fn pulse_room(config: &Config) -> u64 {
    config.pulse_width + (config.dir_setup + config.dir_hold).max(1)
}

/// Whether a configuration is refused: A4's minimum bit time, A7's rules for pulses, and the ranges of A3, A5
/// and A7.
pub fn refused(config: &Config) -> bool {
    if config.clock_hz == 0 || config.baud == 0 || config.receiver_baud == 0 || config.step_period == 0 {
        return true;
    }
    if config.channels < 1 || config.channels > 16 {
        return true;
    }
    if config.slots < 1 || config.slots > 127 {
        return true;
    }
    if config.queue_depth < 1 || config.queue_depth > 255 {
        return true;
    }
    if config.address == Some(255) {
        return true;
    }
    if bit_time(config) < 11 {
        return true;
    }
    if config.pulse_width < 1 {
        return true;
    }
    let room = pulse_room(config);
    match (config.common_dir, config.staggered) {
        (false, false) => room > config.step_period,
        (true, false) => 2 * room > config.step_period,
        (false, true) => room > config.step_period / config.channels as u64,
        (true, true) => room > config.step_period / config.channels as u64 || config.settle < room,
    }
}

/// Runs a single controller on its line. Its configuration must not be [`refused`].
pub fn run(config: &Config, input: &Input) -> Run {
    run_line(std::slice::from_ref(config), input).remove(0)
}

/// Runs several controllers (1..=32) on one line, cycle by cycle; one run per controller, in the order of `configs`.
///
/// `clock_hz` and `baud` are equal. No configuration may be [`refused`].
pub fn run_line(configs: &[Config], input: &Input) -> Vec<Run> {
    assert!((1..=32).contains(&configs.len()), "{} controllers", configs.len());
    for config in configs {
        assert!(!refused(config), "a refused configuration has no run: {config:?}");
        assert!(config.clock_hz == configs[0].clock_hz && config.baud == configs[0].baud, "{configs:?}");
    }
    let host = host_levels(&configs[0], input);
    let forced = forced_levels(input);
    let mut controllers: Vec<Controller> = configs.iter().map(Controller::new).collect();

    for cycle in 0..input.cycles {
        let driven: Vec<Driven> = controllers.iter().map(|controller| controller.driven(cycle)).collect();
        for (k, controller) in controllers.iter_mut().enumerate() {
            // "the AND of what the host and all other controllers with DE = 1 send".
            let mut rx = host[cycle as usize];
            for (j, other) in driven.iter().enumerate() {
                if j != k && other.de {
                    rx &= other.tx;
                }
            }
            // "gives it that level for that long, whatever is sent": by the host or by controllers.
            if let Some(level) = forced[cycle as usize] {
                rx = level;
            }
            // "1 while its own DE is high". Reading: even if a level is forced, because a transceiver that sends
            // receives nothing.
            if driven[k].de {
                rx = true;
            }
            controller.clock(cycle, rx, driven[k]);
        }
    }
    controllers.into_iter().map(|controller| controller.finish(input.cycles)).collect()
}
