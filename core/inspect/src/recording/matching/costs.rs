//! Costs of differences. A gap of one step costs about 1.

/// Part of the interval within which a step is on time.
pub(super) const CLEAN: f64 = 0.2;
/// Part of the interval from which on a step is late.
pub(super) const LATE: f64 = 0.5;

#[derive(Clone, Copy, Debug)]
pub(super) struct Costs {
    late_first: f64,
    late: f64,
    pub(super) shift: f64,
    differs_first: f64,
    differs: f64,
    max_differing: f64,
}

/// Two gaps cost less than two late steps between them.
pub(super) const STEPS: Costs =
    Costs { late_first: 1.2, late: 0.3, shift: 1.5, differs_first: 0.3, differs: 0.05, max_differing: 1.0 };
/// A sender of bytes may pause at any time.
pub(super) const BYTES: Costs =
    Costs { late_first: 0.3, late: 0.02, shift: 0.3, differs_first: 0.35, differs: 0.1, max_differing: 2.0 };

impl Costs {
    /// The cost is linear in the offset, so that a small error of every step costs more than jitter.
    pub(super) fn off(&self, off: f64) -> f64 {
        self.late * if off > LATE { libm::fmin(LATE + off, 3.5) } else { 2.0 * off }
    }

    /// Cost of the first late step of a run.
    pub(super) fn late_run(&self, off: f64) -> f64 {
        self.late_first * ((off - 0.4) / 0.6).clamp(0.0, 1.0)
    }

    /// Cost of a run of steps with another direction or value, with one more step.
    pub(super) fn differing_run(&self, so_far: f64) -> f64 {
        let more = if so_far > 0.0 { so_far + self.differs } else { self.differs_first };
        libm::fmin(more, self.max_differing)
    }
}

/// Cost of a gap; each doubling of its length adds a little.
pub(super) fn gap(count: usize) -> f64 {
    if count == 0 { 0.0 } else { 1.0 + 0.1 * f64::from(count.ilog2() + 1) }
}

/// Bounces and bursts come together, so a second gap of a kind is cheaper.
pub(super) const AGAIN: f64 = 0.85;
