//! A move with two ramps of a given shape, exact in distance and in time (DESIGN B4).
//!
//! The cosine S-curve with a shape g of area A (`ramp`) instead of the cosine:
//!
//! ```text
//!  f_max |     .--------.       f_max = n/(T - 2*t_s*(1 - A))      n/(T - t_s) where A is 1/2
//!        |    /          \      f(t)  = f_max*g(t/t_s)             in the ramp
//!        | .-'            '-.   s(t)  = f_max*t_s*G(t/t_s)         in the ramp
//!        +-----------------------     = f_max*(t - t_s*(1 - A))    in the plateau
//!         t_s           T-t_s  T      = n - s(T - t)               from T/2 on
//! ```

use crate::Peaks;
use crate::curves::mirrored::{Mirrored, MirroredCurve, RAMP_PARTS, parts_s};
use crate::curves::ramp::{Ramp, longest_ramp_s};
use crate::format::{grouped, ramp_up_to};
use crate::timing::{
    CycleTime, Exact, F106, IsDueBefore, Runs, Schedule, is_mirrored_due_before, one_searched_run,
};
use alloc::{boxed::Box, format, string::String, vec::Vec};

/// A move with two shaped ramps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramps {
    halves: Mirrored,
    ramp_s: f64,
    ramp: Ramp,
    area: f64,
    top_speed: f64,
}

impl Ramps {
    /// `steps` (left negative) in `duration_s` > 0 with ramps of `ramp_s`, from 0 to half of it.
    pub fn new(steps: i64, duration_s: f64, ramp_s: f64, ramp: Ramp) -> Self {
        debug_assert!((0.0..=duration_s / 2.0).contains(&ramp_s), "ramps of {ramp_s} s in {duration_s} s");
        let area = ramp.area();
        let top_speed = steps.unsigned_abs() as f64 / (duration_s - 2.0 * ramp_s * (1.0 - area));
        Self { halves: Mirrored { steps, duration_s }, ramp_s, ramp, area, top_speed }
    }

    /// The same move with another ramp time in s, from 0 to half of its duration.
    pub fn with_ramp_s(&self, ramp_s: f64) -> Self {
        Self::new(self.halves.steps, self.halves.duration_s, ramp_s, self.ramp)
    }

    /// f_max in steps/s, the plateau speed.
    pub fn top_speed(&self) -> f64 {
        self.top_speed
    }

    /// The longest ramp in s with a top speed of at most `speed` steps/s ([`longest_ramp_s`]).
    pub fn longest_ramp_s(&self, speed: f64) -> Option<f64> {
        longest_ramp_s(self.halves.steps.unsigned_abs(), self.halves.duration_s, speed, self.area)
    }

    pub(crate) fn changes(&self) -> Vec<f64> {
        self.halves.changes(&[self.top_speed * self.ramp_s * self.area])
    }

    /// x of the ramp at `t` from the nearer end, 0 to 1; `None` in the plateau.
    fn part(&self, t: f64) -> Option<f64> {
        (t < self.ramp_s).then(|| t / self.ramp_s)
    }

    /// Time that a ramp takes longer than its travel at top speed.
    fn lost_s(&self) -> f64 {
        self.ramp_s * (1.0 - self.area)
    }
}

/// Error of a time in f64: 9 u of the position in units of the ramp's travel and at most 25 u of the shape's travel, halved
/// because the travel begins with the square of the time; at most 10 u of a sigmoid's range, whose error shifts the steep
/// start. With Newton's method, the products by ramp time and clock, and the difference from the end it is below 48 u.
impl Schedule for Ramps {
    fn duration(&self, clock_hz: u32) -> CycleTime {
        CycleTime::exact(&Exact::of(self.halves.duration_s).times(clock_hz.into()))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        one_searched_run(self, clock_hz, self.changes())
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let cycles = |time_s: f64| Exact::of(time_s).times(clock_hz.into()).double();
        let (duration, ramp) = (cycles(self.halves.duration_s), cycles(self.ramp_s));
        let (shape, count) = (self.ramp.exact(), self.halves.steps.unsigned_abs());
        let lost = ramp * (F106::from(1.0) - shape.area());
        let top_speed = F106::from(count) / (duration - lost * 2.0);
        Box::new(move |k, since| {
            is_mirrored_due_before((k, count), since, duration, |t, position| {
                if t < ramp {
                    shape.is_past(t / ramp, F106::from(position) / (top_speed * ramp))
                } else {
                    top_speed * (t - lost) > position.into()
                }
            })
        })
    }
}

impl MirroredCurve for Ramps {
    fn halves(&self) -> &Mirrored {
        &self.halves
    }

    fn half_position(&self, t: f64) -> f64 {
        match self.part(t) {
            Some(x) => self.top_speed * self.ramp_s * self.ramp.travel(x),
            None => self.top_speed * (t - self.lost_s()),
        }
    }

    fn half_speed(&self, t: f64) -> f64 {
        self.part(t).map_or(self.top_speed, |x| self.top_speed * self.ramp.speed(x))
    }

    fn half_acceleration(&self, t: f64) -> Option<f64> {
        Some(self.top_speed / self.ramp_s * self.ramp.slope(self.part(t)?))
    }

    /// The acceleration jumps at the end of a ramp, by twice as much if the other ramp follows without a plateau.
    fn all_peaks(&self) -> Peaks {
        if self.ramp_s <= 0.0 {
            return Peaks { speed: self.top_speed, ..Peaks::default() };
        }
        let scale = self.top_speed / self.ramp_s;
        let has_no_plateau = 2.0 * self.ramp_s >= self.halves.duration_s;
        let last = scale * self.ramp.slope(1.0);
        Peaks {
            speed: self.top_speed,
            acceleration: scale * self.ramp.max_slope(),
            jerk: scale / self.ramp_s * self.ramp.max_curvature(),
            acceleration_jump: if has_no_plateau { 2.0 * last } else { last },
            ..Peaks::default()
        }
    }

    fn half_breakpoints_s(&self) -> Vec<f64> {
        // Sharper shapes need more parts. An integer factor preserves the breakpoint in the middle.
        let factor = 1 + (self.ramp.sharpness() / 8.0) as u32;
        parts_s(self.ramp_s, factor * RAMP_PARTS).collect()
    }

    fn half_time_s(&self, position: f64) -> f64 {
        let at_top = self.top_speed * self.ramp_s;
        if position >= at_top * self.area {
            self.lost_s() + position / self.top_speed
        } else {
            self.ramp_s * self.ramp.at_travel(position / at_top)
        }
    }

    fn text(&self, limit_steps_s: f64) -> String {
        let peaks = self.all_peaks();
        let jerk =
            if peaks.jerk > 0.0 { format!(", {} steps/s\u{b3}", grouped(peaks.jerk)) } else { String::new() };
        let longest_s = self.longest_ramp_s(limit_steps_s);
        peaks.to_text() + &jerk + &ramp_up_to(longest_s, self.halves.duration_s)
    }
}

#[cfg(test)]
mod tests;
