//! F4: the translator, and the voltage of each phase.

use super::numbers::{nearest, sincos};
use super::parameters::{Decay, Drive, Motor, Regulator};

/// A chopper's phase: on or off, for a number of points.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Chopper {
    on: bool,
    count: u64,
    /// Off with fast decay, as decided at the last point.
    fast: bool,
    /// s*i has been <= 0 at a point since the phase went off.
    reversed: bool,
}

const BEGIN: Chopper = Chopper { on: true, count: 0, fast: false, reversed: false };

/// Result for a phase in a sub-step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Applied {
    /// v, V.
    pub(super) v: f64,
    /// The phase is open: a = b = 0.
    pub(super) open: bool,
    /// "i = 0 after the step".
    pub(super) ends: bool,
}

/// The inputs of the voltage in a sub-step, for one phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Winding {
    pub(super) i: f64,
    pub(super) e: f64,
    pub(super) r: f64,
    /// 1/a.
    pub(super) ra: f64,
}

/// Translator and bridge of one motor.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Driver {
    drive: Drive,
    microsteps: u32,
    peak: f64,
    /// Microsteps commanded.
    pub(super) u: i64,
    /// t of phases a and b, A.
    pub(super) targets: [f64; 2],
    /// d of phases a and b.
    decays: [f64; 2],
    choppers: [Chopper; 2],
    /// `off` and `blank` in grid steps.
    off: u64,
    blank: u64,
}

impl Driver {
    pub(super) fn new(motor: &Motor, peak: f64, clock_hz: u64, grid_step: u64) -> Self {
        let drive = motor.drive.clone();
        let share = match drive.decay {
            Decay::Slow => 0.0,
            Decay::Fast => 1.0,
            Decay::Mixed(share) | Decay::Auto(share) => share,
        };
        // Reading: "in nearest whole grid steps (half up)" is floor(us*clock_hz/(1e6*N) + 0.5) in f64; other orders
        // differ only in the rounding of a half.
        let whole_steps = |us: f64| {
            let steps = (us * clock_hz as f64 / (1e6 * grid_step as f64) + 0.5).floor();
            (steps as u64).max(1)
        };
        let (off, blank) = (whole_steps(drive.off_us), whole_steps(drive.blank_us));
        let mut driver = Self {
            drive,
            microsteps: motor.microsteps,
            peak,
            u: 0,
            targets: [0.0; 2],
            decays: [share; 2],
            choppers: [BEGIN; 2],
            off,
            blank,
        };
        driver.targets = driver.targets_of(0);
        driver
    }

    fn targets_of(&self, u: i64) -> [f64; 2] {
        let in_turn = u.rem_euclid(4 * i64::from(self.microsteps));
        let (mut s, mut c) = sincos(in_turn as f64 / f64::from(self.microsteps) + 0.5);
        if let Some(levels) = self.drive.dac_levels {
            let n = f64::from(levels);
            s = nearest(s * n) / n;
            c = nearest(c * n) / n;
        }
        [self.peak * c, self.peak * s]
    }

    /// A rise of STEP. Reading: "whatever EN is" holds for the decay of `auto`, too.
    pub(super) fn step(&mut self, right: bool) {
        self.u += if right { 1 } else { -1 };
        let before = self.targets;
        self.targets = self.targets_of(self.u);
        if let Decay::Auto(share) = self.drive.decay {
            let fell = [0, 1].map(|phase| self.targets[phase].abs() < before[phase].abs());
            self.decays = fell.map(|fell| if fell { share } else { 0.0 });
        }
    }

    /// "A rise of EN begins with on, count 0."
    pub(super) fn enabled(&mut self) {
        self.choppers = [BEGIN; 2];
    }

    /// At a grid point with EN = 1.
    pub(super) fn decide(&mut self, currents: [f64; 2]) {
        for (phase, i) in currents.into_iter().enumerate() {
            let (t, d) = (self.targets[phase], self.decays[phase]);
            let s = sign_of(t, i);
            let fast_steps = (d * self.off as f64 + 0.5).floor() as u64;
            let chopper = &mut self.choppers[phase];
            chopper.count += 1;
            if chopper.on {
                if chopper.count >= self.blank && s * i >= t.abs() {
                    // Reading: "at a point since going off" means points after this one.
                    *chopper =
                        Chopper { on: false, count: 0, fast: d > 0.0 && fast_steps > 0, reversed: false };
                }
            } else {
                if s * i <= 0.0 {
                    chopper.reversed = true;
                }
                if chopper.count >= self.off {
                    *chopper = BEGIN;
                } else {
                    chopper.fast = chopper.count < fast_steps && !chopper.reversed;
                }
            }
        }
    }

    /// v of a phase in a sub-step that begins with this current; `bus_v` is V.
    pub(super) fn apply(&self, phase: usize, en: bool, bus_v: f64, winding: Winding) -> Applied {
        if !en {
            return self.diodes(bus_v, winding);
        }
        let v = match self.drive.regulator {
            Regulator::Averaged => averaged(self.targets[phase], self.decays[phase], bus_v, winding),
            Regulator::Chopper => {
                let s = sign_of(self.targets[phase], winding.i);
                let chopper = self.choppers[phase];
                if chopper.on {
                    s * bus_v
                } else if chopper.fast {
                    -s * bus_v
                } else {
                    0.0
                }
            }
        };
        Applied { v, open: false, ends: false }
    }

    /// V + 2*diode_v.
    pub(super) fn diode_bus(&self, bus_v: f64) -> f64 {
        bus_v + 2.0 * self.drive.diode_v
    }

    /// EN = 0.
    fn diodes(&self, bus_v: f64, winding: Winding) -> Applied {
        let Winding { i, e, r, ra } = winding;
        let vd = self.diode_bus(bus_v);
        if i == 0.0 {
            if e.abs() > vd {
                return Applied { v: if e > 0.0 { vd } else { -vd }, open: false, ends: false };
            }
            return Applied { v: 0.0, open: true, ends: false };
        }
        let v = if i > 0.0 { -vd } else { vd };
        let vz = e + r * i - i * ra;
        // "nearer to 0 or beyond": on the axis that has v at its far end. Reading: vz = v is not nearer.
        let (nearer, beyond) = if i > 0.0 { (vz > v, vz > 0.0) } else { (vz < v, vz < 0.0) };
        if nearer {
            return Applied { v: if beyond { 0.0 } else { vz }, open: false, ends: true };
        }
        Applied { v, open: false, ends: false }
    }
}

fn averaged(t: f64, d: f64, bus_v: f64, winding: Winding) -> f64 {
    let Winding { i, e, r, ra } = winding;
    let mut v = e + r * i + (t - i) * ra;
    let most = if t > 0.0 { bus_v } else { d * bus_v };
    let least = if t < 0.0 { -bus_v } else { -(d * bus_v) };
    if v > most {
        v = most;
    }
    if v < least {
        v = least;
    }
    v
}

/// "s = sign of t, of i where t = 0, 1 where both are 0."
fn sign_of(t: f64, i: f64) -> f64 {
    if t > 0.0 {
        1.0
    } else if t < 0.0 || i < 0.0 {
        -1.0
    } else {
        1.0
    }
}
