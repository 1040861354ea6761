//! Size of a table's entries on the line with Klipper's protocol (DESIGN B8).
//!
//! ```text
//! block      length, sequence, commands, checksum (2), end: at most 64 bytes
//! command    its number, the number of the object (a byte each), then its arguments
//! argument   seven bits per byte, the first with the sign: 1 byte for -32 to 95, 2 for -4096 to 12 287, ...
//! ```
//!
//! An entry with steps is a `queue_step` (interval, count, add), a turn a `set_next_step_dir` (dir), and a wait a
//! `reset_step_clock` (clock, 5 bytes). No command is split between blocks.

use crate::step_tables::entry_format::{Entry, EntryFormat};

const FRAME: u64 = 5;
const MAX_BLOCK: u64 = 64 - FRAME;

/// Bytes of the entries in blocks; `None` for a format whose numbers `queue_step` does not accept.
pub(super) fn wire_bytes(format: EntryFormat, entries: &[Entry]) -> Option<u64> {
    let EntryFormat { fraction_bits, interval_bits, count_bits, add_bits, .. } = format;
    if (fraction_bits, interval_bits, count_bits, add_bits) != (0, 32, 16, 16) {
        return None;
    }
    let (mut bytes, mut block) = (0, MAX_BLOCK);
    for entry in entries {
        let command = match entry {
            Entry { count: 0, interval: 0, .. } => 3,
            Entry { count: 0, .. } => 7,
            Entry { interval, count, add } => {
                2 + argument(*interval as i64) + argument((*count).into()) + argument(*add)
            }
        };
        if block + command > MAX_BLOCK {
            (bytes, block) = (bytes + FRAME, 0);
        }
        (bytes, block) = (bytes + command, block + command);
    }
    Some(bytes)
}

fn argument(value: i64) -> u64 {
    // Each byte holds 128 times as many values, of which a quarter is negative.
    (1..5).find(|bytes| (-(1 << (7 * bytes - 2))..3 << (7 * bytes - 2)).contains(&value)).unwrap_or(5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn an_argument_has_seven_bits_a_byte() {
        let rows = [
            (1, -32, 95),
            (2, -4096, 12_287),
            (3, -524_288, 1_572_863),
            (4, -67_108_864, 201_326_591),
            (5, i64::from(i32::MIN), i64::from(u32::MAX)),
        ];
        let mut beyond = None;
        for (bytes, least, most) in rows {
            assert_eq!([least, most].map(argument), [bytes; 2]);
            if let Some((least, most)) = beyond {
                assert_eq!([least, most].map(argument), [bytes; 2]);
            }
            beyond = Some((least - 1, most + 1));
        }
    }

    #[test]
    fn no_command_is_parted_between_blocks() {
        let step = Entry { interval: 20_000, count: 100, add: -40 };
        let (turn, wait) = (Entry { interval: 0, count: 0, add: 1 }, Entry { interval: 9, count: 0, add: 1 });
        // Nine bytes a command: six of them in a block.
        let rows = [
            (vec![], 0),
            (vec![step], 5 + 9),
            (vec![turn, step, wait], 5 + 3 + 9 + 7),
            (vec![step; 6], 5 + 54),
            (vec![step; 7], 5 + 54 + 5 + 9),
        ];
        for (entries, bytes) in rows {
            assert_eq!(wire_bytes(EntryFormat::TICKS, &entries), Some(bytes), "{entries:?}");
        }
        assert_eq!(wire_bytes(EntryFormat::Q8, &[step]), None);
    }
}
