//! Converts the numbers of a scenario to steps, and checks that each is in its range and in a unit of the axis (DESIGN B1).

use crate::mechanics::{Acceleration, Distance, Jerk, Mechanics, NoSuchUnit, Speed};
use crate::{limits, problem::Cause, timing::F106, validator::Validator};
use core::ops::RangeInclusive;

type Range = RangeInclusive<f64>;

/// A validator of quantities in the units of an axis.
pub(crate) struct Quantities<'s> {
    mechanics: &'s Mechanics,
    /// If false, only quantities in steps can be checked.
    has_valid_mechanics: bool,
    pub(crate) validator: Validator,
}

impl<'s> Quantities<'s> {
    pub(crate) fn new(mechanics: &'s Mechanics, path: &str) -> Self {
        let mut quantities =
            Self { mechanics, has_valid_mechanics: true, validator: Validator::within(path) };
        quantities.at("mechanics", Self::check_mechanics);
        quantities.has_valid_mechanics = quantities.validator.is_ok();
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

    pub(crate) fn at<T>(&mut self, field: &str, check: impl FnOnce(&mut Self) -> T) -> T {
        let outer_len = self.validator.enter(field);
        let result = check(self);
        self.validator.leave(outer_len);
        result
    }

    pub(crate) fn at_entry<T>(&mut self, index: usize, check: impl FnOnce(&mut Self) -> T) -> T {
        let outer_len = self.validator.enter_entry(index);
        let result = check(self);
        self.validator.leave(outer_len);
        result
    }

    pub(crate) fn refuse(&mut self, field: &str, cause: impl Into<Cause>) {
        self.validator.add(field, cause);
    }

    pub(crate) fn range(&mut self, field: &str, given: f64, range: Range, unit: &'static str) -> Option<f64> {
        self.validator.range(field, given, range, unit)
    }

    /// A distance in whole steps, rounded half up, not 0.
    pub(crate) fn distance(&mut self, field: &str, given: &Distance) -> Option<i64> {
        let step_size = given.step_size(self.mechanics);
        self.check(field, given.value(), given.unit(), step_size, limits::STEPS)?;
        let whole = given.whole_steps(self.mechanics).ok()?;
        if whole == 0 {
            let steps = given.in_steps(self.mechanics).ok()?;
            self.refuse(field, Cause::NoSteps { steps });
            return None;
        }
        Some(whole)
    }

    /// A distance or a position in whole steps, rounded half up; it may be 0.
    pub(crate) fn position(&mut self, field: &str, given: &Distance) -> Option<i64> {
        let step_size = given.step_size(self.mechanics);
        self.check(field, given.value(), given.unit(), step_size, limits::STEPS)?;
        given.whole_steps(self.mechanics).ok()
    }

    /// The speed at the start or the end of a move, from 0 on; `Some(None)` if none is given.
    pub(crate) fn edge_speed(&mut self, field: &str, given: Option<&Speed>) -> Option<Option<f64>> {
        let Some(given) = given else { return Some(None) };
        self.speed_within(field, given, limits::EDGE_SPEED_STEPS_S).map(Some)
    }

    /// The given acceleration, or another one if none is given.
    pub(crate) fn acceleration_or(
        &mut self,
        field: &str,
        given: Option<&Acceleration>,
        other: Option<f64>,
    ) -> Option<f64> {
        given.map_or(other, |given| self.acceleration(field, given))
    }

    pub(crate) fn speed(&mut self, field: &str, given: &Speed) -> Option<f64> {
        self.speed_within(field, given, limits::SPEED_STEPS_S)
    }

    pub(crate) fn speed_within(&mut self, field: &str, given: &Speed, range: Range) -> Option<f64> {
        self.check(field, given.value(), given.unit(), given.step_size(self.mechanics), range)?;
        given.in_steps(self.mechanics).ok()
    }

    pub(crate) fn acceleration(&mut self, field: &str, given: &Acceleration) -> Option<f64> {
        let step_size = given.step_size(self.mechanics);
        self.check(field, given.value(), given.unit(), step_size, limits::ACCELERATION_STEPS_S2)?;
        given.in_steps(self.mechanics).ok()
    }

    pub(crate) fn jerk(&mut self, field: &str, given: &Jerk) -> Option<f64> {
        let step_size = given.step_size(self.mechanics);
        self.check(field, given.value(), given.unit(), step_size, limits::JERK_STEPS_S3)?;
        given.in_steps(self.mechanics).ok()
    }

    pub(crate) fn step_size_of(&mut self, field: &str, given: &Distance) -> Option<f64> {
        self.usable_step_size(field, given.value(), given.unit(), given.step_size(self.mechanics))
    }

    /// The distance in steps between two positions in the same unit, in which one step is `step_size`.
    pub(crate) fn travel(&mut self, first: f64, given: &Distance, step_size: f64) -> Option<F106> {
        self.check_in_own_unit("", given.value(), step_size, limits::STEPS, given.unit())?;
        given.exact_steps_from(first, self.mechanics).ok()
    }

    /// One step in a quantity's unit; `None` with a problem, or with invalid mechanics.
    fn usable_step_size(
        &mut self,
        field: &str,
        given: f64,
        unit: &'static str,
        step_size: Result<f64, NoSuchUnit>,
    ) -> Option<f64> {
        match step_size {
            Ok(size) => (self.has_valid_mechanics || unit.starts_with("steps")).then_some(size),
            Err(NoSuchUnit { unit, mechanics }) => {
                self.refuse(field, Cause::NoSuchUnit { given, unit, mechanics });
                None
            }
        }
    }

    fn check(
        &mut self,
        field: &str,
        given: f64,
        unit: &'static str,
        step_size: Result<f64, NoSuchUnit>,
        range: Range,
    ) -> Option<f64> {
        let step_size = self.usable_step_size(field, given, unit, step_size)?;
        self.check_in_own_unit(field, given, step_size, range, unit)
    }

    /// Checks a quantity against limits in steps, which a problem reports in the quantity's unit.
    fn check_in_own_unit(
        &mut self,
        field: &str,
        given: f64,
        step_size: f64,
        range: Range,
        unit: &'static str,
    ) -> Option<f64> {
        self.range(field, given, range.start() * step_size..=range.end() * step_size, unit)
    }
}
