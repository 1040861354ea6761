//! Counts of a fault sweep, which can be added.

use crate::faults::fault_sweep::align::Alignment;
use crate::hosts::framed_host::{Counts, GivenUp};
use core::ops::AddAssign;

macro_rules! tally {
    ($($(#[doc = $doc:literal])* $field:ident,)+) => {
        /// Counts over several seeds.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct Tally {
            $($(#[doc = $doc])* pub $field: u64,)+
        }

        impl AddAssign for Tally {
            fn add_assign(&mut self, other: Self) {
                $(self.$field += other.$field;)+
            }
        }
    };
}

tally! {
    seeds,
    /// Seeds with an uncommanded executed tick, or a lost one that the host counts as done.
    wrong_seeds,
    /// Controllers that the host gave up, because they did not reply.
    given_up,
    /// Of these, those whose receivers all have rates in reach.
    given_up_in_reach,
    /// Controllers given up for another reason.
    stuck,
    /// Controllers whose job was not over at the end of the run.
    cut,
    /// Frames sent, with repetitions; on a raw line the sends.
    frames,
    repeated,
    crashes,
    /// Frames whose check failed (CRC).
    bad_check,
    short,
    /// Frames with a byte too many (OVERLONG).
    overlong,
    framing,
    refused,
    /// Repeated frames that were acknowledged again.
    acknowledged_again,
    replies,
    /// Replies that the host did not receive completely.
    replies_lost,
    commanded,
    executed,
    /// Ticks that the host did not send, because it gave up or the run ended.
    unreached,
    /// Ticks executed with other steps than commanded.
    wrong,
    /// Ticks executed twice, or never commanded.
    duplicated,
    /// Lost ticks, of those that the host counts as done; on a raw line, of all.
    missing,
    /// Steps by which wrong ticks differ, plus the steps of duplicated ticks.
    wrong_steps,
    missing_steps,
    /// Distance of the positions from the sums of the ticks, in steps over all channels.
    position_error,
}

impl Tally {
    /// Whether a wrong tick was executed, or one was lost that the host counts as done.
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
        self.duplicated += alignment.duplicated;
        self.missing += alignment.missing;
        self.wrong_steps += alignment.wrong_steps;
        self.missing_steps += alignment.missing_steps;
    }

    pub(super) fn add_host(&mut self, counts: Counts) {
        self.frames += counts.frames;
        self.repeated += counts.repeated;
        self.crashes += counts.crashes;
        self.replies_lost += self.replies.saturating_sub(counts.replies + counts.refused);
    }
}
