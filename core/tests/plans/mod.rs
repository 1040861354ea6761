//! Plans of axes in scenarios: each problem with its path, and properties of every kind of move.

mod axis;
mod breakpoints;
mod continuous;
mod motor;
mod problems;
mod timed;

use stepscope_core::{
    motion::{moves::Axis, plan_axis},
    scenario::{Scenario, Source},
};

/// The first axis of a motion, from its JSON.
fn axis(json: &str) -> Axis {
    let text = format!(r#"{{"source":{{"motion":{{"axes":[{json}]}}}}}}"#);
    match Scenario::from_json(&text).expect("reads").source {
        Source::Motion(motion) => motion.axes.into_iter().next().expect("an axis"),
        _ => unreachable!("a motion"),
    }
}

/// Compares the problems of an axis with the expected ones.
#[track_caller]
fn check(json: &str, expected: &[&str]) {
    let problems = plan_axis(&axis(json), "axis").err().into_iter().flatten().collect::<Vec<_>>();
    let found: Vec<_> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(found, expected, "{json}");
}
