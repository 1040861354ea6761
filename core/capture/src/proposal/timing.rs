//! How close the changes of a channel are to the pulses of a motor.

/// How close the changes of a channel are to a motor's edges: the sum of the times to the next one, before or after.
pub(super) fn nearness(changes: &[u64], edges: &[u64]) -> u64 {
    let near = |at: &u64| {
        let next = edges.partition_point(|edge| edge < at);
        let after = edges.get(next).map_or(u64::MAX, |edge| edge - at);
        let before = next.checked_sub(1).and_then(|last| edges.get(last)).map_or(u64::MAX, |edge| at - edge);
        after.min(before)
    };
    changes.iter().map(near).fold(0, u64::saturating_add)
}

/// Whether changes with this sum of distances come right before or after pulses: far within the shortest interval from
/// pulse to pulse. A change in the middle of an interval says nothing of whose it is.
pub(super) fn is_next_to(nearness: u64, changes: usize, edges: &[u64]) -> bool {
    let intervals = edges.iter().zip(edges.iter().skip(2)).map(|(from, to)| to - from);
    let shortest = intervals.min().unwrap_or(0);
    nearness.saturating_mul(20) <= shortest.saturating_mul(changes as u64)
}

/// Whether there are steps between so many percent of the changes of a channel.
pub(super) fn has_steps_between(changes: &[u64], edges: &[u64], percent: usize) -> bool {
    let place = |at: &u64| edges.partition_point(|edge| edge <= at);
    let between = changes.iter().zip(changes.iter().skip(1));
    let with_steps = between.filter(|(from, to)| place(to) > place(from) + 1).count();
    with_steps * 100 >= changes.len().saturating_sub(1) * percent
}
