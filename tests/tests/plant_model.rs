//! Compares the plant with an independent model (PLANT.md F1 to F8): for random motors, drivers, supplies, sensors and edges,
//! every point, code, slip and digest is the same to the bit, however the run is divided.

use stepscope_core::{
    peripheral::{
        signal::{Levels, Record},
        units::Instant,
    },
    plant::{
        Observer, Plant, Slip,
        parameters::{
            CurrentControl, CurrentDecay, DriverModel, Encoder, MotorModel, Protection, SensorChain, Setup,
            Supply,
        },
    },
};
use stepscope_tests::plant_oracle::{self as oracle, Case, Run, is_refused};

/// Number of random cases, unless `PROPTEST_CASES` sets another.
const CASES: u64 = 150;

fn cases() -> u64 {
    std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(CASES)
}

fn drive(given: &oracle::Drive) -> DriverModel {
    DriverModel {
        regulator: match given.regulator {
            oracle::Regulator::Averaged => CurrentControl::Averaged,
            oracle::Regulator::Chopper => CurrentControl::Chopper,
        },
        decay: match given.decay {
            oracle::Decay::Slow => CurrentDecay::Slow,
            oracle::Decay::Fast => CurrentDecay::Fast,
            oracle::Decay::Mixed(share) => CurrentDecay::Mixed(share),
            oracle::Decay::Auto(share) => CurrentDecay::Auto(share),
        },
        off_us: given.off_us,
        blank_us: given.blank_us,
        dac_levels: given.dac_levels.map(|levels| u16::try_from(levels).expect("levels of a DAC")),
        bridge_ohm: given.bridge_ohm,
        diode_v: given.diode_v,
    }
}

fn motor(given: &oracle::Motor) -> MotorModel {
    MotorModel {
        full_step_deg: given.full_step_deg,
        microsteps: u16::try_from(given.microsteps).expect("microsteps"),
        rated_current_a: given.rated_current_a,
        peak_current_a: given.peak_current_a.unwrap_or(given.rated_current_a),
        resistance_ohm: given.resistance_ohm,
        inductance_mh: given.inductance_mh,
        holding_torque_mn_m: given.holding_torque_mn_m,
        rotor_inertia_g_cm2: given.rotor_inertia_g_cm2,
        load_inertia_g_cm2: given.load_inertia_g_cm2,
        load_torque_mn_m: given.load_torque_mn_m,
        friction_mn_m: given.friction_mn_m,
        stiction_mn_m: given.stiction_mn_m,
        viscous_un_m_s: given.viscous_un_m_s,
        detent_torque_mn_m: given.detent_torque_mn_m,
        gravity_torque_mn_m: given.gravity_torque_mn_m,
        sine_torque_mn_m: given.sine_torque_mn_m,
        sine_per_turn: given.sine_per_turn,
        sine_phase_deg: given.sine_phase_deg,
        coupling_n_m_rad: given.coupling_n_m_rad,
        coupling_un_m_s: given.coupling_un_m_s,
        drive: drive(&given.drive),
    }
}

fn setup(case: &Case) -> Setup {
    let given = &case.plant;
    let sensor = &given.current_sensor;
    let whole = |number: u64| u32::try_from(number).expect("a number of 32 bits");
    let motors: Vec<&oracle::Motor> =
        case.motors.iter().map(|motor| motor.as_ref().expect("each channel has a motor")).collect();
    Setup {
        clock_hz: whole(case.clock_hz),
        step_cycles: given.step_cycles.map(whole),
        supply: Supply {
            supply_v: motors.first().map_or(24.0, |motor| motor.supply_v),
            source_ohm: given.source_ohm,
            buffer_uf: given.buffer_uf,
            source_sinks: given.source_sinks,
            idle_ma: given.idle_ma,
        },
        current_sensor: SensorChain {
            bandwidth_hz: sensor.bandwidth_hz,
            poles: sensor.poles as u8,
            adc_steps: whole(sensor.adc_steps),
            lsb: sensor.lsb_a,
            adc_max: sensor.adc_max,
        },
        encoder: Encoder {
            period_steps: whole(given.encoder.period_steps),
            offset_lsb: given.encoder.offset_lsb,
            noise_lsb: given.encoder.noise_lsb,
            hysteresis_lsb: given.encoder.hysteresis_lsb,
            seed: given.encoder.seed,
        },
        accelerometer: None,
        protection: given
            .protection
            .as_ref()
            .map(|given| Protection { threshold_a: given.threshold_a, samples: given.samples }),
        motors: motors.into_iter().map(motor).collect(),
    }
}

/// Compares each point with the model's.
struct Held<'r> {
    run: &'r Run,
    points: usize,
    supply_codes: Vec<(u64, i64)>,
    encoder_codes: Vec<Vec<(u64, u16)>>,
    slips: Vec<Vec<(u64, i64)>>,
    overload: Option<u64>,
}

impl<'r> Held<'r> {
    fn new(run: &'r Run, motors: usize) -> Self {
        Self {
            run,
            points: 1,
            supply_codes: Vec::new(),
            encoder_codes: vec![Vec::new(); motors],
            slips: vec![Vec::new(); motors],
            overload: None,
        }
    }
}

impl Observer for Held<'_> {
    fn point(&mut self, plant: &Plant) {
        let (cycle, expected) = (plant.cycle(), &self.run.points[self.points]);
        self.points += 1;
        assert_eq!((cycle, plant.is_powered()), (expected.cycle, expected.en));
        let supply = [plant.supply_v(), plant.supply_a(), plant.current_sensor().filtered()];
        assert_eq!(
            supply.map(f64::to_bits),
            [expected.v, expected.i_load, expected.sensed_a].map(f64::to_bits),
            "supply in {cycle}: {supply:?}, {expected:?}"
        );
        for (channel, expected) in expected.motors.iter().enumerate() {
            let found = plant.state(channel).expect("a motor");
            let all = [found.x, found.w, found.i_a, found.i_b, found.x_load, found.w_load];
            let of_oracle = [expected.x, expected.w, expected.i_a, expected.i_b, expected.x_l, expected.w_l];
            assert_eq!(all.map(f64::to_bits), of_oracle.map(f64::to_bits), "motor {channel} in {cycle}");
            assert_eq!(plant.lost(channel), expected.lost, "lost steps of motor {channel} in {cycle}");
        }
        let events = plant.events();
        if events.converted {
            self.supply_codes.push((cycle, plant.current_sensor().code().into()));
        }
        if events.encoded {
            for (channel, codes) in self.encoder_codes.iter_mut().enumerate() {
                codes.push((cycle, plant.encoder(channel)));
            }
        }
        if events.overload {
            self.overload = self.overload.or(Some(cycle));
        }
    }

    fn slip(&mut self, channel: usize, slip: Slip) {
        self.slips[channel].push((slip.cycle, if slip.is_behind { 1 } else { -1 }));
    }
}

/// A motor on every channel, as in the plant of the crate.
fn filled(mut case: Case) -> Case {
    let first = case.motors.iter().flatten().next().cloned().unwrap_or_default();
    case.motors.iter_mut().for_each(|motor| {
        motor.get_or_insert(first.clone());
    });
    case
}

/// Whether a rotor has moved further than any real one. F3's limits do not include the stiffness of a torque that depends on
/// the load angle; if it is too large for the grid, it accelerates the rotor without limit, and values end as NaN.
fn has_flown_away(run: &Run) -> bool {
    run.points.iter().any(|point| point.motors.iter().any(|motor| motor.x.is_nan() || motor.x.abs() > 1e9))
}

/// Runs a case, and checks the time every given number of cycles between its records.
fn check(case: &Case, run: &Run, every: u64, what: &str) {
    let setup = setup(case);
    let mut plant = Plant::new(&setup).unwrap_or_else(|refused| panic!("{what} is refused: {refused:?}"));
    let mut held = Held::new(run, setup.motors.len());
    let mut now = 0;
    for &(cycle, levels) in &case.records {
        while every > 0 && now + every < cycle {
            now += every;
            plant.advance(now, &mut held);
        }
        if cycle > 0 {
            plant.record(Record { cycle: Instant(cycle), levels: Levels(levels) }, &mut held);
        }
    }
    plant.advance(case.cycles, &mut held);
    assert_eq!(held.points, run.points.len(), "{what}");
    assert_eq!(plant.digest(), run.digest, "{what}");
    assert_eq!(held.supply_codes, run.supply_codes, "{what}");
    assert_eq!(held.encoder_codes, run.encoder_codes, "{what}");
    assert_eq!(held.overload, run.overload, "{what}");
    let slips: Vec<Vec<(u64, i64)>> =
        run.lost.iter().map(|slips| slips.iter().map(|slip| (slip.cycle, slip.sign)).collect()).collect();
    assert_eq!(held.slips, slips, "{what}");
    for (channel, expected) in run.energies.iter().enumerate() {
        let found = plant.energy(channel).expect("a motor");
        let pairs = [
            (found.bus, expected.bus),
            (found.copper, expected.copper),
            (found.diodes, expected.diodes),
            // The crate and the model count the load torque and the coupling's damper under different names.
            (
                found.friction + found.viscous + found.load,
                expected.friction + expected.viscous + expected.load,
            ),
        ];
        for (found, expected) in pairs {
            assert!(
                (found - expected).abs() <= 1e-9 * (1.0 + expected.abs()),
                "motor {channel} of {what}: {pairs:?}"
            );
        }
    }
}

#[test]
fn every_point_matches_the_independent_model() {
    let all = (0..cases()).map(|seed| (seed, filled(oracle::random_case(seed))));
    let mut flown = 0;
    for (seed, case) in all.filter(|(_, case)| is_refused(case).is_none()) {
        let run = oracle::run(&case);
        if has_flown_away(&run) {
            flown += 1;
            continue;
        }
        check(&case, &run, 0, &format!("case {seed}"));
        check(&case, &run, 37 + seed % 1000, &format!("case {seed} in portions"));
    }
    assert!(flown * 50 <= cases(), "{flown} of {} cases flew away", cases());
}

/// F7: ENABLE in cycle p restarts the count of an overload. A conversion in p, the last step of the cycle, counts
/// already; EN rises in p + 1.
#[test]
fn enable_restarts_the_count_of_an_overload() {
    let en = 1 << 32;
    for step_cycles in [1, 2, 80] {
        for rise in (395..410).chain(478..484) {
            let case = Case {
                clock_hz: 16_000_000,
                plant: oracle::Plant {
                    step_cycles: Some(step_cycles),
                    idle_ma: 5000.0,
                    protection: Some(oracle::Protection { threshold_a: 1.0, samples: 10 }),
                    ..oracle::Plant::default()
                },
                motors: vec![Some(oracle::Motor::default())],
                records: vec![(0, en), (100, 0), (rise, en)],
                cycles: 4000,
            };
            let run = oracle::run(&case);
            assert!(run.overload.is_some_and(|cycle| cycle > 100 || step_cycles < 10), "{:?}", run.overload);
            check(&case, &run, 0, &format!("EN rises in {rise}, grid of {step_cycles}"));
            check(&case, &run, 1, &format!("EN rises in {rise}, grid of {step_cycles}, cycle by cycle"));
        }
    }
}

#[test]
fn model_and_core_refuse_the_same_cases() {
    let (mut refused, mut taken) = (0, 0);
    for seed in 0..10 * cases() {
        let case = filled(oracle::drawn_case(seed));
        let (found, expected) = (Plant::new(&setup(&case)), is_refused(&case));
        assert_eq!(found.is_err(), expected.is_some(), "case {seed}: {:?}, {expected:?}", found.err());
        *(if expected.is_some() { &mut refused } else { &mut taken }) += 1;
    }
    assert!(refused > 10 && taken > 10, "{refused} refused, {taken} taken");
}
