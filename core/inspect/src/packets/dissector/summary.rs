//! One-line summaries of packets, frames and replies.

use super::{Content, CrcCheck, Dissector, FrameHead, last_frame, position_to_text};
use crate::packets::log::RowOutcome;
use alloc::string::String;
use core::fmt::Write as _;
use stepscope_peripheral::protocol::{Kind, Reply};
use stepscope_peripheral::wire::frame::{Frame, Ticks};
use stepscope_peripheral::wire::packet::{ALL, ChannelCommand};

impl Dissector<'_> {
    /// Appends the address and the summary of a row to `text`.
    pub fn summary(&self, bytes: &[u8], outcome: RowOutcome, text: &mut String) {
        match outcome {
            RowOutcome::Packet(_) => match bytes.split_first() {
                Some((&address, commands)) if self.addressed => {
                    write_address(address, text);
                    text.push_str(", ");
                    write_steps(commands.iter().copied(), text);
                }
                _ => write_steps(bytes.iter().copied(), text),
            },
            RowOutcome::Reply(reply) => {
                let _ = write!(text, "from {}: {reply}", reply.address);
                // The event has no position counters; they are in the bytes.
                if reply.result == Ok(Kind::Positions) {
                    let content = Content::of(bytes, last_frame(bytes));
                    if let [address, kind, body @ ..] = content.without_crc(content.crc()) {
                        write_positions(Frame { address: *address, kind: *kind, body }, text);
                    }
                }
            }
            RowOutcome::Frame(_) => {
                let content = Content::of(bytes, last_frame(bytes));
                if let crc @ CrcCheck::Compared { found, expected } = content.crc()
                    && found == expected
                    && let [address, kind, body @ ..] = content.without_crc(crc)
                {
                    self.frame(Frame { address: *address, kind: *kind, body }, text);
                }
            }
            _ => {}
        }
    }

    fn frame(&self, frame: Frame<'_>, text: &mut String) {
        let head = FrameHead { address: frame.address, kind: frame.kind };
        if head.is_reply() {
            let _ = write!(text, "from {}: ", frame.address);
            let _ = match Reply::parse(frame) {
                Some(reply) => write!(text, "{reply}"),
                None => write!(text, "kind {:#04x}", frame.kind),
            };
            write_positions(frame, text);
            return;
        }
        write_address(frame.address, text);
        let Some(kind) = Kind::parse(frame.kind) else {
            let _ = write!(text, ": kind {:#04x}", frame.kind);
            return;
        };
        let _ = write!(text, ": {}", kind.name());
        let channels = (self.channels)(frame.address);
        let ticks = (kind == Kind::Ticks).then(|| Ticks::parse(frame.body, channels)).flatten();
        let Some(ticks) = ticks else { return };
        let mut totals = [0_i64; 256];
        for (index, &byte) in ticks.commands().iter().enumerate() {
            totals[index % usize::from(channels.max(1))] += steps(byte);
        }
        let unit = if ticks.count() == 1 { "tick" } else { "ticks" };
        let _ = write!(text, " seq {}, {} {unit}, ", ticks.seq, ticks.count());
        write_totals(totals.into_iter().enumerate(), text);
    }
}

fn write_positions(frame: Frame<'_>, text: &mut String) {
    let Some(positions) = frame.positions() else { return };
    for (channel, &counter) in positions.as_slice().iter().enumerate() {
        let _ = write!(text, ", ch{channel} at {}", position_to_text(counter));
    }
}

fn write_address(address: u8, text: &mut String) {
    let _ = if address == ALL { write!(text, "to all") } else { write!(text, "to {address}") };
}

fn steps(byte: u8) -> i64 {
    let ChannelCommand { right, steps } = ChannelCommand::parse(byte);
    if right { i64::from(steps) } else { -i64::from(steps) }
}

/// Appends the steps of one tick, one byte per channel, such as `ch0 +12, ch3 −1`.
pub fn write_steps(commands: impl Iterator<Item = u8>, text: &mut String) {
    write_totals(commands.map(steps).enumerate(), text);
}

fn write_totals(steps: impl Iterator<Item = (usize, i64)>, text: &mut String) {
    let before = text.len();
    for (channel, steps) in steps.filter(|(_, steps)| *steps != 0) {
        let separator = if text.len() == before { "" } else { ", " };
        let sign = if steps < 0 { '\u{2212}' } else { '+' };
        let _ = write!(text, "{separator}ch{channel} {sign}{}", steps.abs());
    }
    if text.len() == before {
        text.push_str("no steps");
    }
}
