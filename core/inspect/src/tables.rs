//! A run as tables: a row for each record of the signals, a row for each packet. CSV as in RFC 4180,
//! with a line feed at the end of a row.

use alloc::string::ToString;
use core::fmt::{self, Write};
use stepscope_peripheral::trace::{PacketLog, shown_signals};
use stepscope_peripheral::{
    signal::{self, Record},
    units::Instant,
};

/// Names of the columns of [`write_edges_row`]: the cycle, its time in s, and the signals of `channels`
/// channels and of the line.
///
/// # Errors
/// Those of the writer.
pub fn write_edges_head(out: &mut impl Write, channels: u8) -> fmt::Result {
    out.write_str("cycle,time_s")?;
    for bit in shown_signals(channels) {
        write!(out, ",{}", signal::name(bit).unwrap_or_default())?;
    }
    out.write_char('\n')
}

/// A record as a row: its cycle, its time, and the level of each signal, 0 or 1.
///
/// # Errors
/// Those of the writer.
pub fn write_edges_row(out: &mut impl Write, record: Record, clock_hz: u32, channels: u8) -> fmt::Result {
    write!(out, "{},{}", record.cycle.0, record.cycle.seconds(clock_hz))?;
    for bit in shown_signals(channels) {
        out.write_str(if record.levels.has(1 << bit) { ",1" } else { ",0" })?;
    }
    out.write_char('\n')
}

/// Names of the columns of [`write_packets_row`].
///
/// # Errors
/// Those of the writer.
pub fn write_packets_head(out: &mut impl Write) -> fmt::Result {
    out.write_str("start_cycle,end_cycle,bytes,outcome,tick_start_cycle,tick_end_cycle,kind\n")
}

/// Row `index` of a log: when on the line, which bytes (in hexadecimal), what became of them, when the
/// ticks that they brought ran (empty for none), and what it is ([`super::RowOutcome::kind`]).
///
/// # Errors
/// Those of the writer.
pub fn write_packets_row(out: &mut impl Write, log: &PacketLog, index: usize) -> fmt::Result {
    let Some(row) = log.rows().get(index) else { return Ok(()) };
    write!(out, "{},{},", row.start.0, row.end.0)?;
    log.bytes(index).iter().try_for_each(|byte| write!(out, "{byte:02x}"))?;
    write!(out, ",{}", Quoted(&row.verdict.to_string()))?;
    for at in [row.tick_start, row.tick_end] {
        out.write_char(',')?;
        at.map_or(Ok(()), |Instant(cycle)| write!(out, "{cycle}"))?;
    }
    writeln!(out, ",{}", row.verdict.kind())
}

/// A text as a field of a table: in quotes where it needs them.
pub struct Quoted<'a>(pub &'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.0.contains([',', '"', '\n', '\r']) {
            return f.write_str(self.0);
        }
        write!(f, "\"{}\"", self.0.replace('"', "\"\""))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::String;
    use stepscope_peripheral::signal::{Event, Levels, PacketOutcome, Sink};

    #[test]
    fn edges_are_rows_of_levels() {
        let mut text = String::new();
        write_edges_head(&mut text, 1).expect("a string takes it");
        let record = Record { cycle: Instant(24), levels: Levels(0x7_0001_0001) };
        write_edges_row(&mut text, record, 16_000_000, 1).expect("a string takes it");
        assert_eq!(text, "cycle,time_s,STEP0,DIR0,EN,RX,TX,DE\n24,0.0000015,1,1,1,1,1,0\n");
    }

    #[test]
    fn packets_are_rows_and_only_what_needs_it_is_quoted() {
        let mut log = PacketLog::default();
        for (at, byte) in [(5, 0x8a), (9, 0x05)] {
            log.event(Instant(at + 3), Event::Byte { seen: Instant(at), byte });
        }
        log.event(Instant(20), Event::Packet(PacketOutcome::Queued));
        log.event(Instant(30), Event::TickStart { orders: [0; 16] });
        let mut text = String::new();
        write_packets_head(&mut text).expect("a string takes it");
        write_packets_row(&mut text, &log, 0).expect("a string takes it");
        write_packets_row(&mut text, &log, 1).expect("a string takes it");
        let expected = "start_cycle,end_cycle,bytes,outcome,tick_start_cycle,tick_end_cycle,kind\n\
                        5,20,8a05,queued,30,,packet\n";
        assert_eq!(text, expected);
        for (given, written) in [("a b", "a b"), ("a,b", "\"a,b\""), ("a\"", "\"a\"\"\""), ("a\n", "\"a\n\"")]
        {
            assert_eq!(Quoted(given).to_string(), written);
        }
    }
}
