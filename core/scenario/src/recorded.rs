//! Converts a table of recorded packets to a line script that sends them again.
//!
//! Uses the columns `bytes` and `start_cycle` or `start_s`. Skips replies, collisions, and replies of other controllers
//! in older tables without `meaning`.

use crate::table::{BadTable, Rows, short};
use crate::{Hex, LineScript, ScriptedSend};
use alloc::{borrow::ToOwned, format, string::String, vec::Vec};
use stepscope_peripheral::wire::frame::{ACK, Deframed, Deframer};

impl LineScript {
    /// Reads the packets of a table; times in s become cycles of `clock_hz`.
    /// Errors: [`BadTable`] with the first invalid line. Overlaps are checked later.
    pub fn recorded(table: &str, clock_hz: u32) -> Result<Self, BadTable> {
        let mut rows = Rows::new(table, b',')?;
        let (_, head) = rows.next().unwrap_or_default();
        let column = |name: &str| head.iter().position(|field| field.trim() == name);
        let missing = |name: &str| {
            rows.error_at(
                0,
                format!("no column {name}; a table of packets needs start_cycle (or start_s) and bytes"),
            )
        };
        let start = column("start_cycle").map(|at| (at, false)).or(column("start_s").map(|at| (at, true)));
        let (start, in_seconds) = start.ok_or_else(|| missing("start_cycle"))?;
        let bytes = column("bytes").ok_or_else(|| missing("bytes"))?;
        let kind = column("kind");
        // Tables with meanings mark all replies; older ones need the outcome.
        let outcome = column("outcome").filter(|_| column("meaning").is_none());
        let mut sends = Vec::new();
        while let Some((position, row)) = rows.next() {
            let field = |index: usize| row.get(index).map_or("", |field| field.trim());
            if kind.is_some_and(|kind| ["reply", "collision"].contains(&field(kind))) {
                continue;
            }
            let given = field(start);
            let start_cycle = if in_seconds { cycle_at(given, clock_hz) } else { given.parse().ok() };
            let start_cycle = start_cycle.filter(|cycle| *cycle > 0).ok_or_else(|| {
                let (name, allowed) = if in_seconds {
                    ("start_s", "a time in s after reset")
                } else {
                    ("start_cycle", "a whole number of cycles from 1")
                };
                rows.error_at(position, format!("{name} is “{}”; use {allowed}", short(given)))
            })?;
            let given = field(bytes);
            let hex: String = given.split_whitespace().collect();
            let sent = base16ct::mixed::decode_vec(&hex).map_err(|_| {
                rows.error_at(
                    position,
                    format!("bytes are “{}”; use pairs of hexadecimal digits", short(given)),
                )
            })?;
            let of_another = outcome.is_some_and(|at| field(at) == OTHER_ADDRESS) && is_reply(&sent);
            if !sent.is_empty() && !of_another {
                sends.push(ScriptedSend { start_cycle, bytes: Hex(sent), frame: None });
            }
        }
        if sends.is_empty() {
            return Err(rows.error_at(
                rows.position,
                "the table has no packets; use at least one row with bytes".to_owned(),
            ));
        }
        Ok(Self { sends })
    }
}

const OTHER_ADDRESS: &str = "another address";

/// Whether these bytes are a controller's frame (DESIGN A6).
fn is_reply(bytes: &[u8]) -> bool {
    let mut deframer = Deframer::default();
    bytes
        .iter()
        .any(|&byte| matches!(deframer.byte(byte), Some(Deframed::Frame(frame)) if frame.kind & ACK != 0))
}

fn cycle_at(seconds: &str, clock_hz: u32) -> Option<u64> {
    let cycle = libm::round(serde_json::from_str::<f64>(seconds).ok()? * f64::from(clock_hz));
    (1.0..9e15).contains(&cycle).then_some(cycle as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{string::ToString, vec};

    fn sends(table: &str) -> Result<Vec<(u64, Vec<u8>)>, String> {
        let script = LineScript::recorded(table, 16_000_000).map_err(|bad| bad.to_string())?;
        Ok(script.sends.into_iter().map(|send| (send.start_cycle, send.bytes.0)).collect())
    }

    #[test]
    fn packets_are_sent_again_and_replies_are_not() {
        let table = "\u{feff}kind,start_cycle,outcome,bytes\r\n\
                     packet,10,queued,8a05\r\nreply,20,\"ACK TICKS: idle, 3 free\",00\r\n\r\nframe,30,\"a\nb\",\"FF 00\"\r\n";
        assert_eq!(sends(table), Ok(vec![(10, vec![0x8a, 5]), (30, vec![0xff, 0])]));
        assert_eq!(sends("start_cycle,bytes\n7,01"), Ok(vec![(7, vec![1])]), "no kind, no line's end");
        assert_eq!(sends("bytes,start_s\n01,0.0000015\n"), Ok(vec![(24, vec![1])]), "24 cycles of 16 MHz");
        let long = format!("bytes,start_cycle\n{},1\n", "ab".repeat(3000));
        assert_eq!(sends(&long), Ok(vec![(1, vec![0xab; 3000])]));
        let wide = format!("{}bytes,start_cycle\n{}ab,1\n", "x,".repeat(100), "x,".repeat(100));
        assert_eq!(sends(&wide), Ok(vec![(1, vec![0xab])]));
    }

    #[test]
    fn replies_of_other_controllers_are_not_sent() {
        use stepscope_peripheral::wire::frame::emit;
        let hex = |bytes: Vec<u8>| base16ct::lower::encode_string(&bytes);
        let (frame, reply) = (hex(emit(2, 4, &[])), hex(emit(2, 0x84, &[0; 9])));
        let table = |outcome: &str| {
            format!(
                "start_cycle,bytes,outcome,kind\n9,{frame},{outcome},frame\n500,{reply},{outcome},frame\n"
            )
        };
        let starts = |outcome| {
            let found = sends(&table(outcome)).expect("a table");
            found.into_iter().map(|(start, _)| start).collect::<Vec<_>>()
        };
        assert_eq!(starts("another address"), [9]);
        assert_eq!(starts("refused: UNKNOWN_KIND"), [9, 500], "the host did send that");
        let marked = format!("start_cycle,bytes,outcome,kind,meaning\n500,{reply},another address,frame,\n");
        assert_eq!(sends(&marked).map(|sends| sends.len()), Ok(1), "a table with meanings marks replies");
    }

    #[test]
    fn errors_state_the_line() {
        for (table, expected) in [
            ("", "line 1: no column start_cycle"),
            ("start_cycle,hex\n", "line 1: no column bytes"),
            ("start_cycle,bytes\n", "line 2: the table has no packets"),
            ("start_cycle,bytes\n1,00\n\n0,00\n", "line 4: start_cycle is “0”"),
            ("start_cycle,bytes\r\n1,00\r\n2.5,00\r\n", "line 3: start_cycle is “2.5”"),
            ("start_s,bytes\nNaN,00\n", "line 2: start_s is “NaN”"),
            ("start_s,bytes\n1e300,00\n", "line 2: start_s is “1e300”"),
            ("start_cycle,bytes\n1,0\n", "line 2: bytes are “0”"),
            ("start_cycle,bytes\n1,0g\n", "line 2: bytes are “0g”"),
            ("start_cycle,bytes\n1\n2\n", "line 4: the table has no packets"),
        ] {
            let found = sends(table).expect_err(table);
            assert!(found.starts_with(expected), "{table:?}: {found}");
        }
    }
}
