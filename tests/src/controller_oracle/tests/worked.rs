//! Numbers of the text, checked by complete runs where they describe one.

use super::super::arithmetic::{Table, display_of_position, interval, steps_of_length};
use super::super::crc32c::crc32c;
use super::super::*;
use crate::xxh64::xxh64;

/// A bus of one controller with the paper's clock.
fn alone(controller: Controller) -> Case {
    Case {
        clock_hz: 16_000_000,
        channels: 1,
        w: 40,
        d: 40,
        h: 0,
        run_cycles: None,
        controllers: vec![controller],
    }
}

fn held(input: Input, from: u64, to: u64) -> [Entry; 2] {
    [(from, true), (to, false)].map(|(cycle, level)| Entry { cycle, what: What::Level(input, level) })
}

/// Presses of this number of cycles.
fn presses(of: &[(u64, Input)], cycles: u64) -> Vec<Entry> {
    of.iter().flat_map(|(at, input)| held(*input, *at, at + cycles)).collect()
}

/// Rises of channel 0.
fn rises(outcome: &Outcome) -> Vec<u64> {
    let step = |at: usize| outcome.trace[at].1 & 1;
    (1..outcome.trace.len())
        .filter(|at| step(*at) == 1 && step(at - 1) == 0)
        .map(|at| outcome.trace[at].0)
        .collect()
}

#[test]
fn crcs_and_digests_match_their_specifications() {
    assert_eq!(crc32c(b"123456789"), 0xE306_9283);
    assert_eq!(xxh64(b""), 0xEF46_DB37_51D8_E999);
    assert_eq!(
        journal_record(1, Content { position: -2, trust: 1, open: true, group: 3, of_loop: 4 }).len(),
        16
    );
}

#[test]
fn lengths_and_steps_convert_both_ways() {
    // (digits, N, d, steps)
    let rows = [(305, 565, 1, 17233), (-305, 565, 1, -17232), (1, 1, 1, 0), (5, 1, 1, 1), (0, 7, 3, 0)];
    for (digits, n, d, steps) in rows {
        assert_eq!(steps_of_length(digits, n, d), steps, "{digits}");
    }
    assert_eq!(display_of_position(17233, 565, 1), 305);
    assert_eq!(display_of_position(-17233, 565, 1), -305);
}

#[test]
fn the_acceleration_table_has_the_published_rows() {
    let table = Table::new(1000, 1000, 20_000);
    // The first 30 steps at f_1; Part E's row (1) is the second.
    for (step, rate) in [(1, 1000), (30, 1000), (31, 1030), (61, 1058), (91, 1086), (198_901, 19_970)] {
        assert_eq!(table.rate_of_step(step), rate, "{step}");
    }
    for (rate, steps) in [(500, 0), (1000, 0), (1001, 30), (1030, 30), (1031, 60), (20_000, 200_460)] {
        assert_eq!(table.steps_to(rate), steps, "{rate}");
    }
}

#[test]
fn a_fine_jog_of_half_a_second_at_10_hz_is_five_steps() {
    let mut inputs = presses(&[(4_000_000, Input::Debug)], 400_000);
    inputs.extend(held(Input::JogPlus, 8_000_000, 16_000_000));
    let outcome = run(&alone(Controller { inputs, ..Controller::default() }));
    let begin = 8_000_000 + 160_000;
    // The first step follows after Lm, the others at 10 Hz.
    let first = begin + 1 + 80;
    let expected: Vec<u64> = (0..5).map(|step| first + 1_600_000 * step).collect();
    assert_eq!(rises(&outcome), expected);
    assert_eq!(outcome.controllers[0].position, 5);
}

#[test]
fn a_move_begins_in_the_cycle_after_its_cause() {
    let group = Group::Move(Move { length: 3, speed_hz: 500, ..Move::default() });
    let inputs = held(Input::Start, 5000, 6000).to_vec();
    let memory = Memory { byte_write_cycles: 1, ..Memory::default() };
    let controller = Controller {
        debounce_cycles: 0,
        pulses_per_unit: 10,
        groups: vec![group],
        memory,
        inputs,
        ..Controller::default()
    };
    let outcome = run(&alone(controller));
    assert_eq!(rises(&outcome), [1, 2, 3].map(|step| 5001 + 32_000 * step));
    // DIR changes at the start; the move ends at the last fall, which the panel shows one cycle later.
    assert_eq!(outcome.trace[1], (5001, 7 << 32 | 1 << 16));
    let ready = outcome.controllers[0].panel.last().copied().unwrap();
    let end = 5001 + 3 * 32_000 + 40;
    assert_eq!(ready, PanelRecord { cycle: end + 1, word: 2 | 1 << 8, position: 3, display: 3 });
    assert_eq!(outcome.cycles, end + 2);
}

#[test]
fn a_controller_without_inputs_ends_when_its_record_is_written() {
    let outcome = run(&alone(Controller::default()));
    // Read in 1600, 16 bytes of 8.5 ms, shown one cycle later.
    let ready = 1600 + 16 * 136_000;
    let panel: Vec<(u64, u64)> =
        outcome.controllers[0].panel.iter().map(|record| (record.cycle, record.word)).collect();
    assert_eq!(panel, [(0, 1), (1601, 1 | 1 << 8), (ready + 1, 2 | 1 << 8)]);
    assert_eq!(outcome.cycles, ready + 2);
    assert_eq!(outcome.trace, [(0, 7 << 32)]);
}

#[test]
fn a_hold_up_time_of_17_bytes_minus_one_cycle_is_sufficient() {
    let w = 10;
    // The cut is in each cycle of the bytes while numbers are saved.
    let lost = |hold_up_cycles: u64| {
        (0..200)
            .filter(|phase| {
                let buttons = [
                    Input::Debug,
                    Input::Ok,
                    Input::Debug,
                    Input::System,
                    Input::Key(7),
                    Input::Ok,
                    Input::Back,
                ];
                let at: Vec<_> = (0..).map(|press| 500 + 3 * press).zip(buttons).collect();
                let mut inputs = presses(&at, 1);
                let cut = 500 + 3 * 6 + 20 + phase;
                inputs.push(Entry { cycle: cut, what: What::Level(Input::Power, false) });
                inputs.push(Entry { cycle: cut + 1000, what: What::Level(Input::Power, true) });
                let memory = Memory { byte_write_cycles: w, hold_up_cycles, ..Memory::default() };
                let controller = Controller {
                    self_test_cycles: 20,
                    debounce_cycles: 0,
                    memory,
                    inputs,
                    ..Controller::default()
                };
                run(&alone(controller)).controllers[0].trust == 0
            })
            .count()
    };
    assert_eq!(lost(17 * w - 1), 0);
    assert_ne!(lost(17 * w - 2), 0);
    // 8.5 ms per byte: 136 ms, at most 144.5 ms.
    assert_eq!((16 * 85, 17 * 85), (1360, 1445));
}

#[test]
fn eight_slots_of_100_000_writes_last_400_000_power_cycles() {
    let mut inputs = Vec::new();
    for cycle in 1..=16 {
        inputs.push(Entry { cycle: 2000 * cycle, what: What::Level(Input::Power, false) });
        inputs.push(Entry { cycle: 2000 * cycle + 600, what: What::Level(Input::Power, true) });
    }
    let memory = Memory { byte_write_cycles: 10, hold_up_cycles: 170, ..Memory::default() };
    let controller = Controller { self_test_cycles: 20, memory, inputs, ..Controller::default() };
    let outcome = run(&alone(controller));
    let most = outcome.controllers[0].writes.iter().max().copied().unwrap();
    // 16 power cycles are 32 records and the last opening one, over 8 slots.
    assert_eq!(most, 33u32.div_ceil(8));
}

#[test]
fn problems_have_their_documented_paths() {
    let groups = vec![
        Group::Home,
        Group::Jump { to: 9, input: None, level: true },
        Group::Repeat { first: 3, times: 2 },
        Group::Set { output: 0, level: true },
    ];
    let axis = Axis { max_switch_at_steps: Some(3), ..Axis::default() };
    let mut inputs = presses(&[(4000, Input::Start)], 5);
    inputs.extend(presses(&[(4000, Input::Start)], 6));
    inputs.extend(held(Input::LimitMax, 1, 2));
    let home = Some(Home { coarse_hz: 1500, ..Home::default() });
    let controller = Controller { groups, axis: Some(axis), inputs, ..Controller::default() };
    let mut case = alone(controller);
    case.clock_hz = 1_000_000;
    let expected = [
        "max_speed_hz",
        "groups[0].home",
        "groups[1].jump.to",
        "groups[2].repeat.first",
        "inputs[2]",
        "inputs[4]",
        "inputs[5]",
    ];
    assert_eq!(refused(&case), expected.map(|field| format!("source.standalone[0].{field}")));
    case.controllers[0] = Controller { home, max_speed_hz: 12_500, ..Controller::default() };
    assert_eq!(refused(&case), ["source.standalone[0].home.coarse_hz"]);
    assert_eq!(interval(1_000_000, 12_500), 80 << 16);
}

#[test]
fn endlessly_repeated_groups_are_rejected_as_too_much_work() {
    let inputs = held(Input::Start, 400, 401).to_vec();
    let groups = vec![Group::Set { output: 1, level: true }, Group::Jump { to: 1, input: None, level: true }];
    let memory = Memory { byte_write_cycles: 1, ..Memory::default() };
    let controller = Controller {
        self_test_cycles: 5,
        debounce_cycles: 0,
        groups,
        inputs,
        memory,
        ..Controller::default()
    };
    let outcome = run(&alone(controller));
    assert!(outcome.work.is_some());
    assert_eq!(outcome.controllers[0].groups_begun, 1_000_001);
}
