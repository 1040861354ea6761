//! The range of each number of a stand-alone controller (CONTROLLER.md, "The format").
//! [`Setup::check`](crate::parameters::Setup::check) also checks rules about several numbers.
//!
//! ```
//! assert!(stepscope_controller::limits::DEBOUNCE_CYCLES.contains(&160_000));
//! ```

use core::ops::RangeInclusive;
use stepscope_peripheral::{config, signal::MAX_CHANNELS};

pub const CLOCK_HZ: RangeInclusive<i128> = 1..=*config::limits::CLOCK_HZ.end() as i128;
/// Channels of the bus, and maximum number of controllers.
pub const CHANNELS: RangeInclusive<i128> = 1..=MAX_CHANNELS as i128;
pub const PULSE_WIDTH_CYCLES: RangeInclusive<i128> = 1..=1_000_000_000;
/// Setup and hold time of DIR.
pub const DIR_CYCLES: RangeInclusive<i128> = 0..=1_000_000_000;
pub const SELF_TEST_CYCLES: RangeInclusive<i128> = 1..=0xffff_ffff;
/// Debounce time of buttons and sensors.
pub const DEBOUNCE_CYCLES: RangeInclusive<i128> = 0..=1_000_000_000;
/// Steps per unit of length.
pub const PULSES_PER_UNIT: RangeInclusive<i128> = 1..=999_999;
/// Decimal places of lengths.
pub const DECIMALS: RangeInclusive<i128> = 0..=3;
/// Step rates; each controller limits them further by `max_speed_hz`.
pub const SPEED_HZ: RangeInclusive<i128> = 10..=10_000_000;
/// Acceleration of level 1 in Hz/s.
pub const LEVEL_HZ_S: RangeInclusive<i128> = 1..=1_000_000;
pub const LEVEL: RangeInclusive<i128> = 1..=5;
/// Minimum trust for a start.
pub const TRUST: RangeInclusive<i128> = 0..=2;
/// Runs of a program, and times of a `repeat`.
pub const LOOPS: RangeInclusive<i128> = 1..=9999;
pub const GROUPS: RangeInclusive<i128> = 1..=50;
/// Length of a `move`, as displayed but without its decimal point.
pub const LENGTH: RangeInclusive<i128> = 0..=999_999;
/// Target of a `move_to`, as displayed but without its decimal point.
pub const TARGET: RangeInclusive<i128> = -999_999..=999_999;
/// Direction: 1 right, 0 left.
pub const DIRECTION: RangeInclusive<i128> = 0..=1;
/// Delay after a group.
pub const DELAY_MS: RangeInclusive<i128> = 0..=999_999;
/// Timeout of a `wait`; 0 for none.
pub const TIMEOUT_MS: RangeInclusive<i128> = 0..=1_000_000_000;
/// Outputs of `set`.
pub const OUTPUT: RangeInclusive<i128> = 0..=3;
/// Number of intervals of a `profile`.
pub const INTERVALS: RangeInclusive<i128> = 0..=1_000_000;
/// Soft limits, switches, ends of an axis, the home position.
pub const STEPS: RangeInclusive<i128> = -(1 << 31)..=1 << 31;
/// Steps of homing after its switch has opened.
pub const PULL_OFF_STEPS: RangeInclusive<i128> = 0..=1_000_000;
/// Maximum steps of one leg of homing.
pub const TRAVEL_STEPS: RangeInclusive<i128> = 1..=1_000_000_000;
pub const BYTE_WRITE_CYCLES: RangeInclusive<i128> = 1..=1_000_000_000;
pub const HOLD_UP_CYCLES: RangeInclusive<i128> = 0..=1_000_000_000_000;
/// Records of the journal.
pub const SLOTS: RangeInclusive<i128> = 2..=200;
/// Entries of the script.
pub const INPUTS: RangeInclusive<i128> = 0..=100_000;
/// Cycle of an entry.
pub const INPUT_CYCLE: RangeInclusive<i128> = 1..=9_000_000_000_000_000;
/// Steps of a manual push.
pub const PUSH_STEPS: RangeInclusive<i128> = -1_000_000..=1_000_000;
/// Groups of all controllers that may begin in a run; one more ends it with [`TooManyGroups`](crate::TooManyGroups).
pub const MAX_GROUPS_BEGUN: u64 = 1_000_000;
