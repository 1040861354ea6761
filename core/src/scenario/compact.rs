//! How the scenario's types are declared: once, with their defaults.
//!
//! [`settings!`] declares a struct and its defaults in one place; from that follow `Default`,
//! reading with every field optional and unknown ones refused, and [`Compact`]: the canonical form
//! that a link carries, fixed in order, with what equals its default left out.

use alloc::{string::String, vec::Vec};
use serde_json::{Map, Value};

/// The canonical JSON of a value: fixed order, defaults left out.
///
/// Reading it back gives an equal value, and equal values have the same canonical form.
pub trait Compact {
    /// The canonical form.
    fn compact(&self) -> Value;
}

macro_rules! plain {
    ($($ty:ty),*) => {$(
        impl Compact for $ty {
            fn compact(&self) -> Value {
                Value::from(self.clone())
            }
        }
    )*};
}
plain!(u8, u16, u32, u64, i64, String);

impl Compact for f64 {
    /// -0.0 equals 0.0, so it is written like it.
    fn compact(&self) -> Value {
        Value::from(*self + 0.0)
    }
}

impl<T: Compact> Compact for Option<T> {
    fn compact(&self) -> Value {
        self.as_ref().map_or(Value::Null, Compact::compact)
    }
}

impl<T: Compact> Compact for Vec<T> {
    fn compact(&self) -> Value {
        self.iter().map(Compact::compact).collect()
    }
}

/// A map of one key: how a choice is written.
pub(super) fn chosen(name: &str, value: Value) -> Value {
    let mut map = Map::new();
    map.insert(name.into(), value);
    Value::Object(map)
}

macro_rules! settings {
    ($(#[$meta:meta])* pub struct $name:ident {
        $($(#[$field_meta:meta])* pub $field:ident: $ty:ty = $default:expr,)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        pub struct $name {
            $($(#[$field_meta])* pub $field: $ty,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }

        impl $crate::scenario::Compact for $name {
            fn compact(&self) -> serde_json::Value {
                let default = Self::default();
                let mut map = serde_json::Map::new();
                $(if self.$field != default.$field {
                    map.insert(stringify!($field).into(), self.$field.compact());
                })*
                serde_json::Value::Object(map)
            }
        }
    };
}

macro_rules! choices {
    ($(#[$meta:meta])* pub enum $name:ident {
        $($(#[$variant_meta:meta])* $variant:ident($ty:ty) = $key:literal,)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        pub enum $name {
            $($(#[$variant_meta])* #[serde(rename = $key)] $variant($ty),)*
        }

        impl $name {
            /// The names of all kinds, as JSON writes them.
            pub const KINDS: &'static [&'static str] = &[$($key),*];
        }

        impl $crate::scenario::Compact for $name {
            fn compact(&self) -> serde_json::Value {
                match self {
                    $(Self::$variant(inner) => $crate::scenario::compact::chosen($key, inner.compact()),)*
                }
            }
        }
    };
}

pub(crate) use {choices, settings};

macro_rules! words {
    ($($ty:ty { $($variant:ident = $word:literal,)* })*) => {$(
        impl Compact for $ty {
            fn compact(&self) -> Value {
                Value::from(match self {
                    $(Self::$variant => $word,)*
                })
            }
        }
    )*};
}

words! {
    super::Distribution { Burst = "burst", Spread = "spread", }
    super::DirLine { PerChannel = "per_channel", Common = "common", }
    super::Protocol { Raw = "raw", Framed = "framed", }
    super::Pulses { Simultaneous = "simultaneous", Staggered = "staggered", }
    super::MotionEngine { Ticks = "ticks", Segments = "segments", }
    super::CosineMethod { Exact = "exact", Sliced = "sliced", }
    super::RampShape {
        Sigmoid = "sigmoid",
        Bezier = "bezier",
        Straight = "straight",
        Exponential = "exponential",
    }
    super::ShortMove { Document = "document", TurnRound = "turn_round", }
    super::Interpolation { Straight = "straight", Smooth = "smooth", }
    super::PointUnit { Steps = "steps", Millimetres = "mm", Degrees = "deg", }
    super::TrapezoidMethod { Table = "table", Exact = "exact", }
    super::DriverModel {
        A4988 = "a4988",
        A4979 = "a4979",
        Drv8825 = "drv8825",
        Tmc2209 = "tmc2209",
        Tmc262 = "tmc262",
        Tb6600Class = "tb6600_class",
    }
}
