//! The energy that a motor takes from the bus (PLANT F8). Losses are summed step by step, stored energy follows from the
//! state, and the remainder shows how exact the steps are.

use crate::motor_constants::{Coupling, MotorConstants, TURN};
use crate::{sincos::sincos, state::State};

/// Sums since the start in J; [`Self::balance`] multiplies `copper` by R/3.
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

/// Energies of a motor since the start of the run in J: bus = copper + friction + viscous + diodes + load + stored.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyBalance {
    pub bus: f64,
    /// Losses in windings and bridge.
    pub copper: f64,
    /// Losses to Coulomb friction of rotor and load.
    pub friction: f64,
    /// Losses to viscous friction and the damping of the coupling.
    pub viscous: f64,
    pub diodes: f64,
    /// Work against gravity and the sinusoidal torque of the load.
    pub load: f64,
    /// Increase of the energy in inductances, masses, coupling and detent.
    pub stored: f64,
    /// Largest of the energies, by amount: the scale of [`Self::error`].
    pub turnover: f64,
}

impl EnergyBalance {
    /// Share of the turnover that the balance does not account for; near 0 if the grid is fine enough.
    pub fn error(&self) -> f64 {
        let spent = self.copper + self.friction + self.viscous + self.diodes + self.load + self.stored;
        if self.turnover > 0.0 { (self.bus - spent).abs() / self.turnover } else { 0.0 }
    }
}

impl EnergyAccount {
    pub(crate) fn new(constants: &MotorConstants, state: &State) -> Self {
        Self { start: stored(constants, state), ..Self::default() }
    }

    /// A (sub-)step of the load. `of_load`: its speed before, after, and after without friction; `of_rotor`: the rotor's
    /// speed before and at the midpoint.
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

    pub(crate) fn balance(&self, constants: &MotorConstants, state: &State) -> EnergyBalance {
        let copper = constants.r / 3.0 * self.copper;
        let Self { bus, friction, viscous, diodes, load, start, .. } = *self;
        let stored = stored(constants, state) - start;
        let turnover =
            bus.abs().max(copper + friction.abs() + viscous + diodes).max(load.abs()).max(start.abs());
        EnergyBalance { bus, copper, friction, viscous, diodes, load, stored, turnover }
    }
}

fn stored(constants: &MotorConstants, state: &State) -> f64 {
    let State { x, w, i_a, i_b, x_load, w_load } = *state;
    let mut stored = 0.5 * constants.l * (i_a * i_a + i_b * i_b) + 0.5 * constants.m * w * w;
    if let Some(c) = &constants.coupling {
        let twist = x_load - x;
        stored += 0.5 * c.mass * w_load * w_load + 0.5 * c.stiffness * twist * twist;
    }
    if constants.detent != 0.0 {
        // The force is -D sin(2*pi*q).
        stored -= constants.detent / TURN * sincos(4.0 * (x + 0.5)).1;
    }
    stored
}
