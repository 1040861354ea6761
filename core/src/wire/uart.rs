//! The receiver of the serial line (DESIGN A4): 8N1, one look a bit.
//!
//! ```text
//! seen low at t; looks again at t + floor(B/2): high = a glitch, arms again in the next cycle
//! data bit i at t + floor(B/2) + (i+1)*B, stop bit at t + floor(B/2) + 9*B
//! stop high: the byte is delivered in that cycle, armed from the next
//! stop low: framing error; arms in the cycle after the first later one that is high
//! ```

use crate::units::{Cycles, Instant};

/// What the receiver heard in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// A byte.
    Byte(u8),
    /// A byte whose stop bit was low; it is dropped.
    FramingError,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Waits for the line to be low.
    Armed,
    /// Looks at bit `bit` (0 start, 1..=8 data, 9 stop) in cycle `at`.
    Sampling { at: Instant, bit: u8, byte: u8 },
    /// After a framing error: waits for the line to be high.
    Broken,
}

/// The receiver.
#[derive(Clone, Debug)]
pub struct Receiver {
    bit: Cycles,
    state: State,
    /// Where the latest start bit was seen.
    seen: Instant,
}

impl Receiver {
    /// A receiver of bit time `bit`, armed.
    #[must_use]
    pub const fn new(bit: Cycles) -> Self {
        Self { bit, state: State::Armed, seen: Instant::RESET }
    }

    /// Where the latest start bit was seen.
    #[must_use]
    pub const fn seen(&self) -> Instant {
        self.seen
    }

    /// Next cycle after `now` in which the receiver does something if the line stays at `rx`.
    #[must_use]
    pub const fn deadline(&self, now: Instant, rx: bool) -> Instant {
        match self.state {
            State::Sampling { at, .. } => at,
            State::Armed if !rx => now.next(),
            State::Broken if rx => now.next(),
            _ => Instant::NEVER,
        }
    }

    /// Cycle `now` with the line at `rx`.
    pub fn clock(&mut self, now: Instant, rx: bool) -> Option<Heard> {
        match self.state {
            State::Armed if !rx => {
                self.seen = now;
                self.state = State::Sampling { at: now + Cycles(self.bit.0 / 2), bit: 0, byte: 0 };
            }
            State::Broken if rx => self.state = State::Armed,
            State::Sampling { at, bit, byte } if at == now => return self.sample(now, rx, bit, byte),
            _ => {}
        }
        None
    }

    fn sample(&mut self, now: Instant, rx: bool, bit: u8, byte: u8) -> Option<Heard> {
        match (bit, rx) {
            (0, true) => self.state = State::Armed,
            (9, true) => {
                self.state = State::Armed;
                return Some(Heard::Byte(byte));
            }
            (9, false) => {
                self.state = State::Broken;
                return Some(Heard::FramingError);
            }
            _ => {
                let level = if bit == 0 { 0 } else { u8::from(rx) << (bit - 1) };
                self.state = State::Sampling { at: now + self.bit, bit: bit + 1, byte: byte | level };
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// B = 11: looks at t+5 (start), t+16+11*i (data), t+104 (stop).
    fn heard(low: &[(u64, u64)], cycles: u64) -> Vec<(u64, Heard)> {
        let mut receiver = Receiver::new(Cycles(11));
        (1..cycles)
            .filter_map(|c| {
                let rx = !low.iter().any(|&(from, to)| (from..to).contains(&c));
                receiver.clock(Instant(c), rx).map(|h| (c, h))
            })
            .collect()
    }

    #[test]
    fn a_byte_is_delivered_in_the_cycle_that_looks_at_its_stop_bit() {
        assert_eq!(heard(&[(10, 21)], 300), [(114, Heard::Byte(0xff))]);
        assert_eq!(heard(&[(10, 109)], 300), [(114, Heard::Byte(0x00))]);
        assert_eq!(heard(&[(10, 32)], 300), [(114, Heard::Byte(0xfe))]);
    }

    #[test]
    fn a_low_shorter_than_half_a_bit_is_a_glitch_and_the_next_cycle_arms() {
        // Low in 10..15 only: at 15 the line is high, armed in 16.
        assert_eq!(heard(&[(10, 15), (16, 27)], 300), [(120, Heard::Byte(0xff))]);
        // A low that begins in the cycle of the look and ends in it is not seen.
        assert_eq!(heard(&[(10, 14), (15, 16)], 300), [(114, Heard::Byte(0xff))]);
    }

    #[test]
    fn after_a_framing_error_the_receiver_arms_one_cycle_after_the_line_is_high() {
        // Held low to 200: error at 114. High in 200 only arms 201; the low of 201 is a start bit.
        assert_eq!(
            heard(&[(10, 200), (201, 212)], 500),
            [(114, Heard::FramingError), (305, Heard::Byte(0xff))]
        );
        // Two lows that meet leave no high cycle.
        assert_eq!(heard(&[(10, 200), (200, 212)], 500), [(114, Heard::FramingError)]);
    }
}
