//! The receiver of the serial line (DESIGN A4): 8N1, one look a bit.
//!
//! ```text
//! seen low at t; looks again at t + floor(B/2): high = a glitch, arms again in the next cycle
//! data bit i at t + floor(B/2) + (i+1)*B, stop bit at t + floor(B/2) + 9*B
//! stop high: the byte is delivered in that cycle, armed from the next
//! stop low: framing error; arms in the cycle after the first later one that is high
//! ```
//!
//! Looks at data bits, and at a start bit while the line is low, change nothing outside. They are made up for when the
//! line changes or the stop bit is due, so that a byte costs as many events as it has edges, and one.
//!
//! ```
//! use stepscope_peripheral::{
//!     units::{Cycles, Instant},
//!     wire::uart::{RxEvent, Receiver},
//! };
//!
//! // Bits of 16 cycles; the line is low from cycle 100 to 179: a start bit and four zeros.
//! let mut receiver = Receiver::new(Cycles(16));
//! let level = |cycle: u64| !(100..180).contains(&cycle);
//! let heard = (1..300).find_map(|cycle| {
//!     receiver.clock(Instant(cycle), level(cycle - 1), level(cycle)).map(|heard| (cycle, heard))
//! });
//! assert_eq!(heard, Some((252, RxEvent::Byte(0xf0)))); // 100 + 8 + 9 * 16
//! ```

use crate::{
    units::{Cycles, Instant},
    wire::{ByteAhead, sender::BitStarts},
};

/// The stop bit's place in a byte.
const STOP: u32 = 9;

/// What the receiver heard in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RxEvent {
    /// A byte.
    Byte(u8),
    /// A byte whose stop bit was low; it is dropped.
    FramingError,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Waits for the line to be low.
    Armed,
    /// Within a byte.
    Sampling,
    /// After a framing error: waits for the line to be high.
    Broken,
}

/// The receiver.
#[derive(Clone, Debug)]
pub struct Receiver {
    bit_cycles: Cycles,
    state: State,
    /// Where the latest start bit was seen.
    seen: Instant,
    /// While sampling: the bit that is looked at next (0 start, 1..=8 data, 9 stop), when, and the bits so far, the
    /// start bit lowest.
    ///
    /// Invariant: a look at the stop bit, or at a start bit that is high, is never made up for later.
    bit: u32,
    at: Instant,
    heard: u32,
    /// While sampling: when the stop bit is looked at.
    stop: Instant,
}

impl Receiver {
    /// A receiver of bit time `bit_cycles`, armed.
    #[must_use]
    pub const fn new(bit_cycles: Cycles) -> Self {
        let seen = Instant::RESET;
        Self {
            bit_cycles,
            state: State::Armed,
            seen,
            bit: 0,
            at: Instant::NEVER,
            heard: 0,
            stop: Instant::NEVER,
        }
    }

    /// Where the latest start bit was seen.
    #[must_use]
    pub const fn seen(&self) -> Instant {
        self.seen
    }

    /// Next cycle after `now` in which something comes of what the receiver does if the line stays
    /// at `rx`: the look at a start bit that is none, the look at the stop bit, or arming.
    #[must_use]
    #[inline(always)]
    pub fn deadline(&self, now: Instant, rx: bool) -> Instant {
        match self.state {
            State::Sampling if self.bit == 0 && rx && now < self.at => self.at,
            State::Sampling => self.stop,
            State::Armed if !rx => now.next(),
            State::Broken if rx => now.next(),
            _ => Instant::NEVER,
        }
    }

    /// Cycle `now` with the line at `rx`, which was at `before` in the cycles since the last call.
    /// No cycle of [`Self::deadline`] may have been left out between.
    #[inline(always)]
    pub fn clock(&mut self, now: Instant, before: bool, rx: bool) -> Option<RxEvent> {
        match self.state {
            State::Armed if !rx => self.begin(now),
            State::Broken if rx => self.state = State::Armed,
            State::Sampling => {
                self.make_up(now, before);
                if self.at == now {
                    return self.look(rx);
                }
            }
            _ => {}
        }
        None
    }

    /// Whether each look falls into its own bit of a byte whose bits begin and end so, the one at the stop bit not into its first
    /// cycle: such a byte is heard as it is sent.
    #[must_use]
    pub fn is_in_step(&self, bit_starts: &BitStarts) -> bool {
        let looks = (0..=u64::from(STOP)).map(|bit| self.bit_cycles.0 / 2 + bit * self.bit_cycles.0);
        let bits = bit_starts.iter().zip(&bit_starts[1..]);
        bits.zip(looks).all(|((from, to), look)| (*from..*to).contains(&look))
            && bit_starts[STOP as usize] < self.stop_after().0
    }

    /// From a start bit to the look at the stop bit.
    const fn stop_after(&self) -> Cycles {
        Cycles(self.bit_cycles.0 / 2 + STOP as u64 * self.bit_cycles.0)
    }

    /// Whether it waits for a start bit.
    pub(crate) fn is_armed(&self) -> bool {
        self.state == State::Armed
    }

    /// When the stop bit of a byte that begins at `start` is looked at.
    #[inline(always)]
    pub(crate) fn stop_of(&self, start: Instant) -> Instant {
        start + self.stop_after()
    }

    /// All looks at a byte that is heard as it is sent, but the one at its stop bit, which is next.
    #[inline(always)]
    pub(crate) fn hear_data(&mut self, byte: &ByteAhead<'_>) {
        self.begin(byte.start);
        (self.bit, self.at, self.heard) = (STOP, self.stop, u32::from(byte.byte) << 1);
    }

    /// All looks at a byte that is heard as it is sent.
    #[inline(always)]
    pub(crate) fn hear_byte(&mut self, byte: &ByteAhead<'_>) {
        debug_assert!(self.is_armed(), "{byte:?} begins where no byte may");
        self.seen = byte.start;
    }

    /// A start bit is seen.
    #[inline(always)]
    fn begin(&mut self, now: Instant) {
        self.seen = now;
        self.state = State::Sampling;
        self.at = now + Cycles(self.bit_cycles.0 / 2);
        self.stop = self.at + Cycles(u64::from(STOP) * self.bit_cycles.0);
        (self.bit, self.heard) = (0, 0);
    }

    /// The looks before `now`, while the line was at `rx`.
    #[inline(always)]
    fn make_up(&mut self, now: Instant, rx: bool) {
        let (mut bit, mut at) = (self.bit, self.at);
        while at < now {
            debug_assert!(bit > 0 || !rx, "a start bit that is none was left out");
            debug_assert!(bit < STOP, "the look at the stop bit was left out");
            bit += 1;
            at += self.bit_cycles;
        }
        if rx {
            self.heard |= (1 << bit) - (1 << self.bit);
        }
        (self.bit, self.at) = (bit, at);
    }

    /// The look that is due in this cycle. In its caller, as its answer would go by way of the memory in wasm.
    #[inline(always)]
    fn look(&mut self, rx: bool) -> Option<RxEvent> {
        match (self.bit, rx) {
            (0, true) => self.state = State::Armed,
            (STOP, true) => {
                self.state = State::Armed;
                return Some(RxEvent::Byte((self.heard >> 1) as u8));
            }
            (STOP, false) => {
                self.state = State::Broken;
                return Some(RxEvent::FramingError);
            }
            _ => self.make_up(self.at.next(), rx),
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::{BitTimes, Schedule, Sender};
    use alloc::{rc::Rc, vec::Vec};

    /// B = 11: looks at t+5 (start), t+16+11*i (data), t+104 (stop).
    fn heard(low: &[(u64, u64)], cycles: u64) -> Vec<(u64, RxEvent)> {
        let mut receiver = Receiver::new(Cycles(11));
        let level = |c| !low.iter().any(|&(from, to)| (from..to).contains(&c));
        (1..cycles)
            .filter_map(|c| {
                let (before, rx) = (level(c - 1), level(c));
                receiver.clock(Instant(c), before, rx).map(|h| (c, h))
            })
            .collect()
    }

    #[test]
    fn a_byte_is_delivered_in_the_cycle_that_looks_at_its_stop_bit() {
        assert_eq!(heard(&[(10, 21)], 300), [(114, RxEvent::Byte(0xff))]);
        assert_eq!(heard(&[(10, 109)], 300), [(114, RxEvent::Byte(0x00))]);
        assert_eq!(heard(&[(10, 32)], 300), [(114, RxEvent::Byte(0xfe))]);
    }

    #[test]
    fn a_low_shorter_than_half_a_bit_is_a_glitch_and_the_next_cycle_arms() {
        // Low in 10..15 only: at 15 the line is high, armed in 16.
        assert_eq!(heard(&[(10, 15), (16, 27)], 300), [(120, RxEvent::Byte(0xff))]);
        // Low again in the cycle of the look: the start bit holds, whatever was between.
        assert_eq!(heard(&[(10, 14), (15, 16)], 300), [(114, RxEvent::Byte(0xff))]);
    }

    #[test]
    fn a_byte_is_due_at_its_edges_and_its_stop_bit_and_a_glitch_at_its_look() {
        let mut receiver = Receiver::new(Cycles(11));
        assert_eq!([false, true].map(|rx| receiver.deadline(Instant(9), rx).0), [10, u64::MAX]);
        assert_eq!(receiver.clock(Instant(10), true, false), None);
        // Low, it will be a start bit; were it high from now on, the look at 15 would tell.
        assert_eq!([false, true].map(|rx| receiver.deadline(Instant(10), rx).0), [114, 15]);
        // The look has not been made up for: the line was low in it, whatever it is now.
        assert_eq!([false, true].map(|rx| receiver.deadline(Instant(20), rx).0), [114, 114]);
        assert_eq!(receiver.clock(Instant(21), false, true), None);
        assert_eq!(receiver.deadline(Instant(21), true), Instant(114));
        assert_eq!(receiver.clock(Instant(114), true, true), Some(RxEvent::Byte(0xff)));
        // A glitch ends with its look and not with the stop bit that it would have had.
        assert_eq!(receiver.clock(Instant(200), true, false), None);
        assert_eq!(receiver.clock(Instant(203), false, true), None);
        assert_eq!(receiver.deadline(Instant(203), true), Instant(205));
        assert_eq!(receiver.clock(Instant(205), true, true), None);
        assert_eq!([false, true].map(|rx| receiver.deadline(Instant(205), rx).0), [206, u64::MAX]);
        // A line that stays low arms again once it is high.
        assert_eq!(receiver.clock(Instant(300), true, false), None);
        assert_eq!(receiver.clock(Instant(404), false, false), Some(RxEvent::FramingError));
        assert_eq!([false, true].map(|rx| receiver.deadline(Instant(404), rx).0), [u64::MAX, 405]);
    }

    /// Senders of many rates: where bytes are in step all of them are heard as they are sent, each before the next begins.
    #[test]
    fn bytes_in_step_are_heard_as_they_are_sent() {
        let (bytes, mut told) = ([0x00, 0xff, 0x55, 0xa7, 0x80], [0, 0]);
        for (bit, percent) in (1..=24).flat_map(|bit| (80..=120).map(move |percent| (bit, percent))) {
            let (clock_hz, baud) = (1_000_000, 100_000_000 / (bit * percent));
            let mut schedule = Schedule::default();
            schedule.push(Instant(5), &bytes);
            let mut sender = Sender::new(Rc::new(schedule), clock_hz, baud);
            let mut receiver = Receiver::new(Cycles(bit.into()));
            let is_in_step = receiver.is_in_step(sender.bit_starts());
            let (mut found, mut before) = (Vec::new(), true);
            for cycle in 1..2000 {
                if sender.next_edge() == Instant(cycle) {
                    sender.pass();
                }
                found.extend(
                    receiver.clock(Instant(cycle), before, sender.level()).map(|heard| (cycle, heard)),
                );
                before = sender.level();
            }
            let times = BitTimes::new(clock_hz, baud);
            let sent = (0..).zip(bytes).map(|(index, byte)| {
                let start = Instant(5) + times.byte(index);
                (receiver.stop_of(start).0, RxEvent::Byte(byte))
            });
            assert!(!is_in_step || sent.eq(found), "bits of {bit}, sent at {baud} of {clock_hz}");
            told[usize::from(is_in_step)] += 1;
        }
        assert!(told.iter().all(|count| *count > 200), "{told:?} out of step and in step");
    }

    #[test]
    fn after_a_framing_error_the_receiver_arms_one_cycle_after_the_line_is_high() {
        // Held low to 200: error at 114. High in 200 only arms 201; the low of 201 is a start bit.
        assert_eq!(
            heard(&[(10, 200), (201, 212)], 500),
            [(114, RxEvent::FramingError), (305, RxEvent::Byte(0xff))]
        );
        // Two lows that meet leave no high cycle.
        assert_eq!(heard(&[(10, 200), (200, 212)], 500), [(114, RxEvent::FramingError)]);
    }
}
