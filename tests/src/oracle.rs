//! The contract's second reader: a slow model of the raw-framing peripheral, written from the sentences of
//! DESIGN Part A (A1, A3, A4, A5, A7, A9) and from nothing else, so that property tests can hold the core
//! to the text edge by edge.
//!
//! It is naive on purpose. Every cycle of `0..cycles` is visited one at a time; levels come straight from the
//! contract's formulas; nothing is skipped, predicted or shared with the core. Raw framing has no reply, so
//! EN = 1, TX = 1 and DE = 0 throughout, and UNDERRUN (framed mode only) never shows.
//!
//! ```text
//! sends, forced --A4 sender--> line (RX, a level a cycle) --A4 receiver--> bytes, framing errors
//!    --A5--> packets, faults --A7--> queue, ticks, slots, pulses --A3--> records, positions
//! ```
//!
//! Where the contract leaves room, the reading taken is written at the line that takes it ("Reading:").

#[cfg(test)]
mod tests;

use std::collections::VecDeque;

/// Fault bit 0 (A6's list): a stop bit was low.
pub const FRAMING: u16 = 1 << 0;
/// Fault bit 1: a gap found a packet unfinished.
pub const SHORT_PACKET: u16 = 1 << 1;
/// Fault bit 4: a packet found the queue full.
pub const QUEUE_OVERFLOW: u16 = 1 << 4;
/// Fault bit 5: a packet ordered more steps than a tick has slots.
pub const TOO_MANY_STEPS: u16 = 1 << 5;

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

/// Everything that the contract lets one configure, in the contract's own units: rates in hertz and baud,
/// times in cycles.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Config {
    /// Peripheral clock, hertz.
    pub clock_hz: u64,
    /// The sender's baud rate.
    pub baud: u64,
    /// The receiver's baud rate; apart from `baud` where a clock error is modelled.
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
    /// Places in the queue, in ticks, 1..=255.
    pub queue_depth: usize,
    /// The cycles 0..=boot-1 are self-test.
    pub boot: u64,
    /// Distribution of a tick's steps: `true` spread, `false` burst.
    pub spread: bool,
    /// `true`: one DIR line for all; `false`: one a channel.
    pub common_dir: bool,
    /// `true`: staggered; `false`: simultaneous.
    pub staggered: bool,
    /// The controller's own address, 0..=254; `None`: packets carry no address.
    pub address: Option<u8>,
}

/// What the host and the scenario do to the line, and for how long the run lasts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// (start cycle, bytes sent back to back from there), not overlapping, none before cycle 1.
    pub sends: Vec<(u64, Vec<u8>)>,
    /// (cycle, length, level), none before cycle 1; where two overlap the later entry wins.
    pub forced: Vec<(u64, u64, bool)>,
    /// The run is the cycles `0..cycles`.
    pub cycles: u64,
}

/// What a run leaves behind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Run {
    /// A3's records (cycle, levels).
    pub trace: Vec<(u64, u64)>,
    /// Position counters; those of unused channels stay 0.
    pub positions: [i32; 16],
    /// Fault flags, bits as in A6's list.
    pub faults: u16,
    /// Ticks whose end was reached.
    pub ticks_done: u32,
}

/// B, the receiver's bit time in cycles: "floor((2*clock_hz + receiver_baud) / (2*receiver_baud))" (A4).
pub fn bit_time(config: &Config) -> u64 {
    (2 * config.clock_hz + config.receiver_baud) / (2 * config.receiver_baud)
}

/// L = W + max(D + H, 1) (A7), cycles.
pub fn pulse_room(config: &Config) -> u64 {
    config.pulse_width + (config.dir_setup + config.dir_hold).max(1)
}

/// Whether a configuration is refused: A4's least bit time, A7's pulse rules, and the ranges that A3, A5
/// and A7 name.
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

/// Start of the `j`-th of the bytes sent back to back from `t0`: "t0 + floor(10*j*clock_hz/baud)" (A4).
pub fn byte_start(config: &Config, t0: u64, j: u64) -> u64 {
    t0 + 10 * j * config.clock_hz / config.baud
}

/// First cycle of bit `k` of a byte that starts at `start`; `k` = 10 is the stop bit's end (A4).
pub fn bit_start(config: &Config, start: u64, k: u64) -> u64 {
    start + k * config.clock_hz / config.baud
}

/// The cycle in which a byte that the receiver first saw at `t` is delivered, or found to have no stop bit
/// (A4).
pub fn stop_sample(config: &Config, t: u64) -> u64 {
    t + bit_time(config) / 2 + 9 * bit_time(config)
}

/// Raw host, paced (A9): "packet j starts at boot + 1 + j*M*Ts".
///
/// Whether the line can carry a packet in M*Ts cycles is the caller's affair.
pub fn packets_schedule(config: &Config, packets: &[Vec<u8>]) -> Vec<(u64, Vec<u8>)> {
    let mut schedule = Vec::new();
    for (j, packet) in packets.iter().enumerate() {
        let start = config.boot + 1 + j as u64 * config.slots * config.step_period;
        schedule.push((start, packet.clone()));
    }
    schedule
}

/// The line's level in every cycle of the run: high, then the sends' bits, then what is forced, in the
/// entries' order.
pub fn line_levels(config: &Config, input: &Input) -> Vec<bool> {
    let mut line = vec![true; input.cycles as usize];
    let mut hold = |from: u64, to: u64, level: bool| {
        for cycle in from..to {
            // "RX = TX = 1" at cycle 0 (A3), whatever is sent or forced.
            if cycle >= 1 && cycle < input.cycles {
                line[cycle as usize] = level;
            }
        }
    };
    for (t0, bytes) in &input.sends {
        for (j, byte) in bytes.iter().enumerate() {
            let start = byte_start(config, *t0, j as u64);
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
    for &(cycle, length, level) in &input.forced {
        hold(cycle, cycle + length, level);
    }
    line
}

/// What the receiver makes of the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heard {
    /// A byte, delivered.
    Byte(u8),
    /// The stop bit was low: the byte is dropped.
    FramingError,
}

/// A4's receiver, between two cycles.
enum Receiver {
    Armed,
    /// The line was first seen low at `t`; `byte` holds the data bits sampled so far.
    InByte {
        t: u64,
        byte: u8,
    },
    /// After a framing error: until the line has been high for a cycle.
    WaitingForHigh,
}

/// The receiver's deliveries and framing errors, each with its cycle.
pub fn hear(config: &Config, line: &[bool]) -> Vec<(u64, Heard)> {
    let bit_time = bit_time(config);
    let mut heard = Vec::new();
    let mut receiver = Receiver::Armed;
    for (cycle, &high) in line.iter().enumerate() {
        let cycle = cycle as u64;
        // The state that a cycle leaves is the next cycle's: "arms again in the next cycle", "is armed from
        // the next cycle on", "arms in the cycle after the first cycle … in which the line is high".
        receiver = match receiver {
            Receiver::Armed if high => Receiver::Armed,
            Receiver::Armed => Receiver::InByte { t: cycle, byte: 0 },
            Receiver::InByte { t, .. } if cycle == t + bit_time / 2 && high => Receiver::Armed,
            Receiver::InByte { t, byte } if cycle == stop_sample(config, t) => {
                heard.push((cycle, if high { Heard::Byte(byte) } else { Heard::FramingError }));
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
    }
    heard
}

/// Whether a channel with count `count` fires in slot `k` (A7).
pub fn fires(config: &Config, count: u64, k: u64) -> bool {
    if config.spread {
        let half = config.slots / 2;
        ((k + 1) * count + half) / config.slots > (k * count + half) / config.slots
    } else {
        k < count
    }
}

/// A pulse: STEP of `channel` is 1 during `[rise, fall)`.
struct Pulse {
    channel: usize,
    rise: u64,
    fall: u64,
}

/// From `cycle` on, DIR of `channels` (a bit each) has `level`.
struct DirChange {
    cycle: u64,
    channels: u64,
    level: bool,
}

/// A tick that has started: all of its pulses and DIR changes, and its end e.
struct Tick {
    end: u64,
    pulses: Vec<Pulse>,
    dir_changes: Vec<DirChange>,
}

/// Lays out the tick that `orders` (byte i for channel i) give, started at `c0` (A7).
fn start_tick(config: &Config, orders: &[u8], c0: u64) -> Tick {
    let (width, setup, hold) = (config.pulse_width, config.dir_setup, config.dir_hold);
    let right = |channel: usize| orders[channel] >> 7 == 1;
    let all = (1 << config.channels) - 1;
    let mut tick =
        Tick { end: c0 + config.slots * config.step_period, pulses: Vec::new(), dir_changes: Vec::new() };

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
            // A7's refusal rules give every pulse room in its own slot.
            assert!(rise + width <= s + config.step_period, "a pulse leaves its slot: {config:?}");
            tick.pulses.push(Pulse { channel, rise, fall: rise + width });
        }
    }
    tick
}

/// Runs a configuration that is not [`refused`], cycle by cycle, in A7's order within one cycle: the
/// sequencer, the gap timer, the byte.
pub fn run(config: &Config, input: &Input) -> Run {
    assert!(!refused(config), "a refused configuration has no run: {config:?}");
    let line = line_levels(config, input);
    let heard = hear(config, &line);
    let gap = 45 * bit_time(config);
    let packet_length = config.channels + usize::from(config.address.is_some());

    let mut result = Run { trace: Vec::new(), positions: [0; 16], faults: 0, ticks_done: 0 };
    // Each place of the queue holds a tick's orders.
    let mut queue: VecDeque<Vec<u8>> = VecDeque::new();
    let mut running: Option<Tick> = None;
    let mut dir: u64 = 0;
    let mut step_before: u64 = 0;
    let mut levels_before: Option<u64> = None;
    // A5's d, the partial packet, and whether bytes are being ignored.
    let mut last_heard: Option<u64> = None;
    let mut partial: Vec<u8> = Vec::new();
    let mut ignoring = false;

    for cycle in 0..input.cycles {
        // The sequencer: a tick ends, a tick starts "from commits of earlier cycles only" (this cycle's
        // byte comes later).
        if running.as_ref().is_some_and(|tick| tick.end == cycle) {
            result.ticks_done += 1;
            running = None;
        }
        if running.is_none()
            && let Some(orders) = queue.pop_front()
        {
            running = Some(start_tick(config, &orders, cycle));
        }
        let mut step: u64 = 0;
        if let Some(tick) = &running {
            for change in &tick.dir_changes {
                if change.cycle == cycle {
                    dir = if change.level { dir | change.channels } else { dir & !change.channels };
                }
            }
            for pulse in &tick.pulses {
                if pulse.rise <= cycle && cycle < pulse.fall {
                    step |= 1 << pulse.channel;
                }
            }
        }

        // The gap timer.
        if last_heard.is_some_and(|d| cycle == d + gap + 1) {
            if !partial.is_empty() {
                result.faults |= SHORT_PACKET;
                partial.clear();
            }
            ignoring = false;
        }

        // The byte. Reading: a framing error has a delivered byte's place in the order, after the gap
        // timer; so in the cycle d + 45*B + 1 a partial packet is SHORT_PACKET first, and then the error is
        // FRAMING.
        for &(_, what) in heard.iter().filter(|(heard_at, _)| *heard_at == cycle) {
            last_heard = Some(cycle);
            match what {
                Heard::FramingError => {
                    result.faults |= FRAMING;
                    partial.clear();
                    ignoring = true;
                }
                Heard::Byte(_) if ignoring => {}
                Heard::Byte(byte) => {
                    partial.push(byte);
                    if partial.len() == packet_length {
                        result.faults |= commit(config, &partial, cycle, &mut queue);
                        partial.clear();
                    }
                }
            }
        }

        // The cycle's levels, and the steps that rise in it.
        for channel in 0..config.channels {
            if step & !step_before & 1 << channel != 0 {
                result.positions[channel] += if dir >> channel & 1 == 1 { 1 } else { -1 };
            }
        }
        step_before = step;
        let rx = u64::from(line[cycle as usize]);
        let levels = step << bits::STEP | dir << bits::DIR | 1 << bits::EN | rx << bits::RX | 1 << bits::TX;
        if levels_before != Some(levels) {
            result.trace.push((cycle, levels));
            levels_before = Some(levels);
        }
    }
    result
}

/// Judges a whole packet committed in cycle `p`; returns the fault it sets, 0 for none.
fn commit(config: &Config, packet: &[u8], p: u64, queue: &mut VecDeque<Vec<u8>>) -> u16 {
    let orders = match config.address {
        None => packet,
        Some(own) if packet[0] == own || packet[0] == 255 => &packet[1..],
        Some(_) => return 0,
    };
    // Reading: "One with p < boot is dropped without a fault" holds whatever is in it, so boot is judged
    // first.
    if p < config.boot {
        return 0;
    }
    // "dropped whole (fault TOO_MANY_STEPS, and no other)": judged before the queue.
    if orders.iter().any(|order| u64::from(order & 0x7F) > config.slots) {
        return TOO_MANY_STEPS;
    }
    if queue.len() == config.queue_depth {
        return QUEUE_OVERFLOW;
    }
    queue.push_back(orders.to_vec());
    0
}
