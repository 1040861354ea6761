//! A move with two ramps of a given shape, exact in distance and in time (DESIGN B4).
//!
//! The cosine S-curve with a shape g of the area A (`ramp`) in place of the cosine:
//!
//! ```text
//!  f_max |     .--------.       f_max = n/(T - 2*t_s*(1 - A))      n/(T - t_s) where A is 1/2
//!        |    /          \      f(t)  = f_max*g(t/t_s)             in the ramp
//!        | .-'            '-.   s(t)  = f_max*t_s*G(t/t_s)         in the ramp
//!        +-----------------------     = f_max*(t - t_s*(1 - A))    in the plateau
//!         t_s           T-t_s  T      = n - s(T - t)               from T/2 on
//! ```

use crate::{
    Curve, Peaks,
    curves::{
        mirrored::{Mirrored, RAMP_PARTS, parts_s},
        ramp::{Ramp, longest_ramp_s},
    },
    format::{grouped, ramp_up_to},
    timing::{
        CycleTime, Double, Exact, IsDueBefore, Runs, Schedule, is_mirrored_due_before, one_searched_run,
    },
};
use alloc::{boxed::Box, format, string::String, vec::Vec};

/// A move with ramps of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramps {
    halves: Mirrored,
    ramp_s: f64,
    ramp: Ramp,
    /// A.
    area: f64,
    /// f_max in steps/s.
    top_speed: f64,
}

impl Ramps {
    /// `steps` (left negative) in `duration_s` > 0 with ramps of `ramp_s`, 0 to half of it.
    #[must_use]
    pub fn new(steps: i64, duration_s: f64, ramp_s: f64, ramp: Ramp) -> Self {
        debug_assert!((0.0..=duration_s / 2.0).contains(&ramp_s), "ramps of {ramp_s} s in {duration_s} s");
        let area = ramp.area();
        let top_speed = steps.unsigned_abs() as f64 / (duration_s - 2.0 * ramp_s * (1.0 - area));
        Self { halves: Mirrored { steps, duration_s }, ramp_s, ramp, area, top_speed }
    }

    /// The same move with ramps of another time in s, 0 to half of its duration.
    #[must_use]
    pub fn with_ramp_s(&self, ramp_s: f64) -> Self {
        Self::new(self.halves.steps, self.halves.duration_s, ramp_s, self.ramp)
    }

    /// f_max in steps/s, the speed of the plateau.
    #[must_use]
    pub fn top_speed(&self) -> f64 {
        self.top_speed
    }

    /// The longest ramp in s with which this move keeps its top speed at or under `speed`
    /// ([`longest_ramp_s`]), of which it can use up to T/2; `None` where even no ramp is too fast.
    #[must_use]
    pub fn longest_ramp_s(&self, speed: f64) -> Option<f64> {
        longest_ramp_s(self.halves.steps.unsigned_abs(), self.halves.duration_s, speed, self.area)
    }

    pub(crate) fn joints(&self) -> Vec<f64> {
        self.halves.joints(&[self.top_speed * self.ramp_s * self.area])
    }

    /// x of the ramp at `t` after the start or before the end, 0 to 1; `None` in the plateau.
    fn part(&self, t: f64) -> Option<f64> {
        (t < self.ramp_s).then(|| t / self.ramp_s)
    }

    fn climb_s(&self, place: f64) -> f64 {
        let at_top = self.top_speed * self.ramp_s;
        if place >= at_top * self.area {
            self.lost_s() + place / self.top_speed
        } else {
            self.ramp_s * self.ramp.at_travel(place / at_top)
        }
    }

    fn lost_s(&self) -> f64 {
        self.ramp_s * (1.0 - self.area)
    }

    /// s(t) of the first half, in steps without sign.
    fn first_half(&self, t: f64) -> f64 {
        match self.part(t) {
            Some(x) => self.top_speed * self.ramp_s * self.ramp.travel(x),
            None => self.top_speed * (t - self.lost_s()),
        }
    }
}

/// Of a time in f64 the place in parts of the ramp's travel has 9 u, and a shape's travel at most 25 for what cancels in
/// the sigmoid's logarithm: the time has half of these, as its way begins with its square. A sigmoid's range r that is
/// off by u shifts its steep start by r/2 of them, at most 10. With those of Newton's end, of the products by the ramp's
/// time and the clock, and of the difference from the end, it is off by less than 48 u.
impl Schedule for Ramps {
    fn length(&self, clock_hz: u32) -> CycleTime {
        CycleTime::exact(&Exact::of(self.halves.duration_s).times(clock_hz.into()))
    }

    fn runs(&self, clock_hz: u32) -> Runs<'_> {
        one_searched_run(self, clock_hz, self.joints())
    }

    fn is_due_before(&self, clock_hz: u32) -> IsDueBefore<'_> {
        let cycles = |time_s: f64| Exact::of(time_s).times(clock_hz.into()).double();
        let (duration, ramp) = (cycles(self.halves.duration_s), cycles(self.ramp_s));
        let (shape, count) = (self.ramp.exactly(), self.halves.steps.unsigned_abs());
        // Both ramps lose as much time against a start at top speed.
        let lost = ramp * (Double::from(1.0) - shape.area());
        let top_speed = Double::from(count) / (duration - lost * 2.0);
        Box::new(move |k, since| {
            is_mirrored_due_before((k, count), since, duration, |t, position| {
                if t < ramp {
                    shape.is_past(t / ramp, Double::from(position) / (top_speed * ramp))
                } else {
                    top_speed * (t - lost) > position.into()
                }
            })
        })
    }
}

impl Curve for Ramps {
    fn duration_s(&self) -> f64 {
        self.halves.duration_s
    }

    fn steps(&self) -> i64 {
        self.halves.steps
    }

    fn position(&self, t: f64) -> f64 {
        self.halves.position(t, |t| self.first_half(t))
    }

    fn speed(&self, t: f64) -> f64 {
        let part = self.part(self.halves.nearer_end(t));
        self.halves.signed(part.map_or(self.top_speed, |x| self.top_speed * self.ramp.speed(x)))
    }

    fn acceleration(&self, t: f64) -> f64 {
        let Some(x) = self.part(self.halves.nearer_end(t)) else { return 0.0 };
        self.halves.acceleration(t, self.top_speed / self.ramp_s * self.ramp.slope(x))
    }

    /// The acceleration jumps where a ramp ends with some of it, twice as far where the other follows
    /// without a plateau.
    fn peaks(&self) -> Peaks {
        if self.ramp_s <= 0.0 {
            return Peaks { speed: self.top_speed, ..Peaks::default() };
        }
        let scale = self.top_speed / self.ramp_s;
        let turns = 2.0 * self.ramp_s >= self.halves.duration_s;
        let last = scale * self.ramp.slope(1.0);
        Peaks {
            speed: self.top_speed,
            acceleration: scale * self.ramp.greatest_slope(),
            jerk: scale / self.ramp_s * self.ramp.greatest_bend(),
            acceleration_jump: if turns { 2.0 * last } else { last },
            ..Peaks::default()
        }
    }

    fn breakpoints_s(&self) -> Vec<f64> {
        // A shape that bends more than a cosine is cut into more pieces, and its middle stays a breakpoint.
        let times = 1 + (self.ramp.sharpness() / 8.0) as u32;
        self.halves.breakpoints_s(parts_s(self.ramp_s, times * RAMP_PARTS))
    }

    fn time_s(&self, place: f64) -> f64 {
        self.halves.time_s(place, |place| self.climb_s(place))
    }

    fn detail(&self, limit_steps_s: f64) -> String {
        let peaks = self.peaks();
        let jerk =
            if peaks.jerk > 0.0 { format!(", {} steps/s\u{b3}", grouped(peaks.jerk)) } else { String::new() };
        let longest_s = self.longest_ramp_s(limit_steps_s);
        peaks.to_text() + &jerk + &ramp_up_to(longest_s, self.duration_s())
    }
}

#[cfg(test)]
mod tests;
