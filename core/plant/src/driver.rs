//! The driver of one motor: from step counts to target currents, and from those to phase voltages (PLANT F4).

use crate::parameters::{CurrentControl, CurrentDecay, DriverModel, MotorModel};
use crate::sincos::{nearest, sincos};

/// What a driver applies to a phase in one (sub-)step.
#[derive(Clone, Copy)]
pub(crate) struct Applied {
    /// Voltage in V.
    pub(crate) v: f64,
    /// No current flows.
    pub(crate) is_open: bool,
    /// The current reaches 0 through the diodes by the end of the step.
    pub(crate) reaches_zero: bool,
}

impl Applied {
    const fn voltage(v: f64) -> Self {
        Self { v, is_open: false, reaches_zero: false }
    }
}

/// A phase at the start of a (sub-)step.
#[derive(Clone, Copy)]
pub(crate) struct PhaseInput {
    /// Back EMF in V.
    pub(crate) e: f64,
    /// Current in A.
    pub(crate) i: f64,
    pub(crate) r: f64,
    /// Voltage in V per A of change within the step.
    pub(crate) ra: f64,
    /// Bus voltage in V.
    pub(crate) supply_v: f64,
}

#[derive(Clone, Debug)]
pub(crate) struct Phase {
    /// Target current in A.
    pub(crate) target: f64,
    pub(crate) share: f64,
    chopper: Chopper,
}

#[derive(Clone, Copy, Debug, Default)]
struct Chopper {
    is_off: bool,
    /// Grid steps in this on-time or off-time.
    count: u32,
    /// The current has passed 0 in this off-time.
    has_passed: bool,
    /// Voltage in units of the supply voltage for a positive current: 1 on, -1 fast decay, 0 slow decay.
    part: f64,
}

/// In grid steps, at least 1.
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

/// Nearest integer to `x` >= 0, halves up.
fn round_half_up(x: f64) -> u32 {
    let whole = x as u32;
    whole.saturating_add(u32::from(x - f64::from(whole) >= 0.5))
}

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

    /// An ideal chopper: the target is reached within the step, as far as the supply voltage allows.
    fn averaged(&self, input: &PhaseInput) -> Applied {
        let t = self.target;
        let mut v = input.e + input.r * input.i + (t - input.i) * input.ra;
        let braking = self.share * input.supply_v;
        let max = if t > 0.0 { input.supply_v } else { braking };
        let min = if t < 0.0 { -input.supply_v } else { -braking };
        // Not f64::min and max: the sign of a zero would depend on the platform.
        if v > max {
            v = max;
        }
        if v < min {
            v = min;
        }
        Applied::voltage(v)
    }

    /// Sign of the target or, for target 0, of the current.
    fn direction(&self, i: f64) -> f64 {
        let decisive = if self.target == 0.0 { i } else { self.target };
        if decisive < 0.0 { -1.0 } else { 1.0 }
    }

    /// A real chopper in its present state.
    fn chopped(&self, input: &PhaseInput) -> Applied {
        let part = self.chopper.part;
        Applied::voltage(if part == 0.0 { 0.0 } else { part * (self.direction(input.i) * input.supply_v) })
    }

    /// Decides the state of the chopper at a grid point with the current `i`.
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

    /// EN = 0: the diodes return the remaining current to the supply.
    fn through_diodes(input: &PhaseInput, diodes: f64) -> Applied {
        let against = input.supply_v + diodes;
        if input.i == 0.0 {
            return if input.e.abs() > against {
                Applied::voltage(sign(input.e) * against)
            } else {
                Applied { v: 0.0, is_open: true, reaches_zero: false }
            };
        }
        let v = -sign(input.i) * against;
        let zero = input.e + input.r * input.i - input.i * input.ra;
        let (is_nearer, is_beyond) =
            if input.i > 0.0 { (zero > v, zero > 0.0) } else { (zero < v, zero < 0.0) };
        if is_nearer {
            Applied { v: if is_beyond { 0.0 } else { zero }, is_open: false, reaches_zero: true }
        } else {
            Applied::voltage(v)
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Driver {
    pub(crate) commanded: i64,
    microsteps: i64,
    /// Peak current in A.
    peak: f64,
    /// Levels of the digital-to-analog converter.
    levels: Option<f64>,
    decay: CurrentDecay,
    regulator: CurrentControl,
    times: ChopperTimes,
    /// Forward voltage of two diodes in V.
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

    /// Commanded position in full steps.
    pub(crate) fn command(&self) -> f64 {
        self.commanded as f64 / self.microsteps as f64
    }

    fn targets(&self) -> [f64; 2] {
        let position = self.commanded.rem_euclid(4 * self.microsteps);
        let (mut s, mut c) = sincos(position as f64 / self.microsteps as f64 + 0.5);
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

    /// Called at each grid point with EN = 1.
    pub(crate) fn decide(&mut self, i_a: f64, i_b: f64) {
        if self.regulator == CurrentControl::Chopper {
            self.phases[0].decide(self.times, i_a);
            self.phases[1].decide(self.times, i_b);
        }
    }

    pub(crate) fn voltage(&self, phase: usize, input: &PhaseInput, powered: bool) -> Applied {
        let Some(phase) = self.phases.get(phase) else { return Applied::voltage(0.0) };
        if !powered {
            Phase::through_diodes(input, self.diodes)
        } else if self.regulator == CurrentControl::Averaged {
            phase.averaged(input)
        } else {
            phase.chopped(input)
        }
    }
}
