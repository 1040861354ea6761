//! Types of the register table, and the macro that derives constants and data from it.
//!
//! ```
//! use stepscope_registers::{MAP, status, table::Access};
//!
//! // A field extracts and inserts its value.
//! assert_eq!(status::STATE.extract(status::STATE.insert(status::STATE_MOVING)), status::STATE_MOVING);
//! // The map as data: the registers that can be written.
//! let mut writable = MAP.iter().filter(|register| register.access != Access::Ro);
//! assert!(writable.any(|register| register.name == "CONTROL"));
//! ```

/// How software can access a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Read only: writes are ignored.
    Ro,
    /// Read and write.
    Rw,
    /// Write only: reads as 0.
    Wo,
    /// Read; writing a one to a bit clears it.
    W1c,
}

impl Access {
    /// Abbreviation in the data sheet.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ro => "RO",
            Self::Rw => "RW",
            Self::Wo => "WO",
            Self::W1c => "W1C",
        }
    }
}

/// A register's value after reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reset {
    /// The same value in every peripheral.
    Fixed(u32),
    /// Set by the configuration that the peripheral was built with.
    Configured,
}

/// A register, or an array of registers.
#[derive(Clone, Copy, Debug)]
pub struct Register {
    /// For an array, without the index.
    pub name: &'static str,
    /// In bytes from the peripheral's base; for an array that of the first register.
    pub offset: u32,
    /// Number of registers, 4 bytes apart.
    pub count: u32,
    /// What reads and writes do.
    pub access: Access,
    /// The value after reset.
    pub reset: Reset,
    /// Description in sentences.
    pub meaning: &'static str,
    /// In ascending order of bits; bits outside of all fields are reserved.
    pub fields: &'static [Field],
}

/// Bits of a register with a common meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// As in the data sheet, such as `CHANNELS`.
    pub name: &'static str,
    /// Lowest bit, 0 to 31.
    pub low: u32,
    /// Highest bit, `low` to 31.
    pub high: u32,
    /// Description in sentences.
    pub meaning: &'static str,
    /// Values that have names.
    pub values: &'static [NamedValue],
}

/// One value of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedValue {
    /// Name of its constant, which begins with the field's.
    pub name: &'static str,
    /// Value of the field, not shifted to the field's bits.
    pub value: u32,
    /// Description in sentences.
    pub meaning: &'static str,
}

impl Field {
    /// A one in every bit of the field.
    pub const fn mask(&self) -> u32 {
        (u32::MAX >> (31 - (self.high - self.low))) << self.low
    }

    /// The field's value in the register value `register`.
    pub const fn extract(&self, register: u32) -> u32 {
        (register & self.mask()) >> self.low
    }

    /// `value` at the position of the field; excess bits are dropped.
    pub const fn insert(&self, value: u32) -> u32 {
        (value << self.low) & self.mask()
    }

    /// Whether any of its bits is set in the register value `register`.
    pub const fn is_set(&self, register: u32) -> bool {
        register & self.mask() != 0
    }
}

impl Register {
    /// Offset in bytes of the first address after the register or array.
    pub const fn end(&self) -> u32 {
        self.offset + 4 * self.count
    }
}

/// Generates a module per register, with constants for its offset, fields and values, and `MAP` with all of them as data.
macro_rules! registers {
    ($(
        $(#[doc = $meaning:literal])*
        $module:ident: $name:literal [$offset:literal; $count:literal], $access:ident, $reset:ident $(($at_reset:literal))? => {
            $(
                $(#[doc = $field_meaning:literal])*
                $field:ident [$low:literal..=$high:literal] {
                    $( $(#[doc = $value_meaning:literal])* $value:ident = $number:literal, )*
                }
            )*
        }
    )*) => {
        $(
            $(#[doc = $meaning])*
            pub mod $module {
                /// Offset in bytes from the peripheral's base.
                pub const OFFSET: u32 = $offset;

                /// The register with its fields, as data.
                pub const REGISTER: $crate::table::Register = $crate::table::Register {
                    name: $name,
                    offset: $offset,
                    count: $count,
                    access: $crate::table::Access::$access,
                    reset: $crate::table::Reset::$reset $(($at_reset))?,
                    meaning: concat!($($meaning),*),
                    fields: &[$($field),*],
                };

                $(
                    $(#[doc = $field_meaning])*
                    pub const $field: $crate::table::Field = $crate::table::Field {
                        name: stringify!($field),
                        low: $low,
                        high: $high,
                        meaning: concat!($($field_meaning),*),
                        values: &[$($crate::table::NamedValue {
                            name: stringify!($value),
                            value: $number,
                            meaning: concat!($($value_meaning),*),
                        }),*],
                    };
                    $(
                        $(#[doc = $value_meaning])*
                        pub const $value: u32 = $number;
                    )*
                )*
            }
        )*

        /// All registers in ascending order of offsets.
        pub const MAP: &[crate::table::Register] = &[$($module::REGISTER),*];
    };
}

pub(crate) use registers;
