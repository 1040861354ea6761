//! The time window of a spectrum: whole periods, or a whole motion.
//!
//! The pulses of a move are in the ticks from its start to its end, so some are outside of the window; these are moved by
//! whole periods. In a tick of two moves, the pulses of the earlier move come first, and opposite steps cancel. With
//! segments every step has its own time, so nothing cancels.

use crate::motion::actual_motion::Pulses;
use alloc::vec::Vec;
use stepscope_motion::{AxisPlan, PlannedMove, step_tables::TickClock};
use stepscope_peripheral::trace::Step;

const MAX_POINTS: usize = 1 << 20;
/// Maximum relative difference of recorded periods.
const MAX_UNEVENNESS: f64 = 0.01;

/// A time window, in s since the start of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnalysisWindow {
    pub start_s: f64,
    pub period_s: f64,
    pub periods: u32,
    /// Whether the motion repeats; otherwise all of it counts as one period.
    pub periodic: bool,
}

impl AnalysisWindow {
    /// All periods of the first periodic move, or the whole motion; `None` if it takes no time.
    pub fn of(plan: &AxisPlan) -> Option<Self> {
        let repeating = plan
            .moves()
            .iter()
            .find_map(|planned| planned.profile.repeats().map(|repeats| (planned.start_s, repeats)));
        let window = match repeating {
            Some((start_s, (period_s, periods))) => Self { start_s, period_s, periods, periodic: true },
            None => Self { start_s: 0.0, period_s: plan.duration_s(), periods: 1, periodic: false },
        };
        (window.period_s > 0.0).then_some(window)
    }

    /// For steps without a plan: whole periods between reversals of an even oscillation, or all steps.
    pub fn of_steps(steps: &[Step], hz: f64) -> Option<Self> {
        let seconds = |cycles: u64| cycles as f64 / hz;
        let (first, last) = (steps.first()?.cycle, steps.last()?.cycle);
        let all =
            Self { start_s: seconds(first), period_s: seconds(last - first), periods: 1, periodic: false };
        let reversals: Vec<u64> = (1..steps.len())
            .filter(|index| Step::direction(steps, *index) != Step::direction(steps, index - 1))
            .filter_map(|index| steps.get(index).map(|step| step.cycle))
            .collect();
        let periods = reversals.len().saturating_sub(1) / 2;
        let repeating =
            reversals.first().zip(reversals.get(2 * periods)).filter(|_| periods > 0).map(|(from, to)| {
                let start_s = seconds(*from);
                Self {
                    start_s,
                    period_s: seconds(to - from) / periods as f64,
                    periods: periods as u32,
                    periodic: true,
                }
            });
        // In an even oscillation each reversal is one period after the last but one.
        let even = |window: &Self| {
            let pairs = reversals.iter().zip(reversals.iter().skip(2));
            pairs
                .map(|(from, to)| seconds(to - from))
                .all(|period_s| libm::fabs(period_s - window.period_s) <= MAX_UNEVENNESS * window.period_s)
        };
        Some(repeating.filter(even).unwrap_or(all)).filter(|window| window.period_s > 0.0)
    }

    /// Steps within the window, as (time in s, +1 right or -1 left).
    pub fn steps_within(&self, steps: &[Step], hz: f64) -> Vec<(f64, i8)> {
        // Half a cycle, because the period is rounded: no step is added or lost.
        let end_s = self.start_s + self.length_s() - if self.periodic { 0.5 / hz } else { -0.5 / hz };
        let pulse = |(index, step): (usize, &Step)| {
            (step.cycle as f64 / hz, Step::direction(steps, index).signum() as i8)
        };
        let is_inside = |(time_s, _): &(f64, i8)| (self.start_s - 0.5 / hz..end_s).contains(time_s);
        steps.iter().enumerate().map(pulse).filter(is_inside).collect()
    }

    pub fn length_s(&self) -> f64 {
        self.period_s * f64::from(self.periods)
    }

    pub fn fundamental_hz(&self) -> f64 {
        1.0 / self.period_s
    }

    /// Pulses of the moves within the window, as (time in s, +1 right or -1 left).
    pub fn pulses_of(&self, plan: &AxisPlan, run: &Pulses<'_>) -> Vec<(f64, i8)> {
        let zero = run.zero();
        let pulse = |(index, step): (usize, &Step)| {
            let direction = Step::direction(run.steps, index).signum() as i8;
            Some((step.cycle.checked_sub(zero)?, direction))
        };
        let pulses: Vec<(u64, i8)> = run.steps.iter().enumerate().filter_map(pulse).collect();
        let Some(tick) = run.tick() else {
            let hz = run.hz();
            let steps = self.steps_of_moves(plan, &pulses).iter();
            return steps.map(|&(cycle, direction)| (cycle as f64 / hz, direction)).collect();
        };
        self.pulses_of_moves(plan, TickClock::new(tick.0, run.clock_hz()), &pulses)
    }

    fn steps_of_moves<'p>(&self, plan: &AxisPlan, pulses: &'p [(u64, i8)]) -> &'p [(u64, i8)] {
        // The middle of a move is not affected by rounding at its ends.
        let middle_s = |planned: &PlannedMove| planned.start_s + planned.profile.duration_s() / 2.0;
        let steps_before = |time_s: f64| {
            let before = plan.moves().iter().take_while(|planned| middle_s(planned) < time_s);
            let steps: u64 = before.map(|planned| planned.profile.step_count()).sum();
            usize::try_from(steps).map_or(pulses.len(), |steps| steps.min(pulses.len()))
        };
        let inside = steps_before(self.start_s)..steps_before(self.start_s + self.length_s());
        pulses.get(inside).unwrap_or_default()
    }

    /// Pulses of moves within the window, as (time in s, +1 right or -1 left). `pulses` are all pulses of the axis by
    /// cycle since its first tick.
    pub fn pulses_of_moves(&self, plan: &AxisPlan, ticks: TickClock, pulses: &[(u64, i8)]) -> Vec<(f64, i8)> {
        let end_s = self.start_s + self.length_s();
        let (first, last) = (ticks.ticks_until(self.start_s) - 1, ticks.ticks_until(end_s) - 1);
        let (begin, end) = (plan.steps_due(self.start_s), plan.steps_due(end_s));
        let due_by_end = |tick: u64| ticks.due_by_end(plan, tick);
        let index_at = |tick: u64| pulses.partition_point(|(cycle, _)| cycle / ticks.tick_cycles() < tick);
        let within = |from: u64, to: u64| pulses.get(index_at(from)..index_at(to)).unwrap_or_default();
        let in_direction =
            |direction: i64| move |pulse: &&(u64, i8)| i64::from(pulse.1) == direction.signum();
        let mut found: Vec<&(u64, i8)> = Vec::new();
        if first == last {
            found.extend(within(first, first + 1));
        } else {
            let due = due_by_end(first) - begin;
            found.extend(
                within(first, first + 1)
                    .iter()
                    .rev()
                    .filter(in_direction(due))
                    .take(due.unsigned_abs() as usize),
            );
            found.extend(within(first + 1, last));
            let due = end - due_by_end(last - 1);
            found.extend(
                within(last, last + 1).iter().filter(in_direction(due)).take(due.unsigned_abs() as usize),
            );
        }
        found.into_iter().map(|&(cycle, direction)| (ticks.seconds(cycle), direction)).collect()
    }
}

/// The ideal position at equal time steps of the window, less the straight line from its start to its end.
pub(crate) fn sampled(plan: &AxisPlan, window: &AnalysisWindow, points: usize) -> Vec<f64> {
    let points = points.clamp(16, MAX_POINTS);
    let at = |part: f64| plan.position(window.start_s + window.length_s() * part);
    let first = at(0.0);
    let direction = if window.periodic { 0.0 } else { at(1.0) - first };
    (0..points)
        .map(|i| {
            let part = i as f64 / points as f64;
            at(part) - first - direction * part
        })
        .collect()
}
