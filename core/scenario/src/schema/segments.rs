//! Lists of segments that the peripheral runs without a host (DESIGN A8).
//!
//! `_q16` counts 1/65536 cycle (48.16 fixed point), `_cycles` whole ones.

use crate::schema::rows::{choices, settings};
use crate::schema::{Direction, OWN, SONOBE, label};
use alloc::vec::Vec;
use stepscope_peripheral::segment::LAST_CYCLE;

settings! {
    /// Nothing is sent: the peripheral runs list i on channel i. `_q16` is in 1/65536 cycle.
    ///
    /// Times are added in 48.16 fixed point without rounding; STEP rises in the whole cycle. DIR changes at the start of
    /// its segment, but at least `bus.dir_hold_cycles` after the last pulse. Every interval is at least W + max(H + D, 1)
    /// cycles (`bus.pulse_width_cycles`, `bus.dir_hold_cycles`, `bus.dir_setup_cycles`). A list lasts less than 2^48
    /// cycles.
    ///
    /// Only `bus.channels` and these three times apply; `line` is ignored. EN, RX and TX are 1 and DE is 0.
    pub struct SegmentLists {
        /// One list per channel.
        pub channels: Vec<ChannelSegments> = Vec::new() => label("Lists")
            .range_text("up to 16, no more than `bus.channels`"),
    }
}

settings! {
    /// The segments of one channel, in order.
    pub struct ChannelSegments {
        /// First cycle of the list.
        pub start_cycle: u64 = 1 => label("Start").unit("cycles").whole(1..=LAST_CYCLE.0)
            .term("Start", "First cycle, counted from reset."),
        /// Count, interval, change of the interval, direction: `20 1048576000 -500 right`; or `dwell 65536000`. Times are in
        /// 1/65536 cycle.
        pub segments: Vec<Segment> = Vec::new() => label("One segment per line")
            .range_text("up to 1 000 000 on all channels")
            .term("Segment", "A number of steps whose intervals change by a constant. An acceleration table with one reload per step is a list of segments of one step.")
            .from(SONOBE),
    }
}

choices! {
    /// One segment.
    pub enum Segment {
        /// Steps whose intervals change by a constant.
        Steps(StepSegment) = "steps" => label("Steps").from(OWN),
        /// A pause.
        Dwell(DwellSegment) = "dwell" => label("Dwell").from(OWN),
    }
}

settings! {
    /// Steps whose intervals change by a constant.
    pub struct StepSegment {
        /// Number of steps, from 1.
        pub count: u32 = 1 => label("Count").range_text("1 to 2^32 - 1"),
        /// Time before the first step; 16000 cycles by default.
        pub interval_q16: u64 = 16_000 << 16 => label("Interval").unit("1/65536 cycle"),
        /// Change of each following interval.
        pub add_q16: i64 = 0 => label("Change").unit("1/65536 cycle"),
        /// Level of DIR.
        pub direction: Direction = Direction::Positive => label("Direction"),
    }
}

settings! {
    /// A pause.
    pub struct DwellSegment {
        /// Length of the pause.
        pub length_q16: u64 = 0 => label("Length").unit("1/65536 cycle"),
    }
}
