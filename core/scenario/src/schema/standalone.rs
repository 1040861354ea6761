//! Stand-alone controllers (CONTROLLER.md, "The format").

use crate::schema::{
    Field, OWN, SONG, ZHANG, label,
    rows::{choices, settings, words},
};
use alloc::{vec, vec::Vec};
use core::ops::RangeInclusive;
use stepscope_controller::{
    input::Signal,
    limits,
    parameters::{Initial, Policy, Release, ShortMove},
};
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
    /// Nothing is sent: controller i drives channel i by buttons, a program and switches of its own. Of `bus` only
    /// `channels` and the three times of a pulse count, of `line` nothing. The default is a controller that waits for
    /// buttons. Lengths are the digits of its display: with one decimal 305 is 30.5.
    ///
    /// What EN does follows from its power, its emergency stop and its alarms. Of several controllers `power`, `estop` and
    /// `clear` are the first one's for all.
    pub struct StandAlone {
        /// Self-test after each power-up.
        pub self_test_cycles: u32 = 1600 => label("Self-test").unit("cycles").whole(whole(&limits::SELF_TEST_CYCLES)).from(ZHANG),
        /// How long a button, a key or the release of the emergency stop has to stand to count.
        pub debounce_cycles: u32 = 160_000 => label("Debounce, buttons").unit("cycles").whole(whole(&limits::DEBOUNCE_CYCLES))
            .term("Debounce", "A contact bounces for some milliseconds. A level counts once it has stood for so long; a shorter one is not seen.")
            .from(ZHANG),
        /// The same of limit and home switches and of `in_0` to `in_3`.
        pub sensor_debounce_cycles: u32 = 0 => label("Debounce, switches").unit("cycles").whole(whole(&limits::DEBOUNCE_CYCLES)).from(OWN),
        /// Pulses a unit of length, as measured (`stepscope calibrate`).
        pub pulses_per_unit: u32 = 100 => label("Pulses a unit").unit("pulses").whole(whole(&limits::PULSES_PER_UNIT))
            .term("Pulses a unit", "How many pulses make one unit of length, centimetres in the document: measured with the table itself, so that the screw's and the gear's errors are in it.")
            .from(ZHANG),
        /// Decimal places of lengths: with 1 the digits 305 are 30.5.
        pub decimals: u8 = 1 => label("Decimals").whole(whole(&limits::DECIMALS)).from(ZHANG),
        /// Lowest rate of the table, f_1: a motor jumps to it from standing still.
        pub start_speed_hz: u32 = 1000 => label("Start-stop rate").unit("Hz").follows("10 to `max_speed_hz`")
            .term("Start-stop rate", "The motor can start and stop at this rate at once. Where it has to jump beyond it, steps may be lost, so the place is not trusted any more.")
            .from(ZHANG),
        /// The fastest that may be asked for.
        pub max_speed_hz: u32 = 20_000 => label("Greatest speed").unit("Hz").follows("10 to 10^7; a step no sooner than a pulse allows").from(ZHANG),
        /// Acceleration of level 1; level n has n times as much.
        pub level_hz_s: u32 = 1000 => label("Acceleration of level 1").unit("Hz/s").whole(whole(&limits::LEVEL_HZ_S)).from(ZHANG),
        /// What becomes of a move that is too short for its speed.
        pub short_move: ShortMove = ShortMove::Document => label("Short moves").from(ZHANG),
        /// Trust that start asks for: 0 LOST, 1 HELD, 2 SURE.
        pub least_trust: u8 = 1 => label("Trust to start").whole(whole(&limits::TRUST))
            .term("Trust", "How sure the controller is of its place. SURE: a zero was set or found. HELD: it was sure, but the windings were without current since. LOST: after a power loss that memory did not outlive, or a jump beyond the start-stop rate.")
            .from(OWN),
        /// Runs of the program.
        pub loops: u16 = 1 => label("Loops").whole(whole(&limits::LOOPS)).from(ZHANG),
        /// The program: one group after another.
        pub groups: Vec<ProgramGroup> = vec![ProgramGroup::Move(MoveGroup::default())] => label("Program").length(length(&limits::GROUPS), "groups")
            .term("Group", "A step of the program: a move by a length with its speed, direction, acceleration and the pause after it, as in the document; or one of the kinds beyond it.")
            .from(ZHANG),
        /// Moving by a button.
        pub jog: Jog = Jog::default() => label("Jog"),
        /// Moving back to zero.
        pub r#return: ReturnToZero = ReturnToZero::default() => label("Return to zero"),
        /// Looking for a switch, which sets the zero.
        pub home: Option<Homing> = None => label("Homing").empty("there is no homing").from(OWN),
        /// Bounds of the positions that are ordered.
        pub soft_limits: Option<SoftLimits> = None => label("Soft limits").empty("none").from(OWN),
        /// A virtual axis with switches.
        pub axis: Option<VirtualAxis> = None => label("Virtual axis").empty("one without switches").from(OWN),
        /// The EEPROM, and what happens when power fails.
        pub memory: Eeprom = Eeprom::default() => label("Memory"),
        /// What is pressed, switched and pushed, and when.
        pub inputs: Vec<PanelInput> = Vec::new() => label("Inputs").length(length(&limits::INPUTS), "inputs"),
    }
}

/// A switch that homing can look for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Switch {
    /// Limit switch to the left.
    LimitMin,
    /// Limit switch to the right.
    LimitMax,
    /// Home switch.
    HomeSwitch,
}

/// A switch or an input, which a program can look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// Limit switch to the left.
    LimitMin,
    /// Limit switch to the right.
    LimitMax,
    /// Home switch.
    HomeSwitch,
    /// Input 0.
    In0,
    /// Input 1.
    In1,
    /// Input 2.
    In2,
    /// Input 3.
    In3,
}

words! {
    ShortMove {
        /// the whole of it at the start-stop rate
        Document = "document", "start-stop rate";
        /// up and down as far as it goes
        TurnRound = "turn_round", "up and down";
    }
    Release {
        /// stops at once, as in the document
        AtOnce = "at_once", "at once";
        /// slows down by the table
        Ramp = "ramp", "by a ramp";
    }
    Policy {
        /// the closing record is written while the supply's buffer holds
        PowerLoss = "power_loss", "when power fails";
        /// an opening record before each move, a closing one after it: no buffer is needed
        WriteAhead = "write_ahead", "before each move";
    }
    Switch {
        /// limit switch to the left
        LimitMin = "limit_min", "limit_min";
        /// limit switch to the right
        LimitMax = "limit_max", "limit_max";
        /// home switch
        HomeSwitch = "home_switch", "home_switch";
    }
    Sensor {
        /// limit switch to the left
        LimitMin = "limit_min", "limit_min";
        /// limit switch to the right
        LimitMax = "limit_max", "limit_max";
        /// home switch
        HomeSwitch = "home_switch", "home_switch";
        /// input 0
        In0 = "in_0", "in_0";
        /// input 1
        In1 = "in_1", "in_1";
        /// input 2
        In2 = "in_2", "in_2";
        /// input 3
        In3 = "in_3", "in_3";
    }
    Signal {
        /// supply; 1 before its first entry
        Power = "power", "power";
        /// emergency stop
        Estop = "estop", "estop";
        /// starts the program, or goes on after a pause
        Start = "start", "start";
        /// pauses a move or a delay
        Pause = "pause", "pause";
        /// jogs to the right while it is held
        JogPlus = "jog_plus", "jog_plus";
        /// jogs to the left while it is held
        JogMinus = "jog_minus", "jog_minus";
        /// returns to zero
        Zero = "zero", "zero";
        /// looks for the switch
        Home = "home", "home";
        /// fine jog, and setting the zero
        Debug = "debug", "debug";
        /// the numbers
        System = "system", "system";
        /// takes the entry; in fine jog sets the zero
        Ok = "ok", "ok";
        /// leaves the numbers
        Back = "back", "back";
        /// clears an alarm, a pause or an entry
        Clear = "clear", "clear";
        /// digit 0
        Key0 = "key_0", "key_0";
        /// digit 1
        Key1 = "key_1", "key_1";
        /// digit 2
        Key2 = "key_2", "key_2";
        /// digit 3
        Key3 = "key_3", "key_3";
        /// digit 4
        Key4 = "key_4", "key_4";
        /// digit 5
        Key5 = "key_5", "key_5";
        /// digit 6
        Key6 = "key_6", "key_6";
        /// digit 7
        Key7 = "key_7", "key_7";
        /// digit 8
        Key8 = "key_8", "key_8";
        /// digit 9
        Key9 = "key_9", "key_9";
        /// limit switch to the left
        LimitMin = "limit_min", "limit_min";
        /// limit switch to the right
        LimitMax = "limit_max", "limit_max";
        /// home switch
        HomeSwitch = "home_switch", "home_switch";
        /// input 0
        In0 = "in_0", "in_0";
        /// input 1
        In1 = "in_1", "in_1";
        /// input 2
        In2 = "in_2", "in_2";
        /// input 3
        In3 = "in_3", "in_3";
    }
}

/// A length in digits of the display, forwards only.
const LENGTH: Field = label("Length").unit("digits")
    .term("Length", "As the display shows it, without its point: with one decimal 305 is 30.5 units. Steps follow by pulses a unit, rounded once from the program's start, so nothing adds up over loops.")
    .from(ZHANG);
/// A place, by the digits of the display; the zero is 0.
const PLACE_OF_GROUP: Field = label("Place").unit("digits").from(ZHANG);
/// A plateau's rate.
const SPEED: Field = speed("Speed");
/// The same by another name.
const fn speed(name: &'static str) -> Field {
    label(name).unit("Hz").follows("10 to `max_speed_hz`").from(ZHANG)
}
/// One of five accelerations.
const LEVEL: Field = label("Acceleration level").whole(whole(&limits::LEVEL)).from(ZHANG);
/// The pause after a group.
const DELAY: Field = label("Delay").unit("ms").whole(whole(&limits::DELAY_MS)).from(ZHANG);
/// A level of an input or an output.
const ON: Field = label("Level").whole(0..=1);
/// 1 right, 0 left.
const DIRECTION: Field = label("Direction").whole(0..=1);

choices! {
    /// A group of the program.
    pub enum ProgramGroup {
        /// By a length.
        Move(MoveGroup) = "move" => label("Move by").from(ZHANG),
        /// To a place.
        MoveTo(MoveToGroup) = "move_to" => label("Move to").from(OWN),
        /// Along a motion or a list of intervals.
        Profile(ProfileGroup) = "profile" => label("Profile").from(SONG),
        /// Looks for the switch.
        Home(HomeGroup) = "home" => label("Homing").from(OWN),
        /// Waits for an input.
        Wait(WaitGroup) = "wait" => label("Wait").from(OWN),
        /// Sets an output.
        Set(SetGroup) = "set" => label("Set output").from(OWN),
        /// Goes back some times.
        Repeat(RepeatGroup) = "repeat" => label("Repeat").from(OWN),
        /// Goes elsewhere.
        Jump(JumpGroup) = "jump" => label("Jump").from(OWN),
    }
}

settings! {
    /// A move by a length, the document's group.
    pub struct MoveGroup {
        /// Digits of the display.
        pub length: u32 = 1000 => LENGTH.whole(whole(&limits::LENGTH)),
        /// 1 right, 0 left.
        pub direction: u8 = 1 => DIRECTION.from(ZHANG),
        /// Rate of the plateau.
        pub speed_hz: u32 = 5000 => SPEED,
        /// Level times `level_hz_s`.
        pub level: u8 = 3 => LEVEL,
        /// Pause after it.
        pub delay_ms: u32 = 0 => DELAY,
        /// An input that ends it early.
        pub until: Option<Until> = None => label("Until").empty("it goes its whole way").from(OWN),
    }
}

settings! {
    /// The level of an input that ends a move.
    pub struct Until {
        /// `home_switch` or `in_0` to `in_3`.
        pub input: Sensor = Sensor::In0 => label("Input").follows("not a limit").from(OWN),
        /// The level.
        pub level: u8 = 1 => ON,
    }
}

settings! {
    /// A move to a place.
    pub struct MoveToGroup {
        /// Place in digits of the display.
        pub length: i64 = 0 => PLACE_OF_GROUP.signed(signed(&limits::PLACE)),
        /// Rate of the plateau.
        pub speed_hz: u32 = 5000 => SPEED,
        /// Level times `level_hz_s`.
        pub level: u8 = 3 => LEVEL,
        /// Pause after it.
        pub delay_ms: u32 = 0 => DELAY,
    }
}

settings! {
    /// A motion of any kind, or a list of intervals, one way.
    pub struct ProfileGroup {
        /// One move of an axis (`source.motion`), in steps; it goes one way.
        pub motion: Option<Move> = None => label("Motion").empty("the intervals"),
        /// Interval of each step, up to 1 000 000 of them.
        pub intervals_q16: Vec<u64> = Vec::new() => label("Intervals, one a line").unit("1/65536 cycle")
            .follows("a pulse's least interval to 2^64 - 1; up to 1 000 000"),
        /// 1 right, 0 left; of intervals.
        pub direction: u8 = 1 => DIRECTION,
        /// Pause after it.
        pub delay_ms: u32 = 0 => DELAY,
    }
}

settings! {
    /// Homing as a group of a program: `home` says how.
    pub struct HomeGroup {
    }
}

settings! {
    /// Waits until an input has a level.
    pub struct WaitGroup {
        /// Which.
        pub input: Sensor = Sensor::In0 => label("Input").from(OWN),
        /// The level.
        pub level: u8 = 1 => ON,
        /// For how long at most; 0 is for ever.
        pub timeout_ms: u32 = 0 => label("Time-out").unit("ms").whole(whole(&limits::TIMEOUT_MS)).from(OWN),
        /// The group after a time-out.
        pub then: Option<u8> = None => label("Then").follows("1 to the number of groups").empty("alarm TIMEOUT"),
    }
}

settings! {
    /// Sets an output.
    pub struct SetGroup {
        /// Which.
        pub output: u8 = 0 => label("Output").whole(whole(&limits::OUTPUT)).from(OWN),
        /// The level.
        pub level: u8 = 1 => ON,
    }
}

settings! {
    /// Goes back to a group until it was reached so many times.
    pub struct RepeatGroup {
        /// The group that it goes back to.
        pub first: u8 = 1 => label("First").follows("1 to below this group's number").from(OWN),
        /// How many times that one is reached.
        pub times: u16 = 2 => label("Times").whole(whole(&limits::LOOPS)).from(OWN),
    }
}

settings! {
    /// Goes on at another group.
    pub struct JumpGroup {
        /// Which.
        pub to: u8 = 1 => label("To").follows("1 to the number of groups").from(OWN),
        /// Only if this input has the level.
        pub input: Option<Sensor> = None => label("Input").empty("always"),
        /// The level.
        pub level: u8 = 1 => ON,
    }
}

settings! {
    /// Moving by the buttons `jog_plus` and `jog_minus`.
    pub struct Jog {
        /// Coarse, from READY.
        pub speed_hz: u32 = 1000 => SPEED,
        /// Fine, from DEBUG.
        pub fine_hz: u32 = 10 => speed("Fine speed"),
        /// Acceleration, where a jog ends by a ramp.
        pub level: u8 = 3 => LEVEL,
        /// How it ends.
        pub release: Release = Release::AtOnce => label("Release").from(ZHANG),
    }
}

settings! {
    /// Moving back to position 0.
    pub struct ReturnToZero {
        /// Rate of the plateau.
        pub speed_hz: u32 = 1000 => SPEED,
        /// Level times `level_hz_s`.
        pub level: u8 = 3 => LEVEL,
    }
}

settings! {
    /// Towards a switch, away from it, and slowly back to it; there the position is known.
    pub struct Homing {
        /// What it looks for.
        pub switch: Switch = Switch::HomeSwitch => label("Switch").from(OWN),
        /// 1 right, 0 left.
        pub direction: u8 = 0 => DIRECTION,
        /// Rate of the search.
        pub coarse_hz: u32 = 1000 => label("Coarse rate").unit("Hz").follows("10 to `start_speed_hz`").from(OWN),
        /// Rate of the last approach.
        pub fine_hz: u32 = 10 => label("Fine rate").unit("Hz").follows("10 to `start_speed_hz`").from(OWN),
        /// Steps away from the switch after it has opened.
        pub pull_off_steps: u32 = 20 => label("Pull-off").unit("steps").whole(whole(&limits::PULL_OFF_STEPS)).from(OWN),
        /// Most steps of each leg.
        pub travel_steps: u32 = 100_000 => label("Travel").unit("steps").whole(whole(&limits::TRAVEL_STEPS)).from(OWN),
        /// Position of the switch.
        pub position_steps: i64 = 0 => label("Position of the switch").unit("steps").signed(signed(&limits::STEPS)).from(OWN),
    }
}

settings! {
    /// Bounds of the positions that a group or a return may order.
    pub struct SoftLimits {
        /// Least.
        pub min_steps: i64 = *limits::STEPS.start() as i64 => label("Least").unit("steps").signed(signed(&limits::STEPS)).from(OWN),
        /// Greatest, at least as much.
        pub max_steps: i64 = *limits::STEPS.end() as i64 => label("Greatest").unit("steps").signed(signed(&limits::STEPS)).from(OWN),
    }
}

/// A place on the virtual axis.
const fn place(name: &'static str) -> Field {
    label(name).unit("steps").signed(signed(&limits::STEPS)).from(OWN)
}

settings! {
    /// A nut that follows the steps while the windings are powered, between hard ends, with switches along its way.
    pub struct VirtualAxis {
        /// Where it stands at first.
        pub start_steps: i64 = 0 => place("Start"),
        /// limit_min is 1 from here to the left.
        pub min_switch_at: Option<i64> = None => place("Left switch, up to").empty("limit_min is an input"),
        /// limit_max is 1 from here to the right.
        pub max_switch_at: Option<i64> = None => place("Right switch, from").empty("limit_max is an input"),
        /// home_switch is 1 from here …
        pub home_from: Option<i64> = None => place("Home switch, from").empty("home_switch is an input"),
        /// … to here; both or neither.
        pub home_to: Option<i64> = None => place("Home switch, to").empty("home_switch is an input"),
        /// It cannot go further to the left: steps are lost there.
        pub hard_min: Option<i64> = None => place("Left end").empty("there is no end"),
        /// It cannot go further to the right.
        pub hard_max: Option<i64> = None => place("Right end").empty("there is no end"),
    }
}

settings! {
    /// The EEPROM with its journal of the position, and the supply's buffer.
    pub struct Eeprom {
        /// When the position is written.
        pub policy: Policy = Policy::PowerLoss => label("Policy").from(OWN),
        /// Time to write a byte; 8.5 ms on an ATmega128.
        pub byte_write_cycles: u32 = 136_000 => label("Time to write a byte").unit("cycles").whole(whole(&limits::BYTE_WRITE_CYCLES))
            .from(ZHANG),
        /// How long the supply's buffer feeds the controller after a power loss.
        pub hold_up_cycles: u64 = 3_200_000 => label("Hold-up").unit("cycles").whole(whole(&limits::HOLD_UP_CYCLES))
            .term("Hold-up", "When the supply fails, the motors are switched off at once and a capacitor feeds the controller for so long. A record in memory takes 16 bytes: with 17 byte times less one cycle it is written for sure.")
            .from(OWN),
        /// Records of the journal, written in turn.
        pub slots: u8 = 8 => label("Slots").whole(whole(&limits::SLOTS)).from(OWN),
        /// What it holds at first: `blank` (erased), `factory` (position 0, sure), or bytes in hexadecimal from address 0.
        pub initial: Initial = Initial::Factory => label("At first").from(OWN),
    }
}

settings! {
    /// An input takes a level in a cycle, and keeps it; or a hand pushes the axis.
    pub struct PanelInput {
        /// When.
        pub cycle: u64 = 1 => label("Cycle").unit("cycles").whole(whole(&limits::INPUT_CYCLE)),
        /// Which input.
        pub input: Option<Signal> = None => label("Input").empty("a push"),
        /// Its level from then on.
        pub level: u8 = 1 => ON,
        /// Moves the axis by so many steps, while its windings are without current.
        pub push_steps: Option<i64> = None => label("Push").unit("steps").signed(signed(&limits::PUSH_STEPS)).empty("an input"),
    }
}
