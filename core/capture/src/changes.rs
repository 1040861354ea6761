//! Changes of levels, compressed: most take two or three bytes instead of 16.
//!
//! ```text
//! block    first change, uncompressed (so that a time is found without decoding earlier blocks), then rows
//! row      1 byte       more: 1 bit | time since the previous change, lowest bits: 6 | new mask: 1
//!          0..9 bytes   more: 1 bit | next bits of the time: 7                  while `more` is set
//!          1 or 9       number of the changed channel, or 0x80 and a mask of 64 bits   if `new mask` is set;
//!                       otherwise the same channels change as before, as STEP does
//! ```

use std::{collections::TryReserveError, slice, vec};

/// Changes that are inspected to propose a channel map.
pub(crate) const MAX_INSPECTED: usize = 1_000_000;

/// The levels of all channels from a tick until the next change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Change {
    /// In ticks of the file.
    pub tick: u64,
    /// Channel i in bit i; 0 if unknown, or neither high nor low.
    pub levels: u64,
}

/// Bytes per block: large enough that the C library returns each block to the system.
const BLOCK: usize = 1 << 17;
/// Ten bytes of time, nine of changed bits.
const MAX_ROW: usize = 19;
/// Bits of the time in the first byte, and in each later one.
const FIRST_BITS: u32 = 6;
const MORE_BITS: u32 = 7;
/// Another byte of the time follows.
const MORE: u8 = 0x80;
/// Other channels change than in the previous row; they follow the time.
const NEW_MASK: u8 = 1;
/// Several channels change; a mask of eight bytes follows.
const SEVERAL: u8 = 0x80;

/// Compressed changes in order of time, each with other levels than the previous one.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    blocks: Vec<Block>,
    len: usize,
    last: Option<Change>,
    /// The bits that changed last in the last block.
    mask: u64,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Block {
    first: Change,
    rows: Vec<u8>,
}

impl Changes {
    pub const fn new() -> Self {
        Self { blocks: Vec::new(), len: 0, last: None, mask: 0 }
    }

    pub const fn len(&self) -> usize {
        self.len
    }

    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    pub fn first(&self) -> Option<Change> {
        self.blocks.first().map(|block| block.first)
    }

    pub const fn last(&self) -> Option<Change> {
        self.last
    }

    /// Used memory in bytes.
    pub fn bytes(&self) -> usize {
        self.blocks.iter().map(|block| size_of::<Block>() + block.rows.len()).sum()
    }

    /// Reserves space for one change, so that [`Self::push`] does not allocate. Errors: out of memory.
    pub fn reserve(&mut self) -> Result<(), TryReserveError> {
        if self.blocks.len() == self.blocks.capacity() {
            self.blocks.try_reserve((self.blocks.len() / 2).max(16))?;
        }
        if let Some(block) = self.blocks.last_mut()
            && block.rows.capacity() == 0
        {
            block.rows.try_reserve_exact(BLOCK)?;
        }
        Ok(())
    }

    /// Adds a change. Its tick must not be before the last change.
    pub fn push(&mut self, change: Change) {
        let last = self.last.replace(change);
        self.len += 1;
        let (Some(block), Some(last)) = (self.blocks.last_mut(), last) else {
            return self.begin_block(change);
        };
        if block.rows.len() + MAX_ROW > BLOCK {
            return self.begin_block(change);
        }
        let (mut time, changed) = (change.tick.saturating_sub(last.tick), change.levels ^ last.levels);
        let new_mask = if changed == self.mask { 0 } else { NEW_MASK };
        let low = (time & ((1 << FIRST_BITS) - 1)) as u8;
        time >>= FIRST_BITS;
        block.rows.push(low << 1 | new_mask | if time > 0 { MORE } else { 0 });
        while time > 0 {
            let low = (time & ((1 << MORE_BITS) - 1)) as u8;
            time >>= MORE_BITS;
            block.rows.push(low | if time > 0 { MORE } else { 0 });
        }
        if new_mask != 0 {
            if changed.is_power_of_two() {
                block.rows.push(changed.trailing_zeros() as u8);
            } else {
                block.rows.push(SEVERAL);
                block.rows.extend(changed.to_le_bytes());
            }
            self.mask = changed;
        }
    }

    fn begin_block(&mut self, first: Change) {
        self.mask = 0;
        self.blocks.push(Block { first, rows: Vec::new() });
    }

    pub fn iter(&self) -> Iter<'_> {
        Iter { blocks: self.blocks.iter(), decoder: Decoder::default(), rows: &[] }
    }

    /// Iterates from the last change at or before `tick`; from the first if there is none.
    pub fn iter_from(&self, tick: u64) -> Iter<'_> {
        let block = self.blocks.partition_point(|block| block.first.tick <= tick).saturating_sub(1);
        let mut from = Iter {
            blocks: self.blocks.get(block..).unwrap_or_default().iter(),
            decoder: Decoder::default(),
            rows: &[],
        };
        loop {
            let mut next = from.clone();
            let has_later_start =
                next.next().is_some() && next.next().is_some_and(|after| after.tick <= tick);
            if !has_later_start {
                return from;
            }
            from.next();
        }
    }
}

/// State of decompression: the latest change, and the channels that changed in it.
#[derive(Clone, Copy, Debug, Default)]
struct Decoder {
    tick: u64,
    levels: u64,
    mask: u64,
}

impl Decoder {
    const fn new(first: Change) -> Self {
        Self { tick: first.tick, levels: first.levels, mask: 0 }
    }

    const fn change(self) -> Change {
        Change { tick: self.tick, levels: self.levels }
    }

    /// Decodes the next row and returns its length; `None` at the end.
    fn decode(&mut self, rows: &[u8]) -> Option<usize> {
        let mut byte = *rows.first()?;
        let (mut at, has_new_mask) = (1, byte & NEW_MASK != 0);
        let mut time = u64::from(byte & !MORE) >> 1;
        let mut shift = FIRST_BITS;
        while byte & MORE != 0 {
            byte = *rows.get(at)?;
            at += 1;
            time |= u64::from(byte & !MORE).checked_shl(shift)?;
            shift += MORE_BITS;
        }
        if has_new_mask {
            let channel = *rows.get(at)?;
            at += 1;
            if channel == SEVERAL {
                let bits = rows.get(at..at + 8)?;
                self.mask = u64::from_le_bytes(bits.try_into().ok()?);
                at += 8;
            } else {
                self.mask = 1_u64.checked_shl(channel.into())?;
            }
        }
        self.tick = self.tick.wrapping_add(time);
        self.levels ^= self.mask;
        Some(at)
    }
}

/// Iterates over stored changes in order of time.
#[derive(Clone, Debug)]
pub struct Iter<'a> {
    blocks: slice::Iter<'a, Block>,
    decoder: Decoder,
    rows: &'a [u8],
}

impl Iterator for Iter<'_> {
    type Item = Change;

    #[inline]
    fn next(&mut self) -> Option<Change> {
        if let Some(length) = self.decoder.decode(self.rows) {
            self.rows = self.rows.get(length..).unwrap_or_default();
            return Some(self.decoder.change());
        }
        let block = self.blocks.next()?;
        (self.decoder, self.rows) = (Decoder::new(block.first), &block.rows);
        Some(block.first)
    }
}

/// Iterator over changes that frees the memory of each block after its last change.
#[derive(Debug)]
pub struct IntoIter {
    blocks: vec::IntoIter<Block>,
    decoder: Decoder,
    rows: Vec<u8>,
    at: usize,
}

impl Iterator for IntoIter {
    type Item = Change;

    #[inline]
    fn next(&mut self) -> Option<Change> {
        if let Some(length) = self.decoder.decode(self.rows.get(self.at..).unwrap_or_default()) {
            self.at += length;
            return Some(self.decoder.change());
        }
        let Block { first, rows } = self.blocks.next()?;
        (self.decoder, self.rows, self.at) = (Decoder::new(first), rows, 0);
        Some(first)
    }
}

impl IntoIterator for Changes {
    type Item = Change;
    type IntoIter = IntoIter;

    fn into_iter(self) -> IntoIter {
        IntoIter { blocks: self.blocks.into_iter(), decoder: Decoder::default(), rows: Vec::new(), at: 0 }
    }
}

impl<'a> IntoIterator for &'a Changes {
    type Item = Change;
    type IntoIter = Iter<'a>;

    fn into_iter(self) -> Iter<'a> {
        self.iter()
    }
}

impl FromIterator<Change> for Changes {
    fn from_iter<T: IntoIterator<Item = Change>>(changes: T) -> Self {
        let mut packed = Self::new();
        changes.into_iter().for_each(|change| packed.push(change));
        packed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compressed_changes_are_read_back_from_any_time() {
        // Times of one to ten bytes; rows in which one channel changes, another one, several, or none.
        let mut all = Vec::new();
        let mut now = Change { tick: 0, levels: 5 };
        for k in 0..100_000_u64 {
            all.push(now);
            let noise = k.wrapping_mul(0x9e37_79b9_7f4a_7c15);
            now.tick += noise >> (24 + (k % 40)) | u64::from(k % 7 != 0);
            now.levels ^= match k % 11 {
                0 => noise,
                1 => 1 << 63,
                2 => 0,
                k if k < 6 => 1,
                k => 1 << (k % 3),
            };
        }
        all.push(Change { tick: u64::MAX, levels: 0 });
        let packed: Changes = all.iter().copied().collect();
        assert!(packed.blocks.len() > 2 && packed.iter().eq(all.iter().copied()));
        assert_eq!((packed.first(), packed.last()), (all.first().copied(), all.last().copied()));
        for at in [0, 1, 2, 9_000, 20_000, 99_999, 100_000] {
            let tick = all[at].tick;
            let first = all.partition_point(|change| change.tick <= tick) - 1;
            assert!(packed.iter_from(tick).eq(all[first..].iter().copied()), "{at}");
            let before = tick.saturating_sub(1);
            let first = all.partition_point(|change| change.tick <= before).saturating_sub(1);
            assert!(packed.iter_from(before).eq(all[first..].iter().copied()), "before {at}");
        }
        assert!(packed.into_iter().eq(all));
        assert_eq!(Changes::new().iter_from(3).next(), None);
    }

    #[test]
    fn step_pulses_take_two_bytes_per_change() {
        let packed: Changes =
            (0..1_000_000).map(|k| Change { tick: 400 * k + k % 5, levels: k & 1 }).collect();
        assert!(packed.bytes() <= 2 * packed.len() + packed.len() / 100, "{}", packed.bytes());
    }

    #[test]
    fn changes_are_read_back() {
        use crate::changes::{Change, Changes};

        let steps = (0..1000).map(|k| Change { tick: 700 * k, levels: k % 2 });
        let changes: Changes = steps.clone().collect();
        assert!(changes.iter().eq(steps.clone()) && changes.bytes() < 2 * 1000 + 100);
        assert!(changes.iter_from(350_000).eq(steps.skip(500)));
    }
}
