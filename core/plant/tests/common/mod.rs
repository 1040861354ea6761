//! Shared by the tests: the motors of F10, and edges in given cycles.
#![allow(dead_code, unreachable_pub, reason = "each test file takes what it needs")]

use stepscope_peripheral::{
    signal::{Levels, Record},
    units::Instant,
};
use stepscope_plant::{
    Observer, Plant,
    parameters::{DriverModel, MotorModel, SensorChain, Setup, Supply},
};

/// T_step of the patent, in cycles: 2.048 ms.
pub const T_STEP: u64 = 32_768;

/// The default motor without friction.
pub fn frictionless() -> MotorModel {
    MotorModel { friction_mn_m: 0.0, viscous_un_m_s: 0.0, ..MotorModel::default() }
}

pub fn full_steps() -> MotorModel {
    MotorModel { microsteps: 1, ..MotorModel::default() }
}

/// F10's motor for the patent's figures. It is our own, because the patent names no motor.
pub fn patent_set() -> MotorModel {
    MotorModel {
        microsteps: 1,
        inductance_mh: 5.3,
        holding_torque_mn_m: 300.0,
        load_inertia_g_cm2: 100.0,
        friction_mn_m: 15.0,
        viscous_un_m_s: 1000.0,
        drive: DriverModel { bridge_ohm: 1.0, ..DriverModel::default() },
        ..MotorModel::default()
    }
}

pub fn one(motor: MotorModel) -> Setup {
    Setup { motors: vec![motor], ..Setup::default() }
}

pub fn patent_plant(motors: usize) -> Setup {
    let supply = Supply { supply_v: 27.0, ..Supply::default() };
    Setup { supply, motors: vec![patent_set(); motors], ..Setup::default() }
}

pub fn with_sensor(setup: Setup, bandwidth_hz: f64) -> Setup {
    Setup { current_sensor: SensorChain { bandwidth_hz, ..SensorChain::default() }, ..setup }
}

/// Records of pulses of `width` cycles to the right, which rise in these cycles of each channel.
pub fn records(rises: &[Vec<u64>], width: u64) -> Vec<Record> {
    let right: u64 = (0..rises.len()).map(|channel| 1 << (16 + channel)).sum();
    let mut edges: Vec<(u64, u64)> = vec![];
    for (channel, rises) in rises.iter().enumerate() {
        for &rise in rises {
            edges.extend([(rise, 1 << channel), (rise + width, 1 << channel)]);
        }
    }
    edges.sort_unstable();
    let mut levels = Levels::RESET.0 | right;
    let mut records: Vec<Record> = vec![];
    for (cycle, bit) in edges {
        levels ^= bit;
        let record = Record { cycle: Instant(cycle), levels: Levels(levels) };
        match records.last_mut() {
            Some(last) if last.cycle == record.cycle => *last = record,
            _ => records.push(record),
        }
    }
    records
}

pub fn run(setup: &Setup, records: &[Record], cycles: u64, observer: &mut impl Observer) -> Plant {
    let mut plant = Plant::new(setup).expect("it holds");
    for &record in records {
        plant.record(record, observer);
    }
    plant.advance(cycles, observer);
    plant
}

/// Calls a closure for each point.
pub struct Each<F>(pub F);

impl<F: FnMut(&Plant)> Observer for Each<F> {
    fn point(&mut self, plant: &Plant) {
        (self.0)(plant);
    }
}

#[track_caller]
pub fn near(found: f64, expected: f64, tolerance: f64) {
    println!("{found} (expected {expected} +- {tolerance})");
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected} +- {tolerance}");
}

#[track_caller]
pub fn near_part(found: f64, expected: f64, part: f64) {
    near(found, expected, (expected * part).abs());
}
