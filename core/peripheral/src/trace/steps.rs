//! The actual steps of a channel: cycles and positions.

use crate::signal::Record;
use alloc::vec::Vec;

/// One step of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    pub cycle: u64,
    /// Position after it, in steps from the start of the trace.
    pub position: i32,
}

impl Step {
    /// Direction of step `index`: +1 to the right, -1 to the left.
    pub fn direction(steps: &[Self], index: usize) -> i32 {
        let before = index.checked_sub(1).and_then(|i| steps.get(i)).map_or(0, |step| step.position);
        steps.get(index).map_or(0, |step| step.position - before)
    }
}

/// The steps of a channel.
pub fn steps(trace: &[Record], channel: u8) -> Vec<Step> {
    steps_in(trace, channel).collect()
}

/// The steps of a channel as an iterator.
pub fn steps_in(trace: &[Record], channel: u8) -> impl Iterator<Item = Step> {
    let mask = 1_u16 << (channel & 15);
    // A trace may start within a pulse.
    let (mut before, mut position) = (trace.first().map_or(0, |record| record.levels.step()), 0_i32);
    trace.iter().filter_map(move |record| {
        let step = record.levels.step();
        let rises = step & !before & mask != 0;
        before = step;
        if !rises {
            return None;
        }
        position = position.wrapping_add(if record.levels.dir() & mask != 0 { 1 } else { -1 });
        Some(Step { cycle: record.cycle.0, position })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{signal::Levels, units::Instant};

    #[test]
    fn a_pulse_that_is_high_at_the_start_is_no_step() {
        let trace = [(0, 1), (5, 0), (9, 1)];
        let trace = trace.map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) });
        assert_eq!(steps(&trace, 0), [Step { cycle: 9, position: -1 }]);
    }

    #[test]
    fn a_step_has_the_direction_of_its_cycle() {
        let right = 1 << 17;
        let trace = [(0, 0), (5, right | 2), (6, right), (9, 2), (10, 0), (12, 2 | 1), (13, 2), (14, 0)]
            .map(|(cycle, levels)| Record { cycle: Instant(cycle), levels: Levels(levels) });
        let found: Vec<(u64, i32)> = steps(&trace, 1).iter().map(|s| (s.cycle, s.position)).collect();
        assert_eq!(found, [(5, 1), (9, 0), (12, -1)]);
        assert_eq!(Step::direction(&steps(&trace, 1), 0), 1);
        assert_eq!(Step::direction(&steps(&trace, 1), 1), -1);
    }
}
