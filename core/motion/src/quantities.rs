//! What a scenario asks of a motion, turned into steps: every number in its range, every quantity
//! in a unit that the axis has, and every problem kept with its path.

use crate::MAX_SPEED;
use crate::{
    mechanics::{Acceleration, Distance, Jerk, Mechanics, NoSuchUnit, Speed},
    problem::{Cause, Validator},
};
use alloc::{format, string::String};

/// Longest way of a move in steps.
const MAX_STEPS: f64 = 1e9;
/// Slowest speed in steps/s, where a speed must not be 0.
const MIN_SPEED: f64 = 1e-6;
/// Accelerations in steps/s^2.
const MIN_ACCELERATION: f64 = 1e-6;
const MAX_ACCELERATION: f64 = 1e13;
/// Jerks in steps/s^3.
const MIN_JERK: f64 = 1e-6;
const MAX_JERK: f64 = 1e19;
/// Times of a move in s.
const MIN_DURATION_S: f64 = 1e-6;
const MAX_DURATION_S: f64 = 86_400.0;

/// Reads the numbers of one axis and keeps the problems that it meets.
pub(super) struct Quantities<'s> {
    mechanics: &'s Mechanics,
    /// Without good mechanics only quantities in steps can be judged.
    mechanics_hold: bool,
    pub(super) validator: Validator,
}

impl<'s> Quantities<'s> {
    /// Checks the mechanics at `path`, which the quantities of the axis need.
    pub(super) fn new(mechanics: &'s Mechanics, path: &str) -> Self {
        let mut quantities = Self { mechanics, mechanics_hold: true, validator: Validator::default() };
        let (kind, shaft, length) = match mechanics {
            Mechanics::Rotary(m) => ("rotary", Some((m.full_step_deg, m.microsteps)), None),
            Mechanics::Wheel(m) => {
                ("wheel", Some((m.full_step_deg, m.microsteps)), Some(("radius_mm", m.radius_mm)))
            }
            Mechanics::Screw(m) => {
                ("screw", Some((m.full_step_deg, m.microsteps)), Some(("lead_mm", m.lead_mm)))
            }
            Mechanics::Direct(m) => ("direct", None, Some(("step_mm", m.step_mm))),
        };
        let at = |field: &str| format!("{path}.{kind}.{field}");
        if let Some((full_step_deg, microsteps)) = shaft {
            quantities.range(at("full_step_deg"), full_step_deg, 0.001, 90.0, "deg");
            quantities.range(at("microsteps"), microsteps.into(), 1.0, 512.0, "");
        }
        if let Some((field, length_mm)) = length {
            quantities.range(at(field), length_mm, 1e-6, 1e6, "mm");
        }
        quantities.mechanics_hold = quantities.validator.is_ok();
        quantities
    }

    /// Keeps a problem.
    pub(super) fn refuse(&mut self, path: impl Into<String>, cause: impl Into<Cause>) {
        self.validator.add(path, cause);
    }

    /// A number from `least` to `most`; nothing else is one, in particular not not-a-number.
    pub(super) fn range(
        &mut self,
        path: impl Into<String>,
        given: f64,
        least: f64,
        most: f64,
        unit: &'static str,
    ) -> Option<f64> {
        self.validator.range(path, given, least, most, unit)
    }

    /// A time of a move.
    pub(super) fn duration(&mut self, path: impl Into<String>, given_s: f64) -> Option<f64> {
        self.range(path, given_s, MIN_DURATION_S, MAX_DURATION_S, "s")
    }

    /// A time from 0 on.
    pub(super) fn pause(&mut self, path: impl Into<String>, given_s: f64) -> Option<f64> {
        self.range(path, given_s, 0.0, MAX_DURATION_S, "s")
    }

    /// A way in whole steps, rounded half up, not 0; left negative.
    pub(super) fn distance(&mut self, path: impl Into<String>, given: &Distance) -> Option<i64> {
        let path = path.into();
        let (step, steps) = self.convert(&path, given.value(), given.unit(), given.step(self.mechanics))?;
        self.in_own_unit(&path, given.value(), step, (-MAX_STEPS, MAX_STEPS), given.unit())?;
        let whole = super::round_half_up(steps);
        if whole == 0 {
            self.refuse(path, Cause::NoSteps { steps });
            return None;
        }
        Some(whole)
    }

    /// A speed in steps/s above 0.
    pub(super) fn speed(&mut self, path: impl Into<String>, given: &Speed) -> Option<f64> {
        self.speed_from(path, given, MIN_SPEED)
    }

    /// A speed in steps/s from `least` on.
    pub(super) fn speed_from(&mut self, path: impl Into<String>, given: &Speed, least: f64) -> Option<f64> {
        let path = path.into();
        let (step, speed) = self.convert(&path, given.value(), given.unit(), given.step(self.mechanics))?;
        self.in_own_unit(&path, given.value(), step, (least, MAX_SPEED), given.unit())?;
        Some(speed)
    }

    /// An acceleration in steps/s^2 above 0.
    pub(super) fn acceleration(&mut self, path: impl Into<String>, given: &Acceleration) -> Option<f64> {
        let path = path.into();
        let (step, acceleration) =
            self.convert(&path, given.value(), given.unit(), given.step(self.mechanics))?;
        let limits = (MIN_ACCELERATION, MAX_ACCELERATION);
        self.in_own_unit(&path, given.value(), step, limits, given.unit())?;
        Some(acceleration)
    }

    /// A jerk in steps/s^3 above 0.
    pub(super) fn jerk(&mut self, path: impl Into<String>, given: &Jerk) -> Option<f64> {
        let path = path.into();
        let (step, jerk) = self.convert(&path, given.value(), given.unit(), given.step(self.mechanics))?;
        self.in_own_unit(&path, given.value(), step, (MIN_JERK, MAX_JERK), given.unit())?;
        Some(jerk)
    }

    /// A step in the unit of a distance, where the axis has that unit.
    pub(super) fn step_of(&mut self, path: &str, given: &Distance) -> Option<f64> {
        self.convert(path, given.value(), given.unit(), given.step(self.mechanics)).map(|(step, _)| step)
    }

    /// A position in steps, not rounded; `step` is one step in its unit.
    pub(super) fn position(&mut self, path: impl Fn() -> String, given: &Distance, step: f64) -> Option<f64> {
        if !(-MAX_STEPS * step..=MAX_STEPS * step).contains(&given.value()) {
            self.in_own_unit(&path(), given.value(), step, (-MAX_STEPS, MAX_STEPS), given.unit())?;
        }
        Some(given.value() / step)
    }

    /// The size of a step in the quantity's unit, and the quantity in steps.
    fn convert(
        &mut self,
        path: &str,
        given: f64,
        unit: &'static str,
        step: Result<f64, NoSuchUnit>,
    ) -> Option<(f64, f64)> {
        match step {
            Ok(step) if self.mechanics_hold || unit.starts_with("steps") => Some((step, given / step)),
            Ok(_) => None,
            Err(NoSuchUnit { unit, mechanics }) => {
                self.refuse(path, Cause::NoSuchUnit { given, unit, mechanics });
                None
            }
        }
    }

    /// Judges a quantity against limits in steps and tells them in its own unit.
    fn in_own_unit(
        &mut self,
        path: &str,
        given: f64,
        step: f64,
        (least, most): (f64, f64),
        unit: &'static str,
    ) -> Option<f64> {
        self.range(path, given, least * step, most * step, unit)
    }
}
