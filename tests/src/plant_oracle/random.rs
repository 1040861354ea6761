//! Random cases for property tests from a seed: motors, drivers, supplies, sensors and edges, equal on every target.
//!
//! Values are spread over F9's ranges. Where a range is too wide for an effect within a run, values are near those of
//! real drives. Runs are short: some hundred to some thousand grid points per motor.

use super::edges::{Bus, DIR, EN};
use super::numbers::SplitMix64;
use super::parameters::{
    Case, CurrentSensor, Decay, Drive, Encoder, Motor, Plant, Protection, Regulator, grid_step,
};
use super::refusals::is_refused;

/// Grid points times motors of a drawn case, at most.
const MOTOR_STEPS: u64 = 24_000;

/// A valid case: the first one drawn from the seed.
pub fn random_case(seed: u64) -> Case {
    let mut dice = Dice(SplitMix64(seed));
    loop {
        let case = dice.case();
        if is_refused(&case).is_none() {
            return case;
        }
    }
}

/// The first case drawn from the seed, valid or not.
pub fn drawn_case(seed: u64) -> Case {
    Dice(SplitMix64(seed)).case()
}

struct Dice(SplitMix64);

impl Dice {
    /// 0..n.
    fn below(&mut self, n: u64) -> u64 {
        self.0.bits() % n
    }

    fn chance(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }

    fn pick<T: Clone>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u64) as usize].clone()
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.0.unit()
    }

    /// Equally likely in each decade: a number of doublings of `least`, then a part of one.
    fn decades(&mut self, least: f64, most: f64) -> f64 {
        let mut doublings = 0;
        while least * (2u64 << doublings) as f64 <= most {
            doublings += 1;
        }
        let value = least * (1u64 << self.below(doublings + 1)) as f64;
        value * self.between(1.0, if value * 2.0 <= most { 2.0 } else { most / value })
    }

    /// Mostly 0; otherwise spread over decades.
    fn seldom(&mut self, percent: u64, least: f64, most: f64) -> f64 {
        if self.chance(percent) { self.decades(least, most) } else { 0.0 }
    }

    fn sign(&mut self) -> f64 {
        if self.chance(50) { 1.0 } else { -1.0 }
    }

    fn case(&mut self) -> Case {
        let clock_hz = if self.chance(50) {
            16_000_000
        } else {
            self.pick(&[100_000, 1_000_000, 4_000_000, 12_345_679, 20_000_000, 72_000_000, 200_000_000])
        };
        let places = match self.below(10) {
            0..=3 => 1,
            4..=6 => 2 + self.below(2),
            7 => 4 + self.below(4),
            8 => 8 + self.below(8),
            _ => 16,
        };
        let supply_v = if self.chance(30) { 24.0 } else { self.decades(3.0, 300.0) };
        let chopped = self.chance(40);
        let mut motors: Vec<Option<Motor>> = Vec::new();
        for _ in 0..places {
            let there = !self.chance(8);
            // Equal motors are common.
            let again = motors.last().cloned().flatten().filter(|_| self.chance(30));
            let motor = again.unwrap_or_else(|| self.motor(supply_v, chopped));
            motors.push(there.then_some(motor));
        }
        if motors.iter().all(Option::is_none) {
            motors[0] = Some(self.motor(supply_v, chopped));
        }
        let mut case = Case { clock_hz, plant: self.plant(), motors, records: Vec::new(), cycles: 0 };
        let usual = grid_step(&case);
        if self.chance(40) {
            case.plant.step_cycles = Some(1 + self.below(usual * 3));
        }
        let n_cycles = grid_step(&case);
        let fitted = case.motors.iter().flatten().count() as u64;
        let points = 60 + self.below(MOTOR_STEPS / fitted);
        case.cycles = points * n_cycles + self.below(n_cycles);
        case.records = self.records(&case, n_cycles);
        case
    }

    fn motor(&mut self, supply_v: f64, chopped: bool) -> Motor {
        let usual = Motor { supply_v, ..Motor::default() };
        let rated_current_a = if self.chance(30) { 1.5 } else { self.decades(0.1, 8.0) };
        let holding_torque_mn_m = if self.chance(30) { 400.0 } else { self.decades(5.0, 5000.0) };
        let friction_mn_m = if self.chance(20) { 0.0 } else { self.between(0.0, 0.1 * holding_torque_mn_m) };
        let inertia = self.decades(1.0, 2000.0);
        let load_inertia = if self.chance(50) { self.decades(1.0, 5000.0) } else { 0.0 };
        // A spring that the grid can mostly follow: against the lighter mass at 50 to 3000 rad/s.
        let natural = self.decades(50.0, 3000.0);
        let coupling_n_m_rad = (load_inertia > 0.0 && self.chance(60))
            .then(|| (load_inertia.min(inertia) * 1e-7 * natural * natural).max(0.001));
        let coupling_un_m_s = self.seldom(60, 1.0, 20_000.0);
        Motor {
            full_step_deg: if self.chance(60) { 1.8 } else { self.pick(&[0.9, 1.2, 3.6, 7.5, 15.0, 0.72]) },
            microsteps: self.pick(&[1, 1, 2, 3, 4, 5, 8, 10, 16, 16, 32, 64, 128, 256, 512]),
            rated_current_a,
            peak_current_a: self.chance(40).then(|| rated_current_a * self.between(0.05, 1.414)),
            resistance_ohm: self.decades(0.1, 40.0),
            inductance_mh: self.decades(0.2, 60.0),
            holding_torque_mn_m,
            rotor_inertia_g_cm2: inertia,
            load_inertia_g_cm2: load_inertia,
            load_torque_mn_m: if self.chance(30) {
                self.between(0.0, 0.4) * holding_torque_mn_m
            } else {
                0.0
            },
            friction_mn_m,
            stiction_mn_m: self.chance(40).then(|| friction_mn_m * self.between(1.0, 3.0)),
            viscous_un_m_s: if self.chance(30) { 300.0 } else { self.seldom(80, 1.0, 50_000.0) },
            detent_torque_mn_m: if self.chance(40) {
                self.between(0.0, 0.5) * holding_torque_mn_m
            } else {
                0.0
            },
            gravity_torque_mn_m: if self.chance(35) {
                self.sign() * self.between(0.0, 0.7) * holding_torque_mn_m
            } else {
                0.0
            },
            sine_torque_mn_m: if self.chance(40) {
                self.between(0.0, 0.5) * holding_torque_mn_m
            } else {
                0.0
            },
            sine_per_turn: self.pick(&[1.0, 2.0, 0.1, 50.0, 13.37, 400.0]),
            sine_phase_deg: self.between(-360.0, 360.0),
            coupling_n_m_rad,
            coupling_un_m_s,
            drive: self.drive(chopped),
            ..usual
        }
    }

    fn drive(&mut self, chopped: bool) -> Drive {
        let share = if self.chance(80) { self.0.unit() } else { self.pick(&[0.0, 1.0]) };
        Drive {
            // Both regulators in one plant, too.
            regulator: if chopped && self.chance(80) { Regulator::Chopper } else { Regulator::Averaged },
            decay: self.pick(&[Decay::Slow, Decay::Fast, Decay::Mixed(share), Decay::Auto(share)]),
            off_us: if self.chance(30) { 20.0 } else { self.decades(1.0, 60.0) },
            blank_us: if self.chance(30) { 1.0 } else { self.decades(0.1, 8.0) },
            dac_levels: self.chance(40).then(|| 1 + self.below(1023) as u32),
            bridge_ohm: self.seldom(50, 0.05, 3.0),
            diode_v: self.pick(&[0.7, 0.7, 0.0, 0.4, 1.1, 2.0]),
        }
    }

    fn plant(&mut self) -> Plant {
        let usual = Plant::default();
        // One in eight has a bus whose voltage a step can reduce to its minimum.
        let weak = self.chance(12);
        Plant {
            source_ohm: self.decades(if weak { 1.0 } else { 0.01 }, if weak { 100.0 } else { 4.0 }),
            buffer_uf: if weak {
                Some(self.decades(10.0, 20.0))
            } else {
                self.chance(60).then(|| self.decades(10.0, 4000.0))
            },
            source_sinks: self.chance(40),
            idle_ma: self.seldom(50, 1.0, 100.0),
            current_sensor: CurrentSensor {
                bandwidth_hz: if self.chance(30) { 3000.0 } else { self.decades(50.0, 100_000.0) },
                poles: 1 + self.below(3) as usize,
                adc_steps: self.pick(&[1, 1, 2, 3, 7, 20]),
                lsb_a: self.pick(&[0.0244140625, 0.0244140625, 0.001, 0.1]),
                adc_max: self.pick(&[2047, 127, 32_767]),
            },
            encoder: Encoder {
                period_steps: self.pick(&[1000, 1, 7, 50, 100]),
                offset_lsb: if self.chance(40) { self.between(-5000.0, 5000.0) } else { 0.0 },
                noise_lsb: self.seldom(50, 0.1, 20.0),
                hysteresis_lsb: self.seldom(50, 0.1, 10.0),
                seed: if self.chance(20) { 0 } else { self.0.bits() >> 32 },
            },
            protection: self.chance(60).then(|| Protection {
                threshold_a: self.decades(0.05, 10.0),
                samples: 1 + self.below(12) as u32,
            }),
            ..usual
        }
    }

    /// Pulses of each channel, and changes of EN. EN never rises in the cycle of a STEP.
    fn records(&mut self, case: &Case, n_cycles: u64) -> Vec<(u64, u64)> {
        let mut bus = Bus::default();
        let mut rises = Vec::new();
        for channel in 0..case.motors.len() {
            if !self.chance(12) {
                let microsteps = case.motors[channel].as_ref().map_or(1, |motor| motor.microsteps);
                self.pulses(&mut bus, &mut rises, (channel, microsteps), case.cycles, n_cycles);
            }
        }
        if self.chance(50) {
            let mut at = 0;
            let mut en = true;
            for _ in 0..1 + self.below(6) {
                at += 1 + self.below((case.cycles / 3).max(2));
                if self.chance(30) {
                    at = at.div_ceil(n_cycles) * n_cycles;
                }
                while !en && rises.contains(&at) {
                    at += 1;
                }
                en = !en;
                bus.order(at, EN, en);
            }
        }
        bus.records(case.cycles)
    }

    /// One channel: parts with a constant, a rising or a random rate, with pauses, in either direction.
    fn pulses(
        &mut self,
        bus: &mut Bus,
        rises: &mut Vec<u64>,
        (channel, microsteps): (usize, u32),
        cycles: u64,
        n_cycles: u64,
    ) {
        // From a part of a grid step to some hundred of them.
        let grid_steps = if self.chance(35) {
            self.decades(0.3, 600.0)
        } else {
            self.decades(60.0, 3000.0) / f64::from(microsteps)
        };
        let usual = ((grid_steps * n_cycles as f64) as u64).max(1);
        let width = 1 + self.below(2 * n_cycles);
        let dir_ahead = self.below(3);
        let snapped = self.chance(25);
        let mut at = 3 + self.below(cycles / 4 + 1);
        let mut right = false;
        let mut pulses = 0;
        while at < cycles && pulses < 4000 {
            let turned = self.chance(50);
            right ^= turned;
            let mut interval = usual + self.below(usual * 2);
            let grows = self.pick(&[0i64, 0, 1, -1]) * self.below(interval / 40 + 1) as i64;
            let random = self.chance(20);
            for step in 0..1 + self.below(120) {
                let rise = if snapped && self.chance(60) { at.div_ceil(n_cycles) * n_cycles } else { at };
                if rise >= cycles {
                    return;
                }
                if step == 0 && turned {
                    // DIR in the cycle of the rise, or up to two cycles earlier.
                    bus.order(rise - dir_ahead, DIR + channel as u32, right);
                }
                bus.pulse(channel, rise, width);
                rises.push(rise);
                pulses += 1;
                let gap = if random { 1 + self.below(2 * interval) } else { interval };
                at = rise + width + 3 + gap;
                interval = interval.saturating_add_signed(grows).max(1);
            }
            if self.chance(40) {
                at += self.below(cycles / 3 + 1);
            }
        }
    }
}
