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

/// Two gaps cost less than two late steps between them that fit others.
pub(super) const STEPS: Costs =
    Costs { late_first: 1.2, late: 0.3, shift: 1.5, differs_first: 0.3, differs: 0.05, max_differing: 1.0 };
/// A sender of bytes may pause at any time.
pub(super) const BYTES: Costs =
    Costs { late_first: 0.3, late: 0.02, shift: 0.3, differs_first: 0.35, differs: 0.1, max_differing: 2.0 };

impl Costs {
    /// The cost of an offset is linear: a small error of every step then outweighs jitter.
    pub(super) fn off(&self, off: f64) -> f64 {
        self.late * if off > LATE { libm::fmin(LATE + off, 3.5) } else { 2.0 * off }
    }

    pub(super) fn late_row(&self, off: f64) -> f64 {
        self.late_first * ((off - 0.4) / 0.6).clamp(0.0, 1.0)
    }

    pub(super) fn differing_row(&self, so_far: f64) -> f64 {
        let more = if so_far > 0.0 { so_far + self.differs } else { self.differs_first };
        libm::fmin(more, self.max_differing)
    }
}

/// Each doubling costs a little.
pub(super) fn gap(count: usize) -> f64 {
    if count == 0 { 0.0 } else { 1.0 + 0.1 * f64::from(count.ilog2() + 1) }
}

/// Bounces and bursts come together, so a second gap of a kind is cheaper.
pub(super) const AGAIN: f64 = 0.85;
