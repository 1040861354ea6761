//! A run as CSV (RFC 4180): one row per record, tick or segment. Packets are in [`crate::packets::packet_table`].

use crate::packets::log::LoggedTick;
use core::fmt::{self, Write};
use stepscope_peripheral::signal::{self, Record};
use stepscope_peripheral::{
    segment::Segment, trace::shown_signals, units::Instant, wire::packet::ChannelCommand,
};

/// The header of [`write_edges_row`].
pub fn write_edges_head(out: &mut impl Write, channels: u8) -> fmt::Result {
    out.write_str("cycle,time_s")?;
    for bit in shown_signals(channels) {
        write!(out, ",{}", signal::name(bit).unwrap_or_default())?;
    }
    out.write_char('\n')
}

/// One row: cycle, time in s, and the level of each signal.
pub fn write_edges_row(out: &mut impl Write, record: Record, clock_hz: u32, channels: u8) -> fmt::Result {
    write!(out, "{},{}", record.cycle.0, record.cycle.seconds(clock_hz))?;
    for bit in shown_signals(channels) {
        out.write_str(if record.levels.has(1 << bit) { ",1" } else { ",0" })?;
    }
    out.write_char('\n')
}

/// The header of [`write_tick_row`].
pub fn write_ticks_head(out: &mut impl Write, channels: u8) -> fmt::Result {
    out.write_str("start_cycle,packet")?;
    (0..channels).try_for_each(|channel| write!(out, ",steps{channel}"))?;
    out.write_char('\n')
}

/// One row: start of the tick, row of its packet, and steps per channel, negative to the left.
pub fn write_tick_row(out: &mut impl Write, tick: &LoggedTick, channels: u8) -> fmt::Result {
    write!(out, "{},", tick.start.0)?;
    tick.row.map_or(Ok(()), |row| write!(out, "{row}"))?;
    for &byte in tick.commands.iter().take(channels.into()) {
        let ChannelCommand { right, steps } = ChannelCommand::parse(byte);
        write!(out, ",{}{steps}", if right || steps == 0 { "" } else { "-" })?;
    }
    out.write_char('\n')
}

/// The header of [`write_segment_row`].
pub const SEGMENTS_HEAD: &str = "channel,start_cycle,kind,count,interval_q16,add_q16,dir,length_q16\n";

/// One row: channel, start of its list, and the segment's numbers.
pub fn write_segment_row(
    out: &mut impl Write,
    channel: usize,
    start: Instant,
    segment: &Segment,
) -> fmt::Result {
    write!(out, "{channel},{},", start.0)?;
    match segment {
        Segment::Steps { count, interval, add, right } => {
            writeln!(out, "steps,{count},{interval},{add},{},", u8::from(*right))
        }
        Segment::Dwell(length) => writeln!(out, "dwell,,,,,{length}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::String;
    use stepscope_peripheral::signal::Levels;

    #[test]
    fn edges_are_rows_of_levels() {
        let mut text = String::new();
        write_edges_head(&mut text, 1).expect("a string takes it");
        let record = Record { cycle: Instant(24), levels: Levels(0x7_0001_0001) };
        write_edges_row(&mut text, record, 16_000_000, 1).expect("a string takes it");
        assert_eq!(text, "cycle,time_s,STEP0,DIR0,EN,RX,TX,DE\n24,0.0000015,1,1,1,1,1,0\n");
    }

    #[test]
    fn edges_are_rows_below_a_head() {
        use crate::export::tables::{write_edges_head, write_edges_row};
        use stepscope_peripheral::{
            signal::{Levels, Record},
            units::Instant,
        };

        let mut table = String::new();
        write_edges_head(&mut table, 1).expect("a string takes it");
        write_edges_row(&mut table, Record { cycle: Instant(16), levels: Levels::RESET }, 16_000_000, 1)
            .expect("as above");
        assert_eq!(table, "cycle,time_s,STEP0,DIR0,EN,RX,TX,DE\n16,0.000001,0,0,1,1,1,0\n");
    }
}
