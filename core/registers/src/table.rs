//! The shape of the register table, and the macro that makes constants and data of its one text.
//!
//! ```
//! use stepscope_registers::{MAP, status, table::Access};
//!
//! // A field takes its value out of what was read, and puts it in its place.
//! assert_eq!(status::STATE.of(status::STATE.with(status::STATE_MOVING)), status::STATE_MOVING);
//! // The map as data: what may be written?
//! let written = MAP.iter().filter(|register| register.access != Access::Ro).map(|register| register.name);
//! assert!(written.into_iter().any(|name| name == "CONTROL"));
//! ```

/// Who may do what with a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Read only: writes are ignored.
    Ro,
    /// Read and write.
    Rw,
    /// Write only: reads as 0.
    Wo,
    /// Read; a one written to a bit clears it, a zero leaves it.
    W1c,
}

impl Access {
    /// Its abbreviation in the data sheet.
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

/// What a register reads as after reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reset {
    /// This.
    Is(u32),
    /// What the peripheral was built with.
    Built,
}

/// A register, or several of the same kind one after another.
#[derive(Clone, Copy, Debug)]
pub struct Register {
    /// Its name; of several, without their numbers.
    pub name: &'static str,
    /// In bytes from the peripheral's base; of several, the first one's.
    pub offset: u32,
    /// How many there are, 4 bytes apart.
    pub count: u32,
    /// Who may do what.
    pub access: Access,
    /// After reset.
    pub reset: Reset,
    /// What it is, in sentences.
    pub meaning: &'static str,
    /// Its fields, from bit 0 up; bits of no field are reserved.
    pub fields: &'static [Field],
}

/// Bits of a register that mean something together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Its lowest bit, 0 to 31.
    pub low: u32,
    /// Its highest bit, `low` to 31.
    pub high: u32,
    /// What it is, in sentences.
    pub meaning: &'static str,
    /// What its values mean, where they are names and no numbers.
    pub values: &'static [Named],
}

/// One value of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Named {
    /// Its constant's name, which begins with the field's.
    pub name: &'static str,
    /// The value, as [`Field::of`] gives it.
    pub value: u32,
    /// What it means.
    pub meaning: &'static str,
}

impl Field {
    /// Its bits within the register.
    #[must_use]
    pub const fn mask(&self) -> u32 {
        u32::MAX >> (31 - (self.high - self.low)) << self.low
    }

    /// How far its lowest bit stands from bit 0.
    #[must_use]
    pub const fn shift(&self) -> u32 {
        self.low
    }

    /// The field's value in what was read of its register.
    #[must_use]
    pub const fn of(&self, register: u32) -> u32 {
        (register & self.mask()) >> self.low
    }

    /// The field's value at its place in the register; what does not fit is cut off.
    #[must_use]
    pub const fn with(&self, value: u32) -> u32 {
        value << self.low & self.mask()
    }

    /// Whether any of its bits is set in what was read of its register.
    #[must_use]
    pub const fn is_set(&self, register: u32) -> bool {
        register & self.mask() != 0
    }
}

impl Register {
    /// Offset just after it, or after the last of several.
    #[must_use]
    pub const fn end(&self) -> u32 {
        self.offset + 4 * self.count
    }
}

/// Makes a module for each register, with constants for its offset, fields and values, and `MAP`,
/// all of them as data.
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
                /// Offset of the register, or of the first of several.
                pub const OFFSET: u32 = $offset;

                /// The register as data.
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

        /// All registers, by offset.
        pub const MAP: &[crate::table::Register] = &[$($module::REGISTER),*];
    };
}

pub(crate) use registers;
