//! The actual motion of one channel's pulses (DESIGN A8, B1).
//!
//! With ticks the speed is steps per tick; with segments and recorded pulses it is 1/interval per step. The first step
//! of a constant rate is due after half an interval, so the speed of a first interval is at most that of the next one.

use crate::motion::step_acceleration;
use crate::packets::log::{LoggedTick, PacketLog};
use stepscope_peripheral::segment::{FRACTION_BITS, Segment, SegmentList};
use stepscope_peripheral::{config::Config, trace::Step, units::Cycles, wire::packet::ChannelCommand};

#[derive(Clone, Copy, Debug)]
enum Source<'a> {
    Ticks(&'a PacketLog, Cycles),
    Segments(&'a SegmentList),
    Recorded,
}

/// The pulses of one channel of a run or a recording.
#[derive(Clone, Copy, Debug)]
pub struct Pulses<'a> {
    pub channel: u8,
    pub steps: &'a [Step],
    source: Source<'a>,
    clock_hz: u32,
}

/// A constant speed in steps/s over a time in s; negative to the left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    pub from_s: f64,
    pub to_s: f64,
    pub speed: f64,
}

impl<'a> Pulses<'a> {
    /// The steps of a channel of a run. `list` is its segment list, if it runs one.
    pub const fn of_run(
        channel: u8,
        steps: &'a [Step],
        log: &'a PacketLog,
        segments: Option<&'a SegmentList>,
        config: &Config,
    ) -> Self {
        let source = match segments {
            Some(list) => Source::Segments(list),
            None => Source::Ticks(log, config.tick()),
        };
        Self { channel, steps, source, clock_hz: config.clock_hz() }
    }

    /// Recorded steps in cycles of `clock_hz`, with the speed from step to step.
    pub const fn recorded(channel: u8, steps: &'a [Step], clock_hz: u32) -> Self {
        Self { channel, steps, source: Source::Recorded, clock_hz }
    }

    pub const fn clock_hz(&self) -> u32 {
        self.clock_hz
    }

    pub fn hz(&self) -> f64 {
        f64::from(self.clock_hz)
    }

    #[cfg(feature = "std")]
    pub(crate) const fn tick(&self) -> Option<Cycles> {
        match self.source {
            Source::Ticks(_, length) => Some(length),
            Source::Segments(_) | Source::Recorded => None,
        }
    }

    /// The cycle of the motion's time 0: the start of the segment list or of the first tick, otherwise 0.
    pub fn zero(&self) -> u64 {
        match self.source {
            Source::Ticks(log, _) => log.ticks().first().map_or(0, |tick| tick.start.0),
            Source::Segments(list) => list.start.0,
            Source::Recorded => 0,
        }
    }

    /// The position in steps at a time.
    pub fn position_at(&self, time_s: f64) -> i32 {
        let after = self.steps_until(time_s);
        after.checked_sub(1).and_then(|last| self.steps.get(last)).map_or(0, |step| step.position)
    }

    pub(crate) fn steps_until(&self, time_s: f64) -> usize {
        let hz = self.hz();
        self.steps.partition_point(|step| step.cycle as f64 / hz <= time_s)
    }

    /// The speed in steps/s at a time.
    pub fn speed_at(&self, time_s: f64) -> f64 {
        let mut speed = 0.0;
        // An interval includes its begin, not its end.
        self.rates(time_s, time_s, &mut |rate| {
            if rate.from_s <= time_s && time_s < rate.to_s {
                speed = rate.speed;
            }
        });
        speed
    }

    /// Calls `each` with start, end and acceleration between steps, for steps without a plan, within `from_s..=to_s`.
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

    /// Whether the steps have an acceleration somewhere. Steps of ticks have none, because their speed is stepwise.
    pub fn have_acceleration(&self) -> bool {
        let is_known = |index| step_acceleration::of(self.steps, index, self.hz()).is_some();
        !matches!(self.source, Source::Ticks(..)) && (0..self.steps.len()).any(is_known)
    }

    /// The acceleration in steps/s^2 at a time, as in [`Self::accelerations`].
    pub fn acceleration_at(&self, time_s: f64) -> Option<f64> {
        step_acceleration::of(self.steps, self.steps_until(time_s).checked_sub(1)?, self.hz())
    }

    /// Calls `each` for every constant speed within `from_s..=to_s`; between them the speed is 0.
    pub fn rates(&self, from_s: f64, to_s: f64, each: &mut dyn FnMut(Rate)) {
        match self.source {
            Source::Ticks(log, length) => self.tick_rates((log, length), from_s, to_s, each),
            Source::Segments(list) => self.intervals(list, from_s, to_s, each),
            Source::Recorded => self.step_to_step(from_s, to_s, each),
        }
    }

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

    fn tick_rates(
        &self,
        (log, length): (&PacketLog, Cycles),
        from_s: f64,
        to_s: f64,
        each: &mut dyn FnMut(Rate),
    ) {
        let hz = self.hz();
        let start = |tick: &LoggedTick| tick.start.0 as f64 / hz;
        // STOP ends a tick early.
        let end = |tick: &LoggedTick| log.tick_end(tick, length).0 as f64 / hz;
        let ticks = log.ticks();
        let first = ticks.partition_point(|tick| end(tick) < from_s);
        for tick in ticks.iter().skip(first).take_while(|tick| start(tick) <= to_s) {
            let command =
                ChannelCommand::parse(tick.commands.get(usize::from(self.channel)).copied().unwrap_or(0));
            let speed = f64::from(command.steps) * hz / length.0 as f64;
            let speed = if command.right { speed } else { 0.0 - speed };
            each(Rate { from_s: start(tick), to_s: end(tick), speed });
        }
    }

    fn intervals(&self, list: &SegmentList, from_s: f64, to_s: f64, each: &mut dyn FnMut(Rate)) {
        let (hz, one) = (self.hz(), (1_u64 << FRACTION_BITS) as f64);
        let seconds = |next: i128| next as f64 / one / hz;
        let mut next = i128::from(list.start.0) << FRACTION_BITS;
        let mut follows = false;
        for (index, segment) in list.segments.iter().enumerate() {
            if seconds(next) > to_s {
                break;
            }
            match *segment {
                Segment::Dwell(dwell) => {
                    next += i128::from(dwell);
                    follows &= dwell == 0;
                }
                Segment::Steps { count, interval, add, right } => {
                    // The next step after k steps of this segment.
                    let start = next;
                    let after = |k: u32| {
                        let (k, add) = (i128::from(k), i128::from(add));
                        start + k * i128::from(interval) + add * (k * (k - 1) / 2)
                    };
                    next = after(count);
                    let first = first_false(count, |k| seconds(after(k + 1)) < from_s);
                    for k in first..count {
                        let (begin, end) = (after(k), after(k + 1));
                        if seconds(begin) > to_s {
                            break;
                        }
                        let mut interval = end - begin;
                        if k == 0 && !follows {
                            let second =
                                if count > 1 { Some(after(2) - end) } else { interval_after(list, index) };
                            interval = interval.max(second.unwrap_or(interval));
                        }
                        let speed = hz * one / interval as f64;
                        let speed = if right { speed } else { -speed };
                        each(Rate { from_s: seconds(begin), to_s: seconds(end), speed });
                    }
                    follows |= count > 0;
                }
            }
        }
    }
}

/// The interval to a step that follows the segment without a dwell.
fn interval_after(list: &SegmentList, index: usize) -> Option<i128> {
    match list.segments.get(index + 1)? {
        Segment::Steps { count: 1.., interval, .. } => Some(i128::from(*interval)),
        _ => None,
    }
}

/// The first number in `0..count` for which `before` is false.
fn first_false(count: u32, before: impl Fn(u32) -> bool) -> u32 {
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
    fn a_first_step_after_half_an_interval_does_not_double_the_speed() {
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
    fn recorded_steps_have_the_speed_of_their_intervals() {
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
