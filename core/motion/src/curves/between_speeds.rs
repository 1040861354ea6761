//! Moves between two speeds within limits: ramp, peak speed and phases.
//!
//! ```text
//! speed |     .------.        ramp from u to w: d = |w - u|, limit L of its direction, jerk J
//!       |   .'        '.        time   d/L + L/J if d >= L^2/J, else 2*sqrt(d/J)
//! start |.-'            '--     steps  (u + w)/2 * time
//!       +------------------ end
//! ```
//!
//! With an infinite jerk the ramps are straight: a trapezoid.

use crate::bisection::border;
use crate::curves::curve::greater;
use crate::curves::phases::{Phase, Phases};
use crate::square_root;

/// Limits of a move in steps and s, each above 0; with an infinite jerk the acceleration jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MoveLimits {
    /// In steps/s.
    pub(crate) speed: f64,
    /// Limit while the speed rises, in steps/s^2.
    pub(crate) acceleration: f64,
    /// Limit while the speed falls, in steps/s^2.
    pub(crate) deceleration: f64,
    /// In steps/s^3.
    pub(crate) jerk: f64,
}

impl MoveLimits {
    /// The limit of the acceleration or the deceleration between two speeds from 0 on.
    pub(crate) fn of_ramp(&self, from: f64, to: f64) -> f64 {
        if to > from { self.acceleration } else { self.deceleration }
    }

    /// Duration in s of a ramp between two speeds from 0 on.
    fn ramp_s(&self, from: f64, to: f64) -> f64 {
        let (change, limit) = (libm::fabs(to - from), self.of_ramp(from, to));
        let full_jerk_s = limit / self.jerk;
        if change <= 0.0 {
            0.0
        } else if change >= limit * full_jerk_s {
            change / limit + full_jerk_s
        } else {
            2.0 * square_root(change / self.jerk)
        }
    }

    /// Travel in steps of a ramp between two speeds from 0 on.
    pub(crate) fn ramp_steps(&self, from: f64, to: f64) -> f64 {
        (from + to) / 2.0 * self.ramp_s(from, to)
    }

    fn ramp(&self, from: f64, to: f64) -> [Phase; 3] {
        let (change, limit) = (libm::fabs(to - from), self.of_ramp(from, to));
        let full_jerk_s = limit / self.jerk;
        let (jerk_s, constant_s, acceleration) = if change >= limit * full_jerk_s {
            (full_jerk_s, change / limit - full_jerk_s, limit)
        } else {
            let jerk_s = square_root(change / self.jerk);
            (jerk_s, 0.0, self.jerk * jerk_s)
        };
        let jerk = if full_jerk_s > 0.0 { self.jerk } else { 0.0 };
        let rising = [
            Phase { time_s: jerk_s, acceleration: 0.0, jerk },
            Phase { time_s: constant_s, acceleration, jerk: 0.0 },
            Phase { time_s: jerk_s, acceleration, jerk: -jerk },
        ];
        if to < from { rising.map(Phase::mirrored) } else { rising }
    }

    /// The peak speed of a move over `steps` > 0; `None` if they are too short for the ramp from `start` to `end`.
    pub(crate) fn peak_speed(&self, steps: f64, start: f64, end: f64) -> Option<f64> {
        let ramps = |peak: f64| self.ramp_steps(start, peak) + self.ramp_steps(peak, end);
        let min = greater(start, end);
        if ramps(self.speed) <= steps {
            return Some(self.speed);
        }
        // A rounding must not refuse the distance of a ramp itself.
        if ramps(min) > steps * (1.0 + 4.0 * f64::EPSILON) {
            return None;
        }
        if self.jerk == f64::INFINITY {
            let Self { acceleration: up, deceleration: down, .. } = *self;
            let square = (2.0 * up * down * steps + down * start * start + up * end * end) / (up + down);
            return Some(greater(min, square_root(square)));
        }
        Some(border(min, self.speed, |peak| ramps(peak) <= steps).0)
    }

    /// A move from one position to another; the speeds count along the move. `None` as in [`Self::peak_speed`].
    pub(crate) fn plan(&self, from: f64, to: f64, start: f64, end: f64) -> Option<Phases> {
        let (steps, sign) = (libm::fabs(to - from), if to < from { -1.0 } else { 1.0 });
        let peak = self.peak_speed(steps, start, end)?;
        let cruise_s = self.cruise_s(steps, start, peak, end);
        let phases = self.ramp(start, peak).into_iter().chain([Phase::cruise(cruise_s)]);
        let phases = phases.chain(self.ramp(peak, end));
        let phases = phases.map(|phase| if sign < 0.0 { phase.mirrored() } else { phase });
        Some(Phases::new(from, sign * start, phases).ending_at(to, sign * end))
    }

    fn cruise_s(&self, steps: f64, start: f64, peak: f64, end: f64) -> f64 {
        let cruise = steps - self.ramp_steps(start, peak) - self.ramp_steps(peak, end);
        if cruise > 0.0 && peak > 0.0 { cruise / peak } else { 0.0 }
    }

    /// Duration in s of the move over `steps` > 0; `None` as in [`Self::peak_speed`].
    pub(crate) fn duration_s(&self, steps: f64, start: f64, end: f64) -> Option<f64> {
        let peak = self.peak_speed(steps, start, end)?;
        let ramps_s = self.ramp_s(start, peak) + self.ramp_s(peak, end);
        Some(ramps_s + self.cruise_s(steps, start, peak, end))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peak_speeds_and_durations_follow_the_limits() {
        let infinite = f64::INFINITY;
        // Limits, steps, start and end speed; peak speed and duration.
        let rows = [
            ([4000.0, 9000.0, 6000.0, infinite], [2000.0, 250.0, 1000.0], Some([3876.2095, 0.882_280_414])),
            ([10_000.0, 100_000.0, 50_000.0, 2e6], [3200.0, 2000.0, 1000.0], Some([10_000.0, 0.464_25])),
            ([4000.0, 20_000.0, 20_000.0, 4e5], [3200.0, 0.0, 0.0], Some([4000.0, 1.05])),
            // Four phases of jerk: s = 2*J*t^3, and the peak is J*t^2.
            ([4000.0, 20_000.0, 20_000.0, 4e5], [12.5, 0.0, 0.0], Some([250.0, 0.1])),
            // Only the deceleration reaches its limit: 0.1 s up to 1000 steps/s, 0.1025 s down.
            ([4000.0, 1e5, 16_000.0, 4e5], [101.25, 0.0, 0.0], Some([1000.0, 0.2025])),
            ([5000.0, 1e5, 1e5, infinite], [100.0, 5000.0, 1000.0], None),
            ([5000.0, 1e5, 1e5, infinite], [120.0, 5000.0, 1000.0], Some([5000.0, 0.04])),
        ];
        for ([speed, acceleration, deceleration, jerk], [steps, start, end], expected) in rows {
            let limits = MoveLimits { speed, acceleration, deceleration, jerk };
            let found = limits.peak_speed(steps, start, end).zip(limits.duration_s(steps, start, end));
            assert_eq!(found.is_some(), expected.is_some(), "{steps} steps");
            let (Some((peak, duration_s)), Some([expected_peak, expected_s])) = (found, expected) else {
                continue;
            };
            assert!((peak - expected_peak).abs() < 1e-4, "{peak}");
            assert!((duration_s - expected_s).abs() < 1e-9, "{duration_s}");
            let (forth, back) =
                (limits.plan(0.0, steps, start, end), limits.plan(1.0, 1.0 - steps, start, end));
            let (forth, back) = (forth.expect("fits"), back.expect("fits"));
            for part in 0..=1000 {
                let t = duration_s * f64::from(part) / 1000.0;
                let (there, mirrored) = (forth.state(t), back.state(t));
                assert!((there.position + mirrored.position - 1.0).abs() < 1e-9, "{t}");
                assert!(there.speed <= speed * (1.0 + 1e-12), "{t}");
            }
            assert_eq!(forth.end().position, steps);
        }
    }
}
