//! Measures how close a channel's changes are to a motor's pulses.

/// Maximum mean distance of changes to edges, in percent of the shortest pulse interval.
const MAX_DISTANCE_PERCENT: u64 = 5;

/// Sum of the times from each change to the nearest edge.
pub(super) fn total_distance(changes: &[u64], edges: &[u64]) -> u64 {
    let distance = |tick: &u64| {
        let next = edges.partition_point(|edge| edge < tick);
        let to_next = edges.get(next).map_or(u64::MAX, |edge| edge - tick);
        let last = next.checked_sub(1).and_then(|last| edges.get(last));
        to_next.min(last.map_or(u64::MAX, |edge| tick - edge))
    };
    changes.iter().map(distance).fold(0, u64::saturating_add)
}

/// Whether the mean distance is at most [`MAX_DISTANCE_PERCENT`]; in the middle of an interval, any motor may fit.
pub(super) fn are_close_to_pulses(total_distance: u64, changes: usize, edges: &[u64]) -> bool {
    // Every other edge: rise to rise.
    let intervals = edges.iter().zip(edges.iter().skip(2)).map(|(from, to)| to - from);
    let shortest = intervals.min().unwrap_or(0);
    let max_total = shortest.saturating_mul(changes as u64).saturating_mul(MAX_DISTANCE_PERCENT);
    total_distance.saturating_mul(100) <= max_total
}

/// Whether at least `percent` of the intervals between consecutive changes contain a whole pulse.
pub(super) fn has_pulses_between(changes: &[u64], edges: &[u64], percent: usize) -> bool {
    let edges_until = |tick: &u64| edges.partition_point(|edge| edge <= tick);
    let pairs = changes.iter().zip(changes.iter().skip(1));
    // Two edges: a rise and a fall.
    let with_pulses = pairs.filter(|(from, to)| edges_until(to) > edges_until(from) + 1).count();
    with_pulses * 100 >= changes.len().saturating_sub(1) * percent
}
