//! The packet table as CSV (RFC 4180).
//!
//! `start_cycle` to `kind` are in cycles, with bytes in hexadecimal; the columns after `number` are in s.
//! `LineScript::recorded` of the scenario crate reads this file.

use super::PacketTable;
use alloc::string::{String, ToString};
use core::fmt::{self, Write};
use stepscope_peripheral::units::Instant;

impl PacketTable<'_> {
    pub fn write_head(out: &mut impl Write) -> fmt::Result {
        out.write_str("start_cycle,end_cycle,bytes,outcome,tick_start_cycle,tick_end_cycle,kind,")?;
        out.write_str("number,start_s,end_s,gap_s,meaning,tick_start_s,tick_end_s\n")
    }

    pub fn write_row(&self, out: &mut impl Write, index: usize) -> fmt::Result {
        let (Some(row), Some(kind)) = (self.logged(index), self.kind(index)) else { return Ok(()) };
        write!(out, "{},{},", row.start.0, row.end.0)?;
        super::format::write_hex(self.bytes(index), "", out);
        write!(out, ",{}", Quoted(&row.outcome.to_string()))?;
        for at in [row.tick_start, row.tick_end] {
            out.write_char(',')?;
            at.map_or(Ok(()), |Instant(cycle)| write!(out, "{cycle}"))?;
        }
        let clock_hz = self.config.clock_hz();
        let seconds = |cycle: u64| Instant(cycle).seconds(clock_hz);
        let (start_s, end_s) = (seconds(row.start.0), seconds(self.line_end(index)));
        write!(out, ",{},{index},{start_s},{end_s},", kind.name())?;
        self.gap(index).map_or(Ok(()), |cycles| write!(out, "{}", seconds(cycles)))?;
        let mut meaning = String::new();
        self.write_summary(index, &mut meaning);
        write!(out, ",{}", Quoted(&meaning))?;
        for at in [row.tick_start, row.tick_end] {
            out.write_char(',')?;
            at.map_or(Ok(()), |at| write!(out, "{}", at.seconds(clock_hz)))?;
        }
        out.write_char('\n')
    }
}

struct Quoted<'a>(&'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.0.contains([',', '"', '\n', '\r']) {
            return f.write_str(self.0);
        }
        write!(f, "\"{}\"", self.0.replace('"', "\"\""))
    }
}

#[cfg(feature = "std")]
pub(crate) fn write_fields(out: &mut impl Write, texts: &[&str]) -> fmt::Result {
    texts.iter().try_for_each(|text| write!(out, ",{}", Quoted(text)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::StoredRun;
    use alloc::vec::Vec;
    use stepscope_sim::Experiment;

    #[test]
    fn packets_are_csv_rows_with_quotes_only_where_required() {
        let json = r#"{"bus":{"channels":2},"source":{"packets":{"packets":["8a05"]}}}"#;
        let experiment = Experiment::from_json(json).expect("runs");
        let mut recording = StoredRun::default();
        let run = experiment.run(&mut recording);
        recording.packets.finish();
        let table = PacketTable::new(&experiment, &run, 0, &recording.packets);
        let mut text = String::new();
        PacketTable::write_head(&mut text).expect("a string takes it");
        (0..2).for_each(|index| table.write_row(&mut text, index).expect("a string takes it"));
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(rows.len(), 2, "{text}");
        let end = rows[1].strip_prefix("1601,4309,8a05,queued,4310,36310,packet,0,").expect(rows[1]);
        assert_eq!(end, "0.0001000625,0.0002735625,,\"ch0 +10, ch1 \u{2212}5\",0.000269375,0.002269375");
        for (given, written) in [("a b", "a b"), ("a,b", "\"a,b\""), ("a\"", "\"a\"\"\""), ("a\n", "\"a\n\"")]
        {
            assert_eq!(Quoted(given).to_string(), written);
        }
    }
}
