//! F1's time: grid points, the sub-steps between them, and all results of a run.
//!
//! ```text
//! point n: sensors, lost steps, digest | chopper decides | changes in cycle n*N act | sub-steps | V, i_load of point n + 1
//! ```

use super::edges::{Change, changes, enable_rises, starts_enabled};
use super::ledger::Ledger;
use super::motor::MotorState;
use super::numbers::nearest;
use super::parameters::{Case, CurrentSensor, Motor, grid_step};
use super::refusals::is_refused;
use super::sensors::{EncoderState, Sensor, Watch};
use super::supply::Supply;
use crate::xxh64::xxh64;

/// A motor at a grid point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorPoint {
    /// Rotor, full steps.
    pub x: f64,
    /// Rotor, full steps/s.
    pub w: f64,
    /// A.
    pub i_a: f64,
    /// A.
    pub i_b: f64,
    /// Load, full steps; the rotor's without a coupling.
    pub x_l: f64,
    /// Load, full steps/s.
    pub w_l: f64,
    /// Commanded microsteps, without a STEP that rises in this cycle.
    pub u: i64,
    /// Acceleration of the load over the grid step that ends here, after its low pass, rad/s^2; 0 at point 0.
    pub sensed_rad_s2: f64,
    /// Full steps lost so far: four per slip.
    pub lost: i64,
}

/// The plant at a grid point.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// n*N.
    pub cycle: u64,
    /// EN, without a change in this cycle.
    pub en: bool,
    /// V.
    pub v: f64,
    /// i_load of the grid step that ends here, A; at point 0 the steady P/V + idle.
    pub i_load: f64,
    /// i_load after the sensor's low passes, A.
    pub sensed_a: f64,
    /// The motors in ascending channel.
    pub motors: Vec<MotorPoint>,
}

/// "lost += 1" or "lost -= 1": four full steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LostStep {
    /// Cycle of the grid point.
    pub cycle: u64,
    /// +1: the rotor is left of the command; -1: right of it.
    pub sign: i64,
}

/// Results of a run of the plant; lists of motors are in ascending channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// N, cycles.
    pub step_cycles: u64,
    /// F8's digest.
    pub digest: u64,
    /// Points 0, 1, ... up to the run's end.
    pub points: Vec<Point>,
    /// ADC values of the supply current: (cycle, code).
    pub supply_codes: Vec<(u64, i64)>,
    /// Codes of each motor's encoder: (cycle, code).
    pub encoder_codes: Vec<Vec<(u64, u16)>>,
    /// The slips of each motor.
    pub lost: Vec<Vec<LostStep>>,
    /// Energies of each motor.
    pub energies: Vec<Ledger>,
    /// The first cycle in which `protection` reports OVERLOAD, with these edges.
    pub overload: Option<u64>,
}

impl Run {
    /// (cycle, `sensed_a`) at each point.
    pub fn sensed_supply(&self) -> Vec<(u64, f64)> {
        self.points.iter().map(|point| (point.cycle, point.sensed_a)).collect()
    }

    /// (cycle, code*lsb_a) of each ADC value.
    pub fn adc_supply(&self, lsb_a: f64) -> Vec<(u64, f64)> {
        self.supply_codes.iter().map(|&(cycle, code)| (cycle, code as f64 * lsb_a)).collect()
    }
}

struct Mounted {
    channel: usize,
    microsteps: f64,
    state: MotorState,
    encoder: EncoderState,
    accelerometer: Sensor,
    /// In units of 4 full steps.
    lost: i64,
    slips: Vec<LostStep>,
    codes: Vec<(u64, u16)>,
}

impl Mounted {
    /// u/microsteps - x.
    fn error(&self) -> f64 {
        self.state.driver.u as f64 / self.microsteps - self.state.x
    }

    /// F8's lost steps at a point with EN = 1.
    fn look_for_slips(&mut self, cycle: u64) {
        let d = self.error() - 4.0 * self.lost as f64;
        let sign = if d > 2.5 {
            1
        } else if d < -2.5 {
            -1
        } else {
            return;
        };
        self.lost += sign;
        self.slips.push(LostStep { cycle, sign });
    }

    /// Advances by one grid step; returns the energy from the bus.
    fn advance(
        &mut self,
        from: u64,
        to: u64,
        changes: &[Change],
        en: bool,
        bus_v: f64,
        clock_hz: u64,
    ) -> f64 {
        let (at, en, energy) = self.advance_through(from, changes, en, bus_v, clock_hz);
        energy + self.state.advance(to - at, clock_hz, bus_v, en)
    }

    /// Advances to the last change that affects the motor: its cycle, EN from there on, and the energy from the bus.
    fn advance_through(
        &mut self,
        from: u64,
        changes: &[Change],
        en: bool,
        bus_v: f64,
        clock_hz: u64,
    ) -> (u64, bool, f64) {
        let (mut at, mut en) = (from, en);
        let mut energy = 0.0;
        for change in changes {
            let own_rise = change.rises >> self.channel & 1 == 1;
            if !own_rise && change.en == en {
                continue;
            }
            if change.cycle > at {
                energy += self.state.advance(change.cycle - at, clock_hz, bus_v, en);
                at = change.cycle;
            }
            if own_rise {
                self.state.driver.step(change.dirs >> self.channel & 1 == 1);
            }
            if change.en && !en {
                // Reading: u includes a STEP that rises in the same cycle, because both take effect from this cycle on.
                self.state.driver.enabled();
                self.lost = nearest(self.error() / 4.0) as i64;
            }
            en = change.en;
        }
        (at, en, energy)
    }

    fn point(&self) -> MotorPoint {
        let state = &self.state;
        MotorPoint {
            x: state.x,
            w: state.w,
            i_a: state.i[0],
            i_b: state.i[1],
            x_l: state.x_l,
            w_l: state.w_l,
            u: state.driver.u,
            sensed_rad_s2: self.accelerometer.value(),
            lost: 4 * self.lost,
        }
    }
}

/// Runs a valid case.
pub fn run(case: &Case) -> Run {
    assert_eq!(is_refused(case), None, "a refused case has no run");
    let n_cycles = grid_step(case);
    let h = n_cycles as f64 / case.clock_hz as f64;
    let mut motors = mount(case, n_cycles, h);
    let p = windings_power(motors.iter().map(|motor| &motor.state));
    let supply_v = case.motors.iter().flatten().map(|motor| motor.supply_v).next().unwrap_or(0.0);
    let mut supply = Supply::new(&case.plant, supply_v, motors.len(), p);
    let mut i_load = p / supply.v + supply.idle;
    let mut sensor = Sensor::new(&case.plant.current_sensor, h, i_load);
    let mut watch = case.plant.protection.as_ref().map(Watch::new);

    let changes = changes(&case.records);
    let mut en = starts_enabled(&case.records);
    // Reading: EN rises in p + 1 if ENABLE comes in p, and the protection is the last step of p. So the count restarts
    // before the value of a point in p or later. (An ENABLE while EN = 1 leaves no edge.)
    let enables = enable_rises(&changes, en);
    let mut points: Vec<Point> = Vec::new();
    let mut supply_codes = Vec::new();
    let mut digested: Vec<u8> = Vec::new();
    let mut next_change = 0;

    for n in 0.. {
        let cycle = n * n_cycles;
        // Point n, with EN and u before any change in this cycle.
        if n > 0 {
            sensor.advance(i_load);
            // Reading: "every adc_steps points" are the points adc_steps, 2*adc_steps, ..., as the encoder's.
            if n % sensor.adc_steps == 0 {
                let code = sensor.code();
                supply_codes.push((cycle, code));
                if let Some(watch) = &mut watch {
                    watch.sample(cycle, code, case.plant.current_sensor.lsb_a);
                }
            }
            for motor in &mut motors {
                if n % case.plant.encoder.period_steps == 0 {
                    let code = motor.encoder.code(motor.state.x);
                    motor.codes.push((cycle, code));
                }
            }
        }
        if en {
            for motor in &mut motors {
                motor.look_for_slips(cycle);
            }
        }
        let point = Point {
            cycle,
            en,
            v: supply.v,
            i_load,
            sensed_a: sensor.value(),
            motors: motors.iter().map(Mounted::point).collect(),
        };
        if n > 0 && n % 20 == 0 {
            digest_point(&mut digested, &point);
        }
        points.push(point);
        if en {
            for motor in &mut motors {
                motor.state.driver.decide(motor.state.i);
            }
        }

        // "Point n + 1 is known once cycle (n+1)N - 1 is."
        let to = cycle + n_cycles;
        if to > case.cycles {
            // Clarified: energies include those after the last point, up to the last change.
            let rest: Vec<Change> =
                changes[next_change..].iter().filter(|change| change.cycle <= case.cycles).cloned().collect();
            for motor in &mut motors {
                motor.advance_through(cycle, &rest, en, supply.v, case.clock_hz);
            }
            break;
        }
        let first_change = next_change;
        while next_change < changes.len() && changes[next_change].cycle < to {
            next_change += 1;
        }
        let here = &changes[first_change..next_change];
        let mut energies = Vec::new();
        for motor in &mut motors {
            let w_before = motor.state.w_l;
            energies.push(motor.advance(cycle, to, here, en, supply.v, case.clock_hz));
            let rad_s2 = (motor.state.w_l - w_before) / h * motor.state.constants.g;
            motor.accelerometer.advance(rad_s2);
        }
        for change in here {
            en = change.en;
        }
        if let Some(watch) = &mut watch
            && enables.iter().any(|rise| (cycle + 1..=to).contains(&(rise - 1)))
        {
            watch.enabled();
        }
        i_load = supply.load_current(&energies, h);
        supply.advance(i_load, h);
    }

    Run {
        step_cycles: n_cycles,
        digest: xxh64(&digested),
        points,
        supply_codes,
        encoder_codes: motors.iter().map(|motor| motor.codes.clone()).collect(),
        lost: motors.iter().map(|motor| motor.slips.clone()).collect(),
        energies: motors.iter().map(|motor| motor.state.ledger).collect(),
        overload: watch.and_then(|watch| watch.tripped),
    }
}

fn mount(case: &Case, n_cycles: u64, h: f64) -> Vec<Mounted> {
    let mounted = |(channel, motor): (usize, &Option<Motor>)| {
        let motor = motor.as_ref()?;
        // Reading: F9 has no fields for the accelerometer, so it has the low pass and the ADC of the current sensor.
        let low_pass: &CurrentSensor = &case.plant.current_sensor;
        Some(Mounted {
            channel,
            microsteps: f64::from(motor.microsteps),
            state: MotorState::new(motor, case.clock_hz, n_cycles),
            encoder: EncoderState::new(&case.plant.encoder, channel, motor.full_step_deg),
            accelerometer: Sensor::new(low_pass, h, 0.0),
            lost: 0,
            slips: Vec::new(),
            codes: Vec::new(),
        })
    };
    case.motors.iter().enumerate().filter_map(mounted).collect()
}

/// P (F5), W.
fn windings_power<'a>(motors: impl Iterator<Item = &'a MotorState>) -> f64 {
    let mut p = 0.0;
    for motor in motors {
        p += motor.constants.r * (motor.i[0] * motor.i[0] + motor.i[1] * motor.i[1]);
    }
    p
}

/// "cycle, then the bits of V, i_load and each motor's x, w, i_a, i_b, little-endian."
fn digest_point(bytes: &mut Vec<u8>, point: &Point) {
    bytes.extend(point.cycle.to_le_bytes());
    for value in [point.v, point.i_load] {
        bytes.extend(value.to_bits().to_le_bytes());
    }
    for motor in &point.motors {
        for value in [motor.x, motor.w, motor.i_a, motor.i_b] {
            bytes.extend(value.to_bits().to_le_bytes());
        }
    }
}

/// V at cycle 0, for F5's refusal.
pub(super) fn start_voltage(case: &Case, supply_v: f64) -> f64 {
    let n_cycles = grid_step(case);
    let states: Vec<MotorState> =
        case.motors.iter().flatten().map(|motor| MotorState::new(motor, case.clock_hz, n_cycles)).collect();
    Supply::new(&case.plant, supply_v, states.len(), windings_power(states.iter())).v
}
