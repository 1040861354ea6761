//! Power cuts and memory (G2, G7): when records are written, the memory after a cut, and the position after it.

use crate::{
    bench::{self, level, presses, run, small},
    common,
};
use stepscope_controller::{
    StandAlone,
    input::Signal::{Back, Estop, Key4, Ok as OkButton, Power, Start, System},
    parameters::{Initial, Parameters, Policy, Setup},
};
use stepscope_peripheral::{signal::Record, units::Instant};

/// The same controller with a power cut.
fn cut(parameters: Parameters, falls: u64, back: u64) -> Parameters {
    let mut inputs = parameters.inputs.clone();
    inputs.extend([level(falls, Power, false), level(back, Power, true)]);
    Parameters { inputs, ..parameters }
}

#[test]
fn a_record_of_16_bytes_of_8_5_ms_takes_136_ms() {
    let setup = Setup::default();
    let mut machine = StandAlone::new(&setup.check().unwrap());
    machine.run(Instant::NEVER, &mut Vec::new());
    // Memory is read in 1600; READY appears in the cycle after the record is complete.
    assert_eq!(machine.panel(0).last().map(|record| record.cycle.0), Some(1600 + 136 * 16_000 + 1));
    assert_eq!(17 * 136_000, 2_312_000, "144.5 ms at 16 MHz");
}

#[test]
fn a_cut_stops_the_motor_closes_the_record_and_switches_off() {
    let parameters = Parameters { inputs: presses(&[(30, Start)]), ..small() };
    let run = run(cut(parameters, 51, 500));
    assert_eq!(run.edges(), "DIR+31 STEP+41 STEP-43 STEP+51 STEP-52 EN-52 DIR-152 EN+501");
    let expected = [
        "31 Running t1 g1/1",
        "52 PowerLoss t1 g0/0",
        "152 Off t0 g0/0",
        "501 SelfTest t0 g0/0",
        "512 SelfTest t1 g0/0",
        "528 Ready t1 g0/0",
    ];
    assert_eq!(run.panel_from(28), expected);
    assert_eq!(run.position(), 2, "the cut pulse counts");
}

#[test]
fn power_back_within_the_hold_up_time_restarts_after_the_closing_record() {
    // When power is back, first cycle of the restart. The closing record is written from 51 to 67.
    for (back, restart) in [(52, 68), (66, 68), (67, 68), (68, 69), (151, 152)] {
        let parameters = Parameters { inputs: presses(&[(30, Start)]), ..small() };
        let run = run(cut(parameters, 51, back));
        assert!(run.panel().contains(&format!("{restart} SelfTest t0 g0/0")), "{back}: {:?}", run.panel());
        assert_eq!(run.position(), 2, "{back}");
    }
}

#[test]
fn an_e_stop_held_through_a_restart_keeps_the_motor_off() {
    let inputs = vec![level(100, Power, false), level(150, Estop, true), level(300, Power, true)];
    let run = run(Parameters { inputs, ..small() });
    assert_eq!(run.edges(), "EN-101");
    assert_eq!(run.end(), "Alarm:Estop");
}

#[test]
fn without_hold_up_time_it_switches_off_immediately() {
    let mut parameters = small();
    parameters.memory.hold_up_cycles = 0;
    let run = run(cut(parameters, 100, 200));
    assert_eq!(run.panel_from(28)[..2], ["101 Off t0 g0/0", "201 SelfTest t0 g0/0"]);
    assert_eq!(run.end(), "Ready", "the open record remains: its position, trust 0");
    assert_eq!(run.machine.trust(0), Some(0));
}

#[test]
fn a_memory_without_a_record_is_an_alarm() {
    for policy in [Policy::PowerLoss, Policy::WriteAhead] {
        let mut parameters = small();
        (parameters.memory.policy, parameters.memory.initial) = (policy, Initial::Blank);
        assert_eq!(run(parameters).end(), "Alarm:Memory", "{policy:?}");
    }
}

#[test]
fn a_hold_up_time_of_17_bytes_minus_one_cycle_is_the_minimum() {
    // Byte write time w, hold-up = 17*w - less, whether every cut leaves the position known during a save of numbers.
    for (w, less, expected) in [(7, 1, true), (7, 2, false), (1, 1, true), (1, 2, false), (2, 2, false)] {
        let mut parameters = small();
        parameters.memory.byte_write_cycles = w;
        parameters.memory.hold_up_cycles = 17 * u64::from(w) - less;
        parameters.inputs = presses(&[(300, System), (302, Key4), (304, OkButton), (306, Back)]);
        let known = (306..306 + 50 * u64::from(w)).filter(|&falls| {
            let run = run(Parameters {
                inputs: cut(parameters.clone(), falls, 100_000).inputs,
                ..parameters.clone()
            });
            run.machine.trust(0) == Some(1)
        });
        assert_eq!(known.count() as u64 == 50 * u64::from(w), expected, "w = {w}, 17*w - {less}");
    }
}

#[test]
fn a_trusted_position_after_any_cut_is_correct() {
    let mut known = [0_u32; 2];
    for policy in [Policy::PowerLoss, Policy::WriteAhead] {
        for hold_up_cycles in [0, 5, 16, 40] {
            for falls in 1..260 {
                let mut parameters = Parameters { inputs: presses(&[(50, Start), (90, Start)]), ..small() };
                parameters.memory.policy = policy;
                parameters.memory.hold_up_cycles = hold_up_cycles;
                parameters.memory.byte_write_cycles = 2;
                let run =
                    run(Parameters { inputs: cut(parameters.clone(), falls, 5000).inputs, ..parameters });
                let trust = run.machine.trust(0).unwrap();
                if trust > 0 {
                    assert_eq!(
                        run.position(),
                        run.machine.positions()[0],
                        "{policy:?} {hold_up_cycles} {falls}"
                    );
                }
                known[usize::from(trust > 0)] += 1;
            }
        }
    }
    assert!(known[0] > 100 && known[1] > 1000, "{known:?}");
}

#[test]
fn a_run_with_the_maximum_sequence_number_ends() {
    for policy in [Policy::PowerLoss, Policy::WriteAhead] {
        let mut record = vec![0xff, 0xff, 0xff, 0xff, 5, 0, 0, 0, 2, 0, 0, 0];
        let check = crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&record);
        record.extend(check.to_le_bytes());
        let mut parameters = Parameters { inputs: presses(&[(50, Start)]), ..small() };
        (parameters.memory.policy, parameters.memory.initial) = (policy, Initial::Bytes(record));
        let setup =
            Setup { clock_hz: 1000, pulse: bench::PULSE, controllers: vec![parameters], ..Setup::default() };
        let mut machine = StandAlone::new(&setup.check().unwrap());
        let mut trace: Vec<Record> = Vec::new();
        machine.run(Instant::NEVER, &mut trace);
        assert!(machine.is_idle() && machine.position(0) == Some(5), "{policy:?}: no record can be newer");
        let now = machine.now();
        machine.run(Instant(now.0 + 1000), &mut trace);
        assert_eq!(machine.now(), Instant(now.0 + 1000));
    }
}

#[test]
fn random_runs_with_cuts_never_trust_a_wrong_position() {
    for seed in 0..300 {
        let mut setup = common::setup(seed);
        for controller in &mut setup.controllers {
            // Without inputs and groups that set a new position.
            controller.memory.initial = Initial::Factory;
            controller.home = None;
            controller.groups.retain(|group| !matches!(group, stepscope_controller::parameters::Group::Home));
            if controller.groups.is_empty() {
                controller.groups.push(bench::to_the_right(3));
            }
            controller
                .inputs
                .retain(|input| input.change.name() != "ok" && input.change.name() != "push_steps");
        }
        let Ok(checked) = setup.check() else { continue };
        let mut machine = StandAlone::new(&checked);
        for until in (100..20_000).step_by(97) {
            machine.run(Instant(until), &mut Vec::new());
            for i in 0..checked.controllers().len() {
                if let Some((position, 1..)) = machine.position_after_power_up(i) {
                    assert_eq!(
                        position,
                        machine.positions()[i],
                        "seed {seed}, cycle {until}, controller {i}"
                    );
                }
            }
        }
    }
}
