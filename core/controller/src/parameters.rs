//! What a stand-alone controller is made of (CONTROLLER.md, "The format"): one struct or enum for each object of a
//! scenario's `source.standalone`, with its defaults.
//!
//! Units are in the names; [`limits`](crate::limits) has the range of each number.
//!
//! ```
//! use stepscope_controller::parameters::{Group, Move, Parameters, Setup};
//!
//! let right = Group::Move(Move { length: 305, speed_hz: 2000, ..Move::default() });
//! let controller = Parameters { groups: vec![right, Group::Home], ..Parameters::default() };
//! let refused = Setup { controllers: vec![controller], ..Setup::default() }.check().unwrap_err();
//! assert_eq!(refused[0].to_string(), "controller 0: groups[1].home: there is no `home`; give one or leave the group out");
//! ```

use crate::input::{Change, Input, Signal};
use alloc::{vec, vec::Vec};
use stepscope_peripheral::{segment::PulseTimes, units::Cycles};

/// Declares a struct with public fields, each with its default.
macro_rules! parameters {
    ($($(#[$meta:meta])* pub struct $name:ident {
        $($(#[$field_meta:meta])* pub $field:ident: $ty:ty = $default:expr,)*
    })*) => {$(
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, Eq)]
        pub struct $name {
            $($(#[$field_meta])* pub $field: $ty,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }
    )*};
}

/// What a move does that is too short for its speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShortMove {
    /// All of it at the start speed, as the document does.
    #[default]
    Document,
    /// Up as far as it goes, and down again.
    TurnRound,
}

/// How a jog ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Release {
    /// At once, and it has no ramp either: the document's.
    #[default]
    AtOnce,
    /// By a ramp, as it began.
    Ramp,
}

/// How the position is kept through power cuts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Policy {
    /// It is written while the supply holds up without power.
    #[default]
    PowerLoss,
    /// What is about to move is written before, without hold-up.
    WriteAhead,
}

/// What the EEPROM holds at reset.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Initial {
    /// All 0xFF.
    Blank,
    /// Blank but for one closed record in slot 0: seq 1, position 0, trust 2.
    #[default]
    Factory,
    /// These from address 0, the rest 0xFF.
    Bytes(Vec<u8>),
}

/// A group of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Group {
    /// A move by a length.
    Move(Move),
    /// A move to a place.
    MoveTo(MoveTo),
    /// Steps with intervals of their own.
    Profile(Profile),
    /// Homing; needs [`Parameters::home`].
    Home,
    /// Waits for a level.
    Wait(Wait),
    /// Sets an output.
    Set(Set),
    /// Goes back some times.
    Repeat(Repeat),
    /// Goes on elsewhere.
    Jump(Jump),
}

parameters! {
    /// All stand-alone controllers of a scenario, and the bus that they drive.
    pub struct Setup {
        /// f, cycles a second, 1 to 10^9.
        pub clock_hz: u32 = 16_000_000,
        /// Channels of the bus, 1 to 16.
        pub channels: u8 = 1,
        /// W, D and H.
        pub pulse: PulseTimes = PulseTimes { width: Cycles(40), setup: Cycles(40), hold: Cycles(0) },
        /// The controllers, i driving channel i: 1 to 16, no more than channels.
        pub controllers: Vec<Parameters> = vec![Parameters::default()],
    }

    /// One controller.
    pub struct Parameters {
        /// Self-test after each power-up in cycles, 1 to 2^32 - 1.
        pub self_test_cycles: u32 = 1600,
        /// Debouncing of buttons, keys and the release of the E-stop, 0 to 10^9 cycles.
        pub debounce_cycles: u32 = 160_000,
        /// Debouncing of limits, the home switch and `in_0` to `in_3`, 0 to 10^9 cycles.
        pub sensor_debounce_cycles: u32 = 0,
        /// N, pulses per unit of length, 1 to 999999.
        pub pulses_per_unit: u32 = 100,
        /// d, decimal places of lengths, 0 to 3.
        pub decimals: u8 = 1,
        /// f_1, the start-stop range in Hz, 10 to `max_speed_hz`.
        pub start_speed_hz: u32 = 1000,
        /// The fastest that may be requested in Hz, 10 to 10^7 and not too fast for a pulse.
        pub max_speed_hz: u32 = 20_000,
        /// Acceleration of level 1 in Hz/s, 1 to 10^6; level n has n times as much.
        pub level_hz_s: u32 = 1000,
        /// What a move does that is too short for its speed.
        pub short_move: ShortMove = ShortMove::Document,
        /// Trust that start asks for: 0 LOST, 1 HELD, 2 SURE.
        pub least_trust: u8 = 1,
        /// Runs of the program, 1 to 9999.
        pub loops: u32 = 1,
        /// The program, 1 to 50 groups.
        pub groups: Vec<Group> = vec![Group::Move(Move::default())],
        /// Jogging.
        pub jog: Jog = Jog::default(),
        /// Return to zero; `return` in a scenario.
        pub return_: Return = Return::default(),
        /// Homing, where there is one.
        pub home: Option<Home> = None,
        /// Bounds of ordered positions, where there are some.
        pub soft_limits: Option<SoftLimits> = None,
        /// A virtual axis with switches.
        pub axis: Option<Axis> = None,
        /// The EEPROM.
        pub memory: Memory = Memory::default(),
        /// The script in any order, up to 100 000 entries.
        pub inputs: Vec<Input> = Vec::new(),
    }

    /// Jogging.
    pub struct Jog {
        /// Speed from READY in Hz, 10 to `max_speed_hz`.
        pub speed_hz: u32 = 1000,
        /// Speed from DEBUG in Hz, 10 to `max_speed_hz`.
        pub fine_hz: u32 = 10,
        /// Level of acceleration, 1 to 5; counts for [`Release::Ramp`].
        pub level: u8 = 3,
        /// How it ends.
        pub release: Release = Release::AtOnce,
    }

    /// Return to zero.
    pub struct Return {
        /// Speed in Hz, 10 to `max_speed_hz`.
        pub speed_hz: u32 = 1000,
        /// Level of acceleration, 1 to 5.
        pub level: u8 = 3,
    }

    /// Homing.
    pub struct Home {
        /// What it looks for: the home switch or a limit.
        pub switch: Signal = Signal::HomeSwitch,
        /// Where to: 1 right, 0 left.
        pub direction: u8 = 0,
        /// Speed of the first two legs in Hz, 10 to `start_speed_hz`.
        pub coarse_hz: u32 = 1000,
        /// Speed of the last leg in Hz, 10 to `start_speed_hz`.
        pub fine_hz: u32 = 10,
        /// Steps away from the switch once it has opened, 0 to 10^6, the one that is due included.
        pub pull_off_steps: u32 = 20,
        /// Most steps of a leg, 1 to 10^9.
        pub travel_steps: u32 = 100_000,
        /// Position where the switch closes, +-2^31.
        pub position_steps: i64 = 0,
    }

    /// Bounds of ordered positions, each +-2^31.
    pub struct SoftLimits {
        /// The least, no more than the maximum.
        pub min_steps: i64 = 0,
        /// The maximum.
        pub max_steps: i64 = 0,
    }

    /// A virtual axis; places are +-2^31 steps.
    pub struct Axis {
        /// Its place at first.
        pub start_steps: i64 = 0,
        /// `limit_min` is closed here and to the left of it; `None` leaves it to the script, as in the next ones.
        pub min_switch_at: Option<i64> = None,
        /// `limit_max` is closed here and to the right of it.
        pub max_switch_at: Option<i64> = None,
        /// `home_switch` is closed from here …
        pub home_from: Option<i64> = None,
        /// … to here. Both or neither.
        pub home_to: Option<i64> = None,
        /// The axis goes no additional to the left; `None` where it does, as in the next one.
        pub hard_min: Option<i64> = None,
        /// The axis goes no additional to the right.
        pub hard_max: Option<i64> = None,
    }

    /// The EEPROM.
    pub struct Memory {
        /// How the position is kept.
        pub policy: Policy = Policy::PowerLoss,
        /// w, how long a byte is written, 1 to 10^9 cycles.
        pub byte_write_cycles: u32 = 136_000,
        /// How long the supply holds up without power, 0 to 10^12 cycles.
        pub hold_up_cycles: u64 = 3_200_000,
        /// Records of the journal, 2 to 200.
        pub slots: u32 = 8,
        /// What it holds at reset; no longer than [`Parameters::memory_len`].
        pub initial: Initial = Initial::Factory,
    }

    /// A `move`.
    pub struct Move {
        /// Length in display digits, 0 to 999999.
        pub length: u32 = 1000,
        /// 1 right, 0 left.
        pub direction: u8 = 1,
        /// Speed in Hz, 10 to `max_speed_hz`.
        pub speed_hz: u32 = 5000,
        /// Level of acceleration, 1 to 5.
        pub level: u8 = 3,
        /// Delay after it in ms, 0 to 999999.
        pub delay_ms: u32 = 0,
        /// Where it ends early.
        pub until: Option<Until> = None,
    }

    /// Level of a sensor at which a [`Move`] brakes and its rest is given up.
    pub struct Until {
        /// `in_0` to `in_3` or `home_switch`.
        pub input: Signal = Signal::In0,
        /// Its level.
        pub level: bool = true,
    }

    /// A `move_to`.
    pub struct MoveTo {
        /// Place in display digits, -999999 to 999999.
        pub length: i32 = 0,
        /// Speed in Hz, 10 to `max_speed_hz`.
        pub speed_hz: u32 = 5000,
        /// Level of acceleration, 1 to 5.
        pub level: u8 = 3,
        /// Delay after it in ms, 0 to 999999.
        pub delay_ms: u32 = 0,
    }

    /// A `profile`. The steps of a motion (B) are intervals, too: their sum from (c + 1) << 16 gives the rises.
    pub struct Profile {
        /// Time before each step in 1/65536 cycle, Lm to 2^64 - 1; 1 to 1 000 000 of them.
        pub intervals: Vec<u64> = Vec::new(),
        /// 1 right, 0 left.
        pub direction: u8 = 1,
        /// Delay after it in ms, 0 to 999999.
        pub delay_ms: u32 = 0,
    }

    /// A `wait`.
    pub struct Wait {
        /// `in_0` to `in_3` or a switch.
        pub input: Signal = Signal::In0,
        /// Level that it waits for.
        pub level: bool = true,
        /// How long in ms, 0 to 10^9; 0 for ever.
        pub timeout_ms: u32 = 0,
        /// Number (from 1) of the group that is next after the time; `None` for alarm TIMEOUT.
        pub then: Option<u32> = None,
    }

    /// A `set`.
    pub struct Set {
        /// Output, 0 to 3.
        pub output: u8 = 0,
        /// Its level.
        pub level: bool = true,
    }

    /// A `repeat`.
    pub struct Repeat {
        /// Number (from 1) of a group before this one.
        pub first: u32 = 1,
        /// How often this group is reached before it lets by, 1 to 9999.
        pub times: u32 = 2,
    }

    /// A `jump`.
    pub struct Jump {
        /// Number (from 1) of the group that is next.
        pub to: u32 = 1,
        /// It jumps if this one, `in_0` to `in_3` or a switch, has the level; `None` for always.
        pub input: Option<Signal> = None,
        /// The level.
        pub level: bool = true,
    }
}

impl Parameters {
    /// The signals that its script has or its axis drives, in their order.
    #[must_use]
    pub fn inputs_used(&self) -> Vec<Signal> {
        let scripted = |signal| {
            self.inputs.iter().any(|input| matches!(input.change, Change::Level(own, _) if own == signal))
        };
        let driven = |signal| {
            self.axis.as_ref().is_some_and(|axis| match signal {
                Signal::LimitMin => axis.min_switch_at.is_some(),
                Signal::LimitMax => axis.max_switch_at.is_some(),
                Signal::HomeSwitch => axis.home_from.is_some(),
                _ => false,
            })
        };
        Signal::ALL.into_iter().filter(|&signal| scripted(signal) || driven(signal)).collect()
    }

    /// How many numbers the panel can change: 8, and 5 of each `move`.
    #[must_use]
    pub fn numbers(&self) -> usize {
        8 + 5 * self.groups.iter().filter(|group| matches!(group, Group::Move(_))).count()
    }

    /// Bytes of the EEPROM: the journal and two banks of numbers.
    #[must_use]
    pub fn memory_len(&self) -> usize {
        16 * self.memory.slots as usize + 2 * (8 + 4 * self.numbers())
    }
}
