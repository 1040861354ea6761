//! Distances, speeds, accelerations and jerks with units, and the mechanics that convert them to steps (DESIGN B1).
//!
//! `{"mm": 250}` and `{"steps": 6400}` are both distances. Millimeters and degrees need mechanics that define them;
//! other mechanics refuse the quantity.
//!
//! ```
//! use stepscope_motion::mechanics::{Distance, Mechanics, Screw};
//!
//! let screw = Mechanics::Screw(Screw { lead_mm: 8.0, ..Screw::default() });
//! // 200 full steps of 16 microsteps per turn, and 8 mm per turn.
//! assert_eq!(Distance::Millimeters(2.0).in_steps(&screw), Ok(800.0));
//! let refused = Distance::Millimeters(2.0).in_steps(&Mechanics::default()).unwrap_err();
//! assert_eq!((refused.unit, refused.mechanics), ("mm", "rotary"));
//! ```

use crate::round_half_up;
use crate::timing::{Exact, F106};
use core::f64::consts::PI;
use stepscope_peripheral::parameters;

/// What a step of the motor moves. All but `Rotary` define millimeters, all but `Direct` degrees.
#[derive(Clone, Debug, PartialEq)]
pub enum Mechanics {
    Rotary(Rotary),
    Wheel(Wheel),
    Screw(Screw),
    Direct(Direct),
}

impl Default for Mechanics {
    fn default() -> Self {
        Self::Rotary(Rotary::default())
    }
}

parameters! { (Clone, Debug, PartialEq)
    /// A bare shaft.
    pub struct Rotary {
        pub full_step_deg: f64 = 1.8,
        pub microsteps: u16 = 16,
    }

    /// A wheel, pulley or gear on the shaft: 2*pi*radius mm per turn.
    pub struct Wheel {
        pub full_step_deg: f64 = 1.8,
        pub microsteps: u16 = 16,
        pub radius_mm: f64 = 10.0,
    }

    /// A lead screw on the shaft: its lead in mm per turn.
    pub struct Screw {
        pub full_step_deg: f64 = 1.8,
        pub microsteps: u16 = 16,
        pub lead_mm: f64 = 8.0,
    }

    /// A linear motor, or any mechanics whose step length is known.
    pub struct Direct {
        pub step_mm: f64 = 0.01,
    }
}

impl Mechanics {
    /// Full step in degrees and number of microsteps, if the mechanics have a shaft.
    pub(crate) fn shaft(&self) -> Option<(f64, u16)> {
        match self {
            Self::Rotary(m) => Some((m.full_step_deg, m.microsteps)),
            Self::Wheel(m) => Some((m.full_step_deg, m.microsteps)),
            Self::Screw(m) => Some((m.full_step_deg, m.microsteps)),
            Self::Direct(_) => None,
        }
    }

    /// Full step of the motor in degrees, if the mechanics have a shaft.
    pub fn full_step_deg(&self) -> Option<f64> {
        self.shaft().map(|(full_step_deg, _)| full_step_deg)
    }

    /// Angle of one step in degrees, if the mechanics have a shaft.
    pub fn step_deg(&self) -> Option<f64> {
        self.shaft().map(|(full_step_deg, microsteps)| full_step_deg / f64::from(microsteps))
    }

    /// Length of one step in mm, if the mechanics define it.
    pub fn step_mm(&self) -> Option<f64> {
        match self {
            Self::Rotary(_) => None,
            Self::Wheel(m) => self.step_deg().map(|deg| 2.0 * PI * m.radius_mm * deg / 360.0),
            Self::Screw(m) => self.step_deg().map(|deg| m.lead_mm * deg / 360.0),
            Self::Direct(m) => Some(m.step_mm),
        }
    }

    /// Whether `number` is finite and the mechanics' numbers are finite and above 0, as exact conversions require.
    fn can_convert(&self, number: f64) -> bool {
        let numbers = match self {
            Self::Rotary(m) => [m.full_step_deg, 1.0],
            Self::Wheel(m) => [m.full_step_deg, 1.0],
            Self::Screw(m) => [m.full_step_deg, m.lead_mm],
            Self::Direct(m) => [m.step_mm, 1.0],
        };
        number.is_finite() && numbers.iter().all(|number| *number > 0.0 && number.is_finite())
    }

    fn degrees_to_steps(&self, degrees: Exact) -> Option<Exact> {
        let (full_step_deg, microsteps) = self.shaft()?;
        Some(degrees.times(microsteps.into()).divided_by(full_step_deg))
    }

    /// Millimeters in steps; `None` for a wheel, whose circumference contains pi.
    fn millimeters_to_steps(&self, millimeters: Exact) -> Option<Exact> {
        match self {
            Self::Rotary(_) | Self::Wheel(_) => None,
            Self::Screw(m) => self.degrees_to_steps(millimeters.times(360.0).divided_by(m.lead_mm)),
            Self::Direct(m) => Some(millimeters.divided_by(m.step_mm)),
        }
    }

    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Rotary(_) => "rotary",
            Self::Wheel(_) => "wheel",
            Self::Screw(_) => "screw",
            Self::Direct(_) => "direct",
        }
    }
}

/// Mechanics of this kind do not define the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoSuchUnit {
    /// As in JSON, such as `mm_s`.
    pub unit: &'static str,
    pub mechanics: &'static str,
}

macro_rules! quantity {
    ($(#[$meta:meta])* $name:ident, $($(#[$variant_meta:meta])* $variant:ident = $key:literal per $factor:expr, by $exact:expr;)*) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq)]
        pub enum $name {
            $($(#[$variant_meta])* $variant(f64),)*
        }

        impl $name {
            /// The number in its unit.
            pub const fn value(&self) -> f64 {
                match self {
                    $(Self::$variant(value) => *value,)*
                }
            }

            /// The unit as in JSON, such as `steps` or `mm_s`.
            pub const fn unit(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $key,)*
                }
            }

            /// One step (per s, s^2 or s^3) in this quantity's unit.
            /// Errors: [`NoSuchUnit`] if the mechanics have no millimeters or no degrees.
            pub fn step_size(&self, mechanics: &Mechanics) -> Result<f64, NoSuchUnit> {
                let step_size: Option<f64> = match self {
                    $(Self::$variant(_) => {
                        let of: fn(&Mechanics) -> Option<f64> = $factor;
                        of(mechanics)
                    })*
                };
                step_size.ok_or(NoSuchUnit { unit: self.unit(), mechanics: mechanics.name() })
            }

            /// The quantity in steps (per s, s^2 or s^3), correctly rounded from its decimals; with pi, a quotient.
            /// Errors: [`NoSuchUnit`] if the mechanics have no millimeters or no degrees.
            pub fn in_steps(&self, mechanics: &Mechanics) -> Result<f64, NoSuchUnit> {
                let quotient = self.step_size(mechanics).map(|size| self.value() / size)?;
                Ok(self.exact_quotient(mechanics).map_or(quotient, |exact| exact.nearest()))
            }

            /// [`Self::in_steps`] in 106 bits; with pi, the decimal of the quotient.
            #[allow(dead_code, reason = "not for distances, which are whole steps")]
            pub(super) fn exact_in_steps(&self, mechanics: &Mechanics) -> Result<F106, NoSuchUnit> {
                let quotient = self.step_size(mechanics).map(|size| self.value() / size)?;
                Ok(self.exact_quotient(mechanics).map_or_else(|| F106::decimal(quotient), |exact| exact.double()))
            }

            /// The quantity in steps as a fraction; with pi, the decimal of the quotient.
            #[allow(dead_code, reason = "only for the quantities of tables")]
            pub(super) fn exact(&self, mechanics: &Mechanics) -> Result<Exact, NoSuchUnit> {
                let quotient = self.step_size(mechanics).map(|size| self.value() / size)?;
                Ok(self.exact_quotient(mechanics).unwrap_or_else(|| Exact::of(quotient)))
            }

            /// The quantity in steps as a fraction; `None` if it is in steps, contains pi, or is out of any range.
            fn exact_quotient(&self, mechanics: &Mechanics) -> Option<Exact> {
                if !mechanics.can_convert(self.value()) {
                    return None;
                }
                match self {
                    $(Self::$variant(value) => {
                        let of: fn(&Mechanics, Exact) -> Option<Exact> = $exact;
                        of(mechanics, Exact::of(*value))
                    })*
                }
            }
        }
    };
}

quantity! {
    /// A distance or a position, negative to the left.
    Distance,
    Steps = "steps" per |_| Some(1.0), by |_, _| None;
    Millimeters = "mm" per Mechanics::step_mm, by Mechanics::millimeters_to_steps;
    Degrees = "deg" per Mechanics::step_deg, by Mechanics::degrees_to_steps;
}

impl Distance {
    /// The distance in whole steps, halves rounded up: 88.35 mm at 0.1 mm per step are 884.
    /// Errors: [`NoSuchUnit`] if the mechanics have no millimeters or no degrees.
    pub fn whole_steps(&self, mechanics: &Mechanics) -> Result<i64, NoSuchUnit> {
        let quotient = self.step_size(mechanics).map(|size| self.value() / size)?;
        Ok(self.exact_quotient(mechanics).map_or_else(|| round_half_up(quotient), |exact| exact.rounded()))
    }

    /// The distance in steps, in 106 bits, from position `first` to this position in the same unit.
    pub(super) fn exact_steps_from(&self, first: f64, mechanics: &Mechanics) -> Result<F106, NoSuchUnit> {
        let quotient = (self.value() - first) / self.step_size(mechanics)?;
        if !mechanics.can_convert(self.value() - first) {
            return Ok(quotient.into());
        }
        let travel = Exact::difference(self.value(), first);
        let exact = match self {
            Self::Steps(_) => Some(travel),
            Self::Millimeters(_) => mechanics.millimeters_to_steps(travel),
            Self::Degrees(_) => mechanics.degrees_to_steps(travel),
        };
        Ok(exact.map_or(quotient.into(), |exact| exact.double()))
    }
}

quantity! {
    Speed,
    StepsPerSecond = "steps_s" per |_| Some(1.0), by |_, _| None;
    MillimetersPerSecond = "mm_s" per Mechanics::step_mm, by Mechanics::millimeters_to_steps;
    DegreesPerSecond = "deg_s" per Mechanics::step_deg, by Mechanics::degrees_to_steps;
    TurnsPerMinute = "rpm" per |mechanics| mechanics.step_deg().map(|deg| deg / 6.0),
    by |mechanics, rpm| mechanics.degrees_to_steps(rpm.times(6.0));
}

quantity! {
    Acceleration,
    StepsPerSecond2 = "steps_s2" per |_| Some(1.0), by |_, _| None;
    MillimetersPerSecond2 = "mm_s2" per Mechanics::step_mm, by Mechanics::millimeters_to_steps;
    DegreesPerSecond2 = "deg_s2" per Mechanics::step_deg, by Mechanics::degrees_to_steps;
}

quantity! {
    Jerk,
    StepsPerSecond3 = "steps_s3" per |_| Some(1.0), by |_, _| None;
    MillimetersPerSecond3 = "mm_s3" per Mechanics::step_mm, by Mechanics::millimeters_to_steps;
    DegreesPerSecond3 = "deg_s3" per Mechanics::step_deg, by Mechanics::degrees_to_steps;
}
