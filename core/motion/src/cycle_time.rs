//! Times in cycles, with the digits that decide a rounding however late they are (DESIGN B1): whole cycles, and a part of
//! one in 106 bits.
//!
//! A number alone loses a bit of the part each time the whole doubles; at 10^12 cycles the part has 14 bits left.
use crate::{double::Double, exact::Exact, trapezoid_table::TrapezoidTable};

/// What 106 bits do not tell from a tie, in parts of a time: 2^-94.
const TIE: f64 = f64::EPSILON * f64::EPSILON * 1024.0;

/// What 106 bits do not tell from a tie, of a time in cycles.
pub(super) fn tie(cycle: u64) -> Double {
    ((cycle as f64 + 1.0) * TIE).into()
}

/// Whole cycles and a part of one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CycleTime {
    pub(super) whole: u64,
    /// 0 to below 1.
    pub(super) part: Double,
}

impl CycleTime {
    /// A time from 0 on.
    pub(super) fn of(cycles: Double) -> Self {
        // Two numbers whose sum it is, each with its own whole cycles; the second may be negative.
        let mut whole = cycles.high as u64;
        let mut part = Double::sum(cycles.high - whole as f64, cycles.low);
        if part.high < 0.0 && whole > 0 {
            (whole, part) = (whole - 1, part + 1.0.into());
        }
        Self { whole, part }
    }

    /// A quotient, from 0 on, in cycles.
    pub(super) fn exact(cycles: &Exact) -> Self {
        let (whole, part) = cycles.whole_and_part();
        Self::default().plus(Self { whole, part })
    }

    pub(super) fn plus(self, other: Self) -> Self {
        let (whole, part) = (self.whole.saturating_add(other.whole), self.part + other.part);
        let past = part - 1.0.into();
        if past.high < 0.0 {
            Self { whole, part }
        } else {
            Self { whole: whole.saturating_add(1), part: past }
        }
    }

    /// Whether it is not after a cycle; what is later by no more than a tie is not.
    pub(super) fn is_by(self, cycle: u64) -> bool {
        self.whole < cycle || (self.whole == cycle && !self.part.exceeds(tie(cycle)))
    }

    /// Whether it is that cycle, but for a tie.
    pub(super) fn is_at(self, cycle: u64) -> bool {
        let short = Double::from(1.0) - self.part;
        self.is_by(cycle) && (self.whole == cycle || (self.whole + 1 == cycle && !short.exceeds(tie(cycle))))
    }

    /// All of it in 106 bits.
    pub(super) fn double(self) -> Double {
        Double::from(self.whole) + self.part
    }

    /// As a number.
    pub(super) fn cycles(self) -> f64 {
        self.whole as f64 + self.part.high
    }
}

/// A time in cycles that is a quotient of whole numbers: whole cycles, and the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Quotient {
    pub(super) whole: u64,
    /// Invariant: below `under`.
    pub(super) rest: u64,
    /// Invariant: below [`MAX_UNDER`].
    pub(super) under: u64,
}

impl Quotient {
    /// The part of a cycle.
    #[inline]
    pub(super) fn part(self) -> f64 {
        // As signed numbers, which targets convert in one instruction.
        self.rest as i64 as f64 / self.under as i64 as f64
    }

    /// With all its digits.
    pub(super) fn time(self) -> CycleTime {
        CycleTime { whole: self.whole, part: Double::from(self.rest) / Double::from(self.under) }
    }
}

/// Quotients in their order, all over one number.
pub(super) trait Quotients {
    /// What they are over.
    fn under(&self) -> u64;
    /// Writes the whole cycles and the rests of the next ones from the beginning on of two blocks, which are equally long, of an
    /// even length; and says of how many: none at the end.
    fn next_block(&mut self, wholes: &mut [u64], rests: &mut [u64]) -> usize;
}

/// Steps of one rate: step k is due after (2k - 1)/2 of its intervals, a quotient of whole numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct EvenSteps {
    /// Half an interval in cycles is `over/under`.
    over: u128,
    /// Invariant: below [`MAX_UNDER`].
    under: u64,
}

/// Sums of two rests stay in 64 bits below this.
const MAX_UNDER: u64 = 1 << 62;

impl EvenSteps {
    /// Of a rate in steps/s as it is printed; `None` where the numbers of `count` steps are too long.
    pub(super) fn new(steps_s: f64, clock_hz: u32, count: u64) -> Option<Self> {
        let (digits, exponent) = Exact::decimal(steps_s);
        let ten = 10_u128.checked_pow(exponent.unsigned_abs())?;
        let digits = u128::from(digits.unsigned_abs()).checked_mul(2)?;
        let (over, under) = if exponent < 0 {
            (ten.checked_mul(clock_hz.into())?, digits)
        } else {
            (clock_hz.into(), digits.checked_mul(ten)?)
        };
        let common = common_divisor(over, under);
        let (over, under) = (over.checked_div(common)?, u64::try_from(under.checked_div(common)?).ok()?);
        let last = over.checked_mul(2 * u128::from(count) + 1)?.checked_div(under.into())?;
        over.checked_mul(TWO)?;
        (under < MAX_UNDER && last < u64::MAX.into()).then_some(Self { over, under })
    }

    /// When step `k` (from 1) is due.
    pub(super) fn step(self, k: u64) -> Quotient {
        let (whole, rest) = self.divided(self.over * (2 * u128::from(k) - 1));
        Quotient { whole, rest, under: self.under }
    }

    fn divided(self, over: u128) -> (u64, u64) {
        let under = u128::from(self.under);
        ((over / under) as u64, (over % under) as u64)
    }

    /// When each of `count` steps is due, without a division for each.
    pub(super) fn steps(self, count: u64) -> EvenRun {
        let lanes = [1, 3].map(|halves| Lane::of(self.divided(self.over * halves)));
        EvenRun { under: self.under, lanes, add: Lane::of(self.divided(self.over * TWO)), left: count }
    }
}

/// Half intervals of two steps.
const TWO: u128 = 4;

/// Whole cycles and a rest; numbers with a sign, so that what is past is told by an arithmetic shift alone.
#[derive(Clone, Copy, Debug)]
struct Lane {
    whole: i64,
    rest: i64,
}

impl Lane {
    fn of((whole, rest): (u64, u64)) -> Self {
        Self { whole: whole as i64, rest: rest as i64 }
    }

    #[inline]
    fn plus(self, add: Self, under: i64) -> Self {
        let past = self.rest + add.rest - under;
        // -1 where the rests make no whole cycle.
        let none = past >> 63;
        let whole = self.whole.wrapping_add(add.whole).wrapping_add(1 + none);
        Self { whole, rest: past + (under & none) }
    }
}

/// Steps of one rate in their order: two at a time, of which neither waits for the other.
pub(super) struct EvenRun {
    under: u64,
    /// The next two.
    lanes: [Lane; 2],
    /// What two intervals add to them.
    add: Lane,
    /// Steps to come.
    left: u64,
}

impl Quotients for EvenRun {
    fn under(&self) -> u64 {
        self.under
    }

    fn next_block(&mut self, wholes: &mut [u64], rests: &mut [u64]) -> usize {
        debug_assert!(wholes.len() == rests.len() && wholes.len().is_multiple_of(2), "two at a time");
        let len = usize::try_from(self.left).map_or(wholes.len(), |left| left.min(wholes.len()));
        // Beyond the last step nobody reads them.
        let formed = len.next_multiple_of(2);
        let blocks = [wholes, rests].map(|block| block.get_mut(..formed).unwrap_or_default());
        self.lanes = evenly(self.lanes, self.add, self.under, blocks);
        self.left -= len as u64;
        len
    }
}

/// Writes quotients of which the first two are given and each is `add` after the next but one before it; says which two come
/// next.
#[inline]
fn evenly(mut lanes: [Lane; 2], add: Lane, under: u64, [wholes, rests]: [&mut [u64]; 2]) -> [Lane; 2] {
    let under = under as i64;
    for (wholes, rests) in wholes.chunks_exact_mut(2).zip(rests.chunks_exact_mut(2)) {
        for (lane, (whole, rest)) in lanes.iter_mut().zip(wholes.iter_mut().zip(rests)) {
            (*whole, *rest) = (lane.whole as u64, lane.rest as u64);
            *lane = lane.plus(add, under);
        }
    }
    lanes
}

fn common_divisor(mut a: u128, mut b: u128) -> u128 {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl TrapezoidTable {
    /// Time of step `k` (from 1; 0 is the start, from the last step on the end) in cycles of a clock of `clock_hz`.
    pub(super) fn step_time(&self, k: u64, clock_hz: u32) -> Quotient {
        let timer_hz = self.table().timer_hz().max(1);
        let product = u128::from(self.step_ticks(k)) * u128::from(clock_hz);
        let (whole, rest) = (product / u128::from(timer_hz), product % u128::from(timer_hz));
        Quotient { whole: whole as u64, rest: rest as u64, under: timer_hz.into() }
    }

    /// When each step is due in cycles of a clock of `clock_hz`, without a division for each: rows of one reload add the same.
    pub(super) fn step_quotients(&self, clock_hz: u32) -> TableRun<'_> {
        let under = u64::from(self.table().timer_hz().max(1));
        TableRun { table: self, clock_hz, under, past: 0, time: (0, 0), last: (0, (0, 0)) }
    }
}

/// The steps of a table in their order.
pub(super) struct TableRun<'t> {
    table: &'t TrapezoidTable,
    clock_hz: u32,
    under: u64,
    /// Steps that are past, and the whole cycles and rest of the last of them.
    past: u64,
    time: (u64, u64),
    /// The last reload, and what it adds.
    last: (u64, (u64, u64)),
}

impl TableRun<'_> {
    /// The cycles that a reload lasts, and the rest.
    #[inline]
    fn cycles(&self, reload: u64) -> (u64, u64) {
        // A part of the timer's rate, which has 32 bits as the clock's has.
        debug_assert!(reload <= u32::MAX.into(), "a reload of {reload}");
        let product = reload.wrapping_mul(self.clock_hz.into());
        (product / self.under, product % self.under)
    }

    /// The next ones, each by the reload of its own interval.
    fn by_reloads(&mut self, wholes: &mut [u64], rests: &mut [u64]) -> usize {
        // The reloads come first: a loop that asks nothing keeps its numbers in registers.
        let len = self.table.reloads(self.past, wholes);
        let (mut last, (mut whole, mut rest)) = (self.last, self.time);
        for (place, rest_place) in wholes.iter_mut().zip(rests).take(len) {
            if *place != last.0 {
                last = (*place, self.cycles(*place));
            }
            let (add, add_rest) = last.1;
            let sum = rest + add_rest;
            let is_past = sum >= self.under;
            rest = sum - if is_past { self.under } else { 0 };
            whole = whole.wrapping_add(add).wrapping_add(is_past.into());
            (*place, *rest_place) = (whole, rest);
        }
        self.last = last;
        len
    }
}

impl Quotients for TableRun<'_> {
    fn under(&self) -> u64 {
        self.under
    }

    fn next_block(&mut self, wholes: &mut [u64], rests: &mut [u64]) -> usize {
        let len = match self.table.one_reload(self.past, wholes.len()) {
            Some(reload) => {
                let (each, under) = (Lane::of(self.cycles(reload)), self.under as i64);
                let first = Lane::of(self.time).plus(each, under);
                let next = [first, first.plus(each, under)];
                evenly(next, each.plus(each, under), self.under, [&mut *wholes, rests]);
                wholes.len()
            }
            None => self.by_reloads(wholes, rests),
        };
        if let (Some(&whole), Some(&rest)) = (wholes.get(len.wrapping_sub(1)), rests.get(len.wrapping_sub(1)))
        {
            self.time = (whole, rest);
        }
        self.past += len as u64;
        len
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Profile,
        mechanics::{Acceleration, Distance, Speed},
        moves::{Axis, Move, Trapezoid, TrapezoidMethod},
        plan_axis,
    };
    use alloc::{vec, vec::Vec};

    /// All of them, some at a time.
    fn all(mut quotients: impl Quotients) -> Vec<Quotient> {
        let (mut found, mut wholes, mut rests) = (Vec::new(), [0; 8], [0; 8]);
        loop {
            let len = quotients.next_block(&mut wholes, &mut rests);
            if len == 0 {
                return found;
            }
            let under = quotients.under();
            let block = wholes.iter().zip(&rests).take(len);
            found.extend(block.map(|(&whole, &rest)| Quotient { whole, rest, under }));
        }
    }

    #[test]
    fn even_steps_are_quotients_of_whole_numbers() {
        // Digits that both sides share are none of theirs.
        let even = EvenSteps::new(3e22, 1_000_000_000, 3).expect("they are short");
        assert_eq!((even.over, even.under), (1, 60_000_000_000_000));
        // 3 steps/s of a clock of 10 Hz: half an interval is 5/3 cycles.
        let even = EvenSteps::new(3.0, 10, 100).expect("they are short");
        let times = all(even.steps(100));
        assert_eq!(times.len(), 100);
        for (k, time) in (1..).zip(times) {
            assert_eq!(time, even.step(k));
            let halves = 5 * (2 * k - 1);
            assert_eq!((time.whole, time.part()), (halves / 3, (halves % 3) as f64 / 3.0), "step {k}");
        }
        // Ties: of 0.8 steps/s every step stands at a half.
        let even = EvenSteps::new(0.8, 2, 10).expect("they are short");
        assert!(
            all(even.steps(10)).iter().all(|time| time.part() == 0.25 || time.part() == 0.75),
            "1.25 cycles, and 2.5 further"
        );
        let even = EvenSteps::new(1e7 / 3.0, 1_000_000_000, 1_000_000_000).expect("they are short");
        // The number that is printed, 3333333.3333333335, is a little more than the third.
        let last = even.step(1_000_000_000);
        assert!(last.whole == 299_999_999_849 && last.part() > 0.999, "{last:?}");
    }

    #[test]
    fn parts_add_up_to_whole_cycles() {
        let half = Double::from(0.5);
        let time = CycleTime::of(3.75.into()).plus(CycleTime { whole: 1 << 60, part: half });
        assert_eq!(time, CycleTime { whole: (1 << 60) + 4, part: 0.25.into() });
        // The nearest f64 is 4, and the sum below it.
        let below = CycleTime::of(Double { high: 4.0, low: -1e-20 });
        assert!(below.whole == 3 && below.part == Double { high: 1.0, low: -1e-20 }, "{below:?}");
        // A hair before 0 by rounding is in no cycle before it.
        assert_eq!(CycleTime::of(Double { high: 0.0, low: -1e-30 }).whole, 0);
        assert_eq!(CycleTime::exact(&Exact::of(7.0).divided_by(2.0)), CycleTime { whole: 3, part: half });
    }

    #[test]
    fn a_tables_steps_one_after_another_are_those_that_are_asked_for_each() {
        for (steps, timer_hz, clock_hz) in [
            (1_i32, 1, 1),
            (37, 1_000_000, 16_000_000),
            (-500, 4_294_967_295, 999_999_937),
            (300, 7, 1_000_000_000),
        ] {
            let moved = Trapezoid {
                distance: Distance::Steps(f64::from(steps)),
                start_speed: Speed::StepsPerSecond(0.5),
                top_speed: Speed::StepsPerSecond(3.0),
                acceleration: Acceleration::StepsPerSecond2(0.25),
                method: TrapezoidMethod::Table,
                timer_hz,
            };
            let axis = Axis { moves: vec![Move::Trapezoid(moved)], ..Axis::default() };
            let plan = plan_axis(&axis, "x").expect("it can be planned");
            let Profile::TrapezoidTable(table) = &plan.moves()[0].profile else { panic!("no table") };
            let mut count = 0;
            for (k, quotient) in (1..).zip(all(table.step_quotients(clock_hz))) {
                assert_eq!(quotient, table.step_time(k, clock_hz), "step {k} of {steps}");
                count = k;
            }
            assert_eq!(count, u64::from(steps.unsigned_abs()));
        }
    }
}
