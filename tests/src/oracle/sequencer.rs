//! A7: the queue, the ticks, and the pulses within their slots.

use std::collections::VecDeque;

use super::Config;

/// Whether a channel with count `count` fires in slot `k` (A7).
pub fn fires(config: &Config, count: u64, k: u64) -> bool {
    if config.spread {
        let half = config.slots / 2;
        ((k + 1) * count + half) / config.slots > (k * count + half) / config.slots
    } else {
        k < count
    }
}

/// The queue and the tick that runs.
#[derive(Default)]
pub(super) struct Sequencer {
    /// Each place of the queue has a tick's commands, byte i for channel i.
    queue: VecDeque<Vec<u8>>,
    running: Option<Tick>,
    /// DIR, one bit per channel.
    pub(super) dir: u64,
    pub(super) ticks_done: u32,
}

impl Sequencer {
    /// The sequencer's part of `cycle`: a tick ends, a tick starts "from commits of earlier cycles only" (this
    /// cycle's byte comes later). True for A7's UNDERRUN: "at e, if no tick starts at e and some count of the
    /// tick that ended is above 0".
    pub(super) fn advance(&mut self, config: &Config, cycle: u64) -> bool {
        let mut counted = false;
        if let Some(ended) = self.running.take_if(|tick| tick.end == cycle) {
            self.ticks_done = self.ticks_done.wrapping_add(1);
            counted = ended.counted;
        }
        if self.running.is_none()
            && let Some(orders) = self.queue.pop_front()
        {
            self.running = Some(start_tick(config, &orders, cycle));
        }
        if let Some(tick) = &self.running {
            for change in &tick.dir_changes {
                if change.cycle == cycle {
                    let cleared = self.dir & !change.channels;
                    self.dir = if change.level { cleared | change.channels } else { cleared };
                }
            }
        }
        counted && self.running.is_none()
    }

    /// STEP in `cycle`, one bit per channel.
    pub(super) fn step(&self, cycle: u64) -> u64 {
        let mut step = 0;
        if let Some(tick) = &self.running {
            for pulse in &tick.pulses {
                if pulse.rise <= cycle && cycle < pulse.fall {
                    step |= 1 << pulse.channel;
                }
            }
        }
        step
    }

    /// "if a tick runs (c0 <= p < e) or the queue is not empty" (A6).
    pub(super) fn moving(&self) -> bool {
        self.running.is_some() || !self.queue.is_empty()
    }

    /// Free places of the queue.
    pub(super) fn free(&self, config: &Config) -> usize {
        config.queue_depth - self.queue.len()
    }

    /// Takes a place; the caller has checked that one is free.
    pub(super) fn queue(&mut self, orders: &[u8]) {
        self.queue.push_back(orders.to_vec());
    }

    /// STOP: "queue emptied, running tick abandoned"; "after STOP, e counts as passed". DIR and ticks_done stay.
    pub(super) fn stop(&mut self) {
        self.queue.clear();
        self.running = None;
    }
}

/// A pulse: STEP of `channel` is 1 during `[rise, fall)`.
struct Pulse {
    channel: usize,
    rise: u64,
    fall: u64,
}

/// From `cycle` on, DIR of `channels` (one bit each) has `level`.
struct DirChange {
    cycle: u64,
    channels: u64,
    level: bool,
}

/// A started tick: all its pulses and DIR changes, its end e, and whether one of its counts is above 0.
struct Tick {
    end: u64,
    counted: bool,
    pulses: Vec<Pulse>,
    dir_changes: Vec<DirChange>,
}

/// Computes the tick of `orders` (byte i for channel i), started at `c0` (A7).
fn start_tick(config: &Config, orders: &[u8], c0: u64) -> Tick {
    let (width, setup, hold) = (config.pulse_width, config.dir_setup, config.dir_hold);
    let right = |channel: usize| orders[channel] >> 7 == 1;
    let all = (1 << config.channels) - 1;
    let mut tick = Tick {
        end: c0 + config.slots * config.step_period,
        counted: orders.iter().any(|order| order & 0x7F > 0),
        pulses: Vec::new(),
        dir_changes: Vec::new(),
    };

    if !config.common_dir {
        for channel in 0..config.channels {
            tick.dir_changes.push(DirChange { cycle: c0, channels: 1 << channel, level: right(channel) });
        }
    }
    for k in 0..config.slots {
        let s = c0 + k * config.step_period;
        let firing: Vec<usize> = (0..config.channels)
            .filter(|&channel| fires(config, (orders[channel] & 0x7F).into(), k))
            .collect();
        if firing.is_empty() {
            continue;
        }
        let nd = firing.len() as u64;
        let d = config.settle.min(config.step_period / nd);
        let lefts = firing.iter().copied().filter(|&channel| !right(channel));
        let rights = firing.iter().copied().filter(|&channel| right(channel));

        let mut rises: Vec<(usize, u64)> = Vec::new();
        match (config.common_dir, config.staggered) {
            (false, false) => rises.extend(firing.iter().map(|&channel| (channel, s + setup))),
            (false, true) => {
                for (j, &channel) in firing.iter().enumerate() {
                    rises.push((channel, s + setup + j as u64 * d));
                }
            }
            (true, false) => {
                tick.dir_changes.push(DirChange { cycle: s, channels: all, level: false });
                rises.extend(lefts.map(|channel| (channel, s + setup)));
                tick.dir_changes.push(DirChange {
                    cycle: s + setup + width + hold,
                    channels: all,
                    level: true,
                });
                rises.extend(rights.map(|channel| (channel, s + 2 * setup + width + hold)));
            }
            (true, true) => {
                let left_count = lefts.clone().count();
                for (j, channel) in lefts.chain(rights).enumerate() {
                    let rise = s + setup + j as u64 * d;
                    rises.push((channel, rise));
                    if j == 0 && left_count > 0 {
                        tick.dir_changes.push(DirChange { cycle: s, channels: all, level: false });
                    }
                    if j == left_count {
                        tick.dir_changes.push(DirChange { cycle: rise - setup, channels: all, level: true });
                    }
                }
            }
        }
        for (channel, rise) in rises {
            // By A7's rules every pulse fits into its slot.
            assert!(rise + width <= s + config.step_period, "a pulse leaves its slot: {config:?}");
            tick.pulses.push(Pulse { channel, rise, fall: rise + width });
        }
    }
    tick
}
