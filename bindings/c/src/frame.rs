//! Frames of the framed protocol.

use crate::pointer::{self, Buffer};
use crate::status::{Failure, RANGE, Status, checked};
use stepscope_core::peripheral::wire::frame::{MAX_BODY, decode_frame, emit};

/// Encodes a frame for the line: CRC, COBS and the closing 0x00. `length` is at most 594 bytes, and 604 bytes hold any frame.
/// `body` may be NULL if `length` is 0. `out` NULL with capacity 0 returns only the count.
///
/// Returns STEPSCOPE_RANGE (the body is too long), _BUFFER, _NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_encode_frame(
    address: u8,
    kind: u8,
    body: *const u8,
    length: usize,
    out: *mut u8,
    capacity: usize,
    count: *mut usize,
) -> Status {
    checked(|| {
        // SAFETY: the header asks for pointers that are NULL or valid for their lengths.
        unsafe {
            let buffer = Buffer::new(out, capacity, count)?;
            if length > MAX_BODY {
                let message = format!("{length} bytes are out of range; use 0 to {MAX_BODY}");
                return Err(Failure::new(RANGE, "length", message));
            }
            buffer.fill(emit(address, kind, pointer::items("body", body, length)?))
        }
    })
}

/// Decodes one frame; its closing 0x00 may be missing. Writes address, kind, and the body, which has at most 594 bytes.
///
/// Returns STEPSCOPE_RANGE (no frame: COBS or CRC are wrong, or there is more than one), _BUFFER (the body is longer; address
/// and kind are written), _NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn stepscope_decode_frame(
    data: *const u8,
    length: usize,
    address: *mut u8,
    kind: *mut u8,
    out: *mut u8,
    capacity: usize,
    count: *mut usize,
) -> Status {
    checked(|| {
        // SAFETY: the header asks for pointers that are NULL or valid for their lengths.
        unsafe {
            let buffer = Buffer::new(out, capacity, count)?;
            let data = pointer::items("data", data, length)?;
            let (frame_address, frame_kind, body) = decode_frame(data).ok_or_else(|| {
                Failure::new(RANGE, "data", "no frame; use the bytes of one, with COBS and CRC")
            })?;
            pointer::put("address", address, frame_address)?;
            pointer::put("kind", kind, frame_kind)?;
            buffer.fill(body.iter().copied())
        }
    })
}
