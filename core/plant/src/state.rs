//! Where a motor is and what flows through it (F2).

/// Where a motor is and what flows through it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// The rotor's position in full steps.
    pub x: f64,
    /// Its speed in full steps/s.
    pub w: f64,
    /// Current of phase a in A.
    pub i_a: f64,
    /// Current of phase b in A.
    pub i_b: f64,
    /// The load's position in full steps; the rotor's where no coupling is between them.
    pub x_load: f64,
    /// The load's speed in full steps/s.
    pub w_load: f64,
}
