//! The window of time that a spectrum is taken of: whole periods, or a whole motion.
//!
//! ```text
//!        start_s    period_s        all whole periods of the sine: no window, no leakage
//! _______|/\/\/\/\/\/\/\/\|______
//!    |    '     '     '    |         ticks; a pulse comes somewhere in the tick that orders it
//! ```
//!
//! The pulses that a move makes begin with the tick in which it starts and end with the tick in
//! which it ends, so some come before the window and some after; taken on into the next period
//! (whole periods later or earlier) they are the motion that repeats for ever. In a tick that two
//! moves share the pulses of the move before come first: of the tick of its start a move has the
//! last ones, of the tick of its end the first ones, as many as it asks for there. Where the two
//! go opposite ways in such a tick, only the difference is made, and what cancels is no one's.
//!
//! Segments make every step in its own cycle, in the order of the moves, and nothing cancels: a move's
//! pulses are as many as it has steps, after those of the moves before it.

use crate::motion::actual_motion::Pulses;
use alloc::vec::Vec;
use stepscope_motion::{AxisPlan, Curve, PlannedMove, quantise::TickClock};
use stepscope_peripheral::trace::Step;

/// Longest transform.
const MAX_POINTS: usize = 1 << 20;
/// By what part of a period recorded ones may differ.
const UNEVEN: f64 = 0.01;

/// The window of time that a spectrum is taken of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnalysisWindow {
    /// Its start in s.
    pub start_s: f64,
    /// Time of one period in s, above 0.
    pub period_s: f64,
    /// How many whole periods, at least 1.
    pub periods: u32,
    /// Whether the motion repeats; otherwise the whole of it stands as one period.
    pub periodic: bool,
}

impl AnalysisWindow {
    /// All periods of the first periodic move, or, where none is, the whole motion; `None` for a
    /// motion that takes no time.
    #[must_use]
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

    /// Of steps of which no plan is known: whole periods, where they go to and fro evenly, from the first turn on; else
    /// from the first step to the last. `None` where that takes no time.
    #[must_use]
    pub fn of_steps(steps: &[Step], hz: f64) -> Option<Self> {
        let seconds = |cycles: u64| cycles as f64 / hz;
        let (first, last) = (steps.first()?.cycle, steps.last()?.cycle);
        let whole =
            Self { start_s: seconds(first), period_s: seconds(last - first), periods: 1, periodic: false };
        let turns: Vec<u64> = (1..steps.len())
            .filter(|index| Step::direction(steps, *index) != Step::direction(steps, index - 1))
            .filter_map(|index| steps.get(index).map(|step| step.cycle))
            .collect();
        let periods = turns.len().saturating_sub(1) / 2;
        let repeating =
            turns.first().zip(turns.get(2 * periods)).filter(|_| periods > 0).map(|(from, to)| {
                let start_s = seconds(*from);
                Self {
                    start_s,
                    period_s: seconds(to - from) / periods as f64,
                    periods: periods as u32,
                    periodic: true,
                }
            });
        // Every turn is a period after the one before the last.
        let even = |window: &Self| {
            let pairs = turns.iter().zip(turns.iter().skip(2));
            pairs
                .map(|(from, to)| seconds(to - from))
                .all(|period_s| libm::fabs(period_s - window.period_s) <= UNEVEN * window.period_s)
        };
        Some(repeating.filter(even).unwrap_or(whole)).filter(|window| window.period_s > 0.0)
    }

    /// Of such steps those within the window, as (time in s, +1 right or -1 left).
    #[must_use]
    pub fn steps_within(&self, steps: &[Step], hz: f64) -> Vec<(f64, i8)> {
        // To half a cycle: sums of rounded periods do not take a step more, or less.
        let end_s = self.start_s + self.length_s() - if self.periodic { 0.5 / hz } else { -0.5 / hz };
        let pulse = |(index, step): (usize, &Step)| {
            (step.cycle as f64 / hz, Step::direction(steps, index).signum() as i8)
        };
        let own = |(time_s, _): &(f64, i8)| (self.start_s - 0.5 / hz..end_s).contains(time_s);
        steps.iter().enumerate().map(pulse).filter(own).collect()
    }

    /// Its length in s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.period_s * f64::from(self.periods)
    }

    /// The frequency of harmonic 1 in Hz.
    #[must_use]
    pub fn fundamental_hz(&self) -> f64 {
        1.0 / self.period_s
    }

    /// The pulses of a run that belong to the window, as (time in s, +1 right or -1 left): of a run by
    /// ticks as [`Self::own_pulses`] tells them, of others those of the steps of its moves, one by one.
    #[must_use]
    pub fn pulses_of(&self, plan: &AxisPlan, run: &Pulses<'_>) -> Vec<(f64, i8)> {
        let zero = run.zero();
        let pulse = |(index, step): (usize, &Step)| {
            let way = Step::direction(run.steps, index).signum() as i8;
            Some((step.cycle.checked_sub(zero)?, way))
        };
        let pulses: Vec<(u64, i8)> = run.steps.iter().enumerate().filter_map(pulse).collect();
        let Some(tick) = run.tick() else {
            let hz = run.hz();
            let own = self.own_steps(plan, &pulses).iter();
            return own.map(|&(cycle, way)| (cycle as f64 / hz, way)).collect();
        };
        self.own_pulses(plan, TickClock::new(tick.0, run.clock_hz()), &pulses)
    }

    /// Of pulses that are the steps of `plan`, one by one, those of the moves within the window.
    fn own_steps<'p>(&self, plan: &AxisPlan, pulses: &'p [(u64, i8)]) -> &'p [(u64, i8)] {
        // A move's middle, which no rounding of its ends takes into another.
        let middle_s = |planned: &PlannedMove| planned.start_s + planned.profile.duration_s() / 2.0;
        let steps_before = |time_s: f64| {
            let before = plan.moves().iter().take_while(|planned| middle_s(planned) < time_s);
            let steps: u64 = before.map(|planned| planned.profile.step_count()).sum();
            // A run that is cut short has fewer.
            usize::try_from(steps).map_or(pulses.len(), |steps| steps.min(pulses.len()))
        };
        let own = steps_before(self.start_s)..steps_before(self.start_s + self.length_s());
        pulses.get(own).unwrap_or_default()
    }

    /// The pulses that belong to the window, see the module, as (time in s, +1 right or -1 left).
    ///
    /// `pulses` are all that the axis of `plan` makes, as (cycle from the start of its first tick
    /// on, +1 right or -1 left), rising in time.
    #[must_use]
    pub fn own_pulses(&self, plan: &AxisPlan, ticks: TickClock, pulses: &[(u64, i8)]) -> Vec<(f64, i8)> {
        let end_s = self.start_s + self.length_s();
        let (first, last) = (ticks.ticks_until(self.start_s) - 1, ticks.ticks_until(end_s) - 1);
        let (begin, end) = (plan.steps_due(self.start_s), plan.steps_due(end_s));
        let due_by_end = |tick: u64| ticks.due_by_end(plan, tick);
        let place = |tick: u64| pulses.partition_point(|(cycle, _)| cycle / ticks.tick_cycles() < tick);
        let within = |from: u64, to: u64| pulses.get(place(from)..place(to)).unwrap_or_default();
        let going = |way: i64| move |pulse: &&(u64, i8)| i64::from(pulse.1) == way.signum();
        let mut own: Vec<&(u64, i8)> = Vec::new();
        if first == last {
            // Shorter than a tick: the tick's pulses are taken for the window's.
            own.extend(within(first, first + 1));
        } else {
            let asked = due_by_end(first) - begin;
            own.extend(
                within(first, first + 1)
                    .iter()
                    .rev()
                    .filter(going(asked))
                    .take(asked.unsigned_abs() as usize),
            );
            own.extend(within(first + 1, last));
            let asked = end - due_by_end(last - 1);
            own.extend(
                within(last, last + 1).iter().filter(going(asked)).take(asked.unsigned_abs() as usize),
            );
        }
        own.into_iter().map(|&(cycle, way)| (ticks.seconds(cycle), way)).collect()
    }
}

/// The ideal position over the window less its straight line, at equal steps of time.
pub(crate) fn sampled(plan: &AxisPlan, window: &AnalysisWindow, points: usize) -> Vec<f64> {
    let points = points.clamp(16, MAX_POINTS);
    let at = |part: f64| plan.position(window.start_s + window.length_s() * part);
    let first = at(0.0);
    let way = if window.periodic { 0.0 } else { at(1.0) - first };
    (0..points)
        .map(|i| {
            let part = i as f64 / points as f64;
            at(part) - first - way * part
        })
        .collect()
}
