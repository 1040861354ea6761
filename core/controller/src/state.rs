//! States and alarms, with their numbers on the panel (CONTROLLER G2).

macro_rules! numbered {
    ($(#[$meta:meta])* $name:ident { $($(#[$item_meta:meta])* $item:ident = $text:literal,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum $name {
            $($(#[$item_meta])* $item,)*
        }

        impl $name {
            pub const ALL: [Self; [$(stringify!($item)),*].len()] = [$(Self::$item),*];

            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$item => $text,)*
                }
            }
        }
    };
}

numbered! {
    /// What a controller is doing; the discriminant is its number on the panel.
    State {
        /// 0: no power.
        Off = "OFF",
        /// 1: self-test and reading memory.
        SelfTest = "SELF_TEST",
        /// 2: waiting for a button.
        Ready = "READY",
        /// 3: a program moves, or is between two groups.
        Running = "RUNNING",
        /// 4: a program is in a delay.
        Delay = "DELAY",
        /// 5: a program waits for a level.
        Wait = "WAIT",
        /// 6: a program's move or a return brakes for a pause.
        Pausing = "PAUSING",
        Paused = "PAUSED",
        Jog = "JOG",
        /// 9: the return to zero.
        Returning = "RETURNING",
        Homing = "HOMING",
        /// 11: fine jogs and manual zero.
        Debug = "DEBUG",
        /// 12: numbers are edited.
        Edit = "EDIT",
        Alarm = "ALARM",
        /// 14: power failure, in the hold-up time.
        PowerLoss = "POWER_LOSS",
    }
}

numbered! {
    /// Why a controller is in [`State::Alarm`]; the discriminant is its number on the panel.
    Alarm {
        None = "",
        /// 1: the emergency stop.
        Estop = "ESTOP",
        Limit = "LIMIT",
        /// 3: a move beyond the soft limits.
        SoftLimit = "SOFT_LIMIT",
        /// 4: homing failed.
        Homing = "HOMING",
        /// 5: the position is not trusted enough.
        Trust = "TRUST",
        /// 6: the timeout of a wait.
        Timeout = "TIMEOUT",
        /// 7: the memory holds no valid record.
        Memory = "MEMORY",
    }
}

/// Name of a trust level: 0 LOST, 1 HELD, 2 SURE; empty for any other.
#[must_use]
pub const fn trust_name(trust: u8) -> &'static str {
    match trust {
        0 => "LOST",
        1 => "HELD",
        2 => "SURE",
        _ => "",
    }
}

impl State {
    pub(crate) const fn rests(self) -> bool {
        matches!(self, Self::Ready | Self::Debug | Self::Edit | Self::Paused | Self::Alarm)
    }
}
