//! Builds the framed host's schedule: frames are sent at times that are critical for replies and ends of ticks, which are
//! predicted for a run without errors. A prediction only chooses times; it decides no result.

use proptest::prelude::*;
use proptest::sample::Index;

use super::frames::{Good, Utterance, said};
use crate::oracle::{Config, bit_time, byte_start, kinds, stop_sample};

/// The time of a send, relative to the previous one.
#[derive(Debug, Clone, Copy)]
pub(super) enum Pause {
    /// Cycles after the end of the last stop bit, even during a reply.
    Rude(u64),
    /// Cycles after the reply, too.
    Polite(u64),
    /// Cycles after, or before, DE's rise for the last reply.
    DeRise(i64),
    /// Cycles after, or before, DE's fall.
    DeFall(i64),
    /// The last byte is delivered this many cycles after a tick's end.
    TickEnd(i64),
    /// The last byte is delivered during a tick, after this part of it, in per mille.
    InTick(u64),
    /// The last byte is delivered this many cycles after, or before, the first pulse of this slot may rise.
    StepRise(Index, i64),
}

/// Unless `calm`, one send in six is during a reply.
pub(super) fn pause(calm: bool) -> impl Strategy<Value = Pause> {
    let polite = if calm { 400 } else { 9 };
    prop_oneof![
        2 => (0..300_u64).prop_map(Pause::Rude),
        polite => (0..200_u64).prop_map(Pause::Polite),
        1 => (0..6_000_u64).prop_map(Pause::Polite),
        1 => (-170..=3_i64).prop_map(Pause::DeRise),
        1 => (-200..=0_i64).prop_map(Pause::DeFall),
        1 => (-3..=3_i64).prop_map(Pause::DeFall),
        polite / 2 => (-2..=2_i64).prop_map(Pause::TickEnd),
        polite / 3 => (0..1_000_u64).prop_map(Pause::InTick),
        polite / 3 => step_rise(),
    ]
}

/// Next to the cycle in which STEP may rise.
pub(super) fn step_rise() -> impl Strategy<Value = Pause> {
    (any::<Index>(), -1..=1_i64).prop_map(|(slot, offset)| Pause::StepRise(slot, offset))
}

/// A pause and the bytes after it; where they are split, and the pause between the parts.
pub(super) type Turn = (Pause, Utterance, Option<(Index, Pause)>);

/// A range of cycles.
#[derive(Clone, Copy)]
struct Span {
    start: u64,
    end: u64,
}

/// Predicted state of one controller, without errors.
#[derive(Default)]
struct Foreseen {
    expected_seq: u8,
    stopped: bool,
    /// In the order of time.
    ticks: Vec<Span>,
}

/// The host's schedule so far.
pub(super) struct Host<'a> {
    line: &'a [Config],
    pub(super) sends: Vec<(u64, Vec<u8>)>,
    /// Where the first controller delivers each send's last byte, without faults on the line.
    pub(super) deliveries: Vec<u64>,
    /// The starts of all bytes of the host and of replies.
    pub(super) byte_starts: Vec<u64>,
    /// The end of the last stop bit: the earliest start of a send.
    pub(super) free_from: u64,
    foreseen: Vec<Foreseen>,
    /// DE of the latest reply.
    reply: Option<Span>,
}

impl<'a> Host<'a> {
    pub(super) fn new(line: &'a [Config]) -> Self {
        Host {
            line,
            sends: Vec::new(),
            deliveries: Vec::new(),
            byte_starts: Vec::new(),
            free_from: 1,
            foreseen: line.iter().map(|_| Foreseen::default()).collect(),
            reply: None,
        }
    }

    /// The cycle from which on, by the prediction, nobody sends.
    pub(super) fn quiet_from(&self) -> u64 {
        self.reply.map_or(0, |reply| reply.end).max(self.free_from)
    }

    /// Adds a send after a pause, and predicts its effect; if it is split, the second part follows after another pause.
    pub(super) fn say(&mut self, (pause, utterance, cut): &Turn) {
        let (bytes, good) = said(utterance, self.line, |k| self.foreseen[k].expected_seq);
        match cut {
            Some((at, second_pause)) if bytes.len() > 1 => {
                let (first, second) = bytes.split_at(1 + at.index(bytes.len() - 1));
                self.send(*pause, first);
                self.send(*second_pause, second);
            }
            _ => self.send(*pause, &bytes),
        }
        if let Some(good) = good {
            let (start, bytes) = self.sends.last().map_or((1, 1), |(start, bytes)| (*start, bytes.len()));
            let last = byte_start(&self.line[0], start, bytes as u64 - 1);
            if self.reply.is_none_or(|reply| reply.end <= start) {
                self.foresee(last, &good);
            }
        }
    }

    fn send(&mut self, pause: Pause, bytes: &[u8]) {
        let config = &self.line[0];
        let last = bytes.len() as u64 - 1;
        let to_delivery = stop_sample(config, byte_start(config, 0, last));
        let reply = self.reply.unwrap_or(Span { start: self.free_from, end: self.free_from });
        let start = match pause {
            Pause::Rude(cycles) => self.free_from + cycles,
            Pause::Polite(cycles) => self.quiet_from() + cycles,
            Pause::DeRise(offset) => reply.start.saturating_add_signed(offset),
            Pause::DeFall(offset) => reply.end.saturating_add_signed(offset),
            Pause::TickEnd(offset) => {
                self.delivered_at(to_delivery, |tick| tick.end.saturating_add_signed(offset))
            }
            Pause::InTick(permille) => {
                self.delivered_at(to_delivery, |tick| tick.start + (tick.end - tick.start) * permille / 1_000)
            }
            Pause::StepRise(slot, offset) => {
                let slot = slot.index(config.slots as usize) as u64;
                let rise = slot * config.step_period + config.dir_setup;
                self.delivered_at(to_delivery, |tick| (tick.start + rise).saturating_add_signed(offset))
            }
        };
        let start = start.max(self.free_from);
        self.sends.push((start, bytes.to_vec()));
        self.deliveries.push(start + to_delivery);
        self.byte_starts.extend((0..=last).map(|j| byte_start(config, start, j)));
        self.free_from = byte_start(config, start, last) + byte_start(config, 0, 1);
    }

    /// The start of a send of `to_delivery` cycles for the first target time of a tick that disturbs no reply.
    fn delivered_at(&self, to_delivery: u64, aim: impl Fn(&Span) -> u64) -> u64 {
        let ticks = self.foreseen.iter().flat_map(|foreseen| &foreseen.ticks);
        let reached = ticks.map(aim).filter(|delivery| *delivery >= self.quiet_from() + to_delivery).min();
        reached.map_or(self.quiet_from(), |delivery| delivery - to_delivery)
    }

    /// Predicts the effect of a valid frame whose last byte starts at `last`.
    fn foresee(&mut self, last: u64, good: &Good) {
        for (config, foreseen) in self.line.iter().zip(&mut self.foreseen) {
            let own = config.address.unwrap_or(0);
            if good.address != own && good.address != 255 {
                continue;
            }
            let p = stop_sample(config, last);
            foreseen.take(config, p, good.kind, &good.body);
            if good.address == own {
                let start = p + 10 * bit_time(config);
                // A NAK has 18 bytes, an ACK one less; or the positions of all channels.
                let tells_positions = good.kind == kinds::POSITIONS && good.body.is_empty();
                let length = if tells_positions { 17 + 4 * config.channels as u64 } else { 18 };
                let byte =
                    |j: u64| start + bit_time(config) + 10 * j * config.clock_hz / config.receiver_baud;
                self.byte_starts.extend((0..length).map(byte));
                self.reply = Some(Span { start, end: byte(length) });
            }
        }
    }
}

impl Foreseen {
    fn take(&mut self, config: &Config, p: u64, kind: u8, body: &[u8]) {
        let running = self.ticks.iter().any(|tick| p < tick.end);
        match kind {
            kinds::TICKS => self.queue(config, p, body),
            kinds::ENABLE => self.stopped = false,
            kinds::DISABLE if !running => self.stopped = true,
            kinds::STOP => {
                self.stopped = true;
                self.ticks.retain(|tick| tick.end <= p);
            }
            kinds::RESYNC => self.expected_seq = 0,
            _ => {}
        }
    }

    fn queue(&mut self, config: &Config, p: u64, body: &[u8]) {
        let waiting = self.ticks.iter().filter(|tick| tick.start > p).count();
        let [seq, count, orders @ ..] = body else { return };
        let fits = (1..=32).contains(count)
            && orders.len() == usize::from(*count) * config.channels
            && orders.iter().all(|order| u64::from(order & 0x7F) <= config.slots)
            && waiting + usize::from(*count) <= config.queue_depth;
        if *seq != self.expected_seq || !fits || p < config.boot || self.stopped {
            return;
        }
        self.expected_seq = self.expected_seq.wrapping_add(1);
        for _ in 0..*count {
            let start = self.ticks.last().map_or(0, |tick| tick.end).max(p + 1);
            self.ticks.push(Span { start, end: start + config.slots * config.step_period });
        }
    }
}
