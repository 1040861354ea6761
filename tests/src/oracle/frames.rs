//! A6 on the wire: CRC-32C, COBS and frames, written independently of the core.

use super::{CRC, OVERLONG, SHORT_PACKET};

/// Maximum decoded bytes; more are OVERLONG.
pub const LONGEST_FRAME: usize = 600;

/// CRC-32/ISCSI (Castagnoli): polynomial 0x1EDC6F41 with its bits reversed, all ones before and after.
pub fn crc32c(bytes: &[u8]) -> u32 {
    let mut crc = u32::MAX;
    for byte in bytes {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 { crc >> 1 ^ 0x82F6_3B78 } else { crc >> 1 };
        }
    }
    !crc
}

/// COBS of `bytes`, without the 0x00 that ends a frame: blocks of up to 254 bytes that are not zero, each after a
/// code byte, its length + 1; a shorter block is followed by an implied zero, except the last one.
pub fn cobs(bytes: &[u8]) -> Vec<u8> {
    let mut encoded = Vec::new();
    let mut block: Vec<u8> = Vec::new();
    // Nothing follows a full block at the very end.
    let mut block_due = true;
    let mut put = |block: &mut Vec<u8>| {
        encoded.push(block.len() as u8 + 1);
        encoded.append(block);
    };
    for &byte in bytes {
        block_due = true;
        if byte == 0 {
            put(&mut block);
        } else {
            block.push(byte);
            if block.len() == 254 {
                put(&mut block);
                block_due = false;
            }
        }
    }
    if block_due {
        put(&mut block);
    }
    encoded
}

/// The bytes of a valid frame on the wire: COBS of `address kind body crc`, then 0x00.
pub fn frame(address: u8, kind: u8, body: &[u8]) -> Vec<u8> {
    let mut decoded = vec![address, kind];
    decoded.extend(body);
    let crc = crc32c(&decoded);
    decoded.extend(crc.to_le_bytes());
    let mut wire = cobs(&decoded);
    wire.push(0x00);
    wire
}

/// Contents of an accepted frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Frame {
    pub(super) address: u8,
    pub(super) kind: u8,
    pub(super) body: Vec<u8>,
}

/// The run of bytes since the last 0x00, decoded so far.
#[derive(Default)]
pub(super) struct Frames {
    decoded: Vec<u8>,
    /// At least one byte has arrived since the last 0x00.
    begun: bool,
    /// Remaining bytes of the block; 0: the next byte is a code.
    left_in_block: u8,
    /// The block is followed by an implied zero, if another code follows.
    owes_zero: bool,
    /// OVERLONG: "everything up to and including the next 0x00 is dropped, with no further flag".
    dropping: bool,
}

impl Frames {
    /// Processes a delivered byte: returns the accepted frame that it completes, or the fault that it sets.
    ///
    /// Reading: a 0x00 before any other byte since reset is "nothing", like one after a 0x00.
    /// Reading: a block of 254 ends a run with or without a code 0x01 after it; both
    /// decode to the same bytes.
    pub(super) fn hear(&mut self, byte: u8) -> Result<Option<Frame>, u16> {
        if byte == 0x00 {
            let run = std::mem::take(self);
            return if run.dropping || !run.begun { Ok(None) } else { run.judged().map(Some) };
        }
        if self.dropping {
            return Ok(None);
        }
        self.begun = true;
        if self.left_in_block == 0 {
            if self.owes_zero {
                self.decode(0)?;
            }
            self.left_in_block = byte - 1;
            self.owes_zero = byte != 0xFF;
        } else {
            self.left_in_block -= 1;
            self.decode(byte)?;
        }
        Ok(None)
    }

    fn decode(&mut self, byte: u8) -> Result<(), u16> {
        if self.decoded.len() == LONGEST_FRAME {
            self.dropping = true;
            return Err(OVERLONG);
        }
        self.decoded.push(byte);
        Ok(())
    }

    /// Checks a run that a 0x00 has ended: "a run that is not COBS or decodes to fewer than 6 bytes (SHORT_PACKET);
    /// a failed check (CRC, judged before the address)".
    fn judged(self) -> Result<Frame, u16> {
        if self.left_in_block > 0 || self.decoded.len() < 6 {
            return Err(SHORT_PACKET);
        }
        let (said, check) = self.decoded.split_at(self.decoded.len() - 4);
        if crc32c(said).to_le_bytes() != check {
            return Err(CRC);
        }
        Ok(Frame { address: said[0], kind: said[1], body: said[2..].to_vec() })
    }
}
