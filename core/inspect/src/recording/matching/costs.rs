//! What each difference costs a hypothesis. A gap of one step costs about 1.

/// Part of the interval within which a step is on time beyond doubt.
pub(super) const CLEAN: f64 = 0.2;
/// Part of the interval from which on a step is late.
pub(super) const LATE: f64 = 0.5;

/// The costs of steps, or of bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Costs {
    /// A row of late steps.
    late_first: f64,
    /// Each step that is late by half an interval.
    late: f64,
    /// All steps from here on are late.
    pub(super) shift: f64,
    /// The first step of several in the wrong direction, or byte with another value.
    differs_first: f64,
    /// Each other one of them.
    differs: f64,
    /// All of them at most.
    differs_most: f64,
}

/// Times identify steps. Two gaps cost less than two late steps between them whose times fit others.
pub(super) const STEPS: Costs =
    Costs { late_first: 1.2, late: 0.3, shift: 1.5, differs_first: 0.3, differs: 0.05, differs_most: 1.0 };
/// Values identify bytes: a sender may pause at any time.
pub(super) const BYTES: Costs =
    Costs { late_first: 0.3, late: 0.02, shift: 0.3, differs_first: 0.35, differs: 0.1, differs_most: 2.0 };

impl Costs {
    /// Of one step that is off by a part of its interval. The cost grows in proportion: a small error of every step, as of a
    /// ramp that is matched with its neighbors, then outweighs jitter.
    pub(super) fn off(&self, off: f64) -> f64 {
        self.late * if off > LATE { libm::fmin(LATE + off, 3.5) } else { 2.0 * off }
    }

    /// Of a row of late steps, by the one that is off most.
    pub(super) fn late_row(&self, off: f64) -> f64 {
        self.late_first * ((off - 0.4) / 0.6).clamp(0.0, 1.0)
    }

    /// Of a row of other directions or values, with one more; 0 so far if the last one was right.
    pub(super) fn differing_row(&self, so_far: f64) -> f64 {
        let more = if so_far > 0.0 { so_far + self.differs } else { self.differs_first };
        libm::fmin(more, self.differs_most)
    }
}

/// Of a gap. Each doubling costs a little.
pub(super) fn gap(count: usize) -> f64 {
    if count == 0 { 0.0 } else { 1.0 + 0.1 * f64::from(count.ilog2() + 1) }
}

/// What a gap costs less directly after another one of its kind: bounces and bursts come together.
pub(super) const AGAIN: f64 = 0.85;
