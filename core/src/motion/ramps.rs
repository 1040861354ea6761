//! A move with two ramps of a given shape, exact in distance and in time (DESIGN B4).
//!
//! As the cosine S-curve has it: n steps, the time T of the move and the time t_s of each ramp,
//! 0 <= t_s <= T/2, with a shape g of the area A (`ramp`) in place of the cosine:
//!
//! ```text
//!  f_max |     .--------.       f_max = n/(T - 2*t_s*(1 - A))      n/(T - t_s) where A is 1/2
//!        |    /          \      f(t)  = f_max*g(t/t_s)             in the ramp
//!        | .-'            '-.   s(t)  = f_max*t_s*G(t/t_s)         in the ramp
//!        +-----------------------     = f_max*(t - t_s*(1 - A))    in the plateau
//!         t_s           T-t_s  T      = n - s(T - t)               from T/2 on
//! ```
//!
//! Slowing down is speeding up, mirrored in time: with an exponential the speed falls slowly at first
//! and steeply at the end.

use super::{
    Curve, Peaks,
    mirrored::Mirrored,
    ramp::{Ramp, longest_ramp_s},
    words::{grouped, in_words, ramp_up_to},
};
use alloc::{format, string::String};

/// A move with ramps of a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramps {
    halves: Mirrored,
    pub(super) ramp_s: f64,
    pub(super) ramp: Ramp,
    /// A.
    area: f64,
    /// f_max in steps/s.
    top_speed: f64,
}

impl Ramps {
    /// `steps` (left negative) in `duration_s` > 0 with ramps of `ramp_s`, 0 to half of it.
    #[must_use]
    pub fn new(steps: i64, duration_s: f64, ramp_s: f64, ramp: Ramp) -> Self {
        let area = ramp.area();
        let top_speed = steps.unsigned_abs() as f64 / (duration_s - 2.0 * ramp_s * (1.0 - area));
        Self { halves: Mirrored { steps, duration_s }, ramp_s, ramp, area, top_speed }
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

    /// x of the ramp at `t` after the start or before the end, 0 to 1; `None` in the plateau.
    fn part(&self, t: f64) -> Option<f64> {
        (t < self.ramp_s).then(|| t / self.ramp_s)
    }

    /// When the curve is at `place`, in s; `place` in steps without sign, 0 to all.
    /// Step k falls due at k - 1/2 (B1).
    #[must_use]
    pub fn time_s(&self, place: f64) -> f64 {
        self.halves.time_s(place, |place| self.climb_s(place))
    }

    /// When the first half is at `place`.
    fn climb_s(&self, place: f64) -> f64 {
        let at_top = self.top_speed * self.ramp_s;
        if place >= at_top * self.area {
            self.lost_s() + place / self.top_speed
        } else {
            self.ramp_s * self.ramp.at_way(place / at_top)
        }
    }

    /// Time that a ramp costs against a start at top speed.
    fn lost_s(&self) -> f64 {
        self.ramp_s * (1.0 - self.area)
    }

    /// s(t) of the first half, in steps without sign.
    fn first_half(&self, t: f64) -> f64 {
        match self.part(t) {
            Some(x) => self.top_speed * self.ramp_s * self.ramp.way(x),
            None => self.top_speed * (t - self.lost_s()),
        }
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

    fn detail(&self, limit_steps_s: f64) -> String {
        let peaks = self.peaks();
        let jerk =
            if peaks.jerk > 0.0 { format!(", {} steps/s\u{b3}", grouped(peaks.jerk)) } else { String::new() };
        let longest_s = self.longest_ramp_s(limit_steps_s);
        in_words(peaks) + &jerk + &ramp_up_to(longest_s, self.duration_s())
    }
}

#[cfg(test)]
mod tests {
    use super::{super::cosine::Cosine, *};
    use alloc::vec::Vec;

    fn shapes() -> [Ramp; 7] {
        let [a, b, c] = [1.0, 6.0, 20.0].map(Ramp::sigmoid);
        [Ramp::Straight, Ramp::Bezier, a, b, c, Ramp::exponential(0.1), Ramp::exponential(4.0)]
    }

    /// Moves of every sort: (steps, duration, ramp).
    const MOVES: &[(i64, f64, f64)] = &[
        (3200, 0.4, 0.2),
        (-6400, 0.4, 0.1),
        (6401, 0.3, 0.0),
        (1, 2.0, 1.0),
        (-2, 1e-6, 5e-7),
        (10, 1e-6, 5e-324),
        (1_000_000_000, 86_400.0, 43_200.0),
        (1_000_000_000, 86_400.0, 1e-6),
        (7, 86_400.0, 1.0),
    ];

    #[test]
    fn top_speeds_are_those_of_the_area() {
        for ramp in [Ramp::Straight, Ramp::Bezier, Ramp::sigmoid(6.0)] {
            assert_eq!(Ramps::new(6400, 0.4, 0.2, ramp).top_speed(), Cosine::new(6400, 0.4, 0.2).top_speed());
        }
        // 6400/(0.4 - 0.4*(1 - 0.7686573603637741)).
        let found = Ramps::new(-6400, 0.4, 0.2, Ramp::exponential(4.0)).top_speed();
        assert!((found - 20_815.516_542_283_4).abs() < 1e-6, "{found}");
        let longest = Ramps::new(3200, 0.4, 0.2, Ramp::sigmoid(6.0)).longest_ramp_s(19_200.0).unwrap();
        assert!((longest - 0.233_333_3).abs() < 1e-6, "{longest}");
    }

    #[test]
    fn the_end_is_exact_the_halves_are_mirrored_and_nothing_turns_round() {
        for ramp in shapes() {
            for &(steps, duration_s, ramp_s) in MOVES {
                let curve = Ramps::new(steps, duration_s, ramp_s, ramp);
                assert_eq!((curve.position(0.0), curve.position(duration_s)), (0.0, steps as f64));
                let count = steps.unsigned_abs() as f64;
                let mut before = 0.0;
                for i in 0..=4000 {
                    let t = duration_s * f64::from(i) / 4000.0;
                    let place = libm::fabs(curve.position(t));
                    assert!(place >= before && place <= count, "{ramp:?} {steps} at {t}: {before} {place}");
                    before = place;
                    let mirrored = count - libm::fabs(curve.position(duration_s - t));
                    assert!((place - mirrored).abs() <= 1e-13 * count, "{ramp:?} {steps} at {t}");
                }
            }
        }
    }

    #[test]
    fn speed_and_acceleration_are_the_differences_of_position_and_speed() {
        for ramp in shapes() {
            for (steps, duration_s, ramp_s) in [(3200, 0.4, 0.2), (-6400, 0.4, 0.1), (1, 2.0, 0.5)] {
                let curve = Ramps::new(steps, duration_s, ramp_s, ramp);
                let peaks = curve.peaks();
                let dt = duration_s * 1e-6;
                for i in 0..1000 {
                    // Not where a joint is.
                    let t = duration_s * (f64::from(i) + 0.37) / 1000.0;
                    let slope = |of: &dyn Fn(f64) -> f64| (of(t + dt) - of(t - dt)) / (2.0 * dt);
                    let (speed, acceleration) = (slope(&|t| curve.position(t)), slope(&|t| curve.speed(t)));
                    assert!((speed - curve.speed(t)).abs() < 1e-6 * peaks.speed, "{ramp:?} at {t}");
                    let error = (acceleration - curve.acceleration(t)).abs();
                    assert!(error < 1e-6 * peaks.acceleration, "{ramp:?} at {t}: {error}");
                    assert!(curve.acceleration(t).abs() <= peaks.acceleration * (1.0 + 1e-12));
                }
            }
        }
    }

    #[test]
    fn a_steps_cycle_is_where_the_position_is_rounded_to_the_next() {
        let clock = 16e6;
        for ramp in shapes() {
            for &(steps, duration_s, ramp_s) in MOVES {
                let curve = Ramps::new(steps, duration_s, ramp_s, ramp);
                let count = steps.unsigned_abs();
                // All steps of a short move; of a long one its first, its last and some between.
                let some = (0..1000).map(|i| 1 + i * (count - 1) / 999);
                let all: Vec<u64> = (1..=count.min(7000))
                    .chain(some)
                    .chain(count.saturating_sub(99).max(1)..=count)
                    .collect();
                for k in all {
                    let place = k as f64 - 0.5;
                    let cycle = libm::floor(curve.time_s(place) * clock + 0.5);
                    let at = |cycle: f64| libm::fabs(curve.position(cycle / clock));
                    // The position itself has its last digit.
                    let digit = count as f64 * 4.0 * f64::EPSILON;
                    let (before, after) = (at(cycle - 1.0), at(cycle + 1.0));
                    assert!(
                        before <= place + digit && after >= place - digit,
                        "{ramp:?} {steps}: step {k} at {cycle}, {before} {after}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_straight_ramps_steps_are_where_whole_numbers_put_them() {
        // 6400 steps in 0.4 s, ramps 0.2 s: s = f_max*t^2/(2*t_s) = 80000*t^2, so at c cycles of 16 MHz
        // s = c^2/3.2e9, and step k is due where c^2 = 1.6e9*(2k - 1).
        let curve = Ramps::new(6400, 0.4, 0.2, Ramp::Straight);
        for k in 1..=3200_i128 {
            let cycle = libm::floor(curve.time_s(k as f64 - 0.5) * 16e6 + 0.5) as i128;
            let level = 4 * 1_600_000_000 * (2 * k - 1);
            let square = |half_cycles: i128| half_cycles * half_cycles;
            assert!(square(2 * cycle - 1) <= level && level <= square(2 * cycle + 1), "step {k} at {cycle}");
        }
    }

    #[test]
    fn peaks_of_one_turn_are_those_of_the_formulas() {
        // f_max = 16000, t_s = 0.2: slopes of 80000, bends of 400000.
        let peaks = |ramp| Ramps::new(3200, 0.4, 0.2, ramp).peaks();
        let straight = peaks(Ramp::Straight);
        assert_eq!(
            straight,
            Peaks {
                speed: 16_000.0,
                acceleration: 80_000.0,
                acceleration_jump: 160_000.0,
                ..Peaks::default()
            }
        );
        let bezier = peaks(Ramp::Bezier);
        assert_eq!(
            (bezier.acceleration, bezier.jerk, bezier.acceleration_jump),
            (120_000.0, 2_400_000.0, 0.0)
        );
        // r/(2*tanh(3)) = 3.014909…, 6/sinh(6) = 0.0297452…, 36*2/(3*sqrt(3))/tanh(3) = 13.92527….
        let sigmoid = peaks(Ramp::sigmoid(6.0));
        for (found, expected) in [
            (sigmoid.acceleration, 80_000.0 * 3.014_909_469_941),
            (sigmoid.acceleration_jump, 160_000.0 * 0.029_745_208_880_876),
            (sigmoid.jerk, 400_000.0 * 13.925_270_352_422_6),
        ] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
        assert_eq!(
            Ramps::new(3200, 0.4, 0.0, Ramp::Bezier).peaks(),
            Peaks { speed: 8000.0, ..Peaks::default() }
        );
    }
}
