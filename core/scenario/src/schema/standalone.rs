//! Stand-alone controllers (CONTROLLER.md, "The format").

use crate::schema::rows::{choices, settings, word_enums, words};
use crate::schema::{Field, OWN, SONG, ZHANG, label};
use alloc::{vec, vec::Vec};
use core::ops::RangeInclusive;
use stepscope_controller::parameters::{Initial, Policy, Release, ShortMove};
use stepscope_controller::{input::Signal, limits};
use stepscope_motion::moves::Move;

const fn whole(range: &RangeInclusive<i128>) -> RangeInclusive<u64> {
    *range.start() as u64..=*range.end() as u64
}

const fn signed(range: &RangeInclusive<i128>) -> RangeInclusive<i64> {
    *range.start() as i64..=*range.end() as i64
}

const fn length(range: &RangeInclusive<i128>) -> RangeInclusive<usize> {
    *range.start() as usize..=*range.end() as usize
}

settings! {
    /// Nothing is sent: controller i drives channel i with buttons, a program and switches. Only `bus.channels` and the
    /// three pulse times (`pulse_width_cycles`, `dir_setup_cycles`, `dir_hold_cycles`) apply; `line` is ignored. The
    /// default controller waits for buttons. Lengths are the digits of its display: with one decimal 305 is 30.5.
    ///
    /// EN follows power, emergency stop and alarms. With several controllers, `power`, `estop` and `clear` of the first
    /// one apply to all.
    pub struct StandAlone {
        /// Self-test after power-up.
        pub self_test_cycles: u32 = 1600 => label("Self-test").unit("cycles").whole(whole(&limits::SELF_TEST_CYCLES)).from(ZHANG),
        /// Minimum time of a button, a key or the release of the emergency stop.
        pub debounce_cycles: u32 = 160_000 => label("Button debounce").unit("cycles").whole(whole(&limits::DEBOUNCE_CYCLES))
            .term("Debounce", "A contact bounces for some milliseconds. A level counts after it has been stable for this time.")
            .from(ZHANG),
        /// The same for limit and home switches and for `in_0` to `in_3`.
        pub sensor_debounce_cycles: u32 = 0 => label("Switch debounce").unit("cycles").whole(whole(&limits::DEBOUNCE_CYCLES)).from(OWN),
        /// Pulses per unit of length, as measured (`stepscope calibrate`).
        pub pulses_per_unit: u32 = 100 => label("Pulses per unit").unit("pulses").whole(whole(&limits::PULSES_PER_UNIT))
            .term("Pulses per unit", "Pulses per unit of length (cm in Zhang 2012). It is measured on the machine, so it includes the errors of screw and gear.")
            .from(ZHANG),
        /// Decimal places of lengths: with 1 the digits 305 are 30.5.
        pub decimals: u8 = 1 => label("Decimals").whole(whole(&limits::DECIMALS)).from(ZHANG),
        /// Lowest rate of the table, f_1. The motor starts at it.
        pub start_speed_hz: u32 = 1000 => label("Start-stop rate").unit("Hz").range_text("10 to `max_speed_hz`")
            .term("Start-stop rate", "The motor can start and stop at this rate without a ramp. A jump to a higher rate may lose steps, so the position is lost.")
            .from(ZHANG),
        /// Maximum rate of all moves.
        pub max_speed_hz: u32 = 20_000 => label("Max speed").unit("Hz").range_text("10 to 10^7, limited by the pulse times").from(ZHANG),
        /// Acceleration of level 1. Level n has n times as much.
        pub level_hz_s: u32 = 1000 => label("Acceleration of level 1").unit("Hz/s").whole(whole(&limits::LEVEL_HZ_S)).from(ZHANG),
        /// Moves that are too short for their speed.
        pub short_move: ShortMove = ShortMove::Document => label("Short moves").from(ZHANG),
        /// Minimum state of the position to start.
        pub required_position: PositionState = PositionState::Restored => label("Required position")
            .term("Required position", "How reliable the position must be to start. Confirmed: zero was set or found. Restored: it was confirmed, but the windings have been without current since. Lost: memory did not survive a power loss, or the motor jumped beyond its start-stop rate.")
            .from(OWN),
        /// How often the program runs.
        pub loops: u16 = 1 => label("Loops").whole(whole(&limits::LOOPS)).from(ZHANG),
        /// The program: groups in order.
        pub groups: Vec<ProgramGroup> = vec![ProgramGroup::Move(MoveGroup::default())] => label("Program").length(length(&limits::GROUPS), "groups")
            .term("Group", "One entry of the program: a move with length, speed, direction, acceleration and delay (Zhang 2012), or another kind, such as a wait or a repeat.")
            .from(ZHANG),
        /// Moves by button.
        pub jog: Jog = Jog::default() => label("Jog"),
        /// Moves back to zero.
        pub r#return: ReturnToZero = ReturnToZero::default() => label("Return to zero"),
        /// Search for a switch that sets the zero.
        pub home: Option<Homing> = None => label("Homing").null_means("no homing").from(OWN),
        /// Limits of commanded positions.
        pub soft_limits: Option<SoftLimits> = None => label("Soft limits").null_means("none").from(OWN),
        /// Virtual axis with switches.
        pub axis: Option<VirtualAxis> = None => label("Virtual axis").null_means("no switches").from(OWN),
        /// EEPROM and power failure.
        pub memory: Eeprom = Eeprom::default() => label("Memory"),
        /// Button presses, switches and pushes, with their times.
        pub inputs: Vec<PanelInput> = Vec::new() => label("Inputs").length(length(&limits::INPUTS), "inputs"),
    }
}

impl Direction {
    /// The direction of a level of DIR.
    pub const fn of_dir(is_high: bool) -> Self {
        if is_high { Self::Positive } else { Self::Negative }
    }

    /// Whether DIR is high.
    pub const fn is_positive(self) -> bool {
        matches!(self, Self::Positive)
    }
}

word_enums! {
    /// The direction of a move or a step.
    pub enum Direction {
        /// left: DIR is low, positions fall
        Negative = "negative" => label("left (negative)");
        /// right: DIR is high, positions rise
        Positive = "positive" => label("right (positive)");
    }
    /// How reliable the position of a controller is, in ascending order.
    pub enum PositionState {
        /// any position, also a lost one
        Lost = "lost" => label("lost (any)");
        /// restored from memory, or confirmed
        Restored = "restored" => label("restored");
        /// zero was set or found while the windings had current
        Confirmed = "confirmed" => label("confirmed");
    }
    /// A switch for homing.
    pub enum Switch {
        /// left limit switch
        LimitMin = "limit_min" => label("left limit switch");
        /// right limit switch
        LimitMax = "limit_max" => label("right limit switch");
        /// home switch
        HomeSwitch = "home_switch" => label("home switch");
    }
    /// A switch or an input that a program can test.
    pub enum Sensor {
        /// left limit switch
        LimitMin = "limit_min" => label("left limit switch");
        /// right limit switch
        LimitMax = "limit_max" => label("right limit switch");
        /// home switch
        HomeSwitch = "home_switch" => label("home switch");
        /// input 0
        In0 = "in_0" => label("in_0");
        /// input 1
        In1 = "in_1" => label("in_1");
        /// input 2
        In2 = "in_2" => label("in_2");
        /// input 3
        In3 = "in_3" => label("in_3");
    }
}

words! {
    ShortMove {
        Document = "at_start_speed", "start-stop rate": "run the whole move at the start-stop rate";
        TurnRound = "reverse", "accelerate and decelerate": "accelerate to the highest rate that fits, then decelerate";
    }
    Release {
        AtOnce = "at_once", "at once": "stops at once (Zhang 2012)";
        Ramp = "ramp", "by a ramp": "decelerates by the table";
    }
    Policy {
        PowerLoss = "power_loss", "when power fails": "the closing record is written during the hold-up time";
        WriteAhead = "write_ahead", "before each move": "one record before each move and one after it; no hold-up is needed";
    }
    Signal {
        Power = "power", "power": "supply; 1 before the first entry";
        Estop = "estop", "estop": "emergency stop";
        Start = "start", "start": "starts the program, or continues after a pause";
        Pause = "pause", "pause": "pauses a move or a delay";
        JogPlus = "jog_plus", "jog_plus": "jogs right while held";
        JogMinus = "jog_minus", "jog_minus": "jogs left while held";
        Zero = "zero", "zero": "returns to zero";
        Home = "home", "home": "starts homing";
        Debug = "debug", "debug": "fine jog and setting of zero";
        System = "system", "system": "opens the numbers";
        Ok = "ok", "ok": "confirms the entry; in fine jog sets the zero";
        Back = "back", "back": "leaves the numbers";
        Clear = "clear", "clear": "clears an alarm, a pause or an entry";
        Key0 = "key_0", "key_0": "digit 0";
        Key1 = "key_1", "key_1": "digit 1";
        Key2 = "key_2", "key_2": "digit 2";
        Key3 = "key_3", "key_3": "digit 3";
        Key4 = "key_4", "key_4": "digit 4";
        Key5 = "key_5", "key_5": "digit 5";
        Key6 = "key_6", "key_6": "digit 6";
        Key7 = "key_7", "key_7": "digit 7";
        Key8 = "key_8", "key_8": "digit 8";
        Key9 = "key_9", "key_9": "digit 9";
        LimitMin = "limit_min", "left limit switch": "left limit switch";
        LimitMax = "limit_max", "right limit switch": "right limit switch";
        HomeSwitch = "home_switch", "home switch": "home switch";
        In0 = "in_0", "in_0": "input 0";
        In1 = "in_1", "in_1": "input 1";
        In2 = "in_2", "in_2": "input 2";
        In3 = "in_3", "in_3": "input 3";
    }
}

const LENGTH: Field = label("Length").unit("digits")
    .term("Length", "Digits of the display without the decimal point: with one decimal 305 is 30.5 units. Each position is computed from the start of the program and then rounded to steps, so errors do not add up.")
    .from(ZHANG);
const POSITION_OF_GROUP: Field = label("Position").unit("digits").from(ZHANG);
const SPEED: Field = speed("Speed");
const fn speed(name: &'static str) -> Field {
    label(name).unit("Hz").range_text("10 to `max_speed_hz`").from(ZHANG)
}
const LEVEL: Field = label("Acceleration level").whole(whole(&limits::LEVEL)).from(ZHANG);
const DELAY: Field = label("Delay").unit("ms").whole(whole(&limits::DELAY_MS)).from(ZHANG);
const ON: Field = label("Level").whole(0..=1);
const DIRECTION: Field = label("Direction");

choices! {
    /// A group of the program.
    pub enum ProgramGroup {
        /// Moves by a length.
        Move(MoveGroup) = "move" => label("Move by").from(ZHANG),
        /// Moves to a position.
        MoveTo(MoveToGroup) = "move_to" => label("Move to").from(OWN),
        /// Runs a motion or a list of intervals.
        Profile(ProfileGroup) = "profile" => label("Profile").from(SONG),
        /// Runs homing.
        Home(HomeGroup) = "home" => label("Homing").from(OWN),
        /// Waits for an input.
        Wait(WaitGroup) = "wait" => label("Wait").from(OWN),
        /// Sets an output.
        Set(SetGroup) = "set" => label("Set output").from(OWN),
        /// Repeats previous groups.
        Repeat(RepeatGroup) = "repeat" => label("Repeat").from(OWN),
        /// Continues at another group.
        Jump(JumpGroup) = "jump" => label("Jump").from(OWN),
    }
}

settings! {
    /// A move by a length (Zhang 2012).
    pub struct MoveGroup {
        /// Digits of the display.
        pub length: u32 = 1000 => LENGTH.whole(whole(&limits::LENGTH)),
        /// Direction of the move.
        pub direction: Direction = Direction::Positive => DIRECTION.from(ZHANG),
        /// Rate of the plateau.
        pub speed_hz: u32 = 5000 => SPEED,
        /// Level times `level_hz_s`.
        pub acceleration_level: u8 = 3 => LEVEL,
        /// Delay after it.
        pub delay_ms: u32 = 0 => DELAY,
        /// An input that ends it early.
        pub until: Option<Until> = None => label("Until").null_means("full length").from(OWN),
    }
}

settings! {
    /// Level of an input that ends a move.
    pub struct Until {
        /// Input other than the limit switches.
        pub input: Sensor = Sensor::In0 => label("Input").range_text("not a limit switch").from(OWN),
        /// Level that ends the move.
        pub level: u8 = 1 => ON,
    }
}

settings! {
    /// A move to a position.
    pub struct MoveToGroup {
        /// Position in digits of the display.
        pub length: i64 = 0 => POSITION_OF_GROUP.signed(signed(&limits::TARGET)),
        /// Rate of the plateau.
        pub speed_hz: u32 = 5000 => SPEED,
        /// Level times `level_hz_s`.
        pub acceleration_level: u8 = 3 => LEVEL,
        /// Delay after it.
        pub delay_ms: u32 = 0 => DELAY,
    }
}

settings! {
    /// A motion of any kind or a list of intervals, in one direction.
    pub struct ProfileGroup {
        /// One move of an axis (`source.motion`), in steps and one direction.
        pub motion: Option<Move> = None => label("Motion").null_means("use the intervals"),
        /// Intervals, each before its step.
        pub intervals_q16: Vec<u64> = Vec::new() => label("One interval per line").unit("1/65536 cycle")
            .range_text("at least the pulse times, at most 2^64 - 1; up to 1 000 000 lines"),
        /// Direction of the steps; used with intervals.
        pub direction: Direction = Direction::Positive => DIRECTION,
        /// Delay after it.
        pub delay_ms: u32 = 0 => DELAY,
    }
}

settings! {
    /// Homing as a group of a program; `home` has its settings.
    pub struct HomeGroup {
    }
}

settings! {
    /// Waits for the level of an input.
    pub struct WaitGroup {
        /// Input.
        pub input: Sensor = Sensor::In0 => label("Input").from(OWN),
        /// Level to wait for.
        pub level: u8 = 1 => ON,
        /// Maximum wait; 0 waits forever.
        pub timeout_ms: u32 = 0 => label("Timeout").unit("ms").whole(whole(&limits::TIMEOUT_MS)).from(OWN),
        /// Next group after a timeout.
        pub then: Option<u8> = None => label("Then").range_text("1 to the number of groups").null_means("alarm TIMEOUT"),
    }
}

settings! {
    /// Sets an output.
    pub struct SetGroup {
        /// Output.
        pub output: u8 = 0 => label("Output").whole(whole(&limits::OUTPUT)).from(OWN),
        /// Level to set.
        pub level: u8 = 1 => ON,
    }
}

settings! {
    /// Returns to an earlier group until that group has run the given number of times.
    pub struct RepeatGroup {
        /// First group to repeat.
        pub first: u8 = 1 => label("First").range_text("1 to below this group's number").from(OWN),
        /// Number of runs.
        pub times: u16 = 2 => label("Times").whole(whole(&limits::LOOPS)).from(OWN),
    }
}

settings! {
    /// Continues at another group.
    pub struct JumpGroup {
        /// Next group.
        pub to: u8 = 1 => label("To").range_text("1 to the number of groups").from(OWN),
        /// Only if this input has the level.
        pub input: Option<Sensor> = None => label("Input").range_text("an input").null_means("always"),
        /// Level at which the jump is made.
        pub level: u8 = 1 => ON,
    }
}

settings! {
    /// Moves by the buttons `jog_plus` and `jog_minus`.
    pub struct Jog {
        /// Coarse jog, in state READY.
        pub speed_hz: u32 = 1000 => SPEED,
        /// Fine jog, in state DEBUG.
        pub fine_hz: u32 = 10 => speed("Fine speed"),
        /// Acceleration of the ramp at the end.
        pub acceleration_level: u8 = 3 => LEVEL,
        /// How a jog ends.
        pub release: Release = Release::AtOnce => label("Release").from(ZHANG),
    }
}

settings! {
    /// Moves back to position 0.
    pub struct ReturnToZero {
        /// Rate of the plateau.
        pub speed_hz: u32 = 1000 => SPEED,
        /// Level times `level_hz_s`.
        pub acceleration_level: u8 = 3 => LEVEL,
    }
}

settings! {
    /// Moves to a switch, away from it, and slowly back to it. There the position is known.
    pub struct Homing {
        /// Switch to search for.
        pub switch: Switch = Switch::HomeSwitch => label("Switch").from(OWN),
        /// Direction of the search.
        pub direction: Direction = Direction::Negative => DIRECTION,
        /// Rate toward the switch.
        pub coarse_hz: u32 = 1000 => label("Coarse rate").unit("Hz").range_text("10 to `start_speed_hz`").from(OWN),
        /// Rate of the final approach.
        pub fine_hz: u32 = 10 => label("Fine rate").unit("Hz").range_text("10 to `start_speed_hz`").from(OWN),
        /// Steps to continue after the switch opens.
        pub pull_off_steps: u32 = 20 => label("Pull-off").unit("steps").whole(whole(&limits::PULL_OFF_STEPS)).from(OWN),
        /// Maximum steps of each approach.
        pub max_travel_steps: u32 = 100_000 => label("Max travel").unit("steps").whole(whole(&limits::TRAVEL_STEPS)).from(OWN),
        /// Position of the switch.
        pub position_steps: i64 = 0 => label("Position of the switch").unit("steps").signed(signed(&limits::STEPS)).from(OWN),
    }
}

settings! {
    /// Limits of the positions that a group or a return may command.
    pub struct SoftLimits {
        /// Minimum.
        pub min_steps: i64 = *limits::STEPS.start() as i64 => label("Minimum").unit("steps").signed(signed(&limits::STEPS)).from(OWN),
        /// Maximum.
        pub max_steps: i64 = *limits::STEPS.end() as i64 => label("Maximum").unit("steps").signed(signed(&limits::STEPS)).from(OWN),
    }
}

const fn axis_position(name: &'static str) -> Field {
    label(name).unit("steps").signed(signed(&limits::STEPS)).from(OWN)
}

settings! {
    /// A nut that follows the steps while the windings are powered, with hard ends and switches.
    pub struct VirtualAxis {
        /// Initial position.
        pub start_steps: i64 = 0 => axis_position("Start"),
        /// `limit_min` is 1 from here to the left.
        pub min_switch_at_steps: Option<i64> = None => axis_position("Left switch, up to").null_means("the left limit switch is an input"),
        /// `limit_max` is 1 from here to the right.
        pub max_switch_at_steps: Option<i64> = None => axis_position("Right switch, from").null_means("the right limit switch is an input"),
        /// Left end of the range in which `home_switch` is 1.
        pub home_from_steps: Option<i64> = None => axis_position("Home switch, from").null_means("the home switch is an input"),
        /// Right end of this range. Set both or neither.
        pub home_to_steps: Option<i64> = None => axis_position("Home switch, to").null_means("the home switch is an input"),
        /// Hard stop on the left, where steps are lost.
        pub hard_min_steps: Option<i64> = None => axis_position("Left hard stop").null_means("no hard stop"),
        /// Hard stop on the right.
        pub hard_max_steps: Option<i64> = None => axis_position("Right hard stop").null_means("no hard stop"),
    }
}

settings! {
    /// EEPROM with the position journal, and hold-up of the supply.
    pub struct Eeprom {
        /// When the position is saved.
        pub policy: Policy = Policy::PowerLoss => label("Save position").from(OWN),
        /// Time to write one byte; 8.5 ms on an ATmega128.
        pub byte_write_cycles: u32 = 136_000 => label("Byte write time").unit("cycles").whole(whole(&limits::BYTE_WRITE_CYCLES))
            .from(ZHANG),
        /// How long the controller runs after a power loss.
        pub hold_up_cycles: u64 = 3_200_000 => label("Hold-up").unit("cycles").whole(whole(&limits::HOLD_UP_CYCLES))
            .term("Hold-up", "After a power failure the motors are off, and a capacitor supplies the controller for this time. Saving the position takes 16 bytes; 17 byte write times minus one cycle are always enough.")
            .from(OWN),
        /// Records of the journal, written in rotation.
        pub slots: u8 = 8 => label("Slots").whole(whole(&limits::SLOTS)).from(OWN),
        /// Initial content: `blank` (erased), `factory` (position 0, confirmed), or bytes in hex from address 0.
        pub initial: Initial = Initial::Factory => label("Initial content").from(OWN),
    }
}

settings! {
    /// An input changes its level in a cycle, or a hand pushes the axis.
    pub struct PanelInput {
        /// Cycle of the change.
        pub cycle: u64 = 1 => label("Cycle").unit("cycles").whole(whole(&limits::INPUT_CYCLE)),
        /// Input that changes.
        pub input: Option<Signal> = None => label("Input").range_text("an input").null_means("a push"),
        /// New level.
        pub level: u8 = 1 => ON,
        /// Moves the axis by this number of steps while the windings have no current.
        pub push_steps: Option<i64> = None => label("Push").unit("steps").signed(signed(&limits::PUSH_STEPS)).null_means("an input"),
    }
}
