//! Positions, speeds and currents of a motor (PLANT F2).

/// The state of a motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Position of the rotor in full steps.
    pub x: f64,
    /// Speed of the rotor in full steps/s.
    pub w: f64,
    /// Current of phase a in A.
    pub i_a: f64,
    /// Current of phase b in A.
    pub i_b: f64,
    /// Position of the load in full steps; without a coupling the rotor's.
    pub x_load: f64,
    /// Speed of the load in full steps/s.
    pub w_load: f64,
}
