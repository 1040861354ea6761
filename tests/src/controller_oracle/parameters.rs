//! "The format": the fields of a case, with the table's defaults.

/// A run of the controllers of one bus.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// f.
    pub clock_hz: u64,
    /// Channels of the bus, 1 to 16.
    pub channels: usize,
    /// `pulse_width_cycles`.
    pub w: u64,
    /// `dir_setup_cycles`.
    pub d: u64,
    /// `dir_hold_cycles`.
    pub h: u64,
    /// Cycles 0 to this minus 1; `None`: until nothing can change.
    pub run_cycles: Option<u64>,
    /// Controller i drives channel i.
    pub controllers: Vec<Controller>,
}

/// One controller.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the format's table says what each is")]
pub struct Controller {
    pub self_test_cycles: u64,
    pub debounce_cycles: u64,
    pub sensor_debounce_cycles: u64,
    pub pulses_per_unit: i64,
    pub decimals: i64,
    pub start_speed_hz: i64,
    pub max_speed_hz: i64,
    pub level_hz_s: i64,
    pub short_move: ShortMove,
    pub least_trust: u8,
    pub loops: i64,
    pub groups: Vec<Group>,
    pub jog: Jog,
    pub return_to_zero: Return,
    pub home: Option<Home>,
    pub soft_limits: Option<SoftLimits>,
    pub axis: Option<Axis>,
    pub memory: Memory,
    pub inputs: Vec<Entry>,
}

impl Default for Controller {
    fn default() -> Self {
        Self {
            self_test_cycles: 1600,
            debounce_cycles: 160_000,
            sensor_debounce_cycles: 0,
            pulses_per_unit: 100,
            decimals: 1,
            start_speed_hz: 1000,
            max_speed_hz: 20_000,
            level_hz_s: 1000,
            short_move: ShortMove::Document,
            least_trust: 1,
            loops: 1,
            groups: vec![Group::Move(Move::default())],
            jog: Jog { speed_hz: 1000, fine_hz: 10, level: 3, release: Release::AtOnce },
            return_to_zero: Return { speed_hz: 1000, level: 3 },
            home: None,
            soft_limits: None,
            axis: None,
            memory: Memory::default(),
            inputs: Vec::new(),
        }
    }
}

/// Behavior of a move that is too short for its speed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the format's words")]
pub enum ShortMove {
    Document,
    TurnRound,
}

/// `until` of a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the format's words")]
pub struct Until {
    pub input: Input,
    pub level: bool,
}

/// The paper's group.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the format's words")]
pub struct Move {
    pub length: i64,
    pub right: bool,
    pub speed_hz: i64,
    pub level: i64,
    pub delay_ms: i64,
    pub until: Option<Until>,
}

impl Default for Move {
    fn default() -> Self {
        Self { length: 1000, right: true, speed_hz: 5000, level: 3, delay_ms: 0, until: None }
    }
}

/// A `profile` of intervals.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the format's words")]
pub struct Profile {
    pub intervals_q16: Vec<u64>,
    pub right: bool,
    pub delay_ms: i64,
}

/// A group of the program. Groups are counted from 1.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the format's words")]
pub enum Group {
    Move(Move),
    MoveTo { length: i64, speed_hz: i64, level: i64, delay_ms: i64 },
    Profile(Profile),
    Home,
    Wait { input: Input, level: bool, timeout_ms: i64, then: Option<usize> },
    Set { output: u8, level: bool },
    Repeat { first: usize, times: u32 },
    Jump { to: usize, input: Option<Input>, level: bool },
}

/// Effect of releasing a jog button.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the format's words")]
pub enum Release {
    AtOnce,
    Ramp,
}

/// `jog`.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the format's words")]
pub struct Jog {
    pub speed_hz: i64,
    pub fine_hz: i64,
    pub level: i64,
    pub release: Release,
}

/// `return`.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the format's words")]
pub struct Return {
    pub speed_hz: i64,
    pub level: i64,
}

/// `home`.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the format's words")]
pub struct Home {
    pub switch: Input,
    pub right: bool,
    pub coarse_hz: i64,
    pub fine_hz: i64,
    pub pull_off_steps: i64,
    pub max_travel_steps: i64,
    pub position_steps: i64,
}

impl Default for Home {
    fn default() -> Self {
        Self {
            switch: Input::HomeSwitch,
            right: false,
            coarse_hz: 1000,
            fine_hz: 10,
            pull_off_steps: 20,
            max_travel_steps: 100_000,
            position_steps: 0,
        }
    }
}

/// `soft_limits`.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the format's words")]
pub struct SoftLimits {
    pub min_steps: i64,
    pub max_steps: i64,
}

/// `axis`.
#[derive(Debug, Clone, PartialEq, Default)]
#[expect(missing_docs, reason = "the format's words")]
pub struct Axis {
    pub start_steps: i64,
    pub min_switch_at_steps: Option<i64>,
    pub max_switch_at_steps: Option<i64>,
    pub home_from_steps: Option<i64>,
    pub home_to_steps: Option<i64>,
    pub hard_min_steps: Option<i64>,
    pub hard_max_steps: Option<i64>,
}

/// When the journal is written (G7).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the format's words")]
pub enum Policy {
    PowerLoss,
    WriteAhead,
}

/// Contents of the EEPROM at reset.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the format's words")]
pub enum Initial {
    Blank,
    Factory,
    Bytes(Vec<u8>),
}

/// `memory`.
#[derive(Debug, Clone, PartialEq)]
#[expect(missing_docs, reason = "the format's words")]
pub struct Memory {
    pub policy: Policy,
    pub byte_write_cycles: u64,
    pub hold_up_cycles: u64,
    pub slots: usize,
    pub initial: Initial,
}

impl Default for Memory {
    fn default() -> Self {
        Self {
            policy: Policy::PowerLoss,
            byte_write_cycles: 136_000,
            hold_up_cycles: 3_200_000,
            slots: 8,
            initial: Initial::Factory,
        }
    }
}

/// An input of the script.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the format's words")]
pub enum Input {
    Power,
    Estop,
    Clear,
    Start,
    Pause,
    JogPlus,
    JogMinus,
    Zero,
    Home,
    Debug,
    System,
    Ok,
    Back,
    Key(u8),
    LimitMin,
    LimitMax,
    HomeSwitch,
    In(u8),
}

/// Number of inputs.
pub(super) const INPUTS: usize = 30;

impl Input {
    /// Index in an array of levels.
    pub(super) fn index(self) -> usize {
        match self {
            Self::Power => 0,
            Self::Estop => 1,
            Self::Clear => 2,
            Self::Start => 3,
            Self::Pause => 4,
            Self::JogPlus => 5,
            Self::JogMinus => 6,
            Self::Zero => 7,
            Self::Home => 8,
            Self::Debug => 9,
            Self::System => 10,
            Self::Ok => 11,
            Self::Back => 12,
            Self::Key(digit) => 13 + usize::from(digit),
            Self::LimitMin => 23,
            Self::LimitMax => 24,
            Self::HomeSwitch => 25,
            Self::In(number) => 26 + usize::from(number),
        }
    }

    /// Its name in "the format".
    pub fn name(self) -> String {
        match self {
            Self::Power => "power".into(),
            Self::Estop => "estop".into(),
            Self::Clear => "clear".into(),
            Self::Start => "start".into(),
            Self::Pause => "pause".into(),
            Self::JogPlus => "jog_plus".into(),
            Self::JogMinus => "jog_minus".into(),
            Self::Zero => "zero".into(),
            Self::Home => "home".into(),
            Self::Debug => "debug".into(),
            Self::System => "system".into(),
            Self::Ok => "ok".into(),
            Self::Back => "back".into(),
            Self::Key(digit) => format!("key_{digit}"),
            Self::LimitMin => "limit_min".into(),
            Self::LimitMax => "limit_max".into(),
            Self::HomeSwitch => "home_switch".into(),
            Self::In(number) => format!("in_{number}"),
        }
    }

    /// Whether the entries of controller 0 apply to all.
    pub(super) fn is_common(self) -> bool {
        matches!(self, Self::Power | Self::Estop | Self::Clear)
    }
}

/// Effect of an entry of the script.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the format's words")]
pub enum What {
    Level(Input, bool),
    Push(i64),
}

/// An entry of the script.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the format's words")]
pub struct Entry {
    pub cycle: u64,
    pub what: What,
}
