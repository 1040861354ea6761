//! F8's energies of a motor, summed over its sub-steps.

/// Energies of one motor since cycle 0, J.
///
/// Reading: F8 names the sides of the balance but not their parts. `load` is the work against gravity, sine and load
/// torque; `friction` includes the coupling's damper and the rotor's own Coulomb friction; `stored` is the growth of
/// kinetic, magnetic, spring and detent energy.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ledger {
    /// From the bus.
    pub bus: f64,
    /// In R.
    pub copper: f64,
    /// In the rotor's Coulomb friction and the coupling's damper.
    pub friction: f64,
    /// In B.
    pub viscous: f64,
    /// In the diodes while EN = 0.
    pub diodes: f64,
    /// Gravity, sine, load torque.
    pub load: f64,
    /// Growth of kinetic, magnetic, spring and detent energy.
    pub stored: f64,
}

impl Ledger {
    /// The error of the balance, relative to the energy moved.
    pub fn imbalance(&self) -> f64 {
        let told = self.copper + self.friction + self.viscous + self.diodes + self.load + self.stored;
        let moved = self.bus.abs()
            + self.copper
            + self.friction
            + self.viscous
            + self.diodes
            + self.load.abs()
            + self.stored.abs();
        if moved == 0.0 { 0.0 } else { (self.bus - told).abs() / moved }
    }
}
