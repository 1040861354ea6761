//! Where the bytes of a row stand on the line: found again in the trace, as the receiver found them.

use crate::{
    signal::{Levels, Record},
    units::{Cycles, Instant},
    wire::uart::{Heard, Receiver},
};
use alloc::vec::Vec;

/// The level of RX (DESIGN A3).
const RX: u64 = 1 << 33;

/// Where the start bits of the first `count` bytes that a receiver of bit time `bit` hears from `start`
/// on were seen; `start` is where it saw the first of them ([`super::LoggedPacket::start`]). Bytes with
/// a low stop bit are left out. Fewer where the trace ends before them.
#[must_use]
pub fn heard(trace: &[Record], bit: Cycles, start: Instant, count: usize) -> Vec<Instant> {
    let mut found = Vec::new();
    let mut receiver = Receiver::new(bit);
    let mut next = trace.partition_point(|record| record.cycle < start);
    let mut level = next.checked_sub(1).and_then(|last| trace.get(last)).is_none_or(is_high);
    let mut now = start;
    while found.len() < count {
        let before = level;
        while let Some(record) = trace.get(next).filter(|record| record.cycle <= now) {
            level = is_high(record);
            next += 1;
        }
        if let Some(Heard::Byte(_)) = receiver.clock(now, before, level) {
            found.push(receiver.seen());
        }
        let deadline = receiver.deadline(now, level);
        let edge = trace.get(next).map_or(Instant::NEVER, |record| record.cycle);
        now = deadline.min(edge);
        if now == Instant::NEVER {
            break;
        }
    }
    found
}

fn is_high(record: &Record) -> bool {
    let Record { levels: Levels(bits), .. } = record;
    bits & RX != 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{run::Experiment, trace::Recording};

    #[test]
    fn bytes_are_found_where_the_receiver_saw_them() {
        // 16 MHz / 115 200 baud: a byte is 1388 cycles and 8/9; the second send comes after a pause.
        let json = r#"{"bus":{"channels":2},"source":{"line":{"sends":[
            {"start_cycle":5000,"bytes":"85"},{"start_cycle":9000,"bytes":"0105"}]}}}"#;
        let mut made = Recording::default();
        let experiment = Experiment::from_json(json).expect("no problems");
        experiment.run(&mut made);
        let bit = experiment.config().bit();
        let seen: Vec<u64> = heard(&made.trace, bit, Instant(5000), 9).iter().map(|at| at.0).collect();
        assert_eq!(seen, [5000, 9000, 10_388]);
        assert_eq!(heard(&made.trace, bit, Instant(9000), 1), [Instant(9000)]);
    }
}
