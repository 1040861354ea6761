//! Constants of a motor's equations in full steps (PLANT F2), and of one integration step (F3).

use crate::parameters::MotorModel;
use crate::sincos::{phi, sincos};
use core::f64::consts::{SQRT_2, TAU};

const DEGREE: f64 = 0.017_453_292_519_943_295;
pub(crate) const TURN: f64 = TAU;

#[derive(Clone, Debug)]
pub(crate) struct MotorConstants {
    /// Full step in rad.
    pub(crate) g: f64,
    pub(crate) k: f64,
    /// Resistance of a phase with its bridge in ohm.
    pub(crate) r: f64,
    /// Inductance of a phase in H.
    pub(crate) l: f64,
    /// Mass of the rotor; without a coupling also of the load.
    pub(crate) m: f64,
    pub(crate) b: f64,
    pub(crate) detent: f64,
    pub(crate) load: Load,
    pub(crate) friction: f64,
    pub(crate) stiction: f64,
    pub(crate) coupling: Option<Coupling>,
}

#[derive(Clone, Debug)]
pub(crate) struct Load {
    gravity: f64,
    sine: f64,
    /// Quarter turns of the sine per full step; `phase`: at position 0.
    rate: f64,
    phase: f64,
}

impl Load {
    /// Force of the load at position `y`.
    pub(crate) fn at(&self, y: f64) -> f64 {
        let mut force = 0.0;
        if self.gravity != 0.0 {
            force -= self.gravity;
        }
        if self.sine != 0.0 {
            force -= self.sine * sincos(self.rate * y + self.phase).0;
        }
        force
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Coupling {
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) mass: f64,
    pub(crate) friction: f64,
}

impl MotorConstants {
    pub(crate) fn new(motor: &MotorModel) -> Self {
        let g = motor.full_step_deg * DEGREE;
        let force = |mn_m: f64| mn_m / 1000.0 * g;
        let damping = |un_m_s: f64| un_m_s / 1e6 * g * g;
        let mass = |g_cm2: f64| g_cm2 * 1e-7 * g * g;
        let mut friction = force(motor.friction_mn_m);
        let mut stiction = motor.stiction_mn_m.map_or(friction, force);
        let of_load = force(motor.load_torque_mn_m);
        let coupling = motor.coupling_n_m_rad.map(|n_m_rad| Coupling {
            stiffness: n_m_rad * g * g,
            damping: damping(motor.coupling_un_m_s),
            mass: mass(motor.load_inertia_g_cm2),
            friction: of_load,
        });
        if coupling.is_none() {
            friction += of_load;
            stiction += of_load;
        }
        let inertia = match coupling {
            Some(_) => motor.rotor_inertia_g_cm2,
            None => motor.rotor_inertia_g_cm2 + motor.load_inertia_g_cm2,
        };
        Self {
            g,
            k: motor.holding_torque_mn_m / 1000.0 / (SQRT_2 * motor.rated_current_a) * g,
            r: motor.resistance_ohm + motor.drive.bridge_ohm,
            l: motor.inductance_mh / 1000.0,
            m: mass(inertia),
            b: damping(motor.viscous_un_m_s),
            detent: force(motor.detent_torque_mn_m),
            load: Load {
                gravity: force(motor.gravity_torque_mn_m),
                sine: force(motor.sine_torque_mn_m),
                rate: motor.sine_per_turn * motor.full_step_deg / 90.0,
                phase: motor.sine_phase_deg / 90.0,
            },
            friction,
            stiction,
            coupling,
        }
    }

    /// Force of the detent, from the sine and cosine of the electrical angle.
    pub(crate) fn detent(&self, sn: f64, cs: f64) -> f64 {
        self.detent * (2.0 * (2.0 * sn * cs) * (1.0 - 2.0 * sn * sn))
    }

    /// Force on a rotor at rest at `x`.
    fn force_at_rest(&self, x: f64, i_a: f64, i_b: f64) -> f64 {
        let (sn, cs) = sincos(x + 0.5);
        let mut force = self.k * cs * i_b - self.k * sn * i_a;
        if self.detent != 0.0 {
            force -= self.detent(sn, cs);
        }
        force + self.load.at(x)
    }

    /// Rest position between -1 and 1 by bisection; 0 if the force has no such zero.
    pub(crate) fn rest(&self, i_a: f64, i_b: f64) -> f64 {
        let force = |x| self.force_at_rest(x, i_a, i_b);
        if force(0.0) == 0.0 || !(force(-1.0) > 0.0 && 0.0 > force(1.0)) {
            return 0.0;
        }
        let (mut low, mut high, mut middle) = (-1.0, 1.0, 0.0);
        for _ in 0..60 {
            middle = 0.5 * (low + high);
            if force(middle) > 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        middle
    }
}

/// A (sub-)step: with a constant voltage u across a phase, its current changes by a*u, and the mean current over the step by b*u.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    /// Length in s, and its half.
    pub(crate) h: f64,
    pub(crate) hh: f64,
    pub(crate) a: f64,
    pub(crate) b: f64,
    /// 1/a.
    pub(crate) ra: f64,
}

impl Span {
    pub(crate) fn new(constants: &MotorConstants, cycles: u64, clock_hz: f64) -> Self {
        let h = cycles as f64 / clock_hz;
        let (phi1, phi2) = phi(constants.r * h / constants.l);
        let a = h / constants.l * phi1;
        Self { h, hh: 0.5 * h, a, b: h / constants.l * phi2, ra: 1.0 / a }
    }
}
