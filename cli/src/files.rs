//! Files that `stepscope run` writes during the run.

use crate::output::Out;
use std::io::{self, Write};
use std::path::PathBuf;
use stepscope_core::{
    inspect::{
        export::{
            tables::{write_edges_head, write_edges_row},
            vcd::{Timescale, VcdWriter},
        },
        packets::{log::PacketLog, packet_table::PacketTable},
        trace::{fingerprint::Fingerprinter, timing::TimingCheck},
    },
    peripheral::{
        signal::{Event, Record, Sink},
        trace::{self, Digest},
        units::Instant,
    },
    sim::{Experiment, Run},
};

/// A sink that writes a file during the run and completes it afterwards.
pub(crate) trait Output: Sink {
    fn has_failed(&self) -> bool {
        false
    }

    /// Writes what remains; returns the first error of the file.
    fn finish(self: Box<Self>, experiment: &Experiment, run: &Run) -> io::Result<()>;
}

struct RecordWriter<F> {
    out: Out,
    write_record: F,
    result: io::Result<()>,
}

impl<F: FnMut(&mut Out, Record) -> io::Result<()>> Sink for RecordWriter<F> {
    fn record(&mut self, record: Record) {
        if self.result.is_ok() {
            self.result = (self.write_record)(&mut self.out, record);
        }
    }
}

impl<F: FnMut(&mut Out, Record) -> io::Result<()>> Output for RecordWriter<F> {
    fn has_failed(&self) -> bool {
        self.result.is_err()
    }

    fn finish(mut self: Box<Self>, _: &Experiment, _: &Run) -> io::Result<()> {
        self.result.and_then(|()| self.out.flush())
    }
}

pub(crate) fn trace(out: Out) -> Box<dyn Output> {
    let mut text = String::new();
    let write_record = move |out: &mut Out, record| {
        text.clear();
        trace::write_record(&mut text, record).map_err(io::Error::other)?;
        out.write_all(text.as_bytes())
    };
    Box::new(RecordWriter { out, write_record, result: Ok(()) })
}

pub(crate) fn csv(mut out: Out, clock_hz: u32, channels: u8) -> io::Result<Box<dyn Output>> {
    let mut text = String::new();
    write_edges_head(&mut text, channels).map_err(io::Error::other)?;
    out.write_all(text.as_bytes())?;
    let write_record = move |out: &mut Out, record: Record| {
        text.clear();
        write_edges_row(&mut text, record, clock_hz, channels).map_err(io::Error::other)?;
        out.write_all(text.as_bytes())
    };
    Ok(Box::new(RecordWriter { out, write_record, result: Ok(()) }))
}

pub(crate) fn vcd(
    out: Out,
    timescale: Timescale,
    clock_hz: u32,
    channels: u8,
) -> io::Result<Box<dyn Output>> {
    Ok(Box::new(VcdWriter::with_signals(out, timescale, clock_hz, channels, &[], [])?))
}

impl Output for VcdWriter<Out> {
    fn has_failed(&self) -> bool {
        VcdWriter::has_failed(self)
    }

    fn finish(self: Box<Self>, _: &Experiment, run: &Run) -> io::Result<()> {
        VcdWriter::finish(*self, run.cycles().0)
    }
}

pub(crate) fn packets(out: Out, controller: usize) -> Box<dyn Output> {
    Box::new(Packets { out, controller, log: PacketLog::default() })
}

/// Written at the end, when every packet's outcome is known.
struct Packets {
    out: Out,
    controller: usize,
    log: PacketLog,
}

impl Sink for Packets {
    fn record(&mut self, _: Record) {}

    fn event(&mut self, at: Instant, event: Event) {
        self.log.event(at, event);
    }
}

impl Output for Packets {
    fn finish(mut self: Box<Self>, experiment: &Experiment, run: &Run) -> io::Result<()> {
        self.log.finish();
        let table = PacketTable::new(experiment, run, self.controller, &self.log);
        let mut text = String::new();
        PacketTable::write_head(&mut text).map_err(io::Error::other)?;
        for index in 0..table.len() {
            table.write_row(&mut text, index).map_err(io::Error::other)?;
            self.out.write_all(text.as_bytes())?;
            text.clear();
        }
        self.out.write_all(text.as_bytes())?;
        self.out.flush()
    }
}

pub(crate) type Files = Vec<(PathBuf, Box<dyn Output>)>;

#[derive(Default)]
pub(crate) struct ControllerOutputs {
    pub(crate) digest: Digest,
    pub(crate) fingerprint: Option<Fingerprinter>,
    pub(crate) files: Files,
    pub(crate) timing: Option<TimingCheck>,
}

impl ControllerOutputs {
    pub(crate) fn has_failed(&self) -> bool {
        self.files.iter().any(|(_, file)| file.has_failed())
    }
}

impl Sink for ControllerOutputs {
    fn record(&mut self, record: Record) {
        self.digest.record(record);
        self.fingerprint.record(record);
        for (_, file) in &mut self.files {
            file.record(record);
        }
        self.timing.record(record);
    }

    fn event(&mut self, at: Instant, event: Event) {
        for (_, file) in &mut self.files {
            file.event(at, event);
        }
        self.timing.event(at, event);
    }
}
