//! States and alarms, with their numbers on the panel (CONTROLLER G2).

crate::named::named_enum! { (Hash)
    /// What a controller is doing; the discriminant is its number on the panel.
    pub enum State {
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
        /// 7: a move, delay or wait is paused.
        Paused = "PAUSED",
        /// 8: a jog button is held, or the jog brakes.
        Jog = "JOG",
        /// 9: the return to zero.
        Returning = "RETURNING",
        /// 10: homing.
        Homing = "HOMING",
        /// 11: fine jogs and manual zero.
        Debug = "DEBUG",
        /// 12: numbers are edited.
        Edit = "EDIT",
        /// 13: an error stopped the controller; see [`Alarm`].
        Alarm = "ALARM",
        /// 14: power failure, in the hold-up time.
        PowerLoss = "POWER_LOSS",
    }
}

crate::named::named_enum! { (Hash)
    /// Why a controller is in [`State::Alarm`]; the discriminant is its number on the panel.
    pub enum Alarm {
        /// 0: no alarm.
        None = "",
        /// 1: the emergency stop.
        Estop = "ESTOP",
        /// 2: a limit switch.
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

/// How far a controller trusts its position.
pub(crate) mod trust {
    pub(crate) const LOST: u8 = 0;
    /// The position was restored from memory.
    pub(crate) const HELD: u8 = 1;
    /// Zero was set after power-up.
    pub(crate) const SURE: u8 = 2;
}

/// Name of a trust level: 0 LOST, 1 HELD, 2 SURE; empty for any other.
pub const fn trust_name(trust: u8) -> &'static str {
    match trust {
        trust::LOST => "LOST",
        trust::HELD => "HELD",
        trust::SURE => "SURE",
        _ => "",
    }
}

impl State {
    /// Whether nothing moves, waits or delays.
    pub(crate) const fn is_idle(self) -> bool {
        matches!(self, Self::Ready | Self::Debug | Self::Edit | Self::Paused | Self::Alarm)
    }
}
