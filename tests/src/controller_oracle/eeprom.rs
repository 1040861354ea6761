//! G7: the cells, the byte in progress, the records and banks as bytes.

use super::crc32c::crc32c;
use super::numbers;
use super::parameters::{Controller, Initial};

/// A journal record's length.
pub(super) const RECORD: usize = 16;

/// Contents of a journal record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "G7's words")]
pub struct Content {
    pub position: i32,
    pub trust: u8,
    pub open: bool,
    pub group: u8,
    pub of_loop: u16,
}

/// A valid journal record in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "G7's words")]
pub struct Record {
    pub slot: usize,
    pub seq: u32,
    pub content: Content,
}

/// seq u32, position i32, flags u8 (1..0 trust, 2 open), group u8, loop u16, CRC-32C of these.
pub fn journal_record(seq: u32, content: Content) -> Vec<u8> {
    let mut bytes = seq.to_le_bytes().to_vec();
    bytes.extend(content.position.to_le_bytes());
    bytes.push(content.trust | u8::from(content.open) << 2);
    bytes.push(content.group);
    bytes.extend(content.of_loop.to_le_bytes());
    with_check(bytes)
}

/// seq u32, the numbers as i32, CRC-32C of these.
pub fn numbers_bank(seq: u32, numbers: &[i64]) -> Vec<u8> {
    let mut bytes = seq.to_le_bytes().to_vec();
    for number in numbers {
        bytes.extend((*number as i32).to_le_bytes());
    }
    with_check(bytes)
}

fn with_check(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.extend(crc32c(&bytes).to_le_bytes());
    bytes
}

/// Whether the last four bytes are the CRC of the others.
fn is_valid(bytes: &[u8]) -> bool {
    let (body, check) = bytes.split_at(bytes.len() - 4);
    check == crc32c(body).to_le_bytes()
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

/// A record or a bank that is being written.
#[derive(Debug, Clone, PartialEq)]
struct Writing {
    address: usize,
    bytes: Vec<u8>,
    /// The byte in progress.
    at: usize,
    /// Cycle in which it began.
    begun: u64,
    /// The bytes after the one in progress are dropped.
    rest_dropped: bool,
}

/// The memory of a controller.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Eeprom {
    pub(super) cells: Vec<u8>,
    /// Writes of each cell.
    pub(super) writes: Vec<u32>,
    slots: usize,
    writing: Option<Writing>,
    /// The opening record of `power_loss` (G7).
    pub(super) opening_is_wanted: bool,
    pub(super) save_is_wanted: bool,
}

/// Bytes of a controller's memory.
pub(super) fn size(controller: &Controller) -> usize {
    RECORD * controller.memory.slots + 2 * (8 + 4 * numbers::count(controller))
}

impl Eeprom {
    pub(super) fn new(controller: &Controller) -> Self {
        let size = size(controller);
        let mut cells = vec![0xFF; size];
        let factory = Content { position: 0, trust: 2, open: false, group: 0, of_loop: 0 };
        let initial = match &controller.memory.initial {
            Initial::Blank => Vec::new(),
            Initial::Factory => journal_record(1, factory),
            Initial::Bytes(bytes) => bytes.clone(),
        };
        cells[..initial.len()].copy_from_slice(&initial);
        Self {
            cells,
            writes: vec![0; size],
            slots: controller.memory.slots,
            writing: None,
            opening_is_wanted: false,
            save_is_wanted: false,
        }
    }

    pub(super) fn is_idle(&self) -> bool {
        self.writing.is_none()
    }

    /// A record of the journal is being written.
    // Reading: a bank of numbers that is being written leaves the memory open.
    pub(super) fn is_writing_record(&self) -> bool {
        self.writing.as_ref().is_some_and(|writing| writing.address < RECORD * self.slots)
    }

    /// The newest complete record: valid, maximum seq, the last one of equals.
    // Reading: only the bytes decide; only the slot that is being written has no complete record.
    // Reading: seq is compared without wrapping: after 2^32 - 1 the record of seq 0 is not the newest.
    pub(super) fn newest(&self) -> Option<Record> {
        let mut newest: Option<Record> = None;
        for slot in 0..self.slots {
            let address = RECORD * slot;
            let bytes = &self.cells[address..address + RECORD];
            let under_way = self.writing.as_ref().is_some_and(|writing| writing.address == address);
            if under_way || !is_valid(bytes) {
                continue;
            }
            let seq = word(bytes, 0);
            if newest.is_none_or(|newest| seq >= newest.seq) {
                let content = Content {
                    position: word(bytes, 4) as i32,
                    trust: bytes[8] & 3,
                    open: bytes[8] >> 2 & 1 == 1,
                    group: bytes[9],
                    of_loop: u16::from_le_bytes([bytes[10], bytes[11]]),
                };
                newest = Some(Record { slot, seq, content });
            }
        }
        newest
    }

    /// The newest valid bank (0 or 1), its seq, its numbers.
    pub(super) fn newest_bank(&self) -> Option<(usize, u32, Vec<i64>)> {
        let mut newest: Option<(usize, u32, Vec<i64>)> = None;
        let length = self.bank_length();
        for bank in 0..2 {
            let address = RECORD * self.slots + length * bank;
            let bytes = &self.cells[address..address + length];
            if !is_valid(bytes) {
                continue;
            }
            let seq = word(bytes, 0);
            if newest.as_ref().is_none_or(|newest| seq >= newest.1) {
                let numbers =
                    (4..length - 4).step_by(4).map(|at| i64::from(word(bytes, at) as i32)).collect();
                newest = Some((bank, seq, numbers));
            }
        }
        newest
    }

    fn bank_length(&self) -> usize {
        (self.cells.len() - RECORD * self.slots) / 2
    }

    /// A record begins in c: slot after the newest complete one, seq + 1 (none: slot 0, seq 1).
    pub(super) fn begin_record(&mut self, content: Content, c: u64) {
        let (slot, seq) = self
            .newest()
            .map_or((0, 1), |newest| ((newest.slot + 1) % self.slots, newest.seq.wrapping_add(1)));
        self.begin(RECORD * slot, journal_record(seq, content), c);
    }

    /// A bank begins in c: the one that is not the newest valid one.
    pub(super) fn begin_bank(&mut self, numbers: &[i64], c: u64) {
        let (bank, seq) = self.newest_bank().map_or((0, 1), |(bank, seq, _)| (1 - bank, seq.wrapping_add(1)));
        self.begin(RECORD * self.slots + bank * self.bank_length(), numbers_bank(seq, numbers), c);
    }

    fn begin(&mut self, address: usize, bytes: Vec<u8>, c: u64) {
        self.writing = Some(Writing { address, bytes, at: 0, begun: c, rest_dropped: false });
    }

    /// Cycle in which the byte in progress is complete.
    pub(super) fn byte_ends(&self, controller: &Controller) -> Option<u64> {
        self.writing.as_ref().map(|writing| writing.begun + controller.memory.byte_write_cycles)
    }

    /// A byte is complete in c and the next begins; `true`: a record of the journal is complete.
    pub(super) fn byte_complete(&mut self, c: u64) -> bool {
        let record = self.is_writing_record();
        let Some(writing) = &mut self.writing else { return false };
        let cell = writing.address + writing.at;
        self.cells[cell] = writing.bytes[writing.at];
        // Reading: a write is counted when its byte is complete or cut.
        self.writes[cell] += 1;
        writing.at += 1;
        writing.begun = c;
        let whole = writing.at == writing.bytes.len();
        if whole || writing.rest_dropped {
            self.writing = None;
        }
        whole && record
    }

    /// POWER_LOSS in c: the byte in progress is finished (one begun in c is not), the others are dropped.
    // Reading: this applies to a bank, too.
    pub(super) fn drop_rest(&mut self, c: u64) {
        match &mut self.writing {
            // Reading: a byte begun in c is not a write of its cell.
            Some(writing) if writing.begun < c => writing.rest_dropped = true,
            _ => self.writing = None,
        }
        self.opening_is_wanted = false;
        self.save_is_wanted = false;
    }

    /// OFF in c: x = c - b > 0 of w cycles of the byte in progress have passed.
    pub(super) fn byte_dies(&mut self, c: u64, w: u64) {
        let Some(writing) = self.writing.take() else { return };
        let x = c - writing.begun;
        if x == 0 {
            return;
        }
        let cell = writing.address + writing.at;
        self.cells[cell] =
            if 2 * u128::from(x) < u128::from(w) { 0xFF } else { writing.bytes[writing.at] | 0x0F };
        self.writes[cell] += 1;
    }
}
