//! States and alarms (G2), with their numbers on the panel.

/// Declares an enum whose discriminants count from 0.
macro_rules! numbered {
    ($(#[$meta:meta])* $name:ident { $($(#[$item_meta:meta])* $item:ident = $text:literal,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u8)]
        pub enum $name {
            $($(#[$item_meta])* $item,)*
        }

        impl $name {
            /// All of them; `ALL[i]` is the one whose number is i.
            pub const ALL: [Self; [$(stringify!($item)),*].len()] = [$(Self::$item),*];

            /// Its name, as CONTROLLER.md has it.
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
        /// 0: without power.
        Off = "OFF",
        /// 1: testing itself and reading its memory.
        SelfTest = "SELF_TEST",
        /// 2: waiting for a button.
        Ready = "READY",
        /// 3: a program moves, or is between two groups.
        Running = "RUNNING",
        /// 4: a program waits out a delay.
        Delay = "DELAY",
        /// 5: a program waits for a level.
        Wait = "WAIT",
        /// 6: a program's move or a return brakes for a pause.
        Pausing = "PAUSING",
        /// 7: a program or a return stands.
        Paused = "PAUSED",
        /// 8: a jog.
        Jog = "JOG",
        /// 9: the return to zero.
        Returning = "RETURNING",
        /// 10: homing.
        Homing = "HOMING",
        /// 11: fine jogs, and zero by hand.
        Debug = "DEBUG",
        /// 12: numbers are changed.
        Edit = "EDIT",
        /// 13: an alarm.
        Alarm = "ALARM",
        /// 14: the power fell, and the supply holds up.
        PowerLoss = "POWER_LOSS",
    }
}

numbered! {
    /// Why a controller is in [`State::Alarm`]; the discriminant is its number on the panel.
    Alarm {
        /// 0: no alarm.
        None = "",
        /// 1: the emergency stop.
        Estop = "ESTOP",
        /// 2: a limit switch.
        Limit = "LIMIT",
        /// 3: an order beyond the soft limits.
        SoftLimit = "SOFT_LIMIT",
        /// 4: homing did not find what it looked for.
        Homing = "HOMING",
        /// 5: the position is not trusted enough.
        Trust = "TRUST",
        /// 6: a wait took too long.
        Timeout = "TIMEOUT",
        /// 7: the memory holds no valid record.
        Memory = "MEMORY",
    }
}

/// Name of a degree of trust: 0 LOST, 1 HELD, 2 SURE; empty for any other.
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
