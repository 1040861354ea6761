//! A trace as a Value Change Dump for GTKWave, Surfer and PulseView.
//!
//! Cycle c is at c*10^9/clock_hz ns, rounded half up; the clock is in a comment at the head, so that `cycle =
//! round(t*clock_hz)` restores it exactly.

use std::{fmt, io, str::FromStr};
use stepscope_peripheral::signal::{Levels, Record, Sink, name};
use stepscope_peripheral::trace::shown_signals;
use vcd::{IdCode, TimescaleUnit, Value, VarType, Writer};

const FEMTOS: u64 = 1_000_000_000_000_000;

const UNITS: [(TimescaleUnit, &str, u64); 6] = [
    (TimescaleUnit::S, "s", FEMTOS),
    (TimescaleUnit::MS, "ms", FEMTOS / 1_000),
    (TimescaleUnit::US, "us", 1_000_000_000),
    (TimescaleUnit::NS, "ns", 1_000_000),
    (TimescaleUnit::PS, "ps", 1_000),
    (TimescaleUnit::FS, "fs", 1),
];

/// The unit of a dump's times: 1, 10 or 100 of s, ms, us, ns, ps or fs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timescale {
    count: u32,
    unit: usize,
}

impl Default for Timescale {
    fn default() -> Self {
        Self { count: 1, unit: 3 }
    }
}

impl Timescale {
    fn parts(self) -> (TimescaleUnit, &'static str, u64) {
        let [.., last] = UNITS;
        UNITS.get(self.unit).copied().unwrap_or(last)
    }

    fn all() -> impl Iterator<Item = Self> {
        (0..UNITS.len()).flat_map(|unit| [100, 10, 1].map(|count| Self { count, unit }))
    }

    fn femtos(self) -> u64 {
        self.parts().2 * u64::from(self.count)
    }

    /// Fails if two cycles of the clock could share a time.
    pub fn of_clock(self, clock_hz: u32) -> Result<Self, TooCoarse> {
        let fits =
            |scale: &Self| u128::from(scale.femtos()) * u128::from(clock_hz.max(1)) <= u128::from(FEMTOS);
        let coarsest = Self::all().find(fits).unwrap_or_default();
        if fits(&self) { Ok(self) } else { Err(TooCoarse { given: self, clock_hz, coarsest }) }
    }
}

impl fmt::Display for Timescale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.count, self.parts().1)
    }
}

impl FromStr for Timescale {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let joined =
            |scale: &Self| text.split_whitespace().collect::<String>() == scale.to_string().replace(' ', "");
        Self::all()
            .find(joined)
            .ok_or("unknown timescale; use 1, 10 or 100 of s, ms, us, ns, ps or fs, such as 10ns")
    }
}

/// Edges of two cycles could share a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooCoarse {
    pub given: Timescale,
    pub clock_hz: u32,
    pub coarsest: Timescale,
}

impl fmt::Display for TooCoarse {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { given, clock_hz, coarsest } = self;
        write!(
            f,
            "a timescale of {given} is longer than a cycle of {clock_hz} Hz, so edges of two cycles could share a time; use at most {coarsest}"
        )
    }
}

impl std::error::Error for TooCoarse {}

/// Writes records as they come. Reports the first error in [`VcdWriter::finish`].
pub struct VcdWriter<W: io::Write> {
    out: Writer<W>,
    timescale: Timescale,
    clock_hz: u32,
    signals: Vec<(u32, IdCode)>,
    levels: Option<Levels>,
    reals: Vec<(IdCode, Option<u64>)>,
    words: Vec<(IdCode, u32, Option<u64>)>,
    stamped: Option<u64>,
    result: io::Result<()>,
}

impl<W: io::Write> VcdWriter<W> {
    /// A dump in ns: the signals of `channels` channels and of the line.
    pub fn new(out: W, clock_hz: u32, channels: u8) -> io::Result<Self> {
        Self::with_signals(out, Timescale::default(), clock_hz, channels, &[], [])
    }

    /// A dump with additional real variables and signals (name, bits). Fails with [`TooCoarse`].
    pub fn with_signals<'n>(
        out: W,
        timescale: Timescale,
        clock_hz: u32,
        channels: u8,
        names: &[String],
        words: impl IntoIterator<Item = (&'n str, u32)>,
    ) -> io::Result<Self> {
        let clock_hz = clock_hz.max(1);
        let timescale = timescale
            .of_clock(clock_hz)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error))?;
        let mut out = Writer::new(out);
        out.timescale(timescale.count, timescale.parts().0)?;
        out.comment(&format!("clock {clock_hz} Hz; cycle = round(t*clock)"))?;
        out.add_module("stepscope")?;
        let mut signals = Vec::new();
        for bit in shown_signals(channels) {
            signals.push((bit, out.add_wire(1, &name(bit).unwrap_or_default())?));
        }
        let mut reals = Vec::new();
        for name in names {
            reals.push((out.add_var(VarType::Real, 64, name, None)?, None));
        }
        let words = words.into_iter().map(|(name, bits)| Ok((out.add_wire(bits, name)?, bits, None)));
        let words = words.collect::<io::Result<_>>()?;
        out.upscope()?;
        out.enddefinitions()?;
        Ok(Self { reals, words, ..Self::empty(out, timescale, clock_hz, signals) })
    }

    fn empty(out: Writer<W>, timescale: Timescale, clock_hz: u32, signals: Vec<(u32, IdCode)>) -> Self {
        let (reals, words) = (Vec::new(), Vec::new());
        Self { out, timescale, clock_hz, signals, levels: None, reals, words, stamped: None, result: Ok(()) }
    }

    /// Continues a file in ns after `levels`, so that it can be written in pieces.
    pub fn resume(out: W, clock_hz: u32, channels: u8, levels: Levels) -> io::Result<Self> {
        let VcdWriter { signals, timescale, clock_hz, .. } = VcdWriter::new(io::sink(), clock_hz, channels)?;
        Ok(Self { levels: Some(levels), ..Self::empty(Writer::new(out), timescale, clock_hz, signals) })
    }

    /// Ends one piece of a file; [`Self::resume`] begins the next.
    pub fn pause(mut self) -> io::Result<()> {
        self.result?;
        self.out.flush()
    }

    /// Ends the file at cycle `end`; fails with the first error of all writes.
    pub fn finish(mut self, end: u64) -> io::Result<()> {
        let stamp = self.stamp(end);
        self.result?;
        self.out.timestamp(stamp?)?;
        self.out.flush()
    }

    /// Whether a write has failed, so that the run can be aborted.
    pub const fn has_failed(&self) -> bool {
        self.result.is_err()
    }

    /// Cycles never share a time, because the unit is not longer than a cycle.
    fn stamp(&self, cycle: u64) -> io::Result<u64> {
        let unit = u128::from(self.clock_hz) * u128::from(self.timescale.femtos());
        let stamp = (u128::from(cycle) * u128::from(FEMTOS) * 2 + unit) / (2 * unit);
        u64::try_from(stamp).map_err(|_| {
            let (scale, clock_hz) = (self.timescale, self.clock_hz);
            io::Error::other(format!(
                "cycle {cycle} of a clock of {clock_hz} Hz exceeds 2^64 times {scale}; use a coarser timescale"
            ))
        })
    }

    fn time(&mut self, cycle: u64) -> io::Result<()> {
        let stamp = self.stamp(cycle)?;
        if self.stamped.replace(stamp) != Some(stamp) {
            self.out.timestamp(stamp)?;
        }
        Ok(())
    }

    /// Writes the real variables, in the order of their names; cycles rise across all writes.
    pub fn analog(&mut self, cycle: u64, values: &[f64]) {
        if self.result.is_ok() {
            self.result = self.write_analog(cycle, values);
        }
    }

    fn write_analog(&mut self, cycle: u64, values: &[f64]) -> io::Result<()> {
        self.time(cycle)?;
        for (&value, (code, before)) in values.iter().zip(&mut self.reals) {
            if before.replace(value.to_bits()) != Some(value.to_bits()) {
                self.out.change_real(*code, value)?;
            }
        }
        Ok(())
    }

    /// Writes the additional signals, in the order of their names; cycles rise across all writes.
    pub fn words(&mut self, cycle: u64, values: impl IntoIterator<Item = u64>) {
        if self.result.is_ok() {
            self.result = self.write_words(cycle, values);
        }
    }

    fn write_words(&mut self, cycle: u64, values: impl IntoIterator<Item = u64>) -> io::Result<()> {
        self.time(cycle)?;
        for (value, (code, bits, before)) in values.into_iter().zip(&mut self.words) {
            if before.replace(value) == Some(value) {
                continue;
            }
            let bit = |shift: u32| if value >> shift & 1 == 1 { Value::V1 } else { Value::V0 };
            if *bits == 1 {
                self.out.change_scalar(*code, bit(0))?;
            } else {
                self.out.change_vector(*code, (0..*bits).rev().map(bit))?;
            }
        }
        Ok(())
    }

    fn write(&mut self, record: Record) -> io::Result<()> {
        self.time(record.cycle.0)?;
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
    fn a_file_written_in_pieces_equals_one_written_at_once() {
        let records: Vec<Record> =
            (0..20).map(|i| Record { cycle: Instant(i * 3), levels: Levels(0x7_0000_0000 ^ i) }).collect();
        let mut expected = Vec::new();
        let mut writer = VcdWriter::new(&mut expected, 16_000_000, 3).expect("memory takes it");
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
        assert_eq!(pieces, expected);
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
        // 5 cycles are 312.5 ns, 17 are 1062.5 ns: half up.
        assert_eq!(steps, [(0, Value::V0), (1_000, Value::V1), (1_063, Value::V0)]);
        assert_eq!(line, [(0, Value::V1), (313, Value::V0), (1_000, Value::V1)]);
        assert_eq!(now, 1_250, "the run's end");
    }

    fn stamps(scale: &str, clock_hz: u32, cycles: &[u64]) -> Vec<u64> {
        let scale = scale.parse().expect("a timescale");
        let writer =
            VcdWriter::with_signals(io::sink(), scale, clock_hz, 1, &[], []).expect("it fits the clock");
        cycles.iter().map(|cycle| writer.stamp(*cycle).expect("it is early enough")).collect()
    }

    #[test]
    fn cycles_are_restored_exactly_from_their_times() {
        for (scale, clock_hz) in [
            ("1 ns", 1_000_000_000),
            ("1 ns", 999_999_999),
            ("1 ns", 14_745_600),
            ("1 ns", 11),
            ("10 ns", 16_000_000),
            ("10 ns", 99_999_999),
            ("1 ps", 16_000_000),
            ("100 us", 10_000),
        ] {
            let femtos = u128::from(scale.parse::<Timescale>().expect("a timescale").femtos());
            let cycles: Vec<u64> = (0..1000).chain(123_456_789..123_457_789).collect();
            for (cycle, stamp) in cycles.iter().zip(stamps(scale, clock_hz, &cycles)) {
                let twice = u128::from(stamp) * femtos * u128::from(clock_hz) * 2;
                let back = (twice + u128::from(FEMTOS)) / (2 * u128::from(FEMTOS));
                assert_eq!(back, u128::from(*cycle), "{scale} at {clock_hz} Hz");
            }
        }
    }

    #[test]
    fn timescales_are_parsed_and_too_coarse_ones_rejected() {
        for (given, expected) in [
            ("1ns", Some("1 ns")),
            ("100 us", Some("100 us")),
            (" 10  ps ", Some("10 ps")),
            ("1 s", Some("1 s")),
            ("2 ns", None),
            ("ns", None),
            ("1000 ns", None),
            ("1 Ns", None),
            ("", None),
        ] {
            let found = given.parse::<Timescale>().ok().map(|scale| scale.to_string());
            assert_eq!(found.as_deref(), expected, "{given}");
        }
        let scaled = |scale: &str, clock_hz| {
            let scale: Timescale = scale.parse().expect("a timescale");
            scale.of_clock(clock_hz).map_err(|error| error.to_string())
        };
        assert!(scaled("10 ns", 100_000_000).is_ok() && scaled("10 ns", 100_000_001).is_err());
        assert_eq!(
            scaled("1us", 16_000_000),
            Err("a timescale of 1 us is longer than a cycle of 16000000 Hz, so edges of two cycles could share a time; use at most 10 ns".into())
        );
        let late =
            VcdWriter::new(io::sink(), 11, 1).expect("it fits the clock").finish(9_000_000_000_000_000);
        assert!(late.is_err_and(|error| error.to_string().contains("use a coarser timescale")));
    }

    #[test]
    fn a_dump_of_a_run_has_its_edges() {
        use crate::export::vcd::VcdWriter;
        use stepscope_sim::Experiment;

        let experiment = Experiment::from_json("{}").expect("the default motion");
        let mut file = Vec::new();
        let mut writer =
            VcdWriter::new(&mut file, experiment.config().clock_hz(), 1).expect("memory takes it");
        let run = experiment.run(&mut writer);
        writer.finish(run.cycles().0).expect("memory takes it");
        let head = "$timescale 1 ns $end\n$comment\n    clock 16000000 Hz; cycle = round(t*clock)\n$end\n";
        assert!(file.starts_with(head.as_bytes()));
    }
}
