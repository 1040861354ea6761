//! Standstill, oscillation, coasting, direct starts and the chopper of F10.

use super::*;
use crate::plant_oracle::edges::EN;
use crate::plant_oracle::motor::MotorState;
use crate::plant_oracle::refusals::natural_frequency_hz;
use crate::plant_oracle::results::move_end;

#[test]
fn natural_frequency_of_the_default_motor() {
    close(natural_frequency_hz(&Motor::default()), 282.14, 0.06);
}

#[test]
fn standstill_under_gravity() {
    for (gravity_torque_mn_m, x) in [(50.0, -0.113134), (150.0, -0.355864), (250.0, -0.690160)] {
        let motor = Motor { gravity_torque_mn_m, friction_mn_m: 0.0, ..Motor::default() };
        let run = run(&alone(motor, &Bus::default(), 80_000));
        close(run.points[0].motors[0].x, x, 1e-6);
        close(run.points[1000].motors[0].x, x, 1e-6);
    }
}

#[test]
fn coasting_without_current() {
    // A rotor at 1000 full steps/s coasts by w*w*M/(2*Fc) after its currents have ended.
    let mut bus = Bus::default();
    bus.order(1, edges::DIR, true);
    let mut rise = 1600;
    for k in 0..1600 {
        bus.pulse(0, rise, 16);
        rise += (32_000 - 20 * k).max(1000);
    }
    bus.order(rise, EN, false);
    let motor = Motor { friction_mn_m: 10.0, viscous_un_m_s: 0.0, ..Motor::default() };
    let c = MotorConstants::new(&motor);
    let run = run(&alone(motor, &bus, rise + 700_000));
    let free =
        run.points.iter().find(|point| !point.en && point.motors[0].i_a == 0.0 && point.motors[0].i_b == 0.0);
    let free = free.unwrap();
    let from = free.motors[0];
    assert!(from.w > 500.0, "{from:?}");
    let way = from.w * from.w * c.m / (2.0 * c.coulomb);
    let last = run.points.last().unwrap().motors[0];
    assert_eq!(last.w, 0.0);
    close(last.x - from.x, way, 0.001 * way);
    // 7.0686 full steps from 1000 full steps/s.
    close(1e6 * c.m / (2.0 * c.coulomb), 7.0686, 0.007);
}

#[test]
fn direct_starts_overshoot_and_ring() {
    for (rate, overshoot, ring_ms) in [(8000, 0.265, 12.1), (19_200, 0.676, 26.5)] {
        let (bus, last) = even_rate(3200, rate);
        let run = run(&alone(Motor::default(), &bus, last + 16 + 1_600_000));
        assert!(run.lost[0].is_empty());
        let end = move_end(&run, 0, 16, last, true).unwrap();
        close(end.overshoot, overshoot, 0.02 * overshoot);
        close(end.settling_cycles as f64 / 16_000.0, ring_ms, 0.02 * ring_ms);
        assert!(run.energies[0].imbalance() < 1e-6, "{:?}", run.energies[0]);
    }
}

#[test]
fn direct_start_with_a_load_slips() {
    let (bus, last) = even_rate(3200, 19_200);
    let motor = Motor { load_inertia_g_cm2: 200.0, ..Motor::default() };
    let run = run(&alone(motor, &bus, last + 16 + 1_600_000));
    assert_eq!(run.points.last().unwrap().motors[0].lost, 188);
    close(run.lost[0][0].cycle as f64 / 16_000.0, 2.81, 0.02);
}

#[test]
fn resonance_loses_steps_between_208_and_252() {
    for (rate, loses) in [(180, false), (200, false), (220, true), (240, true), (264, false)] {
        let motor = Motor { microsteps: 1, friction_mn_m: 20.0, ..Motor::default() };
        let (bus, _) = even_rate(rate * 6 / 10, rate);
        let run = run(&alone(motor, &bus, CLOCK * 6 / 10));
        assert_eq!(!run.lost[0].is_empty(), loses, "{rate} full steps/s");
    }
}

#[test]
fn chopper_at_rest() {
    for (decay, mean_a, rate_hz) in [(Decay::Slow, 1.058, 46_500.0), (Decay::Mixed(0.31), 1.033, 35_800.0)] {
        let drive = Drive { regulator: Regulator::Chopper, decay, ..Drive::default() };
        let run = run(&alone(Motor { drive, ..Motor::default() }, &Bus::default(), 1_600_000));
        let late: Vec<f64> = run.points[20_000..].iter().map(|point| point.motors[0].i_a).collect();
        close(late.iter().sum::<f64>() / late.len() as f64, mean_a, 0.005 * mean_a);
        // Each period has one maximum.
        let tops = late.windows(3).filter(|three| three[0] < three[1] && three[1] > three[2]).count();
        close(tops as f64 / (late.len() as f64 * 1e-6), rate_hz, 0.01 * rate_hz);
    }
}

/// x after each of a number of grid steps of 5 us, from standstill `away` full steps from equilibrium.
fn rings(motor: &Motor, away: f64, steps: usize) -> Vec<f64> {
    let mut state = MotorState::new(motor, CLOCK, 80);
    state.x += away;
    let step = |_| {
        state.advance(80, CLOCK, motor.supply_v, true);
        state.x
    };
    (0..steps).map(step).collect()
}

#[test]
fn the_default_rotor_oscillates_at_282_hz() {
    let motor = Motor { friction_mn_m: 0.0, ..Motor::default() };
    let x = rings(&motor, 0.01, 20_000);
    // Maxima by the parabola through the three points around them: (time in grid steps, height).
    let mut tops = Vec::new();
    for (k, three) in x.windows(3).enumerate() {
        if three[0] < three[1] && three[1] >= three[2] {
            let (slope, bend) = (0.5 * (three[2] - three[0]), three[0] - 2.0 * three[1] + three[2]);
            tops.push((k as f64 + 1.0 - slope / bend, three[1] - 0.5 * slope * slope / bend));
        }
    }
    let (first, tenth) = (tops[0], tops[10]);
    close(10.0 / ((tenth.0 - first.0) * 5e-6), 282.09, 0.06);
    // The maximum falls by exp(-0.1182) per period: by exp(-1.182) in ten.
    close(tenth.1 / first.1, 0.30666, 0.30666 * 0.01182);
}

#[test]
fn two_masses_oscillate_at_98_and_456_hz() {
    let motor = Motor {
        friction_mn_m: 0.0,
        viscous_un_m_s: 0.0,
        load_inertia_g_cm2: 200.0,
        coupling_n_m_rad: Some(20.0),
        ..Motor::default()
    };
    let x = rings(&motor, 0.01, 200_000);
    // The power at a frequency by Goertzel's recurrence, with the model's own sine.
    let power = |hz: f64| {
        let twice_cos = 2.0 * sincos(4.0 * hz * 5e-6).1;
        let (mut last, mut before) = (0.0, 0.0);
        for x in &x {
            (last, before) = (x + twice_cos * last - before, last);
        }
        last * last + before * before - twice_cos * last * before
    };
    for (expected, from, to) in [(98.5, 80, 120), (455.9, 430, 480)] {
        let strongest = (from * 10..to * 10)
            .map(|tenths| f64::from(tenths) / 10.0)
            .max_by(|a, b| power(*a).total_cmp(&power(*b)));
        close(strongest.unwrap(), expected, 0.003 * expected);
    }
}
