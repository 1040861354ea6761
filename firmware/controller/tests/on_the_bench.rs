//! Runs the program on the simulated chip: edges and panel equal those of the simulation, late interrupts only delay edges,
//! and the memory is correct after any power cut.
#![allow(clippy::expect_used, reason = "a test fails by panicking")]

use core::ops::ControlFlow;
use stepscope_controller::{
    Alarm, CheckedSetup, NotRunnable, Runner, State,
    chip::Chip,
    input::{Change, Input, Signal},
    panel,
    parameters::{Axis, Group, Jump, Memory, Move, Parameters, Policy, Setup},
};
use stepscope_controller_firmware::{bench::Bench, run};
use stepscope_core::{
    peripheral::{
        signal::{Levels, Record},
        trace::Digest,
        units::Instant,
    },
    sim::Experiment,
};

macro_rules! case {
    ($scenario:expr, $folder:expr) => {
        (
            include_str!($scenario),
            include_str!(concat!("../../../tests/golden/", $folder, "/digest")),
            include_str!(concat!("../../../tests/golden/", $folder, "/status")),
        )
    };
}
macro_rules! preset {
    ($id:literal) => {
        case!(concat!("../../../core/scenario/presets/", $id, ".json"), concat!("preset-", $id))
    };
}
type Case = (&'static str, &'static str, &'static str);

const POWER_CUT: Case = preset!("controller-power-cut");
const PROGRAM: Case = preset!("zhang-2012-program");

fn cases() -> [Case; 8] {
    [
        preset!("zhang-2012-controller"),
        PROGRAM,
        preset!("zhang-2012-zero-by-jog"),
        preset!("controller-emergency-stop"),
        POWER_CUT,
        preset!("controller-power-cut-lost"),
        case!("../../../tests/golden/controller-cut-in-a-byte/scenario.json", "controller-cut-in-a-byte"),
        case!("../../../tests/golden/controller-tap-of-a-jog/scenario.json", "controller-tap-of-a-jog"),
    ]
}

/// The setup of a scenario without its axis, and its script of inputs: the chip gets both separately.
fn split(json: &str) -> (CheckedSetup, Vec<Input>) {
    let experiment = Experiment::from_json(json).expect("a valid scenario");
    let mut setup = experiment.stand_alone().expect("controllers").setup();
    let inputs = std::mem::take(&mut setup.controllers[0].inputs);
    setup.controllers[0].axis = None;
    (setup.check().expect("a valid setup"), inputs)
}

fn checked(parameters: Parameters) -> CheckedSetup {
    Setup { controllers: vec![parameters], ..Setup::default() }.check().expect("a valid setup")
}

fn level(cycle: u64, signal: Signal, level: bool) -> Input {
    Input { cycle: Instant(cycle), change: Change::Level(signal, level) }
}

/// Press start at tick 3 200 000 for 0.1 s, after the self-test.
fn start() -> [Input; 2] {
    [level(3_200_000, Signal::Start, true), level(4_800_000, Signal::Start, false)]
}

/// Repeatable random numbers (xorshift64).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % limit.max(1)
    }
}

#[test]
fn pins_and_panel_equal_those_of_the_simulation() {
    for (json, digest, status) in cases() {
        let (checked, inputs) = split(json);
        let mut chip = Bench::new(&checked, inputs, Digest::default());
        let runner = run(&mut chip, &checked, |chip, _, wake| chip.sleep(wake, 0)).expect("one controller");
        assert_eq!(format!("{:016x}", chip.sink.value()), digest.trim(), "{json}");
        let panels = format!("panels {:016x}", panel::digest([chip.shown.as_slice()]));
        assert!(status.lines().any(|line| line == panels), "{panels} differs from {json}");
        assert_eq!(runner.lateness().total.0, 0);
    }
}

#[test]
fn a_power_cut_and_restart_have_the_edges_of_the_simulation() {
    let (checked, inputs) = split(POWER_CUT.0);
    let (dies, back) = (Instant(11_200_000 + 3_200_000), Instant(27_200_000));
    let mut chip = Bench::new(&checked, inputs, Digest::default());
    run(
        &mut chip,
        &checked,
        |chip, _, wake| {
            if chip.now() == dies { ControlFlow::Break(()) } else { chip.sleep(wake, 0) }
        },
    )
    .expect("one controller");
    chip.power_off();
    // It wakes in the cycle after power returns, like a machine without power.
    while chip.now() <= back {
        let _ = chip.sleep(Some(Instant(back.0 + 1)), 0);
        chip.inputs();
    }
    let runner = run(&mut chip, &checked, |chip, _, wake| chip.sleep(wake, 0)).expect("one controller");
    assert_eq!(format!("{:016x}", chip.sink.value()), POWER_CUT.1.trim());
    assert_eq!(runner.machine().position(0).map(i64::from), Some(chip.position));
}

#[test]
fn late_interrupts_delay_edges_without_losing_or_crowding_them() {
    let (checked, inputs) = split(PROGRAM.0);
    let mut in_time = Bench::new(&checked, inputs.clone(), Vec::<Record>::new());
    run(&mut in_time, &checked, |chip, _, wake| chip.sleep(wake, 0)).expect("one controller");
    // From less than a pulse to more than a step interval.
    for max_late in [30, 500, 20_000] {
        let mut random = Random(max_late);
        let mut chip = Bench::new(&checked, inputs.clone(), Vec::<Record>::new());
        let mut totals = Vec::new();
        let runner = run(&mut chip, &checked, |chip, runner, wake| {
            totals.resize(chip.sink.len(), runner.lateness().total.0);
            chip.sleep(wake, random.below(max_late + 1))
        })
        .expect("one controller");
        assert_eq!(chip.sink.len(), in_time.sink.len(), "{max_late}");
        assert_eq!((chip.position, runner.machine().position(0)), (in_time.position, Some(0)));
        let lateness = runner.lateness();
        assert!(lateness.worst.0 <= max_late && lateness.total >= lateness.worst && lateness.total.0 > 0);

        // Without the lateness all edges after the press have the same cycles.
        let cycle = |index: usize| (chip.sink[index].cycle.0 - totals[index]).cast_signed();
        let press = cycle(1) - in_time.sink[1].cycle.0.cast_signed();
        for (index, (edge, expected)) in chip.sink.iter().zip(&in_time.sink).enumerate().skip(1) {
            assert_eq!(edge.levels, expected.levels, "{index}");
            assert_eq!(cycle(index), expected.cycle.0.cast_signed() + press, "{index}");
        }
        for (late, exact) in chip.sink.windows(2).zip(in_time.sink.windows(2)).skip(1) {
            assert!(late[1].cycle.0 - late[0].cycle.0 >= exact[1].cycle.0 - exact[0].cycle.0);
        }
    }
}

#[test]
fn the_eeprom_is_correct_after_a_power_cut_in_any_tick() {
    let mut random = Random(2012);
    let (mut known, mut lost) = (0, 0);
    for policy in [Policy::PowerLoss, Policy::WriteAhead] {
        for round in 0..400 {
            // The data sheet allows 1000 ticks per byte; the test uses up to twice as many.
            let memory =
                Memory { policy, byte_write_cycles: 1000, hold_up_cycles: 18_000, ..Memory::default() };
            let long = Move { length: 5, speed_hz: 1000, delay_ms: 3, ..Move::default() };
            let back = Move { length: 2, direction: 0, ..long.clone() };
            let groups = vec![Group::Move(long), Group::Move(back)];
            let checked = checked(Parameters {
                groups,
                memory,
                debounce_cycles: 10,
                loops: 2,
                ..Parameters::default()
            });
            // Start at tick 30 000; the program ends about 2.4 million later. The cut may be announced.
            let (cut, is_announced) = (20_000 + random.below(4_000_000), round % 2 == 0);
            let mut inputs = vec![level(30_000, Signal::Start, true), level(40_000, Signal::Start, false)];
            if is_announced {
                inputs.push(level(cut, Signal::Power, false));
            }
            let mut chip = Bench::new(&checked, inputs, Digest::default());
            chip.byte_write_ticks = 500 + random.below(1500);
            let dies = cut + if is_announced { random.below(36_000) } else { 0 };
            let max_late = [1, 30, 2000][round % 3];
            run(&mut chip, &checked, |chip, _, wake| {
                let wake = wake.map_or(dies, |wake| wake.0.min(dies));
                let slept = chip.sleep(Some(Instant(wake)), random.below(max_late));
                if chip.now().0 >= dies { ControlFlow::Break(()) } else { slept }
            })
            .expect("one controller");
            chip.power_off();
            let runner = Runner::power_up(chip.now(), &checked, &mut chip).expect("one controller");
            match runner.machine().position_after_power_up(0) {
                Some((position, 1..)) => {
                    assert_eq!(i64::from(position), chip.position, "{policy:?} {round}: cut in {cut}");
                    known += 1;
                }
                _ => lost += 1,
            }
        }
    }
    assert!(known > 100 && lost > 100, "both outcomes must occur: {known} known, {lost} lost");
}

#[test]
fn no_step_rises_before_a_slow_eeprom_has_stored_the_opening_record() {
    for policy in [Policy::PowerLoss, Policy::WriteAhead] {
        let memory = Memory { policy, byte_write_cycles: 1000, ..Memory::default() };
        let group = Group::Move(Move { length: 1, ..Move::default() });
        let checked = checked(Parameters { groups: vec![group], memory, ..Parameters::default() });
        let inputs = [level(10_000, Signal::Start, true), level(400_000, Signal::Start, false)];
        let mut chip = Bench::new(&checked, inputs, Vec::<Record>::new());
        chip.byte_write_ticks = 50_000;
        run(&mut chip, &checked, |chip, _, wake| chip.sleep(wake, 0)).expect("one controller");
        let first = chip.sink.iter().find(|edge| edge.levels.step() != 0).map(|edge| edge.cycle.0);
        // With `power_loss` the record is written in the self-test, during the press.
        let expected = (policy == Policy::WriteAhead).then_some(10_000 + 16 * 50_000);
        assert_eq!(first.is_some(), expected.is_some(), "{policy:?}");
        assert!(first >= expected, "{first:?}");
        assert_eq!(chip.position, if expected.is_some() { 10 } else { 0 });
    }
}

#[test]
fn buttons_held_at_power_up_are_no_presses_but_an_emergency_stop_disables_the_driver() {
    let rows = [(Signal::Start, State::Ready, true), (Signal::Estop, State::Alarm, false)];
    for (signal, expected, is_on) in rows {
        let checked = checked(Parameters::default());
        let mut chip = Bench::new(&checked, [level(0, signal, true)], Vec::<Record>::new());
        let runner = run(&mut chip, &checked, |chip, _, wake| chip.sleep(wake, 0)).expect("one controller");
        assert_eq!(runner.machine().state(0), Some(expected), "{signal:?}");
        assert!(chip.sink.iter().all(|edge| edge.levels.has(Levels::EN) == is_on && edge.levels.step() == 0));
    }
}

#[test]
fn a_limit_switch_closed_at_power_up_raises_an_alarm() {
    let checked = checked(Parameters::default());
    let closed = level(0, Signal::LimitMax, true);
    let mut chip = Bench::new(&checked, start().into_iter().chain([closed]), Digest::default());
    let runner = run(&mut chip, &checked, |chip, _, wake| chip.sleep(wake, 0)).expect("one controller");
    assert_eq!((runner.machine().alarm(0), chip.position), (Some(Alarm::Limit), 0));
}

#[test]
fn an_emergency_stop_takes_effect_at_the_next_poll() {
    let checked = checked(Parameters::default());
    for max_late in [0, 7, 3000, 100_000] {
        let pressed = 12_345_678;
        let inputs = start().into_iter().chain([level(pressed, Signal::Estop, true)]);
        let (mut chip, mut random) = (Bench::new(&checked, inputs, Vec::<Record>::new()), Random(7));
        run(&mut chip, &checked, |chip, _, wake| chip.sleep(wake, random.below(max_late + 1)))
            .expect("one controller");
        let off = chip.sink.iter().find(|edge| !edge.levels.has(Levels::EN)).expect("EN falls");
        assert!(
            (pressed + 1..=pressed + 1 + 2 * max_late).contains(&off.cycle.0),
            "{max_late}: {}",
            off.cycle.0
        );
        assert_eq!((off.levels.step(), chip.sink.last()), (0, Some(off)));
    }
}

#[test]
fn homing_finds_the_position_of_a_real_switch() {
    let json = include_str!("../../../core/scenario/presets/controller-homing.json");
    for max_late in [0, 40, 5000] {
        let (checked, inputs) = split(json);
        let (mut chip, mut random) = (Bench::new(&checked, inputs, Digest::default()), Random(9));
        (chip.position, chip.home_switch) = (800, Some((-30, 0)));
        let runner = run(&mut chip, &checked, |chip, _, wake| chip.sleep(wake, random.below(max_late + 1)))
            .expect("one controller");
        let machine = runner.machine();
        assert_eq!(
            (machine.position(0), machine.trust(0), chip.position),
            (Some(0), Some(2), 0),
            "{max_late}"
        );
    }
}

#[test]
fn an_endless_program_neither_blocks_the_chip_nor_fills_its_memory() {
    let groups = vec![Group::Jump(Jump::default())];
    let checked = checked(Parameters { groups, debounce_cycles: 0, ..Parameters::default() });
    let (mut chip, mut polls) = (Bench::new(&checked, start(), Digest::default()), 0);
    let runner = run(&mut chip, &checked, |chip, _, wake| {
        polls += 1;
        if polls > 1_100_000 { ControlFlow::Break(()) } else { chip.sleep(wake, 0) }
    })
    .expect("one controller");
    let machine = runner.machine();
    assert_eq!(
        (machine.state(0), machine.too_many_groups(), machine.panel(0).len()),
        (Some(State::Running), None, 0)
    );
}

#[test]
fn several_controllers_and_virtual_axes_are_refused() {
    let two = Setup { channels: 2, controllers: vec![Parameters::default(); 2], ..Setup::default() };
    let axis = Parameters { axis: Some(Axis::default()), ..Parameters::default() };
    for (checked, expected, text) in [
        (
            two.check().expect("a valid setup"),
            NotRunnable::Controllers(2),
            "2 controllers do not fit on a chip; use one per chip",
        ),
        (
            checked(axis),
            NotRunnable::Axis,
            "axis: a virtual axis cannot drive the real switches of a chip; remove it",
        ),
    ] {
        let mut chip = Bench::new(&checked, [], Digest::default());
        let refused = Runner::power_up(Instant(0), &checked, &mut chip).map(|_| ());
        assert_eq!(refused, Err(expected));
        assert_eq!(expected.to_string(), text);
    }
}

#[test]
fn early_and_repeated_polls_have_no_effect() {
    let (checked, inputs) = split(POWER_CUT.0);
    let mut chip = Bench::new(&checked, inputs, Digest::default());
    let mut random = Random(3);
    run(&mut chip, &checked, |chip, _, wake| {
        let early = wake.map(|wake| Instant(wake.0 - random.below(wake.0 - chip.now().0 + 1)));
        chip.sleep(early, 0)
    })
    .expect("one controller");
    assert_eq!(format!("{:016x}", chip.sink.value()), POWER_CUT.1.trim());
}
