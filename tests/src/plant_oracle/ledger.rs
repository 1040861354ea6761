//! F8's energies of a motor, added up sub-step by sub-step.

/// Energies of one motor since cycle 0, J.
///
/// Reading: F8 names the sides but not what belongs to each. `load` is the work done against gravity, sine and load
/// torque; `friction` has the coupling's damper and the rotor's own Coulomb friction; `stored` is what kinetic,
/// magnetic, spring and detent energy have grown by.
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
    /// What the balance misses, as a share of all that was moved.
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
