//! Selects channels of a file that has too many: requested ones, then those with recognized names, then the others.

use super::recorder::Recorder;
use crate::short_sort::ShortSort as _;
use crate::{capture::MAX_CHANNELS, names::Meaning};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rank {
    FullName,
    LastPart,
    Recognized,
    RecognizedBit,
    Other,
}

impl Rank {
    pub(super) fn of(name: &str, wanted: &[String]) -> Self {
        let last = name.rsplit('.').next().unwrap_or_default();
        match () {
            () if wanted.iter().any(|wanted| wanted == name) => Self::FullName,
            () if wanted.iter().any(|wanted| wanted.eq_ignore_ascii_case(last)) => Self::LastPart,
            () if !Meaning::is_recognized(name) => Self::Other,
            () if name.ends_with(']') => Self::RecognizedBit,
            () => Self::Recognized,
        }
    }
}

struct Candidate<T> {
    rank: Rank,
    order: u64,
    name: String,
    payload: T,
}

#[derive(Default)]
pub(super) struct Selection<T> {
    best: Vec<Candidate<T>>,
    offered: u64,
}

impl<T> Selection<T> {
    pub(super) const fn new() -> Self {
        Self { best: Vec::new(), offered: 0 }
    }

    pub(super) fn offer(&mut self, name: String, payload: T, recorder: &mut Recorder) {
        let rank = Rank::of(&name, &recorder.requested);
        let order = self.offered;
        self.offered += 1;
        let at = self.best.partition_point(|other| other.rank <= rank);
        if at >= MAX_CHANNELS {
            return recorder.omit(&name);
        }
        self.best.insert(at, Candidate { rank, order, name, payload });
        if self.best.len() > MAX_CHANNELS
            && let Some(last) = self.best.pop()
        {
            recorder.omit(&last.name);
        }
    }

    pub(super) fn finish(&mut self, recorder: &mut Recorder, mut each: impl FnMut(T, u8)) {
        self.best.sort_short_by_key(|candidate| candidate.order);
        for Candidate { name, payload, .. } in self.best.drain(..) {
            if let Some(bit) = recorder.channel(&name) {
                each(payload, bit);
            }
        }
    }
}

pub(super) fn select<'a>(names: impl Iterator<Item = &'a str>, recorder: &mut Recorder) -> Vec<Option<u8>> {
    let mut selection = Selection::new();
    let mut count = 0;
    for name in names {
        selection.offer(name.to_owned(), count, recorder);
        count += 1;
    }
    let mut bits = vec![None; count];
    selection.finish(recorder, |at, bit| {
        if let Some(place) = bits.get_mut(at) {
            *place = Some(bit);
        }
    });
    bits
}
