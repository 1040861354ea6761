//! The signals of a run as a table, a row for each record. CSV as in RFC 4180, with a line feed at the end of a row.
//! The table of packets is [`crate::packet_table`].
//!
//! ```
//! use stepscope_inspect::tables::{write_edges_head, write_edges_row};
//! use stepscope_peripheral::{
//!     signal::{Levels, Record},
//!     units::Instant,
//! };
//!
//! let mut table = String::new();
//! write_edges_head(&mut table, 1).expect("a string takes it");
//! write_edges_row(&mut table, Record { cycle: Instant(16), levels: Levels::RESET }, 16_000_000, 1).expect("as above");
//! assert_eq!(table, "cycle,time_s,STEP0,DIR0,EN,RX,TX,DE\n16,0.000001,0,0,1,1,1,0\n");
//! ```

use core::fmt::{self, Write};
use stepscope_peripheral::{
    signal::{self, Record},
    trace::shown_signals,
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

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::String;
    use stepscope_peripheral::{signal::Levels, units::Instant};

    #[test]
    fn edges_are_rows_of_levels() {
        let mut text = String::new();
        write_edges_head(&mut text, 1).expect("a string takes it");
        let record = Record { cycle: Instant(24), levels: Levels(0x7_0001_0001) };
        write_edges_row(&mut text, record, 16_000_000, 1).expect("a string takes it");
        assert_eq!(text, "cycle,time_s,STEP0,DIR0,EN,RX,TX,DE\n24,0.0000015,1,1,1,1,1,0\n");
    }
}
