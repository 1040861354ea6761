//! Supply current, delta t_p, ratio of the peaks, self-test and overload of F10.

use super::*;
use crate::plant_oracle::edges::self_test_bus;
use crate::plant_oracle::results::{peaks, step_seen};
use crate::plant_oracle::supply::Supply;

#[test]
fn supply_current_of_one_step_of_a_locked_motor() {
    let locked = Motor { microsteps: 1, rotor_inertia_g_cm2: 1e9, ..Motor::default() };
    let mut bus = Bus::default();
    bus.order(1, edges::DIR, true);
    bus.pulse(0, 16_000, 16);
    let run = run(&alone(locked, &bus, 40_000));
    close(run.points[200].i_load, 0.150, 0.0015);
    close(run.points[201].i_load, -0.986, 0.03);
    let arrived = run.points.iter().position(|point| point.motors[0].i_a <= -1.0606).unwrap();
    close((run.points[arrived].cycle - 16_000) as f64 / 16_000.0, 0.3807, 0.006);
    close(run.points[arrived - 1].i_load, 1.136, 0.02);
}

#[test]
fn delta_t_p_of_the_patent_set() {
    let mut bus = Bus::default();
    bus.order(1, edges::DIR, true);
    bus.pulse(0, 1600 + 32_768 * 10, 16);
    let run = run(&alone(patent_motor(), &bus, 1600 + 32_768 * 12));
    let seen = step_seen(&run.sensed_supply(), 1600 + 32_768 * 10, 32_768, 0.2).unwrap();
    close(seen.i_q, 0.2167, 0.002);
    // F10 has the current itself, not its deviation.
    close(seen.i_q + seen.least, -0.481, 0.005);
    close(seen.i_q + seen.greatest, 0.922, 0.012);
    close(seen.reached.unwrap() as f64 / 16_000.0, 0.515, 0.006);
    close(seen.settled.unwrap() as f64 / 16_000.0, 0.512, 0.006);
}

/// Four motors, full steps, this number of cycles per step, each later than the previous by `stagger`.
fn four(motor: Motor, steps: u32, stagger: u64) -> Case {
    let lists: Vec<_> = (0..4)
        .map(|channel| (1600 + channel * stagger, vec![Segment::whole(steps, 32_768, 0, true)]))
        .collect();
    of_equals(
        Motor { microsteps: 1, ..motor },
        4,
        &segment_bus(&lists, 16),
        1600 + 32_768 * u64::from(steps + 2),
    )
}

#[test]
fn staggering_lowers_the_peaks() {
    for (motor, ratio, tolerance) in [(patent_motor(), 2.96, 0.05), (Motor::default(), 2.92, 0.04)] {
        let of = |stagger| {
            let run = run(&four(motor.clone(), 16, stagger));
            peaks(&run.sensed_supply(), run.points[0].sensed_a, 1600 + 5 * 32_768)
        };
        let (together, staggered) = (of(0), of(8192));
        close(together.0 / staggered.0, ratio, tolerance);
        if motor == patent_motor() {
            for (found, expected) in [(together, (3.16, -2.96)), (staggered, (1.07, -0.81))] {
                close(found.1, expected.0, 0.03);
                close(found.2, expected.1, 0.03);
            }
        }
    }
}

#[test]
fn self_test_of_the_patent_set() {
    let step_period = 32_768;
    let bus = self_test_bus(4, step_period, 40, 40);
    let case = of_equals(patent_motor(), 4, &bus, 1 + 4 * 24 * step_period);
    let run = run(&case);
    let series = run.adc_supply(case.plant.current_sensor.lsb_a);
    let dp: Vec<Option<u64>> = (0..4)
        .map(|channel| 1 + channel * 24 * step_period + 10 * step_period)
        .map(|rise| step_seen(&series, rise, step_period, 0.2).unwrap().reached)
        .collect();
    assert_eq!(dp, [Some(8479), Some(8207), Some(8255), Some(8223)]);
}

#[test]
fn overload_occurs_in_cycle_39280_or_never() {
    for (stagger, expected) in [(0, Some(39_280)), (8192, None)] {
        let mut case = four(Motor::default(), 4, stagger);
        case.plant.current_sensor.bandwidth_hz = 5000.0;
        case.plant.protection = Some(Protection { threshold_a: 2.0, samples: 4 });
        assert_eq!(run(&case).overload, expected);
    }
}

#[test]
fn the_bus_has_a_minimum_and_only_a_sinking_source_limits_it() {
    for (source_sinks, i_load, least, most) in
        [(false, 1000.0, 1.5, 1.5), (false, -1.0, 70.0, 80.0), (true, -1.0, 24.09, 24.11)]
    {
        let plant = Plant { buffer_uf: Some(10.0), source_sinks, ..Plant::default() };
        let mut supply = Supply::new(&plant, 24.0, 1, 0.0);
        assert_eq!(supply.v, 24.0);
        for _ in 0..100 {
            supply.advance(i_load, 5e-6);
        }
        assert!((least..=most).contains(&supply.v), "{} V at {i_load} A", supply.v);
    }
}
