//! What went over the line and what became of it, a row each, and the ticks that it brought; in words.

use crate::{
    convert::object,
    simulation::{Simulation, config},
};
use serde::Serialize;
use stepscope_core::{
    protocol::{FrameFate, Kind, Reply},
    scenario::{Config, Protocol},
    signal::Fate,
    trace::{LoggedPacket, LoggedTick, PacketLog, Verdict},
    units::Instant,
    wire::{
        frame::{Deframed, Deframer, Frame, Ticks},
        packet::{ALL, Order},
    },
};
use wasm_bindgen::prelude::*;

/// Set in the kind of a frame that is a reply (DESIGN A6).
const REPLY: u8 = 0x80;

#[derive(Serialize)]
struct Row {
    index: usize,
    /// `packet`, `frame`, `reply` or `collision`.
    kind: &'static str,
    start_cycle: u64,
    end_cycle: u64,
    hex: String,
    fields: String,
    outcome: String,
    /// `good`, `foreign` (not for this controller, or from another), `repeated` or `bad`.
    mark: &'static str,
    tick_start_cycle: Option<u64>,
    tick_end_cycle: Option<u64>,
}

#[derive(Serialize)]
struct Rows<T> {
    rows: Vec<T>,
    more: bool,
}

#[derive(Serialize)]
struct TickRow {
    start_cycle: u64,
    end_cycle: u64,
    /// Row that brought it.
    row: Option<usize>,
    fields: String,
}

#[wasm_bindgen]
impl Simulation {
    /// Rows `from..from + count` of the packets, frames and replies: `{total, rows}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packets(&self, from: u32, count: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Page {
            total: usize,
            rows: Vec<Row>,
        }
        let rows = (from as usize..).take(count as usize).map_while(|index| self.row(index));
        object(&Page { total: self.log().rows().len(), rows: rows.collect() })
    }

    /// The rows whose time on the line touches a stretch of cycles, none of them where there are more than `limit`:
    /// `{rows, more}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packets_in(&self, start_cycle: f64, end_cycle: f64, limit: u32) -> Result<JsValue, JsError> {
        let at = |cycle: f64| Instant(cycle.max(0.0) as u64);
        let limit = limit as usize;
        let touching: Vec<usize> =
            self.log().touching(at(start_cycle), at(end_cycle)).take(limit + 1).collect();
        let more = touching.len() > limit;
        let listed = if more { Vec::new() } else { touching };
        object(&Rows { rows: listed.into_iter().filter_map(|index| self.row(index)).collect(), more })
    }

    /// The ticks that touch a stretch of cycles, none of them where there are more than `limit`, each with the row that brought it:
    /// `{rows: [{start_cycle, end_cycle, row, fields}], more}`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn ticks_in(&self, start_cycle: f64, end_cycle: f64, limit: u32) -> Result<JsValue, JsError> {
        let (start, end) = (start_cycle.max(0.0) as u64, end_cycle.max(0.0) as u64);
        let config = config(&self.experiment, self.looked_at);
        let all = self.log().ticks();
        let first = all.partition_point(|tick| tick.start.0 + config.tick().0 <= start);
        let until = all.partition_point(|tick| tick.start.0 <= end).max(first);
        let touching = all.get(first..until).unwrap_or_default();
        let more = touching.len() > limit as usize;
        let listed = if more { &[] } else { touching };
        object(&Rows { rows: listed.iter().map(|tick| self.tick(tick, config)).collect(), more })
    }

    fn tick(&self, tick: &LoggedTick, config: &Config) -> TickRow {
        let end = tick.start + config.tick();
        let after = self.log().rows().partition_point(|row| row.end <= tick.start);
        let stopped = self
            .log()
            .rows()
            .iter()
            .skip(after)
            .take_while(|row| row.end < end)
            .find(|row| row.verdict == Verdict::Frame(FrameFate::Taken(Kind::Stop)));
        let orders = tick.orders.iter().take(usize::from(config.channels()));
        TickRow {
            start_cycle: tick.start.0,
            end_cycle: stopped.map_or(end, |row| row.end).0.min(self.run.cycles().0),
            row: tick.row,
            fields: steps_in_words(orders.copied().enumerate()),
        }
    }

    fn log(&self) -> &PacketLog {
        &self.looked_at().recording.packets
    }

    fn row(&self, index: usize) -> Option<Row> {
        let row = self.log().rows().get(index)?;
        let bytes = self.log().bytes(index);
        let hex: Vec<String> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        let (kind, fields) = self.fields(bytes, row);
        Some(Row {
            index,
            kind,
            start_cycle: row.start.0,
            end_cycle: row.end.0,
            hex: hex.join(" "),
            fields,
            outcome: match row.verdict {
                Verdict::Reply(Reply { answer: Ok(_), .. }) => "acknowledged".to_owned(),
                Verdict::Reply(Reply { answer: Err(reason), .. }) => format!("refused: {}", reason.name()),
                verdict => verdict.to_string(),
            },
            mark: mark(row.verdict),
            tick_start_cycle: row.tick_start.map(|at| at.0),
            tick_end_cycle: row.tick_end.map(|at| at.0),
        })
    }

    /// What a row is, and its bytes in words.
    fn fields(&self, bytes: &[u8], row: &LoggedPacket) -> (&'static str, String) {
        let config = config(&self.experiment, self.looked_at);
        match row.verdict {
            Verdict::Packet(_) => ("packet", packet_in_words(bytes, config.packet_address().is_some())),
            Verdict::Short | Verdict::Framing | Verdict::Ignored => ("packet", String::new()),
            Verdict::Open if config.protocol() == Protocol::Raw => ("packet", String::new()),
            Verdict::Open => ("frame", String::new()),
            Verdict::Collision => ("collision", String::new()),
            Verdict::Reply(reply) => ("reply", format!("from {}: {reply}", reply.address)),
            Verdict::Frame(_) => {
                let mut deframer = Deframer::default();
                let read = bytes.iter().find_map(|&byte| match deframer.byte(byte) {
                    Some(Deframed::Frame(frame)) => Some(self.frame_in_words(frame, config)),
                    _ => None,
                });
                read.unwrap_or(("frame", String::new()))
            }
        }
    }

    /// A frame whose check holds; `own` is the controller that hears it.
    fn frame_in_words(&self, frame: Frame<'_>, own: &Config) -> (&'static str, String) {
        if frame.kind & REPLY != 0 {
            let said = Reply::parse(frame)
                .map_or_else(|| format!("kind {:#04x}", frame.kind), |reply| reply.to_string());
            return ("reply", format!("from {}: {said}", frame.address));
        }
        let to = addressee(frame.address);
        let Some(kind) = Kind::parse(frame.kind) else {
            return ("frame", format!("{to}: kind {:#04x}", frame.kind));
        };
        let channels = self
            .experiment
            .configs()
            .find(|config| config.address() == Some(frame.address))
            .unwrap_or(own)
            .channels();
        let ticks = (kind == Kind::Ticks).then(|| Ticks::parse(frame.body, channels)).flatten();
        let Some(ticks) = ticks else { return ("frame", format!("{to}: {}", kind.name())) };
        let mut totals = vec![0_i64; usize::from(channels)];
        for tick in ticks.iter() {
            for (total, &byte) in totals.iter_mut().zip(&tick) {
                let Order { right, steps } = Order::parse(byte);
                *total += if right { i64::from(steps) } else { -i64::from(steps) };
            }
        }
        let many = match ticks.count() {
            1 => "1 tick".to_owned(),
            count => format!("{count} ticks"),
        };
        let steps = joined(totals.into_iter().enumerate().filter(|(_, total)| *total != 0));
        ("frame", format!("{to}: TICKS seq {}, {many}, {steps}", ticks.seq))
    }
}

const fn mark(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Packet(Fate::Queued)
        | Verdict::Frame(FrameFate::Queued(_) | FrameFate::Taken(_))
        | Verdict::Reply(Reply { answer: Ok(_), .. }) => "good",
        Verdict::Packet(Fate::Foreign) | Verdict::Frame(FrameFate::Foreign) => "foreign",
        Verdict::Frame(FrameFate::Repeated) => "repeated",
        _ => "bad",
    }
}

fn addressee(address: u8) -> String {
    if address == ALL { "to all".to_owned() } else { format!("to {address}") }
}

/// A whole raw packet.
fn packet_in_words(bytes: &[u8], addressed: bool) -> String {
    match bytes.split_first() {
        Some((&address, orders)) if addressed => {
            format!("{}, {}", addressee(address), steps_in_words(orders.iter().copied().enumerate()))
        }
        _ => steps_in_words(bytes.iter().copied().enumerate()),
    }
}

/// What the bytes of one tick order.
fn steps_in_words(orders: impl Iterator<Item = (usize, u8)>) -> String {
    joined(
        orders.map(|(channel, byte)| (channel, Order::parse(byte))).filter(|(_, order)| order.steps > 0).map(
            |(channel, Order { right, steps })| {
                (channel, if right { i64::from(steps) } else { -i64::from(steps) })
            },
        ),
    )
}

/// Channels with their steps, such as `ch0 +12, ch3 −1`.
fn joined(steps: impl Iterator<Item = (usize, i64)>) -> String {
    let words: Vec<String> = steps
        .map(|(channel, steps)| {
            let sign = if steps < 0 { '\u{2212}' } else { '+' };
            format!("ch{channel} {sign}{}", steps.abs())
        })
        .collect();
    if words.is_empty() { "no steps".to_owned() } else { words.join(", ") }
}
