//! The recording's clock relative to the plan's: a filter of offset and rate.

/// Maximum difference of the clocks' rates.
const MAX_SLOPE: f64 = 0.125;

#[derive(Clone, Copy, Debug)]
pub(super) struct Clock {
    at_s: f64,
    late_s: f64,
    slope: f64,
    /// Starts above 0, so that the first steps hardly change the slope.
    seen: u32,
}

impl Clock {
    pub(super) const fn new(at_s: f64, late_s: f64) -> Self {
        Self { at_s, late_s, slope: 0.0, seen: 9 }
    }

    pub(super) const fn shifted(self, at_s: f64, late_s: f64) -> Self {
        Self { at_s, late_s, ..self }
    }

    pub(super) const fn late_s(&self) -> f64 {
        self.late_s
    }

    pub(super) fn late_at(&self, at_s: f64) -> f64 {
        self.late_s + self.slope * (at_s - self.at_s)
    }

    pub(super) fn planned_at(&self, recorded_s: f64) -> f64 {
        self.at_s + (recorded_s - self.at_s - self.late_s) / (1.0 + self.slope)
    }

    /// Adds a step to the filter. Its memory grows to dozens of steps for the offset and hundreds for the rate; a shorter
    /// memory would follow a ramp whose steps are matched with their neighbors.
    pub(super) fn follow(&self, at_s: f64, late_s: f64) -> Self {
        let seen = self.seen.saturating_add(1);
        let n = f64::from(seen);
        let both = (n + 1.0) * (n + 2.0);
        let alpha = libm::fmax(2.0 * (2.0 * n + 1.0) / both, 1.0 / 64.0);
        let beta = libm::fmax(6.0 / both, 1.0 / 16384.0);
        let (expected, passed) = (self.late_at(at_s), at_s - self.at_s);
        let off = late_s - expected;
        let slope_change = if passed > 0.0 { beta * off / passed } else { 0.0 };
        let slope = (self.slope + slope_change).clamp(-MAX_SLOPE, MAX_SLOPE);
        Self { at_s, late_s: expected + alpha * off, slope, seen }
    }
}
