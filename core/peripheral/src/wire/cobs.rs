//! A byte-wise COBS decoder that reports the role of each byte (DESIGN A6): controller, host and dissector share it.
//!
//! ```text
//! wire     code  d  d  code  d  …  00       a code is the distance to the next zero, or to the end
//! content        d  d    0   d  …           255 is the distance to the next code, without a zero there
//! ```

use cobs::{DecodeResult, DecoderState};

/// The role of a byte in a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CobsByte {
    First,
    /// A code without a zero, or the zero of an empty run.
    Overhead,
    Content,
    /// A code in place of a zero in the content.
    Zero,
    /// The delimiter of a complete frame.
    End,
    /// A delimiter too early: the bytes before it are not COBS.
    Broken,
}

impl CobsByte {
    /// The content of `byte` in this role.
    pub const fn content(self, byte: u8) -> Option<u8> {
        match self {
            Self::Content => Some(byte),
            Self::Zero => Some(0),
            Self::First | Self::Overhead | Self::End | Self::Broken => None,
        }
    }
}

/// Decodes frames byte by byte.
#[derive(Debug)]
pub struct CobsDecoder(DecoderState);

impl Clone for CobsDecoder {
    #[allow(clippy::needless_match, reason = "the decoder's state has no Clone of its own")]
    fn clone(&self) -> Self {
        Self(match self.0 {
            DecoderState::Idle => DecoderState::Idle,
            DecoderState::Grab(left) => DecoderState::Grab(left),
            DecoderState::GrabChain(left) => DecoderState::GrabChain(left),
        })
    }
}

impl Default for CobsDecoder {
    fn default() -> Self {
        Self(DecoderState::Idle)
    }
}

impl CobsDecoder {
    /// Takes the next byte; returns its role.
    pub fn byte(&mut self, byte: u8) -> CobsByte {
        match self.0.feed(byte) {
            Ok(DecodeResult::DataStart) => CobsByte::First,
            Ok(DecodeResult::NoData) => CobsByte::Overhead,
            Ok(DecodeResult::DataContinue(0)) => CobsByte::Zero,
            Ok(DecodeResult::DataContinue(_)) => CobsByte::Content,
            Ok(DecodeResult::DataComplete) => CobsByte::End,
            Err(_) => CobsByte::Broken,
        }
    }

    /// Whether bytes wait for their delimiter.
    pub const fn is_open(&self) -> bool {
        !matches!(self.0, DecoderState::Idle)
    }

    /// Whether a delimiter would now end a complete frame.
    pub const fn is_complete(&self) -> bool {
        matches!(self.0, DecoderState::Grab(0) | DecoderState::GrabChain(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use CobsByte::{Broken, Content, End, First, Overhead, Zero};
    use alloc::vec::Vec;

    #[test]
    fn each_byte_has_its_role() {
        let rows: [(&[u8], &[CobsByte]); 4] = [
            (&[0, 0], &[Overhead, Overhead]),
            (&[2, 7, 1, 2, 9, 0], &[First, Content, Zero, Zero, Content, End]),
            (&[3, 7, 0, 1, 0], &[First, Content, Broken, First, End]),
            (&[1, 1], &[First, Zero]),
        ];
        for (wire, expected) in rows {
            let mut reader = CobsDecoder::default();
            let found: Vec<_> = wire.iter().map(|&byte| reader.byte(byte)).collect();
            assert_eq!(found, expected, "{wire:?}");
        }
    }

    #[test]
    fn a_run_of_254_bytes_ends_without_a_zero() {
        let mut reader = CobsDecoder::default();
        let wire = [[255].as_slice(), &[5; 254], &[2, 6]].concat();
        let found: Vec<_> = wire.iter().map(|&byte| reader.byte(byte)).collect();
        assert_eq!((found[0], found[254], found[255], found[256]), (First, Content, Overhead, Content));
        assert!(reader.is_complete() && reader.is_open());
    }
}
