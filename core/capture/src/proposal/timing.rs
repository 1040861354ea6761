//! Measures how close a channel's changes are to a motor's pulses.

/// Sum of the times from each change to the nearest edge.
pub(super) fn nearness(changes: &[u64], edges: &[u64]) -> u64 {
    let distance = |tick: &u64| {
        let next = edges.partition_point(|edge| edge < tick);
        let to_next = edges.get(next).map_or(u64::MAX, |edge| edge - tick);
        let last = next.checked_sub(1).and_then(|last| edges.get(last));
        to_next.min(last.map_or(u64::MAX, |edge| tick - edge))
    };
    changes.iter().map(distance).fold(0, u64::saturating_add)
}

/// Whether the changes are far closer to pulses than the shortest pulse interval. A change in the middle of an
/// interval may belong to any motor.
pub(super) fn is_next_to(nearness: u64, changes: usize, edges: &[u64]) -> bool {
    let intervals = edges.iter().zip(edges.iter().skip(2)).map(|(from, to)| to - from);
    let shortest = intervals.min().unwrap_or(0);
    nearness.saturating_mul(20) <= shortest.saturating_mul(changes as u64)
}

/// Whether at least `percent` of the times between two changes have a pulse.
pub(super) fn has_steps_between(changes: &[u64], edges: &[u64], percent: usize) -> bool {
    let edges_until = |tick: &u64| edges.partition_point(|edge| edge <= tick);
    let pairs = changes.iter().zip(changes.iter().skip(1));
    let with_steps = pairs.filter(|(from, to)| edges_until(to) > edges_until(from) + 1).count();
    with_steps * 100 >= changes.len().saturating_sub(1) * percent
}
