//! Tests of the model: F10's digests, and its numbers that need only the model.

mod digests;
mod motion;
mod pieces;
mod random;
mod supply;

use super::edges::{Bus, RESET, Segment, segment_bus};
use super::*;

const CLOCK: u64 = 16_000_000;

/// `motor` on channel 0 for this number of cycles.
fn alone(motor: Motor, bus: &Bus, cycles: u64) -> Case {
    of_equals(motor, 1, bus, cycles)
}

/// `motor` on channels 0..count.
fn of_equals(motor: Motor, count: usize, bus: &Bus, cycles: u64) -> Case {
    Case {
        clock_hz: CLOCK,
        plant: Plant::default(),
        motors: vec![Some(motor); count],
        records: bus.records(cycles),
        cycles,
    }
}

/// "Patent set" of F10.
fn patent_motor() -> Motor {
    Motor {
        microsteps: 1,
        inductance_mh: 5.3,
        holding_torque_mn_m: 300.0,
        load_inertia_g_cm2: 100.0,
        friction_mn_m: 15.0,
        viscous_un_m_s: 1000.0,
        supply_v: 27.0,
        drive: Drive { bridge_ohm: 1.0, ..Drive::default() },
        ..Motor::default()
    }
}

/// Step k = 0, 1, ... of a constant rate rises in 1600 + floor(k*clock_hz/rate + 1/2).
fn even_rate(steps: u64, rate: u64) -> (Bus, u64) {
    let mut bus = Bus::default();
    bus.order(1, edges::DIR, true);
    let mut last = 0;
    for k in 0..steps {
        last = 1600 + (2 * k * CLOCK + rate) / (2 * rate);
        bus.pulse(0, last, 16);
    }
    (bus, last)
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found}, expected {expected} within {tolerance}");
}
