//! A small controller whose cycles can be counted by hand: a clock of 1 kHz, pulses of 2 cycles with a setup and a hold time of
//! 1 cycle each (so the minimum interval is 4 cycles), a start-stop rate of 100 Hz, and one cycle per byte of memory. The
//! opening record is complete in cycle 26.

use stepscope_controller::{
    StandAlone,
    input::{Change, Input, Signal},
    parameters::{Group, Jog, Memory, Move, Parameters, Return, Setup},
};
use stepscope_peripheral::{
    segment::PulseTimes,
    signal::{Levels, Record},
    units::{Cycles, Instant},
};

pub(crate) const PULSE: PulseTimes = PulseTimes { width: Cycles(2), setup: Cycles(1), hold: Cycles(1) };

pub(crate) fn small() -> Parameters {
    Parameters {
        self_test_cycles: 10,
        debounce_cycles: 0,
        pulses_per_unit: 1,
        decimals: 0,
        start_speed_hz: 100,
        max_speed_hz: 250,
        jog: Jog { speed_hz: 100, ..Jog::default() },
        return_: Return { speed_hz: 100, ..Return::default() },
        groups: vec![to_the_right(3)],
        memory: Memory { byte_write_cycles: 1, hold_up_cycles: 100, slots: 4, ..Memory::default() },
        ..Parameters::default()
    }
}

pub(crate) fn to_the_right(length: u32) -> Group {
    Group::Move(Move { length, speed_hz: 100, ..Move::default() })
}

/// A level from a cycle on.
pub(crate) fn level(cycle: u64, signal: Signal, level: bool) -> Input {
    Input { cycle: Instant(cycle), change: Change::Level(signal, level) }
}

/// Presses of one cycle each.
pub(crate) fn presses(presses: &[(u64, Signal)]) -> Vec<Input> {
    presses.iter().flat_map(|&(at, signal)| [level(at, signal, true), level(at + 1, signal, false)]).collect()
}

/// A run until its end or the given cycle.
pub(crate) struct Run {
    pub(crate) machine: StandAlone,
    pub(crate) trace: Vec<Record>,
}

pub(crate) fn run_all(controllers: Vec<Parameters>, until: u64) -> Run {
    let channels = controllers.len() as u8;
    let setup = Setup { clock_hz: 1000, channels, pulse: PULSE, controllers };
    let checked = setup.check().unwrap_or_else(|refused| panic!("{refused:?}"));
    let (mut machine, mut trace) = (StandAlone::new(&checked), Vec::new());
    machine.run(Instant(until), &mut trace);
    Run { machine, trace }
}

pub(crate) fn run(parameters: Parameters) -> Run {
    run_all(vec![parameters], 1_000_000)
}

pub(crate) fn pressed(parameters: Parameters, pressed: &[(u64, Signal)]) -> Run {
    run(Parameters { inputs: presses(pressed), ..parameters })
}

impl Run {
    /// Edges of channel 0 and EN after cycle 0, such as `DIR+31 STEP+41 STEP-43`.
    pub(crate) fn edges(&self) -> String {
        let signals = [("STEP", 1), ("DIR", 1 << Levels::DIR_SHIFT), ("EN", Levels::EN)];
        let mut edges = Vec::new();
        for pair in self.trace.windows(2) {
            for (name, bit) in signals {
                let (was, is) = (pair[0].levels.0 & bit != 0, pair[1].levels.0 & bit != 0);
                if was != is {
                    edges.push(format!("{name}{}{}", if is { '+' } else { '-' }, pair[1].cycle.0));
                }
            }
        }
        edges.join(" ")
    }

    /// Cycles in which STEP of channel 0 rises.
    pub(crate) fn rises(&self) -> Vec<u64> {
        let rises = |pair: &[Record]| pair[0].levels.step() & 1 == 0 && pair[1].levels.step() & 1 == 1;
        self.trace.windows(2).filter(|pair| rises(pair)).map(|pair| pair[1].cycle.0).collect()
    }

    /// Records of the panel, such as `27 Ready` or `64 Alarm:Limit`.
    pub(crate) fn panel(&self) -> Vec<String> {
        let records = self.machine.panel(0).iter();
        records
            .map(|record| {
                let (cycle, word) = (record.cycle.0, record.word);
                let alarm = match word.alarm() {
                    stepscope_controller::Alarm::None => String::new(),
                    alarm => format!(":{alarm:?}"),
                };
                format!(
                    "{cycle} {:?}{alarm} t{} g{}/{}",
                    word.state(),
                    word.trust(),
                    word.group(),
                    word.loop_()
                )
            })
            .collect()
    }

    /// The records from `cycle` on.
    pub(crate) fn panel_from(&self, cycle: u64) -> Vec<String> {
        let from = self.machine.panel(0).iter().position(|record| record.cycle.0 >= cycle);
        self.panel().split_off(from.unwrap_or(self.machine.panel(0).len()))
    }

    /// State and alarm at the end, such as `Ready` or `Alarm:Limit`.
    pub(crate) fn end(&self) -> String {
        let word = self.machine.word(0).expect("a controller");
        match word.alarm() {
            stepscope_controller::Alarm::None => format!("{:?}", word.state()),
            alarm => format!("Alarm:{alarm:?}"),
        }
    }

    pub(crate) fn position(&self) -> i32 {
        self.machine.position(0).expect("a controller")
    }
}
