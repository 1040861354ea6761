//! The driver bus, which peripheral owns (DESIGN A7).

use crate::schema::{
    PATENT, SHEETS, label,
    rows::{fields, words},
};
use stepscope_peripheral::config::{Bus, DirLine, Distribution, PulsePhasing, limits};

fields! {
    /// The rules that join the times of a slot, with L = W + max(D + H, 1): simultaneous pulses need L <= Ts, on a
    /// common DIR line 2*L <= Ts; staggered ones L <= floor(Ts/channels), on a common DIR line also dp >= L.
    Bus {
        /// Channels in use; a packet has one byte for each.
        channels: u8 => label("Channels")
            .whole(limits::CHANNELS)
            .term("Channel", "One motor's driver with its STEP and DIR lines. EN is one line for all of them.")
            .from(PATENT),
        /// M: the most steps that a channel makes in one tick.
        slots: u8 => label("Slots in a tick")
            .whole(limits::SLOTS)
            .term("Slot", "A tick is divided into slots. A channel makes at most one step in each, so the number of slots limits the steps of a tick.")
            .from(PATENT),
        /// Ts, length of a slot; a tick lasts M*Ts.
        step_period_cycles: u32 => label("Slot")
            .unit("cycles")
            .whole(limits::STEP_PERIOD_CYCLES)
            .term("Length of a slot", "Step period T_s: no channel steps faster than once in it.")
            .from(PATENT),
        /// W, how long STEP is high.
        pulse_width_cycles: u32 => label("STEP high")
            .unit("cycles")
            .whole(limits::PULSE_WIDTH_CYCLES)
            .term("STEP high", "How long a step pulse lasts. A driver overlooks pulses shorter than its data sheet asks for.")
            .from(SHEETS),
        /// D, from the slot's start to the rise of STEP; DIR has changed by then.
        dir_setup_cycles: u32 => label("DIR set-up")
            .unit("cycles")
            .whole(limits::DIR_SETUP_CYCLES)
            .term("DIR set-up", "DIR has to stand for some time before STEP rises, or the driver may step the old way.")
            .from(SHEETS),
        /// H, from the fall of STEP to DIR's change.
        dir_hold_cycles: u32 => label("DIR hold")
            .unit("cycles")
            .whole(limits::DIR_HOLD_CYCLES)
            .term("DIR hold", "DIR has to stand for some time after a step, too.")
            .from(SHEETS),
        /// Where in a tick the steps go.
        distribution: Distribution => label("Steps in a tick")
            .term("Burst and spread", "Burst: the steps of a tick are made in its first slots, then there is a pause, as in the patent. Spread: they are spaced evenly over the tick, which the motor feels as a smoother speed.")
            .from(PATENT),
        /// How many DIR lines the controller has.
        dir_line: DirLine => label("DIR lines")
            .term("DIR lines", "One DIR line for all motors saves wires: within each slot DIR goes low, the ones to the left step, DIR goes high, the others step. Five cycles are enough.")
            .from(PATENT),
        /// When the pulses of a slot come.
        pulse_phasing: PulsePhasing => label("Pulses of a slot")
            .term("Pulses of a slot", "Motors that step in the same instant all draw their peak of current at once. One after another the supply's peaks fall to a half or a third.")
            .from(PATENT),
        /// dp, settling time of the drivers' supply current after a step: staggered pulses are min(dp, floor(Ts/firing
        /// channels)) apart.
        settle_cycles: u32 => label("Current settles")
            .unit("cycles")
            .whole(limits::SETTLE_CYCLES)
            .term("Current settles (dp)", "The patent's Δt_p: time that the supply current needs to settle after a step. Staggered pulses are this far apart, or as far as the slot has room for.")
            .from(PATENT)
            .when("pulse_phasing", "staggered"),
        /// Ticks that the queue holds.
        queue_depth: u8 => label("Queue")
            .unit("ticks")
            .whole(limits::QUEUE_DEPTH)
            .term("Queue", "Ticks that wait in the controller, so that motion goes on while the host is busy. When it is empty in the middle of a motion, that is an underrun.")
            .from(PATENT),
        /// Self-test after reset; packets that end in it are dropped, framed ticks answered with BUSY.
        boot_cycles: u32 => label("Self-test")
            .unit("cycles")
            .term("Self-test", "After reset the controller checks itself and is busy; what is sent meanwhile is dropped.")
            .from(PATENT),
    }
}

words! {
    Distribution {
        /// the first slots of the tick, as in RU 2704486
        Burst = "burst", "burst at its start";
        /// evenly over it
        Spread = "spread", "spread evenly";
    }
    DirLine {
        /// one a channel, changed when a tick starts
        PerChannel = "per_channel", "one a channel";
        /// one for all, changed within each slot that has a step
        Common = "common", "one for all";
    }
    PulsePhasing {
        /// all at once
        Simultaneous = "simultaneous", "all at once";
        /// one channel after another, so that the drivers' current peaks do not meet
        Staggered = "staggered", "one after another";
    }
}
