//! The bus between a driver and the peripheral's registers.

/// Reads and writes registers: on a chip a volatile load and store, in a test the model.
///
/// Offsets are in bytes from the peripheral's base, in steps of 4; every access is 32 bits wide.
pub trait RegisterBus {
    /// Reads the register at `offset`.
    fn read(&mut self, offset: u32) -> u32;

    /// Writes the register at `offset`.
    fn write(&mut self, offset: u32, value: u32);
}

impl<B: RegisterBus> RegisterBus for &mut B {
    fn read(&mut self, offset: u32) -> u32 {
        (**self).read(offset)
    }

    fn write(&mut self, offset: u32, value: u32) {
        (**self).write(offset, value);
    }
}
