//! Values at the ends of their ranges cause no overflow and no panic.

use crate::common::Random;
use stepscope_controller::{
    StandAlone,
    input::{Change, Input, Signal},
    parameters::{
        Axis, Group, Home, Initial, Jog, Memory, Move, MoveTo, Parameters, Policy, Profile, Release, Return,
        Setup, ShortMove, SoftLimits, Wait,
    },
};
use stepscope_peripheral::{
    segment::PulseTimes,
    signal::{Record, Sink},
    units::{Cycles, Instant},
};

const LAST_INPUT: u64 = 9_000_000_000_000_000;

/// Pauses a run after some records.
struct LimitedRecords(u32);

impl Sink for LimitedRecords {
    fn record(&mut self, _: Record) {
        self.0 = self.0.saturating_sub(1);
    }

    fn is_paused(&self) -> bool {
        self.0 == 0
    }
}

fn parameters(random: &mut Random, max_hz: u32) -> Parameters {
    let steps = |random: &mut Random| random.of(&[-(1_i64 << 31), -1, 0, 1, 1 << 31]);
    let speed = |random: &mut Random| random.of(&[10, max_hz]);
    let start_speed_hz = speed(random);
    let level = |random: &mut Random| random.of(&[1, 5]);
    let intervals = vec![random.of(&[1 << 50, u64::MAX]); 3];
    let groups = vec![
        Group::Move(Move {
            length: random.of(&[0, 1, 999_999]),
            direction: random.below(2) as u8,
            speed_hz: speed(random),
            level: level(random),
            delay_ms: random.of(&[0, 999_999]),
            until: None,
        }),
        Group::MoveTo(MoveTo {
            length: random.of(&[-999_999, 0, 999_999]),
            speed_hz: speed(random),
            level: level(random),
            delay_ms: 0,
        }),
        Group::Profile(Profile { intervals, direction: random.below(2) as u8, delay_ms: 999_999 }),
        Group::Wait(Wait { timeout_ms: 1_000_000_000, ..Wait::default() }),
    ];
    let first = random.below(4) as usize;
    let groups = groups.into_iter().cycle().skip(first).take(4).collect();
    let buttons = [Signal::Start, Signal::JogPlus, Signal::Zero, Signal::Home, Signal::Clear, Signal::Pause];
    let inputs = (0..8).map(|index| {
        let cycle = random.of(&[1_000_000, 3_000_000_000, 1 << 40, LAST_INPUT - 1000]) + index;
        Input { cycle: Instant(cycle), change: Change::Level(random.of(&buttons), index % 2 == 0) }
    });
    let inputs = inputs.collect();
    let mut record = vec![9, 0, 0, 0];
    record.extend(random.of(&[i32::MIN, -1, i32::MAX]).to_le_bytes());
    record.extend([2, 0, 0, 0]);
    record.extend(crc::Crc::<u32>::new(&crc::CRC_32_ISCSI).checksum(&record).to_le_bytes());
    Parameters {
        self_test_cycles: random.of(&[1, u32::MAX]),
        debounce_cycles: random.of(&[0, 1_000_000_000]),
        pulses_per_unit: random.of(&[1, 999_999]),
        decimals: random.of(&[0, 3]),
        start_speed_hz,
        max_speed_hz: max_hz,
        level_hz_s: random.of(&[1, 1_000_000]),
        short_move: random.of(&[ShortMove::Document, ShortMove::TurnRound]),
        least_trust: 0,
        loops: 9999,
        groups,
        jog: Jog {
            speed_hz: speed(random),
            fine_hz: speed(random),
            level: 5,
            release: random.of(&[Release::AtOnce, Release::Ramp]),
        },
        return_: Return { speed_hz: speed(random), level: 5 },
        home: random.one_in(2).then(|| Home {
            position_steps: steps(random),
            coarse_hz: 10,
            ..Home::default()
        }),
        soft_limits: random.one_in(3).then_some(SoftLimits { min_steps: -(1 << 31), max_steps: 1 << 31 }),
        axis: random.one_in(2).then(|| Axis {
            start_steps: steps(random),
            home_from_steps: random.one_in(2).then_some(steps(random)),
            hard_min_steps: random.one_in(2).then_some(steps(random)),
            hard_max_steps: random.one_in(2).then_some(steps(random)),
            ..Axis::default()
        }),
        memory: Memory {
            policy: random.of(&[Policy::PowerLoss, Policy::WriteAhead]),
            byte_write_cycles: random.of(&[1, 1_000_000_000]),
            hold_up_cycles: random.of(&[0, 1_000_000_000_000]),
            slots: random.of(&[2, 200]),
            initial: Initial::Bytes(record),
        },
        inputs,
        ..Parameters::default()
    }
}

#[test]
fn values_at_the_ends_of_their_ranges_run() {
    let mut runs = 0;
    for seed in 0..2000 {
        let random = &mut Random(seed);
        let times = random.of(&[(1, 0, 0), (40, 40, 0), (1_000_000_000, 1_000_000_000, 1_000_000_000)]);
        let pulse = PulseTimes { width: Cycles(times.0), setup: Cycles(times.1), hold: Cycles(times.2) };
        let clock_hz = random.of(&[20, 16_000_000, 1_000_000_000]);
        let max_hz = (u64::from(clock_hz) / pulse.min_interval().0).min(10_000_000) as u32;
        if max_hz < 10 {
            continue;
        }
        let mut parameters = parameters(random, max_hz);
        if let Some(axis) = &mut parameters.axis {
            axis.home_to_steps = axis.home_from_steps;
        }
        let mut seen = Vec::new();
        parameters.inputs.retain(|input| {
            let key = (input.cycle, input.change.name());
            let is_new = !seen.contains(&key);
            seen.push(key);
            is_new
        });
        let setup = Setup { clock_hz, channels: 1, pulse, controllers: vec![parameters] };
        let checked = setup.check().unwrap_or_else(|refused| panic!("seed {seed}: {refused:?}"));
        let mut machine = StandAlone::new(&checked);
        machine.run(Instant::NEVER, &mut LimitedRecords(300));
        machine.run(Instant(machine.now().0 + 1000), &mut LimitedRecords(300));
        runs += 1;
    }
    assert!(runs > 500, "{runs} runs");
}
