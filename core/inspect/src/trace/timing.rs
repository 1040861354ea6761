//! The timing check: are the pulses of a run long enough for a driver?
//!
//! ```text
//!          |<-set-up->|<-hold->|
//! DIR   ___X----------+--------X----
//!                     |<--high-->|<--low-->|
//! STEP  ______________/----------\_________/----
//!           |<-wake-->|
//! EN    ____/--------------------------------
//! ```
//!
//! Set-up and hold of DIR refer to the rise of STEP. EN counts as risen in cycle 0 (DESIGN A3). Levels that never
//! changed are not measured: DIR constant since reset has no set-up, the first pulse no low time, and a pulse cut by the
//! end of the run no high time. A DIR change in the cycle of a rise has a set-up of 0 and ends the hold of the rise
//! before. A pulse that STOP cuts short (DESIGN A6) is a short pulse.
//!
//! A time of t ns requires ceil(t*clock_hz/10^9) cycles. Cycles are compared, so nothing is rounded.
//!
//! ```
//! use stepscope_inspect::trace::{drivers::TB6600_CLASS, timing::TimingCheck};
//! use stepscope_sim::Experiment;
//!
//! let experiment = Experiment::from_json(r#"{ "bus": { "pulse_width_cycles": 16 } }"#).expect("it is valid");
//! let mut check = TimingCheck::new(&TB6600_CLASS.rules, experiment.config().clock_hz(), 100);
//! experiment.run(&mut check);
//! assert_eq!(check.violations()[0].measured.0, 16); // 1 us instead of 2.5 us
//! ```

use alloc::vec::Vec;
use stepscope_peripheral::signal::{Levels, MAX_CHANNELS, Record, Sink};
use stepscope_peripheral::units::{Cycles, Instant};
use stepscope_scenario::TimingRules;

const WATCHED: u64 = Levels::EN | 0xFFFF_FFFF;

/// A minimum time that a driver requires.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rule {
    StepHigh,
    StepLow,
    DirSetup,
    DirHold,
    EnableWake,
}

impl Rule {
    /// All rules, in the order of [`TimingCheck::results`].
    pub const ALL: [Self; 5] =
        [Self::StepHigh, Self::StepLow, Self::DirSetup, Self::DirHold, Self::EnableWake];

    pub const fn name(self) -> &'static str {
        match self {
            Self::StepHigh => "step_high",
            Self::StepLow => "step_low",
            Self::DirSetup => "dir_setup",
            Self::DirHold => "dir_hold",
            Self::EnableWake => "enable_wake",
        }
    }

    /// The required ns; 0 for none.
    pub const fn nanos(self, rules: &TimingRules) -> u32 {
        match self {
            Self::StepHigh => rules.step_high_ns,
            Self::StepLow => rules.step_low_ns,
            Self::DirSetup => rules.dir_setup_ns,
            Self::DirHold => rules.dir_hold_ns,
            Self::EnableWake => rules.enable_wake_ns,
        }
    }
}

/// Minimum cycles that last `nanos`; the product of two `u32` fits in `u64`.
pub const fn cycles_at_least(nanos: u32, clock_hz: u32) -> Cycles {
    Cycles((nanos as u64 * clock_hz as u64).div_ceil(1_000_000_000))
}

/// A time shorter than a rule requires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Violation {
    pub channel: u8,
    pub rule: Rule,
    pub at: Instant,
    pub measured: Cycles,
    pub required: Cycles,
}

/// The shortest time measured for a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shortest {
    pub measured: Cycles,
    /// The edge that ended it; the first of equals.
    pub at: Instant,
    pub channel: u8,
}

/// Result of one timing rule over all channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RuleResult {
    pub rule: Rule,
    /// The required time in ns; 0 for none.
    pub nanos: u32,
    pub required: Cycles,
    /// The shortest time of all channels, required or not; `None` where nothing was measured.
    pub shortest: Option<Shortest>,
    pub violations: [u64; MAX_CHANNELS],
}

impl RuleResult {
    pub fn total(&self) -> u64 {
        self.violations.iter().sum()
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Edges {
    rise: Option<Instant>,
    fall: Option<Instant>,
    dir: Option<Instant>,
}

/// Checks the timing of a run; it is a [`Sink`].
#[derive(Clone, Debug)]
pub struct TimingCheck {
    results: [RuleResult; Rule::ALL.len()],
    violations: Vec<Violation>,
    max_listed: usize,
    levels: Levels,
    edges: [Edges; MAX_CHANNELS],
    /// Reset counts as a rise.
    enabled: Instant,
    /// Channels that have not stepped since EN rose.
    waking: u16,
    excluded: [u16; Rule::ALL.len()],
}

impl TimingCheck {
    /// Counts all violations and lists the first `max_listed`.
    pub fn new(rules: &TimingRules, clock_hz: u32, max_listed: usize) -> Self {
        let result = |rule: Rule| {
            let nanos = rule.nanos(rules);
            let required = cycles_at_least(nanos, clock_hz);
            RuleResult { rule, nanos, required, shortest: None, violations: [0; MAX_CHANNELS] }
        };
        Self {
            results: Rule::ALL.map(result),
            violations: Vec::new(),
            max_listed,
            levels: Levels::RESET,
            edges: [Edges::default(); MAX_CHANNELS],
            enabled: Instant::RESET,
            waking: u16::MAX,
            excluded: [0; Rule::ALL.len()],
        }
    }

    /// Excludes a rule for a channel whose edges were generated, not recorded.
    pub fn exclude(&mut self, channel: u8, rule: Rule) {
        if let Some(channels) = self.excluded.get_mut(rule as usize) {
            *channels |= 1 << (channel & 15);
        }
    }

    /// For times that were rounded to cycles: a time that may have been long enough is no violation.
    pub fn of_rounded(rules: &TimingRules, clock_hz: u32, max_listed: usize) -> Self {
        let mut check = Self::new(rules, clock_hz, max_listed);
        for result in &mut check.results {
            result.required = Cycles(u64::from(result.nanos) * u64::from(clock_hz) / 1_000_000_000);
        }
        check
    }

    /// For records in ticks of `numerator / denominator` s instead of cycles.
    pub fn in_ticks(rules: &TimingRules, (numerator, denominator): (u64, u64), max_listed: usize) -> Self {
        let mut check = Self::new(rules, 1, max_listed);
        for result in &mut check.results {
            let ticks = (u128::from(result.nanos) * u128::from(denominator))
                .div_ceil(1_000_000_000 * u128::from(numerator.max(1)));
            result.required = Cycles(u64::try_from(ticks).unwrap_or(u64::MAX));
        }
        check
    }

    /// One result per rule, in the order of [`Rule::ALL`].
    pub const fn results(&self) -> &[RuleResult] {
        &self.results
    }

    pub fn total(&self) -> u64 {
        self.results.iter().map(RuleResult::total).sum()
    }

    /// The listed violations in the order of cycles, then channels, then hold, high, low, set-up, wake-up.
    pub fn violations(&self) -> &[Violation] {
        &self.violations
    }

    /// Index of the first listed violation after `at`, or the last one before.
    pub fn next(&self, at: Instant, forward: bool) -> Option<usize> {
        if forward {
            let index = self.violations.partition_point(|violation| violation.at <= at);
            (index < self.violations.len()).then_some(index)
        } else {
            self.violations.partition_point(|violation| violation.at < at).checked_sub(1)
        }
    }

    fn change(&mut self, at: Instant, changed: Levels) {
        if changed.has(Levels::EN) {
            self.enabled = at;
            self.waking = if self.levels.has(Levels::EN) { u16::MAX } else { 0 };
        }
        let mut left = changed.step() | changed.dir();
        while left != 0 {
            let channel = left.trailing_zeros() as usize;
            let bit = 1 << channel;
            left &= left - 1;
            self.change_channel(at, channel, changed.dir() & bit != 0, changed.step() & bit != 0);
        }
    }

    fn change_channel(&mut self, at: Instant, channel: usize, dir_changed: bool, step_changed: bool) {
        let Some(edges) = self.edges.get_mut(channel) else { return };
        let before = *edges;
        let bit = 1 << channel;
        let high = self.levels.step() & bit != 0;
        if dir_changed {
            edges.dir = Some(at);
        }
        let dir = edges.dir;
        match (step_changed, high) {
            (true, true) => edges.rise = Some(at),
            (true, false) => edges.fall = Some(at),
            (false, _) => {}
        }
        if dir_changed {
            self.measure(Rule::DirHold, channel, before.rise, at);
        }
        if step_changed && high {
            self.measure(Rule::StepLow, channel, before.fall, at);
            self.measure(Rule::DirSetup, channel, dir, at);
            if self.waking & bit != 0 {
                self.waking &= !bit;
                self.measure(Rule::EnableWake, channel, Some(self.enabled), at);
            }
        } else if step_changed {
            self.measure(Rule::StepHigh, channel, before.rise, at);
        }
    }

    fn measure(&mut self, rule: Rule, channel: usize, from: Option<Instant>, at: Instant) {
        let (Some(from), Some(result)) = (from, self.results.get_mut(rule as usize)) else { return };
        if self.excluded.get(rule as usize).is_some_and(|channels| channels >> channel & 1 == 1) {
            return;
        }
        let (measured, number) = (at - from, channel as u8);
        if result.shortest.is_none_or(|shortest| measured < shortest.measured) {
            result.shortest = Some(Shortest { measured, at, channel: number });
        }
        if measured < result.required
            && let Some(count) = result.violations.get_mut(channel)
        {
            *count += 1;
            if self.violations.len() < self.max_listed {
                let required = result.required;
                self.violations.push(Violation { channel: number, rule, at, measured, required });
            }
        }
    }
}

impl Sink for TimingCheck {
    fn record(&mut self, record: Record) {
        // The first levels of a recording are no edge; a run begins with the levels of reset.
        if record.cycle == Instant::RESET {
            self.levels = record.levels;
        }
        let changed = (record.levels.0 ^ self.levels.0) & WATCHED;
        self.levels = record.levels;
        if changed != 0 {
            self.change(record.cycle, Levels(changed));
        }
    }
}

#[cfg(test)]
mod tests;
