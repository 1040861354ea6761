//! The driver of one motor: from the count of steps to target currents, from those to the voltages of the phases (F4).

use crate::{
    parameters::{CurrentControl, CurrentDecay, DriverModel, MotorModel},
    sincos::{nearest, sincos},
};

/// What a driver does to a phase in one (sub-)step.
#[derive(Clone, Copy)]
pub(crate) struct Applied {
    pub(crate) v: f64,
    pub(crate) is_open: bool,
    /// The current has decayed through the diodes at the step's end.
    pub(crate) ends: bool,
}

impl Applied {
    #[inline(always)]
    const fn voltage(v: f64) -> Self {
        Self { v, is_open: false, ends: false }
    }
}

/// What [`Phase`] is asked with, in each (sub-)step: e, i, and the constants of the step.
#[derive(Clone, Copy)]
pub(crate) struct Ask {
    pub(crate) e: f64,
    pub(crate) i: f64,
    pub(crate) r: f64,
    pub(crate) ra: f64,
    pub(crate) bus: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct Phase {
    pub(crate) target: f64,
    pub(crate) share: f64,
    chopper: Chopper,
}

#[derive(Clone, Copy, Debug, Default)]
struct Chopper {
    is_off: bool,
    count: u32,
    /// In this off-time the current has been seen to have passed 0.
    has_passed: bool,
    /// The voltage in parts of the bus', for a current to the right: 1 on, -1 fast, 0 slow.
    part: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct ChopperTimes {
    off: u32,
    blank: u32,
}

impl ChopperTimes {
    pub(crate) fn new(drive: &DriverModel, clock_hz: f64, step_cycles: u32) -> Self {
        let steps = |us: f64| round_half_up(us * clock_hz / (1e6 * f64::from(step_cycles))).max(1);
        Self { off: steps(drive.off_us), blank: steps(drive.blank_us) }
    }
}

/// Whole number nearest to `x` >= 0, halves up.
fn round_half_up(x: f64) -> u32 {
    let whole = x as u32;
    whole.saturating_add(u32::from(x - f64::from(whole) >= 0.5))
}

#[inline(always)]
fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        0.0
    }
}

impl Phase {
    fn new(target: f64, share: f64) -> Self {
        let chopper = Chopper { part: 1.0, ..Chopper::default() };
        Self { target, share, chopper }
    }

    #[inline(always)]
    fn averaged(&self, ask: &Ask) -> Applied {
        let t = self.target;
        let mut v = ask.e + ask.r * ask.i + (t - ask.i) * ask.ra;
        let braking = self.share * ask.bus;
        let most = if t > 0.0 { ask.bus } else { braking };
        let least = if t < 0.0 { -ask.bus } else { -braking };
        if v > most {
            v = most;
        }
        if v < least {
            v = least;
        }
        Applied::voltage(v)
    }

    /// The direction in which a chopper drives: that of the target, of the current where it is 0.
    #[inline(always)]
    fn direction(&self, i: f64) -> f64 {
        let given = if self.target == 0.0 { i } else { self.target };
        if given < 0.0 { -1.0 } else { 1.0 }
    }

    #[inline(always)]
    fn chopped(&self, ask: &Ask) -> Applied {
        let part = self.chopper.part;
        Applied::voltage(if part == 0.0 { 0.0 } else { part * (self.direction(ask.i) * ask.bus) })
    }

    #[inline]
    fn decide(&mut self, times: ChopperTimes, i: f64) {
        let along = self.direction(i) * i;
        let fast = || round_half_up(self.share * f64::from(times.off));
        let chopper = &mut self.chopper;
        chopper.count = chopper.count.saturating_add(1);
        if !chopper.is_off {
            if chopper.count >= times.blank && along >= self.target.abs() {
                let is_fast = self.share > 0.0 && fast() > 0;
                *chopper = Chopper {
                    is_off: true,
                    count: 0,
                    has_passed: false,
                    part: if is_fast { -1.0 } else { 0.0 },
                };
            }
        } else if chopper.count >= times.off {
            *chopper = Chopper { part: 1.0, ..Chopper::default() };
        } else {
            chopper.has_passed |= along <= 0.0;
            chopper.part = if chopper.count < fast() && !chopper.has_passed { -1.0 } else { 0.0 };
        }
    }

    /// EN = 0: what is left of the current runs through the diodes into the bus.
    #[inline]
    fn through_diodes(ask: &Ask, diodes: f64) -> Applied {
        let against = ask.bus + diodes;
        if ask.i == 0.0 {
            return if ask.e.abs() > against {
                Applied::voltage(sign(ask.e) * against)
            } else {
                Applied { v: 0.0, is_open: true, ends: false }
            };
        }
        let v = -sign(ask.i) * against;
        let zero = ask.e + ask.r * ask.i - ask.i * ask.ra;
        let (is_nearer, is_beyond) =
            if ask.i > 0.0 { (zero > v, zero > 0.0) } else { (zero < v, zero < 0.0) };
        if is_nearer {
            Applied { v: if is_beyond { 0.0 } else { zero }, is_open: false, ends: true }
        } else {
            Applied::voltage(v)
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Driver {
    pub(crate) commanded: i64,
    microsteps: i64,
    peak: f64,
    levels: Option<f64>,
    decay: CurrentDecay,
    regulator: CurrentControl,
    times: ChopperTimes,
    pub(crate) diodes: f64,
    pub(crate) phases: [Phase; 2],
}

impl Driver {
    pub(crate) fn new(motor: &MotorModel, clock_hz: f64, step_cycles: u32) -> Self {
        let drive = &motor.drive;
        let phase = Phase::new(0.0, drive.decay.first_share());
        let mut driver = Self {
            commanded: 0,
            microsteps: i64::from(motor.microsteps),
            peak: motor.peak_current_a,
            levels: drive.dac_levels.map(f64::from),
            decay: drive.decay,
            regulator: drive.regulator,
            times: ChopperTimes::new(drive, clock_hz, step_cycles),
            diodes: 2.0 * drive.diode_v,
            phases: [phase.clone(), phase],
        };
        let [a, b] = driver.targets();
        driver.phases[0].target = a;
        driver.phases[1].target = b;
        driver
    }

    #[inline(always)]
    pub(crate) fn command(&self) -> f64 {
        self.commanded as f64 / self.microsteps as f64
    }

    fn targets(&self) -> [f64; 2] {
        let place = self.commanded.rem_euclid(4 * self.microsteps);
        let (mut s, mut c) = sincos(place as f64 / self.microsteps as f64 + 0.5);
        if let Some(n) = self.levels {
            s = nearest(s * n) / n;
            c = nearest(c * n) / n;
        }
        [self.peak * c, self.peak * s]
    }

    pub(crate) fn step(&mut self, right: bool) {
        self.commanded += if right { 1 } else { -1 };
        let targets = self.targets();
        for (phase, target) in self.phases.iter_mut().zip(targets) {
            if let CurrentDecay::Auto(share) = self.decay {
                phase.share = if target.abs() < phase.target.abs() { share } else { 0.0 };
            }
            phase.target = target;
        }
    }

    pub(crate) fn power_up(&mut self) {
        for phase in &mut self.phases {
            phase.chopper = Chopper { part: 1.0, ..Chopper::default() };
        }
    }

    /// A grid point with EN = 1.
    #[inline(always)]
    pub(crate) fn decide(&mut self, i_a: f64, i_b: f64) {
        if self.regulator == CurrentControl::Chopper {
            self.phases[0].decide(self.times, i_a);
            self.phases[1].decide(self.times, i_b);
        }
    }

    #[inline(always)]
    pub(crate) fn voltage(&self, phase: usize, ask: &Ask, powered: bool) -> Applied {
        let Some(held) = self.phases.get(phase) else { return Applied::voltage(0.0) };
        if !powered {
            Phase::through_diodes(ask, self.diodes)
        } else if self.regulator == CurrentControl::Averaged {
            held.averaged(ask)
        } else {
            held.chopped(ask)
        }
    }
}
