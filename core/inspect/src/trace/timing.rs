//! The timing check: could a driver have followed the pulses of a run?
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
//! | rule | measured at | from, to |
//! | --- | --- | --- |
//! | STEP high | fall of STEP | its rise, the fall |
//! | STEP low | rise of STEP | its last fall, the rise |
//! | DIR set-up | every rise of STEP | the channel's last change of DIR, the rise |
//! | DIR hold | change of DIR | the channel's last rise of STEP, the change |
//! | EN wake-up | a channel's first rise of STEP after EN | rise of EN, the rise of STEP |
//!
//! The active edge of STEP is its rise, and set-up and hold of DIR both count from it, as data sheets
//! do; a DIR that changes during a pulse is therefore a matter of hold. Levels before the first record
//! are DESIGN A3's reset: EN is high from cycle 0 on, so a wake-up counts from there. What never
//! changed is not measured: a DIR that kept its level since reset has no set-up, a first pulse no
//! low time before it, and a pulse that the run's end cuts no high time. A DIR that changes in the
//! very cycle in which STEP rises has a set-up of 0 cycles, and its hold counts from the rise
//! before. Steps while EN is low have no wake-up; the fall of EN is no rule, but a pulse that STOP
//! cuts short (DESIGN A6) is a short pulse.
//!
//! A time of n cycles keeps a rule of t ns if n*10^9 >= t*clock_hz. That is so exactly from
//! ceil(t*clock_hz/10^9) cycles on, which is what is compared; no fraction is ever rounded.
//!
//! ```
//! use stepscope_inspect::trace::{drivers::TB6600_CLASS, timing::{Rule, TimingCheck}};
//! use stepscope_scenario::TimingRules;
//! use stepscope_sim::Experiment;
//!
//! // The default motion's pulses of 2.5 us are just long enough for an opto-isolated driver.
//! let experiment = Experiment::from_json("{}").expect("the default motion");
//! let violations = |rules: &TimingRules| {
//!     let mut check = TimingCheck::new(rules, experiment.config().clock_hz(), 10);
//!     experiment.run(&mut check);
//!     (check.total(), check.violations().first().map(|violation| violation.rule))
//! };
//! assert_eq!(violations(&TB6600_CLASS.rules), (0, None));
//! let longer = TimingRules { step_high_ns: 3000, ..TB6600_CLASS.rules.clone() };
//! assert_eq!(violations(&longer), (3200, Some(Rule::StepHigh)));
//! ```

use alloc::vec::Vec;
use stepscope_peripheral::{
    signal::{Levels, MAX_CHANNELS, Record, Sink},
    units::{Cycles, Instant},
};
use stepscope_scenario::TimingRules;

/// Signals that the rules are about.
const WATCHED: u64 = Levels::EN | 0xFFFF_FFFF;

/// What a driver asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rule {
    /// STEP high.
    StepHigh,
    /// STEP low.
    StepLow,
    /// DIR stable before STEP rises.
    DirSetup,
    /// DIR stable after STEP has risen.
    DirHold,
    /// EN before the first rise of STEP.
    EnableWake,
}

impl Rule {
    /// All rules, in the order of [`TimingCheck::results`].
    pub const ALL: [Self; 5] =
        [Self::StepHigh, Self::StepLow, Self::DirSetup, Self::DirHold, Self::EnableWake];

    /// The rule's word in tables and on the page.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::StepHigh => "step_high",
            Self::StepLow => "step_low",
            Self::DirSetup => "dir_setup",
            Self::DirHold => "dir_hold",
            Self::EnableWake => "enable_wake",
        }
    }

    /// What the rules ask for under this one, in ns; 0 asks for nothing.
    #[must_use]
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

/// Fewest cycles that last at least `nanos`; no product of two `u32` leaves `u64`.
#[must_use]
pub const fn cycles_at_least(nanos: u32, clock_hz: u32) -> Cycles {
    Cycles((nanos as u64 * clock_hz as u64).div_ceil(1_000_000_000))
}

/// A time that is shorter than the driver asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Channel, from 0.
    pub channel: u8,
    /// Which rule.
    pub rule: Rule,
    /// Cycle of the edge that came too early.
    pub at: Instant,
    /// How long it was.
    pub measured: Cycles,
    /// How long it should have been, in whole cycles.
    pub required: Cycles,
}

/// A shortest time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Least {
    /// How long it was.
    pub measured: Cycles,
    /// Cycle of the edge that ended it; the first, where several were as short.
    pub at: Instant,
    /// Channel, from 0.
    pub channel: u8,
}

/// What a run came to under one rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RuleResult {
    /// Which rule.
    pub rule: Rule,
    /// What is asked for, in ns; 0 asks for nothing.
    pub nanos: u32,
    /// The same in whole cycles, rounded up.
    pub required: Cycles,
    /// The shortest time of all channels, also where nothing is asked for; `None` where there was
    /// nothing to measure.
    pub least: Option<Least>,
    /// Violations of each channel.
    pub violations: [u64; MAX_CHANNELS],
}

impl RuleResult {
    /// Violations of all channels.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.violations.iter().sum()
    }
}

/// A channel's last edges.
#[derive(Clone, Copy, Debug, Default)]
struct Edges {
    rise: Option<Instant>,
    fall: Option<Instant>,
    dir: Option<Instant>,
}

/// Takes the records of a run and holds them against a driver's rules.
#[derive(Clone, Debug)]
pub struct TimingCheck {
    results: [RuleResult; Rule::ALL.len()],
    violations: Vec<Violation>,
    most_kept: usize,
    levels: Levels,
    edges: [Edges; MAX_CHANNELS],
    /// Last rise of EN; reset counts as one.
    enabled: Instant,
    /// Channels that have not stepped since; none while EN is low.
    waking: u16,
    /// Channels that each rule leaves out.
    left_out: [u16; Rule::ALL.len()],
}

impl TimingCheck {
    /// A check before the first record, for a run at `clock_hz`. It counts all violations and keeps
    /// the first `most_kept` of them in full.
    #[must_use]
    pub fn new(rules: &TimingRules, clock_hz: u32, most_kept: usize) -> Self {
        let result = |rule: Rule| {
            let nanos = rule.nanos(rules);
            let required = cycles_at_least(nanos, clock_hz);
            RuleResult { rule, nanos, required, least: None, violations: [0; MAX_CHANNELS] }
        };
        Self {
            results: Rule::ALL.map(result),
            violations: Vec::new(),
            most_kept,
            levels: Levels::RESET,
            edges: [Edges::default(); MAX_CHANNELS],
            enabled: Instant::RESET,
            waking: u16::MAX,
            left_out: [0; Rule::ALL.len()],
        }
    }

    /// Leaves a rule out for a channel whose edges were made and not recorded.
    pub fn leave_out(&mut self, channel: u8, rule: Rule) {
        if let Some(channels) = self.left_out.get_mut(rule as usize) {
            *channels |= 1 << (channel & 15);
        }
    }

    /// The same of times that were rounded to cycles, half a cycle at most: a time that may have been as long as required is
    /// no violation.
    #[must_use]
    pub fn of_rounded(rules: &TimingRules, clock_hz: u32, most_kept: usize) -> Self {
        let mut check = Self::new(rules, clock_hz, most_kept);
        for result in &mut check.results {
            result.required = Cycles(u64::from(result.nanos) * u64::from(clock_hz) / 1_000_000_000);
        }
        check
    }

    /// A check of records whose cycles are ticks of `numerator / denominator` seconds: exact where no clock has whole cycles
    /// for the ticks.
    #[must_use]
    pub fn in_ticks(rules: &TimingRules, (numerator, denominator): (u64, u64), most_kept: usize) -> Self {
        let mut check = Self::new(rules, 1, most_kept);
        for result in &mut check.results {
            let ticks = (u128::from(result.nanos) * u128::from(denominator))
                .div_ceil(1_000_000_000 * u128::from(numerator.max(1)));
            result.required = Cycles(u64::try_from(ticks).unwrap_or(u64::MAX));
        }
        check
    }

    /// What the run came to under each rule, in the order of [`Rule::ALL`].
    #[must_use]
    pub const fn results(&self) -> &[RuleResult] {
        &self.results
    }

    /// All violations, also those that are not kept.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.results.iter().map(RuleResult::total).sum()
    }

    /// The first violations, in the order of their cycles; within one cycle by channel, and of one
    /// channel hold, high, low, set-up, wake-up.
    #[must_use]
    pub fn violations(&self) -> &[Violation] {
        &self.violations
    }

    /// Index of the first kept violation after `at`, or with `forward` false of the last one before.
    #[must_use]
    pub fn next(&self, at: Instant, forward: bool) -> Option<usize> {
        if forward {
            let index = self.violations.partition_point(|violation| violation.at <= at);
            (index < self.violations.len()).then_some(index)
        } else {
            self.violations.partition_point(|violation| violation.at < at).checked_sub(1)
        }
    }

    /// Signals of `changed` have new levels from `at` on.
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

    /// A time that began at `from`, if it did, and ends at `at`.
    fn measure(&mut self, rule: Rule, channel: usize, from: Option<Instant>, at: Instant) {
        let (Some(from), Some(result)) = (from, self.results.get_mut(rule as usize)) else { return };
        if self.left_out.get(rule as usize).is_some_and(|channels| channels >> channel & 1 == 1) {
            return;
        }
        let (measured, number) = (at - from, channel as u8);
        if result.least.is_none_or(|least| measured < least.measured) {
            result.least = Some(Least { measured, at, channel: number });
        }
        if measured < result.required
            && let Some(count) = result.violations.get_mut(channel)
        {
            *count += 1;
            if self.violations.len() < self.most_kept {
                let required = result.required;
                self.violations.push(Violation { channel: number, rule, at, measured, required });
            }
        }
    }
}

impl Sink for TimingCheck {
    fn record(&mut self, record: Record) {
        // What a recording begins with is no edge; a run begins with the levels of reset.
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
