//! Mean and root mean square of position, speed and acceleration between two cursors.
//!
//! Both are integrals over the curves, not over pixel columns: three-point Gauss-Legendre between breakpoints for the
//! ideal motion, sums of rectangles for the pulses.

use crate::motion::actual_motion::Pulses;
use stepscope_motion::{AxisPlan, Breakpoints};

/// Mean and root mean square over a span of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    pub mean: f64,
    pub rms: f64,
}

/// Position in steps, speed in steps/s, acceleration in steps/s^2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CursorStats {
    pub position: Moments,
    pub speed: Moments,
    /// `None` for pulses.
    pub acceleration: Option<Moments>,
}

#[derive(Clone, Copy, Default)]
struct Sums {
    of_value: f64,
    of_square: f64,
}

impl Sums {
    fn add(&mut self, value: f64, seconds: f64) {
        self.of_value += value * seconds;
        self.of_square += value * value * seconds;
    }

    fn over(self, seconds: f64) -> Moments {
        Moments { mean: self.of_value / seconds, rms: libm::sqrt(self.of_square / seconds) }
    }
}

/// Gauss-Legendre points in -1..1 and their weights.
pub(crate) const POINTS: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.774_596_669_241_483_4, 5.0 / 18.0)];

/// Statistics of the ideal motion, which starts at `zero_s`, from one time to a later one, in s.
pub fn ideal(plan: &AxisPlan, zero_s: f64, from_s: f64, to_s: f64) -> CursorStats {
    let [mut position, mut speed, mut acceleration] = [Sums::default(); 3];
    Breakpoints::of(plan).intervals(from_s - zero_s, to_s - zero_s, &mut |interval| {
        let (middle, half) =
            ((interval.from_s + interval.to_s) / 2.0, (interval.to_s - interval.from_s) / 2.0);
        for (point, weight) in POINTS {
            let (t, seconds) = (middle + half * point, 2.0 * half * weight * interval.times);
            position.add(plan.position(t), seconds);
            speed.add(plan.speed(t), seconds);
            acceleration.add(plan.acceleration(t), seconds);
        }
    });
    let [position, speed, acceleration] =
        [position, speed, acceleration].map(|sums| sums.over(to_s - from_s));
    CursorStats { position, speed, acceleration: Some(acceleration) }
}

/// Statistics of the pulses between two times in s.
pub fn actual(pulses: &Pulses<'_>, from_s: f64, to_s: f64) -> CursorStats {
    let hz = pulses.hz();
    let (mut position, mut since_s) = (Sums::default(), from_s);
    let mut held = pulses.position_at(from_s);
    for step in pulses.steps.iter().skip(pulses.steps_until(from_s)) {
        let at_s = step.cycle as f64 / hz;
        if at_s >= to_s {
            break;
        }
        position.add(f64::from(held), at_s - since_s);
        (since_s, held) = (at_s, step.position);
    }
    position.add(f64::from(held), to_s - since_s);
    let mut speed = Sums::default();
    pulses.rates(from_s, to_s, &mut |rate| {
        let seconds = libm::fmin(rate.to_s, to_s) - libm::fmax(rate.from_s, from_s);
        speed.add(rate.speed, libm::fmax(0.0, seconds));
    });
    let [position, speed] = [position, speed].map(|sums| sums.over(to_s - from_s));
    CursorStats { position, speed, acceleration: None }
}

/// Acceleration of steps without a plan; `None` where it is unknown throughout.
pub fn actual_acceleration(pulses: &Pulses<'_>, from_s: f64, to_s: f64) -> Option<Moments> {
    let (mut sums, mut known_s) = (Sums::default(), 0.0);
    pulses.accelerations(from_s, to_s, &mut |step_s, next_s, value| {
        let seconds = libm::fmax(0.0, libm::fmin(next_s, to_s) - libm::fmax(step_s, from_s));
        sums.add(value, seconds);
        known_s += seconds;
    });
    (known_s > 0.0).then(|| sums.over(known_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::stored_run::StoredRun;
    use alloc::vec::Vec;
    use stepscope_peripheral::trace::{Step, steps};
    use stepscope_sim::Experiment;

    /// Means of many samples, each in the middle of its interval.
    fn brute(from_s: f64, to_s: f64, samples: u32, value: impl Fn(f64) -> f64) -> Moments {
        let mut sums = Sums::default();
        let each = (to_s - from_s) / f64::from(samples);
        (0..samples).for_each(|sample| sums.add(value(from_s + (f64::from(sample) + 0.5) * each), each));
        sums.over(to_s - from_s)
    }

    #[track_caller]
    fn near(found: Moments, expected: Moments, scale: f64, what: &str) {
        for (found, expected) in [(found.mean, expected.mean), (found.rms, expected.rms)] {
            assert!((found - expected).abs() <= 2e-4 * scale, "{what}: {found} {expected} of {scale}");
        }
    }

    struct Ran {
        experiment: Experiment,
        recording: StoredRun,
        steps: Vec<Step>,
    }

    fn run(source: &str) -> Ran {
        let experiment =
            Experiment::from_json(&alloc::format!(r#"{{"source":{source}}}"#)).expect("no problems");
        let mut recording = StoredRun::default();
        experiment.run(&mut recording);
        let steps = steps(&recording.trace, 0);
        Ran { experiment, recording, steps }
    }

    const MOTIONS: &[&str] = &[
        r#"{"trapezoid":{"distance":{"steps":3000}}},{"trapezoid":{"distance":{"steps":-500}}}"#,
        r#"{"trapezoid":{"distance":{"steps":2000},"method":"table"}}"#,
        r#"{"staircase":{"distance":{"steps":3000}}}"#,
        r#"{"cosine":{"distance":{"steps":3200},"duration_s":0.4,"ramp_s":0.1}}"#,
        r#"{"dwell":{"duration_s":0.1}},{"sine_segments":{"amplitude":{"steps":500},"period_s":0.2,"periods":3}}"#,
    ];

    #[test]
    fn means_equal_those_of_many_samples() {
        for moves in MOTIONS {
            let ran = run(&alloc::format!(r#"{{"motion":{{"axes":[{{"moves":[{moves}]}}]}}}}"#));
            let plan = &ran.experiment.plans()[0];
            let zero_s =
                ran.recording.first_tick().expect("ticks").seconds(ran.experiment.config().clock_hz());
            let pulses = Pulses::of_run(0, &ran.steps, &ran.recording.packets, None, ran.experiment.config());
            let length = plan.duration_s();
            for (from, to) in [(-0.01, length + 0.03), (0.1 * length, 0.37 * length), (0.3, 0.300_1)] {
                let (from, to) = (zero_s + from, zero_s + to);
                let peaks = plan.peaks();
                let far = 3000.0;
                let samples = 1_000_000;
                let found = ideal(plan, zero_s, from, to);
                near(found.position, brute(from, to, samples, |t| plan.position(t - zero_s)), far, moves);
                near(found.speed, brute(from, to, samples, |t| plan.speed(t - zero_s)), peaks.speed, moves);
                let expected = brute(from, to, samples, |t| plan.acceleration(t - zero_s));
                let found = found.acceleration.expect("the ideal curve has one");
                near(found, expected, peaks.acceleration.max(1.0), moves);
                let (found, samples) = (actual(&pulses, from, to), 100_000);
                let at = |t: f64| f64::from(pulses.position_at(t));
                near(found.position, brute(from, to, samples, at), far, moves);
                near(found.speed, brute(from, to, samples, |t| pulses.speed_at(t)), peaks.speed, moves);
            }
        }
    }

    #[test]
    fn means_over_complete_moves_are_exact() {
        let ran = run(
            r#"{"motion":{"axes":[{"moves":[{"constant":{"distance":{"steps":100},"speed":{"steps_s":1000}}},{"dwell":{"duration_s":0.1}}]}]}}"#,
        );
        let found = ideal(&ran.experiment.plans()[0], 0.0, 0.0, 0.2);
        let check =
            |found: f64, expected: f64| assert!((found - expected).abs() <= 1e-12 * expected, "{found}");
        check(found.speed.mean, 500.0);
        check(found.speed.rms, 1000.0 * 0.5_f64.sqrt());
        check(found.position.mean, 75.0);
        // The mean of the square: a third of 100^2 over the first half, 100^2 over the second.
        check(found.position.rms, (10_000.0 * 2.0 / 3.0_f64).sqrt());
        assert_eq!(found.acceleration, Some(Moments::default()));
    }

    #[test]
    fn steps_without_a_plan_have_the_acceleration_of_their_ramps() {
        // A second from rest at 2000 steps/s^2, and half a second at the speed that it comes to: 2000 steps/s.
        let ramp = (1..=1000).map(|k| libm::sqrt(f64::from(k) / 1000.0));
        let steps: Vec<Step> = ramp
            .chain((1..=1000).map(|k| 1.0 + f64::from(k) / 2000.0))
            .zip(1..)
            .map(|(at_s, position)| Step { cycle: (at_s * 16e6) as u64, position })
            .collect();
        let pulses = Pulses::recorded(0, &steps, 16_000_000);
        let found = |from_s: f64, to_s: f64| actual_acceleration(&pulses, from_s, to_s);
        let ramp = found(0.2, 0.9).expect("it is known there");
        near(ramp, Moments { mean: 2000.0, rms: 2000.0 }, 200_000.0, "in the ramp");
        let even = found(1.1, 1.4).expect("it is known there");
        assert!(even.rms < 20.0, "rounding to cycles alone: {even:?}");
        // Of both, each for its time.
        let both = found(0.5, 1.4).expect("it is known there");
        assert!((both.mean - 2000.0 * 0.5 / 0.9).abs() < 10.0, "{both:?}");
        assert!((both.rms - 2000.0 * (0.5_f64 / 0.9).sqrt()).abs() < 10.0, "{both:?}");
        // Within eight steps of an end, and beyond it, the acceleration is unknown.
        let (eighth_s, last_s) = (libm::sqrt(0.008), 1.5);
        for (from_s, to_s) in [(0.0, eighth_s - 1e-6), (last_s - 6.9 / 2000.0, last_s + 1.0), (2.0, 3.0)] {
            assert_eq!(found(from_s, to_s), None, "{from_s} to {to_s}");
        }
        for (time_s, expected) in
            [(0.5, Some(2000.0)), (1.3, Some(0.0)), (0.05, None), (1.499, None), (7.0, None)]
        {
            let found = pulses.acceleration_at(time_s);
            assert_eq!(found.is_some(), expected.is_some(), "{time_s}: {found:?}");
            assert!((found.unwrap_or(0.0) - expected.unwrap_or(0.0)).abs() < 20.0, "{time_s}: {found:?}");
        }
        // At a reversal it is unknown.
        let turned: Vec<Step> =
            (0..40).map(|k: i32| Step { cycle: 100 * k as u64, position: 20 - (k - 20).abs() }).collect();
        let pulses = Pulses::recorded(0, &turned, 1_000_000);
        assert_eq!(pulses.acceleration_at(0.002), None, "the steps around step 20 change their direction");
        assert_eq!(pulses.acceleration_at(0.001), Some(0.0));
    }

    #[test]
    fn segments_have_the_speed_of_their_intervals() {
        let ran = run(r#"{"segments":{"channels":[{"segments":[{"steps":{"count":10}},
            {"dwell":{"length_q16":5242880000}},{"steps":{"count":10,"interval_q16":524288000,"dir":0}}]}]}}"#);
        let pulses = Pulses::of_run(
            0,
            &ran.steps,
            &ran.recording.packets,
            ran.experiment.segments().and_then(|lists| lists.lists().first()),
            ran.experiment.config(),
        );
        // From cycle 1 on 10 steps of 1 ms, 5 ms of rest, 10 steps back of 0.5 ms.
        let found = actual(&pulses, 0.0, 0.02);
        assert!(found.speed.mean.abs() < 0.01, "{found:?}");
        assert!((found.speed.rms - (0.5 * 1e6 + 0.25 * 4e6_f64).sqrt()).abs() < 0.1, "{found:?}");
        for (time_s, expected) in [(0.005, 1000.0), (0.012, 0.0), (0.017, -2000.0), (0.021, 0.0)] {
            assert!(
                (pulses.speed_at(time_s) - expected).abs() < 0.01,
                "{time_s}: {}",
                pulses.speed_at(time_s)
            );
        }
    }
}
