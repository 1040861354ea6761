//! Programs, pauses and moves, cycle-exact (G4, G5), with the small controller of `bench`.

use crate::bench::{level, pressed, presses, run, run_all, small, to_the_right};
use stepscope_controller::{
    input::Signal::{Clear, In0, LimitMax, Pause, Start},
    parameters::{
        Group, Jump, Move, MoveTo, Parameters, Policy, Profile, Repeat, Set, ShortMove, SoftLimits, Until,
        Wait,
    },
};

fn with(groups: Vec<Group>) -> Parameters {
    Parameters { groups, ..small() }
}

#[test]
fn the_self_test_ends_with_the_opening_record() {
    let run = run(small());
    assert_eq!(run.panel(), ["0 SelfTest t0 g0/0", "11 SelfTest t1 g0/0", "27 Ready t1 g0/0"]);
    assert_eq!((run.edges().as_str(), run.trace.len()), ("", 1));
}

#[test]
fn a_move_begins_in_the_cycle_of_the_press() {
    let run = pressed(small(), &[(30, Start)]);
    assert_eq!(run.edges(), "DIR+31 STEP+41 STEP-43 STEP+51 STEP-53 STEP+61 STEP-63");
    assert_eq!(run.panel_from(28), ["31 Running t1 g1/1", "64 Ready t1 g0/0"]);
    assert_eq!((run.position(), run.machine.display(0)), (3, Some(3)));
}

#[test]
fn a_press_in_the_last_cycle_of_self_test_is_lost() {
    for (at, expected) in [(26, 0), (27, 3)] {
        let run = pressed(small(), &[(at, Start)]);
        assert_eq!(run.position(), expected, "press in {at}");
        assert_eq!(run.machine.ignored(0).len(), usize::from(expected == 0));
    }
}

#[test]
fn groups_follow_in_the_next_cycle_or_after_their_delay() {
    let delayed = Group::Move(Move { length: 1, speed_hz: 100, delay_ms: 20, ..Move::default() });
    let parameters = Parameters { loops: 2, ..with(vec![delayed, Group::Set(Set::default())]) };
    let run = pressed(parameters, &[(30, Start)]);
    // STEP rises in 41 and falls in 43, which ends the move. 63 sets the output, 64 begins the second loop.
    let expected = [
        "31 Running t1 g1/1",
        "44 Delay t1 g2/1",
        "64 Running t1 g1/2",
        "78 Delay t1 g2/2",
        "98 Ready t1 g0/0",
    ];
    assert_eq!(run.panel_from(28), expected);
    assert_eq!(run.rises(), [41, 75]);
    assert_eq!(run.machine.outputs(0), Some(1));
}

#[test]
fn rounding_errors_do_not_add_up_over_loops() {
    // 0.3 units of 5 pulses are 1.5 steps.
    let parameters = Parameters { pulses_per_unit: 5, decimals: 1, loops: 10, ..with(vec![to_the_right(3)]) };
    let run = pressed(parameters.clone(), &[(30, Start)]);
    assert_eq!(run.position(), 15);
    let left = Group::Move(Move { length: 3, direction: 0, speed_hz: 100, ..Move::default() });
    assert_eq!(pressed(with(vec![left, to_the_right(5)]), &[(30, Start)]).position(), 2);
    let to = |length| Group::MoveTo(MoveTo { length, speed_hz: 100, ..MoveTo::default() });
    let run = pressed(Parameters { groups: vec![to_the_right(3), to(-4)], ..parameters }, &[(30, Start)]);
    assert_eq!(run.position(), -2, "P(-4) = floor(-1.5)");
}

#[test]
fn a_pause_without_a_ramp_stops_immediately_and_start_resumes() {
    // The step of 51 is pending, or its pulse is high.
    for (at, panel, rises) in [
        (45, ["46 Paused t1 g1/1", "101 Running t1 g1/1"], [41, 111, 121]),
        (52, ["53 Pausing t1 g1/1", "54 Paused t1 g1/1"], [41, 51, 111]),
    ] {
        let run = pressed(small(), &[(30, Start), (at, Pause), (100, Start)]);
        assert_eq!(run.panel_from(32)[..2], panel, "pause in {at}");
        assert_eq!((run.rises().as_slice(), run.position()), (&rises[..], 3));
    }
}

#[test]
fn start_during_a_pause_resumes_when_the_pulse_ends() {
    let run = pressed(small(), &[(30, Start), (51, Pause), (52, Start)]);
    assert_eq!(run.panel_from(32), ["52 Pausing t1 g1/1", "53 Running t1 g1/1", "67 Ready t1 g0/0"]);
    // The pulse of 51 falls in 53, where the move for the remaining step begins.
    assert_eq!(run.rises(), [41, 51, 54 + 10]);
}

#[test]
fn a_paused_delay_resumes_with_its_remaining_time() {
    let delayed = Group::Move(Move { length: 1, speed_hz: 100, delay_ms: 20, ..Move::default() });
    // The delay begins in 43 and ends in 63; 13 cycles are left in 50.
    let run = pressed(with(vec![delayed, to_the_right(1)]), &[(30, Start), (50, Pause), (90, Start)]);
    let expected = [
        "44 Delay t1 g2/1",
        "51 Paused t1 g2/1",
        "91 Delay t1 g2/1",
        "104 Running t1 g2/1",
        "117 Ready t1 g0/0",
    ];
    assert_eq!(run.panel_from(32), expected);
}

#[test]
fn a_pause_decelerates_and_start_accelerates_again() {
    let far = Group::Move(Move { length: 400, speed_hz: 200, level: 1, ..Move::default() });
    let short_move = ShortMove::TurnRound;
    let parameters = Parameters { level_hz_s: 500, short_move, ..with(vec![far]) };
    let whole = pressed(parameters.clone(), &[(30, Start)]);
    assert_eq!((whole.position(), whole.machine.trust(0)), (400, Some(1)));
    for (pause, start) in [(500, 520), (500, 600), (500, 2000), (1000, 1001), (1000, 1500)] {
        let run = pressed(parameters.clone(), &[(30, Start), (pause, Pause), (start, Start)]);
        assert_eq!((run.position(), run.end().as_str()), (400, "Ready"), "{pause} {start}");
        assert!(run.panel_from(pause)[0].contains("Pausing"));
        assert_eq!(run.machine.trust(0), Some(1), "the start-stop rate was not exceeded");
    }
}

#[test]
fn until_drops_the_remaining_steps_and_the_next_length_counts_from_there() {
    let until = Some(Until { input: In0, level: true });
    let groups =
        vec![Group::Move(Move { length: 100, speed_hz: 100, until, ..Move::default() }), to_the_right(2)];
    // In 55 the step of 61 is pending and is not executed. In 52 the pulse continues to 53.
    for (at, rises) in [(55, [41, 51, 67, 77]), (52, [41, 51, 65, 75])] {
        let mut inputs = presses(&[(30, Start)]);
        inputs.push(level(at, In0, true));
        let run = run(Parameters { inputs, ..with(groups.clone()) });
        assert_eq!((run.rises().as_slice(), run.position()), (&rises[..], 4), "{at}");
    }
    // The level is there before the move: the group ends in its first cycle.
    let mut inputs = presses(&[(30, Start)]);
    inputs.push(level(30, In0, true));
    let run = run(Parameters { inputs, ..with(groups) });
    assert_eq!(run.rises(), [42, 52]);
}

#[test]
fn a_wait_ends_with_its_level_or_its_timeout() {
    let wait = |then| Group::Wait(Wait { timeout_ms: 40, then, ..Wait::default() });
    // When in_0 rises, `then`, when the first step rises, final state.
    let rows = [
        (20, None, Some(42), "Ready"),
        (50, None, Some(50 + 1 + 11), "Ready"),
        (70, None, Some(70 + 1 + 11), "Ready"),
        (71, None, None, "Alarm:Timeout"),
        (71, Some(2), Some(70 + 1 + 11), "Ready"),
        (71, Some(3), None, "Ready"),
    ];
    for (at, then, rise, end) in rows {
        let mut inputs = presses(&[(30, Start)]);
        inputs.push(level(at, In0, true));
        let groups = vec![wait(then), to_the_right(1), Group::Set(Set::default())];
        let run = run(Parameters { inputs, ..with(groups) });
        assert_eq!((run.rises().first().copied(), run.end().as_str()), (rise, end), "{at} {then:?}");
    }
}

#[test]
fn repeats_nest_and_restart_in_each_loop() {
    let repeat = |first, times| Group::Repeat(Repeat { first, times });
    let groups = vec![to_the_right(1), repeat(1, 2), repeat(1, 3)];
    let run = pressed(Parameters { loops: 2, ..with(groups) }, &[(30, Start)]);
    assert_eq!((run.position(), run.end().as_str()), (2 * 3 * 2, "Ready"));
}

#[test]
fn an_endless_jump_ends_the_run_and_names_its_groups() {
    let jump = Group::Jump(Jump { to: 2, ..Jump::default() });
    let groups = vec![to_the_right(1), Group::Set(Set::default()), Group::Set(Set::default()), jump];
    let run = run_all(vec![Parameters { inputs: presses(&[(30, Start)]), ..with(groups) }], u64::MAX);
    let work = run.machine.too_many_groups().expect("the program is endless");
    assert_eq!((work.first_group, work.last_group, work.is_endless), (2, 4, true));
    assert!(work.to_string().contains("groups 2 to 4 repeat without end"), "{work}");
    assert!(run.machine.is_idle() && run.machine.cycles_until_event().is_none());
}

#[test]
fn a_limit_stops_the_next_step_but_not_a_pulse() {
    // When limit_max closes, rises, last panel record.
    for (at, rises, alarm) in [
        (20, vec![], "31 Alarm:Limit t1 g0/0"),
        (45, vec![41], "46 Alarm:Limit t1 g0/0"),
        (51, vec![41, 51], "54 Alarm:Limit t1 g0/0"),
        (61, vec![41, 51, 61], "64 Ready t1 g0/0"),
    ] {
        let mut inputs = presses(&[(30, Start)]);
        inputs.push(level(at, LimitMax, true));
        let run = run(Parameters { inputs, ..small() });
        assert_eq!((run.rises(), run.panel().last().map(String::as_str)), (rises, Some(alarm)), "{at}");
    }
}

#[test]
fn a_move_beyond_the_soft_limits_is_an_alarm() {
    for (max_steps, expected) in [(3, "Ready"), (2, "Alarm:SoftLimit")] {
        let soft_limits = Some(SoftLimits { min_steps: -1, max_steps });
        assert_eq!(pressed(Parameters { soft_limits, ..small() }, &[(30, Start)]).end(), expected);
    }
}

#[test]
fn a_profile_has_its_own_intervals_and_does_not_brake() {
    let intervals = vec![20 << 16, 15 << 16, 10 << 16 | 0x8000, 10 << 16 | 0x8000];
    let profile = Group::Profile(Profile { intervals, direction: 0, delay_ms: 0 });
    let run = pressed(with(vec![profile, to_the_right(1)]), &[(30, Start), (52, Pause), (200, Start)]);
    assert_eq!(run.rises()[..4], [51, 66, 76, 87]);
    assert_eq!(
        run.panel_from(53),
        ["53 Pausing t1 g1/1", "90 Paused t1 g2/1", "201 Running t1 g2/1", "215 Ready t1 g0/0"]
    );
    assert_eq!(run.position(), -3);
}

#[test]
fn start_requires_the_minimum_trust() {
    let rows = [
        (0, vec![(30, Start)], "Ready"),
        (1, vec![(30, Start)], "Ready"),
        (2, vec![(30, Start)], "Alarm:Trust"),
        (2, vec![(30, Start), (40, Clear)], "Ready"),
    ];
    for (least_trust, pressed_, expected) in rows {
        let run = pressed(Parameters { least_trust, ..small() }, &pressed_);
        assert_eq!(run.end(), expected, "{least_trust} {pressed_:?}");
    }
}

#[test]
fn with_write_ahead_a_move_waits_for_its_open_record() {
    let mut parameters = small();
    parameters.memory.policy = Policy::WriteAhead;
    // READY in 10; a closed record with trust 1 is written from 10 to 26, the open one from 30 to 46.
    let run = pressed(parameters, &[(30, Start)]);
    assert_eq!(run.panel()[..2], ["0 SelfTest t0 g0/0", "11 Ready t1 g0/0"]);
    assert_eq!(run.edges(), "DIR+47 STEP+57 STEP-59 STEP+67 STEP-69 STEP+77 STEP-79");
    assert_eq!(run.machine.position_after_power_up(0), Some((3, 1)));
    assert_eq!(run.machine.now().0, 1_000_000);
    let writes: u32 = run.machine.writes(0).iter().sum();
    assert_eq!(writes, 3 * 16, "closed, open, closed");
}
