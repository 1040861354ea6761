//! The driver bus, which peripheral owns (DESIGN A7).

use crate::schema::rows::{fields, words};
use crate::schema::{PATENT, SHEETS, label};
use stepscope_peripheral::config::{Bus, DirLine, Distribution, PulsePhasing, limits};

fields! {
    /// Rules for the times of a slot, with L = W + max(D + H, 1): simultaneous pulses need L <= Ts, with a common DIR line
    /// 2*L <= Ts. Staggered pulses need L <= floor(Ts/channels), with a common DIR line also dp >= L.
    Bus {
        /// Channels in use. A packet has one byte per channel.
        channels: u8 => label("Channels").whole(limits::CHANNELS)
            .term("Channel", "One motor driver with its STEP and DIR lines. All channels share EN.")
            .from(PATENT),
        /// M: maximum steps per channel and tick.
        slots: u8 => label("Slots per tick").whole(limits::SLOTS)
            .term("Slot", "A tick is divided into slots. A channel makes at most one step per slot.")
            .from(PATENT),
        /// Ts, length of a slot; a tick lasts M*Ts.
        step_period_cycles: u32 => label("Slot").unit("cycles").whole(limits::STEP_PERIOD_CYCLES)
            .term("Length of a slot", "Step period T_s. A channel makes at most one step per slot.")
            .from(PATENT),
        /// W: how long STEP is high.
        pulse_width_cycles: u32 => label("STEP high").unit("cycles").whole(limits::PULSE_WIDTH_CYCLES)
            .term("STEP high", "Width of a step pulse. A driver can miss pulses that are shorter than its data sheet requires.")
            .from(SHEETS),
        /// D: from the start of the slot, where DIR changes, to the rise of STEP.
        dir_setup_cycles: u32 => label("DIR set-up").unit("cycles").whole(limits::DIR_SETUP_CYCLES)
            .term("DIR set-up", "DIR must be stable for this time before STEP rises. Otherwise the driver may step in the old direction.")
            .from(SHEETS),
        /// H: from the fall of STEP to the change of DIR. Data sheets count from the rise: pulse width + this time.
        dir_hold_cycles: u32 => label("DIR hold after STEP falls").unit("cycles")
            .whole(limits::DIR_HOLD_CYCLES)
            .term("DIR hold", "DIR must be stable for this time after STEP falls. Data sheets count from the rise: pulse width + this time.")
            .from(SHEETS),
        /// Position of the steps in a tick.
        distribution: Distribution => label("Steps in a tick")
            .term("Burst and spread", "Burst: the steps use the first slots of the tick, then there is a pause (RU 2704486). Spread: they are spaced evenly over the tick, so the speed is smoother.")
            .from(PATENT),
        /// Number of DIR lines.
        dir_line: DirLine => label("DIR lines")
            .term("DIR lines", "One DIR line for all motors saves wires. In each slot DIR goes low and motors step left, then DIR goes high and motors step right. This takes at least five cycles.")
            .from(PATENT),
        /// Timing of the pulses of a slot.
        pulse_phasing: PulsePhasing => label("Pulses in a slot")
            .term("Pulses in a slot", "Motors that step at the same time draw their current peaks at the same time. Staggered pulses reduce the peaks of the supply current to a half or a third.")
            .from(PATENT),
        /// dp: settling time of the supply current after a step. Staggered pulses are min(dp, floor(Ts/stepping channels))
        /// apart.
        settle_cycles: u32 => label("Settling time").unit("cycles").whole(limits::SETTLE_CYCLES)
            .term("Settling time (dp)", "Time that the supply current needs to settle after a step, Δt_p in RU 2704486. Staggered pulses are this far apart, or closer if the slot is too short.")
            .from(PATENT).when("pulse_phasing", "staggered"),
        /// Capacity of the queue.
        queue_depth: u8 => label("Queue").unit("ticks").whole(limits::QUEUE_DEPTH)
            .term("Queue", "Ticks that wait in the controller, so motion continues while the host is busy. An empty queue during a motion is an underrun.")
            .from(PATENT),
        /// Self-test after reset. Packets that end during it are dropped; framed ticks get the reply BUSY.
        self_test_cycles: u32 => label("Self-test").unit("cycles")
            .term("Self-test", "After reset the controller tests itself and drops everything it receives.")
            .from(PATENT),
    }
}

words! {
    Distribution {
        Burst = "burst", "burst at the start": "the first slots of the tick (RU 2704486)";
        Spread = "spread", "spread evenly": "evenly over the tick";
    }
    DirLine {
        PerChannel = "per_channel", "one per channel": "one per channel, changed at the start of a tick";
        Common = "common", "one for all": "one for all, changed in each slot with a step";
    }
    PulsePhasing {
        Simultaneous = "simultaneous", "all at once": "all at once";
        Staggered = "staggered", "staggered": "one channel after another, so that current peaks do not coincide";
    }
}
