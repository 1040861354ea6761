//! Acceleration of steps without a plan, over eight steps: between single steps rounding to cycles dominates.

use stepscope_peripheral::trace::Step;

pub(crate) const HALF: usize = 8;

/// Signed, in steps/s^2, at a step; `None` unless eight steps on both sides have one direction and take time.
pub(crate) fn of(steps: &[Step], middle: usize, hz: f64) -> Option<f64> {
    let [from, at, to] =
        [middle.checked_sub(HALF)?, middle, middle.checked_add(HALF)?].map(|index| steps.get(index));
    let (from, at, to) = (from?, at?, to?);
    let travel = to.position.wrapping_sub(from.position);
    if travel.unsigned_abs() as usize != 2 * HALF || from.cycle == at.cycle || at.cycle == to.cycle {
        return None;
    }
    let [first_s, second_s] = [(from, at), (at, to)].map(|(a, b)| (b.cycle - a.cycle) as f64 / hz);
    let change = HALF as f64 / second_s - HALF as f64 / first_s;
    Some(libm::copysign(1.0, f64::from(travel)) * change / ((first_s + second_s) / 2.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn eight_steps_on_both_sides_give_the_acceleration() {
        // 8 steps at 100 steps/s, then 8 at 200 steps/s, in cycles of 1 ms.
        let at = |k: i32| if k <= 8 { 10 * k } else { 40 + 5 * k };
        let steps: Vec<Step> = (0..17).map(|k| Step { cycle: at(k) as u64, position: k }).collect();
        assert!((of(&steps, 8, 1000.0).unwrap() - 100.0 / 0.06).abs() < 1e-9);
        assert_eq!(of(&steps, 7, 1000.0), None);
    }
}
