//! The plant compared with formulas: for random motors, and for the rows of F10 that are formulas.
#![expect(clippy::disallowed_methods, reason = "a second opinion by the platform's mathematics")]

use crate::common::{Each, frictionless, full_steps, near, near_part, one, records, run};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, SQRT_2, TAU};
use stepscope_peripheral::{
    signal::{Levels, Record},
    units::Instant,
};
use stepscope_plant::{
    Plant, State,
    parameters::{MotorModel, Setup, Supply},
    stability::Natural,
};

const HZ: f64 = 16e6;

/// The rotor's displacement from its equilibrium, point by point, after a displacement of `off`.
fn rings(setup: &Setup, off: f64, cycles: u64) -> Vec<f64> {
    let mut plant = Plant::new(setup).expect("it holds");
    let state = *plant.state(0).expect("a motor");
    plant.set_state(0, State { x: state.x + off, ..state });
    let mut positions = vec![];
    plant.advance(cycles, &mut Each(|plant: &Plant| positions.push(plant.state(0).expect("a motor").x)));
    positions
}

/// Times of the rises through 0, in samples, and the maximum between them.
fn periods(positions: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut rises = vec![];
    for (index, pair) in positions.windows(2).enumerate() {
        if pair[0] < 0.0 && pair[1] >= 0.0 {
            rises.push(index as f64 - pair[0] / (pair[1] - pair[0]));
        }
    }
    let between = |pair: &[f64]| {
        let (from, to) = (pair[0].ceil() as usize, pair[1].floor() as usize);
        let top = (from..=to).max_by(|&a, &b| positions[a].total_cmp(&positions[b])).expect("a period");
        // The vertex of the parabola through three samples.
        let (l, m, r) = (positions[top - 1], positions[top], positions[top + 1]);
        m - (l - r) * (l - r) / (8.0 * (l - 2.0 * m + r))
    };
    let peaks = rises.windows(2).map(between).collect();
    (rises, peaks)
}

#[test]
fn a_small_oscillation_has_its_frequency_and_decrement() {
    let motor = MotorModel { friction_mn_m: 0.0, ..MotorModel::default() };
    let (rises, peaks) = periods(&rings(&one(motor), 0.01, 1_600_000));
    let count = (rises.len() - 1) as f64;
    near_part(count / (rises[rises.len() - 1] - rises[0]) * 200_000.0, 282.09, 0.0002);
    let decrement = (peaks[0] / peaks[peaks.len() - 1]).ln() / (peaks.len() - 1) as f64;
    near_part(decrement, 0.1182, 0.01);
}

/// Frequency, in Hz, at which the spectrum of `positions` has its maximum, within a fiftieth of `guess`.
fn frequency(positions: &[f64], guess: f64) -> f64 {
    let mean = positions.iter().sum::<f64>() / positions.len() as f64;
    let power = |hz: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for (index, x) in positions.iter().enumerate().step_by(20) {
            // A Hann window suppresses the other mode.
            let window = 1.0 - (TAU * index as f64 / positions.len() as f64).cos();
            let (s, c) = (TAU * hz * index as f64 / 200_000.0).sin_cos();
            re += window * (x - mean) * c;
            im += window * (x - mean) * s;
        }
        re * re + im * im
    };
    let rungs = (0..=80).map(|rung| guess * (0.98 + f64::from(rung) * 0.000_5));
    rungs.max_by(|&a, &b| power(a).total_cmp(&power(b))).expect("rungs")
}

#[test]
fn two_masses_on_a_spring_have_two_frequencies() {
    let motor = MotorModel { load_inertia_g_cm2: 200.0, coupling_n_m_rad: Some(20.0), ..frictionless() };
    let positions = rings(&one(motor), 0.01, 16_000_000);
    near_part(frequency(&positions, 98.5), 98.5, 0.003);
    near_part(frequency(&positions, 455.9), 455.9, 0.003);
}

#[test]
fn friction_stops_a_rotor_without_current() {
    let motor = MotorModel { friction_mn_m: 10.0, viscous_un_m_s: 0.0, ..MotorModel::default() };
    let mut plant = Plant::new(&one(motor)).expect("it holds");
    let off = Record { cycle: Instant(0), levels: Levels(Levels::RX | Levels::TX) };
    plant.record(off, &mut ());
    plant.set_state(0, State { w: 1000.0, ..State::default() });
    let mut stopped = None;
    plant.advance(
        1_600_000,
        &mut Each(|plant: &Plant| {
            if plant.state(0).expect("a motor").w == 0.0 {
                stopped.get_or_insert(plant.cycle());
            }
        }),
    );
    near_part(plant.state(0).expect("a motor").x, 7.0686, 0.001);
    near_part(stopped.expect("it stops") as f64 / HZ * 1e3, 14.14, 0.001);
    near(plant.energy(0).expect("a motor").error(), 0.0, 1e-6);
}

/// The mean torque in mN*m at an imposed rate with the rotor `lag` full steps behind.
fn torque(rate: f64, lag: f64) -> f64 {
    let full_steps_s = rate / 16.0;
    // Its inertia keeps the speed constant.
    let motor = MotorModel { rotor_inertia_g_cm2: 1e9, ..frictionless() };
    let mut plant = Plant::new(&one(motor)).expect("it holds");
    let state = *plant.state(0).expect("a motor");
    plant.set_state(0, State { x: -lag, w: full_steps_s, ..state });
    let rises: Vec<u64> =
        (0..(rate * 0.06) as u64).map(|k| 1 + ((k as f64 + 0.5) / rate * HZ) as u64).collect();
    // Whole electrical periods of four full steps, in the second half.
    let period = 4.0 / full_steps_s;
    let (from, to) = (0.02, 0.02 + (0.035 / period).floor().max(1.0) * period);
    let mut speeds = vec![];
    let mut observer = Each(|plant: &Plant| {
        let t = plant.cycle() as f64 / HZ;
        if t >= from && t <= to {
            speeds.push((t, plant.state(0).expect("a motor").w));
        }
    });
    for record in records(&[rises], 1) {
        if record.cycle.0 as f64 / HZ <= to {
            plant.record(record, &mut observer);
        }
    }
    let ((t_0, w_0), (t_1, w_1)) = (speeds[0], speeds[speeds.len() - 1]);
    let (inertia, g) = (1e9 * 1e-7, 1.8_f64.to_radians());
    inertia * (w_1 - w_0) * g / (t_1 - t_0) * 1e3
}

/// The curve of torque.md in mN*m for the default motor at 24 V: the maximum over all currents up to 1.5 A and voltages up
/// to 24 V.
fn curve(rate: f64) -> f64 {
    let k = 0.4 / (SQRT_2 * 1.5);
    let w = rate / 16.0 * 1.8_f64.to_radians();
    let (r, x) = (1.6, 50.0 * w * 4.3e-3);
    let mut most = f64::MIN;
    for degrees in 0..36_000 {
        let (s, c) = (f64::from(degrees) * 0.01_f64.to_radians()).sin_cos();
        // The full current, if the voltage is sufficient.
        let (i_re, i_im) = (1.5 * c, 1.5 * s);
        let (v_re, v_im) = (k * w + r * i_re - x * i_im, r * i_im + x * i_re);
        if v_re.hypot(v_im) <= 24.0 {
            most = most.max(k * i_re);
        }
        // The full voltage, if the current is within its limit.
        let (u_re, u_im) = (24.0 * c - k * w, 24.0 * s);
        let z = r * r + x * x;
        let (i_re, i_im) = ((u_re * r + u_im * x) / z, (u_im * r - u_re * x) / z);
        if i_re.hypot(i_im) <= 1.5 {
            most = most.max(k * i_re);
        }
    }
    most * 1e3
}

#[test]
fn torque_is_static_below_the_corner_speed_and_a_square_waves_above() {
    let ratio = |rate: f64| {
        let mut best = f64::MIN;
        for lag in 0..80 {
            best = best.max(torque(rate, f64::from(lag) * 0.025));
        }
        best / curve(rate)
    };
    for rate in [1000.0, 8000.0, 19_200.0, 30_945.0] {
        near(ratio(rate), 0.995, 0.015);
    }
    for (rate, expected) in [(40_000.0, 1.05), (60_000.0, 1.21), (100_000.0, 1.28)] {
        near(ratio(rate), expected, 0.02);
    }
}

/// Motors of usual sizes, for which the default grid is fine enough.
fn motors() -> impl Strategy<Value = MotorModel> {
    let electrical = (0.5..4.0, 0.5..5.0, 1.0..10.0);
    let mechanical = (100.0..1000.0, 20.0..300.0, 0.0..300.0, prop::sample::select(vec![0.9, 1.8, 3.6, 7.5]));
    (electrical, mechanical).prop_map(|((current, ohm, mh), (holding, rotor, load, full_step_deg))| {
        MotorModel {
            rated_current_a: current,
            peak_current_a: current,
            resistance_ohm: ohm,
            inductance_mh: mh,
            holding_torque_mn_m: holding,
            rotor_inertia_g_cm2: rotor,
            load_inertia_g_cm2: load,
            full_step_deg,
            ..MotorModel::default()
        }
    })
}

/// With a supply voltage that never limits the current.
fn held(motor: MotorModel) -> Setup {
    Setup { supply: Supply { supply_v: 900.0, ..Supply::default() }, ..one(motor) }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn a_current_rises_with_the_time_constant_of_its_winding(motor in motors(), supply_v in 5.0..60.0) {
        // The rotor is at standstill. The supply is too weak for the target, so the phase has its full voltage.
        let motor = MotorModel { rotor_inertia_g_cm2: 1e9, peak_current_a: 1000.0, ..motor };
        let (r, l) = (motor.resistance_ohm, motor.inductance_mh / 1000.0);
        let setup = Setup { supply: Supply { supply_v, ..Supply::default() }, ..one(motor) };
        let mut plant = Plant::new(&setup).expect("it holds");
        let state = *plant.state(0).expect("a motor");
        plant.set_state(0, State { i_a: 0.0, i_b: 0.0, ..state });
        plant.advance(16_000, &mut ());
        let expected = supply_v / r * (1.0 - (-r / l * 1e-3).exp());
        let found = plant.state(0).expect("a motor").i_a;
        prop_assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    }

    #[test]
    fn a_held_rotor_oscillates_at_its_natural_frequency(motor in motors(), viscous in 100.0..1000.0) {
        let motor = MotorModel { friction_mn_m: 0.0, viscous_un_m_s: viscous, ..motor };
        let natural = Natural::of(&motor);
        prop_assume!(natural.damping_ratio < 0.1);
        let (rises, peaks) = periods(&rings(&held(motor), 0.001, 4_800_000));
        prop_assume!(peaks.len() >= 4);
        let (rises, peaks) = (&rises[..4], &peaks[..3]);
        let found = 3.0 / (rises[3] - rises[0]) * 200_000.0;
        let z = natural.damping_ratio;
        prop_assert!((found / (natural.frequency_hz * (1.0 - z * z).sqrt()) - 1.0).abs() < 1e-3, "{found} {natural:?}");
        let decrement = (peaks[0] / peaks[2]).ln() / 2.0;
        prop_assert!((decrement / (TAU * z / (1.0 - z * z).sqrt()) - 1.0).abs() < 0.01, "{decrement} {z}");
    }

    #[test]
    fn a_load_turns_the_rotor_by_the_arcsine_of_the_torque_ratio(motor in motors(), part in 0.05..0.9_f64) {
        let peak = motor.holding_torque_mn_m / SQRT_2;
        let motor = MotorModel { friction_mn_m: 0.0, gravity_torque_mn_m: part * peak, ..motor };
        let plant = Plant::new(&held(motor)).expect("it holds");
        let found = plant.state(0).expect("a motor").x;
        prop_assert!((found + f64::asin(part) / FRAC_PI_2).abs() < 1e-9, "{found}");
    }

    #[test]
    fn friction_determines_how_far_a_rotor_coasts(motor in motors(), w in 20.0..300.0) {
        let motor = MotorModel { friction_mn_m: 20.0, viscous_un_m_s: 0.0, ..motor };
        let g = motor.full_step_deg.to_radians();
        let inertia = (motor.rotor_inertia_g_cm2 + motor.load_inertia_g_cm2) * 1e-7;
        let mut plant = Plant::new(&held(motor)).expect("it holds");
        plant.record(Record { cycle: Instant(0), levels: Levels(Levels::RX | Levels::TX) }, &mut ());
        plant.set_state(0, State { w, ..State::default() });
        plant.advance(16_000_000, &mut ());
        let expected = inertia * w * w * g / (2.0 * 0.02);
        prop_assume!(inertia * w * g / 0.02 < 0.9);
        let found = plant.state(0).expect("a motor").x;
        // It stops within one grid step.
        prop_assert!((found - expected).abs() <= 1e-5 * w + 1e-9 * expected, "{found} {expected}");
    }

    #[test]
    fn two_masses_oscillate_at_both_roots_of_their_equation(motor in motors(), n_m_rad in 5.0..50.0, load in 50.0..500.0) {
        let motor = MotorModel {
            friction_mn_m: 0.0, viscous_un_m_s: 0.0, load_inertia_g_cm2: load, coupling_n_m_rad: Some(n_m_rad), ..motor
        };
        let pole_pairs = 90.0 / motor.full_step_deg;
        let field = pole_pairs * motor.holding_torque_mn_m / 1000.0 / SQRT_2;
        let (j, j_l) = (motor.rotor_inertia_g_cm2 * 1e-7, load * 1e-7);
        // j*j_l*s^2 - (j*C + j_l*(field + C))*s + C*field = 0, s the square of the angular frequency.
        let (a, b, c) = (j * j_l, j * n_m_rad + j_l * (field + n_m_rad), n_m_rad * field);
        let low = ((b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)).sqrt() / TAU;
        let high = ((b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)).sqrt() / TAU;
        prop_assume!(high / low > 1.5 && high < 2000.0 && low > 20.0);
        let positions = rings(&held(motor), 0.001, 16_000_000);
        for expected in [low, high] {
            let found = frequency(&positions, expected);
            prop_assert!((found / expected - 1.0).abs() < 0.003, "{found} {expected}");
        }
    }

    #[test]
    fn energy_is_conserved(
        motor in motors(), rate in 100.0..3000.0, detent in 0.0..0.1, gravity in -0.2..0.2, sine in 0.0..0.1,
        coupled: bool, buffer: bool, off: bool,
    ) {
        let holding = motor.holding_torque_mn_m;
        let motor = MotorModel {
            detent_torque_mn_m: detent * holding,
            gravity_torque_mn_m: gravity * holding,
            sine_torque_mn_m: sine * holding,
            load_inertia_g_cm2: motor.load_inertia_g_cm2 + 50.0,
            coupling_n_m_rad: coupled.then_some(20.0),
            coupling_un_m_s: 200.0,
            microsteps: 4,
            ..motor
        };
        let supply = Supply { supply_v: 48.0, buffer_uf: buffer.then_some(470.0), ..Supply::default() };
        // The strongest of these motors have an error of 2e-5 on a grid of 5 us.
        let setup = Setup { supply, step_cycles: Some(40), ..one(motor) };
        let mut records = records(&[(1..200).map(|k| k * (16e6 / rate) as u64).collect()], 16);
        if off {
            let half = records.len() / 2;
            records.truncate(half);
            let last = records[half - 1];
            records.push(Record { cycle: Instant(last.cycle.0 + 50), levels: Levels(last.levels.0 & !Levels::EN) });
        }
        let end = records[records.len() - 1].cycle.0 + 160_000;
        let Ok(_) = Plant::new(&setup) else { return Ok(()) };
        let plant = run(&setup, &records, end, &mut ());
        let energy = plant.energy(0).expect("a motor");
        prop_assert!(energy.error() < if coupled { 1e-4 } else { 1e-5 }, "{} {energy:?}", energy.error());
    }

    #[test]
    fn slices_do_not_change_the_result(motor in motors(), rate in 50.0..20_000.0, chop: bool, cuts in prop::collection::vec(1_u64..900_000, 0..40)) {
        let mut motor = MotorModel { microsteps: 8, ..motor };
        if chop {
            motor.drive.regulator = stepscope_plant::parameters::CurrentControl::Chopper;
        }
        let setup = one(motor);
        let Ok(mut sliced) = Plant::new(&setup) else { return Ok(()) };
        let records = records(&[(1..400).map(|k| 100 + (k as f64 * 16e6 / rate) as u64).filter(|&c| c < 800_000).collect()], 3);
        let whole = run(&setup, &records, 900_000, &mut ());
        let mut cuts = cuts;
        cuts.sort_unstable();
        let mut cuts = cuts.into_iter().peekable();
        for &record in &records {
            while let Some(cut) = cuts.next_if(|&cut| cut <= record.cycle.0) {
                sliced.advance(cut, &mut ());
            }
            sliced.record(record, &mut ());
        }
        sliced.advance(900_000, &mut ());
        prop_assert_eq!(sliced.digest(), whole.digest());
        prop_assert_eq!(sliced.state(0), whole.state(0));
    }
}

#[test]
fn integration_is_second_order_and_accurate_at_5_us() {
    // The same oscillation on grids of 5 us, of half of it, and of a sixteenth, which represents the continuous one.
    let ringing = |step_cycles: u32| {
        let motor = MotorModel { friction_mn_m: 0.0, ..full_steps() };
        let mut plant =
            Plant::new(&Setup { step_cycles: Some(step_cycles), ..one(motor) }).expect("it holds");
        let state = *plant.state(0).expect("a motor");
        plant.set_state(0, State { x: 0.5, ..state });
        let mut positions = vec![];
        let mut observer = Each(|plant: &Plant| {
            if plant.cycle().is_multiple_of(160) {
                positions.push(plant.state(0).expect("a motor").x);
            }
        });
        plant.advance(480_000, &mut observer);
        positions
    };
    let [coarse, middle, fine] = [80, 40, 5].map(ringing);
    let off = |positions: &[f64]| positions.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("{} {}", off(&coarse), off(&middle));
    assert!(off(&coarse) < 2e-4);
    assert!(off(&coarse) > 3.0 * off(&middle), "halving the step quarters the error");
}
