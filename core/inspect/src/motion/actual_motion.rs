//! The motion that the pulses of one channel make: its position from edge to edge, its speed from tick to tick or, where
//! segments run the channel, from interval to interval; of recorded pulses from step to step.
//!
//! ```text
//!            _______                     ______
//! speed     | tick  |_______      _____|  1/i  |          of a tick its steps by its length,
//!        ___|       | tick  |___ | dwell|      |___       of a step of a segment 1 by its interval;
//! STEP      ' |  | |'   |   '    '     '|   |  |'         where neither is, nothing moves
//! ```
//!
//! Before the first step, and the first after a dwell, no more than a part of an interval may have passed: step 1 of a
//! constant rate is due after half of one (DESIGN B1). Taken for a whole one it would make twice the speed, so it counts
//! for no faster than the interval after it.
//!
//! ```
//! use stepscope_inspect::motion::actual_motion::Pulses;
//!
//! // Of a run of the default motion: 3200 steps in 0.4 s.
//! # use stepscope_peripheral::trace::{Recording, steps};
//! # use stepscope_sim::Experiment;
//! # let experiment = Experiment::from_json("{}").expect("the default motion");
//! # let mut recording = Recording::default();
//! # let run = experiment.run(&mut recording);
//! # let made = steps(&recording.trace, 0);
//! let pulses = Pulses::of_run(0, &made, &recording.packets, None, experiment.config());
//! let start_s = pulses.zero() as f64 / pulses.hz();
//! assert!((pulses.speed_at(start_s + 0.2) - 16_000.0).abs() < 500.0); // half-way, as fast as it gets
//! assert_eq!(pulses.position_at(start_s + 0.5), 3200);
//! ```

use crate::motion::step_acceleration;
use stepscope_peripheral::{
    config::Config,
    segment::{FRACTION_BITS, Segment, SegmentList},
    trace::{LoggedTick, PacketLog, Step},
    units::Cycles,
    wire::packet::ChannelCommand,
};

/// What orders the steps of a channel, and with them its speed.
#[derive(Clone, Copy, Debug)]
enum Order<'a> {
    /// The ticks of a controller, of so many cycles.
    Ticks(&'a PacketLog, Cycles),
    /// A list of segments.
    Segments(&'a SegmentList),
    /// Nothing that is known: the steps were recorded.
    Recorded,
}

/// What one channel made: in a run, or as it was recorded.
#[derive(Clone, Copy, Debug)]
pub struct Pulses<'a> {
    /// The channel, 0 to 15.
    pub channel: u8,
    /// All of its steps.
    pub steps: &'a [Step],
    order: Order<'a>,
    clock_hz: u32,
}

/// A stretch of time at one speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// Its start in s.
    pub from_s: f64,
    /// Its end in s.
    pub to_s: f64,
    /// Steps/s, left negative.
    pub speed: f64,
}

impl<'a> Pulses<'a> {
    /// Of a run: the steps of a channel, the log of its controller, the list that the channel runs by itself where segments
    /// run it, and the controller's configuration.
    #[must_use]
    pub const fn of_run(
        channel: u8,
        steps: &'a [Step],
        log: &'a PacketLog,
        segments: Option<&'a SegmentList>,
        config: &Config,
    ) -> Self {
        let order = match segments {
            Some(list) => Order::Segments(list),
            None => Order::Ticks(log, config.tick()),
        };
        Self { channel, steps, order, clock_hz: config.clock_hz() }
    }

    /// Steps that were recorded, in cycles of `clock_hz`. The speed is that from each step to the next.
    #[must_use]
    pub const fn recorded(channel: u8, steps: &'a [Step], clock_hz: u32) -> Self {
        Self { channel, steps, order: Order::Recorded, clock_hz }
    }

    /// Cycles a second.
    #[must_use]
    pub const fn clock_hz(&self) -> u32 {
        self.clock_hz
    }

    /// Cycles a second, to compute with.
    #[must_use]
    pub fn hz(&self) -> f64 {
        f64::from(self.clock_hz)
    }

    /// How long a tick is; `None` where none orders the steps, but each is known by itself.
    #[cfg(feature = "std")]
    pub(crate) const fn tick(&self) -> Option<Cycles> {
        match self.order {
            Order::Ticks(_, length) => Some(length),
            Order::Segments(_) | Order::Recorded => None,
        }
    }

    /// Cycle in which the motion's time 0 is: the start of the list of segments, or of the first tick; 0
    /// where none began, and of what was recorded.
    #[must_use]
    pub fn zero(&self) -> u64 {
        match self.order {
            Order::Ticks(log, _) => log.ticks().first().map_or(0, |tick| tick.start.0),
            Order::Segments(list) => list.start.0,
            Order::Recorded => 0,
        }
    }

    /// Position after all steps up to a time, that time included.
    #[must_use]
    pub fn position_at(&self, time_s: f64) -> i32 {
        let after = self.steps_until(time_s);
        after.checked_sub(1).and_then(|last| self.steps.get(last)).map_or(0, |step| step.position)
    }

    /// How many steps have risen by a time.
    pub(crate) fn steps_until(&self, time_s: f64) -> usize {
        let hz = self.hz();
        self.steps.partition_point(|step| step.cycle as f64 / hz <= time_s)
    }

    /// Speed at a time in steps/s.
    #[must_use]
    pub fn speed_at(&self, time_s: f64) -> f64 {
        let mut speed = 0.0;
        // A stretch that begins now counts, one that ends now does not.
        self.rates(time_s, time_s, &mut |rate| {
            if rate.from_s <= time_s && time_s < rate.to_s {
                speed = rate.speed;
            }
        });
        speed
    }

    /// The acceleration of steps that no plan is known of ([`step_acceleration`]), from each step to the next, where that touches
    /// `from_s..=to_s`: both their times in s, and it; nothing where it is not known.
    pub fn accelerations(&self, from_s: f64, to_s: f64, each: &mut dyn FnMut(f64, f64, f64)) {
        let hz = self.hz();
        let seconds = |index: usize| self.steps.get(index).map(|step| step.cycle as f64 / hz);
        let first = self.steps.partition_point(|step| (step.cycle as f64 / hz) < from_s);
        for index in first.saturating_sub(1)..self.steps.len() {
            let (Some(step_s), Some(next_s)) = (seconds(index), seconds(index + 1)) else { return };
            if step_s > to_s {
                return;
            }
            if let Some(value) = step_acceleration::of(self.steps, index, hz) {
                each(step_s, next_s, value);
            }
        }
    }

    /// The same at a time; `None` where it is not known.
    #[must_use]
    pub fn acceleration_at(&self, time_s: f64) -> Option<f64> {
        step_acceleration::of(self.steps, self.steps_until(time_s).checked_sub(1)?, self.hz())
    }

    /// Every stretch of one speed that touches `from_s..=to_s`, in order; between them nothing moves.
    pub fn rates(&self, from_s: f64, to_s: f64, each: &mut dyn FnMut(Rate)) {
        match self.order {
            Order::Ticks(log, length) => self.orders((log, length), from_s, to_s, each),
            Order::Segments(list) => self.intervals(list, from_s, to_s, each),
            Order::Recorded => self.step_to_step(from_s, to_s, each),
        }
    }

    /// Of the steps themselves.
    fn step_to_step(&self, from_s: f64, to_s: f64, each: &mut dyn FnMut(Rate)) {
        let hz = self.hz();
        let first = self.steps.partition_point(|step| (step.cycle as f64 / hz) < from_s).max(1);
        for index in first..self.steps.len() {
            let (Some(before), Some(step)) = (self.steps.get(index - 1), self.steps.get(index)) else {
                return;
            };
            let rate = Rate {
                from_s: before.cycle as f64 / hz,
                to_s: step.cycle as f64 / hz,
                speed: hz / (step.cycle - before.cycle) as f64
                    * f64::from(Step::direction(self.steps, index)),
            };
            if rate.from_s > to_s {
                return;
            }
            each(rate);
        }
    }

    /// Of the ticks.
    fn orders(
        &self,
        (log, length): (&PacketLog, Cycles),
        from_s: f64,
        to_s: f64,
        each: &mut dyn FnMut(Rate),
    ) {
        let hz = self.hz();
        let start = |tick: &LoggedTick| tick.start.0 as f64 / hz;
        // STOP ends a tick before its time.
        let end = |tick: &LoggedTick| log.tick_end(tick, length).0 as f64 / hz;
        let ticks = log.ticks();
        let first = ticks.partition_point(|tick| end(tick) < from_s);
        for tick in ticks.iter().skip(first).take_while(|tick| start(tick) <= to_s) {
            let order =
                ChannelCommand::parse(tick.commands.get(usize::from(self.channel)).copied().unwrap_or(0));
            let speed = f64::from(order.steps) * hz / length.0 as f64;
            let speed = if order.right { speed } else { 0.0 - speed };
            each(Rate { from_s: start(tick), to_s: end(tick), speed });
        }
    }

    /// Of the intervals of a list of segments, each from one step to the next.
    fn intervals(&self, list: &SegmentList, from_s: f64, to_s: f64, each: &mut dyn FnMut(Rate)) {
        let (hz, one) = (self.hz(), (1_u64 << FRACTION_BITS) as f64);
        let seconds = |next: i128| next as f64 / one / hz;
        let mut next = i128::from(list.start.0) << FRACTION_BITS;
        // Whether what comes next follows a step at once.
        let mut follows = false;
        for (place, segment) in list.segments.iter().enumerate() {
            if seconds(next) > to_s {
                break;
            }
            match *segment {
                Segment::Dwell(dwell) => {
                    next += i128::from(dwell);
                    follows &= dwell == 0;
                }
                Segment::Steps { count, interval, add, right } => {
                    // A8's next after k steps of this segment.
                    let start = next;
                    let after = |k: u32| {
                        let (k, add) = (i128::from(k), i128::from(add));
                        start + k * i128::from(interval) + add * (k * (k - 1) / 2)
                    };
                    next = after(count);
                    let first = first_not(count, |k| seconds(after(k + 1)) < from_s);
                    for k in first..count {
                        let (begin, end) = (after(k), after(k + 1));
                        if seconds(begin) > to_s {
                            break;
                        }
                        let mut whole = end - begin;
                        if k == 0 && !follows {
                            let second =
                                if count > 1 { Some(after(2) - end) } else { interval_after(list, place) };
                            whole = whole.max(second.unwrap_or(whole));
                        }
                        let speed = hz * one / whole as f64;
                        let speed = if right { speed } else { -speed };
                        each(Rate { from_s: seconds(begin), to_s: seconds(end), speed });
                    }
                    follows |= count > 0;
                }
            }
        }
    }
}

/// The interval to the step that follows the segment at `place` at once, if one does.
fn interval_after(list: &SegmentList, place: usize) -> Option<i128> {
    match list.segments.get(place + 1)? {
        Segment::Steps { count: 1.., interval, .. } => Some(i128::from(*interval)),
        _ => None,
    }
}

/// The first of `0..count` of which `before` does not hold, or `count`; it holds up to there.
fn first_not(count: u32, before: impl Fn(u32) -> bool) -> u32 {
    let (mut from, mut to) = (0, count);
    while from < to {
        let middle = from + (to - from) / 2;
        if before(middle) { from = middle + 1 } else { to = middle }
    }
    from
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use stepscope_peripheral::{
        config::{Bus, SerialLine},
        signal::{Event, Sink},
        units::Instant,
    };

    #[test]
    fn a_first_step_after_half_an_interval_makes_no_twofold_speed() {
        let config =
            Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("the defaults hold");
        let cycles = |count: u64| count << FRACTION_BITS;
        let steps =
            |count, interval| Segment::Steps { count, interval: cycles(interval), add: 0, right: true };
        // 1000 steps/s, from rest after half an interval; then a slow start of 250 steps/s.
        let rest = Segment::Dwell(cycles(32_000));
        let segments = vec![
            steps(1, 8000),
            steps(2, 16_000),
            rest,
            steps(1, 8000),
            steps(1, 16_000),
            rest,
            steps(1, 64_000),
        ];
        let list = SegmentList { start: Instant(16_000), segments };
        let log = PacketLog::default();
        let pulses = Pulses::of_run(0, &[], &log, Some(&list), &config);
        let mut found = Vec::new();
        pulses.rates(0.0, 1.0, &mut |rate| found.push((rate.from_s, rate.to_s, rate.speed)));
        let expected = [
            (0.001, 0.0015, 1000.0),
            (0.0015, 0.0025, 1000.0),
            (0.0025, 0.0035, 1000.0),
            (0.0055, 0.006, 1000.0),
            (0.006, 0.007, 1000.0),
            (0.009, 0.013, 250.0),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn recorded_steps_have_the_speed_from_each_to_the_next_and_back() {
        let steps = [(100, 1), (150, 2), (250, 1)].map(|(cycle, position)| Step { cycle, position });
        let pulses = Pulses::recorded(0, &steps, 1000);
        let at = [0.05, 0.1, 0.12, 0.15, 0.249, 0.25].map(|time_s| pulses.speed_at(time_s));
        assert_eq!(at, [0.0, 20.0, 20.0, -10.0, -10.0, 0.0]);
        assert_eq!((pulses.zero(), pulses.position_at(0.2)), (0, 2));
    }

    #[test]
    fn a_tick_that_stop_ends_has_no_speed_afterwards() {
        let config =
            Config::new(16_000_000, &Bus::default(), &SerialLine::default()).expect("the defaults hold");
        let mut log = PacketLog::default();
        let mut commands = [0; 16];
        commands[0] = 0x80 | 10;
        log.event(Instant(16_000), Event::TickStart { commands });
        log.event(Instant(24_000), Event::Stopped);
        let pulses = Pulses::of_run(0, &[], &log, None, &config);
        let speed = 10.0 * 16e6 / config.tick().0 as f64;
        assert_eq!(
            [0.000_9, 0.001, 0.001_4, 0.001_5, 0.002].map(|at| pulses.speed_at(at)),
            [0.0, speed, speed, 0.0, 0.0]
        );
    }
}
