//! A motor of a map in progress.

/// The channels of a motor's pulses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// Unknown: only DIR is.
    None,
    Step(usize),
    CwCcw(usize, usize),
    Encoder(usize, usize),
}

#[derive(Clone, Debug)]
pub(super) struct Motor {
    /// Identifies the motor in the names of its channels.
    pub(super) axis: String,
    pub(super) scope: String,
    pub(super) source: Source,
    pub(super) dir: Option<usize>,
    pub(super) inverted: bool,
}

impl Motor {
    pub(super) fn new(axis: &str, scope: &str, source: Source) -> Self {
        Self { axis: axis.to_owned(), scope: scope.to_owned(), source, dir: None, inverted: false }
    }

    pub(super) const fn step(&self) -> Option<usize> {
        match self.source {
            Source::Step(channel) => Some(channel),
            _ => None,
        }
    }

    pub(super) fn has(&self, channel: usize) -> bool {
        self.dir == Some(channel)
            || match self.source {
                Source::None => false,
                Source::Step(step) => step == channel,
                Source::CwCcw(first, second) | Source::Encoder(first, second) => {
                    first == channel || second == channel
                }
            }
    }

    pub(super) const fn lacks_dir(&self) -> bool {
        matches!(self.source, Source::Step(_)) && self.dir.is_none()
    }
}

/// The axis without its number.
pub(super) fn stem(axis: &str) -> &str {
    axis.trim_end_matches(|c: char| c.is_ascii_digit())
}
