//! Where the energy goes that a motor takes from the bus (F8): what a step's equations lose is summed step by step, what
//! is stored follows from the state, and what is left over tells how exact the steps are.

use crate::{
    motor_constants::{Coupling, MotorConstants, TURN},
    sincos::sincos,
    state::State,
};

/// Sums of a motor since the start, in J; copper's still wants R/3.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EnergyAccount {
    pub(crate) bus: f64,
    pub(crate) copper: f64,
    pub(crate) friction: f64,
    pub(crate) viscous: f64,
    pub(crate) diodes: f64,
    pub(crate) load: f64,
    start: f64,
}

/// The energy of a motor since the start of the run, each part in J:
/// bus = copper + friction + viscous + diodes + load + stored.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs, reason = "the names say it")]
pub struct EnergyBalance {
    pub bus: f64,
    /// Lost in the resistances of windings and bridge.
    pub copper: f64,
    /// Lost to Coulomb friction, the load torque's too.
    pub friction: f64,
    /// Lost to viscous friction and in the coupling's damper.
    pub viscous: f64,
    pub diodes: f64,
    /// Work against gravity and the torque that goes round with the load.
    pub load: f64,
    /// Stored in inductances, masses, the coupling and the detent, more than at the start.
    pub stored: f64,
    /// All that went through, with positive sign: what the error is held against.
    pub turnover: f64,
}

impl EnergyBalance {
    /// What is left over, in parts of all that went through: 0 but for the steps' error.
    #[must_use]
    pub fn error(&self) -> f64 {
        let spent = self.copper + self.friction + self.viscous + self.diodes + self.load + self.stored;
        if self.turnover > 0.0 { (self.bus - spent).abs() / self.turnover } else { 0.0 }
    }
}

impl EnergyAccount {
    pub(crate) fn new(machine: &MotorConstants, state: &State) -> Self {
        Self { start: stored(machine, state), ..Self::default() }
    }

    /// A (sub-)step of the second mass: its speeds before, after, and after but for friction; the rotor's before and in
    /// the middle.
    #[inline(always)]
    pub(crate) fn coupled(
        &mut self,
        c: &Coupling,
        of_load: [f64; 3],
        of_rotor: (f64, f64),
        load: f64,
        h: f64,
    ) {
        let ([before, after, pushed], (w, w_m)) = (of_load, of_rotor);
        let middle = 0.5 * (before + after);
        self.load -= h * load * middle;
        self.friction += c.mass * (pushed - after) * middle;
        self.viscous += h * c.damping * (before - w) * (middle - w_m);
    }

    pub(crate) fn balance(&self, machine: &MotorConstants, state: &State) -> EnergyBalance {
        let copper = machine.r / 3.0 * self.copper;
        let Self { bus, friction, viscous, diodes, load, start, .. } = *self;
        let stored = stored(machine, state) - start;
        let turnover =
            bus.abs().max(copper + friction.abs() + viscous + diodes).max(load.abs()).max(start.abs());
        EnergyBalance { bus, copper, friction, viscous, diodes, load, stored, turnover }
    }
}

/// What inductances, masses, the coupling's spring and the detent hold, in J.
fn stored(machine: &MotorConstants, state: &State) -> f64 {
    let State { x, w, i_a, i_b, x_load, w_load } = *state;
    let mut stored = 0.5 * machine.l * (i_a * i_a + i_b * i_b) + 0.5 * machine.m * w * w;
    if let Some(c) = &machine.coupling {
        let twist = x_load - x;
        stored += 0.5 * c.mass * w_load * w_load + 0.5 * c.stiffness * twist * twist;
    }
    if machine.detent != 0.0 {
        // The force is -D sin(2*pi*q).
        stored -= machine.detent / TURN * sincos(4.0 * (x + 0.5)).1;
    }
    stored
}
