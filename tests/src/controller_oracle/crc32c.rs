//! CRC-32/ISCSI from its specification, over contiguous bytes.

/// CRC-32/ISCSI (A6): polynomial 0x1EDC6F41, reflected, all ones in and out.
pub(super) fn crc32c(bytes: &[u8]) -> u32 {
    let mut register = u32::MAX;
    for byte in bytes {
        register ^= u32::from(*byte);
        for _ in 0..8 {
            register = if register & 1 == 1 { register >> 1 ^ 0x82F6_3B78 } else { register >> 1 };
        }
    }
    !register
}
