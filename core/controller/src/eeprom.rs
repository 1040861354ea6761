//! The EEPROM (CONTROLLER G7): bytes are written one after another, and a power cut leaves one half-written.
//!
//! ```text
//!  begun b       b + w         b + 2w
//!     ╎  byte 0    ╎   byte 1    ╎     a byte begun in b is complete in b + w, and the next begins
//!     ╎      ╎power off in b + x       0xFF if 2x < w, else new OR 0x0F; unchanged if x = 0
//! ```

use crate::parameters::Initial;
use alloc::{vec, vec::Vec};

const ERASED: u8 = 0xff;
/// Bits that stay erased in a byte whose write is cut in its second half.
const CUT_LATE: u8 = 0x0f;

#[derive(Clone, Debug)]
pub(crate) struct Eeprom {
    bytes: Vec<u8>,
    writes: Vec<u32>,
    byte_write_cycles: u64,
    writing: Option<Writing>,
}

/// A record being written: the byte in progress, and the remaining ones.
#[derive(Clone, Debug)]
struct Writing {
    address: usize,
    remaining: vec::IntoIter<u8>,
    byte: u8,
    begun: u64,
    /// The byte is not complete before this cycle, even after `byte_write_cycles`.
    not_before: u64,
    /// The same record is written again and again over itself. Only the wear changes, so no event is due.
    repeats: bool,
}

impl Eeprom {
    pub(crate) fn new(len: usize, byte_write_cycles: u32, initial: &Initial, factory: &[u8]) -> Self {
        let given: &[u8] = match initial {
            Initial::Blank => &[],
            Initial::Factory => factory,
            Initial::Bytes(given) => given,
        };
        let byte_write_cycles = u64::from(byte_write_cycles).max(1);
        let mut eeprom =
            Self { bytes: vec![ERASED; len], writes: vec![0; len], byte_write_cycles, writing: None };
        eeprom.load(given);
        eeprom
    }

    pub(crate) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    pub(crate) fn writes(&self) -> &[u32] {
        &self.writes
    }

    pub(crate) const fn is_idle(&self) -> bool {
        self.writing.is_none()
    }

    pub(crate) fn begun(&self) -> Option<u64> {
        self.writing.as_ref().map(|writing| writing.begun)
    }

    pub(crate) fn due(&self) -> u64 {
        let due = |writing: &Writing| match writing {
            Writing { repeats: true, .. } => u64::MAX,
            Writing { begun, not_before, .. } => {
                begun.saturating_add(self.byte_write_cycles).max(*not_before)
            }
        };
        self.writing.as_ref().map_or(u64::MAX, due)
    }

    /// When the byte in progress was begun, its address, and the byte.
    pub(crate) fn byte_in_progress(&self) -> Option<(u64, usize, u8)> {
        self.writing.as_ref().map(|writing| (writing.begun, writing.address, writing.byte))
    }

    /// Delays the byte in progress until `cycle`, because a chip's EEPROM is slower.
    pub(crate) const fn postpone(&mut self, cycle: u64) {
        if let Some(writing) = &mut self.writing {
            (writing.not_before, writing.repeats) = (cycle, false);
        }
    }

    pub(crate) fn load(&mut self, memory: &[u8]) {
        for (byte, given) in self.bytes.iter_mut().zip(memory) {
            *byte = *given;
        }
    }

    /// `repeats`: the same record will be needed again; this has an effect only if memory already holds its bytes.
    pub(crate) fn begin(&mut self, now: u64, address: usize, record: Vec<u8>, repeats: bool) {
        debug_assert!(self.writing.is_none(), "a record is being written");
        let current = self.bytes.get(address..address.saturating_add(record.len()));
        let repeats = repeats && current == Some(record.as_slice());
        let mut remaining = record.into_iter();
        let first = remaining.next();
        self.writing =
            first.map(|byte| Writing { address, remaining, byte, begun: now, not_before: 0, repeats });
    }

    /// Computes the wear and the byte in progress of a repeated record before `now`; then it is an ordinary record.
    pub(crate) fn catch_up(&mut self, now: u64) {
        let Some(writing) = self.writing.as_mut().filter(|writing| writing.repeats) else { return };
        writing.repeats = false;
        let bytes = 1 + writing.remaining.len() as u64;
        let written = now.saturating_sub(1).saturating_sub(writing.begun) / self.byte_write_cycles;
        let (records, part) = (written / bytes, written % bytes);
        let cells = self.writes.iter_mut().skip(writing.address).zip(0..bytes);
        for (writes, index) in cells {
            let more = u32::try_from(records + u64::from(index < part)).unwrap_or(u32::MAX);
            *writes = writes.saturating_add(more);
        }
        writing.begun += written * self.byte_write_cycles;
        for _ in 0..part {
            if let Some(byte) = writing.remaining.next() {
                (writing.byte, writing.address) = (byte, writing.address + 1);
            }
        }
    }

    /// Completes a byte due in cycle `now`; returns whether it was the last of its record.
    pub(crate) fn complete(&mut self, now: u64) -> bool {
        if self.due() > now {
            return false;
        }
        let Some(mut writing) = self.writing.take() else { return false };
        self.write(writing.address, writing.byte);
        let Some(byte) = writing.remaining.next() else { return true };
        let address = writing.address + 1;
        self.writing = Some(Writing { address, byte, begun: now, not_before: 0, repeats: false, ..writing });
        false
    }

    /// The power fails in `now`: drops the remaining bytes, and the one in progress if it began in `now`.
    pub(crate) fn finish_byte_only(&mut self, now: u64) {
        match &mut self.writing {
            Some(writing) if writing.begun < now => writing.remaining = Vec::new().into_iter(),
            writing => *writing = None,
        }
    }

    /// Leaves a byte in progress half-written.
    pub(crate) fn cut_power(&mut self, now: u64) {
        let Some(writing) = self.writing.take() else { return };
        let elapsed = now.saturating_sub(writing.begun);
        if elapsed > 0 {
            let is_early = elapsed.saturating_mul(2) < self.byte_write_cycles;
            self.write(writing.address, if is_early { ERASED } else { writing.byte | CUT_LATE });
        }
    }

    fn write(&mut self, address: usize, byte: u8) {
        if let (Some(cell), Some(writes)) = (self.bytes.get_mut(address), self.writes.get_mut(address)) {
            *cell = byte;
            *writes = writes.saturating_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eeprom() -> Eeprom {
        Eeprom::new(4, 10, &Initial::Bytes(vec![0x55; 4]), &[])
    }

    #[test]
    fn a_byte_is_complete_after_its_write_time_and_the_next_begins() {
        let mut eeprom = eeprom();
        eeprom.begin(100, 1, vec![1, 2], false);
        assert!(!eeprom.complete(109));
        assert_eq!(eeprom.bytes(), [0x55; 4]);
        assert!(!eeprom.complete(110));
        assert_eq!((eeprom.bytes(), eeprom.due()), (&[0x55, 1, 0x55, 0x55][..], 120));
        assert!(eeprom.complete(120) && eeprom.is_idle());
        assert_eq!((eeprom.bytes(), eeprom.writes()), (&[0x55, 1, 2, 0x55][..], &[0, 1, 1, 0][..]));
    }

    #[test]
    fn a_postponed_byte_is_complete_later_and_the_next_takes_its_own_time() {
        let mut eeprom = eeprom();
        eeprom.begin(100, 1, vec![1, 2], false);
        eeprom.postpone(115);
        assert!(!eeprom.complete(114) && eeprom.byte_in_progress() == Some((100, 1, 1)));
        assert!(!eeprom.complete(115) && eeprom.byte_in_progress() == Some((115, 2, 2)));
        assert_eq!((eeprom.bytes()[1], eeprom.due()), (1, 125));
        eeprom.postpone(90);
        assert_eq!(eeprom.due(), 125, "no byte takes less than w");
    }

    #[test]
    fn a_cut_byte_depends_on_the_time_since_its_begin() {
        // Cycle of the cut, byte in memory, writes.
        for (now, expected, writes) in
            [(100, 0x55, 0), (101, 0xff, 1), (104, 0xff, 1), (105, 0x2f, 1), (109, 0x2f, 1)]
        {
            let mut eeprom = eeprom();
            eeprom.begin(100, 0, vec![0x20, 0x21], false);
            eeprom.cut_power(now);
            assert_eq!((eeprom.bytes()[0], eeprom.writes()[0]), (expected, writes), "{now}");
            assert!(eeprom.is_idle());
        }
    }

    #[test]
    fn a_power_failure_ends_the_record_with_the_byte_in_progress() {
        // Cycle of the failure, whether the byte is finished.
        for (now, is_finished) in [(100, false), (101, true)] {
            let mut eeprom = eeprom();
            eeprom.begin(100, 0, vec![1, 2, 3], false);
            eeprom.finish_byte_only(now);
            assert_eq!(!eeprom.is_idle(), is_finished);
            assert_eq!(eeprom.complete(110), is_finished);
            assert!(eeprom.is_idle());
            assert_eq!(eeprom.bytes()[..2], if is_finished { [1, 0x55] } else { [0x55; 2] });
        }
    }

    #[test]
    fn a_repeated_record_equals_the_same_record_written_byte_by_byte() {
        for now in 100..200 {
            let mut plain = eeprom();
            plain.load(&[0x55, 1, 2, 3]);
            let mut repeated = plain.clone();
            plain.begin(100, 1, vec![1, 2, 3], true);
            repeated.begin(100, 1, vec![1, 2, 3], true);
            assert_eq!(repeated.due(), u64::MAX);
            // Byte by byte, begun again in the cycle in which it is complete.
            plain.catch_up(100);
            for cycle in 101..now {
                if plain.complete(cycle) {
                    plain.begin(cycle, 1, vec![1, 2, 3], false);
                }
            }
            repeated.catch_up(now);
            assert_eq!(repeated.writes(), plain.writes(), "{now}");
            assert_eq!(repeated.byte_in_progress(), plain.byte_in_progress(), "{now}");
        }
    }
}
