//! Buttons, jogs, homing and the panel (G2, G6, G8), with the small controller of `bench`.

use crate::bench::{self, Run, level, pressed, presses, run, run_all, small, to_the_right};
use stepscope_controller::{
    Alarm, State,
    input::{
        Change, Input,
        Signal::{
            self, Back, Clear, Debug, Estop, HomeSwitch, JogMinus, JogPlus, Key0, Key1, Key2, Key4,
            Ok as OkButton, Power, Start, System, Zero,
        },
    },
    parameters::{Axis, Group, Home, Jog, Parameters, Release, Setup, SoftLimits},
};
use stepscope_peripheral::{signal::Levels, units::Instant};

/// A button held from one cycle to another.
fn held(parameters: Parameters, button: Signal, from: u64, to: u64) -> Run {
    run(Parameters { inputs: vec![level(from, button, true), level(to, button, false)], ..parameters })
}

#[test]
fn half_a_second_at_10_hz_is_five_steps() {
    let press = |at, is_down| level(at, JogPlus, is_down);
    let inputs = vec![press(4_000_000, true), press(12_000_000, false)];
    let jog = Jog { speed_hz: 10, ..Jog::default() };
    let setup =
        Setup { controllers: vec![Parameters { inputs, jog, ..Parameters::default() }], ..Setup::default() };
    let mut machine = stepscope_controller::StandAlone::new(&setup.check().unwrap());
    machine.run(Instant::NEVER, &mut Vec::new());
    assert_eq!(machine.position(0), Some(5));
}

#[test]
fn a_tap_is_one_step_after_the_minimum_interval() {
    let run = held(small(), JogPlus, 30, 36);
    assert_eq!(run.edges(), "DIR+31 STEP+35 STEP-37");
    assert_eq!(run.panel_from(28), ["31 Jog t1 g0/0", "38 Ready t1 g0/0"]);
    assert_eq!(held(small(), JogMinus, 30, 36).position(), -1);
    assert_eq!(held(small(), JogPlus, 30, 35).position(), 1, "STEP rises before the release is handled");
    let soon = held(small(), JogPlus, 30, 34);
    assert_eq!((soon.edges().as_str(), soon.panel_from(32)[0].as_str()), ("DIR+31", "35 Ready t1 g0/0"));
}

#[test]
fn the_opposite_jog_button_ends_a_jog_without_starting_another() {
    let inputs = vec![level(30, JogPlus, true), level(50, JogMinus, true)];
    let run = run(Parameters { inputs, ..small() });
    assert_eq!((run.position(), run.end().as_str()), (2, "Ready"));
    // Both in one cycle: the jog ends in the cycle in which it begins.
    let inputs = vec![level(30, JogPlus, true), level(30, JogMinus, true)];
    let both = bench::run(Parameters { inputs, ..small() });
    assert_eq!((both.position(), both.panel_from(28)), (0, vec![]));
}

#[test]
fn a_jog_above_the_start_stop_rate_loses_the_position_unless_it_has_a_ramp() {
    for (release, trust) in [(Release::AtOnce, 0), (Release::Ramp, 1)] {
        let jog = Jog { speed_hz: 200, release, level: 5, ..Jog::default() };
        let run = held(Parameters { jog, ..small() }, JogPlus, 30, 900);
        assert_eq!((run.machine.trust(0), run.end().as_str()), (Some(trust), "Ready"), "{release:?}");
    }
}

#[test]
fn a_jog_ends_at_the_soft_limits_while_the_position_is_trusted() {
    let soft_limits = Some(SoftLimits { min_steps: -2, max_steps: 4 });
    let parameters = Parameters { soft_limits, ..small() };
    assert_eq!(held(parameters.clone(), JogPlus, 30, 500).position(), 4);
    assert_eq!(held(parameters.clone(), JogMinus, 30, 500).position(), -2);
    // A memory without a record: trust 0.
    let mut lost = parameters;
    lost.memory.initial = stepscope_controller::parameters::Initial::Blank;
    let mut inputs = presses(&[(30, Clear)]);
    inputs.extend([level(40, JogPlus, true), level(140, JogPlus, false)]);
    assert_eq!(run(Parameters { inputs, ..lost }).position(), 10);
}

#[test]
fn the_e_stop_cuts_a_pulse_that_still_counts() {
    let mut inputs = presses(&[(30, Start), (60, Clear), (80, Clear)]);
    inputs.extend([level(51, Estop, true), level(70, Estop, false)]);
    let run = run(Parameters { inputs, debounce_cycles: 0, ..small() });
    assert_eq!(run.edges(), "DIR+31 STEP+41 STEP-43 STEP+51 STEP-52 EN-52 EN+81");
    assert_eq!(run.panel_from(32), ["52 Alarm:Estop t1 g0/0", "81 Ready t1 g0/0"]);
    assert_eq!(
        (run.position(), run.machine.ignored(0).len()),
        (2, 1),
        "clear has no effect while the emergency stop is pressed"
    );
}

#[test]
fn an_e_stop_in_self_test_is_an_alarm_after_the_test() {
    let run = run(Parameters { inputs: vec![level(5, Estop, true), level(7, Estop, false)], ..small() });
    assert_eq!(run.edges(), "EN-6");
    let expected = ["0 SelfTest t0 g0/0", "11 SelfTest t1 g0/0", "27 Alarm:Estop t1 g0/0"];
    assert_eq!(run.panel(), expected);
}

#[test]
fn the_return_goes_to_a_zero_set_in_debug() {
    let inputs = [(30, Debug), (40, OkButton), (50, Debug), (60, Start), (120, Zero)];
    let run = pressed(small(), &inputs);
    let expected = [
        "31 Debug t1 g0/0",
        "41 Debug t2 g0/0",
        "51 Ready t2 g0/0",
        "61 Running t2 g1/1",
        "94 Ready t2 g0/0",
        "121 Returning t2 g0/0",
        "154 Ready t2 g0/0",
    ];
    assert_eq!(run.panel_from(28), expected);
    assert_eq!((run.position(), run.machine.positions()[0]), (0, 0));
    assert_eq!(
        run.machine.panel(0).last().map(|record| record.word.led()),
        Some(stepscope_controller::panel::Led::On)
    );
}

#[test]
fn homing_seeks_backs_off_and_returns_slowly() {
    // The home switch is closed from -5 to -3. The axis and the controller are at 0.
    let axis = Some(Axis { home_from_steps: Some(-5), home_to_steps: Some(-3), ..Axis::default() });
    let home = Home { coarse_hz: 100, fine_hz: 50, pull_off_steps: 2, ..Home::default() };
    let row = |position_steps| {
        let home = Some(Home { position_steps, ..home.clone() });
        pressed(Parameters { home, axis: axis.clone(), ..small() }, &[(30, Signal::Home)])
    };
    let run = row(0);
    // Three steps to -3; off to -2 and one more to -1, because the pending step is the first of two; fine to -3.
    assert_eq!(run.rises(), [41, 51, 61, 74, 84, 94, 117, 137, 157]);
    assert_eq!((run.position(), run.machine.axis_position(0), run.machine.trust(0)), (0, Some(-3), Some(2)));
    assert_eq!(run.machine.axis_error(0), Some(0));
    assert_eq!(run.panel_from(28), ["31 Homing t1 g0/0", "158 Homing t2 g0/0", "160 Ready t2 g0/0"]);
    let run = row(7);
    assert_eq!((run.position(), run.machine.axis_position(0), run.end().as_str()), (0, Some(-10), "Ready"));
}

#[test]
fn homing_without_a_switch_is_an_alarm() {
    let home = Some(Home { coarse_hz: 100, max_travel_steps: 5, ..Home::default() });
    let inputs = presses(&[(30, Signal::Home)]);
    let parameters = Parameters { home, inputs, ..small() };
    let open = run(parameters.clone());
    assert_eq!((open.end().as_str(), open.position()), ("Alarm:Homing", -5));
    // The switch is stuck: it is still closed after five steps.
    let mut stuck = parameters;
    stuck.inputs.push(level(20, HomeSwitch, true));
    let stuck = run(stuck);
    assert_eq!((stuck.end().as_str(), stuck.position()), ("Alarm:Homing", 5));
    assert_eq!(pressed(small(), &[(30, Signal::Home)]).machine.ignored(0)[0].button, Signal::Home);
}

#[test]
fn a_program_continues_from_zero_after_homing() {
    let axis = Some(Axis { home_from_steps: Some(-5), home_to_steps: Some(-3), ..Axis::default() });
    let home = Some(Home { coarse_hz: 100, fine_hz: 50, pull_off_steps: 2, ..Home::default() });
    let groups = vec![Group::Home, to_the_right(4)];
    let run = pressed(Parameters { home, axis, groups, least_trust: 2, ..small() }, &[(30, Start)]);
    assert_eq!((run.position(), run.machine.trust(0), run.end().as_str()), (4, Some(2), "Ready"));
}

#[test]
fn numbers_are_entered_digit_by_digit() {
    // Number 0 becomes 42, number 1 keeps its value, number 2 is out of range.
    let presses = [
        (30, System),
        (40, Key4),
        (50, Key2),
        (60, OkButton),
        (70, OkButton),
        (80, Key1),
        (90, OkButton),
        (100, Key0),
        (110, Back),
    ];
    let run = pressed(small(), &presses);
    let shown: Vec<_> = run.machine.panel(0).iter().filter(|record| record.cycle.0 > 28).collect();
    let shown: Vec<_> =
        shown.iter().map(|r| (r.cycle.0, r.word.state(), r.word.group(), r.display)).collect();
    let edit = State::Edit;
    let expected = [
        (31, edit, 0, 1),
        (41, edit, 0, 4),
        (51, edit, 0, 42),
        (61, edit, 1, 0),
        (71, edit, 2, 100),
        (81, edit, 2, 1),
        (91, edit, 2, 100),
        (101, edit, 2, 0),
        (111, State::Ready, 0, 0),
    ];
    assert_eq!(shown, expected);
    assert_eq!(run.machine.numbers(0)[..3], [42, 0, 100]);
}

#[test]
fn an_entry_has_its_last_six_digits_and_clear_enters_zero() {
    let keys = [Key1, Key2, Key4, Key0, Key0, Key0, Key1];
    let mut all: Vec<_> = keys.iter().enumerate().map(|(index, &key)| (40 + 2 * index as u64, key)).collect();
    all.insert(0, (30, System));
    assert_eq!(pressed(small(), &all).machine.display(0), Some(240_001));
    all.push((60, Clear));
    assert_eq!(pressed(small(), &all).machine.display(0), Some(0));
}

#[test]
fn saved_numbers_survive_a_power_cut() {
    let buttons = [(30, System), (40, Key4), (50, OkButton), (60, Back)];
    for (falls, expected) in [(70, 1), (300, 4)] {
        let mut inputs = presses(&buttons);
        inputs.extend([level(falls, Power, false), level(2000, Power, true)]);
        let run = run(Parameters { inputs, ..small() });
        assert_eq!((run.machine.numbers(0)[0], run.end().as_str()), (expected, "Ready"), "{falls}");
    }
}

#[test]
fn power_e_stop_and_clear_apply_to_all_and_the_bus_has_the_and_of_en() {
    let quick = Parameters { inputs: vec![level(100, Estop, true), level(110, Estop, false)], ..small() };
    let mut quick = Parameters { debounce_cycles: 0, ..quick };
    quick.inputs.extend(presses(&[(120, Clear)]));
    // The second one still debounces the release of the stop when clear is pressed.
    let slow = Parameters { debounce_cycles: 30, ..small() };
    let run = run_all(vec![quick, slow], 1000);
    let states = [0, 1].map(|i| (run.machine.state(i), run.machine.alarm(i), run.machine.enabled(i)));
    assert_eq!(states[0], (Some(State::Ready), Some(Alarm::None), Some(true)));
    assert_eq!(states[1], (Some(State::Alarm), Some(Alarm::Estop), Some(false)));
    assert!(run.trace.last().is_some_and(|record| record.levels.0 & Levels::EN == 0));
}

#[test]
fn the_axis_can_be_pushed_while_the_motor_is_off() {
    let push = |at, steps| Input { cycle: Instant(at), change: Change::Push(steps) };
    let inputs = vec![push(50, 9), level(60, Estop, true), push(60, 9), push(61, 5), push(62, -20)];
    let axis = Some(Axis { hard_min_steps: Some(-10), ..Axis::default() });
    let run = run(Parameters { inputs, axis, ..small() });
    assert_eq!((run.machine.axis_position(0), run.machine.axis_error(0)), (Some(-10), Some(-10)));
}

/// The first position read from memory counts as correct, wherever the axis starts.
#[test]
fn the_axis_error_is_relative_to_the_position_in_memory_until_zero_is_set() {
    let axis = Some(Axis { start_steps: 50, hard_max_steps: Some(51), ..Axis::default() });
    let row = |inputs| {
        let run = run(Parameters { inputs, axis: axis.clone(), ..small() });
        (run.position(), run.machine.axis_position(0), run.machine.axis_error(0))
    };
    assert_eq!(row(vec![]), (0, Some(50), Some(0)));
    // The program's three steps to the right end at 51: two are lost.
    assert_eq!(row(presses(&[(30, Signal::Start)])), (3, Some(51), Some(-2)));
    // A power cut and a second read change nothing; setting zero does.
    let cut = [level(200, Signal::Power, false), level(900, Signal::Power, true)];
    let mut inputs = presses(&[(30, Signal::Start)]);
    inputs.extend(cut);
    assert_eq!(row(inputs.clone()), (3, Some(51), Some(-2)));
    inputs.extend(presses(&[(1200, Signal::Debug), (1210, Signal::Ok)]));
    assert_eq!(row(inputs), (0, Some(51), Some(0)));
}
