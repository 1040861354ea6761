//! The parameters of stand-alone controllers (CONTROLLER.md, "The format"): one struct or enum per object of
//! `source.standalone` in a scenario.
//!
//! Names contain the units; [`limits`](crate::limits) has the range of each number.
//!
//! ```
//! use stepscope_controller::parameters::{Group, Move, Parameters, Setup};
//!
//! let right = Group::Move(Move { length: 305, speed_hz: 2000, ..Move::default() });
//! let controller = Parameters { groups: vec![right, Group::Home], ..Parameters::default() };
//! let refused = Setup { controllers: vec![controller], ..Setup::default() }.check().unwrap_err();
//! assert_eq!(refused[0].to_string(), "controller 0: groups[1].home: the controller has no `home`; add one or remove this group");
//! ```

use crate::input::{Change, Input, Signal};
use crate::journal;
use alloc::{vec, vec::Vec};
use stepscope_peripheral::{parameters, segment::PulseTimes, units::Cycles};

/// How a move runs that is too short for its speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShortMove {
    /// At the start-stop rate, as in Zhang 2012.
    #[default]
    Document,
    /// Accelerates as far as possible, then decelerates.
    TurnRound,
}

/// How a jog runs and stops.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Release {
    /// At constant speed; it stops immediately, as in Zhang 2012.
    #[default]
    AtOnce,
    Ramp,
}

/// When a controller saves its position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Policy {
    /// During the hold-up time after a power failure.
    #[default]
    PowerLoss,
    /// Before each move; needs no hold-up time.
    WriteAhead,
}

/// Initial contents of the EEPROM.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Initial {
    /// All 0xFF.
    Blank,
    /// Blank except for one closed record in slot 0: seq 1, position 0, trust 2.
    #[default]
    Factory,
    /// These bytes from address 0, the rest 0xFF.
    Bytes(Vec<u8>),
}

/// An instruction of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Group {
    Move(Move),
    MoveTo(MoveTo),
    Profile(Profile),
    /// Homes; needs [`Parameters::home`].
    Home,
    /// Waits for a level.
    Wait(Wait),
    Set(Set),
    /// Goes back a number of times.
    Repeat(Repeat),
    /// Continues at another group.
    Jump(Jump),
}

parameters! { (Clone, Debug, PartialEq, Eq)
    /// A bus and its controllers.
    pub struct Setup {
        pub clock_hz: u32 = 16_000_000,
        /// 1 to 16.
        pub channels: u8 = 1,
        /// Width of a STEP pulse, and setup and hold time of DIR.
        pub pulse: PulseTimes = PulseTimes { width: Cycles(40), setup: Cycles(40), hold: Cycles(0) },
        /// One per channel, from channel 0 on.
        pub controllers: Vec<Parameters> = vec![Parameters::default()],
    }

    /// The parameters of one controller.
    pub struct Parameters {
        pub self_test_cycles: u32 = 1600,
        /// Debounce time of buttons, keys and the release of the E-stop.
        pub debounce_cycles: u32 = 160_000,
        /// Debounce time of limits, the home switch and `in_0` to `in_3`.
        pub sensor_debounce_cycles: u32 = 0,
        pub pulses_per_unit: u32 = 100,
        pub decimals: u8 = 1,
        pub start_speed_hz: u32 = 1000,
        /// Maximum of all requested speeds.
        pub max_speed_hz: u32 = 20_000,
        /// Acceleration of level 1; level n has n times as much.
        pub level_hz_s: u32 = 1000,
        pub short_move: ShortMove = ShortMove::Document,
        /// Minimum trust for a start: 0 LOST, 1 HELD, 2 SURE.
        pub least_trust: u8 = 1,
        pub loops: u32 = 1,
        pub groups: Vec<Group> = vec![Group::Move(Move::default())],
        pub jog: Jog = Jog::default(),
        /// Return to zero; `return` in a scenario.
        pub return_: Return = Return::default(),
        pub home: Option<Home> = None,
        pub soft_limits: Option<SoftLimits> = None,
        pub axis: Option<Axis> = None,
        pub memory: Memory = Memory::default(),
        /// The script in any order.
        pub inputs: Vec<Input> = Vec::new(),
    }

    /// Jogging by the buttons `jog_plus` and `jog_minus`.
    pub struct Jog {
        pub speed_hz: u32 = 1000,
        pub fine_hz: u32 = 10,
        /// Level of acceleration; only for [`Release::Ramp`].
        pub level: u8 = 3,
        pub release: Release = Release::AtOnce,
    }

    /// The return to zero.
    pub struct Return {
        pub speed_hz: u32 = 1000,
        pub level: u8 = 3,
    }

    /// Homing: search for a switch, back off, and approach it slowly.
    pub struct Home {
        /// The home switch or a limit.
        pub switch: Signal = Signal::HomeSwitch,
        /// Direction of the search: 1 right, 0 left.
        pub direction: u8 = 0,
        /// Speed of the first two legs.
        pub coarse_hz: u32 = 1000,
        /// Speed of the last leg.
        pub fine_hz: u32 = 10,
        /// Steps away from the switch after it has opened, including the pending one.
        pub pull_off_steps: u32 = 20,
        pub max_travel_steps: u32 = 100_000,
        /// Position where the switch closes.
        pub position_steps: i64 = 0,
    }

    /// Positions that moves must not exceed.
    pub struct SoftLimits {
        pub min_steps: i64 = 0,
        pub max_steps: i64 = 0,
    }

    /// A virtual axis. A switch that is `None` belongs to the script; an end that is `None` is open.
    pub struct Axis {
        pub start_steps: i64 = 0,
        /// `limit_min` is closed here and to the left.
        pub min_switch_at_steps: Option<i64> = None,
        /// `limit_max` is closed here and to the right.
        pub max_switch_at_steps: Option<i64> = None,
        /// `home_switch` is closed from here to `home_to_steps`; both or neither.
        pub home_from_steps: Option<i64> = None,
        pub home_to_steps: Option<i64> = None,
        /// Left mechanical end.
        pub hard_min_steps: Option<i64> = None,
        /// Right mechanical end.
        pub hard_max_steps: Option<i64> = None,
    }

    /// The EEPROM with the position journal, and the hold-up time of the supply.
    pub struct Memory {
        pub policy: Policy = Policy::PowerLoss,
        pub byte_write_cycles: u32 = 136_000,
        /// Hold-up time of the supply after a power failure.
        pub hold_up_cycles: u64 = 3_200_000,
        pub slots: u32 = 8,
        /// At most [`Parameters::memory_len`] bytes.
        pub initial: Initial = Initial::Factory,
    }

    /// A move by a length (Zhang 2012).
    pub struct Move {
        pub length: u32 = 1000,
        /// 1 right, 0 left.
        pub direction: u8 = 1,
        pub speed_hz: u32 = 5000,
        pub level: u8 = 3,
        /// Delay after it.
        pub delay_ms: u32 = 0,
        /// Level that ends it early.
        pub until: Option<Until> = None,
    }

    /// Level of a sensor at which a [`Move`] brakes and drops its remaining steps.
    pub struct Until {
        /// `in_0` to `in_3` or `home_switch`.
        pub input: Signal = Signal::In0,
        pub level: bool = true,
    }

    /// A move to a position.
    pub struct MoveTo {
        /// Target as displayed, without its decimal point.
        pub length: i32 = 0,
        pub speed_hz: u32 = 5000,
        pub level: u8 = 3,
        /// Delay after it.
        pub delay_ms: u32 = 0,
    }

    /// A `profile`: one step after each interval, counted from the cycle after its begin.
    pub struct Profile {
        /// In 1/65536 cycle, at least the minimum step interval of the bus.
        pub intervals: Vec<u64> = Vec::new(),
        /// 1 right, 0 left.
        pub direction: u8 = 1,
        /// Delay after it.
        pub delay_ms: u32 = 0,
    }

    /// Waits until an input has a level.
    pub struct Wait {
        /// `in_0` to `in_3` or a switch.
        pub input: Signal = Signal::In0,
        pub level: bool = true,
        /// 0 for no timeout.
        pub timeout_ms: u32 = 0,
        /// Number (from 1) of the next group after a timeout; `None` for alarm TIMEOUT.
        pub then: Option<u32> = None,
    }

    /// Sets an output.
    pub struct Set {
        /// 0 to 3.
        pub output: u8 = 0,
        pub level: bool = true,
    }

    /// Repeats the groups from an earlier one up to this one.
    pub struct Repeat {
        /// Number (from 1) of an earlier group.
        pub first: u32 = 1,
        /// How often the groups run; after that the program continues.
        pub times: u32 = 2,
    }

    /// Continues at another group.
    pub struct Jump {
        /// Number (from 1) of the next group.
        pub to: u32 = 1,
        /// Jumps only if this input, `in_0` to `in_3` or a switch, has the level; `None` for always.
        pub input: Option<Signal> = None,
        pub level: bool = true,
    }
}

impl Parameters {
    /// The signals that the script sets or the axis drives, in the order of [`Signal::ALL`].
    pub fn inputs_used(&self) -> Vec<Signal> {
        let scripted = |signal| {
            self.inputs.iter().any(|input| matches!(input.change, Change::Level(own, _) if own == signal))
        };
        let driven = |signal| {
            self.axis.as_ref().is_some_and(|axis| match signal {
                Signal::LimitMin => axis.min_switch_at_steps.is_some(),
                Signal::LimitMax => axis.max_switch_at_steps.is_some(),
                Signal::HomeSwitch => axis.home_from_steps.is_some(),
                _ => false,
            })
        };
        Signal::ALL.into_iter().filter(|&signal| scripted(signal) || driven(signal)).collect()
    }

    /// Size of the EEPROM in bytes: the journal and two banks of numbers.
    pub fn memory_len(&self) -> usize {
        journal::memory_len(self.memory.slots as usize, self.number_count())
    }
}
