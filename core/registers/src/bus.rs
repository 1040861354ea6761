//! What a driver reaches the peripheral through.

/// A bus on which the peripheral's registers are.
///
/// Offsets are in bytes from the peripheral's base, in steps of 4; every access is 32 bits wide. On a
/// chip this is a volatile load and store, in a test it is the model.
pub trait RegisterBus {
    /// Reads the register at `offset`.
    fn read(&mut self, offset: u32) -> u32;

    /// Writes the register at `offset`.
    fn write(&mut self, offset: u32, value: u32);
}

/// A driver may borrow the bus.
impl<B: RegisterBus> RegisterBus for &mut B {
    fn read(&mut self, offset: u32) -> u32 {
        (**self).read(offset)
    }

    fn write(&mut self, offset: u32, value: u32) {
        (**self).write(offset, value);
    }
}
