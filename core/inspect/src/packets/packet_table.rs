//! The packet table: one row per packet, frame or reply that one controller received or sent, with its outcome
//! (DESIGN Part D).
//!
//! A reply of another controller looks like a frame; the host's schedule distinguishes them.

mod csv;
mod detail;
mod faults;
mod filter;
mod format;
mod line_bytes;

#[cfg(feature = "std")]
pub(crate) use csv::write_fields;
pub use detail::{Detail, FieldRow};
pub use faults::FirstFault;
pub use filter::{Filter, Request};
pub use format::{Mark, TimeScale};
pub use line_bytes::LineByte;

use crate::packets::dissector::{Dissection, Dissector, FrameHead, write_steps};
use crate::packets::log::{LoggedPacket, LoggedTick, PacketLog, RowOutcome};
use alloc::{string::String, vec::Vec};
use serde::Serialize;
use stepscope_peripheral::config::{Config, Protocol};
use stepscope_peripheral::{units::Instant, wire::BitTimes};
use stepscope_sim::{Experiment, Run};

/// What a row of the packet table is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    Packet,
    Frame,
    /// A reply of this or another controller.
    Reply,
    Collision,
}

impl RowKind {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Packet => "packet",
            Self::Frame => "frame",
            Self::Reply => "reply",
            Self::Collision => "collision",
        }
    }
}

/// A formatted row. Ranges of cycles do not include their end.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Row {
    pub index: usize,
    pub kind: &'static str,
    pub start_cycle: u64,
    pub end_cycle: u64,
    /// End of the last stop bit.
    pub line_end_cycle: u64,
    pub start: String,
    /// Time since the end of the row before; empty for the first.
    pub gap: String,
    pub hex: String,
    pub fields: String,
    pub outcome: String,
    /// The outcome for a narrow column.
    pub short: String,
    pub why: String,
    pub mark: &'static str,
    pub tick_start_cycle: Option<u64>,
    pub tick_end_cycle: Option<u64>,
}

/// A tick of the packet table.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TickRow {
    pub start_cycle: u64,
    pub end_cycle: u64,
    pub row: Option<usize>,
    pub fields: String,
}

/// Values that a filter can select.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Choices {
    pub addresses: Vec<u8>,
    pub kinds: Vec<&'static str>,
}

/// The packets of one controller as rows of text.
#[derive(Clone, Copy)]
pub struct PacketTable<'a> {
    experiment: &'a Experiment,
    run: &'a Run,
    config: &'a Config,
    log: &'a PacketLog,
}

impl<'a> PacketTable<'a> {
    /// The table of controller `controller`; `log` is its finished log. An unknown number selects the first controller.
    pub fn new(experiment: &'a Experiment, run: &'a Run, controller: usize, log: &'a PacketLog) -> Self {
        let config = experiment.configs().nth(controller).unwrap_or_else(|| experiment.config());
        Self { experiment, run, config, log }
    }

    pub fn len(&self) -> usize {
        self.log.rows().len()
    }

    pub fn is_empty(&self) -> bool {
        self.log.rows().is_empty()
    }

    pub fn bytes(&self, index: usize) -> &'a [u8] {
        self.log.bytes(index)
    }

    /// Unit and digits of the times of this table.
    pub fn scale(&self) -> TimeScale {
        TimeScale::of(self.run.cycles(), self.config.clock_hz())
    }

    pub fn kind(&self, index: usize) -> Option<RowKind> {
        let row = self.logged(index)?;
        Some(match row.outcome {
            RowOutcome::Collision => RowKind::Collision,
            RowOutcome::Reply(_) | RowOutcome::Recorded => RowKind::Reply,
            _ if self.config.protocol() == Protocol::Raw => RowKind::Packet,
            _ if self.is_of_another_controller(index, row) => RowKind::Reply,
            _ => RowKind::Frame,
        })
    }

    /// Whether another controller sent a row of a framed line: neither the host nor a forced level started it.
    fn is_of_another_controller(&self, index: usize, row: &LoggedPacket) -> bool {
        let first = self.log.start_bits(index).first().copied().unwrap_or(row.start);
        let is_of_host =
            self.run.schedule().last_at_or_before(first + self.config.bit()).is_some_and(|send| {
                let sent = self.host_times().bytes(send.bytes.len() as u64);
                first <= send.start + sent
            });
        if is_of_host {
            return false;
        }
        match self.head(index) {
            Some(head) => head.is_reply(),
            None => {
                let forced = self.run.forced();
                let forced = forced.get(..forced.partition_point(|forced| forced.start <= first));
                let is_forced =
                    forced.unwrap_or_default().iter().any(|forced| !forced.level && first < forced.end);
                self.experiment.controllers() > 1 && !is_forced
            }
        }
    }

    /// The row's address, if its bytes are valid.
    pub fn address(&self, index: usize) -> Option<u8> {
        match (self.config.protocol(), self.logged(index)?.outcome) {
            (Protocol::Raw, RowOutcome::Packet(_)) => {
                self.config.packet_address().and_then(|_| self.bytes(index).first().copied())
            }
            (Protocol::Raw, _) => None,
            (Protocol::Framed, _) => self.head(index).map(|head| head.address),
        }
    }

    pub fn row(&self, index: usize) -> Option<Row> {
        let logged = self.logged(index)?;
        let (mut start, mut gap) = (String::new(), String::new());
        self.scale().write(logged.start.0, &mut start);
        if let Some(cycles) = self.gap(index) {
            self.scale().write(cycles, &mut gap);
        }
        let (mut hex, mut fields) = (String::new(), String::new());
        format::write_hex(self.bytes(index), " ", &mut hex);
        self.write_summary(index, &mut fields);
        Some(Row {
            index,
            kind: self.kind(index)?.name(),
            start_cycle: logged.start.0,
            end_cycle: logged.end.0,
            line_end_cycle: self.line_end(index),
            start,
            gap,
            hex,
            fields,
            outcome: format::outcome(logged.outcome),
            short: format::short(logged.outcome),
            why: self.why(index),
            mark: Mark::of(logged.outcome).name(),
            tick_start_cycle: logged.tick_start.map(|at| at.0),
            tick_end_cycle: logged.tick_end.map(|at| at.0),
        })
    }

    /// Appends the bytes of row `index` in hexadecimal.
    pub fn write_hex(&self, index: usize, text: &mut String) {
        format::write_hex(self.bytes(index), " ", text);
    }

    pub fn dissect(&self, index: usize) -> Option<Dissection> {
        let outcome = self.logged(index)?.outcome;
        Some(self.dissector(&|address| self.channels(address)).dissect(self.bytes(index), outcome))
    }

    pub fn choices(&self) -> Choices {
        let (mut addresses, mut kinds) = ([false; 256], Vec::new());
        for index in 0..self.len() {
            if let Some(address) = self.address(index) {
                addresses[usize::from(address)] = true;
            }
            let name = self.head(index).and_then(FrameHead::name);
            for kind in [self.kind(index).map(RowKind::name), name].into_iter().flatten() {
                if !kinds.contains(&kind) {
                    kinds.push(kind);
                }
            }
        }
        Choices {
            addresses: (0..=u8::MAX).filter(|&address| addresses[usize::from(address)]).collect(),
            kinds,
        }
    }

    /// Rows on the line in the cycles `start..=end`.
    pub fn touching(&self, start: Instant, end: Instant) -> impl Iterator<Item = usize> + use<'a> {
        self.log.touching(start, end)
    }

    /// Whether row `index` is on the line in the cycles `start..=end`.
    pub fn is_on_line(&self, index: usize, start: Instant, end: Instant) -> bool {
        self.logged(index).is_some_and(|row| row.start <= end) && self.line_end(index) >= start.0
    }

    /// Ticks in the cycles `start..=end`, each with its row.
    pub fn ticks_touching(
        &self,
        start: Instant,
        end: Instant,
    ) -> impl ExactSizeIterator<Item = TickRow> + use<'a> {
        let (all, length, table) = (self.log.ticks(), self.config.tick(), *self);
        let first = all.partition_point(|tick| tick.start + length <= start);
        let until = all.partition_point(|tick| tick.start <= end).max(first);
        all.get(first..until).unwrap_or_default().iter().map(move |tick| table.tick(tick))
    }

    fn tick(&self, tick: &LoggedTick) -> TickRow {
        let mut fields = String::new();
        write_steps(tick.commands.iter().take(usize::from(self.config.channels())).copied(), &mut fields);
        TickRow {
            start_cycle: tick.start.0,
            end_cycle: self.log.tick_end(tick, self.config.tick()).0.min(self.run.cycles().0),
            row: tick.row,
            fields,
        }
    }

    pub(crate) fn config(&self) -> &'a Config {
        self.config
    }

    pub(crate) fn packets(&self) -> &'a PacketLog {
        self.log
    }

    fn logged(&self, index: usize) -> Option<&'a LoggedPacket> {
        self.log.rows().get(index)
    }

    fn head(&self, index: usize) -> Option<FrameHead> {
        FrameHead::of(self.bytes(index), self.logged(index)?.outcome)
    }

    fn write_summary(&self, index: usize, text: &mut String) {
        if let Some(row) = self.logged(index) {
            let channels = |address| self.channels(address);
            self.dissector(&channels).summary(self.bytes(index), row.outcome, text);
        }
    }

    fn dissector<'b>(&self, channels: &'b dyn Fn(u8) -> u8) -> Dissector<'b> {
        let addressed = self.config.packet_address().is_some();
        Dissector { protocol: self.config.protocol(), addressed, channels }
    }

    fn channels(&self, address: u8) -> u8 {
        let known = self.experiment.configs().find(|config| config.address() == Some(address));
        known.unwrap_or(self.config).channels()
    }

    fn host_times(&self) -> BitTimes {
        BitTimes::new(self.config.clock_hz(), self.experiment.baud())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::record_run;

    #[test]
    fn rows_have_their_bytes_and_kind() {
        let experiment = Experiment::from_json("{}").expect("it is valid");
        let (run, recordings) = record_run(&experiment, 1).expect("it is short");
        let table = PacketTable::new(&experiment, &run, 0, &recordings[0].packets);
        assert_eq!((table.len(), table.kind(0), table.bytes(0).len()), (200, Some(RowKind::Packet), 1));
        assert_eq!((table.row(200), table.kind(200)), (None, None));
    }
}
