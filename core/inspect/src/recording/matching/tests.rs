use super::*;
use crate::recording::test_random::Noise;
use alloc::{format, string::String};
use stepscope_peripheral::trace::Step;

/// Times of `count` steps in s: constant, a ramp up and down, or constant and then a ramp.
fn plan(kind: usize, count: usize) -> Vec<f64> {
    let constant = |count: usize| (0..count).map(|k| k as f64 * 1e-3);
    let ramp = |count: usize| {
        let (half, rate) = (count as f64 / 2.0, 20_000.0);
        let time = move |steps: f64| libm::sqrt(2.0 * steps / rate);
        (0..count).map(move |k| {
            let position = k as f64 + 0.5;
            if position < half { time(position) } else { 2.0 * time(half) - time(2.0 * half - position) }
        })
    };
    match kind {
        0 => constant(count).collect(),
        1 => ramp(count).collect(),
        _ => {
            let first = count / 2;
            constant(first).chain(ramp(count - first).map(|at| at + first as f64 * 1e-3)).collect()
        }
    }
}

fn steps(times: &[f64], clock_hz: f64) -> Vec<Step> {
    let rows = (1..).zip(times);
    rows.map(|(position, at)| Step { cycle: libm::round(at * clock_hz) as u64, position }).collect()
}

/// The gaps: `-2000x3` for three steps missing from planned step 2000 on, `+2000x3` for three extra after planned step 2000.
fn gaps(times: &[f64], planned: &[f64]) -> Vec<String> {
    let (recorded, model) = (steps(times, 1e8), steps(planned, 16e6));
    let found = Matching::of(
        Side { steps: &recorded, clock_hz: 100_000_000, values: &[] },
        Side { steps: &model, clock_hz: 16_000_000, values: &[] },
    );
    let ends = [(planned.len(), times.len(), 0)];
    let (mut gaps, mut model, mut recorded) = (Vec::new(), 0, 0);
    let runs = found.runs().iter().map(|run| (run.model, run.recorded, run.count));
    for (next, came, count) in runs.chain(ends) {
        if next > model {
            gaps.push(format!("-{model}x{}", next - model));
        }
        if came > recorded {
            gaps.push(format!("+{}x{}", model as i64 - 1, came - recorded));
        }
        (model, recorded) = (next + count, came + count);
    }
    gaps
}

#[track_caller]
fn check(planned: &[f64], recorded: &[f64], expected: &[&str]) {
    assert_eq!(gaps(recorded, planned), expected);
}

/// The plan without some steps.
fn without(planned: &[f64], missing: core::ops::Range<usize>) -> Vec<f64> {
    let kept = planned.iter().enumerate().filter(|(index, _)| !missing.contains(index));
    kept.map(|(_, at)| *at).collect()
}

#[test]
fn missing_steps_are_found_at_any_position() {
    for kind in 0..3 {
        let plan = plan(kind, 3200);
        check(&plan, &plan, &[]);
        check(&plan, &without(&plan, 2000..2001), &["-2000x1"]);
        check(&plan, &without(&plan, 700..1200), &["-700x500"]);
        check(&plan, &without(&plan, 3199..3200), &["-3199x1"]);
        check(&plan, &without(&plan, 3000..3200), &["-3000x200"]);
        let both = without(&without(&plan, 2500..2503), 400..401);
        check(&plan, &both, &["-400x1", "-2500x3"]);
    }
    // At the beginning; a constant rate cannot show it.
    let ramp = plan(1, 3200);
    check(&ramp, &without(&ramp, 0..1), &["-0x1"]);
    check(&ramp, &without(&ramp, 0..5), &["-0x5"]);
    check(&ramp, &without(&ramp, 0..300), &["-0x300"]);
}

#[test]
fn extra_steps_are_found_at_any_position() {
    for kind in 0..3 {
        let plan = plan(kind, 3200);
        for (at, count) in [(1, 1), (500, 1), (2000, 1), (2000, 7), (3199, 3)] {
            let gap = if at < 3199 { plan[at + 1] - plan[at] } else { 1e-3 };
            let more = (1..=count).map(|k| plan[at] + gap * k as f64 / (count + 1) as f64);
            let mut recorded: Vec<f64> = plan.iter().copied().chain(more).collect();
            recorded.sort_by(f64::total_cmp);
            check(&plan, &recorded, &[&format!("+{at}x{count}")]);
        }
    }
    // A recording that began with another move.
    let ramp = plan(1, 3200);
    let before = (0..900).map(|k| k as f64 * 7e-4);
    let recorded: Vec<f64> = before.chain(ramp.iter().map(|at| at + 2.0)).collect();
    check(&ramp, &recorded, &["+-1x900"]);
}

#[test]
fn late_steps_and_pauses_are_neither_missing_nor_extra() {
    for kind in 0..3 {
        let plan = plan(kind, 3200);
        // All from step 1000 on are late by many intervals; one is late by 0.9 intervals.
        let pause = |at: usize, by: f64| {
            plan.iter().enumerate().map(|(k, t)| t + if k >= at { by } else { 0.0 }).collect::<Vec<_>>()
        };
        check(&plan, &pause(1000, 0.0105), &[]);
        check(&plan, &pause(1000, 0.5), &[]);
        let mut late = plan.clone();
        late[1500] += 0.9 * (plan[1501] - plan[1500]);
        check(&plan, &late, &[]);
        // The one and its follower late by more than an interval, and then on time.
        late[1500] = plan[1501] + 0.2 * (plan[1502] - plan[1501]);
        late[1501] = plan[1501] + 0.6 * (plan[1502] - plan[1501]);
        check(&plan, &late, &[]);
    }
}

#[test]
fn random_edits_are_found_through_drift_and_jitter() {
    let mut noise = Noise(88_172_645_463_325_252);
    for trial in 0..90 {
        let plan = plan(trial % 3, 3200);
        let (rate, jitter) = [(1.0, 0.0), (1.0002, 0.05), (0.98, 0.02), (1.02, 0.1), (1.05, 0.0)][trial % 5];
        let (mut recorded, mut expected, mut index) = (Vec::new(), Vec::new(), 0);
        let mut next = 100 + noise.below(400);
        let mut before = -1.0;
        while index < plan.len() {
            let after = plan.get(index + 1).copied().unwrap_or(plan[index] + 1e-3) - plan[index];
            let interval = libm::fmin(after, if index > 0 { plan[index] - plan[index - 1] } else { after });
            let is_edit = index == next && index < 3000;
            let missing = if is_edit { [0, 1, 1 + noise.below(20)][noise.below(3)] } else { 0 };
            if is_edit {
                next += 150 + noise.below(800);
            }
            if missing > 0 {
                expected.push(format!("-{index}x{missing}"));
                index += missing;
                continue;
            }
            let at = libm::fmax(plan[index] + jitter * interval * noise.between(-1.0, 1.0), before + 1e-7);
            recorded.push(at);
            if is_edit {
                expected.push(format!("+{index}x1"));
                recorded.push(at + 0.5 * after);
            }
            before = at;
            index += 1;
        }
        let recorded: Vec<f64> = recorded.iter().map(|at| 0.5 + at * rate).collect();
        assert_eq!(gaps(&recorded, &plan), expected, "trial {trial}: rate {rate}, jitter {jitter}");
    }
}

#[test]
fn a_million_steps_with_a_thousand_edits_are_matched() {
    let plan: Vec<f64> = (0..1_000_000).map(|k| f64::from(k) * 1e-4).collect();
    let kept = plan.iter().enumerate().filter(|(index, _)| index % 1000 != 500).map(|(_, at)| *at);
    let recorded: Vec<f64> = kept.collect();
    assert_eq!(gaps(&recorded, &plan).len(), 1000);
}

#[test]
fn a_recording_that_is_unlike_the_plan_is_matched_with_bounded_effort() {
    let plan: Vec<f64> = (0..20_000).map(|k| f64::from(k) * 1e-4).collect();
    let (mut noise, mut at) = (Noise(1), 0.0);
    // Intervals from 0.1 to 2.1 of the planned ones.
    let wild = plan.iter().map(|_| {
        at += 1e-4 * (1.1 + noise.between(-1.0, 1.0));
        at
    });
    let (recorded, model) = (steps(&wild.collect::<Vec<_>>(), 1e6), steps(&plan, 1e6));
    let side = |steps| Side { steps, clock_hz: 1_000_000, values: &[] };
    let mut search = Search::new(side(&recorded), side(&model));
    search.run();
    // Most starts end early; each may try at most 1_690_000.
    assert!(search.all_tried_gaps < 5_000_000, "{}", search.all_tried_gaps);
    let matching = Matching::of(side(&recorded), side(&model));
    // Most steps are near one that was planned.
    assert!((15_000..20_000).contains(&matching.len()), "{}", matching.len());
}

#[test]
fn each_start_has_its_own_budget() {
    // Five steps are missing at the beginning, so another start than the first one is right; three more later.
    let plan = plan(1, 3200);
    let recorded = without(&without(&plan, 2500..2503), 0..5);
    let (recorded, model) = (steps(&recorded, 1e8), steps(&plan, 16e6));
    let mut search = Search::new(
        Side { steps: &recorded, clock_hz: 100_000_000, values: &[] },
        Side { steps: &model, clock_hz: 16_000_000, values: &[] },
    );
    search.max_gaps = 200;
    let (_, starts) = search.run().expect("both have steps");
    assert_eq!(starts, [(5, 0), (2503, 2495)], "{}", search.all_tried_gaps);
}

#[test]
fn bytes_are_matched_by_their_values() {
    let values: Vec<u8> = (0..200_u32).map(|k| (k * k % 251) as u8).collect();
    let times: Vec<f64> = (0..200).map(|k| f64::from(k / 20) * 0.02 + f64::from(k % 20) * 87e-6).collect();
    let of = |kept: &dyn Fn(usize) -> bool, closed: bool| {
        let rows = (0..200).filter(|k| kept(*k));
        let values: Vec<u8> = rows.clone().map(|k| values[k]).collect();
        // Where the hole is closed, the bytes behind it come sooner, up to the end of their packet.
        let times: Vec<f64> =
            rows.map(|k| times[k] - if closed && (45..60).contains(&k) { 87e-6 } else { 0.0 }).collect();
        (steps(&times, 1e6), values)
    };
    let (plan, all) = of(&|_| true, false);
    for (closed, missing) in [(false, 45), (true, 44), (false, 0), (false, 199)] {
        let (recorded, values) = of(&|k| k != missing, closed);
        let side = |steps, values| Side { steps, clock_hz: 1_000_000, values };
        let found = Matching::of(side(&recorded, &values), side(&plan, &all));
        assert_eq!((found.len(), found.recorded(missing)), (199, None), "{missing}: {found:?}");
    }
}

#[test]
fn sides_with_few_or_simultaneous_steps_are_matched() {
    let one = steps(&[1.0], 1e6);
    let side = |steps| Side { steps, clock_hz: 1_000_000, values: &[] };
    assert!(Matching::of(side(&[]), side(&one)).is_empty() && Matching::of(side(&one), side(&[])).is_empty());
    let found = Matching::of(side(&one), side(&one));
    assert_eq!((found.len(), found.pair(0), found.pair(1)), (1, Some((0, 0)), None));
    // All at one time, and times that go back.
    let same = steps(&[1.0; 50], 1e6);
    assert_eq!(Matching::of(side(&same), side(&same)).len(), 50);
    let back = steps(&[3.0, 2.0, 5.0, 1.0], 1e6);
    assert_eq!(Matching::of(side(&back), side(&back)).len(), 4);
}
