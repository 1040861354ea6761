//! Random controllers with small numbers, so that all events are within some 10^5 cycles.

use stepscope_controller::{
    input::{Change, Input, Signal},
    parameters::{
        Axis, Group, Home, Initial, Jog, Jump, Memory, Move, MoveTo, Parameters, Policy, Profile, Release,
        Repeat, Return, Set, Setup, ShortMove, SoftLimits, Until, Wait,
    },
};
use stepscope_peripheral::{
    segment::PulseTimes,
    units::{Cycles, Instant},
};

/// SplitMix64 (Steele, Lea, Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// 0..n.
    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.bits() % n
    }

    pub(crate) fn range(&mut self, min: i64, max: i64) -> i64 {
        min + self.below((max - min + 1) as u64) as i64
    }

    pub(crate) fn one_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }

    pub(crate) fn of<T: Copy>(&mut self, rows: &[T]) -> T {
        rows[self.below(rows.len() as u64) as usize]
    }

    fn maybe<T>(&mut self, one_in: u64, make: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.one_in(one_in).then(|| make(self))
    }
}

const SENSORS: [Signal; 7] = [
    Signal::In0,
    Signal::In1,
    Signal::In2,
    Signal::In3,
    Signal::HomeSwitch,
    Signal::LimitMin,
    Signal::LimitMax,
];
const SWITCHES: [Signal; 3] = [Signal::HomeSwitch, Signal::LimitMin, Signal::LimitMax];

fn group(random: &mut Random, max_hz: i64, count: u32, number: u32, has_home: bool, least_q16: u64) -> Group {
    let speed = |random: &mut Random| random.range(10, max_hz) as u32;
    let delay = |random: &mut Random| if random.one_in(2) { random.below(40) as u32 } else { 0 };
    match random.below(14) {
        0..5 => Group::Move(Move {
            length: random.below(60) as u32,
            direction: random.below(2) as u8,
            speed_hz: speed(random),
            level: random.range(1, 5) as u8,
            delay_ms: delay(random),
            until: random
                .maybe(3, |random| Until { input: random.of(&SENSORS[..5]), level: random.one_in(2) }),
        }),
        5..7 => Group::MoveTo(MoveTo {
            length: random.range(-60, 60) as i32,
            speed_hz: speed(random),
            level: random.range(1, 5) as u8,
            delay_ms: delay(random),
        }),
        7 => {
            let count = random.range(1, 12);
            let mut interval = || least_q16 + random.below(200 << 16);
            Group::Profile(Profile {
                intervals: (0..count).map(|_| interval()).collect(),
                direction: (least_q16 >> 16) as u8 & 1,
                delay_ms: 0,
            })
        }
        8 if has_home => Group::Home,
        9 | 10 => Group::Wait(Wait {
            input: random.of(&SENSORS),
            level: random.one_in(2),
            timeout_ms: random.below(60) as u32,
            then: random.maybe(2, |random| random.range(1, count.into()) as u32),
        }),
        11 if number > 1 => Group::Repeat(Repeat {
            first: random.range(1, i64::from(number) - 1) as u32,
            times: random.range(1, 4) as u32,
        }),
        12 => Group::Jump(Jump {
            to: random.range(1, count.into()) as u32,
            input: random.maybe(2, |random| random.of(&SENSORS)),
            level: random.one_in(2),
        }),
        _ => Group::Set(Set { output: random.below(4) as u8, level: random.one_in(2) }),
    }
}

fn axis(random: &mut Random) -> Axis {
    let near = |random: &mut Random| random.range(-40, 40);
    let home = random.maybe(2, |random| (near(random), random.range(0, 12)));
    Axis {
        start_steps: near(random),
        min_switch_at_steps: random.maybe(3, |random| random.range(-120, -20)),
        max_switch_at_steps: random.maybe(3, |random| random.range(20, 120)),
        home_from_steps: home.map(|(from, _)| from),
        home_to_steps: home.map(|(from, len)| from + len),
        hard_min_steps: random.maybe(4, |random| random.range(-140, -40)),
        hard_max_steps: random.maybe(4, |random| random.range(40, 140)),
    }
}

fn inputs(random: &mut Random, is_first: bool, axis: Option<&Axis>, end: i64) -> Vec<Input> {
    let driven = |signal| {
        axis.is_some_and(|axis| match signal {
            Signal::LimitMin => axis.min_switch_at_steps.is_some(),
            Signal::LimitMax => axis.max_switch_at_steps.is_some(),
            Signal::HomeSwitch => axis.home_from_steps.is_some(),
            _ => false,
        })
    };
    let mut inputs: Vec<Input> = Vec::new();
    let mut add = |cycle: i64, change: Change| {
        let input = Input { cycle: Instant(cycle.max(1) as u64), change };
        if inputs.iter().all(|other| other.cycle != input.cycle || other.change.name() != change.name()) {
            inputs.push(input);
        }
    };
    // What the presses are mostly about: programs, all inputs, or numbers.
    let tendency = random.below(4);
    let count = random.range(1, 40);
    // An operator waits for the self-test, clears an alarm, starts, and then presses one button after another.
    if random.one_in(2) {
        let mut at = random.range(600, 1500);
        let first = [Signal::Clear, random.of(&[Signal::Start, Signal::Start, Signal::Home, Signal::Debug])];
        let next = [
            Signal::Start,
            Signal::Pause,
            Signal::Pause,
            Signal::Start,
            Signal::Zero,
            Signal::Clear,
            Signal::JogPlus,
            Signal::JogMinus,
            Signal::Ok,
            Signal::Debug,
        ];
        for index in 0..random.range(2, 30) {
            let signal = first.get(index as usize).copied().unwrap_or_else(|| random.of(&next));
            let held = random.range(1, 60);
            if signal != Signal::Clear || is_first {
                add(at, Change::Level(signal, true));
                add(at + held, Change::Level(signal, false));
            }
            at += held + random.range(1, 400);
        }
        if random.one_in(2) {
            return inputs;
        }
    }
    for _ in 0..count {
        let at = random.range(1, end);
        let held = if random.one_in(3) { random.range(1, 30) } else { random.range(5, end / 4) };
        let signal = match random.below(12) {
            0 => Signal::Power,
            1 => Signal::Estop,
            2 | 3 => Signal::Start,
            4 => random.of(&SENSORS),
            5 if tendency == 3 => Signal::System,
            6 if tendency < 2 => Signal::Start,
            7 => Signal::Clear,
            _ => Signal::ALL[random.below(Signal::ALL.len() as u64) as usize],
        };
        let is_shared = matches!(signal, Signal::Power | Signal::Estop | Signal::Clear);
        if driven(signal) || is_shared && !is_first || signal == Signal::Power && random.one_in(2) {
            add(at, Change::Push(random.range(-30, 30) as i32));
            continue;
        }
        let level = signal != Signal::Power;
        add(at, Change::Level(signal, level));
        if !random.one_in(12) {
            add(at + held, Change::Level(signal, !level));
        }
    }
    inputs
}

fn parameters(random: &mut Random, clock_hz: i64, pulse: PulseTimes, is_first: bool, end: i64) -> Parameters {
    let least = pulse.min_interval().0 as i64;
    let fastest = (clock_hz / least).max(10);
    let max_hz = random.range(10.max(fastest / 2), fastest);
    let start_hz = random.range(10.max(max_hz / 8), max_hz);
    let speed = |random: &mut Random| random.range(10, max_hz) as u32;
    let has_home = random.one_in(2);
    let used = random.range(1, 7) as u32;
    let axis = random.maybe(2, axis);
    let policy = if random.one_in(2) { Policy::PowerLoss } else { Policy::WriteAhead };
    let byte_write_cycles = random.range(1, 40) as u32;
    let initial = match random.below(6) {
        0 => Initial::Blank,
        1 => Initial::Bytes((0..random.below(64)).map(|_| random.bits() as u8).collect()),
        _ => Initial::Factory,
    };
    let groups =
        (1..=used).map(|number| group(random, max_hz, used, number, has_home, pulse.min_interval().0 << 16));
    let groups = groups.collect();
    Parameters {
        self_test_cycles: random.range(1, 600) as u32,
        debounce_cycles: random.range(0, 30) as u32,
        sensor_debounce_cycles: if random.one_in(2) { 0 } else { random.range(0, 20) as u32 },
        pulses_per_unit: random.range(1, 30) as u32,
        decimals: random.below(3) as u8,
        start_speed_hz: start_hz as u32,
        max_speed_hz: max_hz as u32,
        level_hz_s: random.range(1, 2 * max_hz * max_hz / 60 + 2).min(1_000_000) as u32,
        short_move: if random.one_in(2) { ShortMove::Document } else { ShortMove::TurnRound },
        least_trust: random.below(6).saturating_sub(3) as u8,
        loops: random.range(1, 4) as u32,
        groups,
        jog: Jog {
            speed_hz: speed(random),
            fine_hz: speed(random),
            level: random.range(1, 5) as u8,
            release: if random.one_in(2) { Release::AtOnce } else { Release::Ramp },
        },
        return_: Return { speed_hz: speed(random), level: random.range(1, 5) as u8 },
        home: has_home.then(|| Home {
            switch: random.of(&SWITCHES),
            direction: random.below(2) as u8,
            coarse_hz: random.range(10, start_hz) as u32,
            fine_hz: random.range(10, start_hz) as u32,
            pull_off_steps: random.below(12) as u32,
            max_travel_steps: random.range(1, 200) as u32,
            position_steps: if random.one_in(2) { 0 } else { random.range(-20, 20) },
        }),
        soft_limits: random.maybe(4, |random| SoftLimits {
            min_steps: random.range(-100, -5),
            max_steps: random.range(0, 100),
        }),
        inputs: inputs(random, is_first, axis.as_ref(), end),
        axis,
        memory: Memory {
            policy,
            byte_write_cycles,
            hold_up_cycles: random.below(20 * u64::from(byte_write_cycles)),
            slots: random.range(2, 5) as u32,
            initial,
        },
    }
}

/// A valid setup.
pub(crate) fn setup(seed: u64) -> Setup {
    let random = &mut Random(seed);
    let mut times = |least| Cycles(random.range(least, 6) as u64);
    let pulse = PulseTimes { width: times(1), setup: times(0), hold: times(0) };
    let clock_hz = random.range(1000, 20_000);
    let count = if random.one_in(3) { random.range(2, 3) } else { 1 };
    let end = random.range(2000, 12_000);
    let controllers = (0..count).map(|index| parameters(random, clock_hz, pulse, index == 0, end));
    let controllers = controllers.collect();
    Setup { clock_hz: clock_hz as u32, channels: 3, pulse, controllers }
}
