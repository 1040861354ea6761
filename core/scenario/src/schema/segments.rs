//! Lists of segments that the peripheral runs by itself (DESIGN A8).
//!
//! `_q16` counts 1/65536 cycle (48.16 fixed point), `_cycles` whole ones.

use crate::schema::{
    OWN, SONOBE, label,
    rows::{choices, settings},
};
use alloc::vec::Vec;
use stepscope_peripheral::segment::LAST_CYCLE;

settings! {
    /// Nothing is sent: the peripheral runs list i on channel i. `_q16` is in 1/65536 cycle.
    ///
    /// Times are added in 48.16 fixed point and never rounded; STEP rises in the whole cycle. DIR changes when its
    /// segment begins, but not before the last pulse has been over for `bus.dir_hold_cycles`. Every interval that a step
    /// uses is at least W + max(H + D, 1) cycles (`bus.pulse_width_cycles`, `bus.dir_hold_cycles`,
    /// `bus.dir_setup_cycles`), and the time of a list stays below 2^48 cycles.
    ///
    /// Where segments run a scenario, only `channels` and those three times of `bus` count and nothing of `line`: the
    /// rules that join the others do not apply. EN, RX and TX are 1 and DE is 0 throughout.
    pub struct SegmentLists {
        /// A list for each channel.
        pub channels: Vec<ChannelSegments> = Vec::new() => label("Lists")
            .follows("up to 16, no more than `bus.channels`"),
    }
}

settings! {
    /// The segments of one channel, one after another.
    pub struct ChannelSegments {
        /// Cycle in which the list's time begins.
        pub start_cycle: u64 = 1 => label("Start")
            .unit("cycles")
            .whole(1..=LAST_CYCLE.0)
            .term("Start", "Cycle of the controller's clock, counted from reset, in which this begins."),
        /// Count, interval, growth of the interval, direction: `20 1048576000 -500 right`; or `dwell 65536000`. Times in
        /// 1/65536 cycle.
        pub segments: Vec<Segment> = Vec::new() => label("Segments, one a line")
            .follows("up to 1 000 000 on all channels")
            .term("Segment", "So many steps at intervals that grow by a constant. An acceleration table with one reload a step is a list of segments of one step.")
            .from(SONOBE),
    }
}

choices! {
    /// One segment.
    pub enum Segment {
        /// Steps at intervals that grow by a constant.
        Steps(StepSegment) = "steps" => label("Steps").from(OWN),
        /// Standing still.
        Dwell(DwellSegment) = "dwell" => label("Dwell").from(OWN),
    }
}

settings! {
    /// Steps at intervals that grow by a constant.
    pub struct StepSegment {
        /// How many, from 1.
        pub count: u32 = 1 => label("Count").follows("1 to 2^32 - 1"),
        /// Time before the first of them; 16000 cycles by default.
        pub interval_q16: u64 = 16_000 << 16 => label("Interval").unit("1/65536 cycle"),
        /// What each next interval is longer.
        pub add_q16: i64 = 0 => label("Growth").unit("1/65536 cycle"),
        /// Level of DIR: 1 right, 0 left.
        pub dir: u8 = 1 => label("DIR").whole(0..=1),
    }
}

settings! {
    /// Standing still.
    pub struct DwellSegment {
        /// How long.
        pub length_q16: u64 = 0 => label("Length").unit("1/65536 cycle"),
    }
}
