//! The one table of all registers. What follows from it: the constants that drivers use, the model's
//! decoding, and the tables of the data sheet.

use crate::table::registers;

registers! {
    /// Tells that this is the peripheral: the letters "STEP", the first in the highest byte.
    id: "ID" [0x000; 1], Ro, Is(0x5354_4550) => {
        /// Always the same.
        MAGIC [0..=31] {
            /// "STEP".
            MAGIC_STEP = 0x5354_4550,
        }
    }

    /// What the peripheral was built with.
    capabilities: "CAPABILITIES" [0x004; 1], Ro, Built => {
        /// Version of the register map.
        VERSION [0..=7] {
            /// This one.
            VERSION_1 = 1,
        }
        /// Channels, 1 to 16.
        CHANNELS [8..=12] {}
        /// Ticks that the queue holds, 1 to 255.
        QUEUE_DEPTH [16..=23] {}
        /// How many DIR lines there are.
        DIR_LINE [24..=24] {
            /// One a channel.
            DIR_LINE_PER_CHANNEL = 0,
            /// One, common to all channels.
            DIR_LINE_COMMON = 1,
        }
        /// What the serial line speaks.
        PROTOCOL [25..=25] {
            /// Raw packets.
            PROTOCOL_RAW = 0,
            /// Frames with a check, sequence numbers and replies.
            PROTOCOL_FRAMED = 1,
        }
    }

    /// The peripheral's clock. All times in this map are in its cycles.
    clock_hz: "CLOCK_HZ" [0x008; 1], Ro, Built => {
        /// Cycles per second.
        HZ [0..=31] {}
    }

    /// Length of the self-test after reset.
    boot: "BOOT" [0x00C; 1], Ro, Built => {
        /// Cycles; 0 if there is no self-test.
        CYCLES [0..=31] {}
    }

    /// Commands: a one gives the command of its bit. Where several are set only the highest is carried
    /// out, so STOP always is. RESULT tells the outcome. A write of 0 does nothing.
    control: "CONTROL" [0x010; 1], Wo, Is(0) => {
        /// Puts the timing registers in force. Refused with BUSY while a tick runs or waits, with
        /// BAD_TIMING if the timing does not fit; then nothing changes.
        COMMIT [0..=0] {}
        /// EN = 1; leaves STOPPED.
        ENABLE [1..=1] {}
        /// EN = 0, state STOPPED. Refused with BUSY while a tick runs or waits.
        DISABLE [2..=2] {}
        /// Emergency stop: EN = 0 and STEP = 0, the queue emptied, the running tick abandoned, state
        /// STOPPED.
        STOP [3..=3] {}
    }

    /// Outcome of the last command: of the last write to CONTROL (but a write of 0) or PUSH.
    result: "RESULT" [0x014; 1], Ro, Is(0) => {
        /// Why the command was refused, if it was. 2 to 5 are the reasons of the framed protocol.
        CODE [0..=7] {
            /// Done.
            CODE_DONE = 0,
            /// PUSH: no free place in the queue; sets the fault QUEUE_OVERFLOW.
            CODE_QUEUE_FULL = 2,
            /// PUSH: a channel has more steps than a tick has slots; sets the fault TOO_MANY_STEPS.
            CODE_TOO_MANY_STEPS = 3,
            /// PUSH: in the self-test. DISABLE and COMMIT: a tick runs or waits.
            CODE_BUSY = 4,
            /// PUSH: stopped; ENABLE comes first.
            CODE_STOPPED = 5,
            /// COMMIT: a value is out of its range, or the pulses do not fit.
            CODE_BAD_TIMING = 8,
        }
    }

    /// What the peripheral does. The low three bytes are those of a reply of the framed protocol.
    status: "STATUS" [0x018; 1], Ro, Built => {
        /// The state; of several that hold, the one named first in the order STOPPED, BUSY, MOVING,
        /// READY.
        STATE [0..=7] {
            /// In the self-test.
            STATE_BUSY = 0,
            /// Waits for ticks.
            STATE_READY = 1,
            /// A tick runs or waits.
            STATE_MOVING = 2,
            /// Stopped; ENABLE leaves this state.
            STATE_STOPPED = 3,
        }
        /// Free places in the queue.
        FREE [8..=15] {}
        /// Sequence number that the line's next TICKS frame must have; 0 on a raw line.
        EXPECTED_SEQ [16..=23] {}
        /// A tick runs or waits.
        MOVING [24..=24] {}
        /// The level of EN: 1 = windings powered.
        EN [25..=25] {}
        /// The timing registers differ from the timing in force: COMMIT is due.
        PENDING [26..=26] {}
    }

    /// Fault flags. They stay until a one is written to them, or a RESYNC comes on a framed line.
    faults: "FAULTS" [0x01C; 1], W1c, Is(0) => {
        /// A stop bit on the line was low.
        FRAMING [0..=0] {}
        /// A pause cut a raw packet short, or a run of bytes was no frame.
        SHORT_PACKET [1..=1] {}
        /// A frame's check failed.
        CRC [2..=2] {}
        /// A frame was too long.
        OVERLONG [3..=3] {}
        /// Ticks found no free place in the queue, from PUSH or from the line.
        QUEUE_OVERFLOW [4..=4] {}
        /// A tick ordered more steps than it has slots, from PUSH or from the line.
        TOO_MANY_STEPS [5..=5] {}
        /// A TICKS frame had a wrong sequence number.
        BAD_SEQ [6..=6] {}
        /// A tick with steps ended and none was there to follow; only where PROTOCOL is framed.
        UNDERRUN [7..=7] {}
        /// The supply current was too great for too long, and stopped the controller; only where it is measured.
        OVERLOAD [8..=8] {}
        /// The self-test found no settling time on some channel; only where it measures one.
        SELF_TEST [9..=9] {}
    }

    /// Ticks that have ended since reset. A tick that STOP abandoned is not counted.
    ticks_done: "TICKS_DONE" [0x020; 1], Ro, Is(0) => {
        /// Ticks, wrapping after 4 294 967 295.
        COUNT [0..=31] {}
    }

    /// M: slots in a tick, the most steps that a channel can make in one.
    slots: "SLOTS" [0x040; 1], Rw, Built => {
        /// 1 to 127.
        COUNT [0..=31] {}
    }

    /// Ts: length of a slot. A tick lasts M*Ts.
    step_period: "STEP_PERIOD" [0x044; 1], Rw, Built => {
        /// 2 to 1 000 000 000 cycles.
        CYCLES [0..=31] {}
    }

    /// W: how long STEP stays high.
    pulse_width: "PULSE_WIDTH" [0x048; 1], Rw, Built => {
        /// 1 to 1 000 000 000 cycles.
        CYCLES [0..=31] {}
    }

    /// D: from the start of a slot, where DIR may change, to the rise of STEP.
    dir_setup: "DIR_SETUP" [0x04C; 1], Rw, Built => {
        /// 0 to 1 000 000 000 cycles.
        CYCLES [0..=31] {}
    }

    /// H: how long DIR is held after STEP has fallen.
    dir_hold: "DIR_HOLD" [0x050; 1], Rw, Built => {
        /// 0 to 1 000 000 000 cycles.
        CYCLES [0..=31] {}
    }

    /// dp: settling time of the drivers' supply current after a step. Staggered pulses are at most so
    /// far apart.
    settle: "SETTLE" [0x054; 1], Rw, Built => {
        /// 0 to 1 000 000 000 cycles.
        CYCLES [0..=31] {}
    }

    /// Where the pulses of a tick come.
    mode: "MODE" [0x058; 1], Rw, Built => {
        /// Where in a tick a channel's steps go.
        DISTRIBUTION [0..=0] {
            /// Into the tick's first slots.
            DISTRIBUTION_BURST = 0,
            /// Evenly over the tick.
            DISTRIBUTION_SPREAD = 1,
        }
        /// When the pulses of one slot come.
        PULSES [1..=1] {
            /// All at once.
            PULSES_SIMULTANEOUS = 0,
            /// One channel after another.
            PULSES_STAGGERED = 1,
        }
    }

    /// Orders of the next tick, four channels each: ORDERS0 has channels 0 to 3 and so on. A byte is
    /// bit 7 the direction (1 = right) and bits 6..0 the steps. Bytes of channels that are not there
    /// read as 0. PUSH leaves the orders as they are.
    orders: "ORDERS" [0x060; 4], Rw, Is(0) => {
        /// Channel 4n of ORDERSn.
        FIRST [0..=7] {}
        /// Channel 4n + 1.
        SECOND [8..=15] {}
        /// Channel 4n + 2.
        THIRD [16..=23] {}
        /// Channel 4n + 3.
        FOURTH [24..=31] {}
    }

    /// A write queues a tick with the orders; the value does not matter. RESULT tells the outcome. It
    /// is judged in the order STOPPED, BUSY, TOO_MANY_STEPS, QUEUE_FULL.
    push: "PUSH" [0x070; 1], Wo, Is(0) => {}

    /// Position counters of channels 0 to 15: +1 for a rising STEP edge with DIR right, -1 with DIR
    /// left. Those of channels that are not there stay 0.
    position: "POSITION" [0x080; 16], Ro, Is(0) => {
        /// Steps, two's complement, wrapping.
        STEPS [0..=31] {}
    }
}
