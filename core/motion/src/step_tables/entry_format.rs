//! The format of a step table's entries (DESIGN B8): the widths of their numbers.
//!
//! ```text
//! entry               interval, count, add
//! count > 0           repeats `count` times: waits `interval`, steps, then interval += add
//! count = 0           no step: waits `interval`, then DIR = add (0 left, 1 right)
//! ```
//!
//! DIR is initially left. Interval and add are in units of 1/2^fraction_bits cycle.

use crate::problem::{Cause, ValueError};
use alloc::vec::Vec;
use stepscope_peripheral::segment::{FRACTION_BITS, Segment, SegmentList};

/// Widths of an entry's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EntryFormat {
    pub name: &'static str,
    pub(super) fraction_bits: u32,
    interval_bits: u32,
    count_bits: u32,
    add_bits: u32,
}

impl EntryFormat {
    /// The numbers of the segment engine: 48.16 fixed point.
    pub const Q16: Self =
        Self { name: "q16", fraction_bits: FRACTION_BITS, interval_bits: 64, count_bits: 32, add_bits: 64 };
    /// 24.8 fixed point in 8 bytes.
    pub const Q8: Self =
        Self { name: "q8", fraction_bits: 8, interval_bits: 32, count_bits: 16, add_bits: 16 };
    /// Whole cycles in 8 bytes, like Klipper's queue_step.
    pub const TICKS: Self =
        Self { name: "ticks", fraction_bits: 0, interval_bits: 32, count_bits: 16, add_bits: 16 };
    pub const ALL: [Self; 3] = [Self::Q16, Self::Q8, Self::TICKS];

    /// A custom format. `widths` are the bits of interval, count and add: whole bytes of up to 64, 32 and 64 bits.
    /// `None` for other widths, or for more than 16 bits of a cycle's fraction.
    pub const fn new(name: &'static str, fraction_bits: u32, widths: [u32; 3]) -> Option<Self> {
        let [interval_bits, count_bits, add_bits] = widths;
        let format = Self { name, fraction_bits, interval_bits, count_bits, add_bits };
        if format.is_valid() { Some(format) } else { None }
    }

    /// Whether the numbers fit into an [`Entry`], in whole bytes.
    const fn is_valid(self) -> bool {
        const fn is_width(bits: u32, max: u32) -> bool {
            bits >= 8 && bits <= max && bits.is_multiple_of(8)
        }
        self.fraction_bits <= FRACTION_BITS
            && is_width(self.interval_bits, u64::BITS)
            && is_width(self.count_bits, u32::BITS)
            && is_width(self.add_bits, i64::BITS)
    }

    /// Bits of a cycle's fraction in interval and add, 0 to 16.
    pub const fn fraction_bits(self) -> u32 {
        self.fraction_bits
    }

    /// Bits of interval (unsigned), count (unsigned) and add (signed).
    pub const fn widths(self) -> [u32; 3] {
        [self.interval_bits, self.count_bits, self.add_bits]
    }

    pub const fn bytes(self) -> u64 {
        ((self.interval_bits + self.count_bits + self.add_bits) / 8) as u64
    }

    /// Maximum interval; like the limits of add in 1/2^fraction_bits cycle.
    pub const fn max_interval(self) -> u64 {
        u64::MAX >> (64 - self.interval_bits)
    }

    pub const fn max_count(self) -> u32 {
        u32::MAX >> (32 - self.count_bits)
    }

    pub const fn min_add(self) -> i64 {
        i64::MIN >> (64 - self.add_bits)
    }

    pub const fn max_add(self) -> i64 {
        i64::MAX >> (64 - self.add_bits)
    }

    /// Fraction bits of a segment that this format drops.
    pub(super) const fn dropped_bits(self) -> u32 {
        FRACTION_BITS - self.fraction_bits
    }

    /// The list's segments as entries of this format. A segment that is too large for an entry becomes several entries: waits
    /// of equal length before a long interval, one entry per step for a large add, or parts of a large count.
    /// Errors: a time that is not a multiple of this format's unit.
    pub fn pack(self, list: &SegmentList) -> Result<Vec<Entry>, Cause> {
        let mut packer = Packer { format: self, entries: Vec::new(), right: false };
        for segment in &list.segments {
            match *segment {
                Segment::Dwell(dwell) => packer.wait(self.units(dwell)?),
                Segment::Steps { count, interval, add, right } => {
                    packer.set_direction(right);
                    // A single step has no next interval, so its `add` need not be representable.
                    let add = if count == 1 { 0 } else { add };
                    self.units(add.unsigned_abs())?;
                    packer.steps(count, self.units(interval)?, add >> self.dropped_bits());
                }
            }
        }
        Ok(packer.entries)
    }

    /// Whether the format can represent `add` and all intervals, whatever the count.
    fn has_range_for(self, interval: u64, count: u32, add: i64) -> bool {
        let last = i128::from(interval) + i128::from(add) * i128::from(count.saturating_sub(1));
        (self.min_add()..=self.max_add()).contains(&add)
            && interval <= self.max_interval()
            && (0..=i128::from(self.max_interval())).contains(&last)
    }

    fn units(self, time: u64) -> Result<u64, Cause> {
        if time.trailing_zeros() >= self.dropped_bits() {
            Ok(time >> self.dropped_bits())
        } else {
            let detail = "the format has fewer fraction bits than the list; use q16";
            Err(ValueError::Conflict { detail }.into())
        }
    }
}

const _: () =
    assert!(EntryFormat::Q16.is_valid() && EntryFormat::Q8.is_valid() && EntryFormat::TICKS.is_valid());

/// An entry of a step table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Time before the first step, or of the wait, in units.
    pub interval: u64,
    /// Steps; 0 for a wait.
    pub count: u32,
    /// Increment of the interval in units; for a wait the level of DIR after it.
    pub add: i64,
}

struct Packer {
    format: EntryFormat,
    entries: Vec<Entry>,
    right: bool,
}

impl Packer {
    fn set_direction(&mut self, right: bool) {
        if right != self.right {
            self.right = right;
            self.entries.push(Entry { interval: 0, count: 0, add: right.into() });
        }
    }

    fn wait(&mut self, time: u64) {
        let rest = self.wait_before_last_part(time);
        if rest > 0 {
            self.entries.push(Entry { interval: rest, count: 0, add: self.right.into() });
        }
    }

    /// Divides a long time evenly, so that no part is too short for a timer; returns the last part.
    fn wait_before_last_part(&mut self, mut time: u64) -> u64 {
        for parts in (2..=time.div_ceil(self.format.max_interval())).rev() {
            let interval = time / parts;
            self.entries.push(Entry { interval, count: 0, add: self.right.into() });
            time -= interval;
        }
        time
    }

    fn steps(&mut self, mut count: u32, mut interval: u64, add: i64) {
        let is_representable = self.format.has_range_for(interval, count, add);
        let max_part = if is_representable { self.format.max_count() } else { 1 };
        while count > 0 {
            let part = count.min(max_part);
            let own = self.wait_before_last_part(interval);
            self.entries.push(Entry { interval: own, count: part, add: if part == 1 { 0 } else { add } });
            // Only the interval after the last step of a valid list can saturate, and no entry uses it.
            interval = interval.saturating_add_signed(add.saturating_mul(part.into()));
            count -= part;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;
    use stepscope_peripheral::units::Instant;

    fn pack(format: EntryFormat, segments: Vec<Segment>) -> Result<Vec<(u64, u32, i64)>, Cause> {
        let list = SegmentList { start: Instant(1), segments };
        let entries = format.pack(&list)?;
        Ok(entries.iter().map(|entry| (entry.interval, entry.count, entry.add)).collect())
    }

    fn steps(count: u32, cycles: u64, add: i64, right: bool) -> Segment {
        Segment::Steps { count, interval: cycles << 16, add: add << 16, right }
    }

    #[test]
    fn divides_segments_that_are_too_large_for_an_entry() {
        let q16 = pack(EntryFormat::Q16, vec![steps(9, 100, -2, false), Segment::Dwell(7)]);
        assert_eq!(q16, Ok(vec![(100 << 16, 9, -2 << 16), (7, 0, 0)]));
        let rows = [
            (steps(70_000, 50, 0, false), vec![(50, 65_535, 0), (50, 4465, 0)]),
            (steps(70_000, 50, 1, false), vec![(50, 65_535, 1), (65_585, 4465, 1)]),
            (steps(2, 50, 40_000, true), vec![(0, 0, 1), (50, 1, 0), (40_050, 1, 0)]),
            (steps(1, u32::MAX.into(), 5, false), vec![(u32::MAX.into(), 1, 0)]),
            (steps(1, 1 << 32, 5, false), vec![(1 << 31, 0, 0), (1 << 31, 1, 0)]),
            (steps(1, (1 << 32) + 1, 5, true), vec![(0, 0, 1), (1 << 31, 0, 1), ((1 << 31) + 1, 1, 0)]),
            (Segment::Dwell((1 << 48) + (5 << 16)), vec![((1 << 31) + 2, 0, 0), ((1 << 31) + 3, 0, 0)]),
            (Segment::Dwell(u64::from(u32::MAX) << 16), vec![(u32::MAX.into(), 0, 0)]),
            (Segment::Dwell(0), vec![]),
        ];
        for (segment, expected) in rows {
            assert_eq!(pack(EntryFormat::TICKS, vec![segment]), Ok(expected), "{segment:?}");
        }
        // In q8 an interval has up to 2^24 cycles less 1/256.
        for (cycles, first) in [(1_u64 << 24, 1_u64 << 31), ((1 << 24) + 1, (1 << 31) + 128)] {
            let last = (cycles << 8) - first;
            let expected = vec![(0, 0, 1), (first, 0, 1), (last, 1, 0)];
            assert_eq!(pack(EntryFormat::Q8, vec![steps(1, cycles, 0, true)]), Ok(expected));
        }
        let part = Segment::Steps { count: 2, interval: 3 << 15, add: 0, right: false };
        assert_eq!(pack(EntryFormat::Q8, vec![part]), Ok(vec![(3 << 7, 2, 0)]));
        assert!(matches!(
            pack(EntryFormat::TICKS, vec![part]),
            Err(Cause::Value(ValueError::Conflict { .. }))
        ));
    }

    #[test]
    fn invalid_widths_make_no_format() {
        let rows = [
            (0, [8, 8, 8], true),
            (16, [64, 32, 64], true),
            (17, [64, 32, 64], false),
            (0, [0, 16, 16], false),
            (0, [32, 0, 16], false),
            (0, [32, 16, 0], false),
            (0, [72, 16, 16], false),
            (0, [32, 40, 16], false),
            (0, [32, 16, 72], false),
            (0, [12, 16, 16], false),
        ];
        for (fraction_bits, widths, is_valid) in rows {
            let format = EntryFormat::new("own", fraction_bits, widths);
            assert_eq!(format.is_some(), is_valid, "{fraction_bits} {widths:?}");
        }
    }

    #[test]
    fn formats_have_their_sizes_and_ranges() {
        assert_eq!(EntryFormat::ALL.map(EntryFormat::bytes), [20, 8, 8]);
        let ticks = EntryFormat::TICKS;
        assert_eq!((ticks.max_interval(), ticks.max_count()), (0xffff_ffff, 0xffff));
        assert_eq!((ticks.min_add(), ticks.max_add()), (-32_768, 32_767));
    }
}
