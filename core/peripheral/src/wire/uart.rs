//! The receiver of the serial line (DESIGN A4): 8N1, one sample per bit.
//!
//! ```text
//! B: cycles per bit, t: first low cycle
//! start bit sampled at t + floor(B/2). A high level then is a glitch: the receiver is armed again in the next cycle.
//! data bit i at t + floor(B/2) + (i+1)*B, stop bit at t + floor(B/2) + 9*B
//! stop bit high: the byte is delivered in that cycle; the receiver is armed again in the next cycle.
//! stop bit low: framing error. The receiver is armed one cycle after the line is high again.
//! ```

use crate::units::{Cycles, Instant};

const STOP: u32 = 9;

/// What a sample completed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RxEvent {
    Byte(u8),
    /// A byte whose stop bit was low.
    FramingError,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Waits for a start bit.
    Armed,
    /// Within a byte: the next bit to sample (0 start, 1..=8 data, 9 stop), when, and the data bits so far.
    Sampling { bit: u32, at: Instant, byte: u8 },
    /// After a framing error: waits for the line to be high.
    AwaitingHigh,
}

/// Receives bytes from the level of the line.
#[derive(Clone, Debug)]
pub struct Receiver {
    bit_cycles: Cycles,
    state: State,
    start: Instant,
}

impl Receiver {
    /// An armed receiver with this bit time, at least 2 cycles: half of it is the time up to the sample of a start bit.
    pub const fn new(bit_cycles: Cycles) -> Self {
        Self { bit_cycles, state: State::Armed, start: Instant::RESET }
    }

    /// Cycle in which the latest start bit was detected.
    pub const fn start(&self) -> Instant {
        self.start
    }

    /// Next cycle after `now` in which the receiver acts if the line stays at `rx`.
    pub const fn deadline(&self, now: Instant, rx: bool) -> Instant {
        match self.state {
            State::Sampling { at, .. } => at,
            State::Armed if !rx => now.next(),
            State::AwaitingHigh if rx => now.next(),
            State::Armed | State::AwaitingHigh => Instant::NEVER,
        }
    }

    /// Runs cycle `now` with the line at `rx`. Must be called in every cycle that [`Self::deadline`] returns; others may be
    /// skipped.
    pub fn clock(&mut self, now: Instant, rx: bool) -> Option<RxEvent> {
        match self.state {
            State::Armed if !rx => {
                self.start = now;
                self.state = State::Sampling { bit: 0, at: now + Cycles(self.bit_cycles.0 / 2), byte: 0 };
            }
            State::AwaitingHigh if rx => self.state = State::Armed,
            State::Sampling { bit, at, byte } if at == now => match (bit, rx) {
                (0, true) => self.state = State::Armed,
                (STOP, true) => {
                    self.state = State::Armed;
                    return Some(RxEvent::Byte(byte));
                }
                (STOP, false) => {
                    self.state = State::AwaitingHigh;
                    return Some(RxEvent::FramingError);
                }
                _ => {
                    let byte = byte >> 1 | u8::from(rx) << 7;
                    self.state = State::Sampling { bit: bit + 1, at: at + self.bit_cycles, byte };
                }
            },
            State::Armed | State::AwaitingHigh | State::Sampling { .. } => {}
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// B = 11: samples at t+5 (start), t+16+11*i (data), t+104 (stop).
    fn received(low: &[(u64, u64)], cycles: u64) -> Vec<(u64, RxEvent)> {
        let mut receiver = Receiver::new(Cycles(11));
        let level = |c| !low.iter().any(|&(from, to)| (from..to).contains(&c));
        (1..cycles).filter_map(|c| receiver.clock(Instant(c), level(c)).map(|event| (c, event))).collect()
    }

    #[test]
    fn a_byte_is_delivered_when_its_stop_bit_is_sampled() {
        assert_eq!(received(&[(10, 21)], 300), [(114, RxEvent::Byte(0xff))]);
        assert_eq!(received(&[(10, 109)], 300), [(114, RxEvent::Byte(0x00))]);
        assert_eq!(received(&[(10, 32)], 300), [(114, RxEvent::Byte(0xfe))]);
    }

    #[test]
    fn a_low_shorter_than_half_a_bit_is_a_glitch() {
        // Low in 10..15 only: at 15 the line is high, armed in 16.
        assert_eq!(received(&[(10, 15), (16, 27)], 300), [(120, RxEvent::Byte(0xff))]);
        // Low again when the start bit is sampled: the level in between has no effect.
        assert_eq!(received(&[(10, 14), (15, 16)], 300), [(114, RxEvent::Byte(0xff))]);
    }

    #[test]
    fn deadlines_are_samples_and_arming() {
        let mut receiver = Receiver::new(Cycles(11));
        assert_eq!([false, true].map(|rx| receiver.deadline(Instant(9), rx).0), [10, u64::MAX]);
        assert_eq!(receiver.clock(Instant(10), false), None);
        for (at, rx) in (0..9).map(|bit| (15 + 11 * bit, bit % 2 != 0)) {
            assert_eq!([false, true].map(|rx| receiver.deadline(Instant(at - 1), rx).0), [at; 2]);
            assert_eq!(receiver.clock(Instant(at), rx), None);
        }
        assert_eq!(receiver.clock(Instant(114), true), Some(RxEvent::Byte(0x55)));
        // After a framing error the receiver waits for a high level.
        assert_eq!(receiver.clock(Instant(300), false), None);
        assert!((0..9).all(|bit| receiver.clock(Instant(305 + 11 * bit), false).is_none()));
        assert_eq!(receiver.clock(Instant(404), false), Some(RxEvent::FramingError));
        assert_eq!([false, true].map(|rx| receiver.deadline(Instant(404), rx).0), [u64::MAX, 405]);
    }

    #[test]
    fn after_a_framing_error_the_receiver_arms_one_cycle_after_the_line_is_high() {
        // Held low to 200: error at 114. High in 200 only arms 201; the low of 201 is a start bit.
        assert_eq!(
            received(&[(10, 200), (201, 212)], 500),
            [(114, RxEvent::FramingError), (305, RxEvent::Byte(0xff))]
        );
        // Without a high cycle between them the receiver stays unarmed.
        assert_eq!(received(&[(10, 200), (200, 212)], 500), [(114, RxEvent::FramingError)]);
    }
}
