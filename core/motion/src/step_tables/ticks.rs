//! Ticks of a motion (DESIGN B7).
//!
//! ```text
//! due[j]   = R(s(j*T)), R(x) = floor(x + 1/2)
//! steps[j] = due[j + 1] - due[j]
//! ```
//!
//! The steps up to the end of tick j are the rounded position there, so errors do not accumulate, are at most half a step,
//! and the end is exact. The end of a tick is an integer cycle, for which the number of steps due is exact (`due_by`).

use super::AxesPath;
use crate::problem::{Cause, Problem, ValueError};
use crate::{AxisPlan, Problems};
use alloc::{vec, vec::Vec};

const MAX_TICKS: u64 = 2_000_000;
/// Maximum ticks of all channels together, each a byte.
const MAX_BYTES: u64 = 4_000_000;
const RIGHT: u8 = 1 << 7;
const MAX_STEPS: u8 = !RIGHT;

/// Ticks for the peripheral: one byte per channel and tick, bit 7 = right, bits 6..=0 = steps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ticks {
    channels: u8,
    /// Invariant: a whole number of ticks, at least one.
    bytes: Vec<u8>,
}

impl Ticks {
    /// Number of channels, which is also the bytes per tick.
    pub fn channels(&self) -> u8 {
        self.channels
    }

    #[allow(clippy::len_without_is_empty, reason = "there is always a tick")]
    pub fn len(&self) -> usize {
        self.bytes.len() / usize::from(self.channels.max(1))
    }

    /// The bytes of all ticks in the order of their times.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u8]> {
        self.bytes.chunks_exact(usize::from(self.channels.max(1)))
    }
}

/// Divides the plans, one per channel, into ticks of `tick_cycles` with up to `slots` steps: enough to end every axis, at
/// least one. A byte without steps repeats the previous direction, initially left.
/// Errors: too many plans or ticks; or the first tick of each axis that needs more steps than it has slots.
pub fn ticks(
    plans: &[AxisPlan],
    at: AxesPath<'_>,
    channels: u8,
    slots: u8,
    tick_cycles: u64,
    clock_hz: u32,
) -> Result<Ticks, Problems> {
    let (channels, tick_cycles) = (channels.max(1), tick_cycles.max(1));
    if plans.len() > channels.into() {
        let cause = ValueError::Length { given: plans.len(), min: 1, max: channels.into(), of: "axes" };
        return Err(Problem::new(at.axes, cause).into());
    }
    let needed = plans.iter().map(|plan| plan.spans(tick_cycles, clock_hz)).max().unwrap_or(1);
    let all = needed.saturating_mul(channels.into());
    for (given, max, of) in [(needed, MAX_TICKS, "ticks"), (all, MAX_BYTES, "ticks of all channels")] {
        if given > max {
            return Err(Problem::new(at.whole, ValueError::too_much(given, max, of)).into());
        }
    }
    let width = usize::from(channels);
    let mut bytes = vec![0; all as usize];
    let mut problems = Vec::new();
    for (channel, plan) in plans.iter().enumerate() {
        let column = bytes.iter_mut().skip(channel).step_by(width);
        if let Err(cause) = fill(plan, column, TickClock::new(tick_cycles, clock_hz), slots.min(MAX_STEPS)) {
            problems.push(Problem::new(at.axis(channel), cause));
        }
    }
    debug_assert!(!bytes.is_empty() && bytes.len().is_multiple_of(width), "{} bytes of ticks", bytes.len());
    Problems::check(problems).map(|()| Ticks { channels, bytes })
}

fn fill<'b>(
    plan: &AxisPlan,
    column: impl Iterator<Item = &'b mut u8>,
    clock: TickClock,
    slots: u8,
) -> Result<(), Cause> {
    let mut due_by = plan.due_by(clock.clock_hz);
    let (mut due, mut direction) = (0, 0);
    for (tick, byte) in (0..).zip(column) {
        let next = due_by.steps(clock.end(tick));
        let steps = next.abs_diff(due);
        let count = match u8::try_from(steps) {
            Ok(count) if count <= slots => count,
            _ => {
                let tick_s = clock.end_s(0);
                let (rate, limit) = (steps as f64 / tick_s, f64::from(slots) / tick_s);
                return Err(Cause::TooManySteps { tick, steps, slots, rate, limit });
            }
        };
        if next != due {
            direction = if next > due { RIGHT } else { 0 };
        }
        *byte = direction | count;
        due = next;
    }
    Ok(())
}

/// Times of the ticks, from integers: tick j is [j*T, (j + 1)*T) in s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TickClock {
    tick_cycles: u64,
    clock_hz: u32,
}

impl TickClock {
    /// Ticks of `tick_cycles` at `clock_hz`; 0 of either counts as 1.
    pub fn new(tick_cycles: u64, clock_hz: u32) -> Self {
        Self { tick_cycles: tick_cycles.max(1), clock_hz: clock_hz.max(1) }
    }

    pub fn tick_cycles(&self) -> u64 {
        self.tick_cycles
    }

    /// A cycle from the motion's start in s.
    pub fn seconds(&self, cycle: u64) -> f64 {
        cycle as f64 / f64::from(self.clock_hz)
    }

    fn end(&self, tick: u64) -> u64 {
        tick.saturating_add(1).saturating_mul(self.tick_cycles)
    }

    /// End of tick `tick` (from 0) in s.
    pub fn end_s(&self, tick: u64) -> f64 {
        self.seconds(self.end(tick))
    }

    /// Steps due by the end of tick `tick` (from 0).
    pub fn due_by_end(&self, plan: &AxisPlan, tick: u64) -> i64 {
        plan.due_by(self.clock_hz).steps(self.end(tick))
    }

    /// Minimum number of ticks, at least one, whose end is not before `duration_s`.
    pub fn ticks_until(&self, duration_s: f64) -> u64 {
        let tick_s = self.end_s(0);
        let mut ticks = libm::ceil(duration_s / tick_s) as u64;
        // The division may be wrong by a rounding.
        if ticks > 0 && self.end_s(ticks - 1) < duration_s {
            ticks += 1;
        } else if ticks > 1 && self.end_s(ticks - 2) >= duration_s {
            ticks -= 1;
        }
        ticks.max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        mechanics::{Distance, Speed},
        moves::{Axis, Constant, Dwell, Move, SineSegments},
        plan_axis,
    };

    fn constant(steps: f64, steps_s: f64) -> Move {
        let (distance, speed) = (Distance::Steps(steps), Speed::StepsPerSecond(steps_s));
        Move::Constant(Constant { distance, speed })
    }

    fn plan(moves: Vec<Move>) -> AxisPlan {
        plan_axis(&Axis { moves, ..Axis::default() }, "axis").unwrap()
    }

    #[test]
    fn a_tick_clock_has_the_ends_of_ticks() {
        let clock = TickClock::new(32_000, 16_000_000);
        assert_eq!((clock.tick_cycles(), clock.end_s(0), clock.end_s(4)), (32_000, 0.002, 0.01));
        assert_eq!([0.0, 0.001, 0.002, 0.0021].map(|end_s| clock.ticks_until(end_s)), [1, 1, 1, 2]);
    }

    #[test]
    fn each_byte_has_direction_and_steps_of_its_tick() {
        // moves at 1 kHz in ticks of 1 ms of 1 MHz, bytes of one channel
        let dwell = |duration_s| Move::Dwell(Dwell { duration_s });
        let rows: [(Vec<Move>, &[u8]); 7] = [
            (vec![dwell(0.0)], &[0x00]),
            (vec![dwell(0.002)], &[0x00, 0x00]),
            (vec![constant(4.0, 2000.0)], &[0x82, 0x82]),
            (vec![constant(-4.0, 2000.0)], &[0x02, 0x02]),
            // Without steps the direction stays.
            (vec![constant(2.0, 2000.0), dwell(0.002), constant(-2.0, 2000.0)], &[0x82, 0x80, 0x80, 0x02]),
            // A step every 2 ms, due at 1 ms and 3 ms: to the right it is in the tick that ends there.
            (vec![constant(2.0, 500.0)], &[0x81, 0x80, 0x81, 0x80]),
            // To the left it is in the next tick, because R(-1/2) is 0.
            (vec![constant(-2.0, 500.0)], &[0x00, 0x01, 0x00, 0x01]),
        ];
        for (moves, expected) in rows {
            let found = ticks(&[plan(moves.clone())], AxesPath::MOTION, 1, 100, 1000, 1_000_000).unwrap();
            assert_eq!(found.bytes(), expected, "{moves:?}");
            assert_eq!(found.len(), expected.len());
        }
    }

    #[test]
    fn all_channels_have_ticks_until_the_last_axis_ends() {
        let plans = [plan(vec![constant(4.0, 2000.0)]), plan(vec![constant(-9.0, 3000.0)])];
        let found = ticks(&plans, AxesPath::MOTION, 3, 100, 1000, 1_000_000).unwrap();
        let expected: [&[u8]; 3] = [&[0x82, 0x03, 0], &[0x82, 0x03, 0], &[0x80, 0x03, 0]];
        assert!(found.iter().eq(expected), "{found:?}");
    }

    #[test]
    fn refuses_too_many_steps_or_ticks_with_their_numbers() {
        let one = [plan(vec![constant(100.0, 10_000.0)]), plan(vec![constant(100.0, 12_000.0)])];
        assert!(ticks(&one, AxesPath::MOTION, 2, 12, 1000, 1_000_000).is_ok());
        let found = ticks(&one, AxesPath::MOTION, 2, 9, 1000, 1_000_000).unwrap_err();
        let cause = |steps, rate| Cause::TooManySteps { tick: 0, steps, slots: 9, rate, limit: 9000.0 };
        let expected = [
            Problem::new("source.motion.axes[0]", cause(10, 10_000.0)),
            Problem::new("source.motion.axes[1]", cause(12, 12_000.0)),
        ];
        assert_eq!(found[..], expected);
        let found = ticks(&one, AxesPath::MOTION, 2, 12, 1, 1_000_000_000).unwrap_err();
        let cause = ValueError::TooMuch { given: 10_000_000.0, max: 2_000_000.0, of: "ticks" };
        assert_eq!(found[..], [Problem::new("source.motion", cause)]);
        // 625 000 ticks, too many for seven channels.
        let long = [plan(vec![Move::Dwell(Dwell { duration_s: 625.0 })])];
        assert_eq!(
            ticks(&long, AxesPath::MOTION, 6, 12, 1000, 1_000_000).map(|ticks| ticks.len()),
            Ok(625_000)
        );
        let found = ticks(&long, AxesPath::MOTION, 7, 12, 1000, 1_000_000).unwrap_err();
        let cause = ValueError::TooMuch { given: 4_375_000.0, max: 4_000_000.0, of: "ticks of all channels" };
        assert_eq!(found[..], [Problem::new("source.motion", cause)]);
        assert!(ticks(&one, AxesPath::MOTION, 1, 12, 1000, 1_000_000).is_err());
        // No scenario has these values, but they must not panic.
        assert_eq!(ticks(&one, AxesPath::MOTION, 2, 255, 0, 0).map(|ticks| ticks.len()), Ok(1));
        assert_eq!(ticks(&[], AxesPath::MOTION, 0, 0, 0, 0).map(|ticks| ticks.len()), Ok(1));
    }

    #[test]
    fn errors_do_not_accumulate() {
        let plan = plan(vec![Move::SineSegments(SineSegments::default()), constant(777.0, 1234.5)]);
        let found = ticks(core::slice::from_ref(&plan), AxesPath::MOTION, 1, 127, 5000, 1_000_000).unwrap();
        let mut made = 0;
        for (tick, bytes) in (1_i32..).zip(found.iter()) {
            let steps = i64::from(bytes[0] & !RIGHT);
            made += if bytes[0] & RIGHT == 0 { -steps } else { steps };
            let error = plan.position(f64::from(tick) * 0.005) - made as f64;
            assert!(error.abs() <= 0.5, "{error} after tick {tick}");
        }
        assert_eq!(made, 777);
    }
}
