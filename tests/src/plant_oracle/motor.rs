//! F3: one motor, one sub-step at a time; F4's equilibrium at cycle 0.
//!
//! ```text
//! y = x + w*h/2  ->  k_a, k_b, v, T at y  ->  w' (implicit midpoint)  ->  friction: w1  ->  i, x = y + w1*h/2
//! ```

use super::driver::{Driver, Winding};
use super::ledger::Ledger;
use super::numbers::{phi, sincos, towards_zero};
use super::parameters::{Motor, MotorConstants};

/// State of one motor with its driver.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MotorState {
    pub(super) constants: MotorConstants,
    pub(super) driver: Driver,
    /// Full steps.
    pub(super) x: f64,
    /// Full steps/s.
    pub(super) w: f64,
    /// i_a and i_b, A.
    pub(super) i: [f64; 2],
    /// State of the load, if there is a coupling.
    pub(super) x_l: f64,
    pub(super) w_l: f64,
    pub(super) ledger: Ledger,
}

impl MotorState {
    /// At cycle 0 (F4).
    pub(super) fn new(motor: &Motor, clock_hz: u64, grid_step: u64) -> Self {
        let constants = MotorConstants::new(motor);
        let driver = Driver::new(motor, constants.peak, clock_hz, grid_step);
        let i = driver.targets;
        let mut state =
            Self { constants, driver, x: 0.0, w: 0.0, i, x_l: 0.0, w_l: 0.0, ledger: Ledger::default() };
        state.x = state.rest();
        state.x_l = match constants.coupling {
            Some((_, stiffness, _)) => state.x + state.load(state.x) / stiffness,
            None => state.x,
        };
        state
    }

    /// load(y).
    fn load(&self, y: f64) -> f64 {
        let c = &self.constants;
        let mut load = 0.0;
        if c.gravity != 0.0 {
            load -= c.gravity;
        }
        if c.sine != 0.0 {
            load -= c.sine * sincos(c.sine_rate * y + c.sine_start).0;
        }
        load
    }

    /// The detent's part of f: 0 without a detent.
    fn detent(&self, sn: f64, cs: f64) -> f64 {
        let d = self.constants.detent;
        if d != 0.0 { d * (2.0 * (2.0 * sn * cs) * (1.0 - 2.0 * sn * sn)) } else { 0.0 }
    }

    /// F(x) of the equilibrium at cycle 0.
    fn force(&self, x: f64) -> f64 {
        let k = self.constants.k;
        let (sn, cs) = sincos(x + 0.5);
        k * cs * self.i[1] - k * sn * self.i[0] - self.detent(sn, cs) + self.load(x)
    }

    fn rest(&self) -> f64 {
        if self.force(0.0) == 0.0 || !(self.force(-1.0) > 0.0 && 0.0 > self.force(1.0)) {
            return 0.0;
        }
        let (mut lower, mut upper) = (-1.0, 1.0);
        let mut middle = 0.0;
        for _ in 0..60 {
            middle = 0.5 * (lower + upper);
            if self.force(middle) > 0.0 {
                lower = middle;
            } else {
                upper = middle;
            }
        }
        middle
    }

    /// Advances by `m` cycles of one (sub-)step and returns the energy from the bus, J.
    pub(super) fn advance(&mut self, m: u64, clock_hz: u64, bus_v: f64, en: bool) -> f64 {
        let c = self.constants;
        let h = m as f64 / clock_hz as f64;
        let hh = 0.5 * h;
        let z = c.r * h / c.l;
        let (phi1, phi2) = phi(z);
        let a = h / c.l * phi1;
        let b = h / c.l * phi2;
        let ra = 1.0 / a;

        let (x, w, i) = (self.x, self.w, self.i);
        let y = x + w * hh;
        let (sn, cs) = sincos(y + 0.5);
        let k = [-(c.k * sn), c.k * cs];
        let applied =
            [0, 1].map(|j| self.driver.apply(j, en, bus_v, Winding { i: i[j], e: k[j] * w, r: c.r, ra }));
        let v = applied.map(|applied| applied.v);
        let u = [v[0] - c.r * i[0], v[1] - c.r * i[1]];
        let a_of = applied.map(|applied| if applied.open { 0.0 } else { a });
        let b_of = applied.map(|applied| if applied.open { 0.0 } else { b });

        let mut f = 0.0;
        let detent = self.detent(sn, cs);
        f -= detent;
        let load_here = self.load(y);
        let y_l = self.x_l + self.w_l * hh;
        let mut s = 0.0;
        match c.coupling {
            None => f += load_here,
            Some((_, stiffness, damper)) => {
                s = stiffness * (y_l - y) + damper * (self.w_l - w);
                f += s;
            }
        }

        let t = k[0] * (i[0] + b_of[0] * u[0]) + k[1] * (i[1] + b_of[1] * u[1]) + f;
        let den = c.m + hh * (c.b + (b_of[0] * k[0] * k[0] + b_of[1] * k[1] * k[1]));
        let w_m = (c.m * w + hh * t) / den;
        let w_free = 2.0 * w_m - w;
        let holds = if w == 0.0 { c.stiction } else { c.coulomb };
        let w1 = if w_free.abs() <= h * holds / den {
            0.0
        } else {
            // |w'| is above h*Fs/den >= h*Fc/den, or above h*Fc/den.
            let slower = h * c.coulomb / den;
            if w_free > 0.0 { w_free - slower } else { w_free + slower }
        };
        let w_m = 0.5 * (w + w1);
        let mut mean = [0.0; 2];
        for j in 0..2 {
            let t_j = u[j] - k[j] * w_m;
            mean[j] = i[j] + b_of[j] * t_j;
            self.i[j] = i[j] + a_of[j] * t_j;
            if applied[j].ends {
                self.i[j] = 0.0;
            }
        }
        self.x = y + w1 * hh;
        self.w = w1;

        let (x_l, w_l) = (self.x_l, self.w_l);
        let mut load_at_load = 0.0;
        let mut load_slower = 0.0;
        if let Some((m_l, _, _)) = c.coupling {
            load_at_load = self.load(y_l);
            let free = w_l + h * (load_at_load - s) / m_l;
            self.w_l = towards_zero(free, h * c.load / m_l);
            load_slower = m_l * (free - self.w_l);
            self.x_l = y_l + self.w_l * hh;
        } else {
            self.x_l = self.x;
            self.w_l = self.w;
        }

        let energy = if en {
            (v[0] * mean[0] + v[1] * mean[1]) * h
        } else {
            let vd = self.driver.diode_bus(bus_v);
            (v[0] * mean[0] * bus_v / vd + v[1] * mean[1] * bus_v / vd) * h
        };

        let ledger = &mut self.ledger;
        ledger.bus += energy;
        ledger.diodes += energy - (v[0] * mean[0] + v[1] * mean[1]) * h;
        for (before, after) in i.into_iter().zip(self.i) {
            ledger.copper += c.r * h * (before * before + before * after + after * after) / 3.0;
            ledger.stored += 0.5 * c.l * (after * after - before * before);
        }
        ledger.stored += 0.5 * c.m * (w1 * w1 - w * w) + detent * w_m * h;
        ledger.viscous += c.b * w_m * w_m * h;
        let braked = den * (w_free - w1) * w_m;
        match c.coupling {
            None => {
                let share = if c.coulomb > 0.0 { c.load / c.coulomb } else { 0.0 };
                ledger.friction += braked * (1.0 - share);
                ledger.load += braked * share - load_here * w_m * h;
            }
            Some((m_l, stiffness, damper)) => {
                let mean_l = 0.5 * (w_l + self.w_l);
                let stretch = [x_l - x, self.x_l - self.x];
                ledger.friction += braked + damper * (w_l - w) * (mean_l - w_m) * h;
                ledger.load += load_slower * mean_l - load_at_load * mean_l * h;
                ledger.stored += 0.5 * m_l * (self.w_l * self.w_l - w_l * w_l)
                    + 0.5 * stiffness * (stretch[1] * stretch[1] - stretch[0] * stretch[0]);
            }
        }
        energy
    }
}
