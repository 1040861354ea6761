use super::*;
use alloc::format;
use core::f64::consts::PI;
use stepscope_motion::{Curve, Profile, curves::Cosine, moves::Axis, plan_axis};

fn axis(motor: &str, moves: &str) -> Axis {
    stepscope_scenario::part_from_json(&format!(r#"{{"motor":{motor},"moves":[{moves}]}}"#)).unwrap()
}

fn machine(motor: &str) -> Machine {
    Machine::of(&axis(motor, "")).unwrap()
}

fn demand(motor: &str, moves: &str) -> Demand {
    let axis = axis(motor, moves);
    Demand::of(&Machine::of(&axis).unwrap(), &plan_axis(&axis, "axis").unwrap())
}

#[track_caller]
fn close(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} is not {expected}");
}

/// The move of Song 2021: one turn of 3200 steps in 0.4 s with ramps of 0.2 s.
const TURN: &str = r#"{"cosine":{}}"#;

#[test]
fn without_a_motor_there_is_no_report() {
    assert_eq!(Machine::of(&Axis::default()), None);
    let direct = r#"{"mechanics":{"direct":{}},"motor":{}}"#;
    assert_eq!(Machine::of(&stepscope_scenario::part_from_json(direct).unwrap()), None);
}

#[test]
fn up_to_the_corner_torque_is_that_of_the_regulated_current() {
    let motor = machine("{}");
    // One phase at its peak has 1/sqrt(2) of what both have.
    close(motor.available_mn_m(0.0), 400.0 / 2.0_f64.sqrt(), 1e-12);
    let corner = motor.corner_rate().unwrap();
    // (k*w + R*I)^2 + (p*w*L*I)^2 = V^2 with k = 0.18856, p = 50: a quadratic in w.
    let (k, ri, pli) = (0.4 / (2.0_f64.sqrt() * 1.5), 2.4, 50.0 * 4.3e-3 * 1.5);
    let (a, b, c) = (k * k + pli * pli, 2.0 * k * ri, ri * ri - 576.0);
    let speed = ((b * b - 4.0 * a * c).sqrt() - b) / (2.0 * a);
    close(corner, speed * 3200.0 / (2.0 * PI), 1e-12);
    close(motor.available_mn_m(corner * 0.999_999), motor.available_mn_m(0.0), 1e-12);
    assert!(motor.available_mn_m(corner * 1.001) < motor.available_mn_m(0.0));
    // At a peak of sqrt(2) times the rated current the torque is the holding torque.
    let peak = machine(r#"{"peak_current_a":2.121320343559643}"#);
    close(peak.available_mn_m(0.0), 400.0, 1e-12);
    // 2 V through 1.6 ohm are less than 1.5 A.
    let weak = machine(r#"{"supply_v":2}"#);
    assert_eq!(weak.corner_rate(), Some(0.0));
    close(weak.available_mn_m(0.0), k * 1250.0, 1e-12);
}

#[test]
fn far_above_the_corner_torque_equals_the_textbook_formula() {
    let motor = machine("{}");
    for rate in [100_000.0, 250_000.0, 1_000_000.0] {
        let speed: f64 = rate * 2.0 * PI / 3200.0;
        let (k, r, x) = (0.4 / (2.0_f64.sqrt() * 1.5), 1.6, 50.0 * speed * 4.3e-3);
        let z = (r * r + x * x).sqrt();
        close(motor.available_mn_m(rate), 1000.0 * (k * 24.0 / z - k * k * speed * r / (z * z)), 1e-12);
    }
}

/// An independent search: all currents within the limit, by size and angle, whose voltage the supply has.
#[test]
fn available_torque_equals_a_search_over_all_currents() {
    for json in [
        "{}",
        r#"{"supply_v":0.1}"#,
        r#"{"supply_v":12}"#,
        r#"{"resistance_ohm":12,"supply_v":30}"#,
        r#"{"inductance_mh":0.2}"#,
    ] {
        let axis = axis(json, "");
        let motor = axis.motor.clone().unwrap();
        let model = Machine::of(&axis).unwrap();
        let constant = motor.holding_torque_mn_m / 1000.0 / (2.0_f64.sqrt() * motor.rated_current_a);
        let mut last = f64::INFINITY;
        for rate in (0..60).map(|index| 2500.0 * f64::from(index)) {
            let speed = rate * 2.0 * PI / 3200.0;
            let (r, x) = (motor.resistance_ohm, 50.0 * speed * motor.inductance_mh / 1000.0);
            let mut max = f64::NEG_INFINITY;
            for size in 0..=200 {
                for angle in -400..=400 {
                    let current = motor.rated_current_a * f64::from(size) / 200.0;
                    let (sine, cosine) = (libm::sin(PI * f64::from(angle) / 400.0), {
                        libm::cos(PI * f64::from(angle) / 400.0)
                    });
                    let (re, im) = (current * cosine, current * sine);
                    let (v_re, v_im) = (constant * speed + r * re - x * im, r * im + x * re);
                    if v_re * v_re + v_im * v_im <= motor.supply_v * motor.supply_v {
                        max = max.max(1000.0 * constant * re);
                    }
                }
            }
            let found = model.available_mn_m(rate);
            assert!(found >= max - 1e-9, "{json} at {rate}: {found} under {max}");
            // Where no current is allowed, there is no torque to drive with.
            let above = if max.is_finite() { max + 4.0 } else { 0.0 };
            assert!(found <= above, "{json} at {rate}: {found} over {max}");
            // It falls until there is none.
            assert!(found <= last.max(0.0) + 1e-9, "{json}: more at {rate} than below");
            last = found;
        }
    }
}

#[test]
fn needed_is_inertia_times_acceleration_and_the_load_opposes_the_motion() {
    let motor = machine(r#"{"load_inertia_g_cm2":955,"load_torque_mn_m":50}"#);
    // 1000 g*cm^2 = 1e-4 kg*m^2; 1e5 steps/s^2 are 196.35 rad/s^2: 19.635 mN*m.
    let turning = 0.1 * 1e5 * 2.0 * PI / 3200.0;
    for (speed, acceleration, expected) in [
        (100.0, 1e5, 50.0 + turning),
        (100.0, -1e5, 50.0 - turning),
        (-100.0, -1e5, 50.0 + turning),
        (-100.0, 1e5, 50.0 - turning),
        (100.0, 0.0, 50.0),
        (0.0, 1e5, 50.0 + turning),
        (0.0, -1e5, 50.0 + turning),
        (0.0, 0.0, 0.0),
    ] {
        assert!((motor.needed_mn_m(speed, acceleration) - expected).abs() < 1e-9, "{speed} {acceleration}");
    }
}

#[test]
fn song_2021s_turn_leaves_its_motor_nearly_all_of_its_torque() {
    let found = demand("{}", TURN);
    assert!(found.is_met() && found.shortages.is_empty() && found.jump == 0.0, "{found:?}");
    // 45 g*cm^2 at 16000*pi/0.4 steps/s^2, maximum in the middle of the ramp; there is no load.
    let min = found.min_margin.unwrap();
    let needed = 45e-4 * 16_000.0 * PI / 0.4 * 2.0 * PI / 3200.0;
    close(min.needed_mn_m, needed, 1e-9);
    close(min.at_s, 0.1, 1e-6);
    close(min.margin_mn_m(), 400.0 / 2.0_f64.sqrt() - needed, 1e-9);
}

/// Twenty times as much inertia and a load: short around the middle of the first ramp, where the rate is under
/// the corner, so its times follow from an arc sine.
#[test]
fn a_shortage_reports_times_and_worst_moment() {
    let found = demand(r#"{"load_inertia_g_cm2":9955,"load_torque_mn_m":100}"#, TURN);
    assert_eq!((found.shortage_count, found.shortages.len(), found.is_met()), (1, 1, false), "{found:?}");
    let shortage = found.shortages[0];
    let greatest = 16_000.0 * PI / 0.4 * 2.0 * PI / 3200.0;
    let phase = libm::asin((400.0 / 2.0_f64.sqrt() - 100.0) / greatest);
    close(shortage.from_s, 0.2 * phase / PI, 1e-9);
    close(shortage.to_s, 0.2 * (PI - phase) / PI, 1e-9);
    close(shortage.worst.needed_mn_m, 100.0 + greatest, 1e-9);
    close(shortage.worst.rate, 8000.0, 1e-4);
    assert_eq!((found.min_margin, shortage.times), (Some(shortage.worst), 1.0));
    // Deceleration needs 148 mN*m, less than available; a move to the left is equal.
    let left = r#"{"cosine":{"distance":{"steps":-3200}}}"#;
    assert_eq!(demand(r#"{"load_inertia_g_cm2":9955,"load_torque_mn_m":100}"#, left), found);
    // Without a load both ramps are alike.
    let found = demand(r#"{"load_inertia_g_cm2":14955}"#, TURN);
    assert_eq!(found.shortage_count, 2);
    let [up, down] = found.shortages[..] else { panic!("{found:?}") };
    close(up.from_s + down.to_s, 0.4, 1e-9);
    assert!(down.worst.needed_mn_m < 0.0 && up.worst.needed_mn_m > 0.0);
}

#[test]
fn a_plateau_above_the_torque_rate_is_one_shortage() {
    let motor = r#"{"load_torque_mn_m":200,"supply_v":12}"#;
    let max = machine(motor).torque_rate().unwrap();
    close(machine(motor).available_mn_m(max), 200.0, 1e-9);
    let moves = format!(r#"{{"constant":{{"speed":{{"steps_s":{}}}}}}},{{"dwell":{{}}}}"#, max * 1.01);
    let found = demand(motor, &moves);
    assert_eq!(found.shortage_count, 1, "{found:?}");
    let shortage = found.shortages[0];
    assert_eq!(shortage.from_s, 0.0);
    close(shortage.to_s, 1000.0 / (max * 1.01), 1e-9);
    close(found.jump, max * 1.01, 1e-12);
    let moves = format!(r#"{{"constant":{{"speed":{{"steps_s":{}}}}}}}"#, max * 0.99);
    assert!(demand(motor, &moves).is_met());
}

#[test]
fn repeated_periods_are_one_shortage() {
    let sine = r#"{"sine_segments":{"amplitude":{"steps":4000},"period_s":0.1,"periods":1000}}"#;
    let found = demand(r#"{"load_torque_mn_m":200,"supply_v":12}"#, sine);
    // A sine of straight segments has no acceleration but jumps; only its rate matters.
    assert!(found.shortages.iter().any(|shortage| shortage.times > 990.0), "{found:?}");
    assert!(found.jump > 0.0);
}

/// Without a load, too, a motor that the supply leaves no driving current is short of torque.
#[test]
fn a_motor_without_driving_current_cannot_follow() {
    let weak = r#"{"supply_v":0.1}"#;
    // V/|Z| = k*w*R/|Z|^2, so w^2*(k^2*R^2 - V^2*p^2*L^2) = V^2*R^2.
    let (k, r, pl) = (0.4 / (2.0_f64.sqrt() * 1.5), 1.6, 50.0 * 4.3e-3);
    let speed = 0.1 * r / (k * k * r * r - 0.01 * pl * pl).sqrt();
    let max = machine(weak).torque_rate().unwrap();
    close(max, speed * 3200.0 / (2.0 * PI), 1e-9);
    assert!(machine(weak).available_mn_m(max * 1.001) < 0.0);
    let constant = r#"{"constant":{"speed":{"steps_s":100000}}}"#;
    let found = demand(weak, constant);
    assert_eq!(found.shortage_count, 1, "{found:?}");
    assert!(
        found.shortages[0].worst.margin_mn_m() < 0.0 && found.min_margin == Some(found.shortages[0].worst)
    );
    assert!(machine(weak).curve(100_000.0, 3).last().unwrap().1 < 0.0);
    // At far less than there is, all is well.
    assert!(demand(weak, r#"{"constant":{"speed":{"steps_s":200}}}"#).is_met());
    // 24 V drive at every rate, so without a load nothing limits.
    assert!(machine("{}").available_mn_m(1e7) > 0.0);
    // Where the driver cannot regulate the current, what flows anyway is less than none: here more than 10 mA.
    let strong = r#"{"supply_v":0.1,"peak_current_a":0.01}"#;
    assert!(machine(strong).available_mn_m(100_000.0) < 0.0);
}

#[test]
fn a_working_rate_limits_in_addition_to_torque() {
    let found = demand(r#"{"working_rate_hz":15999}"#, TURN);
    assert_eq!((found.shortage_count, found.over_working_rate), (0, Some(16_000.0)));
    assert!(!found.is_met());
    assert!(demand(r#"{"working_rate_hz":16000}"#, TURN).is_met());
    // Without a load an ideal motor has some torque at every rate.
    assert_eq!(machine("{}").max_rate(), None);
    assert_eq!(machine(r#"{"working_rate_hz":19200}"#).max_rate(), Some(19_200.0));
    assert_eq!(machine(r#"{"load_torque_mn_m":300}"#).max_rate(), Some(0.0));
}

/// f_s = 19200 gives 0.2333 s, of which 0.2 s fit into the move of 0.4 s.
#[test]
fn song_2021s_longest_ramp_comes_out_of_its_working_rate() {
    let ramps = |motor: &str, steps: i64, duration_s: f64| {
        Ramps::of(&machine(motor), &Profile::Cosine(Cosine::new(steps, duration_s, 0.1))).unwrap()
    };
    let found = ramps(r#"{"working_rate_hz":19200}"#, 3200, 0.4);
    close(found.longest_s.unwrap(), 0.233_333_333, 1e-8);
    assert_eq!((found.max_rate, found.room_s, found.too_fast), (Some(19_200.0), 0.2, false));
    let (shortest, longest) = found.enough_s.unwrap();
    assert_eq!(longest, 0.2);
    // The shortest: with J = 45 g*cm^2 the torque of 282.8 mN*m is demand for by n*pi/(2*t_s*(T - t_s)).
    let acceleration = 400.0 / 2.0_f64.sqrt() / 45e-4 / (2.0 * PI / 3200.0);
    let peak = |ramp_s: f64| Cosine::new(3200, 0.4, ramp_s).peaks().acceleration;
    close(peak(shortest), acceleration, 1e-3);
    // 6400 steps in 0.4 s: the longest ramp of the paper is 0.0667 s, so without a plateau it is too fast.
    let found = ramps(r#"{"working_rate_hz":19200}"#, 6400, 0.4);
    close(found.longest_s.unwrap(), 0.066_666_667, 1e-7);
    close(found.enough_s.unwrap().1, 0.066_666_667, 1e-7);
    let found = ramps(r#"{"working_rate_hz":15999}"#, 6400, 0.4);
    assert_eq!((found.longest_s, found.too_fast, found.enough_s), (None, true, None));
    // A load that needs more torque than available with every ramp.
    assert_eq!(ramps(r#"{"load_torque_mn_m":283}"#, 3200, 0.4).enough_s, None);
}

#[test]
fn without_a_suitable_ramp_the_limit_is_reported() {
    let ramps =
        |motor: &str| Ramps::of(&machine(motor), &Profile::Cosine(Cosine::new(3200, 0.4, 0.0))).unwrap();
    // 8000 steps/s is the minimum rate of the move, without ramps.
    let found = ramps(r#"{"working_rate_hz":8000}"#);
    assert_eq!((found.longest_s, found.enough_s, found.without_ramps), (Some(0.0), None, true));
    let free = ramps("{}");
    assert_eq!((found.too_fast_s, free.too_fast_s), (free.enough_s, None));
    let found = ramps(r#"{"working_rate_hz":7999}"#);
    assert!(found.too_fast && !found.without_ramps && found.too_fast_s == free.enough_s);
    // Ramps far shorter than a part of the room are found: a bare rotor of 0.01 g*cm^2 follows them.
    let found = ramps(r#"{"working_rate_hz":8001,"rotor_inertia_g_cm2":0.01}"#);
    let (shortest, longest) = found.enough_s.unwrap();
    assert!(shortest < 1e-6, "{found:?}");
    close(longest, 0.4 - 3200.0 / 8001.0, 1e-9);
    // No torque at all.
    let found = ramps(r#"{"load_torque_mn_m":283}"#);
    assert_eq!((found.enough_s, found.too_fast_s, found.without_ramps), (None, None, false));
    // Too much inertia to set off with any ramp, but enough for the rate itself.
    let found = ramps(r#"{"load_inertia_g_cm2":100000}"#);
    assert_eq!((found.enough_s, found.too_fast_s, found.without_ramps), (None, None, true));
}

#[test]
fn both_ends_of_the_sufficient_ramps_are_found() {
    let motor = r#"{"load_inertia_g_cm2":300,"load_torque_mn_m":180,"supply_v":13}"#;
    // The cosine, and two other shapes with its front.
    for (kind, shape) in
        [("cosine", ""), ("ramps", r#","shape":"straight""#), ("ramps", r#","shape":"sigmoid""#)]
    {
        let with =
            |ramp_s: f64| format!(r#"{{"{kind}":{{"distance":{{"steps":8000}},"ramp_s":{ramp_s}{shape}}}}}"#);
        let plan = plan_axis(&axis(motor, &with(0.1)), "axis").unwrap();
        let found = Ramps::of(&machine(motor), &plan.moves()[0].profile).unwrap();
        let (shortest, longest) = found.enough_s.unwrap();
        assert!(shortest > 0.0 && longest < found.room_s, "{found:?}");
        for (ramp_s, met) in [
            (shortest * 0.998, false),
            (shortest * 1.002, true),
            (longest * 0.998, true),
            (longest * 1.002, false),
        ] {
            assert_eq!(demand(motor, &with(ramp_s)).is_met(), met, "{shape} {ramp_s} of {found:?}");
        }
    }
    let dwell = plan_axis(&axis(motor, r#"{"dwell":{}}"#), "axis").unwrap();
    assert_eq!(Ramps::of(&machine(motor), &dwell.moves()[0].profile), None);
}

#[test]
fn a_curve_and_the_moments_of_a_plan_can_be_drawn() {
    let motor = machine(r#"{"load_torque_mn_m":100}"#);
    let curve: Vec<_> = motor.curve(40_000.0, 5).collect();
    assert_eq!(curve.iter().map(|point| point.0).collect::<Vec<_>>(), [0.0, 1e4, 2e4, 3e4, 4e4]);
    assert!(motor.shown_rate(16_000.0) > motor.torque_rate().unwrap());
    let plan = plan_axis(&axis("{}", TURN), "axis").unwrap();
    // Of 20 bins of 1000 steps/s the last ones are never reached; the middle of the ramp needs most.
    let needed = needed_over_rate(&motor, &plan, 20_000.0, 20);
    assert!(needed[..16].iter().all(|needed| *needed > 100.0), "{needed:?}");
    assert!(needed[17..].iter().all(|needed| needed.is_nan()));
    assert!(needed[8] > needed[2] && needed[8] > needed[14] && needed[8] < 102.0);
}

#[test]
fn only_a_move_with_too_little_torque_has_a_warning() {
    let motor = r#"{"load_inertia_g_cm2":9955,"load_torque_mn_m":100,"working_rate_hz":30000}"#;
    let moves = r#"{"constant":{}},{"cosine":{}},{"dwell":{}}"#;
    let found = demand(motor, moves);
    let warn = |from: f64, to: f64, peak: f64| found.warning(&machine(motor), from, to, peak);
    assert_eq!((warn(0.0, 1.0, 1000.0), warn(1.4, 1.5, 0.0)), (None, None));
    assert_eq!(
        warn(1.0, 1.4, 16_000.0).as_deref(),
        Some(
            "too little torque: 346.7 mN*m needed of 282.8 at 1.1000 s and 8\u{202f}000 steps/s; use more time, longer ramps, less load or a higher supply voltage"
        )
    );
    assert_eq!(
        warn(0.0, 1.0, 30_001.0).as_deref(),
        Some(
            "30\u{202f}001 steps/s exceed the motor's working rate of 30\u{202f}000; use more time or shorter ramps"
        )
    );
}

/// Steps of a plan in cycles of 16 MHz.
fn steps_of(motor: &str, moves: &str) -> (Machine, Vec<stepscope_peripheral::trace::Step>) {
    let json = format!(
        r#"{{"source":{{"motion":{{"engine":"segments","axes":[{{"motor":{motor},"moves":[{moves}]}}]}}}}}}"#
    );
    let experiment = stepscope_sim::Experiment::from_json(&json).unwrap();
    let mut recording = crate::trace::stored_run::StoredRun::default();
    experiment.run(&mut recording);
    (machine(motor), stepscope_peripheral::trace::steps(&recording.trace, 0))
}

#[test]
fn the_steps_of_a_plan_need_the_torque_of_the_plan() {
    let rows = [
        // The bare rotor, a load of inertia, one of friction as well, and a move there and back with a dwell.
        ("{}", TURN, 0.02),
        (r#"{"load_inertia_g_cm2":4955}"#, TURN, 0.02),
        (r#"{"load_inertia_g_cm2":955,"load_torque_mn_m":100}"#, r#"{"cosine":{"ramp_s":0.05}}"#, 0.02),
        ("{}", r#"{"cosine":{}},{"dwell":{"duration_s":0.1}},{"cosine":{"distance":{"steps":-3200}}}"#, 0.02),
    ];
    for (motor, moves, within) in rows {
        let (machine, steps) = steps_of(motor, moves);
        let (plan, found) = (demand(motor, moves), Demand::of_steps(&machine, &steps, 16_000_000));
        assert!(plan.is_met() && found.is_met(), "{motor} {moves} {found:?}");
        let [by_plan, by_steps] = [&plan, &found].map(|demand| demand.min_margin.unwrap().needed_mn_m.abs());
        // In parts of what the motor has.
        assert!((by_plan - by_steps).abs() < within * 282.8, "{motor}: {by_plan} {by_steps}");
        close(found.max_rate, plan.max_rate, 0.02);
    }
}

#[test]
fn steps_and_their_plan_have_the_same_shortage() {
    let motor = r#"{"load_inertia_g_cm2":9955,"load_torque_mn_m":100}"#;
    let (machine, steps) = steps_of(motor, TURN);
    let (plan, found) = (demand(motor, TURN), Demand::of_steps(&machine, &steps, 16_000_000));
    assert_eq!((plan.shortage_count, found.shortage_count), (1, 1));
    let start_s = steps[0].cycle as f64 / 16e6;
    let [by_plan, by_steps] = [&plan, &found].map(|demand| demand.shortages[0]);
    for (planned, stepped) in [(by_plan.from_s, by_steps.from_s), (by_plan.to_s, by_steps.to_s)] {
        // The first step is due a little after the plan's start.
        assert!((stepped - start_s - planned).abs() < 0.02, "{planned} {stepped}");
    }
    close(by_steps.worst.needed_mn_m, by_plan.worst.needed_mn_m, 0.02);
    let report = TorqueReport::of_steps(&machine, &steps, 16_000_000);
    assert_eq!((report.total, report.ramps.len()), (1, 0));
    close(report.window_s.unwrap(), machine.natural_period_s(), 1e-12);
    let max = report.curve.needed.iter().copied().fold(0.0, f64::max);
    close(max, by_steps.worst.needed_mn_m, 0.01);
}

#[test]
fn jitter_needs_little_torque_and_jumps_are_reported() {
    let machine = machine("{}");
    let steps = |interval: u64, off: fn(u64) -> u64| -> Vec<_> {
        let at = |k: i32| u64::from(k.unsigned_abs()) * interval + off(u64::from(k.unsigned_abs()));
        (1..2000).map(|k| stepscope_peripheral::trace::Step { cycle: at(k), position: k }).collect()
    };
    // 16 000 steps/s whose every second step comes half an interval late.
    let even = Demand::of_steps(&machine, &steps(1000, |_| 0), 16_000_000);
    let uneven = Demand::of_steps(&machine, &steps(1000, |k| k % 2 * 500), 16_000_000);
    let [even, uneven_mn_m] = [&even, &uneven].map(|demand| demand.min_margin.unwrap().needed_mn_m.abs());
    assert!((uneven_mn_m - even).abs() < 0.04 * 282.8, "{even} {uneven_mn_m}");
    assert_eq!(Demand::of_steps(&machine, &steps(1000, |_| 0), 16_000_000).jump, 16_000.0);
    // Of steps that are each one by itself none takes up more than its own rate.
    assert_eq!(Demand::of_steps(&machine, &steps(160_000, |_| 0), 16_000_000).jump, 100.0);
    // A pause in which 16 steps would have come, shorter than the rotor swings, and one late step, which is none.
    let paused =
        Demand::of_steps(&machine, &steps(1000, |k| if k > 1000 { 16_000 } else { 0 })[10..1900], 16_000_000);
    assert_eq!(paused.jump, 16_000.0);
    let ramp: fn(u64) -> u64 = |k| libm::sqrt(k as f64 * 2e9) as u64;
    let [smooth, late] = [ramp, |k| libm::sqrt(k as f64 * 2e9) as u64 + if k == 1500 { 300 } else { 0 }]
        .map(|off| Demand::of_steps(&machine, &steps(0, off)[..1990], 16_000_000).jump);
    assert_eq!(smooth, late);
    // It ends at once.
    close(smooth, 16e6 / (libm::sqrt(1990.0 * 2e9) - libm::sqrt(1989.0 * 2e9)), 0.01);
    // A few steps in a burst, every 2 ms, are no start at the burst's rate.
    let bursts = Demand::of_steps(&machine, &steps(200, |k| k / 4 * 31_200), 16_000_000);
    assert!((1900.0..6000.0).contains(&bursts.jump), "{}", bursts.jump);
    for few in [0, 1] {
        let few = Demand::of_steps(&machine, &steps(1000, |_| 0)[..few], 16_000_000);
        assert!(few.is_met() && few.jump == 0.0 && few.max_rate == 0.0, "{few:?}");
    }
}

#[test]
fn a_working_rate_and_simultaneous_steps_are_checked() {
    let machine = machine(r#"{"working_rate_hz":1000}"#);
    let all: Vec<_> = (1..50)
        .map(|k: i32| stepscope_peripheral::trace::Step {
            cycle: u64::from(k.unsigned_abs() / 2) * 8000,
            position: k,
        })
        .collect();
    let found = Demand::of_steps(&machine, &all, 16_000_000);
    assert!(found.over_working_rate.is_some_and(|rate| (3000.0..5000.0).contains(&rate)), "{found:?}");
    assert!(found.min_margin.is_some_and(|min| min.needed_mn_m.is_finite()));
    // Without any inertia only the load is left.
    let (light, steps) = steps_of(r#"{"rotor_inertia_g_cm2":0,"load_torque_mn_m":10}"#, TURN);
    let found = Demand::of_steps(&light, &steps, 16_000_000);
    assert!(found.is_met());
    assert_eq!(found.min_margin.map(|min| min.needed_mn_m), Some(10.0));
}

#[test]
fn a_channel_without_axis_has_the_motor_of_the_plant() {
    use stepscope_plant::{parameters::MotorModel, stability::Natural};
    let scenario = |text: &str| stepscope_scenario::Scenario::from_json(text).unwrap();
    let listed = scenario(
        r#"{"bus":{"channels":3},"source":{"segments":{}},"plant":{"motors":[{"motor":{"working_rate_hz":500}},{"microsteps":4}]}}"#,
    );
    let of = |channel| Machine::of_channel(&listed, 0, channel).unwrap();
    close(1.0 / of(1).natural_period_s(), Natural::of(&MotorModel::default()).frequency_hz, 1e-9);
    assert_eq!((of(0).working_rate(), of(1).working_rate()), (Some(500.0), None));
    // The last entry is used for other channels; a rate with 4 microsteps is 1/4 of that with 16.
    assert_eq!(of(1), of(2));
    close(of(0).corner_rate().unwrap(), 4.0 * of(1).corner_rate().unwrap(), 1e-9);
    assert_eq!(Machine::of_channel(&scenario(r#"{"source":{"segments":{}}}"#), 0, 0), None);
    let default = scenario(r#"{"source":{"segments":{}},"plant":{}}"#);
    assert_eq!(Machine::of_channel(&default, 0, 0), Some(machine("{}")));
    // An axis without a motor of its own has its mechanics with the default motor.
    let turned =
        scenario(r#"{"plant":{},"source":{"motion":{"axes":[{"mechanics":{"rotary":{"microsteps":4}}}]}}}"#);
    close(
        Machine::of_channel(&turned, 0, 0).unwrap().corner_rate().unwrap(),
        of(1).corner_rate().unwrap(),
        1e-9,
    );
}
