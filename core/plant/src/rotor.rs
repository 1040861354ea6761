//! One motor in time: currents, masses, and one (sub-)step of their equations (PLANT F3).
//!
//! ```text
//! half a step of x; mean currents at constant voltage and back EMF, exactly; speed by the implicit midpoint rule;
//! friction; currents; the other half of x
//! ```

use crate::driver::{Driver, PhaseInput};
use crate::motor_constants::{MotorConstants, Span};
use crate::{energy::EnergyAccount, parameters::MotorModel, sincos::sincos, state::State};

#[derive(Clone, Debug)]
pub(crate) struct Rotor {
    pub(crate) constants: MotorConstants,
    pub(crate) driver: Driver,
    pub(crate) state: State,
    pub(crate) energy: EnergyAccount,
    whole: Span,
    step_cycles: u64,
    clock_hz: f64,
    passed: u64,
    /// Energy taken from the supply in this grid step, in J.
    from_supply: f64,
}

/// `value` moved toward 0 by `by`, at most to 0.
fn towards_zero(value: f64, by: f64) -> f64 {
    if value.abs() <= by {
        0.0
    } else if value > 0.0 {
        value - by
    } else {
        value + by
    }
}

impl Rotor {
    pub(crate) fn new(motor: &MotorModel, clock_hz: f64, step_cycles: u32) -> Self {
        let (constants, driver) = (MotorConstants::new(motor), Driver::new(motor, clock_hz, step_cycles));
        let [i_a, i_b] = [driver.phases[0].target, driver.phases[1].target];
        let x = constants.rest(i_a, i_b);
        let x_load = constants.coupling.as_ref().map_or(x, |c| x + constants.load.at(x) / c.stiffness);
        let state = State { x, w: 0.0, i_a, i_b, x_load, w_load: 0.0 };
        let whole = Span::new(&constants, step_cycles.into(), clock_hz);
        let energy = EnergyAccount::new(&constants, &state);
        let step_cycles = step_cycles.into();
        Self { constants, driver, state, energy, whole, step_cycles, clock_hz, passed: 0, from_supply: 0.0 }
    }

    /// Power of the windings at the start, in W.
    pub(crate) fn first_power(&self) -> f64 {
        let State { i_a, i_b, .. } = self.state;
        self.constants.r * (i_a * i_a + i_b * i_b)
    }

    pub(crate) fn advance(&mut self, to: u64, supply_v: f64, powered: bool) {
        if to > self.passed {
            let span = Span::new(&self.constants, to - self.passed, self.clock_hz);
            self.step(&span, supply_v, powered);
            self.passed = to;
        }
    }

    /// Advances to the next grid point; returns the energy taken from the supply since the last one, in J.
    pub(crate) fn finish(&mut self, supply_v: f64, powered: bool) -> f64 {
        if self.passed == 0 {
            let whole = self.whole;
            self.step(&whole, supply_v, powered);
        } else {
            self.advance(self.step_cycles, supply_v, powered);
        }
        self.passed = 0;
        core::mem::take(&mut self.from_supply)
    }

    // A call per motor-step takes 1.7 times as long in `plant_averaged`.
    #[inline(always)]
    fn step(&mut self, span: &Span, supply_v: f64, powered: bool) {
        let Self { constants, driver, state, .. } = self;
        let State { x, w, i_a, i_b, .. } = *state;
        let Span { h, hh, ra, .. } = *span;
        let (k, r, m) = (constants.k, constants.r, constants.m);

        let y = x + w * hh;
        let (sn, cs) = sincos(y + 0.5);
        let (k_a, k_b) = (-(k * sn), k * cs);
        let a = driver.voltage(0, &PhaseInput { e: k_a * w, i: i_a, r, ra, supply_v }, powered);
        let b = driver.voltage(1, &PhaseInput { e: k_b * w, i: i_b, r, ra, supply_v }, powered);
        let (u_a, u_b) = (a.v - r * i_a, b.v - r * i_b);
        let (a_a, b_a) = if a.is_open { (0.0, 0.0) } else { (span.a, span.b) };
        let (a_b, b_b) = if b.is_open { (0.0, 0.0) } else { (span.a, span.b) };

        let mut f = 0.0;
        if constants.detent != 0.0 {
            f -= constants.detent(sn, cs);
        }
        let mut spring = 0.0;
        let mut y_load = y;
        let load;
        if let Some(c) = &constants.coupling {
            y_load = state.x_load + state.w_load * hh;
            spring = c.stiffness * (y_load - y) + c.damping * (state.w_load - w);
            f += spring;
            load = constants.load.at(y_load);
        } else {
            load = constants.load.at(y);
            f += load;
        }

        let torque = k_a * (i_a + b_a * u_a) + k_b * (i_b + b_b * u_b) + f;
        let den = m + hh * (constants.b + (b_a * k_a * k_a + b_b * k_b * k_b));
        let w_m = (m * w + hh * torque) / den;
        let free = 2.0 * w_m - w;
        let slide = h * constants.friction / den;
        let hold = if w == 0.0 { h * constants.stiction / den } else { slide };
        let w_1 = if free.abs() <= hold {
            0.0
        } else if free > 0.0 {
            free - slide
        } else {
            free + slide
        };

        let w_m = 0.5 * (w + w_1);
        let (t_a, t_b) = (u_a - k_a * w_m, u_b - k_b * w_m);
        let (mean_a, mean_b) = (i_a + b_a * t_a, i_b + b_b * t_b);
        let next_a = if a.reaches_zero { 0.0 } else { i_a + a_a * t_a };
        let next_b = if b.reaches_zero { 0.0 } else { i_b + a_b * t_b };
        state.i_a = next_a;
        state.i_b = next_b;
        state.x = y + w_1 * hh;
        state.w = w_1;
        let energy = &mut self.energy;
        if let Some(c) = &constants.coupling {
            let pushed = state.w_load + h * (load - spring) / c.mass;
            let w_l = towards_zero(pushed, h * c.friction / c.mass);
            energy.coupled(c, [state.w_load, w_l, pushed], (w, w_m), load, h);
            state.w_load = w_l;
            state.x_load = y_load + w_l * hh;
        } else {
            state.x_load = state.x;
            state.w_load = w_1;
            energy.load -= h * load * w_m;
        }

        let taken = if powered {
            (a.v * mean_a + b.v * mean_b) * h
        } else {
            let whole = supply_v + driver.diodes;
            let taken = (a.v * mean_a * supply_v / whole + b.v * mean_b * supply_v / whole) * h;
            energy.diodes += taken - (a.v * mean_a + b.v * mean_b) * h;
            taken
        };
        self.from_supply += taken;
        energy.bus += taken;
        energy.friction += (free - w_1) * den * w_m;
        energy.viscous += h * constants.b * w_m * w_m;
        energy.copper +=
            h * (i_a * i_a + i_a * next_a + next_a * next_a + i_b * i_b + i_b * next_b + next_b * next_b);
    }
}
