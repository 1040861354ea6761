//! What comes into a controller: buttons, keys, switches, power, and a hand on the axis (CONTROLLER.md, "The format").
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

/// Declares the signals with their names in a scenario.
macro_rules! signals {
    ($($(#[$meta:meta])* $name:ident = $text:literal,)*) => {
        /// A signal that comes into a controller.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        pub enum Signal {
            $($(#[$meta])* $name,)*
        }

        impl Signal {
            /// All of them; `ALL[i]` is the one whose number is i.
            pub const ALL: [Self; [$($text),*].len()] = [$(Self::$name),*];

            /// Its name in a scenario.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)*
                }
            }
        }
    };
}

// Buttons and keys stand in the order in which a cycle hears them (G1.4).
signals! {
    /// The supply; 1 before its first entry.
    Power = "power",
    /// The emergency stop, 1 while it is pressed.
    Estop = "estop",
    /// Button.
    Clear = "clear",
    /// Button.
    Start = "start",
    /// Button.
    Pause = "pause",
    /// Button, held: jog to the right.
    JogPlus = "jog_plus",
    /// Button, held: jog to the left.
    JogMinus = "jog_minus",
    /// Button.
    Zero = "zero",
    /// Button.
    Home = "home",
    /// Button.
    Debug = "debug",
    /// Button.
    System = "system",
    /// Button.
    Ok = "ok",
    /// Button.
    Back = "back",
    /// Key.
    Key0 = "key_0",
    /// Key.
    Key1 = "key_1",
    /// Key.
    Key2 = "key_2",
    /// Key.
    Key3 = "key_3",
    /// Key.
    Key4 = "key_4",
    /// Key.
    Key5 = "key_5",
    /// Key.
    Key6 = "key_6",
    /// Key.
    Key7 = "key_7",
    /// Key.
    Key8 = "key_8",
    /// Key.
    Key9 = "key_9",
    /// Switch at the left end of the axis.
    LimitMin = "limit_min",
    /// Switch at the right end of the axis.
    LimitMax = "limit_max",
    /// Switch that homing looks for.
    HomeSwitch = "home_switch",
    /// Sensor.
    In0 = "in_0",
    /// Sensor.
    In1 = "in_1",
    /// Sensor.
    In2 = "in_2",
    /// Sensor.
    In3 = "in_3",
}

/// How many signals there are.
pub const SIGNALS: usize = Signal::ALL.len();

impl Signal {
    /// The signal of this name.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|signal| signal.name() == name)
    }

    /// Whether it is a button or a key: its presses mean something.
    #[must_use]
    pub fn is_button(self) -> bool {
        (Self::Clear..=Self::Key9).contains(&self)
    }

    /// Whether it is a limit, the home switch or `in_0` to `in_3`: `sensor_debounce_cycles` is its own.
    #[must_use]
    pub fn is_sensor(self) -> bool {
        self >= Self::LimitMin
    }

    /// Whether it is a limit or the home switch, which an axis may drive.
    #[must_use]
    pub const fn is_switch(self) -> bool {
        matches!(self, Self::LimitMin | Self::LimitMax | Self::HomeSwitch)
    }

    /// The digit of a key.
    #[must_use]
    pub fn digit(self) -> Option<u8> {
        (Self::Key0..=Self::Key9).contains(&self).then(|| self as u8 - Self::Key0 as u8)
    }
}

/// What an entry of the script does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// The raw level of a signal from this cycle on.
    Level(Signal, bool),
    /// A hand pushes the axis so many steps, -10^6 to 10^6, right is positive; of effect while EN = 0.
    Push(i32),
}

impl Change {
    /// Its name in a scenario.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Level(signal, _) => signal.name(),
            Self::Push(_) => "push_steps",
        }
    }
}

/// An entry of the script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Input {
    /// Its cycle, 1 to 9*10^15.
    pub cycle: Instant,
    /// What it does.
    pub change: Change,
}
