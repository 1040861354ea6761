//! A distance in a given time with shaped ramps from a start speed to a plateau and on to an end speed.
//!
//! ```text
//!  vp |     .--------.       v  = v0 + (vp - v0)*g(t/t_s)          in the first ramp, and mirrored from v1 in the last
//!     |    /          \      vp = (n - (v0 + v1)*t_s*(1 - A))/(T - 2*t_s*(1 - A))
//!  v0 | .-'            '- v1 A  the area of the shape g
//!     +-----------------------
//!         t_s           T-t_s  T
//! ```

use crate::curves::curve::greater;
use crate::curves::numeric::Shape;
use crate::curves::phases::{RelativeState, State};
use crate::curves::ramp::Ramp;
use crate::format::ramp_up_to;
use crate::timing::Number;
use alloc::{string::String, vec::Vec};
use core::f64::consts::PI;

/// The shape of both ramps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SpeedShape {
    Cosine,
    Ramp(Ramp),
}

impl SpeedShape {
    pub(crate) fn area(self) -> f64 {
        match self {
            Self::Cosine => 0.5,
            Self::Ramp(ramp) => ramp.area(),
        }
    }

    /// Part of the change of speed at x of 0..=1, its integral and its slope.
    fn at(self, x: f64) -> (f64, f64, f64) {
        match self {
            Self::Cosine => {
                let sine = libm::sin(PI * x / 2.0);
                (sine * sine, (PI * x).minus_its_sine() / (2.0 * PI), PI / 2.0 * libm::sin(PI * x))
            }
            Self::Ramp(ramp) => (ramp.speed(x), ramp.travel(x), ramp.slope(x)),
        }
    }

    fn max_curvature(self) -> f64 {
        match self {
            Self::Cosine => PI * PI / 2.0,
            Self::Ramp(ramp) => ramp.max_curvature(),
        }
    }
}

/// A move between two speeds in a given time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedRamps {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Along the move, from 0 on.
    pub(crate) start_speed: f64,
    pub(crate) end_speed: f64,
    pub(crate) duration_s: f64,
    pub(crate) ramp_s: f64,
    pub(crate) shape: SpeedShape,
}

impl SpeedRamps {
    fn steps(&self) -> f64 {
        libm::fabs(self.to - self.from)
    }

    fn lost_s(&self) -> f64 {
        self.ramp_s * (1.0 - self.shape.area())
    }

    /// Speed of the plateau along the move; a move that would have to reverse has none above 0.
    pub(crate) fn plateau_speed(&self) -> f64 {
        let lost_s = self.lost_s();
        (self.steps() - (self.start_speed + self.end_speed) * lost_s) / (self.duration_s - 2.0 * lost_s)
    }
}

impl Shape for SpeedRamps {
    fn end_position(&self) -> f64 {
        self.to
    }

    fn parts(&self) -> u32 {
        64
    }

    fn changes_s(&self) -> Vec<f64> {
        let ends_s = [self.ramp_s, self.duration_s - self.ramp_s, self.duration_s];
        let mut before_s = 0.0;
        let mut changes_s: Vec<f64> = Vec::new();
        for end_s in ends_s {
            if end_s > before_s {
                changes_s.push(end_s);
                before_s = end_s;
            }
        }
        changes_s
    }

    fn state(&self, t: f64, within_s: f64) -> RelativeState {
        let sign = if self.to < self.from { -1.0 } else { 1.0 };
        let vp = self.plateau_speed();
        let ramp = |speed: f64, t: f64| {
            let (part, area, slope) = self.shape.at((t / self.ramp_s).clamp(0.0, 1.0));
            State {
                position: sign * (speed * t + (vp - speed) * self.ramp_s * area),
                speed: sign * (speed + (vp - speed) * part),
                acceleration: sign * (vp - speed) / self.ramp_s * slope,
            }
        };
        if within_s < self.ramp_s {
            RelativeState { origin: self.from, state: ramp(self.start_speed, t) }
        } else if within_s > self.duration_s - self.ramp_s {
            let mirrored = ramp(self.end_speed, self.duration_s - t);
            let (position, acceleration) = (-mirrored.position, -mirrored.acceleration);
            RelativeState { origin: self.to, state: State { position, acceleration, ..mirrored } }
        } else {
            let position = sign * (self.start_speed * self.lost_s() + vp * (t - self.lost_s()));
            let state = State { position, speed: sign * vp, acceleration: 0.0 };
            RelativeState { origin: self.from, state }
        }
    }

    fn max_jerk(&self) -> f64 {
        if self.ramp_s <= 0.0 {
            return 0.0;
        }
        let vp = self.plateau_speed();
        let change = greater(libm::fabs(vp - self.start_speed), libm::fabs(vp - self.end_speed));
        change / (self.ramp_s * self.ramp_s) * self.shape.max_curvature()
    }

    /// Text about the longest ramp that keeps the plateau within a speed; empty if no ramp does.
    fn text(&self, speed: f64) -> String {
        let spare = speed * self.duration_s - self.steps();
        let slower = 2.0 * speed - self.start_speed - self.end_speed;
        let longest_s = spare / ((1.0 - self.shape.area()) * slower);
        ramp_up_to((spare >= 0.0 && slower > 0.0).then_some(longest_s), self.duration_s)
    }
}
