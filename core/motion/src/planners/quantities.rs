//! What a scenario asks of a motion, turned into steps: every number in its range, every quantity
//! in a unit that the axis has, and every problem kept with its path.

use crate::{
    limits,
    mechanics::{Acceleration, Distance, Jerk, Mechanics, NoSuchUnit, Speed},
    problem::{Cause, Validator},
    timing::Double,
};
use core::ops::RangeInclusive;

pub(crate) struct Quantities<'s> {
    mechanics: &'s Mechanics,
    /// Without good mechanics only quantities in steps can be judged.
    mechanics_hold: bool,
    pub(crate) validator: Validator,
}

impl<'s> Quantities<'s> {
    /// For the axis at `path`; checks its mechanics, which its quantities need.
    pub(crate) fn new(mechanics: &'s Mechanics, path: &str) -> Self {
        let mut quantities = Self { mechanics, mechanics_hold: true, validator: Validator::within(path) };
        quantities.at("mechanics", Self::check_mechanics);
        quantities.mechanics_hold = quantities.validator.is_ok();
        quantities
    }

    fn check_mechanics(&mut self) {
        let (kind, shaft, length) = match self.mechanics {
            Mechanics::Rotary(m) => ("rotary", Some((m.full_step_deg, m.microsteps)), None),
            Mechanics::Wheel(m) => {
                ("wheel", Some((m.full_step_deg, m.microsteps)), Some(("radius_mm", m.radius_mm)))
            }
            Mechanics::Screw(m) => {
                ("screw", Some((m.full_step_deg, m.microsteps)), Some(("lead_mm", m.lead_mm)))
            }
            Mechanics::Direct(m) => ("direct", None, Some(("step_mm", m.step_mm))),
        };
        self.at(kind, |quantities| {
            if let Some((full_step_deg, microsteps)) = shaft {
                quantities.range("full_step_deg", full_step_deg, limits::FULL_STEP_DEG, "deg");
                quantities.range("microsteps", microsteps.into(), limits::MICROSTEPS, "");
            }
            if let Some((field, length_mm)) = length {
                quantities.range(field, length_mm, limits::LENGTH_MM, "mm");
            }
        });
    }

    pub(crate) fn mechanics(&self) -> &'s Mechanics {
        self.mechanics
    }

    pub(crate) fn at<T>(&mut self, step: &str, what: impl FnOnce(&mut Self) -> T) -> T {
        let outside = self.validator.enter(step);
        let made = what(self);
        self.validator.leave(outside);
        made
    }

    pub(crate) fn at_entry<T>(&mut self, index: usize, what: impl FnOnce(&mut Self) -> T) -> T {
        let outside = self.validator.enter_entry(index);
        let made = what(self);
        self.validator.leave(outside);
        made
    }

    pub(crate) fn refuse(&mut self, step: &str, cause: impl Into<Cause>) {
        self.validator.add(step, cause);
    }

    /// A number in its range; nothing else is one, in particular not not-a-number.
    pub(crate) fn range(
        &mut self,
        step: &str,
        given: f64,
        range: RangeInclusive<f64>,
        unit: &'static str,
    ) -> Option<f64> {
        self.validator.range(step, given, range, unit)
    }

    pub(crate) fn duration(&mut self, step: &str, given_s: f64) -> Option<f64> {
        self.range(step, given_s, limits::DURATION_S, "s")
    }

    /// A time from 0 on.
    pub(crate) fn pause(&mut self, step: &str, given_s: f64) -> Option<f64> {
        self.range(step, given_s, limits::PAUSE_S, "s")
    }

    /// A way in whole steps, rounded half up, not 0; left negative.
    pub(crate) fn distance(&mut self, step: &str, given: &Distance) -> Option<i64> {
        let sizes = given.step(self.mechanics);
        self.check(step, given.value(), given.unit(), sizes, limits::STEPS)?;
        let whole = given.whole_steps(self.mechanics).ok()?;
        if whole == 0 {
            let steps = given.in_steps(self.mechanics).ok()?;
            self.refuse(step, Cause::NoSteps { steps });
            return None;
        }
        Some(whole)
    }

    /// A speed in steps/s above 0.
    pub(crate) fn speed(&mut self, step: &str, given: &Speed) -> Option<f64> {
        self.speed_within(step, given, limits::SPEED_STEPS_S)
    }

    /// A speed in steps/s, within limits in the same unit.
    pub(crate) fn speed_within(
        &mut self,
        step: &str,
        given: &Speed,
        range: RangeInclusive<f64>,
    ) -> Option<f64> {
        self.check(step, given.value(), given.unit(), given.step(self.mechanics), range)?;
        given.in_steps(self.mechanics).ok()
    }

    /// An acceleration in steps/s^2 above 0.
    pub(crate) fn acceleration(&mut self, step: &str, given: &Acceleration) -> Option<f64> {
        let sizes = given.step(self.mechanics);
        self.check(step, given.value(), given.unit(), sizes, limits::ACCELERATION_STEPS_S2)?;
        given.in_steps(self.mechanics).ok()
    }

    /// A jerk in steps/s^3 above 0.
    pub(crate) fn jerk(&mut self, step: &str, given: &Jerk) -> Option<f64> {
        self.check(step, given.value(), given.unit(), given.step(self.mechanics), limits::JERK_STEPS_S3)?;
        given.in_steps(self.mechanics).ok()
    }

    /// One step in the unit of a distance, where the axis has that unit.
    pub(crate) fn step_of(&mut self, step: &str, given: &Distance) -> Option<f64> {
        self.size(step, given.value(), given.unit(), given.step(self.mechanics))
    }

    /// The way from a first position to another in the same unit, in steps, not rounded; `size` is one step in that unit.
    pub(crate) fn way(&mut self, first: f64, given: &Distance, size: f64) -> Option<Double> {
        self.in_own_unit("", given.value(), size, limits::STEPS, given.unit())?;
        given.exact_steps_from(first, self.mechanics).ok()
    }

    fn size(
        &mut self,
        step: &str,
        given: f64,
        unit: &'static str,
        size: Result<f64, NoSuchUnit>,
    ) -> Option<f64> {
        match size {
            Ok(size) => (self.mechanics_hold || unit.starts_with("steps")).then_some(size),
            Err(NoSuchUnit { unit, mechanics }) => {
                self.refuse(step, Cause::NoSuchUnit { given, unit, mechanics });
                None
            }
        }
    }

    /// Checks a quantity against limits in steps.
    fn check(
        &mut self,
        step: &str,
        given: f64,
        unit: &'static str,
        size: Result<f64, NoSuchUnit>,
        range: RangeInclusive<f64>,
    ) -> Option<()> {
        let size = self.size(step, given, unit, size)?;
        self.in_own_unit(step, given, size, range, unit).map(|_| ())
    }

    /// Checks a quantity against limits in steps and tells them in its own unit.
    fn in_own_unit(
        &mut self,
        step: &str,
        given: f64,
        size: f64,
        range: RangeInclusive<f64>,
        unit: &'static str,
    ) -> Option<f64> {
        self.range(step, given, range.start() * size..=range.end() * size, unit)
    }
}
