//! Rows of packets in words: as the table, the search and the files have them.

use std::fmt::Write as _;
use stepscope_core::{
    peripheral::{
        config::{Config, Protocol},
        protocol::{FrameOutcome, Kind, Reply},
        signal::PacketOutcome,
        trace::RowOutcome,
        wire::{
            frame::{Deframed, Deframer, Frame, Ticks},
            packet::{ALL, ChannelCommand},
        },
    },
    sim::Experiment,
};

/// Set in the kind of a frame that is a reply (DESIGN A6).
const REPLY: u8 = 0x80;

/// What the words of a row need beside its bytes.
#[derive(Clone, Copy)]
pub(super) struct Line<'a> {
    pub(super) experiment: &'a Experiment,
    /// The controller that hears the line.
    pub(super) own: &'a Config,
}

impl Line<'_> {
    /// What a row is: `packet`, `frame`, `reply` or `collision`.
    pub(super) fn kind(self, bytes: &[u8], verdict: RowOutcome) -> &'static str {
        match verdict {
            RowOutcome::Collision => "collision",
            RowOutcome::Reply(_) => "reply",
            _ if self.own.protocol() == Protocol::Raw => "packet",
            _ if head(bytes, verdict).is_some_and(|(_, kind)| kind & REPLY != 0) => "reply",
            _ => "frame",
        }
    }

    /// Address that a row goes to or comes from, where its bytes have one that can be trusted.
    pub(super) fn address(self, bytes: &[u8], verdict: RowOutcome) -> Option<u8> {
        match (self.own.protocol(), verdict) {
            (_, RowOutcome::Reply(reply)) => Some(reply.address),
            (Protocol::Raw, RowOutcome::Packet(_)) => {
                self.own.packet_address().and_then(|_| bytes.first().copied())
            }
            (Protocol::Raw, _) => None,
            (Protocol::Framed, _) => head(bytes, verdict).map(|(address, _)| address),
        }
    }

    /// Adds the bytes of a row in words, as far as they are known to mean something.
    pub(super) fn fields(self, bytes: &[u8], verdict: RowOutcome, text: &mut String) {
        match verdict {
            RowOutcome::Packet(_) => packet_in_words(bytes, self.own.packet_address().is_some(), text),
            RowOutcome::Reply(reply) => {
                let _ = write!(text, "from {}: {reply}", reply.address);
            }
            RowOutcome::Frame(_) => {
                let mut deframer = Deframer::default();
                for &byte in bytes {
                    if let Some(Deframed::Frame(frame)) = deframer.byte(byte) {
                        return self.frame_in_words(frame, text);
                    }
                }
            }
            _ => {}
        }
    }

    /// Channels of the controller with an address; of the one that hears the line where there is none.
    pub(super) fn channels(self, address: u8) -> u8 {
        let known = self.experiment.configs().find(|config| config.address() == Some(address));
        known.unwrap_or(self.own).channels()
    }

    /// A frame whose check holds.
    fn frame_in_words(self, frame: Frame<'_>, text: &mut String) {
        if frame.kind & REPLY != 0 {
            let _ = write!(text, "from {}: ", frame.address);
            let _ = match Reply::parse(frame) {
                Some(reply) => write!(text, "{reply}"),
                None => write!(text, "kind {:#04x}", frame.kind),
            };
            return;
        }
        to(frame.address, text);
        let Some(kind) = Kind::parse(frame.kind) else {
            let _ = write!(text, ": kind {:#04x}", frame.kind);
            return;
        };
        let _ = write!(text, ": {}", kind.name());
        let channels = self.channels(frame.address);
        let ticks = (kind == Kind::Ticks).then(|| Ticks::parse(frame.body, channels)).flatten();
        let Some(ticks) = ticks else { return };
        let mut totals = [0_i64; 256];
        for (place, &byte) in ticks.orders().iter().enumerate() {
            totals[place % usize::from(channels.max(1))] += steps(byte);
        }
        let many = if ticks.count() == 1 { "tick" } else { "ticks" };
        let _ = write!(text, " seq {}, {} {many}, ", ticks.seq, ticks.count());
        joined(totals.into_iter().enumerate(), text);
    }
}

/// Address and kind of a frame, where its check holds.
pub(super) fn head(bytes: &[u8], verdict: RowOutcome) -> Option<(u8, u8)> {
    let fate = match verdict {
        RowOutcome::Frame(fate) => fate,
        RowOutcome::Reply(reply) => {
            let kind = reply.answer.map_or(u8::MAX, |kind| kind as u8 | REPLY);
            return Some((reply.address, kind));
        }
        _ => return None,
    };
    if matches!(fate, FrameOutcome::Short | FrameOutcome::BadCheck { .. } | FrameOutcome::Overlong) {
        return None;
    }
    // The row ends with the frame's end mark; what stands before an earlier one is no part of it.
    let (_, whole) = bytes.split_last()?;
    let first = whole.iter().rposition(|&byte| byte == 0).map_or(0, |mark| mark + 1);
    let &[code, a, b, ..] = whole.get(first..)? else { return None };
    // Each zero stands as COBS's distance to the next one.
    Some(match (code, a) {
        (1, 1) => (0, 0),
        (1, _) => (0, b),
        (2, _) => (a, 0),
        _ => (a, b),
    })
}

/// What became of a row, in full.
pub(super) fn outcome(verdict: RowOutcome) -> String {
    match verdict {
        RowOutcome::Reply(Reply { answer: Ok(_), .. }) => "acknowledged".to_owned(),
        RowOutcome::Reply(Reply { answer: Err(reason), .. }) => format!("refused: {}", reason.name()),
        verdict => verdict.to_string(),
    }
}

/// What became of a row, for a narrow column: a cross for what was not done, and the name of the reason.
pub(super) fn short(verdict: RowOutcome) -> String {
    match verdict {
        RowOutcome::Frame(FrameOutcome::Repeated) => "\u{21bb} repeated".to_owned(),
        RowOutcome::Frame(FrameOutcome::BadCheck { .. }) => "\u{2715} CRC".to_owned(),
        RowOutcome::Packet(PacketOutcome::Booting) => "\u{2715} self-test".to_owned(),
        RowOutcome::Ignored => "\u{2715} ignored".to_owned(),
        RowOutcome::Collision => "\u{2715} collision".to_owned(),
        RowOutcome::Open => "\u{2715} not complete".to_owned(),
        verdict => {
            let full = outcome(verdict);
            match full.strip_prefix("dropped: ").or_else(|| full.strip_prefix("refused: ")) {
                Some(reason) => format!("\u{2715} {reason}"),
                None => full,
            }
        }
    }
}

/// `good`, `foreign` (not for this controller, or from another), `repeated` or `bad`.
pub(super) const fn mark(verdict: RowOutcome) -> &'static str {
    match verdict {
        RowOutcome::Packet(PacketOutcome::Queued)
        | RowOutcome::Frame(FrameOutcome::Queued(_) | FrameOutcome::Taken(_))
        | RowOutcome::Reply(Reply { answer: Ok(_), .. }) => "good",
        RowOutcome::Packet(PacketOutcome::OtherAddress) | RowOutcome::Frame(FrameOutcome::OtherAddress) => {
            "foreign"
        }
        RowOutcome::Frame(FrameOutcome::Repeated) => "repeated",
        _ => "bad",
    }
}

/// Bytes in hex, two digits each, with a space between.
pub(super) fn hex(bytes: &[u8], text: &mut String) {
    for (index, byte) in bytes.iter().enumerate() {
        let _ = write!(text, "{}{byte:02x}", if index == 0 { "" } else { " " });
    }
}

/// What the bytes of one tick order.
pub(super) fn steps_in_words(orders: impl Iterator<Item = u8>, text: &mut String) {
    joined(orders.map(steps).enumerate(), text);
}

fn to(address: u8, text: &mut String) {
    let _ = if address == ALL { write!(text, "to all") } else { write!(text, "to {address}") };
}

/// A whole raw packet.
fn packet_in_words(bytes: &[u8], addressed: bool, text: &mut String) {
    match bytes.split_first() {
        Some((&address, orders)) if addressed => {
            to(address, text);
            text.push_str(", ");
            steps_in_words(orders.iter().copied(), text);
        }
        _ => steps_in_words(bytes.iter().copied(), text),
    }
}

fn steps(byte: u8) -> i64 {
    let ChannelCommand { right, steps } = ChannelCommand::parse(byte);
    if right { i64::from(steps) } else { -i64::from(steps) }
}

/// Channels with their steps, such as `ch0 +12, ch3 −1`.
fn joined(steps: impl Iterator<Item = (usize, i64)>, text: &mut String) {
    let before = text.len();
    for (channel, steps) in steps.filter(|(_, steps)| *steps != 0) {
        let between = if text.len() == before { "" } else { ", " };
        let sign = if steps < 0 { '\u{2212}' } else { '+' };
        let _ = write!(text, "{between}ch{channel} {sign}{}", steps.abs());
    }
    if text.len() == before {
        text.push_str("no steps");
    }
}

/// Times of one column: one unit and one number of digits, so that they can be compared at a glance.
#[derive(Clone, Copy)]
pub(super) struct Scale {
    pub(super) unit: &'static str,
    /// Smallest step that is printed: so many of them are a second.
    per_s: u64,
    digits: usize,
    clock_hz: u64,
}

impl Scale {
    /// For a run of so many cycles.
    pub(super) fn of(cycles: u64, clock_hz: u32) -> Self {
        let clock_hz = u64::from(clock_hz.max(1));
        let (unit, per_s, digits) = match cycles / clock_hz {
            10.. => ("s", 100_000, 5),
            _ if cycles.saturating_mul(100) >= clock_hz => ("ms", 1_000_000, 3),
            _ => ("\u{b5}s", 100_000_000, 2),
        };
        Self { unit, per_s, digits, clock_hz }
    }

    /// Adds a time.
    pub(super) fn print(self, cycles: u64, text: &mut String) {
        let steps = u128::from(cycles) * u128::from(self.per_s) + u128::from(self.clock_hz / 2);
        let steps = steps / u128::from(self.clock_hz);
        let whole = 10_u128.pow(self.digits as u32);
        let _ = write!(text, "{}.{:0width$}", steps / whole, steps % whole, width = self.digits);
    }
}

/// Name of a kind byte, the same for a frame and the reply that acknowledges it; `NAK` for a refusal.
pub(super) fn name_of(kind: u8) -> Option<&'static str> {
    if kind == u8::MAX { Some("NAK") } else { Kind::parse(kind & !REPLY).map(Kind::name) }
}
