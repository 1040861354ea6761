//! The stretch of time that a spectrum is taken of: whole periods, or a whole motion.
//!
//! ```text
//!        start_s    period_s        all whole periods of the sine: no window, no leakage
//! _______|/\/\/\/\/\/\/\/\|______
//! ```

use crate::motion::{AxisPlan, Profile};
use alloc::vec::Vec;

/// Longest transform.
const MOST_POINTS: usize = 1 << 20;

/// The stretch of time that a spectrum is taken of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Its start in s.
    pub start_s: f64,
    /// Time of one period in s, above 0.
    pub period_s: f64,
    /// How many whole periods, at least 1.
    pub periods: u32,
    /// Whether the motion repeats; otherwise the whole of it stands as one period.
    pub periodic: bool,
}

impl Stretch {
    /// All periods of the first periodic move, or, where none is, the whole motion; `None` for a
    /// motion that takes no time.
    #[must_use]
    pub fn of(plan: &AxisPlan) -> Option<Self> {
        let sine = plan.moves().iter().find_map(|planned| match &planned.profile {
            Profile::SineSegments(sine) => Some((planned.start_s, sine)),
            _ => None,
        });
        let stretch = match sine {
            Some((start_s, sine)) => {
                Self { start_s, period_s: sine.period_s(), periods: sine.periods(), periodic: true }
            }
            None => Self { start_s: 0.0, period_s: plan.duration_s(), periods: 1, periodic: false },
        };
        (stretch.period_s > 0.0).then_some(stretch)
    }

    /// Its length in s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.period_s * f64::from(self.periods)
    }

    /// The frequency of harmonic 1 in Hz.
    #[must_use]
    pub fn fundamental_hz(&self) -> f64 {
        1.0 / self.period_s
    }

    /// Pulses within the stretch: when since its start, in s, and +1 or -1.
    pub(super) fn within<'p>(&self, pulses: &'p [(f64, i8)]) -> impl Iterator<Item = (f64, f64)> + use<'p> {
        let (start_s, length_s) = (self.start_s, self.length_s());
        pulses
            .iter()
            .map(move |&(time_s, direction)| (time_s - start_s, f64::from(direction)))
            .filter(move |(since_s, _)| (0.0..length_s).contains(since_s))
    }
}

/// A transform's length: a power of two, not beyond all bounds.
pub(super) fn transform_points(points: usize) -> usize {
    points.clamp(16, MOST_POINTS).next_power_of_two()
}

/// The ideal position over the stretch less its straight line, at equal steps of time.
pub(super) fn sampled(plan: &AxisPlan, stretch: &Stretch, points: usize) -> Vec<f64> {
    let points = transform_points(points);
    let at = |part: f64| plan.position(stretch.start_s + stretch.length_s() * part);
    let first = at(0.0);
    let way = if stretch.periodic { 0.0 } else { at(1.0) - first };
    (0..points)
        .map(|i| {
            let part = i as f64 / points as f64;
            at(part) - first - way * part
        })
        .collect()
}
