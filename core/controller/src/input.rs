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

use stepscope_peripheral::units::Instant;

macro_rules! signals {
    ($($(#[$meta:meta])* $name:ident = $text:literal,)*) => {
        /// An input signal of a controller.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        pub enum Signal {
            $($(#[$meta])* $name,)*
        }

        impl Signal {
            pub const ALL: [Self; [$($text),*].len()] = [$(Self::$name),*];

            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)*
                }
            }
        }
    };
}

// Buttons and keys are in the order in which a cycle handles them (G1.4).
signals! {
    /// The supply; initially 1.
    Power = "power",
    /// The emergency stop, 1 while it is pressed.
    Estop = "estop",
    Clear = "clear",
    Start = "start",
    Pause = "pause",
    /// Jog to the right while it is held.
    JogPlus = "jog_plus",
    /// Jog to the left while it is held.
    JogMinus = "jog_minus",
    Zero = "zero",
    Home = "home",
    Debug = "debug",
    System = "system",
    Ok = "ok",
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
    HomeSwitch = "home_switch",
    In0 = "in_0",
    In1 = "in_1",
    In2 = "in_2",
    In3 = "in_3",
}

pub const SIGNALS: usize = Signal::ALL.len();

impl Signal {
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|signal| signal.name() == name)
    }

    /// Whether it is a button or a key.
    #[must_use]
    pub fn is_button(self) -> bool {
        (Self::Clear..=Self::Key9).contains(&self)
    }

    /// Whether `sensor_debounce_cycles` applies: limits, home switch, and `in_0` to `in_3`.
    #[must_use]
    pub fn is_sensor(self) -> bool {
        self >= Self::LimitMin
    }

    /// Whether it is a limit or the home switch, which an axis can drive.
    #[must_use]
    pub const fn is_switch(self) -> bool {
        matches!(self, Self::LimitMin | Self::LimitMax | Self::HomeSwitch)
    }

    #[must_use]
    pub fn digit(self) -> Option<u8> {
        (Self::Key0..=Self::Key9).contains(&self).then(|| self as u8 - Self::Key0 as u8)
    }
}

/// Effect of an entry of the script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// The raw level of a signal from this cycle on.
    Level(Signal, bool),
    /// Pushes the axis by -10^6 to 10^6 steps, right is positive; has an effect only while EN = 0.
    Push(i32),
}

impl Change {
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Level(signal, _) => signal.name(),
            Self::Push(_) => "push_steps",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    /// 1 to 9*10^15.
    pub cycle: Instant,
    pub change: Change,
}
