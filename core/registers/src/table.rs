//! Types of the register table, and the macro that derives constants and data from it.
//!
//! ```
//! use stepscope_registers::{MAP, status, table::Access};
//!
//! // A field extracts and inserts its value.
//! assert_eq!(status::STATE.of(status::STATE.with(status::STATE_MOVING)), status::STATE_MOVING);
//! // The map as data: registers that can be written.
//! let written = MAP.iter().filter(|register| register.access != Access::Ro).map(|register| register.name);
//! assert!(written.into_iter().any(|name| name == "CONTROL"));
//! ```

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
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ro => "RO",
            Self::Rw => "RW",
            Self::Wo => "WO",
            Self::W1c => "W1C",
        }
    }
}

/// Value after reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reset {
    Is(u32),
    Built,
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
    pub access: Access,
    pub reset: Reset,
    /// Description in sentences.
    pub meaning: &'static str,
    /// From bit 0 up; bits of no field are reserved.
    pub fields: &'static [Field],
}

/// Bits of a register with a common meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    pub name: &'static str,
    /// Lowest bit, 0 to 31.
    pub low: u32,
    /// Highest bit, `low` to 31.
    pub high: u32,
    /// Description in sentences.
    pub meaning: &'static str,
    /// Values that have names.
    pub values: &'static [Named],
}

/// One value of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Named {
    /// Name of its constant, which begins with the field's.
    pub name: &'static str,
    pub value: u32,
    pub meaning: &'static str,
}

impl Field {
    #[must_use]
    pub const fn mask(&self) -> u32 {
        u32::MAX >> (31 - (self.high - self.low)) << self.low
    }

    /// Position of its lowest bit.
    #[must_use]
    pub const fn shift(&self) -> u32 {
        self.low
    }

    /// The field's value in the register value `register`.
    #[must_use]
    pub const fn of(&self, register: u32) -> u32 {
        (register & self.mask()) >> self.low
    }

    /// `value` at the position of the field; excess bits are dropped.
    #[must_use]
    pub const fn with(&self, value: u32) -> u32 {
        value << self.low & self.mask()
    }

    /// Whether any of its bits is set in the register value `register`.
    #[must_use]
    pub const fn is_set(&self, register: u32) -> bool {
        register & self.mask() != 0
    }
}

impl Register {
    #[must_use]
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
                pub const OFFSET: u32 = $offset;

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
                        values: &[$($crate::table::Named {
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

        pub const MAP: &[crate::table::Register] = &[$($module::REGISTER),*];
    };
}

pub(crate) use registers;
