//! Finds one entry of a step table through the windows of some of its steps (DESIGN B8).
//!
//! Step n of an entry is n*interval + n*(n-1)/2*add after the entry's start. Divided by n this is a straight line over
//! x = (n - 1)/2, and each step's window is a gate for it:
//!
//! ```text
//! low_n/n <= interval + add*(n-1)/2 <= high_n/n          all numbers integers
//! ```
//!
//! For a given add, the intervals that pass all gates are a range of length `room`, which is concave in add. So the two
//! tightest gates of an add without room determine the direction and the minimum distance of an add with room. This bound is
//! valid for any subset of the gates: fewer gates never refuse what all gates allow.

/// The times that step `n` (from 1) of an entry may have, in units from the entry's start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Gate {
    pub(super) n: i64,
    pub(super) low: i64,
    pub(super) high: i64,
}

/// Entries that pass all gates: an add, and a range of intervals in units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Fit {
    pub(super) min: i64,
    pub(super) max: i64,
    pub(super) add: i64,
}

/// Maximum number of adds tried; only gates with less than one unit of room need as many.
const MAX_PROBES: u32 = 64;
/// Maximum time of a gate in units, and maximum contribution of an add to it, so that all sums fit in 64 bits.
pub(super) const MAX_TIME: u64 = 1 << 60;

struct Probe {
    add: i64,
    min: i64,
    max: i64,
    /// Twice the slope of the room over add.
    slope: i64,
    /// Minimum distance of the next add with room, in the direction of growing room.
    ahead: i64,
}

impl Probe {
    fn at(gates: &[Gate], add: i64) -> Option<Self> {
        let (low, high) = tightest(gates, add)?;
        let min = ceiling(low.low, low.n);
        let max = high.high.div_euclid(high.n);
        let slope = low.n - high.n;
        // low.low/low.n - high.high/high.n over a common denominator: the add changes it by the slope.
        let [low_n, high_n] = [low.n, high.n].map(i128::from);
        let missing = i128::from(low.low) * high_n - i128::from(high.high) * low_n;
        let mut ahead = 1;
        if missing > 0 && slope != 0 {
            let per_add = low_n * high_n * i128::from(slope.abs());
            ahead = i64::try_from((2 * missing + per_add - 1) / per_add).unwrap_or(i64::MAX);
        }
        Some(Self { add, min, max, slope, ahead })
    }

    fn room(&self) -> i64 {
        self.max - self.min
    }

    fn fit(&self) -> Option<Fit> {
        (self.room() >= 0).then_some(Fit { min: self.min, max: self.max, add: self.add })
    }
}

/// The gates with the maximum lower and the minimum upper interval at an add, shifted by it; `None` without gates.
fn tightest(gates: &[Gate], add: i64) -> Option<(Gate, Gate)> {
    let wide = |time: i64, n: i64| i128::from(time) * i128::from(n);
    let first = gates.first()?.shifted(add);
    let (mut low, mut high) = (first, first);
    for gate in gates.iter().skip(1) {
        let gate = gate.shifted(add);
        if wide(gate.low, low.n) > wide(low.low, gate.n) {
            low = gate;
        }
        if wide(high.high, gate.n) > wide(gate.high, high.n) {
            high = gate;
        }
    }
    Some((low, high))
}

pub(super) const fn ceiling(numerator: i64, denominator: i64) -> i64 {
    numerator.div_euclid(denominator) + (numerator.rem_euclid(denominator) > 0) as i64
}

impl Gate {
    /// The gate for the interval alone, without add*(n-1)/2.
    fn shifted(self, add: i64) -> Self {
        let part = self.n * (self.n - 1) / 2 * add;
        debug_assert!(
            [self.low, self.high, part].iter().all(|time| time.unsigned_abs() <= MAX_TIME),
            "{self:?} with add {add} does not fit in 64 bits"
        );
        Self { n: self.n, low: self.low - part, high: self.high - part }
    }
}

/// When the search for an add ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Goal {
    /// At the first add that passes.
    Any,
    /// When the room is at least three quarters of the maximum.
    Roomy,
}

/// An interval and an add of `adds` (minimum, maximum) that pass all gates, if there are any. The search begins at `guess`.
/// Every gate's times and add*n*(n-1)/2 for `adds` must be within [`MAX_TIME`].
pub(super) fn fit(gates: &[Gate], adds: (i64, i64), guess: i64, goal: Goal) -> Option<Fit> {
    let (mut left, mut right) = adds;
    let (mut below, mut above): (Option<Probe>, Option<Probe>) = (None, None);
    let mut best: Option<Fit> = None;
    let mut add = guess;
    for _ in 0..MAX_PROBES {
        if left > right {
            break;
        }
        add = add.clamp(left, right);
        let probe = Probe::at(gates, add)?;
        if let Some(fit) = probe.fit()
            && best.is_none_or(|best| probe.room() > best.max - best.min)
        {
            best = Some(fit);
            if goal == Goal::Any {
                break;
            }
        }
        // Without room so far, the search exceeds the bound by half to reach the other side.
        let far = if best.is_none() { probe.ahead.saturating_add(probe.ahead / 2) } else { probe.step() };
        if probe.slope > 0 {
            left = add.saturating_add(probe.ahead);
            add = add.saturating_add(far);
            below = Some(probe);
        } else if probe.slope < 0 {
            right = add.saturating_sub(probe.ahead);
            add = add.saturating_sub(far);
            above = Some(probe);
        } else {
            break;
        }
        if let (Some(below), Some(above)) = (&below, &above) {
            let (summit, max_room) = summit(below, above);
            if best.is_some_and(|best| max_room - (best.max - best.min) <= max_room / 4) {
                break;
            }
            add = summit;
        }
    }
    best
}

impl Probe {
    /// Distance of the next add to try if there is room at this one.
    fn step(&self) -> i64 {
        (2 * self.room()).checked_div(self.slope.abs()).unwrap_or(1).max(1)
    }
}

/// The add where the lines through two probes intersect, and the room there.
fn summit(below: &Probe, above: &Probe) -> (i64, i64) {
    let distance = i128::from(above.add) - i128::from(below.add);
    let (up, down) = (i128::from(below.slope), i128::from(-above.slope));
    let drop = 2 * (i128::from(above.room()) - i128::from(below.room()));
    let along = (drop + down * distance) / (up + down).max(1);
    let room = i128::from(below.room()) + up * along / 2;
    let narrow = |x: i128| i64::try_from(x).unwrap_or(i64::MAX);
    (narrow(i128::from(below.add) + along), narrow(room))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use rand_xoshiro::{
        Xoshiro256StarStar,
        rand_core::{Rng, SeedableRng},
    };

    /// All adds with their ranges of intervals, by exhaustive search.
    fn all(gates: &[Gate], adds: (i64, i64)) -> Vec<Fit> {
        let passes = |interval: i64, add: i64| {
            gates.iter().all(|gate| {
                let time = gate.n * interval + gate.n * (gate.n - 1) / 2 * add;
                (gate.low..=gate.high).contains(&time)
            })
        };
        let fit = |add| {
            let intervals: Vec<i64> = (-400..400).filter(|&interval| passes(interval, add)).collect();
            Some(Fit { min: *intervals.first()?, max: *intervals.last()?, add })
        };
        (adds.0..=adds.1).filter_map(fit).collect()
    }

    /// If two gates leave no room, `ahead` is the distance of the first add without a gap between them.
    #[test]
    fn ahead_is_the_minimum_distance_that_closes_the_gap() {
        let mut noise = Xoshiro256StarStar::seed_from_u64(2);
        let mut draw = |from: i64, to: i64| from + (noise.next_u64() % (to - from + 1) as u64) as i64;
        let mut seen = 0;
        for _ in 0..20_000 {
            let gate = |n, low| Gate { n, low, high: low + 3 };
            let (first, second) = (gate(draw(1, 9), draw(0, 300)), gate(draw(1, 9), draw(0, 300)));
            let probe = Probe::at(&[first, second], 0).expect("there are gates");
            // The minimum interval of one gate minus the maximum of the other, times both n.
            let gap = |low: Gate, high: Gate, add: i64| {
                let (low, high) = (low.shifted(add), high.shifted(add));
                low.low * high.n - high.high * low.n
            };
            let pairs = [(first, second), (second, first)];
            let Some((low, high)) = pairs.into_iter().find(|(low, high)| gap(*low, *high, 0) > 0) else {
                continue;
            };
            if low.n == high.n {
                continue;
            }
            let toward = |adds: i64| if probe.slope > 0 { adds } else { -adds };
            assert!(
                gap(low, high, toward(probe.ahead)) <= 0,
                "{first:?} {second:?}: {} is too few",
                probe.ahead
            );
            assert!(
                gap(low, high, toward(probe.ahead - 1)) > 0,
                "{first:?} {second:?}: {} is too many",
                probe.ahead
            );
            seen += 1;
        }
        assert!(seen > 5000, "{seen}");
    }

    #[test]
    fn finds_a_fit_exactly_if_an_exhaustive_search_does() {
        let mut noise = Xoshiro256StarStar::seed_from_u64(1);
        let mut draw = |from: i64, to: i64| from + (noise.next_u64() % (to - from + 1) as u64) as i64;
        let (mut passed, mut refused) = (0, 0);
        for _ in 0..20_000 {
            let (interval, add) = (draw(20, 60), draw(-3, 3));
            let (count, width, off) = (draw(1, 8), draw(0, 9), draw(0, 12));
            let gates: Vec<Gate> = (1..=count)
                .map(|n| {
                    let middle = n * interval + n * (n - 1) / 2 * add + draw(-off, off);
                    Gate { n, low: middle - width / 2, high: middle + width - width / 2 }
                })
                .collect();
            let adds = (-12, 12);
            let expected = all(&gates, adds);
            let guess = draw(-20, 20);
            for goal in [Goal::Any, Goal::Roomy] {
                let found = fit(&gates, adds, guess, goal);
                match found {
                    Some(found) => assert!(expected.contains(&found), "{gates:?}: {found:?}"),
                    None => assert!(expected.is_empty(), "{gates:?}: {expected:?}"),
                }
            }
            passed += usize::from(!expected.is_empty());
            refused += usize::from(expected.is_empty());
        }
        assert!(passed > 4000 && refused > 4000, "{passed} {refused}");
    }
}
