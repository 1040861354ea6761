//! Records of the memory (CONTROLLER G7): the journal of positions, and two banks of numbers.
//!
//! ```text
//! record   seq u32 | position i32 | flags u8 | group u8 | loop u16 | CRC-32C     16 bytes, from address 16*slot
//! bank     seq u32 | numbers as i32, …                             | CRC-32C     8 + 4*n bytes, behind the journal
//! ```

use alloc::vec::Vec;
use core::ops::Range;
use crc::{CRC_32_ISCSI, Crc};

pub(crate) const RECORD: usize = 16;
const WORD: usize = 4;
const TRUST: u8 = 3;
const OPEN: u8 = 4;

const CHECK: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    pub(crate) position: i32,
    pub(crate) trust: u8,
    /// Whether the position is unknown while this is the newest record.
    pub(crate) is_open: bool,
    pub(crate) group: u8,
    pub(crate) loop_: u16,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Valid {
    slot: usize,
    seq: u32,
    pub(crate) entry: Entry,
}

fn checked(seq: u32, content: impl IntoIterator<Item = u8>) -> Vec<u8> {
    let mut bytes: Vec<u8> = seq.to_le_bytes().into_iter().chain(content).collect();
    bytes.extend(CHECK.checksum(&bytes).to_le_bytes());
    bytes
}

fn opened(bytes: &[u8]) -> Option<(u32, &[u8])> {
    let (content, check) = bytes.split_last_chunk::<WORD>()?;
    let (seq, rest) = content.split_first_chunk::<WORD>()?;
    (CHECK.checksum(content) == u32::from_le_bytes(*check)).then_some((u32::from_le_bytes(*seq), rest))
}

impl Entry {
    fn bytes(self) -> impl Iterator<Item = u8> {
        let flags = self.trust & TRUST | if self.is_open { OPEN } else { 0 };
        let position = self.position.to_le_bytes();
        position.into_iter().chain([flags, self.group]).chain(self.loop_.to_le_bytes())
    }

    fn of(content: &[u8]) -> Option<Self> {
        let &[a, b, c, d, flags, group, low, high] = content else { return None };
        Some(Self {
            position: i32::from_le_bytes([a, b, c, d]),
            trust: flags & TRUST,
            is_open: flags & OPEN != 0,
            group,
            loop_: u16::from_le_bytes([low, high]),
        })
    }
}

/// The newest record of a journal of `slots`: valid, with the maximum sequence number; of equal ones the last.
pub(crate) fn newest(memory: &[u8], slots: usize) -> Option<Valid> {
    let records = memory.chunks_exact(RECORD).take(slots).enumerate();
    let valid = records.filter_map(|(slot, bytes)| {
        let (seq, content) = opened(bytes)?;
        Some(Valid { slot, seq, entry: Entry::of(content)? })
    });
    valid.max_by_key(|valid| valid.seq)
}

/// Address and bytes of the record after the newest one.
pub(crate) fn next(newest: Option<Valid>, slots: usize, entry: Entry) -> (usize, Vec<u8>) {
    let (slot, seq) =
        newest.map_or((0, 1), |newest| ((newest.slot + 1) % slots.max(1), newest.seq.wrapping_add(1)));
    (slot * RECORD, checked(seq, entry.bytes()))
}

/// The record of a factory memory: closed, position 0, trust 2.
pub(crate) fn factory() -> Vec<u8> {
    next(None, 1, Entry { position: 0, trust: 2, is_open: false, group: 0, loop_: 0 }).1
}

/// Address range of bank 0 or 1 of `numbers` numbers after a journal of `slots`.
fn bank(slots: usize, numbers: usize, index: usize) -> Range<usize> {
    let len = 2 * WORD + WORD * numbers;
    let start = RECORD * slots + index * len;
    start..start + len
}

/// Index, sequence number and numbers of the newest valid bank.
fn newest_bank(memory: &[u8], slots: usize, numbers: usize) -> Option<(usize, u32, Vec<i32>)> {
    let banks = [0, 1].into_iter().filter_map(|index| {
        let (seq, content) = opened(memory.get(bank(slots, numbers, index))?)?;
        Some((index, seq, content))
    });
    let (index, seq, content) = banks.max_by_key(|&(_, seq, _)| seq)?;
    let words = content.chunks_exact(WORD).filter_map(|word| Some(i32::from_le_bytes(word.try_into().ok()?)));
    Some((index, seq, words.collect()))
}

pub(crate) fn saved(memory: &[u8], slots: usize, numbers: usize) -> Option<Vec<i32>> {
    Some(newest_bank(memory, slots, numbers)?.2)
}

/// Address and bytes to save these numbers in the bank that is not the newest.
pub(crate) fn save(memory: &[u8], slots: usize, numbers: &[i32]) -> (usize, Vec<u8>) {
    let newest = newest_bank(memory, slots, numbers.len());
    let (index, seq) = newest.map_or((0, 1), |(index, seq, _)| (1 - index, seq.wrapping_add(1)));
    let content = numbers.iter().flat_map(|number| number.to_le_bytes());
    (bank(slots, numbers.len(), index).start, checked(seq, content))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    fn entry(position: i32) -> Entry {
        Entry { position, trust: 1, is_open: true, group: 3, loop_: 0x0102 }
    }

    #[test]
    fn a_record_has_its_fields_at_their_bytes() {
        let newest = Some(Valid { slot: 7, seq: 0x0a0b_0c0d, entry: entry(0) });
        let (address, bytes) = next(newest, 8, entry(-2));
        assert_eq!(address, 0, "after the last slot comes the first");
        assert_eq!(bytes[..12], [0x0e, 0x0c, 0x0b, 0x0a, 0xfe, 0xff, 0xff, 0xff, 5, 3, 2, 1]);
        let expected = Valid { slot: 0, seq: 0x0a0b_0c0e, entry: entry(-2) };
        assert_eq!(super::newest(&bytes, 8), Some(expected));
        for bit in 0..128 {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(super::newest(&damaged, 8), None, "bit {bit}");
        }
    }

    #[test]
    fn the_check_is_the_castagnoli_one() {
        assert_eq!(CHECK.checksum(b"123456789"), 0xe306_9283);
        assert_eq!(newest(&[0xff; 64], 4), None, "an erased memory has no record");
        assert_eq!(saved(&[0xff; 4096], 4, 13), None, "and no numbers");
    }

    #[test]
    fn the_newest_record_has_the_greatest_number_and_of_equals_the_last_slot() {
        let record = |seq: u32, position| checked(seq, entry(position).bytes());
        // Sequence numbers of the slots, the slot that is newest.
        for (seqs, expected) in
            [([1, 2, 3], 2), ([5, 2, 5], 2), ([5, 5, 1], 1), ([u32::MAX, 0, 1], 0), ([0, 0, 0], 2)]
        {
            let memory: Vec<u8> = seqs.iter().flat_map(|&seq| record(seq, 0)).collect();
            assert_eq!(newest(&memory, 3).map(|valid| valid.slot), Some(expected), "{seqs:?}");
        }
    }

    #[test]
    fn numbers_go_into_the_bank_that_is_not_the_newest() {
        let mut memory = vec![0xff; 2 * RECORD + 2 * (8 + 4 * 9)];
        for (numbers, expected) in [([1; 9], 32), ([-2; 9], 32 + 44), ([3; 9], 32), ([4; 9], 32 + 44)] {
            let (address, bytes) = save(&memory, 2, &numbers);
            assert_eq!((address, bytes.len()), (expected, 44));
            memory[address..address + 44].copy_from_slice(&bytes);
            assert_eq!(saved(&memory, 2, 9), Some(numbers.to_vec()));
        }
    }
}
