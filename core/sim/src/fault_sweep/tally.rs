//! What the runs of a fault sweep came to, in numbers that add up.

use crate::fault_sweep::align::Alignment;
use crate::framed_host::{Counts, GivenUp};
use core::ops::AddAssign;

macro_rules! tally {
    ($($(#[doc = $doc:literal])+ $field:ident,)+) => {
        /// Counts over the runs of some seeds.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct Tally {
            $($(#[doc = $doc])+ pub $field: u64,)+
        }

        impl AddAssign for Tally {
            fn add_assign(&mut self, other: Self) {
                $(self.$field += other.$field;)+
            }
        }
    };
}

tally! {
    /// Seeds that were run.
    seeds,
    /// Seeds whose run did something that was not ordered, or left out what the host holds for done.
    wrong_seeds,
    /// Controllers that the host gave up because they did not answer.
    given_up,
    /// Those of them whose receivers all have rates at which bytes are heard.
    given_up_in_reach,
    /// Controllers that the host gave up for another reason.
    stuck,
    /// Controllers whose job was not over when the run was cut.
    cut,
    /// Frames that the host sent, repetitions among them; on a raw line its sends.
    frames,
    /// Frames that the host sent again.
    repeated,
    /// How often the host of a framed line died.
    crashes,
    /// Frames whose check failed (CRC).
    bad_check,
    /// Runs of bytes that were no frame, and packets that a gap cut (SHORT_PACKET).
    short,
    /// Frames with a byte too many (OVERLONG).
    overlong,
    /// Bytes without a stop bit (FRAMING).
    framing,
    /// Frames and packets that were whole and refused.
    refused,
    /// Repeated frames that were acknowledged and not queued again.
    acknowledged_again,
    /// Replies that the controllers sent.
    replies,
    /// Replies that the host did not get, or not whole.
    replies_lost,
    /// Ticks ordered.
    ordered,
    /// Ticks executed.
    executed,
    /// Ticks that the host did not get to, because it gave up or the run was cut.
    unreached,
    /// Ticks executed with other steps than ordered.
    wrong,
    /// Ticks executed twice, or never ordered.
    duplicated,
    /// Ticks left out, of those that the host holds for done; on a raw line, of all.
    missing,
    /// Steps by which wrong ticks differ, and those of duplicated ticks.
    wrong_steps,
    /// Steps of missing ticks.
    missing_steps,
    /// Distance of the positions from where the ordered ticks lead, in steps of all channels.
    position_error,
}

impl Tally {
    /// Whether something was done that was not ordered, or left out and held for done.
    #[must_use]
    pub const fn is_wrong(&self) -> bool {
        self.wrong + self.duplicated + self.missing + self.position_error > 0
    }

    pub(super) fn give_up(&mut self, reason: GivenUp, in_reach: bool) {
        match reason {
            GivenUp::NoReply => {
                self.given_up += 1;
                self.given_up_in_reach += u64::from(in_reach);
            }
            _ => self.stuck += 1,
        }
    }

    pub(super) fn add_alignment(&mut self, alignment: &Alignment) {
        self.wrong += alignment.wrong;
        self.duplicated += alignment.extra;
        self.missing += alignment.missing;
        self.wrong_steps += alignment.wrong_steps;
        self.missing_steps += alignment.missing_steps;
    }

    /// Adds what the host of a framed line counted; replies have been counted before.
    pub(super) fn add_host(&mut self, counts: Counts) {
        self.frames += counts.frames;
        self.repeated += counts.repeated;
        self.crashes += counts.crashes;
        self.replies_lost += self.replies.saturating_sub(counts.replies + counts.refused);
    }
}
