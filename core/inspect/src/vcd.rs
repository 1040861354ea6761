//! A trace as a Value Change Dump, which GTKWave, Surfer and PulseView open.
//!
//! Time is in ps: a cycle is rarely a whole number of anything coarser, and at up to 1 GHz no two
//! cycles fall together. A cycle c stands at floor(c*10^12/clock_hz).
//!
//! ```
//! use stepscope_inspect::vcd::VcdWriter;
//! use stepscope_sim::Experiment;
//!
//! let experiment = Experiment::from_json("{}").expect("the default motion");
//! let mut file = Vec::new();
//! let mut writer = VcdWriter::new(&mut file, experiment.config().clock_hz(), 1).expect("memory takes it");
//! let run = experiment.run(&mut writer);
//! writer.finish(run.cycles().0).expect("memory takes it");
//! assert!(file.starts_with(b"$timescale 1 ps $end"));
//! ```

use std::io;
use stepscope_peripheral::signal::{Levels, Record, Sink, name};
use stepscope_peripheral::trace::shown_signals;
use vcd::{IdCode, TimescaleUnit, Value, Writer};

/// Picoseconds of a second.
const PS: u128 = 1_000_000_000_000;

/// Writes records as they come. The first error ends the writing and is kept for
/// [`VcdWriter::finish`].
pub struct VcdWriter<W: io::Write> {
    out: Writer<W>,
    clock_hz: u128,
    /// Bit of the levels and the signal's code.
    signals: Vec<(u32, IdCode)>,
    levels: Option<Levels>,
    result: io::Result<()>,
}

impl<W: io::Write> VcdWriter<W> {
    /// Writes the head: the signals of `channels` channels and of the line, in one module.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn new(out: W, clock_hz: u32, channels: u8) -> io::Result<Self> {
        let mut out = Writer::new(out);
        out.timescale(1, TimescaleUnit::PS)?;
        out.add_module("stepscope")?;
        let mut signals = Vec::new();
        for bit in shown_signals(channels) {
            signals.push((bit, out.add_wire(1, &name(bit).unwrap_or_default())?));
        }
        out.upscope()?;
        out.enddefinitions()?;
        Ok(Self { out, clock_hz: u128::from(clock_hz.max(1)), signals, levels: None, result: Ok(()) })
    }

    /// Goes on with a file, of which `levels` have been written last: so it is made in pieces.
    ///
    /// # Errors
    /// Never: nothing is written yet.
    pub fn resume(out: W, clock_hz: u32, channels: u8, levels: Levels) -> io::Result<Self> {
        let VcdWriter { signals, clock_hz, .. } = VcdWriter::new(io::sink(), clock_hz, channels)?;
        Ok(Self { out: Writer::new(out), clock_hz, signals, levels: Some(levels), result: Ok(()) })
    }

    /// Ends a piece, after which the file goes on.
    ///
    /// # Errors
    /// The first error of the writer.
    pub fn pause(mut self) -> io::Result<()> {
        self.result?;
        self.out.flush()
    }

    /// Ends the file at cycle `end`, the first that was not run.
    ///
    /// # Errors
    /// The first error of the writer.
    pub fn finish(mut self, end: u64) -> io::Result<()> {
        let stamp = self.stamp(end);
        self.result?;
        self.out.timestamp(stamp)?;
        self.out.flush()
    }

    fn stamp(&self, cycle: u64) -> u64 {
        u64::try_from(u128::from(cycle) * PS / self.clock_hz).unwrap_or(u64::MAX)
    }

    fn write(&mut self, record: Record) -> io::Result<()> {
        self.out.timestamp(self.stamp(record.cycle.0))?;
        for &(bit, code) in &self.signals {
            let high = record.levels.has(1 << bit);
            if self.levels.is_none_or(|before| before.has(1 << bit) != high) {
                self.out.change_scalar(code, if high { Value::V1 } else { Value::V0 })?;
            }
        }
        self.levels = Some(record.levels);
        Ok(())
    }
}

impl<W: io::Write> Sink for VcdWriter<W> {
    fn record(&mut self, record: Record) {
        if self.result.is_ok() {
            self.result = self.write(record);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stepscope_peripheral::units::Instant;
    use vcd::{Command, Parser};

    #[test]
    fn a_file_in_pieces_is_the_file() {
        let records: Vec<Record> =
            (0..20).map(|i| Record { cycle: Instant(i * 3), levels: Levels(0x7_0000_0000 ^ i) }).collect();
        let mut whole = Vec::new();
        let mut writer = VcdWriter::new(&mut whole, 16_000_000, 3).expect("memory takes it");
        records.iter().for_each(|record| writer.record(*record));
        writer.finish(60).expect("memory takes it");
        let mut pieces = Vec::new();
        let mut writer = VcdWriter::new(&mut pieces, 16_000_000, 3).expect("memory takes it");
        for pair in records.windows(2) {
            writer.record(pair[0]);
            writer.pause().expect("memory takes it");
            writer = VcdWriter::resume(&mut pieces, 16_000_000, 3, pair[0].levels).expect("memory takes it");
        }
        writer.record(records[19]);
        writer.finish(60).expect("memory takes it");
        assert_eq!(pieces, whole);
    }

    #[test]
    fn a_parser_reads_back_every_change_at_its_time() {
        let records = [(0, 0x7_0000_0000), (5, 0x5_0000_0000), (16, 0x7_0001_0001), (17, 0x7_0001_0000)]
            .map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) });
        let mut text = Vec::new();
        let mut writer = VcdWriter::new(&mut text, 16_000_000, 1).expect("memory takes it");
        for record in records {
            writer.record(record);
        }
        writer.finish(20).expect("memory takes it");
        let mut parser = Parser::new(text.as_slice());
        let header = parser.parse_header().expect("a header");
        let code = |name| header.find_var(&["stepscope", name]).expect(name).code;
        let (step, rx) = (code("STEP0"), code("RX"));
        let (mut now, mut steps, mut line) = (0, Vec::new(), Vec::new());
        for command in parser {
            match command.expect("a command") {
                Command::Timestamp(at) => now = at,
                Command::ChangeScalar(id, value) if id == step => steps.push((now, value)),
                Command::ChangeScalar(id, value) if id == rx => line.push((now, value)),
                _ => {}
            }
        }
        assert_eq!(steps, [(0, Value::V0), (1_000_000, Value::V1), (1_062_500, Value::V0)]);
        assert_eq!(line, [(0, Value::V1), (312_500, Value::V0), (1_000_000, Value::V1)]);
        assert_eq!(now, 1_250_000, "the run's end");
    }
}
