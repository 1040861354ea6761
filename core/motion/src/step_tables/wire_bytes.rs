//! Size of a table's entries on the line with Klipper's protocol (DESIGN B8).
//!
//! ```text
//! block      length, sequence, commands, checksum (2), end: at most 64 bytes
//! command    its number, the number of the object (a byte each), then its arguments
//! argument   seven bits per byte: 1 byte for -32 to 95, 2 bytes for -4096 to 12 287, ...
//! ```
//!
//! An entry with steps is a `queue_step` (interval, count, add), a turn a `set_next_step_dir` (dir), and a wait a
//! `reset_step_clock` (clock, 5 bytes). No command is split between blocks.

use crate::step_tables::entry_format::{Entry, EntryFormat};

/// Bytes of a block without commands.
const FRAME: u64 = 5;
/// Maximum bytes of a block's commands.
const MAX_COMMANDS: u64 = 64 - FRAME;

/// Bytes of the entries in blocks; `None` for a format whose numbers `queue_step` does not accept.
pub(super) fn wire_bytes(format: EntryFormat, entries: &[Entry]) -> Option<u64> {
    let (fraction_bits, [interval_bits, count_bits, add_bits]) = (format.fraction_bits(), format.widths());
    if (fraction_bits, interval_bits, count_bits, add_bits) != (0, 32, 16, 16) {
        return None;
    }
    let (mut bytes, mut block) = (0, MAX_COMMANDS);
    for entry in entries {
        let command = match entry {
            Entry { count: 0, interval: 0, .. } => 3,
            Entry { count: 0, .. } => 7,
            Entry { interval, count, add } => {
                2 + argument_bytes(*interval as i64) + argument_bytes((*count).into()) + argument_bytes(*add)
            }
        };
        if block + command > MAX_COMMANDS {
            (bytes, block) = (bytes + FRAME, 0);
        }
        (bytes, block) = (bytes + command, block + command);
    }
    Some(bytes)
}

fn argument_bytes(value: i64) -> u64 {
    // Each byte multiplies the number of values by 128; a quarter of them is negative.
    (1..5).find(|bytes| (-(1 << (7 * bytes - 2))..3 << (7 * bytes - 2)).contains(&value)).unwrap_or(5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn an_argument_has_seven_bits_per_byte() {
        let rows = [
            (1, -32, 95),
            (2, -4096, 12_287),
            (3, -524_288, 1_572_863),
            (4, -67_108_864, 201_326_591),
            (5, i64::from(i32::MIN), i64::from(u32::MAX)),
        ];
        let mut beyond = None;
        for (bytes, min, max) in rows {
            assert_eq!([min, max].map(argument_bytes), [bytes; 2]);
            if let Some((min, max)) = beyond {
                assert_eq!([min, max].map(argument_bytes), [bytes; 2]);
            }
            beyond = Some((min - 1, max + 1));
        }
    }

    #[test]
    fn blocks_contain_complete_commands() {
        let step = Entry { interval: 20_000, count: 100, add: -40 };
        let (turn, wait) = (Entry { interval: 0, count: 0, add: 1 }, Entry { interval: 9, count: 0, add: 1 });
        // Nine bytes per command, six commands per block.
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
