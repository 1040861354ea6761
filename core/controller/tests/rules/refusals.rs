//! What is refused, with its numbers, and what is only warned of (CONTROLLER.md, "Refused").

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

/// What is refused of one controller at 1 MHz with the bus's own times.
fn refused(parameters: Parameters) -> Vec<String> {
    let setup = Setup { clock_hz: 1_000_000, controllers: vec![parameters], ..Setup::default() };
    setup.check().err().unwrap_or_default().iter().map(ToString::to_string).collect()
}

/// A controller that holds at 1 MHz: a pulse takes 80 cycles.
fn good() -> Parameters {
    Parameters { max_speed_hz: 12_500, ..Parameters::default() }
}

#[test]
fn the_contracts_own_examples_are_refused_in_its_words() {
    let rows = [
        (
            Parameters { max_speed_hz: 20_000, ..good() },
            "controller 0: max_speed_hz: 20000 Hz is a step every 50 cycles at this clock; W + max(H + D, 1) is 80 cycles, so \
             at most 12500 Hz",
        ),
        (
            Parameters { home: Some(Home { coarse_hz: 1500, ..Home::default() }), ..good() },
            "controller 0: home.coarse_hz: 1500 Hz is above start_speed_hz 1000: homing stops at once and must stay in the \
             start-stop range",
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
            "controller 0: groups[2].repeat.first: 3 is not before this group (3); give a group before it",
        ),
        (
            Parameters {
                groups: vec![Group::Jump(Jump { to: 9, ..Jump::default() }); 4].into_iter().take(4).collect(),
                ..good()
            },
            "controller 0: groups[0].jump.to: 9, but there are 4 groups; give 1 to 4",
        ),
        (
            Parameters { groups: vec![Group::Home], ..good() },
            "controller 0: groups[0].home: there is no `home`; give one or leave the group out",
        ),
        (
            Parameters {
                axis: Some(Axis { max_switch_at_steps: Some(5), ..Axis::default() }),
                inputs: vec![level(7, Signal::LimitMax, true)],
                ..good()
            },
            "controller 0: inputs[0]: limit_max is driven by axis.max_switch_at_steps; leave one of them out",
        ),
        (
            Parameters {
                inputs: vec![level(4000, Signal::Start, true), level(4000, Signal::Start, false)],
                ..good()
            },
            "controller 0: inputs[1]: start has two levels at cycle 4000; give one",
        ),
        (
            Parameters {
                groups: vec![Group::Profile(Profile {
                    intervals: vec![80 << 16, (80 << 16) - 1],
                    ..Profile::default()
                })],
                ..good()
            },
            "controller 0: groups[0].profile.intervals_q16[1]: 5242879/65536 cycle is shorter than a pulse allows; W + max(H \
             + D, 1) is 5242880/65536 cycle, so give at least that",
        ),
    ];
    for (parameters, expected) in rows {
        assert_eq!(refused(parameters)[0], expected);
    }
    assert_eq!(refused(good()), Vec::<String>::new());
}

#[test]
fn each_other_rule_names_its_field() {
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
fn all_problems_are_reported_at_once_and_those_of_the_bus_too() {
    let second = Parameters { inputs: vec![level(9, Signal::Power, false)], decimals: 9, ..good() };
    let setup = Setup { channels: 1, controllers: vec![good(), second], ..Setup::default() };
    let refused: Vec<String> = setup.check().unwrap_err().iter().map(ToString::to_string).collect();
    let expected = [
        "source.standalone: 2 is out of range; give 1 to 1",
        "controller 1: decimals: 9 is out of range; give 0 to 3",
        "controller 1: inputs[0]: power is for all controllers and the first one's; leave it out here",
    ];
    assert_eq!(refused, expected);
}

#[test]
fn warnings_tell_of_what_may_not_be_meant() {
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

/// G3: 36 rows from 1000 at 3000 Hz/s, 4200 steps, come to 5119 Hz.
#[test]
fn a_move_that_never_comes_to_its_speed_is_reported() {
    let warned = |length, short_move| {
        let own = Move { length, speed_hz: 5000, level: 3, ..Move::default() };
        let groups = vec![Group::Home, Group::Move(own)];
        let home = Some(Home::default());
        let numbers =
            Parameters { pulses_per_unit: 1, decimals: 0, groups, home, short_move, ..Parameters::default() };
        let checked = Setup { controllers: vec![numbers], ..Setup::default() }.check().unwrap();
        checked.warnings().first().map(ToString::to_string)
    };
    let warning = "controller 0: groups[1].move.speed_hz: 8399 steps are too short for 5000 Hz, which takes 8400 up and down: the \
                whole move goes at 1000 Hz; a higher level needs fewer, and short_move \"reverse\" goes up as far as they allow";
    assert_eq!(warned(8399, ShortMove::Document).as_deref(), Some(warning));
    assert_eq!(warned(8400, ShortMove::Document), None);
    assert_eq!(warned(8399, ShortMove::TurnRound), None);
}

#[test]
fn a_live_input_is_held_to_the_rules_of_a_script() {
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
    let most = limits::INPUT_CYCLE.end();
    assert_eq!(enter(19, 0, start), Err(format!("cycle 19 is out of range; give 20 to {most}")));
    assert!(enter(20, 0, start).unwrap_err().contains("two levels"));
    assert!(enter(50, 0, Signal::Clear).unwrap_err().contains("two levels"));
    assert!(enter(60, 1, Signal::Clear).unwrap_err().contains("for all"));
    assert!(enter(60, 0, Signal::LimitMax).unwrap_err().contains("axis.max_switch_at_steps"));
    assert_eq!(enter(60, 1, Signal::LimitMax), Ok(()));
}
