//! Remedies for a motion that is too fast for its bus. Each one is validated before it is offered.

use alloc::string::{String, ToString};
use alloc::{format, vec::Vec};
use serde::Serialize;
use stepscope_motion::moves::{Axis, Move};
use stepscope_motion::{plan_axis, problem};
use stepscope_scenario::{Cause, MotionEngine, Scenario, Source};
use stepscope_sim::{ValidatedScenario, axes_of, bus_of};

/// Times are rounded up to multiples of this, in s.
const TIME_STEP_S: f64 = 1e-4;

/// The problem, and changes that solve it.
#[derive(Clone, Debug, Serialize)]
pub struct Remedies {
    pub wrong: String,
    pub offers: Vec<Offer>,
}

/// A change, and the changed scenario as JSON.
#[derive(Clone, Debug, Serialize)]
pub struct Offer {
    pub change: String,
    pub scenario: String,
}

impl Remedies {
    /// `None` if no motion is too fast for its bus.
    pub fn of(validated: &ValidatedScenario) -> Option<Self> {
        let is_too_fast = |cause: &Cause| matches!(cause, Cause::Motion(problem::Cause::TooManySteps { .. }));
        if !validated.problems().iter().any(|problem| is_too_fast(&problem.cause)) {
            return None;
        }
        let scenario = &**validated.scenario();
        let controllers = (0..=scenario.controllers.len()).map(|index| Rates::of(scenario, index));
        let slow: Vec<Rates> = controllers.filter(|rates| rates.needed > rates.limit).collect();
        let worst = slow
            .iter()
            .copied()
            .reduce(|a, b| if a.needed * b.limit >= b.needed * a.limit { a } else { b })?;
        let changes = [shorter_slots(scenario, &slow), longer_times(scenario, &slow), segments(scenario)];
        let offers = changes.into_iter().flatten().filter_map(|(change, scenario)| {
            let text = scenario.to_json();
            ValidatedScenario::from(scenario)
                .problems()
                .is_empty()
                .then_some(Offer { change, scenario: text })
        });
        let Rates { needed, limit, .. } = worst;
        let wrong = format!(
            "The motion needs up to {} steps/s; the bus allows {}.",
            libm::ceil(needed),
            libm::floor(limit)
        );
        Some(Self { wrong, offers: offers.collect() })
    }
}

/// Steps/s that a motion needs, and those that its bus allows.
#[derive(Clone, Copy)]
struct Rates {
    controller: usize,
    needed: f64,
    limit: f64,
}

impl Rates {
    fn of(scenario: &Scenario, controller: usize) -> Self {
        let peak = |axis: &Axis| plan_axis(axis, "axis").map_or(0.0, |plan| plan.peaks().speed);
        let needed = axes_of(scenario, controller).iter().map(peak).fold(0.0, libm::fmax);
        let bus = bus_of(scenario, controller).unwrap_or(&scenario.bus);
        let limit = f64::from(scenario.clock_hz) / f64::from(bus.step_period_cycles.max(1));
        Self { controller, needed, limit }
    }
}

type Change = Option<(String, Scenario)>;

/// Shortens the slots of all controllers to one step at the maximum rate, so that equal ticks stay equal.
fn shorter_slots(scenario: &Scenario, slow: &[Rates]) -> Change {
    let needed = slow.iter().map(|rates| rates.needed).fold(1.0, libm::fmax);
    let period = libm::floor(f64::from(scenario.clock_hz) / needed) as u32;
    let mut changed = scenario.clone();
    let additional = changed.controllers.iter_mut().map(|controller| &mut controller.bus);
    for bus in [&mut changed.bus].into_iter().chain(additional) {
        bus.step_period_cycles = bus.step_period_cycles.min(period);
    }
    let scope = if scenario.controllers.is_empty() { "" } else { " on all controllers" };
    Some((format!("set the slot to {period} cycles{scope}"), changed))
}

fn longer_times(scenario: &Scenario, slow: &[Rates]) -> Change {
    let mut changed = scenario.clone();
    let mut texts = Vec::new();
    for rates in slow {
        let axes = match (&mut changed.source, rates.controller.checked_sub(1)) {
            (Source::Motion(motion), None) => &mut motion.axes,
            (Source::Motion(_), Some(index)) => &mut changed.controllers[index].axes,
            _ => return None,
        };
        for axis in axes {
            let mechanics = axis.mechanics.clone();
            for planned in &mut axis.moves {
                let single_move =
                    Axis { mechanics: mechanics.clone(), moves: [planned.clone()].into(), ..Axis::default() };
                let Ok(plan) = plan_axis(&single_move, "axis") else { continue };
                let factor = plan.peaks().speed / rates.limit;
                if factor <= 1.0 {
                    continue;
                }
                let (name, time_s) = match planned {
                    Move::Cosine(cosine) => ("duration", &mut cosine.duration_s),
                    Move::Ramps(ramps) => ("duration", &mut ramps.duration_s),
                    Move::Sine(sine) => ("period", &mut sine.period_s),
                    Move::SineSegments(sine) => ("period", &mut sine.period_s),
                    _ => return None,
                };
                *time_s = libm::ceil(*time_s * factor / TIME_STEP_S) * TIME_STEP_S;
                texts.push(format!("the {name} to {} s", shortest(*time_s)));
            }
        }
    }
    (!texts.is_empty()).then(|| (format!("set {}", texts.join(", ")), changed))
}

/// Formats with up to four decimals, which hides rounding errors.
fn shortest(time_s: f64) -> String {
    format!("{time_s:.4}").trim_end_matches('0').trim_end_matches('.').to_string()
}

/// Segments instead of ticks: no slot limits a step.
fn segments(scenario: &Scenario) -> Change {
    let mut changed = scenario.clone();
    let Source::Motion(motion) = &mut changed.source else { return None };
    motion.engine = MotionEngine::Segments;
    Some(("use a step table (timer interrupt)".to_string(), changed))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn offers(json: &str) -> Vec<String> {
        let found = Remedies::of(&ValidatedScenario::from_json(json));
        found.map_or_else(Vec::new, |found| found.offers.into_iter().map(|offer| offer.change).collect())
    }

    #[test]
    fn each_offer_is_valid() {
        let slow = r#"{"bus":{"step_period_cycles":2000,"slots":10}}"#;
        let expected = [
            "set the slot to 1000 cycles",
            "set the duration to 0.8 s",
            "use a step table (timer interrupt)",
        ];
        assert_eq!(offers(slow), expected);
        let found = Remedies::of(&ValidatedScenario::from_json(slow)).expect("too fast");
        for Offer { change, scenario } in found.offers {
            let again = ValidatedScenario::from_json(&scenario);
            assert!(again.problems().is_empty(), "{change}: {:?}", again.problems());
        }
    }

    #[test]
    fn the_times_of_all_fast_moves_are_named() {
        let fast = r#"{"bus":{"step_period_cycles":16000},"source":{"motion":{"axes":[
            {"moves":[{"cosine":{"distance":{"steps":400},"duration_s":0.4}},{"sine":{"amplitude":{"steps":200}}}]}]}}}"#;
        let period = offers(fast).into_iter().find(|offer| offer.contains("the period to"));
        assert!(period.is_some_and(|offer| offer.starts_with("set the duration to ")), "{:?}", offers(fast));
    }

    #[test]
    fn insufficient_changes_are_not_offered() {
        // A pulse of 1500 cycles does not fit into a slot of 1000.
        let long_pulse = r#"{"bus":{"step_period_cycles":2000,"slots":10,"pulse_width_cycles":1500}}"#;
        assert_eq!(offers(long_pulse), ["set the duration to 0.8 s"]);
        // Segments need a single controller.
        let two = r#"{"bus":{"step_period_cycles":2000,"slots":10},"line":{"address":1},
            "controllers":[{"address":2,"bus":{"step_period_cycles":2000,"slots":10},"axes":[]}],
            "source":{"motion":{"axes":[{"moves":[{"cosine":{}}]}]}}}"#;
        assert_eq!(
            offers(two),
            ["set the slot to 1000 cycles on all controllers", "set the duration to 0.8 s"]
        );
    }

    #[test]
    fn other_problems_have_no_remedy_here() {
        for json in ["{}", r#"{"bus":{"slots":0}}"#, "]", r#"{"source":{"line":{}}}"#] {
            assert!(Remedies::of(&ValidatedScenario::from_json(json)).is_none(), "{json}");
        }
    }

    #[test]
    fn a_fast_motion_has_remedies() {
        use crate::validation::remedies::Remedies;
        use stepscope_sim::ValidatedScenario;

        // 16 000 steps/s at the top, and slots of 2000 cycles at 16 MHz: 8000 steps/s at most.
        let slow = ValidatedScenario::from_json(r#"{"bus":{"step_period_cycles":2000,"slots":10}}"#);
        let remedies = Remedies::of(&slow).expect("it is refused for its speed");
        assert_eq!(remedies.wrong, "The motion needs up to 16000 steps/s; the bus allows 8000.");
        assert_eq!(remedies.offers[0].change, "set the slot to 1000 cycles");
    }
}
