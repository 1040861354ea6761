//! Records of the memory (CONTROLLER G7): the journal of positions, and two banks of numbers.
//!
//! ```text
//! record   seq u32 | position i32 | flags u8 | group u8 | loop u16 | CRC-32C     16 bytes, from address 16*slot
//! bank     seq u32 | numbers as i32, …                             | CRC-32C     8 + 4*n bytes, behind the journal
//! ```

use crate::state::trust;
use alloc::vec::Vec;
use core::ops::Range;
use crc::{CRC_32_ISCSI, Crc};

pub(crate) const RECORD: usize = 16;
const WORD: usize = 4;
const TRUST_MASK: u8 = 3;
const OPEN_FLAG: u8 = 4;

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    pub(crate) position: i32,
    pub(crate) trust: u8,
    /// Whether the axis may move, so that the position is unknown while this is the newest record.
    pub(crate) is_open: bool,
    pub(crate) group: u8,
    pub(crate) loop_: u16,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ValidRecord {
    slot: usize,
    seq: u32,
    pub(crate) entry: Entry,
}

fn with_crc(seq: u32, content: impl IntoIterator<Item = u8>) -> Vec<u8> {
    let mut bytes: Vec<u8> = seq.to_le_bytes().into_iter().chain(content).collect();
    bytes.extend(CRC.checksum(&bytes).to_le_bytes());
    bytes
}

/// The sequence number and the content, if the CRC is correct.
fn verified(bytes: &[u8]) -> Option<(u32, &[u8])> {
    let (covered, crc) = bytes.split_last_chunk::<WORD>()?;
    let (seq, content) = covered.split_first_chunk::<WORD>()?;
    (CRC.checksum(covered) == u32::from_le_bytes(*crc)).then_some((u32::from_le_bytes(*seq), content))
}

impl Entry {
    fn bytes(self) -> impl Iterator<Item = u8> {
        let flags = self.trust & TRUST_MASK | if self.is_open { OPEN_FLAG } else { 0 };
        let position = self.position.to_le_bytes();
        position.into_iter().chain([flags, self.group]).chain(self.loop_.to_le_bytes())
    }

    fn parse(content: &[u8]) -> Option<Self> {
        let &[a, b, c, d, flags, group, low, high] = content else { return None };
        Some(Self {
            position: i32::from_le_bytes([a, b, c, d]),
            trust: flags & TRUST_MASK,
            is_open: flags & OPEN_FLAG != 0,
            group,
            loop_: u16::from_le_bytes([low, high]),
        })
    }
}

/// The valid record with the maximum sequence number; if several have it, the last one.
pub(crate) fn newest(memory: &[u8], slots: usize) -> Option<ValidRecord> {
    let records = memory.chunks_exact(RECORD).take(slots).enumerate();
    let valid = records.filter_map(|(slot, bytes)| {
        let (seq, content) = verified(bytes)?;
        Some(ValidRecord { slot, seq, entry: Entry::parse(content)? })
    });
    valid.max_by_key(|valid| valid.seq)
}

/// Address and bytes of the record after the newest one.
pub(crate) fn next_record(newest: Option<ValidRecord>, slots: usize, entry: Entry) -> (usize, Vec<u8>) {
    let (slot, seq) =
        newest.map_or((0, 1), |newest| ((newest.slot + 1) % slots.max(1), newest.seq.wrapping_add(1)));
    (slot * RECORD, with_crc(seq, entry.bytes()))
}

/// The record of a factory memory: closed, position 0, trust 2.
pub(crate) fn factory() -> Vec<u8> {
    next_record(None, 1, Entry { position: 0, trust: trust::SURE, is_open: false, group: 0, loop_: 0 }).1
}

/// Address range of bank 0 or 1 of `numbers` numbers after a journal of `slots`.
fn bank(slots: usize, numbers: usize, index: usize) -> Range<usize> {
    let len = 2 * WORD + WORD * numbers;
    let start = RECORD * slots + index * len;
    start..start + len
}

/// Size of a memory: the journal and both banks.
pub(crate) fn memory_len(slots: usize, numbers: usize) -> usize {
    bank(slots, numbers, 1).end
}

/// Index, sequence number and numbers of the newest valid bank.
fn newest_bank(memory: &[u8], slots: usize, numbers: usize) -> Option<(usize, u32, Vec<i32>)> {
    let banks = [0, 1].into_iter().filter_map(|index| {
        let (seq, content) = verified(memory.get(bank(slots, numbers, index))?)?;
        Some((index, seq, content))
    });
    let (index, seq, content) = banks.max_by_key(|&(_, seq, _)| seq)?;
    let words = content.chunks_exact(WORD).filter_map(|word| Some(i32::from_le_bytes(word.try_into().ok()?)));
    Some((index, seq, words.collect()))
}

pub(crate) fn saved_numbers(memory: &[u8], slots: usize, numbers: usize) -> Option<Vec<i32>> {
    Some(newest_bank(memory, slots, numbers)?.2)
}

/// Address and bytes that save these numbers in the older bank.
pub(crate) fn numbers_record(memory: &[u8], slots: usize, numbers: &[i32]) -> (usize, Vec<u8>) {
    let newest = newest_bank(memory, slots, numbers.len());
    let (index, seq) = newest.map_or((0, 1), |(index, seq, _)| (1 - index, seq.wrapping_add(1)));
    let content = numbers.iter().flat_map(|number| number.to_le_bytes());
    (bank(slots, numbers.len(), index).start, with_crc(seq, content))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    fn entry(position: i32) -> Entry {
        Entry { position, trust: 1, is_open: true, group: 3, loop_: 0x0102 }
    }

    #[test]
    fn a_record_has_the_documented_layout() {
        let newest = Some(ValidRecord { slot: 7, seq: 0x0a0b_0c0d, entry: entry(0) });
        let (address, bytes) = next_record(newest, 8, entry(-2));
        assert_eq!(address, 0, "after the last slot comes the first");
        assert_eq!(bytes[..12], [0x0e, 0x0c, 0x0b, 0x0a, 0xfe, 0xff, 0xff, 0xff, 5, 3, 2, 1]);
        let expected = ValidRecord { slot: 0, seq: 0x0a0b_0c0e, entry: entry(-2) };
        assert_eq!(super::newest(&bytes, 8), Some(expected));
        for bit in 0..128 {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(super::newest(&damaged, 8), None, "bit {bit}");
        }
    }

    #[test]
    fn the_crc_is_crc_32c() {
        assert_eq!(CRC.checksum(b"123456789"), 0xe306_9283);
        assert_eq!(newest(&[0xff; 64], 4), None, "an erased memory has no record");
        assert_eq!(saved_numbers(&[0xff; 4096], 4, 13), None, "an erased memory has no numbers");
    }

    #[test]
    fn the_newest_record_has_the_maximum_number_or_the_last_slot_of_equals() {
        let record = |seq: u32, position| with_crc(seq, entry(position).bytes());
        // Sequence numbers of the slots, the slot that is newest.
        for (seqs, expected) in
            [([1, 2, 3], 2), ([5, 2, 5], 2), ([5, 5, 1], 1), ([u32::MAX, 0, 1], 0), ([0, 0, 0], 2)]
        {
            let memory: Vec<u8> = seqs.iter().flat_map(|&seq| record(seq, 0)).collect();
            assert_eq!(newest(&memory, 3).map(|valid| valid.slot), Some(expected), "{seqs:?}");
        }
    }

    #[test]
    fn numbers_are_written_to_the_older_bank() {
        let mut memory = vec![0xff; 2 * RECORD + 2 * (8 + 4 * 9)];
        for (numbers, expected) in [([1; 9], 32), ([-2; 9], 32 + 44), ([3; 9], 32), ([4; 9], 32 + 44)] {
            let (address, bytes) = numbers_record(&memory, 2, &numbers);
            assert_eq!((address, bytes.len()), (expected, 44));
            memory[address..address + 44].copy_from_slice(&bytes);
            assert_eq!(saved_numbers(&memory, 2, 9), Some(numbers.to_vec()));
        }
    }
}
