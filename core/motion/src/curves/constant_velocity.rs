//! Constant rate and dwell (DESIGN B6).

use crate::timing::{CycleTime, Double, Exact, IsDueBefore, Runs, Schedule, one_run};
use crate::{Curve, Peaks, curves::curve::signed};
use alloc::{boxed::Box, string::String};

/// A move at a constant speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constant {
    steps: i64,
    speed: f64,
    exact_speed: Double,
    duration_s: f64,
}

impl Constant {
    /// `steps` (left negative) at `speed` > 0 steps/s.
    pub fn new(steps: i64, speed: f64) -> Self {
        Self::from_exact(steps, Double::decimal(speed))
    }

    pub(crate) fn from_exact(steps: i64, exact_speed: Double) -> Self {
        let speed = exact_speed.high;
        Self { steps, speed, exact_speed, duration_s: steps.unsigned_abs() as f64 / speed }
    }
}

impl Schedule for Constant {
    fn length(&self, clock_hz: u32) -> CycleTime {
        CycleTime::of(Double::from(self.steps.unsigned_abs()) / self.exact_speed * f64::from(clock_hz))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        let cycles_per_step = f64::from(clock_hz) / self.speed;
        one_run(self, clock_hz, move |step| (step + 0.5) * cycles_per_step)
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let cycles_per_step = Double::from(f64::from(clock_hz)) / self.exact_speed;
        Box::new(move |k, since| since > cycles_per_step * (k as f64 - 0.5))
    }
}

impl Curve for Constant {
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
            self.speed(t) * t
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

/// A pause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dwell {
    duration_s: f64,
}

impl Dwell {
    /// A pause of `duration_s` >= 0.
    pub fn new(duration_s: f64) -> Self {
        Self { duration_s }
    }
}

impl Schedule for Dwell {
    fn length(&self, clock_hz: u32) -> CycleTime {
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
