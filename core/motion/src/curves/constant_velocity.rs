//! Moves at a constant velocity, and dwells (DESIGN B6).

use crate::timing::{CycleTime, Exact, F106, IsDueBefore, Runs, Schedule, one_run};
use crate::{Curve, Peaks, curves::curve::signed};
use alloc::{boxed::Box, string::String};

/// A move at a constant speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantVelocity {
    steps: i64,
    speed: f64,
    /// The decimal of the scenario, without rounding.
    speed_exact: F106,
    duration_s: f64,
}

impl ConstantVelocity {
    /// `steps` (left negative) at `speed` > 0 steps/s.
    pub fn new(steps: i64, speed: f64) -> Self {
        Self::from_exact(steps, F106::decimal(speed))
    }

    pub(crate) fn from_exact(steps: i64, speed_exact: F106) -> Self {
        let speed = speed_exact.high;
        Self { steps, speed, speed_exact, duration_s: steps.unsigned_abs() as f64 / speed }
    }
}

impl Schedule for ConstantVelocity {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        CycleTime::of(F106::from(self.steps.unsigned_abs()) / self.speed_exact * f64::from(clock_hz))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let cycles_per_step = f64::from(clock_hz) / self.speed;
        // Step k (from 1) is due at k - 1/2 steps; the index of `one_run` is k - 1.
        one_run(self, clock_hz, move |index| (index + 0.5) * cycles_per_step)
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let cycles_per_step = F106::from(f64::from(clock_hz)) / self.speed_exact;
        Box::new(move |k, since| since > cycles_per_step * (k as f64 - 0.5))
    }
}

impl Curve for ConstantVelocity {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn steps(&self) -> i64 {
        self.steps
    }

    fn position(&self, t: f64) -> f64 {
        if t >= self.duration_s {
            self.steps as f64
        } else if t > 0.0 {
            signed(self.steps, self.speed) * t
        } else {
            0.0
        }
    }

    fn speed(&self, _: f64) -> f64 {
        signed(self.steps, self.speed)
    }

    fn peaks(&self) -> Peaks {
        Peaks { speed: self.speed, ..Peaks::default() }
    }

    fn detail(&self, _: f64) -> String {
        String::new()
    }
}

/// A pause of at least 0 s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dwell {
    duration_s: f64,
}

impl Dwell {
    pub fn new(duration_s: f64) -> Self {
        Self { duration_s }
    }
}

impl Schedule for Dwell {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        CycleTime::exact(&Exact::of(self.duration_s).times(clock_hz.into()))
    }

    fn runs(&self, _: u32) -> Runs<'_> {
        Box::new(core::iter::empty())
    }

    fn is_due_before(&self, _: u32) -> IsDueBefore<'_> {
        Box::new(|_, _| false)
    }
}

impl Curve for Dwell {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn steps(&self) -> i64 {
        0
    }

    fn position(&self, _: f64) -> f64 {
        0.0
    }

    fn speed(&self, _: f64) -> f64 {
        0.0
    }

    fn peaks(&self) -> Peaks {
        Peaks::default()
    }

    fn detail(&self, _: f64) -> String {
        String::new()
    }
}
