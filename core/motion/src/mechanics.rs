//! Lengths, speeds, accelerations and jerks with their units, and the mechanics that turn them into steps (DESIGN B1).
//!
//! `{"mm": 250}` and `{"steps": 6400}` are both distances. Millimetres and degrees need mechanics
//! that have them; where an axis has none, the quantity is refused with the remedy.
//!
//! ```
//! use stepscope_motion::mechanics::{Distance, Mechanics, Screw};
//!
//! let screw = Mechanics::Screw(Screw { lead_mm: 8.0, ..Screw::default() });
//! // 200 full steps of 16 microsteps a turn, and 8 mm a turn.
//! assert_eq!(Distance::Millimetres(2.0).in_steps(&screw), Ok(800.0));
//! let refused = Distance::Millimetres(2.0).in_steps(&Mechanics::default()).unwrap_err();
//! assert_eq!((refused.unit, refused.mechanics), ("mm", "rotary"));
//! ```

use crate::{
    parameters::parameters,
    round_half_up,
    timing::{Double, Exact},
};
use core::f64::consts::PI;

/// What one step is.
#[derive(Clone, Debug, PartialEq)]
pub enum Mechanics {
    /// A turning shaft: degrees.
    Rotary(Rotary),
    /// A wheel, pulley or gear: 2*pi*radius mm a turn, and degrees.
    Wheel(Wheel),
    /// A screw: its lead in mm a turn, and degrees.
    Screw(Screw),
    /// A measured or given length of one step: mm.
    Direct(Direct),
}

impl Default for Mechanics {
    fn default() -> Self {
        Self::Rotary(Rotary::default())
    }
}

parameters! {
    /// A turning shaft.
    pub struct Rotary {
        /// Full step of the motor in degrees.
        pub full_step_deg: f64 = 1.8,
        /// Microsteps in a full step, 1 to 512.
        pub microsteps: u16 = 16,
    }
}

parameters! {
    /// A wheel, pulley or gear on the shaft.
    pub struct Wheel {
        /// Full step of the motor in degrees.
        pub full_step_deg: f64 = 1.8,
        /// Microsteps in a full step, 1 to 512.
        pub microsteps: u16 = 16,
        /// Radius in mm.
        pub radius_mm: f64 = 10.0,
    }
}

parameters! {
    /// A screw on the shaft.
    pub struct Screw {
        /// Full step of the motor in degrees.
        pub full_step_deg: f64 = 1.8,
        /// Microsteps in a full step, 1 to 512.
        pub microsteps: u16 = 16,
        /// Travel of the nut in one turn, in mm.
        pub lead_mm: f64 = 8.0,
    }
}

parameters! {
    /// A given length of one step.
    pub struct Direct {
        /// Length of one step in mm.
        pub step_mm: f64 = 0.01,
    }
}

impl Mechanics {
    /// Full step of the motor in degrees, where the mechanics have one.
    #[must_use]
    pub fn full_step_deg(&self) -> Option<f64> {
        match self {
            Self::Rotary(m) => Some(m.full_step_deg),
            Self::Wheel(m) => Some(m.full_step_deg),
            Self::Screw(m) => Some(m.full_step_deg),
            Self::Direct(_) => None,
        }
    }

    /// Angle of one step in degrees, where the mechanics have one.
    #[must_use]
    pub fn step_deg(&self) -> Option<f64> {
        match self {
            Self::Rotary(m) => Some(m.full_step_deg / f64::from(m.microsteps)),
            Self::Wheel(m) => Some(m.full_step_deg / f64::from(m.microsteps)),
            Self::Screw(m) => Some(m.full_step_deg / f64::from(m.microsteps)),
            Self::Direct(_) => None,
        }
    }

    /// Length of one step in mm, where the mechanics have one.
    #[must_use]
    pub fn step_mm(&self) -> Option<f64> {
        match self {
            Self::Rotary(_) => None,
            Self::Wheel(m) => self.step_deg().map(|deg| 2.0 * PI * m.radius_mm * deg / 360.0),
            Self::Screw(m) => self.step_deg().map(|deg| m.lead_mm * deg / 360.0),
            Self::Direct(m) => Some(m.step_mm),
        }
    }

    /// Whether a number, and all its own, which are above 0, are printed as decimals.
    fn can_tell(&self, number: f64) -> bool {
        let (one, other) = match self {
            Self::Rotary(m) => (m.full_step_deg, 1.0),
            Self::Wheel(m) => (m.full_step_deg, 1.0),
            Self::Screw(m) => (m.full_step_deg, m.lead_mm),
            Self::Direct(m) => (m.step_mm, 1.0),
        };
        number.is_finite() && [one, other].iter().all(|own| *own > 0.0 && own.is_finite())
    }

    /// So many degrees in steps.
    fn degrees(&self, given: Exact) -> Option<Exact> {
        let (full_step_deg, microsteps) = match self {
            Self::Rotary(m) => (m.full_step_deg, m.microsteps),
            Self::Wheel(m) => (m.full_step_deg, m.microsteps),
            Self::Screw(m) => (m.full_step_deg, m.microsteps),
            Self::Direct(_) => return None,
        };
        Some(given.times(microsteps.into()).divided_by(full_step_deg))
    }

    /// So many millimetres in steps; none of a wheel, whose circumference has pi.
    fn millimetres(&self, given: Exact) -> Option<Exact> {
        match self {
            Self::Rotary(_) | Self::Wheel(_) => None,
            Self::Screw(m) => self.degrees(given.times(360.0).divided_by(m.lead_mm)),
            Self::Direct(m) => Some(given.divided_by(m.step_mm)),
        }
    }

    fn name(&self) -> &'static str {
        match self {
            Self::Rotary(_) => "rotary",
            Self::Wheel(_) => "wheel",
            Self::Screw(_) => "screw",
            Self::Direct(_) => "direct",
        }
    }
}

/// A quantity whose unit the axis's mechanics do not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoSuchUnit {
    /// The unit that was given.
    pub unit: &'static str,
    /// The kind of the axis's mechanics.
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
            /// The number as given, in its own unit.
            #[must_use]
            pub const fn value(&self) -> f64 {
                match self {
                    $(Self::$variant(value) => *value,)*
                }
            }

            /// The unit as JSON names it.
            #[must_use]
            pub const fn unit(&self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $key,)*
                }
            }

            /// One step (a second, a second squared or cubed) in this quantity's unit.
            ///
            /// # Errors
            /// [`NoSuchUnit`] where the mechanics have no millimetres or no degrees.
            pub fn step(&self, mechanics: &Mechanics) -> Result<f64, NoSuchUnit> {
                let step: Option<f64> = match self {
                    $(Self::$variant(_) => {
                        let of: fn(&Mechanics) -> Option<f64> = $factor;
                        of(mechanics)
                    })*
                };
                step.ok_or(NoSuchUnit { unit: self.unit(), mechanics: mechanics.name() })
            }

            /// The quantity in steps (a second, a second squared or cubed): the nearest number to what its decimal makes
            /// (DESIGN B1), of a wheel's millimetres the quotient.
            ///
            /// # Errors
            /// [`NoSuchUnit`] where the mechanics have no millimetres or no degrees.
            pub fn in_steps(&self, mechanics: &Mechanics) -> Result<f64, NoSuchUnit> {
                let quotient = self.step(mechanics).map(|step| self.value() / step)?;
                Ok(self.exact_quotient(mechanics).map_or(quotient, |exact| exact.nearest()))
            }

            /// [`Self::in_steps`] with all its digits; a quotient with pi has those that are printed.
            #[allow(dead_code, reason = "of a distance whole steps are asked for")]
            pub(super) fn exact_in_steps(&self, mechanics: &Mechanics) -> Result<Double, NoSuchUnit> {
                let quotient = self.step(mechanics).map(|step| self.value() / step)?;
                Ok(self.exact_quotient(mechanics).map_or_else(|| Double::decimal(quotient), |exact| exact.double()))
            }

            /// The quantity in steps as its decimal makes it; a quotient with pi as it is printed.
            #[allow(dead_code, reason = "of some quantities nobody asks")]
            pub(super) fn exact(&self, mechanics: &Mechanics) -> Result<Exact, NoSuchUnit> {
                let quotient = self.step(mechanics).map(|step| self.value() / step)?;
                Ok(self.exact_quotient(mechanics).unwrap_or_else(|| Exact::of(quotient)))
            }

            /// The quantity in steps as its decimal makes it; `None` where it is in steps already, has pi, or is no number
            /// that a plan would take.
            fn exact_quotient(&self, mechanics: &Mechanics) -> Option<Exact> {
                if !mechanics.can_tell(self.value()) {
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
    /// A way along an axis.
    Distance,
    /// In steps.
    Steps = "steps" per |_| Some(1.0), by |_, _| None;
    /// In millimetres.
    Millimetres = "mm" per Mechanics::step_mm, by Mechanics::millimetres;
    /// In degrees.
    Degrees = "deg" per Mechanics::step_deg, by Mechanics::degrees;
}

impl Distance {
    /// The distance in whole steps, halves rounded up (DESIGN B1): 88.35 mm of 0.1 mm a step are 884.
    ///
    /// # Errors
    /// [`NoSuchUnit`] where the mechanics have no millimetres or no degrees.
    pub fn whole_steps(&self, mechanics: &Mechanics) -> Result<i64, NoSuchUnit> {
        let quotient = self.step(mechanics).map(|step| self.value() / step)?;
        Ok(self.exact_quotient(mechanics).map_or_else(|| round_half_up(quotient), |exact| exact.rounded()))
    }

    /// The way from `first`, in the same unit, to this position, in steps: the nearest number to what the decimals make.
    ///
    /// # Errors
    /// [`NoSuchUnit`] where the mechanics have no millimetres or no degrees.
    pub fn steps_from(&self, first: f64, mechanics: &Mechanics) -> Result<f64, NoSuchUnit> {
        self.exact_steps_from(first, mechanics).map(|steps| steps.high)
    }

    /// [`Self::steps_from`] with all its digits.
    pub(super) fn exact_steps_from(&self, first: f64, mechanics: &Mechanics) -> Result<Double, NoSuchUnit> {
        let quotient = (self.value() - first) / self.step(mechanics)?;
        if !mechanics.can_tell(self.value() - first) {
            return Ok(quotient.into());
        }
        let way = Exact::difference(self.value(), first);
        let exact = match self {
            Self::Steps(_) => Some(way),
            Self::Millimetres(_) => mechanics.millimetres(way),
            Self::Degrees(_) => mechanics.degrees(way),
        };
        Ok(exact.map_or(quotient.into(), |exact| exact.double()))
    }
}

quantity! {
    /// A speed along an axis.
    Speed,
    /// In steps a second (the documents' Hz or pps).
    StepsPerSecond = "steps_s" per |_| Some(1.0), by |_, _| None;
    /// In millimetres a second.
    MillimetresPerSecond = "mm_s" per Mechanics::step_mm, by Mechanics::millimetres;
    /// In degrees a second.
    DegreesPerSecond = "deg_s" per Mechanics::step_deg, by Mechanics::degrees;
    /// In turns a minute.
    TurnsPerMinute = "rpm" per |mechanics| mechanics.step_deg().map(|deg| deg / 6.0),
    by |mechanics, rpm| mechanics.degrees(rpm.times(6.0));
}

quantity! {
    /// An acceleration along an axis.
    Acceleration,
    /// In steps a second squared.
    StepsPerSecond2 = "steps_s2" per |_| Some(1.0), by |_, _| None;
    /// In millimetres a second squared.
    MillimetresPerSecond2 = "mm_s2" per Mechanics::step_mm, by Mechanics::millimetres;
    /// In degrees a second squared.
    DegreesPerSecond2 = "deg_s2" per Mechanics::step_deg, by Mechanics::degrees;
}

quantity! {
    /// A jerk along an axis: the change of an acceleration in a second.
    Jerk,
    /// In steps a second cubed.
    StepsPerSecond3 = "steps_s3" per |_| Some(1.0), by |_, _| None;
    /// In millimetres a second cubed.
    MillimetresPerSecond3 = "mm_s3" per Mechanics::step_mm, by Mechanics::millimetres;
    /// In degrees a second cubed.
    DegreesPerSecond3 = "deg_s3" per Mechanics::step_deg, by Mechanics::degrees;
}
