//! What went over the line and what became of it, a row each, and the ticks that it brought; in words.

mod detail;
mod files;
mod filter;
mod words;

use crate::{
    convert::object,
    simulation::{Simulation, config},
};
pub(crate) use filter::Filter;
use filter::{Asked, Needle};
use serde::Serialize;
use stepscope_core::peripheral::{
    config::Config,
    trace::{LoggedTick, PacketLog},
    units::Instant,
};
use wasm_bindgen::prelude::*;
use words::{Line, Scale};

#[derive(Serialize)]
struct Row {
    index: usize,
    /// `packet`, `frame`, `reply` or `collision`.
    kind: &'static str,
    start_cycle: u64,
    end_cycle: u64,
    /// First cycle after its last byte on the line.
    line_end_cycle: u64,
    /// When it starts, in the table's unit.
    start: String,
    /// Time since the end of what was on the line before; empty for the first.
    gap: String,
    hex: String,
    fields: String,
    outcome: String,
    /// The outcome for a narrow column.
    short: String,
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
    /// What the table shows from now on; nothing is judged before `filter_on`. The text is looked for in
    /// bytes (as hex), words and numbers; `kind` is `packet`, `frame`, `reply`, `collision`, a kind of
    /// DESIGN A6 or `NAK`, and `mark` as in a row, both empty for any; `only` leaves out what the text does
    /// not find. What has to be said of the text comes back, empty for nothing.
    pub fn filter(&mut self, text: &str, kind: &str, address: Option<u8>, mark: &str, only: bool) -> String {
        let (needle, note) = Needle::parse(text);
        let all = needle.is_none() && kind.is_empty() && address.is_none() && mark.is_empty();
        let asked = Asked { needle, kind: kind.to_owned(), address, mark: mark.to_owned(), only };
        self.filter.ask((!all).then_some(asked));
        note
    }

    /// Judges up to `count` more rows: `{done, total, shown, matches}`, the numbers of all rows, of those on
    /// show and of those that the text finds, so far.
    ///
    /// # Errors
    /// Never in practice.
    pub fn filter_on(&mut self, count: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Judged {
            done: bool,
            total: usize,
            shown: usize,
            matches: usize,
        }
        let mut filter = std::mem::take(&mut self.filter);
        let done = filter.go_on(self.line(), self.scale(), self.log(), count as usize);
        let total = self.log().rows().len();
        let judged = Judged { done, total, shown: filter.shown(total), matches: filter.matches() };
        self.filter = filter;
        object(&judged)
    }

    /// The rows on show at positions `from..from + count`: `{total, shown, matches, unit, rows}`, a row
    /// with its `position` and, where the text finds it, its `rank` among the matches. Times are in `unit`.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packets(&self, from: u32, count: u32) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Placed {
            position: usize,
            rank: Option<usize>,
            #[serde(flatten)]
            row: Row,
        }
        #[derive(Serialize)]
        struct Page {
            total: usize,
            shown: usize,
            matches: usize,
            unit: &'static str,
            rows: Vec<Placed>,
        }
        let total = self.log().rows().len();
        let placed = |position| {
            let row = self.row(self.filter.row(position)?)?;
            Some(Placed { position, rank: self.filter.rank(position), row })
        };
        object(&Page {
            total,
            shown: self.filter.shown(total),
            matches: self.filter.matches(),
            unit: self.scale().unit,
            rows: (from as usize..).take(count as usize).map_while(placed).collect(),
        })
    }

    /// Where row `index` stands among those on show, if it is one of them.
    #[must_use]
    pub fn packet_position(&self, index: u32) -> Option<u32> {
        self.filter.position(index as usize).map(|position| position as u32)
    }

    /// Position of the next row after a position, or of the last before it, that the text finds; past the
    /// end it goes on at the beginning.
    #[must_use]
    pub fn next_match(&self, position: Option<u32>, forward: bool) -> Option<u32> {
        self.filter.next_match(position.map(|at| at as usize), forward).map(|at| at as u32)
    }

    /// What there is to choose from: `{addresses, kinds}`, rising, each of them on some row.
    ///
    /// # Errors
    /// Never in practice.
    pub fn packet_choices(&self) -> Result<JsValue, JsError> {
        #[derive(Serialize)]
        struct Choices {
            addresses: Vec<u8>,
            kinds: Vec<&'static str>,
        }
        let line = self.line();
        let (mut addresses, mut kinds) = ([false; 256], Vec::new());
        for (index, row) in self.log().rows().iter().enumerate() {
            let bytes = self.log().bytes(index);
            if let Some(address) = line.address(bytes, row.verdict) {
                addresses[usize::from(address)] = true;
            }
            let name = words::head(bytes, row.verdict).and_then(|(_, kind)| words::name_of(kind));
            for kind in [Some(line.kind(bytes, row.verdict)), name].into_iter().flatten() {
                if !kinds.contains(&kind) {
                    kinds.push(kind);
                }
            }
        }
        let addresses = (0..=u8::MAX).filter(|&address| addresses[usize::from(address)]).collect();
        object(&Choices { addresses, kinds })
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
        let mut fields = String::new();
        words::steps_in_words(tick.orders.iter().take(usize::from(config.channels())).copied(), &mut fields);
        TickRow {
            start_cycle: tick.start.0,
            end_cycle: self.log().tick_end(tick, config.tick()).0.min(self.run.cycles().0),
            row: tick.row,
            fields,
        }
    }

    fn log(&self) -> &PacketLog {
        &self.looked_at().recording.packets
    }

    fn line(&self) -> Line<'_> {
        Line { experiment: &self.experiment, own: config(&self.experiment, self.looked_at) }
    }

    fn scale(&self) -> Scale {
        Scale::of(self.run.cycles().0, self.experiment.config().clock_hz())
    }

    fn row(&self, index: usize) -> Option<Row> {
        let row = self.log().rows().get(index)?;
        let bytes = self.log().bytes(index);
        let (mut start, mut gap) = (String::new(), String::new());
        self.scale().print(row.start.0, &mut start);
        if let Some(cycles) = self.gap(index) {
            self.scale().print(cycles, &mut gap);
        }
        let (mut hex, mut fields) = (String::new(), String::new());
        words::hex(bytes, &mut hex);
        self.line().fields(bytes, row.verdict, &mut fields);
        Some(Row {
            index,
            kind: self.line().kind(bytes, row.verdict),
            start_cycle: row.start.0,
            end_cycle: row.end.0,
            line_end_cycle: self.line_end(index),
            start,
            gap,
            hex,
            fields,
            outcome: words::outcome(row.verdict),
            short: words::short(row.verdict),
            mark: words::mark(row.verdict),
            tick_start_cycle: row.tick_start.map(|at| at.0),
            tick_end_cycle: row.tick_end.map(|at| at.0),
        })
    }
}
