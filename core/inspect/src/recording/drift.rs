//! Clock drift: a line through lateness over time that outliers do not tilt.
//!
//! ```text
//! late               .  excluded        1. slope: median of the slopes from each event to the one n/4 events later
//! |                    . - '           2. excluded: events whose distance from that line exceeds 6 median
//!   |          . - ' . '                    deviations and a cycle
//!   |  . - ' .                           3. least-squares line through the other events
//!   +------------------------> time
//! ```
//!
//! The medians tolerate that half of the slopes are wrong (Theil-Sen with fewer pairs). Least squares then resolve a
//! drift below one cycle.

use alloc::vec::Vec;

/// Maximum events for the medians; of more, only every second, third, … is used.
const MAX_SAMPLED: usize = 1 << 20;
/// Events of a pair are this fraction of all events apart.
const PART: usize = 4;
/// About four standard deviations.
const DEVIATIONS: f64 = 6.0;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Drift {
    pub(super) slope: f64,
    pub(super) late_s: f64,
    /// Maximum distance of events that count, in s.
    pub(super) within_s: f64,
}

impl Drift {
    /// Fits `count` events in the order of time, each (time, lateness) in s; a cycle lasts `cycle_s`.
    pub(super) fn of(count: usize, cycle_s: f64, event: impl Fn(usize) -> Option<(f64, f64)>) -> Self {
        let sampled: Vec<(f64, f64)> =
            (0..count).step_by(count.div_ceil(MAX_SAMPLED).max(1)).filter_map(&event).collect();
        let later = sampled.iter().skip((sampled.len() / PART).max(1));
        let slopes = sampled.iter().zip(later).filter(|(one, other)| other.0 > one.0);
        let slope = median(slopes.map(|(one, other)| (other.1 - one.1) / (other.0 - one.0)).collect());
        let left = |(time, late): (f64, f64)| late - slope * time;
        let middle = median(sampled.iter().copied().map(left).collect());
        let off = |event: (f64, f64)| libm::fabs(left(event) - middle);
        let within_s = DEVIATIONS * median(sampled.iter().copied().map(off).collect()) + cycle_s;
        // Least squares about the means, of the lateness without the first slope.
        let counting = || (0..count).filter_map(&event).filter(|event| off(*event) <= within_s);
        let (mut n, mut times, mut sum) = (0.0, 0.0, 0.0);
        for event in counting() {
            (n, times, sum) = (n + 1.0, times + event.0, sum + left(event));
        }
        if n == 0.0 {
            return Self { slope, late_s: middle, within_s };
        }
        let (mean_time, mean) = (times / n, sum / n);
        let (mut covariance, mut variance) = (0.0, 0.0);
        for event in counting() {
            let time = event.0 - mean_time;
            covariance += time * (left(event) - mean);
            variance += time * time;
        }
        let correction = if variance > 0.0 { covariance / variance } else { 0.0 };
        Self { slope: slope + correction, late_s: mean - correction * mean_time, within_s }
    }

    /// The lateness that the line does not explain, in s.
    pub(super) fn left(&self, time_s: f64, late_s: f64) -> f64 {
        late_s - self.late_s - self.slope * time_s
    }

    pub(super) fn is_outlier(&self, left_s: f64) -> bool {
        libm::fabs(left_s) > self.within_s
    }
}

fn median(mut of: Vec<f64>) -> f64 {
    let (half, is_odd) = (of.len() / 2, of.len() % 2 == 1);
    if of.is_empty() {
        return 0.0;
    }
    let (below, middle, _) = of.select_nth_unstable_by(half, f64::total_cmp);
    let middle = *middle;
    if is_odd {
        return middle;
    }
    let below = below.iter().copied().fold(f64::NEG_INFINITY, libm::fmax);
    (below + middle) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reproducible noise in 0..1.
    fn noise(k: usize) -> f64 {
        ((k as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1_u64 << 53) as f64
    }

    #[track_caller]
    fn check(count: usize, apart_s: f64, cycle_s: f64, ppm: f64, off_ppm: f64, late: impl Fn(usize) -> f64) {
        let event = |k: usize| {
            let time = apart_s * k as f64;
            (time, libm::floor((ppm * 1e-6 * time + late(k)) / cycle_s + 0.5) * cycle_s)
        };
        let found = Drift::of(count, cycle_s, |k| Some(event(k))).slope * 1e6;
        assert!((found - ppm).abs() <= off_ppm, "{found} ppm, not {ppm}");
    }

    #[test]
    fn late_events_and_a_pause_do_not_change_the_drift() {
        let jitter = |k| 2e-6 * noise(k);
        for ppm in [-300.0, 0.0, 50.0] {
            // One of a thousand is late by 10 ms: anywhere, also the first and the last.
            for at in [0, 1, 250, 500, 998, 999] {
                check(1000, 1e-3, 1e-7, ppm, 0.2, |k| jitter(k) + if k == at { 0.01 } else { 0.0 });
            }
            // One in five is late by up to 5 ms.
            check(1000, 1e-3, 1e-7, ppm, 0.5, |k| {
                jitter(k) + if k % 5 == 2 { 5e-3 * noise(k + 7) } else { 0.0 }
            });
            // All after a pause of 10 ms.
            for at in [100, 300, 450, 550, 700, 900] {
                check(1000, 1e-3, 1e-7, ppm, 0.5, |k| jitter(k) + if k >= at { 0.01 } else { 0.0 });
            }
        }
    }

    #[test]
    fn a_drift_below_one_cycle_is_measured() {
        // 100 ms in samples of 1 us: 15 ppm come to a sample and a half.
        check(200, 5e-4, 1e-6, 15.0, 4.0, |k| 1e-6 * noise(k));
        check(200, 5e-4, 1e-6, 0.0, 4.0, |k| 1e-6 * noise(k));
    }

    #[test]
    fn more_events_than_are_sampled_and_too_few_have_a_drift() {
        check(3 * MAX_SAMPLED + 5, 1e-5, 1e-7, 33.0, 0.01, |k| if k % 1000 == 0 { 0.01 } else { 0.0 });
        let of = |events: &[(f64, f64)]| Drift::of(events.len(), 1e-6, |k| events.get(k).copied());
        assert_eq!(of(&[]).slope, 0.0);
        assert_eq!((of(&[(3.0, 1.0)]).slope, of(&[(3.0, 1.0)]).late_s), (0.0, 1.0));
        assert!((of(&[(0.0, 0.0), (1.0, 1e-4)]).slope - 1e-4).abs() < 1e-15);
        // All at one time.
        assert_eq!(of(&[(1.0, 0.0), (1.0, 1.0), (1.0, 2.0)]).slope, 0.0);
    }
}
