//! The table of all registers. Constants for drivers, the model's decoding and the data sheet follow from it.

use crate::table::registers;

registers! {
    /// Identifies the peripheral: the letters "STEP", the first in the highest byte.
    id: "ID" [0x000; 1], Ro, Fixed(0x5354_4550) => {
        /// Constant.
        MAGIC [0..=31] {
            /// "STEP".
            MAGIC_STEP = 0x5354_4550,
        }
    }

    /// Properties of this peripheral.
    capabilities: "CAPABILITIES" [0x004; 1], Ro, Configured => {
        /// Version of the register map.
        VERSION [0..=7] {
            /// The version described here.
            VERSION_1 = 1,
        }
        /// Channels, 1 to 16.
        CHANNELS [8..=12] {}
        /// Ticks that the queue holds, 1 to 255.
        QUEUE_DEPTH [16..=23] {}
        /// Number of DIR lines.
        DIR_LINE [24..=24] {
            /// One per channel.
            DIR_LINE_PER_CHANNEL = 0,
            /// One for all channels.
            DIR_LINE_COMMON = 1,
        }
        /// Protocol of the serial line.
        PROTOCOL [25..=25] {
            /// Raw packets.
            PROTOCOL_RAW = 0,
            /// Frames with a CRC, sequence numbers and replies.
            PROTOCOL_FRAMED = 1,
        }
    }

    /// The peripheral's clock. All times in this map are in its cycles.
    clock_hz: "CLOCK_HZ" [0x008; 1], Ro, Configured => {
        /// Cycles per second.
        HZ [0..=31] {}
    }

    /// Length of the self-test after reset.
    boot: "BOOT" [0x00C; 1], Ro, Configured => {
        /// Cycles; 0 if there is no self-test.
        CYCLES [0..=31] {}
    }

    /// Commands, one per bit. If several bits are set, only the command of the highest is executed, so STOP
    /// always has priority. RESULT reports the outcome. Writing 0 has no effect.
    control: "CONTROL" [0x010; 1], Wo, Fixed(0) => {
        /// Applies the timing registers. Refused with BUSY while a tick runs or waits, and with BAD_TIMING if
        /// the timing is invalid; a refused command changes nothing.
        COMMIT [0..=0] {}
        /// EN = 1; leaves STOPPED.
        ENABLE [1..=1] {}
        /// EN = 0, state STOPPED. Refused with BUSY while a tick runs or waits.
        DISABLE [2..=2] {}
        /// Emergency stop: EN = 0, STEP = 0, queue cleared, current tick aborted, state STOPPED.
        STOP [3..=3] {}
    }

    /// Outcome of the last command: the last write to CONTROL (except of 0) or PUSH.
    result: "RESULT" [0x014; 1], Ro, Fixed(0) => {
        /// Why the command was refused. 2 to 5 are the reasons of the framed protocol.
        CODE [0..=7] {
            /// Done.
            CODE_DONE = 0,
            /// PUSH: no free place in the queue; sets the fault QUEUE_OVERFLOW.
            CODE_QUEUE_FULL = 2,
            /// PUSH: a channel has more steps than a tick has slots; sets the fault TOO_MANY_STEPS.
            CODE_TOO_MANY_STEPS = 3,
            /// PUSH: during the self-test. DISABLE and COMMIT: a tick runs or waits.
            CODE_BUSY = 4,
            /// PUSH: stopped; use ENABLE first.
            CODE_STOPPED = 5,
            /// COMMIT: a value is out of its range, or the pulses do not fit.
            CODE_BAD_TIMING = 8,
        }
    }

    /// State of the peripheral. The low three bytes are those of a reply of the framed protocol.
    status: "STATUS" [0x018; 1], Ro, Configured => {
        /// The state; if several apply, the first in the order STOPPED, BUSY, MOVING, READY.
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
        /// The timing registers differ from the timing in use: COMMIT is needed.
        PENDING [26..=26] {}
    }

    /// Fault flags. They stay set until a one is written to them, or a RESYNC arrives on a framed line.
    faults: "FAULTS" [0x01C; 1], W1c, Fixed(0) => {
        /// A stop bit on the line was low.
        FRAMING [0..=0] {}
        /// A pause cut a raw packet short, or a sequence of bytes was no frame.
        SHORT_PACKET [1..=1] {}
        /// The CRC of a frame was wrong.
        CRC [2..=2] {}
        /// A frame was too long.
        OVERLONG [3..=3] {}
        /// Ticks from PUSH or the line found no free place in the queue.
        QUEUE_OVERFLOW [4..=4] {}
        /// A tick from PUSH or the line requested more steps than it has slots.
        TOO_MANY_STEPS [5..=5] {}
        /// A TICKS frame had a wrong sequence number.
        BAD_SEQ [6..=6] {}
        /// A tick with steps ended and none followed; only if PROTOCOL is framed.
        UNDERRUN [7..=7] {}
        /// The supply current was too high for too long, and the controller stopped; only if it is measured.
        OVERLOAD [8..=8] {}
        /// The self-test found no settling time on some channel; only if it measures one.
        SELF_TEST [9..=9] {}
    }

    /// Ticks that have ended since reset, without those aborted by STOP.
    ticks_done: "TICKS_DONE" [0x020; 1], Ro, Fixed(0) => {
        /// Ticks, wrapping after 4 294 967 295.
        COUNT [0..=31] {}
    }

    /// M: slots per tick, the maximum steps of a channel in one tick.
    slots: "SLOTS" [0x040; 1], Rw, Configured => {
        /// 1 to 127.
        COUNT [0..=31] {}
    }

    /// Ts: length of a slot. A tick lasts M*Ts.
    step_period: "STEP_PERIOD" [0x044; 1], Rw, Configured => {
        /// 2 to 1 000 000 000 cycles.
        CYCLES [0..=31] {}
    }

    /// W: time that STEP stays high.
    pulse_width: "PULSE_WIDTH" [0x048; 1], Rw, Configured => {
        /// 1 to 1 000 000 000 cycles.
        CYCLES [0..=31] {}
    }

    /// D: time from the start of a slot, where DIR may change, to the rise of STEP.
    dir_setup: "DIR_SETUP" [0x04C; 1], Rw, Configured => {
        /// 0 to 1 000 000 000 cycles.
        CYCLES [0..=31] {}
    }

    /// H: time that DIR is held after STEP has fallen.
    dir_hold: "DIR_HOLD" [0x050; 1], Rw, Configured => {
        /// 0 to 1 000 000 000 cycles.
        CYCLES [0..=31] {}
    }

    /// dp: settling time of the drivers' supply current after a step, the maximum distance of staggered pulses.
    settle: "SETTLE" [0x054; 1], Rw, Configured => {
        /// 0 to 1 000 000 000 cycles.
        CYCLES [0..=31] {}
    }

    /// Times of the pulses in a tick.
    mode: "MODE" [0x058; 1], Rw, Configured => {
        /// Where the steps of a channel go within a tick.
        DISTRIBUTION [0..=0] {
            /// Into the tick's first slots.
            DISTRIBUTION_BURST = 0,
            /// Evenly over the tick.
            DISTRIBUTION_SPREAD = 1,
        }
        /// When the pulses of one slot rise.
        PULSES [1..=1] {
            /// All at once.
            PULSES_SIMULTANEOUS = 0,
            /// One channel after another.
            PULSES_STAGGERED = 1,
        }
    }

    /// Commands of the next tick, four channels each: ORDERS0 has channels 0 to 3 and so on. A byte has the
    /// direction in bit 7 (1 = right) and the steps in bits 6..0. Bytes of unused channels read as 0. PUSH keeps the commands.
    orders: "ORDERS" [0x060; 4], Rw, Fixed(0) => {
        /// Channel 4n of ORDERSn.
        FIRST [0..=7] {}
        /// Channel 4n + 1.
        SECOND [8..=15] {}
        /// Channel 4n + 2.
        THIRD [16..=23] {}
        /// Channel 4n + 3.
        FOURTH [24..=31] {}
    }

    /// Writing any value queues a tick with the commands. RESULT reports the outcome, checked in the order STOPPED,
    /// BUSY, TOO_MANY_STEPS, QUEUE_FULL.
    push: "PUSH" [0x070; 1], Wo, Fixed(0) => {}

    /// Position counters of channels 0 to 15: +1 per rising STEP edge with DIR right, -1 with DIR left. Those of
    /// unused channels stay 0.
    position: "POSITION" [0x080; 16], Ro, Fixed(0) => {
        /// Steps, two's complement, wrapping.
        STEPS [0..=31] {}
    }
}
