//! Converts the numbers of a scenario to steps, and checks that each is in its range and in a unit of the axis (DESIGN B1).

use crate::{
    limits,
    mechanics::{Acceleration, Distance, Jerk, Mechanics, NoSuchUnit, Speed},
    problem::Cause,
    timing::Double,
    validator::Validator,
};
use core::ops::RangeInclusive;

pub(crate) struct Quantities<'s> {
    mechanics: &'s Mechanics,
    /// With invalid mechanics only quantities in steps can be checked.
    mechanics_hold: bool,
    pub(crate) validator: Validator,
}

impl<'s> Quantities<'s> {
    pub(crate) fn new(mechanics: &'s Mechanics, path: &str) -> Self {
        let mut quantities = Self { mechanics, mechanics_hold: true, validator: Validator::within(path) };
        quantities.at("mechanics", Self::check_mechanics);
        quantities.mechanics_hold = quantities.validator.is_ok();
        quantities
    }

    fn check_mechanics(&mut self) {
        let length = match self.mechanics {
            Mechanics::Rotary(_) => None,
            Mechanics::Wheel(m) => Some(("radius_mm", m.radius_mm)),
            Mechanics::Screw(m) => Some(("lead_mm", m.lead_mm)),
            Mechanics::Direct(m) => Some(("step_mm", m.step_mm)),
        };
        self.at(self.mechanics.name(), |quantities| {
            if let Some((full_step_deg, microsteps)) = quantities.mechanics.shaft() {
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

    /// A number in its range, which NaN never is.
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

    pub(crate) fn pause(&mut self, step: &str, given_s: f64) -> Option<f64> {
        self.range(step, given_s, limits::PAUSE_S, "s")
    }

    /// A distance in whole steps, rounded half up, not 0; left negative.
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

    pub(crate) fn speed(&mut self, step: &str, given: &Speed) -> Option<f64> {
        self.speed_within(step, given, limits::SPEED_STEPS_S)
    }

    /// A speed within limits, in steps/s.
    pub(crate) fn speed_within(
        &mut self,
        step: &str,
        given: &Speed,
        range: RangeInclusive<f64>,
    ) -> Option<f64> {
        self.check(step, given.value(), given.unit(), given.step(self.mechanics), range)?;
        given.in_steps(self.mechanics).ok()
    }

    pub(crate) fn acceleration(&mut self, step: &str, given: &Acceleration) -> Option<f64> {
        let sizes = given.step(self.mechanics);
        self.check(step, given.value(), given.unit(), sizes, limits::ACCELERATION_STEPS_S2)?;
        given.in_steps(self.mechanics).ok()
    }

    pub(crate) fn jerk(&mut self, step: &str, given: &Jerk) -> Option<f64> {
        self.check(step, given.value(), given.unit(), given.step(self.mechanics), limits::JERK_STEPS_S3)?;
        given.in_steps(self.mechanics).ok()
    }

    /// One step in the unit of a distance, if the axis has that unit.
    pub(crate) fn step_of(&mut self, step: &str, given: &Distance) -> Option<f64> {
        self.size(step, given.value(), given.unit(), given.step(self.mechanics))
    }

    /// The distance in steps between two positions in the same unit, in which one step is `size`.
    pub(crate) fn travel(&mut self, first: f64, given: &Distance, size: f64) -> Option<Double> {
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

    fn check(
        &mut self,
        step: &str,
        given: f64,
        unit: &'static str,
        size: Result<f64, NoSuchUnit>,
        range: RangeInclusive<f64>,
    ) -> Option<f64> {
        let size = self.size(step, given, unit, size)?;
        self.in_own_unit(step, given, size, range, unit)
    }

    /// Checks a quantity against limits in steps, which a problem reports in the quantity's unit.
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
