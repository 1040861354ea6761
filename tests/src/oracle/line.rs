//! A4: the line, by the sender's rule and its forced levels, and the receiver.

use super::{Config, Input, bit_time};

/// Start of the `j`-th of the bytes sent back to back from `t0`: "t0 + floor(10*j*clock_hz/baud)" (A4).
pub fn byte_start(config: &Config, t0: u64, j: u64) -> u64 {
    t0 + 10 * j * config.clock_hz / config.baud
}

/// First cycle of bit `k` of a byte that starts at `start`; `k` = 10 is the stop bit's end (A4).
pub fn bit_start(config: &Config, start: u64, k: u64) -> u64 {
    start + k * config.clock_hz / config.baud
}

/// The cycle in which a byte that the receiver first saw at `t` is delivered, or has no stop bit
/// (A4).
pub fn stop_sample(config: &Config, t: u64) -> u64 {
    t + bit_time(config) / 2 + 9 * bit_time(config)
}

/// Calls `hold(from, to, level)` for each bit of `bytes`, sent back to back from `t0` at the rate `config.baud`:
/// the line has `level` during `[from, to)` (A4).
pub(super) fn send(config: &Config, t0: u64, bytes: &[u8], mut hold: impl FnMut(u64, u64, bool)) {
    for (j, byte) in bytes.iter().enumerate() {
        let start = byte_start(config, t0, j as u64);
        for k in 0..10 {
            let level = match k {
                0 => false,
                9 => true,
                _ => byte >> (k - 1) & 1 == 1,
            };
            hold(bit_start(config, start, k), bit_start(config, start, k + 1), level);
        }
    }
}

/// The host's levels, one per cycle: high, then the bits of the sends.
pub(super) fn host_levels(config: &Config, input: &Input) -> Vec<bool> {
    let mut line = vec![true; input.cycles as usize];
    for (t0, bytes) in &input.sends {
        send(config, *t0, bytes, |from, to, level| {
            for cycle in from..to.min(input.cycles) {
                // "RX = TX = 1" at cycle 0 (A3), regardless of sends.
                if cycle >= 1 {
                    line[cycle as usize] = level;
                }
            }
        });
    }
    line
}

/// The forced levels, in the order of the entries; `None` without one.
pub(super) fn forced_levels(input: &Input) -> Vec<Option<bool>> {
    let mut forced = vec![None; input.cycles as usize];
    for &(start, length, level) in &input.forced {
        for cycle in start..(start + length).min(input.cycles) {
            // "RX = TX = 1" at cycle 0 (A3), regardless of forced levels.
            if cycle >= 1 {
                forced[cycle as usize] = Some(level);
            }
        }
    }
    forced
}

/// The line's level in every cycle of the run while no controller drives it.
pub fn line_levels(config: &Config, input: &Input) -> Vec<bool> {
    let host = host_levels(config, input);
    host.into_iter().zip(forced_levels(input)).map(|(sent, forced)| forced.unwrap_or(sent)).collect()
}

/// Result of the receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RxEvent {
    /// A delivered byte.
    Byte(u8),
    /// The stop bit was low: the byte is dropped.
    FramingError,
}

/// A4's receiver, between two cycles.
pub(super) enum Receiver {
    Armed,
    /// The line was first seen low at `t`; `byte` holds the data bits sampled so far.
    InByte {
        t: u64,
        byte: u8,
    },
    /// After a framing error: until the line has been high for one cycle.
    WaitingForHigh,
}

impl Receiver {
    /// The receiver's result in `cycle`, in which the line is `high` or low.
    pub(super) fn hear(&mut self, config: &Config, cycle: u64, high: bool) -> Option<RxEvent> {
        let bit_time = bit_time(config);
        let mut heard = None;
        // The state after a cycle applies in the next one: "arms again in the next cycle", "is armed from
        // the next cycle on", "arms in the cycle after the first cycle … in which the line is high".
        *self = match *self {
            Receiver::Armed if high => Receiver::Armed,
            Receiver::Armed => Receiver::InByte { t: cycle, byte: 0 },
            Receiver::InByte { t, .. } if cycle == t + bit_time / 2 && high => Receiver::Armed,
            Receiver::InByte { t, byte } if cycle == stop_sample(config, t) => {
                heard = Some(if high { RxEvent::Byte(byte) } else { RxEvent::FramingError });
                if high { Receiver::Armed } else { Receiver::WaitingForHigh }
            }
            Receiver::InByte { t, mut byte } => {
                for i in 0..8 {
                    if cycle == t + bit_time / 2 + (i + 1) * bit_time && high {
                        byte |= 1 << i;
                    }
                }
                Receiver::InByte { t, byte }
            }
            Receiver::WaitingForHigh if high => Receiver::Armed,
            Receiver::WaitingForHigh => Receiver::WaitingForHigh,
        };
        heard
    }
}

/// The deliveries and framing errors of a receiver on a line, each with its cycle.
pub fn hear(config: &Config, line: &[bool]) -> Vec<(u64, RxEvent)> {
    let mut receiver = Receiver::Armed;
    let mut heard = Vec::new();
    for (cycle, &high) in line.iter().enumerate() {
        let cycle = cycle as u64;
        heard.extend(receiver.hear(config, cycle, high).map(|what| (cycle, what)));
    }
    heard
}
