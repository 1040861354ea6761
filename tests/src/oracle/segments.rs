//! A8: the segment engine, one per channel. "A configuration uses either the tick path (A4..A7) or segments; with
//! segments EN = RX = TX = 1 and DE = 0 throughout."

use super::controller::Recorder;
use super::{Config, Run, bits};

/// One entry of a channel's list; `interval`, `add` and a dwell are in 1/65536 cycle.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Segment {
    /// `steps` steps, the first `interval` after the previous event, each next interval `add` longer.
    Steps {
        /// At least 1.
        steps: u32,
        /// 48.16 fixed point, cycles.
        interval: u64,
        /// 48.16 fixed point, cycles per step.
        add: i64,
        /// DIR during these steps.
        dir: bool,
    },
    /// A pause of this length; 0 is allowed, also at the end.
    Dwell(u64),
}

/// The reason and the location of a refusal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Refused {
    /// The channel of the list.
    pub channel: usize,
    /// The index in that list; `None` if the start cycle is invalid.
    pub segment: Option<usize>,
    /// The rule that is broken.
    pub rule: Rule,
}

/// The rules for lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// "start_cycle >= 1".
    StartBeforeCycle1,
    /// "steps = 0".
    NoSteps,
    /// "an interval that a step uses is under (W + max(H + D, 1)) << 16".
    ShortInterval,
    /// An interval that a step uses "leaves u64".
    IntervalLeavesU64,
    /// "`next` leaves u64".
    NextLeavesU64,
}

/// The results of a channel's list.
#[derive(Default)]
struct Ordered {
    /// The cycles in which STEP rises.
    rises: Vec<u64>,
    /// From this cycle on, DIR has this level.
    dir_changes: Vec<(u64, bool)>,
}

/// Runs a list (start cycle, segments) per channel from 0 on; channels beyond `lists` are idle. The whole list is
/// validated, also beyond the run's end, in ascending channel and segment. Work is proportional to the number of steps.
///
/// Reading: A4's and A7's rules apply to the tick path. For segments only `channels` and W, D, H of the configuration
/// matter, W >= 1, and each channel has its own DIR regardless of `common_dir`.
/// Fields of a [`Run`] from A6 and A7 keep their defaults.
pub fn run_segments(config: &Config, lists: &[(u64, Vec<Segment>)], cycles: u64) -> Result<Run, Refused> {
    assert!(config.pulse_width >= 1 && lists.len() <= config.channels && config.channels <= 16, "{config:?}");
    let mut levels = vec![1 << bits::EN | 1 << bits::RX | 1 << bits::TX; cycles as usize];
    for (channel, (start_cycle, list)) in lists.iter().enumerate() {
        let ordered = lay_out(config, *start_cycle, list).map_err(|(segment, rule)| Refused {
            channel,
            segment,
            rule,
        })?;
        for rise in ordered.rises {
            for cycle in rise..(rise + config.pulse_width).min(cycles) {
                levels[cycle as usize] |= 1 << bits::STEP << channel;
            }
        }
        for (from, level) in ordered.dir_changes {
            for cycle in from..cycles {
                let dir = 1 << bits::DIR << channel;
                levels[cycle as usize] &= !dir;
                levels[cycle as usize] |= if level { dir } else { 0 };
            }
        }
    }
    let mut recorder = Recorder::default();
    for (cycle, levels) in levels.into_iter().enumerate() {
        recorder.record(cycle as u64, levels);
    }
    Ok(Run { trace: recorder.trace, positions: recorder.positions, ..Run::default() })
}

fn lay_out(config: &Config, start_cycle: u64, list: &[Segment]) -> Result<Ordered, (Option<usize>, Rule)> {
    let (width, setup, hold) = (config.pulse_width, config.dir_setup, config.dir_hold);
    let least = u128::from(width + (hold + setup).max(1)) << 16;
    if start_cycle < 1 {
        return Err((None, Rule::StartBeforeCycle1));
    }
    // "at the start start_cycle << 16". Reading: a start cycle that exceeds u64 when shifted is refused like any `next`
    // that does, without a segment, also if the list is empty.
    let mut next = u64::try_from(u128::from(start_cycle) << 16).map_err(|_| (None, Rule::NextLeavesU64))?;
    let mut ordered = Ordered::default();
    let mut dir_so_far = false;
    for (index, segment) in list.iter().enumerate() {
        let refused = |rule| (Some(index), rule);
        match *segment {
            Segment::Dwell(dwell) => {
                next = next.checked_add(dwell).ok_or(refused(Rule::NextLeavesU64))?;
            }
            Segment::Steps { steps: 0, .. } => return Err(refused(Rule::NoSteps)),
            Segment::Steps { steps, interval, add, dir } => {
                if dir != dir_so_far {
                    // "changes at max(next >> 16, last fall + H) …; before the first pulse at next >> 16".
                    let hold_over = ordered.rises.last().map_or(0, |rise| rise + width + hold);
                    ordered.dir_changes.push(((next >> 16).max(hold_over), dir));
                    dir_so_far = dir;
                }
                let mut interval = i128::from(interval);
                for _ in 0..steps {
                    // Only "an interval that a step uses": the interval after the last step is unused.
                    let used = u64::try_from(interval).map_err(|_| refused(Rule::IntervalLeavesU64))?;
                    if u128::from(used) < least {
                        return Err(refused(Rule::ShortInterval));
                    }
                    next = next.checked_add(used).ok_or(refused(Rule::NextLeavesU64))?;
                    ordered.rises.push(next >> 16);
                    interval += i128::from(add);
                }
            }
        }
    }
    Ok(ordered)
}
