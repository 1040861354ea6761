//! The range of each number of a stand-alone controller (CONTROLLER.md, "The format"); rules that join several stand in
//! [`Setup::check`](crate::parameters::Setup::check).
//!
//! ```
//! assert!(stepscope_controller::limits::DEBOUNCE_CYCLES.contains(&160_000));
//! ```

use core::ops::RangeInclusive;
use stepscope_peripheral::{config, signal::MAX_CHANNELS};

/// Clock in Hz.
pub const CLOCK_HZ: RangeInclusive<i128> = 1..=*config::limits::CLOCK_HZ.end() as i128;
/// Channels of the bus, and controllers of a scenario: no more than channels.
pub const CHANNELS: RangeInclusive<i128> = 1..=MAX_CHANNELS as i128;
/// W in cycles.
pub const PULSE_WIDTH_CYCLES: RangeInclusive<i128> = 1..=1_000_000_000;
/// D or H in cycles.
pub const DIR_CYCLES: RangeInclusive<i128> = 0..=1_000_000_000;
/// Self-test after each power-up in cycles.
pub const SELF_TEST_CYCLES: RangeInclusive<i128> = 1..=0xffff_ffff;
/// Debouncing in cycles, of buttons and of sensors.
pub const DEBOUNCE_CYCLES: RangeInclusive<i128> = 0..=1_000_000_000;
/// N, pulses per unit of length.
pub const PULSES_PER_UNIT: RangeInclusive<i128> = 1..=999_999;
/// d, decimal places of lengths.
pub const DECIMALS: RangeInclusive<i128> = 0..=3;
/// A speed in Hz, where nothing narrower stands.
pub const SPEED_HZ: RangeInclusive<i128> = 10..=10_000_000;
/// Acceleration of level 1 in Hz/s.
pub const LEVEL_HZ_S: RangeInclusive<i128> = 1..=1_000_000;
/// A level of acceleration.
pub const LEVEL: RangeInclusive<i128> = 1..=5;
/// Trust that start asks for.
pub const TRUST: RangeInclusive<i128> = 0..=2;
/// Runs of a program, and times of a `repeat`.
pub const LOOPS: RangeInclusive<i128> = 1..=9999;
/// Groups of a program.
pub const GROUPS: RangeInclusive<i128> = 1..=50;
/// Length of a `move` in display digits.
pub const LENGTH: RangeInclusive<i128> = 0..=999_999;
/// Place of a `move_to` in display digits.
pub const PLACE: RangeInclusive<i128> = -999_999..=999_999;
/// A direction: 1 right, 0 left.
pub const DIRECTION: RangeInclusive<i128> = 0..=1;
/// Delay after a group in ms.
pub const DELAY_MS: RangeInclusive<i128> = 0..=999_999;
/// How long a `wait` waits in ms, 0 for ever.
pub const TIMEOUT_MS: RangeInclusive<i128> = 0..=1_000_000_000;
/// An output of `set`.
pub const OUTPUT: RangeInclusive<i128> = 0..=3;
/// Intervals of a `profile`, how many.
pub const INTERVALS: RangeInclusive<i128> = 0..=1_000_000;
/// A place in steps: soft limits, switches, ends of an axis, the position that homing sets.
pub const STEPS: RangeInclusive<i128> = -(1 << 31)..=1 << 31;
/// Steps that homing still makes once its switch has opened.
pub const PULL_OFF_STEPS: RangeInclusive<i128> = 0..=1_000_000;
/// Most steps of one leg of homing.
pub const TRAVEL_STEPS: RangeInclusive<i128> = 1..=1_000_000_000;
/// w, how long the EEPROM writes a byte, in cycles.
pub const BYTE_WRITE_CYCLES: RangeInclusive<i128> = 1..=1_000_000_000;
/// How long the supply holds up without power, in cycles.
pub const HOLD_UP_CYCLES: RangeInclusive<i128> = 0..=1_000_000_000_000;
/// Records of the journal.
pub const SLOTS: RangeInclusive<i128> = 2..=200;
/// Entries of the script.
pub const INPUTS: RangeInclusive<i128> = 0..=100_000;
/// Cycle of an entry.
pub const INPUT_CYCLE: RangeInclusive<i128> = 1..=9_000_000_000_000_000;
/// Steps that a hand pushes the axis.
pub const PUSH_STEPS: RangeInclusive<i128> = -1_000_000..=1_000_000;
/// Groups that may begin in a run, of all controllers together; one more ends it with [`Work`](crate::Work) (G, "Refused").
pub const MAX_GROUPS_BEGUN: u64 = 1_000_000;
