//! Errors and warnings with their numbers (CONTROLLER.md, "Refused").

use crate::bench::{level, small};
use stepscope_controller::{
    NotEntered, StandAlone,
    input::{Change, Input, Signal},
    limits,
    parameters::{
        Axis, Group, Home, Initial, Jog, Jump, Memory, Move, Parameters, Profile, Release, Repeat, Setup,
        ShortMove, SoftLimits, Until, Wait,
    },
};
use stepscope_peripheral::units::Instant;

/// The errors of one controller at 1 MHz with the default pulse times.
fn refused(parameters: Parameters) -> Vec<String> {
    let setup = Setup { clock_hz: 1_000_000, controllers: vec![parameters], ..Setup::default() };
    setup.check().err().unwrap_or_default().iter().map(ToString::to_string).collect()
}

/// A valid controller at 1 MHz: a pulse with its pauses takes 80 cycles.
fn good() -> Parameters {
    Parameters { max_speed_hz: 12_500, ..Parameters::default() }
}

#[test]
fn errors_have_numbers_and_a_remedy() {
    let rows = [
        (
            Parameters { max_speed_hz: 20_000, ..good() },
            "controller 0: max_speed_hz: 20000 Hz is a step every 50 cycles, but a pulse with its pauses takes 80; \
             use 10 to 12500 Hz",
        ),
        (
            Parameters { home: Some(Home { coarse_hz: 1500, ..Home::default() }), ..good() },
            "controller 0: home.coarse_hz: 1500 Hz is above `start_speed_hz`, but homing has no ramp; use 10 to 1000 Hz",
        ),
        (
            Parameters {
                groups: vec![
                    Group::Move(Move::default()),
                    Group::Wait(Wait::default()),
                    Group::Repeat(Repeat { first: 3, times: 2 }),
                ],
                ..good()
            },
            "controller 0: groups[2].repeat.first: 3 is not before this group (3); use 1 to 2",
        ),
        (
            Parameters { groups: vec![Group::Jump(Jump { to: 9, ..Jump::default() }); 4], ..good() },
            "controller 0: groups[0].jump.to: there is no group 9; use 1 to 4",
        ),
        (
            Parameters { groups: vec![Group::Home], ..good() },
            "controller 0: groups[0].home: the controller has no `home`; add one or remove this group",
        ),
        (
            Parameters {
                axis: Some(Axis { max_switch_at_steps: Some(5), ..Axis::default() }),
                inputs: vec![level(7, Signal::LimitMax, true)],
                ..good()
            },
            "controller 0: inputs[0]: limit_max is driven by axis.max_switch_at_steps; remove one of them",
        ),
        (
            Parameters {
                inputs: vec![level(4000, Signal::Start, true), level(4000, Signal::Start, false)],
                ..good()
            },
            "controller 0: inputs[1]: start has two entries at cycle 4000; use one",
        ),
        (
            Parameters {
                groups: vec![Group::Profile(Profile {
                    intervals: vec![80 << 16, (80 << 16) - 1],
                    ..Profile::default()
                })],
                ..good()
            },
            "controller 0: groups[0].profile.intervals_q16[1]: 5242879/65536 cycle is shorter than a pulse with its \
             pauses; use at least 5242880/65536 cycle",
        ),
    ];
    for (parameters, expected) in rows {
        assert_eq!(refused(parameters)[0], expected);
    }
    assert_eq!(refused(good()), Vec::<String>::new());
}

#[test]
fn each_error_names_its_field() {
    let until = |input| {
        let until = Some(Until { input, level: true });
        vec![Group::Move(Move { until, ..Move::default() })]
    };
    let push = |push| vec![Input { cycle: Instant(5), change: Change::Push(push) }];
    let memory = |initial| Memory { slots: 2, initial, ..Memory::default() };
    let bytes = 2 * 16 + 2 * (8 + 4 * 13);
    let rows = [
        (Parameters { self_test_cycles: 0, ..good() }, "self_test_cycles"),
        (Parameters { debounce_cycles: 1_000_000_001, ..good() }, "debounce_cycles"),
        (Parameters { pulses_per_unit: 0, ..good() }, "pulses_per_unit"),
        (Parameters { decimals: 4, ..good() }, "decimals"),
        (Parameters { start_speed_hz: 12_501, ..good() }, "start_speed_hz"),
        (Parameters { least_trust: 3, ..good() }, "required_position"),
        (Parameters { loops: 10_000, ..good() }, "loops"),
        (Parameters { groups: vec![], ..good() }, "groups"),
        (Parameters { groups: until(Signal::LimitMin), ..good() }, "groups[0].move.until.input"),
        (
            Parameters { groups: vec![Group::Wait(Wait { input: Signal::Ok, ..Wait::default() })], ..good() },
            "groups[0].wait.input",
        ),
        (
            Parameters { groups: vec![Group::Wait(Wait { then: Some(0), ..Wait::default() })], ..good() },
            "groups[0].wait.then",
        ),
        (Parameters { jog: Jog { fine_hz: 9, ..Jog::default() }, ..good() }, "jog.fine_hz"),
        (Parameters { home: Some(Home { switch: Signal::In0, ..Home::default() }), ..good() }, "home.switch"),
        (
            Parameters { soft_limits: Some(SoftLimits { min_steps: 1, max_steps: 0 }), ..good() },
            "soft_limits.max_steps",
        ),
        (
            Parameters { axis: Some(Axis { home_from_steps: Some(1), ..Axis::default() }), ..good() },
            "axis.home_to_steps",
        ),
        (Parameters { memory: memory(Initial::Bytes(vec![0; bytes + 1])), ..good() }, "memory.initial"),
        (Parameters { inputs: push(1_000_001), ..good() }, "inputs[0].push_steps"),
        (Parameters { inputs: vec![level(0, Signal::Ok, true)], ..good() }, "inputs[0].cycle"),
    ];
    for (parameters, path) in rows {
        let refused = refused(parameters);
        assert_eq!(refused.len(), 1, "{refused:?}");
        assert!(refused[0].starts_with(&format!("controller 0: {path}: ")), "{refused:?}");
    }
    assert_eq!(refused(Parameters { memory: memory(Initial::Bytes(vec![0; bytes])), ..good() }).len(), 0);
}

#[test]
fn all_errors_of_the_bus_and_the_controllers_are_reported_together() {
    let second = Parameters { inputs: vec![level(9, Signal::Power, false)], decimals: 9, ..good() };
    let setup = Setup { channels: 1, controllers: vec![good(), second], ..Setup::default() };
    let refused: Vec<String> = setup.check().unwrap_err().iter().map(ToString::to_string).collect();
    let expected = [
        "source.standalone: 2 is out of range; use 1 to 1",
        "controller 1: decimals: 9 is out of range; use 0 to 3",
        "controller 1: inputs[0]: power applies to all controllers; use it only in the script of the first controller",
    ];
    assert_eq!(refused, expected);
}

#[test]
fn unintended_values_are_warnings() {
    let memory = Memory { byte_write_cycles: 10, hold_up_cycles: 168, ..Memory::default() };
    let jog = Jog { speed_hz: 1001, ..Jog::default() };
    let risky =
        Parameters { debounce_cycles: 0, jog: jog.clone(), memory: memory.clone(), ..Parameters::default() };
    let setup = |parameters| Setup { controllers: vec![parameters], ..Setup::default() };
    let checked = setup(risky).check().unwrap();
    let warned: Vec<&str> = checked.warnings().iter().map(|warned| warned.path.as_str()).collect();
    assert_eq!(warned, ["debounce_cycles", "jog.speed_hz", "memory.hold_up_cycles"]);
    let memory = Memory { hold_up_cycles: 169, ..memory };
    let jog = Jog { release: Release::Ramp, ..jog };
    let fine = setup(Parameters { jog, memory, ..Parameters::default() });
    assert!(fine.check().unwrap().warnings().is_empty());
}

/// 36 rows from 1000 Hz at 3000 Hz/s are 4200 steps and end at 5119 Hz.
#[test]
fn a_move_that_never_reaches_its_speed_is_a_warning() {
    let warned = |length, short_move| {
        let own = Move { length, speed_hz: 5000, level: 3, ..Move::default() };
        let groups = vec![Group::Home, Group::Move(own)];
        let home = Some(Home::default());
        let numbers =
            Parameters { pulses_per_unit: 1, decimals: 0, groups, home, short_move, ..Parameters::default() };
        let checked = Setup { controllers: vec![numbers], ..Setup::default() }.check().unwrap();
        checked.warnings().first().map(ToString::to_string)
    };
    let warning = "controller 0: groups[1].move.speed_hz: the whole move runs at 1000 Hz, because 5000 Hz needs \
                   8400 steps and the move has 8399; use a higher `acceleration_level` or `short_move` \"reverse\"";
    assert_eq!(warned(8399, ShortMove::Document).as_deref(), Some(warning));
    assert_eq!(warned(8400, ShortMove::Document), None);
    assert_eq!(warned(8399, ShortMove::TurnRound), None);
}

#[test]
fn an_entered_input_follows_the_rules_of_a_script() {
    let axis = Some(Axis { max_switch_at_steps: Some(9), ..Axis::default() });
    let inputs = vec![level(50, Signal::Clear, true)];
    let first = Parameters { inputs, axis, ..small() };
    let setup =
        Setup { clock_hz: 1000, channels: 2, pulse: crate::bench::PULSE, controllers: vec![first, small()] };
    let mut machine = StandAlone::new(&setup.check().unwrap());
    machine.run(Instant(20), &mut Vec::new());
    let mut enter = |at, controller, signal| {
        machine
            .enter(Instant(at), controller, Change::Level(signal, true))
            .map_err(|refused| refused.to_string())
    };
    let start = Signal::Start;
    assert_eq!(enter(20, 0, start), Ok(()));
    assert_eq!(enter(20, 1, start), Ok(()), "each controller has its own buttons");
    assert_eq!(enter(20, 2, start), Err(NotEntered::NoController.to_string()));
    let max = limits::INPUT_CYCLE.end();
    assert_eq!(enter(19, 0, start), Err(format!("cycle 19 is out of range; use 20 to {max}")));
    assert!(enter(20, 0, start).unwrap_err().contains("two entries"));
    assert!(enter(50, 0, Signal::Clear).unwrap_err().contains("two entries"));
    assert!(enter(60, 1, Signal::Clear).unwrap_err().contains("all controllers"));
    assert!(enter(60, 0, Signal::LimitMax).unwrap_err().contains("axis.max_switch_at_steps"));
    assert_eq!(enter(60, 1, Signal::LimitMax), Ok(()));
}
