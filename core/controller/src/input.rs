//! Inputs of a controller: buttons, keys, switches, power, and manual pushes of the axis (CONTROLLER.md, "The format").
//!
//! ```
//! use stepscope_controller::input::{Change, Input, Signal};
//! use stepscope_peripheral::units::Instant;
//!
//! let press = Input { cycle: Instant(4000), change: Change::Level(Signal::Start, true) };
//! assert_eq!(press.change.name(), "start");
//! assert_eq!(Signal::by_name("key_7"), Some(Signal::Key7));
//! ```

use crate::named::named_enum;
use stepscope_peripheral::units::Instant;

// The order matters: a cycle handles buttons and keys in it (G1.4), and `is_button`, `is_sensor` and `digit` are ranges of it.
named_enum! { (PartialOrd, Ord, Hash)
    /// An input signal of a controller.
    pub enum Signal {
        /// The supply; initially 1.
        Power = "power",
        /// The emergency stop, 1 while it is pressed.
        Estop = "estop",
        /// Clears an alarm, an entry, or a paused program.
        Clear = "clear",
        /// Starts or resumes the program.
        Start = "start",
        /// Pauses the program or the return to zero.
        Pause = "pause",
        /// Jog to the right while it is held.
        JogPlus = "jog_plus",
        /// Jog to the left while it is held.
        JogMinus = "jog_minus",
        /// Returns to zero, or homes if the position is lost.
        Zero = "zero",
        /// Starts homing.
        Home = "home",
        /// Enters or leaves DEBUG.
        Debug = "debug",
        /// Enters EDIT, or selects the next number.
        System = "system",
        /// Stores an entry; sets zero in DEBUG.
        Ok = "ok",
        /// Leaves EDIT and saves the numbers.
        Back = "back",
        Key0 = "key_0",
        Key1 = "key_1",
        Key2 = "key_2",
        Key3 = "key_3",
        Key4 = "key_4",
        Key5 = "key_5",
        Key6 = "key_6",
        Key7 = "key_7",
        Key8 = "key_8",
        Key9 = "key_9",
        /// Switch at the left end of the axis.
        LimitMin = "limit_min",
        /// Switch at the right end of the axis.
        LimitMax = "limit_max",
        /// Switch for homing.
        HomeSwitch = "home_switch",
        /// Free inputs 0 to 3 of programs.
        In0 = "in_0",
        In1 = "in_1",
        In2 = "in_2",
        In3 = "in_3",
    }
}

/// Number of signals.
pub const SIGNALS: usize = Signal::ALL.len();

impl Signal {
    /// The signal with this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|signal| signal.name() == name)
    }

    /// Whether it is a button or a key.
    pub fn is_button(self) -> bool {
        (Self::Clear..=Self::Key9).contains(&self)
    }

    /// Whether `sensor_debounce_cycles` applies: limits, home switch, and `in_0` to `in_3`.
    pub fn is_sensor(self) -> bool {
        self >= Self::LimitMin
    }

    /// Whether it is a limit or home switch, which the simulated axis can operate by its position.
    pub const fn is_switch(self) -> bool {
        matches!(self, Self::LimitMin | Self::LimitMax | Self::HomeSwitch)
    }

    /// The digit of a key.
    pub fn digit(self) -> Option<u8> {
        (Self::Key0..=Self::Key9).contains(&self).then(|| self as u8 - Self::Key0 as u8)
    }
}

/// What an input changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Sets the raw level of a signal from this cycle on.
    Level(Signal, bool),
    /// Moves the axis by hand by -10^6 to 10^6 steps, right positive; only while the motor is disabled (EN = 0).
    Push(i32),
}

impl Change {
    /// The signal's name, or `push_steps`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Level(signal, _) => signal.name(),
            Self::Push(_) => "push_steps",
        }
    }
}

/// A change in a cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    /// 1 to 9*10^15.
    pub cycle: Instant,
    /// What changes in it.
    pub change: Change,
}
