//! Output files for stand-alone controllers: panel records, and tables and dumps with states and inputs.

use crate::{files::Output, output::Out};
use std::io::{self, Write};
use stepscope_core::{
    controller::CheckedSetup,
    inspect::export::{
        panel::{PANEL_HEAD, PanelSignals, write_panel_row},
        tables::{write_edges_head, write_edges_row},
        vcd::{Timescale, VcdWriter},
    },
    peripheral::{
        signal::{Event, Levels, Record, Sink},
        units::Instant,
    },
    sim::{Experiment, Run},
};

pub(crate) fn records(out: Out) -> Box<dyn Output> {
    Box::new(Records(out))
}

struct Records(Out);

impl Sink for Records {
    fn record(&mut self, _: Record) {}
}

impl Output for Records {
    fn finish(mut self: Box<Self>, experiment: &Experiment, run: &Run) -> io::Result<()> {
        self.0.write_all(PANEL_HEAD.as_bytes())?;
        let clock_hz = experiment.config().clock_hz();
        let mut text = String::new();
        for (index, panel) in run.stand_alone().iter().flat_map(|machine| machine.panels()).enumerate() {
            for record in panel {
                text.clear();
                write_panel_row(&mut text, index, *record, clock_hz).map_err(io::Error::other)?;
                self.0.write_all(text.as_bytes())?;
            }
        }
        self.0.flush()
    }
}

pub(crate) fn csv(
    mut out: Out,
    (clock_hz, channels): (u32, u8),
    panels: &CheckedSetup,
) -> io::Result<Box<dyn Output>> {
    let signals = PanelSignals::new(panels);
    let mut text = String::new();
    write_edges_head(&mut text, channels).map_err(io::Error::other)?;
    let names = signals.signals().iter().map(|signal| format!(",{}", signal.name));
    text = text.trim_end().to_owned() + &names.collect::<String>() + "\n";
    out.write_all(text.as_bytes())?;
    let row = Row { cycle: None, levels: Levels::RESET };
    Ok(Box::new(TableWriter { out, clock_hz, channels, signals, row, result: Ok(()) }))
}

/// The changes of one cycle; the row is written when the next cycle begins.
struct Row {
    cycle: Option<Instant>,
    levels: Levels,
}

struct TableWriter {
    out: Out,
    clock_hz: u32,
    channels: u8,
    signals: PanelSignals,
    row: Row,
    result: io::Result<()>,
}

impl TableWriter {
    fn begin_row(&mut self, cycle: Instant) {
        if self.row.cycle != Some(cycle) {
            self.end_row();
            self.row.cycle = Some(cycle);
        }
    }

    fn end_row(&mut self) {
        let Some(cycle) = self.row.cycle.take() else { return };
        if self.result.is_ok() {
            self.result = self.write(Record { cycle, levels: self.row.levels });
        }
    }

    fn write(&mut self, record: Record) -> io::Result<()> {
        let mut text = String::new();
        write_edges_row(&mut text, record, self.clock_hz, self.channels).map_err(io::Error::other)?;
        let values = self.signals.signals().iter().map(|signal| format!(",{}", signal.text()));
        self.out.write_all((text.trim_end().to_owned() + &values.collect::<String>() + "\n").as_bytes())
    }
}

impl Sink for TableWriter {
    fn record(&mut self, record: Record) {
        self.begin_row(record.cycle);
        self.row.levels = record.levels;
    }

    fn event(&mut self, at: Instant, event: Event) {
        if matches!(event, Event::Panel { .. } | Event::Input { .. }) {
            self.begin_row(at);
            self.signals.take(event);
        }
    }
}

impl Output for TableWriter {
    fn has_failed(&self) -> bool {
        self.result.is_err()
    }

    fn finish(mut self: Box<Self>, _: &Experiment, _: &Run) -> io::Result<()> {
        self.end_row();
        self.result.and_then(|()| self.out.flush())
    }
}

pub(crate) fn vcd(
    out: Out,
    timescale: Timescale,
    (clock_hz, channels): (u32, u8),
    panels: &CheckedSetup,
) -> io::Result<Box<dyn Output>> {
    let signals = PanelSignals::new(panels);
    let words = signals.signals().iter().map(|signal| (signal.name.as_str(), signal.bits));
    let mut writer = VcdWriter::with_signals(out, timescale, clock_hz, channels, &[], words)?;
    writer.words(0, signals.signals().iter().map(|signal| signal.value));
    Ok(Box::new(DumpWriter { writer, signals }))
}

struct DumpWriter {
    writer: VcdWriter<Out>,
    signals: PanelSignals,
}

impl Sink for DumpWriter {
    fn record(&mut self, record: Record) {
        self.writer.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        if self.signals.take(event) {
            self.writer.words(at.0, self.signals.signals().iter().map(|signal| signal.value));
        }
    }
}

impl Output for DumpWriter {
    fn has_failed(&self) -> bool {
        self.writer.has_failed()
    }

    fn finish(self: Box<Self>, _: &Experiment, run: &Run) -> io::Result<()> {
        self.writer.finish(run.cycles().0)
    }
}
