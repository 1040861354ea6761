//! The rows of F10 that need edges only; those with motions and scenarios are in `tests/tests/plant.rs`.

use crate::common::{
    Each, T_STEP, frictionless, full_steps, near, near_part, one, patent_plant, records, run, with_sensor,
};
use stepscope_plant::{
    Observer, Plant, Slip,
    measures::{Measures, MotorResult},
    parameters::{CurrentControl, CurrentDecay, DriverModel, MotorModel, Protection, Setup, Supply},
    rates::{self, RAMP_STEPS_S2, Search},
    settling::{Deviation, Sample, SensorLog, StepResponse},
    stability::Natural,
};

/// 16 MHz.
const HZ: f64 = 16e6;

#[test]
fn natural_frequency_of_the_default_motor() {
    near_part(Natural::of(&MotorModel::default()).frequency_hz, 282.14, 0.0002);
}

#[test]
fn a_rotor_settles_where_its_torque_balances_gravity() {
    for (gravity, expected) in [(50.0, -0.113_134), (150.0, -0.355_864), (250.0, -0.690_160)] {
        let motor = MotorModel { friction_mn_m: 0.0, gravity_torque_mn_m: gravity, ..MotorModel::default() };
        let mut plant = Plant::new(&one(motor)).expect("it holds");
        near(plant.state(0).expect("a motor").x, expected, 1e-6);
        plant.advance(1_600_000, &mut ());
        near(plant.state(0).expect("a motor").x, expected, 1e-6);
    }
}

/// A default motor in full steps with a locked rotor, on a grid of 4 cycles.
fn locked() -> Setup {
    let motor = MotorModel { rotor_inertia_g_cm2: 1e9, ..full_steps() };
    Setup { step_cycles: Some(4), ..one(motor) }
}

#[test]
fn current_of_a_locked_rotor_reverses_in_its_inductive_time() {
    let mut arrived = None;
    let mut observer = Each(|plant: &Plant| {
        if plant.cycle() > 1600 && plant.state(0).expect("a motor").i_a < -1.0606 {
            arrived.get_or_insert(plant.cycle() - 1600);
        }
    });
    run(&locked(), &records(&[vec![1600]], 16), 32_000, &mut observer);
    near_part(arrived.expect("it arrives") as f64 / HZ * 1e3, 0.3807, 0.003);
}

#[test]
fn the_supply_current_dips_and_peaks_while_a_phase_reverses() {
    let mut currents = vec![];
    run(
        &locked(),
        &records(&[vec![1600]], 16),
        32_000,
        &mut Each(|plant: &Plant| currents.push(plant.supply_a())),
    );
    near_part(currents[100], 0.150, 0.01);
    let after = currents.iter().copied();
    near_part(after.clone().fold(f64::INFINITY, f64::min), -0.986, 0.01);
    near_part(after.fold(f64::NEG_INFINITY, f64::max), 1.136, 0.01);
    near_part(currents[399 + 1], -0.986, 0.01);
}

fn search(mut holds: impl FnMut(f64) -> bool) -> f64 {
    let mut search = Search::default();
    while let Some(rate) = search.rate() {
        search.report(holds(rate));
    }
    search.found().expect("a rate holds")
}

#[derive(Default)]
struct Slips(Vec<Slip>);

impl Observer for Slips {
    fn point(&mut self, _: &Plant) {}
    fn slip(&mut self, _: usize, slip: Slip) {
        self.0.push(slip);
    }
}

#[test]
fn without_friction_a_motor_starts_at_eight_natural_frequencies() {
    for (supply_v, expected) in [(24.0, 35_943.0), (240.0, 36_089.0)] {
        let setup = Setup { supply: Supply { supply_v, ..Supply::default() }, ..one(frictionless()) };
        let found = search(|rate| {
            let rises: Vec<u64> = rates::even(16_000_000, rate, 3200).collect();
            let end = rises[3199];
            let mut slips = Slips::default();
            run(&setup, &records(&[rises], 16), end, &mut slips);
            slips.0.is_empty()
        });
        near_part(found, expected, 0.01);
    }
}

/// 3200 steps at a constant rate from standstill, and 0.2 s.
fn direct_start(motor: MotorModel, rate: f64) -> MotorResult {
    let rises: Vec<u64> = rates::even(16_000_000, rate, 3200).collect();
    let end = rises[3199] + 3_200_000;
    let setup = one(motor);
    let mut measures = Measures::new(&Plant::new(&setup).expect("it holds"));
    let plant = run(&setup, &records(&[rises], 16), end, &mut measures);
    measures.result(&plant).motors.remove(0)
}

#[test]
fn a_direct_start_overshoots_and_rings() {
    for (rate, overshoot, settling_ms) in [(8000.0, 0.265, 12.1), (19_200.0, 0.676, 26.5)] {
        let result = direct_start(MotorModel::default(), rate);
        assert_eq!((result.lost, result.slips.len()), (0, 0));
        near_part(result.overshoot.expect("it stepped"), overshoot, 0.02);
        near_part(result.settling.expect("it stepped") as f64 / HZ * 1e3, settling_ms, 0.02);
        near(result.energy.error(), 0.0, 1e-6);
    }
}

#[test]
fn a_direct_start_with_a_load_stalls() {
    let result = direct_start(MotorModel { load_inertia_g_cm2: 200.0, ..MotorModel::default() }, 19_200.0);
    assert_eq!(result.lost, 188);
    near(result.slips[0].cycle as f64 / HZ * 1e3, 2.81, 0.02);
    assert!(result.slips[0].is_behind);
    near(result.energy.error(), 0.0, 1e-6);
}

#[test]
fn start_stop_rates() {
    let load = |load_torque_mn_m| MotorModel { load_torque_mn_m, ..MotorModel::default() };
    let heavy = MotorModel { load_inertia_g_cm2: 200.0, ..MotorModel::default() };
    for (motor, expected) in [
        (MotorModel::default(), 34_700.0),
        (load(100.0), 24_500.0),
        (load(200.0), 12_970.0),
        (heavy, 14_220.0),
    ] {
        let setup = one(motor);
        near_part(search(|rate| rates::starts(&setup, rate, 3200).expect("it holds")), expected, 0.015);
    }
}

#[test]
fn pull_out_rates() {
    for (load_torque_mn_m, expected, part) in
        [(200.0, 46_900.0, 0.01), (250.0, 34_600.0, 0.01), (100.0, 53_200.0, 0.02), (0.0, 121_000.0, 0.02)]
    {
        let setup = one(MotorModel { load_torque_mn_m, ..MotorModel::default() });
        near_part(
            search(|rate| rates::pulls(&setup, rate, RAMP_STEPS_S2).expect("it holds")),
            expected,
            part,
        );
    }
}

#[test]
fn resonance_of_full_half_and_sixteenth_steps() {
    let at = |microsteps: u16, full_steps_s: f64| {
        let setup = one(MotorModel { friction_mn_m: 20.0, microsteps, ..MotorModel::default() });
        rates::resonance(&setup, full_steps_s * f64::from(microsteps)).expect("it holds")
    };
    let rungs = || (5..=100).map(|rung| 4.0 * f64::from(rung));
    let loses: Vec<f64> = rungs().filter(|&rate| at(1, rate).loses_steps).collect();
    println!("{loses:?}");
    near(loses[0], 208.0, 4.0);
    near(loses[loses.len() - 1], 252.0, 4.0);
    assert!(loses.windows(2).all(|pair| pair[1] - pair[0] == 4.0), "{loses:?}");
    let (peak, swing) = rungs()
        .map(|rate| (rate, at(2, rate).peak_to_peak))
        .fold((0.0, 0.0), |most, rung| if rung.1 > most.1 { rung } else { most });
    near(peak, 120.0, 4.0);
    near(swing, 1.96, 0.05);
    for rate in rungs() {
        let found = at(16, rate);
        assert!(found.peak_to_peak < 0.05 && !found.loses_steps, "{rate}: {found:?}");
    }
}

fn sensor_log(setup: &Setup, rises: &[Vec<u64>], cycles: u64) -> SensorLog {
    let mut log = SensorLog::default();
    run(setup, &records(rises, 16), cycles, &mut log);
    log
}

/// One step of a motor after ten T_step at standstill, `after` cycles after a grid point.
fn one_step(setup: &Setup, after: u64) -> StepResponse {
    let rise = 12 * T_STEP / 80 * 80 + after;
    let log = sensor_log(setup, &[vec![rise]], rise + 2 * T_STEP);
    StepResponse::of(&log.samples, rise - 10 * T_STEP, rise, T_STEP, 0.2).expect("there are samples")
}

#[test]
fn one_step_reproduces_the_patents_figure_1() {
    for position in [0, 1, 20, 40, 79] {
        let found = one_step(&patent_plant(1), position);
        near_part(found.rest_a, 0.2167, 0.01);
        near_part(found.min_a, -0.481, 0.01);
        near(found.max_a, 0.922, 0.017);
        near(found.reached.expect("it falls") as f64 / HZ * 1e3, 0.515, 0.006);
        near(found.settled.expect("it settles") as f64 / HZ * 1e3, 0.512, 0.008);
    }
}

/// Four motors, ten steps each, simultaneous and staggered.
fn deviations(setup: &Setup) -> [Deviation; 2] {
    [0, 8192].map(|apart| {
        let first = 12 * T_STEP;
        let rises = |channel: u64| (0..10).map(|k| first + k * T_STEP + channel * apart).collect();
        let rises: Vec<Vec<u64>> = (0..4).map(rises).collect();
        let log = sensor_log(setup, &rises, first + 11 * T_STEP);
        let found = Deviation::of(&log.samples, first, log.steps[4]).expect("there are samples");
        let mut measures = Measures::new(&Plant::new(setup).expect("it holds"));
        let plant = run(setup, &records(&rises, 16), first + 11 * T_STEP, &mut measures);
        let measured = measures.result(&plant).deviation.expect("there are eight steps");
        near(measured.above_a, found.above_a, 1e-6);
        near(measured.below_a, found.below_a, 1e-6);
        found
    })
}

#[test]
fn four_motors_reproduce_the_patents_figure_2() {
    let [together, staggered] = deviations(&patent_plant(4));
    println!("{together:?} {staggered:?}");
    near(together.above_a, 3.16, 0.03);
    near(together.below_a, 2.96, 0.03);
    near(staggered.above_a, 1.07, 0.02);
    near(staggered.below_a, 0.81, 0.02);
    near(together.max_a() / staggered.max_a(), 2.96, 0.05);
}

#[test]
fn the_default_motor_has_nearly_the_same_peak_ratio() {
    let setup = Setup { motors: vec![full_steps(); 4], ..Setup::default() };
    let [together, staggered] = deviations(&setup);
    near(together.max_a() / staggered.max_a(), 2.92, 0.04);
    let step = one_step(&one(full_steps()), 0);
    near_part(step.reached.expect("it falls") as f64 / HZ * 1e3, 1.19, 0.01);
    assert_eq!(step.settled, None);
}

/// The cycle of the first overload with motors that step `apart` cycles after each other.
fn overload(apart: u64) -> Option<u64> {
    let setup =
        Setup { motors: vec![full_steps(); 4], protection: Some(Protection::default()), ..Setup::default() };
    let rises = |channel: u64| (1..=4).map(|k| 1600 + k * T_STEP + channel * apart).collect();
    let rises: Vec<Vec<u64>> = (0..4).map(rises).collect();
    let mut found = None;
    let mut observer = Each(|plant: &Plant| {
        if plant.events().overload {
            found.get_or_insert(plant.cycle());
        }
    });
    run(&with_sensor(setup, 5000.0), &records(&rises, 16), 400_000, &mut observer);
    found
}

#[test]
fn four_simultaneous_steps_overload_the_supply_unless_staggered() {
    near(overload(0).expect("an overload") as f64, 39_280.0, 160.0);
    assert_eq!(overload(8192), None);
}

fn chopped(decay: CurrentDecay) -> DriverModel {
    DriverModel { regulator: CurrentControl::Chopper, decay, ..DriverModel::default() }
}

#[test]
fn chopper_at_standstill() {
    for (decay, mean, khz, swing) in
        [(CurrentDecay::Slow, 1.058, 46.5, None), (CurrentDecay::Mixed(0.31), 1.033, 35.8, Some(0.046))]
    {
        let setup = one(MotorModel { drive: chopped(decay), ..MotorModel::default() });
        let mut currents = vec![];
        run(
            &setup,
            &[],
            1_600_000,
            &mut Each(|plant: &Plant| currents.push(plant.state(0).expect("a motor").i_a)),
        );
        let late = &currents[20_000..];
        near_part(late.iter().sum::<f64>() / late.len() as f64, mean, 0.005);
        let (min, most) = late.iter().fold((9.0_f64, 0.0_f64), |(l, m), &i| (l.min(i), m.max(i)));
        // Each period has one maximum.
        let turns = late.windows(3).filter(|w| w[1] > w[0] && w[1] >= w[2]).count();
        near_part(turns as f64 / (late.len() as f64 / 1e6) / 1e3, khz, 0.01);
        if let Some(swing) = swing {
            near_part(most - min, swing, 0.03);
        }
    }
}

#[test]
fn small_currents_do_not_decay_slowly() {
    let rows = [
        (DriverModel::default(), -0.0004, -0.0004),
        (chopped(CurrentDecay::Mixed(0.31)), -0.0093, 0.0084),
        (chopped(CurrentDecay::Slow), -0.284, 0.158),
    ];
    for (drive, min, most) in rows {
        let motor =
            MotorModel { friction_mn_m: 0.0, viscous_un_m_s: 30_000.0, drive, ..MotorModel::default() };
        let rises: Vec<u64> = (1..=129).map(|k| k * 160_000).collect();
        let mut plant = Plant::new(&one(motor)).expect("it holds");
        let mut errors = vec![];
        for (index, &record) in records(&[rises], 16).iter().enumerate() {
            plant.advance(record.cycle.0, &mut ());
            // Each pulse has two records.
            if index % 2 == 0 && index / 2 + 1 >= 64 {
                errors.push(plant.state(0).expect("a motor").x - plant.command(0));
            }
            plant.record(record, &mut ());
        }
        assert_eq!(errors.len(), 66);
        let (found_least, found_most) =
            errors.iter().fold((9.0_f64, -9.0_f64), |(l, m), &e| (l.min(e), m.max(e)));
        near_part(found_least, min, 0.2);
        near_part(found_most, most, 0.2);
    }
}

#[test]
fn known_samples_have_their_settling_time() {
    let sample = |cycle: u64, current| Sample { cycle, current };
    let rest = (0..10).map(|k| sample(k * 10, 1.0));
    let after = [(100, 0.5), (110, 3.0), (120, 1.5), (130, 1.3), (140, 0.5), (150, 1.1)];
    let samples: Vec<Sample> = rest.chain(after.map(|(c, i)| sample(c, i))).collect();
    let found = StepResponse::of(&samples, 0, 95, 60, 0.2).expect("samples");
    assert_eq!((found.rest_a, found.min_a, found.max_a), (1.0, 0.5, 3.0));
    assert_eq!((found.reached, found.settled), (Some(35), Some(45)));
    let cut = StepResponse::of(&samples, 0, 95, 45, 0.2).expect("samples");
    assert_eq!((cut.reached, cut.settled), (Some(35), None), "the last one is still off");
    assert_eq!(StepResponse::of(&samples, 0, 95, 4, 0.2), None, "no sample after the rise");
    // A constant current does not settle, in whole codes or not.
    for current in [0.0, 7.0, 0.1, 0.15 + 1e-17] {
        let constant: Vec<Sample> = (0..1003).map(|k| sample(k * 10, current)).collect();
        let found = StepResponse::of(&constant, 0, 5000, 5000, 0.2).expect("samples");
        assert_eq!((found.rest_a, found.reached, found.settled), (current, None, None));
    }
    // Neither does a current that returns only after T_step.
    let late: Vec<Sample> = (0..20).map(|k| sample(k * 10, if k < 10 { 1.0 } else { 2.0 })).collect();
    let found = StepResponse::of(&late, 0, 95, 50, 0.2).expect("samples");
    assert_eq!((found.reached, found.settled), (None, None));
}

#[test]
fn overshoot_is_unknown_until_the_first_grid_point_after_a_step() {
    let mut plant = Plant::new(&locked()).expect("a valid setup");
    let mut measures = Measures::new(&plant);
    for record in records(&[vec![1600]], 16) {
        plant.record(record, &mut measures);
        if record.cycle.0 == 1600 {
            assert_eq!(measures.result(&plant).motors[0].overshoot, None);
        }
    }
    plant.advance(1604, &mut measures);
    let overshoot = measures.result(&plant).motors[0].overshoot.expect("a grid point follows the step");
    assert!(overshoot < 0.0, "{overshoot}: the rotor has not arrived");
}
